//! The proofs that a set is not valid: two samples in conflict, the centre of a gap. Both judges give them, and the
//! report lists them. Their numbers are in the report.

use serde::{Deserialize, Serialize};

/// A pair of samples closer than the radius.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Conflict {
    /// The smaller of their indices.
    pub first: usize,
    /// The larger index; equal to `first` when a period is shorter than the radius, so that a sample
    /// is too close to its own copy.
    pub second: usize,
    /// Their distance, around the torus when periodic; less than the radius.
    pub distance: f64,
}

/// The centre of an empty circle larger than the radius allows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gap {
    /// A place of the region.
    pub center: [f64; 2],
    /// Distance from there to the nearest sample.
    pub distance: f64,
    /// What kind of place it is.
    pub kind: GapKind,
}

/// Where the centre of a largest empty circle can be. A place of several kinds counts as the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GapKind {
    /// Equally far from three or more samples.
    VoronoiVertex,
    /// On the border of a bounded region, equally far from two samples.
    Border,
    /// A corner of a bounded region.
    Corner,
    /// A lattice point that no sample is near, where the radius varies or a shape is to be covered.
    LatticePoint,
}
