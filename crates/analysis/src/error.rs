//! Why a set could not be judged; an invalid but readable set is a report, not an error. One variant per cause, each
//! naming the value and the limit or the place. Errors of other libraries are not wrapped.

use crate::number::Number;
use crate::region::Region;
use crate::report::Report;

/// Why [`verify`](crate::verify) or a [`StreamVerifier`](crate::StreamVerifier) gave no verdict.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VerifyError {
    /// The set has no sample.
    #[error("the set is empty: there is no sample to judge")]
    Empty,
    /// The set has more samples than 32-bit indices can name.
    #[error("{count} samples exceed the limit of {limit} samples")]
    TooMany {
        /// How many samples are given.
        count: usize,
        /// How many samples are allowed.
        limit: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("sample {index} at ({}, {}) is not finite", .point[0], .point[1])]
    NotFinite {
        /// Index of the first such sample.
        index: usize,
        /// The position of that sample.
        point: [f64; 2],
    },
    /// A sample lies outside the region; there is no tolerance.
    #[error(
        "sample {index} at ({}, {}) lies outside the region {region}{}",
        Number(.point[0]), Number(.point[1]), on_far_side(*.point, *.region)
    )]
    OutOfRegion {
        /// Index of the first such sample.
        index: usize,
        /// The position of that sample.
        point: [f64; 2],
        /// The region that it should lie in.
        region: Region,
    },
    /// A sample lies outside the shape that is to be covered; there is no tolerance.
    #[error("sample {index} at ({}, {}) lies outside the shape", Number(.point[0]), Number(.point[1]))]
    OutOfShape {
        /// Index of the first such sample.
        index: usize,
        /// The position of that sample.
        point: [f64; 2],
    },
    /// The radius is not a positive number within 2^-100 to 2^100 times the longer extent.
    #[error(
        "the radius {} is not a positive number between 2^-100 and 2^100 times the region's longer side",
        Number(*.radius)
    )]
    BadRadius {
        /// The radius that was given, in the unit of the samples.
        radius: f64,
    },
    /// The covering tolerance is not a finite number of at least zero.
    #[error("the covering tolerance {} is not a finite number of at least 0", Number(*.tolerance))]
    BadTolerance {
        /// The tolerance that was given.
        tolerance: f64,
    },
    /// An extent of the region, or the ratio of both, is outside the supported range.
    #[error(
        "the region {} x {} is not supported: extents must lie between 2^-100 and 2^100, one at most \
         2^40 times the other",
        Number(*.width), Number(*.height)
    )]
    BadRegion {
        /// The width that was given.
        width: f64,
        /// The height that was given.
        height: f64,
    },
    /// The triangulation refused a coordinate. Validation makes that impossible; should it happen
    /// all the same, there is no verdict rather than a wrong one.
    #[error("the triangulation of the tile at ({}, {}) failed: {cause}", .corner[0], .corner[1])]
    Triangulation {
        /// Lower corner of the tile, in region coordinates.
        corner: [f64; 2],
        /// The message of the triangulation.
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
        /// The ordinate of that sample.
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
        /// Lower corner of the tile beside it, in region coordinates.
        corner: [f64; 2],
        /// How far the tile's window reaches.
        reach: f64,
    },
    /// A stream would have to hold more than it is allowed.
    #[error(
        "the stream holds {samples} samples and cannot let go of any, where {limit} are allowed, or \
         its rows have too many cells; the set must be verified in memory"
    )]
    BandTooLarge {
        /// How many samples the stream holds.
        samples: usize,
        /// How many samples are allowed.
        limit: usize,
    },
    /// Rows of a stream are crowded.
    #[error(
        "{samples} samples crowd in few places of their rows: the set must be verified in memory"
    )]
    Crowded {
        /// Samples of the rows.
        samples: usize,
    },
    /// No two samples of a stream are near each other.
    #[error(
        "no two samples of the stream were seen closer than {min_distance}, and only pairs closer than \
         {limit} are sure to be seen; the set must be verified in memory"
    )]
    TooSparse {
        /// The smallest distance found.
        min_distance: f64,
        /// The distance up to which all pairs are found.
        limit: f64,
    },
    /// The two judges differ on a set: one of them is wrong.
    #[error(
        "the two judges disagree on the {difference}: {} by {}, {} by {}; this is a fault of the verifier",
        .reports[0].summary(), .reports[0].judges[0], .reports[1].summary(), .reports[1].judges[0]
    )]
    Disagreement {
        /// The name of the value on which they differ.
        difference: &'static str,
        /// The reports of both.
        reports: Box<[Report; 2]>,
    },
    /// Bytes are not the saved state of a verifier of this question.
    #[error("the saved state of the verifier cannot be used: {reason}")]
    BadState {
        /// The reason, as a part of a sentence.
        reason: &'static str,
    },
    /// The judge does not judge sets of this kind.
    #[error("{0}")]
    WrongJudge(&'static str),
    /// The judge by squares cannot judge a region of such numbers.
    #[error("{reason}")]
    Squares {
        /// The number and its limit.
        reason: String,
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
                | Self::Crowded { .. }
                | Self::TooSparse { .. }
        )
    }
}

/// Returns a hint for a sample on the upper or right side of a torus, which is the opposite side.
fn on_far_side(point: [f64; 2], region: Region) -> &'static str {
    if region.is_periodic() && region.closed().contains(point) {
        ": in a periodic region the upper side is the lower one, at 0; a set that has both is of a bounded region"
    } else {
        ""
    }
}
