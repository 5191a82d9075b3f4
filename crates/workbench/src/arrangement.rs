//! The arrangement of the window by its size: tiles if there is room for them, otherwise the canvas with one
//! panel at a time. The layout of the tiles is kept meanwhile.

use emath::{Vec2, vec2};
use tilescope_session::look::Look;

use crate::layout::Panel;

/// The smallest window, in screen points, that has room for tiles. Chosen, not measured, like the rooms below.
pub const ROOM_FOR_TILES: Vec2 = vec2(960.0, 420.0);
/// The smallest room beside a lesson or the list of lessons, in screen points, for tiles: a lesson puts the panels beside
/// the canvas away, and a laptop's window of 1280 points keeps its menus.
pub const ROOM_BESIDE_LESSON: Vec2 = vec2(880.0, 420.0);
/// The smallest width, in screen points, that has room for panels beside the canvas.
pub const ROOM_BESIDE: f32 = 560.0;
/// The smallest window, in screen points, that has room for the projector's larger type. It is smaller than that for
/// tiles, as projector mode shows no panels beside the canvas.
pub const ROOM_FOR_PROJECTOR: Vec2 = vec2(700.0, 420.0);

/// The arrangement of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Arrangement {
    /// By the layout of the tiles, or as projector mode needs it.
    #[default]
    Tiles,
    /// The canvas on top, everything else below.
    Portrait,
    /// The canvas at the left, everything else beside it.
    Landscape,
}

impl Arrangement {
    /// Returns the arrangement of a window of `size`, in screen points before the look's enlargement.
    #[must_use]
    pub fn of(size: Vec2, look: Look) -> Self {
        Self::with_room(size, look, ROOM_FOR_TILES)
    }

    /// Returns the arrangement of the room that a lesson or the list of lessons leaves of a window, likewise in screen points.
    #[must_use]
    pub fn beside_lesson(size: Vec2, look: Look) -> Self {
        Self::with_room(size, look, ROOM_BESIDE_LESSON)
    }

    /// Returns the arrangement of a size where tiles need this room in the looks of normal type.
    fn with_room(size: Vec2, look: Look, for_tiles: Vec2) -> Self {
        let room = match look {
            Look::Dark | Look::Light => for_tiles,
            Look::Projector | Look::ProjectorDark => ROOM_FOR_PROJECTOR,
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
    /// The arrangement of the window.
    pub arrangement: Arrangement,
    /// The panel that is open. [`Panel::Canvas`] stands for the layers, and [`Panel::Timeline`] for the
    /// playback controls, as the rest of these is always visible.
    pub open: Option<Panel>,
    /// Whether the panel takes most of the window.
    pub is_tall: bool,
}

/// A command for a compact window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DrawerCommand {
    /// Sets the arrangement, after the window's size changed.
    Arrange(Arrangement),
    /// Opens a panel, or closes the open one.
    Show(Option<Panel>),
    /// Sets whether the panel takes most of the window.
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
        // A laptop of 1280 x 720 with a lesson of 372 points, and a smaller one.
        let beside = |size: [f32; 2]| Arrangement::beside_lesson(size.into(), Look::Dark);
        assert_eq!(beside([908.0, 720.0]), Arrangement::Tiles);
        assert_eq!(beside([652.0, 768.0]), Arrangement::Portrait);
        let projected = |size: [f32; 2]| Arrangement::of(size.into(), Look::Projector);
        assert_eq!(projected([800.0, 500.0]), Arrangement::Tiles);
        assert_eq!(projected([390.0, 844.0]), Arrangement::Portrait);
    }
}
