//! The pair correlation g(r), also called radial distribution: pairs at a distance, over those of noise. Distances go
//! around the torus when periodic; bounded sets get the translation correction. Nothing is smoothed, and counts are
//! exact.

use serde::Serialize;

use super::distances::largest_min_distance;
use super::error::MeasureError;
use super::pair_search::{PairSearch, PairSums};
use super::{MIN_SAMPLES, check_count, check_not_all_equal, check_range, check_set};
use crate::domain::Domain;
use crate::grid::Grid;
use crate::monitor::{Control, Monitor};
use crate::region::Region;

/// Bins of a distribution at most.
const MAX_BINS: usize = 1 << 16;

/// Cells along the largest distance: with more, fewer samples are compared in vain, but more cells are visited. Chosen,
/// not measured.
const CELLS_ALONG: f64 = 5.0;

/// The pair correlation of a set.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct PairCorrelation {
    /// How many samples the set has.
    pub samples: usize,
    /// The largest possible minimum distance of this many samples, the unit of the axis.
    pub r_max: f64,
    /// Width of a bin in units of `r_max`; bin `i` is `i width <= r < (i + 1) width`.
    pub bin_width: f64,
    /// Pairs in each bin, each pair once.
    pub counts: Vec<u64>,
    /// `g` of each bin: 1 for independent uniform samples.
    pub g: Vec<f64>,
}

impl PairCorrelation {
    /// The longest reach, in units of `r_max`, of bins in a unit of the caller's choice.
    pub const MAX_DISTANCE: f64 = 8.0;

    /// Returns `g(r)` for `r` up to `most`, in units of `r_max`, in bins of equal width.
    ///
    /// `g` is the number of pairs over that expected of as many independent uniform samples. In a bounded region each
    /// pair is weighed by the inverse of the area in which its first sample can lie when both are moved
    /// together (the translation correction of Ohser and Stoyan 1981), which makes the mean exact for noise.
    /// Time grows with the number of pairs within the distance; the result does not depend on threads.
    ///
    /// # Errors
    ///
    /// Fewer than 3 samples, all at one place, a distance beyond half the shorter side ([`MeasureError::OutOfRange`],
    /// in units of `r_max`), no bins or more than 65,536, samples outside the region.
    pub fn of(
        points: &[[f64; 2]],
        region: Region,
        most: f64,
        bins: usize,
        control: Control<'_>,
    ) -> Result<Self, MeasureError> {
        check_set(points, region, MIN_SAMPLES)?;
        check_not_all_equal(points)?;
        check_count("bins of g(r)", bins, MAX_BINS)?;

        // Up to half the shorter side two samples have one pair of nearest images on a torus, and the weights of a
        // bounded region stay within a factor of 4. The lower limit, which refuses bins of no width, was chosen, not
        // measured.
        let r_max = largest_min_distance(points.len(), region.area());
        let half = 0.5 * region.shorter_side() / r_max;
        check_range("the largest distance of g(r)", most, [1e-6, half])?;

        let monitor = Monitor::begin(control, points.len() as u64)?;
        let domain = Domain::new(region)?;
        let distance = most * r_max * domain.scale;
        let grid = Grid::new(points, domain, distance / CELLS_ALONG);
        let search = PairSearch::new(&grid, distance, bins);
        let PairSums { counts, weights } = search.run(&monitor)?;
        Ok(Self::of_sums(points.len(), &domain, most, counts, &weights))
    }

    /// Returns g(r) from the pairs in each bin, and their weights: the sums of the inverse areas in the domain's unit.
    /// The last bin ends at `most`, in units of `r_max`.
    pub(crate) fn of_sums(
        samples: usize,
        domain: &Domain,
        most: f64,
        counts: Vec<u64>,
        weights: &[f64],
    ) -> Self {
        let area = domain.extent.element_product();
        let users_area = area / (domain.scale * domain.scale);
        let r_max = largest_min_distance(samples, users_area);
        let bins = counts.len() as f64;
        let bin_width = most / bins;
        // The same width in the domain's unit.
        let step = most * r_max * domain.scale / bins;

        let count = samples as f64;
        // Noise has N (N - 1) / 2 pairs, spread evenly over all offsets: one division by the area. The other one is
        // that of each pair's weight, an inverse area.
        let density = 0.5 * count * (count - 1.0) / (area * area);
        // The area between the circles of a bin's two distances.
        let ring = |bin: usize| std::f64::consts::PI * (2 * bin + 1) as f64 * step * step;
        let g = (weights.iter().enumerate()).map(|(bin, weight)| weight / (density * ring(bin)));
        Self {
            samples,
            r_max,
            bin_width,
            g: g.collect(),
            counts,
        }
    }

    /// Returns [`Self::of`] for distances up to 5 `r_max`, or half the shorter side, in 40 bins each.
    pub fn to_look_at(
        points: &[[f64; 2]],
        region: Region,
        control: Control<'_>,
    ) -> Result<Self, MeasureError> {
        let r_max = largest_min_distance(points.len(), region.area());
        // A little less than half the shorter side, beyond which `g` is not defined.
        let half = 0.499 * region.shorter_side() / r_max;
        let most = half.min(5.0);
        let bins = (40.0 * most).ceil().max(1.0) as usize;
        Self::of(points, region, most, bins, control)
    }

    /// Returns [`Self::of`] in bins of a fortieth of `unit`, a length of the region: one of them begins at `unit` but for rounding,
    /// so that sets whose distances begin there are cut alike whatever their numbers. They reach as far as 5 `unit`,
    /// [`Self::MAX_DISTANCE`] `r_max` and half the shorter side allow, in whole bins.
    ///
    /// # Errors
    ///
    /// Those of [`Self::of`]; a `unit` of which less than a bin is within reach, or that is no positive number, is
    /// out of range.
    pub fn in_units_of(
        points: &[[f64; 2]],
        region: Region,
        unit: f64,
        control: Control<'_>,
    ) -> Result<Self, MeasureError> {
        check_set(points, region, MIN_SAMPLES)?;
        let (most, bins) = Self::bins_in_units_of(points.len(), region, unit)?;
        Self::of(points, region, most, bins, control)
    }

    /// The farthest distance and the number of the bins of [`Self::in_units_of`].
    pub(crate) fn bins_in_units_of(
        samples: usize,
        region: Region,
        unit: f64,
    ) -> Result<(f64, usize), MeasureError> {
        let r_max = largest_min_distance(samples, region.area());
        // A little less than half the shorter side, beyond which `g` is not defined.
        let half = 0.499 * region.shorter_side();
        let reach = half.min(Self::MAX_DISTANCE * r_max);
        // A longer unit has no whole bin within reach, and a far shorter one has bins of no width, as in `of`.
        check_range("the unit of g(r)", unit, [1e-6 * r_max, 40.0 * reach])?;
        let bins = (40.0 * (reach / unit).min(5.0)).floor().max(1.0);
        Ok((bins / 40.0 * unit / r_max, bins as usize))
    }

    /// Returns the curve: for each bin its middle in units of `r_max`, and `g`.
    #[must_use]
    pub fn points(&self) -> Vec<[f64; 2]> {
        let each = self.g.iter().enumerate();
        each.map(|(bin, g)| [self.distance(bin), *g]).collect()
    }

    /// Returns the middle of a bin in units of `r_max`.
    #[must_use]
    pub fn distance(&self, bin: usize) -> f64 {
        (bin as f64 + 0.5) * self.bin_width
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::monitor::Progress;
    use crate::region::Boundary;

    /// Square lattices of distance `unit`: the first pairs are in the bin that begins there, whatever the number of samples.
    #[test]
    fn bins_in_a_unit_begin_at_it_for_sets_of_any_number() {
        let go_on = |_: Progress| ControlFlow::Continue(());
        for side in [12_u32, 17, 23, 40] {
            let region = Region {
                width: f64::from(side) * 0.3,
                height: f64::from(side) * 0.3,
                boundary: Boundary::Periodic,
            };
            let points: Vec<[f64; 2]> = (0..side * side)
                .map(|i| [i % side, i / side].map(|k| (f64::from(k) + 0.5) * 0.3))
                .collect();
            // Slightly below the distance, so that rounding does not decide.
            let unit = 0.3 * (1.0 - 1e-9);
            let found = PairCorrelation::in_units_of(&points, region, unit, &go_on).unwrap();
            let first = found.counts.iter().position(|count| *count > 0);
            assert_eq!(first, Some(40), "{side}");
            let width = found.bin_width * found.r_max / unit;
            assert!((width - 0.025).abs() < 1e-12, "{side}: {width}");
            // The bins by number are cut at another phase.
            let by_number = PairCorrelation::to_look_at(&points, region, &go_on).unwrap();
            let edge = unit / by_number.r_max / by_number.bin_width;
            assert!((edge - edge.round()).abs() > 0.01);
            for unit in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
                let refused = PairCorrelation::in_units_of(&points, region, unit, &go_on);
                assert!(
                    matches!(refused, Err(MeasureError::OutOfRange { .. })),
                    "{unit}"
                );
            }
        }
    }

    /// Clusters tighter than a bin, as wide as many, and both, compared with a count of every single pair.
    #[test]
    fn clusters_are_counted_as_pair_by_pair() {
        let go_on = |_: Progress| ControlFlow::Continue(());
        let spread = |i: u32, step: f64| (f64::from(i) * step).fract() - 0.5;
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let region = Region {
                width: 1.0,
                height: 1.0,
                boundary,
            };
            for sizes in [[1e-7, 1e-7], [0.03, 0.03], [1e-7, 0.03]] {
                let points: Vec<[f64; 2]> = (0..3_000_u32)
                    .map(|i| {
                        let size = sizes[(i % 2) as usize];
                        let at = [0.75_f64.mul_add(f64::from(i % 2), 0.125), 0.5];
                        [
                            at[0] + size * spread(i, 0.754_877_666),
                            at[1] + size * spread(i, 0.569_840_29),
                        ]
                    })
                    .collect();
                let found = PairCorrelation::to_look_at(&points, region, &go_on).unwrap();
                let most = found.bin_width * found.g.len() as f64 * found.r_max;
                let mut counts = vec![0; found.g.len()];
                for (k, a) in points.iter().enumerate() {
                    for b in &points[k + 1..] {
                        let [dx, dy] = [0, 1].map(|axis| {
                            let direct = (a[axis] - b[axis]).abs();
                            match boundary {
                                Boundary::Periodic => direct.min(1.0 - direct),
                                Boundary::Bounded => direct,
                            }
                        });
                        let bin = (dx.hypot(dy) / most * counts.len() as f64) as usize;
                        if let Some(count) = counts.get_mut(bin) {
                            *count += 1_u64;
                        }
                    }
                }
                let differ: u64 = (counts.iter().zip(&found.counts))
                    .map(|(a, b)| a.abs_diff(*b))
                    .sum();
                // Distances at the very edge of a bin may be rounded otherwise.
                assert!(differ <= 4, "{boundary:?} {sizes:?}: {differ}");
                assert!(found.counts.iter().sum::<u64>() > 1_000_000);
            }
        }
    }
}
