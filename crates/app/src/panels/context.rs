//! Contexts: the parts of the state that panels receive.

use tilescope_drawing::palette::Palette;
use tilescope_session::layers::Layers;

use tilescope_workbench::arrangement::Drawer;
use tilescope_workbench::curve::ShownCurve;
use tilescope_workbench::state::{Appearance, RunView, State, Time, no_side_by_side};

/// The context of most panels: a run, and how it is drawn. Panels that need more receive a context of their own.
pub struct PanelContext<'a> {
    /// The colours of the look.
    pub palette: &'static Palette,
    /// How moments are drawn.
    pub appearance: &'a Appearance,
    /// The run that the panel shows.
    pub run: &'a RunView,
    /// Whether another run is shown beside it.
    pub is_compared: bool,
    /// Why its pictures are not side by side, if they cannot be.
    pub no_side_by_side: Option<&'static str>,
    /// The layers that the open question of a lesson hides.
    pub hidden_layers: Layers,
    /// Whether a question of a lesson is open.
    pub is_veiled: bool,
}

impl<'a> PanelContext<'a> {
    /// Creates the context for panels of run A.
    #[must_use]
    pub fn of(state: &'a State) -> Self {
        Self {
            palette: Palette::of(state.appearance().look),
            appearance: state.appearance(),
            run: &state.runs().first,
            is_compared: state.runs().second.is_some(),
            no_side_by_side: no_side_by_side(state),
            hidden_layers: state
                .lessons()
                .hidden_layers(state.runs().first.current_stage()),
            is_veiled: state.lessons().veil().is_some(),
        }
    }
}

/// The context of the timeline: a run, playback, and the room there is.
pub struct TimeContext<'a> {
    /// The colours of the look.
    pub palette: &'static Palette,
    /// The run that the timeline is of.
    pub run: &'a RunView,
    /// Playback, and the way through passes.
    pub time: &'a Time,
    /// The curve above the track.
    pub curve: ShownCurve,
    /// The panel below the canvas of a window too small for tiles.
    pub drawer: &'a Drawer,
    /// Whether a question of a lesson is open.
    pub is_veiled: bool,
}

impl<'a> TimeContext<'a> {
    /// Creates the context for the timeline of run A.
    #[must_use]
    pub fn of(state: &'a State) -> Self {
        Self {
            palette: Palette::of(state.appearance().look),
            run: &state.runs().first,
            time: state.time(),
            curve: state.appearance().curve,
            drawer: &state.window().drawer,
            is_veiled: state.lessons().veil().is_some(),
        }
    }
}
