//! The live analysis in the state: its commands, and measuring while its panel is visible.

use std::sync::Arc;

use tilescope_sets::region;

use super::{RunView, State};
use crate::analysis::Analysis;
use crate::analysis::reference_file::ReferenceFile;
use crate::layout::Panel;
use tilescope_drawing::brushed::BrushedCause;

impl State {
    /// Returns whether the analysis panel is visible.
    #[must_use]
    pub fn analyses(&self) -> bool {
        self.window.shows(Panel::Analysis)
    }

    /// Measures the moment while the panel is visible.
    pub(super) fn want_analysis(&mut self) {
        if !self.analyses() {
            self.analysis.rest();
            return;
        }
        let run = &self.runs.first;
        if let (Some(session), Some(shown)) = (&run.session, run.shown()) {
            self.analysis.want(session, &shown, &self.jobs.wake);
        }
    }

    /// Returns the file that this run is compared with, or why it cannot be.
    #[must_use]
    pub fn reference_file(&self) -> Option<Result<&Arc<ReferenceFile>, String>> {
        let file = self.analysis.reference_file.as_ref()?;
        let session = self.runs.first.session.as_ref()?;
        Some(match file.refusal(region(&session.run().domain)) {
            None => Ok(file),
            Some(why) => Err(why),
        })
    }

    /// Returns the causes of the brush at the current moment, if found, while the panel is visible.
    #[must_use]
    pub fn causes(&self) -> Option<&BrushedCause> {
        self.analysis.causes(&self.runs.first, self.analyses())
    }

    /// Returns the result of the brush, in words.
    #[must_use]
    pub fn brush_text(&self) -> String {
        match (self.analysis.brush, self.shown()) {
            (Some(brush), Some(shown)) => self.analysis.marks.description(&shown, brush),
            _ => "Drag over a chart or the periodogram, or enter a range here: the samples or pairs that cause it are shown on the canvas.".to_owned(),
        }
    }

    /// Compares the moments of this and later runs with a file.
    pub(super) fn set_reference_file(&mut self, file: ReferenceFile) {
        self.window.open_panel(Panel::Analysis);
        self.analysis.reference_file = Some(Arc::new(file));
    }

    /// Waits until the moment is measured.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle_analysis(&mut self) {
        // The first call notes the cursor, the second starts the work.
        self.want_analysis();
        self.want_analysis();
        while self.analysis.settle() {
            self.want_analysis();
        }
    }
}

impl Analysis {
    /// Returns the causes of the brush at the moment of a run, if found and visible.
    pub(super) fn causes(&self, run: &RunView, are_seen: bool) -> Option<&BrushedCause> {
        let brush = self.brush.filter(|_| are_seen)?;
        self.marks.of(&run.shown()?, brush)
    }
}
