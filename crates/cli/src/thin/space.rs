//! `tilescope thin` of clouds in space: points with x, y and z.

use std::path::Path;

use anyhow::{Context, Result, bail};
use serde_json::json;
use tilescope_analysis::ThinnedReport;
use tilescope_formats::{CertifiedRadius, FormatError, KeptRows, write_certified};
use tilescope_sets::RadiusSource;
use tilescope_sets::thinning::{
    SpaceFile, SpaceRecipe, SpaceThinning, ThinFileError, ThinRadius, ThinRecipe,
};

use crate::ground::file_name;
use crate::interrupt;
use crate::paths::InFile;
use crate::progress::{verifying, watched};
use crate::solid::{box_text, refuse};

use super::{Described, Laps, SET, ThinArguments, ThinnedFile, Written};

/// Why some options have no meaning for points in space.
const WHOSE: &str =
    "the points lie in space, and it is for those of a plane; --xy thins by x and y alone";

/// Reads points in space from the bytes of a file in which no points of a plane were found, as `planar` says. Fails with that
/// error where the file is no set in space either.
pub(super) fn read<'a>(
    bytes: &'a [u8],
    arguments: &'a ThinArguments,
    name: &'a str,
    planar: ThinFileError,
) -> Result<SpaceFile<'a>> {
    // --columns names the columns of x and y alone, and --xy asks for the plane: with either option, the points are not
    // read as points in space.
    if arguments.xy || arguments.columns.is_some() {
        return Err(planar.into());
    }
    match SpaceFile::new(bytes, arguments.hint(name)) {
        Ok(file) => Ok(file),
        // The points have a third coordinate that is not 0. So the user needs to know why they cannot be read as points
        // in space. That they do not lie in a plane would be no news.
        Err(error) if matches!(planar, ThinFileError::Format(FormatError::NotPlanar { .. })) => {
            Err(anyhow::Error::from(error)
                .context("--xy thins a cloud in space by its x and y, and keeps z with each point"))
        }
        Err(_) => Err(planar.into()),
    }
}

/// Thins a file of points in space, has the choice judged, and writes it whatever the verdict, which the certificate states.
pub(super) fn make(
    arguments: &ThinArguments,
    recipe: &ThinRecipe,
    file: &SpaceFile<'_>,
    mut laps: Laps,
) -> Result<ThinnedFile> {
    // `ThinArguments::domain` has refused --boundary and --origin without a side.
    refuse(
        &[
            ("--width", arguments.width.is_some()),
            ("--height", arguments.height.is_some()),
            ("--planar", arguments.planar),
        ],
        WHOSE,
    )?;
    let ThinRadius::Source(RadiusSource::Constant(radius)) = recipe.radius else {
        bail!(
            "the points lie in space, where one radius is that of all: give --radius R alone; --xy thins by x and y alone"
        );
    };
    // The name is checked now, so that the command does not fail only after the work.
    if let Some(path) = &arguments.out {
        file.check_name(&file_name(path)).in_file(path)?;
    }

    let recipe = SpaceRecipe {
        radius,
        priority: recipe.priority.clone(),
    };
    // Without a stated region the box around the points is taken. A choice needs the ranks: they are the order in which
    // points are taken.
    let (no_region, with_ranks) = (None, true);
    let mut thinning = recipe
        .prepare(file, no_region, with_ranks)
        .in_file(&arguments.input)?;
    thinning.state("file", file.hint.name.into());
    if let Some(set) = arguments.set {
        thinning.state(SET, set.into());
    }
    laps.add("read");

    let points = file.points();
    let kept =
        watched("thin", |control| thinning.choose(points, control)).in_file(&arguments.input)?;
    laps.add("thin");

    let report = verifying(|control| thinning.judge(points, &kept, control))
        .context("the thinned set has no verdict")?;
    laps.add("verify");

    let mut written = None;
    if let Some(path) = &arguments.out {
        interrupt::check("the file was written")?;
        written = Some(write(file, &thinning, &kept, &report, path)?);
        laps.add("write");
    }
    Ok(ThinnedFile {
        described: Described {
            radius: CertifiedRadius::Constant(radius),
            region: json!(thinning.region),
            // Nothing depends on where the box of the points lies.
            origin: json!(null),
            domain: Some(box_text(&thinning.region)),
            priority: thinning.priority().to_string(),
        },
        report,
        written,
        laps,
    })
}

/// Writes the kept points and their certificate.
fn write(
    file: &SpaceFile<'_>,
    thinning: &SpaceThinning,
    kept: &[bool],
    report: &ThinnedReport,
    path: &Path,
) -> Result<Written> {
    let (name, mut rows) = (file_name(path), KeptRows::default());
    // Only points that are read back from the new bytes are certified.
    let chosen = file.keep(kept, &mut rows, &name).in_file(path)?;
    let certificate = thinning.certificate(file.points(), &chosen, report);
    let certificate_path = write_certified(path, chosen.bytes, &certificate).in_file(path)?;
    // `chosen` borrows `rows`, whose list of left-out elements is moved out below.
    drop(chosen);
    Ok(Written {
        certificate,
        certificate_path,
        left_out: rows.left_out,
    })
}
