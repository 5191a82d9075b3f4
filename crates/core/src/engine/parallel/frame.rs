//! The rectangle of cells that a region works on, in coordinates of its own. In a periodic domain the plane repeats
//! without end and a frame may lie anywhere in it, so that nothing wraps inside a region.

use glam::I64Vec2;

use crate::border::Border;
use crate::lattice::{Domain, Point, R, Rect};

/// Cells have sides of 2^15 units, one radius.
pub const CELL_BITS: u32 = 15;

/// Cells of padding around a frame, which hold no samples: the widest search, 4 cells, stays within them.
pub const PAD: i32 = 4;

/// The rectangle of a region.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// The lattice point of the plane that is (0, 0) here.
    pub origin: I64Vec2,
    /// Cells on each axis, without the padding.
    pub cells: [i32; 2],
    /// The first coordinates beyond the frame or, if a bounded domain ends within it, beyond the domain.
    pub end: [i32; 2],
    /// Whether the plane continues below and above the frame, by axis.
    pub goes_on: [[bool; 2]; 2],
    /// The window that the region is for, in the frame's coordinates.
    pub window: Rect,
    /// Sides of the domain, in units.
    pub sides: [i32; 2],
    /// Whether the plane repeats with these sides.
    pub periodic: bool,
    /// The closed border of the domain, in the frame's coordinates.
    pub(crate) border: Border,
}

impl Frame {
    /// Returns the frame of `window`, a rectangle of lattice points of `domain`, with a halo of `halo` cells around the
    /// cells that it touches. A closed border cuts the halo off.
    #[must_use]
    pub fn new(domain: &Domain, window: &Rect, halo: i32) -> Self {
        let sides = [domain.width(), domain.height()];
        let domain_end = [domain.rect().max.x, domain.rect().max.y];
        let periodic = domain.is_periodic();
        let low = [window.min.x, window.min.y];
        let high = [window.max.x, window.max.y];

        let mut frame = Self {
            sides,
            periodic,
            ..Self::default()
        };

        let mut min = [0; 2];
        for axis in 0..2 {
            let mut first = i64::from(low[axis] >> CELL_BITS) - i64::from(halo);
            let mut last = i64::from((high[axis] - 1) >> CELL_BITS) + i64::from(halo);

            frame.goes_on[axis] = [true; 2];
            if !periodic {
                // The frame has no cells beyond a closed border, and the plane goes on only where the halo ends before it.
                let last_cell = i64::from((domain_end[axis] - 1) >> CELL_BITS);
                frame.goes_on[axis] = [first > 0, last < last_cell];
                first = first.max(0);
                last = last.min(last_cell);
            }

            frame.origin[axis] = first << CELL_BITS;
            frame.cells[axis] = (last - first + 1) as i32;
            let full = frame.cells[axis] << CELL_BITS;
            // A bounded domain may end within its last cell.
            frame.end[axis] = if periodic {
                full
            } else {
                full.min((i64::from(domain_end[axis]) - frame.origin[axis]) as i32)
            };

            min[axis] = (i64::from(low[axis]) - frame.origin[axis]) as i32;
        }

        frame.border = Border::of(domain, frame.origin);
        let [x, y] = min;
        frame.window = Rect {
            min: Point::new(x, y),
            max: Point::new(x + window.width(), y + window.height()),
        };
        frame
    }

    /// Returns the cells from one row to the next, with the padding.
    #[inline(always)]
    #[must_use]
    pub fn stride(&self) -> usize {
        (self.cells[0] + 2 * PAD) as usize
    }

    /// Returns how many cells there are, with the padding.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.stride() * (self.cells[1] + 2 * PAD) as usize
    }

    /// Returns the index of the cell (column, row), which may lie in the padding.
    #[inline(always)]
    #[must_use]
    pub fn cell(&self, column: i32, row: i32) -> usize {
        (row + PAD) as usize * self.stride() + (column + PAD) as usize
    }

    /// Returns the index of the cell that holds (x, y).
    #[inline(always)]
    #[must_use]
    pub fn cell_at(&self, x: i32, y: i32) -> usize {
        self.cell(x >> CELL_BITS, y >> CELL_BITS)
    }

    /// Returns the column and row of a cell.
    #[inline(always)]
    #[must_use]
    pub fn column_row(&self, cell: usize) -> (i32, i32) {
        let stride = self.stride();
        ((cell % stride) as i32 - PAD, (cell / stride) as i32 - PAD)
    }

    /// Returns the cells that the window touches: columns, then rows, half open.
    #[must_use]
    pub fn window_cells(&self) -> Rect {
        let cell = |x: i32| x >> CELL_BITS;
        Rect {
            min: Point::new(cell(self.window.min.x), cell(self.window.min.y)),
            max: Point::new(
                cell(self.window.max.x - 1) + 1,
                cell(self.window.max.y - 1) + 1,
            ),
        }
    }

    /// Returns the lattice point of the domain at (x, y).
    #[inline]
    #[must_use]
    pub fn point(&self, x: i32, y: i32) -> Point {
        let axis = |x: i32, axis: usize| {
            let at = self.origin[axis] + i64::from(x);
            if self.periodic {
                at.rem_euclid(i64::from(self.sides[axis])) as i32
            } else {
                at as i32
            }
        };
        Point::new(axis(x, 0), axis(y, 1))
    }

    /// Returns whether (x, y) lies in the frame, and so inside a bounded domain.
    #[inline(always)]
    #[must_use]
    pub fn holds(&self, x: i32, y: i32) -> bool {
        (x as u32) < self.end[0] as u32 && (y as u32) < self.end[1] as u32
    }

    /// Returns the rectangle from which tiled samples are taken: the frame, and one radius beyond
    /// the closed borders of the domain.
    #[must_use]
    pub fn tiled(&self) -> Rect {
        let reach = |axis: usize| {
            let [below, above] = self.goes_on[axis];
            (
                if below { 0 } else { -R },
                self.end[axis] + if above { 0 } else { R },
            )
        };
        let ((left, right), (bottom, top)) = (reach(0), reach(1));
        Rect {
            min: Point::new(left, bottom),
            max: Point::new(right, top),
        }
    }
}
