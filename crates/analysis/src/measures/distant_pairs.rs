//! The pairs of samples whose distance lies in a range: those that a bin of the pair correlation counts. Distances go
//! around the torus when periodic. All pairs are counted; at most the caller's limit of them is held.

use std::ops::Range;

use glam::{BVec2, DVec2};
use rayon::prelude::*;
use serde::Serialize;

use super::error::MeasureError;
use super::neighbors::Neighbors;
use super::{check_count, check_range, check_set};
use crate::domain::Domain;
use crate::error::VerifyError;
use crate::grid::{Entry, Grid};
use crate::monitor::{Control, Monitor};
use crate::region::Region;

/// Pairs that are held at most: 400 MB.
pub const MAX_PAIRS: usize = 1 << 24;

/// Cells along the largest distance: more would fit its circle better, and take longer to walk through.
const CELLS_ALONG: f64 = 5.0;

/// Two samples at a distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DistantPair {
    /// The sample with the smaller index.
    pub first: u32,
    /// The sample with the larger index.
    pub second: u32,
    /// From the first sample to the nearest image of the second, in the length unit of the samples. In a periodic
    /// region it may lead across a seam.
    pub offset: [f64; 2],
}

/// The pairs of a range of distances.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DistantPairs {
    /// The range: from the first distance up to below the second, in the length unit of the samples.
    pub distances: [f64; 2],
    /// Number of pairs, held or not.
    pub total: u64,
    /// The pairs held, each once, sorted by their indices.
    pub pairs: Vec<DistantPair>,
}

/// Returns the unordered pairs of samples with `least <= distance < most`, in the length unit of the samples.
///
/// At most `limit` pairs are held. If there are more, those around the samples of lowest `y` are held, row by row of
/// grid cells. Time grows with the number of pairs closer than `most`; it is doubled where all are held, as each is
/// then met twice. The result does not depend on the number of threads.
///
/// # Errors
///
/// No sample or one outside the region; a distance that is negative, not a number or beyond half the shorter side
/// ([`MeasureError::OutOfRange`]: up to there two samples of a periodic region have one pair of nearest images; bounded
/// regions have the same limit); a largest distance that does not exceed the least ([`MeasureError::NotRising`]); a
/// limit of 0 or beyond [`MAX_PAIRS`].
pub fn pairs_between(
    points: &[[f64; 2]],
    region: Region,
    [least, most]: [f64; 2],
    limit: usize,
    control: Control<'_>,
) -> Result<DistantPairs, MeasureError> {
    let fewest = 1;
    check_set(points, region, fewest)?;
    check_count("pairs to hold", limit, MAX_PAIRS)?;
    let half = 0.5 * region.shorter_side();
    check_range("the least distance of a pair", least, [0.0, half])?;
    check_range("the largest distance of a pair", most, [0.0, half])?;
    if most <= least {
        // Of the two distances the second is named, as that which does not rise.
        return Err(MeasureError::NotRising {
            name: "the distances of pairs",
            index: 1,
            value: most,
        });
    }

    // Each sample is looked at twice: to count its pairs, and to hold them.
    let monitor = Monitor::begin(control, 2 * points.len() as u64)?;
    let domain = Domain::new(region)?;
    let scaled = [least, most].map(|distance| distance * domain.scale);
    let grid = Grid::new(points, domain, scaled[1] / CELLS_ALONG);
    let search = RangeSearch {
        neighbors: Neighbors { grid: &grid },
        distances: scaled,
    };

    let (total, pairs) = search.run(limit, &monitor)?;
    // Rows of which no pairs are held are not passed a second time.
    monitor.advance(2 * points.len() as u64 - monitor.done())?;
    Ok(DistantPairs {
        distances: [least, most],
        total,
        pairs,
    })
}

/// The search for pairs whose distance lies in a range.
struct RangeSearch<'a> {
    neighbors: Neighbors<'a>,
    /// The range, in the domain's unit.
    distances: [f64; 2],
}

impl RangeSearch<'_> {
    /// Counts the pairs of each row of cells, then holds up to `limit` of them, from the first row on. Returns the number of all
    /// pairs and those held.
    fn run(
        &self,
        limit: usize,
        monitor: &Monitor<'_>,
    ) -> Result<(u64, Vec<DistantPair>), VerifyError> {
        let rows = self.neighbors.grid.cells[1];
        let counts: Vec<u64> = (0..rows)
            .into_par_iter()
            .map(|row| {
                let mut count = 0;
                self.row(row, monitor, |_, _, found| count += u64::from(found))?;
                Ok(count)
            })
            .collect::<Result<_, VerifyError>>()?;

        // Which pairs are held follows from the counts, not from which thread is first.
        let (mut total, mut wanted) = (0, Vec::new());
        for (row, count) in counts.into_iter().enumerate() {
            let room = (limit as u64).saturating_sub(total);
            if count.min(room) > 0 {
                wanted.push((row, count.min(room) as usize));
            }
            total += count;
        }

        let held: Vec<Vec<DistantPair>> = (wanted.into_par_iter())
            .map(|(row, count)| self.hold(row, count, monitor))
            .collect::<Result<_, VerifyError>>()?;

        let mut pairs = held.concat();
        pairs.par_sort_unstable_by_key(|pair| (pair.first, pair.second));
        Ok((total, pairs))
    }

    /// The first pairs of a row of cells.
    fn hold(
        &self,
        row: usize,
        count: usize,
        monitor: &Monitor<'_>,
    ) -> Result<Vec<DistantPair>, VerifyError> {
        let mut pairs = Vec::with_capacity(count);
        self.row(row, monitor, |a, b, found| {
            if found && pairs.len() < count {
                pairs.push(self.pair(a, b));
            }
        })?;
        Ok(pairs)
    }

    /// Calls `see` with each compared pair of a row of cells, and with whether it counts: whether its distance is in the range
    /// and the pair is not counted elsewhere.
    fn row(
        &self,
        row: usize,
        monitor: &Monitor<'_>,
        mut see: impl FnMut(&Entry, &Entry, bool),
    ) -> Result<(), VerifyError> {
        let (grid, [least, most]) = (self.neighbors.grid, self.distances);
        for column in 0..grid.cells[0] {
            let own = grid.run(row, &(column..column + 1));
            if own.is_empty() {
                continue;
            }

            let compare = |run: Range<usize>, once: bool| {
                for a in own {
                    for b in &grid.entries()[run.clone()] {
                        let length = self.neighbors.offset(a, b).length();
                        // A pair that is met from both of its samples counts at the lower index.
                        let counts_here = once || a.id < b.id;
                        see(a, b, counts_here && least <= length && length < most);
                    }
                }
            };
            self.neighbors.partners([column, row], most, compare);
            monitor.advance(own.len() as u64)?;
        }
        Ok(())
    }

    /// Returns two samples as a pair, by their nearest images.
    fn pair(&self, a: &Entry, b: &Entry) -> DistantPair {
        let (one, two) = if a.id < b.id { (a, b) } else { (b, a) };
        let domain = &self.neighbors.grid.domain;
        let direct = two.position - one.position;
        let around = direct - domain.extent.copysign(direct);
        let shorter = around.abs().cmplt(direct.abs()) & BVec2::splat(domain.periodic);
        let offset = DVec2::select(shorter, around, direct) / domain.scale;
        DistantPair {
            first: one.id,
            second: two.id,
            offset: offset.to_array(),
        }
    }
}
