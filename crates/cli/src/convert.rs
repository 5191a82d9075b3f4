//! `tilescope convert`: a point set into another format, verified as it was read and as it was written.

use std::path::PathBuf;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use tilescope_analysis::{JudgeChoice, Region, VerifyOptions};
use tilescope_formats::{CheckError, ExportContext, Format, Overrides, PointSet};

use crate::options::{JudgeArguments, SetArguments, UNIT_SQUARE};
use crate::progress::verifying;
use crate::target::check_target;
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
    #[command(flatten)]
    judge: JudgeArguments,
    /// Format of the output, if its extension does not name one
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

pub fn run(arguments: &ConvertArguments) -> Result<u8> {
    interrupt::listen();
    let path = &arguments.output;
    check_target(path, arguments.to, "--to")?;
    let (set, context) = read(arguments)?;
    let exported = verifying(|control| tilescope_formats::export(path, &set, &context, control));
    let exported = exported.with_context(|| path.display().to_string())?;
    let report = &exported.report;
    let warnings = exported.warnings.iter();
    let warnings = warnings.map(|warning| output::warning_line(&warning.to_string()));
    output::emit(&format!(
        "{} samples, r = {}\n{}{}certificate    {}\n",
        report.count,
        report.radius,
        output::verdict_text(report),
        warnings.collect::<String>(),
        exported.certificate_path.display()
    ))?;
    Ok(verdict_code(report.valid()))
}

/// Returns the set, and what the new file states of it.
fn read(arguments: &ConvertArguments) -> Result<(PointSet, ExportContext)> {
    let path = &arguments.input;
    let overrides = Overrides {
        judges: arguments.judge.choice(),
        ..arguments.set.overrides(path)?
    };
    let (set, context) =
        match verifying(|control| tilescope_formats::check(path, &overrides, control)) {
            Err(CheckError::NoRadius | CheckError::NoRegion(_)) => uncertified(arguments)?,
            Err(error) => return Err(error).with_context(|| path.display().to_string()),
            Ok(check) => {
                if let Some(differs) = check.differences.first() {
                    bail!("{}: its certificate is not true: {differs}", path.display());
                }
                let mut context = ExportContext::new(check.report.region, check.report.radius);
                if let Some(certificate) = check.certificate {
                    context = ExportContext {
                        program: certificate.program,
                        program_version: certificate.program_version,
                        method: certificate.method,
                        parameters: certificate.parameters,
                        precision: certificate.precision,
                        ..context
                    };
                }
                (check.set, context)
            }
        };
    let format = arguments.to;
    let verify = arguments.judge.options();
    Ok((
        set,
        ExportContext {
            format,
            verify,
            ..context
        },
    ))
}

/// Reads a set of unknown radius: its smallest distance becomes the radius.
fn uncertified(arguments: &ConvertArguments) -> Result<(PointSet, ExportContext)> {
    let (path, given) = (&arguments.input, &arguments.set);
    let set = given.read(path)?.set;
    let region = given.region_over(UNIT_SQUARE);
    let radius = given
        .radius
        .map_or_else(|| smallest_distance(&set.points, region), Ok);
    let radius = radius.with_context(|| path.display().to_string())?;
    let mut context = ExportContext::new(region, radius);
    "unknown".clone_into(&mut context.method);
    Ok((set, context))
}

fn smallest_distance(points: &[[f64; 2]], region: Region) -> Result<f64> {
    // The report's smallest distance does not depend on the radius it is asked about; the mean
    // spacing keeps the search quick.
    let spacing = (region.width * region.height / points.len().max(1) as f64).sqrt();
    let options = VerifyOptions {
        judges: JudgeChoice::Delaunay,
        ..VerifyOptions::default()
    };
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
