//! Why the judge by squares gives no verdict, one variant for each cause.

use super::{MAX_PITCH_BITS, MAX_RADIUS};

/// Why [`SquaresJudge`](crate::SquaresJudge) gave no verdict.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SquaresError {
    /// A side of the region is not positive.
    #[error("the region has a side of {side} units; at least 1 is needed")]
    Side {
        /// The length of that side, in units.
        side: i32,
    },
    /// A radius is not positive, or too large.
    #[error("a radius of {radius} units is not from 1 to {MAX_RADIUS}")]
    Radius {
        /// The first such radius.
        radius: i32,
    },
    /// A periodic region is so small that a place may be near two images of a sample.
    #[error(
        "the shorter side of the periodic region has {side} units; more than twice the largest radius, {radius}, are needed"
    )]
    Period {
        /// The length of the shorter side, in units.
        side: i32,
        /// The largest radius of the region, in units.
        radius: i32,
    },
    /// The pitch of a field or of a mask is too large.
    #[error("the pitch is 2^{bits} units; at most 2^{MAX_PITCH_BITS} are possible")]
    Pitch {
        /// The binary logarithm of the pitch given.
        bits: u32,
    },
    /// The sides of a periodic region are no multiples of the pitch of its field.
    #[error(
        "the periodic region has a side of {side} units, which is no multiple of the pitch, 2^{bits} units"
    )]
    UnevenPitch {
        /// The length of that side, in units.
        side: i32,
        /// The binary logarithm of the pitch.
        bits: u32,
    },
    /// There are not as many nodes as the region needs.
    #[error(
        "{given} nodes in rows of {columns} are given; {needed_columns} x {needed_rows} are needed"
    )]
    Nodes {
        /// How many nodes are given.
        given: usize,
        /// Nodes of a row given.
        columns: usize,
        /// Nodes of a row that are needed.
        needed_columns: usize,
        /// Rows that are needed.
        needed_rows: usize,
    },
    /// The pixels of a mask are no whole rows.
    #[error("{pixels} pixels are no rows of {columns}")]
    Mask {
        /// How many pixels are given.
        pixels: usize,
        /// Pixels of a row given.
        columns: usize,
    },
    /// A ring has no inside.
    #[error("ring {ring} has {corners} corners; at least 3 are needed")]
    Ring {
        /// The index of the first such ring.
        ring: usize,
        /// How many corners it has.
        corners: usize,
    },
    /// There are more samples than 32-bit indices can name.
    #[error("{count} samples exceed the limit of {limit}")]
    TooMany {
        /// How many samples are given.
        count: usize,
        /// How many samples are allowed.
        limit: usize,
    },
    /// A sample lies outside the domain; there is no tolerance.
    #[error("sample {index} at ({}, {}) lies outside the domain", .place[0], .place[1])]
    Outside {
        /// Index of the first such sample.
        index: usize,
        /// The place of that sample.
        place: [i32; 2],
    },
    /// The control function asked to stop.
    #[error("the verification was cancelled")]
    Cancelled,
}
