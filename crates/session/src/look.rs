//! The looks of a window: dark and light, each also at the size of a projector. Their colours are in
//! `drawing/src/palette.rs`; the command that changes the look is in `workbench/src/appearance.rs`, its actions in
//! `app/src/actions.rs`. To add a look, begin here.

/// A look of the window.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Look {
    /// Light texts and lines on a dark ground.
    #[default]
    Dark,
    /// Dark texts and lines on a light ground.
    Light,
    /// Dark on light at nearly twice the size, showing only the canvas, the sentence, the controls and the
    /// timeline.
    Projector,
    /// The same, light on dark, for rooms that are dark.
    ProjectorDark,
}

impl Look {
    /// Every look, in the order of the menu.
    pub const ALL: [Self; 4] = [
        Self::Dark,
        Self::Light,
        Self::Projector,
        Self::ProjectorDark,
    ];

    /// Returns its name in the menu.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Dark => "Dark theme",
            Self::Light => "Light theme",
            Self::Projector => "Projector mode",
            Self::ProjectorDark => "Projector mode, dark",
        }
    }

    /// Returns whether it is one for a projector.
    #[must_use]
    pub const fn is_projector(self) -> bool {
        matches!(self, Self::Projector | Self::ProjectorDark)
    }

    /// Returns whether it is light on dark.
    #[must_use]
    pub const fn is_dark(self) -> bool {
        matches!(self, Self::Dark | Self::ProjectorDark)
    }

    /// Returns the light look for a dark one, and the dark one for a light one.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Dark => Self::Light,
            Self::Light => Self::Dark,
            Self::Projector => Self::ProjectorDark,
            Self::ProjectorDark => Self::Projector,
        }
    }

    /// Returns how much larger everything is drawn.
    #[must_use]
    pub const fn zoom(self) -> f32 {
        if self.is_projector() { 1.75 } else { 1.0 }
    }
}
