//! What a part of the state may use of the others while it carries out a command, and what it asks of them.

use tilescope_session::incoming::NamedBytes;
use tilescope_session::jobs::Wake;

use super::parts::JobContext;
use super::{Appearance, Notice};

/// What a part asks of the others. The state does it once the command is carried out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Effect {
    /// The user should read this.
    Tell(Notice),
    /// The panel of what is selected should be in view.
    Inspect,
    /// A file is to be downloaded.
    Download(NamedBytes),
}

/// What a part may use of the others.
pub(super) struct Context {
    /// Starts work in the background.
    pub(super) wake: Wake,
    /// Whether the camera jumps instead of flying.
    pub(super) reduced_motion: bool,
    /// What the part asks for.
    pub(super) effects: Vec<Effect>,
    /// The number of the session made last.
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
        self.effects.push(Effect::Tell(Notice { text, is_error }));
    }

    /// Returns the number of a session that is about to be made.
    pub(super) const fn next_generation(&mut self) -> u64 {
        self.generation += 1;
        self.generation
    }

    pub(super) fn ask(&mut self, effect: Effect) {
        self.effects.push(effect);
    }
}
