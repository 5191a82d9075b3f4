//! Scenes: moments with a view and a caption, to be shown one after another. The user's are kept in the session; those of
//! the tour come with the program.

use glam::DVec2;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use tilescope_debugger::Direction;

use crate::view::{MAX_RADII, is_near};

/// A change of the scenes, or of the one that is shown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SceneCommand {
    /// Makes a scene of the moment and its view, after the one that is shown or as the last.
    Add,
    /// Gives a scene the moment and the view that are shown; its caption stays.
    Replace(usize),
    /// Sets the caption of a scene.
    Caption(usize, String),
    /// Removes a scene.
    Remove(usize),
    /// Moves a scene to another place in the list.
    Move(usize, usize),
    /// Shows a scene.
    Show(usize),
    /// Shows the next or the previous scene.
    Step(Direction),
    /// Starts the tour.
    Tour,
    /// Removes the caption from the canvas, and ends the tour.
    Leave,
}

/// A list of scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneList {
    /// The user's.
    Own,
    /// The tour.
    Tour,
}

/// The scene that is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShownScene {
    /// The list it is of.
    pub list: SceneList,
    /// Its index in the list.
    pub index: usize,
}

/// The camera of a scene, in r, whatever the size of the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneCamera {
    /// The width of the view across its shorter side.
    pub radii: f64,
    /// The middle of the view; `None` for the place of the event.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub center: Option<DVec2>,
    /// The place of the event in the run where the scene was made. In another run the view moves with the event.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub event: Option<DVec2>,
}

impl SceneCamera {
    /// Reads the camera of a scene's view; `None` if it has none, which fits the whole domain.
    #[must_use]
    pub fn of(view: &Value) -> Option<Self> {
        Self::deserialize(view.get("camera")?).ok()
    }

    /// Returns the middle of the view where the event is at `event`; `None` if the camera is not valid. In another run than
    /// the scene's own the view moves with the event.
    #[must_use]
    pub fn placed(self, event: Option<DVec2>, is_same_run: bool) -> Option<DVec2> {
        let center = match (self.center, self.event, event) {
            (Some(center), Some(from), Some(to)) if !is_same_run => center + (to - from),
            (Some(center), _, _) => center,
            (None, _, event) => event?,
        };
        let is_valid = is_near(center) && self.radii > 0.0 && self.radii <= MAX_RADII;
        is_valid.then_some(center)
    }
}
