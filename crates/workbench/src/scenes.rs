//! Scenes: moments with a view and a caption, to be shown one after another. The user's are kept in the session; those of
//! the tour come with the program.

use glam::DVec2;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use tilescope_debugger::Direction;
use tilescope_session::layers::Colouring;
use tilescope_session::look::Look;

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

/// The view of a scene. What is missing stays as it is, but the camera fits the domain and layers follow the stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct SceneView {
    /// The camera; `None` fits the whole domain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<SceneCamera>,
    /// The names of the layers; `None` for those of the stage.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<Value>,
    /// The property of samples that their colour shows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colouring: Option<Colouring>,
    /// Light, dark or for a projector.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look: Option<Look>,
    /// The layout of the panels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layout: Option<Value>,
    /// The selection.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub selection: Option<Value>,
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
