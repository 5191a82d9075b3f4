//! Cells over a rectangle of the plane or a periodic domain, and which of them lie near a place. What the cells hold is left
//! to the grids of samples.

use std::ops::Range;

use glam::IVec2;

use crate::lattice::{Point, Rect};

/// Cells whose sides are a power of two. They are numbered row by row.
#[derive(Clone, Default)]
pub(crate) struct CellGrid {
    /// The places in the cells. If the plane wraps, this is the domain.
    rect: Rect,
    wraps: bool,
    /// Cells are 2^`bits` units wide.
    bits: u32,
    columns: usize,
    rows: usize,
}

impl CellGrid {
    /// Returns the cells over `rect`; if `wraps`, its opposite sides are joined.
    pub const fn new(rect: Rect, wraps: bool, bits: u32) -> Self {
        Self {
            rect,
            wraps,
            bits,
            columns: ((rect.width() - 1) >> bits) as usize + 1,
            rows: ((rect.height() - 1) >> bits) as usize + 1,
        }
    }

    /// Returns the places in the cells.
    pub const fn rect(&self) -> &Rect {
        &self.rect
    }

    /// Returns the side of the cells as a power of two.
    pub const fn bits(&self) -> u32 {
        self.bits
    }

    /// Returns how many cells there are.
    pub const fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// Returns the index of the cell of a place in the rectangle.
    #[inline]
    pub const fn cell_at(&self, p: Point) -> usize {
        let column = (p.x - self.rect.min.x) >> self.bits;
        let row = (p.y - self.rect.min.y) >> self.bits;
        row as usize * self.columns + column as usize
    }

    /// Returns the places of a cell.
    pub fn cell_rect(&self, cell: usize) -> Rect {
        let (column, row) = ((cell % self.columns) as i32, (cell / self.columns) as i32);
        let Rect { min, max } = self.rect;
        let side = 1 << self.bits;
        let first = Point::new(min.x + column * side, min.y + row * side);

        // A rectangle may end less than a cell before the end of the integers.
        let end = |from: i32, max: i32| from + (max - from).min(side);
        Rect {
            min: first,
            max: Point::new(end(first.x, max.x), end(first.y, max.y)),
        }
    }

    /// Returns the ranges of cells, row by row, that together hold all places at most `reach` from `from` on both axes, or
    /// `None` if the rectangle does not hold them all.
    #[inline]
    pub fn inner_rows(
        &self,
        from: Point,
        reach: i32,
    ) -> Option<impl Iterator<Item = Range<usize>> + use<>> {
        let Rect { min, max } = self.rect;
        let cell = |at: i32, first: i32| ((at - first) >> self.bits) as usize;
        // Ends beyond the integers stay at their limits, which lie outside of the rectangle.
        let (left, right) = (from.x.saturating_sub(reach), from.x.saturating_add(reach));
        let (bottom, top) = (from.y.saturating_sub(reach), from.y.saturating_add(reach));
        if left < min.x || bottom < min.y || right >= max.x || top >= max.y {
            return None;
        }

        let (columns, first) = (self.columns, cell(left, min.x));
        let width = cell(right, min.x) - first + 1;
        let rows = cell(bottom, min.y)..cell(top, min.y) + 1;
        Some(rows.map(move |row| {
            let start = row * columns + first;
            start..start + width
        }))
    }

    /// Calls `visit` with ranges of cells that together hold all places at most `reach` from `from` on both axes, until it
    /// returns `true`; returns whether it did. With each range comes the shift to be added to its places: 0, or a side of a
    /// domain that wraps.
    #[inline]
    pub fn any_range(
        &self,
        from: Point,
        reach: i32,
        mut visit: impl FnMut(Range<usize>, IVec2) -> bool,
    ) -> bool {
        // Away from the border, which is nearly always, nothing wraps and nothing is cut off.
        if let Some(mut rows) = self.inner_rows(from, reach) {
            return rows.any(|range| visit(range, IVec2::ZERO));
        }

        let Rect { min, max } = self.rect;
        let cell = |at: i32, first: i32| ((at - first) >> self.bits) as usize;

        // In a plane that wraps an axis has up to three spans: one here, and one shifted in from either end.
        let rows = axis_spans(from.y, reach, min.y..max.y, self.wraps);
        let columns = axis_spans(from.x, reach, min.x..max.x, self.wraps);
        for row_span in rows.iter().filter(|span| span.first <= span.last) {
            for row in cell(row_span.first, min.y)..=cell(row_span.last, min.y) {
                let start = row * self.columns;
                for span in columns.iter().filter(|span| span.first <= span.last) {
                    let (first, last) = (cell(span.first, min.x), cell(span.last, min.x));
                    let shift = IVec2::new(span.shift, row_span.shift);
                    if visit(start + first..start + last + 1, shift) {
                        return true;
                    }
                }
            }
        }
        false
    }
}

/// Coordinates on an axis, and how far they are shifted. An empty span has its last before its first.
#[derive(Clone, Copy)]
struct AxisSpan {
    first: i32,
    last: i32,
    shift: i32,
}

/// Returns the spans of coordinates of `held` that lie at most `reach` from `from` once they are shifted.
#[inline]
fn axis_spans(from: i32, reach: i32, held: Range<i32>, wraps: bool) -> [AxisSpan; 3] {
    const NOTHING: AxisSpan = AxisSpan {
        first: 0,
        last: -1,
        shift: 0,
    };

    // Sums need 64 bits: a place and its reach may lie beyond the ends of the 32-bit integers.
    let (min, max) = (i64::from(held.start), i64::from(held.end));
    let (low, high) = (
        i64::from(from) - i64::from(reach),
        i64::from(from) + i64::from(reach),
    );

    let last = max - 1;
    // Bounds are clamped to one beyond either end, so that a span that misses the held places is empty.
    let here = AxisSpan {
        first: low.clamp(min, max) as i32,
        last: high.clamp(min - 1, last) as i32,
        shift: 0,
    };
    if !wraps {
        return [here, NOTHING, NOTHING];
    }

    // Below the domain its last places lie again, shifted by a side, and above it its first places. A reach of more
    // than half a side finds a sample more than once, each time another image of it.
    let side = max - min;
    let below = AxisSpan {
        first: (low + side).max(min) as i32,
        last: last as i32,
        shift: -side as i32,
    };
    let above = AxisSpan {
        first: min as i32,
        last: (high - side).min(last) as i32,
        shift: side as i32,
    };

    [
        here,
        if low < min { below } else { NOTHING },
        if high > last { above } else { NOTHING },
    ]
}
