//! Reads a point set from the bytes of a file and of its certificate. Opens no file and verifies nothing.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use crate::certificate::{CERTIFICATE_SUFFIX, Certificate};
use crate::codecs::{Hint, ReadSet, decode};
use crate::error::FormatError;
use crate::mapping::Mapping;

/// The name of the certificate of the data file `path`.
///
/// ```
/// use tilescope_formats::certificate_path;
/// let path = certificate_path("out/set.csv".as_ref());
/// assert_eq!(path, std::path::Path::new("out/set.csv.certificate.json"));
/// ```
#[must_use]
pub fn certificate_path(path: &Path) -> PathBuf {
    with_suffix(path, CERTIFICATE_SUFFIX)
}

pub(crate) fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(suffix);
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
    let mut read = decode(bytes, hint)?;
    if let Some((name, bytes)) = certificate {
        read.certificate = Some(Certificate::from_bytes(bytes, name)?);
    }
    let region = read.certificate.as_ref().map(|stated| stated.region);
    let mapping = Mapping::new(read.detection.format, region, read.precision);
    for point in &mut read.set.points {
        *point = mapping.domain_from_file(*point);
    }
    Ok(read)
}
