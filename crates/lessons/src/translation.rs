//! Translations of lessons: a file that quotes each text of the original and says it in another language. Keys, runs and
//! expressions come from the original alone.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::mem::take;

use crate::error::{LessonError, shortened};
use crate::prose;
use crate::text::MAX_BYTES;

/// A translation of a lesson's texts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Translation {
    texts: HashMap<String, (String, usize)>,
    /// What divides a number from its decimals, if it is no point.
    decimal_sign: Option<char>,
}

impl Translation {
    /// Reads a translation: each text of the original as a quotation, lines that begin with `> `, and after it the
    /// translation up to the next quotation.
    ///
    /// # Errors
    ///
    /// A file that is too long, text before the first quotation, a quotation without translation or the same one twice,
    /// braces that cannot be read, and a translation with other expressions in braces than its original.
    pub fn read(text: &str) -> Result<Self, LessonError> {
        if text.len() > MAX_BYTES {
            let length = text.len();
            let message =
                format!("the file has {length} bytes; a translation has at most {MAX_BYTES}");
            return Err(LessonError::new(1, message));
        }

        let mut read = Self::default();
        let (mut original, mut translated, mut line) = (String::new(), String::new(), 1);

        // Appends a line of the file to a text: lines are joined by spaces, as in the lesson.
        let add = |part: &mut String, row: &str| {
            if !part.is_empty() {
                part.push(' ');
            }
            part.push_str(row.trim());
        };

        for (number, row) in (1..).zip(text.lines()) {
            if let Some(quoted) = row.strip_prefix('>') {
                // A quotation behind a translation begins the next pair, so that this pair is complete.
                if !translated.is_empty() {
                    let [original, translated] = [&mut original, &mut translated].map(take);
                    read.put(original, translated, line)?;
                }

                // The fault of a pair names the first line of its quotation.
                if original.is_empty() {
                    line = number;
                }
                add(&mut original, quoted);
            } else if !row.trim().is_empty() {
                if original.is_empty() {
                    let message = "text before the first quotation; a translation quotes each text of the original with \"> \"";
                    return Err(LessonError::new(number, message));
                }
                add(&mut translated, row);
            }
        }

        // The last pair has no quotation behind it.
        if !original.is_empty() {
            read.put(original, translated, line)?;
        }

        Ok(read)
    }

    /// Returns the translation for a language that divides numbers from their decimals by `sign`.
    #[must_use]
    pub fn with_decimal_sign(mut self, sign: char) -> Self {
        self.decimal_sign = Some(sign);
        self
    }

    /// Returns a number, written with a point, as this language writes it.
    pub(crate) fn number(&self, number: String) -> String {
        match self.decimal_sign {
            Some(sign) => number.replace('.', sign.encode_utf8(&mut [0; 4])),
            None => number,
        }
    }

    /// Returns a place, in r, as this language writes it: coordinates with decimal commas are divided by a semicolon.
    pub(crate) fn place(&self, place: [f64; 2]) -> String {
        let [x, y] = place.map(|at| self.number(format!("{at:.2}")));
        let between = if self.decimal_sign == Some(',') {
            ';'
        } else {
            ','
        };
        format!("({x} r{between} {y} r)")
    }

    /// Adds a text and its translation; `line` is that of the quotation. Fails if the translation is empty or has other
    /// expressions, if braces cannot be read, and if the text has a translation already.
    fn put(
        &mut self,
        original: String,
        translated: String,
        line: usize,
    ) -> Result<(), LessonError> {
        let wrong = |message: String| Err(LessonError::new(line, message));

        if translated.is_empty() {
            return wrong(format!("\"{}\" has no translation", shortened(&original)));
        }

        // Another language may have the values in another order, but none may be missing.
        let sorted = |text: &str| {
            let mut found =
                prose::expressions(text).map_err(|message| LessonError::new(line, message))?;
            found.sort();
            Ok(found)
        };

        if sorted(&original)? != sorted(&translated)? {
            let message = "the translation has other expressions in braces than the original";
            return wrong(message.to_owned());
        }

        if let Some((_, other)) = self.texts.get(&original) {
            return wrong(format!("the same text is translated in line {other}"));
        }

        self.texts.insert(original, (translated, line));
        Ok(())
    }

    /// Returns the translation of a text, or the text if there is none.
    #[must_use]
    pub fn of<'a>(&'a self, text: &'a str) -> &'a str {
        let found = self.texts.get(text);
        found.map_or(text, |(translated, _)| translated)
    }

    /// Returns the texts of a lesson that are not translated, and the lines of translations of texts that it does not have.
    #[must_use]
    pub fn compared(&self, texts: &[&str]) -> (Vec<String>, Vec<LessonError>) {
        let missing = texts
            .iter()
            .filter(|text| !self.texts.contains_key(**text))
            .map(|text| (*text).to_owned())
            .collect();

        let fault = |text: &str, line: usize| {
            let message = format!("the lesson has no text \"{}\"", shortened(text));
            LessonError::new(line, message)
        };
        let mut stale: Vec<LessonError> = self
            .texts
            .iter()
            .filter(|(text, _)| !texts.contains(&text.as_str()))
            .map(|(text, (_, line))| fault(text, *line))
            .collect();

        // The texts are kept without an order.
        stale.sort_by_key(|error| error.line);
        (missing, stale)
    }

    /// Returns a translation file to be filled in: every text of a lesson in its order, quoted, with its translation
    /// here, or `TODO` if it has none. Translations of texts that the lesson does not have are left out.
    #[must_use]
    pub fn renewed(&self, texts: &[&str]) -> String {
        let mut seen: Vec<&str> = Vec::new();
        let mut file = String::new();

        for &text in texts {
            // A text that the lesson has twice is translated once.
            if !seen.contains(&text) {
                seen.push(text);
                let known = self.texts.get(text);
                let translated = known.map_or("TODO", |(translated, _)| translated);
                let _ = write!(file, "> {text}\n\n{translated}\n\n");
            }
        }

        file
    }
}

/// Returns whether a word has the form of a language tag, such as `de`, `zh-Hant` or `pt-BR`: a language of two to eight
/// letters and subtags of one to eight letters or digits, divided by hyphens (BCP 47). Whether the language exists is not
/// checked.
#[must_use]
pub fn is_language(tag: &str) -> bool {
    let mut parts = tag.split('-');
    let language = parts.next().unwrap_or_default();
    let is_language =
        (2..=8).contains(&language.len()) && language.bytes().all(|b| b.is_ascii_alphabetic());
    let is_subtag = |part: &str| {
        (1..=8).contains(&part.len()) && part.bytes().all(|b| b.is_ascii_alphanumeric())
    };
    is_language && tag.len() <= MAX_TAG && parts.all(is_subtag)
}

/// The longest language tag, in bytes: software need not take longer ones (RFC 5646, section 4.4.1).
const MAX_TAG: usize = 35;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_replaced_and_faults_named() {
        let read = Translation::read(
            "> A set\n> of points.\n\nEine Menge\nvon Punkten.\n\n> {a}\n\nNr. {a}\n",
        )
        .unwrap();
        assert_eq!(read.of("A set of points."), "Eine Menge von Punkten.");
        assert_eq!((read.of("{a}"), read.of("other")), ("Nr. {a}", "other"));
        assert_eq!(read.number("0.46".to_owned()), "0.46");
        let read = read.with_decimal_sign(',');
        assert_eq!(read.number("\u{2212}0.46".to_owned()), "\u{2212}0,46");
        for (text, part) in [
            ("Hallo", "before the first quotation"),
            ("> a\n> b", "no translation"),
            ("> {a}\n\nb", "other expressions"),
            ("> a\n\nb\n\n> a\n\nc", "line 1"),
        ] {
            let error = Translation::read(text).unwrap_err().to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
    }

    #[test]
    fn language_tags_have_subtags() {
        for tag in [
            "de",
            "zh-Hant",
            "pt-BR",
            "sr-Latn-RS",
            "es-419",
            "de-CH-1996",
            "gsw",
        ] {
            assert!(is_language(tag), "{tag}");
        }
        for tag in [
            "",
            "d",
            "germanlanguage",
            "de_DE",
            "de-",
            "-de",
            "zh--Hant",
            "de/..",
            "12",
            "\u{e9}s",
            "de\u{1b}",
            "aa-bbbbbbbb-cccccccc-dddddddd-eeeeeeee",
        ] {
            assert!(!is_language(tag), "{tag}");
        }
    }
}
