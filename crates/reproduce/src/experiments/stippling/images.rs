//! The images that are stippled: a photograph, smooth shades, and text.

use tilescope_figures::{Group, Scene, Shape, Text, to_png};
use tilescope_sets::GrayImage;

use crate::error::Result;

/// The photograph that the tests of this program read. It is small, and is made larger here.
const PHOTO: &[u8] = include_bytes!("../../../../tilescope/tests/it/images/photo.jpg");
/// Light in an image.
const WHITE: f64 = 65_535.0;

/// An image with its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StippledImage {
    Photograph,
    Shades,
    Text,
}

/// How dark each pixel of a square image is: 0 is white and 1 black. Rows begin with the lowest.
#[derive(Clone, Debug)]
pub struct Darkness {
    pub side: usize,
    pub pixels: Vec<f64>,
}

impl StippledImage {
    pub const ALL: [Self; 3] = [Self::Photograph, Self::Shades, Self::Text];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Photograph => "photograph",
            Self::Shades => "shades",
            Self::Text => "text",
        }
    }

    /// Returns the image with this many pixels in a row.
    pub fn image(self, side: usize) -> Result<GrayImage> {
        match self {
            Self::Photograph => photograph(side),
            Self::Shades => {
                let shade =
                    |x: f64, y: f64| 0.5 + 0.45 * (7.0 * x).sin() * (2.0 + 9.0 * y * y).cos();
                grey(side, shade)
            }
            Self::Text => text(side),
        }
    }
}

/// Returns the image of a function of places in the unit square that says how dark they are.
fn grey(side: usize, dark: impl Fn(f64, f64) -> f64) -> Result<GrayImage> {
    let middle = |index: usize| (index as f64 + 0.5) / side as f64;
    let rows = (0..side).flat_map(|row| (0..side).map(move |column| (middle(column), middle(row))));
    let pixels = rows.map(|(x, y)| ((1.0 - dark(x, y).clamp(0.0, 1.0)) * WHITE).round() as u16);
    Ok(GrayImage::from_grey(side, pixels.collect())?)
}

/// Returns the square in the middle of the photograph, linear between its pixels.
fn photograph(side: usize) -> Result<GrayImage> {
    let photo = GrayImage::read("photo.jpg", PHOTO)?;
    let size = photo.pixels().map(|count| count as f64);
    let square = size[0].min(size[1]);
    let corner = size.map(|length| 0.5 * (length - square));

    let pixel = |x: f64, y: f64| {
        // There are no pixels beyond the borders of the photograph: the nearest pixel stands in for them.
        let at = |index: f64, count: f64| index.clamp(0.0, count - 1.0) + 0.5;
        photo.darkness_at([at(x, size[0]), at(y, size[1])], size)
    };
    grey(side, |x, y| {
        let [u, v] = [corner[0] + x * square - 0.5, corner[1] + y * square - 0.5];
        // The pixel whose middle lies left of the place and below it, and the place's distance from that middle.
        let ([left, low], [dx, dy]) = ([u.floor(), v.floor()], [u - u.floor(), v - v.floor()]);
        let along = |row: f64| (1.0 - dx) * pixel(left, row) + dx * pixel(left + 1.0, row);
        (1.0 - dy) * along(low) + dy * along(low + 1.0)
    })
}

/// Returns black text on white paper, drawn as figures draw it.
fn text(side: usize) -> Result<GrayImage> {
    let length = side as f64;
    let mut scene = Scene::new(length, length, [255; 4]);
    let mut group = Group::new("text");
    // The sizes of the type are shares of the side: capitals are about a quarter of it high, and small letters a twentieth.
    for (words, size, y) in [
        ("Rain", 0.34, 0.38),
        ("on paper", 0.18, 0.62),
        ("dots in every stroke", 0.08, 0.78),
    ] {
        let at = [0.06 * length, y * length];
        group.shapes.push(Shape::Text(Text::new(
            at,
            words,
            size * length,
            [0, 0, 0, 255],
        )));
    }
    scene.groups.push(group);
    Ok(GrayImage::read("text.png", &to_png(&scene, 1.0)?)?)
}

impl Darkness {
    /// Returns how dark the pixels of a square image are.
    pub fn of(image: &GrayImage) -> Self {
        let [side, rows] = image.pixels();
        let size = [side as f64, rows as f64];
        let middles =
            (0..rows * side).map(|index| [index % side, index / side].map(|at| at as f64 + 0.5));
        Self {
            side,
            pixels: middles
                .map(|place| image.darkness_at(place, size))
                .collect(),
        }
    }

    /// Returns the sum over all pixels, in black pixels.
    pub fn sum(&self) -> f64 {
        self.pixels.iter().sum()
    }

    /// Returns the index of the pixel at a place, in pixels.
    pub fn index(&self, place: [f64; 2]) -> usize {
        let [column, row] = place.map(|at| (at.max(0.0) as usize).min(self.side - 1));
        row * self.side + column
    }
}
