//! `GeoJSON` (RFC 7946): the points of a `FeatureCollection`, a `Feature`, a `Point` or a `MultiPoint`, taken as planar. A
//! `FeatureCollection` of points is written.
//!
//! RFC 7946 has longitudes and latitudes alone, unless all who use a file have agreed on another system, and it has no
//! place to state one. Positions are written as they are. Other geometries are refused by name. Whether positions are
//! rather longitudes and latitudes shows only beside a domain: see [`ReadSet::degrees`](super::ReadSet).

use std::fmt;

use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::json::{Position, PositionVisitor};
use super::radii::RADIUS;
use super::{Columns, RANK, Raw};
use crate::error::{FilePlace, FormatError};
use crate::format::{Format, Precision};
use crate::text::push;

const FORMAT: Format = Format::GeoJson;

/// Every type of object that RFC 7946 has.
const TYPES: [&str; 9] = [
    "FeatureCollection",
    "Feature",
    "Point",
    "MultiPoint",
    "LineString",
    "MultiLineString",
    "Polygon",
    "MultiPolygon",
    "GeometryCollection",
];

/// The types of an object and of those in it, without coordinates.
#[derive(Deserialize)]
struct Outline {
    #[serde(rename = "type")]
    kind: String,
    #[serde(default)]
    geometry: Option<Box<Outline>>,
    #[serde(default)]
    features: Vec<Outline>,
}

/// The coordinates of an object and of those in it.
#[derive(Deserialize)]
struct Content {
    #[serde(default)]
    coordinates: Vec<GeoCoordinate>,
    #[serde(default)]
    geometry: Option<Box<Content>>,
    #[serde(default)]
    features: Vec<Content>,
}

/// An element of coordinates: a number of a point's position, or a position of several points.
enum GeoCoordinate {
    Number(f64),
    Position(Position),
}

/// Whether JSON is an object of `GeoJSON`.
pub(super) fn is(bytes: &[u8]) -> bool {
    /// The type alone, which stands beside anything.
    #[derive(Deserialize)]
    struct Head {
        #[serde(rename = "type")]
        kind: String,
    }

    let head = serde_json::from_slice::<Head>(bytes);
    head.is_ok_and(|Head { kind }| TYPES.contains(&kind.as_str()))
}

/// Reads the points of a `GeoJSON` document.
pub(super) fn read(bytes: &[u8]) -> Result<Raw, FormatError> {
    // Types come first, since the coordinates of other geometries have another form.
    let outline: Outline = serde_json::from_slice(bytes)?;
    refuse_others(&outline)?;

    let content: Content = serde_json::from_slice(bytes)?;
    let mut points = Vec::new();
    add(&content, &mut points)?;

    // Small planar sets look like degrees, too. This is decided later, when the domain is known.
    let degrees = may_be_degrees(&points);
    let mut raw = Raw::new(points, Precision::Double);
    raw.degrees = degrees;
    Ok(raw)
}

/// Returns whether positions may be longitudes, from -180 to 180 degrees, and latitudes, from -90 to 90.
#[must_use]
pub fn may_be_degrees<'a>(positions: impl IntoIterator<Item = &'a [f64; 2]>) -> bool {
    let mut positions = positions.into_iter();
    positions.all(|[x, y]| x.abs() <= 180.0 && y.abs() <= 90.0)
}

fn refuse_others(outline: &Outline) -> Result<(), FormatError> {
    match outline.kind.as_str() {
        "FeatureCollection" => {
            let mut features = outline.features.iter().enumerate();
            features.try_for_each(|(index, feature)| {
                refuse_feature(feature, &format!(" (feature {index})"))
            })
        }
        "Feature" => refuse_feature(outline, ""),
        _ => refuse_geometry(outline, ""),
    }
}

/// `place` follows the name of the refused object.
fn refuse_feature(feature: &Outline, place: &str) -> Result<(), FormatError> {
    if feature.kind != "Feature" {
        return Err(unsupported(&feature.kind, place));
    }
    match &feature.geometry {
        Some(geometry) => refuse_geometry(geometry, place),
        None => Err(unsupported("without a geometry", place)),
    }
}

fn refuse_geometry(geometry: &Outline, place: &str) -> Result<(), FormatError> {
    match geometry.kind.as_str() {
        "Point" | "MultiPoint" => Ok(()),
        other => Err(unsupported(other, place)),
    }
}

fn unsupported(kind: &str, place: &str) -> FormatError {
    // The type may be any text of the file, and a message is to stay one: 40 characters are more than any type has.
    let kind: String = kind.chars().take(40).flat_map(char::escape_debug).collect();
    FormatError::Unsupported {
        format: FORMAT,
        what: format!("{kind}{place}"),
        supported: "Point and MultiPoint can, alone and as features",
    }
}

/// Adds the points of an object, in the order of the file: those of its features (of a collection), of its geometry (of
/// a feature), and its own (of a geometry).
fn add(content: &Content, points: &mut Vec<[f64; 2]>) -> Result<(), FormatError> {
    for feature in &content.features {
        add(feature, points)?;
    }
    if let Some(geometry) = &content.geometry {
        add(geometry, points)?;
    }

    let place = FilePlace::Point(points.len() as u64);
    let malformed = |reason: &str| FormatError::Malformed {
        format: FORMAT,
        place,
        reason: reason.to_owned(),
    };

    let mut numbers = Vec::new();
    for element in &content.coordinates {
        match element {
            GeoCoordinate::Number(value) => numbers.push(*value),
            GeoCoordinate::Position(Position(point)) => points.push(*point),
        }
    }

    // Numbers alone are a point's position, positions alone are those of several points; mixed, they are neither.
    match (&numbers[..], content.coordinates.len() == numbers.len()) {
        // All elements were positions, and were added above, or there are none.
        ([], _) => {}
        (&[x, y], true) => points.push([x, y]),
        (&[x, y, z], true) => {
            super::xyz::planar(z, FORMAT, place)?;
            points.push([x, y]);
        }
        _ => {
            return Err(malformed("coordinates are 2 numbers, or 3 with z = 0"));
        }
    }
    Ok(())
}

/// Writes points as features. Numbers are written by `{:?}`, which is as short as `{}` but writes 1e300 with an
/// exponent.
pub(super) fn write(points: &[[f64; 2]], columns: &Columns) -> Vec<u8> {
    let mut out = b"{\"type\": \"FeatureCollection\", \"features\": [\n".to_vec();
    for (index, point) in points.iter().enumerate() {
        let before = if index == 0 { "" } else { ",\n" };
        let geometry = format_args!("{{\"type\": \"Point\", \"coordinates\": {point:?}}}");
        push(
            &mut out,
            format_args!(
                "{before}{{\"type\": \"Feature\", \"geometry\": {geometry}, \"properties\": {{"
            ),
        );

        let mut comma = "";
        if let Some(level) = columns.levels.get(index) {
            push(&mut out, format_args!("\"level\": {level}"));
            comma = ", ";
        }
        let (rank, radius) = (columns.ranks.get(index), columns.radii.get(index));
        for (name, value) in [(RANK, rank), (RADIUS, radius)] {
            if let Some(value) = value {
                push(&mut out, format_args!("{comma}\"{name}\": {value:?}"));
                comma = ", ";
            }
        }
        out.extend_from_slice(b"}}");
    }
    out.extend_from_slice(b"\n]}\n");
    out
}

impl<'de> Deserialize<'de> for GeoCoordinate {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(GeoCoordinateVisitor)
    }
}

struct GeoCoordinateVisitor;

impl<'de> Visitor<'de> for GeoCoordinateVisitor {
    type Value = GeoCoordinate;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or a position")
    }

    fn visit_f64<E>(self, value: f64) -> Result<GeoCoordinate, E> {
        Ok(GeoCoordinate::Number(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<GeoCoordinate, E> {
        Ok(GeoCoordinate::Number(value as f64))
    }

    fn visit_i64<E>(self, value: i64) -> Result<GeoCoordinate, E> {
        Ok(GeoCoordinate::Number(value as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, numbers: A) -> Result<GeoCoordinate, A::Error> {
        PositionVisitor
            .visit_seq(numbers)
            .map(GeoCoordinate::Position)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CertificateUse, Columns, Raw, json};
    use crate::error::FormatError;

    fn read_json(bytes: &[u8]) -> Result<Raw, FormatError> {
        json::read(bytes, CertificateUse::Checked, false)
    }

    fn points(text: &str) -> Vec<[f64; 2]> {
        let raw = read_json(text.as_bytes());
        raw.expect(text).set.points
    }

    fn message(text: &str) -> String {
        let raw = read_json(text.as_bytes());
        raw.err().expect(text).to_string()
    }

    #[test]
    fn points_of_all_four_kinds_are_read() {
        let point = r#"{"coordinates": [1, 0.5], "type": "Point", "bbox": [1, 2]}"#;
        let several = r#"{"type": "MultiPoint", "coordinates": [[2, 3], [-4.5, 5, 0]]}"#;
        let feature = |geometry: &str| {
            format!(
                r#"{{"type": "Feature", "properties": {{"points": 3}}, "geometry": {geometry}}}"#
            )
        };
        assert_eq!(points(point), [[1.0, 0.5]]);
        assert_eq!(points(&feature(several)), [[2.0, 3.0], [-4.5, 5.0]]);

        let both = [feature(several), feature(point)].join(",");
        let all = format!(r#"{{"type": "FeatureCollection", "crs": {{}}, "features": [{both}]}}"#);
        assert_eq!(points(&all), [[2.0, 3.0], [-4.5, 5.0], [1.0, 0.5]]);
    }

    #[test]
    fn other_geometries_are_refused_by_name() {
        let line = r#"{"type": "LineString", "coordinates": [[0, 0], [1, 1]]}"#;
        let refusal =
            "GeoJSON: LineString cannot be read; Point and MultiPoint can, alone and as features";
        assert_eq!(message(line), refusal);
        let area = r#"{"type": "Polygon", "coordinates": [[[0, 0], [1, 1], [1, 0], [0, 0]]]}"#;
        let collection = |geometry: &str| {
            let point =
                r#"{"type": "Feature", "geometry": {"type": "Point", "coordinates": [0, 0]}}"#;
            let other = format!(r#"{{"type": "Feature", "geometry": {geometry}}}"#);
            format!(r#"{{"type": "FeatureCollection", "features": [{point}, {other}]}}"#)
        };
        assert!(message(&collection(area)).contains("GeoJSON: Polygon (feature 1) cannot be read"));
        assert!(message(&collection("null")).contains("without a geometry (feature 1)"));
        let many = r#"{"type": "GeometryCollection", "geometries": []}"#;
        assert!(message(many).contains("GeoJSON: GeometryCollection cannot"));
    }

    #[test]
    fn positions_are_planar_numbers() {
        let point =
            |coordinates: &str| format!(r#"{{"type": "Point", "coordinates": {coordinates}}}"#);
        assert_eq!(points(&point("[1, 2, 0]")), [[1.0, 2.0]]);
        assert!(message(&point("[1, 2, 12.5]")).contains("point 0: z is 12.5, and only planar"));
        for other in ["[1]", "[1, 2, 0, 4]", "[1, [2, 3]]"] {
            assert!(message(&point(other)).contains("point"), "{other}");
        }
        assert!(message(&point("[\"a\", 2]")).contains("invalid type"));
        let several = r#"{"type": "MultiPoint", "coordinates": [[0, 0], [1, 2, 3]]}"#;
        assert!(message(several).contains("z is 3, and only planar sets"));
    }

    #[test]
    fn levels_ranks_and_radii_are_properties_of_points() {
        let both = Columns {
            levels: vec![0, 1],
            ranks: vec![0.125, 0.625].into(),
            radii: vec![0.5, 0.25],
            drawing: None,
        };
        let places = [[1e300, -0.0], [0.1, 1.0 / 3.0]];
        let text = String::from_utf8(super::write(&places, &both)).expect("text");
        let written: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let properties = serde_json::json!({ "level": 1, "rank": 0.625, "radius": 0.25 });
        assert_eq!(written["features"][1]["properties"], properties);
        let bits = |points: &[[f64; 2]]| points.iter().map(|p| p.map(f64::to_bits)).collect();
        let [back, made]: [Vec<[u64; 2]>; 2] = [bits(&points(&text)), bits(&places)];
        assert_eq!(back, made);

        let bare = super::write(&places, &Columns::default());
        assert!(String::from_utf8_lossy(&bare).contains("\"properties\": {}}"));
    }

    #[test]
    fn what_may_be_degrees_is_marked() {
        let degrees = |x: f64, y: f64| {
            let text = format!(r#"{{"type": "Point", "coordinates": [{x}, {y}]}}"#);
            read_json(text.as_bytes()).expect("a point").degrees
        };
        assert!(degrees(8.5, 47.4) && degrees(-180.0, 90.0));
        assert!(!degrees(180.5, 0.0) && !degrees(0.0, -91.0));
        let own = read_json(b"[[8.5, 47.4]]").expect("a point");
        assert!(!own.degrees);
    }
}
