//! Detection and insertion in a region (see `stages::detect` for what a candidate is). A place that no sample covers
//! was covered by a lost one (a tiled sample that was eliminated or dropped), so only cells near lost samples are
//! searched (all cells if the pattern itself misses lattice points). Stamps prove most of their pixels covered: a table
//! says which of a cell's 8 x 8 pixels a sample surely covers. In the others, candidates are made from the samples that
//! are about as near to the pixel as the nearest one, since only those can make one.
//!
//! A region knows its part of the plane alone. A cell is *unsure* if its samples depend on the plane beyond, *reached*
//! if candidates in it may depend on an unsure cell, and *hot* if an unknown sample may be inserted in it or beside it.

mod candidate;
mod detect;
mod open;
mod pixel;
mod search;

use fearless_simd::Simd;

use crate::lattice::Domain;
use crate::parameters::{Insertion, Search};
use crate::random::Key;

use super::frame::PAD;
use super::near::{MAX_SITES, Near};
use super::region::{Region, flag};

use candidate::RankedCandidate;
use pixel::{Pixel, pixels_of};
pub(crate) use pixel::{corner, each_bit};

/// Cells searched around a cell unless that proves too few: all samples within 2r of its places.
pub(super) const USUAL: i32 = 2;

/// Parameters of the run that gap filling needs.
pub(crate) struct Rules {
    pub domain: Domain,
    pub search: Search,
    pub key: Key,
    /// How many cells away from a lost sample an uncovered place may be: 1 for a place that it covered, more with a
    /// pattern that leaves lattice points uncovered.
    pub lost_reach: i32,
    /// How gaps are filled.
    pub insertion: Insertion,
}

impl Rules {
    /// Returns whether every place that no sample covers was covered by a lost one.
    pub(crate) fn is_exact(&self) -> bool {
        self.lost_reach == 1
    }

    /// Returns how many cells away an unsure sample can affect a place.
    pub(crate) fn reach(&self) -> i32 {
        match self.insertion {
            Insertion::Circumcentre => reach_cells(self.domain.is_periodic()).max(self.lost_reach),
            Insertion::Uniform => self.lost_reach,
        }
    }
}

/// A sample that was inserted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inserted {
    pub x: i32,
    pub y: i32,
    pub iteration: u32,
}

/// The buffers of a fill.
pub(crate) struct GapBuffers {
    /// Bits of cells in which uncovered places may lie, row by row, and the list of those cells with
    /// their columns and rows.
    pub marked: Vec<u64>,
    pub listed: Vec<(u32, i32, i32)>,
    /// Open cells with their open pixels.
    masks: Vec<(u32, u64)>,
    /// Bits of open cells whose pixels are kept. `open_index` of such a cell is its index in `first_pixels`, which
    /// holds the index of its first pixel.
    open: Vec<u64>,
    open_index: Vec<u32>,
    first_pixels: Vec<u32>,
    pixels: Vec<Pixel>,
    /// The largest distance of a pixel to its nearest sample.
    farthest: f32,
    pub near: Near,
    wide: Near,
    /// The samples that may make a candidate in the current pixel, as indices of gathered samples.
    sites: [u8; MAX_SITES],
    candidates: Vec<RankedCandidate>,
    /// The pixels to be searched, each by its cell and its number in the cell.
    todo: Vec<(u32, u8)>,
    /// Cells in which a detection found that samples it needs are missing.
    unsure: Vec<usize>,
    pub inserted: Vec<Inserted>,
    /// Cell and slot of the samples inserted in the last iteration, sorted.
    detectors: Vec<u64>,
}

// It cannot be derived, as `sites` is too long an array for that.
impl Default for GapBuffers {
    fn default() -> Self {
        Self {
            marked: Vec::new(),
            listed: Vec::new(),
            open: Vec::new(),
            open_index: Vec::new(),
            masks: Vec::new(),
            first_pixels: Vec::new(),
            pixels: Vec::new(),
            farthest: 0.0,
            near: Near::default(),
            wide: Near::default(),
            sites: [0; MAX_SITES],
            candidates: Vec::new(),
            todo: Vec::new(),
            unsure: Vec::new(),
            inserted: Vec::new(),
            detectors: Vec::new(),
        }
    }
}

impl<const TAGS: bool> Region<TAGS> {
    /// Fills the gaps by circumcentres, except where the result depends on the plane beyond the frame.
    #[inline(always)]
    pub(crate) fn fill<S: Simd>(&mut self, simd: S, rules: &Rules) {
        // The buffers are taken out of the region, which is read while they change.
        let mut gaps = std::mem::take(&mut self.gaps);
        gaps.inserted.clear();

        self.mark(&mut gaps, rules);
        // The first detection checks every cell that is reached by then. Later ones pass reached cells by, so that
        // these are checked when they are marked.
        let (unchecked, checked) = (false, true);
        self.mark_reached(simd, &mut gaps, rules, unchecked);
        self.first_detection(simd, &mut gaps, rules);

        let mut iteration = 1;
        loop {
            let inserted_before = gaps.inserted.len();
            self.insert_candidates(simd, &mut gaps, rules, iteration);
            // After a round without an insertion all is done, unless cells have become unsure in it: then the number of
            // unsure cells exceeds `self.spread`, and their surroundings are still to be marked.
            if gaps.inserted.len() == inserted_before && self.spread == self.unsure.len() {
                break;
            }

            iteration += 1;
            self.mark_reached(simd, &mut gaps, rules, checked);
            self.detect_again(simd, &mut gaps, inserted_before, rules);
        }

        self.gaps = gaps;
    }

    /// Marks a cell as unsure, and flags it and the cells around it as hot.
    pub(crate) fn make_hot(&mut self, cell: usize) {
        self.make_unsure(cell);
        self.flag_around(cell, flag::HOT);
    }

    /// Marks the surroundings of unsure cells as reached: open places there may be filled by unknown samples. With
    /// `check` the newly reached cells become hot here if they are open; otherwise detection does so. The field
    /// `spread` counts the unsure cells whose surroundings are marked.
    #[inline(always)]
    fn mark_reached<S: Simd>(
        &mut self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        check: bool,
    ) {
        let reach = rules.reach();
        // Cells that become unsure on the way are left to the next call.
        let end = self.unsure.len();
        let (columns, rows) = (self.frame.cells[0], self.frame.cells[1]);

        for k in self.spread..end {
            let (column, row) = self.frame.column_row(self.unsure[k] as usize);
            for row in (row - reach).max(0)..=(row + reach).min(rows - 1) {
                for column in (column - reach).max(0)..=(column + reach).min(columns - 1) {
                    let cell = self.frame.cell(column, row);
                    if self.flags[cell] & flag::REACHED == 0 {
                        self.flags[cell] |= flag::REACHED;
                        // Only a cell with an open place depends on samples that are yet unknown.
                        if check && self.is_still_open(simd, gaps, cell, column, row) {
                            self.make_hot(cell);
                        }
                    }
                }
            }
        }
        self.spread = end;
    }

    /// Returns whether a cell that had an open pixel at the first detection may still have one.
    #[inline(always)]
    fn is_still_open<S: Simd>(
        &self,
        simd: S,
        gaps: &mut GapBuffers,
        cell: usize,
        column: i32,
        row: i32,
    ) -> bool {
        let (column, row) = ((column + PAD) as usize, (row + PAD) as usize);
        // Only cells with an open pixel at the first detection can have an open place: samples are never taken away
        // after that.
        if gaps.open[row * self.words() + column / 64] >> (column % 64) & 1 == 0 {
            return false;
        }

        gaps.near
            .gather(&self.slots, self.frame.stride(), cell, USUAL);
        let pixels = pixels_of(&gaps.first_pixels, &gaps.pixels, gaps.open_index[cell]);
        let mask = pixels
            .iter()
            .fold(0, |mask, pixel| mask | 1 << pixel.number);
        gaps.near.any_open(simd, mask)
    }
}

/// Returns the tag of a sample inserted in `iteration`.
pub(crate) fn inserted_tag(iteration: u32) -> u64 {
    u64::from(u32::MAX) << 32 | u64::from(iteration)
}

/// Returns the iteration that inserted the sample of a tag, or `None` for a tiled one.
pub(crate) const fn inserted_in(tag: u64) -> Option<u32> {
    if tag >> 32 == u32::MAX as u64 {
        Some(tag as u32)
    } else {
        None
    }
}

/// Returns how many cells away a sample may be from a candidate that depends on it: 2r and 16 units, or 3.5r near
/// closed borders.
#[must_use]
pub const fn reach_cells(periodic: bool) -> i32 {
    if periodic { 3 } else { 4 }
}
