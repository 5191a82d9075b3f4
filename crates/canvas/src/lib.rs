//! The picture of a moment in the window: samples, disks, gaps and what lies over them, drawn from a
//! [`Subject`](tilescope_drawing::subject::Subject).
//!
//! It knows neither the state of the window nor its commands. What it keeps between frames are pictures that can be made again.

mod brushed;
mod contrast;
pub mod hint;
pub mod hover;
pub mod instanced;
pub mod overlay;
pub mod pane;
mod raster;
mod resident;
mod sheet;
pub mod sprites;
mod stack;
mod strokes;
pub mod touch;

use egui::Rect;

pub use contrast::mark as contrast_mark;

/// More samples than this in view are drawn as points, without symbols and disks.
pub const MAX_SYMBOLS: usize = 90_000;

/// The whole of a texture.
pub const UNIT: Rect = Rect {
    min: egui::pos2(0.0, 0.0),
    max: egui::pos2(1.0, 1.0),
};
