//! The appearance of moments: layers, colouring, look, and whether the camera may fly.

use tilescope_core::Stage;
use tilescope_session::layers::{Colouring, Layers, SessionKind};
use tilescope_session::look::Look;

use crate::command::AppearanceCommand;
use crate::curve::ShownCurve;

/// The appearance of moments.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Appearance {
    /// The layers that the user chose; `None` for those of the stage.
    pub chosen_layers: Option<Layers>,
    /// The property of samples that their colour shows.
    pub colouring: Colouring,
    /// Light, dark or for a projector; [`Self::choose_look`] changes it.
    pub look: Look,
    /// The look to return to from projector mode.
    pub(crate) look_before: Look,
    /// The curve above the timeline.
    pub curve: ShownCurve,
    /// Whether the radii, the shape and the dots of a set in a field or a shape are beside it.
    pub is_side_by_side: bool,
    /// Whether the camera follows the current event.
    pub follows_events: bool,
    /// Whether the camera jumps instead of flying.
    pub reduced_motion: bool,
    /// The user's choice of reduced motion, if any; otherwise the system's preference counts.
    motion_chosen: Option<bool>,
}

impl Appearance {
    /// Returns the layers that are shown at a stage of a run; without a session, those of the last stage.
    #[must_use]
    pub fn layers(&self, stage: Option<Stage>) -> Layers {
        self.layers_of(SessionKind::Run, stage)
    }

    /// Returns the layers that are shown at a stage of a kind of session; without a session, those of the last stage of a run.
    #[must_use]
    pub fn layers_of(&self, kind: SessionKind, stage: Option<Stage>) -> Layers {
        let of_stage = || Layers::of_stage_in(kind, stage.unwrap_or(Stage::Finish));
        self.chosen_layers.unwrap_or_else(of_stage)
    }

    /// Applies a command while `layers` are shown.
    pub(crate) fn apply(&mut self, command: AppearanceCommand, mut layers: Layers) {
        match command {
            AppearanceCommand::ToggleLayer(layer) => {
                // After the first switch no layer follows the stage any more. If the other layers still followed it, a
                // user could not predict which layers the next stage shows.
                layers.toggle(layer);
                self.chosen_layers = Some(layers);
            }
            AppearanceCommand::AutomaticLayers => self.chosen_layers = None,

            AppearanceCommand::Colour(colouring) => self.colouring = colouring,
            AppearanceCommand::ToggleTheme => self.choose_look(self.look.other()),
            AppearanceCommand::Look(look) => self.choose_look(look),
            // The key that enters projector mode also leaves it, for the look from before.
            AppearanceCommand::ToggleProjector => self.choose_look(match self.look {
                look if look.is_projector() => self.look_before,
                _ => Look::Projector,
            }),

            AppearanceCommand::Curve(number) => self.curve.number = number,
            AppearanceCommand::CurveHeight(height) => {
                // A script can give a height beyond the limits.
                let number = self.curve.number;
                self.curve = ShownCurve { number, height }.within_limits();
            }

            AppearanceCommand::ToggleSideBySide => self.is_side_by_side = !self.is_side_by_side,
            AppearanceCommand::ToggleFollow => self.follows_events = !self.follows_events,
            AppearanceCommand::ToggleReducedMotion => {
                // A choice counts from now on, whatever the system prefers.
                self.reduced_motion = !self.reduced_motion;
                self.motion_chosen = Some(self.reduced_motion);
            }
        }
    }

    /// Copies layers, colouring and look from another appearance.
    pub(crate) fn take(&mut self, other: &Self) {
        (self.chosen_layers, self.colouring) = (other.chosen_layers, other.colouring);
        self.choose_look(other.look);
    }

    /// Returns the user's choice of reduced motion, if any.
    #[must_use]
    pub const fn motion_chosen(&self) -> Option<bool> {
        self.motion_chosen
    }

    /// Restores the user's earlier choice of reduced motion; `None`, as of a user who never chose, changes nothing.
    pub(crate) fn choose_motion(&mut self, chosen: Option<bool>) {
        self.motion_chosen = chosen.or(self.motion_chosen);
        self.reduced_motion = chosen.unwrap_or(self.reduced_motion);
    }

    /// Sets the system's preference of reduced motion, which counts until the user chooses.
    pub(crate) fn prefer_reduced_motion(&mut self, reduced: bool) {
        self.reduced_motion = self.motion_chosen.unwrap_or(reduced);
    }

    /// Chooses a look. Leaving projector mode returns to the look before it.
    pub fn choose_look(&mut self, look: Look) {
        if look.is_projector() && !self.look.is_projector() {
            self.look_before = self.look;
        }
        self.look = look;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaving_projector_mode_restores_the_look_before_it() {
        let mut appearance = Appearance::default();
        for command in [
            AppearanceCommand::Look(Look::Light),
            AppearanceCommand::ToggleProjector,
        ] {
            appearance.apply(command, Layers::default());
        }
        assert_eq!(appearance.look, Look::Projector);
        appearance.apply(AppearanceCommand::Look(Look::Projector), Layers::default());
        appearance.apply(AppearanceCommand::ToggleProjector, Layers::default());
        assert_eq!(appearance.look, Look::Light);
    }

    #[test]
    fn the_users_choice_overrides_the_systems_preference() {
        let mut appearance = Appearance::default();
        appearance.prefer_reduced_motion(true);
        assert!(appearance.reduced_motion && appearance.motion_chosen().is_none());
        appearance.apply(AppearanceCommand::ToggleReducedMotion, Layers::default());
        appearance.prefer_reduced_motion(true);
        assert!(!appearance.reduced_motion);
        assert_eq!(appearance.motion_chosen(), Some(false));
    }
}
