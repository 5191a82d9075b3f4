//! The picture of a moment: samples, disks, gaps and what lies over them, drawn from a [`Subject`](tilescope_drawing::subject::Subject).
//! It knows neither the state of the window nor its commands; what it remembers between frames are pictures that can be
//! made again.

pub(crate) mod blocks;
mod brushed;
mod contrast;
mod geometry;
pub mod hint;
pub(crate) mod hover;
pub mod instanced;
mod now;
pub(crate) mod overlay;
mod paint;
pub(crate) mod pane;
mod raster;
mod resident;
mod seams;
pub(crate) mod sprites;
mod stack;
mod strokes;
mod symbols;
pub mod touch;
pub(crate) mod tree;

use egui::Rect;

pub(crate) use contrast::mark as contrast_mark;
pub(crate) use tree::Made;

/// More samples than this in view are drawn as points, without symbols and disks.
pub const MAX_SYMBOLS: usize = 90_000;
/// Disks and gaps are drawn from this many screen points per r.
pub const MIN_DISK_SCALE: f64 = 1.25;

/// The whole of a texture.
pub const UNIT: Rect = Rect {
    min: egui::pos2(0.0, 0.0),
    max: egui::pos2(1.0, 1.0),
};
