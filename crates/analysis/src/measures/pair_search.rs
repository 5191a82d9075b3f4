//! The search behind the pair correlation: the pairs of each bin, found in vectors. Counts are exact.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x8, u64x8};
use glam::DVec2;
use rayon::prelude::*;

use super::neighbors::Neighbors;
use crate::error::VerifyError;
use crate::grid::{Entry, Grid};
use crate::monitor::Monitor;

/// Parts that are counted apart and added in sequence, so that sums do not depend on threads.
const PARTS: usize = 64;

/// Samples whose pairs are counted between two reports.
const REPORTED: u64 = 256;

/// The pairs of a cell with more samples than this are counted on several threads.
const CROWD: usize = 1 << 10;

/// Pairs whose bins are found together.
const LANES: usize = 8;

/// 2^52. The sum of it and a smaller whole number has that number in its lowest bits.
const WHOLE: f64 = (1_u64 << 52) as f64;

/// The search for the pairs of all bins.
pub(super) struct PairSearch<'a> {
    neighbors: Neighbors<'a>,
    /// The end of the last bin, in the domain's unit.
    distance: f64,
    bins: usize,
    /// The samples' coordinates along x and along y, and zeros of a last incomplete vector.
    coordinates: [Vec<f64>; 2],
    /// For each lane the last bin that its pairs can go into, beyond those that are returned.
    beyond: [f64; LANES],
    level: Level,
}

/// Returns how far samples are from one along an axis, around the torus if it is periodic: as `Neighbors::offset` does.
#[expect(
    clippy::inline_always,
    reason = "it must become a part of what dispatch! compiles for the processor"
)]
#[inline(always)]
fn apart<S: Simd>(
    simd: S,
    from: f64,
    others: &[f64],
    extent: f64x8<S>,
    periodic: bool,
) -> f64x8<S> {
    let direct = (f64x8::splat(simd, from) - f64x8::from_slice(simd, others)).abs();
    if periodic {
        direct.min(extent - direct)
    } else {
        direct
    }
}

/// Pairs and their weights, by bin; more bins, one for each lane, take the farther pairs that were compared, and are dropped.
pub(super) struct PairSums {
    pub counts: Vec<u64>,
    pub weights: Vec<f64>,
}

impl<'a> PairSearch<'a> {
    /// Returns the search for pairs up to a distance, in bins of equal width.
    pub fn new(grid: &'a Grid, distance: f64, bins: usize) -> Self {
        let along = |axis: usize| {
            let values = grid.entries().iter().map(|entry| entry.position[axis]);
            values.chain([0.0; LANES]).collect()
        };
        Self {
            neighbors: Neighbors { grid },
            distance,
            bins,
            coordinates: [0, 1].map(along),
            beyond: std::array::from_fn(|lane| (bins + lane) as f64),
            level: Level::new(),
        }
    }

    /// Returns the pairs in each bin and their weights.
    pub fn run(&self, monitor: &Monitor<'_>) -> Result<PairSums, VerifyError> {
        let rows = self.neighbors.grid.cells[1];
        let bound = |part: usize| part * rows / PARTS;
        let parts: Vec<PairSums> = (0..PARTS)
            .into_par_iter()
            .map(|part| self.rows(bound(part)..bound(part + 1), monitor))
            .collect::<Result<_, _>>()?;

        let mut sum = self.empty();
        // Parts are added in their order, as the rounding of sums depends on it.
        for part in parts {
            sum.add(part);
        }
        // The last counts are those of pairs beyond all bins.
        sum.counts.truncate(self.bins);

        let domain = &self.neighbors.grid.domain;
        // On a torus each pair weighs one over the area, so that exact counts give the weights.
        if domain.periodic {
            let area = domain.extent.element_product();
            sum.weights = sum
                .counts
                .iter()
                .map(|count| *count as f64 / area)
                .collect();
        }

        Ok(sum)
    }

    /// Returns the sums over no pair.
    fn empty(&self) -> PairSums {
        PairSums {
            counts: vec![0; self.bins + LANES],
            weights: vec![0.0; self.bins],
        }
    }

    /// Returns the sums over the pairs of the samples in some rows of cells.
    fn rows(&self, rows: Range<usize>, monitor: &Monitor<'_>) -> Result<PairSums, VerifyError> {
        let (mut found, mut unreported) = (self.empty(), 0);
        for row in rows {
            for column in 0..self.neighbors.grid.cells[0] {
                let own = self.neighbors.grid.run(row, &(column..column + 1));
                if !own.is_empty() {
                    self.cell([column, row], &mut found);
                    unreported += own.len() as u64;
                }
                // A report draws a bar, and takes longer than a cell.
                if unreported >= REPORTED {
                    monitor.advance(unreported)?;
                    unreported = 0;
                }
            }
        }
        monitor.advance(unreported)?;
        Ok(found)
    }

    /// Counts the pairs of a cell's samples with each other and with the samples in the runs of `Neighbors::partners`.
    /// A run is met `once` where no cell of it meets this one in turn: then each of its pairs counts.
    fn cell(&self, [column, row]: [usize; 2], found: &mut PairSums) {
        let grid = self.neighbors.grid;
        let own = grid.run_range(row, &(column..column + 1));
        let samples = |run: &Range<usize>| &grid.entries()[run.clone()];

        let count_pairs = |run: Range<usize>, once: bool| {
            // A tight cluster has the square of its samples in pairs, which need not be looked at one by one. The
            // cell's own run never comes with `once`: the last two arms are for it.
            if once && self.is_one_bin([samples(&own), samples(&run)]) {
                found.counts[0] += own.len() as u64 * run.len() as u64;
            } else if own != run {
                self.for_each_sample(&own, found, |k, found| {
                    self.pairs(k, run.clone(), once, found);
                });
            } else if self.is_one_bin([samples(&own); 2]) {
                found.counts[0] += own.len() as u64 * (own.len() as u64 - 1) / 2;
            } else {
                // Within a cell each sample is compared with those after it, so that each pair is met once.
                let each_once = true;
                self.for_each_sample(&own, found, |k, found| {
                    self.pairs(k, k + 1..own.end, each_once, found);
                });
            }
        };

        self.neighbors
            .partners([column, row], self.distance, count_pairs);
    }

    /// Calls `add_pairs` with the index of each sample of a cell, and with the sums to add its pairs to: on all threads where
    /// the cell has more than [`CROWD`] samples.
    fn for_each_sample(
        &self,
        own: &Range<usize>,
        found: &mut PairSums,
        add_pairs: impl Fn(usize, &mut PairSums) + Sync,
    ) {
        if own.len() <= CROWD {
            for k in own.clone() {
                add_pairs(k, found);
            }
            return;
        }

        let starts = own.clone().into_par_iter().step_by(CROWD);
        let chunks = starts.map(|start| {
            let mut part = self.empty();
            for k in start..own.end.min(start + CROWD) {
                add_pairs(k, &mut part);
            }
            part
        });
        // Parts are added in their order, so that sums do not depend on threads.
        for part in chunks.collect::<Vec<PairSums>>() {
            found.add(part);
        }
    }

    /// Counts the pairs of a sample with those of a run, all by their indices in the grid. Unless the pairs are met
    /// `once`, they are met from both of their samples, and counted from the one of the lower number.
    fn pairs(&self, index: usize, run: Range<usize>, once: bool, found: &mut PairSums) {
        dispatch!(self.level, simd => self.pairs_in_vectors(simd, index, run, once, found));
    }

    /// Finds the bins of as many pairs at a time as a vector has lanes.
    ///
    /// About half of the compared pairs are beyond the distance. A branch that skips them would often be mispredicted,
    /// so they are counted, too, in bins behind the last one: each lane has one of its own, since additions to a single
    /// bin would wait for each other. Pairs that are only a few bins too far may fall into another lane's, which does no
    /// harm.
    #[expect(
        clippy::inline_always,
        reason = "it must become a part of what dispatch! compiles for the processor"
    )]
    #[inline(always)]
    fn pairs_in_vectors<S: Simd>(
        &self,
        simd: S,
        index: usize,
        run: Range<usize>,
        once: bool,
        found: &mut PairSums,
    ) {
        let grid = self.neighbors.grid;
        let (domain, a) = (&grid.domain, grid.entries()[index]);
        let (width, height) = (
            f64x8::splat(simd, domain.extent.x),
            f64x8::splat(simd, domain.extent.y),
        );
        let bins_per_length = f64x8::splat(simd, self.bins as f64 / self.distance);
        let beyond = f64x8::from_slice(simd, &self.beyond);
        let [all_x, all_y] = &self.coordinates;

        for start in run.clone().step_by(LANES) {
            // The last vector of a run may have samples beyond it. Their bins are found too, and not counted.
            let end = start + LANES;
            let x = apart(
                simd,
                a.position.x,
                &all_x[start..end],
                width,
                domain.periodic,
            );
            let y = apart(
                simd,
                a.position.y,
                &all_y[start..end],
                height,
                domain.periodic,
            );

            let in_bins = ((x * x + y * y).sqrt() * bins_per_length).min(beyond);
            // The lowest bits of these words are the bins, of which there are far fewer than 2^32.
            let bins = (in_bins.trunc() + f64x8::splat(simd, WHOLE)).bitcast::<u64x8<S>>();
            // In a bounded domain a pair weighs one over the area of the places at which it would lie in the domain:
            // pairs that are longer fit in fewer places. Pairs of a torus all weigh the same: their weights are made of
            // the counts when the search ends.
            let mut weights = (width - x) * (height - y);
            if !domain.periodic {
                weights = f64x8::splat(simd, 1.0) / weights;
            }

            let others = &grid.entries()[start..run.end.min(end)];
            let each = bins.as_slice().iter().zip(weights.as_slice()).zip(others);
            for ((bin, weight), b) in each {
                let (bin, new) = (*bin as u32 as usize, once || a.id < b.id);
                found.counts[bin] += u64::from(new);
                if !domain.periodic && new && bin < self.bins {
                    found.weights[bin] += weight;
                }
            }
        }
    }

    /// Returns whether all pairs of two runs are certainly in the first bin, which a tight cluster fills with as many
    /// pairs as the square of its samples. Where pairs are weighed, each must be computed.
    fn is_one_bin(&self, runs: [&[Entry]; 2]) -> bool {
        // Few pairs are counted sooner than their extent is found. As a number of pairs the limit was chosen, not
        // measured.
        let is_crowd = runs[0].len() * runs[1].len() > CROWD;
        if !is_crowd || !self.neighbors.grid.domain.periodic {
            return false;
        }

        let all = runs.into_iter().flatten().map(|entry| entry.position);
        let ends = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = all.fold(ends, |(low, high), at| (low.min(at), high.max(at)));
        low.distance(high) * (self.bins as f64 / self.distance) < 1.0
    }
}

impl PairSums {
    /// Adds the sums over other pairs.
    fn add(&mut self, other: Self) {
        for (total, count) in self.counts.iter_mut().zip(other.counts) {
            *total += count;
        }
        for (total, weight) in self.weights.iter_mut().zip(other.weights) {
            *total += weight;
        }
    }
}
