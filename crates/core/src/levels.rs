//! Nested levels: maximal sets `S_0`, `S_1`, ..., `S_J`, each with all samples of the one before, at radii of which each is
//! the one before divided by the root of 2; the last is the run's r.
//!
//! *Definition.* The nested pattern has sets `P_0`, `P_1`, ... of the same kind ([`NestedPattern`]). Blocks are those of a
//! run at r, and each block clips all levels at one place and under one symmetry. At level j a block, enlarged by `r_j`, receives its clip
//! of `P_j`. Elimination takes first the samples of `S_(j-1)`, which are farther apart than `r_(j-1)` and all stay, then the
//! tiled samples that lie in their own block, then those in margins, both block after block in the order of the blocks'
//! indices. A tiled sample that lies on a sample of `S_(j-1)` is that sample. Insertion then fills the gaps at `r_j`, as in a
//! run at `r_j`, until no candidate is left: the result is `S_j`. With one level this is a run's result, bit for bit.
//!
//! *Why each level is maximal.* `P_j` is maximal, so the union of the clips covers every lattice point (paper, Theorem
//! 3.1), and elimination uncovers a place only by losing a tiled sample that covers it. That insertion then finds
//! every gap is shown in [`gaps`]. `S_j` is conflict-free since a sample is kept or inserted only where no other covers it. So distances
//! within `S_j` exceed `r_j`, and its covering radius is at most (1 + 2^-15) `r_j`: the deviation, 0.71 units and what a unit is longer than
//! r / 2^15, is smaller than a unit at every level.
//!
//! *Prefixes.* The samples of `S_0` come first, then those that each level adds. The first n samples, |`S_j`| <= n <
//! |`S_(j+1)`|, contain `S_j` and are part of `S_(j+1)`: distances exceed `r_(j+1)`, and the covering radius is at most that of
//! `S_j`.
//!
//! *Ranks.* Each sample has a number in `[0, 1)`, and those with numbers below any threshold are such a prefix ([`rank`]).
//!
//! *Why it is cheap.* Far from seams `S_j` is the block's own clip of `P_j`, since no sample of another block and no inserted sample is near.
//! There samples are copied without a test ([`region`]). Where `S_(j-1)` has samples that are not of the block's pattern,
//! each costs the pattern's samples within `r_j` around it, fewer at every level; and pattern samples that are lost at one
//! level return at a finer one, where nothing covers them any more.
//!
//! *Windows.* What a sample depends on is followed by *unknowns* ([`region`]), never guessed.

mod blocks;
mod candidates;
mod frame;
mod gaps;
mod grid;
mod nested;
mod pattern;
mod plane;
mod rank;
mod region;
mod search;

use crate::error::ParameterError;
use crate::radius::MAX_HALVINGS;

pub use nested::{Nested, PrefixGuarantee, WithinLevel};
pub use pattern::NestedPattern;
pub use plane::{NestedPlane, NestedRequest};
pub use rank::rank_threshold;

/// The most levels of a run.
pub const MAX_LEVELS: u32 = MAX_HALVINGS + 1;

/// Refuses numbers of levels that are out of range.
fn check_levels(levels: u32) -> Result<(), ParameterError> {
    let maximum = MAX_LEVELS;
    match levels {
        1..=MAX_LEVELS => Ok(()),
        _ => Err(ParameterError::Levels { levels, maximum }),
    }
}
