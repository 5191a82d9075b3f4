//! Draws a moment of a run with egui: samples, disks, gaps and overlays, from a
//! [`Subject`](tilescope_drawing::subject::Subject). It does not depend on the state of the window or its commands;
//! between frames it keeps only caches. Begin with [`pane`]; what a moment consists of is in `tilescope-drawing`,
//! pointer input in `tilescope-app`.
//!
//! ```
//! use tilescope_canvas::sprites::{Sprite, Sprites};
//!
//! // Symbols are drawn once, as textures, and kept.
//! let (ctx, mut sprites) = (egui::Context::default(), Sprites::default());
//! let dot = sprites.stamp(&ctx, Sprite::Dot, 4.0);
//! assert!(dot.half >= 4.0);
//! assert_eq!(sprites.stamp(&ctx, Sprite::Dot, 4.0).texture, dot.texture);
//! ```

mod brushed;
mod contrast;
pub mod hint;
pub mod hover;
pub mod instanced;
pub mod objects;
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
