//! A set in space as balls instead of a plane through it.

use tilescope_drawing::orbit::OrbitView;

use super::{NO_PLANE, RunView};
use crate::orbit::{OrbitCommand, RunOrbit};
use crate::state::effects::Context;

impl RunView {
    /// Returns the picture of the set as balls, where that is shown instead of a plane; `None` for planar sets.
    #[must_use]
    pub fn orbit(&self) -> Option<&RunOrbit> {
        self.plane()?;
        Some(&self.orbit).filter(|orbit| orbit.is_shown())
    }

    /// Shows the set as balls, or changes how they are seen.
    pub(in crate::state) fn change_orbit(&mut self, command: OrbitCommand, context: &mut Context) {
        // The size is that of the canvas, whatever it shows.
        if self.plane().is_none() && !matches!(command, OrbitCommand::Size(_)) {
            return context.tell_error(NO_PLANE.to_owned());
        }
        self.orbit.apply(command);
    }

    /// Shows balls from a saved view, or a plane; returns whether the set is one that has such a view.
    pub(in crate::state) fn take_orbit(&mut self, view: Option<OrbitView>) -> bool {
        let fits = view.is_none() || self.plane().is_some();
        self.orbit.take(view.filter(|_| fits));
        fits
    }

    /// Shows this run as another one is shown, where both are in space.
    pub(in crate::state) fn follow_orbit(&mut self, other: &Self) {
        if self.plane().is_some() && other.plane().is_some() {
            self.orbit.take(other.orbit().map(RunOrbit::view));
        }
    }
}
