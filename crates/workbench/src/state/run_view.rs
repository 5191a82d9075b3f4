//! A run and how it is looked at: what there is once for the run that the panels show, and once more for the run beside it.

use glam::DVec2;
use std::sync::Arc;

use tilescope_session::selection::Selection;

use emath::Rect;
use tilescope_core::{Parameters, Stage};
use tilescope_debugger::{Debugger, OutlineRows, Stops};
use tilescope_session::geometry::Geometry;
use tilescope_session::jobs::Job;
use tilescope_session::moment::{Moment, ShownMoment};
use tilescope_session::session::{MakeError, Session};
use tilescope_session::verification::{Verdict, WitnessMark};

use super::{Appearance, Verification};
use crate::passes::Passes;
use tilescope_drawing::camera::{Camera, Flight};
use tilescope_drawing::subject::{Contrast, Subject};

mod camera;
mod debug;
mod hits;
mod passes;
mod time;
mod work;

pub use debug::FindEventsTask;
pub use debug::{EventQuery, FoundEvents, MAX_FOUND};
pub use hits::CountHitsTask;
pub use hits::{Hits, MAX_HITS};
pub(super) use time::{next_line, none_there};

/// How the making of a session ends.
pub(super) type Made = Result<Result<Session, MakeError>, String>;

/// A run and how it is looked at.
pub struct RunView {
    /// What is being looked at.
    pub session: Option<Arc<Session>>,
    /// The run at work.
    pub sampling: Option<Job<Result<Session, MakeError>>>,
    /// What the verifier says about the session.
    pub verification: Verification,
    /// The stage shown, as its place in the session's list.
    pub stage: usize,
    /// The events of the session and the cursor among them, where they were kept.
    pub debugger: Option<Debugger>,
    /// The view.
    pub camera: Camera,
    /// Where its canvas is in the window.
    pub viewport: Rect,
    /// The sample under the pointer.
    pub hovered: Option<u32>,
    /// The selected sample.
    pub selected: Option<u32>,
    /// The selected place, in r.
    pub place: Option<DVec2>,
    /// The place that a verdict was followed to.
    pub witness_mark: Option<WitnessMark>,
    /// The triangulation of the moment.
    pub geometry: Geometry,
    /// What the run at work is made from, where no file takes part.
    pub(super) asked: Option<Parameters>,
    /// What the event browser shows of the tree.
    pub rows: Option<OutlineRows>,
    /// What the user has set for debugging, while there are no events to debug.
    pub(super) stops: Stops,
    /// The file that the session was saved to or opened from last.
    pub session_path: Option<String>,
    /// The cursor to which the event browser was opened last.
    pub(super) revealed: usize,
    /// The passes of the session's parameters on the GPU, once they were asked for.
    pub passes: Option<Passes>,
    /// What the event browser looks for.
    pub query: EventQuery,
    /// The history of what is selected.
    pub history_found: FoundEvents,
    /// Where the breakpoints would stop a run.
    pub hits: Hits,
    /// Where the camera is flying to.
    pub flight: Option<Flight>,
    /// Whether the whole domain is shown, and stays so when the window changes.
    pub(super) fitted: bool,
    /// While the pattern, which has a domain of its own, is shown: the camera to return to, and
    /// whether it was fitted.
    pub(super) before_pattern: Option<(Camera, bool)>,
}

impl Default for RunView {
    fn default() -> Self {
        Self {
            session: None,
            sampling: None,
            verification: Verification::Nothing,
            stage: 0,
            debugger: None,
            camera: Camera::default(),
            viewport: Rect::NOTHING,
            hovered: None,
            selected: None,
            place: None,
            witness_mark: None,
            geometry: Geometry::default(),
            asked: None,
            rows: None,
            stops: Stops::default(),
            session_path: None,
            revealed: 0,
            passes: None,
            query: EventQuery::default(),
            history_found: FoundEvents::default(),
            hits: Hits::default(),
            flight: None,
            fitted: true,
            before_pattern: None,
        }
    }
}

impl RunView {
    /// Returns the moment that is shown.
    #[must_use]
    pub fn shown(&self) -> Option<ShownMoment<'_>> {
        let session = self.session.as_deref()?;
        Some(ShownMoment {
            session,
            debugger: self.debugger.as_ref(),
            stage: *session.stages.get(self.stage)?,
        })
    }

    /// Returns the moment that is shown, to be kept while the window goes on.
    #[must_use]
    pub fn moment(&self) -> Option<Moment> {
        self.shown().map(|shown| shown.moment())
    }

    /// Returns what is selected.
    #[must_use]
    pub fn selection(&self) -> Selection {
        let sample = self.selected.map(Selection::Sample);
        let place = self.place.map(Selection::Place);
        sample.or(place).unwrap_or(Selection::Nothing)
    }

    /// Returns whether the session is a combination.
    #[must_use]
    pub fn shows_combination(&self) -> bool {
        let session = self.session.as_ref();
        session.is_some_and(|session| session.combination.is_some())
    }

    /// Returns the stage shown.
    #[must_use]
    pub fn current_stage(&self) -> Option<Stage> {
        self.session.as_ref()?.stages.get(self.stage).copied()
    }

    /// Returns the verdict, once there is one.
    #[must_use]
    pub fn verdict(&self) -> Option<&Verdict> {
        match &self.verification {
            Verification::Done(verdict) => Some(verdict),
            _ => None,
        }
    }

    /// Returns what its canvas shows, without what is known only of the run that the panels show.
    pub(super) fn subject<'a>(
        &'a self,
        appearance: &Appearance,
        contrast: Option<Contrast<'a>>,
    ) -> Option<Subject<'a>> {
        Some(Subject {
            shown: self.shown()?,
            camera: self.camera,
            layers: appearance.layers,
            colouring: appearance.colouring,
            hovered: self.hovered,
            selected: self.selected,
            place: self.place,
            witness_mark: self.witness_mark,
            geometry: &self.geometry,
            contrast,
            causes: None,
        })
    }
}
