//! Scenes: moments with a view and a caption, to be shown one after another. The user's are kept in the session; those of
//! the tour come with the program.

use serde::{Deserialize, Serialize};
use tilescope_debugger::Direction;

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
    /// Removes the scene of this index.
    Remove(usize),
    /// Moves a scene from one index of the list to another.
    Move(usize, usize),
    /// Shows the scene of this index.
    Show(usize),
    /// Shows the next or the previous scene.
    Step(Direction),
    /// Starts the tour of the window.
    Tour,
    /// Does what the button of this index of the tour's scene offers.
    Offer(usize),
    /// Removes the caption from the canvas, and ends the tour.
    Leave,
}

/// A list of scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneList {
    /// The user's own scenes.
    Own,
    /// The scenes of the tour.
    Tour,
}

/// Returns the caption that is shown, and the speaker's note, which follows a line of three hyphens.
#[must_use]
pub fn split_caption(caption: &str) -> (&str, &str) {
    let mut at = 0;
    for line in caption.split_inclusive('\n') {
        if line.trim() == "---" {
            return (caption[..at].trim_end(), caption[at + line.len()..].trim());
        }
        at += line.len();
    }
    (caption, "")
}

/// The scene that is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShownScene {
    /// The list it is of.
    pub list: SceneList,
    /// Its index in the list.
    pub index: usize,
}
