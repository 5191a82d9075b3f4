//! When the samples of a pattern arrived.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::error::SampleError;
use crate::exact::darts::{Arrival, PatternDarts};
use crate::parameters::PatternSpec;
use crate::pattern::Pattern;
use crate::progress::Observer;
use crate::random::Key;

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
        Ok(Self::new(pattern, PatternDarts::of_spec(spec)?))
    }

    /// Returns the arrivals of the set that [`crate::reference_sample`] makes of the side, the boundary and the seed of `spec`.
    /// It is not the pattern that `spec` describes, whose darts have a key of their own, so that no pattern repeats the
    /// draws of a run with its seed.
    ///
    /// Fails when the side is out of range. The observer is called for [`crate::Stage::Pattern`], and may stop it.
    ///
    /// ```
    /// use tilescope_core::{Boundary, Domain, PatternArrivals, PatternSpec, Unobserved, reference_sample};
    ///
    /// let spec = PatternSpec { side: 20.0, seed: 7, ..PatternSpec::default() };
    /// let arrived = PatternArrivals::of_reference(&spec, &mut Unobserved)?;
    /// let domain = Domain::from_size([1.0, 1.0], 0.05, Boundary::Periodic)?;
    /// assert_eq!(arrived.pattern().samples(), reference_sample(domain, 7, &mut Unobserved)?);
    /// # Ok::<(), tilescope_core::SampleError>(())
    /// ```
    pub fn of_reference(
        spec: &PatternSpec,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        let darts = PatternDarts::of_key(spec, Key::from_seed(spec.seed))?;
        let pattern = Pattern::of_seed(spec, spec.seed, observer)?;
        Ok(Self::new(Arc::new(pattern), darts))
    }

    /// Returns a pattern with the arrivals of its samples, which are among `darts`.
    fn new(pattern: Arc<Pattern>, darts: PatternDarts) -> Self {
        // Later darts at the place of a sample were refused by it.
        let arrivals = pattern.samples().iter().map(|&p| darts.first_at(p));
        Self {
            arrivals: arrivals.collect(),
            pattern,
            darts,
        }
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
