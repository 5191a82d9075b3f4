//! The result of a judge, from which the report is made. Both judges give it, each by searches of its own.

use crate::judge::Judge;
use crate::witness::{Conflict, Gap};
use crate::worst::Worst;

/// Pairs in conflict are counted up to this number: a set with more was misread or has another radius, and counting
/// them all would take a time that grows with the square of its samples.
pub const MAX_CONFLICTS: u64 = 1_000_000;

/// What a judge found, in the domain's unit.
pub(crate) struct Findings {
    pub judge: Judge,
    pub conflicts: u64,
    pub worst_conflicts: Worst<Conflict>,
    pub min_distance: f64,
    pub gaps: u64,
    pub worst_gaps: Worst<Gap>,
    pub covering_radius: f64,
}
