//! Words from others, such as names of files and learners, made safe for terminals, logs and spreadsheets.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::fmt::Write as _;

/// Returns a text in which every character that a terminal or a log would obey, rather than show, is an escape: control
/// characters except line feeds and tabs, and the marks that change the direction of the words around them.
///
/// An escape is a backslash, `u` and four hexadecimal digits, as in JSON: a JSON object stays one with the same content.
///
/// ```
/// use tilescope_analysis::shown;
/// assert_eq!(shown("a\u{1b}[2Jb\n"), "a\\u001b[2Jb\n");
/// ```
#[must_use]
pub fn shown(text: &str) -> Cow<'_, str> {
    escaped(text, |c| is_obeyed(c) && !matches!(c, '\n' | '\t'))
}

/// Returns a text as [`shown`] does, with line feeds and tabs as escapes, too: a word in one line of a message, which
/// must not begin a line of its own.
///
/// ```
/// use tilescope_analysis::shown_in_line;
/// assert_eq!(shown_in_line("a\nverdict  valid"), "a\\u000averdict  valid");
/// ```
#[must_use]
pub fn shown_in_line(text: &str) -> Cow<'_, str> {
    escaped(text, is_obeyed)
}

/// Returns whether terminals obey a character: they move the cursor, colour, ring, begin a line, or turn the direction
/// of the words around it.
fn is_obeyed(c: char) -> bool {
    // The line and paragraph separators, the embeddings and overrides of direction, and its isolates.
    let turns = matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || turns
}

/// Returns a text in which the characters that must be escaped, which have at most four hexadecimal digits, are written
/// as `\uXXXX`.
fn escaped(text: &str, must_be: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&must_be) {
        return Cow::Borrowed(text);
    }

    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if must_be(c) {
            // Writing to a text does not fail.
            let _ = write!(out, "\\u{:04x}", u32::from(c));
        } else {
            out.push(c);
        }
    }
    Cow::Owned(out)
}

/// Returns a name of the system as text. A name that is not UTF-8 has U+FFFD for bytes that are no text, and says so
/// before it: its end, by which a file's format is known, stays.
///
/// ```
/// use tilescope_analysis::lossy;
/// assert_eq!(lossy("set.csv".as_ref()), "set.csv");
/// ```
#[must_use]
pub fn lossy(name: &OsStr) -> Cow<'_, str> {
    match name.to_string_lossy() {
        Cow::Borrowed(whole) => Cow::Borrowed(whole),
        Cow::Owned(part) => Cow::Owned(format!("(not UTF-8) {part}")),
    }
}

/// The first character of a table that people open in a spreadsheet. Without it Excel reads the text in another
/// encoding than UTF-8.
pub const BYTE_ORDER_MARK: char = '\u{feff}';

/// Returns the text of a cell in a table that people open in a spreadsheet. What a spreadsheet would take for a formula
/// gets an apostrophe before it; numbers stay as they are.
///
/// Formulas begin with `=`, `+`, `-` or `@`, in ASCII or in full width, at the beginning of the cell, behind a tab or a
/// line end, and behind a semicolon, at which spreadsheets of many countries divide the cells of a comma-separated file.
/// A text that begins with one of these dividers gets an apostrophe in any case.
///
/// ```
/// use tilescope_analysis::cell;
/// assert_eq!(cell("=1+1"), "'=1+1");
/// assert_eq!(cell("-0.5"), "-0.5");
/// ```
#[must_use]
pub fn cell(text: &str) -> Cow<'_, str> {
    let is_number = text.parse::<f64>().is_ok_and(f64::is_finite);
    let begins = |c: char| "=+-@\u{ff1d}\u{ff0b}\u{ff0d}\u{ff20}".contains(c);
    let divides = |c: char| matches!(c, '\t' | '\r' | '\n' | ';');
    if is_number || !text.contains(begins) && !text.starts_with(divides) {
        return Cow::Borrowed(text);
    }

    let mut out = String::with_capacity(text.len() + 8);
    // Spreadsheets drop a tab or a line end at the beginning, and look at what follows. Behind a semicolon a cell
    // begins, too.
    if text.starts_with(divides) {
        out.push('\'');
    }
    let mut at_start = true;
    for c in text.chars() {
        if at_start && begins(c) {
            out.push('\'');
        }
        out.push(c);
        // Blanks and quotation marks behind a divider may be dropped, too.
        at_start = divides(c) || at_start && matches!(c, ' ' | '"');
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_character_that_terminals_obey_is_left() {
        for code in (0..0x20).chain(0x7f..0xa0).chain([0x202e, 0x2066, 0x2028]) {
            let c = char::from_u32(code).expect("no surrogate");
            let text = format!("a{c}b");
            let escape = format!("a\\u{code:04x}b");
            assert_eq!(shown_in_line(&text), escape);

            // A text of several lines keeps its lines and columns.
            let expected = if "\n\t".contains(c) { &text } else { &escape };
            assert_eq!(&shown(&text), expected);
        }
        for text in ["", "Jürgen 点集 🙂 \u{200f}א", "\\u001b"] {
            assert_eq!(
                (shown(text), shown_in_line(text)),
                (text.into(), text.into())
            );
        }
    }

    #[cfg(unix)]
    #[test]
    fn names_that_are_not_utf8_say_so() {
        use std::os::unix::ffi::OsStrExt as _;
        let name = OsStr::from_bytes(b"a\xff.csv");
        assert_eq!(lossy(name), "(not UTF-8) a\u{fffd}.csv");
        assert_eq!(lossy("a\u{fffd}.csv".as_ref()), "a\u{fffd}.csv");
    }

    #[test]
    fn formulas_are_texts_in_spreadsheets() {
        for (text, expected) in [
            ("=HYPERLINK(\"x\")", "'=HYPERLINK(\"x\")"),
            ("+1+cmd|' /C calc'!A0", "'+1+cmd|' /C calc'!A0"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("-x", "'-x"),
            ("-inf", "'-inf"),
            ("  =1", "  '=1"),
            ("\t=1", "'\t'=1"),
            ("\r", "'\r"),
            ("a;=1", "a;'=1"),
            ("a;\"=1", "a;\"'=1"),
            ("a\n-b", "a\n'-b"),
            ("\u{ff1d}1", "'\u{ff1d}1"),
        ] {
            assert_eq!(cell(text), expected);
        }
        for text in ["", "Ada", "a=b", "1-2", "-0.5", "+1e3", "a - b", "x; y"] {
            assert_eq!(cell(text), text);
        }
    }
}
