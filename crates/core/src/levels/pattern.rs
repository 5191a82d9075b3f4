//! The pattern of nested levels: sets `P_0`, `P_1`, ... in a periodic square, each with all samples of the one before and
//! maximal at its own radius, made by throwing darts on at ever smaller radii (see [`crate::stages::darts`]).

use glam::I64Vec2;

use crate::error::SampleError;
use crate::lattice::{Boundary, Domain, Point, Rect};
use crate::parameters::PatternSpec;
use crate::pattern::{Pattern, PatternVariant, Symmetry};
use crate::progress::Observer;
use crate::radius::Radius;
use crate::random::{Key, Stream};
use crate::stage::Stage;
use crate::stages::darts::DartProcess;
use crate::stages::disks::DiskGrid;

use super::check_levels;

/// The shortest side of a pattern, in radii of its coarsest level: more than the 10 that a periodic domain needs. The
/// 12 was chosen, not measured.
const SHORTEST_SIDE: f64 = 12.0;

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
        let coarsest = Radius::before(levels - 1);
        let shortest = (SHORTEST_SIDE * f64::from(coarsest.units)).ceil() as i32;
        let side = spec.side_units()?.max(shortest);

        // The number of levels is a part of the key: each number has a pattern of its own.
        let key = Key::from_seed(spec.seed).derive(Stream::Pattern, levels);
        let rect = Domain::from_units(side, side, Boundary::Periodic).rect();
        let mut samples: Vec<Point> = Vec::new();
        let mut made = Vec::with_capacity(levels as usize);

        for level in 0..levels {
            // A level keeps all samples of those before it, which are farther apart. From level to level the square of
            // the radius is halved, down to the finest radius.
            let finer_levels = levels - 1 - level;
            let mut disks = DiskGrid::default();
            let periodic = true;
            disks.reset(rect, periodic, Radius::before(finer_levels));
            let fits = samples.iter().all(|&p| disks.insert(p));
            debug_assert!(fits, "the samples are conflict-free");

            let mut darts = DartProcess::among(key.derive(Stream::Nested, level), disks);
            let mut added = Vec::new();
            while !darts.is_finished() {
                added.append(&mut darts.step(Stage::Pattern, observer)?);
            }

            samples.extend_from_slice(&added);
            added.sort_unstable_by_key(|p| p.canonical());
            made.push(added);
        }

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
            let covers_lattice = true;
            let pattern = Pattern::of_samples(&domain, samples.clone(), covers_lattice);
            LevelClip::new(&pattern.variant(symmetry), Radius::before(halvings).bits)
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
    /// Returns the samples of a variant sorted into cells of 2^`bits` units.
    fn new(variant: &PatternVariant, bits: u32) -> Self {
        let columns = ((variant.width - 1) >> bits) as usize + 1;
        let cell = |p: Point| (p.y >> bits) as usize * columns + (p.x >> bits) as usize;

        // Which samples of the pattern these are is not needed.
        let mut points: Vec<Point> = variant
            .samples
            .iter()
            .map(|(point, _index)| *point)
            .collect();
        points.sort_by_key(|p| cell(*p));

        // The pattern is a square, with as many rows of cells as columns.
        let mut starts = vec![0_u32; columns * columns + 1];
        for p in &points {
            starts[cell(*p) + 1] += 1;
        }

        // The sum of the counts of all cells before one is the index of its first sample.
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
            // The rectangle is cut where the periodic pattern begins again, so that within a part nothing wraps.
            let from_y = (origin[1] + i64::from(bottom)).rem_euclid(side) as i32;
            let part_height = (rect.max.y - bottom).min(self.side - from_y);

            let mut left = rect.min.x;
            while left < rect.max.x {
                let from_x = (origin[0] + i64::from(left)).rem_euclid(side) as i32;
                let part_width = (rect.max.x - left).min(self.side - from_x);

                let cell = |x: i32| (x >> self.bits) as usize;
                let (first, last) = (cell(from_x), cell(from_x + part_width - 1));
                for row in cell(from_y)..=cell(from_y + part_height - 1) {
                    let start = row * self.columns;
                    let from = self.starts[start + first] as usize;
                    let to = self.starts[start + last + 1] as usize;
                    for p in &self.points[from..to] {
                        let (x, y) = (p.x - from_x, p.y - from_y);
                        // Cells at the edges reach beyond the part. A negative offset becomes a number that is too large.
                        if (x as u32) < part_width as u32 && (y as u32) < part_height as u32 {
                            place(Point::new(left + x, bottom + y));
                        }
                    }
                }
                left += part_width;
            }
            bottom += part_height;
        }
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
            let radius = Radius::before(levels - 1 - level);
            let mut grid = DiskGrid::default();
            grid.reset(rect, true, radius);
            all.extend_from_slice(added);
            for &p in &all {
                assert!(!grid.covers(p) && grid.insert(p), "level {level}");
            }
            assert_eq!(grid.uncovered_point(0), None, "level {level}");
            let density = all.len() as f64 * radius.squared as f64 / f64::from(side).powi(2);
            assert!((0.64..0.75).contains(&density), "level {level}: {density}");
        }

        // The coarsest set is not maximal for the next radius.
        let mut grid = DiskGrid::default();
        grid.reset(rect, true, Radius::before(levels - 2));
        assert!(pattern.levels()[0].iter().all(|&p| grid.insert(p)));
        assert!(grid.uncovered_point(0).is_some());
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
