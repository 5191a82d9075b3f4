//! How moments are drawn.

use tilescope_session::layers::{Colouring, Layers};
use tilescope_session::look::Look;

use crate::command::AppearanceCommand;

/// How moments are drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Appearance {
    /// The layers shown.
    pub layers: Layers,
    /// What the colour of samples means.
    pub colouring: Colouring,
    /// Light, dark or for a projector; [`Self::choose_look`] changes it.
    pub look: Look,
    /// The look to which the projector mode returns.
    pub(crate) look_before: Look,
    /// Whether the camera jumps instead of flying.
    pub reduced_motion: bool,
    /// What the user chose of that; the system's wish counts otherwise.
    motion_chosen: Option<bool>,
}

impl Default for Appearance {
    fn default() -> Self {
        Self {
            layers: Layers::default(),
            colouring: Colouring::default(),
            look: Look::Dark,
            look_before: Look::Dark,
            reduced_motion: false,
            motion_chosen: None,
        }
    }
}

impl Appearance {
    pub(crate) fn apply(&mut self, command: AppearanceCommand) {
        match command {
            AppearanceCommand::ToggleLayer(layer) => self.layers.toggle(layer),
            AppearanceCommand::Colour(colouring) => self.colouring = colouring,
            AppearanceCommand::ToggleTheme => self.choose_look(self.look.other()),
            AppearanceCommand::Look(look) => self.choose_look(look),
            AppearanceCommand::ToggleProjector => self.choose_look(match self.look {
                Look::Projector => self.look_before,
                _ => Look::Projector,
            }),
            AppearanceCommand::ToggleReducedMotion => {
                self.reduced_motion = !self.reduced_motion;
                self.motion_chosen = Some(self.reduced_motion);
            }
        }
    }

    /// Takes up layers, colouring and look of another appearance.
    pub(crate) fn take(&mut self, other: &Self) {
        (self.layers, self.colouring) = (other.layers, other.colouring);
        self.choose_look(other.look);
    }

    /// Returns what the user chose of motion, if anything.
    #[must_use]
    pub const fn motion_chosen(&self) -> Option<bool> {
        self.motion_chosen
    }

    /// Takes up what the user chose earlier.
    pub(crate) fn choose_motion(&mut self, chosen: Option<bool>) {
        self.motion_chosen = chosen.or(self.motion_chosen);
        self.reduced_motion = chosen.unwrap_or(self.reduced_motion);
    }

    /// Takes up what the system prefers, which counts until the user chooses.
    pub(crate) fn prefer_reduced_motion(&mut self, reduced: bool) {
        self.reduced_motion = self.motion_chosen.unwrap_or(reduced);
    }

    /// Chooses a look. The projector mode is left for the one before it.
    pub fn choose_look(&mut self, look: Look) {
        if look == Look::Projector && self.look != look {
            self.look_before = self.look;
        }
        self.look = look;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_projector_mode_is_left_for_the_look_before_it() {
        let mut appearance = Appearance::default();
        for command in [
            AppearanceCommand::Look(Look::Light),
            AppearanceCommand::ToggleProjector,
        ] {
            appearance.apply(command);
        }
        assert_eq!(appearance.look, Look::Projector);
        appearance.apply(AppearanceCommand::Look(Look::Projector));
        appearance.apply(AppearanceCommand::ToggleProjector);
        assert_eq!(appearance.look, Look::Light);
    }

    #[test]
    fn what_the_user_chose_counts_more_than_what_the_system_prefers() {
        let mut appearance = Appearance::default();
        appearance.prefer_reduced_motion(true);
        assert!(appearance.reduced_motion && appearance.motion_chosen().is_none());
        appearance.apply(AppearanceCommand::ToggleReducedMotion);
        appearance.prefer_reduced_motion(true);
        assert!(!appearance.reduced_motion);
        assert_eq!(appearance.motion_chosen(), Some(false));
    }
}
