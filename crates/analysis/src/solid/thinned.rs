//! Judges sets in space that were chosen from others, as [`verify_thinned`](crate::verify_thinned) does planar ones: that no two
//! kept points are near each other, and that each point given is near a kept one that came earlier.
//!
//! All points are sorted by the cubes that they lie in. The points near a point of a cube lie in its cube or in one of the 26
//! around it, which are nine rows of three. When the cubes are visited in their order, each of these rows moves on only, so
//! that nine pointers into the sorted kept points find the near points, without a search.

use rayon::prelude::*;

use crate::exact::is_shorter;
use crate::findings::MAX_CONFLICTS;
use crate::monitor::{Control, Monitor};
use crate::thinned::ThinnedReport;

use super::SolidError;

/// Cubes are wider than the radius by this share, since coordinates in units of a cube are rounded: up to 2^29 cubes along an
/// axis, by a tenth of that.
const MARGIN: f64 = 1.0 / (1 << 20) as f64;

/// The longest extent of a cloud, in radii: with one cube more at either end, numbers of cubes fit into 30 bits.
const MAX_EXTENT: f64 = (1_u64 << 29) as f64;

/// Distances whose squares differ by less than this share of them are compared exactly. Three squares, two sums and the square of
/// the radius are each wrong by 2^-53 at most.
const DOUBT: f64 = 1.0 / (1_u64 << 48) as f64;

/// Points that a thread judges at a time: some milliseconds. Chosen, not measured.
const CHUNK: usize = 1 << 14;

/// Points in space that were given, and which of them were kept.
///
/// Points are *near* if dx^2 + dy^2 + dz^2 < r^2, compared exactly; dx, dy and dz are the differences of the coordinates, each
/// rounded to a double as a subtraction is.
#[derive(Clone, Copy, Debug)]
pub struct ThinnedSolid<'a> {
    /// The points that there were.
    pub given: &'a [[f64; 3]],
    /// Whether each of them was kept.
    pub kept: &'a [bool],
    /// The radius of all.
    pub radius: f64,
    /// Which came earlier: the one of the lesser rank. Without ranks, the one of the lesser index.
    pub ranks: Option<&'a [u32]>,
}

/// Judges a thinned set in space. Of each kind of fault at most `witnesses` are named.
///
/// # Errors
///
/// [`SolidError::Empty`], [`SolidError::TooMany`], [`SolidError::NotFinite`], [`SolidError::BadRadius`] for a radius that is not
/// above 0 and finite or is more than 2^29 times shorter than the extent of the points, and [`SolidError::Cancelled`].
///
/// # Panics
///
/// If a list has another length than that of the points given.
pub fn verify_thinned_solid(
    set: &ThinnedSolid<'_>,
    witnesses: usize,
    control: Control<'_>,
) -> Result<ThinnedReport, SolidError> {
    check(set)?;
    let low = extreme(set.given, f64::min);
    let high = extreme(set.given, f64::max);
    let longest = (0..3)
        .map(|axis| high[axis] - low[axis])
        .fold(0.0, f64::max);
    if longest / set.radius > MAX_EXTENT {
        let radius = set.radius;
        return Err(SolidError::BadRadius { radius });
    }

    let monitor = Monitor::begin(control, set.given.len() as u64)?;
    let mut all: Vec<Sited> = (0..set.given.len() as u32)
        .into_par_iter()
        .map(|index| Sited::new(set, low, index))
        .collect();
    // Sorted by cubes; indices differ, so that there is one order alone.
    all.par_sort_unstable();
    // Kept points stay sorted.
    let kept: Vec<Sited> = (all.par_iter().copied())
        .filter(|point| set.kept[point.index()])
        .collect();

    let search = ThinnedSearch {
        set,
        kept: &kept,
        witnesses,
    };
    let judged = |chunk: &[Sited]| {
        let found = search.chunk(chunk);
        monitor.advance(chunk.len() as u64)?;
        Ok(found)
    };
    let found: Result<Vec<ThinnedReport>, SolidError> = all.par_chunks(CHUNK).map(judged).collect();

    let mut report = ThinnedReport {
        given: set.given.len() as u64,
        kept: kept.len() as u64,
        ..ThinnedReport::default()
    };
    for part in found? {
        report.add(part, witnesses);
    }
    // Each chunk stops near the limit, but their sum may be beyond it.
    report.conflicts = report.conflicts.min(MAX_CONFLICTS);
    Ok(report)
}

/// Refuses sets that cannot be judged.
fn check(set: &ThinnedSolid<'_>) -> Result<(), SolidError> {
    let (count, limit) = (set.given.len(), u32::MAX as usize);
    assert_eq!(set.kept.len(), count, "one flag for each point");
    assert!(set.ranks.is_none_or(|ranks| ranks.len() == count));

    if count == 0 {
        return Err(SolidError::Empty);
    }
    // Indices are stored in 32 bits.
    if count > limit {
        return Err(SolidError::TooMany { count, limit });
    }
    let is_refused = |point: &[f64; 3]| point.iter().any(|at| !at.is_finite());
    if let Some(index) = set.given.par_iter().position_first(is_refused) {
        let point = set.given[index];
        return Err(SolidError::NotFinite { index, point });
    }
    if !(0.0 < set.radius && set.radius < f64::INFINITY) {
        let radius = set.radius;
        return Err(SolidError::BadRadius { radius });
    }
    Ok(())
}

/// Returns the least or the greatest coordinate of points on each axis; there is a point.
fn extreme(points: &[[f64; 3]], either: fn(f64, f64) -> f64) -> [f64; 3] {
    let both = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|axis| either(a[axis], b[axis]));
    let all = points.par_iter().copied();
    all.reduce_with(both).unwrap_or_default()
}

/// A point by the cube that it lies in and its index: 32 bits each for the cube's place along z, y and x, and for the index, so
/// that points sort by planes, rows and cubes.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Sited(u128);

impl Sited {
    fn new(set: &ThinnedSolid<'_>, low: [f64; 3], index: u32) -> Self {
        let point = set.given[index as usize];
        let width = set.radius * (1.0 + MARGIN);
        // From 1 on, so that there is a number below the first cube.
        let [x, y, z] = [0, 1, 2].map(|axis| ((point[axis] - low[axis]) / width) as u128 + 1);
        Self(z << 96 | y << 64 | x << 32 | u128::from(index))
    }

    const fn index(self) -> usize {
        self.0 as u32 as usize
    }

    /// Returns the cube: a number that is greater for a cube that comes later.
    const fn cube(self) -> u128 {
        self.0 >> 32
    }
}

/// Where a row of cubes lies from another one: planes and rows.
const ROWS: [[i128; 2]; 9] = [
    [-1, -1],
    [-1, 0],
    [-1, 1],
    [0, -1],
    [0, 0],
    [0, 1],
    [1, -1],
    [1, 0],
    [1, 1],
];

/// Returns the first of the three cubes in a row that are near a cube.
const fn first_of_row(cube: u128, [plane, row]: [i128; 2]) -> u128 {
    // Planes are 64 bits up and rows 32, and the first of three cubes lies one before the middle. No number leaves its 32 bits,
    // since cubes are numbered from 1 to 2^29 + 1.
    cube.wrapping_add_signed((plane << 64) + (row << 32) - 1)
}

/// The search for near points.
struct ThinnedSearch<'a> {
    set: &'a ThinnedSolid<'a>,
    /// The kept points, sorted.
    kept: &'a [Sited],
    witnesses: usize,
}

/// A kept point near a cube.
struct KeptPoint {
    place: [f64; 3],
    index: usize,
}

impl ThinnedSearch<'_> {
    /// Judges points that follow each other in the order of the cubes.
    fn chunk(&self, points: &[Sited]) -> ThinnedReport {
        let mut found = ThinnedReport::default();
        let Some(first) = points.first() else {
            return found;
        };
        // Where the three cubes of each row begin among the kept points; from here on these only move on.
        let mut begins = ROWS.map(|row| {
            let from = first_of_row(first.cube(), row);
            self.kept.partition_point(|kept| kept.cube() < from)
        });

        let mut near = Vec::new();
        for group in points.chunk_by(|a, b| a.cube() == b.cube()) {
            let cube = group[0].cube();
            near.clear();
            for (begin, row) in begins.iter_mut().zip(ROWS) {
                let from = first_of_row(cube, row);
                while self.kept.get(*begin).is_some_and(|kept| kept.cube() < from) {
                    *begin += 1;
                }
                let in_row = self.kept[*begin..].iter();
                near.extend(
                    in_row
                        .take_while(|kept| kept.cube() <= from + 2)
                        .map(|kept| {
                            let index = kept.index();
                            let place = self.set.given[index];
                            KeptPoint { place, index }
                        }),
                );
            }

            for point in group {
                // A set that was not thinned at all has more conflicts than are worth counting. It is refused anyway.
                if found.conflicts >= MAX_CONFLICTS {
                    return found;
                }
                self.point(point.index(), &near, &mut found);
            }
        }
        found
    }

    /// Judges a point against the kept points around it.
    fn point(&self, index: usize, near: &[KeptPoint], found: &mut ThinnedReport) {
        let set = self.set;
        let place = set.given[index];
        if set.kept[index] {
            // The pair is met from each of its points, and counts from the lower index.
            for other in near.iter().filter(|other| index < other.index) {
                if are_near(place, other.place, set.radius) {
                    found.conflicts += 1;
                    if found.conflicting.len() < self.witnesses {
                        found.conflicting.push([index, other.index]);
                    }
                }
            }
            return;
        }

        // Only an earlier point can have kept this one out.
        let rank = |index: usize| set.ranks.map_or(index as u32, |ranks| ranks[index]);
        let own = rank(index);
        let mut all = near.iter();
        let is_covered =
            all.any(|other| are_near(place, other.place, set.radius) && rank(other.index) < own);
        if !is_covered {
            found.uncovered += 1;
            if found.uncovered_points.len() < self.witnesses {
                found.uncovered_points.push(index);
            }
        }
    }
}

/// Returns whether two points are nearer than the radius.
fn are_near(a: [f64; 3], b: [f64; 3], radius: f64) -> bool {
    let sides = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let squared = sides[0] * sides[0] + sides[1] * sides[1] + sides[2] * sides[2];
    // Rounding cannot decide where the squares differ by more than the doubt.
    let limit = radius * radius;
    if (squared - limit).abs() > limit * DOUBT {
        return squared < limit;
    }
    is_shorter(sides, radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_are_decided_in_integers() {
        let near = |offset: [f64; 3], radius| are_near(offset, [0.0; 3], radius);
        assert!(!near([2.0, 3.0, 6.0], 7.0));
        assert!(near([2.0, -3.0, 6.0_f64.next_down()], 7.0));
        assert!(!near([2.0_f64.next_up(), 3.0, -6.0], 7.0));
        assert!(!near([5.0, 1e-300, 0.0], 5.0) && near([5.0, 1e-300, 0.0], 5.0_f64.next_up()));
        assert!(near([5.0_f64.next_down(), 1e-300, -1e-300], 5.0));
    }

    #[test]
    fn rows_of_cubes_are_found_by_one_addition() {
        let cube = |x: u128, y: u128, z: u128| z << 64 | y << 32 | x;
        assert_eq!(first_of_row(cube(5, 1, 7), [-1, -1]), cube(4, 0, 6));
        assert_eq!(first_of_row(cube(1, 1, 1), [1, 1]), cube(0, 2, 2));
        assert_eq!(first_of_row(cube(9, 9, 9), [0, 0]) + 2, cube(10, 9, 9));
    }
}
