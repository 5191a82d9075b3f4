//! When the samples of a pattern arrived.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::error::SampleError;
use crate::exact::darts::{Arrival, PatternDarts};
use crate::parameters::PatternSpec;
use crate::pattern::Pattern;
use crate::progress::Observer;

/// A pattern that knows its darts and the arrivals of its samples: all that exact tiling needs of a pattern, for an engine that
/// throws refused darts again where it needs them. [`super::PatternHistory`] keeps them, and so takes longer to make.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PatternArrivals {
    pattern: Arc<Pattern>,
    darts: PatternDarts,
    arrivals: Vec<Arrival>,
}

impl PatternArrivals {
    /// Returns the arrivals of the pattern that `spec` describes, and makes the pattern if it is not among the last few
    /// that were used ([`Pattern::of_spec`]).
    ///
    /// The observer is called for [`crate::Stage::Pattern`], and may stop it.
    pub fn of_spec(spec: &PatternSpec, observer: &mut dyn Observer) -> Result<Self, SampleError> {
        let pattern = Pattern::of_spec(spec, observer)?;
        let darts = PatternDarts::of_spec(spec)?;
        // Later darts at the place of a sample were refused by it.
        let arrivals = pattern.samples().iter().map(|&p| darts.first_at(p));
        Ok(Self {
            arrivals: arrivals.collect(),
            pattern,
            darts,
        })
    }

    /// Returns the pattern.
    #[must_use]
    pub const fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Returns all darts of the pattern.
    #[must_use]
    pub const fn darts(&self) -> &PatternDarts {
        &self.darts
    }

    /// Returns the arrivals of the pattern's samples, in their order.
    #[must_use]
    pub fn arrivals(&self) -> &[Arrival] {
        &self.arrivals
    }
}
