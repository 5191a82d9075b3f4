//! How well dots show an image: the error of both after a blur, and how many dots each tone has.

use serde::{Deserialize, Serialize};

use super::images::Darkness;

/// Blurs as standard deviations of a Gauss function, in mean distances of dots, the root of the area of a dot. The first shows
/// single dots, the last is that of a page at arm's length.
pub const BLURS: [f64; 4] = [0.35, 0.7, 1.4, 2.8];
/// A Gauss function is cut off behind this many deviations: 0.3 % is left out.
const CUT: f64 = 3.0;
/// Where the classes of darkness begin; the last ends at black. Lighter tones have too few dots.
pub const CLASSES: [f64; 4] = [0.0625, 0.25, 0.5, 0.75];
/// A class that has less than this share of all darkness is left out: chance would decide its tone.
const LEAST_SHARE: f64 = 0.02;

/// How well dots show an image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Peak signal to noise of each blur, in decibels.
    pub blurs: [f64; 4],
    /// Dots over those that the darkness of each class asks for; none where there is hardly any of it.
    pub tones: [Option<f64>; 4],
}

impl Quality {
    /// Returns the quality of dots in pixels of the image.
    pub fn of(dark: &Darkness, dots: &[[f64; 2]]) -> Self {
        // All dots together have as much ink as the image. An image without dots is taken to have one, so that nothing is
        // divided by 0.
        let ink = dark.sum() / dots.len().max(1) as f64;
        let distance = dark.side as f64 / (dots.len().max(1) as f64).sqrt();
        // Only pixels so far from the border are compared that no blur of theirs reaches beyond it.
        let margin = (CUT * BLURS[3] * distance).ceil() as usize;
        let shown = inked(dark, dots, ink);
        let error: Vec<f64> = shown
            .iter()
            .zip(&dark.pixels)
            .map(|(ink, dark)| ink - dark)
            .collect();
        Self {
            blurs: BLURS.map(|blur| {
                decibels(
                    &blurred(&error, dark.side, blur * distance),
                    dark.side,
                    margin,
                )
            }),
            tones: tones(dark, dots, ink),
        }
    }

    /// Returns how far the tone that is farthest off is from 1.
    pub fn worst_tone(&self) -> f64 {
        let off = self.tones.iter().flatten().map(|tone| (tone - 1.0).abs());
        off.fold(0.0, f64::max)
    }
}

/// Returns the ink in each pixel. Each dot is shared by the four pixels around it, so that it stays where it is.
fn inked(dark: &Darkness, dots: &[[f64; 2]], ink: f64) -> Vec<f64> {
    let mut pixels = vec![0.0; dark.pixels.len()];
    for &[x, y] in dots {
        let [u, v] = [x - 0.5, y - 0.5];
        let [right, up] = [u - u.floor(), v - v.floor()];
        for (across, along) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let share = (if across > 0.0 { right } else { 1.0 - right })
                * (if along > 0.0 { up } else { 1.0 - up });
            pixels[dark.index([u.floor() + across, v.floor() + along])] += ink * share;
        }
    }
    pixels
}

/// Returns a square image after a Gauss function of this deviation in pixels, along both axes. Beyond it all is 0.
fn blurred(pixels: &[f64], side: usize, deviation: f64) -> Vec<f64> {
    let reach = (CUT * deviation).ceil() as usize;
    let weight = |step: usize| (-0.5 * ((step as f64 - reach as f64) / deviation).powi(2)).exp();
    let weights: Vec<f64> = (0..=2 * reach).map(weight).collect();
    let all: f64 = weights.iter().sum();

    // Each pass blurs along rows and swaps rows and columns, so that two passes blur both axes and restore the image.
    let pass = |from: &[f64]| {
        let mut to = vec![0.0; from.len()];
        for (row, line) in from.chunks_exact(side).enumerate() {
            for column in 0..side {
                let first = column.saturating_sub(reach);
                let near = &line[first..(column + reach + 1).min(side)];
                let from_first = &weights[first + reach - column..];
                let sum: f64 = near
                    .iter()
                    .zip(from_first)
                    .map(|(value, weight)| value * weight)
                    .sum();
                to[column * side + row] = sum / all;
            }
        }
        to
    };
    pass(&pass(pixels))
}

/// Returns the peak signal to noise of an error in the middle of a square image, in decibels; black is the peak.
fn decibels(error: &[f64], side: usize, margin: usize) -> f64 {
    // All blurs have the same margin, so that their errors are those of the same part of the image.
    let inside = margin..side.saturating_sub(margin);
    let (mut sum, mut count) = (0.0, 0_u32);
    for row in inside.clone() {
        for &value in error[row * side..][..side]
            .get(inside.clone())
            .unwrap_or_default()
        {
            sum += value * value;
            count += 1;
        }
    }
    -10.0 * (sum / f64::from(count.max(1))).log10()
}

/// Returns dots over those that the darkness of each class asks for.
fn tones(dark: &Darkness, dots: &[[f64; 2]], ink: f64) -> [Option<f64>; 4] {
    // The class of a tone is the last that begins at it or before.
    let class = |tone: f64| CLASSES.iter().rposition(|&from| tone >= from);
    // Both in black pixels.
    let (mut asked, mut made) = ([0.0; 4], [0.0; 4]);
    for &tone in &dark.pixels {
        if let Some(class) = class(tone) {
            asked[class] += tone;
        }
    }
    for &dot in dots {
        if let Some(class) = class(dark.pixels[dark.index(dot)]) {
            made[class] += ink;
        }
    }
    let least = LEAST_SHARE * dark.sum();
    [0, 1, 2, 3].map(|class| (asked[class] >= least).then(|| made[class] / asked[class]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_regular_grid_is_better_than_the_same_dots_moved_together_and_tones_say_where_dots_are() {
        let dark = Darkness {
            side: 120,
            pixels: vec![0.3; 120 * 120],
        };
        let place = |index: usize| [index % 40, index / 40].map(|at| 3.0 * at as f64 + 1.5);
        let even: Vec<[f64; 2]> = (0..1600).map(place).collect();
        let crowded: Vec<[f64; 2]> = even.iter().map(|&[x, y]| [0.9 * x, y]).collect();
        let [even, crowded] = [even, crowded].map(|dots| Quality::of(&dark, &dots));
        assert!(
            even.blurs[2] > crowded.blurs[2] + 10.0,
            "{even:?} {crowded:?}"
        );
        assert!((even.tones[1].unwrap() - 1.0).abs() < 1e-9 && even.tones[0].is_none());

        // Two tones, and all dots on the darker one.
        let two = (0..120 * 120).map(|index| if index % 120 < 60 { 0.3 } else { 0.6 });
        let dark = Darkness {
            side: 120,
            pixels: two.collect(),
        };
        let right: Vec<[f64; 2]> = (0..1600).map(|index| [90.0, place(index)[1]]).collect();
        let quality = Quality::of(&dark, &right);
        assert_eq!(quality.tones[1], Some(0.0));
        assert!((quality.tones[2].unwrap() - 1.5).abs() < 1e-9);
    }
}
