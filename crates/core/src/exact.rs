//! Exact tiling: KDRT's blocks and clips with no bias at their seams. It clips *the darts with their arrival order instead
//! of the samples*: a dart is a sample unless an earlier sample covers it.
//!
//! *Definition.* A pattern is random sequential addition of keyed darts ([`PatternDarts`]). A block holds every dart of
//! the pattern whose image lies in the block itself: no margin around it. Darts arrive in the order of [`PlacedDart`],
//! and each is a sample unless a sample that arrived before covers it. That is a unique set, on every engine.
//!
//! *Why it has no bias.* Independent Poisson processes in disjoint rectangles are one Poisson process, and blocks and
//! offsets do not depend on the darts. So the darts of all blocks are distributed as the reference sampler's, and with
//! them the samples, at seams as anywhere. What remains is that blocks share one pattern.
//!
//! *Why it is cheap.* A dart that the pattern refused was refused by its *first blocker*, the earliest sample that
//! covers it. Its fate in a block is the same unless the first blocker is missing; that of a pattern's sample is the
//! same unless a new earlier sample covers it. Both happen near seams alone: of 1.5 million samples none changed
//! farther than 4.7 r from one. [`PatternHistory`] has the first blockers, and [`exact_sample`] follows the
//! differences.
//!
//! *In a shape* ([`exact_in_shape`]) darts outside do not exist. A sample of the pattern outside of the shape is missing in its
//! block as one that is lost: the darts that it refused are decided again. So the shape's border is one more seam, and the set
//! is distributed as the reference sampler's in the shape, but for the pattern that blocks share.

mod agenda;
mod agreement;
mod arrivals;
mod bare;
mod cells;
mod darts;
mod engine;
mod filter;
mod ground;
mod history;
mod laid;
mod lists;
mod packed;
mod pieces;
mod plane;
mod present;
mod seams;

use crate::parameters::PatternSpec;

pub use arrivals::PatternArrivals;
pub use darts::{Arrival, PatternDarts, PlacedDart};
pub use engine::recorded::exact_recorded;
pub use engine::{exact_in_shape, exact_sample};
pub use history::PatternHistory;
pub use laid::{ExactPiece, exact_pieces};
pub use plane::{
    ExactPlane, OwnedExactPlane, exact_in_shape_parallel, exact_points, exact_sample_parallel,
};

/// The most samples of a set that takes a pattern of 200 r, which has as many itself. Larger sets take one of 400 r.
const SMALL_SET: f64 = 28_000.0;

impl PatternSpec {
    /// Returns the pattern that exact tiling takes for a set of about `samples` samples if no other is asked for.
    ///
    /// The mean of K sets of N samples from M patterns of k samples has a variance of about 1 / (K N) + 1 / (M k), in units of
    /// that of one sample: beyond K N = M k more samples hardly make it better. So each seed has a pattern of its own, which
    /// for a set of up to 28,000 samples is at least as large as the set, and beyond that has 111,000 samples.
    #[must_use]
    pub fn for_exact(samples: f64, seed: u64) -> Self {
        Self {
            side: if samples <= SMALL_SET { 200.0 } else { 400.0 },
            seed,
            ..Self::default()
        }
    }
}
