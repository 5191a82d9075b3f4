//! The region in the verifier's own unit: a power of two that makes the longer side 1 to 2. Scaling by a power of two
//! is exact, so every comparison decides as it would in the caller's unit. The samples are in [`crate::grid`] and in
//! `circles`.

use glam::DVec2;

use crate::border::BorderLine;
use crate::error::VerifyError;
use crate::region::{Boundary, Region};

/// Radii are accepted between this fraction of the longer side, 2^-100, and its inverse: squares
/// and the density then stay finite and nonzero.
const MIN_RELATIVE_RADIUS: f64 = Region::MIN_EXTENT;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Domain {
    /// The width and the height, in the unit of the domain.
    pub extent: DVec2,
    pub periodic: bool,
    /// Multiplies the caller's lengths.
    pub scale: f64,
}

impl Domain {
    pub fn new(region: Region) -> Result<Self, VerifyError> {
        let Region { width, height, .. } = region;
        if !region.is_supported() {
            return Err(VerifyError::BadRegion { width, height });
        }
        // The exponent field of 1 / 2^floor(log2(longer)): extents are normal numbers.
        let exponent = width.max(height).to_bits() >> 52;
        let scale = f64::from_bits((2 * 1023 - exponent) << 52);
        Ok(Self {
            extent: DVec2::new(width, height) * scale,
            periodic: region.boundary == Boundary::Periodic,
            scale,
        })
    }

    /// The radius in this unit.
    pub fn scale_radius(&self, radius: f64) -> Result<f64, VerifyError> {
        let longer = self.extent.max_element();
        let limits = longer * MIN_RELATIVE_RADIUS..=longer / MIN_RELATIVE_RADIUS;
        Some(radius * self.scale)
            .filter(|scaled| limits.contains(scaled))
            .ok_or(VerifyError::BadRadius { radius })
    }

    /// A sample in this unit; adding zero turns -0 into 0.
    pub fn scale_point(&self, point: [f64; 2]) -> DVec2 {
        DVec2::from(point) * self.scale + 0.0
    }

    /// The period of each axis, infinite when bounded.
    pub fn periods(&self) -> DVec2 {
        if self.periodic {
            self.extent
        } else {
            DVec2::INFINITY
        }
    }

    /// The lines beyond which nothing lies; a torus has none.
    pub fn border(&self) -> &'static [BorderLine] {
        if self.periodic { &[] } else { &BorderLine::ALL }
    }

    /// Returns the distance below which two places are the same, where samples are about `length` apart.
    pub fn same_place(&self, length: f64) -> f64 {
        // A place is known to about 2^-50 of the extent, and Voronoi vertices of a random set
        // are hardly ever closer than 2^-30 r.
        let longer = self.extent.max_element();
        (length * 2f64.powi(-30)).max(longer * 2f64.powi(-46))
    }

    /// Moves a place of a torus such that places at the seam, from either side, come out near zero, possibly just below.
    pub fn at_seam(&self, place: DVec2, same: f64) -> DVec2 {
        let beyond = place.cmpge(self.periods() - 2.0 * same);
        DVec2::select(beyond, place - self.extent, place)
    }

    /// The side of a square that holds one sample on average.
    pub fn spacing(&self, count: usize) -> f64 {
        (self.extent.element_product() / count as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scaling_is_an_exact_power_of_two() {
        for width in [1.0, 0.999, 1e-20, 3e20, 7.0] {
            let height = width / 3.0;
            let boundary = Boundary::Periodic;
            let region = Region {
                width,
                height,
                boundary,
            };
            let domain = Domain::new(region).expect("supported");
            assert!((1.0..2.0).contains(&domain.extent[0]), "{width}");
            assert_eq!(domain.extent[0] / domain.scale, width);
            assert_eq!(domain.extent[1] / domain.scale, height);
            assert_eq!(domain.scale.to_bits() & ((1 << 52) - 1), 0);
        }
    }
}
