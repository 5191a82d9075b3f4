//! What panels are shown from.

use tilescope_drawing::palette::Palette;

use tilescope_workbench::arrangement::Drawer;
use tilescope_workbench::state::{Appearance, RunView, State, Time};

/// What most panels are shown from: a run, and how it is drawn. A panel that needs more is given just that.
pub struct PanelContext<'a> {
    /// The colours.
    pub palette: &'static Palette,
    /// How moments are drawn.
    pub appearance: &'a Appearance,
    /// The run.
    pub run: &'a RunView,
    /// Whether another run is shown beside it.
    pub is_compared: bool,
}

impl<'a> PanelContext<'a> {
    /// Returns what panels of the first run are shown from.
    #[must_use]
    pub fn of(state: &'a State) -> Self {
        Self {
            palette: Palette::of(state.appearance.look),
            appearance: &state.appearance,
            run: &state.runs.first,
            is_compared: state.runs.second.is_some(),
        }
    }
}

/// What the timeline is shown from: a run, how time runs, and how much room there is.
pub struct TimeContext<'a> {
    /// The colours.
    pub palette: &'static Palette,
    /// The run.
    pub run: &'a RunView,
    /// How time runs.
    pub time: &'a Time,
    /// What a window shows that is too small for tiles.
    pub drawer: &'a Drawer,
}

impl<'a> TimeContext<'a> {
    /// Returns what the first run's timeline is shown from.
    #[must_use]
    pub fn of(state: &'a State) -> Self {
        Self {
            palette: Palette::of(state.appearance.look),
            run: &state.runs.first,
            time: &state.time,
            drawer: &state.window.drawer,
        }
    }
}
