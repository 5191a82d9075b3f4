//! JSON from files: the one reader of this program's own kinds, such as layouts, sessions and results of lessons.
//! Editors and shells of Windows put a byte-order mark before text, which JSON does not have.

use serde::de::DeserializeOwned;

/// Returns bytes without a byte-order mark of UTF-8 before them.
#[must_use]
pub fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)
}

/// Reads the JSON of a file, which may begin with a byte-order mark.
///
/// ```
/// let pair: [u8; 2] = tilescope_core::json::from_bytes(b"\xEF\xBB\xBF[1, 2]")?;
/// assert_eq!(pair, [1, 2]);
/// # Ok::<(), serde_json::Error>(())
/// ```
pub fn from_bytes<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, serde_json::Error> {
    serde_json::from_slice(without_mark(bytes))
}

/// Reads the JSON of a file, as text, which may begin with a byte-order mark.
pub fn from_text<T: DeserializeOwned>(text: &str) -> Result<T, serde_json::Error> {
    from_bytes(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_mark_is_passed_over() {
        for text in ["[1]", "\u{FEFF}[1]", "\u{FEFF} [1]\r\n"] {
            assert_eq!(from_text::<[u8; 1]>(text).expect(text), [1]);
        }
        for text in ["\u{FEFF}\u{FEFF}[1]", "[\u{FEFF}1]", ""] {
            assert!(from_text::<[u8; 1]>(text).is_err(), "{text:?}");
        }
    }
}
