//! A run between two passes, and the CPU's beside it, whichever the method.

use std::sync::Arc;

use tilescope_core::{
    Observer, Parameters, Pattern, PatternArrivals, PatternHistory, SampleError, Stage,
    TilingMethod,
};
use tilescope_gpu::cpu_reference::{CpuReference, RunDifference};
use tilescope_gpu::layout::Name;
use tilescope_gpu::{
    BufferRows, ExactReference, ExactRows, ExactStepper, Gpu, GpuError, PassReport, RowLocator,
    RowPlaces, Stepper,
};

/// A run on the device that stops after any pass.
pub(super) enum AnyStepper {
    Kdrt(Box<Stepper>),
    Exact(Box<ExactStepper>),
}

/// The data from which the places of buffer rows follow, read between the same two passes as the rows.
pub(super) enum AnyRows {
    Kdrt(RowLocator),
    Exact(ExactRows),
}

impl AnyRows {
    pub(super) fn locate(&self, name: Name, table: &BufferRows) -> RowPlaces {
        match self {
            Self::Kdrt(rows) => rows.locate(name, table),
            Self::Exact(rows) => rows.locate(name, table),
        }
    }
}

impl AnyStepper {
    /// Returns a run before its first pass. The last few patterns are kept, so that the pattern is usually at hand.
    pub(super) async fn new(
        gpu: &Arc<Gpu>,
        parameters: &Parameters,
        observer: &mut dyn Observer,
    ) -> Result<Self, GpuError> {
        let (gpu, spec) = (Arc::clone(gpu), &parameters.pattern);

        match parameters.method {
            TilingMethod::Kdrt => {
                let pattern = Pattern::of_spec(spec, observer)?;
                // The device makes all stages, so that each has passes to look at.
                let first_gpu_stage = Stage::Blocks;
                let stepper = Stepper::new(gpu, parameters, &pattern, first_gpu_stage).await?;
                Ok(Self::Kdrt(Box::new(stepper)))
            }
            TilingMethod::Exact => {
                // The device throws refused darts again, and needs no table of them.
                let arrived = PatternArrivals::of_spec(spec, observer)?;
                let stepper = ExactStepper::new(gpu, parameters, &arrived).await?;
                Ok(Self::Exact(Box::new(stepper)))
            }
        }
    }

    pub(super) async fn step_pass(&mut self) -> Result<Option<PassReport>, GpuError> {
        match self {
            Self::Kdrt(stepper) => stepper.step_pass().await,
            Self::Exact(stepper) => stepper.step_pass().await,
        }
    }

    pub(super) async fn rewind(&mut self) -> Result<(), GpuError> {
        match self {
            Self::Kdrt(stepper) => stepper.rewind().await,
            Self::Exact(stepper) => stepper.rewind().await,
        }
    }

    pub(super) fn reports(&self) -> &[PassReport] {
        match self {
            Self::Kdrt(stepper) => stepper.reports(),
            Self::Exact(stepper) => stepper.reports(),
        }
    }

    pub(super) const fn restarts(&self) -> u32 {
        match self {
            Self::Kdrt(stepper) => stepper.restarts(),
            Self::Exact(stepper) => stepper.restarts(),
        }
    }

    pub(super) fn ended_stage(&self) -> Option<Stage> {
        match self {
            Self::Kdrt(stepper) => stepper.ended_stage(),
            Self::Exact(stepper) => stepper.ended_stage(),
        }
    }

    pub(super) async fn table(&self, name: Name, rows: u64) -> Result<BufferRows, GpuError> {
        match self {
            Self::Kdrt(stepper) => stepper.table(name, rows).await,
            Self::Exact(stepper) => stepper.table(name, rows).await,
        }
    }

    /// `stage` is that of the visited pass, since some buffers hold other data in other stages.
    pub(super) async fn rows(&self, stage: Stage) -> Result<AnyRows, GpuError> {
        match self {
            Self::Kdrt(stepper) => stepper.row_locator(stage).await.map(AnyRows::Kdrt),
            Self::Exact(stepper) => stepper.rows().await.map(AnyRows::Exact),
        }
    }

    pub(super) fn set_word(&self, name: Name, index: u64, word: u32) {
        match self {
            Self::Kdrt(stepper) => stepper.set_word(name, index, word),
            Self::Exact(stepper) => stepper.set_word(name, index, word),
        }
    }
}

/// The same run on the CPU.
pub(super) enum AnyReference {
    Kdrt(Box<CpuReference>),
    Exact(Box<ExactReference>),
}

impl AnyReference {
    /// Returns the run before its first stage; of exact tiling, which has no state to stop in, the whole run.
    pub(super) fn new(
        parameters: &Parameters,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        let spec = &parameters.pattern;
        match parameters.method {
            TilingMethod::Kdrt => {
                let pattern = Pattern::of_spec(spec, observer)?;
                let reference = CpuReference::new(parameters, &pattern)?;
                Ok(Self::Kdrt(Box::new(reference)))
            }
            // The CPU's engine does not go stage by stage, and its run is finished here. The level at which a sample
            // arrived says in which iteration the device must have decided it.
            TilingMethod::Exact => {
                let history = PatternHistory::of_spec(spec, observer)?;
                let reference = ExactReference::new(parameters, &history, observer)?;
                Ok(Self::Exact(Box::new(reference)))
            }
        }
    }

    /// Returns the first difference of the device's run from the CPU's after a stage, or `None` if they are equal.
    pub(super) async fn compare(
        &mut self,
        stage: Stage,
        stepper: &AnyStepper,
        observer: &mut dyn Observer,
    ) -> Result<Option<RunDifference>, GpuError> {
        match (self, stepper) {
            // The sequential engine goes on to the same stage. The run of an exact tiling is finished already.
            (Self::Kdrt(reference), AnyStepper::Kdrt(stepper)) => {
                reference.advance(stage, observer)?;
                Ok(reference.compare(stage, &stepper.run().await?))
            }
            (Self::Exact(reference), AnyStepper::Exact(stepper)) => {
                Ok(reference.compare(stage, &stepper.samples().await?))
            }
            // Both follow from the method of the same parameters.
            (Self::Kdrt(_), AnyStepper::Exact(_)) | (Self::Exact(_), AnyStepper::Kdrt(_)) => {
                unreachable!("a run and its reference have one method")
            }
        }
    }
}
