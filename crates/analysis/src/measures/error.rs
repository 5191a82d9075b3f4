//! Why a measure could not be taken: one variant per cause, each naming the value and the limit. A strange but readable
//! set is measured, not refused. Errors of other libraries are not wrapped.

use crate::error::VerifyError;

/// Why a measure was refused or not finished.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeasureError {
    /// The samples or the region cannot be measured: a coordinate is not finite or outside, the region is not
    /// supported, or the triangulation failed.
    #[error(transparent)]
    Set(VerifyError),
    /// The measure needs more samples.
    #[error("the number of samples, {count}, is too small: this measure needs at least {limit}")]
    TooFew {
        /// How many samples are given.
        count: usize,
        /// How many samples are needed.
        limit: usize,
    },
    /// The measure takes too long or too much memory for this many samples.
    #[error("{count} samples exceed the limit of {limit} for this measure")]
    TooMany {
        /// How many samples are given.
        count: usize,
        /// How many samples are allowed.
        limit: usize,
    },
    /// All samples are at one place.
    #[error("all {count} samples are at the one place ({}, {})", .point[0], .point[1])]
    AllEqual {
        /// How many samples are given.
        count: usize,
        /// The position that all of them have.
        point: [f64; 2],
    },
    /// A window of frequencies has no frequency.
    #[error("the window of frequencies {0}..{1} x {2}..{3} is empty", .window[0], .window[1], .window[2], .window[3])]
    EmptyWindow {
        /// First and end along x, first and end along y.
        window: [i64; 4],
    },
    /// The transform of a window would take too much memory.
    #[error(
        "the window of {columns} x {rows} frequencies needs {bytes} bytes, where {limit} are allowed"
    )]
    WindowTooLarge {
        /// How many frequencies the window has along x.
        columns: u64,
        /// How many frequencies the window has along y.
        rows: u64,
        /// The working memory that the transform needs.
        bytes: u64,
        /// The working memory that is allowed.
        limit: u64,
    },
    /// A frequency is so high that the rounding of a coordinate shifts its phase noticeably.
    #[error(
        "the frequency {frequency} is beyond {limit}, where rounded coordinates blur its phase"
    )]
    FrequencyTooHigh {
        /// The frequency of largest magnitude in the window.
        frequency: i64,
        /// The largest magnitude allowed.
        limit: i64,
    },
    /// A length, width or level is not a number in its range.
    #[error("{name} is {value}, which is not between {least} and {most}")]
    OutOfRange {
        /// The name of the value, as messages have it.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// The least that is allowed.
        least: f64,
        /// The most that is allowed.
        most: f64,
    },
    /// A number of bins, cells or classes is zero or too large.
    #[error("{name}: {count} is not between 1 and {limit}")]
    BadCount {
        /// The name of the things counted, as messages have it.
        name: &'static str,
        /// The number that was given.
        count: usize,
        /// The largest number allowed.
        limit: usize,
    },
    /// Two things that must be of one length are not.
    #[error("{name}: {count} values given where {expected} are needed")]
    LengthDiffers {
        /// What the values are.
        name: &'static str,
        /// How many values are given.
        count: usize,
        /// How many values are needed.
        expected: usize,
    },
    /// A value to be averaged or compared differs in kind from the earlier ones.
    #[error("{name} differs from that of what was added before")]
    Differs {
        /// The name of the thing that differs.
        name: &'static str,
    },
    /// A list of values that must rise does not.
    #[error("{name}: value {index}, {value}, is not finite or does not exceed the one before it")]
    NotRising {
        /// What the values are.
        name: &'static str,
        /// The first offending index.
        index: usize,
        /// The value at that index.
        value: f64,
    },
    /// The control function asked to stop.
    #[error("the measurement was cancelled")]
    Cancelled,
}

impl From<VerifyError> for MeasureError {
    fn from(error: VerifyError) -> Self {
        match error {
            VerifyError::Cancelled => Self::Cancelled,
            VerifyError::Empty => Self::TooFew { count: 0, limit: 1 },
            VerifyError::TooMany { count, limit } => Self::TooMany { count, limit },
            other => Self::Set(other),
        }
    }
}
