//! The order in which points are taken.

use std::fmt;
use std::str::FromStr;

use rayon::prelude::*;
use tilescope_core::{Key, Stream};

/// The order in which points are taken. Of equal ones the first of the file comes first.
///
/// ```
/// use tilescope_sets::thinning::ThinningPriority;
///
/// let drawn: ThinningPriority = "random 7".parse()?;
/// assert_eq!(drawn, ThinningPriority::Random { seed: 7 });
/// assert_eq!("least of height".parse::<ThinningPriority>()?.to_string(), "least of height");
/// # Ok::<(), tilescope_sets::thinning::UnknownPriority>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ThinningPriority {
    /// That of the file.
    Order,
    /// That of the values in a column of the file.
    Column {
        /// The name of the column, or its number from 1.
        column: String,
        /// Which value is the first.
        first: FirstValue,
    },
    /// That of draws, one for each place in the file.
    Random {
        /// The seed of the draws.
        seed: u64,
    },
}

/// The value that comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FirstValue {
    /// Low values are taken before high ones.
    Least,
    /// High values are taken before low ones.
    Greatest,
}

/// The words before the name of a column.
const LEAST: &str = "least of ";
const GREATEST: &str = "greatest of ";

/// As certificates state it.
impl fmt::Display for ThinningPriority {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Order => f.write_str("order"),
            Self::Column { column, first } => {
                let first = match first {
                    FirstValue::Least => LEAST,
                    FirstValue::Greatest => GREATEST,
                };
                write!(f, "{first}{column}")
            }
            Self::Random { seed } => write!(f, "random {seed}"),
        }
    }
}

/// A certificate states an order that is not known here.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the order \"{0}\" is not known; known are order, random SEED, least of COLUMN and greatest of COLUMN"
)]
pub struct UnknownPriority(pub String);

impl FromStr for ThinningPriority {
    type Err = UnknownPriority;

    fn from_str(text: &str) -> Result<Self, UnknownPriority> {
        let seed = || text.strip_prefix("random ")?.parse().ok();
        let by_column = |words: &str, first| {
            let column = text.strip_prefix(words)?.to_owned();
            Some(Self::Column { column, first })
        };
        let drawn = || seed().map(|seed| Self::Random { seed });
        // Words come before the name of a column, so that a column may be called "order" or "random 7" as well.
        (text == "order")
            .then_some(Self::Order)
            .or_else(drawn)
            .or_else(|| by_column(LEAST, FirstValue::Least))
            .or_else(|| by_column(GREATEST, FirstValue::Greatest))
            .ok_or_else(|| UnknownPriority(text.to_owned()))
    }
}

/// Returns for each of `count` points its place in the order of a priority; `None` if that is the order of the file.
/// `column` has the values of a priority by column, and is not read for the others. Equal values are taken in the order
/// of the file.
///
/// # Panics
///
/// If the priority is a column and there are not as many values.
#[must_use]
pub fn ranks(priority: &ThinningPriority, count: usize, column: &[f64]) -> Option<Vec<u32>> {
    let all = (0..count as u32).into_par_iter();

    match priority {
        ThinningPriority::Order => None,
        ThinningPriority::Column { first, .. } => {
            assert_eq!(column.len(), count, "one value for each point");
            let sort_key = |index: u32| {
                // Adding 0 makes the two zeros equal.
                let value = column[index as usize] + 0.0;
                match first {
                    FirstValue::Least => sortable(value),
                    FirstValue::Greatest => !sortable(value),
                }
            };
            Some(places(all.map(|index| (sort_key(index), index)).collect()))
        }
        ThinningPriority::Random { seed } => {
            // Draws are keyed by the place in the file: no draw depends on the others, nor on threads.
            let key = Key::from_seed(*seed);
            let draw = |index| {
                let [high, low] = key.draw(Stream::Priority, index);
                u64::from(high) << 32 | u64::from(low)
            };
            Some(places(all.map(|index| (draw(index), index)).collect()))
        }
    }
}

/// Returns an integer that is greater for a greater double.
const fn sortable(value: f64) -> u64 {
    let bits = value.to_bits();
    // Negative numbers have the sign bit, and grow with their other bits.
    if bits >> 63 == 0 {
        bits | 1 << 63
    } else {
        !bits
    }
}

/// Returns the place of each index in the order of its key.
fn places(mut keys: Vec<(u64, u32)>) -> Vec<u32> {
    keys.par_sort_unstable();
    let mut places = vec![0; keys.len()];
    for ((_, index), place) in keys.into_iter().zip(0..) {
        places[index as usize] = place;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    fn by_column(first: FirstValue, values: &[f64]) -> Vec<u32> {
        let column = "w".to_owned();
        let priority = ThinningPriority::Column { column, first };
        ranks(&priority, values.len(), values).expect("ranks")
    }

    #[test]
    fn columns_are_sorted_as_numbers_and_ties_by_index() {
        let values = [2.0, -1.0, 0.0, -0.0, -7.5, 1e-300];
        assert_eq!(by_column(FirstValue::Least, &values), [5, 1, 2, 3, 0, 4]);
        assert_eq!(by_column(FirstValue::Greatest, &values), [0, 4, 2, 3, 5, 1]);
    }

    #[test]
    fn orders_are_stated_and_read() {
        for text in [
            "order",
            "random 18446744073709551615",
            "least of a b",
            "greatest of least of z",
        ] {
            let read: ThinningPriority = text.parse().expect(text);
            assert_eq!(read.to_string(), text);
        }
        for text in ["", "Order", "random", "random -1", "least", "height"] {
            assert!(text.parse::<ThinningPriority>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_draw_is_a_permutation_and_pinned() {
        let draw = |seed| ranks(&ThinningPriority::Random { seed }, 8, &[]).expect("ranks");
        let mut sorted = draw(7);
        assert_ne!(sorted, draw(8));
        sorted.sort_unstable();
        assert_eq!(sorted, [0, 1, 2, 3, 4, 5, 6, 7]);
        assert!(ranks(&ThinningPriority::Order, 8, &[]).is_none());
    }
}
