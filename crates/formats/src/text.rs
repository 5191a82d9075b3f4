//! Lines, fields and numbers of text formats, without allocating per line.
//!
//! Works on byte slices so that a stray non-UTF-8 byte is a typed error at its line. The meaning of a line is up to
//! each codec.

use std::borrow::Cow;
use std::io::Write;

use crate::error::{FilePlace, FormatError, quote};
use crate::format::Format;

/// Bytes without a UTF-8 byte-order mark, which Windows editors put before text.
pub(crate) fn without_bom(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)
}

/// Lines with their number from 1, trimmed of blanks. They end with LF, CRLF or CR.
pub(crate) fn lines(bytes: &[u8]) -> impl Iterator<Item = (u64, &[u8])> {
    let mut rest = without_bom(bytes);
    let each = std::iter::from_fn(move || {
        let text = Some(rest).filter(|text| !text.is_empty())?;
        let line;
        (line, rest) = split_line(text);
        Some(line.trim_ascii())
    });
    (1..).zip(each)
}

/// The first line without its end, and what follows it.
pub(crate) fn split_line(bytes: &[u8]) -> (&[u8], &[u8]) {
    let Some(end) = bytes.iter().position(|b| matches!(b, b'\n' | b'\r')) else {
        return (bytes, &[]);
    };
    let (line, rest) = bytes.split_at(end);
    (line, rest.strip_prefix(b"\r\n").unwrap_or(&rest[1..]))
}

/// How many of `bytes` are whole lines with their ends.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn whole_lines(bytes: &[u8]) -> usize {
    // A CR that is the last byte may be the first half of CRLF.
    let known = bytes.strip_suffix(b"\r").unwrap_or(bytes);
    let end = known.iter().rposition(|b| matches!(b, b'\n' | b'\r'));
    end.map_or(0, |end| end + 1)
}

/// Text as UTF-8: UTF-16 that begins with its byte-order mark and then with Latin text is converted, other bytes are
/// returned as they are.
pub(crate) fn as_utf8(bytes: &[u8]) -> Cow<'_, [u8]> {
    let unit: fn([u8; 2]) -> u16 = match bytes {
        [0xFF, 0xFE, ..] => u16::from_le_bytes,
        [0xFE, 0xFF, ..] => u16::from_be_bytes,
        _ => return Cow::Borrowed(bytes),
    };

    let (pairs, odd) = bytes[2..].as_chunks::<2>();
    let units = pairs.iter().map(|&pair| unit(pair));
    // Raw numbers may begin with the same two bytes, but 64 units in a row hardly look like text by chance.
    if !units.clone().take(64).all(is_of_tables) {
        return Cow::Borrowed(bytes);
    }

    let letters = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER));
    let mut text: String = letters.collect();
    if !odd.is_empty() {
        // Half a letter is left; it must not vanish, because a digit may be missing.
        text.push(char::REPLACEMENT_CHARACTER);
    }
    Cow::Owned(text.into_bytes())
}

/// Whether text may begin with this unit of UTF-16: numbers in binary files may begin with the mark, too, but hardly go on
/// with Latin letters, digits and blanks alone.
fn is_of_tables(unit: u16) -> bool {
    let letter = char::from_u32(u32::from(unit));
    // 0x250 is the first unit behind Unicode's Latin letters.
    unit < 0x250 && letter.is_some_and(|c| !c.is_control() || c.is_ascii_whitespace())
}

/// Lines that are neither blank nor a remark.
pub(crate) fn data_lines(bytes: &[u8]) -> impl Iterator<Item = (u64, &[u8])> {
    lines(bytes).filter(|(_, line)| !line.is_empty() && !is_remark(line))
}

/// Whether a line is a remark: it begins with `#`, `%` or `//`.
pub(crate) fn is_remark(line: &[u8]) -> bool {
    let line = line.trim_ascii_start();
    line.starts_with(b"#") || line.starts_with(b"%") || line.starts_with(b"//")
}

/// Fields between any blanks.
pub(crate) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace)
        .filter(|w| !w.is_empty())
}

/// The finite number that `token` spells.
///
/// Rust's own grammar (correctly rounded, so shortest decimals return their f64 to the bit). `inf`, `nan` and numbers
/// beyond the range of f64 are [`FormatError::NotFinite`].
pub(crate) fn number(token: &[u8], format: Format, place: FilePlace) -> Result<f64, FormatError> {
    let parsed = std::str::from_utf8(token)
        .ok()
        .and_then(|text| text.parse::<f64>().ok());
    match parsed {
        // Rust reads `inf` and `nan` as numbers, and 1e999 as infinite: these are no coordinates.
        Some(value) if value.is_finite() => Ok(value),
        Some(value) => Err(FormatError::NotFinite {
            format,
            place,
            value,
        }),
        None if has_decimal_comma(token) => Err(FormatError::DecimalComma {
            format,
            place,
            token: quote(token),
        }),
        None => Err(FormatError::NotANumber {
            format,
            place,
            token: quote(token),
        }),
    }
}

/// Whether `token` would be a number if its comma were a point.
fn has_decimal_comma(token: &[u8]) -> bool {
    let text = String::from_utf8_lossy(token);
    text.contains(',') && text.replacen(',', ".", 1).parse::<f64>().is_ok()
}

/// The first `N` fields of a line as numbers. Fails if there are fewer fields, if one of the first `N` is no finite
/// number, and, when `exact`, if there are more fields.
pub(crate) fn numbers<'a, const N: usize>(
    mut fields: impl Iterator<Item = &'a [u8]>,
    format: Format,
    line: u64,
    exact: bool,
) -> Result<[f64; N], FormatError> {
    let place = FilePlace::Line(line);
    let mut values = [0.0; N];
    for (found, value) in values.iter_mut().enumerate() {
        // The index of this value is the number of fields before it.
        let too_few = FormatError::Columns {
            format,
            place,
            found,
            expected: N,
        };
        *value = number(fields.next().ok_or(too_few)?, format, place)?;
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

/// Appends formatted text to bytes.
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
    fn lines_end_with_lf_crlf_or_cr() {
        let texts = |bytes| lines(bytes).map(|(_, line)| line).collect::<Vec<_>>();
        assert_eq!(texts(b"1\r2\r\n3\n\n5"), [&b"1"[..], b"2", b"3", b"", b"5"]);
        assert_eq!(texts(b"1\r\r"), [&b"1"[..], b""]);
        assert!(texts(b"").is_empty());
    }

    #[test]
    #[cfg(not(target_arch = "wasm32"))]
    fn pieces_end_with_whole_lines() {
        for (text, whole) in [
            (&b"1\n2"[..], 2),
            (b"1\r\n2\r", 3),
            (b"1\r2\r3", 4),
            (b"1\r\n", 3),
            (b"12", 0),
            (b"1\r", 0),
        ] {
            assert_eq!(whole_lines(text), whole, "{text:?}");
        }
    }

    #[test]
    fn utf_16_is_converted_and_floats_are_left_alone() {
        let encoded = |text: &str, unit: fn(u16) -> [u8; 2]| -> Vec<u8> {
            let marked = std::iter::once(0xFEFF).chain(text.encode_utf16());
            marked.flat_map(unit).collect()
        };
        let text = "x,y\r\n0.5,1\r\n";
        for unit in [u16::to_le_bytes, u16::to_be_bytes] {
            assert_eq!(as_utf8(&encoded(text, unit)), text.as_bytes());
        }

        let mut cut = encoded(text, u16::to_le_bytes);
        cut.pop();
        assert!(as_utf8(&cut).ends_with("\u{fffd}".as_bytes()));

        let float = [0xFF, 0xFE, 0x7F, 0x3F, 0, 0, 0, 0x3F];
        assert!(matches!(as_utf8(&float), Cow::Borrowed(bytes) if bytes == float));
        assert_eq!(as_utf8(b"plain"), &b"plain"[..]);
    }

    #[test]
    fn numbers_refuse_what_is_not_a_finite_number() {
        let parse = |token| number(token, Format::Xyz, FilePlace::Line(2));
        assert_eq!(parse(b"0.5").ok(), Some(0.5));
        for token in [&b"nan"[..], b"inf", b"1e999"] {
            assert!(matches!(parse(token), Err(FormatError::NotFinite { .. })));
        }
        for token in [&b"0,5"[..], b"-12,25e-3", b",5"] {
            assert!(matches!(
                parse(token),
                Err(FormatError::DecimalComma { .. })
            ));
        }
        for token in [&b"zero"[..], b"", b"1,000,000", b"\xFF\xFE", b"1e"] {
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
