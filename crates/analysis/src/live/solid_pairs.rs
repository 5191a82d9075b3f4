//! Distances between samples in space, kept while samples come and go: the smallest one, and conflicts. Squared distances are
//! integers, so that nothing drifts. Begin with [`LiveSolidPairs`].
//!
//! Its functions return counted steps: the cells and the samples that a search looked at.

use super::solid_box::SolidBox;
use super::solid_grid::SolidGrid;
use super::tournament::Tournament;
use crate::measures::{MeasureError, check_range};
use crate::region::Boundary;

/// The id and the place of a sample in space.
pub type LiveSolidSample = (u32, [i32; 3]);

/// The edge of a cell in radii. Conflicts need one radius. A tenth more is certain to hold the nearest pair of most sets of some
/// dozens of samples, and larger cells hold more samples to look at, in proportion to their volume.
const EDGE: f64 = 1.1;

/// The edge of the cells in which sparse sets are searched, over the cube root of the volume for each sample. In a
/// torus no set has a smallest distance above 1.241 such roots: balls of half that distance around all samples do not
/// overlap, so that its cube is at most 6 / pi times the volume for each sample. Cells of this edge mostly show the
/// nearest pair at once.
const SPARSE_EDGE: f64 = 1.25;

/// The longest side of a box. Offsets then have 31 bits.
const MAX_SIDE: u32 = i32::MAX as u32;

/// The largest radius, as in the plane.
const MAX_RADIUS: u32 = 1 << 20;

/// The steps that a change of a maximal set takes in the mean, as measured: 27 cells with a sample in each, and those around
/// samples that have lost their nearest one.
const STEPS_OF_CHANGE: u64 = 90;

/// The steps that a sample of a maximal set takes in the mean when all is made anew, as measured.
const STEPS_OF_SAMPLE: u64 = 40;

/// The distances between the samples of a set in space that changes.
#[derive(Clone, Debug)]
pub struct LiveSolidPairs {
    solid: SolidBox,
    grid: SolidGrid,
    /// Samples by slot: their ids.
    ids: Vec<u32>,
    /// Slots without a sample.
    free: Vec<u32>,
    /// For each sample the complement of the squared distance to the nearest other one, if that square is at most `certain`. The
    /// largest complement is that of the smallest distance.
    nearest: Tournament,
    /// The square of a distance: the search around a sample finds all samples that are at most that far away.
    certain: u64,
    conflicts: u64,
    count: usize,
    /// A buffer for the slots whose nearest sample was removed.
    to_search: Vec<u32>,
}

impl LiveSolidPairs {
    /// Returns the distances of no sample.
    ///
    /// # Errors
    ///
    /// [`MeasureError::OutOfRange`] for sides of 0 or beyond 2^31 - 1 units, or a radius of 0 or beyond 2^20.
    pub fn new(solid: SolidBox) -> Result<Self, MeasureError> {
        let within =
            |name, value: u32, most: u32| check_range(name, value.into(), [1.0, most.into()]);
        let sides = [
            "the width of a box",
            "the height of a box",
            "the depth of a box",
        ];
        for (name, side) in sides.into_iter().zip(solid.size) {
            within(name, side, MAX_SIDE)?;
        }
        within("the radius of a box", solid.radius, MAX_RADIUS)?;

        let grid = SolidGrid::new(solid, EDGE * f64::from(solid.radius));
        Ok(Self {
            solid,
            certain: square_of(grid.certain_distance()),
            grid,
            ids: Vec::new(),
            free: Vec::new(),
            nearest: Tournament::new(0),
            conflicts: 0,
            count: 0,
            to_search: Vec::new(),
        })
    }

    /// Adds a sample at a place of the box. Returns the counted steps.
    pub fn insert(&mut self, id: u32, place: [i32; 3]) -> u64 {
        // The slot of a removed sample is used again, so that the memory follows the samples and not the changes.
        let slot = self.free.pop().unwrap_or_else(|| {
            self.ids.push(0);
            self.ids.len() as u32 - 1
        });
        self.ids[slot as usize] = id;

        let (end, certain) = (self.radius_square(), self.certain);
        let (nearest, conflicts) = (&mut self.nearest, &mut self.conflicts);
        // Of each sample `nearest` keeps the complement of the squared distance to the nearest one: the largest complement is that
        // of the closest pair, and 0 stands for no sample.
        let mut largest_complement = 0;
        let steps = self.grid.around(place, |other, square| {
            *conflicts += u64::from(square < end);
            // The search finds only some of the pairs that are farther apart: they cannot tell which sample is the nearest.
            if square <= certain {
                let complement = !square;
                largest_complement = largest_complement.max(complement);
                if complement > nearest.at(other) {
                    nearest.set(other, complement);
                }
            }
        });

        self.nearest.set(slot, largest_complement);
        self.grid.insert(slot, place);
        self.count += 1;
        steps
    }

    /// Takes out the sample that was added with an id at a place. Returns the counted steps.
    ///
    /// # Panics
    ///
    /// If there is no such sample.
    pub fn remove(&mut self, id: u32, place: [i32; 3]) -> u64 {
        let removed = (self.grid).remove(place, |slot| self.ids[slot as usize] == id);
        let slot = removed.expect("the sample was added at the place");
        self.nearest.set(slot, 0);
        self.free.push(slot);
        self.count -= 1;

        let end = self.radius_square();
        let (nearest, conflicts) = (&self.nearest, &mut self.conflicts);
        let mut to_search = std::mem::take(&mut self.to_search);
        to_search.clear();
        let mut steps = self.grid.around(place, |other, square| {
            *conflicts -= u64::from(square < end);
            // The removed sample was the other's nearest one, or another is as near: the nearest one is searched again below.
            if nearest.at(other) == !square {
                to_search.push(other);
            }
        });

        for &other in &to_search {
            steps += self.find_nearest(other);
        }
        self.to_search = to_search;
        steps
    }

    /// Takes these samples in place of all others. Returns the counted steps.
    pub fn rebuild(&mut self, samples: &[LiveSolidSample]) -> u64 {
        self.clear(samples.len());
        let each = samples.iter();
        each.map(|&(id, place)| self.insert(id, place)).sum()
    }

    /// Removes all samples, and makes room for `room` new ones.
    pub fn clear(&mut self, room: usize) {
        self.grid.clear();
        self.ids.clear();
        self.free.clear();
        self.nearest = Tournament::new(room);
        (self.conflicts, self.count) = (0, 0);
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
        let mut largest_complement = 0;
        let steps = self.grid.around(self.grid.place(slot), |other, square| {
            // As in `insert`: only pairs that the search finds for certain count.
            if other != slot && square <= self.certain {
                largest_complement = largest_complement.max(!square);
            }
        });
        self.nearest.set(slot, largest_complement);
        steps
    }

    /// Returns the number of samples.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// Returns `N r^3 / volume`.
    #[must_use]
    pub fn density(&self) -> f64 {
        self.count as f64 / self.solid.volume_in_radii()
    }

    /// The square of the shortest period of a torus: the distance of each sample from its own copy.
    fn period_square(&self) -> Option<u64> {
        let shortest = self.solid.size.into_iter().min().map(u64::from)?;
        let is_periodic = self.solid.boundary == Boundary::Periodic;
        (is_periodic && self.count > 0).then_some(shortest * shortest)
    }

    fn radius_square(&self) -> u64 {
        u64::from(self.solid.radius).pow(2)
    }

    /// Returns the number of pairs of samples nearer than r, each pair once by its nearest images:
    /// [`SolidReport::conflicts`](crate::SolidReport::conflicts), but without a limit.
    #[must_use]
    pub const fn conflicts(&self) -> u64 {
        self.conflicts
    }

    /// Returns the smallest distance between two samples or, on a torus, between a sample and its own copy, in radii:
    /// [`SolidReport::min_distance`](crate::SolidReport::min_distance). Infinite if there is none.
    ///
    /// It is kept from change to change. Where no two samples are within 1.1 r, however, all samples are searched: of a run
    /// by darts, some hundred.
    #[must_use]
    pub fn smallest_distance_in_radii(&self) -> f64 {
        // The largest complement is that of the smallest square; it is 0 if no pair is so near that it is kept.
        let among_samples = match self.nearest.largest() {
            0 => self.closest_of_sparse(),
            kept => Some(!kept),
        };
        let least = among_samples.into_iter().chain(self.period_square()).min();
        let radius = f64::from(self.solid.radius);
        least.map_or(f64::INFINITY, |square| (square as f64).sqrt() / radius)
    }

    /// Returns the square of the smallest distance of a set in which no two samples are within `certain`; `None` of
    /// fewer than two samples. The cells of `grid` are too small for such a set: others are made, which are larger the
    /// fewer samples there are.
    fn closest_of_sparse(&self) -> Option<u64> {
        if self.count < 2 {
            return None;
        }
        // Slots without a sample are left out.
        let mut is_free = vec![false; self.ids.len()];
        for &slot in &self.free {
            is_free[slot as usize] = true;
        }
        let slots = (0..self.ids.len() as u32).filter(|&slot| !is_free[slot as usize]);
        let places: Vec<[i32; 3]> = slots.map(|slot| self.grid.place(slot)).collect();

        let volume: f64 = self.solid.size.map(f64::from).iter().product();
        let mut edge = SPARSE_EDGE * (volume / self.count as f64).cbrt();
        loop {
            let mut grid = SolidGrid::new(self.solid, edge);
            let mut least = u64::MAX;
            for (slot, &place) in (0..).zip(&places) {
                grid.around(place, |_, square| least = least.min(square));
                grid.insert(slot, place);
            }
            // All pairs up to the certain distance were seen. Otherwise the cells are made larger. Once no axis has
            // more than three cells, that distance is infinite, and the loop ends.
            if least <= square_of(grid.certain_distance()) {
                return Some(least);
            }
            edge *= 2.0;
        }
    }
}

/// Returns the square of a distance in units, rounded down. An infinite one gives the largest number.
fn square_of(distance: f64) -> u64 {
    (distance * distance) as u64
}
