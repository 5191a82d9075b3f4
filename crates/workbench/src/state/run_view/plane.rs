//! The plane through a set in space: where it lies, and moving it.

use tilescope_core::R;
use tilescope_session::solid::MadeSolid;

use super::RunView;
use crate::state::effects::Context;

/// How far a step moves the plane, in lattice units: a twentieth of r, so that no ball is passed in one step.
pub const STEP: i32 = R / 20;

/// Why there is no plane to move.
pub const NO_PLANE: &str =
    "This set is planar: a depth in the form makes a set in space, which a plane goes through.";

/// The plane that was chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Plane {
    /// Where it lies along the third axis, in lattice units; `None` for the middle of the box.
    at: Option<i32>,
    /// Whether it stays there. Otherwise it follows the events: it lies where the last one with a place happened.
    is_pinned: bool,
}

impl RunView {
    /// Returns where the plane through a set in space lies along the third axis, in lattice units; `None` for planar sets.
    #[must_use]
    pub fn plane(&self) -> Option<i32> {
        let session = self.session.as_ref()?;
        let solid = session.solid.as_ref()?;
        let of_event = || {
            let debugger = self.debugger.as_ref()?;
            session.event_height(debugger.state().cursor())
        };
        let followed = of_event().filter(|_| !self.plane.is_pinned);
        Some(followed.or(self.plane.at).unwrap_or_else(|| solid.middle()))
    }

    /// Returns whether the plane follows the events of the run; `None` where there is no plane, or there are no events.
    #[must_use]
    pub fn follows_events(&self) -> Option<bool> {
        self.plane()?;
        self.debugger.as_ref().map(|_| !self.plane.is_pinned)
    }

    /// Pins the plane where it lies, or has it follow the events again.
    pub(in crate::state) fn pin_plane(&mut self, is_pinned: bool, context: &mut Context) {
        let Some(at) = self.plane() else {
            return context.tell_error(NO_PLANE.to_owned());
        };
        // Before the first event with a place, a plane that follows the events lies here.
        self.plane = Plane {
            at: Some(at),
            is_pinned,
        };
        self.forget_unseen();
    }

    /// Returns the third side and where the plane lies along it, in user units; `None` for planar sets.
    #[must_use]
    pub fn plane_place(&self) -> Option<(f64, f64)> {
        let solid = self.session.as_ref()?.solid.as_ref()?;
        Some((solid.depth(), solid.users_from_plane(self.plane()?)))
    }

    /// Returns where the plane lies, in user units, if it was moved there; `None` if it follows the events.
    #[must_use]
    pub fn moved_plane(&self) -> Option<f64> {
        self.plane.at.filter(|_| self.plane.is_pinned)?;
        self.plane_place().map(|(_, place)| place)
    }

    /// Moves the plane to a place of the third axis, in user units; beyond the box, to its end.
    pub(in crate::state) fn show_plane(&mut self, place: f64, context: &mut Context) {
        let session = self.session.as_ref();
        match session.and_then(|session| session.solid.as_ref()) {
            Some(solid) => self.put_plane(solid.plane_at(place)),
            None => context.tell_error(NO_PLANE.to_owned()),
        }
    }

    /// Moves the plane by this many steps.
    pub(in crate::state) fn step_plane(&mut self, steps: i32, context: &mut Context) {
        let session = self.session.as_ref();
        let solid = session.and_then(|session| session.solid.as_ref());
        match solid.zip(self.plane()) {
            Some((solid, at)) => self.put_plane(solid.plane_beyond(at, steps.saturating_mul(STEP))),
            None => context.tell_error(NO_PLANE.to_owned()),
        }
    }

    /// Moves the plane through a sample, if the set is in space.
    pub(in crate::state) fn bring_plane(&mut self, id: u32) {
        let session = self.session.as_ref();
        if let Some(solid) = session.and_then(|session| session.solid.as_ref()) {
            self.put_plane(solid.height(id));
        }
    }

    /// Moves the plane to a place that was asked for, where it stays.
    fn put_plane(&mut self, at: i32) {
        self.plane = Plane {
            at: Some(at),
            is_pinned: true,
        };
        // A sample under the pointer may have left the plane.
        self.forget_unseen();
    }

    /// Moves the plane to where that of another run lies; where one of the two is planar, changes nothing.
    pub(in crate::state) fn follow_plane(&mut self, other: &Self) {
        let session = self.session.as_ref();
        let solid = session.and_then(|session| session.solid.as_ref());
        let Some((solid, (_, place))) = solid.zip(other.plane_place()) else {
            return;
        };
        // The boxes may differ in depth, so that the place is compared in user units.
        let at = solid.plane_at(place);
        if self.plane() != Some(at) || !self.plane.is_pinned {
            self.put_plane(at);
        }
    }

    /// Moves the plane to a place of the third axis, in r, where it stays; `None` has it follow the events.
    pub(in crate::state) fn cut_at(&mut self, place: Option<f64>) {
        self.cut_where(|solid| Some(solid.plane_at_radii(place?)));
    }

    /// The same for a place in user units.
    pub(in crate::state) fn cut_at_users(&mut self, place: Option<f64>) {
        self.cut_where(|solid| Some(solid.plane_at(place?)));
    }

    /// Moves the plane to where a function has it, which gives `None` for a plane that follows the events. A planar set has
    /// none.
    fn cut_where(&mut self, at: impl FnOnce(&MadeSolid) -> Option<i32>) {
        let session = self.session.as_ref();
        let solid = session.and_then(|session| session.solid.as_ref());
        match solid.and_then(at) {
            Some(at) => self.put_plane(at),
            None => self.plane = Plane::default(),
        }
    }

    /// Lets the plane follow the events exactly if that of another run does.
    pub(in crate::state) const fn pin_as(&mut self, other: &Self) {
        self.plane.is_pinned = other.plane.is_pinned;
    }

    /// Keeps the plane for a set of the same box, and puts that of another box in its middle.
    pub(in crate::state) fn reset_plane(&mut self, is_same_box: bool) {
        if !is_same_box {
            self.plane = Plane::default();
        }
    }
}
