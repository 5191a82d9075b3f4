//! A run and its view: the session, its verification, the moment, the camera and the selection. There is one for the run
//! that the panels show, and one for a second run beside it. Begin with [`RunView`]; each file of `run_view/` has the
//! commands of one aspect.

use std::sync::Arc;

use emath::Rect;
use glam::DVec2;
use tilescope_core::{Parameters, Stage};
use tilescope_debugger::{Debugger, OutlineRows, Stops};
use tilescope_session::geometry::Geometry;
use tilescope_session::jobs::Job;
use tilescope_session::layers::{Layers, SessionKind};
use tilescope_session::moment::{Moment, ShownMoment};
use tilescope_session::selection::Selection;
use tilescope_session::session::{MakeError, Session};
use tilescope_session::verification::{Verdict, WitnessMark};

use super::{Appearance, Verification};
use crate::analysis::Measuring;
use crate::analysis::solid::SolidMeasuring;
use crate::curve::RunCurve;
use crate::live::Live;
use crate::orbit::RunOrbit;
use crate::passes::Passes;
use tilescope_drawing::brushed::BrushedCause;
use tilescope_drawing::camera::{Camera, Flight};
use tilescope_drawing::subject::{Contrast, GroundView, Subject};

mod camera;
mod debug;
mod hits;
mod orbit;
mod passes;
mod plane;
mod prefix;
mod time;
mod transition;
mod work;

pub use debug::{EventQuery, FindEventsTask, FoundEvents, MAX_FOUND};

pub use hits::{CountHitsTask, Hits, MAX_HITS};
pub use plane::NO_PLANE;
pub(super) use time::next_line;
pub(crate) use time::none_there;
pub(super) use transition::TRANSITION_SECS;
pub(super) use work::Asked;

/// The result of making a session.
pub(super) type Made = Result<Result<Session, MakeError>, String>;

/// A run and its view.
pub struct RunView {
    /// The session, once one is made.
    pub session: Option<Arc<Session>>,
    /// The session being made.
    pub sampling: Option<Job<Result<Session, MakeError>>>,
    /// The verification of the session.
    pub verification: Verification,
    /// The stage shown, as its index in the session.
    pub stage: usize,
    /// The events of the session with the cursor, if events were recorded.
    pub debugger: Option<Debugger>,
    /// The camera of its canvas.
    pub camera: Camera,
    /// The rectangle of its canvas in the window.
    pub viewport: Rect,
    /// The sample under the pointer.
    pub hovered: Option<u32>,
    /// The selected sample, by its id.
    pub selected: Option<u32>,
    /// The selected place, in r.
    pub place: Option<DVec2>,
    /// The witness of a verdict that the user flew to.
    pub witness_mark: Option<WitnessMark>,
    /// The gaps and the triangulation of the moment.
    pub geometry: Geometry,
    /// The measures of the moment that move with the run.
    pub live: Live,
    /// All measures of the moment, once it rests.
    pub measuring: Measuring,
    /// The spectrum and g(r) of the moment of a set in space, once it rests.
    pub solid_measuring: SolidMeasuring,
    /// The curve of the run.
    pub curve: RunCurve,
    /// The parameters of the session being made, if no file is part of its input.
    pub(super) asked: Option<Parameters>,
    /// The visible rows of the event browser's tree.
    pub rows: Option<OutlineRows>,
    /// Breakpoints, watches and scenes, while there are no events to apply them to.
    pub(super) stops: Stops,
    /// The file that the session was saved to or opened from last.
    pub session_path: Option<String>,
    /// The cursor at which the event browser's tree was last expanded.
    pub(super) revealed: usize,
    /// The passes of the session's parameters on the GPU, once opened.
    pub passes: Option<Passes>,
    /// The query of the event browser.
    pub query: EventQuery,
    /// The history of the selection.
    pub history_found: FoundEvents,
    /// The events at which the breakpoints would stop.
    pub hits: Hits,
    /// The flight of the camera, if it is flying.
    pub flight: Option<Flight>,
    /// Whether the whole domain is fitted into the canvas, also when the window changes.
    pub(super) fitted: bool,
    /// The place in the middle of the canvas and how many r around it fit, also when the window changes; `None` once the
    /// user moves the picture.
    pub(super) framed: Option<(DVec2, f64)>,
    /// While the pattern is shown, which has its own domain: the camera to return to, and whether it was
    /// fitted.
    pub(super) before_pattern: Option<(Camera, bool)>,
    transition: transition::Transition,
    /// The prefix that is shown, of nested levels.
    prefix: prefix::Prefix,
    /// The plane that is shown, of a set in space.
    plane: plane::Plane,
    /// The picture of a set in space as balls, where that is shown instead of a plane.
    orbit: RunOrbit,
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
            live: Live::default(),
            measuring: Measuring::default(),
            solid_measuring: SolidMeasuring::default(),
            curve: RunCurve::default(),
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
            // A new run is shown whole.
            fitted: true,
            framed: None,
            before_pattern: None,
            transition: transition::Transition::default(),
            prefix: prefix::Prefix::default(),
            plane: plane::Plane::default(),
            orbit: RunOrbit::default(),
        }
    }
}

impl RunView {
    /// Returns this run, and leaves an empty one in its place, with the same canvas. Breakpoints, watches and scenes go on
    /// to the next run, as they do between runs.
    pub(super) fn set_aside(&mut self) -> Self {
        let empty = Self {
            viewport: self.viewport,
            stops: self.stops(),
            ..Self::default()
        };
        std::mem::replace(self, empty)
    }

    /// Returns the moment that is shown.
    #[must_use]
    pub fn shown(&self) -> Option<ShownMoment<'_>> {
        let session = self.session.as_deref()?;
        Some(ShownMoment {
            session,
            debugger: self.debugger.as_ref(),
            stage: *session.stages.get(self.stage)?,
            prefix: self.prefix(),
            plane: self.plane(),
        })
    }

    /// Returns the moment that is shown, as a value without references to the run.
    #[must_use]
    pub fn moment(&self) -> Option<Moment> {
        self.shown().map(|shown| shown.moment())
    }

    /// Returns the selected sample or place.
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

    /// Returns the kind of the session; before there is one, a run.
    #[must_use]
    pub fn kind(&self) -> SessionKind {
        let session = self.session.as_ref();
        session.map_or(SessionKind::Run, |session| session.kind())
    }

    /// Returns the stage shown.
    #[must_use]
    pub fn current_stage(&self) -> Option<Stage> {
        self.session.as_ref()?.stages.get(self.stage).copied()
    }

    /// Returns the layers that are shown of it.
    #[must_use]
    pub fn layers(&self, appearance: &Appearance) -> Layers {
        appearance.layers_of(self.kind(), self.current_stage())
    }

    /// Returns the verdict, once there is one.
    #[must_use]
    pub fn verdict(&self) -> Option<&Verdict> {
        match &self.verification {
            Verification::Done(verdict) => Some(verdict),
            _ => None,
        }
    }

    /// Returns the subject of its canvas.
    pub(super) fn subject<'a>(
        &'a self,
        appearance: &Appearance,
        contrast: Option<Contrast<'a>>,
        causes: Option<&'a BrushedCause>,
    ) -> Option<Subject<'a>> {
        Some(Subject {
            shown: self.shown()?,
            camera: self.camera,
            layers: self.session.as_ref()?.drawable(self.layers(appearance)),
            colouring: appearance.colouring,
            hovered: self.hovered,
            selected: self.selected,
            place: self.place,
            witness_mark: self.witness_mark,
            geometry: &self.geometry,
            contrast,
            causes,
            view: GroundView::Set,
            drawn_in: self.drawn_in(),
        })
    }
}
