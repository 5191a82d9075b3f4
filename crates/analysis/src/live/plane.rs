//! Where samples come and go: a rectangle of whole places.

use crate::region::{Boundary, Region};

/// A rectangle of whole places, its boundary and the radius, all in one unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plane {
    /// The width and the height, in units.
    pub size: [u32; 2],
    /// The Poisson-disk radius, in units.
    pub radius: u32,
    /// What the border means.
    pub boundary: Boundary,
}

impl Plane {
    /// Returns the same rectangle in radii.
    #[must_use]
    pub fn region_in_radii(&self) -> Region {
        let [width, height] = self
            .size
            .map(|side| f64::from(side) / f64::from(self.radius));
        Region {
            width,
            height,
            boundary: self.boundary,
        }
    }
}
