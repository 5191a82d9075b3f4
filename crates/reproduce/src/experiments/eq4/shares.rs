//! Counts and areas of the sets of one leaf, the shares that follow from them, and their table and chart.

use serde::{Deserialize, Serialize};
use tilescope_figures::chart::{Panel, Series};

use crate::error::ReproduceError;
use crate::experiments::common::{chart, curve, picture, reference};
use crate::outcome::{Picture, Table};
use crate::table::table;

/// Counts and areas (in squared radii) of one set or of several.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct LeafShares {
    pub leaf: f64,
    pub count: usize,
    pub inserted: usize,
    /// The domain's.
    pub area: f64,
    pub blocks: usize,
    /// Sum of the widths and heights of all blocks, in radii.
    pub edges: f64,
    /// Area of all clips.
    pub clipped: f64,
    /// Area that a single clip reaches.
    pub alone: f64,
    pub tiled: usize,
    /// Tiled samples outside their own block.
    pub margin: usize,
    pub in_conflict: usize,
    pub eliminated: usize,
    /// Eliminated samples of their own block.
    pub lost: usize,
}

impl LeafShares {
    /// Returns the sum over sets of one leaf.
    pub fn sum(sets: &[Self]) -> Self {
        let sum = |mut all: Self, one: &Self| {
            all.leaf = one.leaf;
            all.count += one.count;
            all.inserted += one.inserted;
            all.area += one.area;
            all.blocks += one.blocks;
            all.edges += one.edges;
            all.clipped += one.clipped;
            all.alone += one.alone;
            all.tiled += one.tiled;
            all.margin += one.margin;
            all.in_conflict += one.in_conflict;
            all.eliminated += one.eliminated;
            all.lost += one.lost;
            all
        };
        sets.iter().fold(Self::default(), sum)
    }

    /// Equation 4.
    pub fn predicted(&self) -> f64 {
        (2.0 * self.leaf + 1.0) / (self.leaf + 1.0).powi(2)
    }

    pub fn mean_edge(&self) -> f64 {
        self.edges / (2.0 * self.blocks as f64)
    }

    /// Equation 4 with the mean edge, and r on each side of it.
    pub fn mended(&self) -> f64 {
        let edge = self.mean_edge();
        1.0 - (edge / (edge + 2.0)).powi(2)
    }

    /// The share of the plane that several clips reach.
    pub fn overlap(&self) -> f64 {
        1.0 - self.alone / self.area
    }

    /// The share of clips that lies beyond their blocks.
    pub fn margin_share(&self) -> f64 {
        1.0 - self.area / self.clipped
    }

    /// The share of tiled samples that lie in the margin of their own clip.
    fn margin_samples(&self) -> f64 {
        self.margin as f64 / self.tiled as f64
    }

    fn conflict_share(&self) -> f64 {
        self.in_conflict as f64 / self.tiled as f64
    }

    /// The share of the result that was inserted.
    pub fn inserted_share(&self) -> f64 {
        self.inserted as f64 / self.count as f64
    }

    /// The share of all samples that ever were that were eliminated or inserted.
    fn touched(&self) -> f64 {
        (self.eliminated + self.inserted) as f64 / (self.tiled + self.inserted) as f64
    }

    /// The share of samples of their own block that were lost.
    fn lost_share(&self) -> f64 {
        self.lost as f64 / (self.tiled - self.margin) as f64
    }
}

/// A measured share: its name in files, in tables and in the chart.
type Share = (&'static str, &'static str, fn(&LeafShares) -> f64);

const SHARES: [Share; 6] = [
    (
        "clip_margin",
        "clips beyond their blocks",
        LeafShares::margin_share,
    ),
    ("overlap", "plane where clips overlap", LeafShares::overlap),
    (
        "in_conflict",
        "tiled samples in conflict",
        LeafShares::conflict_share,
    ),
    (
        "touched",
        "samples eliminated or inserted",
        LeafShares::touched,
    ),
    (
        "lost",
        "samples lost of their own block",
        LeafShares::lost_share,
    ),
    (
        "inserted",
        "result that was inserted",
        LeafShares::inserted_share,
    ),
];

/// Returns all shares by leaf, and their products with it.
pub fn curves(found: &[LeafShares]) -> Result<Picture, ReproduceError> {
    let of = |value: &dyn Fn(&LeafShares) -> f64| {
        found.iter().map(|one| [one.leaf, value(one)]).collect()
    };
    let all = |scale: &dyn Fn(&LeafShares) -> f64| -> Vec<Series> {
        let predicted = |one: &LeafShares| one.predicted() * scale(one);
        let mut series = vec![reference("equation 4", of(&predicted))];
        for (number, (_, name, share)) in SHARES.iter().enumerate() {
            series.push(curve(name, number, of(&|one| share(one) * scale(one))));
        }
        series
    };
    let shares = chart(
        "Shares by the shortest edge",
        "N, r",
        "share, %",
        all(&|_| 100.0),
    );
    let products = chart(
        "Shares times N: level where inversely proportional",
        "N, r",
        "share times N, r",
        all(&|one| one.leaf),
    );
    let caption = "What elimination and insertion touch, by the shortest edge N of a block, against equation 4.".to_owned();
    let rows = vec![vec![Panel::Lines(shares)], vec![Panel::Lines(products)]];
    picture("shares", "The affected share", caption, rows)
}

/// Returns all numbers by leaf.
pub fn shares(found: &[LeafShares]) -> Table {
    let of_leaf: [Share; 3] = [
        ("predicted", "equation 4", LeafShares::predicted),
        (
            "mended",
            "equation 4 with 2 r and the mean edge",
            LeafShares::mended,
        ),
        (
            "margin_samples",
            "tiled samples beyond their blocks",
            LeafShares::margin_samples,
        ),
    ];
    let mut shares = table("shares", "What elimination and insertion touch", found)
        .column("leaf_r", "N, r", 3, |one| one.leaf)
        .column("mean_edge_r", "mean edge, r", 4, |one| one.mean_edge())
        .column("samples", "samples", 9, |one| one.count);
    for (key, head, share) in of_leaf.into_iter().chain(SHARES) {
        let (key, head) = (format!("{key}_percent"), format!("{head}, %"));
        shares = shares.column(&key, &head, 3, |one| 100.0 * share(one));
    }
    shares.shown()
}
