//! How the window is arranged in the room it has: tiles where there is enough, else the canvas with one panel at a time.
//! Tiles stay as they are meanwhile. What is shown where is not known here.

use emath::{Vec2, vec2};
use tilescope_session::look::Look;

use crate::layout::Panel;

/// Narrower windows, in screen points, have no room for tiles.
pub const ROOM_FOR_TILES: Vec2 = vec2(960.0, 420.0);
/// Narrower windows, in screen points, have no room for panels beside the canvas.
pub const ROOM_BESIDE: f32 = 560.0;
/// Smaller windows have no room for the projector's larger type.
pub const ROOM_FOR_PROJECTOR: Vec2 = vec2(700.0, 420.0);

/// How the window is arranged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Arrangement {
    /// As the layout of the tiles says, or as a projector needs it.
    #[default]
    Tiles,
    /// The canvas on top, everything else below.
    Portrait,
    /// The canvas at the left, everything else beside it.
    Landscape,
}

impl Arrangement {
    /// Returns how a window of `size`, in screen points before any look enlarges them, is arranged.
    #[must_use]
    pub fn of(size: Vec2, look: Look) -> Self {
        let room = match look {
            Look::Dark | Look::Light => ROOM_FOR_TILES,
            Look::Projector => ROOM_FOR_PROJECTOR,
        };
        if size.x >= room.x && size.y >= room.y {
            Self::Tiles
        } else if size.x > size.y && size.x >= ROOM_BESIDE {
            Self::Landscape
        } else {
            Self::Portrait
        }
    }

    /// Returns whether there is no room for tiles.
    #[must_use]
    pub fn is_compact(self) -> bool {
        self != Self::Tiles
    }
}

/// The one panel of a compact window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Drawer {
    /// How the window is arranged.
    pub arrangement: Arrangement,
    /// Which panel is open. Of the canvas these are its layers, of the timeline its clocks: the rest is always there.
    pub open: Option<Panel>,
    /// Whether the panel has most of the window.
    pub is_tall: bool,
}

/// What is done to a compact window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DrawerCommand {
    /// The window has another size.
    Arrange(Arrangement),
    /// Shows a panel, or none.
    Show(Option<Panel>),
    /// Gives the panel most of the window, or no longer.
    Tall(bool),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phones_and_tablets_have_no_room_for_tiles() {
        for (size, expected) in [
            ([390.0, 844.0], Arrangement::Portrait),
            ([360.0, 640.0], Arrangement::Portrait),
            ([768.0, 1024.0], Arrangement::Portrait),
            ([844.0, 390.0], Arrangement::Landscape),
            ([568.0, 320.0], Arrangement::Landscape),
            ([320.0, 180.0], Arrangement::Portrait),
            ([932.0, 430.0], Arrangement::Landscape),
            ([1200.0, 400.0], Arrangement::Landscape),
            ([960.0, 600.0], Arrangement::Tiles),
            ([1920.0, 1080.0], Arrangement::Tiles),
        ] {
            assert_eq!(Arrangement::of(size.into(), Look::Dark), expected);
        }
        let projected = |size: [f32; 2]| Arrangement::of(size.into(), Look::Projector);
        assert_eq!(projected([800.0, 500.0]), Arrangement::Tiles);
        assert_eq!(projected([390.0, 844.0]), Arrangement::Portrait);
    }
}
