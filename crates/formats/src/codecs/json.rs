//! JSON: an object with `certificate`, `points`, when known, `provenance`, and, where it varies, the `radius` of each point.
//!
//! Also reads a bare array of `[x, y]` pairs, and the points of `GeoJSON`; skips all other fields. No bit is lost:
//! shortest decimals are written and read with correct rounding.

use std::fmt::{self, Debug};

use serde::de::{DeserializeOwned, Error, IgnoredAny, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::{CertificateUse, Raw, geojson, kept};
use crate::certificate::Certificate;
use crate::error::FormatError;
use crate::format::Precision;
use crate::indented::indented;
use crate::point_set::{PointSet, Provenance};
use crate::text::{push, without_bom};

/// The fields read, the certificate as a `C`.
#[derive(Deserialize)]
struct Document<C> {
    points: Vec<Position>,
    #[serde(default)]
    provenance: Option<Vec<Provenance>>,
    #[serde(default = "Option::default")]
    certificate: Option<C>,
}

/// Reads the points of a document and, unless it is left out, its certificate. With `any_z` a point may have any
/// third coordinate, which is cut off first.
pub(super) fn read(
    bytes: &[u8],
    certificate: CertificateUse,
    any_z: bool,
) -> Result<Raw, FormatError> {
    // A page never asks for this. The condition keeps the code for it out of the page's program.
    if any_z && !cfg!(target_arch = "wasm32") {
        let flat = kept::flat(bytes)?;
        let any_z = false;
        return read(&flat, certificate, any_z);
    }
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
        match serde_json::from_slice(bytes) {
            Ok(document) => document,
            // Only JSON that is no document of this program is tried as GeoJSON, so that a document is parsed once.
            Err(_) if geojson::is(bytes) => return Ok((geojson::read(bytes)?, None)),
            Err(error) => return Err(error.into()),
        }
    };

    let mut raw = Raw::new(Vec::new(), Precision::Double);
    raw.set = PointSet {
        points: positions(document.points),
        provenance: document.provenance,
    };
    Ok((raw, document.certificate))
}

/// A position of two numbers, or of three with z = 0.
pub(super) struct Position(pub [f64; 2]);

pub(super) fn positions(positions: Vec<Position>) -> Vec<[f64; 2]> {
    positions.into_iter().map(|Position(point)| point).collect()
}

impl<'de> Deserialize<'de> for Position {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(PositionVisitor)
    }
}

pub(super) struct PositionVisitor;

impl<'de> Visitor<'de> for PositionVisitor {
    type Value = Position;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("2 numbers, or 3 with z = 0")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut numbers: A) -> Result<Position, A::Error> {
        let mut point = [0.0; 2];
        for (found, value) in point.iter_mut().enumerate() {
            let next = numbers.next_element()?;
            *value = next.ok_or_else(|| A::Error::invalid_length(found, &self))?;
        }

        let z = numbers.next_element::<f64>()?;
        if let Some(z) = z.filter(|z| *z != 0.0) {
            let reason = format_args!("z is {z}, and only planar sets (z = 0) are read");
            return Err(A::Error::custom(reason));
        }
        // A fourth number may mean anything, so that the position is refused.
        if numbers.next_element::<IgnoredAny>()?.is_some() {
            return Err(A::Error::invalid_length(4, &self));
        }
        Ok(Position(point))
    }
}

/// Writes a document: the certificate, the points, the provenance and the radii, of which there are none where all points have
/// the same.
pub(super) fn write(
    points: &[[f64; 2]],
    provenance: Option<&[Provenance]>,
    radii: &[f64],
    certificate: Option<&Certificate>,
) -> Result<Vec<u8>, FormatError> {
    // Room for the points: a row of numbers below 1 with 17 digits after the point has 44 bytes. Longer numbers, the
    // certificate and the provenance may make the buffer grow.
    let mut out = Vec::with_capacity(points.len() * 44);

    out.extend_from_slice(b"{\n");
    if let Some(certificate) = certificate {
        out.extend_from_slice(b"\"certificate\": ");
        out.extend(indented(certificate)?);
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

    if !radii.is_empty() {
        out.extend_from_slice(b"],\n\"radius\": [\n");
        push_rows(&mut out, radii);
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
        super::read(bytes, CertificateUse::Checked, false)
    }

    #[test]
    fn a_bare_array_and_unknown_fields_are_read() {
        let bare = read(b"\xEF\xBB\xBF [[0.5, 1], [2e-1, 0]]\r\n").expect("an array");
        assert_eq!(bare.set.points, [[0.5, 1.0], [0.2, 0.0]]);
        let wide = read(br#"{"note": {"a": [1]}, "points": [[0, 0]]}"#).expect("an object");
        assert_eq!(wide.set.points, [[0.0, 0.0]]);
        let flat = read(b"[[0.5, 1, 0], [0.25, 0, -0.0]]").expect("z = 0");
        assert_eq!(flat.set.points, [[0.5, 1.0], [0.25, 0.0]]);
    }

    #[test]
    fn only_planar_positions_are_read() {
        let message = |text: &str| read(text.as_bytes()).err().expect(text).to_string();
        let solid = message("{\"points\": [[1, 2, 0],\n[1, 2, 0.6]]}");
        let refusal = "JSON: z is 0.6, and only planar sets (z = 0) are read at line 2 column 11";
        assert_eq!(solid, refusal);
        assert!(message("[[1, 2, 0, 0]]").contains("2 numbers, or 3 with z = 0"));
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
