//! The content of a link, as values. `write.rs` writes it as text, `read.rs` reads it.

use tilescope_core::combine::file::Layout as Combination;
use tilescope_core::{NestedRequest, Parameters};
use tilescope_debugger::{SavedBreakpoint, SavedScene};
use tilescope_session::recipe::Recipe;

use crate::lessons::WantedLesson;
use crate::view::SavedView;

/// How a link names a moment of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum NamedMoment {
    /// The end.
    #[default]
    End,
    /// After this many events, or of nested levels this many samples.
    Event(usize),
    /// After the stage of this name.
    Stage(String),
}

/// The content of a link: the input of a run, and its view.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinkContent {
    /// The run's parameters.
    pub parameters: Parameters,
    /// The levels, if nested ones are shown instead of a run.
    pub nested: Option<NestedRequest>,
    /// The layout of the combination, if one is shown instead of a run.
    pub combination: Option<Combination>,
    /// The moment.
    pub moment: NamedMoment,
    /// The view.
    pub view: SavedView,
    /// The breakpoints.
    pub breakpoints: Vec<SavedBreakpoint>,
    /// The watched expressions.
    pub watches: Vec<String>,
    /// The scenes.
    pub scenes: Vec<SavedScene>,
    /// The lesson that is opened instead of a run.
    pub lesson: Option<WantedLesson>,
}

impl LinkContent {
    /// Returns the recipe of its run.
    #[must_use]
    pub fn recipe(&self) -> Recipe {
        Recipe {
            parameters: self.parameters,
            own: None,
            nested: self.nested,
        }
    }
}
