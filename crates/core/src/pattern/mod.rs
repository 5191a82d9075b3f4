//! The pattern: a small maximal set from which building blocks clip (paper, section 3.1.2).
//! A pattern that exists is conflict-free and maximal on the lattice: it was generated, checked, or
//! unpacked from bytes that only this program writes (`packed`).

mod cache;
mod packed;
mod ready;
mod sets;

pub use packed::PackedError;
pub use ready::{READY_MADE, ReadyMade};

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::error::SampleError;
use crate::lattice::{Domain, Point, Rect};
use crate::parameters::{Boundary, ParameterError, PatternSpec};
use crate::progress::Observer;
use crate::random::{Key, Stream};
use crate::reference::reference_sample;
use crate::stages::disks::DiskGrid;

/// How much farther than `R` (as a difference of squares) a lattice point of a *given* pattern may
/// be from its nearest sample: a distance of 0.12 units. With the 0.71 units between a place and
/// its lattice point and the 0.17 by which a unit may exceed its share of the radius that stays
/// below one unit, the promised (1 + 2^-15) r. Nearly all results of KDRT pass (seen: 0.24 units in
/// one of four sets of 865,000 samples, none elsewhere); those of the reference sampler always do.
const GIVEN_SLACK: i64 = 7_800;

/// The fewest samples to a squared radius that can cover a plane: 2 / (3 sqrt 3), the triangular
/// lattice's. Half of it allows for what lies beyond a closed border.
const LEAST_DENSITY: f64 = 0.5 * 0.384_9;

/// A maximal set that blocks clip from. Patterns are equal when blocks clip the same from them,
/// wherever they came from.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Pattern {
    domain: Domain,
    samples: Vec<Point>,
    /// What it was generated from; a given set has no seed.
    seed: Option<u64>,
    /// Whether every lattice point is known to be covered; a given set may miss some by a hair.
    covers_lattice: bool,
}

impl PartialEq for Pattern {
    fn eq(&self, other: &Self) -> bool {
        self.domain == other.domain && self.samples == other.samples
    }
}

/// One of the 8 symmetries of the square: mirrors of x (bit 0) and y (bit 1), then a swap of the
/// axes (bit 2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Symmetry(pub u8);

/// The pattern under one symmetry, row by row, ready to be clipped.
#[derive(Clone, Debug)]
pub struct Variant {
    /// Lattice columns: the period in a periodic pattern.
    pub width: i32,
    /// Lattice rows.
    pub height: i32,
    /// Whether the pattern repeats.
    pub periodic: bool,
    /// Positions by y, then x, each with its index in [`Pattern::samples`].
    pub samples: Vec<(Point, u32)>,
}

impl Pattern {
    /// Returns the pattern that `spec` describes, made by the reference sampler. Runs need not wait
    /// for that: [`Self::of_spec`] makes a pattern only when there is none yet.
    pub fn generate(spec: &PatternSpec, observer: &mut dyn Observer) -> Result<Self, SampleError> {
        let side = spec.side_units()?;
        let domain = Domain::from_units(side, side, spec.boundary);
        // A pattern's seed must not make the run's own draws when the two seeds are equal.
        let [low, high] = Key::from_seed(spec.seed).draw(Stream::Pattern, 0);
        let seed = u64::from(low) | u64::from(high) << 32;
        let mut restage = |mut progress: crate::Progress| {
            progress.stage = crate::Stage::Pattern;
            observer.observe(progress)
        };
        let samples =
            reference_sample(domain, seed, &mut restage).map_err(|error| match error {
                SampleError::Cancelled { .. } => SampleError::Cancelled {
                    stage: crate::Stage::Pattern,
                },
                other => other,
            })?;
        Ok(Self {
            domain,
            samples,
            seed: Some(spec.seed),
            covers_lattice: true,
        })
    }

    /// Returns the pattern of given positions in user units: a set of radius `radius` on
    /// `[0, size[0]] x [0, size[1]]`.
    ///
    /// Fails, naming samples and places in user units, when the set is empty, not finite, outside,
    /// too small, not conflict-free or not maximal once rounded to the lattice.
    pub fn from_positions(
        positions: &[[f64; 2]],
        size: [f64; 2],
        radius: f64,
        boundary: Boundary,
    ) -> Result<Self, PatternError> {
        if positions.is_empty() {
            return Err(PatternError::Empty);
        }
        let domain = Domain::from_size(size, radius, boundary)?;
        for (index, &[x, y]) in positions.iter().enumerate() {
            let inside = (0.0..=size[0]).contains(&x) && (0.0..=size[1]).contains(&y);
            if !inside {
                return Err(PatternError::Outside {
                    index,
                    position: [x, y],
                    size,
                });
            }
        }
        check_count(positions.len(), &domain)?;
        let samples = positions
            .iter()
            .map(|&p| domain.lattice_from_user(p))
            .collect();
        Self::checked(&domain, samples)
    }

    /// Returns the pattern of samples of `domain` if they are conflict-free and maximal.
    fn checked(domain: &Domain, mut samples: Vec<Point>) -> Result<Self, PatternError> {
        samples.sort_unstable_by_key(|p| p.canonical());
        let covers_lattice = check(domain, &samples)?;
        Ok(Self::of_samples(domain, samples, covers_lattice))
    }

    /// Returns the pattern of samples in canonical order that need no check.
    fn of_samples(domain: &Domain, samples: Vec<Point>, covers_lattice: bool) -> Self {
        Self {
            // Blocks see lattice units only; the user's unit ends here.
            domain: Domain::from_units(domain.width(), domain.height(), domain.boundary()),
            samples,
            seed: None,
            covers_lattice,
        }
    }

    /// Returns whether this is the pattern that [`Self::generate`] makes of `spec`.
    #[must_use]
    pub fn is_of(&self, spec: &PatternSpec) -> bool {
        let side = Ok(self.domain.width());
        spec.side_units() == side
            && self.domain.height() == self.domain.width()
            && self.domain.boundary() == spec.boundary
            && self.seed == Some(spec.seed)
    }

    /// Returns whether every lattice point is known to be covered by a sample within R.
    pub(crate) const fn covers_lattice(&self) -> bool {
        self.covers_lattice
    }

    /// Returns the pattern's domain; its user unit is one radius.
    #[must_use]
    pub const fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Returns the samples in canonical order.
    #[must_use]
    pub fn samples(&self) -> &[Point] {
        &self.samples
    }

    /// Returns the pattern under `symmetry`.
    #[must_use]
    pub fn variant(&self, symmetry: Symmetry) -> Variant {
        let extent = self.domain.rect().max;
        let map = |p: Point| {
            let x = if symmetry.0 & 1 == 0 {
                p.x
            } else {
                extent.x - 1 - p.x
            };
            let y = if symmetry.0 & 2 == 0 {
                p.y
            } else {
                extent.y - 1 - p.y
            };
            if symmetry.0 & 4 == 0 {
                Point::new(x, y)
            } else {
                Point::new(y, x)
            }
        };
        let mut samples: Vec<(Point, u32)> = self
            .samples
            .iter()
            .zip(0..)
            .map(|(&p, index)| (map(p), index))
            .collect();
        samples.sort_unstable_by_key(|(p, _)| p.row_major());
        let far = if symmetry.0 & 4 == 0 {
            extent
        } else {
            Point::new(extent.y, extent.x)
        };
        Variant {
            width: far.x,
            height: far.y,
            periodic: self.domain.is_periodic(),
            samples,
        }
    }
}

impl Variant {
    /// Calls `place` with the offset from the clip's corner and the pattern index of every sample
    /// in the `width` x `height` rectangle that starts at `start`, repeating a periodic pattern.
    pub fn clip(
        &self,
        start: Point,
        width: i32,
        height: i32,
        mut place: impl FnMut(i32, i32, u32),
    ) {
        // Segments of rows: [row, end) of the pattern lie at `up` in the clip. A clip as long as the
        // longest domain and a pattern's side together exceed 32 bits.
        let (mut row, mut up) = (i64::from(start.y), 0);
        let (width, height) = (i64::from(width), i64::from(height));
        while up < height {
            let end = (row + (height - up)).min(i64::from(self.height));
            let from = self.samples.partition_point(|(p, _)| i64::from(p.y) < row);
            let to = self.samples.partition_point(|(p, _)| i64::from(p.y) < end);
            for &(p, index) in &self.samples[from..to] {
                let mut right = i64::from(p.x) - i64::from(start.x);
                if right < 0 && self.periodic {
                    right += i64::from(self.width);
                }
                while (0..width).contains(&right) {
                    place(right as i32, (up + i64::from(p.y) - row) as i32, index);
                    if !self.periodic {
                        break;
                    }
                    right += i64::from(self.width);
                }
            }
            up += end - row;
            row = 0;
        }
    }

    /// Returns the rectangle of all starts at which a `width` x `height` clip fits.
    #[must_use]
    pub fn starts(&self, width: i32, height: i32) -> Option<Rect> {
        let max = if self.periodic {
            Point::new(self.width, self.height)
        } else {
            Point::new(self.width - width + 1, self.height - height + 1)
        };
        (max.x > 0 && max.y > 0).then_some(Rect {
            min: Point::new(0, 0),
            max,
        })
    }
}

/// Refuses too few samples, before any memory is taken that grows with the domain.
fn check_count(count: usize, domain: &Domain) -> Result<(), PatternError> {
    let area = domain.area_radii();
    if count == 0 {
        return Err(PatternError::Empty);
    }
    if (count as f64) < LEAST_DENSITY * area {
        return Err(PatternError::TooFew { count, area });
    }
    Ok(())
}

/// Checks a given set and returns whether it covers every lattice point.
fn check(domain: &Domain, samples: &[Point]) -> Result<bool, PatternError> {
    let conflict = |a: Point, b: Point| {
        let units = (domain.distance_squared(a, b) as f64).sqrt();
        PatternError::Conflict {
            first: domain.user_from_lattice(a),
            second: domain.user_from_lattice(b),
            radii: units / f64::from(crate::lattice::R),
        }
    };
    let mut grid = crate::grid::SampleGrid::with_capacity(*domain, samples.len());
    let mut disks = DiskGrid::new(*domain);
    for (&p, id) in samples.iter().zip(0..) {
        let mut other = None;
        grid.any_near(p, crate::lattice::R, |near| {
            let covered = crate::lattice::covers_offset(near.offset.0, near.offset.1);
            if covered {
                other = Some(samples[near.id as usize]);
            }
            covered
        });
        if let Some(other) = other {
            return Err(conflict(other, p));
        }
        grid.insert(id, p);
        let fits = disks.insert(p);
        debug_assert!(fits, "no conflict was found");
    }
    match disks.uncovered_point(GIVEN_SLACK) {
        None => Ok(disks.uncovered_point(0).is_none()),
        Some(p) => Err(PatternError::NotMaximal {
            witness: domain.user_from_lattice(p),
        }),
    }
}

/// Why a pattern cannot serve.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PatternError {
    /// There is no sample.
    #[error("the set is empty")]
    Empty,
    /// Its domain or radius is impossible.
    #[error("the set's domain is impossible: {0}")]
    Domain(#[from] ParameterError),
    /// A position is not finite or not inside.
    #[error("sample {index} of the set, ({}, {}), is not inside [0, {}] x [0, {}]", position[0], position[1], size[0], size[1])]
    Outside {
        /// Index of the position as given.
        index: usize,
        /// The position.
        position: [f64; 2],
        /// The pattern's size.
        size: [f64; 2],
    },
    /// Two samples are no farther apart than the radius.
    #[error("the set is not conflict-free: ({}, {}) and ({}, {}) are {radii:.6} r apart", first[0], first[1], second[0], second[1])]
    Conflict {
        /// One sample, in the pattern's units.
        first: [f64; 2],
        /// The other.
        second: [f64; 2],
        /// Their distance in radii.
        radii: f64,
    },
    /// So few samples cannot cover the domain.
    #[error(
        "the set is not maximal: {count} samples cannot cover {area:.1} squared radii; is its radius right?"
    )]
    TooFew {
        /// How many there are.
        count: usize,
        /// The area in squared radii.
        area: f64,
    },
    /// A place is not covered.
    #[error("the set is not maximal: no sample covers ({}, {})", witness[0], witness[1])]
    NotMaximal {
        /// The place, in the pattern's units.
        witness: [f64; 2],
    },
    /// A block does not fit a bounded pattern.
    #[error("a block of {:.2} x {:.2} r, enlarged by r on each side, does not fit a bounded pattern of {:.2} x {:.2} r: use a larger pattern, a periodic one or a smaller leaf", block[0], block[1], pattern[0], pattern[1])]
    TooSmall {
        /// The block's sides in radii.
        block: [f64; 2],
        /// The pattern's sides in radii.
        pattern: [f64; 2],
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::R;
    use crate::progress::Unobserved;

    fn small(boundary: Boundary) -> Pattern {
        let spec = PatternSpec {
            side: 14.5,
            boundary,
            seed: 3,
        };
        Pattern::generate(&spec, &mut Unobserved).unwrap()
    }

    fn positions(pattern: &Pattern) -> Vec<[f64; 2]> {
        pattern
            .samples
            .iter()
            .map(|&p| pattern.domain.user_from_lattice(p))
            .collect()
    }

    #[test]
    fn a_generated_pattern_passes_the_check_for_given_ones() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let pattern = small(boundary);
            let given =
                Pattern::from_positions(&positions(&pattern), pattern.domain.size(), 1.0, boundary);
            assert_eq!(given.unwrap(), pattern);
        }
    }

    #[test]
    fn bad_patterns_are_refused() {
        let pattern = small(Boundary::Periodic);
        let size = pattern.domain.size();
        let make = |p: &[[f64; 2]], r| Pattern::from_positions(p, size, r, Boundary::Periodic);
        let good = positions(&pattern);
        assert_eq!(make(&[], 1.0), Err(PatternError::Empty));
        let mut bad = good.clone();
        bad.remove(17);
        let removed = good[17];
        match make(&bad, 1.0) {
            Err(PatternError::NotMaximal { witness }) => {
                assert!((witness[0] - removed[0]).hypot(witness[1] - removed[1]) < 1.01);
            }
            other => panic!("{other:?}"),
        }
        let mut bad = good.clone();
        bad.push([good[3][0], good[3][1] + 0.5]);
        assert!(matches!(
            make(&bad, 1.0),
            Err(PatternError::Conflict { .. })
        ));
        bad.pop();
        bad.push([f64::NAN, 1.0]);
        assert!(matches!(make(&bad, 1.0), Err(PatternError::Outside { .. })));
        assert!(matches!(
            make(&good, 1.1),
            Err(PatternError::Conflict { .. })
        ));
        assert!(matches!(
            make(&good, 0.9),
            Err(PatternError::NotMaximal { .. })
        ));
        assert!(matches!(make(&good, 2.0), Err(PatternError::Domain(_))));
    }

    #[test]
    fn a_clip_equals_a_scan_of_the_repeated_pattern() {
        let pattern = small(Boundary::Periodic);
        for symmetry in (0..8).map(Symmetry) {
            let variant = pattern.variant(symmetry);
            let side = variant.width;
            for (k, (width, height)) in [(7 * R, 3 * R), (40 * R, 11 * R), (side, 31 * R)]
                .into_iter()
                .enumerate()
            {
                let start = Point::new(side - 1 - k as i32 * 5 * R, k as i32 * 3 * R + 17);
                let mut clipped = Vec::new();
                variant.clip(start, width, height, |x, y, index| {
                    clipped.push((y, x, index));
                });
                clipped.sort_unstable();
                let mut scanned = Vec::new();
                for &(p, index) in &variant.samples {
                    let shift = |p: i32, start: i32| (p - start).rem_euclid(side);
                    for y in (shift(p.y, start.y)..height).step_by(side as usize) {
                        for x in (shift(p.x, start.x)..width).step_by(side as usize) {
                            scanned.push((y, x, index));
                        }
                    }
                }
                scanned.sort_unstable();
                assert_eq!(clipped, scanned);
            }
        }
    }

    #[test]
    fn symmetries_keep_distances_and_differ() {
        let pattern = small(Boundary::Bounded);
        let original = pattern.variant(Symmetry(0)).samples;
        for symmetry in (1..8).map(Symmetry) {
            let turned = pattern.variant(symmetry).samples;
            assert_ne!(turned, original);
            let find = |set: &[(Point, u32)], id| set.iter().find(|s| s.1 == id).unwrap().0;
            let distance = |set: &[(Point, u32)]| {
                let (a, b) = (find(set, 0), find(set, 40));
                pattern.domain.distance_squared(a, b)
            };
            assert_eq!(distance(&turned), distance(&original));
        }
    }
}
