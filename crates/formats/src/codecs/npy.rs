//! numpy's array file, shape (N, 2), or (N, 3) with z = 0; of sets in space (N, 3).
//!
//! Reads header versions 1 to 3, f4 and f8 of either byte order, C and Fortran order; writes version 1.0,
//! little-endian, C order, shape (N, 2), and of sets in space (N, 3). The header, a Python literal, is matched as
//! numpy's format specification prescribes and never evaluated.

use super::Raw;
use super::xyz::planar;
use crate::binary::{self, Cursor, Endian, coordinate};
use crate::detect::NPY_MAGIC;
use crate::error::{FilePlace, FormatError, quote};
use crate::format::{Format, Precision};
use crate::text::push;

const FORMAT: Format = Format::Npy;
/// numpy pads so that data begin at a multiple of this.
const ALIGNMENT: usize = 64;

/// The content of the header's dictionary.
pub(super) struct NpyHeader {
    pub precision: Precision,
    pub endian: Endian,
    /// Whether all x come first, then all y.
    pub fortran: bool,
    pub count: u64,
    /// Coordinates of a point: 2 or 3.
    pub columns: usize,
}

pub(super) fn read(bytes: &[u8], any_z: bool) -> Result<Raw, FormatError> {
    let (header, offset) = read_head(bytes)?;
    let width = header.columns * header.precision.bytes();
    let mut cursor = Cursor::new(bytes, offset as usize, FORMAT);
    let data = cursor.records(header.count, width as u64)?;
    cursor.finish()?;

    let points = if header.fortran || header.columns == 3 {
        scattered(data, &header, any_z)?
    } else {
        binary::pairs(data, 0, header.precision, header.endian, FORMAT)?
    };
    Ok(Raw::new(points, header.precision))
}

/// Reads points in space, of shape (N, 3).
pub(super) fn read_solid(bytes: &[u8]) -> Result<(Vec<[f64; 3]>, Precision), FormatError> {
    let of_space = "only shape (N, 3) can be a set in space";
    let (header, offset) = read_head(bytes).map_err(|error| match error {
        // Of another shape the reader of planar sets would name that of those.
        FormatError::Unsupported { format, what, .. } if what.starts_with("shape") => {
            FormatError::Unsupported {
                format,
                what,
                supported: of_space,
            }
        }
        other => other,
    })?;
    if header.columns != 3 {
        return Err(FormatError::Unsupported {
            format: FORMAT,
            what: format!("shape ({}, {})", header.count, header.columns),
            supported: of_space,
        });
    }

    // The number of rows is compared with the bytes that are there before anything is allocated.
    let size = header.precision.bytes();
    let mut cursor = Cursor::new(bytes, offset as usize, FORMAT);
    let data = cursor.records(header.count, 3 * size as u64)?;
    cursor.finish()?;

    let count = header.count as usize;
    let value = |row: usize, axis: usize| {
        // In Fortran order all x come first, then all y and all z.
        let at = if header.fortran {
            axis * count + row
        } else {
            3 * row + axis
        };
        let stored = &data[at * size..][..size];
        let value = coordinate(stored, header.precision, header.endian);
        binary::finite(value, FORMAT, row as u64)
    };
    let point = |row| Ok([value(row, 0)?, value(row, 1)?, value(row, 2)?]);
    let points: Result<_, FormatError> = (0..count).map(point).collect();
    Ok((points?, header.precision))
}

/// Writes points in space.
pub(super) fn write_solid(points: &[[f64; 3]], precision: Precision) -> Vec<u8> {
    let mut out = head_of(&NpyHeader {
        precision,
        endian: Endian::Little,
        fortran: false,
        count: points.len() as u64,
        columns: 3,
    });
    binary::push(&mut out, points.as_flattened(), precision);
    out
}

/// The header of a file that begins with `bytes`, and where its data begin.
pub(super) fn read_head(bytes: &[u8]) -> Result<(NpyHeader, u64), FormatError> {
    if !bytes.starts_with(NPY_MAGIC) {
        return Err(FormatError::Magic {
            format: FORMAT,
            expected: "\"\\x93NUMPY\"",
        });
    }

    // The version has two bytes, of which the first counts. From version 2 on the header may be longer than 2^16 bytes, so that
    // its length has four bytes and not two.
    let mut cursor = Cursor::new(bytes, NPY_MAGIC.len(), FORMAT);
    let version = cursor.take(2)?[0];
    let length = match version {
        1 => u64::from(u16::from_le_bytes(binary::array(cursor.take(2)?))),
        2 | 3 => u64::from(cursor.u32()?),
        _ => {
            return Err(FormatError::Unsupported {
                format: FORMAT,
                what: format!("header version {version}"),
                supported: "versions 1 to 3 can",
            });
        }
    };

    let at = FilePlace::Offset(cursor.offset());
    let found = header(cursor.take(length)?, at)?;
    Ok((found, cursor.offset()))
}

/// Returns the points of data that are not simply rows of two coordinates: all x stand before all y, or rows have a z.
/// A z other than 0 is refused, unless `any_z` is set.
fn scattered(data: &[u8], header: &NpyHeader, any_z: bool) -> Result<Vec<[f64; 2]>, FormatError> {
    let (size, columns) = (header.precision.bytes(), header.columns);
    // The number of bytes was compared with the header when they were taken.
    let count = data.len() / (size * columns);

    // How many values further the next row and the next column are: in Fortran order a column is contiguous, in C order a row.
    let (next_row, next_column) = if header.fortran {
        (1, count)
    } else {
        (columns, 1)
    };

    let number = |row: usize, column: usize| {
        let at = size * (row * next_row + column * next_column);
        let value = coordinate(&data[at..at + size], header.precision, header.endian);
        binary::finite(value, FORMAT, row as u64)
    };

    let point = |row| {
        if columns == 3 && !any_z {
            planar(number(row, 2)?, FORMAT, FilePlace::Point(row as u64))?;
        }
        Ok([number(row, 0)?, number(row, 1)?])
    };
    (0..count).map(point).collect()
}

/// Reads the header's dictionary, which stands at `place`.
fn header(text: &[u8], place: FilePlace) -> Result<NpyHeader, FormatError> {
    let fault = |reason: String| FormatError::Header {
        format: FORMAT,
        place,
        reason,
    };

    let dictionary =
        std::str::from_utf8(text).map_err(|_| fault(format!("\"{}\" is not text", quote(text))))?;
    let value = |key: &str| {
        value_of(dictionary, key).ok_or_else(|| fault(format!("there is no key '{key}'")))
    };

    let (precision, endian) = descr(value("descr")?)?;
    let order = value("fortran_order")?;
    // `value` returns the rest of the dictionary from the value on.
    let fortran = order.starts_with("True");
    if !fortran && !order.starts_with("False") {
        let order = quote(order.as_bytes());
        return Err(fault(format!("fortran_order is {order}")));
    }

    let tuple = value("shape")?;
    let shape = tuple
        .strip_prefix('(')
        .and_then(|rest| rest.split_once(')'))
        .ok_or_else(|| fault(format!("shape is {}", quote(tuple.as_bytes()))))?
        .0;

    let Some((count, columns)) = rows_and_columns(shape) else {
        return Err(FormatError::Unsupported {
            format: FORMAT,
            what: format!("shape ({})", quote(shape.as_bytes())),
            supported: "only shape (N, 2) can, and (N, 3) with z = 0",
        });
    };

    Ok(NpyHeader {
        precision,
        endian,
        fortran,
        count,
        columns,
    })
}

/// What follows `'key':`, trimmed.
fn value_of<'a>(dictionary: &'a str, key: &str) -> Option<&'a str> {
    let mut quoted = ['\'', '"'].into_iter().filter_map(|mark| {
        let name = format!("{mark}{key}{mark}");
        Some(dictionary.split_once(name.as_str())?.1)
    });
    Some(quoted.next()?.trim_start().strip_prefix(':')?.trim_start())
}

/// Reads the type of the numbers.
fn descr(value: &str) -> Result<(Precision, Endian), FormatError> {
    let inner = value
        .strip_prefix(['\'', '"'])
        .and_then(|rest| rest.split(['\'', '"']).next());
    match inner {
        Some("<f8") => Ok((Precision::Double, Endian::Little)),
        Some(">f8") => Ok((Precision::Double, Endian::Big)),
        Some("<f4") => Ok((Precision::Single, Endian::Little)),
        Some(">f4") => Ok((Precision::Single, Endian::Big)),
        other => Err(FormatError::Unsupported {
            format: FORMAT,
            what: format!("the type {}", quote(other.unwrap_or(value).as_bytes())),
            supported: "<f8, >f8, <f4 and >f4 can",
        }),
    }
}

/// N and the columns of the shape `N, 2` or `N, 3`; Python 2 wrote `L` after long numbers.
fn rows_and_columns(shape: &str) -> Option<(u64, usize)> {
    let number = |part: &str| part.trim().trim_end_matches('L').parse::<u64>().ok();
    let (rows, rest) = shape.split_once(',')?;
    let columns = match number(rest.trim().trim_end_matches(','))? {
        2 => 2,
        3 => 3,
        _ => return None,
    };
    Some((number(rows)?, columns))
}

pub(super) fn write(points: &[[f64; 2]], precision: Precision) -> Vec<u8> {
    let mut out = head(points.len() as u64, precision);
    binary::push_pairs(&mut out, points, precision);
    out
}

/// The head of a file of `count` points. The alignment makes it 128 bytes, whatever the count.
pub(super) fn head(count: u64, precision: Precision) -> Vec<u8> {
    head_of(&NpyHeader {
        precision,
        endian: Endian::Little,
        fortran: false,
        count,
        columns: 2,
    })
}

/// Returns the array with only those of its rows that are kept, in the same number type and order. `kept` has an entry
/// for each row, as the whole array was read before.
pub(super) fn keep(bytes: &[u8], kept: &[bool]) -> Result<Vec<u8>, FormatError> {
    let (header, offset) = read_head(bytes)?;
    let size = header.precision.bytes();
    let data = bytes.get(offset as usize..).unwrap_or_default();
    let count = kept.iter().filter(|kept| **kept).count() as u64;

    // All else in the dictionary stays as it was.
    let mut out = head_of(&NpyHeader { count, ..header });
    // In Fortran order each column is an array by itself. Chunks need a size, even if there are no rows.
    let (width, arrays) = if header.fortran {
        (size, header.columns)
    } else {
        (size * header.columns, 1)
    };
    for array in data.chunks_exact(width * kept.len().max(1)).take(arrays) {
        let rows = array.chunks_exact(width).zip(kept);
        for (row, _) in rows.filter(|(_, kept)| **kept) {
            out.extend_from_slice(row);
        }
    }
    Ok(out)
}

/// Returns the head of a file with this header, in version 1.0.
fn head_of(header: &NpyHeader) -> Vec<u8> {
    let order = match header.endian {
        Endian::Little => '<',
        Endian::Big => '>',
    };
    let size = header.precision.bytes();
    let fortran = if header.fortran { "True" } else { "False" };
    let (count, columns) = (header.count, header.columns);
    let mut dictionary = format!(
        "{{'descr': '{order}f{size}', 'fortran_order': {fortran}, 'shape': ({count}, {columns}), }}"
    );

    // Two bytes of version and two of length stand between the magic number and the dictionary, which ends with a line end.
    let prefix = NPY_MAGIC.len() + 4;
    while !(prefix + dictionary.len() + 1).is_multiple_of(ALIGNMENT) {
        dictionary.push(' ');
    }

    let mut out = Vec::with_capacity(2 * ALIGNMENT);
    out.extend_from_slice(NPY_MAGIC);
    out.extend_from_slice(&[1, 0]);
    // The head has 128 bytes, so that two bytes suffice for the length. The line end counts in it.
    out.extend_from_slice(&(dictionary.len() as u16 + 1).to_le_bytes());
    push(&mut out, format_args!("{dictionary}\n"));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<Raw, FormatError> {
        super::read(bytes, false)
    }

    /// A file of header `version`, with `dictionary` and the values as given bytes.
    fn file(version: u8, dictionary: &str, data: &[u8]) -> Vec<u8> {
        let mut out = NPY_MAGIC.to_vec();
        out.extend_from_slice(&[version, 0]);
        let length = dictionary.len() as u32;
        let width = if version == 1 { 2 } else { 4 };
        out.extend_from_slice(&length.to_le_bytes()[..width]);
        out.extend_from_slice(dictionary.as_bytes());
        out.extend_from_slice(data);
        out
    }

    fn dictionary(descr: &str, fortran: &str, shape: &str) -> String {
        format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n")
    }

    #[test]
    fn every_type_order_and_version_is_read() {
        let values = [0.5_f64, 0.25, 0.75, 0.125];
        let little: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let big: Vec<u8> = values.iter().flat_map(|v| v.to_be_bytes()).collect();
        let single: Vec<u8> = values
            .iter()
            .flat_map(|&v| (v as f32).to_be_bytes())
            .collect();
        let rows = vec![[0.5, 0.25], [0.75, 0.125]];
        let columns = vec![[0.5, 0.75], [0.25, 0.125]];
        for version in 1..=3 {
            for (descr, data) in [("<f8", &little), (">f8", &big), (">f4", &single)] {
                let c = file(version, &dictionary(descr, "False", "(2, 2)"), data);
                assert_eq!(read(&c).expect(descr).set.points, rows);
                let fortran = file(version, &dictionary(descr, "True", "(2L,2,)"), data);
                assert_eq!(read(&fortran).expect(descr).set.points, columns);
            }
        }
    }

    #[test]
    fn three_columns_are_read_where_z_is_0() {
        let bytes = |values: [f64; 6]| values.map(f64::to_le_bytes).concat();
        let in_rows = |z: f64| bytes([0.5, 0.25, 0.0, 0.75, 0.125, z]);
        let in_columns = |z: f64| bytes([0.5, 0.75, 0.25, 0.125, -0.0, z]);
        for (fortran, data) in [("False", in_rows(0.0)), ("True", in_columns(0.0))] {
            let flat = file(1, &dictionary("<f8", fortran, "(2, 3)"), &data);
            let points = read(&flat).expect(fortran).set.points;
            assert_eq!(points, [[0.5, 0.25], [0.75, 0.125]]);
        }
        for (fortran, data) in [("False", in_rows(0.6)), ("True", in_columns(0.6))] {
            let solid = file(1, &dictionary("<f8", fortran, "(2, 3)"), &data);
            assert_eq!(
                read(&solid).err().expect("not planar").to_string(),
                "NumPy array: point 1: z is 0.6, and only planar sets (z = 0) are read"
            );
        }
        let nan = file(1, &dictionary("<f8", "False", "(2, 3)"), &in_rows(f64::NAN));
        assert!(matches!(read(&nan), Err(FormatError::NotFinite { .. })));
    }

    #[test]
    fn written_data_are_aligned() {
        for count in [1, 9, 10, 12_345] {
            let bytes = write(&vec![[0.5, 0.5]; count], Precision::Double);
            assert_eq!((bytes.len() - count * 16) % ALIGNMENT, 0);
            assert_eq!(read(&bytes).expect("own file").set.len(), count);
        }
    }

    #[test]
    fn header_faults_are_named() {
        let message = |bytes: &[u8]| read(bytes).err().expect("refused").to_string();
        let data = [0; 16];
        let of = |d: &str, f: &str, s: &str| message(&file(1, &dictionary(d, f, s), &data));
        assert!(of("<i8", "False", "(1, 2)").contains("type <i8"));
        assert!(of("<f8", "Maybe", "(1, 2)").contains("fortran_order is Maybe"));
        assert!(of("<f8", "False", "(2,)").contains("shape (2,)"));
        assert!(of("<f8", "False", "(1, 4)").contains("shape (1, 4)"));
        assert!(of("<f8", "False", "(1, 3)").contains("24 bytes are needed"));
        assert!(of("<f8", "False", "(2, 2)").contains("32 bytes are needed"));
        assert!(of("<f8", "False", "(18446744073709551615, 2)").contains("truncated"));
        assert!(message(&file(4, "", &[])).contains("version 4"));
        assert!(message(&file(1, "{}", &[])).contains("no key 'descr'"));
        assert!(message(NPY_MAGIC).contains("truncated"));
        assert!(message(b"not numpy").contains("does not begin with"));
    }
}
