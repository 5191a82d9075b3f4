//! A compact grid for conflict-free sets: cells whose sides are at most the radius, with room for three samples. It
//! answers coverage queries for the dart process and for the check of patterns, in a rectangle of
//! the plane or in a periodic domain. Samples have no ids here; for those see [`crate::SampleGrid`].

use glam::IVec2;

use crate::lattice::{Domain, Point, Rect};
use crate::radius::Radius;
use crate::stages::cells::CellGrid;

/// Samples in one cell. Of four points of a square some three form an angle of at least 90 degrees; were all farther
/// apart than its side, two would be farther apart than its diagonal. A cell's side is at most the radius.
const SLOTS: usize = 3;

/// A slot without a sample: no rectangle reaches so far.
const EMPTY: Point = Point::new(i32::MIN, i32::MIN);

/// A conflict-free set of samples of one radius that grows.
#[derive(Clone, Default)]
pub struct DiskGrid {
    grid: CellGrid,
    radius: Radius,
    cells: Vec<[Point; SLOTS]>,
}

/// A square of lattice points, `side` units wide, that starts at `min`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Cell {
    /// The lowest point inside.
    pub min: Point,
    /// Units along each side: a power of two.
    pub side: i32,
}

impl Cell {
    /// Returns the cell's quarters, row by row.
    pub(crate) fn quarters(self) -> [Self; 4] {
        let Self { min, side } = self;
        let half = side / 2;
        [(0, 0), (half, 0), (0, half), (half, half)].map(|(right, up)| Self {
            min: Point::new(min.x + right, min.y + up),
            side: half,
        })
    }
}

impl DiskGrid {
    /// Returns an empty grid over `domain`, for samples of radius `R`.
    #[must_use]
    pub fn new(domain: Domain) -> Self {
        let mut grid = Self::default();
        grid.reset(domain.rect(), domain.is_periodic(), Radius::FINEST);
        grid
    }

    /// Empties the grid and sets what it holds; if `wraps`, opposite sides of `rect` are joined.
    pub(crate) fn reset(&mut self, rect: Rect, wraps: bool, radius: Radius) {
        self.grid = CellGrid::new(rect, wraps, radius.bits);
        self.radius = radius;
        self.cells.clear();
        self.cells.resize(self.grid.count(), [EMPTY; SLOTS]);
    }

    /// Returns the places that the grid holds.
    pub(crate) const fn rect(&self) -> &Rect {
        self.grid.rect()
    }

    /// Returns the radius of the samples.
    pub(crate) const fn radius(&self) -> Radius {
        self.radius
    }

    /// Adds a sample, which must lie in the rectangle; returns `false`, and adds nothing, when its cell is full, which
    /// only happens in a set that is not conflict-free.
    #[inline]
    #[must_use]
    pub fn insert(&mut self, p: Point) -> bool {
        let cell = self.grid.cell_at(p);
        let free = self.cells[cell].iter_mut().find(|slot| **slot == EMPTY);
        free.map(|slot| *slot = p).is_some()
    }

    /// Calls `visit` with the offset from `from` of the samples at most `reach` away on both axes, and of some farther
    /// ones, until it returns `true`; returns whether it did.
    #[inline]
    pub(crate) fn any_near(
        &self,
        from: Point,
        reach: i32,
        mut visit: impl FnMut(IVec2) -> bool,
    ) -> bool {
        self.grid.any_range(from, reach, |range, shift| {
            // In a long domain a shift less a place may leave 32 bits. The offsets of samples found here are short, so
            // that the wrapped sums are right again.
            let (x, y) = (shift.x.wrapping_sub(from.x), shift.y.wrapping_sub(from.y));
            self.cells[range].iter().any(|cell| {
                let mut held = cell.iter().take_while(|slot| slot.x != EMPTY.x);
                held.any(|p| visit(IVec2::new(p.x.wrapping_add(x), p.y.wrapping_add(y))))
            })
        })
    }

    /// Returns whether any sample covers `point`, which must lie in the rectangle.
    #[inline]
    #[must_use]
    pub fn covers(&self, point: Point) -> bool {
        let Radius { units, .. } = self.radius;
        // The point's own cell nearly always answers when it holds a sample.
        let own = &self.cells[self.grid.cell_at(point)];
        let mut held = own.iter().take_while(|slot| slot.x != EMPTY.x);
        held.any(|p| self.radius.covers(*p - point))
            || self.any_near(point, units, |offset| self.radius.covers(offset))
    }

    /// Appends to `out` the quarters of `cell` that hold places of the rectangle and are not covered by a single
    /// sample. `near` is a buffer.
    pub(crate) fn uncovered_quarters(
        &self,
        cell: Cell,
        near: &mut Vec<IVec2>,
        out: &mut Vec<Point>,
    ) {
        near.clear();
        let half = cell.side / 2;
        let middle = Point::new(cell.min.x + half, cell.min.y + half);
        // A sample that covers a quarter covers the quarter's corner beside the cell's middle, less than 2 units away
        // from it. A quarter that the rectangle cuts off may lack this corner, but it holds its own lowest place, which
        // is at most half a diagonal of the cell from the middle.
        let is_whole = self.extent(cell) == IVec2::splat(cell.side - 1);
        let reach = self.radius.units + if is_whole { 2 } else { cell.side };
        let limit = i64::from(reach) * i64::from(reach);

        self.any_near(middle, reach, |offset| {
            if offset.as_i64vec2().length_squared() <= limit {
                // From here on offsets begin at the cell's lowest place.
                near.push(offset + half);
            }
            // The search goes on to all samples.
            false
        });

        for quarter in cell.quarters() {
            // Beyond a border there is nothing to cover.
            if !self.rect().contains(quarter.min) {
                continue;
            }

            let extent = self.extent(quarter);
            let corner = quarter.min - cell.min;
            let mut offsets = near.iter().map(|&offset| offset - corner);
            if !offsets.any(|offset| self.radius.covers(farthest(offset, extent))) {
                out.push(quarter.min);
            }
        }
    }

    /// Returns whether one sample covers every place of `cell`, which begins in the rectangle.
    #[must_use]
    pub(crate) fn covers_cell(&self, cell: Cell) -> bool {
        self.covers_cell_within(cell, &self.radius)
    }

    /// Returns what [`Self::covers_cell`] would if samples had another radius.
    fn covers_cell_within(&self, cell: Cell, radius: &Radius) -> bool {
        let extent = self.extent(cell);
        // A sample that covers all places covers the lowest one, too, and is near that.
        self.any_near(cell.min, radius.units, |offset| {
            radius.covers(farthest(offset, extent))
        })
    }

    /// Returns a place that no sample covers, or `None`: an exact proof that the set is maximal on the lattice. A
    /// sample counts as covering the places at a squared distance of at most the squared radius plus `slack`.
    #[must_use]
    pub fn uncovered_point(&self, slack: i64) -> Option<Point> {
        let radius = self.radius.with_slack(slack);
        // Hardly any sample covers a whole cell that is about as wide as the radius: the search begins with halves.
        let mut stack: Vec<Cell> = tiling_cells(self.rect(), radius.side() / 2).collect();

        while let Some(cell) = stack.pop() {
            if self.covers_cell_within(cell, &radius) {
                continue;
            }

            // The cell is one place, which no sample covers. Larger ones may be covered by several samples together.
            if cell.side == 1 {
                return Some(cell.min);
            }

            // At the upper borders a cell may reach beyond the rectangle.
            let quarters = cell.quarters().into_iter();
            stack.extend(quarters.filter(|quarter| self.rect().contains(quarter.min)));
        }

        None
    }

    /// Returns the offset of a cell's highest place in the rectangle from its lowest.
    fn extent(&self, cell: Cell) -> IVec2 {
        IVec2::splat(cell.side).min(self.rect().max - cell.min) - 1
    }
}

/// Returns the cells of `side` units that tile a rectangle, row by row.
pub(crate) fn tiling_cells(rect: &Rect, side: i32) -> impl Iterator<Item = Cell> + use<> {
    let Rect { min, max } = *rect;
    let starts =
        move |min: i32, max: i32| (0..=(max - min - 1) / side).map(move |k| min + k * side);
    starts(min.y, max.y).flat_map(move |y| {
        starts(min.x, max.x).map(move |x| Cell {
            min: Point::new(x, y),
            side,
        })
    })
}

/// Returns the offset of a sample from the farthest place of a rectangle, on each axis, without its sign. `offset` is
/// the sample's from the lowest place, and `extent` that of the highest.
#[inline]
pub(crate) fn farthest(offset: IVec2, extent: IVec2) -> IVec2 {
    offset.abs().max((offset - extent).abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Boundary, R};
    use crate::random::{Key, Stream, below};

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
        for k in 0..3 {
            assert!(disks.insert(Point::new(k, 0)));
        }
        assert!(!disks.insert(Point::new(9, 9)));
    }

    /// Returns the offsets from `from` of all points, and of their images if the plane wraps, that are within reach.
    fn scan(points: &[Point], from: Point, reach: i32, period: Option<Point>) -> Vec<[i32; 2]> {
        let shifts = if period.is_some() { -1..=1 } else { 0..=0 };
        let Point { x, y } = period.unwrap_or_default();
        let mut scanned = Vec::new();
        for p in points {
            for i in shifts.clone() {
                for j in shifts.clone() {
                    let offset = *p - from + IVec2::new(i * x, j * y);
                    if offset.abs().max_element() <= reach {
                        scanned.push(offset.to_array());
                    }
                }
            }
        }
        scanned.sort_unstable();
        scanned
    }

    /// The grid visits what a scan of all images finds, each once.
    #[test]
    fn a_wrapping_grid_finds_what_a_scan_finds() {
        let radius = Radius::before(1);
        let rect = Rect {
            min: Point::new(0, 0),
            max: Point::new(13 * 46_341 + 77, 11 * 46_341 + 5),
        };
        let mut grid = DiskGrid::default();
        for wraps in [true, false] {
            grid.reset(rect, wraps, radius);
            let mut points = Vec::new();
            for k in 0..2_000 {
                let [a, b] = Key::from_seed(1).draw(Stream::Dart, k);
                let x = below(a, rect.max.x as u32) as i32;
                let p = Point::new(x, below(b, rect.max.y as u32) as i32);
                if !grid.covers(p) {
                    assert!(grid.insert(p));
                    points.push(p);
                }
            }
            assert!(points.len() > 60);

            for reach in [1, 46_341, 100_000] {
                for &from in &points {
                    let mut found = Vec::new();
                    grid.any_near(from, reach, |offset| {
                        if offset.abs().max_element() <= reach {
                            found.push(offset.to_array());
                        }
                        false
                    });
                    found.sort_unstable();
                    let period = wraps.then_some(rect.max);
                    assert_eq!(found, scan(&points, from, reach, period));
                }
            }
        }
    }
}
