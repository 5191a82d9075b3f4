//! Reads a point set from the bytes of a file and of its certificate. Opens no file and verifies nothing.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use crate::certificate::{CERTIFICATE_SUFFIX, Certificate};
use crate::codecs::{Hint, decode};
use crate::detect::Detection;
use crate::error::FormatError;
use crate::format::Precision;
use crate::mapping::Mapping;
use crate::point_set::PointSet;

/// A point set read from a file.
#[derive(Clone, Debug)]
pub struct ReadSet {
    /// The points: in domain units with a certificate, otherwise as the file has them.
    pub set: PointSet,
    /// The format and how it was recognised.
    pub detection: Detection,
    /// Number type of the file's coordinates.
    pub precision: Precision,
    /// How many sets the file holds.
    pub sets: usize,
    /// The certificate beside or inside the file. [`check_bytes`](crate::check_bytes) says whether it is true.
    pub certificate: Option<Certificate>,
}

/// The name of the certificate of the data file `path`.
///
/// ```
/// use tilescope_formats::certificate_path;
/// let path = certificate_path("out/set.csv".as_ref());
/// assert_eq!(path, std::path::Path::new("out/set.csv.certificate.json"));
/// ```
#[must_use]
pub fn certificate_path(path: &Path) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(CERTIFICATE_SUFFIX);
    name.into()
}

/// The point set in the bytes of a file. `certificate` has the name and the bytes of the certificate beside it.
///
/// # Errors
///
/// [`FormatError`] when the bytes, or those of the certificate, are unreadable.
pub fn read_bytes(
    bytes: &[u8],
    hint: &Hint<'_>,
    certificate: Option<(&str, &[u8])>,
) -> Result<ReadSet, FormatError> {
    let decoded = decode(bytes, hint)?;
    let certificate = match certificate {
        Some((name, bytes)) => Some(Certificate::from_bytes(bytes, name)?),
        None => decoded.certificate,
    };
    let mut set = decoded.set;
    let region = certificate.as_ref().map(|stated| stated.region);
    let mapping = Mapping::new(decoded.detection.format, region, decoded.precision);
    for point in &mut set.points {
        *point = mapping.domain_from_file(*point);
    }
    Ok(ReadSet {
        set,
        detection: decoded.detection,
        precision: decoded.precision,
        sets: decoded.sets,
        certificate,
    })
}
