//! Faults of a lesson file: the line, and a message with the allowed values and the nearest right word.

/// A fault of a lesson or of a translation.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct LessonError {
    /// The line of the file, from 1.
    pub line: usize,
    /// The fault, and the allowed values.
    pub message: String,
}

impl LessonError {
    /// Returns a fault at a line.
    #[must_use]
    pub fn new(line: usize, message: impl Into<String>) -> Self {
        Self {
            line,
            message: message.into(),
        }
    }

    /// Returns the fault of a word that is not one of `known`, with the nearest of them.
    #[must_use]
    pub fn unknown(line: usize, what: &str, word: &str, known: &[&str]) -> Self {
        let meant = nearest(word, known)
            .map_or_else(String::new, |near| format!(" Did you mean \"{near}\"?"));
        let (word, list) = (shortened(word), known.join(", "));
        let message = format!("there is no {what} \"{word}\".{meant} There are: {list}.");
        Self::new(line, message)
    }
}

/// Returns the known word that is most similar to a word, if one is similar.
#[must_use]
pub fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let word: String = word.chars().take(40).collect();
    let likeness = |known: &&str| strsim::jaro_winkler(&word, known);
    let words = known.iter().copied();
    let best = words.max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
    // Words that are less alike are not taken for misspellings of each other. The limit was chosen, not measured.
    best.filter(|best| likeness(best) > 0.7)
}

/// Returns a text with at most 60 characters, to be quoted.
#[must_use]
pub fn shortened(text: &str) -> String {
    if text.chars().count() <= 60 {
        return text.to_owned();
    }
    text.chars().take(57).chain("...".chars()).collect()
}
