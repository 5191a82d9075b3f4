//! Errors of patterns, with one variant for each cause, with the sample or the position concerned.

use thiserror::Error;

use super::ParameterError;

/// Why a pattern cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PatternError {
    /// There is no sample.
    #[error("the set is empty")]
    Empty,
    /// Its domain or radius is impossible.
    #[error("the set's domain is impossible: {0}")]
    Domain(#[from] ParameterError),
    /// A position is not finite or not inside.
    #[error("sample {index} of the set, ({}, {}), is not inside [0, {}] x [0, {}]", position[0], position[1], size[0], size[1])]
    Outside {
        /// Index of the position as given.
        index: usize,
        /// The position as given.
        position: [f64; 2],
        /// The sides of the pattern.
        size: [f64; 2],
    },
    /// Two samples are no farther apart than the radius.
    #[error("the set is not conflict-free: ({}, {}) and ({}, {}) are {radii:.6} r apart", first[0], first[1], second[0], second[1])]
    Conflict {
        /// One sample, in the pattern's units.
        first: [f64; 2],
        /// The other sample, in the same units.
        second: [f64; 2],
        /// Their distance in radii.
        radii: f64,
    },
    /// This few samples cannot cover the domain.
    #[error(
        "the set is not maximal: {count} samples cannot cover {area:.1} squared radii; is its radius right?"
    )]
    TooFew {
        /// How many there are.
        count: usize,
        /// The area in squared radii.
        area: f64,
    },
    /// A place is not covered.
    #[error("the set is not maximal: no sample covers ({}, {})", witness[0], witness[1])]
    NotMaximal {
        /// The place, in the pattern's units.
        witness: [f64; 2],
    },
    /// A block does not fit a bounded pattern.
    #[error("a block of {:.2} x {:.2} r, enlarged by r on each side, does not fit a bounded pattern of {:.2} x {:.2} r: use a larger pattern, a periodic one or a smaller leaf", block[0], block[1], pattern[0], pattern[1])]
    TooSmall {
        /// The block's sides in radii.
        block: [f64; 2],
        /// The pattern's sides in radii.
        pattern: [f64; 2],
    },
}
