//! The parallel engine: any window of a run, computed from the blocks around it alone. A run is cut into windows that
//! fit the cache; windows share no data, so threads cannot change the result. Results equal those of the sequential
//! engine; tests compare the two byte for byte. Begin with `Plane::compute`, which runs the stages of one window.

// Only code that is inlined into the function with the instruction set's features may use them.
#![allow(clippy::inline_always)]

pub(crate) mod claim;
pub(crate) mod clip;
pub(crate) mod counts;
pub(crate) mod frame;
pub(crate) mod gaps;
mod near;
pub(crate) mod places;
pub(crate) mod plane;
pub(crate) mod region;
pub(crate) mod side_by_side;
mod stamp;
pub(crate) mod sweep;
mod uniform;
mod whole;
pub(crate) mod widened;
pub(crate) mod window_maker;
