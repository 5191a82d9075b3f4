//! A scene of shapes, as SVG and as PNG, and frames as animations.
//!
//! One [`Scene`], several exporters that agree, and the [`Palette`] that the app's canvas shares. The same scene gives the
//! same bytes on every platform. It opens no file and no window.
//! Positions are vectors of `glam`.
//!
//! ```
//! use tilescope_figures::{Group, Marker, Palette, Scene, Shape, Style, to_png, to_svg};
//!
//! let palette = Palette::LIGHT;
//! let mut samples = Group::new("samples");
//! samples.shapes.push(Shape::marker(Marker::Dot, [30.0, 20.0], 6.0, Style::filled(palette.sample)));
//! let mut scene = Scene::new(60.0, 40.0, palette.background);
//! scene.groups.push(samples);
//! assert!(to_svg(&scene)?.contains("<circle cx=\"30\" cy=\"20\" r=\"3\""));
//! assert!(to_png(&scene, 2.0)?.starts_with(b"\x89PNG"));
//! # Ok::<(), tilescope_figures::FigureError>(())
//! ```

pub mod animation;
mod bitmap;
mod canvas;
pub mod chart;
mod control;
mod dots;
mod error;
mod fonts;
mod geometry;
mod palette;
mod png;
mod raster;
mod rect;
mod scene;
mod set;
mod stamp;
mod svg;

pub use animation::{AnimationError, FrameProgress, write_apng, write_gif};
pub use bitmap::Bitmap;
pub use canvas::PictureOptions;
pub use control::Control;
pub use dots::on_paper;
pub use error::{FigureError, MAX_BITMAP_SIDE, MAX_LENGTH, MAX_PIXELS, MAX_SIDE};
pub use fonts::{Font, fitted, lacking, text_width, wrapped};
pub use palette::{Color, Palette, with_alpha};
pub use png::{to_png, to_png_controlled};
pub use raster::{Pixels, to_pixels};
pub use scene::{
    Anchor, Baseline, Fill, Group, Hatch, Marker, Rect, Scene, Shape, Stroke, Style, Text, View,
};
pub use set::{DiskRadii, PlaneLook, SetPicture, set_scene, set_scene_controlled};
pub use stamp::{Stamp, stamp};
pub use svg::{escape, font_faces, to_svg, to_svg_with_fonts, to_svg_with_fonts_controlled};
