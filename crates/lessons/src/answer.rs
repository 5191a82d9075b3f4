//! Answers of learners. They are plain data, as they come from windows and pages, and their texts are kept in results.

use std::fmt;

use serde::{Deserialize, Serialize};

/// An answer of a learner. Positions and lengths are in r; options, items and bands are numbered from 0 in the order in
/// which they are shown.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// The samples, by id.
    Pick(Vec<u32>),
    /// A place, in r.
    Place([f64; 2]),
    /// A number, in the unit of its question.
    Number(f64),
    /// An option; in a trace, of the event that is predicted.
    Choice(usize),
    /// The items, in their order.
    Order(Vec<usize>),
    /// A cut across an axis at a coordinate.
    Cut {
        /// The axis across which it cuts.
        axis: CutAxis,
        /// The coordinate on that axis, in r.
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
    /// It grows by more than the noise.
    Up,
    /// It stays within the noise.
    Same,
    /// It falls by more than the noise.
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

/// Returns the texts of values, joined.
pub(crate) fn joined<T: fmt::Display>(
    values: impl IntoIterator<Item = T>,
    between: &str,
) -> String {
    let texts = values.into_iter().map(|value| value.to_string());
    texts.collect::<Vec<_>>().join(between)
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

/// Returns the letter of an option.
#[must_use]
pub fn letter(option: usize) -> char {
    char::from(b'A' + (option % 26) as u8)
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pick(samples) => f.write_str(&joined(samples, " ")),
            Self::Place([x, y]) => write!(f, "({} {})", short(*x), short(*y)),
            Self::Number(number) => write!(f, "{}", short(*number)),
            Self::Choice(option) => write!(f, "{}", letter(*option)),
            Self::Order(items) => f.write_str(&joined(items.iter().copied().map(letter), " ")),
            Self::Cut { axis, at } => write!(f, "{axis:?} {}", short(*at)),
            Self::Bands(changes) => f.write_str(&joined(changes, " ")),
        }
    }
}
