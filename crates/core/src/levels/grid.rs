//! The samples of one level by cells, in a rectangle of the plane or in a whole periodic domain, which wraps.

use crate::lattice::{Point, Rect};

use super::radius::LevelRadius;

/// Samples in a cell. Of four points of a square some three form an angle of at least 90 degrees; were all farther
/// apart than its side, two would be farther apart than its diagonal. A cell's side is at most the level's radius.
const SLOTS: usize = 3;

#[derive(Clone, Copy, Default)]
struct LevelCell {
    count: u32,
    points: [Point; SLOTS],
}

/// What a place is to the samples known so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// A sample lies here.
    Taken,
    /// A sample covers it.
    Covered,
    /// No sample covers it.
    Free,
}

/// A conflict-free set of samples that grows.
#[derive(Default)]
pub(super) struct LevelGrid {
    /// The places that it holds. If the plane wraps, this is the domain.
    pub rect: Rect,
    pub wraps: bool,
    bits: u32,
    columns: usize,
    cells: Vec<LevelCell>,
    /// Flags of cells, for those who use the grid.
    pub flags: Vec<u8>,
}

impl LevelGrid {
    /// Empties the grid and sets what it holds.
    pub fn reset(&mut self, rect: Rect, wraps: bool, radius: &LevelRadius) {
        self.rect = rect;
        self.wraps = wraps;
        self.bits = radius.bits;
        let cells = |side: i32| ((side - 1) >> self.bits) as usize + 1;
        self.columns = cells(rect.width());
        let count = self.columns * cells(rect.height());
        self.cells.clear();
        self.cells.resize(count, LevelCell::default());
        self.flags.clear();
        self.flags.resize(count, 0);
    }

    /// Returns the index of the cell of a place in the rectangle.
    #[inline]
    pub fn cell_at(&self, p: Point) -> usize {
        let column = (p.x - self.rect.min.x) >> self.bits;
        let row = (p.y - self.rect.min.y) >> self.bits;
        row as usize * self.columns + column as usize
    }

    /// Returns the places of a cell.
    pub fn cell_rect(&self, cell: usize) -> Rect {
        let (column, row) = ((cell % self.columns) as i32, (cell / self.columns) as i32);
        let min = Point::new(
            self.rect.min.x + (column << self.bits),
            self.rect.min.y + (row << self.bits),
        );
        let end = |from: i32, max: i32| from + (max - from).min(1 << self.bits);
        Rect {
            min,
            max: Point::new(end(min.x, self.rect.max.x), end(min.y, self.rect.max.y)),
        }
    }

    /// Adds a sample, which no other may cover.
    #[inline]
    pub fn insert(&mut self, p: Point) {
        let cell = self.cell_at(p);
        let cell = &mut self.cells[cell];
        debug_assert!(
            (cell.count as usize) < SLOTS,
            "the samples are conflict-free"
        );
        cell.points[cell.count as usize % SLOTS] = p;
        cell.count += 1;
    }

    /// Calls `visit` with ranges of cells, and how far they are shifted, that together hold all places at most `reach`
    /// from `from` on both axes.
    #[inline]
    pub fn any_range(
        &self,
        from: Point,
        reach: i32,
        mut visit: impl FnMut(std::ops::Range<usize>, Point) -> bool,
    ) -> bool {
        let Rect { min, max } = self.rect;
        let rows = axis_spans(from.y, reach, [min.y, max.y], self.wraps);
        let columns = axis_spans(from.x, reach, [min.x, max.x], self.wraps);
        for &[bottom, top, up] in rows.iter().filter(|span| span[0] <= span[1]) {
            let (first, last) = ((bottom - min.y) >> self.bits, (top - min.y) >> self.bits);
            for row in first as usize..=last as usize {
                let start = row * self.columns;
                for &[left, right, along] in columns.iter().filter(|span| span[0] <= span[1]) {
                    let first = ((left - min.x) >> self.bits) as usize;
                    let last = ((right - min.x) >> self.bits) as usize;
                    if visit(start + first..start + last + 1, Point::new(along, up)) {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// Calls `visit` with the offset from `from` of the samples at most `reach` away on both axes, and of some farther
    /// ones, until it returns `true`; returns whether it did.
    #[inline]
    pub fn any_near(
        &self,
        from: Point,
        reach: i32,
        mut visit: impl FnMut(i32, i32) -> bool,
    ) -> bool {
        self.any_range(from, reach, |range, shift| {
            // A domain has at most 2^31 units, and a place near it lies at most a few radii outside.
            let (x, y) = (shift.x.wrapping_sub(from.x), shift.y.wrapping_sub(from.y));
            self.cells[range].iter().any(|cell| {
                let held = &cell.points[..cell.count as usize];
                held.iter()
                    .any(|p| visit(p.x.wrapping_add(x), p.y.wrapping_add(y)))
            })
        })
    }

    /// Sets a flag of all cells that touch the square around `from`, and calls `first` with those that did not have it.
    pub fn flag_near(&mut self, from: Point, reach: i32, flag: u8, mut first: impl FnMut(usize)) {
        let mut flags = std::mem::take(&mut self.flags);
        self.any_range(from, reach, |range, _| {
            for cell in range {
                if flags[cell] & flag == 0 {
                    flags[cell] |= flag;
                    first(cell);
                }
            }
            false
        });
        self.flags = flags;
    }

    /// Returns what `p` is to the samples.
    #[inline]
    pub fn place(&self, p: Point, radius: &LevelRadius) -> Place {
        let mut here = false;
        let covered = self.any_near(p, radius.units, |dx, dy| {
            here |= (dx, dy) == (0, 0);
            radius.covers(dx, dy)
        });
        match (here, covered) {
            (true, _) => Place::Taken,
            (false, true) => Place::Covered,
            (false, false) => Place::Free,
        }
    }
}

/// Returns up to three spans [first, last, shift] of coordinates from `min` to below `max` that lie at most `reach`
/// from `from` once they are shifted. Empty spans have their last before their first.
#[inline]
fn axis_spans(from: i32, reach: i32, [min, max]: [i32; 2], wraps: bool) -> [[i32; 3]; 3] {
    const NOTHING: [i32; 3] = [0, -1, 0];
    let (low, high) = (
        i64::from(from) - i64::from(reach),
        i64::from(from) + i64::from(reach),
    );
    let last = i64::from(max) - 1;
    let here = [
        low.clamp(min.into(), max.into()) as i32,
        high.clamp(i64::from(min) - 1, last) as i32,
        0,
    ];
    if !wraps || (low >= i64::from(min) && high <= last) {
        return [here, NOTHING, NOTHING];
    }
    let side = max - min;
    let long = i64::from(side);
    let below = [(low + long).max(min.into()) as i32, last as i32, -side];
    let above = [min, (high - long).min(last) as i32, side];
    [
        here,
        if low < i64::from(min) { below } else { NOTHING },
        if high > last { above } else { NOTHING },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Key, Stream, below};

    /// The grid visits what a scan of all images finds, each once.
    #[test]
    fn a_wrapping_grid_finds_what_a_scan_finds() {
        let radius = LevelRadius::before(1);
        let rect = Rect {
            min: Point::new(0, 0),
            max: Point::new(13 * 46_341 + 77, 11 * 46_341 + 5),
        };
        let mut grid = LevelGrid::default();
        for wraps in [true, false] {
            grid.reset(rect, wraps, &radius);
            let mut points = Vec::new();
            for k in 0..2_000 {
                let [a, b] = Key::from_seed(1).draw(Stream::Dart, k);
                let x = below(a, rect.max.x as u32) as i32;
                let p = Point::new(x, below(b, rect.max.y as u32) as i32);
                if grid.place(p, &radius) == Place::Free {
                    grid.insert(p);
                    points.push(p);
                }
            }
            assert!(points.len() > 60);
            for reach in [1, 46_341, 100_000] {
                for &from in &points {
                    let mut found = Vec::new();
                    grid.any_near(from, reach, |dx, dy| {
                        if dx.abs() <= reach && dy.abs() <= reach {
                            found.push((dx, dy));
                        }
                        false
                    });
                    let shifts = if wraps { vec![-1, 0, 1] } else { vec![0] };
                    let mut scanned = Vec::new();
                    for p in &points {
                        for &i in &shifts {
                            for &j in &shifts {
                                let dx = p.x + i * rect.max.x - from.x;
                                let dy = p.y + j * rect.max.y - from.y;
                                if dx.abs() <= reach && dy.abs() <= reach {
                                    scanned.push((dx, dy));
                                }
                            }
                        }
                    }
                    found.sort_unstable();
                    scanned.sort_unstable();
                    assert_eq!(found, scanned);
                }
            }
        }
    }
}
