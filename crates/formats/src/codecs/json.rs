//! JSON: an object with `certificate`, `points` and, when known, `provenance`.
//!
//! Also reads a bare array of `[x, y]` pairs and skips fields it does not know. No bit is lost: shortest
//! decimals are written and read with correct rounding.

use std::fmt::Debug;

use serde::Deserialize;
use serde::de::{DeserializeOwned, IgnoredAny};

use super::{CertificateUse, Raw};
use crate::certificate::Certificate;
use crate::error::FormatError;
use crate::format::Precision;
use crate::point_set::{PointSet, Provenance};
use crate::text::{push, without_bom};

/// The fields read, the certificate as a `C`.
#[derive(Deserialize)]
struct Document<C> {
    points: Vec<[f64; 2]>,
    #[serde(default)]
    provenance: Option<Vec<Provenance>>,
    #[serde(default = "Option::default")]
    certificate: Option<C>,
}

pub(super) fn read(bytes: &[u8], certificate: CertificateUse) -> Result<Raw, FormatError> {
    // A certificate that is left out need not be readable.
    if certificate == CertificateUse::LeftOut {
        return Ok(document::<IgnoredAny>(bytes)?.0);
    }

    let (mut raw, certificate) = document::<Certificate>(bytes)?;
    if let Some(certificate) = &certificate {
        certificate.check_version("inside the file")?;
    }
    raw.certificate = certificate;
    Ok(raw)
}

/// Returns the set in a document, and its certificate.
fn document<C: DeserializeOwned>(bytes: &[u8]) -> Result<(Raw, Option<C>), FormatError> {
    let bytes = without_bom(bytes);
    let bare = bytes.trim_ascii_start().first() == Some(&b'[');
    let document = if bare {
        Document {
            points: serde_json::from_slice(bytes)?,
            provenance: None,
            certificate: None,
        }
    } else {
        serde_json::from_slice(bytes)?
    };
    let mut raw = Raw::new(Vec::new(), Precision::Double);
    raw.set = PointSet {
        points: document.points,
        provenance: document.provenance,
    };
    Ok((raw, document.certificate))
}

pub(super) fn write(
    points: &[[f64; 2]],
    provenance: Option<&[Provenance]>,
    certificate: Option<&Certificate>,
) -> Result<Vec<u8>, FormatError> {
    let mut out = Vec::with_capacity(points.len() * 44);
    out.extend_from_slice(b"{\n");
    if let Some(certificate) = certificate {
        out.extend_from_slice(b"\"certificate\": ");
        serde_json::to_writer_pretty(&mut out, certificate)?;
        out.extend_from_slice(b",\n");
    }
    out.extend_from_slice(b"\"points\": [\n");
    push_rows(&mut out, points);
    if let Some(provenance) = provenance {
        out.extend_from_slice(b"],\n\"provenance\": [\n");
        push_rows(
            &mut out,
            provenance.iter().map(|&from| <[u32; 3]>::from(from)),
        );
    }
    out.extend_from_slice(b"]\n}\n");
    Ok(out)
}

/// Appends arrays, one on a line. {:?} is as short as {} and spells 1e300 with an exponent.
fn push_rows(out: &mut Vec<u8>, rows: impl IntoIterator<Item: Debug>) {
    for (index, row) in rows.into_iter().enumerate() {
        let before = if index == 0 { "" } else { ",\n" };
        push(out, format_args!("{before}{row:?}"));
    }
    out.push(b'\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<Raw, FormatError> {
        super::read(bytes, CertificateUse::Checked)
    }

    #[test]
    fn a_bare_array_and_unknown_fields_are_read() {
        let bare = read(b"\xEF\xBB\xBF [[0.5, 1], [2e-1, 0]]\r\n").expect("an array");
        assert_eq!(bare.set.points, [[0.5, 1.0], [0.2, 0.0]]);
        let wide = read(br#"{"note": {"a": [1]}, "points": [[0, 0]]}"#).expect("an object");
        assert_eq!(wide.set.points, [[0.0, 0.0]]);
    }

    #[test]
    fn faults_carry_line_and_column() {
        for text in [
            &b"{\"points\": [[0.5, 0.5]"[..],
            b"{\"points\": [[0.5]]}",
            b"{\"points\": [[0.5, NaN]]}",
            b"{\"points\": [[0.5, 1e999]]}",
            b"{\"points\": [[1, 2, 3]]}",
            b"{}",
            b"[[0, 0]] x",
        ] {
            let error = read(text).err().expect("refused").to_string();
            assert!(error.contains(" at line 1 column "), "{error}");
        }
    }

    #[test]
    fn deep_nesting_is_refused_without_harm() {
        let text = [b"{\"a\": ".to_vec(), vec![b'['; 200_000]].concat();
        assert!(read(&text).is_err());
    }
}
