//! Means over sets, with their errors by the spread between sets.

use std::f64::consts::PI;
use std::ops::Range;

use tilescope_analysis::measures::Summary;

use super::balls::{BINS_IN_R, MeasuredBalls};
use crate::experiments::common::interval;

/// The published packing fraction of spheres of diameter r, 0.384 130 7 (Zhang and Torquato 2013), as N r³ / volume:
/// a sphere fills pi / 6 of a cubed diameter.
pub const PUBLISHED: f64 = 0.384_130_7 * 6.0 / PI;
/// Its standard error: 2.1e-6 of the packing fraction.
pub const PUBLISHED_ERROR: f64 = 2.1e-6 * 6.0 / PI;
/// Frequencies below this count as low.
pub const LOW: f64 = 0.2;

/// What a run found.
#[derive(Clone, Debug)]
pub struct SpaceResults {
    /// Sides in radii.
    pub side: f64,
    pub small_side: f64,
    /// Maximal sets in large cubes.
    pub large: Vec<MeasuredBalls>,
    /// Maximal sets in small cubes, with spectra.
    pub small: Vec<MeasuredBalls>,
    /// The controls, in small cubes: sets that were stopped early, and independent places.
    pub stopped: Vec<MeasuredBalls>,
    pub scattered: Vec<MeasuredBalls>,
}

/// The mean of a quantity over sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetMean {
    pub mean: f64,
    /// Its standard error; NaN of one set.
    pub error: f64,
    sets: usize,
}

impl SetMean {
    /// Returns the mean of a quantity over sets, all NaN without sets.
    pub fn of(sets: &[MeasuredBalls], quantity: impl Fn(&MeasuredBalls) -> f64) -> Self {
        let summary = Summary::of(sets.iter().map(quantity));
        let (mean, deviation) =
            summary.map_or((f64::NAN, f64::NAN), |all| (all.mean, all.deviation));
        let error = if sets.len() > 1 {
            deviation / (sets.len() as f64).sqrt()
        } else {
            f64::NAN
        };
        Self {
            mean,
            error,
            sets: sets.len(),
        }
    }

    /// Returns the interval that holds the truth with probability 99 %, if there are several sets.
    pub fn interval(&self) -> Option<[f64; 2]> {
        interval([self.mean, self.error], self.sets)
    }

    /// Returns how far the interval reaches to either side; infinite of one set.
    pub fn reach(&self) -> f64 {
        self.interval()
            .map_or(f64::INFINITY, |[low, high]| 0.5 * (high - low))
    }
}

/// Returns the mean of g in a bin.
pub fn pairs(sets: &[MeasuredBalls], bin: usize) -> SetMean {
    SetMean::of(sets, |set| set.pairs.get(bin).copied().unwrap_or(f64::NAN))
}

/// Returns the middle of a bin, in radii.
pub fn middle(bin: usize) -> f64 {
    (bin as f64 + 0.5) / BINS_IN_R as f64
}

/// Returns the bins between two distances in radii.
pub fn bins(distances: Range<f64>) -> Range<usize> {
    let bin = |distance: f64| (distance * BINS_IN_R as f64).round() as usize;
    bin(distances.start)..bin(distances.end)
}

/// Returns the mean power of low frequencies: those of all shells whose mean lies below [`LOW`].
pub fn floor(sets: &[MeasuredBalls]) -> SetMean {
    SetMean::of(sets, |set| {
        let low = || set.shells.iter().filter(|shell| shell.nu < LOW);
        // Each frequency weighs the same: outer shells have more of them.
        let powers = low().map(|shell| shell.power * shell.frequencies as f64);
        let frequencies: usize = low().map(|shell| shell.frequencies).sum();
        powers.sum::<f64>() / frequencies as f64
    })
}

/// Returns the variance of the number of samples between sets over its mean, and the standard error of that. It
/// estimates the power at frequency 0.
pub fn scatter(sets: &[MeasuredBalls]) -> [f64; 2] {
    let counts = Summary::of(sets.iter().map(|set| set.samples as f64));
    let scatter = counts.map_or(f64::NAN, |all| all.deviation.powi(2) / all.mean);
    // Counts of large cubes are nearly normal: the variance of so many has this error.
    [scatter, scatter * (2.0 / (sets.len() as f64 - 1.0)).sqrt()]
}
