//! Every method compared with both groups of reference sets of its radius. Verdicts are in `claims`.

use super::method::Method;
use super::spectra::{MethodSpectra, difference, find};

/// A method at a radius against the reference sampler.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Against {
    pub radius: f64,
    pub method: Method,
    /// Relative RMS difference of the radial mean power from that of the reference sets.
    pub difference: f64,
    /// The same difference between two groups of reference sets.
    pub chance: f64,
    /// The difference with chance subtracted in quadrature.
    pub left: f64,
    /// Anisotropy above that of reference sets, in decibels.
    pub excess: f64,
    /// The difference in anisotropy of two groups of reference sets, in decibels.
    pub apart: f64,
    /// How far the excess is from zero by chance with probability 99 %, in decibels.
    pub reach: f64,
    /// Highest power over what chance allows.
    pub peak: f64,
}

impl Against {
    /// Returns how many times as large as chance the difference is.
    pub fn ratio(&self) -> f64 {
        self.difference / self.chance
    }

    pub fn tiled(&self) -> bool {
        self.method.tiles(self.radius)
    }

    /// Whether there are at least nine blocks: repetition shows only where many blocks share a pattern.
    pub fn tiled_often(&self) -> bool {
        self.method.tiles_often(self.radius)
    }
}

/// Compares every method with both groups of reference sets of its radius. Methods without both groups, or with other annuli
/// of frequencies than theirs, are left out.
pub fn against(found: &[MethodSpectra]) -> Vec<Against> {
    let compare = |one: &MethodSpectra| {
        let groups =
            [Method::Reference, Method::Again].map(|method| find(found, one.radius, method));
        let [Some(a), Some(b)] = groups else {
            return None;
        };

        let chance = difference(&a.curves, &b.curves)?;
        let [to_a, to_b] = [a, b].map(|group| difference(&one.curves, &group.curves));
        // Neither of the two reference groups is better, so that the squares of both differences are averaged.
        let square = 0.5 * (to_a?.powi(2) + to_b?.powi(2));

        Some(Against {
            radius: one.radius,
            method: one.method,
            difference: square.sqrt(),
            chance,
            // Chance and the method add independently of each other, so that their squares add up to the whole.
            left: (square - chance.powi(2)).max(0.0).sqrt(),
            excess: one.excess - 0.5 * (a.excess + b.excess),
            apart: (a.excess - b.excess).abs(),
            // Independent errors add in squares: that of the method, and that of the mean of both groups.
            reach: one
                .excess_reach
                .hypot(0.5 * a.excess_reach.hypot(b.excess_reach)),
            peak: one.peaks.over(),
        })
    };

    let others = |one: &&MethodSpectra| !matches!(one.method, Method::Reference | Method::Again);
    found.iter().filter(others).filter_map(compare).collect()
}

#[cfg(test)]
pub mod tests;
