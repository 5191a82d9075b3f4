//! The pattern of nested levels: sets `P_0`, `P_1`, ... in a periodic square, each with all samples of the one before and
//! maximal at its own radius, made by throwing darts on at ever smaller radii (see [`crate::stages::darts`]).

use glam::I64Vec2;

use crate::error::SampleError;
use crate::lattice::{Boundary, Domain, Point, Rect};
use crate::parameters::PatternSpec;
use crate::pattern::{Pattern, PatternVariant, Symmetry};
use crate::progress::{Meter, Observer};
use crate::random::{Key, Stream, below};
use crate::stage::Stage;
use crate::stages::darts::{poisson, throw_key};

use super::grid::{LevelGrid, Place};
use super::radius::{LevelRadius, check_levels};

/// The shortest side of a pattern, in radii of its coarsest level.
const SHORTEST_SIDE: f64 = 12.0;

/// Throws of darts before cells are first divided.
const FIRST_THROWS: u32 = 4;

/// A nested pattern, from which blocks clip all levels at one place.
#[derive(Clone, Debug, PartialEq)]
pub struct NestedPattern {
    side: i32,
    /// The samples that each level adds, in canonical order.
    levels: Vec<Vec<Point>>,
}

impl NestedPattern {
    /// Returns the pattern of `levels` levels that `spec` describes, whose side is that of the spec or 12 times
    /// the coarsest radius, whichever is longer. No lattice point is uncovered at any level.
    ///
    /// Fails when the spec's side is out of range, there are no or too many levels, or `observer` stops it.
    pub fn generate(
        spec: &PatternSpec,
        levels: u32,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        check_levels(levels)?;
        let coarsest = LevelRadius::before(levels - 1);
        let shortest = (SHORTEST_SIDE * f64::from(coarsest.units)).ceil() as i32;
        let side = spec.side_units()?.max(shortest);
        let key = Key::from_seed(spec.seed).derive(Stream::Pattern, levels);
        let mut darts = NestedDarts::new(side);
        let mut made = Vec::with_capacity(levels as usize);
        let mut meter = Meter::begin(observer, Stage::Pattern, levels.into())?;
        for level in 0..levels {
            let radius = LevelRadius::before(levels - 1 - level);
            made.push(darts.fill(&radius, key.derive(Stream::Nested, level), &mut meter)?);
        }
        meter.end()?;
        Ok(Self { side, levels: made })
    }

    /// Returns the side in lattice units.
    #[must_use]
    pub const fn side(&self) -> i32 {
        self.side
    }

    /// Returns the samples that each level adds to the one before it.
    #[must_use]
    pub fn levels(&self) -> &[Vec<Point>] {
        &self.levels
    }

    /// Returns what each level adds under one symmetry, sorted into cells.
    pub(super) fn variant(&self, symmetry: Symmetry) -> Vec<LevelClip> {
        let domain = Domain::from_units(self.side, self.side, Boundary::Periodic);
        let finer = (0..self.levels.len() as u32).rev();
        let levels = self.levels.iter().zip(finer);
        let clip = |(samples, halvings): (&Vec<Point>, u32)| {
            let pattern = Pattern::of_samples(&domain, samples.clone(), true);
            LevelClip::new(
                &pattern.variant(symmetry),
                LevelRadius::before(halvings).bits,
            )
        };
        levels.map(clip).collect()
    }
}

/// What a level adds to the pattern, by rows of cells.
pub(super) struct LevelClip {
    side: i32,
    bits: u32,
    columns: usize,
    starts: Vec<u32>,
    points: Vec<Point>,
}

impl LevelClip {
    fn new(variant: &PatternVariant, bits: u32) -> Self {
        let columns = ((variant.width - 1) >> bits) as usize + 1;
        let cell = |p: Point| (p.y >> bits) as usize * columns + (p.x >> bits) as usize;
        let mut points: Vec<Point> = variant.samples.iter().map(|s| s.0).collect();
        points.sort_by_key(|p| cell(*p));
        let mut starts = vec![0_u32; columns * columns + 1];
        for p in &points {
            starts[cell(*p) + 1] += 1;
        }
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        Self {
            side: variant.width,
            bits,
            columns,
            starts,
            points,
        }
    }

    /// Calls `place` with every sample in `rect`, where the place (0, 0) shows the pattern's place `origin`.
    #[inline]
    pub fn clip(&self, origin: I64Vec2, rect: &Rect, mut place: impl FnMut(Point)) {
        let side = i64::from(self.side);
        let mut bottom = rect.min.y;
        while bottom < rect.max.y {
            let from_y = (origin[1] + i64::from(bottom)).rem_euclid(side) as i32;
            let rows = (rect.max.y - bottom).min(self.side - from_y);
            let mut left = rect.min.x;
            while left < rect.max.x {
                let from_x = (origin[0] + i64::from(left)).rem_euclid(side) as i32;
                let columns = (rect.max.x - left).min(self.side - from_x);
                let cell = |x: i32| (x >> self.bits) as usize;
                let (first, last) = (cell(from_x), cell(from_x + columns - 1));
                for row in cell(from_y)..=cell(from_y + rows - 1) {
                    let start = row * self.columns;
                    let from = self.starts[start + first] as usize;
                    let to = self.starts[start + last + 1] as usize;
                    for p in &self.points[from..to] {
                        let (x, y) = (p.x - from_x, p.y - from_y);
                        if (x as u32) < columns as u32 && (y as u32) < rows as u32 {
                            place(Point::new(left + x, bottom + y));
                        }
                    }
                }
                left += columns;
            }
            bottom += rows;
        }
    }
}

/// The dart process that makes a nested pattern, level by level.
struct NestedDarts {
    rect: Rect,
    samples: Vec<Point>,
    disks: LevelGrid,
}

impl NestedDarts {
    fn new(side: i32) -> Self {
        Self {
            rect: Rect {
                min: Point::default(),
                max: Point::new(side, side),
            },
            samples: Vec::new(),
            disks: LevelGrid::default(),
        }
    }

    /// Adds samples until no lattice point is uncovered at `radius`, and returns those in canonical order.
    fn fill(
        &mut self,
        radius: &LevelRadius,
        key: Key,
        meter: &mut Meter<'_>,
    ) -> Result<Vec<Point>, SampleError> {
        self.disks.reset(self.rect, true, radius);
        for &p in &self.samples {
            self.disks.insert(p);
        }
        let first = self.samples.len();
        let mut side = radius.side();
        let starts = || (0..=(self.rect.max.x - 1) / side).map(|k| k * side);
        let cells = starts().flat_map(|y| starts().map(move |x| Point::new(x, y)));
        let mut active: Vec<Point> = cells
            .filter(|&min| !self.covers(min, side, radius))
            .collect();
        let mut depth = 0;
        while !active.is_empty() {
            let throws = if depth == 0 { FIRST_THROWS } else { 1 };
            for throw in 0..throws {
                self.throw(&active, side, radius, throw_key(key, depth, throw));
                meter.ask()?;
            }
            if side == 1 {
                break;
            }
            side /= 2;
            depth += 1;
            let quarters = |min: Point| {
                let corners = [(0, 0), (side, 0), (0, side), (side, side)];
                corners.map(|(x, y)| Point::new(min.x + x, min.y + y))
            };
            let mut next: Vec<Point> = active.into_iter().flat_map(quarters).collect();
            next.retain(|&min| self.rect.contains(min) && !self.covers(min, side, radius));
            active = next;
        }
        let mut added = self.samples[first..].to_vec();
        added.sort_unstable_by_key(|p| p.canonical());
        Ok(added)
    }

    /// Throws darts at the active cells and keeps, by rank, those that no sample covers.
    fn throw(&mut self, active: &[Point], side: i32, radius: &LevelRadius, key: Key) {
        let mut darts: Vec<(u32, Point)> = Vec::new();
        for &min in active {
            let cell = key.derive_at(min.x, min.y);
            let count = if side == 1 {
                1
            } else {
                poisson(cell.words()[0])
            };
            for index in 0..count {
                let [x, y] = cell.draw(Stream::Dart, 2 * index);
                let [rank, _] = cell.draw(Stream::Dart, 2 * index + 1);
                let [x, y] = [x, y].map(|word| below(word, side as u32) as i32);
                let dart = Point::new(min.x + x, min.y + y);
                if self.rect.contains(dart) && self.disks.place(dart, radius) == Place::Free {
                    darts.push((rank, dart));
                }
            }
        }
        darts.sort_unstable_by_key(|(rank, dart)| (*rank, dart.row_major()));
        for (_, dart) in darts {
            if self.disks.place(dart, radius) == Place::Free {
                self.disks.insert(dart);
                self.samples.push(dart);
            }
        }
    }

    /// Returns whether one sample covers all lattice points of the domain in the cell at `min`.
    fn covers(&self, min: Point, side: i32, radius: &LevelRadius) -> bool {
        let reach = |from: i32, end: i32| side.min(end - from) - 1;
        let (width, height) = (reach(min.x, self.rect.max.x), reach(min.y, self.rect.max.y));
        let farthest = |from: i32, extent: i32| from.abs().max((from - extent).abs());
        // Such a sample is at most the radius away from the lowest point.
        self.disks.any_near(min, radius.units, |x, y| {
            radius.covers(farthest(x, width), farthest(y, height))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::R;
    use crate::progress::Unobserved;

    #[test]
    fn every_level_is_conflict_free_and_covers_every_lattice_point() {
        let levels = 5;
        let spec = PatternSpec {
            side: 40.0,
            ..PatternSpec::default()
        };
        let pattern = NestedPattern::generate(&spec, levels, &mut Unobserved).unwrap();
        let side = pattern.side();
        assert_eq!(side, 12 * 4 * R);
        let rect = Rect {
            min: Point::default(),
            max: Point::new(side, side),
        };
        let mut all = Vec::new();
        for (level, added) in (0..levels).zip(pattern.levels()) {
            let radius = LevelRadius::before(levels - 1 - level);
            let mut grid = LevelGrid::default();
            grid.reset(rect, true, &radius);
            all.extend_from_slice(added);
            for &p in &all {
                assert_eq!(grid.place(p, &radius), Place::Free, "level {level}");
                grid.insert(p);
            }
            assert_eq!(uncovered(&grid, &radius), None, "level {level}");
            let density = all.len() as f64 * radius.squared as f64 / f64::from(side).powi(2);
            assert!((0.64..0.75).contains(&density), "level {level}: {density}");
        }
        // The coarsest set is not maximal for the next radius.
        let mut grid = LevelGrid::default();
        let radius = LevelRadius::before(levels - 2);
        grid.reset(rect, true, &radius);
        pattern.levels()[0].iter().for_each(|&p| grid.insert(p));
        assert!(uncovered(&grid, &radius).is_some());
    }

    /// A lattice point that no sample covers: squares are divided until one sample covers all four of their corners.
    fn uncovered(grid: &LevelGrid, radius: &LevelRadius) -> Option<Point> {
        let end = grid.rect.max.x;
        let mut squares = vec![(Point::default(), end)];
        while let Some((min, side)) = squares.pop() {
            let last = |from: i32| (from + side).min(end) - 1;
            let (right, top) = (last(min.x) - min.x, last(min.y) - min.y);
            let covered = grid.any_near(min, radius.units, |x, y| {
                [(x, y), (x - right, y), (x, y - top), (x - right, y - top)]
                    .iter()
                    .all(|&(x, y)| radius.covers(x, y))
            });
            if covered {
                continue;
            }
            if side == 1 {
                return Some(min);
            }
            let half = (side + 1) / 2;
            for (x, y) in [(0, 0), (half, 0), (0, half), (half, half)] {
                if min.x + x < end && min.y + y < end && x < side && y < side {
                    squares.push((Point::new(min.x + x, min.y + y), half));
                }
            }
        }
        None
    }

    #[test]
    fn a_clip_equals_a_scan_of_the_repeated_pattern() {
        let spec = PatternSpec {
            side: 24.0,
            ..PatternSpec::default()
        };
        let pattern = NestedPattern::generate(&spec, 3, &mut Unobserved).unwrap();
        let side = pattern.side();
        for symmetry in (0..8).map(Symmetry) {
            for clip in pattern.variant(symmetry) {
                let rect = Rect {
                    min: Point::new(-3 * R, 5),
                    max: Point::new(31 * R, 61 * R),
                };
                let origin = I64Vec2::new((7 * R).into(), (-40 * R).into());
                let (mut clipped, mut scanned) = (Vec::new(), Vec::new());
                clip.clip(origin, &rect, |p| clipped.push(p.row_major()));
                for p in &clip.points {
                    let first = |p: i32, axis: usize, from: i32| {
                        let from = i64::from(from);
                        let ahead = (i64::from(p) - origin[axis] - from).rem_euclid(side.into());
                        (from + ahead) as i32
                    };
                    let (x, y) = (first(p.x, 0, rect.min.x), first(p.y, 1, rect.min.y));
                    for y in (y..rect.max.y).step_by(side as usize) {
                        for x in (x..rect.max.x).step_by(side as usize) {
                            scanned.push((y, x));
                        }
                    }
                }
                clipped.sort_unstable();
                scanned.sort_unstable();
                assert_eq!(clipped, scanned);
            }
        }
    }
}
