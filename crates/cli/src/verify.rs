//! `tilescope verify`: checks a file against its radius, its region and its certificate.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use serde_json::json;
use tilescope_analysis::{Control, MAX_FACTOR, verify_prefix};
use tilescope_formats::{
    Certificate, CertificateUse, CertifiedLevel, Check, CheckError, Overrides, VaryingDomain,
    check_stream,
};
use tilescope_sets::check_or_unit_square;

use crate::ground::GroundArguments;
use crate::options::{JudgeArguments, SetArguments, hinted};
use crate::paths::{InFile, named};
use crate::progress::verifying;
use crate::space::SizeArgument;
use crate::{interrupt, output, own_radii, ranks, solid, thinned, verdict_code};

/// Arguments of `tilescope verify`.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct VerifyArguments {
    /// The point set
    file: PathBuf,
    #[command(flatten)]
    set: SetArguments,
    #[command(flatten)]
    size: SizeArgument,
    #[command(flatten)]
    judge: JudgeArguments,
    #[command(flatten)]
    ground: GroundArguments,
    /// The points from which a thinned set was chosen: judge the choice itself
    #[arg(long, value_name = "FILE", conflicts_with = "prefix")]
    source: Option<PathBuf>,
    /// Judge only the first N samples: of a set with nested levels, whether they hold what its certificate states; of a stipple, a
    /// field or a shape, whether no two are near, and within which factor of their radii they cover
    #[arg(long, value_name = "N", conflicts_with_all = ["radius"])]
    prefix: Option<usize>,
    /// Judge only the samples of a set with nested levels whose ranks are below T, a number from above 0 to 1: whether they are
    /// samples of one level, and hold another one whole
    #[arg(long, value_name = "T", conflicts_with_all = ["radius", "prefix", "source", "no_certificate"])]
    rank: Option<f64>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Without a certificate the radius must be given; sides and boundary that are not given are those of
the periodic unit square. If no radius is given and the file has a column named radius, no two
samples may be near by their own radii: in the plane, or in a domain that is bounded unless
--boundary says otherwise; covering cannot be judged without the field. Only the region and the
radius are taken from a certificate; the tolerance is always 2^-15. Of a set whose radius varies, or
that covers a shape, the certificate states an expression and polygons; images must be given. A
stipple is the beginning of a set: it may cover within more than the radius, as its certificate
states, and that factor is measured again. A file does not show how its set was made: to check the
fields listed as stated only, make the set again. A set of nested levels is verified level by level.
A set in space is one whose certificate states a third side, or for which --depth does: cubes and
covered circles judge it. A thinned set is judged against the points from which it was chosen, which
--source has; without them, that no two of its points are near.

Examples:
  tilescope verify set.csv
  tilescope verify theirs.txt --radius 0.01
  tilescope verify survey.csv --radius 2 --width 90 --height 60 --columns easting northing
  tilescope verify levels.npy --prefix 1000
  tilescope verify levels.csv --rank 0.3
  tilescope verify trees.csv --radius 2 --width 100 --height 80 --boundary bounded --origin 500000 5400000
  tilescope verify field.ply --radius-image grey.png
  tilescope verify thinned.ply --source cloud.ply
  tilescope verify balls.ply
  tilescope verify theirs.xyz --radius 1 --width 10 --height 10 --depth 10 --boundary bounded
  tilescope verify photo.svg --density-image photo.jpg
  tilescope verify photo.svg --density-image photo.jpg --prefix 20000
  tilescope verify theirs.csv --radius-image grey.png --radius 0.005..0.02
  tilescope verify theirs.csv --radius 0.5 --width 20 --height 10 --boundary bounded --json";

/// Checks a file against its radius, its domain and its certificate, and prints the verdict.
pub fn run(arguments: &VerifyArguments) -> Result<u8> {
    interrupt::listen();
    let has_image = arguments.ground.radius_image.is_some();
    arguments.set.refuse_two_radii(has_image)?;
    // From here on three sides in one word are as three options.
    let mut arguments = arguments.clone();
    arguments.set.take_sides(&arguments.size);
    let arguments = &arguments;
    output::note_left_out(&arguments.set, &arguments.file);
    if let Some(stated) = thinned::space::certificate(&arguments.set, &arguments.file) {
        return thinned_in_space(arguments, &stated);
    }
    if solid::is_in_space(&arguments.set, &arguments.file) {
        return in_space(arguments);
    }
    if let Some(count) = arguments.prefix {
        return prefix(arguments, count);
    }
    if let Some(below) = arguments.rank {
        ranks::refuse_others(&arguments.set, &arguments.ground)?;
        let options = arguments.judge.options();
        return ranks::judge(
            &arguments.file,
            &arguments.set,
            below,
            &options,
            arguments.json,
        );
    }
    let (file, set) = (&arguments.file, &arguments.set);
    let source = arguments.source.as_deref();
    let judge_thinned = || thinned::run(file, set, &arguments.ground, source, arguments.json);
    // Only a thinned set has a source: of any other one, --source is refused there.
    if source.is_some() {
        return judge_thinned();
    }

    let found = match checked(arguments) {
        // Only the certificate says that a set was thinned, and it is read with the points.
        Err(error) if matches!(error.downcast_ref(), Some(CheckError::Thinned)) => {
            return judge_thinned();
        }
        // The radii of the samples say less than a field, and are asked only where no radius is given.
        Err(error) if matches!(error.downcast_ref(), Some(CheckError::NoRadius)) => {
            let judged = own_radii::judge(file, set, arguments.json)?;
            return judged.ok_or(error);
        }
        outcome => outcome?,
    };
    let corner = origin(found.origin, &found.check);
    output::report(
        arguments.json,
        || to_json(&found.check, corner),
        || to_text(&found, corner),
    )?;
    Ok(verdict_code(found.check.passed()))
}

/// Checks a set whose certificate states that it was chosen from points in space.
fn thinned_in_space(arguments: &VerifyArguments, stated: &Certificate) -> Result<u8> {
    let given = [
        ("--prefix", arguments.prefix.is_some()),
        ("--rank", arguments.rank.is_some()),
    ];
    solid::refuse(&given, solid::PLANAR)?;
    let VerifyArguments {
        file,
        set,
        ground,
        json,
        ..
    } = arguments;
    let source = arguments.source.as_deref();
    thinned::space::run(file, set, ground, source, stated, *json)
}

/// Checks a set in space. Refuses the options of planar sets.
fn in_space(arguments: &VerifyArguments) -> Result<u8> {
    let given = [
        ("--prefix", arguments.prefix.is_some()),
        ("--rank", arguments.rank.is_some()),
        ("--source", arguments.source.is_some()),
    ];
    let is_given = true;
    let ground = arguments.ground.option().map(|name| (name, is_given));
    let planar: Vec<(&str, bool)> = given.into_iter().chain(ground).collect();
    solid::refuse(&planar, solid::PLANAR)?;
    let VerifyArguments {
        file,
        set,
        judge,
        json,
        ..
    } = arguments;
    solid::check::verify(file, set, judge, *json)
}

/// Judges the first `count` samples, and prints the verdict.
fn prefix(arguments: &VerifyArguments, count: usize) -> Result<u8> {
    let (file, set) = (&arguments.file, &arguments.set);
    let stated = set.certificate(file)?;
    if let Some(stated) = stated.filter(Certificate::is_varying) {
        return prefix_of_field(arguments, count, &stated);
    }
    prefix_of_levels(arguments, count)
}

/// Judges the first `count` samples in the field and the shape of the whole set, and prints the verdict: they are a set of as
/// many samples, as the first dots of a stipple are one with fewer dots.
fn prefix_of_field(arguments: &VerifyArguments, count: usize, stated: &Certificate) -> Result<u8> {
    let (file, set) = (&arguments.file, &arguments.set);
    let name = named(file);
    // Only in the order of arrival are the first samples spread over the whole set.
    ensure!(
        stated.shuffle_seed.is_none(),
        "{name}: the samples were shuffled, so that the first {count} in the file are not the first that arrived"
    );
    let ground = arguments.ground.judged(file, set, Some(stated))?;
    let ground = ground.context("the certificate states neither a field nor a shape")?;
    // As for levels: the certificate's numbers are of all samples, and not of the first ones.
    let points = set.read_as_stated(file)?.set.points;
    ensure!(
        (1..=points.len()).contains(&count),
        "--prefix is {count}; the set has {} samples",
        points.len()
    );

    let options = arguments.judge.options();
    let first = &points[..count];
    let judge = |control: Control<'_>| {
        let judged = &ground.varying.judged;
        judged.verify_prefix(first, &options, control)
    };
    let report = verifying(judge).in_file(file)?;
    // Without a factor the report has the gaps of a whole set, which says nothing about a beginning.
    ensure!(
        report.covering_factor.is_some() || report.conflicts > 0,
        "{name}: the first {count} samples leave places that are farther than {MAX_FACTOR} times the radius from all of them; \
         covering is measured up to that factor, for which about {} samples are needed",
        points.len().div_ceil((MAX_FACTOR * MAX_FACTOR) as usize)
    );
    let radius = output::ground_text(&ground.varying);
    let no_levels = [];
    output::report(
        arguments.json,
        || output::verdict_json(&report),
        || {
            let verdict = output::verdict_text(&report, &no_levels);
            format!(
                "the first {count} of {}, r = {radius}\n\n{verdict}",
                points.len()
            )
        },
    )?;
    Ok(verdict_code(report.valid()))
}

/// Judges the first `count` samples by the levels that the certificate states, and prints the verdict.
fn prefix_of_levels(arguments: &VerifyArguments, count: usize) -> Result<u8> {
    let (file, set) = (&arguments.file, &arguments.set);
    arguments
        .ground
        .refuse("sets with nested levels have one radius and no shape")?;
    // The file is not compared with its certificate, which is about all samples: a fault behind the first `count` says
    // nothing about these. They are judged by the certificate's claim alone.
    let read = set.read_as(file, set.set, CertificateUse::AsStated)?;
    let name = named(file);
    let Some(certificate) = read.certificate else {
        bail!("{name}: there is no certificate, which states the levels of a set");
    };
    // The claim says how far apart these samples are and how far they cover, by the levels that they complete.
    let Some(claim) = certificate.prefix(count) else {
        bail!(
            "{name}: the certificate states no levels, no field and no shape, or fewer than {count} samples"
        );
    };

    let region = set.region_over(certificate.region);
    let options = arguments.judge.options();
    let found =
        verifying(|control| verify_prefix(&read.set.points, region, claim, &options, control));
    let level = CertifiedLevel::of(&found.in_file(file)?);
    output::report(
        arguments.json,
        || json!(level),
        || output::level_row(&level),
    )?;
    Ok(verdict_code(level.valid))
}

/// A verified file.
struct CheckedFile {
    check: Check,
    /// The given origin, or else that of the field and the shape; none where no origin is given and the radius is the same
    /// everywhere in a rectangle.
    origin: Option<[f64; 2]>,
    /// The field and the shape that it was judged in.
    varying: Option<Arc<VaryingDomain>>,
}

/// Reads and verifies a file.
fn checked(arguments: &VerifyArguments) -> Result<CheckedFile> {
    let file = &arguments.file;
    let mut overrides = Overrides {
        judges: arguments.judge.choice(),
        ..arguments.set.overrides(file)?
    };
    let (ground, set) = (&arguments.ground, &arguments.set);
    // Arguments state a field and a shape that no certificate does, and give the images that a certificate names.
    if ground.is_given() {
        ground.judge_in(file, set, &mut overrides)?;
    }

    let judge = |overrides: &_| verifying(|control| check_stream(file, overrides, control));
    // A file of which neither the certificate nor the arguments state a domain is checked in the periodic unit square.
    let mut outcome = check_or_unit_square(&overrides, judge);

    // The certificate is read with the points. Only when it states a field or a shape, which few sets have, is the file
    // read a second time, to be judged in them.
    if let Err(CheckError::NoField) = outcome {
        ground.judge_in(file, set, &mut overrides)?;
        outcome = check_or_unit_square(&overrides, judge);
    }
    match outcome {
        Err(error @ CheckError::NoRadius) => Err(error).context("give --radius").in_file(file),
        outcome => Ok(CheckedFile {
            check: outcome.map_err(hinted).in_file(file)?,
            origin: overrides.origin,
            varying: overrides.varying,
        }),
    }
}

/// Returns where the lower corner of the domain lies in the file, if not at 0 0.
fn origin(given: Option<[f64; 2]>, check: &Check) -> Option<[f64; 2]> {
    let stated = check.certificate.as_ref().and_then(|stated| stated.origin);
    let origin = given.or(stated);
    origin.filter(|&[x, y]| x != 0.0 || y != 0.0)
}

/// Returns the outcome for programs; it has an origin only where that is not 0 0.
fn to_json(check: &Check, origin: Option<[f64; 2]>) -> serde_json::Value {
    let mut object = json!({
        "format": check.detection.format.to_string(),
        "precision": check.precision,
        "region": check.report.region,
        "radius": check.report.radius,
        "certificate": check.certificate.is_some(),
        "levels": check.levels,
        "prefix": check.certificate.as_ref().and_then(|stated| stated.prefix),
        "unchecked": check.certificate.as_ref().map(Certificate::unchecked),
        "differences": check.differences,
        "passed": check.passed(),
    });
    output::add(&mut object, output::verdict_json(&check.report));
    if let Some(origin) = origin {
        object["origin"] = json!(origin);
    }
    object
}

/// Returns the outcome in lines.
fn to_text(found: &CheckedFile, origin: Option<[f64; 2]>) -> String {
    let check = &found.check;
    let mut report = check.report.clone();
    // Gaps are printed at their places in the file, whose domain begins at its origin; the report's begins at zero. The
    // samples of conflicts have numbers, and no place is printed.
    let [x, y] = origin.unwrap_or_default();
    for gap in &mut report.worst_gaps {
        gap.center = [gap.center[0] + x, gap.center[1] + y];
    }

    let verdict = output::verdict_text(&report, &check.levels);
    // A field has no single radius: its least and its greatest stand in the place of one.
    let radius = match &found.varying {
        Some(varying) => output::ground_text(varying),
        None => report.radius.to_string(),
    };
    let at = origin.map_or_else(String::new, |[x, y]| format!(" at {x} {y}"));

    let mut out = format!(
        "{}: {}{at}, r = {radius}\n\n{verdict}",
        check.detection,
        output::region_text(&report.region),
    );

    out += &output::certificate_text(check.certificate.as_ref(), &check.differences);
    out
}
