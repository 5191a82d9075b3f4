//! The run of a step: recorded stage by stage, or nested levels, whose samples arrive in the order of their ranks. Begin with
//! [`StepRun`].

use std::sync::Arc;

use tilescope_core::{NestedRequest, Observer, Parameters, Pattern, SampleError, TilingMethod};
use tilescope_debugger::{DEFAULT_BUDGET, RecordedLevels, Recording};

/// What the run of a step is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepRun {
    /// Its parameters.
    pub parameters: Parameters,
    /// The levels, if the step shows nested ones.
    pub levels: Option<NestedRequest>,
}

impl StepRun {
    /// Returns whether a recording is that of this run, and not a painted one.
    #[must_use]
    pub fn is_of(&self, recording: &Recording) -> bool {
        let recorded = recording.levels();
        let is_whole = recorded.is_none_or(|levels| !levels.is_painted);
        let levels = recorded.map(|levels| levels.request);
        is_whole && levels == self.levels && recording.run().parameters == self.parameters
    }

    /// Makes the run and records it. Its pattern is made for it.
    ///
    /// # Errors
    ///
    /// Those of the sampler.
    pub fn make(&self, observer: &mut dyn Observer) -> Result<Arc<Recording>, SampleError> {
        if let Some(request) = &self.levels {
            return record_levels(&self.parameters, request, observer).map(Arc::new);
        }
        let pattern = Pattern::of_spec(&self.parameters.pattern, observer)?;
        record(&self.parameters, &pattern, observer)
    }
}

/// Runs the sequential engine of the parameters' method for a lesson and records it. `pattern` is the one that they describe.
///
/// # Errors
///
/// Those of [`Recording::with_pattern`] and [`Recording::new`].
pub fn record(
    parameters: &Parameters,
    pattern: &Arc<Pattern>,
    observer: &mut dyn Observer,
) -> Result<Arc<Recording>, SampleError> {
    let recording = match parameters.method {
        TilingMethod::Kdrt => {
            Recording::with_pattern(parameters, Arc::clone(pattern), DEFAULT_BUDGET, observer)?
        }
        // It takes the darts of the pattern that the parameters describe.
        TilingMethod::Exact => Recording::new(parameters, DEFAULT_BUDGET, observer)?,
    };
    Ok(Arc::new(recording))
}

/// Makes nested levels and records the arrival of each sample.
fn record_levels(
    parameters: &Parameters,
    request: &NestedRequest,
    observer: &mut dyn Observer,
) -> Result<Recording, SampleError> {
    let made = request.make(parameters, observer)?;
    // Only windows of the order by distance have no ranks, and this is a whole run.
    let levels = RecordedLevels::whole(*request, made.ranks().unwrap_or_default());
    let points = made.points().to_vec();
    Ok(Recording::of_levels(
        parameters,
        *made.domain(),
        points,
        levels,
    ))
}
