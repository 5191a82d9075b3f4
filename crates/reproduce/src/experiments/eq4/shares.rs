//! Counts and areas of the sets of one leaf, the shares that follow from them, and their table and chart.

use serde::{Deserialize, Serialize};
use serde_json::json;
use tilescope_figures::chart::{Panel, Series};

use crate::error::ReproduceError;
use crate::experiments::common::{curve, picture, reference};
use crate::outcome::{Picture, Table};
use crate::texts::{chart, table};

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

/// A measured share: its name in the chart.
type Share = (&'static str, fn(&LeafShares) -> f64);

const SHARES: [Share; 6] = [
    ("clips beyond their blocks", LeafShares::margin_share),
    ("plane where clips overlap", LeafShares::overlap),
    ("tiled samples in conflict", LeafShares::conflict_share),
    ("samples eliminated or inserted", LeafShares::touched),
    ("samples lost of their own block", LeafShares::lost_share),
    ("result that was inserted", LeafShares::inserted_share),
];

/// Returns all shares by leaf, and their products with it.
pub fn curves(found: &[LeafShares]) -> Result<Picture, ReproduceError> {
    let of = |value: &dyn Fn(&LeafShares) -> f64| {
        found.iter().map(|one| [one.leaf, value(one)]).collect()
    };
    let all = |scale: &dyn Fn(&LeafShares) -> f64| -> Vec<Series> {
        let predicted = |one: &LeafShares| one.predicted() * scale(one);
        let mut series = vec![reference("equation 4", of(&predicted))];
        for (number, (name, share)) in SHARES.iter().enumerate() {
            series.push(curve(name, number, of(&|one| share(one) * scale(one))));
        }
        series
    };
    let shares = chart("eq4/shares", all(&|_| 100.0));
    let products = chart("eq4/products", all(&|one| one.leaf));
    let rows = vec![vec![Panel::Lines(shares)], vec![Panel::Lines(products)]];
    picture("eq4/shares", &json!({}), rows)
}

/// Returns all numbers by leaf.
pub fn shares(found: &[LeafShares]) -> Table {
    table("eq4/shares", found, |one| {
        json!({
            "leaf_r": one.leaf, "mean_edge_r": one.mean_edge(), "samples": one.count,
            "predicted_percent": 100.0 * one.predicted(), "mended_percent": 100.0 * one.mended(),
            "margin_samples_percent": 100.0 * one.margin_samples(),
            "clip_margin_percent": 100.0 * one.margin_share(), "overlap_percent": 100.0 * one.overlap(),
            "in_conflict_percent": 100.0 * one.conflict_share(), "touched_percent": 100.0 * one.touched(),
            "lost_percent": 100.0 * one.lost_share(), "inserted_percent": 100.0 * one.inserted_share(),
        })
    })
}
