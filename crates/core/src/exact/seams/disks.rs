//! Which samples cover places of a cell, in lists that are read eight samples at a time. A cell of side R near a seam is asked
//! about often. Its list lies in two or four lines of the cache; without it, the cells around would be read one by one.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, i32x8, mask32x8, u32x8};

use crate::exact::seams::halves::Halves;
use crate::lattice::{Point, R, R_SQUARED};

/// Samples that are looked at together.
const LANES: usize = 8;

/// Where a free lane has its sample: too far from any place of a frame to cover it, and near enough that differences fit.
const FAR: i32 = 1 << 28;

/// The lists begin one cell outside of the frame, so that the disk of any sample of the frame touches only cells with lists.
const MARGIN: i32 = 1;

/// The bits of all quarters of a square.
pub(super) const ALL_QUARTERS: u32 = 0b1111;

/// Eight samples of a list.
#[derive(Clone, Copy)]
struct DiskGroup {
    xs: [i32; LANES],
    ys: [i32; LANES],
    /// The first bits of their arrivals.
    whens: [u32; LANES],
    /// Their ids; from [`DOUBTFUL`] on if they depend on the plane beyond the ground.
    ids: [u32; LANES],
}

/// The bit that marks the ids of doubtful samples.
pub(super) const DOUBTFUL: u32 = 1 << 31;

/// Whether a dart is covered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coverage {
    None,
    /// Only by samples that depend on the plane beyond the ground.
    Doubtful,
    Certain,
}

impl DiskGroup {
    const EMPTY: Self = Self {
        xs: [FAR; LANES],
        ys: [FAR; LANES],
        whens: [u32::MAX; LANES],
        ids: [0; LANES],
    };

    /// Returns a bit for each sample that covers a place and has a `when` of at most `latest`.
    #[inline(always)]
    fn covering<S: Simd>(&self, simd: S, place: Point, latest: u32) -> u32 {
        let across = (i32x8::simd_from(simd, self.xs) - place.x).abs();
        let up = (i32x8::simd_from(simd, self.ys) - place.y).abs();
        let near = are_within(simd, across, up);
        let early = u32x8::simd_from(simd, self.whens).simd_le(u32x8::splat(simd, latest));
        (near & early).to_bitmask() as u32
    }
}

/// The list of a cell: groups one after another, of which the last may have free lanes.
#[derive(Clone, Copy)]
struct HeldList {
    /// The first group; 0, which stays empty, of a cell without samples.
    first: u32,
    last: u32,
    /// How many lanes of the last group were filled. A list without a group has none free.
    filled: u32,
    /// Whether samples deep inside of blocks are in the list, too.
    is_whole: bool,
}

impl HeldList {
    const EMPTY: Self = Self {
        first: 0,
        last: 0,
        filled: LANES as u32,
        is_whole: false,
    };
}

/// The lists of all cells of a frame.
#[derive(Default)]
pub(super) struct DiskLists {
    stride: i32,
    cells: Vec<HeldList>,
    groups: Vec<DiskGroup>,
    /// Of each group the next one of its list, or 0.
    nexts: Vec<u32>,
    has_doubtful: bool,
}

impl DiskLists {
    /// Empties the lists, and sets the first place beyond the frame.
    pub(super) fn reset(&mut self, end: Point) {
        let cells = |end: i32| (end - 1) / R + 1 + 2 * MARGIN;
        self.stride = cells(end.x);
        let count = self.stride * cells(end.y);
        self.cells.clear();
        self.cells.resize(count as usize, HeldList::EMPTY);
        self.groups.clear();
        self.nexts.clear();
        self.has_doubtful = false;
        self.append();
    }

    /// Adds an empty group, and returns its index.
    fn append(&mut self) -> u32 {
        self.groups.push(DiskGroup::EMPTY);
        self.nexts.push(0);
        self.groups.len() as u32 - 1
    }

    /// Returns the index of the cell of a place.
    #[inline(always)]
    pub(super) const fn cell(&self, place: Point) -> usize {
        let (column, row) = (
            (place.x >> R.ilog2()) + MARGIN,
            (place.y >> R.ilog2()) + MARGIN,
        );
        (row * self.stride + column) as usize
    }

    /// Returns whether the list of a cell was whole, and marks it as whole.
    #[inline(always)]
    pub(super) fn make_whole(&mut self, cell: usize) -> bool {
        std::mem::replace(&mut self.cells[cell].is_whole, true)
    }

    /// Adds a sample to the list of every cell that its disk touches.
    #[inline(always)]
    pub(super) fn add(&mut self, place: Point, when: u32, id: u32) {
        let (cells, count) = self.touched(place);
        for &cell in &cells[..count] {
            self.add_to(cell, place, when, id);
        }
    }

    /// Adds a doubtful sample to the list of every cell that its disk touches.
    #[inline(always)]
    pub(super) fn add_doubtful(&mut self, place: Point, when: u32, id: u32) {
        self.has_doubtful = true;
        self.add(place, when, id | DOUBTFUL);
    }

    /// Adds a sample to the list of one cell.
    #[inline(always)]
    pub(super) fn add_to(&mut self, cell: usize, place: Point, when: u32, id: u32) {
        if self.cells[cell].filled == LANES as u32 {
            self.extend(cell);
        }

        // `% LANES` changes no lane, but spares the check of the index, here and wherever a lane is read.
        let held = &mut self.cells[cell];
        let (group, lane) = (
            &mut self.groups[held.last as usize],
            held.filled as usize % LANES,
        );
        group.xs[lane] = place.x;
        group.ys[lane] = place.y;
        group.whens[lane] = when;
        group.ids[lane] = id;
        held.filled += 1;
    }

    /// Gives the list of a cell one more group.
    #[inline(never)]
    fn extend(&mut self, cell: usize) {
        let group = self.append();
        let held = &mut self.cells[cell];
        if held.first == 0 {
            held.first = group;
        } else {
            self.nexts[held.last as usize] = group;
        }
        (held.last, held.filled) = (group, 0);
    }

    /// Removes the sample at a place from all lists. Returns whether there was one: no two are at one place.
    #[inline(always)]
    pub(super) fn remove<S: Simd>(&mut self, simd: S, place: Point) -> bool {
        let mut found = false;
        // The lane stays free: one sample in seventy is lost.
        self.each_at(simd, place, |group, lane| {
            group.xs[lane] = FAR;
            found = true;
        });
        found
    }

    /// Makes the sample at a place a doubtful one in all lists. Returns whether there was a certain one.
    #[inline(always)]
    pub(super) fn doubt<S: Simd>(&mut self, simd: S, place: Point) -> bool {
        let mut was_certain = false;
        self.each_at(simd, place, |group, lane| {
            was_certain |= group.ids[lane] < DOUBTFUL;
            group.ids[lane] |= DOUBTFUL;
        });
        self.has_doubtful |= was_certain;
        was_certain
    }

    /// Calls `visit` with the group and the lane of the sample at a place in each list that has it.
    #[inline(always)]
    fn each_at<S: Simd>(
        &mut self,
        simd: S,
        place: Point,
        mut visit: impl FnMut(&mut DiskGroup, usize),
    ) {
        let (x, y) = (i32x8::splat(simd, place.x), i32x8::splat(simd, place.y));
        let (cells, count) = self.touched(place);
        for &cell in &cells[..count] {
            let mut index = self.cells[cell].first as usize;
            while index != 0 {
                let group = &mut self.groups[index];
                let in_column = i32x8::simd_from(simd, group.xs).simd_eq(x);
                let in_row = i32x8::simd_from(simd, group.ys).simd_eq(y);
                let lanes = (in_column & in_row).to_bitmask() as u32;
                // No two samples are at one place, so that a list has this one once.
                if lanes != 0 {
                    visit(group, lanes.trailing_zeros() as usize % LANES);
                    break;
                }
                index = self.nexts[index] as usize;
            }
        }
    }

    /// Returns the cells that the disk around a place touches, and how many they are.
    #[inline(always)]
    fn touched(&self, place: Point) -> ([usize; 9], usize) {
        let cell = self.cell(place);
        let stride = self.stride as usize;
        // None of the four cells that share a side with the place's own is farther than R.
        let mut cells = [cell; 9];
        cells[1] = cell - 1;
        cells[2] = cell + 1;
        cells[3] = cell - stride;
        cells[4] = cell + stride;

        // The squared distances of the columns and the rows beside the cell. That of a corner cell is the sum of two.
        let (x, y) = (place.x & (R - 1), place.y & (R - 1));
        let (left, right) = (square(x + 1), square(R - x));
        let (below, above) = (square(y + 1), square(R - y));
        let corners = [
            (left + below, cell - stride - 1),
            (right + below, cell - stride + 1),
            (left + above, cell + stride - 1),
            (right + above, cell + stride + 1),
        ];
        let mut count = 5;
        for (squared, corner) in corners {
            // Written in any case, and written over if the disk does not touch it.
            cells[count] = corner;
            count += usize::from(squared <= R_SQUARED as u32);
        }
        (cells, count)
    }

    /// Returns whether samples of a cell's list that came before `when` cover a place of the cell. Of samples with the same `when`,
    /// `is_earlier` decides; it gets their ids.
    #[inline(always)]
    pub(super) fn coverage<S: Simd>(
        &self,
        simd: S,
        cell: usize,
        place: Point,
        when: u32,
        mut is_earlier: impl FnMut(u32) -> bool,
    ) -> Coverage {
        let mut coverage = Coverage::None;
        let mut index = self.cells[cell].first as usize;
        // A cell without samples has the empty group.
        loop {
            let group = &self.groups[index];
            let mut found = group.covering(simd, place, when);
            while found != 0 {
                // There is a bit for each lane: the remainder only shows the compiler that the index is in range.
                let lane = found.trailing_zeros() as usize % LANES;
                found &= found - 1;
                let id = group.ids[lane];

                // Without the mark of doubtful ones it is the sample's id. A doubtful sample decides only if no certain
                // one follows.
                if group.whens[lane] < when || is_earlier(id % DOUBTFUL) {
                    if id < DOUBTFUL {
                        return Coverage::Certain;
                    }
                    coverage = Coverage::Doubtful;
                }
            }

            index = self.nexts[index] as usize;
            if index == 0 {
                return coverage;
            }
        }
    }

    /// Calls `visit` with the id of each sample of a cell's list that covers a place of the cell and did not come before `when`.
    #[inline(always)]
    pub(super) fn each_later<S: Simd>(
        &self,
        simd: S,
        cell: usize,
        place: Point,
        when: u32,
        mut visit: impl FnMut(u32),
    ) {
        let mut index = self.cells[cell].first as usize;
        while index != 0 {
            let group = &self.groups[index];
            // Samples of any time: the later ones are picked out below.
            let mut found = group.covering(simd, place, u32::MAX);
            while found != 0 {
                // There is a bit for each lane: the remainder only shows the compiler that the index is in range.
                let lane = found.trailing_zeros() as usize % LANES;
                found &= found - 1;
                // Whether the sample is doubtful does not matter here.
                if group.whens[lane] >= when {
                    visit(group.ids[lane] % DOUBTFUL);
                }
            }

            index = self.nexts[index] as usize;
        }
    }

    /// Calls `visit` with the ids of the samples of a cell's list that have a `when` of at least `earliest`.
    pub(super) fn each_from(&self, cell: usize, earliest: u32, mut visit: impl FnMut(u32)) {
        let mut index = self.cells[cell].first as usize;
        while index != 0 {
            let group = &self.groups[index];
            for lane in 0..LANES {
                // Free lanes have the latest of all.
                if group.whens[lane] >= earliest && group.xs[lane] != FAR {
                    visit(group.ids[lane] % DOUBTFUL);
                }
            }
            index = self.nexts[index] as usize;
        }
    }

    /// Returns two sets of bits, one for each quarter of a square, left before right and below before above: first the
    /// quarters that a single certain sample with a `when` of at most `latest` covers, then those that only a single
    /// doubtful one covers. `halves` are those of the square's columns and those of its rows. Samples are looked for in
    /// the list of `cell`, in which the square's middle lies.
    #[inline(always)]
    pub(super) fn covered_quarters<S: Simd>(
        &self,
        simd: S,
        cell: usize,
        halves: [impl Halves; 2],
        latest: u32,
    ) -> [u32; 2] {
        let only_certain = true;
        // In most frames all samples are certain: they need not be looked at twice.
        if !self.has_doubtful {
            let covered = self.quarters(simd, cell, halves, latest, !only_certain);
            return [covered, 0];
        }
        let certain = self.quarters(simd, cell, halves, latest, only_certain);
        if certain == ALL_QUARTERS {
            return [certain, 0];
        }
        let all = self.quarters(simd, cell, halves, latest, !only_certain);
        [certain, all & !certain]
    }

    /// Returns a bit for each quarter that a single sample with a `when` of at most `latest` covers. With
    /// `only_certain` doubtful samples do not count.
    #[inline(always)]
    fn quarters<S: Simd>(
        &self,
        simd: S,
        cell: usize,
        [across, up]: [impl Halves; 2],
        latest: u32,
        only_certain: bool,
    ) -> u32 {
        let too_far = i32x8::splat(simd, R + 1);
        // By quarter and lane, the least of the squared distances from the quarter's farthest place to a sample, less R
        // squared: where that is at most 0, the sample covers the quarter. The numbers are looked at once, after the last
        // group. To stop at a group that covers all quarters would take a branch that the processor cannot foresee.
        let mut beyond = [i32x8::splat(simd, i32::MAX); 4];
        let mut index = self.cells[cell].first as usize;
        while index != 0 {
            let group = &self.groups[index];
            let whens = u32x8::simd_from(simd, group.whens);
            let mut counts = whens.simd_le(u32x8::splat(simd, latest));
            if only_certain {
                let ids = u32x8::simd_from(simd, group.ids);
                counts &= ids.simd_lt(u32x8::splat(simd, DOUBTFUL));
            }

            let [left, right] = across.farther(simd, i32x8::simd_from(simd, group.xs));
            let [bottom, top] = up.farther(simd, i32x8::simd_from(simd, group.ys));
            // Samples that do not count are made too far on one axis, which is enough. Longer distances count as R + 1,
            // so that squares fit 32 bits.
            let (left, right) = (
                counts.select(left, too_far).min(too_far),
                counts.select(right, too_far).min(too_far),
            );
            let (bottom, top) = (bottom.min(too_far), top.min(too_far));
            let (left, right) = (
                left * left - R_SQUARED as i32,
                right * right - R_SQUARED as i32,
            );
            let (bottom, top) = (bottom * bottom, top * top);
            beyond[0] = beyond[0].min(left + bottom);
            beyond[1] = beyond[1].min(right + bottom);
            beyond[2] = beyond[2].min(left + top);
            beyond[3] = beyond[3].min(right + top);
            index = self.nexts[index] as usize;
        }

        let bit = |quarter: usize| {
            let is_covered = beyond[quarter].simd_le(i32x8::splat(simd, 0)).any_true();
            u32::from(is_covered) << quarter
        };
        bit(0) | bit(1) | bit(2) | bit(3)
    }
}

#[inline(always)]
const fn square(distance: i32) -> u32 {
    (distance * distance) as u32
}

/// Returns which of the distances, given on both axes, are at most R.
#[inline(always)]
fn are_within<S: Simd>(simd: S, across: i32x8<S>, up: i32x8<S>) -> mask32x8<S> {
    // Longer distances count as R + 1, which is too far as well: squares then fit 32 bits, as does their sum, of which R^2 is
    // taken off in between.
    let most = i32x8::splat(simd, R + 1);
    let (across, up) = (across.min(most), up.min(most));
    let beyond = across * across - R_SQUARED as i32 + up * up;
    beyond.simd_le(i32x8::splat(simd, 0))
}
