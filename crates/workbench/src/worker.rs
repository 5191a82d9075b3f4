//! Every kind of background task, by its name, for workers on a page. A new task needs a line here.

use std::error::Error;
use std::sync::Arc;

use tilescope_core::{Parameters, Unobserved};
use tilescope_debugger::{DEFAULT_BUDGET, Recording};
use tilescope_live::{Course, Motion, timed};
use tilescope_session::jobs::Monitor;
use tilescope_session::task::{Task, TaskError, run};

macro_rules! tasks {
    ($($task:ty,)*) => {
        /// Runs the task called `name` and returns its outcome as bytes.
        ///
        /// # Errors
        ///
        /// [`TaskError`]: it refers to sessions that are not kept here, or there is no such task.
        pub fn perform(name: &str, input: &[u8], monitor: &Monitor) -> Result<Vec<u8>, TaskError> {
            match name {
                $(<$task>::NAME => run::<$task>(input, monitor),)*
                other => Err(TaskError::Failed(format!("there is no job called {other:?}"))),
            }
        }

        /// The names of all tasks.
        #[cfg(test)]
        const NAMES: &[&str] = &[$(<$task>::NAME,)*];
    };
}

tasks! {
    tilescope_session::sampling::PatternTask,
    tilescope_session::sampling::ArrivalsTask,
    tilescope_session::sampling::SampleTask,
    tilescope_session::sampling::GpuSessionTask,
    tilescope_session::combining::CombineTask,
    tilescope_session::verification::VerifyTask,
    tilescope_session::geometry::ExposeTask,
    tilescope_session::geometry::TriangulateTask,
    crate::state::run_view::CountHitsTask,
    crate::state::run_view::FindEventsTask,
    crate::analysis::StartMeasuringTask,
    crate::analysis::ContinueMeasuringTask,
    crate::analysis::solid::MeasureSolidTask,
    crate::analysis::reference::MeasureReferenceTask,
    crate::analysis::brush::BrushTask,
    crate::curve::CurveTask,
    crate::orbit::OrbitTask,
    crate::compare::DivergenceTask,
    crate::compare::difference::DifferenceTask,
    crate::files::ReadTask,
    crate::files::packaging::PackageTask,
    crate::state::export::ExportTask,
    crate::thumbnails::ThumbnailTask,
    tilescope_classroom::lesson_picture::StepPictureTask,
    tilescope_classroom::handout::HandoutTask,
}

/// Times the measures that move with the run of default parameters and this radius, without drawing, by `seconds`, a clock that never
/// goes back. Returns a JSON array with an object for each motion without and with the analysis.
///
/// # Errors
///
/// A sentence, if there is no such run.
pub fn time_measures(radius: f64, seconds: &dyn Fn() -> f64) -> Result<String, String> {
    timed_rows(radius, seconds).map_err(|error| error.to_string())
}

/// Returns the array of [`time_measures`], or the error itself.
fn timed_rows(radius: f64, seconds: &dyn Fn() -> f64) -> Result<String, Box<dyn Error>> {
    let parameters = Parameters {
        radius,
        ..Parameters::default()
    };
    let recording = Recording::new(&parameters, DEFAULT_BUDGET, &mut Unobserved)?;
    let course = Arc::new(Course::of_recording(&recording));

    let mut rows = Vec::new();
    for motion in Motion::ALL {
        for analysis in [false, true] {
            rows.push(timed(&recording, &course, motion, analysis, seconds)?);
        }
    }
    Ok(serde_json::to_string(&rows)?)
}

#[cfg(test)]
mod tests;
