//! The periodogram of a point set on the integer frequencies of the unit torus, by direct sums.
//! `P(k) = |sum exp(-2 pi i k.x)|^2 / N` with coordinates divided by the extents; mean 1 for noise.
//! It never includes the zero frequency, which holds the sample count and no structure.
//!
//! The cost is `N` times the number of frequencies: a reference for small sets and for faster
//! transforms, exact to about `1e-15` times the frequency per sample.

use std::f64::consts::TAU;

use rayon::prelude::*;

/// Samples that advance through the frequencies of a row together, as many as hide the latency of
/// the rotations.
const LANES: usize = 8;

/// The mean power of an annulus of integer frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadialBin {
    /// Mean `|k|` of its frequencies: the centre of the bin on the axis.
    pub frequency: f64,
    /// Mean of `P(k)`.
    pub power: f64,
    /// Number of frequencies, both of each pair `k` and `-k`.
    pub count: u64,
}

/// Returns the power `P(k)` at one integer frequency, straight from the definition.
///
/// Zero for an empty set; `N` at the zero frequency.
///
/// ```
/// use tilescope_analysis::spectrum::power;
///
/// // Two samples half a period apart: silent at odd frequencies along x, in phase at even ones.
/// let points = [[0.0, 0.0], [0.5, 0.0]];
/// assert!(power(&points, 1.0, 1.0, [1, 0]) < 1e-30);
/// assert!((power(&points, 1.0, 1.0, [2, 0]) - 2.0).abs() < 1e-14);
/// ```
#[must_use]
pub fn power(points: &[[f64; 2]], width: f64, height: f64, frequency: [i64; 2]) -> f64 {
    let [kx, ky] = frequency.map(|k| k as f64);
    let sum = points.iter().fold([0.0; 2], |sum, point| {
        let [re, im] = unit(kx * (point[0] / width) + ky * (point[1] / height));
        [sum[0] + re, sum[1] + im]
    });
    squared(sum) / points.len().max(1) as f64
}

/// Returns the mean power of the annuli `j - 1/2 <= |k| < j + 1/2` for `j` from 1 to `max_frequency`.
///
/// Frequencies are integer multiples of `1 / width` and `1 / height`, and `|k|` is the length of the
/// integer vector. The result does not depend on the number of threads. It is empty for an empty set.
#[must_use]
pub fn radial_mean_power(
    points: &[[f64; 2]],
    width: f64,
    height: f64,
    max_frequency: usize,
) -> Vec<RadialBin> {
    if points.is_empty() {
        return Vec::new();
    }
    let samples: Vec<[f64; 2]> = (points.iter())
        .map(|point| [point[0] / width, point[1] / height])
        .collect();
    // P(-k) = P(k): rows kx >= 0 do. Frequencies up to max_frequency + 1/2 have |kx| <= max_frequency.
    let rows: Vec<Vec<Sum>> = (0..=max_frequency)
        .into_par_iter()
        .map(|kx| row_sums(&samples, kx, max_frequency))
        .collect();
    let mut sums = vec![Sum::default(); max_frequency + 1];
    for row in &rows {
        for (sum, part) in sums.iter_mut().zip(row) {
            sum.power += part.power;
            sum.frequency += part.frequency;
            sum.count += part.count;
        }
    }
    sums[1..].iter().map(|sum| sum.bin(points.len())).collect()
}

/// Running sums of an annulus.
#[derive(Clone, Copy, Default)]
struct Sum {
    power: f64,
    frequency: f64,
    count: u64,
}

impl Sum {
    fn bin(&self, samples: usize) -> RadialBin {
        let count = self.count as f64;
        RadialBin {
            frequency: self.frequency / count,
            power: self.power / (count * samples as f64),
            count: self.count,
        }
    }
}

/// Sums of `|F(kx, ky)|^2` by annulus for one `kx`, its mirror row included.
fn row_sums(samples: &[[f64; 2]], kx: usize, max_frequency: usize) -> Vec<Sum> {
    let mut sums = vec![Sum::default(); max_frequency + 1];
    let transform = row_transform(samples, kx, max_frequency);
    for (index, value) in transform.into_iter().enumerate() {
        let ky = index as f64 - max_frequency as f64;
        // Row zero is its own mirror: taking both halves of it counts each pair twice already.
        let weight = if kx == 0 { 1 } else { 2 };
        let frequency = (kx as f64).hypot(ky);
        let annulus = (frequency + 0.5).floor() as usize;
        if let Some(sum) = sums.get_mut(annulus) {
            sum.power += weight as f64 * squared(value);
            sum.frequency += weight as f64 * frequency;
            sum.count += weight;
        }
    }
    sums
}

/// `sum exp(-2 pi i (kx x + ky y))` for `ky` from `-max_frequency` to `max_frequency`.
fn row_transform(samples: &[[f64; 2]], kx: usize, max_frequency: usize) -> Vec<[f64; 2]> {
    let mut sums = vec![[0.0; 2]; 2 * max_frequency + 1];
    for block in samples.chunks(LANES) {
        // Lanes without a sample stay zero and add nothing.
        let mut phase = [[0.0; LANES]; 2];
        let mut step = [[0.0; LANES]; 2];
        for (lane, [x, y]) in block.iter().enumerate() {
            let [re, im] = unit(kx as f64 * x - max_frequency as f64 * y);
            (phase[0][lane], phase[1][lane]) = (re, im);
            let [re, im] = unit(*y);
            (step[0][lane], step[1][lane]) = (re, im);
        }
        for sum in &mut sums {
            sum[0] += phase[0].iter().sum::<f64>();
            sum[1] += phase[1].iter().sum::<f64>();
            for lane in 0..LANES {
                let (re, im) = (phase[0][lane], phase[1][lane]);
                phase[0][lane] = re * step[0][lane] - im * step[1][lane];
                phase[1][lane] = re * step[1][lane] + im * step[0][lane];
            }
        }
    }
    sums
}

/// `exp(-2 pi i turns)`; whole turns are removed first, exactly.
fn unit(turns: f64) -> [f64; 2] {
    let (sin, cos) = (TAU * (turns - turns.round())).sin_cos();
    [cos, -sin]
}

fn squared([re, im]: [f64; 2]) -> f64 {
    re * re + im * im
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(columns: u32, rows: u32) -> Vec<[f64; 2]> {
        (0..columns * rows)
            .map(|i| [f64::from(i % columns), f64::from(i / columns)])
            .collect()
    }

    /// Uniform samples from a multiplicative generator.
    fn noise(count: usize) -> Vec<[f64; 2]> {
        let mut state = 0x9E37_79B9_7F4A_7C15_u64;
        let mut uniform = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..count).map(|_| [uniform(), uniform()]).collect()
    }

    #[test]
    fn a_lattice_peaks_at_its_reciprocal_lattice_and_nowhere_else() {
        let (columns, rows) = (8, 5);
        let points = lattice(columns, rows);
        let extent = [f64::from(columns), f64::from(rows)];
        for kx in -17..=17 {
            for ky in -17..=17 {
                let peak = kx % i64::from(columns) == 0 && ky % i64::from(rows) == 0;
                let expected = if peak { f64::from(columns * rows) } else { 0.0 };
                let found = power(&points, extent[0], extent[1], [kx, ky]);
                assert!((found - expected).abs() < 1e-9, "{kx} {ky}: {found}");
            }
        }
    }

    /// The two computations share only the phase of a sample.
    #[test]
    fn annuli_are_the_means_of_the_definition() {
        let (points, most) = (noise(101), 12_i64);
        let scaled: Vec<_> = points.iter().map(|[x, y]| [3.0 * x, 0.5 * y]).collect();
        let bins = radial_mean_power(&scaled, 3.0, 0.5, most as usize);
        assert_eq!(bins.len(), most as usize);
        for (bin, j) in bins.iter().zip(1..) {
            let (mut sum, mut length, mut count) = (0.0, 0.0, 0);
            for kx in -most..=most {
                for ky in -most..=most {
                    let k = ((kx * kx + ky * ky) as f64).sqrt();
                    if k >= f64::from(j) - 0.5 && k < f64::from(j) + 0.5 {
                        sum += power(&scaled, 3.0, 0.5, [kx, ky]);
                        length += k;
                        count += 1;
                    }
                }
            }
            assert_eq!(bin.count, count);
            assert!((bin.power - sum / count as f64).abs() < 1e-11);
            assert!((bin.frequency - length / count as f64).abs() < 1e-12);
        }
    }

    #[test]
    fn noise_has_power_one_without_the_zero_frequency() {
        let bins = radial_mean_power(&noise(4096), 1.0, 1.0, 40);
        let frequencies: u64 = bins.iter().map(|bin| bin.count).sum();
        let total: f64 = bins.iter().map(|bin| bin.power * bin.count as f64).sum();
        // The powers are exponential of mean 1, in equal pairs: five standard deviations.
        let slack = 5.0 * (2.0 / frequencies as f64).sqrt();
        assert!((total / frequencies as f64 - 1.0).abs() < slack);
    }

    #[test]
    fn a_lattice_is_silent_below_its_first_peak() {
        let bins = radial_mean_power(&lattice(16, 16), 16.0, 16.0, 16);
        assert!(bins[..15].iter().all(|bin| bin.power < 1e-20));
        // Four of the frequencies near 16 are peaks of height N.
        let last = bins[15];
        assert!((last.power - 4.0 * 256.0 / last.count as f64).abs() < 1e-9);
    }

    #[test]
    fn nothing_asked_nothing_given() {
        assert!(radial_mean_power(&[], 1.0, 1.0, 8).is_empty());
        assert!(radial_mean_power(&[[0.5, 0.5]], 1.0, 1.0, 0).is_empty());
    }
}
