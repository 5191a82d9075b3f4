//! Draws a moment of a run: the visible part of the plane, colours, the look of each sample, and every part of
//! the picture on any [`Surface`](surface::Surface). The window's canvas and the pictures of
//! [`picture`] are such surfaces, so that files look like the canvas; only the marks of a comparison and the witness of a verdict
//! are drawn on the canvas alone. Begin with [`parts`].
//!
//! ```
//! use emath::{Rect, pos2};
//! use tilescope_drawing::camera::Camera;
//!
//! let viewport = Rect::from_min_max(pos2(0.0, 0.0), pos2(800.0, 600.0));
//! let camera = Camera::fitting([100.0, 100.0], viewport);
//! assert_eq!(camera.screen_from_domain(viewport, [50.0, 50.0]), viewport.center());
//! ```

pub mod age;
pub mod brushed;
pub mod camera;
pub mod figure;
pub mod labels;
pub mod look;
pub mod looks;
pub mod made;
pub mod orbit;
pub mod palette;
pub mod parts;
pub mod picture;
pub mod scene;
pub mod spectra;
pub mod subject;
pub mod surface;
pub mod symbol;

/// The scale, in screen points per r, above which disks and gaps are drawn.
pub const MIN_DISK_SCALE: f64 = 1.25;
/// The opacity of a disk's inside: on a projector, too, a place in one disk differs from a place in none.
pub const DISK_FILL: f32 = 0.11;
/// The opacity of a disk's edge.
pub const DISK_RING: f32 = 0.62;
