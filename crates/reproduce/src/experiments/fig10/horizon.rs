//! An infinite checkerboard up to its horizon: rendered from samples, and integrated exactly over each pixel.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::filter::{pixel_means, shade};
use super::samplers::Sampler;
use crate::control::Control;
use crate::error::Result;
use crate::study::Settings;

/// Height of the eye above the board, in cells.
const EYE: f64 = 8.0;
/// One row of pixels in this many lies above the horizon.
const SKY: usize = 8;
/// Within this many pixels below the horizon nothing is integrated, which leaves out at most [`LEFT_OUT`] of a pixel.
const CUT: f64 = 1.0 / 32.0;
/// The largest share of a pixel that [`CUT`] leaves out.
pub const LEFT_OUT: f64 = CUT * CUT / (2.0 * EYE);
/// Samples per pixel of the images that are shown.
pub const SHOWN: usize = 4;

/// A square image of the board: cells are 1 and -1, the sky is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon {
    /// Pixels along a side, and the focal length.
    pub side: usize,
}

impl Horizon {
    fn sky(self) -> usize {
        self.side / SKY
    }

    /// Returns the distance along the board times pixels below the horizon, in cells.
    fn depth(self) -> f64 {
        EYE * self.side as f64
    }

    /// Returns the value at a place, in pixels from the upper left corner.
    fn value(self, at: [f64; 2]) -> f64 {
        let below = at[1] - self.sky() as f64;
        if below <= 0.0 {
            return 0.0;
        }
        let x = EYE * (at[0] - 0.5 * self.side as f64) / below;
        wave(x.floor() + (self.depth() / below).floor())
    }

    /// Returns the mean over each pixel. Exact but for rounding and, in the first row below the horizon, for what [`CUT`] says.
    pub fn exact(self) -> Vec<f64> {
        let row = |row: usize| {
            let Some(below) = row.checked_sub(self.sky()) else {
                return vec![0.0; self.side];
            };
            let ends = [below as f64, below as f64 + 1.0];
            let edge = |column: usize| self.left_of(column as f64 - 0.5 * self.side as f64, ends);
            let edges: Vec<f64> = (0..=self.side).map(edge).collect();
            edges.windows(2).map(|pair| pair[1] - pair[0]).collect()
        };
        let rows: Vec<Vec<f64>> = (0..self.side).into_par_iter().map(row).collect();
        rows.concat()
    }

    /// Returns the integral of the board between the middle of the image and `u` pixels right of it, and between two distances
    /// `v` below the horizon.
    ///
    /// Along a row it is `v / EYE` times a triangle wave of `EYE u / v`. Where neither that nor the wave along the board turns,
    /// this is linear in `v`, so that the value in the middle of such a piece is its mean.
    fn left_of(self, u: f64, [near, far]: [f64; 2]) -> f64 {
        let end = near.max(CUT);
        let across = (EYE * u).abs();
        let mut from = far;
        let mut sum = 0.0;
        while from > end {
            let to = turn(self.depth(), from).max(turn(across, from)).max(end);
            let v = f64::midpoint(from, to);
            let along = wave((self.depth() / v).floor());
            sum += (from - to) * along * v / EYE * triangle(EYE * u / v);
            from = to;
        }
        sum
    }

    /// Returns how wrong the image is that the samples of a set in the unit square give.
    fn errors(
        self,
        index: u64,
        per_pixel: usize,
        points: &[[f64; 2]],
        exact: &[f64],
    ) -> HorizonErrors {
        let side = self.side;
        let placed: Vec<[f64; 2]> = points
            .iter()
            .map(|at| at.map(|v| v * side as f64))
            .collect();

        let image = pixel_means(&placed, |at| self.value(at), side);
        // The sky has no error: with it the mean error would look smaller than that of the board.
        let board = self.sky() * side..;
        let pairs = image.values[board.clone()].iter().zip(&exact[board]);
        let squares: f64 = pairs.clone().map(|(a, b)| (a - b).powi(2)).sum();

        // Shades are kept only of the set that is shown.
        let shown = index == 0 && per_pixel == SHOWN;
        HorizonErrors {
            index,
            per_pixel,
            count: points.len(),
            rmse: (squares / pairs.len() as f64).sqrt(),
            // Of all pixels, those of the sky too: they get as many samples.
            empty: image.empty as f64 / (side * side) as f64,
            shades: shown.then(|| image.values.iter().map(|v| shade(*v)).collect()),
        }
    }
}

/// Returns the largest `v` below `from` at which `quotient / v` is a whole number; 0 if there is none.
fn turn(quotient: f64, from: f64) -> f64 {
    let next = (quotient / from).floor() + 1.0;
    let at = quotient / next;
    // If `from` is such a place itself, rounding may give it again.
    if at < from {
        at
    } else {
        quotient / (next + 1.0)
    }
}

/// 1 in even cells, -1 in odd ones.
fn wave(cell: f64) -> f64 {
    1.0 - 2.0 * (cell - 2.0 * (0.5 * cell).floor())
}

/// The integral of the wave from zero: 0 at even numbers, 1 at odd ones.
fn triangle(at: f64) -> f64 {
    1.0 - (at - 2.0 * (0.5 * at).floor() - 1.0).abs()
}

/// How wrong the image of a set is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HorizonErrors {
    /// Index of the set.
    pub index: u64,
    pub per_pixel: usize,
    pub count: usize,
    /// Root of the mean squared error of the pixels below the horizon.
    pub rmse: f64,
    /// Share of pixels without a sample.
    pub empty: f64,
    /// Shades of the image, of the first set and [`SHOWN`] samples alone.
    pub shades: Option<Vec<u8>>,
}

pub fn per_pixel(settings: &Settings) -> &'static [usize] {
    settings.pick(&[1, 2, 4, 8, 16], &[1, 4, 16])
}

/// Returns the image and how many sets render it.
pub fn amounts(settings: &Settings) -> (Horizon, u64) {
    let (side, sets) = settings.pick((256, 5), (128, 3));
    (Horizon { side }, sets)
}

/// Returns the errors of the images of a sampler's sets.
pub fn errors(
    sampler: Sampler,
    per_pixel: usize,
    horizon: Horizon,
    sets: u64,
    settings: &Settings,
    control: &Control<'_>,
) -> Result<Vec<HorizonErrors>> {
    // One exact image serves all sets.
    let exact = horizon.exact();
    let one = |index| {
        let count = per_pixel * horizon.side * horizon.side;
        let points = sampler.points(count, index, settings, control)?;
        Ok(horizon.errors(index, per_pixel, &points, &exact))
    };
    // A regular grid has only one set.
    (0..sampler.sets(sets)).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::tests::alone;

    /// The mean of a pixel over a grid of places, and what such a sum may be off by where edges cross the pixel.
    fn summed(horizon: Horizon, index: usize, steps: usize) -> f64 {
        let corner = [index % horizon.side, index / horizon.side].map(|v| v as f64);
        let mut sum = 0.0;
        for k in 0..steps * steps {
            let at = [k % steps, k / steps].map(|v| (v as f64 + 0.5) / steps as f64);
            sum += horizon.value([corner[0] + at[0], corner[1] + at[1]]);
        }
        sum / (steps * steps) as f64
    }

    #[test]
    fn the_integral_is_what_a_fine_grid_gives() {
        let horizon = Horizon { side: 64 };
        let exact = horizon.exact();
        for index in [
            64 * 8 + 40,
            64 * 9 + 5,
            64 * 12 + 33,
            64 * 20,
            64 * 40 + 63,
            64 * 63 + 31,
        ] {
            let found = summed(horizon, index, 1500);
            assert!(
                (exact[index] - found).abs() < 2e-3,
                "{index}: {} {found}",
                exact[index]
            );
        }
        assert!(exact[..64 * 8].iter().all(|v| *v == 0.0));
        assert!(exact.iter().all(|v| v.abs() < 1.0 + 1e-9));
        assert!(exact.iter().any(|v| *v > 0.999) && exact.iter().any(|v| *v < -0.999));
    }

    #[test]
    fn a_finer_image_has_the_same_means() {
        // Four pixels of the finer image are one of the coarser: an error anywhere would show.
        let (coarse, fine) = (Horizon { side: 64 }.exact(), Horizon { side: 128 }.exact());
        for row in 8..64 {
            for column in 0..64 {
                let at = |dx: usize, dy: usize| fine[(2 * row + dy) * 128 + 2 * column + dx];
                let mean = 0.25 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1));
                let off = (mean - coarse[64 * row + column]).abs();
                let bound = if row == 8 { 1e-4 } else { 1e-9 };
                assert!(off < bound, "{column} {row}: {off}");
            }
        }
    }

    #[test]
    fn errors_fall_with_samples() {
        let settings = Settings::default();
        alone(&settings, |control| {
            for sampler in [Sampler::Random, Sampler::Jittered, Sampler::Kdrt] {
                let rmse = |per_pixel| -> Result<f64> {
                    let horizon = Horizon { side: 64 };
                    let made = || errors(sampler, per_pixel, horizon, 1, &settings, control);
                    let found = made()?;
                    assert_eq!(found, made()?);
                    Ok(found[0].rmse)
                };
                assert!(rmse(16)? < 0.6 * rmse(2)?, "{sampler:?}");
            }
            Ok(())
        });
    }
}
