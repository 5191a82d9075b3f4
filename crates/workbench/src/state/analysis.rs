//! The live analysis and the runs that are shown: its commands, the file to compare with, and the causes of the brush.

use std::sync::Arc;

use tilescope_drawing::brushed::BrushedCause;
use tilescope_session::jobs::Wake;
use tilescope_sets::region;

use super::{RunView, Runs, WindowState};
use crate::analysis::reference_file::ReferenceFile;
use crate::analysis::{Analysis, AnalysisCommand};
use crate::layout::Panel;

impl Runs {
    /// Stops or goes on measuring: both runs are measured, or neither.
    pub(super) fn measure(&mut self, command: AnalysisCommand) {
        let second = self.second.as_mut().map(|(run, _)| run);
        for run in [Some(&mut self.first), second].into_iter().flatten() {
            match command {
                AnalysisCommand::Stop => run.stop_measuring(),
                AnalysisCommand::Resume => {
                    run.measuring.resume();
                    run.solid_measuring.resume();
                }
                AnalysisCommand::Clear | AnalysisCommand::Brush(_) => {}
            }
        }
    }
}

impl Analysis {
    /// Applies a command to what the runs are compared with.
    pub(super) fn apply(&mut self, command: AnalysisCommand) {
        match command {
            AnalysisCommand::Stop | AnalysisCommand::Resume => {}
            AnalysisCommand::Clear => self.reference_file = None,
            AnalysisCommand::Brush(brush) => self.brush = brush,
        }
    }

    /// Looks at the moment of a run; rests while the analysis is not visible.
    pub(super) fn follow(&mut self, run: &RunView, is_seen: bool, wake: &Wake) {
        if !is_seen {
            return self.rest();
        }
        match (&run.session, run.shown()) {
            // Reference and brush are of planar sets.
            (Some(session), Some(shown)) if session.solid.is_none() => {
                self.want(session, &shown, wake);
            }
            _ => self.rest(),
        }
    }

    /// Waits until the reference is measured and the causes of the brush are found.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle_with(&mut self, run: &RunView, is_seen: bool, wake: &Wake) {
        // The first call notes the moment, the second starts the work.
        self.follow(run, is_seen, wake);
        self.follow(run, is_seen, wake);
        while self.settle() {
            self.follow(run, is_seen, wake);
        }
    }

    /// Returns the file that a run is compared with, or why it cannot be.
    #[must_use]
    pub fn file_for(&self, run: &RunView) -> Option<Result<&Arc<ReferenceFile>, String>> {
        let file = self.reference_file.as_ref()?;
        let session = run.session.as_ref()?;
        Some(match file.refusal(region(&session.run().domain)) {
            None => Ok(file),
            Some(why) => Err(why),
        })
    }

    /// Returns the result of the brush at the moment of a run, in words.
    #[must_use]
    pub fn brush_text(&self, run: &RunView) -> String {
        match (self.brush, run.shown()) {
            (Some(brush), Some(shown)) => self.marks.description(&shown, brush),
            _ => "Drag over a chart or the periodogram, or enter a range here: the samples or pairs that cause it are shown on the canvas.".to_owned(),
        }
    }

    /// Returns the causes of the brush at the moment of a run, if found, while the window shows the panel of the analysis.
    #[must_use]
    pub fn causes(&self, run: &RunView, window: &WindowState) -> Option<&BrushedCause> {
        let brush = self.brush.filter(|_| window.shows(Panel::Analysis))?;
        self.marks.of(&run.shown()?, brush)
    }
}
