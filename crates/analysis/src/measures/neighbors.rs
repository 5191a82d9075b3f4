//! Searches around samples on the verifier's grid: all samples within a distance, and the nearest one. Distances go
//! around the torus when periodic. A given distance is at most half a period, so that only one copy of a sample is
//! within it of another. The nearest sample may be farther: its distance is that of its nearest copy.

use std::ops::Range;

use glam::DVec2;

use crate::grid::{Entry, Grid};

/// The samples around those of a grid.
pub(super) struct Neighbors<'a> {
    pub grid: &'a Grid,
}

impl Neighbors<'_> {
    /// Magnitudes of the coordinate differences of two samples, the short way around.
    pub fn offset(&self, a: &Entry, b: &Entry) -> DVec2 {
        let direct = (a.position - b.position).abs();
        if self.grid.domain.periodic {
            direct.min(self.grid.domain.extent - direct)
        } else {
            direct
        }
    }

    /// Calls `see` with runs of samples, by their indices in the grid, that may be within `distance` of those of a
    /// cell. Over all cells every such pair is met: once where the second argument of `see` is true. Where it is false,
    /// a pair is met twice, from both of its samples, and a sample also meets itself.
    pub fn partners(
        &self,
        [column, row]: [usize; 2],
        distance: f64,
        mut see: impl FnMut(Range<usize>, bool),
    ) {
        let (once, twice) = (true, false);
        let (grid, cells, sides) = (self.grid, self.grid.cells, self.grid.cell_sides());
        // Rounding may have moved each of two samples into the next cell.
        let reach =
            (sides.to_array()).map(|side| (distance / side + 2.0 * Grid::ROUNDING).ceil() as usize);
        let periodic = grid.domain.periodic;

        // A pair of cells is met once, from the cell that has the other one ahead: in one of the next rows, or in the
        // same row among the next columns. On a torus, rows ahead go on across the seam. If it has few rows, each of
        // two rows is ahead of the other: then all rows are looked at, and each pair is met twice. If it has few
        // columns, the same is done within the cell's own row. A bounded domain of few rows or columns needs no
        // exception, but is rare and is treated like a torus.
        let [all_columns, all_rows] = [0, 1].map(|axis| 2 * reach[axis] + 1 >= cells[axis]);
        let columns = near(column, reach[0], cells[0], periodic);
        let rows = if all_rows {
            [0..cells[1], 0..0]
        } else {
            ahead(row, reach[1], cells[1], periodic)
        };
        for row in rows.into_iter().flatten() {
            for columns in &columns {
                see(
                    grid.run_range(row, columns),
                    if all_rows { twice } else { once },
                );
            }
        }

        // All rows, the cell's own among them, have been looked at.
        if all_rows {
            return;
        }

        if all_columns {
            see(grid.run_range(row, &(0..cells[0])), twice);
        } else {
            see(grid.run_range(row, &(column..column + 1)), twice);
            for columns in ahead(column, reach[0], cells[0], periodic) {
                see(grid.run_range(row, &columns), once);
            }
        }
    }

    /// Returns the distance from a sample to the nearest other one, infinite if there is none. The search goes through
    /// rows of cells, the nearest rows first.
    pub fn nearest(&self, entry: &Entry) -> f64 {
        let (rows, side) = (self.grid.cells[1], self.grid.cell_sides()[1]);
        let domain = &self.grid.domain;
        let [column, home] = crate::grid::cell_at(domain, self.grid.cells, entry.position);

        let mut least_square = f64::INFINITY;
        // Around a torus every row is within half of them.
        let farthest = if domain.periodic { rows / 2 } else { rows - 1 };
        for step in 0..=farthest {
            // A sample in a row `step` rows away is at least `step - 1` sides away, less some rounding.
            if (step as f64 - 1.0 - 2.0 * Grid::ROUNDING) * side > least_square.sqrt() {
                break;
            }

            let row_below = if domain.periodic {
                Some((home + rows - step) % rows)
            } else {
                home.checked_sub(step)
            };
            let row_above = if domain.periodic {
                Some((home + step) % rows)
            } else {
                Some(home + step).filter(|&row| row < rows)
            };

            // Below and above are one row at step 0 and, of an even number of rows on a torus, at the last step.
            let other_row = row_above.filter(|_| row_above != row_below);
            for row in [row_below, other_row].into_iter().flatten() {
                least_square = self.nearest_in_row(entry, [column, row], least_square);
            }
        }
        least_square.sqrt()
    }

    /// Returns the smaller of a squared distance and that to the nearest other sample of a row. The row is sorted by x, and
    /// is walked from the sample's x outwards. `column` is that of the sample.
    fn nearest_in_row(
        &self,
        entry: &Entry,
        [column, row]: [usize; 2],
        mut least_square: f64,
    ) -> f64 {
        let whole = self.grid.run_range(row, &(0..self.grid.cells[0]));
        let (run, x) = (&self.grid.entries()[whole.clone()], entry.position.x);

        // A sample of an earlier column lies before the sample's x and one of a later column behind it, as no column falls when x
        // rises. So the place where the walks begin is in the sample's own column.
        let own = self.grid.run_range(row, &(column..column + 1));
        let before = self.grid.entries()[own.clone()].partition_point(|other| other.position.x < x);
        let start = own.start - whole.start + before;
        let width = self.grid.domain.extent.x;

        // Compares with one more sample, and returns whether a farther one along x may still be nearer: otherwise `all`
        // ends the walk.
        let mut step = |other: &Entry| {
            let direct = (other.position.x - x).abs();
            if other.id != entry.id {
                least_square = least_square.min(self.offset(entry, other).length_squared());
            }
            // Differences along x grow on the way. Samples that are nearer around the torus are met by the walks across
            // the seam.
            direct * direct <= least_square
        };
        let _ = run[start..].iter().all(&mut step);
        let _ = run[..start].iter().rev().all(&mut step);

        if self.grid.domain.periodic {
            let mut step_across_seam = |other: &Entry| {
                let around = width - (other.position.x - x).abs();
                if other.id != entry.id {
                    least_square = least_square.min(self.offset(entry, other).length_squared());
                }
                around * around <= least_square
            };
            let _ = run[..start].iter().all(&mut step_across_seam);
            let _ = run[start..].iter().rev().all(&mut step_across_seam);
        }
        least_square
    }
}

/// Cell indices within `reach` of one along an axis, each once, as at most two ranges. If the axis has no more than
/// `2 reach + 1` cells, these are all of its cells, also in a bounded domain.
fn near(index: usize, reach: usize, cells: usize, periodic: bool) -> [Range<usize>; 2] {
    let (below, above) = (index.checked_sub(reach), index + reach + 1);
    if 2 * reach + 1 >= cells {
        return [0..cells, 0..0];
    }
    // On a torus the cells beyond one end are those at the other end.
    match below {
        None if periodic => [0..above, index + cells - reach..cells],
        Some(below) if periodic && above > cells => [0..above - cells, below..cells],
        _ => [below.unwrap_or(0)..above.min(cells), 0..0],
    }
}

/// Cell indices up to `reach` beyond one along an axis, as at most two ranges.
fn ahead(index: usize, reach: usize, cells: usize, periodic: bool) -> [Range<usize>; 2] {
    let end = index + reach + 1;
    if periodic && end > cells {
        [index + 1..cells, 0..end - cells]
    } else {
        [index + 1..end.min(cells), 0..0]
    }
}
