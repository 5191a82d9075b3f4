//! The live analysis and the run that is shown: the file to compare with, and the causes of the brush.

use std::sync::Arc;

use tilescope_drawing::brushed::BrushedCause;
use tilescope_session::jobs::Wake;
use tilescope_sets::region;

use super::{RunView, WindowState};
use crate::analysis::Analysis;
use crate::analysis::reference_file::ReferenceFile;
use crate::layout::Panel;

impl Analysis {
    /// Measures the moment of a run; rests while the analysis is not visible.
    pub(super) fn follow(&mut self, run: &RunView, is_seen: bool, wake: &Wake) {
        if !is_seen {
            return self.rest();
        }
        if let (Some(session), Some(shown)) = (&run.session, run.shown()) {
            self.want(session, &shown, wake);
        }
    }

    /// Waits until the moment is measured.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle_with(&mut self, run: &RunView, is_seen: bool, wake: &Wake) {
        // The first call notes the cursor, the second starts the work.
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
