//! Lines, fields and numbers of text formats, without allocating per line.
//!
//! Works on byte slices so that a stray non-UTF-8 byte is a typed error at its line. The meaning of a line is up to
//! each codec.

use std::io::Write;

use crate::error::{FilePlace, FormatError, quote};
use crate::format::Format;

/// Bytes without a UTF-8 byte-order mark, which Windows editors put before text.
pub(crate) fn without_bom(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)
}

/// Lines with their number from 1, trimmed of spaces and carriage returns.
pub(crate) fn lines(bytes: &[u8]) -> impl Iterator<Item = (u64, &[u8])> {
    without_bom(bytes)
        .split(|&b| b == b'\n')
        .zip(1..)
        .map(|(line, number)| (number, line.trim_ascii()))
}

/// Lines that are neither blank nor a `#` comment.
pub(crate) fn data_lines(bytes: &[u8]) -> impl Iterator<Item = (u64, &[u8])> {
    lines(bytes).filter(|(_, line)| !line.is_empty() && line[0] != b'#')
}

/// Fields between any blanks.
pub(crate) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace)
        .filter(|w| !w.is_empty())
}

/// The finite number that `token` spells.
///
/// Rust's own grammar (correctly rounded, so shortest decimals return their f64 to the bit). `inf` and `nan` are
/// [`FormatError::NotFinite`].
pub(crate) fn number(token: &[u8], format: Format, place: FilePlace) -> Result<f64, FormatError> {
    let parsed = std::str::from_utf8(token)
        .ok()
        .and_then(|text| text.parse::<f64>().ok());
    match parsed {
        Some(value) if value.is_finite() => Ok(value),
        Some(value) => Err(FormatError::NotFinite {
            format,
            place,
            value,
        }),
        None => Err(FormatError::NotANumber {
            format,
            place,
            token: quote(token),
        }),
    }
}

/// The first `N` fields of `fields` as numbers; extra fields are an error when `exact`.
pub(crate) fn numbers<'a, const N: usize>(
    mut fields: impl Iterator<Item = &'a [u8]>,
    format: Format,
    line: u64,
    exact: bool,
) -> Result<[f64; N], FormatError> {
    let place = FilePlace::Line(line);
    let mut values = [0.0; N];
    for (found, value) in values.iter_mut().enumerate() {
        let columns = FormatError::Columns {
            format,
            place,
            found,
            expected: N,
        };
        *value = number(fields.next().ok_or(columns)?, format, place)?;
    }
    let extra = if exact { fields.count() } else { 0 };
    if extra > 0 {
        return Err(FormatError::Columns {
            format,
            place,
            found: N + extra,
            expected: N,
        });
    }
    Ok(values)
}

/// Appends the shortest decimals which read back as `values`, between `separator`s, and a newline.
pub(crate) fn push_line(out: &mut Vec<u8>, values: &[f64], separator: &str) {
    for (index, value) in values.iter().enumerate() {
        let before = if index == 0 { "" } else { separator };
        push(out, format_args!("{before}{value}"));
    }
    out.push(b'\n');
}

/// Appends formatted text.
pub(crate) fn push(out: &mut Vec<u8>, text: std::fmt::Arguments<'_>) {
    // Writing to a Vec cannot fail: its io::Write only ever grows the buffer.
    let _ = out.write_fmt(text);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_bear_bom_crlf_blanks_and_a_missing_newline() {
        let found: Vec<_> = data_lines(b"\xEF\xBB\xBF1 2 \r\n\r\n# note\r\n\t3  4").collect();
        assert_eq!(found, [(1, &b"1 2"[..]), (4, &b"3  4"[..])]);
        assert_eq!(words(b"3 \t 4").count(), 2);
    }

    #[test]
    fn numbers_refuse_what_is_not_a_finite_number() {
        let parse = |token| number(token, Format::Xyz, FilePlace::Line(2));
        assert_eq!(parse(b"0.5").ok(), Some(0.5));
        for token in [&b"nan"[..], b"inf", b"1e999"] {
            assert!(matches!(parse(token), Err(FormatError::NotFinite { .. })));
        }
        for token in [&b"zero"[..], b"", b"0,5", b"\xFF\xFE", b"1e"] {
            assert!(matches!(parse(token), Err(FormatError::NotANumber { .. })));
        }
    }

    #[test]
    fn columns_are_counted() {
        let three = |exact| numbers::<2>(words(b"1 2 3"), Format::UtkText, 9, exact);
        assert_eq!(three(false).ok(), Some([1.0, 2.0]));
        assert!(matches!(
            three(true),
            Err(FormatError::Columns { found: 3, .. })
        ));
    }
}
