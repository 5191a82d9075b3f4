//! The reference set: a maximal Poisson-disk set by dart throwing, always the same, measured once.

use std::sync::Arc;

use tilescope_analysis::measures::MeasuredSet;
use tilescope_core::{Boundary, Pattern, PatternSpec, Unobserved};
use tilescope_session::jobs::{Job, Monitor, Wake};
use tilescope_session::task::{self, Task};
use tilescope_session::units::radii;
use tilescope_session::words::grouped;
use tilescope_sets::region_in_radii;

use super::measured::{Samples, refusal};

/// The set is made as a pattern, larger than the default pattern of runs.
pub const SPEC: PatternSpec = PatternSpec {
    side: 200.0,
    boundary: Boundary::Periodic,
    seed: 0,
};

/// The measures of the reference set.
#[derive(Default)]
pub enum Reference {
    /// It was not requested yet.
    #[default]
    Unknown,
    /// It is being measured.
    Pending(Job<Result<MeasuredSet, String>>),
    /// It was measured. It never changes, since the set is always the same.
    Known(Arc<MeasuredSet>),
    /// It could not be measured, and why.
    Failed(String),
}

impl Reference {
    /// Returns its measures, once known.
    #[must_use]
    pub const fn measured(&self) -> Option<&Arc<MeasuredSet>> {
        match self {
            Self::Known(measured) => Some(measured),
            _ => None,
        }
    }

    /// Returns how the set was made, and its number of samples once it is measured.
    #[must_use]
    pub fn name(&self) -> String {
        let count = self.measured().map_or_else(String::new, |measured| {
            format!(", {} samples", grouped(measured.samples))
        });
        format!("dart throwing, {} r periodic{count}", SPEC.side)
    }

    /// Stops measuring it; the next [`Self::want`] begins anew.
    pub(super) fn rest(&mut self) {
        if matches!(self, Self::Pending(_)) {
            *self = Self::Unknown;
        }
    }

    pub(super) fn want(&mut self, wake: &Wake) {
        match self {
            Self::Unknown => *self = Self::Pending(task::start(wake, MeasureReferenceTask)),
            Self::Pending(job) => {
                if let Some(outcome) = job.poll() {
                    self.take(outcome);
                }
            }
            Self::Known(_) | Self::Failed(_) => {}
        }
    }

    fn take(&mut self, outcome: Result<Result<MeasuredSet, String>, String>) {
        *self = match outcome {
            Ok(Ok(measured)) => Self::Known(Arc::new(measured)),
            Ok(Err(why)) | Err(why) => Self::Failed(why),
        };
    }

    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle(&mut self) -> bool {
        let Self::Pending(job) = self else {
            return false;
        };
        let outcome = job.wait();
        self.take(outcome);
        true
    }
}

/// The task of measuring the reference set.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct MeasureReferenceTask;

impl Task for MeasureReferenceTask {
    type Outcome = Result<MeasuredSet, String>;
    const NAME: &'static str = "measure the reference";

    fn run(self, monitor: &Monitor) -> Self::Outcome {
        // Only the measuring below reports its progress and can be stopped.
        let pattern =
            Pattern::of_spec(&SPEC, &mut Unobserved).map_err(|error| error.to_string())?;
        let samples = pattern.samples().iter();
        let points = samples.map(|point| [radii(point.x), radii(point.y)]);
        let set = Samples {
            points: points.collect(),
            region: region_in_radii(pattern.domain()),
            // Places are in r.
            radius: 1.0,
        };

        let measured = set.measured(&|progress| monitor.follow(progress));
        // A cancelled measurement has no reason, and no caller reads its outcome.
        measured.map_err(|error| refusal(&error).unwrap_or_default())
    }
}
