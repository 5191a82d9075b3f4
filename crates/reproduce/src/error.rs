//! Why a reproduction ended early. Finished units are kept.

use std::path::{Path, PathBuf};

use thiserror::Error;
use tilescope_analysis::measures::MeasureError;
use tilescope_analysis::{Report, SolidError, VerifyError};
use tilescope_core::combine::CombineError;
use tilescope_core::{ParameterError, SampleError};
use tilescope_figures::FigureError;
use tilescope_figures::chart::ChartError;
use tilescope_formats::FormatError;
use tilescope_gpu::GpuError;
use tilescope_sets::VaryingError;

/// Why a reproduction ended early.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReproduceError {
    /// The caller stopped it.
    #[error("cancelled; run the same command again to continue")]
    Cancelled,
    /// A set that should be valid is not: nothing is concluded from it.
    #[error(
        "{what}: the verifier counts {conflicts} conflicts and {gaps} gaps; nothing is concluded from this set"
    )]
    Invalid {
        /// Which set it is, in words.
        what: String,
        /// How many conflicts the verifier counts.
        conflicts: u64,
        /// How many gaps the verifier counts.
        gaps: u64,
    },
    /// A file or a folder could not be read or made.
    #[error("{}: {cause}", path.display())]
    Io {
        /// The path of the file or folder.
        path: PathBuf,
        /// Why the system refused.
        cause: std::io::Error,
    },
    /// An engine failed, for the reason in the text.
    #[error("{0}")]
    Engine(String),
    /// A set could not be made, verified or measured, a figure not drawn, or a file not written.
    #[error(transparent)]
    Failed(Box<dyn std::error::Error + Send + Sync>),
}

impl ReproduceError {
    /// Returns the error of a set that is not valid, by the verifier's report.
    pub(crate) fn invalid(what: &str, report: &Report) -> Self {
        Self::Invalid {
            what: what.to_owned(),
            conflicts: report.conflicts,
            gaps: report.gaps,
        }
    }

    /// Returns what makes the error of a file or a folder.
    pub(crate) fn io(path: &Path) -> impl Fn(std::io::Error) -> Self + '_ {
        |cause| Self::Io {
            path: path.to_owned(),
            cause,
        }
    }
}

/// A result, or why the reproduction ended early.
pub type Result<T, E = ReproduceError> = std::result::Result<T, E>;

/// Makes errors of other crates into [`ReproduceError::Failed`], and those that say that the caller stopped it into
/// [`ReproduceError::Cancelled`].
macro_rules! failures {
    ($($error:ty $(=> $cancelled:pat)?,)*) => {$(
        impl From<$error> for ReproduceError {
            fn from(error: $error) -> Self {
                $(if matches!(&error, $cancelled) {
                    return Self::Cancelled;
                })?
                Self::Failed(Box::new(error))
            }
        }
    )*};
}

failures! {
    ParameterError,
    SampleError => SampleError::Cancelled { .. },
    GpuError => GpuError::Sample(SampleError::Cancelled { .. }),
    CombineError => CombineError::Sample(SampleError::Cancelled { .. }),
    VerifyError => VerifyError::Cancelled,
    SolidError => SolidError::Cancelled,
    VaryingError => VaryingError::Sample(SampleError::Cancelled { .. }) | VaryingError::Judge(VerifyError::Cancelled),
    MeasureError => MeasureError::Cancelled | MeasureError::Set(VerifyError::Cancelled),
    ChartError,
    FigureError,
    FormatError,
    serde_json::Error,
}
