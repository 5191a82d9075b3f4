//! Rectangles, in pixels or in the units of a group.

use glam::DVec2;

/// A rectangle with sides along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// The corner with the smaller coordinates.
    pub min: DVec2,
    /// The corner with the larger coordinates.
    pub max: DVec2,
}

impl Rect {
    /// The rectangle between two opposite corners.
    #[must_use]
    pub fn new(min: impl Into<DVec2>, max: impl Into<DVec2>) -> Self {
        let (min, max) = (min.into(), max.into());
        Self { min, max }
    }

    /// Returns the lengths of the sides along x and along y.
    #[must_use]
    pub fn size(&self) -> DVec2 {
        self.max - self.min
    }

    pub(crate) fn middle(&self) -> DVec2 {
        self.min.midpoint(self.max)
    }

    /// The corners, clockwise from the upper left where y points down.
    pub(crate) fn corners(&self) -> [DVec2; 4] {
        let Self { min, max } = *self;
        [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)]
    }

    /// The rectangle with a margin around it.
    pub(crate) fn padded(&self, margin: f64) -> Self {
        Self::new(self.min - margin, self.max + margin)
    }

    /// Whether the insides of two rectangles have a place in common.
    #[must_use]
    pub fn meets(&self, other: &Self) -> bool {
        (self.min.cmplt(other.max) & other.min.cmplt(self.max)).all()
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }
}
