//! Two grey pictures to be stippled, computed from formulas: a still life of three balls on a table, whose shades are smooth, and a
//! landscape of ridges, whose edges are sharp. Nobody else has rights to them.
//!
//!     cargo run --release -p tilescope-sets --example pictures -- assets/pictures
//!
//! writes `still-life.png` and `landscape.png` into a folder. Another machine may round sines in another way, so that the files
//! that lie there are not compared with new ones.

use std::error::Error;
use std::path::PathBuf;

use tilescope_formats::write_whole;
use tilescope_sets::GrayImage;

/// Pixels along a row and a column.
const SIZE: [usize; 2] = [480, 360];

/// A ball on the table: its centre and its radius, in heights of the picture from the lower left corner, and how light it is.
struct Ball {
    center: [f64; 2],
    radius: f64,
    albedo: f64,
}

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

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".to_owned()));
    for (name, shade) in [
        ("still-life.png", still_life as fn([f64; 2]) -> f64),
        ("landscape.png", landscape),
    ] {
        let image = GrayImage::as_png(name, SIZE[0], &rendered(shade))?;
        write_whole(&folder.join(name), &image.to_png()?)?;
    }
    Ok(())
}

/// Returns the grey of each pixel, from the lowest row up: the mean of 3 x 3 places, so that edges have no steps.
fn rendered(shade: fn([f64; 2]) -> f64) -> Vec<u16> {
    let [columns, rows] = SIZE;
    let height = rows as f64;
    let pixels = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
    let grey = |[column, row]: [usize; 2]| {
        let part = |at: usize, sub: usize| (at as f64 + (sub as f64 + 0.5) / 3.0) / height;
        let places = (0..9).map(|sub| [part(column, sub % 3), part(row, sub / 3)]);
        let mean = places.map(shade).sum::<f64>() / 9.0;
        // Of 256 greys, so that the file is small; a byte is the upper half of each grey.
        257 * (mean.clamp(0.0, 1.0) * 255.0).round() as u16
    };
    pixels.map(grey).collect()
}

/// Returns the light of a place of the still life, from 0 to 1.
fn still_life([x, y]: [f64; 2]) -> f64 {
    // The balls are listed from the back to the front.
    let hit = BALLS.iter().rev().find_map(|ball| on_ball(ball, [x, y]));
    hit.unwrap_or_else(|| on_table([x, y]))
}

/// Returns the light of a place on a ball; nothing beside it.
fn on_ball(ball: &Ball, [x, y]: [f64; 2]) -> Option<f64> {
    let [u, v] = [
        (x - ball.center[0]) / ball.radius,
        (y - ball.center[1]) / ball.radius,
    ];
    let depth = 1.0 - u * u - v * v;
    if depth < 0.0 {
        return None;
    }
    let normal = [u, v, depth.sqrt()];
    let facing: f64 = normal.iter().zip(LIGHT).map(|(a, b)| a * b).sum();
    // Lambert's law, light from all sides, light from the table below, and a highlight (Phong).
    let mirrored = 2.0 * facing * normal[2] - LIGHT[2];
    let highlight = 0.5 * mirrored.max(0.0).powi(24);
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
        1.0 - 0.75 * (1.0 - out).clamp(0.0, 1.0).powf(0.6)
    });
    (0.62 + 0.7 * y) * shadows.product::<f64>()
}

/// Returns the light of a place of the landscape, from 0 to 1.
fn landscape([x, y]: [f64; 2]) -> f64 {
    const SHORE: f64 = 0.24;
    if y < SHORE {
        // The lake shows what is above the shore, with ripples that widen towards the viewer.
        let below = SHORE - y;
        let ripple = (below * 260.0 / (0.3 + 3.0 * below) + 9.0 * (5.0 * x).sin()).sin();
        let seen = above([x, SHORE + 1.6 * below + 0.01 * ripple]);
        return 0.82 * seen + 0.05 * ripple * (below / SHORE).sqrt();
    }
    above([x, y])
}

/// Returns the light of a place above the lake.
fn above([x, y]: [f64; 2]) -> f64 {
    // From the nearest ridge to the farthest: how high it is, how rough, and how light the haze makes it.
    for (number, [base, rough, light]) in [
        [0.30, 0.05, 0.06],
        [0.40, 0.10, 0.28],
        [0.52, 0.16, 0.50],
        [0.60, 0.20, 0.70],
    ]
    .into_iter()
    .enumerate()
    {
        let height = ridge(x, number as f64);
        let top = base + rough * height;
        if y < top {
            // Haze lies in the valleys.
            return light + 0.18 * (top - y).min(0.3) / 0.3;
        }
    }
    let sun = ((x - 0.98).powi(2) + (y - 0.80).powi(2)).sqrt();
    if sun < 0.06 {
        return 1.0;
    }
    0.80 + 0.12 * (-8.0 * sun).exp() + 0.1 * (1.0 - y)
}

/// Returns the outline of a ridge, between about -1 and 1: a sum of ever finer waves, folded to have peaks.
fn ridge(x: f64, number: f64) -> f64 {
    let waves = (0..7).map(|octave| {
        let scale = 2.0_f64.powi(octave);
        let wave = (3.1 * scale * x + 1.7 * number + 2.3 * f64::from(octave)).sin();
        (1.0 - 2.0 * wave.abs()) / scale.powf(0.9)
    });
    waves.sum::<f64>() * 0.55
}
