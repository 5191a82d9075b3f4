//! The box that balls lie in, on the lattice, with its exact relation to user space.

use serde::{Deserialize, Serialize};

use crate::error::ParameterError;
use crate::lattice::{Boundary, R, side_units};

use super::Place;

/// The shortest side of a box, in radii. If a periodic side is longer than two radii, at most one image of a sample
/// covers a place. A side is rounded down to whole units, which makes a unit longer than its share of the radius. Sides
/// of at least four radii keep this excess small (see [`SolidDomain::covering_bound`]).
pub const MIN_SIDE_RADII_SOLID: f64 = 4.0;

/// The largest volume of a box, in cubed radii, 2^30: some 800 million samples. The darts of a throw, 1.4 to a
/// cube of side r, and their images are then fewer than 2^32.
pub const MAX_VOLUME_RADII: f64 = 1_073_741_824.0;

/// A box of lattice points with one corner at the origin.
///
/// A periodic box holds the points `0 <= x < side` on each axis; a bounded one is closed and also holds `x == side`. A
/// unit is never shorter than `radius / R` on any axis, so two samples more than `R` units apart are farther apart than
/// the user's radius.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidDomain {
    sides: Place,
    boundary: Boundary,
    size: [f64; 3],
    radius: f64,
}

impl SolidDomain {
    /// Returns the domain of a box of a width, a height and a depth in user units, sampled with `radius`.
    ///
    /// Fails when a number is not finite or not positive, a side is shorter or longer in radii than
    /// [`MIN_SIDE_RADII_SOLID`] and [`crate::MAX_SIDE_RADII`] allow, or the volume is above [`MAX_VOLUME_RADII`].
    pub fn from_size(
        size: [f64; 3],
        radius: f64,
        boundary: Boundary,
    ) -> Result<Self, ParameterError> {
        if !radius.is_finite() || radius <= 0.0 {
            return Err(ParameterError::Radius { radius });
        }

        let units = |axis: usize, name| side_units(name, size[axis], radius, MIN_SIDE_RADII_SOLID);
        let domain = Self {
            sides: [units(0, "width")?, units(1, "height")?, units(2, "depth")?],
            boundary,
            size,
            radius,
        };

        let volume = domain.volume_radii();
        if volume > MAX_VOLUME_RADII {
            let maximum = MAX_VOLUME_RADII;
            return Err(ParameterError::Volume { volume, maximum });
        }
        Ok(domain)
    }

    /// Returns the sides in lattice units.
    #[must_use]
    pub const fn sides(&self) -> [i32; 3] {
        self.sides
    }

    /// Returns how the box ends.
    #[must_use]
    pub const fn boundary(&self) -> Boundary {
        self.boundary
    }

    /// Returns the width, the height and the depth in user units.
    #[must_use]
    pub const fn size(&self) -> [f64; 3] {
        self.size
    }

    /// Returns the radius in user units.
    #[must_use]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns the volume in cubed radii.
    #[must_use]
    pub fn volume_radii(&self) -> f64 {
        let radii = self.sides.map(|side| f64::from(side) / f64::from(R));
        radii.iter().product()
    }

    /// Returns the promised bound on the covering radius, in user units: at most (1 + 2^-15) radius where all sides have
    /// 8 r or are multiples of r, and never more than (1 + 1.13 * 2^-15) radius.
    ///
    /// A place is within sqrt(3) / 2 < 7/8 units of a lattice point, which is within R units of a sample. A unit exceeds
    /// `radius / R` by at most one part in the shortest side's units.
    #[must_use]
    pub fn covering_bound(&self) -> f64 {
        let longest_unit = self.unit().into_iter().fold(0.0, f64::max);
        (f64::from(R) + 0.875) * longest_unit
    }

    /// Returns the positions in user units, inside the closed box.
    #[must_use]
    pub fn users_from_lattice(&self, places: &[[i32; 3]]) -> Vec<[f64; 3]> {
        let unit = self.unit();
        let user = |place: &Place| {
            [0, 1, 2].map(|axis| (f64::from(place[axis]) * unit[axis]).min(self.size[axis]))
        };
        places.iter().map(user).collect()
    }

    /// Returns the lengths of a lattice unit along each axis, in user units.
    fn unit(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.size[axis] / f64::from(self.sides[axis]))
    }

    /// Returns a bounded box of the lattice alone, from 0 to a highest place: the frame of a window in space without end. Its user
    /// units are those of the lattice.
    pub(super) fn of_last(last: Place) -> Self {
        Self {
            sides: last,
            boundary: Boundary::Bounded,
            size: last.map(f64::from),
            radius: f64::from(R),
        }
    }

    /// Returns the highest place.
    pub(super) fn last(&self) -> Place {
        let beyond = match self.boundary {
            Boundary::Periodic => 1,
            Boundary::Bounded => 0,
        };
        self.sides.map(|side| side - beyond)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_boxes_are_refused_with_value_and_limit() {
        let refused = |size, radius| {
            let domain = SolidDomain::from_size(size, radius, Boundary::Periodic);
            domain.expect_err("a refusal").to_string()
        };
        assert!(refused([10.0, 10.0, 0.0], 1.0).starts_with("the depth is 0"));
        assert!(refused([10.0; 3], f64::NAN).contains("radius is NaN"));
        let short = refused([10.0, 3.9, 10.0], 1.0);
        assert!(short.contains("height is 3.9 r long; it must be at least 4 r"));
        assert!(refused([1.0; 3], 1e-5).contains("at most 65,532 r"));
        let volume = refused([2_000.0; 3], 1.0);
        assert!(volume.contains("8,000,000,000 cubes of side r"), "{volume}");
        assert!(volume.contains("at most 1,073,741,824"), "{volume}");
    }

    #[test]
    fn the_bound_is_that_of_the_certificate_from_eight_radii_on() {
        for k in 0..3_000 {
            let side = 4.0 + f64::from(k) * 0.003_1;
            let radius = 0.7 + f64::from(k) * 1e-5;
            let size = [side * radius, 20.0, 30.0];
            let domain = SolidDomain::from_size(size, radius, Boundary::Bounded).unwrap();
            let beyond = (domain.covering_bound() / radius - 1.0) * f64::from(R);
            assert!((0.875..1.13).contains(&beyond), "{side}: {beyond}");
            assert!(side < 8.0 || beyond <= 1.0, "{side}: {beyond}");
        }
        let whole = SolidDomain::from_size([4.0, 5.0, 6.0], 1.0, Boundary::Bounded).unwrap();
        assert!(whole.covering_bound() < 1.0 + 0.876 / f64::from(R));
    }

    #[test]
    fn positions_stay_in_the_box() {
        let domain = SolidDomain::from_size([0.3, 0.7, 0.9], 0.01, Boundary::Bounded).unwrap();
        let [corner] = domain.users_from_lattice(&[domain.last()])[..] else {
            panic!("one position");
        };
        assert!(corner[0] <= 0.3 && corner[1] <= 0.7 && corner[2] <= 0.9);
        assert!(corner[0] > 0.299_999 && corner[2] > 0.899_999);
    }
}
