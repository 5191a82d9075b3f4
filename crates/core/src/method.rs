//! A whole run by the method of its parameters, with every sample and its fate.

use crate::engine::sequential::Sequential;
use crate::error::SampleError;
use crate::exact::{PatternHistory, exact_recorded};
use crate::parameters::{Parameters, TilingMethod};
use crate::pattern::Pattern;
use crate::progress::Observer;
use crate::record::{Recorder, Unrecorded};
use crate::run::Run;
use crate::varying::Shape;

/// Returns the finished run of `parameters`, by their method, with the pattern that they describe.
///
/// The result is conflict-free (no two samples within the radius) and, with the complete search,
/// maximal (covering radius at most (1 + 2^-15) r). Equal parameters give equal results, bit for
/// bit, on every machine.
///
/// ```
/// use tilescope_core::{Parameters, Unobserved, sample};
///
/// let parameters = Parameters { radius: 0.02, ..Parameters::default() };
/// let run = sample(&parameters, &mut Unobserved)?;
/// assert_eq!(run.positions().len(), run.summary().count);
/// assert!((1650..1850).contains(&run.summary().count));
/// # Ok::<(), tilescope_core::SampleError>(())
/// ```
pub fn sample(parameters: &Parameters, observer: &mut dyn Observer) -> Result<Run, SampleError> {
    sample_recorded(parameters, observer, &mut Unrecorded)
}

/// Like [`sample`], and reports every event to `recorder`. Recording does not change the result.
pub fn sample_recorded<T: Recorder>(
    parameters: &Parameters,
    observer: &mut dyn Observer,
    recorder: &mut T,
) -> Result<Run, SampleError> {
    // Exact tiling, too, keeps the origin and fate of every sample here, so that both methods have the same limit.
    parameters.validate_sequential()?;

    match parameters.method {
        TilingMethod::Kdrt => {
            let pattern = Pattern::of_spec(&parameters.pattern, observer)?;
            let mut engine = Sequential::new(parameters, pattern)?;
            while engine.step_recorded(observer, recorder)?.is_some() {}
            // No stage is left: this only hands over the run.
            engine.finish(observer)
        }
        TilingMethod::Exact => {
            let history = PatternHistory::of_spec(&parameters.pattern, observer)?;
            exact_recorded(
                parameters,
                &history,
                &Shape::rectangle(),
                observer,
                recorder,
            )
        }
    }
}
