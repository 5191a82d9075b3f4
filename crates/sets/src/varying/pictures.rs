//! Two grey pictures to be stippled, computed from formulas: a still life of three balls on a table, whose shades are smooth,
//! and a landscape of ridges, whose edges are sharp. They are free of others' rights. They are computed where they are asked
//! for, as a page would have to load their files. Sines and powers are those of `libm`, and so are the same everywhere.

use super::VaryingError;
use super::image::GrayImage;

/// Pixels along a row and a column.
const SIZE: [usize; 2] = [480, 360];

/// Places along the side of a pixel whose mean is its grey, so that edges have no steps.
const PLACES: usize = 3;

/// A picture that the program computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComputedPicture {
    /// Three balls on a table.
    StillLife,
    /// Ridges behind a lake.
    Landscape,
}

impl ComputedPicture {
    /// Both of them.
    pub const ALL: [Self; 2] = [Self::StillLife, Self::Landscape];

    /// Pixels along a row and a column.
    pub const SIZE: [usize; 2] = SIZE;

    /// Returns the name of its file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::StillLife => "still-life.png",
            Self::Landscape => "landscape.png",
        }
    }

    /// Returns the picture, as [`GrayImage::read`] reads its file.
    ///
    /// # Errors
    ///
    /// As [`GrayImage::as_png`]; there are none with these pixels.
    pub fn image(self) -> Result<GrayImage, VaryingError> {
        let grey = match self {
            Self::StillLife => rendered(|column, y| still_life([along(column), y])),
            Self::Landscape => {
                // An outline is the same for all places of a column, and computed once.
                let ridges: Vec<[f64; 4]> = (0..SIZE[0] * PLACES).map(outlines).collect();
                rendered(|column, y| landscape(along(column), &ridges[column], y))
            }
        };
        GrayImage::as_png(self.name(), SIZE[0], &grey)
    }
}

/// Returns where a column or a row of places lies, in heights of the picture.
fn along(place: usize) -> f64 {
    (place as f64 + 0.5) / (PLACES * SIZE[1]) as f64
}

/// Returns the grey of each pixel, from the lowest row up. `shade` is the light at a height in a column of places.
fn rendered(shade: impl Fn(usize, f64) -> f64) -> Vec<u16> {
    let [columns, rows] = SIZE;
    let mut grey = Vec::with_capacity(columns * rows);
    for row in 0..rows {
        for column in 0..columns {
            // Places lie in a square grid within the pixel.
            let mut sum = 0.0;
            for place in 0..PLACES * PLACES {
                let y = along(PLACES * row + place / PLACES);
                sum += shade(PLACES * column + place % PLACES, y);
            }
            let mean = sum / (PLACES * PLACES) as f64;
            // Of 256 greys, so that the file is small; a byte is the upper half of each grey.
            grey.push(257 * (mean.clamp(0.0, 1.0) * 255.0).round() as u16);
        }
    }
    grey
}

/// A ball on the table: its centre and its radius, in heights of the picture from the lower left corner, and how light it is.
struct Ball {
    center: [f64; 2],
    radius: f64,
    albedo: f64,
}

/// The balls, from the back to the front.
const BALLS: [Ball; 3] = [
    Ball {
        center: [0.44, 0.46],
        radius: 0.24,
        albedo: 0.85,
    },
    Ball {
        center: [0.80, 0.36],
        radius: 0.15,
        albedo: 0.45,
    },
    Ball {
        center: [1.04, 0.28],
        radius: 0.09,
        albedo: 0.95,
    },
];

/// Where the light comes from: from the upper left and the front, as a unit vector.
const LIGHT: [f64; 3] = [-0.48, 0.64, 0.6];

/// Returns the light of a place of the still life, from 0 to 1.
fn still_life(at: [f64; 2]) -> f64 {
    let hit = BALLS.iter().rev().find_map(|ball| on_ball(ball, at));
    hit.unwrap_or_else(|| on_table(at))
}

/// Returns the light of a place on a ball; nothing beside it.
fn on_ball(ball: &Ball, [x, y]: [f64; 2]) -> Option<f64> {
    let [u, v] = [
        (x - ball.center[0]) / ball.radius,
        (y - ball.center[1]) / ball.radius,
    ];
    // The third side of a triangle on the unit sphere; beside the ball there is none.
    let depth = 1.0 - u * u - v * v;
    if depth < 0.0 {
        return None;
    }
    let normal = [u, v, depth.sqrt()];
    let facing: f64 = normal.iter().zip(LIGHT).map(|(a, b)| a * b).sum();

    // Lambert's law, light from all sides, light from the table below, and a highlight (Phong), whose power is 24.
    let mirrored = (2.0 * facing * normal[2] - LIGHT[2]).max(0.0);
    let eighth = {
        let fourth = mirrored * mirrored * mirrored * mirrored;
        fourth * fourth
    };
    let highlight = 0.5 * eighth * eighth * eighth;
    let ambient = 0.10 + 0.10 * (-v).max(0.0);
    Some(ball.albedo * (0.85 * facing.max(0.0) + ambient) + highlight)
}

/// Returns the light of a place of the table and of the wall behind it.
fn on_table([x, y]: [f64; 2]) -> f64 {
    const EDGE: f64 = 0.34;
    if y > EDGE {
        return 0.92 - 0.25 * (y - EDGE) - 0.15 * (x - 0.3).abs();
    }

    // Shadows are ellipses that fade outwards, away from the light.
    let shadows = BALLS.iter().map(|ball| {
        let foot = ball.center[1] - 0.92 * ball.radius;
        let u = (x - ball.center[0] - 0.7 * ball.radius) / (1.5 * ball.radius);
        let v = (y - foot) / (0.33 * ball.radius);
        let out = (u * u + v * v).sqrt();
        1.0 - 0.75 * libm::pow((1.0 - out).clamp(0.0, 1.0), 0.6)
    });
    (0.62 + 0.7 * y) * shadows.product::<f64>()
}

/// The ridges from the nearest to the farthest: how high each is, how rough, and how light the haze makes it.
const RIDGES: [[f64; 3]; 4] = [
    [0.30, 0.05, 0.06],
    [0.40, 0.10, 0.28],
    [0.52, 0.16, 0.50],
    [0.60, 0.20, 0.70],
];

/// Returns the upper ends of the ridges in a column of places.
fn outlines(column: usize) -> [f64; 4] {
    let x = along(column);
    let mut number = -1.0;
    RIDGES.map(|[base, rough, _]| {
        number += 1.0;
        base + rough * outline(x, number)
    })
}

/// Returns the outline of a ridge, between about -1 and 1: a sum of ever finer waves, folded to have peaks.
fn outline(x: f64, number: f64) -> f64 {
    let waves = (0..7_u32).map(|octave| {
        // Each wave is half as long as the one before, and little more than half as high.
        let scale = f64::from(1 << octave);
        let wave = libm::sin(3.1 * scale * x + 1.7 * number + 2.3 * f64::from(octave));
        (1.0 - 2.0 * wave.abs()) / libm::pow(scale, 0.9)
    });
    waves.sum::<f64>() * 0.55
}

/// Returns the light of a place of the landscape, from 0 to 1. `tops` are the upper ends of the ridges there.
fn landscape(x: f64, tops: &[f64; 4], y: f64) -> f64 {
    const SHORE: f64 = 0.24;
    if y >= SHORE {
        return above(x, tops, y);
    }
    // The lake mirrors the ridges above the shore, with ripples that widen towards the viewer.
    let below = SHORE - y;
    let sway = 9.0 * libm::sin(5.0 * x);
    let ripple = libm::sin(below * 260.0 / (0.3 + 3.0 * below) + sway);
    let seen = above(x, tops, SHORE + 1.6 * below + 0.01 * ripple);
    0.82 * seen + 0.05 * ripple * (below / SHORE).sqrt()
}

/// Returns the light of a place above the lake.
fn above(x: f64, tops: &[f64; 4], y: f64) -> f64 {
    for ([.., light], top) in RIDGES.iter().zip(tops) {
        // Ridges are in order of their distance, so that the first one hides the others.
        if y < *top {
            // Haze lies in the valleys.
            return light + 0.18 * (top - y).min(0.3) / 0.3;
        }
    }

    // The sun, and around it the sky, which is lighter near it and near the horizon.
    let [right, up] = [x - 0.98, y - 0.80];
    let sun = (right * right + up * up).sqrt();
    if sun < 0.06 {
        return 1.0;
    }
    0.80 + 0.12 * libm::exp(-8.0 * sun) + 0.1 * (1.0 - y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn computed_pictures_are_those_of_their_files_byte_for_byte() {
        let files = [
            &include_bytes!("../../../../assets/pictures/still-life.png")[..],
            &include_bytes!("../../../../assets/pictures/landscape.png")[..],
        ];
        for (picture, file) in ComputedPicture::ALL.into_iter().zip(files) {
            let image = picture.image().expect("a picture");
            assert_eq!(image.pixels(), ComputedPicture::SIZE);
            assert!(image.to_png().expect("a file") == file, "{picture:?}");
        }
        // The control: the other picture is another file.
        let other = ComputedPicture::Landscape.image().expect("a picture");
        assert!(other.to_png().expect("a file") != files[0]);
    }
}
