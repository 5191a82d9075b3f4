//! `tilescope sample`: parameters to a verified, saved set.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use clap::{Args, ValueEnum};
use tilescope_analysis::Report;
use tilescope_core::{MAXIMAL_DENSITY, Parameters, radius_estimate};
use tilescope_formats::{ExportContext, Exported, Format, PointSet, Precision, Warning};

use crate::engine::{Chosen, EngineArguments};
use crate::make::{self, Facts, Made};
use crate::output::{self, Outcome};
use crate::parameters::RunArguments;
use crate::place::check_target;
use crate::progress::verifying;
use crate::{interrupt, stream, verdict_code, window};

/// Sets expected to be larger than this are never held as a whole, where that can be avoided.
const LARGE: f64 = 1e6;

/// Arguments of `tilescope sample`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct SampleArguments {
    #[command(flatten)]
    pub run: RunArguments,
    #[command(flatten)]
    pub engine: EngineArguments,
    /// Only the samples in this rectangle, X0 <= x < X1 and Y0 <= y < Y1: exactly those of the whole
    /// set, which is never made; in a periodic domain it may lie across the border or beyond, and a bounded
    /// one's border belongs to the windows that reach it
    #[arg(long, num_args = 4, value_names = ["X0", "Y0", "X1", "Y1"],
        conflicts_with_all = ["shuffle", "resume", "no_verify"])]
    pub window: Option<Vec<f64>>,
    /// KDRT, or the reference sampler, which makes a maximal set from scratch and of the arguments
    /// above heeds radius or count, sides, boundary and seed
    #[arg(long, value_enum, default_value = "kdrt")]
    pub method: Method,
    /// Save the set, validated, with a certificate beside it; the extension gives the format.
    /// Sets of more than a million samples are written as they come: to npy, bin, rps, csv and ply of any size
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Go on with an interrupted --out from its last checkpoint; all other arguments must be the same
    #[arg(long, requires = "out")]
    resume: bool,
    /// Seconds between checkpoints of a file written as it comes: what an interruption may cost
    #[arg(long, value_name = "SECONDS", default_value_t = 10, requires = "out")]
    checkpoint: u64,
    /// Do not verify; a file then has no certificate
    #[arg(long, requires = "out")]
    no_verify: bool,
    /// Format of the file, where the extension does not tell
    #[arg(long, value_name = "FORMAT", requires = "out")]
    pub format: Option<Format>,
    /// Number type, for formats that leave the choice: f32 or f64. Rounding to f32 moves samples of large sets (from some
    /// 30,000 on) closer than the radius: such a file is NOT VALID, and says up to which radius it is conflict-free
    #[arg(long, value_enum, default_value = "f64", requires = "out")]
    pub precision: PrecisionArgument,
    /// Write the samples in an order drawn from this seed
    #[arg(long, value_name = "SEED", requires = "out")]
    shuffle: Option<u64>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

const EXAMPLES: &str = "\
Examples:
  tilescope sample --radius 0.01
  tilescope sample --count 100000 --seed 7 --out set.npy
  tilescope sample --radius 0.02 --width 2 --boundary bounded --insertion uniform --out set.csv
  tilescope sample --count 100000000 --leaf 40 --out huge.npy
  tilescope sample --count 100000000 --engine gpu --out huge.npy
  tilescope sample --radius 2e-5 --window 0.5 0.5 0.502 0.502
  tilescope sample --radius 0.002 --search 2          the experiment that leaves gaps: exit code 1
  tilescope sample --count 5000 --method reference --json";

/// How to make the set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// Randomized tiling
    Kdrt,
    /// Ebeida et al. 2012
    Reference,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum PrecisionArgument {
    F32,
    F64,
}

pub fn run(arguments: &SampleArguments) -> Result<u8> {
    interrupt::listen();
    arguments.engine.threads.set()?;
    if let Some(path) = &arguments.out {
        check_target(path, arguments.format, "--format")?;
    }
    if let Some(window) = &arguments.window {
        return window::run(arguments, window);
    }
    let expected = arguments.expected()?;
    let streams = arguments.streams(expected)?;
    let made = if arguments.method == Method::Reference {
        ensure!(
            !arguments.engine.wants_gpu(),
            "--engine gpu and --gpu-adapter compute KDRT: the reference sampler runs on the CPU alone"
        );
        make::reference(&arguments.run)?
    } else {
        let parameters = arguments.run.parameters();
        let chosen = arguments.engine.choose(&parameters, expected)?;
        if streams {
            return stream(arguments, &chosen);
        }
        make::with(&chosen, &arguments.run)?
    };
    let facts = &made.facts;
    let (report, certificate, warnings) = match &arguments.out {
        Some(path) if arguments.no_verify => {
            let warnings = save_unverified(arguments, facts, &made.set, path)?;
            (None, None, warnings)
        }
        Some(path) => {
            let exported = save(arguments, &made, path)?;
            let certificate = Some(exported.certificate_path);
            (Some(exported.report), certificate, exported.warnings)
        }
        None => {
            let report = make::judge(&made.set.points, facts.region, facts.radius)?;
            (Some(report), None, Vec::new())
        }
    };
    let outcome = Outcome {
        facts,
        count: made.set.len() as u64,
        report: report.as_ref(),
        saved: certificate.as_deref(),
        warnings: (repeats(arguments, facts.radius).into_iter())
            .chain(warnings.iter().map(ToString::to_string))
            .collect(),
    };
    tell(arguments, &outcome)
}

/// Returns a remark on a pattern that repeats itself within blocks.
fn repeats(arguments: &SampleArguments, radius: f64) -> Option<String> {
    let parameters = Parameters {
        radius,
        ..arguments.run.parameters()
    };
    let tiled = arguments.method == Method::Kdrt && arguments.run.pattern.is_none();
    let side = parameters.side_without_repeats().filter(|_| tiled)?;
    Some(format!(
        "the pattern of {} r repeats itself within the largest blocks, which spectra show; --pattern-side {side} holds them",
        parameters.pattern.side
    ))
}

/// Makes and saves a set without ever holding it.
fn stream(arguments: &SampleArguments, chosen: &Chosen) -> Result<u8> {
    let target = stream::Target {
        out: arguments.out.as_deref(),
        complete: &|context| arguments.complete(context),
        verify: !arguments.no_verify,
        resume: arguments.resume,
        checkpoint: Duration::from_secs(arguments.checkpoint),
    };
    let passed =
        stream::pass(&arguments.run, chosen, &target).map_err(|error| match &arguments.out {
            Some(path) => error.context(path.display().to_string()),
            None => error,
        })?;
    let outcome = Outcome {
        facts: &passed.facts,
        count: passed.facts.summary.as_ref().map_or(0, |s| s.count as u64),
        report: passed.end.report(),
        saved: passed.end.certificate(),
        warnings: (repeats(arguments, passed.facts.radius).into_iter())
            .chain(passed.end.warnings().iter().map(ToString::to_string))
            .collect(),
    };
    tell(arguments, &outcome)
}

fn tell(arguments: &SampleArguments, outcome: &Outcome<'_>) -> Result<u8> {
    if arguments.json {
        output::emit(&format!("{}\n", output::json(outcome)))?;
    } else {
        output::emit(&output::text(outcome))?;
    }
    Ok(verdict_code(outcome.report.is_none_or(Report::valid)))
}

impl SampleArguments {
    /// Returns the file's format, if there is a file.
    fn format(&self) -> Option<Format> {
        let named = || self.out.as_deref().and_then(Format::from_path);
        self.format.or_else(named)
    }

    /// Returns about how many samples the set will have.
    fn expected(&self) -> Result<f64> {
        Ok(match self.run.count {
            Some(count) => {
                // No device is opened for a count that cannot be.
                radius_estimate(&self.run.parameters(), count)?;
                count as f64
            }
            None => self.run.parameters().validate()?.area_radii() * MAXIMAL_DENSITY,
        })
    }

    /// Returns whether the set is to be passed on band by band: when it is large, when it is resumed, and when nobody else wants to see it.
    fn streams(&self, expected: f64) -> Result<bool> {
        let parameters = self.run.parameters();
        let engine = self.method == Method::Kdrt && self.engine.makes_bands(&parameters);
        let format = self.format().is_none_or(Format::streams) && self.shuffle.is_none();
        if self.resume {
            ensure!(
                engine,
                "--resume needs the parallel engine or a GPU, which make sets band by band"
            );
            ensure!(
                format,
                "--resume needs a format that is written as it comes ({}), and no --shuffle",
                Format::ALL
                    .into_iter()
                    .filter(|f| f.streams())
                    .map(Format::extension)
                    .collect::<Vec<_>>()
                    .join(", ")
            );
        }
        Ok(engine && format && (self.resume || self.no_verify || expected > LARGE))
    }

    /// Completes what an export states.
    fn complete(&self, context: &mut ExportContext) {
        context.format = self.format();
        context.shuffle_seed = self.shuffle;
        context.precision = match self.precision {
            PrecisionArgument::F32 => Precision::Single,
            PrecisionArgument::F64 => Precision::Double,
        };
    }
}

/// Saves a set without a verdict, and so without a certificate.
pub fn save_unverified(
    arguments: &SampleArguments,
    facts: &Facts,
    set: &PointSet,
    path: &Path,
) -> Result<Vec<Warning>> {
    let mut context = facts.context();
    arguments.complete(&mut context);
    tilescope_formats::export_unverified(path, set, &context)
        .with_context(|| path.display().to_string())
}

fn save(arguments: &SampleArguments, made: &Made, path: &Path) -> Result<Exported> {
    let mut context = made.facts.context();
    arguments.complete(&mut context);
    verifying(|control| tilescope_formats::export(path, &made.set, &context, control))
        .with_context(|| path.display().to_string())
}
