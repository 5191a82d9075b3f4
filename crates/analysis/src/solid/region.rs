//! The box that a set in space lives in.

use std::fmt;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::number::Number;
use crate::region::{Boundary, Region};

/// An axis-parallel box with one corner at the origin, in the length unit of the samples: half open when periodic, closed
/// when bounded, as a [`Region`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolidRegion {
    /// The extent along x, in the unit of the samples.
    pub width: f64,
    /// The extent along y, in the unit of the samples.
    pub height: f64,
    /// The extent along z, in the unit of the samples.
    pub depth: f64,
    /// What the border means.
    pub boundary: Boundary,
}

impl SolidRegion {
    /// The largest accepted ratio of two extents, 2^20: coordinates of a long box are then exact to 2^-30 of its short sides.
    pub const MAX_ASPECT: f64 = 1_048_576.0;

    /// Returns the width, the height and the depth.
    #[must_use]
    pub const fn size(&self) -> [f64; 3] {
        [self.width, self.height, self.depth]
    }

    /// Whether opposite sides are glued.
    #[must_use]
    pub const fn is_periodic(&self) -> bool {
        matches!(self.boundary, Boundary::Periodic)
    }

    /// The volume, `width * height * depth`.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.size().iter().product()
    }

    /// Whether `point` lies in the region, with no tolerance; false for NaN.
    #[must_use]
    pub fn contains(&self, point: [f64; 3]) -> bool {
        let size = self.size();
        (0..3).all(|axis| {
            let (value, extent) = (point[axis], size[axis]);
            let is_below = match self.boundary {
                Boundary::Periodic => value < extent,
                Boundary::Bounded => value <= extent,
            };
            value >= 0.0 && is_below
        })
    }

    /// Whether all extents and their ratios are within the limits.
    #[must_use]
    pub fn is_supported(&self) -> bool {
        let range = Region::MIN_EXTENT..=Region::MAX_EXTENT;
        // Each extent is asked, because min and max would pass over a NaN.
        self.size().iter().all(|extent| range.contains(extent))
            && self.longest() / self.shortest() <= Self::MAX_ASPECT
    }

    pub(super) const fn shortest(&self) -> f64 {
        self.width.min(self.height).min(self.depth)
    }

    pub(super) const fn longest(&self) -> f64 {
        self.width.max(self.height).max(self.depth)
    }

    /// Returns the distance of two places, around the torus if the region is periodic.
    pub(super) fn distance(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        DVec3::from(self.apart(a, b)).length()
    }

    /// Returns how far apart two places are along each axis, around the torus if the region is periodic.
    pub(super) fn apart(&self, a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        let inside = (DVec3::from(a) - DVec3::from(b)).abs();
        let apart = if self.is_periodic() {
            inside.min(DVec3::from(self.size()) - inside)
        } else {
            inside
        };
        apart.into()
    }
}

impl fmt::Display for SolidRegion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, end) = match self.boundary {
            Boundary::Periodic => ("periodic", ')'),
            Boundary::Bounded => ("bounded", ']'),
        };
        let [x, y, z] = self.size().map(Number);
        write!(f, "{name} [0, {x}{end} x [0, {y}{end} x [0, {z}{end}")
    }
}
