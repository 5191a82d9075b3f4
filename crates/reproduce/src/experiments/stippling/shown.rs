//! The table of all methods, and their pictures side by side.

use serde_json::json;
use tilescope_figures::Bitmap;
use tilescope_figures::chart::{Panel, TileContent};

use super::ComparedImage;
use super::images::Darkness;
use super::methods::DotMethod;
use crate::error::Result;
use crate::experiments::common::{picture, tile};
use crate::outcome::{Picture, Table};
use crate::texts::table;

/// Pixels of a picture along a side: enough for dots to be round. The side of its tile is half of it.
const PICTURE: usize = 480;

/// Returns each image with the dots of all methods but the last, independent dots, beside it.
pub fn picture_of(all: &[ComparedImage]) -> Result<Picture> {
    let mut rows = Vec::new();
    for one in all {
        let side = Some(0.5 * PICTURE as f64);
        let image =
            TileContent::Cells(bitmap(|at| one.dark.pixels[one.dark.index(at)], &one.dark)?);
        let no_note = String::new();
        let mut tiles = vec![Panel::Tile(tile(side, one.subject.name(), no_note, image))];
        // Independent dots, the last of the four methods, are the control of the measure, and have no picture.
        for (method, made) in DotMethod::ALL.into_iter().zip(&one.by_method).take(3) {
            let content = TileContent::Cells(dotted(&one.dark, &made.dots)?);
            let note = format!("{} dots", made.dots.len());
            tiles.push(Panel::Tile(tile(side, method.name(), note, content)));
        }
        rows.push(tiles);
    }
    picture("stippling/side-by-side", &json!({}), rows)
}

/// Returns the picture of a darkness at places in pixels of an image, from the highest row down.
fn bitmap(dark_at: impl Fn([f64; 2]) -> f64, dark: &Darkness) -> Result<Bitmap> {
    let scale = dark.side as f64 / PICTURE as f64;
    let shade = |index: usize| {
        let [column, row] = [index % PICTURE, PICTURE - 1 - index / PICTURE];
        let at = [column, row].map(|at| (at as f64 + 0.5) * scale);
        (255.0 * (1.0 - dark_at(at))).round() as u8
    };
    Ok(Bitmap::grey(
        PICTURE,
        (0..PICTURE * PICTURE).map(shade).collect(),
    )?)
}

/// Returns the picture of dots that together have as much ink as the image, but for what overlaps or is cut off.
/// Without dots it is white.
fn dotted(dark: &Darkness, dots: &[[f64; 2]]) -> Result<Bitmap> {
    let scale = PICTURE as f64 / dark.side as f64;
    // Without dots the radius is not used.
    let radius = scale * (dark.sum() / (dots.len().max(1) as f64 * std::f64::consts::PI)).sqrt();
    let mut shades = vec![255; PICTURE * PICTURE];
    for dot in dots {
        let [x, y] = dot.map(|at| at * scale);
        let range =
            |at: f64| ((at - radius).max(0.0) as usize)..((at + radius) as usize + 1).min(PICTURE);
        for row in range(y) {
            for column in range(x) {
                // A pixel is black if its middle lies in the dot. The picture has its highest row first.
                if (column as f64 + 0.5 - x).hypot(row as f64 + 0.5 - y) <= radius {
                    shades[(PICTURE - 1 - row) * PICTURE + column] = 0;
                }
            }
        }
    }
    Ok(Bitmap::grey(PICTURE, shades)?)
}

/// Returns the table of all images and methods.
pub fn tables(all: &[ComparedImage]) -> Vec<Table> {
    let rows = all.iter().flat_map(|one| {
        let methods = DotMethod::ALL.into_iter().zip(&one.by_method);
        methods.map(move |(method, made)| (one.subject.name(), method.name(), made))
    });
    let cells = table("stippling/methods", rows, |(image, method, made)| {
        // Blurs from the finest, tones from the lightest.
        let ([a, b, c, d], [light, half, dark, black]) = (made.quality.blurs, made.quality.tones);
        json!({
            "image": image, "method": method, "dots": made.dots.len(),
            "finest": a, "fine": b, "coarse": c, "coarsest": d,
            "light": light, "half": half, "dark": dark, "black": black,
            "seconds": made.seconds,
        })
    });
    vec![cells]
}
