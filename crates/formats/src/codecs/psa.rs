//! The two files of psa (point set analysis, Schlömer & Deussen).
//!
//! `.txt` begins with the number of points; `.rps` holds only f32 pairs. Both are of the unit torus.

use super::Raw;
use crate::binary::{self, Cursor, Endian};
use crate::error::{FilePlace, FormatError, quote};
use crate::format::{Format, Precision};
use crate::text::{data_lines, number, push, push_line, words};

/// Reads a text with the number of points and then their coordinates.
pub(super) fn read_text(bytes: &[u8]) -> Result<Raw, FormatError> {
    const FORMAT: Format = Format::PsaText;
    let mut tokens = data_lines(bytes)
        .flat_map(|(line, row)| words(row).map(move |word| (FilePlace::Line(line), word)));
    let Some((place, first)) = tokens.next() else {
        return Err(FormatError::Empty { format: FORMAT });
    };
    let stated = count(first, FORMAT, place)?;

    // Two digits, each with a blank or a line end, make a point take at least four bytes: a false count reserves no more.
    let mut points = Vec::with_capacity(stated.min(bytes.len() as u64 / 4) as usize);

    // The x of a point whose y is still to come, and its place. A point may go on in the next line, as psa reads number by
    // number.
    let mut lone_x = None;
    for (place, token) in tokens {
        let value = number(token, FORMAT, place)?;
        match lone_x.take() {
            Some((x, _)) => points.push([x, value]),
            None => lone_x = Some((value, place)),
        }
    }

    // From a file with a false count psa itself would read too few points, or garbage.
    let found = points.len() as u64;
    if found != stated {
        return Err(FormatError::Count {
            format: FORMAT,
            stated,
            found,
        });
    }

    // The count agrees with the points, so that the fault is where the coordinate is.
    if let Some((x, place)) = lone_x {
        return Err(FormatError::Row {
            format: FORMAT,
            place,
            reason: format!("after the {stated} points stated, a lone coordinate {x} is left"),
        });
    }

    Ok(Raw::new(points, Precision::Double))
}

/// Returns the text with only those of its pairs that are kept, each number as it was written.
pub(super) fn keep_text(bytes: &[u8], kept: &[bool]) -> Vec<u8> {
    let mut tokens = data_lines(bytes).flat_map(|(_, row)| words(row)).skip(1);
    let mut out = Vec::with_capacity(bytes.len() / 2);
    let count = kept.iter().filter(|kept| **kept).count();
    push(&mut out, format_args!("{count}\n"));
    for &is_kept in kept {
        // The two numbers of a point that is not kept are taken from the text, too.
        if let (true, Some(x), Some(y)) = (is_kept, tokens.next(), tokens.next()) {
            out.extend_from_slice(&[x, b" ", y, b"\n"].concat());
        }
    }
    out
}

fn count(token: &[u8], format: Format, place: FilePlace) -> Result<u64, FormatError> {
    let parsed = std::str::from_utf8(token).ok().and_then(|t| t.parse().ok());
    parsed.ok_or_else(|| FormatError::Header {
        format,
        place,
        reason: format!("\"{}\" is not a number of points", quote(token)),
    })
}

pub(super) fn write_text(points: &[[f64; 2]]) -> Vec<u8> {
    let mut out = Vec::with_capacity(points.len() * 40);
    push(&mut out, format_args!("{}\n", points.len()));
    for point in points {
        push_line(&mut out, point, " ");
    }
    out
}

pub(super) fn read_rps(bytes: &[u8]) -> Result<Raw, FormatError> {
    const FORMAT: Format = Format::PsaRps;
    let mut cursor = Cursor::new(bytes, 0, FORMAT);
    let data = cursor.records(bytes.len() as u64 / 8, 8)?;
    cursor.finish()?;
    let points = binary::pairs(data, 0, Precision::Single, Endian::Little, FORMAT)?;
    Ok(Raw::new(points, Precision::Single))
}

pub(super) fn write_rps(points: &[[f64; 2]]) -> Vec<u8> {
    let mut out = Vec::new();
    binary::push_pairs(&mut out, points, Precision::Single);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        read_text(text.as_bytes()).err().expect(text).to_string()
    }

    #[test]
    fn text_is_a_count_and_that_many_pairs() {
        let raw = read_text(b"2\r\n0.1 0.2\r\n0.3 0.4").expect("two points");
        assert_eq!(raw.set.points, [[0.1, 0.2], [0.3, 0.4]]);
        assert_eq!(write_text(&raw.set.points), b"2\n0.1 0.2\n0.3 0.4\n");
    }

    #[test]
    fn a_wrong_count_is_refused() {
        let stated = |n, found| format!("psa text: the file states {n} points and holds {found}");
        assert_eq!(message("3\n0 0\n1 1\n"), stated("3", 2));
        assert_eq!(message("1\n0 0\n1 1\n"), stated("1", 2));
        let vast = u64::MAX.to_string();
        assert_eq!(message(&format!("{vast}\n0 0\n")), stated(&vast, 1));
        assert_eq!(
            message("1\n0 0\n1\n"),
            "psa text: line 3: after the 1 points stated, a lone coordinate 1 is left"
        );
        assert_eq!(
            message("-4\n0 0\n"),
            "psa text: header, line 1: \"-4\" is not a number of points"
        );
    }

    #[test]
    fn rps_takes_whole_pairs() {
        let bytes = write_rps(&[[0.5, 0.25]]);
        assert_eq!(bytes, [0, 0, 0, 0x3F, 0, 0, 0x80, 0x3E]);
        assert_eq!(read_rps(&bytes).expect("a pair").set.points, [[0.5, 0.25]]);
        let ragged = read_rps(&bytes[..7]).err().expect("seven bytes");
        assert_eq!(
            ragged.to_string(),
            "psa RPS: 7 bytes follow the last point, at byte 0"
        );
    }
}
