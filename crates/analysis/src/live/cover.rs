//! Covered circles, kept while samples come and go: which circles the other disks leave open, the open places as the judges
//! count them, and the largest empty circle. Begin with [`LiveCover`].
//!
//! # The cells that are kept
//!
//! The Voronoi cell of each sample that has a vertex farther than a *threshold*, which is a little below the limit of
//! (1 + 2^-15) r. All open places and the largest empty circle are vertices of those cells. The circle of radius threshold around
//! any other sample is covered by the other disks of that radius, and its cell lies within it (see `circles`). The threshold is
//! lowered when no cell reaches beyond it, so the largest empty circle is always among the kept cells.
//!
//! # Why a change is local
//!
//! A sample that comes takes places from the cells of its Voronoi neighbours alone, and one that goes gives places to the same
//! cells. Two samples whose cells touch are both as far from a common vertex. So either their distance is at most twice the
//! threshold, or that vertex is beyond it and both cells are kept, with their neighbours. A kept cell is clipped when a sample
//! comes; when one goes, the cells around are tested anew as far as they are not kept, and cut out anew as far as they are or the
//! test fails.
//!
//! In a hole a cell may have neighbours at any distance. A vertex is certain when no sample lies within its circle. The search
//! for one sees blocks of empty cells at once ([`super::place_grid`]), so its steps grow with the logarithm of the plane's size
//! and the samples on the rim that are as near.
//!
//! Steps are counted as in [`super::place_grid`], and one for each vertex that a clipped cell has then.
//!
//! # Why nothing is counted twice
//!
//! See [`super::cell::CellVertices`]. Two different places less than 2^-30 r apart are two here, but one to the judges.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use glam::DVec2;

use super::cell::{CellVertices, LiveCell, Vertex};
use super::place_grid::{Occupant, PlaceGrid, check_plane};
use super::plane::Plane;
use super::renewal::{LiveSample, Renew};
use super::tournament::Tournament;
use crate::circles::{CircleTest, open_arcs, unproven_circles};
use crate::exact::covering_limit;
use crate::measures::MeasureError;
use crate::region::{Boundary, Region};
use crate::verify::COVERING_TOLERANCE;
use crate::witness::Gap;
use crate::worst::Witness;

/// How many cells away all samples are that may cover a part of a circle: cells are as wide as the circle's radius.
const REACH: usize = 2;

/// The first threshold, as a part of the limit. Of a maximal set about 2% of the cells reach farther.
const FIRST_THRESHOLD: f64 = 0.99;

/// On tori narrower than this many limits (the radius of the circles), all cells are kept, since a disk may cover a
/// circle from two sides. Chosen with room to spare.
const MIN_TORUS: f64 = 8.0;

/// The steps that a change of a maximal set takes in the mean, as measured.
const STEPS_OF_CHANGE: u64 = 400;

/// The steps that a sample of a maximal set takes in the mean when all is made anew, as measured.
const STEPS_OF_SAMPLE: u64 = 18;

/// The steps of a sample where each is tested by itself, as measured.
const STEPS_OF_SAMPLE_ALONE: u64 = 50;

/// The steps of one sample where all are tested together: it takes as long as this many steps of a change.
const STEPS_OF_TEST: u64 = 8;

/// A place that a sample takes. Its index among all such places is its slot.
#[derive(Clone, Debug, Default)]
struct Taken {
    place: [i32; 2],
    /// How many samples are there.
    copies: u32,
    /// Open places that count for its cell.
    open: u32,
    /// Its cell, if it is kept.
    vertices: Vec<Vertex>,
}

/// The circles of a set of samples that changes.
#[derive(Clone, Debug)]
pub struct LiveCover {
    plane: Plane,
    /// The largest covering radius of a maximal set, in units.
    limit: f64,
    /// Cells that reach farther are kept, see the head of this file.
    threshold: f64,
    grid: PlaceGrid,
    /// The places with their samples and cells, by slot.
    taken: Vec<Taken>,
    /// Slots without a sample.
    free: Vec<u32>,
    /// Of each kept cell the distance of the farthest vertex, as bits: those sort as the numbers do.
    reaches: Tournament,
    /// The number of samples, each copy counted.
    count: usize,
    /// The number of open places.
    open: u64,
    /// The cell that was cut out last, a buffer.
    cell: LiveCell,
    /// Slots to look at, a buffer.
    touched: Vec<u32>,
}

impl LiveCover {
    /// Returns the circles of no sample.
    ///
    /// # Errors
    ///
    /// [`MeasureError::OutOfRange`] for sides beyond 2^30 units or a radius beyond 2^20.
    pub fn new(plane: Plane) -> Result<Self, MeasureError> {
        check_plane(plane)?;
        let limit = covering_limit(COVERING_TOLERANCE, plane.radius.into());
        let mut cover = Self {
            plane,
            limit,
            // `clear` sets the first threshold.
            threshold: 0.0,
            // A hair more than the limit, so that a vertex at the limit is certain.
            grid: PlaceGrid::new(plane, limit * (1.0 + 1e-6)),
            taken: Vec::new(),
            free: Vec::new(),
            reaches: Tournament::default(),
            count: 0,
            open: 0,
            cell: LiveCell::default(),
            touched: Vec::new(),
        };
        cover.clear();
        Ok(cover)
    }

    /// Removes all samples, and goes back to the first threshold.
    fn clear(&mut self) {
        // On a narrow torus no cell is left out (`MIN_TORUS`).
        let shorter = f64::from(self.plane.size[0].min(self.plane.size[1]));
        let is_narrow =
            self.plane.boundary == Boundary::Periodic && shorter < MIN_TORUS * self.limit;
        self.threshold = if is_narrow {
            0.0
        } else {
            FIRST_THRESHOLD * self.limit
        };
        self.grid.clear();
        self.taken.clear();
        self.free.clear();
        self.reaches = Tournament::new(0);
        (self.count, self.open) = (0, 0);
    }

    /// Adds a sample at a place of the plane. Returns the counted steps. Circles do not depend on ids.
    pub fn insert(&mut self, _id: u32, place: [i32; 2]) -> u64 {
        self.count += 1;
        // A second sample at a place changes no circle.
        if let Some(slot) = self.slot_at(place) {
            self.taken[slot as usize].copies += 1;
            return 1;
        }

        let slot = self.take(place);
        let (mut steps, is_covered) = self.examine(slot);

        let mut touched = std::mem::take(&mut self.touched);
        if is_covered {
            // The sample's cell lies within its circle of the threshold, so that its neighbours are within two thresholds.
            touched.clear();
            steps += self.grid.around(place, REACH, |other, _| {
                touched.push(other.slot);
                ControlFlow::Continue(())
            });
            for &other in &touched {
                let offset = self.grid.offset(self.taken[other as usize].place, place);
                steps += self.clip_kept(other, offset.map(i64::from), slot);
            }
        } else {
            // If the circle was not proven covered, `examine` left the sample's cell in `self.cell`. It names all
            // neighbours, however far they are. As seen from them, the sample lies in the opposite direction.
            let cell = std::mem::take(&mut self.cell);
            for (other, [x, y]) in cell.vertices.iter().filter_map(Vertex::neighbour) {
                steps += self.clip_kept(other, [-x, -y], slot);
            }
            self.cell = cell;
        }

        self.touched = touched;
        steps + self.lower_threshold()
    }

    /// Takes out a sample that was added at a place. Returns the counted steps.
    ///
    /// # Panics
    ///
    /// If no sample is there.
    pub fn remove(&mut self, _id: u32, place: [i32; 2]) -> u64 {
        let slot = self
            .slot_at(place)
            .expect("a sample was added at the place");
        self.count -= 1;
        let taken = &mut self.taken[slot as usize];
        taken.copies -= 1;
        // While another sample is left at the place, no circle changes.
        if taken.copies > 0 {
            return 1;
        }

        // If the sample's cell is kept, it names neighbours that may be farther than any circle reaches.
        let mut touched = std::mem::take(&mut self.touched);
        touched.clear();
        let vertices = std::mem::take(&mut taken.vertices);
        let neighbours = vertices.iter().filter_map(Vertex::neighbour);
        touched.extend(neighbours.map(|(other, _)| other));

        self.drop_cell(slot);
        self.grid.remove(place, |occupant| occupant.slot == slot);
        self.free.push(slot);

        // Now the neighbours that the sample's cell did not name. Each of them is within two thresholds, or its own
        // cell is kept (see the head of this file).
        let two_thresholds_square = 4.0 * self.threshold * self.threshold;
        let mut steps = self.grid.around(place, REACH, |other, offset| {
            let is_kept = !self.taken[other.slot as usize].vertices.is_empty();
            if is_kept || square(offset) as f64 <= two_thresholds_square {
                touched.push(other.slot);
            }
            ControlFlow::Continue(())
        });

        // One neighbour may be found both by the cell and by its distance.
        touched.sort_unstable();
        touched.dedup();

        // On a torus a copy of the removed sample may be among its neighbours.
        for &other in touched.iter().filter(|&&other| other != slot) {
            let kept = &self.taken[other as usize].vertices;
            let mut neighbours = kept.iter().filter_map(Vertex::neighbour);
            // A kept cell that does not border on the removed sample does not change. A cell that is not kept may
            // reach beyond the threshold now.
            if kept.is_empty() || neighbours.any(|(neighbour, _)| neighbour == slot) {
                steps += self.examine(other).0;
            }
        }

        self.touched = touched;
        steps + self.lower_threshold()
    }

    /// Takes these samples in place of all others. Returns the counted steps.
    pub fn rebuild(&mut self, samples: &[LiveSample]) -> u64 {
        self.clear();
        for &(_, place) in samples {
            self.put(place);
        }

        self.reaches = Tournament::new(self.taken.len());
        let steps = self.examine_all();
        STEPS_OF_TEST * samples.len() as u64 + steps + self.lower_threshold()
    }

    /// Returns about how many counted steps a change takes.
    #[must_use]
    pub const fn cost_of_change(&self) -> u64 {
        STEPS_OF_CHANGE
    }

    /// Returns about how many counted steps it takes to make all anew from `count` samples.
    #[must_use]
    pub const fn cost_of_rebuild(&self, count: usize) -> u64 {
        STEPS_OF_SAMPLE * count as u64
    }

    /// Puts a sample at a place, without a look at any circle.
    fn put(&mut self, place: [i32; 2]) {
        self.count += 1;
        match self.slot_at(place) {
            Some(slot) => self.taken[slot as usize].copies += 1,
            // The new slot is not needed here.
            None => drop(self.take(place)),
        }
    }

    /// Returns the slot of a place, if a sample is there.
    fn slot_at(&self, place: [i32; 2]) -> Option<u32> {
        let mut beside = self.grid.beside(place).iter();
        let found = beside.find(|occupant| occupant.place == place)?;
        Some(found.slot)
    }

    /// Gives a place a slot with one sample, and returns the slot.
    fn take(&mut self, place: [i32; 2]) -> u32 {
        let slot = self.free.pop().unwrap_or_else(|| {
            self.taken.push(Taken::default());
            self.taken.len() as u32 - 1
        });
        let taken = &mut self.taken[slot as usize];
        (taken.place, taken.copies) = (place, 1);
        self.grid.insert(Occupant { place, slot });
        slot
    }

    /// Keeps the cell of a sample if it has a vertex beyond the threshold. Returns the counted steps, and whether the circle of
    /// the threshold was proven covered without the cell, which is otherwise in `self.cell`.
    fn examine(&mut self, slot: u32) -> (u64, bool) {
        let place = self.taken[slot as usize].place;
        let (mut steps, is_covered) = self.test(place);
        if is_covered {
            self.drop_cell(slot);
        } else {
            steps += self.cut(place, slot);
            // The slot's own buffer is filled again, so that a change allocates little.
            let mut vertices = std::mem::take(&mut self.taken[slot as usize].vertices);
            vertices.clear();
            vertices.extend_from_slice(&self.cell.vertices);
            self.taken[slot as usize].vertices = vertices;
            self.weigh(slot);
        }
        (steps, is_covered)
    }

    /// Keeps the cells that have a vertex beyond the threshold. Returns the counted steps.
    fn examine_all(&mut self) -> u64 {
        let unproven = self.unproven();
        unproven.into_iter().map(|slot| self.examine(slot).0).sum()
    }

    /// Returns the slots of samples whose circle of the threshold is not proven covered. All samples are tested together, as the
    /// judge by circles does it, which takes less time than to test each by itself.
    fn unproven(&self) -> Vec<u32> {
        // Slots whose places have no sample any more are left out.
        let is_taken = |slot: &u32| self.taken[*slot as usize].copies > 0;
        let slots: Vec<u32> = (0..self.taken.len() as u32).filter(is_taken).collect();
        // With a threshold of 0, as on narrow tori, all cells are kept.
        if self.threshold == 0.0 {
            return slots;
        }

        let point = |slot: &u32| self.taken[*slot as usize].place.map(f64::from);
        let points: Vec<[f64; 2]> = slots.iter().map(point).collect();
        let region = Region {
            width: self.plane.size[0].into(),
            height: self.plane.size[1].into(),
            boundary: self.plane.boundary,
        };

        match unproven_circles(&points, region, self.threshold) {
            Ok(unproven) => unproven
                .into_iter()
                .map(|index| slots[index as usize])
                .collect(),
            // The test declines crowded sets and thin planes: then no circle counts as proven.
            Err(_) => slots,
        }
    }

    /// Tests quickly whether the disks of the threshold certainly cover the circle of a sample. Returns the counted steps, and
    /// whether they do.
    fn test(&self, place: [i32; 2]) -> (u64, bool) {
        // With a threshold of 0, as on narrow tori, all cells are kept.
        if self.threshold == 0.0 {
            return (0, false);
        }

        let mut test = CircleTest::new(self.threshold);
        if self.plane.boundary == Boundary::Bounded {
            for axis in [0, 1] {
                let low = i64::from(place[axis]);
                let mut mirrored = [0, 0];
                // The disk of the sample's mirror image covers exactly the part of its circle beyond the border.
                for depth in [-low, i64::from(self.plane.size[axis]) - low] {
                    mirrored[axis] = 2 * depth;
                    test.add(mirrored.map(|value| value as f64));
                }
            }
        }

        let steps = self.grid.around(place, REACH, |_, offset| {
            test.add(offset.map(f64::from));
            if test.is_covered() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        (steps, test.is_covered())
    }

    /// Cuts out the cell of a sample into `self.cell`. Returns the counted steps.
    fn cut(&mut self, place: [i32; 2], slot: u32) -> u64 {
        let cell = &mut self.cell;
        cell.begin(self.plane, place, slot);
        // New vertices are doubtful until all samples that may cut them off have been seen.
        let is_certain = false;
        let mut widest_square = f64::INFINITY;
        let mut steps = self.grid.around(place, REACH, |other, offset| {
            // A sample more than twice as far as the farthest vertex cuts nothing off. The bound is a little larger, as
            // squares of vertices are rounded.
            if other.slot != slot
                && square(offset) as f64 <= widest_square
                && cell.clip(offset.map(i64::from), other.slot, is_certain)
            {
                widest_square = 4.0 * cell.farthest_square() * (1.0 + 1e-9);
            }
            ControlFlow::Continue(())
        });

        // All samples within the certain distance were seen: no other one cuts off a vertex that is at most half as
        // far. Each other vertex is certain once no sample is nearer to it than the cell's own.
        cell.trust(0.5 * self.grid.certain_with_copies(REACH));
        while let Some(index) = self.cell.uncertain() {
            let (more, cutting) = self.nearer(place, index);
            steps += more;
            match cutting {
                Some((offset, other)) => {
                    self.cell.clip(offset, other, is_certain);
                }
                None => self.cell.confirm(index),
            }
        }
        steps
    }

    /// Finds the sample, or the copy of one, that is nearest to a vertex of the cell, if it is nearer than the cell's
    /// own, which is at `place`. Returns the counted steps, and the offset of that sample from the cell's own with its
    /// slot.
    fn nearer(&self, place: [i32; 2], index: usize) -> (u64, Option<([i64; 2], u32)>) {
        let at = self.cell.vertices[index].at;
        let size = self.plane.size.map(i64::from);
        let center = DVec2::from(place.map(f64::from)) + at;
        let mut found = None;
        // The search goes beyond the circle by more than its square is rounded: whether a sample on the circle is
        // within is decided exactly below.
        let first_square = at.length_squared() * (1.0 + 1e-12);

        let steps = self
            .grid
            .within(center, first_square, |other, periods, nearest_square| {
                let offset = [0, 1].map(|axis| {
                    let copy = i64::from(other.place[axis]) + i64::from(periods[axis]) * size[axis];
                    copy - i64::from(place[axis])
                });
                // The offset is 0 for the cell's own sample. Its copies have cut the cell at the beginning.
                if offset != [0, 0] && self.cell.cuts(index, offset) {
                    let distance = DVec2::from(offset.map(|value| value as f64)) - at;
                    // Only samples within the present radius are passed to this closure. So the sample that is found
                    // last is the nearest, but for rounding, which must not make the radius larger.
                    *nearest_square = nearest_square.min(distance.length_squared());
                    found = Some((offset, other.slot));
                }
            });
        (steps, found)
    }

    /// Clips a cell, if it is kept, by a new neighbour. Returns the counted steps: the number of its vertices.
    fn clip_kept(&mut self, slot: u32, offset: [i64; 2], neighbour: u32) -> u64 {
        let taken = &mut self.taken[slot as usize];
        // A new sample may be found around itself, and its own cell is complete.
        if taken.vertices.is_empty() || slot == neighbour {
            return 0;
        }

        // `self.cell` is a buffer: its own vertices are kept in `taken` meanwhile.
        std::mem::swap(&mut self.cell.vertices, &mut taken.vertices);
        // All other samples have cut a kept cell before, so that its new vertices are certain.
        let is_certain = true;
        let cuts = self.cell.clip(offset, neighbour, is_certain);
        std::mem::swap(
            &mut self.cell.vertices,
            &mut self.taken[slot as usize].vertices,
        );

        if cuts {
            self.weigh(slot);
        }
        self.taken[slot as usize].vertices.len() as u64
    }

    /// Counts the open places of a cell anew, and drops a cell that does not reach beyond the threshold.
    fn weigh(&mut self, slot: u32) {
        let taken = &self.taken[slot as usize];
        let squares = (taken.vertices.iter()).map(|vertex| vertex.at.length_squared());
        let reach = squares.fold(0.0, f64::max).sqrt();
        if reach <= self.threshold {
            self.drop_cell(slot);
            return;
        }

        let open = self.vertices_of(slot).open().count() as u32;
        self.reaches.set(slot, reach.to_bits());
        let taken = &mut self.taken[slot as usize];
        self.open = self.open - u64::from(taken.open) + u64::from(open);
        taken.open = open;
    }

    /// Drops a cell, if it is kept.
    fn drop_cell(&mut self, slot: u32) {
        let taken = &mut self.taken[slot as usize];
        self.open -= u64::from(taken.open);
        taken.open = 0;
        // Most samples have no reach to be taken out of the tree.
        if self.reaches_of(slot) > 0 {
            self.reaches.set(slot, 0);
        }
        self.taken[slot as usize].vertices.clear();
    }

    /// Returns the distance of the farthest vertex of a cell, as bits, or 0 if the cell is not kept.
    fn reaches_of(&self, slot: u32) -> u64 {
        self.reaches.at(slot)
    }

    fn vertices_of(&self, slot: u32) -> CellVertices<'_> {
        let taken = &self.taken[slot as usize];
        CellVertices {
            plane: self.plane,
            limit: self.limit,
            place: taken.place,
            vertices: &taken.vertices,
        }
    }

    /// Lowers the threshold until a cell reaches beyond it; returns the counted steps. It is not raised until all is
    /// made anew, so this happens a few times at most.
    fn lower_threshold(&mut self) -> u64 {
        let mut steps = 0;
        while self.count > 0 && self.reaches.largest() == 0 {
            // The threshold's distance from the limit doubles.
            let lower = self.limit - 2.0 * (self.limit - self.threshold);
            // Below half of the limit no circle is worth a test.
            self.threshold = if lower > 0.5 * self.limit { lower } else { 0.0 };
            steps += self.examine_all();
        }
        steps
    }

    /// Returns the number of samples.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// Returns the number of open places: [`Report::gaps`](crate::Report::gaps).
    #[must_use]
    pub const fn open_places(&self) -> u64 {
        self.open
    }

    /// Returns the radius of the largest empty circle centred in the plane, in radii:
    /// [`Report::covering_radius`](crate::Report::covering_radius). Infinite without samples.
    #[must_use]
    pub fn covering_radius_in_radii(&self) -> f64 {
        if self.count == 0 {
            return f64::INFINITY;
        }
        let reach = f64::from_bits(self.reaches.largest());
        // Radii near the limit were compared exactly, but their rounded values may be beyond it.
        let radius = if self.open == 0 {
            reach.min(self.limit)
        } else {
            reach
        };
        radius / f64::from(self.plane.radius)
    }

    /// Returns whether no sample could be added, up to the tolerance.
    #[must_use]
    pub const fn is_maximal(&self) -> bool {
        self.count > 0 && self.open == 0
    }

    /// Returns the largest empty circle, in radii; of several, the one farthest left, and of those the lowest. None without
    /// samples.
    #[must_use]
    pub fn largest(&self) -> Option<Gap> {
        let reach = f64::from_bits(self.reaches.largest());
        let slots = self.reaches.winners().into_iter();
        let circles = slots.flat_map(|slot| {
            let all = self.vertices_of(slot);
            // The reach of a cell is computed as this length is, so that the two are equal bit for bit.
            let farthest = move |index: &usize| all.vertices[*index].at.length() == reach;
            (0..all.vertices.len())
                .filter(farthest)
                .map(move |index| Gap {
                    center: self.home(slot, all.vertices[index].at),
                    distance: self.covering_radius_in_radii(),
                    kind: all.kind(index),
                })
        });
        // Slots depend on how the set came about, and places do not.
        circles.min_by(|a, b| {
            let [x, y] = [0, 1].map(|axis| a.center[axis].total_cmp(&b.center[axis]));
            x.then(y)
        })
    }

    /// Returns all open places, in radii, the largest first, as [`verify`](crate::verify) finds them.
    #[must_use]
    pub fn gaps(&self) -> Vec<Gap> {
        let mut gaps = Vec::new();
        for slot in 0..self.taken.len() as u32 {
            if self.taken[slot as usize].open > 0 {
                let all = self.vertices_of(slot);
                gaps.extend(all.open().map(|index| Gap {
                    center: self.home(slot, all.vertices[index].at),
                    distance: all.vertices[index].at.length() / f64::from(self.plane.radius),
                    kind: all.kind(index),
                }));
            }
        }
        gaps.sort_unstable_by(Witness::rank);
        gaps
    }

    /// Returns the parts of the circle of radius (1 + 2^-15) r around the sample at a place that no other disk covers, as angles
    /// from the x axis, anticlockwise; none if its circle is covered or no sample is there.
    #[must_use]
    pub fn exposed_arcs(&self, place: [i32; 2]) -> Vec<[f64; 2]> {
        let Some(slot) = self.slot_at(place) else {
            return Vec::new();
        };
        if self.reaches_of(slot) <= self.limit.to_bits() {
            return Vec::new();
        }
        let vertices = self.taken[slot as usize].vertices.iter();
        let covered = vertices.map(|vertex| vertex.covered_arc(self.limit));
        // An edge that does not reach the circle covers no part of it.
        let arcs: Vec<_> = covered.filter(|(_, cos)| *cos < 1.0).collect();
        open_arcs(&arcs)
    }

    /// Returns the places of the samples whose circle of radius (1 + 2^-15) r is not covered.
    pub fn exposed(&self) -> impl Iterator<Item = [i32; 2]> + use<'_> {
        let limit = self.limit.to_bits();
        let slots = (0..self.taken.len() as u32).filter(move |&slot| self.reaches_of(slot) > limit);
        slots.map(|slot| self.taken[slot as usize].place)
    }

    /// The place, in radii, at an offset from a sample: wrapped around a torus, within a bounded plane.
    fn home(&self, slot: u32, at: DVec2) -> [f64; 2] {
        let place = DVec2::from(self.taken[slot as usize].place.map(f64::from)) + at;
        let extent = DVec2::from(self.plane.size.map(f64::from));
        let home = match self.plane.boundary {
            Boundary::Periodic => {
                let wrapped = place - (place / extent).floor() * extent;
                // Of a place a little below 0, rounding makes the extent itself, which is 0 again.
                DVec2::select(wrapped.cmplt(extent), wrapped, DVec2::ZERO)
            }
            Boundary::Bounded => place.clamp(DVec2::ZERO, extent),
        };
        (home / f64::from(self.plane.radius)).to_array()
    }
}

impl Renew for LiveCover {
    /// The number of slices that are done: one for each sample that is put in, then one for each slot whose circle is
    /// tested, and one for the threshold.
    type Work = usize;

    const BEGINNING: u64 = 1;

    fn begin_anew(&self, samples: &[LiveSample]) -> (Self, usize) {
        let mut empty = self.clone();
        empty.clear();
        empty.reaches = Tournament::new(samples.len());
        (empty, 0)
    }

    fn next_slice(&mut self, work: &mut usize, samples: &[LiveSample]) -> Option<u64> {
        let index = *work;
        *work += 1;
        if let Some(&(_, place)) = samples.get(index) {
            self.put(place);
            // As many steps as `rebuild` counts for a sample; what putting it in takes was not measured alone.
            return Some(STEPS_OF_TEST);
        }

        // All samples are in. Now each slot's circle is looked at, and after the last one the threshold.
        let slot = index - samples.len();
        match slot.cmp(&self.taken.len()) {
            Ordering::Less => Some(self.examine(slot as u32).0),
            Ordering::Equal => Some(self.lower_threshold()),
            Ordering::Greater => None,
        }
    }

    fn cost_of_slices(&self, count: usize) -> u64 {
        STEPS_OF_SAMPLE_ALONE * count as u64
    }
}

fn square(offset: [i32; 2]) -> i64 {
    let [x, y] = offset.map(i64::from);
    x * x + y * y
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples a little less than r apart, of which many circles are covered by few others.
    fn places(side: i32) -> Vec<(u32, [i32; 2])> {
        let moved = |i: i32, step: i32| i * step % 300 - 150;
        let all = (0..side * side).map(|i| {
            let at = [i % side, i / side].map(|k| 1250 * k + 600);
            [at[0] + moved(i, 7919), at[1] + moved(i, 5417)]
        });
        (0..).zip(all).collect()
    }

    /// The open places of the samples without one, by changes and from nothing.
    fn without(cover: &mut LiveCover, samples: &[(u32, [i32; 2])], index: usize) -> [u64; 2] {
        cover.rebuild(samples);
        let (id, place) = samples[index];
        cover.remove(id, place);
        let by_change = cover.open_places();
        let rest: Vec<_> = samples
            .iter()
            .filter(|sample| sample.0 != id)
            .copied()
            .collect();
        cover.rebuild(&rest);
        [by_change, cover.open_places()]
    }

    /// The control: with cells too small for the circle, a change does not look at all circles that it opens.
    #[test]
    fn a_wrong_range_of_neighbours_is_noticed() {
        let samples = places(16);
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let plane = Plane {
                size: [20_000; 2],
                radius: 1000,
                boundary,
            };
            let mut right = LiveCover::new(plane).expect("a plane");
            let mut wrong = right.clone();
            wrong.grid = PlaceGrid::new(plane, 0.4 * right.limit);
            let mut noticed = 0;
            for index in 0..samples.len() {
                let [by_change, anew] = without(&mut right, &samples, index);
                assert_eq!(by_change, anew, "{index}");
                let [by_change, anew] = without(&mut wrong, &samples, index);
                noticed += usize::from(by_change != anew);
            }
            assert!(noticed > samples.len() / 4, "{boundary:?}: {noticed}");
        }
    }
}
