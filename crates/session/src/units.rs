//! Conversion from lattice units to r.

use glam::{DVec2, I64Vec2};
use tilescope_core::{Domain, Point, R};

/// Returns lattice units in r.
#[must_use]
pub fn radii(units: i32) -> f64 {
    f64::from(units) / f64::from(R)
}

/// Returns a point of the lattice in r.
#[must_use]
pub fn position(point: Point) -> DVec2 {
    DVec2::new(radii(point.x), radii(point.y))
}

/// Returns the place of the lattice nearest to a place in r.
#[must_use]
pub fn lattice(at: DVec2) -> I64Vec2 {
    (at * f64::from(R)).round().as_i64vec2()
}

/// Returns the size of a domain in r.
#[must_use]
pub fn size(domain: &Domain) -> DVec2 {
    DVec2::new(radii(domain.width()), radii(domain.height()))
}
