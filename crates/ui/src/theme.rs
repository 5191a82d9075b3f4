//! Fonts, spacing and the colours of widgets. The colours themselves are in `drawing/src/palette.rs`, and the choice
//! among them, a [`Look`], is in `session/src/look.rs`. Begin with [`restyle`].

mod input_style;

use egui::{FontFamily, Theme};
use tilescope_session::look::Look;

pub use input_style::{FINGER, InputStyle, install, is_for_fingers, restyle, row_height};

/// Returns the family of headings.
#[must_use]
pub fn semibold() -> FontFamily {
    FontFamily::Name("semibold".into())
}

/// Returns which of egui's two themes a look replaces.
const fn theme_of(look: Look) -> Theme {
    if look.is_dark() {
        Theme::Dark
    } else {
        Theme::Light
    }
}
