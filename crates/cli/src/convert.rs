//! `tilescope convert`: a point set into another format, verified on both sides.

use std::fmt::Write;
use std::path::PathBuf;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use tilescope_analysis::{Region, VerifyOptions};
use tilescope_formats::{CheckError, ExportContext, Format, PointSet};

use crate::options::{SetArguments, UNIT_SQUARE};
use crate::place::check_target;
use crate::progress::verifying;
use crate::{interrupt, output, verdict_code};

/// Arguments of `tilescope convert`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct ConvertArguments {
    /// The point set
    input: PathBuf,
    /// The file to write; its extension gives the format
    output: PathBuf,
    #[command(flatten)]
    set: SetArguments,
    /// Format of the output, where the extension does not tell
    #[arg(long, value_name = "FORMAT")]
    to: Option<Format>,
}

const EXAMPLES: &str = "\
A certificate is checked and carried over. Without one, and without --radius, the smallest distance
between two samples is taken as the radius; missing sides are those of the periodic unit square.
The file is written whatever the verdict; exit code 1 says that it is not valid for the radius.

Examples:
  tilescope convert set.csv set.npy
  tilescope convert theirs.txt set.ply --radius 0.01";

struct Input {
    set: PointSet,
    context: ExportContext,
}

pub fn run(arguments: &ConvertArguments) -> Result<u8> {
    interrupt::listen();
    let path = &arguments.output;
    check_target(path, arguments.to, "--to")?;
    let input = read(arguments)?;
    let exported =
        verifying(|control| tilescope_formats::export(path, &input.set, &input.context, control))
            .with_context(|| path.display().to_string())?;
    let report = &exported.report;
    let mut text = format!("{} samples, r = {}\n", report.count, report.radius);
    text.push_str(&output::verdict_text(report));
    for warning in &exported.warnings {
        text.push_str(&output::warning_line(&warning.to_string()));
    }
    let _ = writeln!(
        text,
        "certificate    {}",
        exported.certificate_path.display()
    );
    output::emit(&text)?;
    Ok(verdict_code(report.valid()))
}

fn read(arguments: &ConvertArguments) -> Result<Input> {
    let path = &arguments.input;
    let overrides = arguments.set.overrides(path)?;
    let outcome = verifying(|control| tilescope_formats::check(path, &overrides, control));
    match outcome {
        Err(CheckError::NoRadius | CheckError::NoRegion(_)) => uncertified(arguments),
        Err(error) => Err(error).with_context(|| path.display().to_string()),
        Ok(check) => {
            let differs = check.differences.first().map(ToString::to_string);
            ensure!(
                differs.is_none(),
                "{}: its certificate is not true: {}",
                path.display(),
                differs.unwrap_or_default()
            );
            let mut context = ExportContext::new(check.report.region, check.report.radius);
            if let Some(certificate) = check.certificate {
                context.program = certificate.program;
                context.program_version = certificate.program_version;
                context.method = certificate.method;
                context.parameters = certificate.parameters;
                context.precision = certificate.precision;
            }
            context.format = arguments.to;
            Ok(Input {
                set: check.set,
                context,
            })
        }
    }
}

/// A set of unknown radius: its smallest distance is the radius for which it is conflict-free.
fn uncertified(arguments: &ConvertArguments) -> Result<Input> {
    let read = arguments.set.read(&arguments.input)?;
    let given = &arguments.set;
    let region = Region {
        width: given.width.unwrap_or(UNIT_SQUARE.width),
        height: given.height.unwrap_or(UNIT_SQUARE.height),
        boundary: given.boundary.map_or(UNIT_SQUARE.boundary, Into::into),
    };
    let radius = match given.radius {
        Some(radius) => radius,
        None => smallest_distance(&read.set.points, region)
            .with_context(|| arguments.input.display().to_string())?,
    };
    let mut context = ExportContext::new(region, radius);
    context.format = arguments.to;
    "unknown".clone_into(&mut context.method);
    Ok(Input {
        set: read.set,
        context,
    })
}

fn smallest_distance(points: &[[f64; 2]], region: Region) -> Result<f64> {
    // The report's smallest distance does not depend on the radius it is asked about; the mean
    // spacing keeps the search quick.
    let spacing = (region.width * region.height / points.len().max(1) as f64).sqrt();
    let options = VerifyOptions::default();
    let report =
        verifying(|control| tilescope_analysis::verify(points, region, spacing, &options, control))
            .context("no radius is known, and none can be measured; give --radius")?;
    ensure!(
        report.min_distance.is_finite(),
        "a single sample has no radius; give --radius"
    );
    if let (true, Some(pair)) = (report.min_distance <= 0.0, report.worst_conflicts.first()) {
        bail!(
            "samples {} and {} are the same point, so the smallest distance is no radius; give --radius",
            pair.first,
            pair.second
        );
    }
    Ok(report.min_distance)
}
