//! Sums over the counts of sets, in integers: they do not depend on the order in which threads add to them.

use serde::{Deserialize, Serialize};

/// The counts of samples of several sets, summed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CountSums {
    pub sets: u64,
    pub samples: u64,
    /// The squares of the sets' counts. A million sets of 50,000 samples have 2.5 x 10^15, far less than 2^64.
    squares: u64,
}

impl CountSums {
    /// Returns the sums of one set.
    pub fn of(samples: usize) -> Self {
        let samples = samples as u64;
        Self {
            sets: 1,
            samples,
            squares: samples * samples,
        }
    }

    /// Returns the sums of both.
    pub const fn joined(self, other: Self) -> Self {
        Self {
            sets: self.sets + other.sets,
            samples: self.samples + other.samples,
            squares: self.squares + other.squares,
        }
    }

    /// Returns the mean of the counts, or NaN without sets.
    pub fn mean(&self) -> f64 {
        self.samples as f64 / self.sets as f64
    }

    /// Returns the standard error of the mean by the spread between sets; NaN for fewer than two.
    pub fn error(&self) -> f64 {
        // n times the sum of squares less the square of the sum: exact, where a difference of two sums of floats would keep
        // few of its digits.
        let [sets, samples, squares] = [self.sets, self.samples, self.squares].map(u128::from);
        let spread = (sets * squares - samples * samples) as f64;
        let sets = sets as f64;
        (spread / (sets * sets * (sets - 1.0))).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_error_are_those_of_the_counts_in_any_order() {
        let sums = |counts: &[usize]| {
            let each = counts.iter().map(|count| CountSums::of(*count));
            each.fold(CountSums::default(), CountSums::joined)
        };
        let one = sums(&[45_001, 45_003, 45_005, 45_007]);
        assert_eq!(one, sums(&[45_007, 45_001, 45_005, 45_003]));
        assert!((one.mean() - 45_004.0).abs() < 1e-9);
        // The variance of these four is 20/3, that of their mean a quarter of it.
        assert!((one.error() - (5.0_f64 / 3.0).sqrt()).abs() < 1e-9);
        assert!(sums(&[7]).error().is_nan());
    }
}
