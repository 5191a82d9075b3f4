//! The looks of a window: light, dark, and for a projector. Their colours are in `tilescope_drawing::palette`.

/// A look of the window. Earlier versions saved the aliases.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Look {
    /// Light on dark.
    #[default]
    #[serde(alias = "Dark")]
    Dark,
    /// Dark on light.
    #[serde(alias = "Light")]
    Light,
    /// Dark on light at nearly twice the size, showing only the canvas, the sentence, the controls and the
    /// timeline.
    #[serde(alias = "Projector")]
    Projector,
}

impl Look {
    /// Every look.
    pub const ALL: [Self; 3] = [Self::Dark, Self::Light, Self::Projector];

    /// Returns its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Dark => "Dark theme",
            Self::Light => "Light theme",
            Self::Projector => "Projector mode",
        }
    }

    /// Returns the light look for the dark one, and the dark one for the others.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Dark => Self::Light,
            Self::Light | Self::Projector => Self::Dark,
        }
    }

    /// Returns how much larger everything is drawn.
    #[must_use]
    pub const fn zoom(self) -> f32 {
        match self {
            Self::Dark | Self::Light => 1.0,
            Self::Projector => 1.75,
        }
    }
}
