//! Fields of a row: what separates them, and quotation marks.

use crate::text::words;

/// What separates the fields of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Separator {
    Comma,
    Semicolon,
    Tab,
    /// Any number of blanks.
    Blank,
}

impl Separator {
    /// The separator of a row, by what it holds outside quotation marks.
    ///
    /// Tabs and semicolons are tried before commas, since a comma beside them may be a decimal comma. So may a comma
    /// beside blanks: in `0,5 0,25` the blank separates, and in `0.5, 0.25` the comma does.
    pub fn of(row: &[u8]) -> Self {
        let outside: Vec<u8> = outside_quotes(row).collect();
        // A tab may be one of several blanks, and a comma a decimal one, so that neither separates if a part between
        // two of them holds several numbers. A semicolon is nothing but a separator.
        let splits = |by: u8| outside.contains(&by) && !outside.split(|&b| b == by).any(is_row);
        if splits(b'\t') {
            Self::Tab
        } else if outside.contains(&b';') {
            Self::Semicolon
        } else if splits(b',') {
            Self::Comma
        } else {
            Self::Blank
        }
    }

    /// The separator that a line such as `sep=;` states; `None` for other lines. The inner error is what stands in the
    /// place of a separator.
    pub fn stated(line: &[u8]) -> Option<Result<Self, &[u8]>> {
        // Blanks are not trimmed: one of them may be the separator.
        let inner = line
            .strip_prefix(b"\"")
            .and_then(|inner| inner.strip_suffix(b"\""));
        let key = b"sep=";
        let (start, value) = inner.unwrap_or(line).split_at_checked(key.len())?;
        if !start.eq_ignore_ascii_case(key) {
            return None;
        }
        Some(match value {
            b"," => Ok(Self::Comma),
            b";" => Ok(Self::Semicolon),
            // Some write a tab as the two characters \t.
            b"\t" | b"\\t" => Ok(Self::Tab),
            b" " => Ok(Self::Blank),
            other => Err(other),
        })
    }

    /// The byte between two fields; between words, one of several that may be there.
    pub fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab => b'\t',
            Self::Blank => b' ',
        }
    }
}

/// The bytes of a row outside of its quotation marks.
fn outside_quotes(row: &[u8]) -> impl Iterator<Item = u8> {
    // The first part lies outside, the second one inside, and so on by turns.
    let parts = row.split(|&b| b == b'"').step_by(2);
    parts.flatten().copied()
}

/// Whether a part of a row has several numbers, so that it is no field.
fn is_row(part: &[u8]) -> bool {
    words(part).count() > 1 && words(part).all(looks_numeric)
}

/// Whether a field is a number or was meant to be one, such as `0,5` or `1.0D-02`.
pub(crate) fn looks_numeric(field: &[u8]) -> bool {
    let field = unquoted(field);
    // `inf` and `NaN` are numbers that begin with a letter.
    let parses = || std::str::from_utf8(field).is_ok_and(|text| text.parse::<f64>().is_ok());
    matches!(field.first(), Some(b'0'..=b'9' | b'+' | b'-' | b'.')) || parses()
}

/// A field without blanks and quotation marks around it.
pub(crate) fn unquoted(field: &[u8]) -> &[u8] {
    let field = field.trim_ascii();
    let inner = field
        .strip_prefix(b"\"")
        .and_then(|inner| inner.strip_suffix(b"\""));
    inner.map_or(field, <[u8]>::trim_ascii)
}

/// Splits rows that have quotation marks, by the `csv` crate's parser.
#[derive(Clone, Debug)]
pub(crate) struct QuotedRow {
    separator: Separator,
    parser: csv_core::Reader,
    line: Vec<u8>,
    /// The contents of the fields, without quotation marks, one after another.
    contents: Vec<u8>,
    ends: Vec<usize>,
}

impl QuotedRow {
    pub fn new(separator: Separator) -> Self {
        let delimiter = separator.byte();
        Self {
            separator,
            parser: csv_core::ReaderBuilder::new().delimiter(delimiter).build(),
            line: Vec::new(),
            contents: Vec::new(),
            ends: Vec::new(),
        }
    }

    /// Takes a row; false if a quotation mark is still open at its end.
    pub fn take(&mut self, row: &[u8]) -> bool {
        self.line.clear();
        self.line.extend_from_slice(row);
        self.line.push(b'\n');
        // A row has no more contents than bytes, and no more fields.
        self.contents.resize(self.line.len(), 0);
        self.ends.resize(self.line.len() + 1, 0);

        self.parser.reset();
        let (result, _read, _written, count) =
            (self.parser).read_record(&self.line, &mut self.contents, &mut self.ends);
        self.ends.truncate(count);
        result == csv_core::ReadRecordResult::Record
    }

    /// The fields of the row. Several blanks separate fields as one does.
    pub fn fields(&self) -> impl Iterator<Item = &[u8]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        let fields = starts.zip(&self.ends);
        let by_blanks = self.separator == Separator::Blank;
        fields
            .map(|(start, &end)| &self.contents[start..end])
            .filter(move |field| !(by_blanks && field.is_empty()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_separator_is_seen_in_the_row() {
        for (row, separator) in [
            ("0.5,0.25", Separator::Comma),
            ("0.5, 0.25", Separator::Comma),
            ("12,5,7,3", Separator::Comma),
            ("x [m],y [m]", Separator::Comma),
            ("\"a;b\",x,y", Separator::Comma),
            ("0,5;0,25", Separator::Semicolon),
            ("x;y", Separator::Semicolon),
            ("0,5\t0,25", Separator::Tab),
            ("X coord\tY coord", Separator::Tab),
            ("0,5 0,25", Separator::Blank),
            ("0,5 12", Separator::Blank),
            ("X Y Z", Separator::Blank),
            ("0.1 0.2\t0.3", Separator::Blank),
            ("0.5", Separator::Blank),
        ] {
            assert_eq!(Separator::of(row.as_bytes()), separator, "{row}");
        }
    }

    #[test]
    fn a_first_line_may_state_the_separator() {
        assert_eq!(Separator::stated(b"sep=;"), Some(Ok(Separator::Semicolon)));
        assert_eq!(Separator::stated(b"\"SEP=,\""), Some(Ok(Separator::Comma)));
        assert_eq!(Separator::stated(b"sep=\t"), Some(Ok(Separator::Tab)));
        assert_eq!(Separator::stated(b"sep=|"), Some(Err(&b"|"[..])));
        assert_eq!(Separator::stated(b"separator,x,y"), None);
        assert_eq!(Separator::stated(b"x"), None);
    }

    #[test]
    fn quotation_marks_hold_a_field_together() {
        let mut quoted = QuotedRow::new(Separator::Comma);
        assert!(quoted.take(b"\"0.5\",\"a, \"\"b\"\"\",7"));
        assert!(quoted.fields().eq([&b"0.5"[..], b"a, \"b\"", b"7"]));
        assert!(!quoted.take(b"0.5,\"red"));
        assert!(quoted.take(b"0.5,0.25"));
        assert!(quoted.fields().eq([&b"0.5"[..], b"0.25"]));

        let mut words = QuotedRow::new(Separator::Blank);
        assert!(words.take(b"\"x\"  \"y z\""));
        assert!(words.fields().eq([&b"x"[..], b"y z"]));
    }
}
