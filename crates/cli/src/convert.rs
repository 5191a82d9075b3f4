//! `tilescope convert`: a point set into another format, verified as it was read and as it was written.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use tilescope_analysis::{JudgeChoice, Region, VerifyOptions};
use tilescope_formats::{
    CertifiedLevel, Check, CheckError, ExportContext, Format, Overrides, PointSet, is_valid,
};

use crate::ground::GroundArguments;
use crate::options::{JudgeArguments, SetArguments, WITHOUT_CERTIFICATE, formats, hinted};
use crate::paths::{InFile, check_inputs_stay, check_target, named};
use crate::progress::verifying;
use crate::ranks::{self, RankArguments};
use crate::sample_arguments::leave_out_origin;
use crate::solid::{self, Slice};
use crate::space::SizeArgument;
use crate::{interrupt, output, verdict_code};

/// Arguments of `tilescope convert`.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct ConvertArguments {
    /// The point set
    input: PathBuf,
    /// The file to write; its extension gives the format
    output: PathBuf,
    #[command(flatten)]
    set: SetArguments,
    #[command(flatten)]
    size: SizeArgument,
    #[command(flatten)]
    judge: JudgeArguments,
    #[command(flatten)]
    ground: GroundArguments,
    /// Format of the output, if its extension does not name one
    #[arg(long, value_name = "FORMAT", value_parser = formats())]
    to: Option<Format>,
    /// Of a set in space, write the disks in which this plane meets its balls: a table with x, y, radius and depth, the
    /// distance of the sample above the plane
    #[arg(long, value_name = "AXIS=PLACE", value_parser = Slice::parse)]
    slice: Option<Slice>,
    #[command(flatten)]
    ranks: RankArguments,
}

const EXAMPLES: &str = "\
A certificate is checked and carried over; with --no-certificate it is left out, and the new one
states that the method is unknown. Without one, and without --radius, the radius is the smallest
distance between two samples; missing sides are those of the periodic unit square. The file is written
whatever the verdict; exit code 1 means that the set is not valid for the radius.

Examples:
  tilescope convert set.csv set.npy
  tilescope convert theirs.txt set.ply --radius 0.01
  tilescope convert levels.csv third.csv --rank 0.33
  tilescope convert levels.csv painted.csv --rank-image dark.png
  tilescope convert balls.ply balls.npy
  tilescope convert balls.ply disks.csv --slice z=5";

/// Writes a set in another format, and prints its verdict.
pub fn run(arguments: &ConvertArguments) -> Result<u8> {
    interrupt::listen();
    // From here on three sides in one word are as three options.
    let mut arguments = arguments.clone();
    arguments.set.take_sides(&arguments.size);
    let arguments = &arguments;
    let path = &arguments.output;
    // The paths are checked before the input is read, which may take long.
    check_target(path, arguments.to, "--to")?;
    let painted = arguments.ranks.rank_image.as_deref();
    check_inputs_stay(path, painted.into_iter().chain([arguments.input.as_path()]))?;
    let has_image = arguments.ground.radius_image.is_some();
    arguments.set.refuse_two_radii(has_image)?;
    output::note_left_out(&arguments.set, &arguments.input);

    let (input, given) = (arguments.input.as_path(), &arguments.set);
    if let Some(slice) = arguments.slice {
        return solid::plane::write([input, path], arguments.to, given, slice);
    }
    if solid::is_in_space(given, input) {
        // Fields, shapes and ranks are those of sets in the plane: their options, whose names `option` returns only if
        // they are given, are refused.
        let is_given = true;
        let ground = arguments.ground.option().map(|name| (name, is_given));
        let ranks = arguments.ranks.option().map(|name| (name, is_given));
        let planar: Vec<_> = ground.into_iter().chain(ranks).collect();
        solid::refuse(&planar, solid::PLANAR)?;
        return solid::check::convert([input, path], arguments.to, given, &arguments.judge);
    }

    let is_ranked = arguments.ranks.option().is_some();
    if is_ranked {
        ranks::refuse_others(given, &arguments.ground)?;
    }
    if let Some(painted) = painted {
        let options = arguments.judge.options();
        return ranks::keep_painted([input, path], given, painted, arguments.to, &options);
    }

    let (set, context) = match arguments.ranks.rank {
        Some(below) => {
            let (set, mut context) = ranks::set_below(input, given, below)?;
            // `read` in the other arm does the same.
            leave_out_origin(path, arguments.to, &mut context)?;
            (set, context)
        }
        None => read(arguments)?,
    };
    let context = ExportContext {
        format: arguments.to,
        verify: arguments.judge.options(),
        ..context
    };
    let exported = verifying(|control| tilescope_formats::export(path, &set, &context, control))
        .in_file(path)?;

    let (report, certificate) = (exported.report, named(&exported.certificate_path));
    let levels = &exported.certificate.levels;
    let verdict = output::verdict_text(&report, levels);
    let count = report.count;
    let judged_in = match &context.varying {
        Some(varying) => output::ground_text(varying),
        None => report.radius.to_string(),
    };

    let warnings: String = (exported.warnings.iter())
        .map(|warning| output::warning_line(&warning.to_string()))
        .collect();
    output::emit(&format!(
        "{count} samples, r = {judged_in}\n{verdict}{warnings}certificate    {certificate}\n"
    ))?;
    Ok(verdict_code(is_valid(&report, levels)))
}

/// Returns the set, and the statements of the new file's certificate.
fn read(arguments: &ConvertArguments) -> Result<(PointSet, ExportContext)> {
    let path = &arguments.input;
    let mut overrides = Overrides {
        judges: arguments.judge.choice(),
        ..arguments.set.overrides(path)?
    };
    let check =
        |overrides: &_| verifying(|control| tilescope_formats::check(path, overrides, control));
    let mut checked = check(&overrides);
    // A field and a shape are made only for a set whose certificate states them, which the first check finds out before
    // it judges. It then ends, and a second one judges in them.
    if let Err(CheckError::NoField) = checked {
        (arguments.ground).judge_in(path, &arguments.set, &mut overrides)?;
        checked = check(&overrides);
    }

    let (set, mut context) = match checked {
        // Neither a certificate nor an option states the radius or the region: the smallest distance and the unit
        // square take their places.
        Err(CheckError::NoRadius | CheckError::NoRegion(_)) => uncertified(arguments)?,
        outcome => {
            let (set, found) = outcome.map_err(hinted).in_file(path)?;
            let format = found.detection.format;
            let mut context = certified(found, path)?;
            // Ranks stand in a column of the file, beside the levels that its certificate states.
            if !context.levels.is_empty() {
                let ranks = ranks::of_file(path, &arguments.set, format)?;
                context.ranks = ranks.unwrap_or_default().into();
            }
            (set, context)
        }
    };

    // An origin that is given takes the place of the stated one.
    if let Some(origin) = arguments.set.origin() {
        context.origin = origin;
    }
    context.varying = overrides.varying;
    // An origin cannot be left out of a set with a field or a shape, so that these have to be known first.
    leave_out_origin(&arguments.output, arguments.to, &mut context)?;
    Ok((set, context))
}

/// Carries the certificate of a checked set over, if it has one.
fn certified(check: Check, path: &Path) -> Result<ExportContext> {
    // The new file's certificate repeats these statements, so that they have to be true.
    if let Some(differs) = check.differences.first() {
        let path = named(path);
        bail!("{path}: its certificate is not true: {differs}; {WITHOUT_CERTIFICATE}");
    }
    let mut context = of_unknown_origin(check.report.region, check.report.radius);
    // The verdict is not carried over: it is that of the file to be written, which may round positions.
    if let Some(certificate) = check.certificate {
        context.origin = certificate.origin.unwrap_or_default();
        context.levels = check.levels.iter().map(CertifiedLevel::claim).collect();
        context.program = certificate.program;
        context.program_version = certificate.program_version;
        context.method = certificate.method;
        context.parameters = certificate.parameters;
        context.precision = certificate.precision;
        // A set that is the beginning of a larger one states how many points that one has.
        context.made = certificate.prefix.map(|prefix| prefix.made);
    }
    Ok(context)
}

/// Reads a set without a certificate. Its radius is the one that is given, or else its smallest distance.
fn uncertified(arguments: &ConvertArguments) -> Result<(PointSet, ExportContext)> {
    let (path, given) = (&arguments.input, &arguments.set);
    let read = given.read(path, given.set)?;
    let region = given.region_over(Region::UNIT_SQUARE);
    given.refuse_degrees(&read, region).in_file(path)?;
    let set = read.set;
    let radius = match given.least_radius() {
        Some(radius) => radius,
        None => smallest_distance(&set.points, region).in_file(path)?,
    };
    Ok((set, of_unknown_origin(region, radius)))
}

/// Returns the statements about a set of which nothing says how it was made.
fn of_unknown_origin(region: Region, radius: f64) -> ExportContext {
    ExportContext {
        method: "unknown".to_owned(),
        ..ExportContext::new(region, radius)
    }
}

/// Returns the smallest distance of a set without a radius, which then serves as its radius.
fn smallest_distance(points: &[[f64; 2]], region: Region) -> Result<f64> {
    // The report's smallest distance does not depend on the radius; the mean spacing keeps the search quick. An empty
    // set, which has no spacing, is refused by the verifier.
    let spacing = (region.width * region.height / points.len().max(1) as f64).sqrt();
    // One judge is enough to measure it: the judges that the arguments choose judge the written file.
    let options = VerifyOptions {
        judges: JudgeChoice::Delaunay,
        ..VerifyOptions::default()
    };
    let report =
        verifying(|control| tilescope_analysis::verify(points, region, spacing, &options, control))
            .context("no radius is known, and none can be measured; give --radius")?;

    let distance = report.min_distance;
    ensure!(
        distance.is_finite(),
        "a single sample has no radius; give --radius"
    );
    // Two samples at one place are 0 apart, and disks of radius 0 cover nothing. They are a conflict for any spacing, and
    // the worst one.
    if let (true, Some(pair)) = (distance <= 0.0, report.worst_conflicts.first()) {
        let (first, second) = (pair.first, pair.second);
        bail!(
            "samples {first} and {second} are the same point, so the smallest distance is no radius; give --radius"
        );
    }
    Ok(distance)
}
