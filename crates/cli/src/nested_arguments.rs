//! The arguments of nested levels.

use clap::Args;
use tilescope_core::WithinLevel;

use crate::options::{Names, named};

/// Arguments of nested levels.
#[derive(Debug, Args)]
pub struct NestedArguments {
    /// Make K sets, each with all samples of the one before and maximal for a radius smaller by the root of 2. The last has
    /// the radius given. The samples of the first come first, so that every prefix of the set is evenly spread
    #[arg(long, value_name = "K",
        conflicts_with_all = ["count", "pattern", "window", "resume", "no_verify", "shuffle"])]
    pub levels: Option<u32>,
    /// Exactly N samples: the first of a run of --levels whose last set has as many or a few more. There is no maximal
    /// set of exactly so many samples in general: of these, every place is within 1.42 radii
    #[arg(long, value_name = "N", group = "size", requires = "levels")]
    pub exactly: Option<usize>,
    /// How the samples that a level adds follow each other
    #[arg(long, value_name = "ORDER", value_parser = named::<WithinLevel>(&ORDERS_WITHIN), default_value = "random",
        requires = "levels")]
    pub order_within: WithinLevel,
}

const ORDERS_WITHIN: Names<2> = [
    ("random", "In an order that is drawn"),
    (
        "farthest",
        "Each is the farthest from all samples before it",
    ),
];
