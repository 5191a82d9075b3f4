//! What a page tells the app when it begins there: what draws it, and how the GPU comes to compute.

use super::{FullScreen, Notice, State};
use crate::device::Engine;
use crate::embedding::Embedding;

/// How the app begins on a page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PageStart {
    /// What draws.
    pub display: String,
    /// Why, if there is a reason to tell.
    pub reason: String,
    /// Who samples.
    pub engine: Engine,
    /// A part of the window that is shown alone.
    pub embedding: Option<Embedding>,
    /// Whether the system wishes that nothing moves by itself.
    pub reduced_motion: bool,
    /// Whether the browser lets the page have the full screen.
    pub full_screen: bool,
}

impl State {
    /// Begins on a page: the GPU is opened and tested, and serves from then on where it passes. One that computes on the CPU
    /// is not tested unless it was asked for.
    pub fn begin_on_page(&mut self, start: &PageStart) {
        self.window.embedding = start.embedding;
        self.prefer_reduced_motion(start.reduced_motion);
        if !start.full_screen {
            let why = "The browser does not let this page have the full screen.";
            self.window.full_screen = FullScreen::Refused(why);
        }
        if !start.reason.is_empty() {
            self.messages.notice = Some(Notice {
                text: start.reason.clone(),
                is_error: true,
            });
        }
        self.with(|state, context| state.gpu.begin_on_page(start, context));
    }
}
