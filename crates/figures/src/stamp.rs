//! A piece of text as pixels, for a window that has no font for it.

use glam::DVec2;
use tiny_skia::{FillRule, Paint, Pixmap, Transform};

use crate::error::MAX_SIDE;
use crate::fonts::{Font, Fonts};
use crate::raster::Pixels;

/// A piece of text as pixels, to be placed by its baseline.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// White pixels with their opacity, to be tinted.
    pub pixels: Pixels,
    /// The pixel row of the baseline.
    pub baseline: u32,
    /// How many pixels farther the next character stands.
    pub advance: u32,
}

/// Returns a text in the regular font at an em of `size` pixels, with boxes for the characters that the font lacks: for a
/// window that has no font for them. `None` if there is nothing to draw, if it would be larger than pictures may be, or if
/// the program's own fonts cannot be read.
///
/// ```
/// use tilescope_figures::stamp;
/// assert_ne!(stamp("\u{70b9}", 16.0), stamp("\u{96c6}", 16.0));
/// assert_eq!(stamp("", 16.0), None);
/// ```
#[must_use]
pub fn stamp(text: &str, size: f64) -> Option<Stamp> {
    let fonts = Fonts::new().ok()?;
    let width = fonts.width(text, Font::Regular, size).ceil();
    // Letters may reach above capitals and below the baseline: there is room for that, in parts of an em that were
    // chosen, not measured.
    let [above, below] = [1.1 * size, 0.3 * size].map(f64::ceil);

    // A text without width would have no pixels, and a text from a file may be longer than any picture: neither is
    // drawn.
    let is_small = (1.0..=MAX_SIDE).contains(&width) && above + below <= MAX_SIDE;
    let [columns, rows] = [width, above + below].map(|side| side as u32);
    let mut pixmap = is_small.then(|| Pixmap::new(columns, rows)).flatten()?;

    let place = |p: DVec2| [p.x as f32, (p.y + above) as f32];
    let path = fonts.outline(text, Font::Regular, size, place)?;
    let mut paint = Paint::default();
    paint.set_color(tiny_skia::Color::WHITE);
    pixmap.fill_path(
        &path,
        &paint,
        FillRule::Winding,
        Transform::identity(),
        None,
    );

    Some(Stamp {
        pixels: Pixels {
            width: columns,
            height: rows,
            rgba: pixmap.take_demultiplied(),
        },
        baseline: above as u32,
        advance: columns,
    })
}
