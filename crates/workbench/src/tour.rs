//! The tour: the scenes that come with the program, in `assets/tour.json`.

use std::sync::LazyLock;

use serde::Deserialize;
use tilescope_debugger::SavedScene;

use crate::command::Command;

/// A scene of the tour.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct TourScene {
    /// The heading of its card.
    pub title: String,
    /// The moment, the view and the caption.
    #[serde(flatten)]
    pub scene: SavedScene,
    /// The buttons of the scene.
    #[serde(default)]
    pub offers: Vec<Offer>,
}

/// A button with the commands that it issues.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Offer {
    /// The text of the button.
    pub name: String,
    /// The commands it issues.
    pub commands: Vec<Command>,
}

static TOUR: LazyLock<Vec<TourScene>> = LazyLock::new(|| {
    let text = include_str!("../../../assets/tour.json");
    serde_json::from_str(text).expect("the tour is valid")
});

/// Returns the scenes of the tour.
#[must_use]
pub fn tour() -> &'static [TourScene] {
    &TOUR
}
