//! The order of samples in GPU buffers: levels of increasing density, each sorted by grid cell. A region of the plane
//! is a few ranges, and a thinned subset is a prefix. A level adds the samples that are far enough from those before, so
//! that a thinned set of blue noise still looks like one, only coarser. Nested levels are such levels as they are.

use std::ops::Range;

use glam::DVec2;
use tilescope_core::{Domain, Point, R};
use tilescope_session::units::{radii, size};

/// About every 64th sample, then every 16th, every fourth, and the rest.
const LEVELS: usize = 4;
/// The smallest distances between the samples of a level and those before, in r. At half the distance there are about four times
/// the samples. The last level has the rest.
const DISTANCES: [f64; LEVELS - 1] = [8.0, 4.0, 2.0];
/// The grid has hardly more cells than this; each level holds an offset for each cell. Chosen, not measured.
const MAX_CELLS: f64 = 65_536.0;
/// The shortest side of a cell, in r. Chosen, not measured.
const MIN_CELL: f64 = 4.0;
/// Ranges closer than this are drawn in one call. Chosen, not measured.
const MAX_SKIPPED: u32 = 64;
/// How far outside its domain a sample may lie, in r, with some slack: bounded domains drop such samples.
const BEYOND: f64 = 1.5;

/// Maps samples to buffer positions, and cells to ranges of positions.
#[derive(Debug, Default)]
pub struct CellOrder {
    side: f64,
    cells: [usize; 2],
    size: DVec2,
    /// How many samples there are up to the end of each level.
    ends: Vec<u32>,
    /// The first position of each cell, by level; one more entry at the end.
    starts: Vec<u32>,
    /// The sample at each position.
    pub ids: Vec<u32>,
    /// The position of each sample.
    pub positions: Vec<u32>,
}

impl CellOrder {
    /// Returns the order of `points`: the same for the same points. They may have nested levels, whose ends are
    /// `nested`.
    pub fn new(domain: &Domain, points: &[Point], nested: &[usize]) -> Self {
        let extent = size(domain);
        let side = (extent.element_product() / MAX_CELLS).sqrt().max(MIN_CELL);
        let mut order = Self {
            side,
            cells: extent.to_array().map(|length| (length / side) as usize + 1),
            size: extent,
            ..Self::default()
        };

        let by_cell = order.by_cell(points);
        let (levels, count) = if nested.is_empty() {
            (order.levels(points, &by_cell), LEVELS)
        } else {
            let level = |id: &u32| nested.partition_point(|&end| end <= *id as usize);
            (by_cell.iter().map(level).collect(), nested.len())
        };

        order.split_into_levels(points, &by_cell, &levels, count);
        order
    }

    fn cell_of(&self, point: Point) -> usize {
        let axis = |units: i32, k: usize| {
            ((radii(units) / self.side).max(0.0) as usize).min(self.cells[k] - 1)
        };
        axis(point.y, 1) * self.cells[0] + axis(point.x, 0)
    }

    const fn cell_count(&self) -> usize {
        self.cells[0] * self.cells[1]
    }

    /// Returns the ids sorted by cell, in an arbitrary but fixed order within a cell.
    fn by_cell(&self, points: &[Point]) -> Vec<u32> {
        let mut starts = vec![0_u32; self.cell_count() + 1];
        for &point in points {
            starts[self.cell_of(point) + 1] += 1;
        }
        accumulate(&mut starts);

        let mut next = starts.clone();
        let mut ids = vec![0_u32; points.len()];
        for (id, &point) in (0_u32..).zip(points) {
            let slot = &mut next[self.cell_of(point)];
            ids[*slot as usize] = id;
            *slot += 1;
        }

        for cell in 0..self.cell_count() {
            let ids_in_cell = &mut ids[starts[cell] as usize..starts[cell + 1] as usize];
            // By a hash of their places, so that the order in which samples were made leaves no trace in the levels.
            ids_in_cell.sort_unstable_by_key(|&id| (hash(points[id as usize]), id));
        }
        ids
    }

    /// Sorts the samples by level and cell. `levels` has the level of each sample, in the order of `by_cell`; there are `count` levels.
    fn split_into_levels(
        &mut self,
        points: &[Point],
        by_cell: &[u32],
        levels: &[usize],
        count: usize,
    ) {
        let cells = self.cell_count();
        self.starts = vec![0_u32; count * cells + 1];

        // A slot is a cell of a level. Coarse levels come first, so that a coarser set is the beginning of the buffers.
        let slot = |level: usize, id: u32| level * cells + self.cell_of(points[id as usize]);
        let slots: Vec<usize> = levels
            .iter()
            .zip(by_cell)
            .map(|(&level, &id)| slot(level, id))
            .collect();
        // Each count stands one place behind its slot, so that after summing each place has the start of its slot.
        for slot in &slots {
            self.starts[slot + 1] += 1;
        }
        accumulate(&mut self.starts);

        self.ends = (1..=count)
            .map(|level| self.starts[level * cells])
            .collect();

        let mut next = self.starts.clone();
        self.ids = vec![0; points.len()];
        self.positions = vec![0; points.len()];
        for (&slot, &id) in slots.iter().zip(by_cell) {
            let position = next[slot];
            next[slot] += 1;
            self.ids[position as usize] = id;
            self.positions[id as usize] = position;
        }
    }

    /// Returns the level of each sample, in the order of `by_cell`.
    fn levels(&self, points: &[Point], by_cell: &[u32]) -> Vec<usize> {
        // The places in the order in which they are visited: read one after another, they come faster from memory.
        let visited: Vec<Point> = by_cell.iter().map(|&id| points[id as usize]).collect();
        let mut levels = vec![LEVELS - 1; visited.len()];

        for (level, distance) in DISTANCES.into_iter().enumerate() {
            let mut taken = Taken::new(self.size, distance);
            // The samples of coarser levels come first, and keep samples too near to them out of this level.
            for (&own, &point) in levels.iter().zip(&visited) {
                if own < level {
                    taken.take(point);
                }
            }

            // The others are tried one by one; those too near remain for a finer level.
            for (own, &point) in levels.iter_mut().zip(&visited) {
                if *own > level && taken.take(point) {
                    *own = level;
                }
            }
        }

        levels
    }

    /// Returns how many levels hold the first `count` samples, at least one, and how many samples these levels have.
    pub fn levels_of(&self, count: u32) -> (usize, u32) {
        let enough = self.ends.partition_point(|&end| end < count);
        // If there are fewer samples than `count`, all levels are taken.
        let level = enough.min(self.ends.len().saturating_sub(1));
        (level + 1, self.ends.get(level).copied().unwrap_or(0))
    }

    /// Returns the positions of the samples of the first `levels` levels in the cells that meet the rectangle from
    /// `low` to `high`, in r: all samples of those levels in it, and some around it.
    pub fn ranges(&self, low: DVec2, high: DVec2, levels: usize) -> Vec<Range<u32>> {
        let mut ranges: Vec<Range<u32>> = Vec::new();
        let (Some(columns), Some(rows)) = (self.span(low, high, 0), self.span(low, high, 1)) else {
            return ranges;
        };

        // Positions ascend by level, row and column, and so do the ranges.
        for level in 0..levels.min(self.ends.len()) {
            for row in rows.clone() {
                let first = level * self.cell_count() + row * self.cells[0];
                let range = self.starts[first + columns.start]..self.starts[first + columns.end];
                match ranges.last_mut() {
                    _ if range.is_empty() => {}
                    // A few samples out of view cost less than another call.
                    Some(last) if range.start - last.end <= MAX_SKIPPED => last.end = range.end,
                    _ => ranges.push(range),
                }
            }
        }
        ranges
    }

    /// Returns the cells along an axis that meet the interval and may hold samples.
    fn span(&self, low: DVec2, high: DVec2, k: usize) -> Option<Range<usize>> {
        let (low, high) = (low[k] - BEYOND, high[k] + BEYOND);
        if self.ids.is_empty() || high < 0.0 || low > self.size[k] || low > high {
            return None;
        }
        let cell = |value: f64| ((value.max(0.0) / self.side) as usize).min(self.cells[k] - 1);
        Some(cell(low)..cell(high) + 1)
    }
}

/// Returns the total length of `ranges`.
pub fn count(ranges: &[Range<u32>]) -> usize {
    ranges.iter().map(ExactSizeIterator::len).sum()
}

/// Points at a distance from each other, in cells so small that each holds one at most.
struct Taken {
    /// Cells in a unit of the lattice.
    scale: f64,
    columns: usize,
    rows: usize,
    /// The square of the distance, in units of the lattice.
    square: u64,
    /// The point in each cell, row by row, within a frame of two empty cells.
    cells: Vec<Point>,
}

impl Taken {
    /// Stands for no point: farther from all than any distance.
    const NONE: Point = Point::new(i32::MIN / 2, i32::MIN / 2);

    fn new(size: DVec2, distance: f64) -> Self {
        let side = distance * std::f64::consts::FRAC_1_SQRT_2;
        let [columns, rows] = size.to_array().map(|length| (length / side) as usize + 1);
        let distance = (distance * f64::from(R)) as u64;
        Self {
            scale: 1.0 / (side * f64::from(R)),
            columns,
            rows,
            square: distance * distance,
            cells: vec![Self::NONE; (columns + 4) * (rows + 4)],
        }
    }

    /// Takes a point unless it is too near to another one. Returns whether it was taken. Images across the border of a
    /// periodic domain do not count: a picture of fewer samples may have two near each other there.
    fn take(&mut self, point: Point) -> bool {
        // A sample a little outside the domain is taken to be in the outermost cell.
        let cell = |units: i32, count: usize| {
            ((f64::from(units) * self.scale).max(0.0) as usize).min(count - 1)
        };
        let (column, row) = (cell(point.x, self.columns), cell(point.y, self.rows));
        // Two empty cells surround the grid on each side, so that indices are larger by 2.
        let width = self.columns + 4;
        let own = (row + 2) * width + column + 2;

        // The diagonal of a cell is as long as the distance, so that two points in one cell are too near.
        if self.cells[own] != Self::NONE {
            return false;
        }

        let is_near = |other: &Point| {
            let x = u64::from(point.x.abs_diff(other.x));
            let y = u64::from(point.y.abs_diff(other.y));
            x * x + y * y < self.square
        };

        // A point that is too near is at most two cells away, in five rows of five cells. With the 2 of the empty cells, they begin at
        // `row` and `column`, and never end outside the list.
        for near_row in row..row + 5 {
            let first = near_row * width + column;
            if self.cells[first..first + 5].iter().any(is_near) {
                return false;
            }
        }

        self.cells[own] = point;
        true
    }
}

fn accumulate(starts: &mut [u32]) {
    let mut sum = 0;
    for start in starts {
        sum += *start;
        *start = sum;
    }
}

const fn hash(point: Point) -> u32 {
    let mut bits = (point.x as u32).wrapping_mul(0x9E37_79B1) ^ (point.y as u32).rotate_left(16);
    bits = (bits ^ bits >> 15).wrapping_mul(0x85EB_CA77);
    bits = (bits ^ bits >> 13).wrapping_mul(0xC2B2_AE3D);
    bits ^ bits >> 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_core::Boundary;

    const SIDE: f64 = 100.0;

    /// Returns one sample per squared r, not in order of position.
    fn grid() -> (Domain, Vec<Point>) {
        let domain = Domain::from_size([SIDE; 2], 1.0, Boundary::Bounded).unwrap();
        let at = |k: i32| Point::new((k % 100) * R + R / 2, (k / 100) * R + R / 2);
        let points = (0..10_000).map(|k| at(k * 37 % 10_000)).collect();
        (domain, points)
    }

    fn ids(order: &CellOrder, low: [f64; 2], high: [f64; 2], levels: usize) -> Vec<u32> {
        let ranges = order.ranges(low.into(), high.into(), levels);
        let positions = ranges.into_iter().flatten();
        positions
            .map(|position| order.ids[position as usize])
            .collect()
    }

    #[test]
    fn every_sample_has_one_position() {
        let (domain, points) = grid();
        let order = CellOrder::new(&domain, &points, &[]);
        let mut all = order.ids.clone();
        all.sort_unstable();
        assert!(all.iter().copied().eq(0..10_000));
        for (id, &position) in (0..).zip(&order.positions) {
            assert_eq!(order.ids[position as usize], id);
        }
        let whole = order.ranges(DVec2::splat(-9.0), DVec2::splat(SIDE + 9.0), LEVELS);
        assert_eq!(whole, vec![0..10_000], "all of it is one call");
    }

    #[test]
    fn a_view_holds_all_its_samples_and_few_others() {
        let (domain, points) = grid();
        let order = CellOrder::new(&domain, &points, &[]);
        let (low, high) = ([20.0, 31.0], [40.0, 44.0]);
        let seen = ids(&order, low, high, LEVELS);
        for (id, point) in (0..).zip(&points) {
            let (x, y) = (radii(point.x), radii(point.y));
            if low[0] <= x && x <= high[0] && low[1] <= y && y <= high[1] {
                assert!(seen.contains(&id), "{point:?}");
            }
        }
        assert!(seen.len() < 1_500, "{}", seen.len());
        assert!(ids(&order, [SIDE + 2.0, 0.0], [SIDE + 9.0, 9.0], LEVELS).is_empty());
    }

    #[test]
    fn levels_are_a_64th_a_16th_a_quarter_and_all_everywhere() {
        let (domain, points) = grid();
        let order = CellOrder::new(&domain, &points, &[]);
        for (levels, share) in [(1, 64), (2, 16), (3, 4), (4, 1)] {
            for corner in [[0.0, 0.0], [0.0, 50.0], [50.0, 0.0], [50.0, 50.0]] {
                let far = corner.map(|from| from + 49.0);
                let inside = |&id: &u32| {
                    let point = [points[id as usize].x, points[id as usize].y].map(radii);
                    (0..2).all(|k| corner[k] <= point[k] && point[k] <= far[k])
                };
                let seen = |levels| ids(&order, corner, far, levels);
                let count = |levels| seen(levels).iter().filter(|id| inside(id)).count() as f64;
                let (all, some) = (count(LEVELS), count(levels));
                let ratio = some * f64::from(share) / all;
                assert!((0.7..1.4).contains(&ratio), "{levels} {corner:?} {ratio}");
            }
        }
    }

    #[test]
    fn the_samples_of_a_thinned_set_keep_their_distance() {
        let (domain, points) = grid();
        let order = CellOrder::new(&domain, &points, &[]);
        let at = |id: u32| {
            let point = points[id as usize];
            DVec2::new(radii(point.x), radii(point.y))
        };
        for (levels, distance) in (1..).zip(DISTANCES) {
            let thinned = ids(&order, [0.0; 2], [SIDE; 2], levels);
            for (k, &a) in thinned.iter().enumerate() {
                let others = thinned[..k].iter().map(|&b| at(a).distance(at(b)));
                assert!(others.fold(f64::INFINITY, f64::min) >= distance);
            }
            // Every other sample is nearer than that to one of them.
            let is_near = |id: u32| thinned.iter().any(|&b| at(id).distance(at(b)) < distance);
            assert!((0..10_000).step_by(7).all(is_near));
        }
    }

    #[test]
    fn nested_levels_are_the_levels() {
        let (domain, points) = grid();
        let order = CellOrder::new(&domain, &points, &[100, 2_500, 10_000]);
        for (levels, count) in [(1, 100), (2, 2_500), (3, 10_000)] {
            let mut seen = ids(&order, [0.0; 2], [SIDE; 2], levels);
            seen.sort_unstable();
            assert!(seen.into_iter().eq(0..count));
        }
        let of = |count| order.levels_of(count);
        assert_eq!([of(0), of(100), of(101)], [(1, 100), (1, 100), (2, 2_500)]);
        assert_eq!(of(u32::MAX), (3, 10_000));
        let plain = CellOrder::new(&domain, &points, &[]);
        assert_eq!(plain.levels_of(u32::MAX), (LEVELS, 10_000));
    }

    #[test]
    fn samples_outside_the_domain_are_found_and_no_samples_work() {
        let domain = Domain::from_size([SIDE; 2], 1.0, Boundary::Bounded).unwrap();
        let order = CellOrder::new(&domain, &[Point::new(-R, 5 * R)], &[]);
        assert_eq!(ids(&order, [-1.2, 4.0], [-0.9, 6.0], LEVELS), [0]);
        let empty = CellOrder::new(&domain, &[], &[]);
        assert!(
            empty
                .ranges(DVec2::ZERO, DVec2::splat(SIDE), LEVELS)
                .is_empty()
        );
    }
}
