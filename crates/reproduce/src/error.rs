//! Why a reproduction ends early. What was finished before is kept.

use std::path::PathBuf;

use thiserror::Error;
use tilescope_analysis::VerifyError;
use tilescope_analysis::measures::MeasureError;
use tilescope_core::combine::CombineError;
use tilescope_core::{ParameterError, SampleError};
use tilescope_figures::FigureError;
use tilescope_figures::chart::ChartError;
use tilescope_formats::FormatError;

/// Why a reproduction ended early.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReproduceError {
    /// The caller stopped it.
    #[error("cancelled; the same command goes on where it stopped")]
    Cancelled,
    /// A set that should be valid is not: nothing is concluded from it.
    #[error(
        "{what}: the verifier counts {conflicts} conflicts and {gaps} gaps; nothing is concluded from this set"
    )]
    Invalid {
        /// Which set.
        what: String,
        /// Conflicts found.
        conflicts: u64,
        /// Gaps found.
        gaps: u64,
    },
    /// A file or a folder could not be read or made.
    #[error("{}: {cause}", path.display())]
    Io {
        /// Which.
        path: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
    /// Kept numbers could not be written as JSON.
    #[error("{}: {cause}", path.display())]
    Json {
        /// Which file.
        path: PathBuf,
        /// Why.
        cause: serde_json::Error,
    },
    /// An engine failed.
    #[error("{0}")]
    Engine(String),
    /// Parameters are out of range.
    #[error(transparent)]
    Parameters(#[from] ParameterError),
    /// A set could not be made.
    #[error(transparent)]
    Sample(SampleError),
    /// Sets could not be combined.
    #[error(transparent)]
    Combine(CombineError),
    /// The verifier gave no verdict.
    #[error(transparent)]
    Verify(VerifyError),
    /// A measure could not be taken.
    #[error(transparent)]
    Measure(MeasureError),
    /// A figure could not be laid out.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// A figure could not be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// A file of the result could not be written.
    #[error(transparent)]
    Format(#[from] FormatError),
}

// Cancelling is one thing, wherever it is noticed.
impl From<SampleError> for ReproduceError {
    fn from(error: SampleError) -> Self {
        match error {
            SampleError::Cancelled { .. } => Self::Cancelled,
            other => Self::Sample(other),
        }
    }
}

impl From<CombineError> for ReproduceError {
    fn from(error: CombineError) -> Self {
        match error {
            CombineError::Sample(error) => error.into(),
            other => Self::Combine(other),
        }
    }
}

impl From<VerifyError> for ReproduceError {
    fn from(error: VerifyError) -> Self {
        match error {
            VerifyError::Cancelled => Self::Cancelled,
            other => Self::Verify(other),
        }
    }
}

impl From<MeasureError> for ReproduceError {
    fn from(error: MeasureError) -> Self {
        match error {
            MeasureError::Cancelled => Self::Cancelled,
            MeasureError::Set(error) => error.into(),
            other => Self::Measure(other),
        }
    }
}
