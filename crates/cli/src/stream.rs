//! Sets of any size: computed, written and verified band by band.

use std::path::Path;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow, ensure};
use pollster::block_on;
use serde_json::{Value, json};
use tilescope_analysis::StreamVerifier;
use tilescope_core::{Domain, ExactPlane, Sampled, Summary, Sweep, SweepState, WindowMaker};
use tilescope_formats::{
    ExportContext, Format, Overrides, PassingDigest, Provenance, StreamExport, StreamOptions,
    certificate_beside, check_stream, checkpoint_token, finish_interrupted, resume_path,
};
use tilescope_gpu::{Backend, Bands};
use tilescope_sets::{Facts, Recipe, Settled, provenance};

use crate::engine::of_engine;
use crate::interrupt::Resumable;
use crate::output::{Judged, Outcome, Work};
use crate::paths::{InFile, named};
use crate::progress::{Stopwatch, verifying};
use crate::sample_arguments::{CHECKPOINT, SampleArguments};
use crate::{interrupt, make};

/// Samples handed to the writer at a time: 1 MiB of positions. Chosen, not measured.
const PIECE: usize = 1 << 16;

/// A run that is made band by band.
pub trait Banded {
    /// Computes the next band and returns its samples, or `None` at the end.
    fn step(&mut self, watch: &mut Stopwatch) -> Result<Option<Sampled>>;

    /// Returns the position of the run, from which another process can continue.
    fn state(&self) -> SweepState;

    /// Continues from the state of the same run.
    fn restore(&mut self, state: &SweepState);

    /// Returns the counts of all bands so far.
    fn summary(&self) -> Summary;

    /// Returns the engine in use, if one was chosen.
    fn backend(&self) -> Option<Backend>;
}

impl Banded for Bands {
    fn step(&mut self, watch: &mut Stopwatch) -> Result<Option<Sampled>> {
        block_on(self.step(watch)).map_err(of_engine)
    }

    fn state(&self) -> SweepState {
        self.state()
    }

    fn restore(&mut self, state: &SweepState) {
        self.restore(state);
    }

    fn summary(&self) -> Summary {
        self.summary()
    }

    fn backend(&self) -> Option<Backend> {
        Some(self.backend().clone())
    }
}

impl Banded for Sweep<ExactPlane<'_>> {
    fn step(&mut self, watch: &mut Stopwatch) -> Result<Option<Sampled>> {
        Ok(self.step(watch)?)
    }

    fn state(&self) -> SweepState {
        self.state()
    }

    fn restore(&mut self, state: &SweepState) {
        self.restore(state);
    }

    fn summary(&self) -> Summary {
        self.summary()
    }

    fn backend(&self) -> Option<Backend> {
        // Exact tiling runs on all threads.
        None
    }
}

/// Makes a set of KDRT band by band, and writes and verifies each band.
pub fn kdrt(
    arguments: &SampleArguments,
    run: &Settled,
    backend: &Backend,
    watch: Stopwatch,
) -> Result<Outcome> {
    let begin = |sources| make::bands(run, backend, sources);
    let passed = pass(arguments, run.facts.clone(), &run.domain, begin, watch);
    of_file(passed, arguments)
}

/// Makes an exact tiling of about `samples` samples band by band, and writes and verifies each band.
pub fn exact(arguments: &SampleArguments, recipe: &Recipe, samples: f64) -> Result<Outcome> {
    let mut watch = Stopwatch::start();
    let history = recipe.history(&mut watch)?;
    let plane = ExactPlane::new(&recipe.parameters, &history)?;
    let domain = *plane.domain();

    // The certificate is begun before the samples are counted, so that it states how many there are for each of the pattern
    // from the expected number.
    let facts = recipe.facts_of_exact(&recipe.parameters, &domain, history.pattern(), samples);
    let begin = |sources| Ok(plane.sweep(sources));
    let passed = pass(arguments, facts, &domain, begin, watch);
    of_file(passed, arguments)
}

/// Adds the name of the file, if there is one, to the error of a set that was made band by band.
fn of_file(passed: Result<Outcome>, arguments: &SampleArguments) -> Result<Outcome> {
    match &arguments.out {
        Some(path) => passed.in_file(path),
        None => passed,
    }
}

/// Makes the set of a run band by band, and writes and verifies each band. `begin` returns the run at its beginning, with
/// the source of each sample if it is asked for.
fn pass<B: Banded>(
    arguments: &SampleArguments,
    mut facts: Facts,
    domain: &Domain,
    begin: impl FnOnce(bool) -> Result<B>,
    mut watch: Stopwatch,
) -> Result<Outcome> {
    let context = arguments.context(&facts);
    let out = arguments.out.as_deref();
    let resumed = out.filter(|_| arguments.resume);
    // `finish_interrupted` below removes the checkpoint, so that its state is read before. Other arguments are thus
    // refused even if the interrupted run had written all samples.
    let state = resumed
        .map(|path| state_of(path, &facts, arguments.no_verify))
        .transpose()?;

    // The interrupted process may have written all samples and given the file its name. Then at most the certificate
    // has to get its name, and no band is computed.
    if let Some(path) = resumed
        && let Some(count) = finish_interrupted(path)?
    {
        return finished(arguments, path, facts, count);
    }

    let sink = Sink::open(arguments, &context)?;
    // Sources are computed only for a file that can hold them.
    let sources = out.is_some() && context.format.is_some_and(Format::carries_provenance);
    let mut bands = begin(sources)?;
    if let Some(state) = &state {
        bands.restore(state);
    }

    let parameters = serde_json::to_value(&facts.parameters)?;
    let verify = !arguments.no_verify;
    // A run that is resumed compares `parameters` and `verify` with its own arguments, in `state_of`.
    let token =
        |sweep_state| json!({ "parameters": parameters, "verify": verify, "state": sweep_state });
    let end = pass_into(&mut bands, sink, domain, token, &mut watch);
    let (verdict, digest) = end.map_err(|error| with_hint(error, out))?;

    let summary = bands.summary();
    let count = summary.count as u64;
    facts.summary = Some(summary);
    let work = Work {
        backend: bands.backend(),
        seconds: watch.take(),
    };
    let outcome = Outcome::new(facts, work, count, verdict);
    Ok(Outcome {
        // The digest of a resumed run is that of the samples after the checkpoint alone, and is left out.
        positions_digest: state.is_none().then_some(digest),
        ..outcome
    })
}

/// Returns the outcome of a run that was interrupted when its file was whole already. Unless --no-verify is given, the
/// file is judged once more: the first verdict was lost with the interrupted process. The digest of the positions and
/// the warnings of the export were lost, too, and are left out.
fn finished(arguments: &SampleArguments, path: &Path, facts: Facts, count: u64) -> Result<Outcome> {
    // The run itself was the work of the process that was interrupted.
    let outcome = |judged| Outcome::new(facts, Work::default(), count, judged);
    if arguments.no_verify {
        return Ok(outcome(Judged::default()));
    }

    let overrides = Overrides {
        judges: arguments.judge.choice(),
        ..Overrides::default()
    };
    let check = verifying(|control| check_stream(path, &overrides, control))?;
    Ok(outcome(Judged {
        report: Some(check.report),
        certificate: Some(certificate_beside(path)),
        ..Judged::default()
    }))
}

/// Returns the error with a note on how to resume, if there is a checkpoint.
fn with_hint(error: anyhow::Error, out: Option<&Path>) -> anyhow::Error {
    let has_checkpoint = |path: &&Path| checkpoint_token(path).is_ok_and(|token| token.is_some());
    match out.filter(has_checkpoint) {
        Some(path) => error.context(Resumable(path.to_owned())),
        None => error,
    }
}

/// Returns the state of the interrupted run of `path`. Fails if there is none, and if it had another parameter or was
/// not verified as this run is: the error names the first that differs.
fn state_of(path: &Path, facts: &Facts, no_verify: bool) -> Result<SweepState> {
    let token = checkpoint_token(path)?.with_context(|| {
        let resume = resume_path(path);
        format!("there is nothing to resume: no {}", named(&resume))
    })?;
    // Bands of other parameters would not fit to those that the file has already.
    for (name, asked) in &facts.parameters {
        let begun = &token["parameters"][name];
        // KDRT and exact tiling have other parameters.
        ensure!(
            !begun.is_null(),
            "the interrupted run had no {name}, as it was by another --method or version; all arguments must be the same"
        );
        ensure!(
            begun == asked,
            "the interrupted run had {name} {begun}, this one has {asked}; all arguments must be the same"
        );
    }

    // The verifier must have seen every band, or none.
    let was = if no_verify {
        "verified, without --no-verify"
    } else {
        "not verified (--no-verify)"
    };
    ensure!(
        token["verify"] == !no_verify,
        "the interrupted run was {was}; all arguments must be the same"
    );
    let state = token["state"].clone();
    serde_json::from_value(state).context("the checkpoint is not that of a run")
}

/// Computes bands on this thread (and the pool's, or a device) while another thread writes and verifies them. Returns
/// the verdict and the digest of the positions.
fn pass_into(
    bands: &mut impl Banded,
    sink: Sink,
    domain: &Domain,
    token: impl Fn(SweepState) -> Value,
    watch: &mut Stopwatch,
) -> Result<(Judged, String)> {
    // One band waits at most: the memory must not grow where computing is faster than writing.
    let (sender, receiver) = sync_channel(1);
    std::thread::scope(|scope| {
        let writer = scope.spawn(move || sink.take_all(domain, &receiver));

        let computed = loop {
            let message: Message = match bands.step(watch) {
                Ok(sampled) => sampled.map(|sampled| (sampled, token(bands.state()))),
                // Without the end the writer does not finish the file.
                Err(error) => break Err(error),
            };
            let is_last = message.is_none();
            // If the writer stopped, its result has the reason.
            if sender.send(message).is_err() || is_last {
                break Ok(());
            }
        };

        // The writer waits until the channel is closed.
        drop(sender);
        let written = writer.join().map_err(|_| anyhow!("the writer failed"))?;

        match computed {
            // Both threads may fail, for instance if the disk is full and the process is asked to end. The writer's
            // error is then the one that is reported.
            Err(error) => Err(written.err().unwrap_or(error)),
            Ok(()) => written?.context("the writer ended before the run"),
        }
    })
}

/// A band of samples and the checkpoint to resume from after it, for the writing thread; `None` is the end.
type Message = Option<(Sampled, Value)>;

/// The receiver of samples: a file, or the verifier alone.
enum Sink {
    File {
        export: Box<StreamExport>,
        last_checkpoint: Instant,
        /// The least time between two checkpoints.
        interval: Duration,
    },
    Judge(Box<StreamVerifier>),
}

impl Sink {
    /// Opens the file of the set, or begins the verdict of a set that is not written.
    fn open(arguments: &SampleArguments, context: &ExportContext) -> Result<Self> {
        let Some(path) = &arguments.out else {
            // Without a file the set is only judged while it passes by.
            let options = arguments.judge.options();
            let verifier = StreamVerifier::new(context.region, context.radius, &options)?;
            return Ok(Self::Judge(Box::new(verifier)));
        };
        let export = if arguments.resume {
            // The token has the state of the run, from which the engine has begun already.
            let (export, _token) = StreamExport::resume(path, context)?;
            export
        } else {
            // Every file that is written band by band can be resumed with --resume.
            let (verify, resumable) = (!arguments.no_verify, true);
            StreamExport::create(path, context, StreamOptions { verify, resumable })?
        };
        Ok(Self::File {
            export: Box::new(export),
            last_checkpoint: Instant::now(),
            interval: Duration::from_secs(arguments.checkpoint.unwrap_or(CHECKPOINT)),
        })
    }

    /// Takes all bands, then finishes, and returns the verdict and the digest of the positions; `None` if the channel
    /// is closed without an end message.
    fn take_all(
        mut self,
        domain: &Domain,
        messages: &Receiver<Message>,
    ) -> Result<Option<(Judged, String)>> {
        let mut digest = PassingDigest::default();
        for message in messages {
            let Some((sampled, token)) = message else {
                return Ok(Some((self.finish()?, digest.text())));
            };

            let provenance = sampled.sources.as_deref().map(provenance);
            // Positions take twice the memory of lattice points, so that they are made piece by piece.
            for (k, piece) in sampled.points.chunks(PIECE).enumerate() {
                let points = domain.users_from_lattice(piece);
                digest.add(&points);
                let range = k * PIECE..k * PIECE + points.len();
                self.push(&points, provenance.as_ref().map(|all| &all[range]))?;
            }

            // A checkpoint is written only between bands, as the token has the state after the whole band.
            if let Self::File {
                export,
                last_checkpoint,
                interval,
            } = &mut self
                && last_checkpoint.elapsed() >= *interval
            {
                export.checkpoint(&token)?;
                *last_checkpoint = Instant::now();
            }
        }

        // The channel was closed without the end: the run failed, and its file stays unfinished.
        Ok(None)
    }

    fn push(&mut self, points: &[[f64; 2]], provenance: Option<&[Provenance]>) -> Result<()> {
        match self {
            Self::File { export, .. } => export.push(points, provenance, &|_| interrupt::flow())?,
            Self::Judge(verifier) => verifier.push(points, &|_| interrupt::flow())?,
        }
        Ok(())
    }

    /// Finishes the file or the verdict.
    fn finish(self) -> Result<Judged> {
        Ok(match self {
            Self::File { export, .. } => {
                let streamed = export.finish(&|_| interrupt::flow())?;
                // With --no-verify there is neither a report nor a certificate.
                let verified = streamed.verified.map(|v| (v.report, v.certificate_path));
                let (report, certificate) = verified.unzip();
                Judged {
                    report,
                    certificate,
                    warnings: streamed.warnings,
                    ..Judged::default()
                }
            }
            Self::Judge(verifier) => Judged {
                report: Some(verifier.finish(&|_| interrupt::flow())?),
                ..Judged::default()
            },
        })
    }
}
