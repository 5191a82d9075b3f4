//! Warnings about parts of a link, limited in number.

/// The most warnings that are kept; others are counted. Chosen, not measured.
const MAX_WARNINGS: usize = 8;

/// Warnings about parts of a link that were changed or ignored.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LinkWarnings {
    sentences: Vec<String>,
    more: usize,
}

impl LinkWarnings {
    /// Adds a warning; beyond the limit it is only counted.
    pub fn add(&mut self, sentence: String) {
        if self.sentences.len() < MAX_WARNINGS {
            self.sentences.push(sentence);
        } else {
            self.more += 1;
        }
    }

    /// Returns whether there are no warnings.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.sentences.is_empty()
    }

    /// Returns the warnings, one sentence each; the last one counts those beyond the limit.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        let mut sentences = self.sentences.clone();
        match self.more {
            0 => {}
            1 => sentences.push("One more part was left out.".to_owned()),
            more => sentences.push(format!("{more} more parts were left out.")),
        }
        sentences
    }

    /// Returns all warnings as one text.
    #[must_use]
    pub fn text(&self) -> String {
        self.sentences().join(" ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_are_limited_in_number() {
        let mut warnings = LinkWarnings::default();
        assert!(warnings.is_empty() && warnings.text().is_empty());
        for k in 0..1_000 {
            warnings.add(format!("Part {k}."));
        }
        let sentences = warnings.sentences();
        assert_eq!(sentences.len(), MAX_WARNINGS + 1);
        assert_eq!(sentences[MAX_WARNINGS], "992 more parts were left out.");
    }
}
