//! Reconstruction of an image from samples: Gaussian weights over the sum of weights, or the mean of each pixel. Values
//! are shown as shades of grey.
//! The same samples give the same bits on any number of threads.

use rayon::prelude::*;

/// Standard deviation of the Gaussian, in pixels.
pub const SIGMA: f64 = 0.5;
/// Beyond this many pixels along an axis the Gaussian is cut off. This loses a share of `erfc(4.5 / sqrt 2)`, 6.8e-6,
/// along each axis: a filtered value of a function between -1 and 1 is off by less than 2.8e-5.
pub const REACH: f64 = 4.5 * SIGMA;
/// The bound of what the end of the Gaussian changes in a value.
pub const CUT_OFF: f64 = 2.8e-5;
/// Whole pixels around an image from which samples contribute.
pub const MARGIN: usize = 3;

/// Rows of pixels that one thread computes at once.
const BAND: usize = 16;
/// Pixels that are looked at for a sample along an axis. A sample reaches the centres of five at most. The sixth is for
/// the case that rounding makes the first a pixel too early.
const TOUCHED: usize = 6;

/// An image, and how many of its pixels have no value of their own.
pub struct Filtered {
    /// The values, row by row.
    pub values: Vec<f64>,
    /// Pixels whose centre no sample reaches; of [`pixel_means`], those that hold no sample.
    pub empty: usize,
}

/// Returns the weighted means of a function at samples, in pixel coordinates, about the centres of `side` x `side` pixels;
/// zero where no sample is in reach of a centre.
pub fn gaussian(
    samples: &[[f64; 2]],
    function: impl Fn([f64; 2]) -> f64 + Sync,
    side: usize,
) -> Filtered {
    let bins = in_bands(samples, side);
    // The bands have one height on any number of threads, and so every sum has one order.
    let bands: Vec<Filtered> = (0..side.div_ceil(BAND))
        .into_par_iter()
        .map(|band| band_of(band, &bins, &function, side))
        // In the sequence of the bands, whichever thread is first.
        .collect();
    Filtered {
        empty: bands.iter().map(|band| band.empty).sum(),
        values: bands.into_iter().flat_map(|band| band.values).collect(),
    }
}

/// Returns the samples that can contribute, by bands of rows; the first and last band hold those outside, too.
fn in_bands(samples: &[[f64; 2]], side: usize) -> Vec<Vec<[f64; 2]>> {
    let bands = side.div_ceil(BAND);
    let mut bins = vec![Vec::new(); bands];
    let reached = -REACH..=side as f64 + REACH;
    for at in samples {
        if at.iter().all(|v| reached.contains(v)) {
            let band = (at[1].max(0.0) / BAND as f64) as usize;
            bins[band.min(bands - 1)].push(*at);
        }
    }
    bins
}

/// Returns the filtered rows of a band.
fn band_of(
    band: usize,
    bins: &[Vec<[f64; 2]>],
    function: &(impl Fn([f64; 2]) -> f64 + Sync),
    side: usize,
) -> Filtered {
    let rows = BAND * band..(BAND * (band + 1)).min(side);
    // For each pixel the sum of the weighed values, and that of the weights.
    let mut sums = vec![[0.0; 2]; rows.len() * side];
    // A sample reaches at most into the next band, as REACH is less than BAND: three bands of samples contribute.
    let near = band.saturating_sub(1)..(band + 2).min(bins.len());

    for at in bins[near].iter().flatten() {
        let (across, down) = (touched(at[0]), touched(at[1]));
        let mut value = None;
        for (row, wy) in down.filter(|(row, _)| rows.contains(row)) {
            // The function is evaluated once for a sample, at its first row in the band, and never if it has none there.
            let value = *value.get_or_insert_with(|| function(*at));
            let line = &mut sums[(row - rows.start) * side..][..side];
            for (column, wx) in across.clone().filter(|(column, _)| *column < side) {
                line[column][0] += wx * wy * value;
                line[column][1] += wx * wy;
            }
        }
    }

    let mean = |[sum, weight]: &[f64; 2]| if *weight > 0.0 { sum / weight } else { 0.0 };
    Filtered {
        values: sums.iter().map(mean).collect(),
        empty: sums.iter().filter(|sum| sum[1] <= 0.0).count(),
    }
}

/// Returns the pixels along an axis whose centres a sample reaches, with their weights. They may lie beyond the upper
/// end of the image.
fn touched(at: f64) -> impl Iterator<Item = (usize, f64)> + Clone {
    let first = (at - REACH - 0.5).ceil() as i64;
    let weights: [f64; TOUCHED] = std::array::from_fn(|index| {
        let away = (first + index as i64) as f64 + 0.5 - at;
        let within = away.abs() <= REACH;
        if within {
            (-0.5 * (away / SIGMA).powi(2)).exp()
        } else {
            0.0
        }
    });
    let pixels = (first..).zip(weights).filter(|(_, weight)| *weight > 0.0);
    pixels.filter_map(|(pixel, weight)| Some((usize::try_from(pixel).ok()?, weight)))
}

/// Returns the mean of a function at the samples in each of `side` x `side` pixels, in pixel coordinates. A pixel
/// without samples takes the value at one sample: the nearest to its centre of those in the smallest square of pixels
/// about it that has any. Without any sample all are 0.
pub fn pixel_means(
    samples: &[[f64; 2]],
    function: impl Fn([f64; 2]) -> f64,
    side: usize,
) -> Filtered {
    let mut pixels = vec![Vec::new(); side * side];
    for at in samples {
        // A sample on the edge behind the last pixel belongs to that pixel.
        let [column, row] = at.map(|v| (v as usize).min(side - 1));
        pixels[row * side + column].push(*at);
    }

    let mut empty = 0;
    let value = |(index, held): (usize, &Vec<[f64; 2]>)| {
        if !held.is_empty() {
            let sum = held.iter().fold(0.0, |sum, at| sum + function(*at));
            return sum / held.len() as f64;
        }
        empty += 1;
        nearest(&pixels, side, index).map_or(0.0, &function)
    };

    Filtered {
        values: pixels.iter().enumerate().map(value).collect(),
        empty,
    }
}

/// Returns the sample nearest to the centre of a pixel, in the smallest square of pixels about it that has one.
fn nearest(pixels: &[Vec<[f64; 2]>], side: usize, index: usize) -> Option<[f64; 2]> {
    let [x, y] = [index % side, index / side];
    let away = |at: &[f64; 2]| {
        let [dx, dy] = [at[0] - x as f64 - 0.5, at[1] - y as f64 - 0.5];
        dx * dx + dy * dy
    };
    (1..side).find_map(|reach| {
        let near = |at: usize| at.saturating_sub(reach)..(at + reach + 1).min(side);
        let around = near(y).flat_map(|row| near(x).map(move |column| row * side + column));
        let held = around.flat_map(|pixel| &pixels[pixel]).copied();
        held.min_by(|a, b| away(a).total_cmp(&away(b)))
    })
}

/// Errors of this size and beyond are black or white.
pub const ERROR_SHOWN: f64 = 0.5;

/// Returns the shade of a value from -1 to 1.
pub fn shade(value: f64) -> u8 {
    (127.5 + 127.5 * value).round().clamp(0.0, 255.0) as u8
}

/// Returns the shade of an error; zero is middle grey.
pub fn error_shade(error: f64) -> u8 {
    shade(error / ERROR_SHOWN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shades_reach_from_black_to_white() {
        assert_eq!([-2.0, -1.0, 0.0, 1.0].map(shade), [0, 0, 128, 255]);
        assert_eq!([-0.5, 0.0, 0.5].map(error_shade), [0, 128, 255]);
    }

    fn samples(side: usize, along: usize) -> Vec<[f64; 2]> {
        let step = (side + 2 * MARGIN) as f64 / along as f64;
        let at = |index: usize| (index as f64 + 0.37) * step - MARGIN as f64;
        (0..along * along)
            .map(|index| [at(index % along), at(index / along)])
            .collect()
    }

    #[test]
    fn a_constant_stays_one() {
        let samples = samples(40, 90);
        for filtered in [
            gaussian(&samples, |_| 0.7, 40),
            pixel_means(&samples[45 * 90..], |_| 0.7, 40),
        ] {
            assert_eq!(filtered.values.len(), 1600);
            assert!(filtered.values.iter().all(|v| (v - 0.7).abs() < 1e-12));
        }
    }

    #[test]
    fn weights_are_those_of_the_gaussian_and_end_at_the_reach() {
        for at in [4.0, 4.25, 4.5, 4.999, 2.1] {
            let reached: Vec<_> = touched(at).collect();
            assert!((4..=5).contains(&reached.len()), "{at}");
            let away = |pixel: usize| pixel as f64 + 0.5 - at;
            let [first, last] = [reached[0].0, reached[reached.len() - 1].0];
            assert!(
                away(first) - 1.0 < -REACH && away(last) + 1.0 > REACH,
                "{at}"
            );
            let peak = reached.iter().fold(0.0_f64, |a, b| a.max(b.1));
            let nearest = ((at - 0.5).round() + 0.5 - at) / SIGMA;
            assert!((peak - (-0.5 * nearest * nearest).exp()).abs() < 1e-12);
        }
    }

    #[test]
    fn filtering_is_what_a_plain_double_loop_gives() {
        let samples = samples(20, 47);
        let function = |at: [f64; 2]| (0.9 * at[0] + 0.2 * at[1] * at[1]).sin();
        let filtered = gaussian(&samples, function, 20);
        for (index, value) in filtered.values.iter().enumerate() {
            let center = [index % 20, index / 20].map(|v| v as f64 + 0.5);
            let mut sums = [0.0; 2];
            for at in &samples {
                let away = [at[0] - center[0], at[1] - center[1]];
                if away.iter().all(|v| v.abs() <= REACH) {
                    let squared = away[0] * away[0] + away[1] * away[1];
                    let weight = (-0.5 * squared / (SIGMA * SIGMA)).exp();
                    sums = [sums[0] + weight * function(*at), sums[1] + weight];
                }
            }
            assert!((value - sums[0] / sums[1]).abs() < 1e-12, "{index}");
        }
        assert_eq!(filtered.empty, 0);
    }

    #[test]
    fn threads_change_no_bit() {
        let samples = samples(100, 300);
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let function = |at: [f64; 2]| (at[0] * at[1]).sin();
            let pool = pool.build().unwrap();
            pool.install(|| gaussian(&samples, function, 100).values)
        };
        assert_eq!(run(1), run(3));
    }

    #[test]
    fn pixels_without_samples_take_the_nearest_and_are_counted() {
        let two = [[0.5, 0.5], [3.4, 0.9]];
        let found = pixel_means(&two, |at| at[0], 4);
        assert_eq!(
            (found.empty, found.values[0], found.values[3]),
            (14, 0.5, 3.4)
        );
        assert_eq!(found.values[4..8], [0.5, 0.5, 3.4, 3.4]);
        assert_eq!(found.values[12..], [0.5, 0.5, 3.4, 3.4]);
        let none = gaussian(&[], |_| 1.0, 4);
        assert_eq!((none.empty, none.values), (16, vec![0.0; 16]));
    }
}
