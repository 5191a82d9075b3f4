//! The commands of the live analysis, and having the moment measured while its panel is looked at.

use std::sync::Arc;

use tilescope_session::verification::region_of;

use super::{RunView, State};
use crate::analysis::Analysis;
use crate::analysis::held::Held;
use crate::layout::Panel;
use tilescope_drawing::brushed::BrushedCause;

impl State {
    /// Returns whether what is measured can be seen.
    #[must_use]
    pub fn analyses(&self) -> bool {
        self.window.shows(Panel::Analysis)
    }

    /// Has the moment measured while somebody looks.
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

    /// Returns the file that this run is held against, or why it is not.
    #[must_use]
    pub fn held(&self) -> Option<Result<&Arc<Held>, String>> {
        let held = self.analysis.held.as_ref()?;
        let session = self.runs.first.session.as_ref()?;
        Some(match held.refusal(region_of(session)) {
            None => Ok(held),
            Some(why) => Err(why),
        })
    }

    /// Returns the causes of what is brushed at the moment, once they are found, while the analysis is looked at.
    #[must_use]
    pub fn causes(&self) -> Option<&BrushedCause> {
        self.analysis.causes(&self.runs.first, self.analyses())
    }

    /// Returns what came of the brush, in words.
    #[must_use]
    pub fn brush_said(&self) -> String {
        match (self.analysis.brush, self.shown()) {
            (Some(brush), Some(shown)) => self.analysis.marks.said(&shown, brush),
            _ => "Drag over a chart or the periodogram, or choose here: what causes it is shown on the canvas.".to_owned(),
        }
    }

    /// Holds the moments of this run, and of others, against a file.
    pub(super) fn hold(&mut self, held: Held) {
        self.window.open_panel(Panel::Analysis);
        self.analysis.held = Some(Arc::new(held));
    }

    /// Waits until the moment is measured.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle_analysis(&mut self) {
        // The first call finds where the cursor rests, the second begins.
        self.want_analysis();
        self.want_analysis();
        while self.analysis.settle() {
            self.want_analysis();
        }
    }
}

impl Analysis {
    /// Returns the causes of what is brushed at the moment of a run, once they are found; none where they are not seen.
    pub(super) fn causes(&self, run: &RunView, are_seen: bool) -> Option<&BrushedCause> {
        let brush = self.brush.filter(|_| are_seen)?;
        self.marks.of(&run.shown()?, brush)
    }
}
