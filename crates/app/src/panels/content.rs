//! The content of a panel: how it fills its tile, and the part of the state that it receives.

use egui::Ui;
use tilescope_workbench::command::Command;
use tilescope_workbench::state::State;

use super::context::PanelContext;

/// How the content of a panel fills its tile.
pub enum Room {
    /// It scrolls as a whole.
    Scrolled,
    /// It does its own layout.
    Whole,
}

/// How to show a panel.
enum Show {
    /// From the context of run A.
    Run(fn(&mut Ui, &PanelContext<'_>, &mut Vec<Command>)),
    /// From a context of its own.
    State(fn(&mut Ui, &State, &mut Vec<Command>)),
}

/// The content of a panel. The file of each panel has one.
pub struct Content {
    /// How it fills its tile.
    pub room: Room,
    show: Show,
}

impl Content {
    /// Returns the content of a panel that shows run A.
    pub const fn of_run(
        room: Room,
        show: fn(&mut Ui, &PanelContext<'_>, &mut Vec<Command>),
    ) -> Self {
        let show = Show::Run(show);
        Self { room, show }
    }

    /// Returns the content of a panel that shows more than a run: `show` makes its context.
    pub const fn of_state(room: Room, show: fn(&mut Ui, &State, &mut Vec<Command>)) -> Self {
        let show = Show::State(show);
        Self { room, show }
    }

    /// Shows the content of the panel.
    pub fn show(&self, ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
        match self.show {
            Show::Run(show) => show(ui, &PanelContext::of(state), commands),
            Show::State(show) => show(ui, state, commands),
        }
    }
}
