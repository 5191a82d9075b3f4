//! Sets whose radius depends on the place, in domains of any shape: [`varying_sample`].
//!
//! Two places of radii a and b are *near* each other if they are at most ceil(2ab / (a + b)) apart, the harmonic mean of
//! their radii, which is at most twice the smaller one. In the result no two samples are near each other, and each lattice
//! point of the domain is near a sample, with the radius that the point itself has.
//!
//! The set is that of a process of darts in which time is local: where the radius is R, darts come with the
//! intensity 1 / R^2, and a dart becomes a sample unless an earlier sample is near it. [`crate::stages::darts`] runs it.
//! With the radius [`R`](crate::R) everywhere it is the reference sampler, dart by dart. [`varying_sample`] makes the
//! same samples on all threads, and [`varying_window`] those in a window without the others.

mod crowd;
mod field;
mod ground;
mod locality;
mod near;
mod octaves;
mod parallel;
mod patch;
mod quadtree;
mod rule;
mod shape;
mod window;

use crate::error::SampleError;
use crate::lattice::Point;
use crate::progress::Observer;

pub use field::{FieldError, MAX_FIELD_RADIUS, MAX_PITCH_BITS, RadiusField};
pub use locality::Locality;
pub(crate) use shape::Class;
pub use shape::{Shape, ShapeError};
pub use window::{VaryingWindow, expected_in_window, varying_window};

/// Returns the samples of the field's domain inside `shape`, in the order of their arrival.
///
/// No two samples are near each other, and *no lattice point* of the shape is without a sample near it. Equal seeds, fields
/// and shapes give equal sequences. The first samples of a sequence are spread over the whole shape, the denser the smaller
/// the radius. Fails when `observer` stops it, or the system does not give the memory for grids as fine as the smallest radius.
/// Progress is reported as [`crate::Stage::Iterate`], one iteration for each throw.
pub fn varying_sample(
    field: &RadiusField,
    shape: &Shape,
    seed: u64,
    observer: &mut dyn Observer,
) -> Result<Vec<Point>, SampleError> {
    parallel::sample(field, shape, seed, observer)
}
