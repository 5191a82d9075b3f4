//! Makes sessions: tasks that sample on the CPU, and a run on a GPU.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use tilescope_core::{Parameters, Pattern, PatternSpec, Run, SampleError, Stage};
use tilescope_gpu::{Gpu, GpuError, GpuSweep, Stepper};

use crate::jobs::Monitor;
use crate::recipe::Recipe;
use crate::session::{Failure, MakeError, Reporter, Session, keeps_everything};
use crate::task::{self, SessionRef, Task};

/// What comes of making a session.
pub type Made = Result<Session, MakeError>;

/// Samples on the CPU.
#[derive(Serialize, Deserialize)]
pub struct SampleTask {
    /// What is made.
    pub recipe: Recipe,
    /// What the session is known by.
    pub generation: u64,
}

impl Task for SampleTask {
    type Outcome = Made;
    const NAME: &'static str = "sample";

    fn run(self, monitor: &Monitor) -> Made {
        Ok(Session::sample(&self.recipe, self.generation, monitor)?)
    }

    fn cancelled(monitor: &Monitor) -> Option<Made> {
        Some(Err(MakeError::cancelled_by(monitor)))
    }

    fn keep(made: Made) {
        SessionRef::keep(made);
    }
}

/// Makes the pattern that a description asks for.
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

/// Prepares what a GPU has made, with the events of the same run on the CPU.
#[derive(Serialize, Deserialize)]
pub struct GpuSessionTask {
    /// What the GPU made.
    pub run: Run,
    /// What it was asked to make.
    pub recipe: Recipe,
    /// What the session is known by.
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

/// The first stage that a GPU runs of a run that is kept stage by stage.
const FIRST_GPU_STAGE: Stage = Stage::Blocks;

/// Samples by `recipe` on `gpu` and prepares the result: with all its stages where the CPU would keep
/// them, too. If the device fails, the CPU makes the same session, which then knows of the failure.
///
/// Fails as [`Session::sample`], never because of the device.
pub async fn on_gpu(
    gpu: Arc<Gpu>,
    recipe: &Recipe,
    generation: u64,
    monitor: &Arc<Monitor>,
) -> Result<Session, MakeError> {
    let name = gpu.report().name.clone();
    let mut observer = Reporter { monitor };
    let recipe = recipe.clone();
    let pattern = if let Some(own) = &recipe.own {
        Arc::clone(&own.pattern)
    } else {
        let making = PatternTask(recipe.parameters.pattern);
        let made = task::run_for(making, monitor).await;
        made.map_err(MakeError::fault)??
    };
    let parameters = &recipe.parameters;
    let error = match run_on(gpu, parameters, &pattern, &mut observer).await {
        Ok(run) => {
            let engine = format!("GPU ({name})");
            let twin = GpuSessionTask {
                run,
                recipe,
                generation,
            };
            let session = task::run_for(twin, monitor).await;
            let mut session = session.map_err(MakeError::fault)??;
            session.engine = engine;
            return Ok(session);
        }
        Err(GpuError::Sample(error)) => return Err(error.into()),
        Err(error) => error,
    };
    let sampling = SampleTask { recipe, generation };
    let session = task::run_for(sampling, monitor).await;
    let mut session = session.map_err(MakeError::fault)??;
    session.failure = Some(Failure { name, error });
    Ok(session)
}

/// Runs parameters on a device: to the last stage with all of them kept, or for the result alone.
async fn run_on(
    gpu: Arc<Gpu>,
    parameters: &Parameters,
    pattern: &Arc<Pattern>,
    observer: &mut Reporter<'_>,
) -> Result<Run, GpuError> {
    parameters.validate_sequential()?;
    if !keeps_everything(parameters)? {
        return GpuSweep::run(gpu, parameters, pattern, observer).await;
    }
    let mut stepper = Stepper::new(gpu, parameters, pattern, FIRST_GPU_STAGE).await?;
    while let Some(stage) = stepper.step().await? {
        if let Some(stage) = observer.report(stage, 1.0) {
            return Err(SampleError::Cancelled { stage }.into());
        }
    }
    stepper.run().await
}
