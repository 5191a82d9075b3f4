//! Why a run ends without a result, and why parameters or patterns are refused: one variant per cause.

mod parameters;
mod pattern;

use thiserror::Error;

use crate::stage::Stage;

pub use parameters::ParameterError;
pub use pattern::PatternError;

/// Why sampling failed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SampleError {
    /// The parameters cannot be sampled.
    #[error(transparent)]
    Parameters(#[from] ParameterError),
    /// The pattern cannot serve.
    #[error(transparent)]
    Pattern(#[from] PatternError),
    /// A window of the parallel engine depends on too much around it.
    #[error(
        "a part of this set depends on more than {radii} r around it (the pattern leaves too many places uncovered); the sequential engine can make it"
    )]
    Entangled {
        /// How far around it was looked, in radii.
        radii: f64,
    },
    /// The observer asked to stop.
    #[error("cancelled during stage \"{stage}\"")]
    Cancelled {
        /// Where it was.
        stage: Stage,
    },
}
