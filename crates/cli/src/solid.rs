//! Sets in space: balls in a box, by the commands that make, verify, convert and draw sets. Options of planar sets are refused by
//! name.
//!
//! [`make`] has `tilescope sample`, [`window`] its windows, [`check`] `verify` and `convert`, [`plane`] the disks in which a plane
//! meets the balls, [`orbit`] the picture of all balls.

pub mod check;
pub mod make;
pub mod orbit;
pub mod plane;
mod verdict;
pub mod window;

use std::path::Path;

use anyhow::{Result, bail, ensure};
use tilescope_analysis::{JudgeChoice, Region, SolidError};
use tilescope_formats::{CheckError, FormatError, Overrides, solid_certificate};

use crate::options::{JudgeArguments, SetArguments, WITHOUT_CERTIFICATE};

pub use plane::Slice;
pub use verdict::box_text;

/// Why options of planar sets are refused.
pub const PLANAR: &str = "it is for planar sets, and this one has a third side";

/// Refuses the first of some options that is given, as `whose` has no use for it.
pub fn refuse(options: &[(&str, bool)], whose: &str) -> Result<()> {
    match options.iter().find(|(_, is_given)| *is_given) {
        Some((name, _)) => bail!("{name}: {whose}; leave {name} out"),
        None => Ok(()),
    }
}

/// Refuses the judge of planar sets, before anything is made or read.
pub fn check_judge(judge: &JudgeArguments) -> Result<()> {
    match judge.choice() {
        JudgeChoice::Delaunay => Err(SolidError::WrongJudge.into()),
        JudgeChoice::Automatic
        | JudgeChoice::Circles
        | JudgeChoice::Both
        | JudgeChoice::Subdivision => Ok(()),
    }
}

/// Whether a file is to be read as a set in space: if its certificate has a third side, or if one is given.
pub fn is_in_space(set: &SetArguments, file: &Path) -> bool {
    set.depth.is_some() || (!set.no_certificate && solid_certificate(file).is_some())
}

/// Returns the values that override the certificate of a set in space, but for the depth, which readers of such sets
/// take beside them. Without the certificate of a set in space, a width and a height that are not given are 1, and a
/// box without a given boundary is periodic.
fn overrides(set: &SetArguments, file: &Path) -> Result<Overrides> {
    // No image has radii in space.
    let has_image = false;
    set.refuse_two_radii(has_image)?;
    refuse(
        &[
            ("--columns", set.columns.is_some()),
            ("--planar", set.planar),
        ],
        PLANAR,
    )?;

    // A width, a height or a boundary that is not given is that of the certificate, if it is of a set in space.
    let stated = solid_certificate(file).filter(|_| !set.no_certificate);
    // Certificates of sets in space state no origin: positions begin at 0. Only those of thinned ones lie anywhere.
    ensure!(
        set.origin.is_none()
            || stated
                .as_ref()
                .is_none_or(|stated| stated.thinned.is_some()),
        "--origin: its certificate states a box that begins at 0; leave --origin out, or give --no-certificate"
    );
    let is_given = set.width.is_some() || set.height.is_some() || set.boundary.is_some();
    let of_stated = stated.map(|stated| stated.region);
    let region = || set.region_over(of_stated.unwrap_or(Region::UNIT_SQUARE));
    // Without a region here, the check takes that of the certificate.
    Ok(Overrides {
        format: set.format,
        set: set.set,
        region: (is_given || of_stated.is_none()).then(region),
        radius: set.least_radius(),
        origin: set.origin(),
        origin_z: set.origin_z,
        without_certificate: set.no_certificate,
        ..Overrides::default()
    })
}

/// Adds to the error of a check the options that help.
fn hinted(error: CheckError) -> anyhow::Error {
    // Messages of the crates below name values, and here the options that set them are added. A context is printed
    // before its error: "give --radius: there is no certificate".
    match error {
        CheckError::Solid(SolidError::OutOfRegion { .. }) | CheckError::BeyondBox { .. } => {
            anyhow::anyhow!(
                "{error}; --width, --height, --depth, --boundary, --origin and --origin-z state another domain"
            )
        }
        CheckError::NoRadius => anyhow::Error::from(error).context("give --radius"),
        CheckError::NoDepth => anyhow::Error::from(error).context("give --depth"),
        CheckError::Format(
            error @ (FormatError::FalseCertificate { .. } | FormatError::Certificate { .. }),
        ) => anyhow::anyhow!("{error}; {WITHOUT_CERTIFICATE}"),
        other => other.into(),
    }
}
