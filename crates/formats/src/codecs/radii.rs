//! The radius of each point, in files that have such a column: text tables, PLY, JSON and `GeoJSON`. Other readers skip it.

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::kept::ColumnUse;
use super::{ply, positive, table};
use crate::error::FormatError;
use crate::format::Format;

/// The name of the column, and of the property of features.
pub(super) const RADIUS: &str = "radius";

/// Returns the radius of each point, if the file has a column, or features a property, called [`RADIUS`]. `columns` are
/// those of x and y that were chosen in a text table. If one of them was chosen by the name [`RADIUS`], there are no
/// radii: that column is a coordinate. A choice by number is not compared with the name. Fails where a radius is no
/// number or not above 0.
pub(super) fn read(
    bytes: &[u8],
    format: Format,
    columns: Option<[&str; 2]>,
) -> Result<Option<Vec<f64>>, FormatError> {
    let is_coordinate = |chosen: [&str; 2]| chosen.iter().any(|name| name.trim() == RADIUS);
    let radii = match format {
        Format::Csv | Format::Xyz if columns.is_some_and(is_coordinate) => None,
        Format::Csv | Format::Xyz => if_any(table::column(
            bytes,
            format,
            columns,
            RADIUS,
            ColumnUse::Radius,
        ))?,
        Format::PlyAscii | Format::PlyBinary => {
            if_any(ply::column(bytes, format, RADIUS, ColumnUse::Radius))?
        }
        // A file that is read as JSON may hold GeoJSON.
        Format::Json | Format::GeoJson => of_document(bytes)?.or_else(|| of_features(bytes)),
        Format::PsaText
        | Format::PsaRps
        | Format::UtkText
        | Format::UtkBinary
        | Format::Npy
        | Format::Svg => None,
    };

    // Columns were checked row by row. Of features any number may come.
    for &radius in radii.iter().flatten() {
        positive("the radius of a point", radius)?;
    }
    Ok(radii)
}

/// Returns nothing instead of the error that there is no such column. Other faults of the header were found when the
/// points were read.
fn if_any(column: Result<Vec<f64>, FormatError>) -> Result<Option<Vec<f64>>, FormatError> {
    match column {
        Err(FormatError::Header { .. }) => Ok(None),
        found => found.map(Some),
    }
}

/// A document of this program, whose list of radii has one for each point.
#[derive(Deserialize)]
struct Document {
    points: Vec<IgnoredAny>,
    radius: Vec<f64>,
}

/// Returns nothing where a document has no list of radii. Fails where it has more or fewer than there are points.
fn of_document(bytes: &[u8]) -> Result<Option<Vec<f64>>, FormatError> {
    let document: Option<Document> = serde_json::from_slice(crate::text::without_bom(bytes)).ok();
    let Some(Document { points, radius }) = document else {
        return Ok(None);
    };
    if radius.len() == points.len() {
        return Ok(Some(radius));
    }
    Err(FormatError::Column {
        name: RADIUS,
        found: radius.len(),
        points: points.len(),
    })
}

#[derive(Deserialize)]
struct Collection {
    features: Vec<Feature>,
}

#[derive(Deserialize)]
struct Feature {
    #[serde(rename = "geometry")]
    _geometry: Geometry,
    properties: Properties,
}

/// A point alone: several points would share a radius.
#[derive(Deserialize)]
struct Geometry {
    #[serde(rename = "coordinates")]
    _position: [f64; 2],
}

#[derive(Deserialize)]
struct Properties {
    radius: f64,
}

/// Returns nothing where a feature has none: other programs may put anything into properties.
fn of_features(bytes: &[u8]) -> Option<Vec<f64>> {
    let collection: Collection = serde_json::from_slice(crate::text::without_bom(bytes)).ok()?;
    let radii = collection.features.iter();
    Some(radii.map(|feature| feature.properties.radius).collect())
}

#[cfg(test)]
mod tests {
    use super::super::{Columns, Hint, Target, encode_certified, read_ranks};
    use super::*;
    use crate::point_set::PointSet;

    #[test]
    fn what_is_written_is_read_and_other_files_have_none() {
        let set = PointSet::from_points(vec![[0.5, 0.25], [0.1, 1.0 / 3.0]]);
        let radii = vec![1.0 / 7.0, 1e-9];
        // A rank with all of its 33 bits.
        let ranks = vec![0.0, 1.0 - 1.0 / 8_589_934_592.0];
        for format in Format::ALL {
            let bytes = |columns: &Columns| {
                encode_certified(&set, &Target::new(format), None, columns).expect("bytes")
            };
            let with = Columns {
                levels: vec![0, 1],
                ranks: ranks.clone().into(),
                radii: radii.clone(),
                drawing: None,
            };
            let has_columns = matches!(
                format,
                Format::Csv | Format::PlyAscii | Format::PlyBinary | Format::GeoJson
            );
            // JSON has a list of radii beside that of points, and no ranks.
            let has_radii = has_columns || format == Format::Json;
            let found = read(&bytes(&with), format, None).expect("a file");
            assert_eq!(found, has_radii.then(|| radii.clone()), "{format}");
            let found = read(&bytes(&Columns::default()), format, None).expect("a file");
            assert_eq!(found, None, "{format}");

            // Other files are not even asked for ranks.
            assert_eq!(format.carries_ranks(), has_columns, "{format}");

            // Ranks are read from the same formats, to the bit, by the name of their column.
            let hint = Hint {
                format: Some(format),
                ..Hint::default()
            };
            let found = read_ranks(&bytes(&with), &hint).expect("a file");
            assert_eq!(found, has_columns.then(|| ranks.clone()), "{format}");
            let found = read_ranks(&bytes(&Columns::default()), &hint).expect("a file");
            assert_eq!(found, None, "{format}");
        }
    }

    #[test]
    fn tables_of_others_have_it_anywhere_and_what_is_no_radius_is_refused() {
        let table = |text: &str| read(text.as_bytes(), Format::Csv, None);
        let first = table("Radius;x;y\n0.5;1;2\n0.25;3;4\n").expect("a table");
        assert_eq!(first, Some(vec![0.5, 0.25]));
        assert_eq!(table("x,y,size\n1,2,3\n").expect("a table"), None);

        // Where other columns are those of x and y, the radii are read all the same.
        let survey = "name,easting,northing,radius\na,1,2,0.5\nb,3,4,0.25\n";
        let chosen = |columns| read(survey.as_bytes(), Format::Csv, Some(columns));
        for columns in [["easting", "northing"], ["2", "3"]] {
            let found = chosen(columns).expect("a table");
            assert_eq!(found, Some(vec![0.5, 0.25]), "{columns:?}");
        }
        let found = chosen(["easting", "radius"]).expect("a table");
        assert_eq!(found, None);

        let refused = |text: &str| table(text).expect_err("no radius").to_string();
        assert!(
            refused("x,y,radius\n1,2,0\n")
                .contains("line 2: \"0\" in column radius is not a finite number above 0")
        );
        assert!(refused("x,y,radius\n1,2,wide\n").contains("wide"));

        let json = |text: &str| read(text.as_bytes(), Format::Json, None);
        let uneven = json(r#"{"points": [[1, 2], [3, 4]], "radius": [0.5]}"#);
        let said = uneven.expect_err("a radius is missing").to_string();
        assert!(said.contains("1 entries of radius for 2 points"), "{said}");
        let negative = json(r#"{"points": [[1, 2]], "radius": [-0.5]}"#);
        assert!(
            negative
                .expect_err("no radius")
                .to_string()
                .contains("-0.5")
        );

        let shared = br#"{"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"radius": 1},
            "geometry": {"type": "MultiPoint", "coordinates": [[0, 0], [1, 1]]}}]}"#;
        assert_eq!(read(shared, Format::GeoJson, None).expect("points"), None);
    }
}
