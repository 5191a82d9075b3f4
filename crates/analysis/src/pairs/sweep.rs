//! The pair search for crowded sets: a line moves along x, and each sample is compared with those behind it within
//! reach, by y. The reach is the radius until [`MAX_CONFLICTS`] are counted, then the distance of the mildest witness.
//! The result is that of the scan of a grid, for any order of the samples.
//!
//! # Why it takes `N log N`
//!
//! Cut the strip of a sample, one reach long and two high, into squares of half a reach: two samples of a square are
//! within reach. While conflicts are counted such pairs end the counting; after that there are no more of them than
//! witnesses, and before the first conflict there are none, because the smallest distance is the reach. So each sample
//! is compared with a bounded number of others on the average. Only samples at one place can tie at distance zero
//! without end: there the first ones are enough.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use super::{Pairs, length, offset};
use crate::error::VerifyError;
use crate::findings::MAX_CONFLICTS;
use crate::grid::{Entry, Grid};
use crate::monitor::Monitor;

/// Samples between two reports. Chosen, not measured.
const CHUNK: usize = 4096;

/// Allows for the rounding of a reach and of the distances compared with it.
const SLACK: f64 = 1.0 + 1e-9;

/// The sweep of a line along x, with the pairs that it found.
struct Sweep<'a> {
    grid: &'a Grid,
    radius: f64,
    witnesses: usize,
    /// By x, then y, then index.
    samples: Vec<Entry>,
    /// The samples behind the line that may be within reach: the bits of y, which sort as y does, and the index in
    /// `samples`.
    behind: BTreeSet<(u64, u32)>,
    pairs: Pairs,
}

/// Returns the conflicts and the smallest distance of all pairs, by a line that sweeps over the samples: for sets that crowd
/// cells.
pub(super) fn search(
    grid: &Grid,
    radius: f64,
    witnesses: usize,
    monitor: &Monitor<'_>,
) -> Result<Pairs, VerifyError> {
    let mut samples = grid.entries().to_vec();
    // At equal places the index decides, so that the sweep has one sequence.
    samples.sort_unstable_by(|a, b| {
        let [x, y] = [0, 1].map(|axis| a.position[axis].total_cmp(&b.position[axis]));
        x.then(y).then(a.id.cmp(&b.id))
    });

    let mut sweep = Sweep {
        grid,
        radius,
        witnesses,
        samples,
        behind: BTreeSet::new(),
        pairs: Pairs::new(witnesses),
    };
    sweep.run(monitor)?;
    Ok(sweep.pairs)
}

impl Sweep<'_> {
    /// Finds the pairs: a line sweeps along x, and `behind` holds the samples within reach behind it.
    fn run(&mut self, monitor: &Monitor<'_>) -> Result<(), VerifyError> {
        let count = self.samples.len();
        // The first sample that `behind` may still hold.
        let mut first = 0;
        for index in 0..count {
            let x = self.samples[index].position[0];
            self.drop_behind(&mut first, index, |other| x - other);
            let around = false;
            self.add_pairs(index, around);
            self.behind.insert(self.key(index));

            if (index + 1) % CHUNK == 0 {
                monitor.advance(CHUNK as u64)?;
            }
        }
        monitor.advance((count % CHUNK) as u64)?;

        if !self.grid.domain.periodic {
            return Ok(());
        }

        // The line meets the first samples once more, a period on: it finds the pairs that are closer around the torus.
        let period = self.grid.domain.extent[0];
        for index in 0..count {
            let x = self.samples[index].position[0];
            self.drop_behind(&mut first, count, |other| (period - other) + x);
            // No sample is within reach across the seam, nor will be as the line moves on.
            if self.behind.is_empty() {
                break;
            }

            let around = true;
            self.add_pairs(index, around);
            // All samples are counted by now: the caller may only cancel here.
            if index % CHUNK == 0 {
                monitor.advance(0)?;
            }
        }
        Ok(())
    }

    fn key(&self, index: usize) -> (u64, u32) {
        (self.samples[index].position[1].to_bits(), index as u32)
    }

    /// How far pairs matter; it never grows.
    fn reach(&self) -> f64 {
        let wanted = if self.pairs.conflicts < MAX_CONFLICTS {
            self.radius
        } else if self.witnesses == 0 {
            0.0
        } else {
            let mildest = self.pairs.worst.mildest();
            mildest.map_or(self.radius, |pair| pair.distance)
        };
        wanted.max(self.pairs.min_distance)
    }

    /// Drops from `behind` the samples from `first` on, up to `end`, that are beyond reach: `along` gives the distance
    /// from the line along x for the x of a sample. `first` becomes the first sample that is left.
    fn drop_behind(&mut self, first: &mut usize, end: usize, along: impl Fn(f64) -> f64) {
        let reach = self.reach() * SLACK;
        while *first < end && along(self.samples[*first].position[0]) > reach {
            self.behind.remove(&self.key(*first));
            *first += 1;
        }
    }

    /// Records the pairs of a sample with those behind the line: straight on, or `around` the torus along x. A pair is
    /// recorded the way that is shorter along x.
    fn add_pairs(&mut self, index: usize, around: bool) {
        let entry = self.samples[index];
        let periods = self.grid.domain.periods();
        let reach = self.reach();
        // With a reach of 0 only pairs at one place are left. They are all alike: one for each witness is enough.
        let most_partners = if reach == 0.0 {
            self.witnesses
        } else {
            usize::MAX
        };

        for ordinates in stretches(entry.position[1], reach * SLACK, periods[1]) {
            // The keys of all samples with these ordinates, whatever their index.
            let keys = (*ordinates.start(), 0)..=(*ordinates.end(), u32::MAX);
            for &(_, other) in self.behind.range(keys).take(most_partners) {
                let partner = &self.samples[other as usize];
                let direct = (partner.position[0] - entry.position[0]).abs();
                let is_closer_around = direct + direct > periods[0];
                // Around the torus a pair may be met from each of its samples. It counts from the lower index.
                let counts_here = !around || other as usize > index;
                if counts_here && is_closer_around == around {
                    let distance = length(offset(periods, &entry, partner));
                    self.pairs.add([&entry, partner], distance, self.radius);
                }
            }
        }
    }
}

/// The ordinates within reach of one, around the torus, each once; as bits.
fn stretches(y: f64, reach: f64, period: f64) -> impl Iterator<Item = RangeInclusive<u64>> {
    let bits = |low: f64, high: f64| low.max(0.0).to_bits()..=high.to_bits();
    let all = 2.0 * reach * SLACK >= period;
    let (low, high) = (y - reach, y + reach);
    let straight = if all {
        bits(0.0, f64::INFINITY)
    } else {
        bits(low, high)
    };
    let below =
        (!all && low < 0.0 && period.is_finite()).then(|| bits(low + period, f64::INFINITY));
    let above = (!all && high > period).then(|| bits(0.0, high - period));
    [Some(straight), below, above].into_iter().flatten()
}
