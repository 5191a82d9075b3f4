//! The parallel engine: any window of a run, computed from the blocks around it alone.
//! A run is cut into windows that fit the cache; windows share nothing and write nothing that
//! another reads, so threads cannot change the result. It never decides differently from the
//! sequential engine: the two are compared byte for byte.

// Code must be inlined into the function that has the instruction set's features, or it has none of them.
#![allow(clippy::inline_always)]

mod claim;
pub(crate) mod clip;
pub(crate) mod counts;
pub(crate) mod frame;
pub(crate) mod gaps;
pub(crate) mod instructions;
mod near;
pub(crate) mod plane;
mod region;
mod stamp;
pub(crate) mod sweep;
mod uniform;
mod whole;
