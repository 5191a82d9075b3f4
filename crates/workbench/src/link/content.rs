//! What is in a link, as values.

use tilescope_core::Parameters;
use tilescope_core::combine::file::Layout as Combination;
use tilescope_debugger::{Bookmark, SavedBreakpoint};
use tilescope_session::layers::{Colouring, Layers};
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;

use crate::clock::Clock;
use crate::layout::Layout;
use crate::view::View;
use tilescope_drawing::camera::Camera;

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
#[derive(Clone, Debug, PartialEq)]
pub struct Content {
    /// What the run is made from.
    pub parameters: Parameters,
    /// The layout of the combination that is shown in the place of a run.
    pub combination: Option<Combination>,
    /// The moment.
    pub moment: NamedMoment,
    /// The view of the domain; none shows all of it.
    pub camera: Option<Camera>,
    /// The layers that are on.
    pub layers: Layers,
    /// What colours mean.
    pub colouring: Colouring,
    /// The look.
    pub look: Look,
    /// What is selected.
    pub selection: Selection,
    /// What a tick is.
    pub clock: Clock,
    /// How fast time runs.
    pub speed: f32,
    /// The cursors between which play goes round.
    pub range: Option<[usize; 2]>,
    /// What the second run is made from, and whether cameras move together, clocks run together and differences are
    /// marked.
    pub second: Option<(Parameters, [bool; 3])>,
    /// The breakpoints.
    pub breakpoints: Vec<SavedBreakpoint>,
    /// The watched expressions.
    pub watches: Vec<String>,
    /// The bookmarks.
    pub bookmarks: Vec<Bookmark>,
    /// Where the panels stand.
    pub layout: Layout,
}

impl Default for Content {
    /// What a link holds that says nothing.
    fn default() -> Self {
        Self {
            parameters: Parameters::default(),
            combination: None,
            moment: NamedMoment::End,
            camera: None,
            layers: Layers::default(),
            colouring: Colouring::default(),
            look: Look::default(),
            selection: Selection::Nothing,
            clock: Clock::default(),
            speed: 1.0,
            range: None,
            second: None,
            breakpoints: Vec::new(),
            watches: Vec::new(),
            bookmarks: Vec::new(),
            layout: Layout::default(),
        }
    }
}

impl Content {
    /// Returns how the run is looked at.
    #[must_use]
    pub fn view(&self) -> View {
        let selects = self.selection != Selection::Nothing;
        View {
            camera: Some(self.camera.unwrap_or_default()),
            fitted: Some(self.camera.is_none()),
            layers: Some(self.layers),
            colouring: Some(self.colouring),
            look: Some(self.look),
            layout: Some(self.layout.clone()),
            selection: selects.then_some(self.selection),
            clock: Some(self.clock),
            speed: Some(self.speed),
            range: self.range,
            second: self.second.map(|(parameters, _)| parameters),
            links: self.second.map(|(_, links)| links),
        }
    }
}
