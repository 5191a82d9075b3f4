//! `tilescope sample`: parameters to a verified, saved set.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use tilescope_analysis::{Region, Report, VerifyOptions};
use tilescope_core::{
    Domain, Origin, Parameters, Point, Run, SampleError, Sequential, Stage, Summary,
    reference_sample, sample_count, search_radius,
};
use tilescope_formats::{ExportContext, Format, PointSet, Precision, Provenance, bytes_digest};

use crate::options::region;
use crate::output::{self, Outcome};
use crate::parameters::RunArguments;
use crate::progress::{Stopwatch, verifying};
use crate::{interrupt, verdict_code};

/// Arguments of `tilescope sample`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct SampleArguments {
    #[command(flatten)]
    run: RunArguments,
    /// KDRT, or the reference sampler, which makes a maximal set from scratch and of the arguments
    /// above heeds radius or count, sides, boundary and seed
    #[arg(long, value_enum, default_value = "kdrt")]
    method: Method,
    /// Save the set, validated, with a certificate beside it; the extension gives the format
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Format of the file, where the extension does not tell
    #[arg(long, value_name = "FORMAT", requires = "out")]
    format: Option<Format>,
    /// Number type, for formats that leave the choice: f32 or f64
    #[arg(long, value_enum, default_value = "f64", requires = "out")]
    precision: PrecisionArgument,
    /// Write the samples in an order drawn from this seed
    #[arg(long, value_name = "SEED", requires = "out")]
    shuffle: Option<u64>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  tilescope sample --radius 0.01
  tilescope sample --count 100000 --seed 7 --out set.npy
  tilescope sample --radius 0.02 --width 2 --boundary bounded --insertion uniform --out set.csv
  tilescope sample --radius 0.002 --search 2          the experiment that leaves gaps: exit code 1
  tilescope sample --count 5000 --method reference --json";

/// How to make the set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    /// Randomized tiling
    Kdrt,
    /// Ebeida et al. 2012
    Reference,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum PrecisionArgument {
    F32,
    F64,
}

/// A set that was made, by either method.
pub struct Made {
    pub method: &'static str,
    pub parameters: BTreeMap<String, Value>,
    pub region: Region,
    pub radius: f64,
    pub set: PointSet,
    pub summary: Option<Summary>,
    pub seconds: Vec<(Stage, f64)>,
}

pub fn run(arguments: &SampleArguments) -> Result<u8> {
    interrupt::listen();
    if let Some(path) = &arguments.out {
        check_target(path, arguments.format)?;
    }
    let made = match arguments.method {
        Method::Kdrt => kdrt(arguments)?,
        Method::Reference => reference(arguments)?,
    };
    let (report, saved, warnings) = match &arguments.out {
        Some(path) => save(arguments, &made, path)?,
        None => (judge(&made)?, None, Vec::new()),
    };
    let outcome = Outcome {
        made: &made,
        report: &report,
        saved: saved.as_deref(),
        warnings,
    };
    if arguments.json {
        output::emit(&format!("{}\n", output::json(&outcome)))?;
    } else {
        output::emit(&output::text(&outcome))?;
    }
    Ok(verdict_code(report.valid()))
}

/// Refuses, before any work, a target that could not be written at its end.
fn check_target(path: &Path, format: Option<Format>) -> Result<()> {
    let known = Format::ALL.map(Format::extension).join(", ");
    ensure!(
        format.is_some() || Format::from_path(path).is_some(),
        "{}: the extension names no format (known: {known}); give --format",
        path.display()
    );
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder {
        ensure!(
            folder.is_dir(),
            "{}: there is no such folder",
            folder.display()
        );
    }
    ensure!(!path.is_dir(), "{}: this is a folder", path.display());
    Ok(())
}

fn kdrt(arguments: &SampleArguments) -> Result<Made> {
    let mut watch = Stopwatch::start();
    let parameters = arguments.run.parameters();
    if arguments.run.count.is_none() {
        parameters.validate()?;
    }
    let pattern = arguments.run.pattern(&mut watch)?;
    let run = match arguments.run.count {
        Some(count) => sample_count(&parameters, count, &pattern, &mut watch)?,
        None => Sequential::new(&parameters, Arc::clone(&pattern))?.finish(&mut watch)?,
    };
    let mut stated = described(&run.parameters)?;
    if let Some(path) = &arguments.run.pattern {
        stated.insert("pattern".into(), pattern_of_file(path)?);
    }
    Ok(from_run(&run, stated, watch.take()))
}

/// Returns a finished run as a set with its provenance.
pub fn from_run(
    run: &Run,
    parameters: BTreeMap<String, Value>,
    seconds: Vec<(Stage, f64)>,
) -> Made {
    let provenance = run
        .result
        .iter()
        .map(|&id| match run.samples.origins[id as usize] {
            Origin::Tiled { block, pattern, .. } => Provenance::tiled(block, pattern),
            Origin::Inserted { iteration, .. } => Provenance::inserted(iteration),
        });
    Made {
        method: "kdrt",
        parameters,
        region: region(&run.domain),
        radius: run.domain.radius(),
        set: PointSet {
            points: run.positions(),
            provenance: Some(provenance.collect()),
        },
        summary: Some(run.summary()),
        seconds,
    }
}

fn reference(arguments: &SampleArguments) -> Result<Made> {
    let mut watch = Stopwatch::start();
    let parameters = arguments.run.parameters();
    let (domain, points) = reference_set(&parameters, arguments.run.count, &mut watch)?;
    let stated = BTreeMap::from([
        ("width".to_owned(), json!(parameters.width)),
        ("height".to_owned(), json!(parameters.height)),
        ("radius".to_owned(), json!(domain.radius())),
        ("boundary".to_owned(), json!(parameters.boundary)),
        ("seed".to_owned(), json!(parameters.seed)),
    ]);
    Ok(Made {
        method: "reference",
        parameters: stated,
        region: region(&domain),
        radius: domain.radius(),
        set: PointSet::from_points(positions(&domain, &points)),
        summary: None,
        seconds: watch.take(),
    })
}

/// Makes a reference set; with a count, of the radius that gives it.
fn reference_set(
    parameters: &Parameters,
    count: Option<u64>,
    watch: &mut Stopwatch,
) -> Result<(Domain, Vec<Point>), SampleError> {
    let mut attempt = |radius| {
        let domain = Parameters {
            radius,
            ..*parameters
        }
        .validate_sequential()?;
        let points = reference_sample(domain, parameters.seed, watch)?;
        Ok((points.len() as u64, (domain, points)))
    };
    match count {
        Some(count) => search_radius(parameters, count, attempt),
        None => attempt(parameters.radius).map(|(_, made)| made),
    }
}

fn positions(domain: &Domain, points: &[Point]) -> Vec<[f64; 2]> {
    points
        .iter()
        .map(|&p| domain.user_from_lattice(p))
        .collect()
}

/// Returns every parameter by name.
pub fn described(parameters: &Parameters) -> Result<BTreeMap<String, Value>> {
    Ok(serde_json::from_value(serde_json::to_value(parameters)?)?)
}

/// A pattern from a file is named by its content.
fn pattern_of_file(path: &Path) -> Result<Value> {
    let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Ok(json!({ "file": name, "digest": bytes_digest(&bytes) }))
}

/// Returns the verifier's report on a set.
pub fn judge(made: &Made) -> Result<Report> {
    let options = VerifyOptions::default();
    verifying(|control| {
        tilescope_analysis::verify(
            &made.set.points,
            made.region,
            made.radius,
            &options,
            control,
        )
    })
    .context("the verifier gives no verdict")
}

/// Returns what an export of a set states.
pub fn context(made: &Made) -> ExportContext {
    let mut context = ExportContext::new(made.region, made.radius);
    "tilescope".clone_into(&mut context.program);
    env!("CARGO_PKG_VERSION").clone_into(&mut context.program_version);
    made.method.clone_into(&mut context.method);
    context.parameters.clone_from(&made.parameters);
    context
}

fn save(
    arguments: &SampleArguments,
    made: &Made,
    path: &Path,
) -> Result<(Report, Option<PathBuf>, Vec<String>)> {
    let mut context = context(made);
    context.format = arguments.format;
    context.shuffle_seed = arguments.shuffle;
    context.precision = match arguments.precision {
        PrecisionArgument::F32 => Precision::Single,
        PrecisionArgument::F64 => Precision::Double,
    };
    let exported =
        verifying(|control| tilescope_formats::export(path, &made.set, &context, control))
            .with_context(|| path.display().to_string())?;
    let warnings = exported.warnings.iter().map(ToString::to_string).collect();
    Ok((exported.report, Some(exported.certificate_path), warnings))
}
