//! A compact grid for conflict-free sets: cells of one radius with a few packed slots. It answers coverage queries for
//! the dart process and the pattern check. Samples have no ids here; for those see [`crate::SampleGrid`].

use glam::IVec2;

use crate::grid::spans;
use crate::lattice::{Domain, Point, R, R_SQUARED, covers_offset};

/// Samples in one cell. Of four points some three form an angle of at least 90 degrees; were all
/// farther than R apart, its far side would exceed sqrt 2 R, the diagonal of a cell. So a cell of a
/// conflict-free set holds at most three; the fourth slot keeps cells aligned.
const SLOTS: usize = 4;
const EMPTY: u32 = u32::MAX;
const LOW_BITS: i32 = R - 1;
const CELL_BITS: u32 = R.ilog2();

/// A conflict-free set of samples that grows.
#[derive(Clone)]
pub struct DiskGrid {
    domain: Domain,
    columns: usize,
    cells: Vec<[u32; SLOTS]>,
}

/// A square of lattice points, `side` units wide, that starts at `min`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Cell {
    /// The lowest point inside.
    pub min: Point,
    /// Units along each side: a power of two.
    pub side: i32,
}

impl DiskGrid {
    /// Returns an empty grid over `domain`.
    #[must_use]
    pub fn new(domain: Domain) -> Self {
        let rect = domain.rect();
        let columns = ((rect.max.x - 1) / R + 1) as usize;
        let rows = ((rect.max.y - 1) / R + 1) as usize;
        Self {
            domain,
            columns,
            cells: vec![[EMPTY; SLOTS]; columns * rows],
        }
    }

    /// Returns the domain.
    #[must_use]
    pub const fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Adds a sample of the domain; returns `false`, and adds nothing, when its cell is full, which only happens
    /// in a set that is not conflict-free.
    #[must_use]
    pub fn insert(&mut self, p: Point) -> bool {
        let cell = (p.y / R) as usize * self.columns + (p.x / R) as usize;
        let packed = (((p.y & LOW_BITS) << 15) | (p.x & LOW_BITS)) as u32;
        let free = self.cells[cell].iter_mut().find(|slot| **slot == EMPTY);
        free.map(|slot| *slot = packed).is_some()
    }

    /// Calls `visit` with the offset (the shortest way around) from `from` of every sample in the
    /// cells that touch `[from - below, from + above]` on both axes, until it returns `true`.
    #[inline]
    fn any_near(
        &self,
        from: Point,
        below: i32,
        above: i32,
        mut visit: impl FnMut(IVec2) -> bool,
    ) -> bool {
        let extent = self.domain.rect().max;
        let (left, right) = (from.x - below, from.x + above);
        let (bottom, top) = (from.y - below, from.y + above);
        if left >= 0 && bottom >= 0 && right < extent.x && top < extent.y {
            // Away from the border, which is nearly always: nothing wraps.
            let columns = left >> CELL_BITS..=right >> CELL_BITS;
            for row in bottom >> CELL_BITS..=top >> CELL_BITS {
                let start = row as usize * self.columns;
                let range = start + *columns.start() as usize..=start + *columns.end() as usize;
                for (slots, column) in self.cells[range].iter().zip(columns.clone()) {
                    for p in unpack(slots, column, row) {
                        if visit(p - from) {
                            return true;
                        }
                    }
                }
            }
            return false;
        }
        // spans() takes a centre and a reach; an odd width is rounded outwards.
        let reach = (below + above + 1) / 2;
        let shift = reach - below;
        let periodic = self.domain.is_periodic();
        let (rows, row_spans) = spans(from.y + shift, reach, extent.y, periodic);
        let (columns, column_spans) = spans(from.x + shift, reach, extent.x, periodic);
        for row in rows[..row_spans].iter().flat_map(|&(a, b)| a..=b) {
            for column in columns[..column_spans].iter().flat_map(|&(a, b)| a..=b) {
                let slots = &self.cells[row as usize * self.columns + column as usize];
                for p in unpack(slots, column, row) {
                    if visit(self.domain.difference(from, p)) {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// Returns whether any sample covers `point`, which must lie in the domain.
    #[inline]
    #[must_use]
    pub fn covers(&self, point: Point) -> bool {
        // The point's own cell nearly always answers when it holds a sample.
        let (column, row) = (point.x >> CELL_BITS, point.y >> CELL_BITS);
        let slots = &self.cells[row as usize * self.columns + column as usize];
        unpack(slots, column, row).any(|p| covers_offset(p - point))
            || self.any_near(point, R, R, covers_offset)
    }

    /// Appends to `out` the quarters of `cell` that hold points of the domain and are not covered
    /// by a single sample.
    pub fn uncovered_quarters(&self, cell: Cell, near: &mut Vec<IVec2>, out: &mut Vec<Point>) {
        near.clear();
        self.any_near(cell.min, R, cell.side - 1 + R, |offset| {
            near.push(offset);
            false
        });
        let half = cell.side / 2;
        let max = self.domain.rect().max;
        for (right, up) in [(0, 0), (half, 0), (0, half), (half, half)] {
            let min = Point::new(cell.min.x + right, cell.min.y + up);
            if min.x >= max.x || min.y >= max.y {
                continue;
            }
            let extent = IVec2::splat(half).min(max - min) - 1;
            let corner = IVec2::new(right, up);
            let covered = near
                .iter()
                .any(|&offset| farthest_squared(offset - corner, extent) <= R_SQUARED);
            if !covered {
                out.push(min);
            }
        }
    }

    /// Returns whether one sample covers every domain point of `cell`, counting distances up to
    /// the root of `R^2 + slack`.
    #[must_use]
    pub fn covers_cell(&self, cell: Cell, slack: i64) -> bool {
        let max = self.domain.rect().max;
        let extent = IVec2::splat(cell.side).min(max - cell.min) - 1;
        // One unit more than R where the slack lets disks grow beyond it.
        let reach = R + i32::from(slack > 0);
        self.any_near(cell.min, reach, cell.side - 1 + reach, |offset| {
            farthest_squared(offset, extent) <= R_SQUARED + slack
        })
    }

    /// Returns a lattice point of the domain that no sample covers, counting distances up to the
    /// root of `R^2 + slack`, or `None`: an exact proof that the set is maximal on the lattice.
    #[must_use]
    pub fn uncovered_point(&self, slack: i64) -> Option<Point> {
        let mut stack = tiling_cells(&self.domain, R / 2);
        while let Some(cell) = stack.pop() {
            if self.covers_cell(cell, slack) {
                continue;
            }
            if cell.side == 1 {
                return Some(cell.min);
            }
            let half = cell.side / 2;
            for (right, up) in [(0, 0), (half, 0), (0, half), (half, half)] {
                let min = Point::new(cell.min.x + right, cell.min.y + up);
                if self.domain.rect().contains(min) {
                    stack.push(Cell { min, side: half });
                }
            }
        }
        None
    }
}

/// Returns the positions packed in a cell's slots.
#[inline]
fn unpack(slots: &[u32; SLOTS], column: i32, row: i32) -> impl Iterator<Item = Point> {
    slots
        .iter()
        .take_while(|&&packed| packed != EMPTY)
        .map(move |&packed| {
            let (x, y) = (packed as i32 & LOW_BITS, (packed >> CELL_BITS) as i32);
            Point::new((column << CELL_BITS) | x, (row << CELL_BITS) | y)
        })
}

/// Returns the cells of `side` units that tile the domain, row by row.
#[must_use]
pub fn tiling_cells(domain: &Domain, side: i32) -> Vec<Cell> {
    let max = domain.rect().max;
    let starts = |extent: i32| (0..=(extent - 1) / side).map(move |k| k * side);
    starts(max.y)
        .flat_map(|y| {
            starts(max.x).map(move |x| Cell {
                min: Point::new(x, y),
                side,
            })
        })
        .collect()
}

/// Returns the squared distance from a sample at `offset` from a rectangle's lowest point to the
/// farthest lattice point of the rectangle, which ends at `extent`.
#[inline]
fn farthest_squared(offset: IVec2, extent: IVec2) -> i64 {
    let farthest = offset.abs().max((offset - extent).abs());
    farthest.as_i64vec2().length_squared()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Boundary;

    #[test]
    fn an_uncovered_point_is_found() {
        // Samples R apart on a square lattice cover everything, and so they do without one of them:
        // its neighbours are exactly R away.
        let side = 10 * R;
        let domain = Domain::from_units(side, side, Boundary::Periodic);
        let fill = |skip: Option<Point>| {
            let mut disks = DiskGrid::new(domain);
            for y in 0..10 {
                for x in 0..10 {
                    let p = Point::new(x * R, y * R);
                    if Some(p) != skip {
                        assert!(disks.insert(p));
                    }
                }
            }
            disks
        };
        assert_eq!(fill(None).uncovered_point(0), None);
        let missing = Point::new(0, 9 * R);
        let disks = fill(Some(missing));
        let witness = disks.uncovered_point(0);
        assert_eq!(
            witness, None,
            "neighbours at distance R cover the sample's own place too"
        );
        let other = Point::new(0, 8 * R);
        let mut disks = DiskGrid::new(domain);
        for y in 0..10 {
            for x in 0..10 {
                let p = Point::new(x * R, y * R);
                if p != missing && p != other {
                    assert!(disks.insert(p));
                }
            }
        }
        let witness = disks
            .uncovered_point(0)
            .expect("two missing samples leave a gap");
        assert!(!disks.covers(witness));
    }

    #[test]
    fn a_full_cell_refuses_more() {
        let domain = Domain::from_units(10 * R, 10 * R, Boundary::Bounded);
        let mut disks = DiskGrid::new(domain);
        for k in 0..4 {
            assert!(disks.insert(Point::new(k, 0)));
        }
        assert!(!disks.insert(Point::new(9, 9)));
    }
}
