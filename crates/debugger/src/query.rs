//! Queries of events: words that must all hold, such as `insert iteration>1 block=7`. Comparisons may also be written as in
//! watches, `insert and distance < 0.9 && block == 7`. Events are numbered from 1, so
//! that the number of the last event is how many have happened. Errors name the word that they are in.

use std::cmp::Ordering;

use tilescope_core::{Origin, R, RunEvent, Verdict};

use crate::context::Context;
use crate::event::Event;
use crate::kind::EventKind;
use crate::listing::{LineId, Listings};
use crate::moves::{Target, matches_target};
use crate::recording::Recording;

/// An error in a query.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QueryError {
    /// A word is neither a kind of event nor a comparison.
    #[error(
        "\"{word}\" is neither a kind of event nor a comparison such as iteration>1{}",
        meant(near)
    )]
    UnknownWord {
        /// The word as it was typed.
        word: String,
        /// Similar words that are known.
        near: Vec<&'static str>,
    },
    /// The name is unknown.
    #[error(
        "\"{word}\": there is no \"{name}\"; there are event, iteration, block, sample, distance, depth, line, kind and verdict"
    )]
    UnknownName {
        /// The word as it was typed.
        word: String,
        /// The part before the comparison.
        name: String,
    },
    /// The value is not a whole number.
    #[error("\"{word}\": \"{value}\" is not a whole number")]
    NotANumber {
        /// The word as it was typed.
        word: String,
        /// The part behind the comparison.
        value: String,
    },
    /// The value is not a number.
    #[error("\"{word}\": \"{value}\" is not a number of radii")]
    NotALength {
        /// The word as it was typed.
        word: String,
        /// The part behind the comparison.
        value: String,
    },
    /// The value of `kind`, `line` or `verdict` is unknown.
    #[error("\"{word}\": \"{value}\" is not known here")]
    UnknownValue {
        /// The word as it was typed.
        word: String,
        /// The part behind the comparison.
        value: String,
    },
    /// The comparison needs numbers, and the values are not.
    #[error("\"{word}\": only = and != can be used here")]
    NotOrdered {
        /// The word as it was typed.
        word: String,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NumberField {
    Event,
    Iteration,
    Block,
    Depth,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
/// A condition on an event. A term that ends with `bool` accepts what it names if that is true, and all else if it is false.
enum Term {
    Kind(EventKind, bool),
    /// A target of a run, such as the next conflict.
    Found(Target),
    Line(LineId, bool),
    Verdict(&'static str, bool),
    Sample(u32, bool),
    Number(NumberField, Orderings, i64),
    /// The distance of the two samples that an event names, in r, as the bits of a float: floats are not `Eq`.
    Distance(Orderings, u64),
}

/// A parsed query; by default it accepts every event.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Query {
    terms: Vec<Term>,
}

/// How the number of an event may compare with the number of a query.
type Orderings = &'static [Ordering];

const EQUAL: Orderings = &[Ordering::Equal];
const UNEQUAL: Orderings = &[Ordering::Less, Ordering::Greater];

/// The signs of comparisons. Of two signs that begin alike, the longer one comes first.
const OPERATORS: [(&str, Orderings); 8] = [
    ("==", EQUAL),
    ("!=", UNEQUAL),
    ("<=", &[Ordering::Less, Ordering::Equal]),
    (">=", &[Ordering::Greater, Ordering::Equal]),
    ("<", &[Ordering::Less]),
    (">", &[Ordering::Greater]),
    ("=", EQUAL),
    (":", EQUAL),
];

/// Words for what the debugger runs to, with their meanings.
const TARGETS: [(&str, Target, &str); 4] = [
    (
        "conflict",
        Target::Conflict,
        "Two samples are found to be in conflict.",
    ),
    (
        "elimination",
        Target::Elimination,
        "A sample is eliminated.",
    ),
    ("gap", Target::Gap, "A place is found to lie in a gap."),
    ("insertion", Target::Insertion, "A sample is inserted."),
];

/// Beginnings of comparisons, with their meanings.
const COMPARISONS: [(&str, &str); 8] = [
    ("iteration=", "Events of an iteration, also with < and >."),
    ("block=", "Events of a block, also with < and >."),
    ("sample=", "Events that name a sample, also with !=."),
    (
        "distance=",
        "Events of two samples at a distance in r, also with < and >.",
    ),
    ("event=", "The event of a number, also with < and >."),
    (
        "depth=",
        "Events of a depth in the tree, also with < and >.",
    ),
    ("line=", "Events of a line of pseudocode, such as insert.3."),
    (
        "verdict=",
        "Examined places: accepted, too-far, outside, covered, not-nearest or thinned.",
    ),
];

const VERDICTS: [&str; 6] = [
    "accepted",
    "too-far",
    "outside",
    "covered",
    "not-nearest",
    "thinned",
];

/// Returns the words of queries with their meanings: targets of runs, kinds of events, and beginnings of comparisons.
pub fn words() -> impl Iterator<Item = (&'static str, &'static str)> {
    let targets = TARGETS.iter().map(|&(word, _, meaning)| (word, meaning));
    let all = EventKind::ALL.iter();
    let kinds = all.map(|kind| (kind.name(), kind.explanation()));
    targets.chain(kinds).chain(COMPARISONS)
}

/// Returns the words that the last word of a text may become; none if it is empty or one of them.
#[must_use]
pub fn completions(text: &str) -> Vec<(&'static str, &'static str)> {
    let last = text.rsplit(char::is_whitespace).next().unwrap_or_default();
    if last.is_empty() || words().any(|(word, _)| word == last) {
        return Vec::new();
    }

    let mut near: Vec<_> = words().filter(|(word, _)| is_near(word, last)).collect();
    // Words that only have to be finished come before those that are corrected.
    near.sort_by_key(|(word, _)| !word.starts_with(last));
    near
}

/// Returns a text with its last word replaced, ready for the next word or the number of a comparison.
#[must_use]
pub fn completed(text: &str, word: &str) -> String {
    let start = text.rfind(char::is_whitespace).map_or(0, |at| at + 1);
    let end = if word.ends_with('=') { "" } else { " " };
    format!("{}{word}{end}", &text[..start])
}

/// Returns whether a typed word may stand for a known one: it is a part of it, or at most two letters must
/// be added, removed or replaced.
fn is_near(known: &str, typed: &str) -> bool {
    let typed = typed.to_lowercase();
    // Two changes leave little of a word of three letters, so that short ones must be a part.
    known.contains(&typed) || (typed.len() > 3 && strsim::levenshtein(known, &typed) <= 2)
}

/// Returns the end of an error's sentence that lists similar words.
fn meant(near: &[&str]) -> String {
    if near.is_empty() {
        return String::new();
    }
    format!("; similar: {}", near.join(", "))
}

impl Query {
    /// Returns the query of a text; an empty one accepts every event.
    pub fn parse(text: &str) -> Result<Self, QueryError> {
        let written = joined(text);
        // All words of a query must hold, so that "and" between them adds nothing.
        let words = written.split_whitespace().filter(|word| *word != "and");
        let terms: Result<_, _> = words.map(parse_word).collect();
        Ok(Self { terms: terms? })
    }

    /// Returns whether an event matches. `context` is the context after the event.
    #[must_use]
    pub fn accepts(
        &self,
        recording: &Recording,
        index: usize,
        event: &Event,
        context: &Context,
    ) -> bool {
        self.terms
            .iter()
            .all(|term| term.holds(recording, index, event, context))
    }

    /// Returns the matching events in order, at most `limit` of them.
    #[must_use]
    pub fn find_all(&self, recording: &Recording, limit: usize) -> Vec<usize> {
        let mut context = Context::default();
        let meant = recording.tape().from(0).filter(|&(index, event)| {
            context.apply(event, index as u32);
            self.accepts(recording, index, event, &context)
        });
        meant.map(|(index, _)| index).take(limit).collect()
    }
}

impl Term {
    /// Returns whether an event of this index matches. `context` is the context after the event.
    fn holds(self, recording: &Recording, index: usize, event: &Event, context: &Context) -> bool {
        match self {
            Self::Found(target) => matches_target(recording, index, event, target),
            Self::Kind(kind, wanted) => (event.kind() == kind) == wanted,
            Self::Line(line, wanted) => (event.line() == line) == wanted,
            Self::Verdict(name, wanted) => (verdict_name(event) == Some(name)) == wanted,
            Self::Sample(sample, wanted) => event.touches(sample) == wanted,

            Self::Number(number, orderings, value) => {
                let found = match number {
                    // Numbers of events begin with 1 wherever a user meets them.
                    NumberField::Event => Some(index as i64 + 1),
                    NumberField::Iteration => Some(context.iteration.into()),
                    // Each kind of event has a depth, but not every event is of a block.
                    NumberField::Depth => Some(event.depth().into()),
                    NumberField::Block => block(recording, event).map(i64::from),
                };

                // An event without a block matches no comparison of blocks, not even `!=`.
                found.is_some_and(|found| orderings.contains(&found.cmp(&value)))
            }

            Self::Distance(orderings, value) => {
                let [a, b, ..] = event.samples();
                let wanted = f64::from_bits(value);

                // An event without two samples has no distance and does not match.
                let ordering =
                    distance(recording, a, b).and_then(|found| found.partial_cmp(&wanted));
                ordering.is_some_and(|ordering| orderings.contains(&ordering))
            }
        }
    }
}

/// Returns the block of an event: the one that it makes or gives a clip; else that of its first sample, which for an
/// inserted sample is the block in which it lies. `None` if the event names no sample, or one that a recording that was
/// cut off lacks.
#[must_use]
pub fn block(recording: &Recording, event: &Event) -> Option<u32> {
    if let Some(RunEvent::Leaf { block } | RunEvent::Clip { block }) = event.run_event() {
        return Some(block);
    }

    let sample = event.samples()[0];
    match recording.run().samples.origins.get(sample as usize)? {
        Origin::Tiled { block, .. } => Some(*block),
        // An inserted sample comes from no block: the one whose rectangle holds its place counts.
        Origin::Inserted { .. } => {
            let point = recording.point(sample)?;
            let leaves = &recording.run().blocks.leaves;
            leaves
                .iter()
                .position(|block| block.rect.contains(point))
                .map(|k| k as u32)
        }
    }
}

/// Returns the shortest way between two samples, in r, if the recording has both.
#[must_use]
pub fn distance(recording: &Recording, a: u32, b: u32) -> Option<f64> {
    let (at_a, at_b) = (recording.point(a)?, recording.point(b)?);
    let planar = recording.domain().distance_squared(at_a, at_b) as f64;
    // Samples of a set in space lie at different heights, too.
    let height = recording
        .heights()
        .and_then(|heights| heights.get(a as usize));
    let above = height.and_then(|&z| recording.above(b, z));
    let above = above.map_or(0.0, f64::from);
    Some((planar + above * above).sqrt() / f64::from(R))
}

/// Returns the name of the verdict of an event that examines a point; `None` for other events.
#[must_use]
pub fn verdict_name(event: &Event) -> Option<&'static str> {
    let (RunEvent::Candidate { verdict, .. } | RunEvent::Dart { verdict, .. }) =
        event.run_event()?
    else {
        return None;
    };
    Some(match verdict {
        Verdict::Accepted => VERDICTS[0],
        Verdict::TooFar => VERDICTS[1],
        Verdict::Outside => VERDICTS[2],
        Verdict::Covered { .. } => VERDICTS[3],
        Verdict::NotNearest { .. } => VERDICTS[4],
        Verdict::Thinned => VERDICTS[5],
    })
}

/// Returns a query without the blanks around its comparisons, and with a blank in place of each `&&`. People write
/// both in watches, and may write them in queries.
fn joined(text: &str) -> String {
    let text = text.replace("&&", " ");
    let mut written = String::with_capacity(text.len());

    let compares = |c: char| "=<>!:".contains(c);
    let mut is_value_next = false;
    for c in text.chars() {
        // Blanks before a comparison are taken back, those behind it are not copied.
        if compares(c) {
            written.truncate(written.trim_end().len());
        } else if c.is_whitespace() && is_value_next {
            continue;
        }
        is_value_next = compares(c);

        written.push(c);
    }
    written
}

/// The parts of a comparison's text.
struct Word<'a> {
    text: &'a str,
    name: &'a str,
    value: &'a str,
    orderings: Orderings,
}

/// Returns the term of a word: a target, a kind of event, or a comparison.
fn parse_word(word: &str) -> Result<Term, QueryError> {
    let signs = OPERATORS.iter();
    let split = signs.filter_map(|&(sign, orderings)| {
        let parts = word.split_once(sign)?;
        Some((parts, orderings))
    });

    // The first sign in the word divides it. Where `<=` stands, `<` stands, too: of signs at one place `min_by_key` takes
    // the first of the list, which is the longest.
    let Some(((name, value), orderings)) = split.min_by_key(|((name, _), _)| name.len()) else {
        if let Some((_, target, _)) = TARGETS.iter().find(|(name, ..)| *name == word) {
            return Ok(Term::Found(*target));
        }
        let unknown = || QueryError::UnknownWord {
            word: word.into(),
            near: completions(word).iter().map(|(near, _)| *near).collect(),
        };

        let kind = EventKind::named(word).ok_or_else(unknown)?;
        // A kind alone asks for its events, as `kind=` does, and not for all others.
        let is_wanted = true;
        return Ok(Term::Kind(kind, is_wanted));
    };

    let word = Word {
        text: word,
        name,
        // Watches have their texts in quotes.
        value: value.trim_matches('"'),
        orderings,
    };
    word.term()
}

impl Word<'_> {
    /// Returns the term of the comparison. The error names the word and, unless only its sign is wrong, the part of it
    /// that is wrong.
    fn term(&self) -> Result<Term, QueryError> {
        match self.name {
            // Names and samples can only be equal or not, which `same` returns; numbers and distances have an order, too.
            "kind" => Ok(Term::Kind(
                self.known(EventKind::named(self.value))?,
                self.same()?,
            )),
            "line" => {
                let line = self.known(Listings::shipped().find(self.value))?;
                Ok(Term::Line(line, self.same()?))
            }
            "verdict" => {
                let name = VERDICTS.into_iter().find(|&name| name == self.value);
                Ok(Term::Verdict(self.known(name)?, self.same()?))
            }

            "sample" => Ok(Term::Sample(self.whole()?, self.same()?)),
            "event" => self.number(NumberField::Event),
            "iteration" => self.number(NumberField::Iteration),
            "block" => self.number(NumberField::Block),
            "depth" => self.number(NumberField::Depth),

            "distance" => self.distance(),

            _ => Err(QueryError::UnknownName {
                word: self.text.into(),
                name: self.name.into(),
            }),
        }
    }

    fn known<T>(&self, value: Option<T>) -> Result<T, QueryError> {
        value.ok_or_else(|| QueryError::UnknownValue {
            word: self.text.into(),
            value: self.value.into(),
        })
    }

    /// Returns whether the comparison is for equality or, if false, for inequality. Fails for other comparisons.
    fn same(&self) -> Result<bool, QueryError> {
        match self.orderings {
            EQUAL => Ok(true),
            UNEQUAL => Ok(false),
            _ => Err(QueryError::NotOrdered {
                word: self.text.into(),
            }),
        }
    }

    fn whole(&self) -> Result<u32, QueryError> {
        self.value.parse().map_err(|_| QueryError::NotANumber {
            word: self.text.into(),
            value: self.value.into(),
        })
    }

    /// Returns the term of a distance. Its bits are kept, so that terms can be compared.
    fn distance(&self) -> Result<Term, QueryError> {
        let length = self
            .value
            .parse()
            .ok()
            .filter(|value: &f64| value.is_finite());
        let length = length.ok_or_else(|| QueryError::NotALength {
            word: self.text.into(),
            value: self.value.into(),
        })?;
        Ok(Term::Distance(self.orderings, length.to_bits()))
    }

    fn number(&self, number: NumberField) -> Result<Term, QueryError> {
        let value = self.whole()?.into();
        Ok(Term::Number(number, self.orderings, value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_parsed() {
        let query = Query::parse("insert iteration>=2 block=7 kind!=dart line:insert.3").unwrap();
        assert_eq!(query.terms[0], Term::Kind(EventKind::Insert, true));
        assert_eq!(
            query.terms[1],
            Term::Number(
                NumberField::Iteration,
                &[Ordering::Greater, Ordering::Equal],
                2
            )
        );
        assert_eq!(query.terms[3], Term::Kind(EventKind::Dart, false));
        assert_eq!(query.terms.len(), 5);
        assert_eq!(Query::parse("  "), Ok(Query::default()));
    }

    #[test]
    fn queries_may_be_written_as_watches() {
        let query = Query::parse("insert iteration>1 block=7 line=insert.3").unwrap();
        for text in [
            "insert and iteration > 1 and block == 7 and line=insert.3",
            "insert && iteration>1 && block == 7 && line == \"insert.3\"",
            "insert&&iteration >1&&block= 7&&line : insert.3",
        ] {
            assert_eq!(Query::parse(text).as_ref(), Ok(&query), "{text}");
        }
        let near = Query::parse("distance < 0.9").unwrap();
        assert_eq!(near.terms.len(), 1);
        assert_eq!(Query::parse("distance<0.9"), Ok(near));
    }

    #[test]
    fn words_are_completed_and_similar_ones_are_named() {
        let near = |text: &str| -> Vec<&str> {
            completions(text)
                .into_iter()
                .map(|(word, _)| word)
                .collect()
        };
        assert_eq!(near("insert conf"), ["conflict"]);
        assert_eq!(near("iter"), ["iteration", "iteration-end", "iteration="]);
        assert_eq!(near("confilct"), ["conflict"]);
        assert!(near("").is_empty() && near("gap").is_empty() && near("block=7 ").is_empty());
        assert_eq!(completed("gap ite", "iteration="), "gap iteration=");
        assert_eq!(completed("conf", "conflict"), "conflict ");
        for (word, _) in words().filter(|(word, _)| !word.ends_with('=')) {
            assert!(Query::parse(word).is_ok(), "{word}");
        }
        let error = Query::parse("elimnation").unwrap_err().to_string();
        assert!(error.ends_with("; similar: elimination"), "{error}");
    }

    #[test]
    fn the_bad_word_is_named() {
        for (text, part) in [
            ("insert banana", "\"banana\" is neither"),
            ("colour=3", "there is no \"colour\""),
            ("iteration>two", "\"two\" is not a whole number"),
            ("block=-1", "\"-1\" is not a whole number"),
            ("kind:explode", "\"explode\" is not known"),
            ("line=eliminate.99", "\"eliminate.99\" is not known"),
            ("sample<3", "only = and !="),
            ("distance<near", "\"near\" is not a number of radii"),
            ("=", "there is no \"\""),
        ] {
            let error = Query::parse(text).unwrap_err().to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
