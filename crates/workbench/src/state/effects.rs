//! The interface between parts of the state: the data that a part may use while it applies a command, and the effects that
//! it asks for.

use tilescope_session::incoming::NamedBytes;
use tilescope_session::jobs::Wake;

use super::parts::JobContext;
use super::{Appearance, Notice};

/// A request of a part to the others, which the state carries out after the command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Effect {
    /// Show this notice.
    Tell(Notice),
    /// Copy a text to the clipboard.
    Copy(String),
    /// Open the panel of the selection.
    Inspect,
    /// Download a file.
    Download(NamedBytes),
}

/// The data of other parts that a part may use while it applies a command.
pub(super) struct Context {
    /// Starts work in the background.
    pub(super) wake: Wake,
    /// Whether the camera jumps instead of flying.
    pub(super) reduced_motion: bool,
    /// The effects asked for so far.
    pub(super) effects: Vec<Effect>,
    /// The generation of the session made last.
    pub(super) generation: u64,
}

impl Context {
    pub(super) fn new(jobs: &JobContext, appearance: &Appearance) -> Self {
        Self {
            wake: Wake::clone(&jobs.wake),
            generation: jobs.generation,
            reduced_motion: appearance.reduced_motion,
            effects: Vec::new(),
        }
    }

    pub(super) fn tell(&mut self, text: String, is_error: bool) {
        self.ask(Effect::Tell(Notice::new(text, is_error)));
    }

    /// Returns the generation for a session that is about to be made.
    pub(super) const fn next_generation(&mut self) -> u64 {
        self.generation += 1;
        self.generation
    }

    pub(super) fn ask(&mut self, effect: Effect) {
        self.effects.push(effect);
    }
}
