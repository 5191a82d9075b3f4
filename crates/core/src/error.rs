//! Why a run ends without a result: one variant per cause.

use thiserror::Error;

use crate::parameters::ParameterError;
use crate::pattern::PatternError;
use crate::progress::Stage;

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
    /// The observer asked to stop.
    #[error("cancelled during stage \"{stage}\"")]
    Cancelled {
        /// Where it was.
        stage: Stage,
    },
}
