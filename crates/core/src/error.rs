//! Errors of runs, parameters and patterns, with one variant for each cause.

mod parameters;
mod pattern;

use thiserror::Error;

use crate::memory::NoMemory;
use crate::stage::Stage;

pub use parameters::ParameterError;
pub use pattern::PatternError;

/// Why a set could not be sampled.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SampleError {
    /// The parameters cannot be sampled.
    #[error(transparent)]
    Parameters(#[from] ParameterError),
    /// The pattern cannot be used.
    #[error(transparent)]
    Pattern(#[from] PatternError),
    /// A window of the parallel engine depends on too much around it.
    #[error(
        "a part of this set depends on more than {radii} r around it (the pattern leaves too many places uncovered); the sequential engine can make it"
    )]
    Entangled {
        /// The width of the widest halo, in radii.
        radii: f64,
    },
    /// A window in space depends on too much around it.
    #[error(
        "a sample of this window depends on more than {radii} r around it: choose a smaller window, or another seed"
    )]
    Remote {
        /// The width of the widest halo, in radii.
        radii: f64,
    },
    /// There is not as much memory as the samples need.
    #[error(transparent)]
    Memory(#[from] NoMemory),
    /// The observer asked to stop.
    #[error("cancelled during stage \"{stage}\"")]
    Cancelled {
        /// The stage that was running.
        stage: Stage,
    },
}
