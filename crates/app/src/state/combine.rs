//! The commands that make combinations, and how they are shown.

use tilescope_core::combine::file::Layout;

use super::State;
use super::undo::Part;
use crate::canvas::layers::Layer;
use crate::combination::{CombineCommand, Combining, NINE};
use crate::draft::sentence;
use crate::jobs::Job;
use crate::session::Session;

/// Why something that belongs to a run cannot be done with a combination.
pub(super) const NO_PARAMETERS: &str =
    "A combination is made from a layout: there are no parameters of it to change.";

impl State {
    /// Starts to make a combination; the session at hand stays until it is there.
    pub(super) fn combine(&mut self, command: CombineCommand) {
        let text = match command {
            CombineCommand::Nine => NINE.to_owned(),
            CombineCommand::Text(text) => text,
        };
        (self.notice, self.arriving) = (None, None);
        match Layout::from_json(text.as_bytes()) {
            Ok(layout) => {
                self.remember_run(Part::Run);
                self.start_combining(layout);
            }
            Err(error) => self.tell(sentence(&error.to_string()), true),
        }
    }

    pub(super) fn start_combining(&mut self, layout: Layout) {
        self.stop_reading();
        self.generation += 1;
        let generation = self.generation;
        let combining = Combining { layout, generation };
        self.sampling = Some(Job::run(&self.wake, combining));
    }

    /// Shows a new combination, its seams among the layers.
    pub(super) fn show_combination(&mut self, session: Session) {
        self.show(session);
        if !self.layers.has(Layer::Seams) {
            self.layers.toggle(Layer::Seams);
        }
    }

    /// Returns whether the session at hand is a combination.
    #[must_use]
    pub fn shows_combination(&self) -> bool {
        self.session
            .as_ref()
            .is_some_and(|session| session.combination.is_some())
    }
}
