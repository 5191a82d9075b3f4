//! Searches around samples on the verifier's grid: all samples within a distance, and the nearest one. Distances go
//! around the torus when periodic. Distances are at most half a period, so that only one copy of a sample is within
//! reach of another.

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

    /// Calls `see` with runs of samples such that over all cells every pair of samples within `distance` is met: once
    /// where the argument of `see` is true, and otherwise twice, from both sides, or with itself.
    pub fn partners(
        &self,
        [column, row]: [usize; 2],
        distance: f64,
        mut see: impl FnMut(&[Entry], bool),
    ) {
        let (grid, cells, sides) = (self.grid, self.grid.cells, self.grid.cell_sides());
        let reach =
            (sides.to_array()).map(|side| (distance / side + 2.0 * Grid::ROUNDING).ceil() as usize);
        let periodic = grid.domain.periodic;

        // Of two cells that reach each other both ways around the torus none is ahead.
        let [all_columns, all_rows] = [0, 1].map(|axis| 2 * reach[axis] + 1 >= cells[axis]);
        let columns = near(column, reach[0], cells[0], periodic);
        let rows = if all_rows {
            [0..cells[1], 0..0]
        } else {
            ahead(row, reach[1], cells[1], periodic)
        };
        for row in rows.into_iter().flatten() {
            for columns in &columns {
                see(grid.run(row, columns), !all_rows);
            }
        }
        // The cell's own row was among them.
        if all_rows {
            return;
        }

        if all_columns {
            see(grid.run(row, &(0..cells[0])), false);
        } else {
            see(grid.run(row, &(column..column + 1)), false);
            for columns in ahead(column, reach[0], cells[0], periodic) {
                see(grid.run(row, &columns), true);
            }
        }
    }

    /// The distance from a sample to the nearest other one. Rows are sorted by x: each is
    /// walked from the sample's x outwards, nearest rows first.
    pub fn nearest(&self, entry: &Entry) -> f64 {
        let (rows, side) = (self.grid.cells[1], self.grid.cell_sides()[1]);
        let domain = &self.grid.domain;
        let home = crate::grid::cell_at(domain, self.grid.cells, entry.position)[1];

        let mut best = f64::INFINITY;
        // Around a torus every row is within half of them.
        let most = if domain.periodic { rows / 2 } else { rows - 1 };
        for step in 0..=most {
            // Rows this far off are at least that much away.
            if (step as f64 - 1.0 - 2.0 * Grid::ROUNDING) * side > best.sqrt() {
                break;
            }

            let below = if domain.periodic {
                Some((home + rows - step) % rows)
            } else {
                home.checked_sub(step)
            };
            let above = if domain.periodic {
                Some((home + step) % rows)
            } else {
                Some(home + step).filter(|&row| row < rows)
            };
            // The home row, and the opposite one of an even number, are both.
            let above = above.filter(|_| above != below);
            for row in [below, above].into_iter().flatten() {
                best = best.min(self.nearest_in_row(entry, row, best));
            }
        }
        best.sqrt()
    }

    /// The smaller of a squared distance and that to the nearest other sample of a row.
    fn nearest_in_row(&self, entry: &Entry, row: usize, mut best: f64) -> f64 {
        let run = self.grid.run(row, &(0..self.grid.cells[0]));
        let x = entry.position.x;
        let start = run.partition_point(|other| other.position.x < x);
        let width = self.grid.domain.extent.x;

        let mut closer = |other: &Entry| {
            let direct = (other.position.x - x).abs();
            if other.id != entry.id {
                best = best.min(self.offset(entry, other).length_squared());
            }
            // Going on, differences grow until they are shorter the other way around, where
            // the walk from the other end finds them.
            direct * direct <= best
        };
        let _ = run[start..].iter().all(&mut closer);
        let _ = run[..start].iter().rev().all(&mut closer);

        if self.grid.domain.periodic {
            let mut across = |other: &Entry| {
                let around = width - (other.position.x - x).abs();
                if other.id != entry.id {
                    best = best.min(self.offset(entry, other).length_squared());
                }
                around * around <= best
            };
            let _ = run[..start].iter().all(&mut across);
            let _ = run[start..].iter().rev().all(&mut across);
        }
        best
    }
}

/// Cell indices within `reach` of one along an axis, each once, as at most two ranges.
fn near(index: usize, reach: usize, cells: usize, periodic: bool) -> [Range<usize>; 2] {
    let (below, above) = (index.checked_sub(reach), index + reach + 1);
    if 2 * reach + 1 >= cells {
        return [0..cells, 0..0];
    }
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
