//! A periodogram on a coarser grid, to be looked at: means over squares of frequencies.
//! It never leaves a frequency of the window out of sight but zero and an incomplete rim.

use serde::Serialize;

use super::check_count;
use super::error::MeasureError;
use super::periodogram::Periodogram;

/// Mean powers of squares of frequencies about zero.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CoarsePower {
    /// Squares along each axis, an odd number; the zero frequency is in the middle one.
    pub size: usize,
    /// Frequencies along a square's side, an odd number.
    pub side: usize,
    /// Mean powers, rows of equal ky, along kx. The zero frequency counts for nothing; where it is alone in its square,
    /// that is NaN.
    pub power: Vec<f64>,
}

impl CoarsePower {
    /// Squares along an axis at most.
    pub const MAX_SIZE: usize = 1024;

    /// Returns the means over the smallest odd squares of which at most `most` lie along an axis.
    ///
    /// # Errors
    ///
    /// [`MeasureError::BadCount`] for `most` zero or above [`Self::MAX_SIZE`], [`MeasureError::EmptyWindow`] where
    /// zero is no frequency of the window.
    pub fn of(periodogram: &Periodogram, most: usize) -> Result<Self, MeasureError> {
        check_count("squares along an axis", most, Self::MAX_SIZE)?;
        let [x0, x1, y0, y1] = periodogram.window.bounds();
        let reach = (-x0).min(x1 - 1).min(-y0).min(y1 - 1);
        if reach < 0 {
            let window = [x0, x1, y0, y1];
            return Err(MeasureError::EmptyWindow { window });
        }
        let squares = |side: i64| 2 * ((reach - (side - 1) / 2) / side) + 1;
        let side = (1..=2 * reach + 1)
            .step_by(2)
            .find(|side| squares(*side) <= most as i64)
            .unwrap_or(2 * reach + 1);
        let half = squares(side) / 2;
        let centers = move || -half..=half;
        let power = centers()
            .flat_map(|y| centers().map(move |x| [x * side, y * side]))
            .map(|center| mean(periodogram, center, (side - 1) / 2));
        Ok(Self {
            size: squares(side) as usize,
            side: side as usize,
            power: power.collect(),
        })
    }
}

/// The mean over a square of frequencies but zero.
fn mean(periodogram: &Periodogram, [x, y]: [i64; 2], reach: i64) -> f64 {
    let around = move |middle: i64| middle - reach..=middle + reach;
    let frequencies = around(y).flat_map(|ky| around(x).map(move |kx| [kx, ky]));
    let powers = frequencies
        .filter(|k| *k != [0, 0])
        .filter_map(|k| periodogram.at(k));
    let (sum, count) = powers.fold((0.0, 0), |(sum, count), power| (sum + power, count + 1));
    sum / f64::from(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::FrequencyWindow;
    use crate::region::{Boundary, Region};

    fn periodogram(most: u32) -> Periodogram {
        let window = FrequencyWindow::centered(most);
        let power = window.frequencies().map(|[x, y]| (x + 100 * y) as f64);
        Periodogram {
            power: power.collect(),
            window,
            region: Region {
                width: 1.0,
                height: 1.0,
                boundary: Boundary::Periodic,
            },
            samples: 100.0,
            sets: 1,
        }
    }

    #[test]
    fn a_fine_grid_is_the_periodogram_without_zero() {
        let found = CoarsePower::of(&periodogram(3), 7).unwrap();
        assert_eq!((found.size, found.side), (7, 1));
        assert!(found.power[24].is_nan());
        assert_eq!(found.power[0], -303.0);
        assert_eq!(found.power[48], 303.0);
    }

    #[test]
    fn squares_have_the_mean_of_their_frequencies() {
        let found = CoarsePower::of(&periodogram(7), 8).unwrap();
        assert_eq!((found.size, found.side), (5, 3));
        for (index, power) in found.power.iter().enumerate() {
            let [x, y] = [index % 5, index / 5].map(|i| 3.0 * (i as f64 - 2.0));
            assert!((power - (x + 100.0 * y)).abs() < 1e-9, "{index}: {power}");
        }
    }

    #[test]
    fn no_square_and_no_zero_are_refused() {
        assert!(CoarsePower::of(&periodogram(3), 0).is_err());
        let mut shifted = periodogram(3);
        shifted.window.x = 1..8;
        let refused = CoarsePower::of(&shifted, 7);
        assert!(matches!(refused, Err(MeasureError::EmptyWindow { .. })));
    }
}
