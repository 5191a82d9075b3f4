//! Sets of any size: computed band by band, and written and verified as they come.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow, bail};
use serde_json::Value;
use tilescope_analysis::{Report, StreamVerifier, VerifyOptions};
use tilescope_core::{Domain, Sampled, Sweep, SweepState};
use tilescope_formats::{
    ExportContext, Exported, Format, Provenance, StreamExport, StreamOptions, Streamed, Warning,
};

use crate::interrupt;
use crate::make::{self, Facts};
use crate::parameters::RunArguments;
use crate::progress::Stopwatch;

/// Seconds between checkpoints: what an interruption may cost.
const CHECKPOINT_SECONDS: u64 = 10;

/// Samples handed to the writer at a time.
const PIECE: usize = 1 << 16;

/// What to do with the samples.
pub struct Target<'a> {
    /// Where to write them; without it they are only verified.
    pub out: Option<&'a Path>,
    /// Completes what an export states.
    pub complete: &'a dyn Fn(&mut ExportContext),
    /// Whether to verify.
    pub verify: bool,
    /// Whether to go on with an interrupted export.
    pub resume: bool,
}

/// A set that passed by.
pub struct Passed {
    pub facts: Facts,
    /// What was written and found.
    pub end: End,
}

/// What is left of the samples.
pub enum End {
    /// They were verified.
    Judged(Box<Report>),
    /// They were written, and verified if that was asked for.
    Written(Box<Streamed>),
}

impl End {
    /// Returns the report, if there is one.
    pub fn report(&self) -> Option<&Report> {
        match self {
            Self::Judged(report) => Some(report),
            Self::Written(streamed) => verified(streamed).map(|exported| &exported.report),
        }
    }

    /// Returns the certificate's path, if one was written.
    pub fn certificate(&self) -> Option<&Path> {
        match self {
            Self::Judged(_) => None,
            Self::Written(streamed) => verified(streamed).map(|e| e.certificate_path.as_path()),
        }
    }

    /// Returns what the user should be told.
    pub fn warnings(&self) -> &[Warning] {
        match self {
            Self::Judged(_) => &[],
            Self::Written(streamed) => &streamed.warnings,
        }
    }
}

fn verified(streamed: &Streamed) -> Option<&Exported> {
    streamed.verified.as_ref()
}

/// Makes a set with the parallel engine and hands it on as it comes.
pub fn pass(arguments: &RunArguments, target: &Target<'_>) -> Result<Passed> {
    let mut watch = Stopwatch::start();
    let pattern = arguments.pattern(&mut watch)?;
    let parameters = make::with_radius(arguments, &pattern, &mut watch)?;
    let domain = parameters.validate()?;
    let mut facts = Facts::of_run(&parameters, &domain, Some(arguments))?;
    let mut context = facts.context();
    (target.complete)(&mut context);
    let (mut sink, token) = Sink::open(target, &context)?;
    let sources = target.out.is_some() && context.format.is_some_and(Format::carries_provenance);
    let mut sweep = Sweep::new(&parameters, &pattern, sources)?;
    if let Some(token) = token {
        sweep.restore(&serde_json::from_value(token).context("the checkpoint is not of a run")?);
    }
    let end = sweep_into(&mut sweep, &mut sink, &domain, &mut watch)?;
    facts.seconds = watch.take();
    facts.summary = Some(sweep.summary());
    Ok(Passed { facts, end })
}

/// Computes on this thread (and the pool's) while another one writes and verifies.
fn sweep_into(
    sweep: &mut Sweep,
    sink: &mut Sink,
    domain: &Domain,
    watch: &mut Stopwatch,
) -> Result<End> {
    let (sender, receiver) = sync_channel(1);
    std::thread::scope(|scope| {
        let writer = scope.spawn(move || sink.take_all(domain, &receiver));
        let computed = loop {
            let word = match sweep.step(watch) {
                Ok(Some(sampled)) => Word::Band(sampled, sweep.state()),
                Ok(None) => Word::End,
                // Without a last word the writer finishes nothing.
                Err(error) => break Err(error),
            };
            let is_last = matches!(word, Word::End);
            // A writer that has stopped will say why.
            if sender.send(word).is_err() || is_last {
                break Ok(());
            }
        };
        drop(sender);
        let written = writer.join().map_err(|_| anyhow!("the writer failed"))?;
        computed?;
        written
    })
}

/// What the computing thread tells the writing one.
enum Word {
    Band(Sampled, SweepState),
    End,
}

/// Where samples go.
enum Sink {
    File(Option<StreamExport>, Instant),
    Judge(Option<StreamVerifier>),
}

impl Sink {
    /// Returns the sink and, when an export goes on, the token of its checkpoint.
    fn open(target: &Target<'_>, context: &ExportContext) -> Result<(Self, Option<Value>)> {
        let Some(path) = target.out else {
            let options = VerifyOptions::default();
            let verifier = StreamVerifier::new(context.region, context.radius, &options)?;
            return Ok((Self::Judge(Some(verifier)), None));
        };
        let (export, token) = if target.resume {
            let (export, token) = StreamExport::resume(path, context)?;
            (export, Some(token))
        } else {
            let options = StreamOptions {
                verify: target.verify,
                resumable: true,
            };
            (StreamExport::create(path, context, options)?, None)
        };
        Ok((Self::File(Some(export), Instant::now()), token))
    }

    /// Takes bands to the last one, then finishes.
    fn take_all(&mut self, domain: &Domain, words: &Receiver<Word>) -> Result<End> {
        for word in words {
            let Word::Band(sampled, state) = word else {
                return self.finish();
            };
            let provenance = make::provenance(&sampled);
            for (k, piece) in sampled.points.chunks(PIECE).enumerate() {
                let points = make::positions(domain, piece);
                let range = k * PIECE..k * PIECE + points.len();
                self.push(&points, provenance.as_ref().map(|all| &all[range]))?;
            }
            self.checkpoint(&state)?;
        }
        bail!("the run was cancelled before its end")
    }

    fn push(&mut self, points: &[[f64; 2]], provenance: Option<&[Provenance]>) -> Result<()> {
        match self {
            Self::File(Some(export), _) => export.push(points, provenance, &control)?,
            Self::Judge(Some(verifier)) => verifier.push(points, &control)?,
            Self::File(None, _) | Self::Judge(None) => {}
        }
        Ok(())
    }

    fn checkpoint(&mut self, state: &SweepState) -> Result<()> {
        if let Self::File(Some(export), last) = self
            && last.elapsed() >= Duration::from_secs(CHECKPOINT_SECONDS)
        {
            export.checkpoint(&serde_json::to_value(state)?)?;
            *last = Instant::now();
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<End> {
        match self {
            Self::File(export, _) => {
                let export = export.take().context("the file is finished already")?;
                Ok(End::Written(Box::new(export.finish(&control)?)))
            }
            Self::Judge(verifier) => {
                let verifier = verifier.take().context("the verdict is given already")?;
                Ok(End::Judged(Box::new(verifier.finish(&control)?)))
            }
        }
    }
}

fn control(_: tilescope_analysis::Progress) -> ControlFlow<()> {
    interrupt::flow()
}
