//! The question to the second judge, its result, and the reasons for which it gives none.

use serde::{Deserialize, Serialize};

use super::gaps::Gaps;
use super::sample::Sample;
use crate::domain::Domain;
use crate::error::VerifyError;
use crate::findings::Findings;
use crate::judge::Judge;
use crate::witness::Conflict;
use crate::worst::Worst;

/// Why this judge declines a set, which the first judge then judges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Declined {
    /// The radius is many times the period or a tiny fraction of the extent.
    Radius,
    /// There are many more cells than samples, or no two samples are near each other.
    Sparse,
    /// Many samples lie in few cells.
    Crowded,
    /// There is a hole of many radii, or there are very many.
    Holes,
}

/// Either a result, or why there is none.
pub(crate) type Judged<T> = Result<Result<T, Declined>, VerifyError>;

/// What the search found, in the domain's unit.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Found {
    pub conflicts: u64,
    pub worst_conflicts: Worst<Conflict>,
    pub min_distance: f64,
    pub gaps: Gaps,
    /// Pairs with a larger squared distance change nothing.
    pub nearby: f64,
    /// Samples whose cell reaches farther than the cells around them show.
    pub exposed: Vec<Sample>,
}

impl Found {
    pub fn new(witnesses: usize) -> Self {
        Self {
            conflicts: 0,
            worst_conflicts: Worst::new(witnesses),
            min_distance: f64::INFINITY,
            gaps: Gaps::default(),
            nearby: f64::INFINITY,
            exposed: Vec::new(),
        }
    }

    /// Returns the result for the report, with at most `witnesses` of the largest gaps. By then no sample is exposed
    /// any more: each was looked at again in wider surroundings.
    pub fn findings(self, witnesses: usize) -> Findings {
        let mut worst_gaps = Worst::new(witnesses);
        let gaps = self.gaps.len() as u64;
        self.gaps
            .all
            .into_iter()
            .for_each(|gap| worst_gaps.push(gap));

        Findings {
            judge: Judge::Circles,
            conflicts: self.conflicts,
            worst_conflicts: self.worst_conflicts,
            min_distance: self.min_distance,
            gaps,
            worst_gaps,
            covering_radius: self.gaps.covering_radius,
        }
    }

    pub fn merge(mut self, other: Self) -> Self {
        self.conflicts += other.conflicts;
        self.worst_conflicts.merge(other.worst_conflicts);
        self.min_distance = self.min_distance.min(other.min_distance);
        self.nearby = self.nearby.min(other.nearby);
        self.gaps.merge(other.gaps);
        self.exposed.extend(other.exposed);
        self
    }

    /// Records a pair of samples: a conflict if it is closer than the radius, and the smallest distance.
    pub fn add_pair(&mut self, one: Sample, other: Sample, distance: f64, radius: f64) {
        if distance < radius {
            self.conflicts += 1;
            self.worst_conflicts.push(Conflict {
                first: one.id.min(other.id) as usize,
                second: one.id.max(other.id) as usize,
                distance,
            });
        }

        if distance < self.min_distance {
            self.min_distance = distance;
            let limit = distance.max(radius);
            // A little more than the square, for rounding: farther pairs are no conflict and not the closest.
            self.nearby = limit * limit * (1.0 + 1e-9);
        }
    }

    /// Records each sample of a torus with its own nearest copies, a period away.
    pub fn add_own_copies(&mut self, count: usize, period: f64, radius: f64) {
        self.min_distance = self.min_distance.min(period);
        if period < radius {
            self.conflicts += count as u64;
            for id in 0..count {
                self.worst_conflicts.push(Conflict {
                    first: id,
                    second: id,
                    distance: period,
                });
            }
        }
    }
}

/// The question that a set is judged by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Question {
    pub domain: Domain,
    pub radius: f64,
    /// Circles larger than this are gaps.
    pub limit: f64,
    pub witnesses: usize,
}
