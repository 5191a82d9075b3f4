//! The levels of a session whose set is in an order of which every prefix is evenly spread. It has no stages to step
//! through: a moment of it is a prefix. Begin with [`NestedLevels`]; its claims are what the verifier is asked about.
//! [`crate::nesting`] makes such sessions.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use tilescope_analysis::PrefixClaim;
use tilescope_core::{NestedRequest, Parameters};

use crate::encoding::as_json;

/// The levels of a session.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NestedLevels {
    /// The claims on the samples to the end of each level, the coarsest first.
    pub claims: Vec<PrefixClaim>,
    /// The rank of each sample, in order; nothing if the set was read from a file.
    pub ranks: Vec<f64>,
    /// What the set was made from; `None` if it was read from a file.
    #[serde(with = "as_json")]
    pub asked: Option<(Parameters, NestedRequest)>,
    /// How the set was made, as certificates name it.
    pub method: String,
    /// The parameters of that, by name.
    #[serde(with = "as_json")]
    pub stated: BTreeMap<String, Value>,
}

impl NestedLevels {
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
