//! What is in a link, as values.

use tilescope_core::Parameters;
use tilescope_core::combine::file::Layout as Combination;
use tilescope_debugger::{Bookmark, SavedBreakpoint};

use crate::view::SavedView;

/// How a link names a moment of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum NamedMoment {
    /// The end.
    #[default]
    End,
    /// When so many events have happened.
    Event(usize),
    /// After the stage of this name.
    Stage(String),
}

/// What a link holds: what a run is made from, and how it is looked at.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinkContent {
    /// What the run is made from.
    pub parameters: Parameters,
    /// The layout of the combination that is shown in the place of a run.
    pub combination: Option<Combination>,
    /// The moment.
    pub moment: NamedMoment,
    /// How the run is looked at.
    pub view: SavedView,
    /// The breakpoints.
    pub breakpoints: Vec<SavedBreakpoint>,
    /// The watched expressions.
    pub watches: Vec<String>,
    /// The bookmarks.
    pub bookmarks: Vec<Bookmark>,
}
