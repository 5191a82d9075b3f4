//! The grid of a level: as [`crate::stages::disks::DiskGrid`], with cells from which the samples around a place are gathered by
//! vector instructions, four numbers at a time.

// An inlined function is compiled for the instructions of the function that asks for it.
#![allow(clippy::inline_always)]

use std::ops::Range;

use glam::IVec2;

use crate::lattice::{Point, Rect};
use crate::radius::Radius;
use crate::stages::cells::CellGrid;

/// Samples in one cell (see [`crate::stages::disks`]).
const SLOTS: usize = 3;

/// Samples are handled in groups of this many, and the last group is filled up.
pub(super) const LANES: usize = 8;

/// The offset that fills the last group: farther away than any query.
const FAR: f32 = 1e9;

/// The samples of a cell, by axis. The fourth numbers are not used.
#[derive(Clone, Copy, Default)]
#[repr(align(32))]
struct LevelCell {
    across: [i32; SLOTS + 1],
    up: [i32; SLOTS + 1],
}

/// A conflict-free set of samples of one radius that grows.
#[derive(Clone, Default)]
pub(super) struct LevelGrid {
    layout: CellGrid,
    radius: Radius,
    cells: Vec<LevelCell>,
    /// How many samples each cell has. Beside the cells, so that both are read in one piece.
    counts: Vec<u8>,
}

/// Samples gathered around a place, by axis, as offsets from a place nearby.
#[derive(Default)]
pub(super) struct GatheredSamples {
    pub across: Vec<f32>,
    pub up: Vec<f32>,
    pub count: usize,
}

impl LevelGrid {
    /// Empties the grid and sets what it holds; if `wraps`, opposite sides of `rect` are joined.
    pub fn reset(&mut self, rect: Rect, wraps: bool, radius: Radius) {
        self.layout = CellGrid::new(rect, wraps, radius.bits);
        self.radius = radius;
        self.cells.clear();
        self.cells.resize(self.layout.count(), LevelCell::default());
        self.counts.clear();
        self.counts.resize(self.layout.count(), 0);
    }

    /// Takes a smaller radius, if its cells are those of the radius before: the samples stay. Returns whether they are.
    pub fn refine(&mut self, rect: &Rect, radius: Radius) -> bool {
        let is_same = self.radius.bits == radius.bits && self.layout.rect() == rect;
        if is_same {
            self.radius = radius;
        }
        is_same
    }

    /// Returns the cells without what they hold.
    pub const fn layout(&self) -> &CellGrid {
        &self.layout
    }

    /// Returns the radius of the samples.
    pub const fn radius(&self) -> Radius {
        self.radius
    }

    /// Adds a sample, which must lie in the rectangle; returns `false`, and adds nothing, when its cell is full, which
    /// only happens in a set that is not conflict-free.
    #[inline]
    #[must_use]
    pub fn insert(&mut self, p: Point) -> bool {
        let cell = self.layout.cell_at(p);
        let count = usize::from(self.counts[cell]);
        if count >= SLOTS {
            return false;
        }

        self.cells[cell].across[count] = p.x;
        self.cells[cell].up[count] = p.y;
        self.counts[cell] += 1;
        true
    }

    /// Returns whether a sample lies at `p`, which must lie in the rectangle.
    pub fn holds(&self, p: Point) -> bool {
        self.samples(self.layout.cell_at(p)).any(|q| q == p)
    }

    /// Returns the samples of a cell.
    #[inline]
    fn samples(&self, cell: usize) -> impl Iterator<Item = Point> {
        let LevelCell { across, up } = &self.cells[cell];
        let samples = across.iter().zip(up).take(self.counts[cell].into());
        samples.map(|(&x, &y)| Point::new(x, y))
    }

    /// Calls `visit` with the offset from `from` of the samples at most `reach` away on both axes, and of some farther
    /// ones, until it returns `true`; returns whether it did.
    #[inline]
    pub fn any_near(&self, from: Point, reach: i32, mut visit: impl FnMut(IVec2) -> bool) -> bool {
        self.layout.any_range(from, reach, |mut range, shift| {
            // In a long domain a shift less a place may leave 32 bits. The offsets of samples found here are short, so
            // that the wrapped sums are right again.
            let (x, y) = (shift.x.wrapping_sub(from.x), shift.y.wrapping_sub(from.y));
            range.any(|cell| {
                let mut samples = self.samples(cell);
                samples.any(|p| visit(IVec2::new(p.x.wrapping_add(x), p.y.wrapping_add(y))))
            })
        })
    }

    /// Returns whether any sample covers `point`, which must lie in the rectangle.
    #[inline]
    #[must_use]
    pub fn covers(&self, point: Point) -> bool {
        let Radius { units, .. } = self.radius;
        // The point's own cell nearly always answers when it holds a sample.
        let mut own = self.samples(self.layout.cell_at(point));
        own.any(|p| self.radius.covers(p - point))
            || self.any_near(point, units, |offset| self.radius.covers(offset))
    }

    /// Gathers the samples at most `reach` away from `middle` on both axes, and some farther ones, as offsets from `from`, which
    /// are exact where they are shorter than 2^24.
    pub fn gather(&self, middle: Point, reach: i32, from: Point, out: &mut GatheredSamples) {
        // Where the plane wraps, each axis of the square is cut into up to three spans. A span touches fewer than two
        // cells more than fit into its length. The second and the third span begin at an edge of a cell, the plane's
        // lower end, and touch fewer than one cell more. The length is rounded down: that is made up for by one more
        // cell, and five is the sum. Beyond the last sample a group is written.
        let columns = ((2 * reach) >> self.layout.bits()) as usize + 5;
        let room = SLOTS * columns * columns + LANES;
        if out.across.len() < room {
            out.across.resize(room, FAR);
            out.up.resize(room, FAR);
        }

        let (across, up) = (&mut out.across[..room], &mut out.up[..room]);
        let mut count = 0;
        let mut add = |range: Range<usize>, shift: IVec2| {
            let (x, y) = (shift.x.wrapping_sub(from.x), shift.y.wrapping_sub(from.y));
            // A local copy of the count, so that the compiler need not store it after each of the writes below.
            let mut next = count;
            for (cell, held) in self.cells[range.clone()].iter().zip(&self.counts[range]) {
                // All four numbers of a cell are written, the unused ones too, and those beyond the cell's samples are
                // overwritten by the next cell: a branch on how many there are would often be mispredicted.
                let right = cell.across.map(|at| at.wrapping_add(x) as f32);
                let above = cell.up.map(|at| at.wrapping_add(y) as f32);
                across[next..=next + SLOTS].copy_from_slice(&right);
                up[next..=next + SLOTS].copy_from_slice(&above);
                next += usize::from(*held);
            }
            count = next;
        };

        // Nearly always nothing wraps, and the rows need no shift.
        if let Some(rows) = self.layout.inner_rows(middle, reach) {
            for range in rows {
                add(range, IVec2::ZERO);
            }
        } else {
            self.layout.any_range(middle, reach, |range, shift| {
                add(range, shift);
                false
            });
        }

        // The last group is filled up with samples that are near no place.
        across[count..count + LANES].fill(FAR);
        up[count..count + LANES].fill(FAR);
        out.count = count;
    }
}

impl GatheredSamples {
    /// Returns the samples in groups, the last one filled up with far ones.
    #[inline(always)]
    pub fn groups(&self) -> impl Iterator<Item = (&[f32; LANES], &[f32; LANES])> {
        let groups = self.count.div_ceil(LANES);
        let (across, _) = self.across.as_chunks();
        let (up, _) = self.up.as_chunks();
        across.iter().zip(up).take(groups)
    }

    /// Returns the offset of a sample.
    #[inline(always)]
    pub fn offset(&self, index: usize) -> IVec2 {
        IVec2::new(self.across[index] as i32, self.up[index] as i32)
    }

    /// Returns the samples.
    #[inline(always)]
    pub fn samples(&self) -> impl Iterator<Item = (f32, f32)> + '_ {
        let (across, up) = (&self.across[..self.count], &self.up[..self.count]);
        across.iter().copied().zip(up.iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Key, Stream, below};

    /// What is gathered is what a search visits, across the ends of a plane that wraps, too.
    #[test]
    fn gathered_samples_are_those_near() {
        let radius = Radius::before(1);
        let rect = Rect {
            min: Point::new(0, 0),
            max: Point::new(13 * 46_341 + 77, 11 * 46_341 + 5),
        };
        for wraps in [true, false] {
            let mut grid = LevelGrid::default();
            grid.reset(rect, wraps, radius);
            let mut points = Vec::new();
            for k in 0..2_000 {
                let [a, b] = Key::from_seed(1).draw(Stream::Dart, k);
                let x = below(a, rect.max.x as u32) as i32;
                let p = Point::new(x, below(b, rect.max.y as u32) as i32);
                if !grid.covers(p) {
                    assert!(!grid.holds(p) && grid.insert(p) && grid.holds(p));
                    points.push(p);
                }
            }
            assert!(points.len() > 60);

            let mut gathered = GatheredSamples::default();
            for reach in [1, 46_341, 100_000] {
                for &middle in &points {
                    let mut visited = Vec::new();
                    grid.any_near(middle, reach, |offset| {
                        visited.push(offset);
                        false
                    });
                    grid.gather(middle, reach, middle, &mut gathered);
                    let found: Vec<_> = (0..gathered.count).map(|k| gathered.offset(k)).collect();
                    assert_eq!(found, visited);
                    // What fills the last group is near nothing.
                    let all = gathered.groups().flat_map(|(across, _)| across);
                    assert!(all.skip(found.len()).all(|&across| across >= FAR));
                }
            }
        }
    }

    #[test]
    fn a_full_cell_refuses_more_and_a_finer_radius_keeps_samples() {
        let rect = Rect {
            min: Point::new(0, 0),
            max: Point::new(400_000, 400_000),
        };
        let mut grid = LevelGrid::default();
        grid.reset(rect, true, Radius::before(1));
        assert!((0..3).all(|k| grid.insert(Point::new(k, 0))));
        assert!(!grid.insert(Point::new(9, 9)));
        // Levels with other cells begin anew.
        assert!(grid.refine(&rect, Radius::before(0)) && grid.holds(Point::new(2, 0)));
        assert!(!grid.refine(&rect, Radius::before(2)));
    }
}
