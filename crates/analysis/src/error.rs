//! Why a set could not be judged; an invalid but readable set is a report, not an error.
//! One variant per cause, each naming the value and the limit or the place.
//! It never wraps a foreign error type.

use crate::region::Region;

/// Why [`verify`](crate::verify) or a [`StreamVerifier`](crate::StreamVerifier) gave no verdict.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VerifyError {
    /// The set has no sample.
    #[error("the set is empty: there is no sample to judge")]
    Empty,
    /// The set has more samples than 32-bit indices can name.
    #[error("{count} samples exceed the limit of {limit} samples")]
    TooMany {
        /// Samples given.
        count: usize,
        /// Samples allowed.
        limit: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("sample {index} at ({}, {}) is not finite", .point[0], .point[1])]
    NotFinite {
        /// Index of the first such sample.
        index: usize,
        /// Its position.
        point: [f64; 2],
    },
    /// A sample lies outside the region; there is no tolerance.
    #[error("sample {index} at ({}, {}) lies outside the region {region}", .point[0], .point[1])]
    OutOfRegion {
        /// Index of the first such sample.
        index: usize,
        /// Its position.
        point: [f64; 2],
        /// The region asked for.
        region: Region,
    },
    /// Two samples have identical coordinates.
    #[error("samples {first} and {second} are the same point ({}, {})", .point[0], .point[1])]
    Duplicate {
        /// The smallest index that has a duplicate.
        first: usize,
        /// The next index with the same position.
        second: usize,
        /// Their position.
        point: [f64; 2],
    },
    /// Three or more samples of a bounded region lie exactly on one line, which is how a file
    /// read with its columns mixed up looks.
    #[error(
        "all {count} samples lie on the line through ({}, {}) and ({}, {}): \
         a bounded set needs three that do not",
        .first[0], .first[1], .second[0], .second[1]
    )]
    Collinear {
        /// Samples given.
        count: usize,
        /// The first sample.
        first: [f64; 2],
        /// The second sample.
        second: [f64; 2],
    },
    /// The radius is not a positive number within 2^-100 to 2^100 times the longer extent.
    #[error(
        "the radius {radius} is not a positive number between 2^-100 and 2^100 times the region's \
         longer side"
    )]
    BadRadius {
        /// The radius given.
        radius: f64,
    },
    /// The covering tolerance is not a finite number of at least zero.
    #[error("the covering tolerance {tolerance} is not a finite number of at least 0")]
    BadTolerance {
        /// The tolerance given.
        tolerance: f64,
    },
    /// An extent of the region, or the ratio of both, is outside the supported range.
    #[error(
        "the region {width} x {height} is not supported: extents must lie between 2^-100 and \
         2^100, one at most 2^40 times the other"
    )]
    BadRegion {
        /// The width given.
        width: f64,
        /// The height given.
        height: f64,
    },
    /// The triangulation refused a coordinate. Validation makes that impossible; should it happen
    /// all the same, there is no verdict rather than a wrong one.
    #[error("the triangulation of the tile at ({}, {}) failed: {cause}", .corner[0], .corner[1])]
    Triangulation {
        /// Lower corner of the tile, in region coordinates.
        corner: [f64; 2],
        /// What the triangulation said.
        cause: String,
    },
    /// A sample of a stream lies too far below one before it.
    #[error(
        "sample {index} has the ordinate {value}, below {limit}: the samples do not come in rows, so \
         the set must be verified in memory"
    )]
    OutOfOrder {
        /// Index of the first such sample.
        index: usize,
        /// Its ordinate.
        value: f64,
        /// The lowest ordinate that could still come.
        limit: f64,
    },
    /// A stream has a hole so wide that rows which would show its rim are gone.
    #[error(
        "near ({}, {}) the set has a hole that a stream cannot judge: samples up to {reach} away \
         matter; it must be verified in memory",
        .corner[0], .corner[1]
    )]
    HoleTooWide {
        /// Lower corner of the tile that sees it, in region coordinates.
        corner: [f64; 2],
        /// How far the tile wants to see.
        reach: f64,
    },
    /// A stream would have to hold more than it is allowed.
    #[error(
        "the stream holds {samples} samples and cannot let go of any, where {limit} are allowed, or \
         its rows have too many cells; the set must be verified in memory"
    )]
    BandTooLarge {
        /// Samples held.
        samples: usize,
        /// Samples allowed.
        limit: usize,
    },
    /// No two samples of a stream are near each other.
    #[error(
        "no two samples of the stream were seen closer than {min_distance}, and only pairs closer than \
         {limit} are sure to be seen; the set must be verified in memory"
    )]
    TooSparse {
        /// The smallest distance seen.
        min_distance: f64,
        /// The distance up to which all pairs are seen.
        limit: f64,
    },
    /// Bytes are not the saved state of a verifier of this question.
    #[error("the saved state of the verifier cannot be used: {reason}")]
    BadState {
        /// What is wrong with it.
        reason: &'static str,
    },
    /// The control function asked to stop.
    #[error("the verification was cancelled")]
    Cancelled,
}

impl VerifyError {
    /// Whether only the stream is at fault: [`verify`](crate::verify) may judge the same set.
    #[must_use]
    pub fn needs_memory(&self) -> bool {
        matches!(
            self,
            Self::OutOfOrder { .. }
                | Self::HoleTooWide { .. }
                | Self::BandTooLarge { .. }
                | Self::TooSparse { .. }
        )
    }
}
