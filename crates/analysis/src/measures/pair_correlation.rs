//! The pair correlation g(r), also called radial distribution: pairs at a distance, over those of noise.
//! Distances go around the torus when periodic; bounded sets get the translation correction.
//! It never smooths; counts are exact.

use std::ops::{ControlFlow, Range};

use rayon::prelude::*;
use serde::Serialize;

use super::distances::largest_min_distance;
use super::error::MeasureError;
use super::neighbors::Neighbors;
use super::{check_count, check_not_all_equal, check_range, check_set};
use crate::domain::Domain;
use crate::error::VerifyError;
use crate::grid::{Entry, Grid};
use crate::monitor::{Monitor, Progress};
use crate::region::Region;

/// Bins of a distribution at most.
const MAX_BINS: usize = 1 << 16;

/// Parts that are counted apart and added in sequence, so that sums do not depend on threads.
const PARTS: usize = 64;

/// Cells along the largest distance: more look at fewer samples in vain but at more cells.
const CELLS_ALONG: f64 = 5.0;

/// The pair correlation of a set.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct PairCorrelation {
    /// Number of samples.
    pub samples: usize,
    /// The largest possible minimum distance of so many samples, the unit of the axis.
    pub r_max: f64,
    /// Width of a bin in units of `r_max`; bin `i` is `i width <= r < (i + 1) width`.
    pub bin_width: f64,
    /// Pairs in each bin, each pair once.
    pub counts: Vec<u64>,
    /// `g` of each bin: 1 for independent uniform samples.
    pub g: Vec<f64>,
}

impl PairCorrelation {
    /// Bins in a unit of one's own reach at most so many `r_max`.
    pub const FARTHEST: f64 = 8.0;

    /// Returns `g(r)` for `r` up to `most`, in units of `r_max`, in bins of equal width.
    ///
    /// `g` is the number of pairs over that expected of as many independent uniform samples. In a bounded region each
    /// pair is weighed by the inverse of the area in which its first sample can lie when both are moved
    /// together (the translation correction of Ohser and Stoyan 1981), which makes the mean exact for noise.
    /// Time grows with the number of pairs within the distance; the result does not depend on threads.
    ///
    /// # Errors
    ///
    /// Fewer than 3 samples, all at one place, a distance beyond half the shorter side
    /// ([`MeasureError::OutOfRange`], in units of `r_max`), no bins or more than 65,536, samples
    /// that are no places of the region.
    pub fn of(
        points: &[[f64; 2]],
        region: Region,
        most: f64,
        bins: usize,
        control: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Result<Self, MeasureError> {
        check_set(points, region, 3)?;
        check_not_all_equal(points)?;
        check_count("bins of g(r)", bins, MAX_BINS)?;
        let r_max = largest_min_distance(points.len(), region.area());
        let half = 0.5 * region.width.min(region.height) / r_max;
        check_range("the largest distance of g(r)", most, [1e-6, half])?;
        let monitor = Monitor::new(control, points.len() as u64);
        monitor.advance(0)?;
        let domain = Domain::new(region)?;
        let distance = most * r_max * domain.scale;
        let grid = Grid::new(points, domain, distance / CELLS_ALONG);
        let search = Search {
            neighbors: Neighbors { grid: &grid },
            distance,
            bins,
        };
        let found = search.run(&monitor)?;
        let bin_width = most / bins as f64;
        let (count, area) = (points.len() as f64, domain.extent[0] * domain.extent[1]);
        let density = 0.5 * count * (count - 1.0) / (area * area);
        let step = distance / bins as f64;
        let ring = |bin: usize| std::f64::consts::PI * (2 * bin + 1) as f64 * step * step;
        let g = (found.weights.iter().enumerate())
            .map(|(bin, weight)| weight / (density * ring(bin)))
            .collect();
        Ok(Self {
            samples: points.len(),
            r_max,
            bin_width,
            counts: found.counts,
            g,
        })
    }

    /// Returns [`Self::of`] for distances up to 5 `r_max`, or half the shorter side, in 40 bins each.
    pub fn to_look_at(
        points: &[[f64; 2]],
        region: Region,
        control: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Result<Self, MeasureError> {
        let r_max = largest_min_distance(points.len(), region.area());
        let half = 0.499 * region.width.min(region.height) / r_max;
        let most = half.min(5.0);
        let bins = (40.0 * most).ceil().max(1.0) as usize;
        Self::of(points, region, most, bins, control)
    }

    /// Returns [`Self::of`] in bins of a fortieth of `unit`, a length of the region: one of them begins at `unit` but for rounding,
    /// so that sets whose distances begin there are cut alike whatever their numbers. They reach as far as 5 `unit`,
    /// [`Self::FARTHEST`] `r_max` and half the shorter side allow, in whole bins.
    ///
    /// # Errors
    ///
    /// Those of [`Self::of`]; a `unit` of which less than a bin is within reach, or that is no positive number, is
    /// out of range.
    pub fn in_units_of(
        points: &[[f64; 2]],
        region: Region,
        unit: f64,
        control: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Result<Self, MeasureError> {
        check_set(points, region, 3)?;
        let r_max = largest_min_distance(points.len(), region.area());
        let half = 0.499 * region.width.min(region.height);
        let reach = half.min(Self::FARTHEST * r_max);
        check_range("the unit of g(r)", unit, [1e-6 * r_max, 40.0 * reach])?;
        let bins = (40.0 * (reach / unit).min(5.0)).floor().max(1.0);
        let most = bins / 40.0 * unit / r_max;
        Self::of(points, region, most, bins as usize, control)
    }

    /// Returns the middles of the bins in units of `r_max`, and `g` there.
    #[must_use]
    pub fn places(&self) -> Vec<[f64; 2]> {
        let each = self.g.iter().enumerate();
        each.map(|(bin, g)| [self.distance(bin), *g]).collect()
    }

    /// Returns the middle of a bin in units of `r_max`.
    #[must_use]
    pub fn distance(&self, bin: usize) -> f64 {
        (bin as f64 + 0.5) * self.bin_width
    }
}

struct Search<'a> {
    neighbors: Neighbors<'a>,
    distance: f64,
    bins: usize,
}

/// Pairs and their weights, by bin; beyond the last bin the other pairs looked at, until they are dropped.
struct Found {
    counts: Vec<u64>,
    weights: Vec<f64>,
}

impl Search<'_> {
    fn run(&self, monitor: &Monitor<'_>) -> Result<Found, VerifyError> {
        let rows = self.neighbors.grid.cells[1];
        let bound = |part: usize| part * rows / PARTS;
        let parts: Vec<Found> = (0..PARTS)
            .into_par_iter()
            .map(|part| self.rows(bound(part)..bound(part + 1), monitor))
            .collect::<Result<_, _>>()?;
        let mut sum = self.empty();
        for part in parts {
            for (total, count) in sum.counts.iter_mut().zip(part.counts) {
                *total += count;
            }
            for (total, weight) in sum.weights.iter_mut().zip(part.weights) {
                *total += weight;
            }
        }
        sum.counts.pop();
        let domain = &self.neighbors.grid.domain;
        if domain.periodic {
            let area = domain.extent[0] * domain.extent[1];
            sum.weights = sum
                .counts
                .iter()
                .map(|count| *count as f64 / area)
                .collect();
        }
        Ok(sum)
    }

    fn empty(&self) -> Found {
        Found {
            counts: vec![0; self.bins + 1],
            weights: vec![0.0; self.bins],
        }
    }

    fn rows(&self, rows: Range<usize>, monitor: &Monitor<'_>) -> Result<Found, VerifyError> {
        let mut found = self.empty();
        for row in rows {
            for column in 0..self.neighbors.grid.cells[0] {
                let own = self.neighbors.grid.run(row, &(column..column + 1));
                if !own.is_empty() {
                    self.cell([column, row], &mut found);
                    monitor.advance(own.len() as u64)?;
                }
            }
        }
        Ok(found)
    }

    /// Pairs beyond the distance go into a bin of their own: half of those looked at are, and a branch
    /// would guess wrong as often.
    fn cell(&self, [column, row]: [usize; 2], found: &mut Found) {
        let domain = &self.neighbors.grid.domain;
        let own = self.neighbors.grid.run(row, &(column..column + 1));
        let per_length = self.bins as f64 / self.distance;
        let partners = |run: &[Entry], once: bool| {
            for a in own {
                for b in run {
                    let [dx, dy] = self.neighbors.offset(a, b);
                    let length = (dx * dx + dy * dy).sqrt();
                    let bin = ((length * per_length) as usize).min(self.bins);
                    let new = once || a.id < b.id;
                    found.counts[bin] += u64::from(new);
                    if !domain.periodic && new && bin < self.bins {
                        let overlap = (domain.extent[0] - dx) * (domain.extent[1] - dy);
                        found.weights[bin] += 1.0 / overlap;
                    }
                }
            }
        };
        self.neighbors
            .partners([column, row], self.distance, partners);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
}
