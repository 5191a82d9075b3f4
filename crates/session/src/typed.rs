//! Numbers as people type them in fields: thousands apart, with a decimal comma or an exponent. Begin with [`number`].
//!
//! One rule for every field: a comma before groups of three digits separates thousands, as in the numbers that the program
//! shows; any other single comma is a decimal comma.

/// The largest whole number up to which every whole number is an `f64`: 2^53.
const MAX_EXACT: f64 = 9_007_199_254_740_992.0;

/// Returns whether a character separates thousands wherever it stands between two digits: blanks of any width, which
/// people paste from other programs, apostrophes, as the Swiss write, and underscores.
const fn separates(c: char) -> bool {
    matches!(
        c,
        ' ' | '\u{a0}' | '\u{2009}' | '\u{202f}' | '\'' | '\u{2019}' | '_'
    )
}

/// Returns whether the parts of a number without its sign are thousands: up to three digits that begin with no 0, then
/// groups of three.
fn are_thousands<'a>(mut parts: impl Iterator<Item = &'a str>) -> bool {
    let is_digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    // A number has at least one part, even if that is empty.
    let first = parts.next().unwrap_or_default();
    // "0,125" has a decimal comma: no number of thousands begins with 0.
    let leads = is_digits(first) && first.len() <= 3 && !first.starts_with('0');
    leads && parts.all(|part| is_digits(part) && part.len() == 3)
}

/// Returns a typed number as Rust writes numbers, or `None` if blanks, apostrophes or underscores separate anything but
/// thousands. Other texts that are no numbers stay such, and are refused where the result is read.
fn plain(text: &str) -> Option<String> {
    let text = text.trim();
    // Rust reads only the hyphen as the sign of a negative number.
    let (sign, size) = match text.strip_prefix(['+', '-', '\u{2212}']) {
        Some(size) if text.starts_with('+') => ("", size),
        Some(size) => ("-", size),
        None => ("", text),
    };

    // Thousands are separated only in the whole part. From a point or an exponent on, the text stays as it is.
    let end = size.find(['.', 'e', 'E']).unwrap_or(size.len());
    let (whole, rest) = size.split_at(end);

    let mut whole = whole.to_owned();
    if whole.contains(separates) {
        // A decimal comma ends the groups of thousands.
        let groups = whole.split(',').next().unwrap_or_default();
        if !are_thousands(groups.split(separates)) {
            return None;
        }
        whole.retain(|c| !separates(c));
        // "1 000,5": after these separators a comma can only be a decimal one, unless there is a point as well.
        if whole.matches(',').count() == 1 && !rest.starts_with('.') {
            whole = whole.replace(',', ".");
        }
    } else if are_thousands(whole.split(',')) {
        // Commas before groups of three digits separate thousands, as in "1,000".
        whole.retain(|c| c != ',');
    } else if whole.matches(',').count() == 1 && !rest.starts_with('.') {
        // "0,5": any other single comma is a decimal one, unless there is a point as well.
        whole = whole.replace(',', ".");
    }
    Some(format!("{sign}{whole}{rest}"))
}

/// Returns the finite number that a text says: `1e6`, `1,000,000`, `1 000 000`, `0,125` and `1'000.5` are numbers; `None`
/// for a text that is no number.
#[must_use]
pub fn number(text: &str) -> Option<f64> {
    let number = plain(text)?.parse::<f64>().ok()?;
    number.is_finite().then_some(number)
}

/// Returns the whole number from 0 on that a text says, in the forms of [`number`]; `None` for any other text.
#[must_use]
pub fn whole(text: &str) -> Option<u64> {
    let plain = plain(text)?;
    plain.parse().ok().or_else(|| {
        let number = number(text)?;
        // A larger number with an exponent might be another whole number than the one meant.
        let is_whole = number.fract() == 0.0 && (0.0..=MAX_EXACT).contains(&number);
        is_whole.then_some(number as u64)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_people_type_them() {
        for (text, value) in [
            ("7", 7.0),
            (" 0.00836 ", 0.008_36),
            (".5", 0.5),
            ("1e6", 1e6),
            ("1E-3", 1e-3),
            ("1,5e3", 1500.0),
            ("-1", -1.0),
            ("\u{2212}2", -2.0),
            ("+3", 3.0),
            // Thousands.
            ("1,000", 1e3),
            ("20,041", 20_041.0),
            ("1,000,000", 1e6),
            ("1,000.5", 1000.5),
            ("1 000 000", 1e6),
            ("1\u{a0}000", 1e3),
            ("1\u{2009}000\u{2009}000", 1e6),
            ("1\u{202f}000", 1e3),
            ("1'000.25", 1000.25),
            ("1\u{2019}000", 1e3),
            ("1_000", 1e3),
            ("1 000,5", 1000.5),
            ("1 000,5e3", 1_000_500.0),
            // Decimal commas.
            ("0,01", 0.01),
            ("0,125", 0.125),
            ("12,5", 12.5),
            ("1,0000", 1.0),
        ] {
            assert_eq!(number(text), Some(value), "{text:?}");
        }
    }

    #[test]
    fn texts_that_are_no_number_are_refused() {
        for text in [
            "",
            "one",
            ",",
            "1,00,000",
            "0,0,1",
            "1 00",
            "12 34",
            "1,,000",
            "1.000.000",
            "1.000,5",
            "NaN",
            "inf",
            "1e999",
            "1e",
            "1 000 00",
            "1,000,5",
            "- 1",
            "--1",
            "1 e6",
        ] {
            assert_eq!(number(text), None, "{text:?}");
        }
    }

    #[test]
    fn whole_numbers_are_exact() {
        for (text, value) in [
            ("0", 0),
            ("1e6", 1_000_000),
            ("1.5e6", 1_500_000),
            ("1 000 000", 1_000_000),
            ("18446744073709551615", u64::MAX),
            ("18,446,744,073,709,551,615", u64::MAX),
        ] {
            assert_eq!(whole(text), Some(value), "{text:?}");
        }
        for text in [
            "-1",
            "1.5",
            "1e-3",
            "1e19",
            "18446744073709551616",
            "many",
            "0,5",
        ] {
            assert_eq!(whole(text), None, "{text:?}");
        }
    }
}
