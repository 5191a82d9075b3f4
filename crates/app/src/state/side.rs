//! One of two runs: everything that the window knows of a run and how it is looked at. The run that the panels show lives
//! in the state itself; the two change places, so that whatever can be done with one can be done with the other.

use std::mem::swap;
use std::sync::Arc;

use egui::Rect;
use tilescope_core::Parameters;
use tilescope_debugger::{Debugger, OutlineRows, Stops};

use super::{EventQuery, Found, Hits, State, Verification};
use crate::camera::{Camera, Flight};
use crate::geometry::Geometry;
use crate::jobs::Job;
use crate::moment::Shown;
use crate::passes::Passes;
use crate::session::{MakeError, Session};
use crate::verification::Sight;

/// The run that is beside the one at hand.
pub struct Side {
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
    pub place: Option<[f64; 2]>,
    /// The place that a verdict was followed to.
    pub sight: Option<Sight>,
    /// The triangulation of the moment.
    pub geometry: Geometry,
    /// What the run at work is made from, where no file takes part.
    pub(super) asked: Option<Parameters>,
    pub(super) rows: Option<OutlineRows>,
    stops: Stops,
    session_path: Option<String>,
    revealed: usize,
    passes: Option<Passes>,
    query: EventQuery,
    history_found: Found,
    hits: Hits,
    pub(super) flight: Option<Flight>,
    pub(super) fitted: bool,
    pub(super) before_pattern: Option<(Camera, bool)>,
}

impl Default for Side {
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
            sight: None,
            geometry: Geometry::default(),
            asked: None,
            rows: None,
            stops: Stops::default(),
            session_path: None,
            revealed: 0,
            passes: None,
            query: EventQuery::default(),
            history_found: Found::default(),
            hits: Hits::default(),
            flight: None,
            fitted: true,
            before_pattern: None,
        }
    }
}

impl Side {
    /// Returns the moment that is shown.
    #[must_use]
    pub fn shown(&self) -> Option<Shown<'_>> {
        let session = self.session.as_deref()?;
        Some(Shown {
            session,
            debugger: self.debugger.as_ref(),
            stage: *session.stages.get(self.stage)?,
        })
    }
}

impl State {
    /// Has the run at hand and another one change places.
    pub(super) fn exchange(&mut self, side: &mut Side) {
        swap(&mut self.session, &mut side.session);
        swap(&mut self.sampling, &mut side.sampling);
        swap(&mut self.verification, &mut side.verification);
        swap(&mut self.stage, &mut side.stage);
        swap(&mut self.debugger, &mut side.debugger);
        swap(&mut self.camera, &mut side.camera);
        swap(&mut self.viewport, &mut side.viewport);
        swap(&mut self.hovered, &mut side.hovered);
        swap(&mut self.selected, &mut side.selected);
        swap(&mut self.place, &mut side.place);
        swap(&mut self.sight, &mut side.sight);
        swap(&mut self.geometry, &mut side.geometry);
        swap(&mut self.rows, &mut side.rows);
        swap(&mut self.stops, &mut side.stops);
        swap(&mut self.session_path, &mut side.session_path);
        swap(&mut self.hits, &mut side.hits);
        swap(&mut self.revealed, &mut side.revealed);
        swap(&mut self.passes, &mut side.passes);
        swap(&mut self.query, &mut side.query);
        swap(&mut self.history_found, &mut side.history_found);
        swap(&mut self.flight, &mut side.flight);
        swap(&mut self.fitted, &mut side.fitted);
        swap(&mut self.before_pattern, &mut side.before_pattern);
    }
}
