//! A periodogram on a coarser grid, for display: means over rectangles of frequencies. Every frequency of the window
//! counts, except zero and those of an incomplete rim.

use std::borrow::Cow;
use std::ops::Range;

use rayon::prelude::*;
use serde::Serialize;

use super::check_count;
use super::error::MeasureError;
use super::periodogram::Periodogram;

/// Mean powers of rectangles of frequencies about zero; of squares where the window is one.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct CoarsePower {
    /// Rectangles along x, an odd number; the zero frequency is in the middle one.
    pub size: usize,
    /// Rectangles along y, an odd number.
    pub rows: usize,
    /// Frequencies along a rectangle's side in x, an odd number.
    pub side: usize,
    /// Frequencies along a rectangle's side in y, an odd number.
    pub row_side: usize,
    /// Mean powers, rows of equal ky, along kx. The zero frequency counts for nothing; where it is alone in its rectangle,
    /// that is NaN.
    pub power: Vec<f64>,
}

impl CoarsePower {
    /// Rectangles along an axis at most.
    pub const MAX_SIZE: usize = 1024;

    /// Returns the means over rectangles with odd sides: the smallest with which at most `most` lie along an axis.
    ///
    /// # Errors
    ///
    /// [`MeasureError::BadCount`] for `most` zero or above [`Self::MAX_SIZE`], [`MeasureError::EmptyWindow`] where
    /// zero is no frequency of the window.
    pub fn of(periodogram: &Periodogram, most: usize) -> Result<Self, MeasureError> {
        check_count("squares along an axis", most, Self::MAX_SIZE)?;
        let [x0, x1, y0, y1] = periodogram.window.bounds();
        // The picture has zero in its middle, and reaches as far as the window does to both sides.
        let reach = [(-x0).min(x1 - 1), (-y0).min(y1 - 1)];
        if reach.iter().any(|reach| *reach < 0) {
            let window = [x0, x1, y0, y1];
            return Err(MeasureError::EmptyWindow { window });
        }

        // With a step of 1 every frequency of the window is added.
        let step = 1;
        let mut sums = CoarseSums::new(reach, most, step);
        let [x, y] = reach;
        let columns = 2 * x as usize + 1;
        let rows = (-y..y + 1).into_par_iter().map(|ky| {
            // The window reaches as far as the picture to both sides, so that each row of the picture is a part of a
            // row of the window: the zeros below never stand in for one.
            let first = periodogram.window.index([-x, ky]);
            let row = first.and_then(|first| periodogram.power.get(first..first + columns));
            let mut powers = row.map_or_else(|| Cow::Owned(vec![0.0; columns]), Cow::Borrowed);
            if ky == 0 {
                // The power at zero counts as 0: it depends on the number of samples alone, and would outshine all
                // others.
                powers.to_mut()[x as usize] = 0.0;
            }
            sums.along(&powers)
        });

        // Rows are added in their order, so that rounding does not depend on threads.
        for (row, along) in rows.collect::<Vec<_>>().into_iter().enumerate() {
            sums.add(row, &along);
        }
        Ok(sums.picture())
    }
}

/// A picture in the making, from rows of powers at the multiples of a frequency.
pub(crate) struct CoarseSums {
    /// Parts on either side of the middle one, and the frequencies along a side: along x and along y.
    divisions: [(i64, i64); 2],
    /// For each part along x and along y its multiples, counted from the lowest one on.
    parts: [Vec<Range<usize>>; 2],
    /// The sums of the parts, row by row.
    sums: Vec<f64>,
}

impl CoarseSums {
    /// Returns sums without any row yet, for the multiples of `step` up to `reach`, in at most `most` parts along an axis.
    pub fn new(reach: [i64; 2], most: usize, step: i64) -> Self {
        let divisions = reach.map(|reach| division(reach, most, step));
        let parts = [0, 1].map(|axis| {
            let (half, side) = divisions[axis];
            let lowest = -(reach[axis] / step);
            // How many of the multiples, which begin with the lowest one, are below k.
            let multiples_below = |k: i64| ((k - 1).div_euclid(step) + 1 - lowest) as usize;
            // Part 0 has zero in its middle.
            let part_at = |number: i64| {
                let first = number * side - (side - 1) / 2;
                multiples_below(first)..multiples_below(first + side)
            };
            (-half..=half).map(part_at).collect::<Vec<_>>()
        });

        Self {
            sums: vec![0.0; parts[0].len() * parts[1].len()],
            divisions,
            parts,
        }
    }

    /// Adds the powers at the multiples along x of a multiple along y, both counted from the lowest on. That of zero
    /// must be given as 0.
    pub fn add_row(&mut self, row: usize, powers: &[f64]) {
        let along = self.along(powers);
        self.add(row, &along);
    }

    /// Returns the sums of a row over the parts along x.
    fn along(&self, powers: &[f64]) -> Vec<f64> {
        let columns = self.parts[0].iter();
        let sum = |part: &Range<usize>| powers[part.clone()].iter().sum();
        columns.map(sum).collect()
    }

    /// Adds the sums of a row over the parts along x.
    fn add(&mut self, row: usize, along: &[f64]) {
        let rows = &self.parts[1];
        let part = rows.partition_point(|part| part.end <= row);
        // Rows of an incomplete rim are in no part.
        if rows.get(part).is_none_or(|part| !part.contains(&row)) {
            return;
        }

        let sums = &mut self.sums[part * along.len()..][..along.len()];
        for (sum, more) in sums.iter_mut().zip(along) {
            *sum += more;
        }
    }

    /// Returns whether the middle parts have a multiple along y, counted from the lowest on.
    pub fn is_in_middle(&self, row: usize) -> bool {
        let rows = &self.parts[1];
        rows[rows.len() / 2].contains(&row)
    }

    /// Returns the means where opposite frequencies have the same power, and no row below the middle parts was added.
    pub fn symmetric_picture(mut self) -> CoarsePower {
        let [columns, rows] = &self.parts;
        let (below, others) = self.sums.split_at_mut(rows.len() / 2 * columns.len());
        for (sum, opposite) in below.iter_mut().zip(others.iter().rev()) {
            *sum = *opposite;
        }
        self.picture()
    }

    /// Returns the mean power of each part.
    pub fn picture(&self) -> CoarsePower {
        let [columns, rows] = &self.parts;
        let counts = rows
            .iter()
            .flat_map(|row| columns.iter().map(|column| row.len() * column.len()));
        let middle = self.sums.len() / 2;
        let power = (self.sums.iter().zip(counts))
            .enumerate()
            .map(|(part, (sum, count))| {
                // The middle part has the zero frequency, which is not counted.
                let counted = count - usize::from(part == middle);
                sum / counted as f64
            });

        let [(_, side), (_, row_side)] = self.divisions;
        CoarsePower {
            size: columns.len(),
            rows: rows.len(),
            side: side as usize,
            row_side: row_side as usize,
            power: power.collect(),
        }
    }
}

/// Returns the parts on either side of the middle one and their length, for the multiples of `step` up to `reach`.
fn division(reach: i64, most: usize, step: i64) -> (i64, i64) {
    // The middle part takes half of its side from the reach. With those on both sides there are 2 parts + 1, at most
    // `most`.
    let parts = |side: i64| (reach - (side - 1) / 2) / side;
    // A part shorter than the step may have no multiple of it, and so no mean.
    let side = (1..=2 * reach + 1)
        .step_by(2)
        .find(|side| *side >= step && 2 * parts(*side) < most as i64)
        .unwrap_or(2 * reach + 1);
    (parts(side), side)
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

    /// Each axis has its own side: a power of a rectangle is still the mean of its frequencies.
    #[test]
    fn an_oblong_window_is_divided_along_each_axis() {
        let mut oblong = periodogram(7);
        oblong.window.y = -2..3;
        oblong.power = (oblong.window.frequencies())
            .map(|[x, y]| (x + 100 * y) as f64)
            .collect();
        let found = CoarsePower::of(&oblong, 8).unwrap();
        assert_eq!((found.size, found.rows), (5, 5));
        assert_eq!((found.side, found.row_side), (3, 1));
        for (index, power) in found.power.iter().enumerate() {
            let [x, y] = [index % 5, index / 5].map(|i| i as f64 - 2.0);
            let expected = 3.0 * x + 100.0 * y;
            assert!((power - expected).abs() < 1e-9, "{index}: {power}");
        }
    }

    /// Few frequencies leave room for a part each, also where only every third of them is there.
    #[test]
    fn every_part_has_a_mean_at_any_step() {
        for step in [1, 2, 3] {
            let mut sums = CoarseSums::new([10, 7], 121, step);
            let [columns, rows] = [10, 7].map(|reach| 2 * (reach / step) as usize + 1);
            for row in 0..rows {
                sums.add_row(row, &vec![5.0; columns]);
            }

            let found = sums.picture();
            let middle = found.power.len() / 2;
            for (part, power) in found.power.iter().enumerate() {
                // Nothing is added for zero, which is alone in the middle part.
                assert!(part == middle || *power == 5.0, "{step}, {part}: {power}");
            }
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
