//! Files with only some of their points: what stands beside a point stays with it, to the byte where rows are copied.

use serde_json::Value;

use super::{Hint, RANK, detected, npy, ply, psa, table, utk};
use crate::error::{FilePlace, FormatError};
use crate::format::Format;
use crate::text::{as_utf8, without_bom};

/// A file with only those of its points that are kept.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct KeptRows {
    /// The bytes of the file.
    pub bytes: Vec<u8>,
    /// What else is left out, in words: the faces of a mesh, for example, whose vertex numbers would now be those of
    /// other vertices.
    pub left_out: Vec<String>,
}

/// Returns a file with only those of its points that are kept, in the same format and order, with all of their columns.
/// `kept` has a flag for each point that [`decode`](super::decode) returns, of the set that the hint chooses.
///
/// Rows are copied as they are, but text in UTF-16 becomes UTF-8, and members of JSON objects are sorted. A certificate inside
/// the file, which is about all points, is left out.
///
/// # Errors
///
/// As [`decode`](super::decode), and [`FormatError::NotChosen`] for formats that cannot keep what belongs to a point.
pub fn keep_rows(bytes: &[u8], hint: &Hint<'_>, kept: &[bool]) -> Result<KeptRows, FormatError> {
    // The same bytes and format as in `decode`, as the flags are those of the points that it returned. Binary files
    // stay as they are.
    let bytes = &*as_utf8(bytes);
    let format = detected(bytes, hint)?.format;
    let mut left_out = Vec::new();
    let file = match format {
        Format::Csv | Format::Xyz => table::keep(bytes, format, hint.columns, kept),
        Format::PsaText => Ok(psa::keep_text(bytes, kept)),
        // A row is two f32.
        Format::PsaRps => Ok(rows(bytes, 8, kept)),
        Format::UtkText => Ok(utk::keep_text(bytes, hint.set, kept)),
        Format::UtkBinary => utk::keep_binary(bytes, hint.set, kept),
        Format::Npy => npy::keep(bytes, kept),
        Format::PlyAscii | Format::PlyBinary => {
            let kept_file;
            (kept_file, left_out) = ply::keep(bytes, format, kept)?;
            Ok(kept_file)
        }
        Format::Json | Format::GeoJson => json(bytes, kept),
        Format::Svg => Err(FormatError::NotChosen {
            format,
            reason: "a circle may have a style that other elements give it; convert the file to csv first",
        }),
    }?;

    Ok(KeptRows {
        bytes: file,
        left_out,
    })
}

/// What the numbers of a column are read for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnUse {
    /// To be ordered by: every finite number.
    Order,
    /// As radii, which are above 0.
    Radius,
}

impl ColumnUse {
    /// Whether a number is of use. NaN and infinities have no place in an order, and are no lengths.
    pub(super) fn accepts(self, value: f64) -> bool {
        value.is_finite() && (self == Self::Order || value > 0.0)
    }

    /// Returns what a number of the column has to be, for messages.
    pub(super) const fn wanted(self) -> &'static str {
        match self {
            Self::Order => "a finite number",
            Self::Radius => "a finite number above 0",
        }
    }
}

/// Returns the numbers of a column, one for each point: of a text table, by its name or its number from 1; a scalar property of
/// PLY vertices; a property of `GeoJSON` points.
///
/// # Errors
///
/// As [`decode`](super::decode), and when there is no such column or one of its values is of no use: the message names its line
/// or its point.
pub fn read_column(
    bytes: &[u8],
    hint: &Hint<'_>,
    name: &str,
    of_use: ColumnUse,
) -> Result<Vec<f64>, FormatError> {
    let bytes = &*as_utf8(bytes);
    let format = detected(bytes, hint)?.format;
    match format {
        Format::Csv | Format::Xyz => table::column(bytes, format, hint.columns, name, of_use),
        Format::PlyAscii | Format::PlyBinary => ply::column(bytes, format, name, of_use),
        Format::Json | Format::GeoJson => json_column(bytes, name, of_use),
        Format::PsaText
        | Format::PsaRps
        | Format::UtkText
        | Format::UtkBinary
        | Format::Npy
        | Format::Svg => Err(FormatError::NotChosen {
            format,
            reason: "points have no column beside their coordinates",
        }),
    }
}

/// Returns the rank of each point, if the file has a column or a property named `rank`, as files of nested levels have.
///
/// # Errors
///
/// As [`read_column`], but there are no ranks in a file without such a column, nor in JSON whose first feature has no number
/// of this name.
pub fn read_ranks(bytes: &[u8], hint: &Hint<'_>) -> Result<Option<Vec<f64>>, FormatError> {
    match read_column(bytes, hint, RANK, ColumnUse::Order) {
        // The header of a table or of PLY names no such column, or the format has no columns. Properties of GeoJSON are
        // looked up feature by feature: if the first one has no number of this name, the file has no ranks. If only a
        // later one lacks it, that is a fault.
        Err(
            FormatError::Header { .. }
            | FormatError::NotChosen { .. }
            | FormatError::Row {
                format: Format::Json,
                place: FilePlace::Point(0),
                ..
            },
        ) => Ok(None),
        found => found.map(Some),
    }
}

/// Returns the rows that are kept, of `width` bytes each.
pub(super) fn rows(data: &[u8], width: usize, kept: &[bool]) -> Vec<u8> {
    let mut out = Vec::new();
    let rows = data.chunks_exact(width).zip(kept);
    for (row, _) in rows.filter(|(_, kept)| **kept) {
        out.extend_from_slice(row);
    }
    out
}

/// Members of this program's documents, and of a geometry of `GeoJSON`.
const POINTS: &str = "points";
const CERTIFICATE: &str = "certificate";
const COORDINATES: &str = "coordinates";

/// Returns a JSON document with the kept points only, and without its certificate. There is a flag for each point; an
/// entry of a list beyond them would stay.
fn json(bytes: &[u8], kept: &[bool]) -> Result<Vec<u8>, FormatError> {
    let mut document: Value = serde_json::from_slice(without_bom(bytes))?;
    let mut flags = kept.iter().copied();

    match &mut document {
        // A bare list of points.
        Value::Array(points) => points.retain(|_| flags.next().unwrap_or(true)),
        Value::Object(members) if members.contains_key(POINTS) => {
            members.remove(CERTIFICATE);
            // A list of as many entries as there are points has one for each of them, as the provenance does.
            let lists = members.values_mut().filter_map(Value::as_array_mut);
            for list in lists.filter(|list| list.len() == kept.len()) {
                let mut flags_of_list = kept.iter();
                list.retain(|_| flags_of_list.next().is_none_or(|kept| *kept));
            }
        }
        // A collection stays, without the features that are left out. Any other document may be a single point, which
        // cannot stay without its position: if no point is left, the document becomes an empty collection.
        object => {
            let is_left = keep_geo(object, &mut flags);
            let is_collection = object.get("features").is_some();
            if !is_left && !is_collection && !kept.is_empty() {
                *object = serde_json::json!({ "type": "FeatureCollection", "features": [] });
            }
        }
    }

    let mut out = serde_json::to_vec(&document)?;
    out.push(b'\n');
    Ok(out)
}

/// Takes the points that are not kept out of an object of `GeoJSON`, in the order in which they are read, and features that
/// then have no point. Returns whether any point is left.
fn keep_geo(object: &mut Value, flags: &mut impl Iterator<Item = bool>) -> bool {
    // Features, geometry and coordinates come in the order in which points are read, which is that of the flags.
    let mut is_left = false;
    if let Some(features) = object.get_mut("features").and_then(Value::as_array_mut) {
        features.retain_mut(|feature| keep_geo(feature, flags));
        is_left |= !features.is_empty();
    }
    if let Some(geometry) = object.get_mut("geometry") {
        is_left |= keep_geo(geometry, flags);
    }
    if let Some(coordinates) = object.get_mut(COORDINATES).and_then(Value::as_array_mut) {
        // Several positions, or the numbers of one.
        if coordinates.first().is_some_and(Value::is_array) {
            coordinates.retain(|_| flags.next().unwrap_or(true));
            is_left |= !coordinates.is_empty();
        } else if !coordinates.is_empty() {
            is_left |= flags.next().unwrap_or(true);
        }
    }
    is_left
}

/// Returns the numbers of a property of `GeoJSON` features, one for each point.
fn json_column(bytes: &[u8], name: &str, of_use: ColumnUse) -> Result<Vec<f64>, FormatError> {
    let document: Value = serde_json::from_slice(without_bom(bytes))?;
    let format = Format::Json;
    let Some(features) = document.get("features").and_then(Value::as_array) else {
        return Err(FormatError::NotChosen {
            format,
            reason: "only the features of a GeoJSON FeatureCollection have properties",
        });
    };

    let mut values = Vec::new();
    for feature in features {
        let place = FilePlace::Point(values.len() as u64);
        // Values of other types than numbers have no order that is the same for everybody.
        let property = &feature["properties"][name];
        let number = property.as_f64().filter(|&value| of_use.accepts(value));
        let value = number.ok_or_else(|| FormatError::Row {
            format,
            place,
            reason: format!(
                "the property {name} is {property}, which is not {}",
                of_use.wanted()
            ),
        })?;
        // All points of a feature have its properties. Coordinates are those of one point, or an array for each of several.
        let coordinates = feature["geometry"][COORDINATES].as_array();
        let points = coordinates.map_or(0, |all| {
            let are_several = all.first().is_some_and(Value::is_array);
            if are_several { all.len() } else { 1 }
        });
        values.extend(std::iter::repeat_n(value, points));
    }
    Ok(values)
}

/// Returns a JSON point set without third coordinates.
pub(super) fn flat(bytes: &[u8]) -> Result<Vec<u8>, FormatError> {
    let mut document: Value = serde_json::from_slice(without_bom(bytes))?;
    // A document that is a bare list is a list of points.
    let is_place = true;
    flatten(&mut document, is_place);
    Ok(serde_json::to_vec(&document)?)
}

/// Cuts positions of three numbers to two. `is_place` says that this value lies among coordinates or points, where
/// lists of numbers are positions.
fn flatten(value: &mut Value, is_place: bool) {
    match value {
        Value::Array(list) => {
            // Positions of two numbers need no cut. Positions of another length are refused when the document is read.
            if is_place && list.len() == 3 && list.iter().all(Value::is_number) {
                list.truncate(2);
            }
            for inner in list {
                flatten(inner, is_place);
            }
        }

        Value::Object(members) => {
            for (name, member) in members {
                // Lists of three numbers elsewhere, as in properties, stay.
                let holds_places = name == POINTS || name == COORDINATES;
                if holds_places || name == "features" || name == "geometry" {
                    flatten(member, holds_places);
                }
            }
        }
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

#[cfg(test)]
mod tests;
