//! The first judge's search for conflicts and the smallest distance, on a grid. A pair is compared with the radius in
//! `Pairs::add`. Distances go around the torus when periodic; each pair counts once, at its shortest. Crowded sets go
//! another way ([`sweep`]) to the same result. It does not use the triangulation, so that the two halves of the verdict
//! are independent.

mod sweep;

use std::ops::Range;

use glam::DVec2;

use rayon::prelude::*;

use serde::{Deserialize, Serialize};

use crate::domain::Domain;
use crate::error::VerifyError;
use crate::grid::{Entry, Grid};
use crate::monitor::Monitor;
use crate::witness::Conflict;
use crate::worst::Worst;

/// Cells per parallel task: enough to hide the scheduling, few enough for prompt cancellation.
const CHUNK: usize = 4096;

/// Runs of entries longer than this are narrowed by binary search before they are scanned.
const LONG_RUN: usize = 32;

/// The result of the search, in the domain's unit.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Pairs {
    pub conflicts: u64,
    pub worst: Worst<Conflict>,
    /// Infinite for a single sample in a bounded region.
    pub min_distance: f64,
}

impl Pairs {
    pub fn new(witnesses: usize) -> Self {
        Self {
            conflicts: 0,
            worst: Worst::new(witnesses),
            min_distance: f64::INFINITY,
        }
    }

    /// Records a pair: it is in conflict if its distance is below the radius.
    fn add(&mut self, [one, other]: [&Entry; 2], distance: f64, radius: f64) {
        if distance < radius {
            self.conflicts += 1;
            self.worst.push(Conflict {
                first: one.id.min(other.id) as usize,
                second: one.id.max(other.id) as usize,
                distance,
            });
        }
        self.min_distance = self.min_distance.min(distance);
    }

    pub fn merge(&mut self, other: Self) {
        self.conflicts += other.conflicts;
        self.worst.merge(other.worst);
        self.min_distance = self.min_distance.min(other.min_distance);
    }
}

/// The cell side for [`search`]: such that the closest pair of a large set is within one cell side (no packing has all
/// distances above 1.0746 spacings).
pub(crate) fn cell_side(domain: &Domain, count: usize) -> f64 {
    1.1 * domain.spacing(count)
}

/// Returns the pairs closer than `radius`, counted at least up to [`MAX_CONFLICTS`](crate::MAX_CONFLICTS), and the smallest
/// distance of all pairs. `points` are the samples of `grid`, whose cells are of [`cell_side`].
pub(crate) fn search(
    grid: &Grid,
    points: &[[f64; 2]],
    radius: f64,
    witnesses: usize,
    monitor: &Monitor<'_>,
) -> Result<Pairs, VerifyError> {
    // The scan looks into touching cells alone, so that cells must be as wide as the radius, and a little wider, since
    // rounding may move a sample into the next cell.
    let least_side = radius * (1.0 + 4.0 * Grid::ROUNDING);
    let coarse = (least_side > cell_side(&grid.domain, points.len()))
        .then(|| Grid::new(points, grid.domain, least_side));
    let scanned = coarse.as_ref().unwrap_or(grid);

    let mut pairs = if scanned.is_crowded() {
        // The scan compares all pairs of a cell; the sweep does not look at cells.
        sweep::search(grid, radius, witnesses, monitor)?
    } else {
        let mut pairs = scan(scanned, 0..scanned.cells[1], radius, witnesses, monitor)?;
        widen(scanned, points, &mut pairs, monitor)?;
        pairs
    };

    if grid.domain.periodic {
        add_own_copies(grid, radius, &mut pairs);
    }
    Ok(pairs)
}

/// Where the smallest distance exceeds a cell side, a closer pair may be in cells that do not touch:
/// repeats the search with larger cells until that is excluded.
fn widen(
    grid: &Grid,
    points: &[[f64; 2]],
    pairs: &mut Pairs,
    monitor: &Monitor<'_>,
) -> Result<(), VerifyError> {
    let mut side = certain_distance(grid);
    while pairs.min_distance > side {
        side *= 2.0;
        let coarse = Grid::new(points, grid.domain, side);
        // No work is added: the caller may only cancel here.
        monitor.advance(0)?;
        // Conflicts are all counted: only the smallest distance is sought, and the work is not counted twice.
        let (radius, witnesses) = (0.0, 0);
        let rows = 0..coarse.cells[1];
        let found = scan(&coarse, rows, radius, witnesses, &monitor.uncounted())?;
        pairs.min_distance = pairs.min_distance.min(found.min_distance);
        side = certain_distance(&coarse);
    }
    Ok(())
}

/// All pairs closer than this are in cells that touch, where the scan looks.
pub(crate) fn certain_distance(grid: &Grid) -> f64 {
    let sides = grid.cell_sides();
    // Along an axis of so few cells all of them touch, on a torus across the seam.
    let all_touch = if grid.domain.periodic { 3 } else { 2 };
    [0, 1]
        .into_iter()
        .filter(|&axis| grid.cells[axis] > all_touch)
        .map(|axis| sides[axis] * (1.0 - 2.0 * Grid::ROUNDING))
        .fold(f64::INFINITY, f64::min)
}

/// Records each sample with its own nearest copies in the repeated plane.
fn add_own_copies(grid: &Grid, radius: f64, pairs: &mut Pairs) {
    let period = grid.domain.extent.min_element();
    pairs.min_distance = pairs.min_distance.min(period);
    if period < radius {
        pairs.conflicts += grid.entries().len() as u64;
        for id in 0..grid.entries().len() {
            pairs.worst.push(Conflict {
                first: id,
                second: id,
                distance: period,
            });
        }
    }
}

/// Compares the samples within the cells of `rows`, and with those of the touching cells of higher index. Over all rows
/// of a region every pair of touching cells is compared once. `grid` must hold the row after each of `rows` and, if these
/// include the first row of a torus, also the last row.
pub(crate) fn scan(
    grid: &Grid,
    rows: Range<usize>,
    radius: f64,
    witnesses: usize,
    monitor: &Monitor<'_>,
) -> Result<Pairs, VerifyError> {
    let empty = || Scan::new(grid, radius, witnesses);
    let (first, end) = (rows.start * grid.cells[0], rows.end * grid.cells[0]);

    let scan = (0..(end - first).div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut scan = empty();
            let start = first + chunk * CHUNK;
            let work: usize = (start..end.min(start + CHUNK))
                .map(|cell| scan.cell(cell))
                .sum();
            monitor.advance(work as u64)?;
            Ok(scan)
        })
        // Chunks may be merged in any order: counts, the minimum and the worst pairs do not depend on it.
        .try_reduce(empty, |left, right| Ok(left.merge(right)))?;

    Ok(scan.pairs)
}

/// A stretch of entries sorted by x that may hold partners of a cell's samples.
struct Stretch {
    range: Range<usize>,
    /// How far the entries are moved along x to be on the side of the cell where they are closest; none
    /// where the region is so few cells wide that they may be closest on either side.
    shift: Option<f64>,
}

/// The scan of some cells, with the pairs that it found.
struct Scan<'a> {
    grid: &'a Grid,
    periods: DVec2,
    radius: f64,
    /// The radius, or the smallest distance so far if that is more: pairs farther apart along x may be skipped.
    reach: f64,
    /// Pairs with a larger squared distance change nothing.
    threshold: f64,
    pairs: Pairs,
}

impl<'a> Scan<'a> {
    fn new(grid: &'a Grid, radius: f64, witnesses: usize) -> Self {
        let pairs = Pairs::new(witnesses);
        let (periods, threshold) = (grid.domain.periods(), f64::INFINITY);
        let sides = grid.cell_sides();
        Self {
            grid,
            periods,
            radius,
            // Before the first pair, a side: closest pairs that are farther apart are left to `widen` in any case.
            reach: radius.max(sides.max_element()),
            threshold,
            pairs,
        }
    }

    fn merge(mut self, other: Self) -> Self {
        self.pairs.merge(other.pairs);
        self
    }

    /// Compares the samples within a cell, and with those of the touching cells of higher index; returns the number of
    /// samples in the cell.
    fn cell(&mut self, cell: usize) -> usize {
        let grid = self.grid;
        let (column, row) = (cell % grid.cells[0], cell / grid.cells[0]);
        let own = grid.run_range(row, &(column..column + 1));
        if own.is_empty() {
            return 0;
        }

        let mut stretches: [Option<Stretch>; 9] = Default::default();
        let used = self.stretches(column, row, &mut stretches);
        // In fewer than three columns a sample may be closer around the torus than straight on: no shift is right for all.
        let has_two_ways = grid.domain.periodic && grid.cells[0] < 3;

        for index in own.clone() {
            let entry = &grid.entries()[index];
            let rest = Stretch {
                // Samples before this one in the cell have been compared with it.
                range: index + 1..own.end,
                shift: (!has_two_ways).then_some(0.0),
            };
            self.compare(entry, &rest);
            for stretch in stretches[..used].iter().flatten() {
                self.compare(entry, stretch);
            }
        }
        own.len()
    }

    /// Writes the entries of the touching cells of higher index to `out`, each cell once, and returns how many stretches they
    /// are: at most one for each of the three by three cells around.
    fn stretches(&self, column: usize, row: usize, out: &mut [Option<Stretch>; 9]) -> usize {
        let [columns, rows] = self.grid.cells;
        let mut used = 0;
        let is_inside = column > 0 && column + 1 < columns && row > 0 && row + 1 < rows;
        if is_inside {
            // Away from the border, which is the common case, cells of a row make one stretch. Those to the left and below
            // have lower indices.
            let ahead = self.grid.run_range(row, &(column + 1..column + 2));
            let above = self.grid.run_range(row + 1, &(column - 1..column + 2));
            for range in [ahead, above] {
                let shift = Some(0.0);
                out[used] = Some(Stretch { range, shift });
                used += 1;
            }
            return used;
        }

        let (near_columns, near_rows) = (self.near(column, 0), self.near(row, 1));
        // Only the shift along x matters, by which stretches are sorted: `compare` finds the offset along y anew.
        for &(other_row, _) in near_rows.iter().flatten() {
            for &(other_column, shift) in near_columns.iter().flatten() {
                // A pair of cells is compared from the cell of lower index alone.
                if (other_row, other_column) > (row, column) {
                    let columns = other_column..other_column + 1;
                    let range = self.grid.run_range(other_row, &columns);
                    out[used] = Some(Stretch { range, shift });
                    used += 1;
                }
            }
        }
        used
    }

    /// Returns the cell indices along an axis that touch `index`, each once, with their shift as in [`Stretch`].
    /// `None` in place of such a pair stands for no cell: beyond a border, or where a torus has fewer than three.
    fn near(&self, index: usize, axis: usize) -> [Option<(usize, Option<f64>)>; 3] {
        let cells = self.grid.cells[axis];
        let period = self.grid.domain.extent[axis];
        let periodic = self.grid.domain.periodic;
        // In fewer than three cells around a torus, all cells touch, and a sample may be nearest on either side.
        if periodic && cells < 3 {
            return std::array::from_fn(|other| (other < cells).then_some((other, None)));
        }

        // Step 0 is the cell before, 1 the cell itself, 2 the cell behind. Beyond a border a torus goes on at its other
        // side.
        let neighbour = |step: usize| match (index + step).checked_sub(1) {
            None => periodic.then_some((cells - 1, -period)),
            Some(next) if next == cells => periodic.then_some((0, period)),
            Some(next) => Some((next, 0.0)),
        };
        [0, 1, 2].map(|step| neighbour(step).map(|(other, shift)| (other, Some(shift))))
    }

    /// Compares a sample with those of a stretch.
    fn compare(&mut self, entry: &Entry, stretch: &Stretch) {
        let entries = self.grid.entries();
        let mut run = &entries[stretch.range.clone()];
        if run.len() > LONG_RUN
            && let Some(shift) = stretch.shift
        {
            // Clustered samples can fill a cell: those too far off along x are skipped. The factor covers the rounding
            // of `along`, so that no pair within reach is lost.
            let reach = self.reach * (1.0 + 1e-9);
            let along = |other: &Entry| other.position.x + shift - entry.position.x;
            let start = run.partition_point(|other| along(other) < -reach);
            let end = run.partition_point(|other| along(other) <= reach);
            run = &run[start..end];
        }

        for other in run {
            let apart = offset(self.periods, entry, other);
            if apart.length_squared() <= self.threshold {
                self.pair(entry, other, apart);
            }
        }
    }

    /// Records a pair within the threshold. Such pairs are few once the closest ones are found.
    #[cold]
    fn pair(&mut self, entry: &Entry, other: &Entry, offset: DVec2) {
        let distance = length(offset);
        let closer = distance < self.pairs.min_distance;
        self.pairs.add([entry, other], distance, self.radius);
        if closer {
            // Pairs that are farther apart are neither conflicts nor the closest pair. The factor covers the rounding
            // of squares: a pair near the limit is still compared by its distance.
            let limit = distance.max(self.radius);
            self.reach = self.reach.min(limit);
            self.threshold = limit * limit * (1.0 + 1e-12);
        }
    }
}

/// The absolute offset of two samples, around the torus. The long way round is summed so that
/// its rounding is relative to the offset and not to the period.
#[inline]
fn offset(periods: DVec2, entry: &Entry, other: &Entry) -> DVec2 {
    let (low, high) = (
        entry.position.min(other.position),
        entry.position.max(other.position),
    );
    let direct = high - low;
    DVec2::select(
        (direct + direct).cmpgt(periods),
        (periods - high) + low,
        direct,
    )
}

/// The length of an offset.
fn length(offset: DVec2) -> f64 {
    let square = offset.length_squared();
    // The square root is correctly rounded, and hypot is not. But squares of tiny numbers lose bits, which hypot keeps.
    if square > 1e-280 {
        square.sqrt()
    } else {
        offset.x.hypot(offset.y)
    }
}

#[cfg(test)]
mod tests;
