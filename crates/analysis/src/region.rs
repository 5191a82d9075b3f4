//! The rectangle that a point set lives in and what its border means. Plain data with the limits that the verifier
//! accepts, each with its reason.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::number::Number;

/// What the border of a [`Region`] means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Boundary {
    /// Opposite sides are glued: the set repeats with periods `width` and `height`.
    Periodic,
    /// Nothing lies beyond the border, and only places inside it must be covered.
    Bounded,
}

/// An axis-parallel rectangle with one corner at the origin, in the length unit of the samples.
///
/// It is `[0, width) x [0, height)` when periodic and the closed `[0, width] x [0, height]` when
/// bounded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// The extent along x, in the unit of the samples.
    pub width: f64,
    /// The extent along y, in the unit of the samples.
    pub height: f64,
    /// What the border means.
    pub boundary: Boundary,
}

impl Region {
    /// The largest accepted extent, 2^100. With [`Self::MIN_EXTENT`] it keeps the power of two that
    /// scales the region to unit size, and every squared extent, far inside the range of `f64`.
    pub const MAX_EXTENT: f64 = f64::from_bits((1023 + 100) << 52);
    /// The smallest accepted extent, 2^-100.
    pub const MIN_EXTENT: f64 = f64::from_bits((1023 - 100) << 52);
    /// The largest accepted ratio of the two extents, 2^40: beyond it the short side drowns in the
    /// rounding of sums with the long one.
    pub const MAX_ASPECT: f64 = f64::from_bits((1023 + 40) << 52);

    /// The periodic unit square: the domain of a set whose domain is not stated.
    pub const UNIT_SQUARE: Self = Self::new([1.0, 1.0], true);

    /// Returns the periodic or bounded region of a width and a height.
    #[must_use]
    pub const fn new([width, height]: [f64; 2], is_periodic: bool) -> Self {
        Self {
            width,
            height,
            boundary: if is_periodic {
                Boundary::Periodic
            } else {
                Boundary::Bounded
            },
        }
    }

    /// Returns the width and the height.
    #[must_use]
    pub const fn size(&self) -> [f64; 2] {
        [self.width, self.height]
    }

    /// Whether opposite sides are glued.
    #[must_use]
    pub const fn is_periodic(&self) -> bool {
        matches!(self.boundary, Boundary::Periodic)
    }

    /// The area, `width * height`.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.width * self.height
    }

    /// Whether `point` lies in the region, with no tolerance; false for NaN.
    #[must_use]
    pub fn contains(&self, point: [f64; 2]) -> bool {
        let last = self.last_point();
        (0..2).all(|axis| point[axis] >= 0.0 && point[axis] <= last[axis])
    }

    /// The same rectangle with all of its sides, as those of a torus seen in the plane.
    #[must_use]
    pub const fn closed(self) -> Self {
        Self::new(self.size(), false)
    }

    /// The extent of its shorter side.
    #[must_use]
    pub const fn shorter_side(&self) -> f64 {
        self.width.min(self.height)
    }

    /// The largest coordinates of a point of the region.
    pub(crate) fn last_point(&self) -> [f64; 2] {
        [self.width, self.height].map(|extent| match self.boundary {
            Boundary::Periodic => extent.next_down(),
            Boundary::Bounded => extent,
        })
    }

    /// Whether both extents and their ratio are within the limits above.
    #[must_use]
    pub fn is_supported(&self) -> bool {
        let range = Self::MIN_EXTENT..=Self::MAX_EXTENT;
        let (short, long) = (self.shorter_side(), self.width.max(self.height));
        // Both extents are asked, because min and max would pass over a NaN.
        range.contains(&self.width)
            && range.contains(&self.height)
            && long / short <= Self::MAX_ASPECT
    }
}

impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, end) = match self.boundary {
            Boundary::Periodic => ("periodic", ')'),
            Boundary::Bounded => ("bounded", ']'),
        };
        let (width, height) = (Number(self.width), Number(self.height));
        write!(f, "{name} [0, {width}{end} x [0, {height}{end}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn region(boundary: Boundary) -> Region {
        Region {
            width: 2.0,
            height: 1.0,
            boundary,
        }
    }

    #[test]
    fn only_a_bounded_region_contains_its_far_sides() {
        assert!(region(Boundary::Bounded).contains([2.0, 1.0]));
        assert!(!region(Boundary::Periodic).contains([2.0, 0.5]));
        assert!(!region(Boundary::Periodic).contains([0.5, 1.0]));
        assert!(region(Boundary::Periodic).contains([0.0, 0.0]));
        assert!(!region(Boundary::Bounded).contains([f64::NAN, 0.5]));
        assert!(!region(Boundary::Bounded).contains([-f64::MIN_POSITIVE, 0.5]));
    }

    #[test]
    fn extents_outside_the_limits_are_not_supported() {
        let with = |width, height| Region {
            width,
            height,
            boundary: Boundary::Periodic,
        };
        assert!(with(1.0, 1.0).is_supported());
        assert!(with(1.0, 1e12).is_supported());
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e31, 1e-31, 1e-13] {
            assert!(!with(1.0, bad).is_supported(), "{bad}");
            assert!(!with(bad, 1.0).is_supported(), "{bad}");
        }
    }

    #[test]
    fn is_written_as_an_interval_product() {
        let text = region(Boundary::Periodic).to_string();
        assert_eq!(text, "periodic [0, 2) x [0, 1)");
        let text = Region::new([2.0, 1.0], false).to_string();
        assert_eq!(text, "bounded [0, 2] x [0, 1]");
    }
}
