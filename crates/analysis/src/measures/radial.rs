//! Mean power and anisotropy of annuli of frequencies. Only annuli that the window holds whole, up to sign, are given;
//! zero is in none.

use rayon::prelude::*;
use serde::Serialize;

use super::check_range;
use super::error::MeasureError;
use super::periodogram::{Periodogram, unit_lengths};
use crate::region::Region;

/// Rows of frequencies whose sums are added up apart, so that they do not depend on threads. Chosen, not measured.
const ROWS: i64 = 32;

/// The frequencies whose length lies in a half-open interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct Annulus {
    /// Mean length of its frequencies: where its value belongs on the axis. See [`Periodogram::length`].
    pub frequency: f64,
    /// The mean of their powers.
    pub power: f64,
    /// `10 log10(variance / mean^2)` of the power over the annulus, in decibels. For a set without preferred
    /// directions it is about [`anisotropy_reference_db`]. NaN where there are fewer than two pairs of opposite
    /// frequencies or no power, and minus infinity where all powers are equal.
    pub anisotropy_db: f64,
    /// Number of frequencies, both of each pair `k` and `-k`.
    pub count: u64,
}

/// Radial means of a periodogram.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct RadialProfile {
    /// Annuli from the lowest on; ones without a frequency are left out.
    pub annuli: Vec<Annulus>,
    /// Number of samples, a mean over the sets: `frequency / sqrt(samples)` is the axis `nu`.
    pub samples: f64,
    /// Number of sets that the power is a mean of.
    pub sets: u64,
}

/// Returns the anisotropy in decibels of a periodogram averaged over `sets` sets without preferred directions:
/// powers are then distributed as a mean of that many exponential values, and the level is `-10 log10(sets)`.
#[must_use]
pub fn anisotropy_reference_db(sets: u64) -> f64 {
    10.0 * (1.0 / sets as f64).log10()
}

impl RadialProfile {
    /// Widths of annuli that are accepted.
    pub const WIDTHS: [f64; 2] = [0.25, 1e6];

    /// Returns the annuli `1/2 + j width <= |k| < 1/2 + (j + 1) width`, `j` from 0 on, that lie in the window. The first annulus
    /// also has the frequencies shorter than 1/2 that an oblong region has, except zero. Where the window holds one half of the
    /// plane, opposite frequencies stand for the other half.
    ///
    /// # Errors
    ///
    /// [`MeasureError::OutOfRange`] for a width outside [`Self::WIDTHS`].
    pub fn of(periodogram: &Periodogram, width: f64) -> Result<Self, MeasureError> {
        check_range("the width of an annulus", width, Self::WIDTHS)?;
        let (held_length, [most_x, most_y]) = reach(periodogram);
        // Annuli begin at a length of 1/2. A window that reaches less far holds none.
        let whole_annuli = ((held_length - 0.5) / width).floor().max(0.0) as usize;

        let part_count = (most_y / ROWS + 1) as usize;
        let parts = (0..part_count).into_par_iter().map(|part| {
            let mut sums = vec![AnnulusSums::default(); whole_annuli];
            let first = part as i64 * ROWS;
            let rows = first..(most_y + 1).min(first + ROWS);
            for ky in rows {
                add_row(&mut sums, periodogram, ky, most_x, width);
            }
            sums
        });

        let mut annuli = vec![AnnulusSums::default(); whole_annuli];
        // Parts are merged in their order, as the rounding of sums depends on it.
        for part in parts.collect::<Vec<_>>() {
            for (sums, more) in annuli.iter_mut().zip(part) {
                sums.merge(more);
            }
        }

        Ok(Self {
            annuli: annuli.iter().filter_map(AnnulusSums::annulus).collect(),
            samples: periodogram.samples,
            sets: periodogram.sets,
        })
    }

    /// Returns the frequencies of the annuli as `nu = |k| / sqrt(N)`.
    #[must_use]
    pub fn relative_frequencies(&self) -> Vec<f64> {
        let unit = self.samples.sqrt();
        (self.annuli.iter())
            .map(|annulus| annulus.frequency / unit)
            .collect()
    }

    /// Returns the mean powers.
    #[must_use]
    pub fn powers(&self) -> Vec<f64> {
        self.annuli.iter().map(|annulus| annulus.power).collect()
    }
}

/// Returns the length below which every frequency or its opposite is in the window, and the largest frequencies along x and y
/// that can be shorter than that.
fn reach(periodogram: &Periodogram) -> (f64, [i64; 2]) {
    let [x0, x1, y0, y1] = periodogram.window.bounds();
    let scale = unit_lengths(periodogram.region);
    // As opposite frequencies stand for each other, one axis must be held on both sides of zero, and reaches as far as
    // its shorter side. Of the other axis one side is enough: it reaches as far as its longer side. A negative number
    // is no reach: the window does not hold the axis's zero. Both choices of the axes are tried, and the longer reach
    // counts.
    let (both_x, both_y) = ((-x0).min(x1 - 1), (-y0).min(y1 - 1));
    let one_side = |first: i64, end: i64| {
        if first <= 0 && end > 0 {
            (-first).max(end - 1)
        } else {
            -1
        }
    };

    [[one_side(x0, x1), both_y], [both_x, one_side(y0, y1)]]
        .into_iter()
        .filter(|most| most[0] >= 0 && most[1] >= 0)
        .map(|most| {
            // The shortest frequency that is missing lies on an axis, one beyond the last.
            let missing = [0, 1].map(|axis| (most[axis] + 1) as f64 * scale[axis]);
            (missing[0].min(missing[1]), most)
        })
        .fold((0.0, [0, 0]), |longest, next| {
            if next.0 > longest.0 { next } else { longest }
        })
}

/// Adds the powers of a row of frequencies, zero or above, to the sums of their annuli.
fn add_row(sums: &mut [AnnulusSums], periodogram: &Periodogram, ky: i64, most_x: i64, width: f64) {
    let [x_unit, y_unit] = unit_lengths(periodogram.region);
    // Frequencies to both sides of zero have the same length.
    let place = |kx: i64| {
        let length = (kx as f64 * x_unit).hypot(ky as f64 * y_unit);
        (length, annulus_of(length, width))
    };
    let places: Vec<(f64, usize)> = (0..=most_x).map(place).collect();

    // One of each two opposite frequencies is enough, as they have the same power.
    let least_x = if ky == 0 { 1 } else { -most_x };
    for kx in least_x..=most_x {
        let (length, annulus) = places[kx.unsigned_abs() as usize];
        // Frequencies beyond the last whole annulus are left out. Up to `most_x` the window holds all others, or their
        // opposites.
        if let (Some(sums), Some(power)) = (sums.get_mut(annulus), periodogram.at([kx, ky])) {
            sums.add(length, power);
        }
    }
}

/// The annulus of a length; the first one has those below it, too.
fn annulus_of(length: f64, width: f64) -> usize {
    ((length - 0.5) / width).max(0.0) as usize
}

/// Sums over an annulus, one frequency of each pair; the spread is kept as in Welford 1962.
#[derive(Clone, Copy, Default)]
struct AnnulusSums {
    count: u64,
    /// The sum of the lengths of its frequencies.
    length: f64,
    /// The mean of their powers.
    mean: f64,
    /// The sum of the squared deviations from that mean.
    spread: f64,
}

impl AnnulusSums {
    fn add(&mut self, length: f64, power: f64) {
        self.count += 1;
        self.length += length;
        let before = power - self.mean;
        self.mean += before / self.count as f64;
        self.spread += before * (power - self.mean);
    }

    /// Adds the sums of other frequencies, after Chan et al. 1979.
    fn merge(&mut self, other: Self) {
        let count = self.count + other.count;
        if other.count == 0 {
            return;
        }
        let (between, share) = (other.mean - self.mean, other.count as f64 / count as f64);
        self.spread += other.spread + between * between * share * self.count as f64;
        self.mean += between * share;
        self.length += other.length;
        self.count = count;
    }

    /// Returns the annulus; none without a frequency. Of a single one the anisotropy is NaN.
    fn annulus(&self) -> Option<Annulus> {
        let variance = self.spread / (self.count.checked_sub(1)?) as f64;
        let ratio = variance / (self.mean * self.mean);
        Some(Annulus {
            frequency: self.length / self.count as f64,
            power: self.mean,
            anisotropy_db: 10.0 * ratio.log10(),
            count: 2 * self.count,
        })
    }
}

/// Neighbouring columns of a row whose frequencies are in one annulus.
#[derive(Clone, Copy, Debug)]
struct AnnulusRun {
    annulus: u32,
    first: u32,
    end: u32,
}

/// The annuli of the multiples of a frequency about zero: made once, for the profiles of many sets.
#[derive(Clone, Debug)]
pub(crate) struct AnnulusTable {
    /// The annuli of the frequencies of a quarter, row by row. Frequencies beyond the last annulus are in none.
    runs: Vec<AnnulusRun>,
    /// Where the runs of each row begin, and the end of the last row's.
    starts: Vec<usize>,
    columns: usize,
    /// The number of frequencies in each annulus, one of each pair, and the sum of their lengths.
    counts: Vec<u64>,
    lengths: Vec<f64>,
}

impl AnnulusTable {
    /// Returns the annuli of the frequencies `step (x, y)` with `|x| < columns` and `|y| < rows`, each annulus `width`
    /// wide. Lengths are those of [`Periodogram::length`].
    pub fn new([columns, rows]: [usize; 2], step: usize, region: Region, width: f64) -> Self {
        let [x_unit, y_unit] = unit_lengths(region);
        // The shortest frequency that is missing lies on an axis. All annuli before the one that it lies in are whole.
        let [missing_x, missing_y] = [columns, rows].map(|count| (count * step) as f64);
        let whole = annulus_of((missing_x * x_unit).min(missing_y * y_unit), width);

        let (mut runs, mut starts) = (Vec::new(), vec![0]);
        let (mut counts, mut lengths) = (vec![0; whole + 1], vec![0.0; whole + 1]);
        for y in 0..rows {
            let along_y = (y * step) as f64 * y_unit;
            let length = |x: usize| ((x * step) as f64 * x_unit).hypot(along_y);
            let row: Vec<f64> = (0..columns).map(length).collect();

            // Frequencies beyond the last whole annulus share the index after it, which `profile` leaves out.
            let annulus = |length: &f64| annulus_of(*length, width).min(whole);
            let annuli: Vec<usize> = row.iter().map(annulus).collect();
            // Counts are of one frequency of each opposite pair.
            for x in half_row(columns, y) {
                counts[annuli[x]] += 1;
                lengths[annuli[x]] += row[x];
            }

            let mut first = 0;
            for run in annuli.chunk_by(|one, next| one == next) {
                let end = first + run.len();
                if run[0] < whole {
                    runs.push(AnnulusRun {
                        annulus: run[0] as u32,
                        first: first as u32,
                        end: end as u32,
                    });
                }
                first = end;
            }
            starts.push(runs.len());
        }

        Self {
            runs,
            starts,
            columns,
            counts,
            lengths,
        }
    }

    /// Returns sums to which powers are added row by row.
    pub fn sums(&self) -> ProfileSums<'_> {
        ProfileSums {
            table: self,
            sums: vec![[0.0; 2]; self.lengths.len()],
            pairs: vec![[0.0; 2]; self.columns],
        }
    }
}

/// Columns, as absolute values, from the lowest on: those of one frequency of each opposite pair. In row zero these are
/// the columns above zero, in any other row all.
fn half_row(columns: usize, row: usize) -> impl Iterator<Item = usize> {
    let below = if row == 0 { 0 } else { columns };
    let above = usize::from(row == 0);
    (1..below).rev().chain(above..columns)
}

/// A profile in the making: that of [`RadialProfile::of`] on the same powers, but for rounding.
pub(crate) struct ProfileSums<'a> {
    table: &'a AnnulusTable,
    /// Of each annulus the sums of the powers and of their squares: quicker than Welford's mean and spread, which divide by each
    /// count. The spread loses digits where the powers of an annulus agree in more than half of their digits, as those
    /// of a single sample do.
    sums: Vec<[f64; 2]>,
    /// Room for the sums of the powers at a column and at its opposite, and of their squares.
    pairs: Vec<[f64; 2]>,
}

impl ProfileSums<'_> {
    /// Adds a row, zero or above, of powers from `x = 1 - columns` to `columns - 1`.
    pub fn add_row(&mut self, row: usize, powers: &[f64]) {
        let columns = self.table.columns;
        let runs = &self.table.runs[self.table.starts[row]..self.table.starts[row + 1]];
        // Columns beyond the last run are in no annulus, and their sums are not needed. Column 0, which has no opposite, is set
        // below in any case: so one column is the least.
        let reached = runs.last().map_or(1, |run| run.end as usize);

        let (below, above) = powers.split_at(columns - 1);
        let pairs = &mut self.pairs[..reached];
        let sums_of = |one: f64, other: f64| [one + other, one * one + other * other];
        if row == 0 {
            // In the row of zero the columns below are the opposites of those above, whose powers count once. Zero is in no
            // annulus.
            for (sums, one) in pairs.iter_mut().zip(above) {
                *sums = sums_of(*one, 0.0);
            }
            pairs[0] = [0.0; 2];
        } else {
            pairs[0] = sums_of(above[0], 0.0);
            let opposites = above[1..].iter().zip(below.iter().rev());
            for (sums, (one, other)) in pairs[1..].iter_mut().zip(opposites) {
                *sums = sums_of(*one, *other);
            }
        }

        // Sums of a run are kept out of memory: to write and read them for each column takes longer than the sum.
        for run in runs {
            let [mut sum, mut squares] = self.sums[run.annulus as usize];
            for [pair_sum, pair_squares] in &self.pairs[run.first as usize..run.end as usize] {
                sum += pair_sum;
                squares += pair_squares;
            }
            self.sums[run.annulus as usize] = [sum, squares];
        }
    }

    /// Returns the profile of one set.
    pub fn profile(&self, samples: f64) -> RadialProfile {
        let AnnulusTable {
            counts, lengths, ..
        } = self.table;
        // The last place is for the frequencies beyond all whole annuli, whose powers are added nowhere.
        let whole = self.sums.len() - 1;
        let annuli = self.sums[..whole].iter().zip(counts).zip(lengths);

        let annulus = |((&[sum, squares], &count), &length): ((&[f64; 2], &u64), &f64)| {
            // Of an annulus without a frequency the mean is NaN, and `AnnulusSums::annulus` leaves the annulus out.
            let mean = sum / count as f64;
            let sums = AnnulusSums {
                count,
                length,
                mean,
                // Of equal powers it is 0 but for rounding, which may be negative.
                spread: (squares - sum * mean).max(0.0),
            };
            sums.annulus()
        };
        RadialProfile {
            annuli: annuli.filter_map(annulus).collect(),
            samples,
            sets: 1,
        }
    }
}
