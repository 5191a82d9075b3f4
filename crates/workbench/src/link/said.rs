//! What did not come of a link, in sentences: as many as one reads.

/// The most sentences that are kept.
const MAX_WARNINGS: usize = 8;
/// The most characters of what is quoted.
const QUOTED: usize = 40;

/// Sentences about the parts of a link that count otherwise than they say, or not at all.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LinkWarnings {
    sentences: Vec<String>,
    more: usize,
}

impl LinkWarnings {
    /// Says something.
    pub fn say(&mut self, sentence: String) {
        if self.sentences.len() < MAX_WARNINGS {
            self.sentences.push(sentence);
        } else {
            self.more += 1;
        }
    }

    /// Returns whether there is nothing to say.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.sentences.is_empty()
    }

    /// Returns what there is to say, one sentence each; the last one counts those that were too many.
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

    /// Returns all of it.
    #[must_use]
    pub fn text(&self) -> String {
        self.sentences().join(" ")
    }
}

/// Returns a text from outside as it can be shown: short, on one line.
#[must_use]
pub fn quoted(text: &str) -> String {
    let plain = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let mut shown: String = text.chars().take(QUOTED).map(plain).collect();
    if text.chars().nth(QUOTED).is_some() {
        shown.push('\u{2026}');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_much_is_said_as_one_reads() {
        let mut said = LinkWarnings::default();
        assert!(said.is_empty() && said.text().is_empty());
        for k in 0..1_000 {
            said.say(format!("Part {k}."));
        }
        let sentences = said.sentences();
        assert_eq!(sentences.len(), MAX_WARNINGS + 1);
        assert_eq!(sentences[MAX_WARNINGS], "992 more parts were left out.");
        assert_eq!(quoted("a\nb"), "a\u{fffd}b");
        assert_eq!(quoted(&"x".repeat(99)).chars().count(), QUOTED + 1);
    }
}
