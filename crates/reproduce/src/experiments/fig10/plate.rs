//! The zone plate `sin(x^2 + y^2)`: rendered from samples, exactly filtered, and the difference of the two. The exact
//! image does not depend on samples.

use std::f64::consts::PI;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::filter::{Filtered, MARGIN, SIGMA, error_shade, gaussian, shade};
use super::samplers::Sampler;
use crate::control::Control;
use crate::error::Result;
use crate::study::Settings;

/// Local frequency at the right and the upper edge, in cycles per pixel; the image's own Nyquist frequency is 1/2.
pub const EDGE: f64 = 1.5;
/// The image's Nyquist frequency: errors below it are noise, above it aliasing as well.
pub const NYQUIST: f64 = 0.5;
/// Width of the classes of local frequency, in cycles per pixel. Chosen, not measured.
const CLASS: f64 = 0.05;
/// A class of fewer pixels is left out: its error would be mostly chance. Chosen, not measured.
const MIN_PIXELS: f64 = 40.0;

/// A zone plate about the lower left corner of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plate {
    /// Pixels along a side.
    pub side: usize,
}

impl Plate {
    fn step(self) -> f64 {
        (PI * EDGE / self.side as f64).sqrt()
    }

    /// Returns the value at a place, in pixels from the upper left corner.
    fn value(self, at: [f64; 2]) -> f64 {
        let [x, y] = [at[0], self.side as f64 - at[1]].map(|v| v * self.step());
        (x * x + y * y).sin()
    }

    /// Returns the local frequency at the centre of a pixel, in cycles per pixel.
    fn frequency(self, index: usize) -> f64 {
        let [x, y] = [index % self.side, self.side - 1 - index / self.side].map(|v| v as f64 + 0.5);
        self.step().powi(2) * x.hypot(y) / PI
    }

    /// Returns the zone plate filtered by a Gaussian that goes on for ever.
    ///
    /// A Gaussian's mean of `exp(i x^2)` about `c` is `exp(i c^2 / (1 - i q)) / sqrt(1 - i q)` with `q` twice the variance: along
    /// each axis an amplitude and a phase.
    pub fn exact(self) -> Vec<f64> {
        let axis: Vec<[f64; 2]> = (0..self.side)
            .map(|pixel| mean_of_chirp((pixel as f64 + 0.5) * self.step(), SIGMA * self.step()))
            .collect();
        (0..self.side * self.side)
            .into_par_iter()
            .map(|index| {
                let [a, p] = axis[index % self.side];
                let [b, q] = axis[self.side - 1 - index / self.side];
                a * b * (p + q).sin()
            })
            .collect()
    }

    /// Returns the image that samples of the unit square give; they reach beyond it on all sides.
    fn render(self, points: &[[f64; 2]]) -> Filtered {
        let scale = (self.side + 2 * MARGIN) as f64;
        let placed: Vec<[f64; 2]> = points
            .iter()
            .map(|at| at.map(|v| v * scale - MARGIN as f64))
            .collect();
        gaussian(&placed, |at| self.value(at), self.side)
    }
}

/// Returns amplitude and phase of the mean of `exp(i x^2)` under a Gaussian about `center`.
fn mean_of_chirp(center: f64, deviation: f64) -> [f64; 2] {
    let q = 2.0 * deviation * deviation;
    let spread = 1.0 + q * q;
    let squared = center * center / spread;
    [
        (-squared * q).exp() / spread.powf(0.25),
        squared + 0.5 * q.atan(),
    ]
}

/// How wrong an image is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlateErrors {
    /// Index of the set.
    pub index: u64,
    pub count: usize,
    pub side: usize,
    /// Pixels without a sample in reach.
    pub empty: usize,
    pub rmse: f64,
    /// Where the local frequency is below and above the image's Nyquist frequency.
    pub below: f64,
    pub above: f64,
    /// Mean squared exact value over mean squared error, in decibels.
    pub signal_db: f64,
    /// Middle of each class of local frequency, and the error there.
    pub classes: Vec<[f64; 2]>,
    /// Shades of the image and of the error, of the first set alone.
    pub shades: Option<[Vec<u8>; 2]>,
}

/// A sum of squares and how many.
type Squares = (f64, f64);

fn add((sum, count): &mut Squares, value: f64) {
    *sum += value * value;
    *count += 1.0;
}

fn root((sum, count): Squares) -> f64 {
    (sum / count.max(1.0)).sqrt()
}

/// Returns the zone plate, samples of a set, and sets.
pub fn amounts(settings: &Settings) -> (Plate, usize, u64) {
    let (count, side, sets) = settings.pick((1_000_000, 512, 5), (62_500, 128, 3));
    (Plate { side }, count, sets)
}

/// Renders a zone plate from the set number `index` of about `count` samples, and returns how wrong the image is.
pub fn errors(
    sampler: Sampler,
    count: usize,
    index: u64,
    plate: Plate,
    settings: &Settings,
    control: &Control<'_>,
) -> Result<PlateErrors> {
    let points = sampler.points(count, index, settings, control)?;
    control.go_on()?;

    let exact = plate.exact();
    let image = plate.render(&points);
    let pairs = image.values.iter().zip(&exact);
    let differences: Vec<f64> = pairs.map(|(found, wanted)| found - wanted).collect();

    let shades = || {
        let result = image.values.iter().map(|v| shade(*v)).collect();
        [
            result,
            differences.iter().map(|v| error_shade(*v)).collect(),
        ]
    };

    Ok(PlateErrors {
        index,
        count: points.len(),
        empty: image.empty,
        // Shades are kept only of the set that is shown.
        shades: (index == 0).then(shades),
        ..measured(plate, &exact, &differences)
    })
}

/// Returns the errors of an image as numbers: in all, below and above the Nyquist frequency, and by local frequency.
fn measured(plate: Plate, exact: &[f64], errors: &[f64]) -> PlateErrors {
    // Frequencies grow along both axes, so that the corner has the highest.
    let highest = EDGE * std::f64::consts::SQRT_2;
    let mut classes = vec![Squares::default(); (highest / CLASS).ceil() as usize];
    let [mut below, mut above, mut all, mut signal] = [Squares::default(); 4];

    for (index, (error, wanted)) in errors.iter().zip(exact).enumerate() {
        let frequency = plate.frequency(index);
        let class = ((frequency / CLASS) as usize).min(classes.len() - 1);

        let part = if frequency < NYQUIST {
            &mut below
        } else {
            &mut above
        };
        for squares in [&mut classes[class], part, &mut all] {
            add(squares, *error);
        }
        add(&mut signal, *wanted);
    }

    // Few pixels, as at the corner, say too little about the error at their frequency.
    let full = classes
        .iter()
        .enumerate()
        .filter(|(_, (_, pixels))| *pixels >= MIN_PIXELS);
    let middle = |class: usize| (class as f64 + 0.5) * CLASS;

    PlateErrors {
        side: plate.side,
        rmse: root(all),
        below: root(below),
        above: root(above),
        signal_db: 20.0 * (root(signal) / root(all)).log10(),
        classes: full
            .map(|(class, squares)| [middle(class), root(*squares)])
            .collect(),
        // The caller fills in the facts about the set.
        ..PlateErrors::default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::filter::{CUT_OFF, REACH};
    use super::*;
    use crate::study::tests::alone;

    /// The filtered value by summing over a fine grid, to the end of the reach.
    fn quadrature(plate: Plate, index: usize) -> f64 {
        const STEPS: i32 = 400;
        let center = [index % plate.side, index / plate.side].map(|v| v as f64 + 0.5);
        let offsets = (-STEPS..=STEPS).map(|k| f64::from(k) * REACH / f64::from(STEPS));
        let weight = |away: f64| (-0.5 * (away / SIGMA).powi(2)).exp();
        let mut sums = [0.0; 2];
        for dy in offsets.clone() {
            for dx in offsets.clone() {
                let both = weight(dx) * weight(dy);
                sums[0] += both * plate.value([center[0] + dx, center[1] + dy]);
                sums[1] += both;
            }
        }
        sums[0] / sums[1]
    }

    #[test]
    fn the_exact_image_is_what_quadrature_gives() {
        let plate = Plate { side: 64 };
        let exact = plate.exact();
        for index in [
            0,
            63,
            64 * 63,
            64 * 64 - 1,
            64 * 40 + 9,
            64 * 55 + 12,
            64 * 60,
        ] {
            let found = quadrature(plate, index);
            let off = (exact[index] - found).abs();
            assert!(off < CUT_OFF, "{index}: {} and {found}", exact[index]);
        }
        // Without the filter, values are quite others.
        let raw = plate.value([12.5, 55.5]);
        assert!((raw - exact[64 * 55 + 12]).abs() > 0.01);
    }

    #[test]
    fn frequencies_are_those_of_the_phase() {
        let plate = Plate { side: 100 };
        assert!((plate.frequency(99 * 100 + 99) - EDGE * 0.995).abs() < 1e-3);
        let phase = |x: f64| (x * plate.step()).powi(2);
        let cycles = (phase(40.0 + 0.5) - phase(39.0 + 0.5)) / (2.0 * PI);
        assert!((plate.frequency(99 * 100 + 39) - cycles).abs() < 1e-2);
    }

    #[test]
    fn errors_fall_with_samples_and_threads_change_nothing() {
        let settings = Settings::default();
        alone(&settings, |control| {
            let plate = Plate { side: 64 };
            let rendered = |count, sampler| errors(sampler, count, 0, plate, &settings, control);
            for sampler in [Sampler::Random, Sampler::Jittered, Sampler::Kdrt] {
                let (few, many) = (rendered(10_000, sampler)?, rendered(160_000, sampler)?);
                assert!(
                    many.rmse < 0.6 * few.rmse,
                    "{sampler:?}: {} {}",
                    few.rmse,
                    many.rmse
                );
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(1)
                    .build()
                    .unwrap();
                let alone = pool.install(|| rendered(10_000, sampler))?;
                assert_eq!(alone, few, "{sampler:?}");
            }
            Ok(())
        });
    }
}
