//! Votes of a class on a question, as a lecturer types them, and advice by the share of right answers. The method is peer
//! instruction: vote, discuss with a neighbour, vote again.

use serde::{Deserialize, Serialize};

use crate::answer::letter;
use crate::error::nearest;

/// The most votes for one option.
pub const MAX_VOTES: u32 = 10_000;

/// The share of right answers, estimated from the raised cards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RightShare {
    /// No learner, or nearly none.
    None,
    /// About a quarter of the class.
    Few,
    /// About a half of the class.
    Half,
    /// About three quarters, or more.
    Most,
}

impl RightShare {
    /// Every value, the smallest first.
    pub const ALL: [Self; 4] = [Self::None, Self::Few, Self::Half, Self::Most];

    /// Returns the word for it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Few => "few",
            Self::Half => "half",
            Self::Most => "most",
        }
    }

    const fn share(self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Few => 0.25,
            Self::Half => 0.5,
            Self::Most => 0.8,
        }
    }
}

/// One vote of a class.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Vote {
    /// How many chose each option.
    Counts(Vec<u32>),
    /// How many were right.
    Right(RightShare),
}

impl Vote {
    /// Reads `A 12 B 30`, `12 30`, or one of `none`, `few`, `half` and `most`; `options` is how many options the question
    /// has. Options that are not named have no votes.
    ///
    /// # Errors
    ///
    /// A sentence with the wrong word and the allowed ones.
    pub fn read(text: &str, options: usize) -> Result<Self, String> {
        let lower = text.to_lowercase();
        // Lecturers type all kinds of signs between counts.
        let words: Vec<&str> = lower
            .split(|c: char| c.is_whitespace() || matches!(c, ',' | ';' | ':' | '='))
            .filter(|word| !word.is_empty())
            .collect();

        let [first, ..] = words.as_slice() else {
            return Err("Type counts such as A 12 B 30, or none, few, half or most.".to_owned());
        };

        let mut shares = RightShare::ALL.into_iter();
        if let Some(share) = shares.find(|share| share.name() == *first) {
            return match words.len() {
                1 => Ok(Self::Right(share)),
                _ => Err(format!("\"{first}\" stands alone.")),
            };
        }

        if options == 0 {
            return Err(
                "The question has no lettered options: type none, few, half or most.".to_owned(),
            );
        }

        Ok(Self::Counts(counts_of(&words, options)?))
    }

    /// Returns how many voted; none if the share was estimated.
    #[must_use]
    pub fn count(&self) -> Option<u32> {
        match self {
            Self::Right(_) => None,
            Self::Counts(counts) => Some(counts.iter().sum()),
        }
    }

    /// Returns the share of right answers, from 0 to 1; `right` is the index of the right option. None without votes, and
    /// for counts where no single option is right.
    #[must_use]
    pub fn right_share(&self, right: Option<usize>) -> Option<f64> {
        match self {
            Self::Right(share) => Some(share.share()),
            Self::Counts(counts) => {
                let all: u32 = counts.iter().sum();
                let right = *counts.get(right?)?;
                (all > 0).then(|| f64::from(right) / f64::from(all))
            }
        }
    }
}

/// Returns the votes for each option from the words `A 12 B 30` or `12 30`; there is at least one option.
fn counts_of(words: &[&str], options: usize) -> Result<Vec<u32>, String> {
    let mut counts = vec![0; options];
    // The option of the next count: the first one, the one behind that of the last count, or the one that a letter has
    // named.
    let mut at = 0;
    let mut is_named = false;

    for word in words {
        // A word is a letter, a count, or both, such as `a12`.
        let (letters, digits): (String, String) = (
            word.chars().take_while(|c| c.is_alphabetic()).collect(),
            word.chars().skip_while(|c| c.is_alphabetic()).collect(),
        );

        if !letters.is_empty() {
            let option =
                (0..options).find(|&option| letter(option).to_lowercase().eq(letters.chars()));
            // The message names the letter of the last option.
            let last = letter(options - 1);
            at = option.ok_or_else(|| wrong_word(&letters, last))?;
            is_named = true;
        }

        if digits.is_empty() {
            continue;
        }

        let read = digits.parse::<u32>().ok();
        let in_range = read.filter(|count| *count <= MAX_VOTES);
        let count = in_range.ok_or_else(|| {
            format!("\"{digits}\" is not a count: whole numbers up to {MAX_VOTES}.")
        })?;

        let Some(slot) = counts.get_mut(at) else {
            return Err(format!(
                "There are {options} options, and more counts than that."
            ));
        };

        *slot = count;
        at += 1;
    }

    // Letters alone, as in `A B`, leave all counts at 0, and are refused. `A 0 B 0` cannot be told from them here: a
    // vote in which no learner took part is typed as zeros without letters, which stay.
    if is_named && counts.iter().all(|&count| count == 0) {
        return Err("A count follows each letter: A 12 B 30.".to_owned());
    }

    Ok(counts)
}

fn wrong_word(word: &str, last: char) -> String {
    let names = RightShare::ALL.map(RightShare::name);
    let hint = nearest(word, &names).map_or_else(String::new, |near| format!(" Is it \"{near}\"?"));
    format!("\"{word}\" is no option: they are A to {last}.{hint}")
}

/// What to do after a vote.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Advice {
    /// Too few are right to convince the others: give the hint or explain, and vote again.
    Explain,
    /// Let neighbours convince each other, and vote again.
    Discuss,
    /// Reveal the answer and go on.
    GoOn,
}

/// Returns what to do at a share of right answers. Discussion helps most between 30% and 70% (Crouch and Mazur, "Peer
/// Instruction: Ten years of experience and results", 2001).
#[must_use]
pub fn advice(share: f64) -> Advice {
    match share {
        share if share < 0.3 => Advice::Explain,
        share if share <= 0.7 => Advice::Discuss,
        _ => Advice::GoOn,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_read_by_letter_and_in_order() {
        let counts = |text: &str, options| Vote::read(text, options);
        let expected = Ok(Vote::Counts(vec![12, 30, 0]));
        for text in ["A 12 B 30", "a12 b30", "12 30", "B: 30, A: 12", "12, 30, 0"] {
            assert_eq!(counts(text, 3), expected, "{text}");
        }
        assert_eq!(counts("B 7", 2), Ok(Vote::Counts(vec![0, 7])));
        for share in RightShare::ALL {
            assert_eq!(Vote::read(share.name(), 0), Ok(Vote::Right(share)));
        }
    }

    #[test]
    fn wrong_votes_name_the_word_and_what_is_allowed() {
        let error = |text: &str, options| Vote::read(text, options).unwrap_err();
        assert!(error("D 3", 3).contains("A to C"));
        assert!(error("mosst", 3).contains("\"most\""));
        assert!(error("1 2 3 4", 3).contains("3 options"));
        assert!(error("A 99999", 3).contains("10000"));
        assert!(error("A -3", 3).contains("\"-3\""));
        assert!(error("A B", 3).contains("count"));
        assert!(error("", 3).contains("A 12 B 30"));
        assert!(error("12", 0).contains("half"));
        assert!(error("half 3", 2).contains("alone"));
    }

    #[test]
    fn the_share_of_right_answers_says_what_to_do() {
        let vote = Vote::Counts(vec![10, 30]);
        assert_eq!(vote.right_share(Some(1)), Some(0.75));
        assert_eq!(vote.right_share(None), None);
        assert_eq!(Vote::Counts(vec![0, 0]).right_share(Some(0)), None);
        let advised = RightShare::ALL.map(|share| {
            let share = Vote::Right(share).right_share(None);
            advice(share.expect("a share"))
        });
        assert_eq!(
            advised,
            [
                Advice::Explain,
                Advice::Explain,
                Advice::Discuss,
                Advice::GoOn
            ]
        );
    }
}
