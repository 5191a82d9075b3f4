//! The picture with its caption and the meaning of its colours, for files.

use std::ops::ControlFlow;

use tilescope_figures::{
    Anchor, Baseline, Bitmap, FigureError, Group, Rect, Scene, Shape, Style, Text, fitted,
};
use tilescope_session::words::counted;

use super::{BallColors, COLOR_BANDS, GoOn, OrbitError, OrbitPicture, OrbitView, band_color};

/// Returns what a picture of so many balls in a box of a size shows, in a sentence: "739 balls of half the radius in a box of 10 x 10 x 10, cut open at the corner
/// nearest to the eye, seen from 30 degrees above".
#[must_use]
pub fn described(count: usize, size: [f64; 3], view: OrbitView) -> String {
    let balls = counted(count, "ball", "balls");
    let sides = size.map(|side| side.to_string()).join(" \u{d7} ");
    let cut = if view.is_cut {
        ", cut open at the corner nearest to the eye"
    } else {
        ""
    };
    format!(
        "{balls} of half the radius in a box of {sides}{cut}, seen from {}",
        view.height_text()
    )
}

/// Returns the picture with a line above it, unless that is empty, and, if asked for, below it what the colours mean.
///
/// # Errors
///
/// [`OrbitError`].
pub fn scene(
    picture: &OrbitPicture<'_>,
    caption: &str,
    has_legend: bool,
    go_on: GoOn<'_>,
) -> Result<Scene, OrbitError> {
    let pixels = picture.draw(go_on)?;
    let [width, height] = picture.size.map(f64::from);
    let colors: Vec<[u8; 3]> = pixels
        .rgba
        .chunks_exact(4)
        .map(|pixel| [pixel[0], pixel[1], pixel[2]])
        .collect();
    drop(pixels);

    let opaque = |color: ecolor::Color32| color.to_array();
    let palette = picture.palette;
    let mut scene = Scene::new(width, height, opaque(palette.domain));
    // Who does not see the picture gets the whole sentence; above it the line has no room for more than the caption.
    let set = &picture.set;
    let words = described(set.points.len(), set.size, picture.view);
    scene.title = if caption.is_empty() {
        words
    } else {
        format!("{caption}: {words}")
    };

    let mut group = Group::new("balls");
    let rect = Rect::new([0.0; 2], [width, height]);
    // `draw` refused sides that a bitmap cannot have.
    let bitmap = Bitmap::rgb(picture.size[0] as usize, &colors).map_err(too_large(picture))?;
    group.shapes.push(Shape::Image { rect, bitmap });
    scene.groups.push(group);

    // Letters grow with the picture: the lengths below are pixels of one that is 1000 wide.
    let px = width / 1000.0;
    let mut writing = Group::new("caption");
    let at = [16.0 * px, 32.0 * px];
    let (letters, room) = (20.0 * px, width - 2.0 * at[0]);
    let line = fitted(caption, room, letters);
    let text = Text::new(at, line, letters, opaque(palette.text));
    writing.shapes.push(Shape::Text(text));
    let meaning = match picture.set.colors {
        // Balls of one colour need no legend.
        BallColors::One => None,
        BallColors::Arrival => Some((
            "balls by arrival: the first half, the next quarter, and so on",
            band_share as fn(u32) -> String,
        )),
        BallColors::Levels(_) => Some((
            "balls by the level at which they arrived",
            level_name as fn(u32) -> String,
        )),
    };
    if let Some((heading, name)) = meaning.filter(|_| has_legend) {
        writing.shapes.extend(legend(picture, px, heading, name));
    }
    scene.groups.push(writing);
    Ok(scene)
}

fn too_large(picture: &OrbitPicture<'_>) -> impl Fn(FigureError) -> OrbitError {
    let [width, height] = picture.size;
    move |_| OrbitError::Size { width, height }
}

/// Returns the squares of the colours at the lower edge, each with its name, below a heading. `px` is a thousandth of
/// the picture's width: lengths are multiples of it, chosen by eye.
fn legend(
    picture: &OrbitPicture<'_>,
    px: f64,
    heading: &str,
    name: impl Fn(u32) -> String,
) -> Vec<Shape> {
    let height = f64::from(picture.size[1]);
    let palette = picture.palette;
    let letters = |at: [f64; 2], text: String, anchor| {
        Shape::Text(Text {
            anchor,
            baseline: Baseline::Middle,
            ..Text::new(at, text, 15.0 * px, palette.muted.to_array())
        })
    };
    let (left, middle) = (16.0 * px, height - 30.0 * px);
    let above = [left, middle - 24.0 * px];
    let mut shapes = vec![letters(above, heading.to_owned(), Anchor::Start)];

    // A square and its words take this room.
    let room = 72.0 * px;
    for band in 0..COLOR_BANDS {
        let x = left + room * f64::from(band);
        let half = 7.0 * px;
        let [red, green, blue] = band_color(palette, band);
        let square = Rect::new([x, middle - half], [x + 2.0 * half, middle + half]);
        let style = Style::filled([red, green, blue, u8::MAX]);
        shapes.push(Shape::Rect {
            rect: square,
            style,
        });

        shapes.push(letters([x + 2.6 * half, middle], name(band), Anchor::Start));
    }
    shapes
}

/// Returns the levels that have the colour of a band.
#[must_use]
pub fn level_name(band: u32) -> String {
    match band {
        last if last == COLOR_BANDS - 1 => format!("{last} and later"),
        band => band.to_string(),
    }
}

/// Returns the share of the balls that have the colour of a band, in the order of their arrival.
fn band_share(band: u32) -> String {
    // The last colour is that of all that the others leave, as many balls as the one before it has.
    match band {
        last if last == COLOR_BANDS - 1 => "rest".to_owned(),
        band => format!("1/{}", 2_u32 << band),
    }
}

/// Draws every picture to its end.
pub const fn to_the_end() -> ControlFlow<()> {
    ControlFlow::Continue(())
}
