//! Every kind of background task, by its name, for workers on a page. A new task needs a line here.

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
    crate::analysis::reference::MeasureReferenceTask,
    crate::analysis::brush::BrushTask,
    crate::curve::CurveTask,
    crate::compare::DivergenceTask,
    crate::compare::difference::DifferenceTask,
    crate::files::ReadTask,
    crate::state::export::ExportTask,
    crate::thumbnails::ThumbnailTask,
    tilescope_classroom::lesson_picture::StepPictureTask,
    tilescope_classroom::handout::HandoutTask,
}

#[cfg(test)]
mod tests;
