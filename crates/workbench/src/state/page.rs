//! Starting on a page: what draws the window, and how the GPU is prepared for sampling.

use crate::device::EngineChoice;
use crate::embedding::Embedding;

/// The options that the page passes to the app at its start.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PageStart {
    /// The description of what draws the window.
    pub display: String,
    /// Why, if that needs an explanation.
    pub reason: String,
    /// The engine to begin with.
    pub engine: EngineChoice,
    /// The part of the window to show when it is embedded in another page.
    pub embedding: Option<Embedding>,
    /// Whether the system prefers reduced motion.
    pub reduced_motion: bool,
    /// Whether the browser allows the page full screen.
    pub full_screen: bool,
}
