//! The two files of UTK (the sampling toolkit of Coeurjolly, Ostromoukhov et al.).
//!
//! Text: `x y` a line, `#` between sets. Binary: a 20-byte header, then rows. Both are of the unit torus and may hold
//! several sets. If there are several, the caller must choose one.

use super::Raw;
use crate::binary::{self, Cursor, Endian};
use crate::detect::UTK_MAGIC;
use crate::error::{FilePlace, FormatError};
use crate::format::{Format, Precision};
use crate::text::{is_remark, lines, numbers, push_line, words};

/// Type codes of UTK's `DATATYPE`: the metadata's byte 0.
const TYPE_FLOAT: u8 = 4;
const TYPE_DOUBLE: u8 = 5;
/// Magic, metadata, number of sets, number of points, dimension.
pub(super) const HEADER_BYTES: u64 = 20;

/// Reads the chosen set of a text with one or more sets.
pub(super) fn read_text(bytes: &[u8], chosen: Option<usize>) -> Result<Raw, FormatError> {
    let (points, found) = text_of(bytes, chosen)?;
    let mut raw = Raw::new(points, Precision::Double);
    raw.sets = found;
    Ok(raw)
}

/// Returns the chosen set of a text, with the given number of coordinates a point, and how many sets there are.
pub(super) fn text_of<const N: usize>(
    bytes: &[u8],
    chosen: Option<usize>,
) -> Result<(Vec<[f64; N]>, usize), FormatError> {
    const FORMAT: Format = Format::UtkText;
    let mut sets = vec![Vec::new()];
    // A row of more numbers is refused.
    let exact = true;
    // A line that begins with # separates two sets; remarks that begin with another sign are passed over.
    let is_other_remark = |row: &[u8]| is_remark(row) && row[0] != b'#';
    for (line, row) in lines(bytes).filter(|(_, row)| !row.is_empty() && !is_other_remark(row)) {
        let last = sets.last_mut();
        match last {
            Some(set) if row[0] != b'#' => set.push(numbers(words(row), FORMAT, line, exact)?),
            // Like UTK, ignores empty sets: separators at the beginning, or several in a row.
            Some(set) if set.is_empty() => {}
            // A separator behind a set begins the next one.
            _ => sets.push(Vec::new()),
        }
    }

    // A separator at the end is followed by no set.
    sets.retain(|set| !set.is_empty());

    let found = sets.len();
    if found == 0 {
        return Err(FormatError::Empty { format: FORMAT });
    }

    let index = choose(found, chosen, FORMAT)?;
    Ok((sets.swap_remove(index), found))
}

/// Returns the chosen set with only those of its lines that are kept.
pub(super) fn keep_text(bytes: &[u8], chosen: Option<usize>, kept: &[bool]) -> Vec<u8> {
    let mut out = Vec::with_capacity(bytes.len() / 2);
    // Sets are divided as when they are read: a separator ends a set that is not empty. Without a choice there is only
    // one set.
    let (mut set, mut is_begun, mut flags) = (0, false, kept.iter());
    for (_, row) in lines(bytes).filter(|(_, row)| !row.is_empty()) {
        // Remarks of other programs separate no sets.
        if !is_remark(row) {
            is_begun = true;
            if set == chosen.unwrap_or(0) && flags.next().is_some_and(|kept| *kept) {
                out.extend_from_slice(&[row, b"\n"].concat());
            }
        } else if row[0] == b'#' && is_begun {
            (set, is_begun) = (set + 1, false);
        }
    }
    out
}

/// Returns the chosen set with only those of its rows that are kept.
pub(super) fn keep_binary(
    bytes: &[u8],
    chosen: Option<usize>,
    kept: &[bool],
) -> Result<Vec<u8>, FormatError> {
    // A file of dimension 3 is laid out like one of dimension 2, but with a third number in each row. The head says
    // which of the two it is.
    let (solid, planar) = (3, 2);
    let axes = match read_head_of(bytes, solid) {
        Ok(_) => solid,
        Err(_) => planar,
    };
    let UtkHead { precision, .. } = read_head_of(bytes, axes)?;
    let count = kept.iter().filter(|kept| **kept).count() as u64;
    let width = axes as usize * precision.bytes();
    // All sets have as many points as the chosen one, of which `kept` has a flag each; without a choice there is only
    // one set.
    let begin = HEADER_BYTES as usize + chosen.unwrap_or(0) * kept.len() * width;
    let data = bytes.get(begin..).unwrap_or_default();
    let mut out = head(count, precision)?;
    set_dimension(&mut out, axes);
    out.extend(super::kept::rows(data, width, kept));
    Ok(out)
}

fn choose(found: usize, chosen: Option<usize>, format: Format) -> Result<usize, FormatError> {
    match chosen {
        None if found == 1 => Ok(0),
        Some(index) if index < found => Ok(index),
        _ => Err(FormatError::Sets {
            format,
            found,
            chosen,
        }),
    }
}

pub(super) fn write_text(points: &[[f64; 2]]) -> Vec<u8> {
    let mut out = Vec::with_capacity(points.len() * 40);
    for point in points {
        push_line(&mut out, point, " ");
    }
    out
}

/// The head of a binary file.
pub(super) struct UtkHead {
    pub precision: Precision,
    pub sets: u32,
    /// Points of each set.
    pub count: u32,
}

/// The head of a file that begins with `bytes`; data begin at [`HEADER_BYTES`].
pub(super) fn read_head(bytes: &[u8]) -> Result<UtkHead, FormatError> {
    read_head_of(bytes, 2)
}

/// The head of a file of sets of the `wanted` dimension.
fn read_head_of(bytes: &[u8], wanted: u32) -> Result<UtkHead, FormatError> {
    const FORMAT: Format = Format::UtkBinary;
    if !bytes.starts_with(UTK_MAGIC) {
        return Err(FormatError::Magic {
            format: FORMAT,
            expected: "\"UTK!\" (0x214B5455)",
        });
    }

    let mut cursor = Cursor::new(bytes, UTK_MAGIC.len(), FORMAT);
    // The first of four bytes of metadata is the number type. The others do not matter here.
    let precision = precision_of(cursor.take(4)?[0])?;
    let (sets, count, dimension) = (cursor.u32()?, cursor.u32()?, cursor.u32()?);

    // The rows of another dimension have other lengths.
    if dimension != wanted {
        return Err(FormatError::Unsupported {
            format: FORMAT,
            what: format!("a set of dimension {dimension}"),
            supported: match wanted {
                2 => "only dimension 2 is; on the command line --depth reads dimension 3",
                _ => "a set in space has dimension 3",
            },
        });
    }
    if sets == 0 || count == 0 {
        return Err(FormatError::Empty { format: FORMAT });
    }

    Ok(UtkHead {
        precision,
        sets,
        count,
    })
}

pub(super) fn read_binary(bytes: &[u8], chosen: Option<usize>) -> Result<Raw, FormatError> {
    const FORMAT: Format = Format::UtkBinary;
    let head = read_head(bytes)?;
    let data = set_of(bytes, &head, 2, chosen)?;
    let UtkHead {
        precision, sets, ..
    } = head;
    let points = binary::pairs(data, 0, precision, Endian::Little, FORMAT)?;
    let mut raw = Raw::new(points, precision);
    raw.sets = sets as usize;
    Ok(raw)
}

/// Returns the rows of the chosen set of a binary file, each with this number of coordinates.
fn set_of<'a>(
    bytes: &'a [u8],
    head: &UtkHead,
    coordinates: usize,
    chosen: Option<usize>,
) -> Result<&'a [u8], FormatError> {
    let mut cursor = Cursor::new(bytes, HEADER_BYTES as usize, Format::UtkBinary);
    let row = (coordinates * head.precision.bytes()) as u64;
    let data = cursor.records(u64::from(head.sets) * u64::from(head.count), row)?;
    cursor.finish()?;

    // The sets lie one after another and are of one length.
    let index = choose(head.sets as usize, chosen, Format::UtkBinary)?;
    let set_bytes = data.len() / head.sets as usize;
    Ok(&data[index * set_bytes..][..set_bytes])
}

/// Reads points in space from a binary file of dimension 3.
pub(super) fn read_solid_binary(
    bytes: &[u8],
    chosen: Option<usize>,
) -> Result<(Vec<[f64; 3]>, Precision), FormatError> {
    let head = read_head_of(bytes, 3)?;
    let size = head.precision.bytes();
    let rows = set_of(bytes, &head, 3, chosen)?.chunks_exact(3 * size);
    let point = |(row, index): (&[u8], u64)| {
        let value = |axis: usize| {
            let value =
                binary::coordinate(&row[axis * size..][..size], head.precision, Endian::Little);
            binary::finite(value, Format::UtkBinary, index)
        };
        Ok([value(0)?, value(1)?, value(2)?])
    };
    // An error counts points from the first one of the chosen set.
    let points: Result<_, FormatError> = rows.zip(0..).map(point).collect();
    Ok((points?, head.precision))
}

/// Writes points in space as one set of dimension 3.
pub(super) fn write_solid_binary(
    points: &[[f64; 3]],
    precision: Precision,
) -> Result<Vec<u8>, FormatError> {
    let mut out = head(points.len() as u64, precision)?;
    set_dimension(&mut out, 3);
    binary::push(&mut out, points.as_flattened(), precision);
    Ok(out)
}

/// Replaces the dimension in the head of a file: the head's last word.
fn set_dimension(head: &mut Vec<u8>, axes: u32) {
    head.truncate(HEADER_BYTES as usize - 4);
    head.extend_from_slice(&axes.to_le_bytes());
}

/// Returns the precision of a type's code.
fn precision_of(code: u8) -> Result<Precision, FormatError> {
    match code {
        TYPE_FLOAT => Ok(Precision::Single),
        TYPE_DOUBLE => Ok(Precision::Double),
        0..=3 => Err(FormatError::Unsupported {
            format: Format::UtkBinary,
            what: format!("the integer type {code}"),
            supported: "types 4 (f32) and 5 (f64) are",
        }),
        _ => Err(FormatError::Header {
            format: Format::UtkBinary,
            // The type's code follows the four bytes of the magic number.
            place: FilePlace::Offset(4),
            reason: format!("the type is {code}; UTK has 0 to 5"),
        }),
    }
}

pub(super) fn write_binary(
    points: &[[f64; 2]],
    precision: Precision,
) -> Result<Vec<u8>, FormatError> {
    let mut out = head(points.len() as u64, precision)?;
    binary::push_pairs(&mut out, points, precision);
    Ok(out)
}

/// The head of a file of one set of `count` points in the plane.
pub(super) fn head(count: u64, precision: Precision) -> Result<Vec<u8>, FormatError> {
    let count = u32::try_from(count).map_err(|_| FormatError::TooMany {
        format: Format::UtkBinary,
        points: count as usize,
        limit: u64::from(u32::MAX),
    })?;

    let code = match precision {
        Precision::Single => TYPE_FLOAT,
        Precision::Double => TYPE_DOUBLE,
    };

    let mut out = Vec::with_capacity(HEADER_BYTES as usize);
    out.extend_from_slice(UTK_MAGIC);
    // The metadata: the type, and three bytes that no reader here needs.
    out.extend_from_slice(&[code, 0, 0, 0]);
    // The numbers of sets, of points and of dimensions.
    for word in [1, count, 2] {
        out.extend_from_slice(&word.to_le_bytes());
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_of_several_text_sets_must_be_chosen() {
        let text = b"# made by UTK\n0 0\n#\n#\n0.5 0.5\n0.25 0.5\n#\n";
        let error = read_text(text, None).err().expect("two sets");
        assert!(matches!(error, FormatError::Sets { found: 2, .. }));
        assert!(read_text(text, Some(2)).is_err());
        let second = read_text(text, Some(1)).expect("the second set");
        assert_eq!(second.set.points, [[0.5, 0.5], [0.25, 0.5]]);
        assert_eq!(second.sets, 2);
    }

    #[test]
    fn text_lines_hold_two_columns() {
        let error = read_text(b"0 0\n0 0 0\n", None).err().expect("3 columns");
        assert_eq!(
            error.to_string(),
            "UTK text: line 2: 3 columns where 2 are needed"
        );
    }

    #[test]
    fn binary_header_is_as_utk_writes_it() {
        let bytes = write_binary(&[[0.5, 0.25]], Precision::Single).expect("one point");
        assert_eq!(bytes[..8], [0x55, 0x54, 0x4B, 0x21, 4, 0, 0, 0]);
        assert_eq!(bytes[8..20], [1, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
        assert_eq!(bytes.len(), 28);
    }

    #[test]
    fn binary_header_faults_are_named() {
        let good = write_binary(&[[0.5, 0.25]], Precision::Double).expect("one point");
        let message = |at: usize, value: u8| {
            let mut bytes = good.clone();
            bytes[at] = value;
            read_binary(&bytes, None)
                .err()
                .expect("refused")
                .to_string()
        };
        assert!(message(0, 0).contains("does not begin with"));
        assert!(message(4, 2).contains("integer type 2"));
        assert!(message(4, 9).contains("the type is 9"));
        assert!(message(12, 9).contains("144 bytes are needed"));
        assert!(message(15, 0xFF).contains("truncated"));
        assert!(message(16, 3).contains("dimension 3"));
        assert!(message(12, 0).contains("no points"));
    }

    #[test]
    fn the_chosen_binary_set_is_read() {
        let mut bytes =
            write_binary(&[[0.5, 0.25], [0.75, 0.125]], Precision::Double).expect("two");
        bytes[8] = 2;
        bytes[12] = 1;
        assert!(read_binary(&bytes, None).is_err());
        let second = read_binary(&bytes, Some(1)).expect("the second set");
        assert_eq!(second.set.points, [[0.75, 0.125]]);
    }
}
