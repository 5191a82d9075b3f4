//! Detection in a region: chooses the pixels to be searched in each iteration.
//!
//! A pixel is *open* if no single sample is known to cover it, and a cell if one of its pixels is. Samples that depend
//! on the plane beyond the frame are *unknown*. A cell is *unsure* if it may hold an unknown sample, *reached* if one
//! may take part in its candidates, and *hot* if one may yet be inserted in it or beside it.

use fearless_simd::Simd;

use crate::lattice::R;

use super::super::frame::{CELL_BITS, PAD};
use super::super::near::{HALF_DIAGONAL, SITE_SLACK};
use super::super::region::{Region, flag, pack};
use super::super::stamp::Stamps;
use super::candidate::site_key;
use super::pixel::{Pixel, PlacedPixel, centre, each_bit, pixels_of};
use super::search::Detectors;
use super::{GapBuffers, Inserted, Rules, USUAL, reach_cells};

/// The cells gathered, up to `USUAL` (two) from a pixel's own on both axes, have all samples nearer to the pixel than
/// this.
const GATHERED: f32 = (2 * R) as f32;

impl<const TAGS: bool> Region<TAGS> {
    /// Finds the open pixels and the candidates of iteration 1.
    #[inline(always)]
    pub(super) fn first_detection<S: Simd>(
        &mut self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
    ) {
        gaps.first_pixels.clear();
        gaps.pixels.clear();
        gaps.farthest = 0.0;
        gaps.candidates.clear();
        // Indices of earlier windows stay: only those of cells with a bit in `gaps.open` are read. These bits were
        // cleared when cells were marked, and `keep_open` sets them.
        gaps.open_index.resize(self.frame.cell_count(), 0);

        self.find_open(gaps);
        // The lists are taken out of the buffers, which change meanwhile.
        let masks = std::mem::take(&mut gaps.masks);
        let mut unsure = std::mem::take(&mut gaps.unsure);

        for &(cell, open) in &masks {
            let cell = cell as usize;
            gaps.near
                .gather(&self.slots, self.frame.stride(), cell, USUAL);
            // Candidates here may depend on unknown samples: the cell is unsure if it has an open place. If not, it has
            // no candidate.
            if self.flags[cell] & flag::REACHED != 0 {
                if gaps.near.any_open(simd, open) {
                    unsure.push(cell);
                }
                continue;
            }

            let first = self.keep_open(simd, gaps, cell, open);
            for k in first..gaps.pixels.len() {
                let pixel = gaps.pixels[k];
                let at = PlacedPixel { cell, pixel };
                self.search_measured(simd, gaps, rules, at, Detectors::First, &mut unsure);
            }
        }

        gaps.masks = masks;
        self.make_all_hot(gaps, unsure);
    }

    /// Fills `gaps.masks` with the cells that have open pixels.
    #[inline(always)]
    fn find_open(&self, gaps: &mut GapBuffers) {
        let stamps = Stamps::get();
        self.list_marked(&gaps.marked, &mut gaps.listed);
        gaps.masks.clear();
        for &(cell, column, row) in &gaps.listed {
            let open = self.open_pixels(stamps, cell as usize, column, row);
            if open != 0 {
                gaps.masks.push((cell, open));
            }
        }
    }

    /// Measures the open pixels of a cell, keeps those that no single sample covers, enters the cell in `gaps.open`,
    /// and returns the index of the first pixel kept.
    #[inline(always)]
    fn keep_open<S: Simd>(&self, simd: S, gaps: &mut GapBuffers, cell: usize, open: u64) -> usize {
        let (column, row) = self.frame.column_row(cell);
        let bit = (column + PAD) as usize;
        gaps.open[(row + PAD) as usize * self.words() + bit / 64] |= 1 << (bit % 64);
        gaps.open_index[cell] = gaps.first_pixels.len() as u32;
        let first = gaps.pixels.len();
        gaps.first_pixels.push(first as u32);

        for number in each_bit(open) {
            let (x, y) = centre(number);
            let measured = gaps.near.measure(simd, x, y);
            // A covered pixel is overwritten by the next one: a branch would be mispredicted too often.
            let kept = gaps.pixels.len() + usize::from(!measured.covered);
            gaps.pixels.push(Pixel::new(number, &measured));
            gaps.pixels.truncate(kept);
            // Covered pixels count, too: `farthest` need only be large enough.
            gaps.farthest = gaps.farthest.max(measured.nearest);
        }
        first
    }

    /// Searches a pixel that was measured among the samples in `gaps.near`.
    #[inline(always)]
    fn search_measured<S: Simd>(
        &self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        at: PlacedPixel,
        detectors: Detectors,
        unsure: &mut Vec<usize>,
    ) {
        let pixel = at.pixel;
        // Some sites may lie outside the gathered cells.
        if farthest_site(pixel.nearest) >= GATHERED {
            self.search_wide(simd, gaps, rules, at, detectors, unsure);
        // Three sites make a candidate; on a closed border two do, or one.
        } else if pixel.sites.count_ones() >= 3 || !self.frame.periodic {
            self.search_pixel(simd, gaps, rules, at, detectors, unsure);
        }
    }

    /// Finds the candidates made by the samples inserted last, those from `first` on.
    #[inline(always)]
    pub(super) fn detect_again<S: Simd>(
        &mut self,
        simd: S,
        gaps: &mut GapBuffers,
        first: usize,
        rules: &Rules,
    ) {
        // The lists are taken out of the buffers, which change meanwhile.
        let mut todo = std::mem::take(&mut gaps.todo);
        let mut unsure = std::mem::take(&mut gaps.unsure);
        todo.clear();
        gaps.candidates.clear();
        gaps.detectors.clear();

        for k in first..gaps.inserted.len() {
            let Inserted { x, y, .. } = gaps.inserted[k];
            gaps.detectors
                .push(site_key(self.frame.cell_at(x, y), pack(x, y)));
            self.concerned_pixels(gaps, x, y, &mut todo);
        }

        // The sites of a candidate are looked up among the sorted detectors. Pixels are sorted by cell, so that the
        // samples around a cell are gathered once. Two new samples may concern one pixel, which is searched once.
        gaps.detectors.sort_unstable();
        todo.sort_unstable();
        todo.dedup();

        let mut gathered = usize::MAX;
        for &(cell, number) in &todo {
            let cell = cell as usize;
            if gathered != cell {
                gaps.near
                    .gather(&self.slots, self.frame.stride(), cell, USUAL);
                gathered = cell;
            }

            let (x, y) = centre(number);
            let measured = gaps.near.measure(simd, x, y);
            if !measured.covered {
                let pixel = Pixel::new(number, &measured);
                let at = PlacedPixel { cell, pixel };
                self.search_measured(simd, gaps, rules, at, Detectors::Inserted, &mut unsure);
            }
        }

        gaps.todo = todo;
        self.make_all_hot(gaps, unsure);
    }

    /// Makes the cells of a list hot, and gives the list back to the buffers, empty.
    fn make_all_hot(&mut self, gaps: &mut GapBuffers, mut cells: Vec<usize>) {
        for cell in cells.drain(..) {
            self.make_hot(cell);
        }
        gaps.unsure = cells;
    }

    /// Appends the open pixels in which the sample at (x, y) may be a site of a candidate.
    #[inline(always)]
    fn concerned_pixels(&self, gaps: &GapBuffers, x: i32, y: i32, todo: &mut Vec<(u32, u8)>) {
        let words = self.words();
        let (column, row) = (x >> CELL_BITS, y >> CELL_BITS);

        // Samples three cells away are at least 2 r away: two cells suffice while no pixel has sites as far away.
        let reach = if farthest_site(gaps.farthest) < GATHERED {
            2
        } else {
            reach_cells(self.frame.periodic)
        };

        // Of a row of bits those of 2 reach + 1 cells are of interest, and they lie in one word or two. Bits of the
        // padding are never set.
        let first = (column + PAD - reach) as usize;
        let ones = (1_u64 << (2 * reach + 1)) - 1;

        for row in row - reach..=row + reach {
            let start = (row + PAD) as usize * words + first / 64;
            let low = gaps.open[start] >> (first % 64);
            // The shift is in two steps, since one by 64 is not allowed.
            let high = gaps
                .open
                .get(start + 1)
                .map_or(0, |&next| next << 1 << (63 - first % 64));

            for bit in each_bit((low | high) & ones) {
                let column = column - reach + i32::from(bit);
                let cell = self.frame.cell(column, row);
                // A reached cell inserts nothing: it has no open place, or is unsure already.
                if self.flags[cell] & flag::REACHED != 0 {
                    continue;
                }

                let dx = (x - (column << CELL_BITS)) as f32;
                let dy = (y - (row << CELL_BITS)) as f32;
                for pixel in pixels_of(&gaps.first_pixels, &gaps.pixels, gaps.open_index[cell]) {
                    let (cx, cy) = centre(pixel.number);
                    let squared = (dx - cx) * (dx - cx) + (dy - cy) * (dy - cy);
                    // A pixel that the sample covers as a whole has no open place left. `nearest` was measured before
                    // later insertions, which can only make it smaller: no site is farther away than `farthest`.
                    let covered_to = R as f32 - HALF_DIAGONAL;
                    let farthest = farthest_site(pixel.nearest);
                    if squared > covered_to * covered_to && squared <= farthest * farthest {
                        todo.push((cell as u32, pixel.number));
                    }
                }
            }
        }
    }
}

/// Returns the largest distance of a candidate's site from the centre of the candidate's pixel, to which the nearest
/// sample is at `nearest`. A place of the pixel is up to half a diagonal farther from that sample, and up to half a
/// diagonal from the centre, and all its sites are about as far from it.
#[inline(always)]
fn farthest_site(nearest: f32) -> f32 {
    nearest + 2.0 * HALF_DIAGONAL + SITE_SLACK
}
