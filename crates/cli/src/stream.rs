//! Sets of any size: computed band by band, and written and verified as they come.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow, ensure};
use serde_json::{Value, json};
use tilescope_analysis::{Report, StreamVerifier, VerifyOptions};
use tilescope_core::{Domain, Sampled, SweepState};
use tilescope_formats::{
    ExportContext, Exported, Format, Provenance, StreamExport, StreamOptions, Streamed, Warning,
    checkpoint_token, resume_path,
};

use crate::bands::Bands;
use crate::engine::Chosen;
use crate::facts::Facts;
use crate::parameters::RunArguments;
use crate::progress::Stopwatch;
use crate::{interrupt, make};

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
    /// How much time may pass between checkpoints.
    pub checkpoint: Duration,
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

/// Makes a set with an engine that makes bands, and hands it on as it comes.
pub fn pass(arguments: &RunArguments, chosen: &Chosen, target: &Target<'_>) -> Result<Passed> {
    let mut watch = Stopwatch::start();
    let pattern = arguments.pattern(&mut watch)?;
    let parameters = make::with_radius(arguments, &pattern, &mut watch)?;
    let domain = parameters.validate()?;
    let mut facts = Facts::of_run(&parameters, &domain, Some(arguments))?;
    let mut context = facts.context();
    (target.complete)(&mut context);
    let state = match (target.out, target.resume) {
        (Some(path), true) => Some(state_of(path, &facts, target.verify)?),
        _ => None,
    };
    let sink = Sink::open(target, &context)?;
    let sources = target.out.is_some() && context.format.is_some_and(Format::carries_provenance);
    let mut bands = Bands::new(&parameters, &pattern, sources, chosen)?;
    if let Some(state) = &state {
        bands.restore(state);
    }
    let parameters = serde_json::to_value(&facts.parameters)?;
    let verify = target.verify;
    let token =
        |state: &SweepState| json!({ "parameters": parameters, "verify": verify, "state": state });
    let end = pass_into(&mut bands, sink, (&domain, &token), &mut watch)
        .map_err(|error| with_hint(error, target.out))?;
    facts.seconds = watch.take();
    facts.engine = Some(bands.told());
    facts.summary = Some(bands.summary());
    Ok(Passed { facts, end })
}

/// Says how to go on, where that is possible.
fn with_hint(error: anyhow::Error, out: Option<&Path>) -> anyhow::Error {
    match out {
        Some(path) if checkpoint_token(path).is_ok_and(|token| token.is_some()) => {
            error.context(format!(
                "{}: not finished; the same command with --resume goes on from the last checkpoint",
                path.display()
            ))
        }
        _ => error,
    }
}

/// Returns where the interrupted run of `path` was. Fails when there is none, or when it was made with
/// other parameters, which are named.
fn state_of(path: &Path, facts: &Facts, verify: bool) -> Result<SweepState> {
    let token = checkpoint_token(path)?.with_context(|| {
        let resume = resume_path(path);
        format!("there is nothing to resume: no {}", resume.display())
    })?;
    for (name, asked) in &facts.parameters {
        let begun = &token["parameters"][name];
        ensure!(
            begun == asked,
            "the interrupted run had {name} {begun}, asked was {asked}; all arguments must be the same"
        );
    }
    ensure!(
        token["verify"] == verify,
        "the interrupted run was {}; all arguments must be the same",
        if verify {
            "not verified (--no-verify)"
        } else {
            "verified, without --no-verify"
        }
    );
    let state = token["state"].clone();
    serde_json::from_value(state).context("the checkpoint is not of a run")
}

/// What a checkpoint must know of a run that was there.
type Token<'a> = dyn Fn(&SweepState) -> Value + Sync + 'a;

/// Computes on this thread (and the pool's, or a device) while another one writes and verifies.
fn pass_into(
    bands: &mut Bands,
    sink: Sink,
    (domain, token): (&Domain, &Token<'_>),
    watch: &mut Stopwatch,
) -> Result<End> {
    let (sender, receiver) = sync_channel(1);
    std::thread::scope(|scope| {
        let writer = scope.spawn(move || sink.take_all(domain, token, &receiver));
        let computed = loop {
            let word = match bands.step(watch) {
                Ok(Some(sampled)) => Word::Band(sampled, bands.state()),
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
        // A run that was stopped leaves the writer nothing to say but that.
        match (computed, written) {
            (Err(error), Ok(_)) => Err(error),
            (Err(error), Err(why)) if why.is::<CutShort>() => Err(error),
            (_, written) => written,
        }
    })
}

/// What the computing thread tells the writing one.
enum Word {
    Band(Sampled, SweepState),
    End,
}

/// The computing thread ended without a last word.
#[derive(Debug, thiserror::Error)]
#[error("the run was cancelled before its end")]
struct CutShort;

/// Where samples go.
enum Sink {
    File {
        export: Box<StreamExport>,
        last_checkpoint: Instant,
        checkpoint: Duration,
    },
    Judge(Box<StreamVerifier>),
}

impl Sink {
    fn open(target: &Target<'_>, context: &ExportContext) -> Result<Self> {
        let Some(path) = target.out else {
            let options = VerifyOptions::default();
            let verifier = StreamVerifier::new(context.region, context.radius, &options)?;
            return Ok(Self::Judge(Box::new(verifier)));
        };
        let export = if target.resume {
            StreamExport::resume(path, context)?.0
        } else {
            let options = StreamOptions {
                verify: target.verify,
                resumable: true,
            };
            StreamExport::create(path, context, options)?
        };
        Ok(Self::File {
            export: Box::new(export),
            last_checkpoint: Instant::now(),
            checkpoint: target.checkpoint,
        })
    }

    /// Takes bands to the last one, then finishes.
    fn take_all(
        mut self,
        domain: &Domain,
        token: &Token<'_>,
        words: &Receiver<Word>,
    ) -> Result<End> {
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
            self.checkpoint(|| token(&state))?;
        }
        Err(CutShort.into())
    }

    fn push(&mut self, points: &[[f64; 2]], provenance: Option<&[Provenance]>) -> Result<()> {
        match self {
            Self::File { export, .. } => export.push(points, provenance, &control)?,
            Self::Judge(verifier) => verifier.push(points, &control)?,
        }
        Ok(())
    }

    fn checkpoint(&mut self, token: impl FnOnce() -> Value) -> Result<()> {
        if let Self::File {
            export,
            last_checkpoint,
            checkpoint,
        } = self
            && last_checkpoint.elapsed() >= *checkpoint
        {
            export.checkpoint(&token())?;
            *last_checkpoint = Instant::now();
        }
        Ok(())
    }

    fn finish(self) -> Result<End> {
        Ok(match self {
            Self::File { export, .. } => End::Written(Box::new(export.finish(&control)?)),
            Self::Judge(verifier) => End::Judged(Box::new(verifier.finish(&control)?)),
        })
    }
}

fn control(_: tilescope_analysis::Progress) -> ControlFlow<()> {
    interrupt::flow()
}
