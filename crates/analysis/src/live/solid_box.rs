//! Where samples in space come and go: a box of whole places.

use crate::region::Boundary;

/// A box of whole places, its boundary and the radius, all in one unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolidBox {
    /// The width, the height and the depth, in units.
    pub size: [u32; 3],
    /// The Poisson-disk radius, in units.
    pub radius: u32,
    /// What the border means.
    pub boundary: Boundary,
}

impl SolidBox {
    /// Returns the volume in cubed radii.
    #[must_use]
    pub fn volume_in_radii(&self) -> f64 {
        let radius = f64::from(self.radius);
        self.size
            .map(|side| f64::from(side) / radius)
            .iter()
            .product()
    }
}
