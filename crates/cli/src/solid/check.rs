//! `tilescope verify` and `tilescope convert` of sets in space.

use std::path::Path;

use anyhow::{Result, bail, ensure};
use serde_json::{Value, json};
use tilescope_analysis::{JudgeChoice, SolidError, SolidRegion, VerifyOptions, verify_solid};
use tilescope_formats::{
    Certificate, CheckError, ExportContext, Format, SolidCheck, SolidColumns, SolidContext,
    check_solid, check_solid_format, export_solid, in_space, read_solid,
};

use crate::options::{JudgeArguments, SetArguments, WITHOUT_CERTIFICATE};
use crate::output::{self, warning_line};
use crate::paths::{InFile, named};
use crate::progress::verifying;
use crate::verdict_code;

use super::{check_judge, hinted, overrides, verdict};

/// Checks a file with a set in space against its radius, its box and its certificate, and prints the outcome.
pub fn verify(
    file: &Path,
    set: &SetArguments,
    judge: &JudgeArguments,
    as_json: bool,
) -> Result<u8> {
    let (_, check) = checked(file, set, judge)?.map_err(hinted).in_file(file)?;
    let origin = set.origin_in_space();
    output::report(
        as_json,
        || to_json(&check, origin),
        || to_text(&check, judge.choice(), origin),
    )?;
    Ok(verdict_code(check.passed()))
}

/// The points of a file and their check, or why it was not checked.
type Checked = Result<(Vec<[f64; 3]>, SolidCheck), CheckError>;

/// Reads and checks a set. The outer error is one of the arguments; the inner one is that of the check, which `convert`
/// looks at.
fn checked(file: &Path, set: &SetArguments, judge: &JudgeArguments) -> Result<Checked> {
    check_judge(judge)?;
    let mut overrides = overrides(set, file)?;
    overrides.judges = judge.choice();
    Ok(verifying(|control| {
        check_solid(file, &overrides, set.depth, control)
    }))
}

/// Returns the outcome for programs.
fn to_json(check: &SolidCheck, origin: Option<[f64; 3]>) -> Value {
    // The same fields as of planar sets, so that programs read both alike.
    let (report, stated) = (&check.verdict.report, check.certificate.as_ref());
    let mut object = json!({
        "format": check.detection.format.to_string(),
        "precision": check.precision,
        "region": report.region,
        "radius": report.radius,
        "certificate": stated.is_some(),
        "prefix": stated.and_then(|stated| stated.prefix),
        "unchecked": stated.map(Certificate::unchecked),
        "differences": check.differences,
        "passed": check.passed(),
    });
    output::add(&mut object, verdict::json(&check.verdict));
    if let Some(origin) = origin {
        object["origin"] = json!(origin);
    }
    object
}

fn to_text(check: &SolidCheck, asked: JudgeChoice, origin: Option<[f64; 3]>) -> String {
    let mut shown = check.verdict.clone();
    // Gaps are printed at their places in the file, whose box begins at its origin; the report's begins at zero.
    let [x, y, z] = origin.unwrap_or_default();
    for gap in &mut shown.report.worst_gaps {
        let [at_x, at_y, at_z] = gap.center;
        gap.center = [at_x + x, at_y + y, at_z + z];
    }
    let at = origin.map_or_else(String::new, |[x, y, z]| format!(" at {x} {y} {z}"));
    let report = &check.verdict.report;
    let mut out = format!(
        "{}: {}{at}, r = {}\n\n{}",
        check.detection,
        verdict::box_text(&report.region),
        report.radius,
        verdict::text(&shown, asked),
    );
    out += &output::certificate_text(check.certificate.as_ref(), &check.differences);
    out
}

/// Writes a set in space in another format, verified as it was written. It is verified as it was read, too, unless its
/// radius is unknown: that is then measured. The exit code is that of the written set.
pub fn convert(
    [input, path]: [&Path; 2],
    to: Option<Format>,
    set: &SetArguments,
    judge: &JudgeArguments,
) -> Result<u8> {
    // A format that cannot hold the set is refused before the set is judged, which takes longest.
    check_solid_format(Format::to_write(path, to)?).in_file(path)?;
    let (points, mut context) = match checked(input, set, judge)? {
        // Neither a certificate nor --radius states a radius: the smallest distance becomes the radius.
        Err(CheckError::NoRadius) => uncertified(input, set)?,
        // A thinned set covers the points that it was chosen from and not its box. In another format it is a set of which
        // nothing is known but box and radius.
        Err(CheckError::Thinned) => thinned(input, set)?,
        read => {
            let (points, mut check) = read.map_err(hinted).in_file(input)?;
            let columns = std::mem::take(&mut check.columns);
            let context = SolidContext {
                columns,
                ..certified(check, input)?
            };
            (points, context)
        }
    };
    context.planar.format = to;
    context.planar.verify = judge.options();
    if let Some([x, y, z]) = set.origin_in_space() {
        // Certificates of sets in space state no origin, so that the new file has none.
        output::note(&format!(
            "note: sets in space are written from 0 on: the origin {x} {y} {z} is taken off all positions"
        ));
    }

    let exported =
        verifying(|control| export_solid(path, &points, &context, control)).in_file(path)?;
    let warnings: String = (exported.warnings.iter())
        .map(|warning| warning_line(&warning.to_string()))
        .collect();
    output::emit(&format!(
        "{} samples, r = {}\n{}{warnings}certificate    {}\n",
        points.len(),
        context.planar.radius,
        verdict::text(&exported.verdict, judge.choice()),
        named(&exported.certificate_path)
    ))?;
    Ok(verdict_code(exported.verdict.valid()))
}

/// Returns a thinned set and what the certificate of a converted one states: the box and the radius of its own.
fn thinned(file: &Path, set: &SetArguments) -> Result<(Vec<[f64; 3]>, SolidContext)> {
    let given = overrides(set, file)?;
    let read = read_solid(file, &given, set.depth)
        .map_err(hinted)
        .in_file(file)?;
    let [x, y, z] = read.origin;
    if set.origin.is_none() && [x, y, z].iter().any(|&value| value != 0.0) {
        output::note(&format!(
            "note: sets in space are written from 0 on: the lowest coordinates of the points, {x} {y} {z}, are taken off all"
        ));
    }
    output::note(&format!(
        "note: {}: the new certificate does not say that its points were chosen from others",
        named(file)
    ));
    let context = SolidContext {
        columns: read.columns,
        ..of_unknown_origin(read.region, read.radius)
    };
    Ok((read.points, context))
}

/// Returns what the new file's certificate states: box and radius as they were checked, and how the set was made as its
/// own certificate states it, if there is one. Fails if that is not true.
fn certified(check: SolidCheck, file: &Path) -> Result<SolidContext> {
    // The new certificate repeats what the old one states, which therefore has to be true.
    if let Some(differs) = check.differences.first() {
        let file = named(file);
        bail!("{file}: its certificate is not true: {differs}; {WITHOUT_CERTIFICATE}");
    }
    let report = &check.verdict.report;
    let mut context = of_unknown_origin(report.region, report.radius);
    if let Some(stated) = check.certificate {
        let planar = &mut context.planar;
        planar.program = stated.program;
        planar.program_version = stated.program_version;
        planar.method = stated.method;
        planar.parameters = stated.parameters;
        planar.precision = stated.precision;
        // Of a prefix only the number of points that were made is repeated: the rest is measured on the new file.
        planar.made = stated.prefix.map(|prefix| prefix.made);
    }
    Ok(context)
}

/// A set in space as it was read, without a verdict.
pub struct ReadSet {
    pub points: Vec<[f64; 3]>,
    pub region: SolidRegion,
    pub radius: f64,
    /// Whether the radius was given or stated; else it is the smallest distance.
    pub has_radius: bool,
}

/// Reads a set, with its smallest distance for a radius that nothing states.
pub fn read(file: &Path, set: &SetArguments) -> Result<ReadSet> {
    match read_solid(file, &overrides(set, file)?, set.depth) {
        // Other programs' sets state no radius: their smallest distance stands for it.
        Err(CheckError::NoRadius) => {
            let (points, context) = uncertified(file, set)?;
            let planar = &context.planar;
            Ok(ReadSet {
                region: in_space(planar.region, context.depth),
                radius: planar.radius,
                points,
                has_radius: false,
            })
        }
        read => {
            let read = read.map_err(hinted).in_file(file)?;
            Ok(ReadSet {
                points: read.points,
                region: read.region,
                radius: read.radius,
                has_radius: true,
            })
        }
    }
}

/// Reads a set of unknown radius: its smallest distance becomes the radius.
fn uncertified(file: &Path, set: &SetArguments) -> Result<(Vec<[f64; 3]>, SolidContext)> {
    let mut overrides = overrides(set, file)?;
    // Any radius will do to read the points.
    overrides.radius = Some(1.0);
    let read = read_solid(file, &overrides, set.depth)
        .map_err(hinted)
        .in_file(file)?;
    let radius = smallest_distance(&read.points, read.region).in_file(file)?;
    let context = SolidContext {
        columns: read.columns,
        ..of_unknown_origin(read.region, radius)
    };
    Ok((read.points, context))
}

/// Returns the smallest distance of a set without a radius, which then serves as its radius.
fn smallest_distance(points: &[[f64; 3]], region: SolidRegion) -> Result<f64> {
    // Any radius gives the same smallest distance. The mean spacing keeps the search quick; an empty file is refused
    // below.
    let spacing = (region.volume() / points.len().max(1) as f64).cbrt();
    let shortest = region.size().into_iter().fold(f64::INFINITY, f64::min);
    let options = VerifyOptions {
        // One judge is enough for a distance. The user's choice of judges is for the file that `convert` writes.
        judges: JudgeChoice::Subdivision,
        ..VerifyOptions::default()
    };
    // The verifier refuses a radius at which, in a periodic box, a place may be near two images of a sample: the
    // shortest side has to be more than twice the covering limit, which is a hair above the radius. 2.5 is 2 with room.
    let radius = spacing.min(shortest / 2.5);

    let report = verifying(|control| verify_solid(points, region, radius, &options, control))
        .map_err(|error| match error {
            // The box is at fault, and not that no radius is known.
            SolidError::OutOfRegion { .. } => hinted(error.into()),
            other => anyhow::Error::from(other)
                .context("no radius is known, and none can be measured; give --radius"),
        })?;
    let distance = report.min_distance;
    // One sample has no distance to another, and two at one place have none that is a radius.
    ensure!(
        distance.is_finite() && distance > 0.0,
        "the smallest distance is {distance}, which is no radius; give --radius"
    );
    Ok(distance)
}

/// Returns the statements about a set of which nothing says how it was made.
fn of_unknown_origin(region: SolidRegion, radius: f64) -> SolidContext {
    let base = tilescope_analysis::Region::new([region.width, region.height], region.is_periodic());
    debug_assert_eq!(in_space(base, region.depth), region);
    SolidContext {
        planar: ExportContext {
            method: "unknown".to_owned(),
            ..ExportContext::new(base, radius)
        },
        depth: region.depth,
        columns: SolidColumns::default(),
    }
}
