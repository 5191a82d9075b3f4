//! Sets in space on disk: what `files` does for planar sets, by the same temporary files.

use std::path::Path;

use tilescope_analysis::Control;

use crate::certificate::Certificate;
use crate::check::{CheckError, Overrides};
use crate::error::FormatError;
use crate::export::{ExportError, Warning};
use crate::files::{file_name, read_certificate, read_whole, stored_at, write_whole};

use super::check::{SolidCheck, SolidSet, check_owned, read_solid_bytes};
use super::export::{SolidBytes, SolidContext, SolidExported, export_through, unverified_bytes};

/// Writes points in space (in domain units) to the file `path` and a certificate beside it, as [`export`](crate::export) does
/// planar sets.
///
/// # Errors
///
/// As [`export`](crate::export), and when the format cannot hold sets in space.
pub fn export_solid(
    path: &Path,
    points: &[[f64; 3]],
    context: &SolidContext,
    control: Control<'_>,
) -> Result<SolidExported, ExportError> {
    // The set goes to the disk through `store`, and the certificate as the bytes that the closure returns first.
    let (exported, certificate_path) = stored_at(path, |store, name| {
        let exported = export_through(store, name, points, context, control)?;
        Ok((exported.certificate_bytes.clone(), exported))
    })?;

    let SolidBytes {
        certificate,
        verdict,
        warnings,
        ..
    } = exported;
    Ok(SolidExported {
        certificate_path,
        certificate,
        verdict,
        warnings,
    })
}

/// Writes points in space (in domain units) to the file `path` without verifying them, as
/// [`export_unverified`](crate::export_unverified) does planar sets. Returns a note if the format leaves columns out.
///
/// # Errors
///
/// As [`export_unverified`](crate::export_unverified), and when the format cannot hold sets in space.
pub fn export_solid_unverified(
    path: &Path,
    points: &[[f64; 3]],
    context: &SolidContext,
) -> Result<Option<Warning>, FormatError> {
    let (bytes, left_out) = unverified_bytes(&file_name(path)?, points, context)?;
    write_whole(path, &bytes)?;
    Ok(left_out)
}

/// Re-verifies the file `path` with a set in space, as [`check_solid_bytes`] does. The overrides are those of planar
/// sets and have no third side, so that `depth` gives it. Without `depth` the certificate's third side is used. Returns
/// the points with the check.
///
/// # Errors
///
/// As [`check_solid_bytes`], and when a file cannot be read.
pub fn check_solid(
    path: &Path,
    overrides: &Overrides,
    depth: Option<f64>,
    control: Control<'_>,
) -> Result<(Vec<[f64; 3]>, SolidCheck), CheckError> {
    let data = read_whole(path)?;
    let certificate = if overrides.without_certificate {
        None
    } else {
        read_certificate(path)?
    };
    let (name, beside) = (file_name(path)?, certificate.as_deref());
    check_owned(data, &name, beside, overrides, depth, control)
}

/// The set in space in the file `path`, with its certificate compared with the file as [`read`](crate::read) compares that of a
/// planar set. `depth` is as in [`check_solid`].
///
/// # Errors
///
/// As [`check_solid`], except those of judges; and [`FormatError::FalseCertificate`].
pub fn read_solid(
    path: &Path,
    overrides: &Overrides,
    depth: Option<f64>,
) -> Result<SolidSet, CheckError> {
    let data = read_whole(path)?;
    let certificate = if overrides.without_certificate {
        None
    } else {
        read_certificate(path)?
    };
    read_solid_bytes(
        &data,
        &file_name(path)?,
        certificate.as_deref(),
        overrides,
        depth,
    )
}

/// Returns the certificate beside `path` if it states a third side. Whether it is true is left to a check. Nothing if
/// there is no certificate, none that can be read, or that of a planar set.
#[must_use]
pub fn solid_certificate(path: &Path) -> Option<Certificate> {
    let bytes = read_certificate(path).ok().flatten()?;
    let stated = Certificate::from_bytes(&bytes, "").ok()?;
    Some(stated).filter(|stated| stated.depth.is_some())
}
