//! Progress, cancellation and errors while a session is made.

use std::ops::ControlFlow;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use tilescope_core::{Observer, Progress, SampleError, Stage};

use super::Session;
use crate::combination::CombinationError;
use crate::jobs::Monitor;

/// Why a session could not be made.
#[derive(Debug, thiserror::Error)]
pub enum MakeError {
    /// The run failed, or was cancelled.
    #[error(transparent)]
    Sample(#[from] SampleError),
    /// The combination failed, or was cancelled.
    #[error(transparent)]
    Combination(#[from] CombinationError),
    /// Its field of radii or its shape is refused; the reason in words.
    #[error("{0}")]
    Ground(String),
    /// It failed, or was cancelled, and the error is there as text alone: it comes from a worker, or was made from a message.
    #[error("{message}")]
    InWorker {
        /// The stage in which it was cancelled, if it was.
        cancelled: Option<Stage>,
        /// The error in words.
        message: String,
    },
}

/// A [`MakeError`] as it is sent.
#[derive(Serialize, Deserialize)]
struct SentError(Option<Stage>, String);

impl Serialize for MakeError {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        SentError(self.cancelled(), self.to_string()).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for MakeError {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let SentError(cancelled, message) = SentError::deserialize(deserializer)?;
        Ok(Self::InWorker { cancelled, message })
    }
}

impl MakeError {
    /// Returns the error of a session whose making was cancelled, in the stage that `monitor` reported last.
    pub fn cancelled_by(monitor: &Monitor) -> Self {
        let activity = monitor.activity();
        let without_iterations = [
            Stage::Pattern,
            Stage::Blocks,
            Stage::Tile,
            Stage::Eliminate,
            Stage::Regions,
            Stage::Finish,
        ];
        // More iterations than a run usually has; chosen, not measured.
        let iterations = (1..=64).map(Stage::Iterate);
        let mut stages = without_iterations.into_iter().chain(iterations);

        // A monitor has its stage only as a text. A text that names none, as before the first report and while the sets
        // of a combination are made, counts as the first stage.
        let reported = stages.find(|stage| stage.to_string() == activity);
        let stage = reported.unwrap_or(Stage::Pattern);

        Self::InWorker {
            cancelled: Some(stage),
            message: SampleError::Cancelled { stage }.to_string(),
        }
    }

    /// Returns a fault of the program, in words, as an error.
    #[must_use]
    pub const fn fault(message: String) -> Self {
        Self::InWorker {
            cancelled: None,
            message,
        }
    }

    /// Returns the stage in which it was cancelled, if it was.
    #[must_use]
    pub fn cancelled(&self) -> Option<Stage> {
        match self {
            Self::Sample(SampleError::Cancelled { stage }) => Some(*stage),
            Self::Sample(_) | Self::Ground(_) => None,
            Self::Combination(error) => error.cancelled(),
            Self::InWorker { cancelled, .. } => *cancelled,
        }
    }
}

/// Reports a run's progress to a [`Monitor`] and stops the run when it was cancelled.
pub struct Reporter<'a> {
    /// Receives the progress, and says whether the work was cancelled.
    pub monitor: &'a Monitor,
}

impl Reporter<'_> {
    /// Reports `part` of `stage` as done; returns the stage if the work was cancelled.
    #[must_use]
    pub fn report(&self, stage: Stage, part: f32) -> Option<Stage> {
        self.monitor.set_activity(&stage.to_string());
        self.monitor.set_fraction(share_of(stage).at(part));
        self.monitor.is_cancelled().then_some(stage)
    }
}

/// The share of a stage in the time that work takes, from 0 to 1.
#[derive(Clone, Copy)]
pub(crate) struct StageShare {
    start: f32,
    length: f32,
}

impl StageShare {
    /// Returns the share that begins at `start` and is `length` long.
    pub const fn new(start: f32, length: f32) -> Self {
        Self { start, length }
    }

    /// Returns how much of the work is done with a part of the stage.
    pub const fn at(self, part: f32) -> f32 {
        self.start + self.length * part
    }
}

/// Returns the share of a stage in the time that a run takes, as measured on a million samples.
pub(crate) const fn share_of(stage: Stage) -> StageShare {
    match stage {
        Stage::Pattern => StageShare::new(0.0, 0.08),
        Stage::Blocks => StageShare::new(0.08, 0.01),
        Stage::Tile => StageShare::new(0.09, 0.16),
        Stage::Eliminate => StageShare::new(0.25, 0.3),
        Stage::Iterate(1) => StageShare::new(0.55, 0.3),
        Stage::Iterate(_) => StageShare::new(0.85, 0.05),
        // A parallel engine works region by region, and has no stages between pattern and end.
        Stage::Regions => StageShare::new(0.05, 0.85),
        Stage::Finish => StageShare::new(0.9, 0.1),
    }
}

/// Returns the part of a stage that is done, from 0 to 1.
pub(crate) fn part_done(progress: Progress) -> f32 {
    progress.done as f32 / progress.total.max(1) as f32
}

impl Reporter<'_> {
    /// Returns the session that `prepare` makes, unless the work was cancelled.
    pub fn prepare(&self, prepare: impl FnOnce() -> Session) -> Result<Session, SampleError> {
        // Preparing counts as the second half of the last stage, which is an estimate.
        match self.report(Stage::Finish, 0.5) {
            None => Ok(prepare()),
            Some(stage) => Err(SampleError::Cancelled { stage }),
        }
    }
}

impl Observer for Reporter<'_> {
    fn observe(&mut self, progress: Progress) -> ControlFlow<()> {
        let stopped = self.report(progress.stage, part_done(progress));
        stopped.map_or(ControlFlow::Continue(()), |_| ControlFlow::Break(()))
    }
}
