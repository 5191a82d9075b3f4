//! Reads a point set from the bytes of a file and of its certificate. Opens no file and judges no set, but compares a
//! certificate with the file.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use crate::certificate::{CERTIFICATE_SUFFIX, Certificate};
use crate::check::{Contents, contradictions};
use crate::codecs::{CertificateUse, Hint, ReadSet, decode, refuse_degrees};
use crate::digest::{bytes_digest, positions_digest};
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

/// The point set in the bytes of a file. `certificate` has the name and the bytes of the certificate beside it, which
/// takes precedence over one inside; [`Hint::certificate`] says how it is used.
///
/// By default the returned certificate is that of these bytes: its digests, its count and the numbers that follow from
/// others are compared. Only [`check_bytes`](crate::check_bytes) decides whether the set is as valid as it states.
///
/// # Errors
///
/// [`FormatError`] when the bytes, or those of the certificate, are unreadable; [`FormatError::FalseCertificate`] when
/// the certificate is not that of the bytes.
pub fn read_bytes(
    bytes: &[u8],
    hint: &Hint<'_>,
    certificate: Option<(&str, &[u8])>,
) -> Result<ReadSet, FormatError> {
    let used = certificate.filter(|_| hint.certificate != CertificateUse::LeftOut);
    let beside = match used {
        Some((name, bytes)) => Some((name, Certificate::from_bytes(bytes, name)?)),
        None => None,
    };
    // Points in space would fail to decode, with a reason that does not name the third side.
    if let Some((name, stated)) = &beside {
        stated.refuse_depth(name)?;
    }

    let mut read = decode(bytes, hint)?;
    // A certificate beside the file replaces one inside.
    let mut name = "inside the file";
    if let Some((name_beside, stated)) = beside {
        read.certificate = Some(stated);
        name = name_beside;
    }

    if hint.certificate == CertificateUse::Checked
        && let Some(stated) = &read.certificate
    {
        // A caller that uses one radius only would be wrong about a set whose radius varies.
        if !hint.varying {
            stated.refuse_varying(name)?;
        }
        // A certificate inside the file was not looked at above.
        stated.refuse_depth(name)?;

        let found = Contents {
            format: read.detection.format,
            precision: read.precision,
            digest: stated.digest.as_ref().map(|_| bytes_digest(bytes)),
            positions_digest: positions_digest(&read.set.points),
            count: read.set.len() as u64,
        };
        if let Some(first) = contradictions(stated, &found).into_iter().next() {
            return Err(FormatError::FalseCertificate {
                name: name.to_owned(),
                difference: first.to_string(),
            });
        }
    }

    let stated = read.certificate.as_ref();
    let region = stated.map(|stated| stated.region);
    let origin = (hint.origin)
        .or(stated.and_then(|stated| stated.origin))
        .unwrap_or_default();
    // Positions may be degrees if they do not lie in the domain, so that without a domain nothing can be said.
    if let Some(region) = region {
        refuse_degrees(&read, region, origin)?;
    }

    let mapping = Mapping::new(read.detection.format, region, read.precision).with_origin(origin);
    for point in &mut read.set.points {
        *point = mapping.domain_from_file(*point);
    }
    Ok(read)
}

#[cfg(test)]
mod tests;
