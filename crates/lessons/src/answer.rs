//! Answers of learners, and keys: the right answers. Both are plain data, as answers come from windows, pages and files,
//! and the keys of shipped lessons are kept in files.

use std::fmt;

use serde::{Deserialize, Serialize};

/// An answer of a learner. Positions and lengths are in r; options, items and bands are numbered from 0 in the order in
/// which they are shown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Answer {
    /// The samples, by id.
    Pick(Vec<u32>),
    /// A place.
    Place([f64; 2]),
    /// A number.
    Number(f64),
    /// An option; in a trace, of the event that is predicted.
    Choice(usize),
    /// The items, in their order.
    Order(Vec<usize>),
    /// A cut across an axis at a coordinate.
    Cut {
        /// The axis.
        axis: CutAxis,
        /// The coordinate.
        at: f64,
    },
    /// The changes of the bands.
    Bands(Vec<Change>),
}

/// The axis that a cut divides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CutAxis {
    /// A vertical line at some x.
    X,
    /// A horizontal line at some y.
    Y,
}

impl CutAxis {
    /// Returns its name, "x" or "y".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
        }
    }

    pub(crate) const fn other(self) -> Self {
        match self {
            Self::X => Self::Y,
            Self::Y => Self::X,
        }
    }
}

/// How the power of a band changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Change {
    /// It grows.
    Up,
    /// It stays within the noise.
    Same,
    /// It falls.
    Down,
}

impl Change {
    /// All changes, in the order in which they are offered.
    pub const ALL: [Self; 3] = [Self::Up, Self::Same, Self::Down];
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Up => "up",
            Self::Same => "same",
            Self::Down => "down",
        })
    }
}

/// The right answer to a question, computed from the recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Key {
    /// All samples that are right. A question for one sample accepts any of them.
    Pick(Vec<u32>),
    /// Right places.
    Place(Vec<[f64; 2]>),
    /// The number.
    Number(f64),
    /// The option.
    Choice(usize),
    /// The number by which each item is sorted.
    Order(Vec<f64>),
    /// The axis, and the interval of legal cuts.
    Cut {
        /// The axis.
        axis: CutAxis,
        /// The lowest and the highest coordinate.
        legal: [f64; 2],
    },
    /// The changes.
    Bands(Vec<Change>),
    /// The option of each event.
    Trace(Vec<usize>),
}

/// Writes numbers without needless digits, separated by spaces.
fn list<T: fmt::Display>(
    f: &mut fmt::Formatter<'_>,
    values: impl IntoIterator<Item = T>,
) -> fmt::Result {
    for (index, value) in values.into_iter().enumerate() {
        write!(f, "{}{value}", if index > 0 { " " } else { "" })?;
    }
    Ok(())
}

/// Returns the indices of numbers, the smallest number first.
pub(crate) fn sorted(ranks: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..ranks.len()).collect();
    order.sort_by(|&a, &b| ranks[a].total_cmp(&ranks[b]));
    order
}

/// Returns a number with at most four decimals.
pub(crate) fn short(number: f64) -> f64 {
    (number * 1e4).round() / 1e4
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pick(samples) => list(f, samples),
            Self::Place(places) => list(f, places.iter().map(|at| Answer::Place(*at))),
            Self::Number(number) => write!(f, "{}", short(*number)),
            Self::Choice(option) => write!(f, "{}", letter(*option)),
            Self::Order(ranks) => list(f, sorted(ranks).into_iter().map(letter)),
            Self::Cut {
                axis,
                legal: [low, high],
            } => write!(f, "{axis:?} {}..{}", short(*low), short(*high)),
            Self::Bands(changes) => list(f, changes),
            Self::Trace(options) => list(f, options.iter().copied().map(letter)),
        }
    }
}

/// Returns the letter of an option.
#[must_use]
pub fn letter(option: usize) -> char {
    char::from(b'A' + (option % 26) as u8)
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pick(samples) => list(f, samples),
            Self::Place([x, y]) => write!(f, "({} {})", short(*x), short(*y)),
            Self::Number(number) => write!(f, "{}", short(*number)),
            Self::Choice(option) => write!(f, "{}", letter(*option)),
            Self::Order(items) => list(f, items.iter().copied().map(letter)),
            Self::Cut { axis, at } => write!(f, "{axis:?} {}", short(*at)),
            Self::Bands(changes) => list(f, changes),
        }
    }
}
