//! Sets in space as files: points x, y, z in file coordinates. Formats hold them whose readers take three numbers a
//! point. Planar sets have two numbers a point in most of these formats, and z = 0 in PLY and XYZ.

use super::kept::ColumnUse;
use super::solid_columns::{self, SolidColumns};
use super::{Hint, detected, npy, ply, table, utk};
use crate::binary;
use crate::detect::{Detection, Evidence};
use crate::error::FormatError;
use crate::format::{Format, Precision};
use crate::text::{as_utf8, push, push_line};

/// A set in space as a file holds it.
#[derive(Clone, Debug)]
pub struct SolidRaw {
    /// The points, in file coordinates.
    pub points: Vec<[f64; 3]>,
    /// What the file says of when they arrived.
    pub columns: SolidColumns,
    /// The format and how it was recognised.
    pub detection: Detection,
    /// Number type of the file's coordinates.
    pub precision: Precision,
}

/// Refuses a format that cannot hold sets in space.
pub(crate) fn check_format(format: Format) -> Result<(), FormatError> {
    let reason = match format {
        Format::Csv
        | Format::Xyz
        | Format::Npy
        | Format::PlyAscii
        | Format::PlyBinary
        | Format::UtkText
        | Format::UtkBinary => return Ok(()),
        Format::PsaText | Format::PsaRps => "psa measures planar sets alone",
        Format::Json => "the points of this program's JSON have x and y",
        Format::GeoJson => "a third number is an altitude there, which no distance counts",
        Format::Svg => "a picture is planar",
    };
    Err(FormatError::NoThird { format, reason })
}

/// The points in space that `bytes` hold, in file coordinates, as [`decode`](crate::decode) returns those in the plane.
/// Columns of the hint do not choose columns to read: with them the file is read as a text table, or refused if its format
/// has no columns. An origin and a certificate of the hint are not used.
///
/// # Errors
///
/// As [`decode`](crate::decode), and for formats and files without a third coordinate.
pub fn decode(bytes: &[u8], hint: &Hint<'_>) -> Result<SolidRaw, FormatError> {
    let is_set = false;
    decode_as(bytes, hint, is_set)
}

/// The same of a set of balls. Rows without names have three numbers there: of a fourth it is not known what it says, and
/// which three are the place. A cloud to be thinned may have more, which stay beside its points.
pub(crate) fn decode_set(bytes: &[u8], hint: &Hint<'_>) -> Result<SolidRaw, FormatError> {
    let is_set = true;
    decode_as(bytes, hint, is_set)
}

fn decode_as(bytes: &[u8], hint: &Hint<'_>, is_set: bool) -> Result<SolidRaw, FormatError> {
    let bytes = &*as_utf8(bytes);
    let mut detection = detected(bytes, hint)?;
    // Three numbers in a line are taken for XYZ: only the name says that they are UTK's.
    let named = Format::from_path(hint.name.as_ref());
    if detection.format == Format::Xyz && hint.format.is_none() && named == Some(Format::UtkText) {
        detection.format = Format::UtkText;
        // The name decided, and not the content.
        detection.evidence = Evidence::Extension;
    }
    let format = detection.format;
    check_format(format)?;

    // Each reader refuses numbers that are not finite, and files whose points have no third number.
    let (points, precision) = match format {
        Format::Npy => npy::read_solid(bytes)?,
        Format::UtkBinary => utk::read_solid_binary(bytes, hint.set)?,
        // Decimals are read in double precision, however many digits the text has.
        Format::UtkText => {
            let (points, _sets_in_file) = utk::text_of(bytes, hint.set)?;
            (points, Precision::Double)
        }
        // x and y are read as of a planar set, whatever z is, and then z as a column by itself. A choice of two columns
        // is one of a plane, and is not used.
        Format::Csv | Format::Xyz => {
            table::check_in_space(bytes, format, is_set)?;
            let (columns, any_z) = (None, true);
            let planar = table::read(bytes, format, columns, any_z)?;
            let heights = table::heights(bytes, format)?;
            (in_space(&planar.set.points, &heights), planar.precision)
        }
        // `check_format` leaves only PLY.
        _ => {
            let any_z = true;
            let planar = ply::read(bytes, format, any_z)?;
            let heights = ply::column(bytes, format, "z", ColumnUse::Order)?;
            (in_space(&planar.set.points, &heights), planar.precision)
        }
    };
    if points.is_empty() {
        return Err(FormatError::Empty { format });
    }
    // Only UTK's files have several sets, and their readers refuse one that is not there.
    let has_several = matches!(format, Format::UtkText | Format::UtkBinary);
    if hint.set.is_some_and(|index| index > 0) && !has_several {
        return Err(FormatError::Sets {
            format,
            found: 1,
            chosen: hint.set,
        });
    }
    Ok(SolidRaw {
        points,
        columns: solid_columns::read(bytes, format),
        detection,
        precision,
    })
}

fn in_space(planar: &[[f64; 2]], heights: &[f64]) -> Vec<[f64; 3]> {
    // Both readers take the same rows.
    debug_assert_eq!(planar.len(), heights.len());
    let each = planar.iter().zip(heights);
    each.map(|(&[x, y], &z)| [x, y, z]).collect()
}

/// Whether a format has columns beside the coordinates of a set in space, and names for them.
pub(crate) fn has_columns(format: Format) -> bool {
    matches!(format, Format::Csv | Format::PlyAscii | Format::PlyBinary)
}

/// The bytes of a file of points in file coordinates, with their columns if the format has any. Fails without a point.
/// Text has the shortest decimals that read back as the same numbers, whatever `precision` is.
pub(crate) fn encode(
    points: &[[f64; 3]],
    columns: &SolidColumns,
    format: Format,
    precision: Precision,
) -> Result<Vec<u8>, FormatError> {
    check_format(format)?;
    if points.is_empty() {
        return Err(FormatError::Empty { format });
    }
    columns.check(points.len())?;
    for (point, index) in points.iter().zip(0..) {
        for &value in point {
            binary::finite(value, format, index)?;
        }
    }

    // Head and rows are those of planar sets with one number more, or with another z in PLY and XYZ.
    Ok(match format {
        Format::Npy => npy::write_solid(points, precision),
        Format::UtkBinary => utk::write_solid_binary(points, precision)?,
        Format::PlyAscii | Format::PlyBinary => {
            ply::write_solid(points, columns, format, precision)
        }
        Format::Csv => table_of(points, columns),
        // XYZ and UTK's text have no head, and so no names for columns.
        _ => lines(points),
    })
}

fn lines(points: &[[f64; 3]]) -> Vec<u8> {
    let mut out = Vec::new();
    for point in points {
        push_line(&mut out, point, " ");
    }
    out
}

/// Comma-separated values with a head.
fn table_of(points: &[[f64; 3]], columns: &SolidColumns) -> Vec<u8> {
    let mut out = b"x,y,z".to_vec();
    for name in columns.names() {
        push(&mut out, format_args!(",{name}"));
    }
    out.push(b'\n');

    for (index, point) in points.iter().enumerate() {
        push_line(&mut out, point, ",");
        // The end of the line goes behind the columns.
        out.pop();
        for number in columns.of(index) {
            push(&mut out, format_args!(",{number}"));
        }
        out.push(b'\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [[f64; 3]; 3] = [[0.5, 0.25, 0.125], [0.1, 1.0 / 3.0, 0.7], [0.0, 0.9, 1e-9]];

    const HOLDING: [Format; 7] = [
        Format::Csv,
        Format::Xyz,
        Format::Npy,
        Format::PlyAscii,
        Format::PlyBinary,
        Format::UtkText,
        Format::UtkBinary,
    ];

    fn read(bytes: &[u8], format: Format) -> Result<SolidRaw, FormatError> {
        let hint = Hint {
            format: Some(format),
            ..Hint::default()
        };
        decode(bytes, &hint)
    }

    #[test]
    fn what_is_written_is_read_to_the_bit_and_others_refuse_with_the_reason() {
        for format in Format::ALL {
            let bytes = encode(&POINTS, &SolidColumns::default(), format, Precision::Double);
            if !HOLDING.contains(&format) {
                let said = bytes.expect_err("planar").to_string();
                assert!(said.contains("holds no third coordinate"), "{said}");
                continue;
            }
            let bytes = bytes.expect("bytes");
            let raw = read(&bytes, format).expect("own file");
            assert_eq!(raw.points, POINTS, "{format}");
            // A name of the format's extension is recognised, too.
            let name = format!("set.{}", format.extension());
            let named = decode(&bytes, &Hint::from_name(&name)).expect("by its name");
            assert_eq!((named.points, named.detection.format), (raw.points, format));
        }
    }

    #[test]
    fn single_precision_is_rounded_as_f32() {
        for format in [Format::Npy, Format::PlyBinary, Format::UtkBinary] {
            let bytes = encode(&POINTS, &SolidColumns::default(), format, Precision::Single)
                .expect("bytes");
            let raw = read(&bytes, format).expect("own file");
            assert_eq!(raw.precision, Precision::Single);
            let rounded = POINTS.map(|point| point.map(|value| f64::from(value as f32)));
            assert_eq!(raw.points, rounded, "{format}");
        }
    }

    #[test]
    fn tables_and_vertices_of_others_have_z_anywhere() {
        let table = b"z;x;name;y\n3;1;a;2\n6;4;b;5\n";
        let raw = read(table, Format::Csv).expect("a table");
        assert_eq!(raw.points, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        let cloud = b"1 2 3 255 0 0\n4 5 6 0 0 255\n";
        let raw = read(cloud, Format::Xyz).expect("a cloud");
        assert_eq!(raw.points, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        let ply =
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty uchar red\nproperty float z\n\
            property float y\nproperty float x\nend_header\n255 3 2 1\n";
        assert_eq!(
            read(ply, Format::PlyAscii).expect("vertices").points,
            [[1.0, 2.0, 3.0]]
        );
    }

    #[test]
    fn faults_are_named() {
        let said = |bytes: &[u8], format| read(bytes, format).expect_err("refused").to_string();
        assert!(said(b"x,y\n1,2\n", Format::Csv).contains("no column is named z"));
        let two = said(b"1 2\n", Format::Xyz);
        assert!(two.contains("2 columns") && two.contains("three"), "{two}");
        assert!(said(b"x,y,z\n1,2,nan\n", Format::Csv).contains("is not a finite number"));
        assert!(said(b"1 2\n", Format::UtkText).contains("2 columns where 3 are needed"));
        let planar = npy::write(&[[0.5, 0.5]], Precision::Double);
        assert!(said(&planar, Format::Npy).contains("shape (1, 2)"));
        let planar = utk::write_binary(&[[0.5, 0.5]], Precision::Double).expect("bytes");
        assert!(said(&planar, Format::UtkBinary).contains("a set of dimension 2"));
        let flat = b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n";
        assert!(said(flat, Format::PlyAscii).contains("no scalar property z"));
        let nan = encode(
            &[[0.0, f64::NAN, 0.0]],
            &SolidColumns::default(),
            Format::Npy,
            Precision::Double,
        );
        assert!(matches!(nan, Err(FormatError::NotFinite { .. })));
        let mut short = encode(
            &POINTS,
            &SolidColumns::default(),
            Format::Npy,
            Precision::Double,
        )
        .expect("bytes");
        short.pop();
        assert!(said(&short, Format::Npy).contains("72 bytes are needed"));

        // A file of one set has no second one.
        let of_set = |index| {
            let hint = Hint {
                format: Some(Format::Csv),
                set: Some(index),
                ..Hint::default()
            };
            decode(b"x,y,z\n1,2,3\n", &hint)
        };
        assert!(of_set(0).is_ok());
        assert!(matches!(of_set(1), Err(FormatError::Sets { found: 1, .. })));
    }
}
