//! The pattern: a small maximal set from which building blocks clip (paper, section 3.1.2).
//! A pattern that exists is conflict-free and maximal on the lattice: it was generated or checked, both by
//! [`crate::pattern_making`].

use glam::IVec2;
use serde::{Deserialize, Serialize};

use crate::error::ParameterError;
use crate::lattice::{Domain, MIN_SIDE_RADII_BOUNDED, Point, Rect};

/// A maximal set that blocks clip from. Patterns are equal if their samples and domains are equal, whatever their
/// source.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Pattern {
    domain: Domain,
    samples: Vec<Point>,
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

impl Symmetry {
    /// Returns an offset in the pattern as it is under the symmetry.
    #[must_use]
    pub const fn turn(self, IVec2 { x, y }: IVec2) -> IVec2 {
        let x = if self.0 & 1 == 0 { x } else { -x };
        let y = if self.0 & 2 == 0 { y } else { -y };
        if self.0 & 4 == 0 {
            IVec2::new(x, y)
        } else {
            IVec2::new(y, x)
        }
    }

    /// Returns the offset of which [`Self::turn`] makes this one.
    #[must_use]
    pub const fn turn_back(self, turned: IVec2) -> IVec2 {
        let mirrors = Self(self.0 & 3);
        if self.0 & 4 == 0 {
            mirrors.turn(turned)
        } else {
            mirrors.turn(IVec2::new(turned.y, turned.x))
        }
    }

    /// Returns how far a turned pattern of the given number of columns and rows moves to have its lowest corner at 0
    /// again.
    #[must_use]
    pub const fn corner(self, extent: Point) -> IVec2 {
        let right = if self.0 & 1 == 0 { 0 } else { extent.x - 1 };
        let up = if self.0 & 2 == 0 { 0 } else { extent.y - 1 };
        if self.0 & 4 == 0 {
            IVec2::new(right, up)
        } else {
            IVec2::new(up, right)
        }
    }
}

/// The pattern under one symmetry, row by row, ready to be clipped.
#[derive(Clone, Debug)]
pub struct PatternVariant {
    /// Lattice columns: the period in a periodic pattern.
    pub width: i32,
    /// Lattice rows: the period in a periodic pattern.
    pub height: i32,
    /// Whether the pattern repeats.
    pub periodic: bool,
    /// Positions by y, then x, each with its index in [`Pattern::samples`].
    pub samples: Vec<(Point, u32)>,
}

impl Pattern {
    /// Returns the pattern of samples in canonical order that need no check.
    pub(crate) fn of_samples(domain: &Domain, samples: Vec<Point>, covers_lattice: bool) -> Self {
        Self {
            // Blocks use lattice units only, so the user's unit is dropped here.
            domain: Domain::from_units(domain.width(), domain.height(), domain.boundary()),
            samples,
            covers_lattice,
        }
    }

    /// Refuses a domain too narrow for a pattern from a file, which leaves places a little farther from its samples.
    pub fn check_domain(&self, domain: &Domain) -> Result<(), ParameterError> {
        let minimum = MIN_SIDE_RADII_BOUNDED;
        for (name, side) in ["width", "height"].into_iter().zip(domain.size()) {
            let radii = side / domain.radius();
            if !self.covers_lattice && radii < minimum {
                return Err(ParameterError::SideTooShort {
                    name,
                    radii,
                    minimum,
                });
            }
        }
        Ok(())
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
    pub fn variant(&self, symmetry: Symmetry) -> PatternVariant {
        let extent = self.domain.rect().max;
        // A mirror leads to negative coordinates: the pattern is moved back, so that they begin at 0 again.
        let corner = symmetry.corner(extent);

        let turn = |p: Point| {
            let turned = symmetry.turn(IVec2::new(p.x, p.y)) + corner;
            Point::new(turned.x, turned.y)
        };

        let mut samples: Vec<(Point, u32)> = self
            .samples
            .iter()
            .zip(0..)
            .map(|(&p, index)| (turn(p), index))
            .collect();
        // Clips find their rows by bisection.
        samples.sort_unstable_by_key(|(p, _)| p.row_major());

        // Bit 2 of a symmetry swaps the axes.
        let turned_extent = if symmetry.0 & 4 == 0 {
            extent
        } else {
            Point::new(extent.y, extent.x)
        };

        PatternVariant {
            width: turned_extent.x,
            height: turned_extent.y,
            periodic: self.domain.is_periodic(),
            samples,
        }
    }
}

impl PatternVariant {
    /// Calls `visit` with the offset from the clip's corner and the pattern index of every sample in the `width` x
    /// `height` rectangle that starts at `start`, a place of the pattern. A periodic pattern repeats; in a bounded one
    /// `start` must be one of [`Self::starts`].
    pub fn clip(
        &self,
        start: Point,
        width: i32,
        height: i32,
        mut visit: impl FnMut(i32, i32, u32),
    ) {
        // The pattern's rows from `row` to `end` lie in the clip from its row `up` on. Sums need 64 bits: a clip may be as
        // long as the longest domain, and a pattern's side is added to it.
        let (mut row, mut up) = (i64::from(start.y), 0);
        let (width, height) = (i64::from(width), i64::from(height));

        while up < height {
            // The clip's rows up to the next end of the pattern.
            let end = (row + (height - up)).min(i64::from(self.height));

            let from = self.samples.partition_point(|(p, _)| i64::from(p.y) < row);
            let to = self.samples.partition_point(|(p, _)| i64::from(p.y) < end);
            for &(p, index) in &self.samples[from..to] {
                // How far right of the clip's corner the sample first lies. In a periodic pattern one left of the corner
                // lies right of it one period later.
                let mut right = i64::from(p.x) - i64::from(start.x);
                if right < 0 && self.periodic {
                    right += i64::from(self.width);
                }

                while (0..width).contains(&right) {
                    visit(right as i32, (up + i64::from(p.y) - row) as i32, index);
                    if !self.periodic {
                        break;
                    }
                    right += i64::from(self.width);
                }
            }

            // After its last row a periodic pattern begins again. The clips of a bounded one end before.
            up += end - row;
            row = 0;
        }
    }

    /// Returns the rectangle of all starts at which a `width` x `height` clip fits, or `None` if it fits nowhere.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Boundary, R};
    use crate::parameters::PatternSpec;
    use crate::progress::Unobserved;

    #[test]
    fn a_pattern_that_leaves_lattice_points_uncovered_needs_wider_domains() {
        let domain = |side| Domain::from_size([side, 9.0], 1.0, Boundary::Bounded).unwrap();
        let made = small(Boundary::Periodic);
        let given = Pattern {
            covers_lattice: false,
            ..made.clone()
        };
        assert_eq!(made.check_domain(&domain(4.0)), Ok(()));
        assert_eq!(given.check_domain(&domain(6.0)), Ok(()));
        let refused = given.check_domain(&domain(5.9)).unwrap_err().to_string();
        assert!(
            refused.contains("the width is 5.9 r long; it must be at least 6 r"),
            "{refused}"
        );
    }

    fn small(boundary: Boundary) -> Pattern {
        let spec = PatternSpec {
            side: 14.5,
            boundary,
            seed: 3,
        };
        Pattern::generate(&spec, &mut Unobserved).unwrap()
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
