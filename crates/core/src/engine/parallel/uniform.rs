//! Uniform insertion in a region: the dart process of `stages::darts`, restricted to the gaps and to the frame. Its
//! cells are those of the domain, with the same keys. Which covered cells are visited does not matter, since no dart in
//! them becomes a sample.
//!
//! Cells of the frame, of side R, have flags, as in [`super::gaps`], and 8 x 8 *pixels*. Samples that depend on the plane
//! beyond the frame are *unknown*. A cell is *unsure* if it may hold an unknown sample, *reached* if one may fill its open
//! places, and *hot* if one may yet be inserted in it or beside it. *Lost* samples were tiled and are not among the
//! survivors.

use fearless_simd::Simd;

use crate::lattice::{Point, R, R_SQUARED};
use crate::stages::darts::{DartDraws, GAP_SIDE, LAST_LEVEL, cell_darts, throw_key};
use crate::stages::disks::Cell;
use crate::stages::uniform::{SLACK, gap_key};

use super::frame::CELL_BITS;
use super::gaps::{GapBuffers, Inserted, Rules, USUAL, corner, each_bit, inserted_tag};
use super::region::{Loss, Region, flag, unpack};
use super::stamp::{PIXEL_SIDE, Stamps};

/// An active cell of the dart process.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Active {
    /// Its lowest corner in the frame.
    y: i32,
    x: i32,
    /// Its lowest corner in the domain.
    domain_y: i32,
    domain_x: i32,
}

/// A dart that no earlier sample covers, compared by rank.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct RankedDart {
    rank: u32,
    /// Its position in the domain, y first.
    row_major: (i32, i32),
    x: i32,
    y: i32,
}

impl<const TAGS: bool> Region<TAGS> {
    /// Fills the gaps with keyed darts, except where the result depends on the plane beyond the frame.
    pub(crate) fn fill_uniformly<S: Simd>(&mut self, simd: S, rules: &Rules) {
        // The buffers are taken out of the region, which is read while they change.
        let mut gaps = std::mem::take(&mut self.gaps);
        gaps.inserted.clear();
        self.mark(&mut gaps, rules);

        // Unknown samples may fill open places around an unsure cell.
        for k in 0..self.unsure.len() {
            self.reach_around(self.unsure[k] as usize, rules.lost_reach);
        }
        let mut active = self.first_cells(simd, &mut gaps, rules);

        let process_key = gap_key(rules.key);
        // Cells of level 1 have sides of `GAP_SIDE`, half a radius.
        let mut level = 1;
        while !active.is_empty() {
            // From level 1 on a cell throws once, so that its throw is number 0.
            let key = throw_key(process_key, level, 0);
            self.throw(simd, &mut gaps, rules, key, &active, level);
            // The cells of the last level have one lattice point, and cannot be cut.
            if level == LAST_LEVEL {
                break;
            }
            active = self.quarters(rules, &active, R >> level);
            level += 1;
        }

        self.gaps = gaps;
    }

    /// Flags as reached the cells at most `reach` away from one, those of the padding too, which is wider.
    fn reach_around(&mut self, cell: usize, reach: i32) {
        let (column, row) = self.frame.column_row(cell);
        for row in row - reach..=row + reach {
            for column in column - reach..=column + reach {
                let cell = self.frame.cell(column, row);
                self.flags[cell] |= flag::REACHED;
            }
        }
    }

    /// Returns the active cells of the first level: at least all that hold places which lost samples left bare, except
    /// in reached cells. Those of the reached cells that may have an open place become hot.
    fn first_cells<S: Simd>(
        &mut self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
    ) -> Vec<Active> {
        let stamps = Stamps::get();
        let mut active = Vec::new();
        let mut unsure = Vec::new();

        self.list_marked(&gaps.marked, &mut gaps.listed);
        for &(cell, column, row) in &gaps.listed {
            let cell = cell as usize;
            let open = self.open_pixels(stamps, cell, column, row);
            if open == 0 {
                continue;
            }

            // Unknown samples may fill a reached cell: it is unsure if it has an open place. All samples that may cover
            // a place of it lie in cells that are at most `USUAL` away.
            if self.flags[cell] & flag::REACHED != 0 {
                gaps.near
                    .gather(&self.slots, self.frame.stride(), cell, USUAL);
                if gaps.near.any_open(simd, open) {
                    unsure.push(cell);
                }
            } else if rules.is_exact() {
                // A lost sample covered every uncovered place, so that open pixels of marked cells hold them all.
                for (x, y) in each_bit(open).map(corner) {
                    let low = [(column << CELL_BITS) + x, (row << CELL_BITS) + y];
                    self.cells_in(low, low.map(|v| v + PIXEL_SIDE), &mut active);
                }
            }
        }

        if !rules.is_exact() {
            // A pattern that misses lattice points has gaps of its own. The sequential engine fills them only in the
            // cells around lost samples, at most `SLACK` units beyond r, so that exactly these cells must be taken
            // here. Around samples of unknown fate cells are reached, and nothing is inserted in them.
            for lost in self.lost.iter().filter(|lost| lost.loss == Loss::Certain) {
                let reach = R + SLACK;
                let low = [lost.x - reach, lost.y - reach];
                let high = [lost.x + reach + 1, lost.y + reach + 1];
                self.cells_in(low, high, &mut active);
            }
        }

        for cell in unsure {
            self.make_hot(cell);
        }

        active.sort_unstable();
        active.dedup();
        // The darts of a cell that one sample covers would all be refused. Unsure cells leave with the next level, in
        // `quarters`: until then `throw` inserts nothing in them.
        active.retain(|a| !self.is_covered(a, GAP_SIDE));
        active
    }

    /// Appends the domain's cells of side [`GAP_SIDE`] that a rectangle of the frame touches, which ends before `high`.
    fn cells_in(&self, low: [i32; 2], high: [i32; 2], out: &mut Vec<Active>) {
        // Starts of the domain's cells along an axis: in the frame and in the domain.
        let starts = |axis: usize| {
            let (side, frame) = (self.frame.sides[axis], &self.frame);
            // A bounded domain has the places on its far border, too.
            let extent = if frame.periodic { side } else { side + 1 };

            let limit = high[axis].min(frame.end[axis]);
            let mut at = low[axis].max(0);

            std::iter::from_fn(move || {
                (at < limit).then(|| {
                    let in_plane = frame.origin[axis] + i64::from(at);
                    let in_domain = if frame.periodic {
                        in_plane.rem_euclid(side.into())
                    } else {
                        in_plane
                    } as i32;

                    let start_in_domain = in_domain / GAP_SIDE * GAP_SIDE;
                    let start = at - (in_domain - start_in_domain);
                    // The next cell follows. The last cell of the domain may be shorter.
                    at = start + GAP_SIDE.min(extent - start_in_domain);
                    (start, start_in_domain)
                })
            })
        };

        for (y, domain_y) in starts(1) {
            out.extend(starts(0).map(|(x, domain_x)| Active {
                y,
                x,
                domain_y,
                domain_x,
            }));
        }
    }

    /// Makes a level's throw: throws darts into the active cells, and inserts those that no sample covers, by rank.
    fn throw<S: Simd>(
        &mut self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        key: crate::random::Key,
        active: &[Active],
        level: u32,
    ) {
        let side = R >> level;
        let domain = rules.domain.rect();
        let mut darts = Vec::new();

        for cell in active {
            let min = Point::new(cell.domain_x, cell.domain_y);
            // One draw has 16 bits for each coordinate of a dart, which is enough: cells are at most half of R wide.
            for (rank, p) in cell_darts(key, Cell { min, side }, DartDraws::One) {
                let (x, y) = (cell.x + p.x - min.x, cell.y + p.y - min.y);
                // Darts that a sample covers now are refused in any turn, and need not be sorted. Cells at the far
                // ends reach beyond the domain.
                if domain.contains(p) && self.frame.holds(x, y) && !self.covered(simd, x, y) {
                    darts.push(RankedDart {
                        rank,
                        row_major: p.row_major(),
                        x,
                        y,
                    });
                }
            }
        }

        darts.sort_unstable();
        for RankedDart { x, y, .. } in darts {
            let cell = self.frame.cell_at(x, y);
            // Unsure cells are computed again, and reached ones have no open place if they are not unsure.
            if self.flags[cell] & (flag::REACHED | flag::UNSURE) != 0 || self.covered(simd, x, y) {
                continue;
            }

            // An unknown sample in this cell or beside it may be inserted before the dart, and cover it. The dart's
            // fate is then unknown, too.
            if self.flags[cell] & flag::HOT != 0 {
                self.make_hot(cell);
                continue;
            }

            // A level has one throw, which counts as the iteration of its number.
            self.insert(x, y, inserted_tag(level));
            gaps.inserted.push(Inserted {
                x,
                y,
                iteration: level,
            });
        }
    }

    /// Returns those quarters of the active cells, of `side` units, that may hold uncovered points and into which this
    /// region may insert.
    fn quarters(&self, rules: &Rules, active: &[Active], side: i32) -> Vec<Active> {
        let half = side / 2;
        let max = rules.domain.rect().max;
        let mut next = Vec::with_capacity(active.len());
        for cell in active {
            for (right, up) in [(0, 0), (half, 0), (0, half), (half, half)] {
                let quarter = Active {
                    x: cell.x + right,
                    y: cell.y + up,
                    domain_x: cell.domain_x + right,
                    domain_y: cell.domain_y + up,
                };
                // A cell at the upper border may reach beyond the domain with some of its quarters.
                let inside = quarter.domain_x < max.x && quarter.domain_y < max.y;
                if inside && !self.is_covered(&quarter, half) && !self.is_unsure(&quarter, half) {
                    next.push(quarter);
                }
            }
        }
        next
    }

    /// Returns whether all of a cell lies in unsure or reached cells, into which `throw` inserts nothing, or outside of
    /// the frame.
    fn is_unsure(&self, cell: &Active, side: i32) -> bool {
        // An active cell is smaller than a cell of the frame, so that its corners lie in all that it touches.
        let last = side - 1;
        [(0, 0), (last, 0), (0, last), (last, last)]
            .into_iter()
            .all(|(right, up)| {
                let (x, y) = (cell.x + right, cell.y + up);
                !self.frame.holds(x, y)
                    || self.flags[self.frame.cell_at(x, y)] & (flag::UNSURE | flag::REACHED) != 0
            })
    }

    /// Returns whether one survivor covers every point of a cell that lies in the domain.
    fn is_covered(&self, cell: &Active, side: i32) -> bool {
        // The last point of the cell in the domain, from its first one. A bounded domain includes its upper borders.
        let [width, height] = self.frame.sides;
        let closed = i32::from(!self.frame.periodic);
        let right = side.min(width + closed - cell.domain_x) - 1;
        let top = side.min(height + closed - cell.domain_y) - 1;

        let columns = (cell.x - R) >> CELL_BITS..=(cell.x + right + R) >> CELL_BITS;
        let rows = (cell.y - R) >> CELL_BITS..=(cell.y + top + R) >> CELL_BITS;
        rows.into_iter().any(|row| {
            columns.clone().any(|column| {
                // The last slot has the number of samples in the other three, inverted.
                let slots = &self.slots[self.frame.cell(column, row)];
                slots[..!slots[3] as usize & 3].iter().any(|&packed| {
                    // A sample covers all points if it covers the farthest one, which is a corner.
                    let p = unpack(packed, column, row);
                    let across = i64::from((cell.x - p.x).abs().max((cell.x + right - p.x).abs()));
                    let up = i64::from((cell.y - p.y).abs().max((cell.y + top - p.y).abs()));
                    across * across + up * up <= R_SQUARED
                })
            })
        })
    }
}
