//! Languages of the window beside English: for each a table in `assets/words` that has its text for every English one.
//!
//! The program makes its texts in English; where one is shown, [`Language::text`] gives the one to show instead. A text with
//! numbers or with parts of its own has a row with slots in braces, so that the words of a language may stand in another
//! order. A new language is one more file, a row of `TABLES`, a tag in `TAGS`, and a row in `web/page/words.js`.

use std::collections::HashMap;
use std::sync::{LazyLock, PoisonError, RwLock};

/// The tables that the program has from its start, each with the tag of its language. In a browser there are none: a page
/// loads them with the lessons and [`add`]s them, since a first visit needs neither.
pub const TABLES: &[(&str, &str)] = if cfg!(target_arch = "wasm32") {
    &[]
} else {
    &[
        ("de", include_str!("../../../assets/words/de.txt")),
        ("es", include_str!("../../../assets/words/es.txt")),
    ]
};

/// The tags of all languages that the window can have, English first, in the order in which its button leads through them.
pub const TAGS: [&str; 3] = ["en", "de", "es"];

/// Returns the tag of the language behind a given one in [`TAGS`], English behind the last one. Any other text counts as English.
#[must_use]
pub fn next_tag(tag: &str) -> &'static str {
    let at = TAGS.iter().position(|other| *other == tag).unwrap_or(0);
    TAGS[(at + 1) % TAGS.len()]
}

/// Returns whether a tag is that of English, or empty, as it is where no language was chosen.
#[must_use]
pub fn is_english(tag: &str) -> bool {
    matches!(tag, "" | "en")
}

/// The number by which a table shows its separators of thousands and of decimals, and how it writes percent.
const SAMPLE_NUMBER: &str = "1,234.5%";
/// How deep parts of a text may have parts. The deepest text, a key after a sentence on two samples, has three levels.
const MAX_DEPTH: usize = 5;

/// The languages that have a table, each with its tag. They are never freed, so that a reference to one can be kept anywhere.
static LANGUAGES: LazyLock<RwLock<Vec<(String, &'static Language)>>> = LazyLock::new(|| {
    let read = |(tag, table): &(&str, &'static str)| {
        let language = Language::read(table).expect("tests read the tables");
        ((*tag).to_owned(), &*Box::leak(Box::new(language)))
    };
    RwLock::new(TABLES.iter().map(read).collect())
});

/// Adds the table of a language; one that is there already stays.
///
/// # Errors
///
/// A fault of the table, as of [`Language::read`].
pub fn add(tag: &str, table: &str) -> Result<(), String> {
    // A panic elsewhere leaves the tables whole.
    let mut languages = LANGUAGES.write().unwrap_or_else(PoisonError::into_inner);
    if languages.iter().any(|(other, _)| other == tag) {
        return Ok(());
    }
    let language = Language::read(Box::leak(table.into()))?;
    languages.push((tag.to_owned(), Box::leak(Box::new(language))));
    Ok(())
}

/// A language of the window: its texts for the English ones.
#[derive(Debug)]
pub struct Language {
    texts: HashMap<&'static str, &'static str>,
    patterns: Vec<Pattern>,
    thousands: char,
    decimals: char,
    percent: &'static str,
}

/// An English text with slots, and its translation with the same slots.
#[derive(Debug)]
struct Pattern {
    english: Vec<Piece>,
    translated: Vec<Piece>,
}

/// A part of a text of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Piece {
    Words(&'static str),
    Slot(Slot),
}

/// A slot of a text, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slot {
    /// `{#name}`: a number, written as the language writes numbers.
    Number(&'static str),
    /// `{name}`: a text of the table.
    Text(&'static str),
    /// `{=name}`: anything; it stays as it is, like a name of a file.
    Same(&'static str),
}

impl Language {
    /// Returns the language of a tag such as `de`; `None` for English, and for languages without a table.
    #[must_use]
    pub fn of(tag: &str) -> Option<&'static Self> {
        // A panic elsewhere leaves the tables whole.
        let languages = LANGUAGES.read().unwrap_or_else(PoisonError::into_inner);
        let found = languages.iter().find(|(other, _)| other == tag);
        found.map(|(_, language)| *language)
    }

    /// Returns what divides a number from its decimals.
    #[must_use]
    pub const fn decimal_sign(&self) -> char {
        self.decimals
    }

    /// Returns the text to show for an English one, with its numbers written as in this language; the English one if the
    /// table lacks it.
    #[must_use]
    pub fn text(&self, english: &str) -> String {
        let found = self.translated(english);
        found.unwrap_or_else(|| english.to_owned())
    }

    /// Returns the same, or `None` if the table lacks the text.
    #[must_use]
    pub fn translated(&self, english: &str) -> Option<String> {
        self.found(english, 0)
    }

    /// Returns the translation of a text that is a part of `depth` others; `None` if there is none. A text without the
    /// blanks around it, or without its capital letter, counts as a part of the whole text.
    fn found(&self, english: &str, depth: usize) -> Option<String> {
        if depth > MAX_DEPTH {
            return None;
        }

        // The cheap ways come first: a text of the table, or a number. Patterns must be tried one by one.
        if let Some(text) = self.texts.get(english) {
            return Some((*text).to_owned());
        }
        if let Some(number) = self.number(english) {
            return Some(number);
        }

        // Columns are aligned with blanks, which are no part of the words.
        let trimmed = english.trim();
        if trimmed.len() < english.len() && !trimmed.is_empty() {
            let text = self.found(trimmed, depth + 1)?;
            return Some(english.replacen(trimmed, &text, 1));
        }

        let matched = |pattern: &Pattern| self.matched(pattern, english, depth);
        if let Some(text) = self.patterns.iter().find_map(matched) {
            return Some(text);
        }

        // At the beginning of a sentence a text has a capital letter that it does not have in the table. An ASCII letter is one byte.
        let first = english.chars().next().filter(char::is_ascii_uppercase)?;
        let rest = &english[1..];
        let small = format!("{}{rest}", first.to_ascii_lowercase());
        Some(crate::words::capital(&self.found(&small, depth + 1)?))
    }

    /// Returns a number, with a unit of percent if it has one, as this language writes it; `None` for other texts.
    fn number(&self, english: &str) -> Option<String> {
        let number = english.strip_suffix('%').unwrap_or(english);
        let digits = number.trim_start_matches(['-', '\u{2212}', '+', '\u{b1}']);

        let is_number = digits.starts_with(|c: char| c.is_ascii_digit())
            && digits.ends_with(|c: char| c.is_ascii_digit())
            && digits
                .bytes()
                .all(|byte| byte.is_ascii_digit() || b",.".contains(&byte));

        // English has commas between thousands and a point before decimals.
        let translated = |c: char| match c {
            ',' => self.thousands,
            '.' => self.decimals,
            c => c,
        };
        let unit = if number == english { "" } else { self.percent };
        is_number.then(|| number.chars().map(translated).chain(unit.chars()).collect())
    }

    /// Returns the translation of a text by a pattern; `None` if the pattern does not match the text, or if the part of
    /// the text in one of its slots has no translation.
    fn matched(&self, pattern: &Pattern, english: &str, depth: usize) -> Option<String> {
        let mut parts = Vec::new();
        self.fits(&pattern.english, english, depth, &mut parts)
            .then(|| {
                let pieces = pattern.translated.iter();
                let text = pieces.map(|piece| match piece {
                    Piece::Words(words) => *words,
                    Piece::Slot(slot) => {
                        // The translation may have the slots in another order, but has the same ones.
                        let part = parts.iter().find(|(other, _)| other == slot);
                        part.map_or("", |(_, text)| text.as_str())
                    }
                });
                text.collect()
            })
    }

    /// Returns whether pieces match a whole text, and collects the translations of their slots.
    fn fits(
        &self,
        pieces: &[Piece],
        english: &str,
        depth: usize,
        parts: &mut Vec<(Slot, String)>,
    ) -> bool {
        // Words must stand in the text as they are. The end of a slot is not known: each possible end is tried below.
        let (slot, after) = match pieces {
            [] => return english.is_empty(),
            [Piece::Words(words), after @ ..] => {
                let rest = english.strip_prefix(words);
                return rest.is_some_and(|rest| self.fits(after, rest, depth, parts));
            }
            [Piece::Slot(slot), after @ ..] => (*slot, after),
        };

        let mut ends: Vec<usize> = match after {
            [Piece::Words(words), ..] => english.match_indices(words).map(|(at, _)| at).collect(),
            // Slots have words between them, so that this one is the last, and takes the rest of the text.
            _ => vec![english.len()],
        };
        // A slot is never empty.
        ends.retain(|&end| end > 0);

        for end in ends {
            let held = parts.len();
            let part = &english[..end];
            // The rest is compared before the part is translated, which takes longer.
            let rest_fits = self.fits(after, &english[end..], depth, parts);

            let text = match slot {
                _ if !rest_fits => None,
                Slot::Number(_) => self.number(part),
                Slot::Text(_) => self.found(part, depth + 1),
                Slot::Same(_) => Some(part.to_owned()),
            };

            if let Some(text) = text {
                parts.push((slot, text));
                return true;
            }

            // The text does not match with this end, so that the parts that were collected are taken back.
            parts.truncate(held);
        }

        false
    }

    /// Reads a table: an English text at the beginning of a line, and below it its translation, indented. Lines that begin
    /// with `#` are remarks.
    ///
    /// # Errors
    ///
    /// The line of a fault: a text without translation, the same text twice, a translation with other slots than the
    /// English text, a slot without end, and two slots without words between them. Without a line: a translation of
    /// the sample number that has no two separators.
    pub fn read(table: &'static str) -> Result<Self, String> {
        let mut texts = HashMap::new();
        let mut patterns = Vec::new();
        let numbered = table.lines().zip(1..);
        let mut lines = numbered.filter(|(line, _)| !line.is_empty() && !line.starts_with('#'));

        while let Some((english, line_number)) = lines.next() {
            let fault = |what: &str| format!("line {line_number}: \"{english}\" {what}");
            let next = lines.next().and_then(|(line, _)| line.strip_prefix("    "));
            let translated = next.ok_or_else(|| fault("has no indented translation below it"))?;

            let pattern = Pattern {
                english: pieces(english).map_err(fault)?,
                translated: pieces(translated).map_err(fault)?,
            };

            // A part would be lost if the translation had no slot for it, and a slot without a part would stay empty.
            if slots(&pattern.english) != slots(&pattern.translated) {
                return Err(fault("and its translation have other slots"));
            }
            if texts.insert(english, translated).is_some() {
                return Err(fault("is there twice"));
            }

            // Texts without slots are found in `texts`, so that only the others are patterns.
            if pattern
                .english
                .iter()
                .any(|piece| matches!(piece, Piece::Slot(_)))
            {
                patterns.push(pattern);
            }
        }

        // One text of the table is a number: its translation has the separators and the percent sign of the language.
        // A table without it writes numbers as English does.
        let sample = texts.remove(SAMPLE_NUMBER).unwrap_or(SAMPLE_NUMBER);
        let last_digit = sample.rfind(|c: char| c.is_ascii_digit());
        let (number, percent) = sample.split_at(last_digit.map_or(0, |at| at + 1));

        let mut signs = number.chars().filter(|c| !c.is_ascii_digit());
        let (Some(thousands), Some(decimals)) = (signs.next(), signs.next()) else {
            return Err(format!(
                "\"{sample}\" for {SAMPLE_NUMBER} has no two separators"
            ));
        };

        Ok(Self {
            texts,
            patterns,
            thousands,
            decimals,
            percent,
        })
    }

    /// Returns the English texts of the table, each as its words between slots.
    pub fn english(&self) -> impl Iterator<Item = Vec<&'static str>> {
        let words = |text: &&'static str| {
            // The texts were read with the table, so that each has its pieces.
            let pieces = pieces(text).unwrap_or_default().into_iter();
            let words = pieces.filter_map(|piece| match piece {
                Piece::Words(words) => Some(words),
                Piece::Slot(_) => None,
            });
            words.collect()
        };
        self.texts.keys().map(words)
    }
}

/// Returns the slots of some pieces in a fixed order.
fn slots(pieces: &[Piece]) -> Vec<String> {
    let slots = pieces
        .iter()
        .filter(|piece| matches!(piece, Piece::Slot(_)));
    let mut slots: Vec<String> = slots.map(|slot| format!("{slot:?}")).collect();
    slots.sort();
    slots
}

/// Returns the pieces of a text of the table. Fails for a slot without end and for two slots without words between
/// them; the error says which of these the text has.
fn pieces(text: &'static str) -> Result<Vec<Piece>, &'static str> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some((words, after)) = rest.split_once('{') {
        let (name, after) = after.split_once('}').ok_or("has a slot without end")?;
        // Only words between two slots tell where the text of the first one ends.
        if !words.is_empty() {
            pieces.push(Piece::Words(words));
        } else if matches!(pieces.last(), Some(Piece::Slot(_))) {
            return Err("has two slots without words between them");
        }
        pieces.push(Piece::Slot(match name.split_at_checked(1) {
            Some(("#", name)) => Slot::Number(name),
            Some(("=", name)) => Slot::Same(name),
            _ => Slot::Text(name),
        }));
        rest = after;
    }
    if !rest.is_empty() {
        pieces.push(Piece::Words(rest));
    }
    Ok(pieces)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "# remark\n1,234.5%\n    1.234,5 %\nPlay\n    Abspielen\n\nSpace\n    Leertaste\n\
        {name} ({key})\n    {name} ({key})\nsample {#n}\n    Punkt {#n}\n{#n} samples\n    {#n} Punkte\n\
        {a} covers {b}, {#far} r away.\n    {a} bedeckt {b}, Abstand {#far} r.\n\
        {=file} is empty.\n    Leer ist {=file}.\n";

    #[test]
    fn texts_have_their_numbers_and_parts_translated() {
        let language = Language::read(TABLE).unwrap();
        for (english, expected) in [
            ("Play", "Abspielen"),
            ("Play (Space)", "Abspielen (Leertaste)"),
            ("1,204 samples", "1.204 Punkte"),
            ("   12 samples", "   12 Punkte"),
            ("\u{2212}0.25", "\u{2212}0,25"),
            ("12.5%", "12,5 %"),
            (
                "Sample 3 covers sample 1,000, 0.46 r away.",
                "Punkt 3 bedeckt Punkt 1.000, Abstand 0,46 r.",
            ),
            ("a.b (1.5).csv is empty.", "Leer ist a.b (1.5).csv."),
        ] {
            let found = language.translated(english);
            assert_eq!(found.as_deref(), Some(expected), "{english}");
        }
        // What the table lacks stays as it is, also within a text that it has.
        for english in ["Stop", "Play (Enter)", "sample x", "1.5.x", "", "Pla\u{fc}"] {
            assert_eq!(language.translated(english), None, "{english}");
            assert_eq!(language.text(english), english);
        }
    }

    #[test]
    fn faults_of_a_table_are_named() {
        for (table, part) in [
            (
                "1,234.5%\n    1.234,5 %\nPlay\nStop\n",
                "line 3: \"Play\" has no",
            ),
            (
                "Play\n    A\nPlay\n    B\n",
                "line 3: \"Play\" is there twice",
            ),
            ("{#n} r\n    {n} r\n", "other slots"),
            ("a {b\n    c\n", "without end"),
            ("{a}{b}\n    {a} {b}\n", "two slots"),
            ("1,234.5%\n    12345 %\n", "no two separators"),
        ] {
            let error = Language::read(table).unwrap_err();
            assert!(error.contains(part), "{table}: {error}");
        }
    }

    #[test]
    fn the_tables_can_be_read() {
        for (tag, table) in TABLES {
            assert_eq!(Language::read(table).err(), None, "{tag}");
        }
        assert!(Language::of("de").is_some() && Language::of("en").is_none());
        let tables = TABLES.iter().map(|(tag, _)| *tag);
        assert!(std::iter::once("en").chain(tables).eq(TAGS));
    }

    /// Returns the English texts of a table, in their order.
    fn english(table: &str) -> Vec<&str> {
        let rows = table.lines().filter(|line| !line.is_empty());
        rows.filter(|line| !line.starts_with([' ', '#'])).collect()
    }

    // Tests of the window find what the German table lacks.
    #[test]
    fn all_tables_have_the_rows_of_the_first() {
        let [first, others @ ..] = TABLES else {
            panic!("no table");
        };
        assert!(english(first.1).len() > 500);
        for (tag, table) in others {
            assert_eq!(english(table), english(first.1), "{tag}");
            let lacks = table.replacen("\nEnter\n", "\nReturn\n", 1);
            assert_ne!(english(&lacks), english(first.1), "control");
        }
    }

    #[test]
    fn the_button_leads_through_all_languages_and_begins_at_english() {
        assert_eq!(TAGS.map(next_tag), ["de", "es", "en"]);
        assert_eq!(["", "xx"].map(next_tag), ["de", "de"]);
        assert_eq!(
            ["", "en", "de", "xx"].map(is_english),
            [true, true, false, false]
        );
    }

    #[test]
    fn a_language_is_added_once() {
        assert!(Language::of("test").is_none());
        assert!(add("test", "Play\n").is_err() && Language::of("test").is_none());
        add("test", TABLE).unwrap();
        let added = Language::of("test").unwrap();
        assert_eq!(added.text("Play"), "Abspielen");

        add("test", &TABLE.replace("Abspielen", "Start")).unwrap();
        assert!(std::ptr::eq(added, Language::of("test").unwrap()));
    }
}
