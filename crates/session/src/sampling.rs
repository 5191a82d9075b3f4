//! Makes sessions on the CPU or the GPU. A session's *generation* is a number that no other session has.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use tilescope_core::{
    Parameters, Pattern, PatternArrivals, PatternSpec, Run, SampleError, Stage, TilingMethod,
};
use tilescope_gpu::{Gpu, GpuError, GpuSweep, Stepper, exact_on_gpu};

use crate::jobs::Monitor;
use crate::nesting;
use crate::packing;
use crate::recipe::Recipe;
use crate::session::{Failure, MakeError, Reporter, Session, keeps_everything};
use crate::stippling;
use crate::task::{self, SessionRef, Task};
use crate::varying;

/// The result of making a session.
pub type Made = Result<Session, MakeError>;

/// The task of sampling on the CPU.
#[derive(Serialize, Deserialize)]
pub struct SampleTask {
    /// The parameters and the pattern of the run.
    pub recipe: Recipe,
    /// The generation that the session gets.
    pub generation: u64,
}

impl Task for SampleTask {
    type Outcome = Made;
    const NAME: &'static str = "sample";

    fn run(self, monitor: &Monitor) -> Made {
        let Self { recipe, generation } = &self;
        if let Some(depth) = recipe.depth {
            return packing::sample(recipe, depth, *generation, monitor);
        }
        if let Some(request) = &recipe.ground {
            return match &request.stipple {
                Some(stipple) => stippling::sample(recipe, request, stipple, *generation, monitor),
                None => varying::sample(recipe, request, *generation, monitor),
            };
        }
        Ok(match recipe.nested {
            Some(request) => nesting::sample(recipe, request, *generation, monitor)?,
            None => Session::sample(recipe, *generation, monitor)?,
        })
    }

    fn cancelled(monitor: &Monitor) -> Option<Made> {
        Some(Err(MakeError::cancelled_by(monitor)))
    }

    fn keep(made: Made) {
        SessionRef::keep(made);
    }
}

/// The task of generating the pattern of a description.
#[derive(Serialize, Deserialize)]
pub struct PatternTask(pub PatternSpec);

impl Task for PatternTask {
    type Outcome = Result<Arc<Pattern>, MakeError>;
    const NAME: &'static str = "pattern";

    fn run(self, monitor: &Monitor) -> Self::Outcome {
        let mut observer = Reporter { monitor };
        Ok(Pattern::of_spec(&self.0, &mut observer)?)
    }

    fn cancelled(monitor: &Monitor) -> Option<Self::Outcome> {
        Some(Err(MakeError::cancelled_by(monitor)))
    }
}

/// The task of finding the arrivals of the pattern of a description.
#[derive(Serialize, Deserialize)]
pub struct ArrivalsTask(pub PatternSpec);

impl Task for ArrivalsTask {
    type Outcome = Result<PatternArrivals, MakeError>;
    const NAME: &'static str = "arrivals";

    fn run(self, monitor: &Monitor) -> Self::Outcome {
        let mut observer = Reporter { monitor };
        Ok(PatternArrivals::of_spec(&self.0, &mut observer)?)
    }

    fn cancelled(monitor: &Monitor) -> Option<Self::Outcome> {
        Some(Err(MakeError::cancelled_by(monitor)))
    }
}

/// The task of preparing a GPU's run as a session, with the events of the same run on the CPU.
#[derive(Serialize, Deserialize)]
pub struct GpuSessionTask {
    /// The run as the GPU made it.
    pub run: Run,
    /// The input of that run.
    pub recipe: Recipe,
    /// The generation that the session gets.
    pub generation: u64,
}

impl Task for GpuSessionTask {
    type Outcome = Made;
    const NAME: &'static str = "twin";

    fn run(self, monitor: &Monitor) -> Made {
        let mut observer = Reporter { monitor };
        let recipe = &self.recipe;
        Ok(Session::of_gpu(
            self.run,
            recipe,
            self.generation,
            &mut observer,
        )?)
    }

    fn cancelled(monitor: &Monitor) -> Option<Made> {
        Some(Err(MakeError::cancelled_by(monitor)))
    }

    fn keep(made: Made) {
        SessionRef::keep(made);
    }
}

/// The first stage that runs on the GPU when all stages are kept.
const FIRST_GPU_STAGE: Stage = Stage::Blocks;

/// Samples by `recipe` on `gpu` and prepares the result, with all its stages if the CPU would keep them, too. If the
/// device fails, the CPU makes the same session, which reports the failure. Callers leave recipes of nested levels, of
/// a ground and of space to [`SampleTask`], as no device makes them.
///
/// Fails as [`Session::sample`] does, never because of the device.
pub async fn on_gpu(
    gpu: Arc<Gpu>,
    recipe: &Recipe,
    generation: u64,
    monitor: &Arc<Monitor>,
) -> Result<Session, MakeError> {
    let name = gpu.report().name.clone();
    let mut observer = Reporter { monitor };

    let recipe = recipe.clone();
    let parameters = &recipe.parameters;
    // An own pattern with exact tiling is refused, as on the CPU: the GPU would make the pattern of the parameters.
    recipe.check().map_err(SampleError::from)?;

    // Patterns are made in tasks, which run in workers on a page, so that the window's thread stays free.
    let ran = match (parameters.method, &recipe.own) {
        (TilingMethod::Exact, _) => {
            let made = task::run_for(ArrivalsTask(parameters.pattern), monitor).await;
            let arrived = made.map_err(MakeError::fault)??;
            exact_on(&gpu, parameters, &arrived, &mut observer).await
        }
        (TilingMethod::Kdrt, Some(own)) => {
            run_on(gpu, parameters, &own.pattern, &mut observer).await
        }
        (TilingMethod::Kdrt, None) => {
            let made = task::run_for(PatternTask(parameters.pattern), monitor).await;
            let pattern = made.map_err(MakeError::fault)??;
            run_on(gpu, parameters, &pattern, &mut observer).await
        }
    };

    let error = match ran {
        Ok(run) => {
            let engine = format!("GPU ({name})");
            let preparing = GpuSessionTask {
                run,
                recipe,
                generation,
            };
            let made = task::run_for(preparing, monitor).await;
            let mut session = made.map_err(MakeError::fault)??;
            session.engine = engine;
            return Ok(session);
        }

        // Wrong parameters, which would fail on the CPU as well, and cancellation end here. After a fault of the device, the CPU
        // takes over below.
        Err(error) => error.of_device()?,
    };

    let sampling = SampleTask { recipe, generation };
    let made = task::run_for(sampling, monitor).await;
    let mut session = made.map_err(MakeError::fault)??;
    session.failure = Some(Failure { name, error });
    Ok(session)
}

/// Makes an exact tiling on a device. Only its result is kept: the CPU's recording has the stages of small ones.
async fn exact_on(
    gpu: &Arc<Gpu>,
    parameters: &Parameters,
    arrived: &PatternArrivals,
    observer: &mut Reporter<'_>,
) -> Result<Run, GpuError> {
    // As in `run_on`.
    parameters.validate_sequential()?;
    exact_on_gpu(gpu, parameters, arrived, observer).await
}

/// Runs parameters on a device, keeping either all stages or only the result.
async fn run_on(
    gpu: Arc<Gpu>,
    parameters: &Parameters,
    pattern: &Arc<Pattern>,
    observer: &mut Reporter<'_>,
) -> Result<Run, GpuError> {
    // Parameters that the CPU's engine refuses are refused here, too, and not as an error of the device.
    parameters.validate_sequential()?;

    if !keeps_everything(parameters)? {
        return GpuSweep::run(gpu, parameters, pattern, observer).await;
    }

    // If all stages are kept, the run is made stage by stage, and can be cancelled between two of them.
    let mut stepper = Stepper::new(gpu, parameters, pattern, FIRST_GPU_STAGE).await?;
    while let Some(completed) = stepper.step().await? {
        // An observer that stops the run names the stage at which it does.
        if let Some(stage) = observer.report(completed, 1.0) {
            return Err(SampleError::Cancelled { stage }.into());
        }
    }
    stepper.run().await
}
