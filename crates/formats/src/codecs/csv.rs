//! Comma-separated values with the header `x,y`.
//!
//! Reads any table that has columns named x and y, or none named and x and y first; further columns are
//! skipped. Decimal commas are not read: a row with more fields than the first line is refused.

use super::Raw;
use crate::error::{FilePlace, FormatError};
use crate::format::{Format, Precision};
use crate::text::{data_lines, number, push, push_line};

const FORMAT: Format = Format::Csv;
/// The first line.
pub(super) const HEAD: &[u8] = b"x,y\n";

pub(super) fn read(bytes: &[u8]) -> Result<Raw, FormatError> {
    let (mut table, mut points) = (CsvTable::default(), Vec::new());
    for (line, row) in data_lines(bytes) {
        table.take(row, line, &mut points)?;
    }
    Ok(Raw::new(points, Precision::Double))
}

/// The columns found in the first line.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CsvTable(Option<CsvColumns>);

#[derive(Clone, Copy, Debug)]
struct CsvColumns {
    /// Which columns are x and y.
    places: [usize; 2],
    count: usize,
}

impl CsvTable {
    /// Reads a line that is neither blank nor a comment: a header, if it is the first, or a point.
    pub(super) fn take(
        &mut self,
        row: &[u8],
        line: u64,
        points: &mut Vec<[f64; 2]>,
    ) -> Result<(), FormatError> {
        if let Some(columns) = self.0 {
            points.push(point(row, line, columns)?);
            return Ok(());
        }
        let header = is_header(row);
        let columns = CsvColumns {
            places: if header {
                named_columns(row, line)?
            } else {
                [0, 1]
            },
            count: fields(row).count(),
        };
        if !header {
            points.push(point(row, line, columns)?);
        }
        self.0 = Some(columns);
        Ok(())
    }
}

/// The fields of a line. A comma between quotation marks does not separate fields.
fn fields(row: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut quoted = false;
    row.split(move |&b| {
        quoted ^= b == b'"';
        b == b',' && !quoted
    })
}

/// A header is a first line that does not begin with a number.
fn is_header(line: &[u8]) -> bool {
    let first = field_name(fields(line).next().unwrap_or_default());
    std::str::from_utf8(first).map_or(true, |text| text.parse::<f64>().is_err())
}

fn field_name(field: &[u8]) -> &[u8] {
    let field = field.trim_ascii();
    let inner = field
        .strip_prefix(b"\"")
        .and_then(|f| f.strip_suffix(b"\""));
    inner.unwrap_or(field).trim_ascii()
}

fn named_columns(header: &[u8], line: u64) -> Result<[usize; 2], FormatError> {
    let find = |name: &[u8]| {
        fields(header)
            .position(|field| field_name(field).eq_ignore_ascii_case(name))
            .ok_or_else(|| FormatError::Header {
                format: FORMAT,
                place: FilePlace::Line(line),
                reason: format!("no column is named {}", String::from_utf8_lossy(name)),
            })
    };
    Ok([find(b"x")?, find(b"y")?])
}

fn point(row: &[u8], line: u64, columns: CsvColumns) -> Result<[f64; 2], FormatError> {
    let place = FilePlace::Line(line);
    let wrong = |expected| FormatError::Columns {
        format: FORMAT,
        place,
        found: fields(row).count(),
        expected,
    };
    let [x, y] = columns.places;
    let (mut found, mut surplus) = ([None; 2], false);
    for (column, field) in fields(row).enumerate() {
        let field = field.trim_ascii();
        if column == x {
            found[0] = Some(field);
        } else if column == y {
            found[1] = Some(field);
        }
        // Some programs end each row with a comma.
        surplus |= column >= columns.count && !field.is_empty();
    }
    let [Some(x), Some(y)] = found else {
        return Err(wrong(x.max(y) + 1));
    };
    if surplus {
        return Err(wrong(columns.count));
    }
    Ok([number(x, FORMAT, place)?, number(y, FORMAT, place)?])
}

/// Writes the points, and their levels if there are any.
pub(super) fn write(points: &[[f64; 2]], levels: &[u32]) -> Vec<u8> {
    let mut out = HEAD.to_vec();
    if levels.is_empty() {
        push_rows(&mut out, points);
        return out;
    }
    out = b"x,y,level\n".to_vec();
    for (point, level) in points.iter().zip(levels) {
        push_line(&mut out, point, ",");
        out.pop();
        push(&mut out, format_args!(",{level}\n"));
    }
    out
}

pub(super) fn push_rows(out: &mut Vec<u8>, points: &[[f64; 2]]) {
    for point in points {
        push_line(out, point, ",");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(text: &str) -> Result<Vec<[f64; 2]>, FormatError> {
        read(text.as_bytes()).map(|raw| raw.set.points)
    }

    #[test]
    fn columns_are_found_by_name_or_by_order() {
        let expected = vec![[0.5, 0.25]];
        for text in [
            "x,y\n0.5,0.25\n",
            "\u{feff}X , Y\r\n 0.5 , 0.25 \r\n",
            "id,\"y\",\"x\"\n7,0.25,0.5",
            "0.5,0.25,red\n",
            "# made by hand\n\n5e-1,.25",
            "x,y\n0.5,0.25,\n",
            "x,y,name\n0.5,0.25,\"a, b\"\n",
        ] {
            assert_eq!(points(text).expect(text), expected);
        }
    }

    #[test]
    fn faults_are_named_with_their_line() {
        let message = |text| points(text).expect_err(text).to_string();
        assert_eq!(
            message("a,b\n1,2\n"),
            "CSV: header, line 1: no column is named x"
        );
        assert_eq!(
            message("x,y\n1,2\n3\n"),
            "CSV: line 3: 1 columns where 2 are needed"
        );
        assert_eq!(
            message("x,y\n1,two\n"),
            "CSV: line 2: \"two\" is not a number"
        );
        // Decimal commas.
        assert_eq!(
            message("x,y\n0,5,0,25\n"),
            "CSV: line 2: 4 columns where 2 are needed"
        );
        assert_eq!(
            message("0.5,0.25\n0,5,0,25\n"),
            "CSV: line 2: 4 columns where 2 are needed"
        );
        assert_eq!(
            message("x,y\n1,NaN\n"),
            "CSV: line 2: the coordinate NaN is not a finite number"
        );
    }
}
