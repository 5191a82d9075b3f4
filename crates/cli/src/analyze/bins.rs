//! Where the pair correlation is looked at: how far, and in which bins. Sets of one radius are cut at that radius,
//! where their pairs begin, so that curves of different numbers of samples can be subtracted. Counts no pair.

use tilescope_analysis::Region;
use tilescope_analysis::measures::{PairCorrelation, largest_min_distance};

use super::measured::SPREAD_OF_COUNTS;

/// Bins in a unit.
const EACH: f64 = 40.0;

/// Units that are looked at, at most.
const MAX_UNITS: f64 = 5.0;

/// The bins of a pair correlation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bins {
    /// Fortieths of the radius of all sets.
    OfRadius { radius: f64, count: usize },
    /// About fortieths of `r_max`, up to a distance in units of it.
    OfSpacing { farthest: f64, count: usize },
}

impl Bins {
    /// Returns the bins for a set of so many samples. Sets of fewer samples, as far as they are averaged with it, reach
    /// as far.
    pub fn of(radius: Option<f64>, samples: usize, region: Region) -> Self {
        let r_max = largest_min_distance(samples, region.area());
        let half = 0.499 * region.width.min(region.height);
        if let Some(radius) = radius.filter(|radius| *radius > 0.0) {
            // A radius that is none of the set's may hold all of it.
            let reach = half.min(PairCorrelation::MAX_DISTANCE * r_max) / radius;
            let count = (EACH * reach.min(MAX_UNITS)).floor();
            if count >= 1.0 {
                let count = count as usize;
                return Self::OfRadius { radius, count };
            }
        }
        let farthest = (half / r_max * (1.0 - SPREAD_OF_COUNTS).sqrt()).min(MAX_UNITS);
        Self::OfSpacing {
            farthest,
            count: (EACH * farthest).ceil().max(1.0) as usize,
        }
    }

    /// Returns how many there are.
    pub const fn count(&self) -> usize {
        match *self {
            Self::OfRadius { count, .. } | Self::OfSpacing { count, .. } => count,
        }
    }

    /// Returns the end of the last one for a set of so many samples, in units of its `r_max`.
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
    use crate::options::UNIT_SQUARE;

    #[test]
    fn bins_of_a_radius_end_at_the_same_distances_whatever_the_number() {
        let ends = |samples: usize| {
            let bins = Bins::of(Some(0.02), samples, UNIT_SQUARE);
            let r_max = largest_min_distance(samples, 1.0);
            (bins.count(), bins.farthest(samples, UNIT_SQUARE) * r_max)
        };
        let ((count, end), (other, other_end)) = (ends(1700), ends(1750));
        assert_eq!((count, other), (200, 200));
        assert!((end - 0.1).abs() < 1e-12 && (other_end - 0.1).abs() < 1e-12);
        let spacing = |samples: usize| Bins::of(None, samples, UNIT_SQUARE);
        assert_eq!(spacing(1700), spacing(1750));
    }

    #[test]
    fn a_radius_that_cannot_be_the_sets_costs_no_more_than_its_spacing() {
        for radius in [0.4, 1e3, f64::INFINITY, f64::NAN, -1.0] {
            let bins = Bins::of(Some(radius), 1_000_000, UNIT_SQUARE);
            let farthest = bins.farthest(1_000_000, UNIT_SQUARE);
            assert!(
                (0.0..=PairCorrelation::MAX_DISTANCE).contains(&farthest),
                "{radius}: {farthest}"
            );
        }
        // Few samples in a small domain reach half of it.
        let bins = Bins::of(Some(0.3), 8, UNIT_SQUARE);
        assert!(bins.farthest(8, UNIT_SQUARE) * largest_min_distance(8, 1.0) < 0.5);
    }
}
