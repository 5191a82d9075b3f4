//! The field and the shape of a run whose darts were recorded, for questions about its places.

use super::field::RadiusField;
use super::ground::VaryingGround;
use super::octaves::octave_of;
use super::quadtree::base_cells;
use super::rule::{is_near, reach};
use super::shape::Shape;
use crate::lattice::Point;
use crate::random::Key;
use crate::stages::darts::{DartGround, DartProcess};
use crate::stages::disks::Cell;

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

    /// Returns the side of the cell in which darts around a place of the domain begin to fall, in units: that of the largest aligned
    /// square of a power of two that is no wider than the least radius in it.
    #[must_use]
    pub fn base_side(&self, place: Point) -> i32 {
        let square = |bits: u8| Cell {
            min: Point::new(place.x >> bits << bits, place.y >> bits << bits),
            side: 1 << bits,
        };
        let suits = |bits: &u8| (1 << *bits) <= self.field.range(square(*bits)).least;

        // As the process of darts finds its cells: from the largest radius down. A square of one unit always suits.
        let top = octave_of(self.field.whole().greatest);
        1 << (0..=top).rev().find(suits).unwrap_or(0)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Boundary, Domain, R};

    #[test]
    fn the_base_side_is_that_of_the_cell_in_which_darts_fall() {
        let domain = Domain::from_size([8.0, 8.0], 1.0, Boundary::Bounded).expect("a domain");
        let [columns, rows] = RadiusField::node_counts(&domain, 15).expect("nodes");
        let radii: Vec<i32> = (0..columns * rows)
            .map(|node| R + (node % columns) as i32 * R / 3)
            .collect();
        let field = RadiusField::from_nodes(domain, 15, &radii).expect("a field");
        let locality = Locality {
            field,
            shape: Shape::rectangle(),
        };

        let cells = base_cells(&locality.field, &locality.shape);
        // Radii rise from one R to more than three, so that cells have two sides.
        assert!(cells.iter().any(|cell| cell.base_bits == 15));
        assert!(cells.iter().any(|cell| cell.base_bits == 16));
        for cell in cells {
            let square = cell.square();
            let last = Point::new(
                square.min.x + square.side - 1,
                square.min.y + square.side - 1,
            );
            for place in [square.min, last] {
                assert_eq!(locality.base_side(place), square.side, "{place:?}");
            }
        }
    }
}
