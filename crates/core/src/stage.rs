//! The stages of a run by name. What they do is in [`crate::stages`].

use serde::{Deserialize, Serialize};

/// A stage of a run, in the paper's order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// The small maximal set is made or checked (Ebeida et al. 2012).
    Pattern,
    /// The KD-tree's leaves (Algorithm 1).
    Blocks,
    /// Each block receives its clip (Algorithm 2).
    Tile,
    /// Conflicts are resolved (Algorithm 4, first loop).
    Eliminate,
    /// An iteration of detection and insertion, counted from 1 (Algorithms 3 and 4).
    Iterate(u32),
    /// All stages from the blocks to the end, region by region: the parallel engine's only stage.
    Regions,
    /// The survivors are put into canonical order.
    Finish,
}

impl std::fmt::Display for Stage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Pattern => f.write_str("pattern"),
            Self::Blocks => f.write_str("blocks"),
            Self::Tile => f.write_str("tile"),
            Self::Eliminate => f.write_str("eliminate"),
            Self::Iterate(k) => write!(f, "iterate {k}"),
            Self::Regions => f.write_str("regions"),
            Self::Finish => f.write_str("finish"),
        }
    }
}
