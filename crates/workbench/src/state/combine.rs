//! Combinations in the state: making and showing them.

use tilescope_core::combine::file::Layout;
use tilescope_session::combination::{CombineCommand, NINE};
use tilescope_session::combining::CombineTask;
use tilescope_session::layers::Layer;
use tilescope_session::session::Session;
use tilescope_session::task;
use tilescope_session::words::sentence;

use super::State;
use crate::command::Which;
use crate::rules::UndoPart;

/// The refusal of commands that need a run's parameters.
pub(super) const NO_PARAMETERS: &str =
    "A combination is made from a layout and has no parameters to change.";

impl State {
    /// Starts making a combination; the current session stays until it is ready.
    pub(super) fn combine(&mut self, command: CombineCommand) {
        let text = match command {
            CombineCommand::Nine => NINE.to_owned(),
            CombineCommand::Text(text) => text,
        };
        (self.messages.notice, self.links.arriving) = (None, None);
        match Layout::from_json(text.as_bytes()) {
            Ok(layout) => {
                self.remember_run(UndoPart::Run);
                self.start_combining(layout);
            }
            Err(error) => self.tell(sentence(&error.to_string()), true),
        }
    }

    pub(super) fn start_combining(&mut self, layout: Layout) {
        self.files.stop_reading();
        self.jobs.generation += 1;
        let generation = self.jobs.generation;
        let combining = CombineTask { layout, generation };
        self.runs.first.sampling = Some(task::start(&self.jobs.wake, combining));
    }

    /// Shows a new combination, with the layer of seams on.
    pub(super) fn show_combination(&mut self, which: Which, session: Session) {
        self.show_in(which, session);
        if let Some(layers) = &mut self.appearance.chosen_layers
            && !layers.has(Layer::Seams)
        {
            layers.toggle(Layer::Seams);
        }
    }

    /// Returns whether the current session is a combination.
    #[must_use]
    pub fn shows_combination(&self) -> bool {
        self.runs.first.shows_combination()
    }
}
