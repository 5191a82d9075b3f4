//! Distances between samples, kept while samples come and go: those of g(r), the smallest one, and conflicts. Squared distances
//! are integers, and each change adds or takes those to the samples around it, so nothing drifts. Begin with [`LivePairs`].
//!
//! Its functions return counted steps: the cells and the samples that a search looked at.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use glam::DVec2;

use super::place_grid::{Occupant, PlaceGrid, check_plane};
use super::plane::Plane;
use super::renewal::{LiveSample, Renew};
use super::tournament::Tournament;
use crate::domain::Domain;
use crate::measures::{MIN_SAMPLES, MeasureError, PairCorrelation, largest_min_distance};
use crate::region::Boundary;
use crate::witness::Conflict;
use crate::worst::Witness;

/// Bins in a radius, as the pair correlation of a set of one radius has them.
const BINS_PER_RADIUS: f64 = 40.0;

/// Bins at most, as there: they end at 5 radii.
const MAX_BINS: f64 = 200.0;

/// Samples whose distance is kept are at most that many cells apart. Fewer and larger cells than these make a change no
/// quicker.
const REACH: usize = 2;

/// In how many parts of 1 the weight of a pair is counted. In a bounded plane it is the plane's area over the area in
/// which the pair's first sample can lie when both are moved together: 1 to 4. The sum over 2^32 pairs is exact in 128
/// bits.
const WEIGHT_UNITS: f64 = (1_u64 << 40) as f64;

/// The steps that a change of a maximal set takes in the mean, as measured.
const STEPS_OF_CHANGE: u64 = 200;

/// The steps that a sample of a maximal set takes in the mean when all is made anew, as measured.
const STEPS_OF_SAMPLE: u64 = 80;

/// The distances of all pairs by bin, and the conflicts among them. Each pair counts once.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Histogram {
    plane: Plane,
    /// Two counts for each bin: of the pairs exactly where the bin begins, which rounding may put into the bin before,
    /// and of all others. The last two bins are beyond the curve's end: of them it shows only the pairs exactly where
    /// the first one begins.
    counts: Vec<[u64; 2]>,
    /// The sums of their weights, in a bounded plane.
    weights: Vec<[u128; 2]>,
    conflicts: u64,
    /// Pairs at one place.
    coincident: u64,
}

impl Histogram {
    /// Returns the histogram of no pair.
    fn new(plane: Plane) -> Self {
        // The bins of `PairCorrelation::in_units_of`: they end just below half of the shorter side, since beyond that a
        // torus shows a pair twice. A dense set has fewer bins there, and `correlation` drops the others.
        let half = 0.499 * plane.region_in_radii().shorter_side();
        // One more bin begins exactly at the end, and one more takes all pairs that are farther than that bin.
        let bins = (BINS_PER_RADIUS * half).floor().min(MAX_BINS) as usize + 2;
        let weights = match plane.boundary {
            Boundary::Periodic => 0,
            Boundary::Bounded => bins,
        };
        Self {
            plane,
            counts: vec![[0; 2]; bins],
            weights: vec![[0; 2]; weights],
            conflicts: 0,
            coincident: 0,
        }
    }

    /// The distance beyond which no pair matters, in units.
    fn reach(&self) -> f64 {
        let farthest = (self.counts.len() - 2) as f64 / BINS_PER_RADIUS;
        // Conflicts are looked for in a plane of any size, so that the reach is a radius at least. One unit more covers
        // the rounding of the product.
        farthest.max(1.0) * f64::from(self.plane.radius) + 1.0
    }

    /// Adds a pair that comes, or takes one that goes.
    #[inline]
    fn change(&mut self, offset: [i32; 2], square: u64, comes: bool) {
        // Half of the pairs are farther than all bins. They are counted, too, since a branch that leaves them out would
        // be mispredicted for half of the pairs.
        let (bin, part) = self.bin(square);
        let step = |count: &mut u64| *count = if comes { *count + 1 } else { *count - 1 };
        step(&mut self.counts[bin][part]);
        // On a torus all pairs weigh the same, and counts suffice. The last bin is never shown and needs no weights.
        if !self.weights.is_empty() && bin + 1 < self.counts.len() {
            let weight = self.weight(offset);
            let sum = &mut self.weights[bin][part];
            *sum = if comes { *sum + weight } else { *sum - weight };
        }

        let radius = u64::from(self.plane.radius);
        if square < radius * radius {
            step(&mut self.conflicts);
            if square == 0 {
                step(&mut self.coincident);
            }
        }
    }

    /// Returns the bin of a squared distance, and its part: 0 exactly where the bin begins, otherwise 1. In the last
    /// bin, which is never shown, the part means nothing.
    #[inline]
    fn bin(&self, square: u64) -> (usize, usize) {
        let radius = f64::from(self.plane.radius);
        let at = (square as f64).sqrt() * (BINS_PER_RADIUS / radius);
        let bin = (at as usize).min(self.counts.len() - 1);
        let within_bin = at - bin as f64;
        // `at` is at most 200 where it matters, so that its rounding is far less than 1e-9 of a bin: a pair that is
        // farther than that from both ends of its bin is certainly in it. Pairs beyond all bins are in the last one,
        // wherever they are.
        if (1e-9..1.0 - 1e-9).contains(&within_bin) || bin + 1 == self.counts.len() {
            return (bin, 1);
        }

        // Near an edge between two bins integers decide: `at` = `nearest` if 40^2 square = (nearest radius)^2.
        let nearest = if within_bin < 0.5 { bin } else { bin + 1 };
        let edge = nearest as u64 * u64::from(self.plane.radius);
        match ((BINS_PER_RADIUS * BINS_PER_RADIUS) as u64 * square).cmp(&(edge * edge)) {
            Ordering::Less => (nearest - 1, 1),
            Ordering::Equal => (nearest, 0),
            Ordering::Greater => (nearest, 1),
        }
    }

    /// Returns the weight of a pair in a bounded plane, in [`WEIGHT_UNITS`].
    fn weight(&self, offset: [i32; 2]) -> u128 {
        // Along an axis, a pair that is moved as a whole can begin on all of the side but the length of its offset.
        let factor = |axis: usize| {
            let size = f64::from(self.plane.size[axis]);
            size / (size - f64::from(offset[axis].abs()))
        };
        (factor(0) * factor(1) * WEIGHT_UNITS).round() as u128
    }
}

/// The distances between the samples of a set that changes.
#[derive(Clone, Debug)]
pub struct LivePairs {
    histogram: Histogram,
    grid: PlaceGrid,
    /// Samples by slot: id and place.
    samples: Vec<LiveSample>,
    /// Slots without a sample.
    free: Vec<u32>,
    /// For each sample the complement of the squared distance to the nearest other one, if that square is at most
    /// `certain`. The largest complement is that of the smallest distance.
    nearest: Tournament,
    /// The square of a distance: the search around a sample finds all samples that are at most that far away.
    certain: u64,
    count: usize,
    /// A buffer for the slots whose nearest sample was removed.
    to_search: Vec<u32>,
}

impl LivePairs {
    /// Returns the distances of no sample.
    ///
    /// # Errors
    ///
    /// [`MeasureError::OutOfRange`] for sides beyond 2^30 units or a radius beyond 2^20.
    pub fn new(plane: Plane) -> Result<Self, MeasureError> {
        check_plane(plane)?;
        let histogram = Histogram::new(plane);
        let grid = PlaceGrid::new(plane, histogram.reach() / REACH as f64);
        let certain = grid.certain_distance(REACH);
        Ok(Self {
            histogram,
            grid,
            samples: Vec::new(),
            free: Vec::new(),
            nearest: Tournament::new(0),
            // Where all samples are seen, the distance is infinite, and its square becomes the largest number.
            certain: (certain * certain) as u64,
            count: 0,
            to_search: Vec::new(),
        })
    }

    /// Adds a sample at a place of the plane. Returns the counted steps.
    pub fn insert(&mut self, id: u32, place: [i32; 2]) -> u64 {
        // The slot of a removed sample is used again, so that the memory follows the samples and not the changes.
        let slot = self.free.pop().unwrap_or_else(|| {
            self.samples.push((0, [0; 2]));
            self.samples.len() as u32 - 1
        });
        self.samples[slot as usize] = (id, place);

        let comes = true;
        // Of each sample `nearest` keeps the complement of the squared distance to the nearest one: the largest
        // complement is that of the closest pair, and 0 stands for no sample.
        let mut largest_complement = 0;
        let steps = self.grid.around(place, REACH, |other, offset| {
            let distance_squared = square(offset);
            self.histogram.change(offset, distance_squared, comes);
            // The search finds only some of the pairs that are farther apart: they cannot tell which sample is the
            // nearest.
            if distance_squared <= self.certain {
                let complement = !distance_squared;
                largest_complement = largest_complement.max(complement);
                if complement > self.nearest.at(other.slot) {
                    self.nearest.set(other.slot, complement);
                }
            }
            ControlFlow::Continue(())
        });

        self.nearest.set(slot, largest_complement);
        self.grid.insert(Occupant { place, slot });
        self.count += 1;
        steps
    }

    /// Takes out the sample that was added with an id at a place. Returns the counted steps.
    ///
    /// # Panics
    ///
    /// If there is no such sample.
    pub fn remove(&mut self, id: u32, place: [i32; 2]) -> u64 {
        let is_it = |occupant: &Occupant| self.samples[occupant.slot as usize] == (id, place);
        let removed = self.grid.remove(place, is_it);
        let slot = removed.expect("the sample was added at the place");

        self.nearest.set(slot, 0);
        self.free.push(slot);
        self.count -= 1;

        let comes = false;
        let mut to_search = std::mem::take(&mut self.to_search);
        to_search.clear();
        let mut steps = self.grid.around(place, REACH, |other, offset| {
            let distance_squared = square(offset);
            self.histogram.change(offset, distance_squared, comes);
            // The removed sample was the other's nearest one, or another is as near: the nearest one is searched again
            // below.
            if self.nearest.at(other.slot) == !distance_squared {
                to_search.push(other.slot);
            }
            ControlFlow::Continue(())
        });

        for &other in &to_search {
            steps += self.find_nearest(other);
        }
        self.to_search = to_search;
        steps
    }

    /// Takes these samples in place of all others. Returns the counted steps.
    pub fn rebuild(&mut self, samples: &[LiveSample]) -> u64 {
        self.clear(samples.len());
        let each = samples.iter();
        each.map(|&(id, place)| self.insert(id, place)).sum()
    }

    /// Removes all samples, and makes room for `room` new ones.
    fn clear(&mut self, room: usize) {
        self.grid.clear();
        self.samples.clear();
        self.free.clear();
        self.nearest = Tournament::new(room);
        self.histogram = Histogram::new(self.histogram.plane);
        self.count = 0;
    }

    /// Returns about how many counted steps a change takes.
    #[must_use]
    pub const fn cost_of_change(&self) -> u64 {
        STEPS_OF_CHANGE
    }

    /// Returns about how many counted steps it takes to add `count` samples in place of all.
    #[must_use]
    pub const fn cost_of_rebuild(&self, count: usize) -> u64 {
        STEPS_OF_SAMPLE * count as u64
    }

    /// Searches the nearest sample to that of a slot again. Returns the counted steps.
    fn find_nearest(&mut self, slot: u32) -> u64 {
        // `nearest` holds complements of squared distances: the largest one belongs to the nearest sample, and 0 means
        // that none was found.
        let mut largest_complement = 0;
        let place = self.samples[slot as usize].1;
        let steps = self.grid.around(place, REACH, |other, offset| {
            let distance_squared = square(offset);
            // As in `insert`: only pairs that the search finds for certain count.
            if other.slot != slot && distance_squared <= self.certain {
                largest_complement = largest_complement.max(!distance_squared);
            }
            ControlFlow::Continue(())
        });

        self.nearest.set(slot, largest_complement);
        steps
    }

    /// Returns the number of samples.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// The square of the shorter period of a torus: the distance of each sample from its own copy.
    fn period_square(&self) -> Option<u64> {
        let plane = self.histogram.plane;
        let shorter = u64::from(plane.size[0].min(plane.size[1]));
        (plane.boundary == Boundary::Periodic && self.count > 0).then_some(shorter * shorter)
    }

    /// Whether each sample is in conflict with its own copy.
    fn has_own_conflicts(&self) -> bool {
        self.period_square()
            .is_some_and(|square| square < self.radius_square())
    }

    fn radius_square(&self) -> u64 {
        u64::from(self.histogram.plane.radius).pow(2)
    }

    /// Returns the number of pairs of samples nearer than r: [`Report::conflicts`](crate::Report::conflicts), but without a
    /// limit.
    #[must_use]
    pub fn conflicts(&self) -> u64 {
        let own = if self.has_own_conflicts() {
            self.count as u64
        } else {
            0
        };
        self.histogram.conflicts + own
    }

    /// Returns the smallest distance between two samples or, on a torus, between a sample and its own copy, in radii:
    /// [`Report::min_distance`](crate::Report::min_distance). Infinite if there is none.
    ///
    /// It is kept from change to change. Where no two samples are within 5 r, however, all samples are searched.
    #[must_use]
    pub fn smallest_distance_in_radii(&self) -> f64 {
        // The largest complement is that of the smallest square; it is 0 if no pair is so near that it is kept.
        let among_samples = match self.nearest.largest() {
            0 => self.closest_of_sparse().map(|(square, _)| square),
            kept => Some(!kept),
        };
        let least = among_samples.into_iter().chain(self.period_square()).min();
        least.map_or(f64::INFINITY, |square| self.in_radii(square))
    }

    fn in_radii(&self, square: u64) -> f64 {
        (square as f64).sqrt() / f64::from(self.histogram.plane.radius)
    }

    /// Returns the closest pair of samples, by ids, and their distance in radii; of equally close pairs the first by ids.
    /// On a torus a sample and its own copy are a pair, too. None if there is no pair.
    #[must_use]
    pub fn closest(&self) -> Option<Conflict> {
        // 0 if no two samples are near each other, otherwise the complement of the smallest squared distance.
        let kept = self.nearest.largest();
        let mut candidates: Vec<(u64, [u32; 2])> = Vec::new();
        if kept == 0 {
            candidates.extend(self.closest_of_sparse());
        }

        // All pairs of the smallest distance, whose square is `!kept`, are listed: their order by ids decides below. If
        // `kept` is 0, there are no winners.
        for slot in self.nearest.winners() {
            self.each_nearer(slot, !kept + 1, |other| {
                candidates.push((!kept, [slot, other]));
            });
        }
        // The smallest id is searched only where no pair that is kept is closer than a sample and its copy.
        let own = self.period_square();
        if let Some(square) = own.filter(|&square| kept == 0 || square <= !kept) {
            let slots = self.grid.all().map(|occupant| occupant.slot);
            let first = slots.min_by_key(|&slot| self.samples[slot as usize].0);
            candidates.extend(first.map(|slot| (square, [slot; 2])));
        }

        let pairs = candidates.into_iter();
        pairs
            .map(|(square, slots)| self.pair(square, slots))
            .min_by(Witness::rank)
    }

    fn pair(&self, square: u64, slots: [u32; 2]) -> Conflict {
        let [one, other] = slots.map(|slot| self.samples[slot as usize].0 as usize);
        Conflict {
            first: one.min(other),
            second: one.max(other),
            distance: self.in_radii(square),
        }
    }

    /// Calls `each` with the slots of the samples whose squared distance from one is less than `end`.
    fn each_nearer(&self, slot: u32, end: u64, mut each: impl FnMut(u32)) {
        let place = self.samples[slot as usize].1;
        self.grid.around(place, REACH, |other, offset| {
            if other.slot != slot && square(offset) < end {
                each(other.slot);
            }
            ControlFlow::Continue(())
        });
    }

    /// Returns the closest pair where no two samples are near each other: the square of its distance, and its slots.
    /// Samples that are so far apart are few, and the nearest to each is searched in the grid's pyramid. None if there
    /// are fewer than two samples.
    fn closest_of_sparse(&self) -> Option<(u64, [u32; 2])> {
        let size = self.histogram.plane.size.map(i64::from);
        let mut closest: Option<(u64, [u32; 2])> = None;
        for occupant in self.grid.all() {
            let center = DVec2::from(occupant.place.map(f64::from));
            // The closest pair so far bounds the search for a closer one; before there is one, the plane's diagonal does.
            let diagonal_square = size[0] * size[0] + size[1] * size[1];
            let bound_square = closest.map_or(diagonal_square as f64, |(square, _)| square as f64);

            self.grid
                .within(center, bound_square, |other, periods, narrowed_square| {
                    let along = |axis: usize| {
                        let copy =
                            i64::from(other.place[axis]) + i64::from(periods[axis]) * size[axis];
                        copy - i64::from(occupant.place[axis])
                    };
                    let (x, y) = (along(0), along(1));
                    let found = ((x * x + y * y) as u64, [occupant.slot, other.slot]);
                    // Of equally close pairs the first by ids is listed, as the judges do it.
                    let comes_before = |closest: (u64, [u32; 2])| {
                        let [new, old] =
                            [found, closest].map(|(square, slots)| self.pair(square, slots));
                        new.rank(&old).is_lt()
                    };
                    // A sample's own copies are no samples of the set: `period_square` has their distance.
                    if other.slot != occupant.slot && closest.is_none_or(comes_before) {
                        closest = Some(found);
                        *narrowed_square = narrowed_square.min(found.0 as f64);
                    }
                });
        }
        closest
    }

    /// Returns the conflicts, as [`Report::worst_conflicts`](crate::Report::worst_conflicts) lists them, but all.
    #[must_use]
    pub fn conflict_pairs(&self) -> Vec<Conflict> {
        // The squares of the radius and of the shorter period: squared distances are compared.
        let (end, period) = (self.radius_square(), self.period_square());
        let mut found = Vec::new();
        for &Occupant { slot, place } in self.grid.all() {
            // A larger complement is a smaller distance: samples without a conflict are passed over.
            if self.nearest.at(slot) > !end {
                self.each_nearer(slot, end, |other| {
                    let offset = self.grid.offset(place, self.samples[other as usize].1);
                    // Each pair is met from both of its samples.
                    if slot < other {
                        found.push(self.pair(square(offset), [slot, other]));
                    }
                });
            }

            // On a torus narrower than the radius each sample is in conflict with its own copy.
            if let Some(period) = period.filter(|&period| period < end) {
                found.push(self.pair(period, [slot; 2]));
            }
        }
        found.sort_unstable_by(Witness::rank);
        found
    }

    /// Returns g(r): what [`PairCorrelation::in_units_of`] the radius gives for these samples in radii. Counts are the same
    /// numbers where r is a power of two, so that places in radii are not rounded; g of a bounded plane differs by less than
    /// 10^-11 of itself.
    ///
    /// # Errors
    ///
    /// Those of that function.
    pub fn correlation(&self) -> Result<PairCorrelation, MeasureError> {
        // Sets are refused for the same reasons as by `PairCorrelation::in_units_of`.
        let (count, region) = (self.count, self.histogram.plane.region_in_radii());
        if count < MIN_SAMPLES {
            return Err(MeasureError::TooFew {
                count,
                limit: MIN_SAMPLES,
            });
        }
        // If the two samples of every pair are at one place, so are all samples.
        if self.histogram.coincident == count as u64 * (count as u64 - 1) / 2 {
            let place = self
                .grid
                .all()
                .next()
                .map_or([0; 2], |occupant| occupant.place);
            let radius = f64::from(self.histogram.plane.radius);
            let point = place.map(|value| f64::from(value) / radius);
            return Err(MeasureError::AllEqual { count, point });
        }

        // The region is in radii, so that a radius, the unit of the bins, is 1.
        let unit = 1.0;
        // The curve ends at this multiple of the largest minimum distance that `count` samples can have.
        let (end_in_multiples, bins) = PairCorrelation::bins_in_units_of(count, region, unit)?;
        let domain = Domain::new(region)?;
        // The same end in the domain's unit, in which `PairCorrelation` counts.
        let end = end_in_multiples * largest_min_distance(count, region.area()) * domain.scale;
        let per_length = bins as f64 / end;

        // One bin more is for farther pairs.
        let (mut counts, mut sums) = (vec![0; bins + 1], vec![0; bins + 1]);
        for (index, in_bin) in self.histogram.counts.iter().enumerate() {
            // Pairs exactly at the beginning of a bin go into it or into the one before, by the same rounded numbers as in
            // `PairCorrelation`.
            let edge = index as f64 / BINS_PER_RADIUS * domain.scale;
            let to = [((edge * per_length) as usize).min(bins), index.min(bins)];
            for part in [0, 1] {
                counts[to[part]] += in_bin[part];
                // On a torus no weights are kept: their sums stay 0 and are not read. The last bin has none, either.
                let in_bin_weights = self.histogram.weights.get(index);
                sums[to[part]] += in_bin_weights.map_or(0, |weights| weights[part]);
            }
        }
        // The curve does not show the farther pairs.
        counts.pop();
        sums.pop();

        let area = domain.extent.element_product();
        let density = |(pairs, sum): (&u64, u128)| match self.histogram.plane.boundary {
            Boundary::Periodic => *pairs as f64 / area,
            Boundary::Bounded => sum as f64 / WEIGHT_UNITS / area,
        };
        let weights: Vec<f64> = counts.iter().zip(sums).map(density).collect();
        Ok(PairCorrelation::of_sums(
            count,
            &domain,
            end_in_multiples,
            counts,
            &weights,
        ))
    }
}

impl Renew for LivePairs {
    /// The samples that are in.
    type Work = usize;

    const BEGINNING: u64 = 1;

    fn begin_anew(&self, samples: &[LiveSample]) -> (Self, usize) {
        let mut empty = self.clone();
        empty.clear(samples.len());
        (empty, 0)
    }

    fn next_slice(&mut self, work: &mut usize, samples: &[LiveSample]) -> Option<u64> {
        let &(id, place) = samples.get(*work)?;
        *work += 1;
        Some(self.insert(id, place))
    }

    fn cost_of_slices(&self, count: usize) -> u64 {
        self.cost_of_rebuild(count)
    }
}

fn square(offset: [i32; 2]) -> u64 {
    let [x, y] = offset.map(i64::from);
    (x * x + y * y) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The control: with cells too small for the distances, pairs are missed.
    #[test]
    fn a_wrong_range_of_neighbours_is_noticed() {
        let plane = Plane {
            size: [20_000; 2],
            radius: 1000,
            boundary: Boundary::Periodic,
        };
        let mut right = LivePairs::new(plane).expect("a plane");
        let mut wrong = right.clone();
        wrong.grid = PlaceGrid::new(plane, 0.5 * right.histogram.reach() / REACH as f64);
        let samples: Vec<(u32, [i32; 2])> = (0..200_u32)
            .map(|i| (i, [7919, 5417].map(|step| (i * step % 20_000) as i32)))
            .collect();
        let mut counts = [0_u64; 3];
        for (i, a) in samples.iter().enumerate() {
            for b in &samples[..i] {
                let square = square(right.grid.offset(a.1, b.1));
                let is_in_a_bin = right.histogram.bin(square).0 + 1 < right.histogram.counts.len();
                counts[2] += u64::from(is_in_a_bin);
            }
        }

        right.rebuild(&samples);
        wrong.rebuild(&samples);
        for (pairs, count) in [&right, &wrong].into_iter().zip(&mut counts) {
            let bins = &pairs.histogram.counts;
            *count = bins[..bins.len() - 1].iter().flatten().sum();
        }
        assert!(
            counts[0] == counts[2] && counts[1] < counts[2],
            "{counts:?}"
        );
    }
}
