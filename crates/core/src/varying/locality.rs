//! The field and the shape of a run whose darts were recorded, for questions about its places.

use super::field::RadiusField;
use super::ground::VaryingGround;
use super::quadtree::base_cells;
use super::rule::{is_near, reach};
use super::shape::Shape;
use crate::lattice::Point;
use crate::random::Key;
use crate::stages::darts::{DartGround, DartProcess};

/// Where a run's radius depends on the place, or its domain is a shape.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Locality {
    /// The radius at each lattice point of the domain.
    pub field: RadiusField,
    /// The lattice points that are to be covered.
    pub shape: Shape,
}

impl Locality {
    /// Returns the process of darts that makes the set of a seed.
    pub(crate) fn process(&self, seed: u64) -> DartProcess<impl DartGround> {
        let ground = VaryingGround::new(&self.field, &self.shape);
        let cells = base_cells(&self.field, &self.shape);
        DartProcess::on(ground, Key::from_seed(seed), cells)
    }

    /// Returns the radius at a place of the domain, in units.
    #[must_use]
    pub fn radius_at(&self, place: Point) -> i32 {
        self.field.radius_at(place)
    }

    /// Returns how far apart two places may be and still are near each other, in units: the harmonic mean of their radii,
    /// rounded up.
    #[must_use]
    pub fn reach(&self, a: Point, b: Point) -> i32 {
        reach(self.radius_at(a), self.radius_at(b))
    }

    /// Returns how far from a place samples that are near it can be, in units: twice its radius, however large others are.
    #[must_use]
    pub fn sight(&self, place: Point) -> i32 {
        2 * self.radius_at(place)
    }

    /// Returns whether two places are near each other.
    #[must_use]
    pub fn is_near(&self, a: Point, b: Point) -> bool {
        let squared = self.field.domain().distance_squared(a, b);
        is_near(squared, self.radius_at(a), self.radius_at(b))
    }

    /// Returns whether two places of these radii are near each other at this squared distance, all in units.
    #[inline]
    #[must_use]
    pub const fn near_at(squared: i64, [a, b]: [i32; 2]) -> bool {
        is_near(squared, a, b)
    }

    /// Returns whether a place of the domain belongs to the shape.
    #[must_use]
    pub fn inside(&self, place: Point) -> bool {
        self.shape.inside(place)
    }
}
