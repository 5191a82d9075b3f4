//! Some cells of the region with those around them, as coordinates in one frame: copies across the seams lie beyond
//! them. Its scan of pairs finds the conflicts, exactly, and proves most circles covered; the others are left to
//! [`super::search`].
//!
//! A sample's *circle* is the border of its disk: a set is maximal if the other disks cover all circles within the
//! region. A circle is cut into *bins*, and a *mask* has a bit for each bin that is covered. A *table*
//! ([`super::table`]) gives the mask of a neighbour's disk by its offset, of which it asks only in which small *square*
//! it lies.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x8};
use glam::DVec2;

use super::found::{Declined, Found};
use super::sample::Sample;
use super::samples::{Cells, Samples};
use super::table::{
    FULL, Mask, PER_RADIUS, Square, Table, UNCERTAIN, WIDEST, opposite, squares_of,
};

/// Samples whose offsets are computed at once.
const LANES: usize = 8;

/// Most pairs of samples in one cell, per sample of a tile, each sample paired with itself, too. A maximal set has about two.
const MAX_CROWD: usize = 16;

/// A rectangle of cells, counted on across the seams.
#[derive(Clone, Debug)]
pub(super) struct Rectangle {
    pub columns: Range<i64>,
    pub rows: Range<i64>,
}

/// The samples of a rectangle of cells and of the cells around it. It is filled again for each rectangle.
#[derive(Debug, Default)]
pub(super) struct Tile {
    /// Cells with the halo.
    size: [usize; 2],
    /// The cells without it, counted from the lowest of the halo.
    own: [Range<usize>; 2],
    /// The lowest corner of the halo.
    low: DVec2,
    /// Cells in a unit of length.
    per_unit: DVec2,
    /// The first sample of each cell, row by row, and the end.
    starts: Vec<u32>,
    /// The position of each sample; that of a copy lies beyond the seam.
    positions: Vec<DVec2>,
    /// The place of each sample, or of the one it copies, in the sequence of all cells.
    pub source: Vec<u32>,
    scan: Scan,
}

/// The buffers of the scan of pairs.
#[derive(Debug, Default)]
struct Scan {
    /// Positions from the corner of the tile, in squares of the table.
    x: Vec<f32>,
    y: Vec<f32>,
    /// What the samples around it cover of each circle.
    masks: Vec<Mask>,
    /// The tile's own samples whose circles were not proven covered.
    open: Vec<u32>,
}

/// Pairs of neighbours that are not yet marked. One loop marks the pairs of several samples, since the end of each loop
/// costs a mispredicted branch.
#[derive(Default)]
struct Unmarked {
    groups: [Group; GROUPS],
    /// How many groups are held.
    count: usize,
    /// The lanes of all groups that hold a neighbour.
    hits: u64,
}

/// One sample, and consecutive samples that may be its neighbours.
#[derive(Clone, Copy, Default)]
struct Group {
    sample: u32,
    /// The first of the others.
    start: u32,
    /// The squares of the table that hold their offsets.
    squares: [Square; LANES],
}

/// This many groups have all of their lanes in 64 bits.
const GROUPS: usize = 64 / LANES;

impl Unmarked {
    /// Adds a group: a sample, and those from `start` on, one a lane. Lanes with a bit in `hits` hold its neighbours.
    /// There is room until [`Self::is_full`].
    #[inline]
    fn add(&mut self, sample: usize, start: usize, squares: [Square; LANES], hits: u64) {
        let place = self.count % GROUPS;
        self.groups[place] = Group {
            sample: sample as u32,
            start: start as u32,
            squares,
        };
        self.hits |= hits << (place * LANES);
        self.count += 1;
    }

    const fn is_full(&self) -> bool {
        self.count == GROUPS
    }

    /// Marks in both circles of each pair what the other disk covers. Afterwards no pairs are held.
    #[inline]
    fn mark(&mut self, table: &Table, masks: &mut [Mask]) {
        while self.hits != 0 {
            let place = self.hits.trailing_zeros() as usize;
            // This clears the lowest bit that is set.
            self.hits &= self.hits - 1;

            let (group, lane) = (&self.groups[place / LANES], place % LANES);
            let covered = table.mask(group.squares[lane]);
            masks[group.sample as usize] |= covered;
            // Seen from the other sample, the disk lies in the opposite direction.
            masks[group.start as usize + lane] |= opposite(covered);
        }
        self.count = 0;
    }
}

/// Why a tile could not be filled.
pub(super) enum Unfilled {
    /// It needs rows that are not held.
    Rows,
    Declined(Declined),
}

impl Tile {
    /// Fills the tile with the samples of a rectangle and of `halo` cells around it.
    pub fn fill(
        &mut self,
        samples: &Samples<'_>,
        rectangle: &Rectangle,
        halo: [usize; 2],
    ) -> Result<(), Unfilled> {
        let cells = &samples.cells;
        let axes = [&rectangle.columns, &rectangle.rows];
        let spans = [0, 1].map(|axis| {
            let (range, halo) = (axes[axis], halo[axis] as i64);
            let span = range.start - halo..range.end + halo;
            if cells.domain.periodic {
                span
            } else {
                // Beyond the border of a bounded region there are no cells.
                span.start.max(0)..span.end.min(cells.counts[axis] as i64)
            }
        });
        for axis in [0, 1] {
            let (own, span) = (axes[axis], &spans[axis]);
            self.size[axis] = (span.end - span.start) as usize;
            self.own[axis] = (own.start - span.start) as usize..(own.end - span.start) as usize;
        }

        let [columns, rows] = spans;
        if !rows.clone().all(|row| samples.holds(row)) {
            return Err(Unfilled::Rows);
        }

        self.per_unit = cells.per_unit;
        self.low = DVec2::new(columns.start as f64, rows.start as f64) * cells.sides;
        let runs_of_row = runs(cells, &columns);
        self.clear();
        // Pairs in one cell, each twice, and each sample with itself: they tell how long the scan of pairs will take.
        let mut crowd = 0;
        for row in rows {
            let period = row.div_euclid(cells.counts[1] as i64);
            let up = period as f64 * cells.domain.extent.y;
            for run in &runs_of_row {
                // Ranks among all samples held; they become indices in this tile below.
                let starts = samples.starts(row, run.columns.clone());
                let (first, end) = (starts[0], starts[starts.len() - 1]);

                let before = self.positions.len() as u32;
                for bounds in starts.windows(2) {
                    self.starts.push(before + bounds[0] - first);
                    let count = (bounds[1] - bounds[0]) as usize;
                    crowd += count * count;
                }

                let shift = DVec2::new(run.shift, up);
                let ranks = first as usize..end as usize;
                samples.append_positions(ranks, shift, &mut self.positions);
                self.source.extend(first..end);
            }
        }
        self.starts.push(self.positions.len() as u32);

        // The time of the scan is quadratic in the samples of a cell. The 256 (chosen, not measured) let small tiles have a
        // crowded cell or two.
        if crowd > MAX_CROWD * (256 + self.positions.len()) {
            return Err(Unfilled::Declined(Declined::Crowded));
        }
        Ok(())
    }

    fn clear(&mut self) {
        self.starts.clear();
        self.positions.clear();
        self.source.clear();
    }

    /// The samples of the tile's own cells, in runs of a row each.
    pub fn own(&self) -> impl Iterator<Item = Range<usize>> + use<'_> {
        let [columns, rows] = self.own.clone();
        rows.map(move |row| self.cell(columns.clone(), row))
    }

    /// The column and the row of a sample, but for rounding at borders, which the slack of cells pays for.
    fn cell_of(&self, index: usize) -> [usize; 2] {
        let at = ((self.position(index) - self.low) * self.per_unit).max(DVec2::ZERO);
        [
            (at.x as usize).min(self.size[0] - 1),
            (at.y as usize).min(self.size[1] - 1),
        ]
    }

    /// The tile's own samples whose circles the scan did not prove covered.
    pub fn open(&self) -> impl ExactSizeIterator<Item = usize> + use<'_> {
        self.scan.open.iter().map(|&index| index as usize)
    }

    /// What the scan proved covered of a sample's circle.
    pub fn mask(&self, index: usize) -> Mask {
        self.scan.masks[index]
    }

    pub fn position(&self, index: usize) -> DVec2 {
        self.positions[index]
    }

    /// The samples of some cells of a row.
    fn cell(&self, columns: Range<usize>, row: usize) -> Range<usize> {
        let line = row * self.size[0];
        self.starts[line + columns.start] as usize..self.starts[line + columns.end] as usize
    }

    /// Calls `each` with every other sample of the cells around a sample's, and its offset.
    pub fn around(&self, index: usize, reach: [usize; 2], mut each: impl FnMut(usize, DVec2)) {
        let [column, row] = self.cell_of(index);
        let columns = column.saturating_sub(reach[0])..(column + reach[0] + 1).min(self.size[0]);
        let rows = row.saturating_sub(reach[1])..(row + reach[1] + 1).min(self.size[1]);
        let position = self.position(index);
        for row in rows {
            for other in self.cell(columns.clone(), row) {
                if other != index {
                    each(other, self.position(other) - position);
                }
            }
        }
    }

    /// Scans all pairs of neighbours once: marks in both circles the bins that the other disk covers, and counts the
    /// conflicts of the tile's own samples. Circles and disks have the radius `rho`: that of the largest empty circle
    /// found so far, up to the limit of covering. Samples nearer than `radius`, that of the set, are in conflict.
    ///
    /// A pair belongs to the tile of the sample that comes first in the sequence of rows and columns, counted on across
    /// the seams, so it is counted in one tile.
    pub fn scan(&mut self, samples: &Samples<'_>, rho: f64, radius: f64, found: &mut Found) {
        let per_unit = PER_RADIUS / rho;
        // From the tile's corner, as 32 bits would round places of a large region too much.
        let in_squares = |out: &mut Vec<f32>, axis: usize| {
            let at = |position: &DVec2| ((position[axis] - self.low[axis]) * per_unit) as f32;
            out.clear();
            out.extend(self.positions.iter().map(at));
            // The last group of lanes may read beyond the last position, so that there must be room.
            out.resize(self.positions.len() + LANES, 0.0);
        };

        let mut scan = std::mem::take(&mut self.scan);
        in_squares(&mut scan.x, 0);
        in_squares(&mut scan.y, 1);
        scan.masks.clear();
        scan.masks.resize(self.positions.len(), 0);
        scan.open.clear();

        dispatch!(Level::new(), simd => self.scan_cells(simd, &mut scan, |pair, scan_found: &mut Found| {
            self.pair(samples, pair, radius, scan_found);
        }, samples.cells.reach, per_unit * per_unit, found));
        self.scan = scan;
    }

    /// Scans the pairs of all rows: marks the bins that they cover, lists the samples whose circles stay open, and calls `pair`
    /// for pairs that may be in conflict or the closest. `squares_per_area` is how many of the table's squares make a
    /// unit of area.
    #[expect(
        clippy::inline_always,
        reason = "it must become a part of what dispatch! compiles for the processor"
    )]
    #[inline(always)]
    fn scan_cells<S: Simd>(
        &self,
        simd: S,
        scan: &mut Scan,
        pair: impl Fn([usize; 2], &mut Found),
        reach: [usize; 2],
        squares_per_area: f64,
        found: &mut Found,
    ) {
        let table = Table::get();
        let (xs, ys, masks) = (&scan.x[..], &scan.y[..], &mut scan.masks[..]);
        // The squared distance up to which a pair is a conflict or may be the closest.
        let mut nearby = in_squares_at_most(found.nearby, squares_per_area);
        let (mut runs, mut unmarked) = (Vec::new(), Unmarked::default());

        // Rows above the tile's own are left out: their pairs with its samples were met from below.
        for row in 0..self.own[1].end {
            for column in 0..self.size[0] {
                let cell = self.cell(column..column + 1, row);
                if cell.is_empty() {
                    continue;
                }

                let is_own = self.own[1].contains(&row) && self.own[0].contains(&column);
                self.runs_ahead([column, row], reach, &mut runs);
                for index in cell {
                    // The first run is the rest of the row behind this sample: those before it were compared with it.
                    runs[0].start = index + 1;
                    let lanes = |value: f32| f32x8::splat(simd, value);
                    let (x, y) = (lanes(xs[index]), lanes(ys[index]));
                    // A pair counts in the tile that owns its first sample. For a sample of the halo, no pair counts
                    // here: no squared distance is as low as -1.
                    let near = if is_own { lanes(nearby) } else { lanes(-1.0) };

                    for run in &runs {
                        for start in run.clone().step_by(LANES) {
                            let dx = f32x8::from_slice(simd, &xs[start..start + LANES]) - x;
                            let dy = f32x8::from_slice(simd, &ys[start..start + LANES]) - y;
                            let distance_square = dx * dx + dy * dy;

                            // Lanes beyond the run hold samples of other cells or zeros.
                            let count = (run.end - start).min(LANES);
                            let within = (1_u64 << count) - 1;
                            let hits = distance_square.simd_lt(lanes(WIDEST)).to_bitmask() & within;
                            let close = distance_square.simd_le(near).to_bitmask() & within;
                            let squares = squares_of(simd, dx, dy).into();
                            unmarked.add(index, start, squares, hits);
                            if unmarked.is_full() {
                                unmarked.mark(table, masks);
                            }

                            if close != 0 {
                                for lane in (0..count).filter(|lane| close >> lane & 1 == 1) {
                                    pair([index, start + lane], found);
                                }
                                // A closer pair lowers the distance up to which pairs matter.
                                nearby = in_squares_at_most(found.nearby, squares_per_area);
                            }
                        }
                    }
                }
            }
            unmarked.mark(table, masks);

            // No later row marks circles of this row: circles that are not full by now stay open.
            if self.own[1].contains(&row) {
                let own = self.cell(self.own[0].clone(), row);
                let open = own.filter(|&index| masks[index] != FULL);
                scan.open.extend(open.map(|index| index as u32));
            }
        }
    }

    /// Puts into `runs` the samples that may be neighbours of those of a cell and come after them: one run of the same
    /// row, whose start the caller sets anew for each sample of the cell, and one of each row above.
    #[inline]
    fn runs_ahead(
        &self,
        [column, row]: [usize; 2],
        reach: [usize; 2],
        runs: &mut Vec<Range<usize>>,
    ) {
        let [width, height] = self.size;
        let ahead = (column + reach[0] + 1).min(width);
        let columns = column.saturating_sub(reach[0])..ahead;
        let same_row = self.cell(column..ahead, row).end;
        let above = row + 1..(row + reach[1] + 1).min(height);

        runs.clear();
        // The start 0 is a placeholder: the caller begins this run after the sample that is compared.
        runs.push(0..same_row);
        runs.extend(above.map(|row| self.cell(columns.clone(), row)));
    }

    /// Records a pair with the distance of its two samples, the shorter way around a torus. The tile may hold other
    /// copies of them.
    #[cold]
    fn pair(&self, samples: &Samples<'_>, pair: [usize; 2], radius: f64, found: &mut Found) {
        let [one, other] = pair.map(|index| samples.at(self.source[index] as usize));
        // A sample near a seam meets its own copy.
        if one.id == other.id {
            return;
        }

        // In a narrow torus a sample meets several copies of another sample. Only the copy along the shorter way
        // counts.
        let periods = samples.cells.domain.periods();
        let is_shorter_way = (0..2).all(|axis| {
            let between = other.position[axis] - one.position[axis];
            let shown = self.position(pair[1])[axis] - self.position(pair[0])[axis];
            // By how many periods the copy along the shorter way is moved.
            let shortest = if 2.0 * between.abs() > periods[axis] {
                -between.signum()
            } else {
                0.0
            };
            // Without a period there are no copies.
            periods[axis].is_infinite() || ((shown - between) / periods[axis]).round() == shortest
        });
        if is_shorter_way {
            found.add_pair(one, other, distance(one, other, periods), radius);
        }
    }
}

/// Returns a squared length, rounded up, in units of the table's squares, of which `squares_per_area` make a unit of
/// area. Rounding moves an offset along both axes.
fn in_squares_at_most(length_square: f64, squares_per_area: f64) -> f32 {
    let farthest = (length_square * squares_per_area).sqrt() + 2.0 * UNCERTAIN;
    (farthest * farthest).min(f64::from(f32::MAX)) as f32
}

/// Returns the distance of two samples, the shorter way around a torus. Across a seam the parts on both sides of it are
/// summed, so that the rounding is relative to the offset and not to the period.
pub(super) fn distance(one: Sample, other: Sample, periods: DVec2) -> f64 {
    let along = |axis: usize| {
        let (a, b) = (one.position[axis], other.position[axis]);
        let (low, high) = (a.min(b), a.max(b));
        let direct = high - low;
        if 2.0 * direct > periods[axis] {
            (periods[axis] - high) + low
        } else {
            direct
        }
    };

    let (x, y) = (along(0), along(1));
    let square = x * x + y * y;
    // Squares near 1e-308, the least number with all digits, lose some; `hypot` does not square.
    if square > 1e-280 {
        square.sqrt()
    } else {
        x.hypot(y)
    }
}

/// Columns of a tile that lie side by side in the region.
struct Run {
    /// The columns in the region.
    columns: Range<usize>,
    /// How far the samples are moved.
    shift: f64,
}

/// Returns columns, counted on across the seams, as runs of columns of the region.
fn runs(cells: &Cells, columns: &Range<i64>) -> Vec<Run> {
    let count = cells.counts[0] as i64;
    let mut runs = Vec::new();
    let mut next = columns.start;
    while next < columns.end {
        let (period, first) = (next.div_euclid(count), next.rem_euclid(count));
        // The run ends at a seam, if the columns do not end before it.
        let end = columns.end.min(next - first + count);
        runs.push(Run {
            columns: first as usize..(first + end - next) as usize,
            shift: period as f64 * cells.domain.extent.x,
        });
        next = end;
    }
    runs
}
