//! A set in space as a picture: balls of half the radius, which never overlap, in their box, cut open at a corner. It shows the
//! set and not the algorithm; a plane through the set shows that. Begin with [`OrbitPicture`].
//!
//! The projection is parallel, so that equal balls are equal disks. Of each pixel the nearest surface is kept (`bands`), and
//! only those are shaded (`shade`), so that the balls inside cost little. The same picture has the same bytes everywhere.

mod bands;
mod edges;
mod projection;
mod scene;
mod shade;
mod view;

use std::ops::ControlFlow;

use rayon::prelude::*;
use tilescope_figures::Pixels;

use crate::palette::Palette;
use bands::Band;
use edges::Edge;
use projection::{PlacedBall, Projection};
use shade::Shading;

pub use scene::{described, level_name, scene, to_the_end};
pub use view::{MAX_ELEVATION, OrbitView, TURN_FRAMES, ZOOMS};

/// The most balls of a picture: the codes of surfaces have 32 bits, two of them for the kind of a surface.
pub const MAX_BALLS: usize = (1 << 30) - 1;
/// The longest side of a picture in pixels, that of a bitmap in a scene.
pub const MAX_PICTURE_SIDE: u32 = tilescope_figures::MAX_BITMAP_SIDE as u32;
/// The number of colours: one for each level, or one for the first half of the balls, one for the half of the rest, and so on.
pub const COLOR_BANDS: u32 = 8;
/// The rows of pixels that a thread makes at a time: enough bands for many threads, and few balls that lie in two of them.
const BAND_ROWS: usize = 32;

/// Whether to go on, asked between bands of rows, from any thread.
pub type GoOn<'a> = &'a (dyn Fn() -> ControlFlow<()> + Sync);

/// Why there is no picture of a set in space.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OrbitError {
    /// A side of the box, or the radius, is no length.
    #[error("{name} is {value}; a picture needs a length above 0")]
    Length {
        /// What it is the length of.
        name: &'static str,
        /// The number.
        value: f64,
    },
    /// A ball has a coordinate that is not finite.
    #[error("ball {index} lies at {coordinate}, which is no place of the box")]
    Place {
        /// The ball, counted from 0.
        index: usize,
        /// Its coordinate.
        coordinate: f64,
    },
    /// There are too many balls.
    #[error("{balls} balls are too many for a picture; the limit is {MAX_BALLS}")]
    TooMany {
        /// How many there are.
        balls: usize,
    },
    /// A side of the picture has no pixel or too many.
    #[error(
        "a picture of {width} x {height} pixels cannot be made; each side must be 1 to {MAX_PICTURE_SIDE}"
    )]
    Size {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// The caller asked to stop.
    #[error("the picture was cancelled")]
    Cancelled,
}

/// What the colours of balls show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BallColors<'a> {
    /// Nothing: all balls have one.
    One,
    /// When they arrived, of a set whose samples are in the order of their arrival.
    Arrival,
    /// The level of the process at which each ball arrived.
    Levels(&'a [u8]),
}

/// A set in space.
#[derive(Clone, Copy, Debug)]
pub struct OrbitSet<'a> {
    /// The samples, in user units.
    pub points: &'a [[f64; 3]],
    /// The sides of the box, whose lower corner is at 0, in user units.
    pub size: [f64; 3],
    /// The radius of the set, in user units: two samples are at least so far apart, and balls have half of it.
    pub radius: f64,
    /// What the colours of the balls show.
    pub colors: BallColors<'a>,
}

impl OrbitSet<'_> {
    /// Refuses sets and sizes that cannot be drawn.
    fn check(&self) -> Result<(), OrbitError> {
        let [x, y, z] = self.size;
        let radius = self.radius;
        for (name, value) in [
            ("the radius", radius),
            ("the box along x", x),
            ("the box along y", y),
            ("the box along z", z),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(OrbitError::Length { name, value });
            }
        }

        let balls = self.points.len();
        if balls > MAX_BALLS {
            return Err(OrbitError::TooMany { balls });
        }
        // A coordinate that is no number would be placed nowhere, and no comparison of nearness would hold.
        for (index, point) in self.points.iter().enumerate() {
            if let Some(&coordinate) = point.iter().find(|value| !value.is_finite()) {
                return Err(OrbitError::Place { index, coordinate });
            }
        }
        Ok(())
    }

    /// Returns the number of the colour of a ball, below [`COLOR_BANDS`].
    ///
    /// By arrival, the first half of the balls has the first colour, half of the rest the next one, and so on: about a level each in
    /// the late levels of the process, in which the samples that are still to come halve from level to level.
    #[must_use]
    pub fn color_band(&self, index: usize) -> u32 {
        let band = match self.colors {
            BallColors::One => 0,
            BallColors::Arrival => {
                // The balls from this one on; at least 1, so that the division below is one by no 0.
                let left = self.points.len().saturating_sub(index).max(1) as u64;
                (self.points.len() as u64 / left).max(1).ilog2()
            }
            BallColors::Levels(levels) => levels.get(index).copied().unwrap_or_default().into(),
        };
        // There are 16 levels, of which the late ones have few balls and share the last colour.
        band.min(COLOR_BANDS - 1)
    }
}

/// Returns the colour of a band on the ramp of ages.
#[must_use]
pub fn band_color(palette: &Palette, band: u32) -> [u8; 3] {
    let age = band as f32 / (COLOR_BANDS - 1) as f32;
    let [red, green, blue, _] = palette.age(age).to_array();
    [red, green, blue]
}

/// A picture of a set in space.
#[derive(Clone, Copy, Debug)]
pub struct OrbitPicture<'a> {
    /// The set.
    pub set: OrbitSet<'a>,
    /// From where it is seen.
    pub view: OrbitView,
    /// The octant that is cut out: a sign for each axis, from the middle of the box; `None` for a whole set.
    pub open: Option<[f64; 3]>,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The colours.
    pub palette: &'a Palette,
    /// Whether it is drawn with one ray for a pixel instead of four: for a view that moves.
    pub is_coarse: bool,
}

impl<'a> OrbitPicture<'a> {
    /// Returns the picture of a set, cut open as the view says.
    #[must_use]
    pub fn new(set: OrbitSet<'a>, view: OrbitView, size: [u32; 2], palette: &'a Palette) -> Self {
        Self {
            set,
            view,
            open: view.open(),
            size,
            palette,
            is_coarse: false,
        }
    }

    /// Draws the picture, opaque, on all threads.
    ///
    /// Besides the pixels it holds some 40 bytes for each ball, and some for each pixel of the bands in work.
    ///
    /// # Errors
    ///
    /// [`OrbitError`].
    pub fn draw(&self, go_on: GoOn<'_>) -> Result<Pixels, OrbitError> {
        let [width, height] = self.size;
        let sides = 1..=MAX_PICTURE_SIDE;
        if !(sides.contains(&width) && sides.contains(&height)) {
            return Err(OrbitError::Size { width, height });
        }
        self.set.check()?;

        // Rays for a pixel, along each axis: four rays smooth the edges of balls.
        let rays = if self.is_coarse { 1 } else { 2 };
        let projection = Projection::new(&self.set, self.view, [width, height], rays);
        let balls = projection.place(&self.set, self.open);
        let edges = Edge::all(&self.set, self.open, &projection);
        let shading = Shading::new(self, &projection, &balls);

        let row_bytes = 4 * width as usize;
        let mut rgba = vec![u8::MAX; row_bytes * height as usize];
        let of_band = by_bands(&balls, &projection, height as usize, rays);
        let bands = rgba.par_chunks_mut(BAND_ROWS * row_bytes).zip(&of_band);
        let drawn = bands
            .enumerate()
            .try_for_each(|(number, (pixels, inside))| {
                if go_on().is_break() {
                    return Err(OrbitError::Cancelled);
                }
                let rows = pixels.len() / row_bytes;
                let top = number * BAND_ROWS * rays;
                let mut band = Band::new(top, rows * rays, width as usize * rays);
                // The nearest come first, so that what they hide is refused by one comparison.
                for &ball in inside {
                    band.paint(&balls[ball as usize], &projection, self.open);
                }
                for edge in &edges {
                    band.draw(edge);
                }
                shading.shade(&band, rays, pixels);
                Ok(())
            });
        drawn?;

        Ok(Pixels {
            width,
            height,
            rgba,
        })
    }
}

/// Returns the balls that reach into each band of rows, in their order.
fn by_bands(
    balls: &[PlacedBall],
    projection: &Projection,
    height: usize,
    rays: usize,
) -> Vec<Vec<u32>> {
    let count = height.div_ceil(BAND_ROWS);
    let mut bands = vec![Vec::new(); count];
    let rows = (BAND_ROWS * rays) as f32;

    for (index, ball) in balls.iter().enumerate() {
        let [above, below] = [ball.row - projection.radius, ball.row + projection.radius];
        // A ball that ends above the picture is in no band.
        if below < 0.0 {
            continue;
        }
        // A ball that begins above the picture is in the first band, since the cast of a negative number gives 0. A
        // ball that begins below the picture is in no band, since `skip` passes over all bands. Even of a sample far
        // outside of the box this is true: the cast of a row beyond all whole numbers gives the greatest.
        let first = (above / rows) as usize;
        let last = (below / rows) as usize;
        for band in bands.iter_mut().take(last.saturating_add(1)).skip(first) {
            band.push(index as u32);
        }
    }
    bands
}

#[cfg(test)]
mod tests;
