//! The levels of a session whose set is in an order of which every prefix is evenly spread. It has no stages to step
//! through: a moment of it is a prefix. Begin with [`NestedLevels`]; its claims are what the verifier is asked about.
//! [`crate::nesting`] makes such sessions; those of lessons come from a recording.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use tilescope_analysis::PrefixClaim;
use tilescope_core::{NestedRequest, Parameters, Run, rank_threshold};
use tilescope_debugger::{RecordedLevels, Recording};
use tilescope_sets::stated;

use crate::encoding::as_json;

/// The levels of a session.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NestedLevels {
    /// The claims on the samples to the end of each level, the coarsest first.
    pub claims: Vec<PrefixClaim>,
    /// The rank of each sample, in order; nothing if the set was read from a file.
    pub ranks: Vec<f64>,
    /// What the set was made from; `None` if it was read from a file, and if a density has removed samples of it.
    #[serde(with = "as_json")]
    pub asked: Option<(Parameters, NestedRequest)>,
    /// How the set was made, as certificates name it.
    pub method: String,
    /// The parameters of that, by name.
    #[serde(with = "as_json")]
    pub stated: BTreeMap<String, Value>,
}

/// Returns what the certificate of levels states of how they were made.
pub(crate) fn stated_by(
    parameters: &Parameters,
    request: &NestedRequest,
) -> BTreeMap<String, Value> {
    let mut all = stated(parameters);
    all.extend(stated(request));
    all
}

impl NestedLevels {
    /// Returns the levels of a run that was recorded with them.
    #[must_use]
    pub fn of_recorded(run: &Run, levels: &RecordedLevels) -> Self {
        let (request, radius) = (levels.request, run.domain.radius());
        // Each radius is the root of 2 times that of the next level, and thresholds double.
        let radius_of = |level: usize| {
            let share = rank_threshold(level as u32, request.levels);
            radius * (1.0 / share).sqrt()
        };

        let ends = levels.ends.iter().enumerate();
        let whole = ends.map(|(level, &end)| PrefixClaim::maximal(end, radius_of(level)));
        let mut claims: Vec<PrefixClaim> = whole.collect();

        // Samples behind the last whole level are a part of the next level, and make a last claim: with the distance of
        // the next level, and the covering of the last whole one, if there is one. In a painted set a density has
        // removed samples of any level. Then no level is whole, and all samples make one claim: they keep the distance
        // of the finest level, and no covering.
        let last = claims.last().copied();
        let count = levels.ranks.len();
        if last.is_none_or(|claim| claim.count < count) {
            claims.push(PrefixClaim {
                count,
                distance: if levels.is_painted {
                    radius
                } else {
                    radius_of(claims.len())
                },
                covering: last.and_then(|claim| claim.covering),
            });
        }

        Self {
            claims,
            ranks: levels.ranks.clone(),
            // No parameters make a painted set.
            asked: (!levels.is_painted).then_some((run.parameters, request)),
            method: "kdrt".to_owned(),
            stated: stated_by(&run.parameters, &request),
        }
    }

    /// Returns the recording of a set that was made from a recipe, whose samples arrive one by one; `None` for one of a file.
    #[must_use]
    pub fn recording(&self, run: &Run) -> Option<Recording> {
        let (parameters, request) = self.asked?;
        let levels = RecordedLevels::whole(request, self.ranks.clone());
        let points = run.samples.points.clone();
        Some(Recording::of_levels(
            &parameters,
            run.domain,
            points,
            levels,
        ))
    }

    /// Returns how many samples there are to the end of each level.
    #[must_use]
    pub fn ends(&self) -> impl ExactSizeIterator<Item = usize> {
        self.claims.iter().map(|claim| claim.count)
    }

    /// Returns the level that adds a sample, from 0.
    #[must_use]
    pub fn level_of(&self, id: usize) -> usize {
        self.claims.partition_point(|claim| claim.count <= id)
    }

    /// Returns how many samples have ranks below a number; `None` if the ranks are not known.
    #[must_use]
    pub fn below(&self, rank: f64) -> Option<usize> {
        // Ranks ascend in the order of the samples, so that these are the first ones.
        let is_known = !self.ranks.is_empty();
        is_known.then(|| self.ranks.partition_point(|&other| other < rank))
    }

    /// Returns a number below which the ranks of the first `count` samples lie, and no others; of all such numbers one
    /// with the fewest decimals. `None` if the ranks of `count` samples are not known, and if the last of them has the
    /// same rank as the sample after it. Also `None` for all samples of a set that was cut off or thinned by a density,
    /// as the rank of the sample that would come next is not known.
    ///
    /// # Panics
    ///
    /// If `count` is 0.
    #[must_use]
    pub fn threshold(&self, count: usize) -> Option<f64> {
        let last = *self
            .ranks
            .get(..count)?
            .last()
            .expect("a prefix has a sample");
        // Whether the set ends here as it was asked for: with an exact number of samples, or with a whole last level.
        let ends_here = |&(_, request): &(Parameters, NestedRequest)| {
            request.exactly.is_some() || self.whole(count) == Some(request.levels as usize - 1)
        };
        let next = match self.ranks.get(count) {
            Some(&next) => next,
            // All ranks are below 1.
            None => self
                .asked
                .as_ref()
                .filter(|asked| ends_here(asked))
                .map(|_| 1.0)?,
        };
        // Ranks ascend, so that these two ranks are equal: no number separates them.
        if last >= next {
            return None;
        }

        // The next rank is cut off behind as few decimals as possible, such that it stays above the last rank. With up
        // to 15 decimals the powers of ten and the products are exact enough. If 15 are too few, the next rank itself
        // is returned.
        let mut cut = (1..=15).map(|decimals| {
            let scale = 10.0_f64.powi(decimals);
            (next * scale).floor() / scale
        });
        let is_between = |threshold: &f64| last < *threshold && *threshold <= next;
        Some(cut.find(is_between).unwrap_or(next))
    }

    /// Returns the claim on the first `count` samples.
    ///
    /// # Panics
    ///
    /// If there are not as many.
    #[must_use]
    pub fn claim(&self, count: usize) -> PrefixClaim {
        PrefixClaim::within(&self.claims, count).expect("there are that many samples")
    }

    /// Returns the last level that the first `count` samples hold whole, if they hold one.
    #[must_use]
    pub fn whole(&self, count: usize) -> Option<usize> {
        let is_whole =
            |claim: &PrefixClaim| claim.count <= count && claim.covering == Some(claim.distance);
        self.claims.iter().rposition(is_whole)
    }

    /// Returns the claims on the first `count` samples, level by level.
    #[must_use]
    pub fn cut(&self, count: usize) -> Vec<PrefixClaim> {
        let whole = self.claims.iter().filter(|claim| claim.count < count);
        whole.copied().chain([self.claim(count)]).collect()
    }

    /// Returns the radius of the disks of the first `count` samples, in user units: that of the last whole level, with which
    /// they cover the domain, or of the first level.
    #[must_use]
    pub fn disk_radius(&self, count: usize) -> f64 {
        self.claim(count).radius()
    }
}
