//! The search for conflicts and for the smallest distance: samples in bins that are at least as wide as the distance that
//! is looked for, each compared with those in the bins around its own.

mod around;

use rayon::prelude::*;

use crate::findings::MAX_CONFLICTS;
use crate::monitor::Monitor;
use crate::witness::Conflict;
use crate::worst::Worst;

use super::SolidQuestion;
use super::error::SolidError;
use super::region::SolidRegion;
use around::Around;

/// Bins are wider than the radius by a thousandth: in most sets the nearest pair is then found with the conflicts.
const NEARLY: f64 = 1.001;

/// Bins are wider than they must be by a thousandth, far more than rounding moves a sample across their borders.
const SPARE: f64 = 0.999;

/// The most bins on an axis: numbers of bins on three axes fit into a key of 96 bits.
const MAX_BINS: f64 = 4_294_967_295.0;

/// Samples that a thread works on at a time. This number and the next one are chosen, not measured.
const CHUNK: usize = 512;

/// Chunks between two questions whether there are conflicts enough.
const CHUNKS: usize = 64;

/// With more samples in a bin, pairs are too many to look at all of them. In the first search bins are at most 2.01 r
/// wide, and a conflict-free set has at most 51 samples in a bin: the balls of r / 2 around them do not overlap, and lie
/// in a cube of 3.01 r.
const CROWD: usize = 64;

/// The conflicts among pairs, and the distance of the nearest one.
pub(super) struct PairsFound {
    pub conflicts: u64,
    pub worst: Worst<Conflict>,
    pub min_distance: f64,
}

impl PairsFound {
    fn new(witnesses: usize) -> Self {
        Self {
            conflicts: 0,
            worst: Worst::new(witnesses),
            min_distance: f64::INFINITY,
        }
    }

    /// Returns no conflicts, for a set whose nearest samples are this far apart.
    pub fn without_conflicts(min_distance: f64) -> Self {
        Self {
            min_distance,
            ..Self::new(0)
        }
    }

    fn merge(&mut self, other: Self) {
        self.conflicts += other.conflicts;
        self.worst.merge(other.worst);
        self.min_distance = self.min_distance.min(other.min_distance);
    }

    /// Whether more conflicts would not be counted.
    const fn is_full(&self) -> bool {
        self.conflicts >= MAX_CONFLICTS
    }
}

/// Counts the pairs closer than the radius, and finds the smallest distance of all.
pub(super) fn search(
    question: &SolidQuestion<'_>,
    monitor: &Monitor<'_>,
) -> Result<PairsFound, SolidError> {
    let &SolidQuestion {
        points,
        ref region,
        radius,
        witnesses,
        ..
    } = question;
    let reach = NEARLY * radius;
    let bins = Bins::new(points, region, reach);
    let mut found = bins.scan(radius, witnesses, monitor)?;
    // Where conflicts are too many, or all samples far apart, the nearest pair was not sure to be seen.
    if found.is_full() || found.min_distance > reach {
        found.min_distance = smallest_distance(points, region, reach, monitor)?;
    }

    if region.is_periodic() {
        // A sample and its own image are the shortest period apart.
        found.min_distance = found.min_distance.min(region.shortest());
    }
    Ok(found)
}

/// Pairs by their distance.
pub(super) struct PairsByDistance {
    /// How many pairs each bin of distances has.
    pub counts: Vec<u64>,
    /// For each bin, the sum of the inverse volumes in which a pair can lie. In a periodic region that is the region's.
    pub weights: Vec<f64>,
}

impl PairsByDistance {
    fn new(bins: usize) -> Self {
        Self {
            counts: vec![0; bins],
            weights: vec![0.0; bins],
        }
    }

    fn merge(&mut self, other: &Self) {
        for (own, others) in self.counts.iter_mut().zip(&other.counts) {
            *own += others;
        }
        for (own, others) in self.weights.iter_mut().zip(&other.weights) {
            *own += others;
        }
    }
}

/// Counts the pairs closer than `most` by their distance, in `bins` intervals of equal width. The bins of samples in
/// space are called cells here.
pub(super) fn pairs_by_distance(
    points: &[[f64; 3]],
    region: &SolidRegion,
    most: f64,
    bins: usize,
    monitor: &Monitor<'_>,
) -> Result<PairsByDistance, SolidError> {
    let cells = Bins::new(points, region, most);
    let mut all = PairsByDistance::new(bins);
    for batch in cells.binned.chunks(CHUNK * CHUNKS) {
        let of_chunk = |chunk: &[Binned]| cells.by_distance(chunk, most, bins);
        let found: Vec<PairsByDistance> = batch.par_chunks(CHUNK).map(of_chunk).collect();
        // In their order, so that sums are rounded alike on any number of threads.
        for found in found {
            all.merge(&found);
        }
        monitor.advance(batch.len() as u64)?;
    }
    Ok(all)
}

/// Returns the smallest distance of two samples, and infinity of one sample alone. The first search is certain to find
/// pairs within `reach`; the following searches have a shorter reach in a crowd and a longer one where nothing was
/// found.
fn smallest_distance(
    points: &[[f64; 3]],
    region: &SolidRegion,
    mut reach: f64,
    monitor: &Monitor<'_>,
) -> Result<f64, SolidError> {
    if has_copies(points) {
        return Ok(0.0);
    }

    let monitor = monitor.uncounted();
    loop {
        let bins = Bins::new(points, region, reach);
        let crowd = bins.fullest();
        // A bin is cut into this many parts along each axis. As it holds more samples than parts, two of them are in
        // one part: at most its diagonal apart.
        let parts = (crowd as f64).cbrt().ceil() - 1.0;
        let diagonal = bins.widest() * 3.0_f64.sqrt() / parts;
        if crowd > CROWD && diagonal < reach {
            reach = diagonal;
            continue;
        }

        // No distance is below 0, so that no conflict is counted, and none needs to be listed.
        let (radius, witnesses) = (0.0, 0);
        let found = bins.scan(radius, witnesses, &monitor)?.min_distance;
        // All pairs within the reach were seen, and a bin as wide as the region sees all.
        if found <= reach || bins.is_one() {
            return Ok(found);
        }
        reach = if found.is_finite() {
            found
        } else {
            2.0 * reach
        };
    }
}

/// Returns whether two samples have one place.
fn has_copies(points: &[[f64; 3]]) -> bool {
    // Adding 0 makes the two zeros equal in all bits.
    let bits = |point: &[f64; 3]| point.map(|value| (value + 0.0).to_bits());
    let mut places: Vec<[u64; 3]> = points.par_iter().map(bits).collect();
    places.par_sort_unstable();
    places.windows(2).any(|pair| pair[0] == pair[1])
}

/// A sample in its bin.
#[derive(Clone, Copy)]
struct Binned {
    /// The numbers of its bin along z, y and x.
    key: u128,
    place: [f64; 3],
    index: u32,
}

/// Samples in the order of their bins: along x, then y, then z.
struct Bins<'a> {
    region: &'a SolidRegion,
    counts: [u64; 3],
    binned: Vec<Binned>,
}

impl<'a> Bins<'a> {
    /// Sorts samples into bins that are wider than `reach` where the region is.
    fn new(points: &[[f64; 3]], region: &'a SolidRegion, reach: f64) -> Self {
        let size = region.size();
        let counts = size.map(|extent| (SPARE * extent / reach).clamp(1.0, MAX_BINS) as u64);
        // A place on an upper side belongs to the last bin.
        let binned = points.par_iter().enumerate().map(|(index, &place)| {
            let [x, y, z] = [0, 1, 2].map(|axis| {
                let bin = (place[axis] / size[axis] * counts[axis] as f64) as u64;
                bin.min(counts[axis] - 1)
            });
            Binned {
                key: key(x, y, z),
                place,
                index: index as u32,
            }
        });

        // Indices differ, so that the order does not depend on threads.
        let mut binned: Vec<Binned> = binned.collect();
        binned.par_sort_unstable_by_key(|sample| (sample.key, sample.index));
        Self {
            region,
            counts,
            binned,
        }
    }

    /// Whether there is a single bin.
    fn is_one(&self) -> bool {
        self.counts == [1; 3]
    }

    /// Returns the longest edge of a bin.
    fn widest(&self) -> f64 {
        let axes = self.region.size().into_iter().zip(self.counts);
        let edges = axes.map(|(extent, count)| extent / count as f64);
        edges.fold(0.0, f64::max)
    }

    /// Returns how many samples the fullest bin has.
    fn fullest(&self) -> usize {
        let runs = self.binned.chunk_by(|a, b| a.key == b.key);
        runs.map(<[Binned]>::len).max().unwrap_or(0)
    }

    /// Compares all samples with those in the bins around their own, until there are conflicts enough.
    fn scan(
        &self,
        radius: f64,
        witnesses: usize,
        monitor: &Monitor<'_>,
    ) -> Result<PairsFound, SolidError> {
        let mut all = PairsFound::new(witnesses);
        for batch in self.binned.chunks(CHUNK * CHUNKS) {
            // Decided for whole batches, so that the report is the same on any number of threads.
            if !all.is_full() {
                let of_chunk = |chunk: &[Binned]| self.of_chunk(chunk, radius, witnesses);
                let found: Vec<PairsFound> = batch.par_chunks(CHUNK).map(of_chunk).collect();
                for found in found {
                    all.merge(found);
                }
            }
            monitor.advance(batch.len() as u64)?;
        }
        Ok(all)
    }

    /// Returns the pairs of some samples with those in the bins around them, each pair once.
    fn of_chunk(&self, chunk: &[Binned], radius: f64, witnesses: usize) -> PairsFound {
        let mut found = PairsFound::new(witnesses);
        let mut around = Around::of(self);
        for own in chunk.chunk_by(|a, b| a.key == b.key) {
            // Samples of a bin have the same bins around them.
            around.find(own[0].key);
            for one in own {
                for other in around.rows.iter().copied().flatten() {
                    // Of a pair each sample finds the other, and the first one counts.
                    if one.index >= other.index {
                        continue;
                    }

                    let distance = self.region.distance(one.place, other.place);
                    found.min_distance = found.min_distance.min(distance);
                    if distance < radius {
                        found.conflicts += 1;
                        found.worst.push(Conflict {
                            first: one.index as usize,
                            second: other.index as usize,
                            distance,
                        });
                    }
                }
                // A crowd of a million would take a million million comparisons.
                if found.is_full() {
                    return found;
                }
            }
        }
        found
    }

    /// Returns the pairs of some samples with those in the bins around them by their distance, each pair once.
    fn by_distance(&self, chunk: &[Binned], most: f64, bins: usize) -> PairsByDistance {
        let mut found = PairsByDistance::new(bins);
        let mut around = Around::of(self);
        let size = self.region.size();
        for own in chunk.chunk_by(|a, b| a.key == b.key) {
            around.find(own[0].key);
            for one in own {
                for other in around.rows.iter().copied().flatten() {
                    let distance = self.region.distance(one.place, other.place);
                    // Of a pair each sample finds the other, and the first one counts.
                    if one.index >= other.index || distance >= most {
                        continue;
                    }

                    // Rounding may put the largest distance into the bin beyond the last.
                    let bin = ((distance / most * bins as f64) as usize).min(bins - 1);
                    let apart = self.region.apart(one.place, other.place);
                    // The volume of the places at which a pair with this offset fits into the box.
                    let room: f64 = if self.region.is_periodic() {
                        self.region.volume()
                    } else {
                        (0..3).map(|axis| size[axis] - apart[axis]).product()
                    };
                    found.counts[bin] += 1;
                    found.weights[bin] += 1.0 / room;
                }
            }
        }
        found
    }
}

/// Returns the key of a bin.
const fn key(x: u64, y: u64, z: u64) -> u128 {
    (z as u128) << 64 | (y as u128) << 32 | x as u128
}
