//! Units of length: the lattice of the core and r.

use tilescope_core::R;

/// Returns lattice units in r.
#[must_use]
pub fn radii(units: i32) -> f64 {
    f64::from(units) / f64::from(R)
}
