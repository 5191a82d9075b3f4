//! Type, spacing and the colours of widgets, light and dark.

mod input_style;

use egui::{FontFamily, Theme};
use tilescope_drawing::palette::{DARK, LIGHT, Palette};
use tilescope_session::look::Look;

pub use input_style::{FINGER, InputStyle, install, is_for_fingers, restyle, row_height};

/// Returns the family of headings.
#[must_use]
pub fn semibold() -> FontFamily {
    FontFamily::Name("semibold".into())
}

/// Returns egui's theme for a look.
#[must_use]
pub const fn theme_of(look: Look) -> Theme {
    match look {
        Look::Dark | Look::ProjectorDark => Theme::Dark,
        Look::Light | Look::Projector => Theme::Light,
    }
}

/// Returns the palette of egui's theme.
const fn palette_of(theme: Theme) -> &'static Palette {
    match theme {
        Theme::Dark => &DARK,
        Theme::Light => &LIGHT,
    }
}
