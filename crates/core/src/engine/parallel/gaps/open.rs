//! Finds the cells and pixels that may hold uncovered places: cells near lost samples, and pixels that the stamps of
//! the samples around do not prove covered. Cells and pixels that are left out are surely covered; those found may
//! turn out to be.
//!
//! A cell has sides of R and is divided into 8 x 8 pixels, one bit of a word each. A stamp has the pixels that a sample
//! surely covers. A lost sample was tiled and is not among the survivors. A slot holds a sample of a cell, packed.

use crate::lattice::R;

use super::super::frame::{CELL_BITS, PAD};
use super::super::region::{Region, Slots};
use super::super::stamp::{PIXELS, Stamps};
use super::{GapBuffers, Rules, corner};

impl<const TAGS: bool> Region<TAGS> {
    /// Marks the cells in which an uncovered place may lie: those around lost samples, or all with a pattern that
    /// leaves places uncovered itself. Also clears the bits of open cells, which are set as open pixels are found.
    #[inline(always)]
    pub(crate) fn mark(&self, gaps: &mut GapBuffers, rules: &Rules) {
        let words = self.words();
        let rows = (self.frame.cells[1] + 2 * PAD) as usize;
        let marks_all = !rules.is_exact();
        let marked = if marks_all { u64::MAX } else { 0 };
        for (bits, value) in [(&mut gaps.marked, marked), (&mut gaps.open, 0)] {
            bits.clear();
            bits.resize(words * rows, value);
        }

        if marks_all {
            return;
        }

        // A sample covers places of its own cell and of the eight around it. Three cells of a row lie in one word or
        // two.
        for lost in &self.lost {
            let first_column = ((lost.x >> CELL_BITS) + PAD - 1) as usize;
            let row = ((lost.y >> CELL_BITS) + PAD) as usize;

            let (word, bit) = (first_column / 64, first_column % 64);
            for row in row - 1..=row + 1 {
                let at = row * words + word;
                gaps.marked[at] |= 0b111 << bit;
                if bit > 61 {
                    gaps.marked[at + 1] |= 0b111 >> (64 - bit);
                }
            }
        }
    }

    /// Returns the words of a row of bits, one bit a cell.
    #[inline(always)]
    pub(super) fn words(&self) -> usize {
        self.frame.stride().div_ceil(64)
    }

    /// Lists the marked cells of the frame with their columns and rows, row by row.
    #[inline(always)]
    pub(crate) fn list_marked(&self, marked: &[u64], list: &mut Vec<(u32, i32, i32)>) {
        list.clear();
        let words = self.words();
        for row in 0..self.frame.cells[1] {
            let start = (row + PAD) as usize * words;
            for (word, &bits) in marked[start..start + words].iter().enumerate() {
                let mut left = bits;
                while left != 0 {
                    let column = (word * 64) as i32 + left.trailing_zeros() as i32 - PAD;
                    // This clears the lowest bit that is set.
                    left &= left - 1;
                    // The padding beside the frame has bits, too.
                    if (0..self.frame.cells[0]).contains(&column) {
                        list.push((self.frame.cell(column, row) as u32, column, row));
                    }
                }
            }
        }
    }

    /// Returns the pixels of a cell that are not proven covered.
    #[inline(always)]
    pub(crate) fn open_pixels(&self, stamps: &Stamps, cell: usize, column: i32, row: i32) -> u64 {
        let stride = self.frame.stride();
        let around = |middle: usize| &self.slots[middle - 1..=middle + 1];
        let (below, own, above) = (around(cell - stride), around(cell), around(cell + stride));
        // Cells around are numbered row by row from the lower left one: the cell itself is number 4. Of a cell's four
        // slots the last holds a count, and is no sample; the stamp of a free one is empty.
        let covered_by = |from: usize, &[a, b, c, _]: &Slots| {
            stamps.stamp(from, a) | stamps.stamp(from, b) | stamps.stamp(from, c)
        };
        // The samples of the cell itself and of the four cells at its sides prove most cells covered.
        let mut covered = covered_by(4, &own[1]) | covered_by(3, &own[0]) | covered_by(5, &own[2]);
        covered |= covered_by(1, &below[1]) | covered_by(7, &above[1]);
        if covered == u64::MAX {
            return 0;
        }
        covered |= covered_by(0, &below[0])
            | covered_by(2, &below[2])
            | covered_by(6, &above[0])
            | covered_by(8, &above[2]);
        if !self.frame.periodic {
            covered |= self.outside(column, row);
        }
        !covered
    }

    /// Returns the pixels of a cell that lie outside a bounded domain.
    #[inline(always)]
    fn outside(&self, column: i32, row: i32) -> u64 {
        let [width, height] = self.frame.end;
        let (left, bottom) = (column << CELL_BITS, row << CELL_BITS);
        if left + R <= width && bottom + R <= height {
            return 0;
        }
        let mut outside = 0;
        for pixel in 0..PIXELS * PIXELS {
            let (x, y) = corner(pixel as u8);
            outside |= u64::from(left + x >= width || bottom + y >= height) << pixel;
        }
        outside
    }
}
