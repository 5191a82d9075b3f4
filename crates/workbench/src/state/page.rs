//! Starting on a page: what draws the window, and how the GPU is prepared for sampling.

use super::{FullScreen, Notice, State};
use crate::device::EngineChoice;
use crate::embedding::Embedding;

/// The options that the page passes to the app at its start.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PageStart {
    /// The description of what draws the window.
    pub display: String,
    /// Why, if that needs an explanation.
    pub reason: String,
    /// The engine.
    pub engine: EngineChoice,
    /// The part of the window to show when it is embedded in another page.
    pub embedding: Option<Embedding>,
    /// Whether the system prefers reduced motion.
    pub reduced_motion: bool,
    /// Whether the browser allows the page full screen.
    pub full_screen: bool,
}

impl State {
    /// Starts on a page: opens and tests the GPU, which samples from then on if it passes. One that computes on
    /// the CPU is tested only if it was requested.
    pub fn begin_on_page(&mut self, start: &PageStart) {
        self.embed(start.embedding);
        self.prefer_reduced_motion(start.reduced_motion);
        if !start.full_screen {
            let why = "The browser does not allow this page full screen.";
            self.window.full_screen = FullScreen::Refused(why);
        }
        if !start.reason.is_empty() {
            self.messages.notice = Some(Notice::new(start.reason.clone(), true));
        }
        self.with(|state, context| state.gpu.begin_on_page(start, context));
    }
}
