//! The syntax of links: percent encoding, lists, base64 for addresses, numbers, names.

use base64::Engine as _;
use base64::alphabet::URL_SAFE;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use serde::Serialize;
use serde_json::Value;
use tilescope_session::words::slug;

/// The decimals of numbers that need not be exact: a thousandth of a screen point at most scales.
const DECIMALS: i32 = 6;

/// Returns a text with everything escaped but letters, digits and `-._~`, so that no mail or chat cuts the address.
pub fn escaped(text: &str) -> String {
    let byte = |byte: u8| match byte {
        b'-' | b'.' | b'_' | b'~' => char::from(byte).to_string(),
        _ if byte.is_ascii_alphanumeric() => char::from(byte).to_string(),
        _ => format!("%{byte:02X}"),
    };
    text.bytes().map(byte).collect()
}

/// Returns the keys and values of a fragment, read as `URLSearchParams` does: escapes are decoded, and invalid ones are
/// kept as text. `&amp;`, as copied from a page's source, stands for `&`.
pub fn pairs(fragment: &str) -> impl Iterator<Item = (String, String)> {
    form_urlencoded::parse(fragment.as_bytes()).map(|(key, value)| {
        let key = key.trim_start_matches("amp;").to_owned();
        (key, value.into_owned())
    })
}

/// Returns a text as an item of a list. Items are separated by semicolons, so a semicolon or backslash within a text is
/// escaped with a backslash.
pub fn item(text: &str) -> String {
    text.replace('\\', r"\\").replace(';', r"\;")
}

/// Returns the items of a list.
pub fn items(list: &str) -> Vec<String> {
    let (mut items, mut item) = (Vec::new(), String::new());
    let mut rest = list.chars().peekable();
    while let Some(character) = rest.next() {
        match character {
            // A backslash before any other character escapes nothing, and stands for itself.
            '\\' => item.push(rest.next_if(|next| r"\;".contains(*next)).unwrap_or('\\')),
            ';' => items.push(std::mem::take(&mut item)),
            character => item.push(character),
        }
    }
    items.push(item);
    items
}

/// Base64 for addresses, without padding. The unused bits of the last character are not checked.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &URL_SAFE,
    GeneralPurposeConfig::new()
        .with_encode_padding(false)
        .with_decode_padding_mode(DecodePaddingMode::RequireNone)
        .with_decode_allow_trailing_bits(true),
);

/// Returns bytes as base64 for addresses, without padding.
pub fn base64(bytes: &[u8]) -> String {
    BASE64.encode(bytes)
}

/// Returns the bytes of a base64 text; `None` if it is not one.
pub(crate) fn from_base64(text: &str) -> Option<Vec<u8>> {
    BASE64.decode(text).ok()
}

/// Returns a short text that reads as exactly this number.
pub fn exact(number: f64) -> String {
    let plain = number.to_string();
    // Up to 12 characters a number is read more easily without an exponent, even if that is longer; chosen, not
    // measured.
    if plain.len() > 12 {
        let short = format!("{number:e}");
        if short.len() < plain.len() {
            return short;
        }
    }
    plain
}

/// Returns a number for display positions, to a millionth and at least six digits.
pub fn rounded(number: f64) -> String {
    // Below 1e-9 the limit of 12 decimals counts anyway, and 0 has no logarithm.
    let digits = DECIMALS - 1 - number.abs().max(1e-9).log10().floor() as i32;
    let decimals = digits.clamp(DECIMALS, 12) as usize;
    let text = format!("{number:.decimals$}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0" } else { short }.to_owned()
}

/// Returns the number in a text, if it is finite.
pub fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Returns exactly `N` finite numbers with commas between them.
pub fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let numbers: Option<Vec<f64>> = text.split(',').take(N + 1).map(finite).collect();
    numbers?.try_into().ok()
}

/// Returns rings of corners: `x,y` for each corner, with `_` between corners and `~` between rings.
pub fn rings_text(rings: &[Vec<[f64; 2]>]) -> String {
    let corner = |corner: &[f64; 2]| corner.map(exact).join(",");
    let ring = |ring: &Vec<[f64; 2]>| ring.iter().map(corner).collect::<Vec<_>>().join("_");
    rings.iter().map(ring).collect::<Vec<_>>().join("~")
}

/// Returns the rings that [`rings_text`] wrote; `None` if the text is not one.
pub fn rings_of(text: &str) -> Option<Vec<Vec<[f64; 2]>>> {
    let ring = |ring: &str| ring.split('_').map(numbers::<2>).collect();
    text.split('~').map(ring).collect()
}

/// Returns the name of a choice in links.
pub fn name<T: Serialize>(choice: &T) -> String {
    match serde_json::to_value(choice) {
        Ok(Value::String(name)) => slug(&name),
        // A choice has only names, so that this does not occur.
        _ => String::new(),
    }
}

/// Returns the one of `all` that has this name.
pub fn named<T: Serialize + Copy>(all: &[T], text: &str) -> Option<T> {
    all.iter().find(|one| name(*one) == text).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escaped_text_is_read_back() {
        for text in [
            "",
            "a b",
            "distance < 0.4 && p = 3; 100%",
            "1 + 2%2C3",
            "r\u{e9}seau \u{1f600}\n",
        ] {
            let there = escaped(text);
            assert!(
                !there.contains(['&', '=', ';', ':', '#', ' ', '+']),
                "{there}"
            );
            let read: Vec<_> = pairs(&format!("a={there}")).collect();
            assert_eq!(read, [("a".to_owned(), text.to_owned())]);
        }
        for (text, key, value) in [
            ("watch=a+%2B%201", "watch", "a + 1"),
            ("watch=100%", "watch", "100%"),
            ("watch=%zz", "watch", "%zz"),
            ("amp;seed=7", "seed", "7"),
        ] {
            let read: Vec<_> = pairs(text).collect();
            assert_eq!(read, [(key.to_owned(), value.to_owned())], "{text}");
        }
    }

    #[test]
    fn items_of_a_list_are_read_back() {
        let texts = ["", ";", r"\", r"a\;b;", r"\\;;\", "c"];
        let list: Vec<String> = texts.iter().map(|text| item(text)).collect();
        assert_eq!(items(&list.join(";")), texts);
        // A backslash before another character stands for itself.
        assert_eq!(items(r"a\b;\"), [r"a\b", r"\"]);
    }

    #[test]
    fn base64_is_read_back() {
        let bytes: Vec<u8> = (0..=255).collect();
        for len in [0, 1, 2, 3, 4, 5, 254, 255, 256] {
            let text = base64(&bytes[..len]);
            assert_eq!(from_base64(&text).as_deref(), Some(&bytes[..len]));
        }
        assert_eq!(base64(b"Many"), "TWFueQ");
        for broken in ["A", "AAAAA", "AA=", "A A", "\u{e9}\u{e9}"] {
            assert_eq!(from_base64(broken), None, "{broken}");
        }
    }

    #[test]
    fn exact_numbers_are_exact_and_rounded_ones_are_stable() {
        for number in [
            0.1,
            0.008_36,
            1.0 / 3.0,
            1e300,
            5e-324,
            120.0,
            65_532.0,
            1e-9,
        ] {
            assert_eq!(finite(&exact(number)), Some(number));
            for number in [number, -number] {
                let text = rounded(number);
                assert_eq!(rounded(finite(&text).unwrap()), text);
            }
        }
        assert_eq!(exact(1e300), "1e300");
        assert_eq!(rounded(12.500_000_000_1), "12.5");
        assert_eq!(rounded(-0.0), "0");
        assert_eq!(numbers("1,2.5"), Some([1.0, 2.5]));
        assert_eq!(numbers::<2>("1,2,3"), None);
        assert_eq!(numbers::<2>("1,NaN"), None);
        assert_eq!(numbers::<1>("inf"), None);
    }
}
