//! The bins of the pair correlation, and how far they reach. For sets of one radius a bin begins at that radius,
//! where their pairs begin, so that curves of different numbers of samples can be subtracted. Pairs are counted elsewhere.

use super::distances::largest_min_distance;
use super::pair_correlation::PairCorrelation;
use crate::region::Region;

/// Bins in a unit of distance.
const EACH: f64 = 40.0;

/// The farthest distance, in units.
const MAX_UNITS: f64 = 5.0;

/// The bins of a pair correlation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PairBins {
    /// Fortieths of the radius of all sets.
    OfRadius {
        /// The radius, in the unit of the samples.
        radius: f64,
        /// How many bins there are.
        count: usize,
    },
    /// About fortieths of `r_max`, up to a distance in units of it.
    OfSpacing {
        /// The end of the last bin.
        farthest: f64,
        /// How many bins there are.
        count: usize,
    },
}

impl PairBins {
    /// Numbers of samples that are averaged differ from the first set's by this part of it at most.
    pub const MAX_COUNT_SPREAD: f64 = 0.1;

    /// Returns the bins for a set of this number of samples, which serve all sets that may be averaged with it.
    /// `radius` is the radius of all its samples; `None`, and also 0, if they have none in common or it is not known.
    #[must_use]
    pub fn of(radius: Option<f64>, samples: usize, region: Region) -> Self {
        let r_max = largest_min_distance(samples, region.area());
        // A little less than half the shorter side, beyond which g(r) is not defined.
        let half = 0.499 * region.shorter_side();
        if let Some(radius) = radius.filter(|radius| *radius > 0.0) {
            // A pair correlation reaches at most `MAX_DISTANCE` units of `r_max`. `MAX_UNITS` times a radius above
            // `r_max` may be more than that. (In units of `r_max`, further below, `MAX_UNITS` is always less.)
            let reach = half.min(PairCorrelation::MAX_DISTANCE * r_max) / radius;
            let count = (EACH * reach.min(MAX_UNITS)).floor();
            // A radius that is not the set's may be longer than its domain: no bin fits then, and those of `r_max` are
            // taken.
            if count >= 1.0 {
                // Those that end within the reach: their width is fixed.
                let count = count as usize;
                return Self::OfRadius { radius, count };
            }
        }

        // These bins also serve sets of fewer samples, by `MAX_COUNT_SPREAD` at most. Such a set has a longer `r_max`,
        // and so longer bins. The root shortens the reach so far that these bins end within the half, too. (Bins in
        // units of a radius are equally long in all sets.)
        let farthest = (half / r_max * (1.0 - Self::MAX_COUNT_SPREAD).sqrt()).min(MAX_UNITS);
        Self::OfSpacing {
            farthest,
            // None is wider than a fortieth, and there is at least one.
            count: (EACH * farthest).ceil().max(1.0) as usize,
        }
    }

    /// Returns the number of bins.
    #[must_use]
    pub const fn count(&self) -> usize {
        match *self {
            Self::OfRadius { count, .. } | Self::OfSpacing { count, .. } => count,
        }
    }

    /// Returns the end of the last bin for a set of the given number of samples, in units of its `r_max`.
    #[must_use]
    pub fn farthest(&self, samples: usize, region: Region) -> f64 {
        match *self {
            Self::OfRadius { radius, count } => {
                count as f64 / EACH * radius / largest_min_distance(samples, region.area())
            }
            Self::OfSpacing { farthest, .. } => farthest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region::Boundary;

    const UNIT_SQUARE: Region = Region {
        width: 1.0,
        height: 1.0,
        boundary: Boundary::Periodic,
    };

    #[test]
    fn bins_of_a_radius_end_at_the_same_distances_whatever_the_number() {
        let ends = |samples: usize| {
            let bins = PairBins::of(Some(0.02), samples, UNIT_SQUARE);
            let r_max = largest_min_distance(samples, 1.0);
            (bins.count(), bins.farthest(samples, UNIT_SQUARE) * r_max)
        };
        let ((count, end), (other, other_end)) = (ends(1700), ends(1750));
        assert_eq!((count, other), (200, 200));
        assert!((end - 0.1).abs() < 1e-12 && (other_end - 0.1).abs() < 1e-12);
        let spacing = |samples: usize| PairBins::of(None, samples, UNIT_SQUARE);
        assert_eq!(spacing(1700), spacing(1750));
    }

    #[test]
    fn a_radius_that_cannot_be_the_sets_costs_no_more_than_its_spacing() {
        for radius in [0.4, 1e3, f64::INFINITY, f64::NAN, -1.0] {
            let bins = PairBins::of(Some(radius), 1_000_000, UNIT_SQUARE);
            let farthest = bins.farthest(1_000_000, UNIT_SQUARE);
            assert!(
                (0.0..=PairCorrelation::MAX_DISTANCE).contains(&farthest),
                "{radius}: {farthest}"
            );
        }
        // Few samples in a small domain reach half of it.
        let bins = PairBins::of(Some(0.3), 8, UNIT_SQUARE);
        assert!(bins.farthest(8, UNIT_SQUARE) * largest_min_distance(8, 1.0) < 0.5);
    }
}
