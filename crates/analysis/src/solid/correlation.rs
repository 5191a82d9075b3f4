//! The pair correlation of a set in space: pairs at a distance, over those of noise.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::measures::{MeasureError, check_count, check_range};
use crate::monitor::{Control, Monitor};

use super::SolidError;
use super::error::check_points;
use super::pairs::pairs_by_distance;
use super::region::SolidRegion;

/// The most bins.
const MAX_BINS: usize = 1 << 16;

/// The pair correlation of a set in space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidCorrelation {
    /// How many samples the set has.
    pub samples: usize,
    /// Width of a bin in the unit of the samples; bin `i` is `i width <= distance < (i + 1) width`.
    pub bin_width: f64,
    /// Pairs in each bin, each pair once.
    pub counts: Vec<u64>,
    /// `g` of each bin: 1 for independent uniform samples.
    pub g: Vec<f64>,
}

impl SolidCorrelation {
    /// Returns `g` for distances up to `most`, in the unit of the samples, in bins of equal width.
    ///
    /// `g` is the number of pairs over that expected of as many independent uniform samples. In a bounded region each pair
    /// counts by the inverse of the volume in which its first sample can lie when both are moved together (the translation
    /// correction of Ohser and Stoyan 1981), which makes the mean exact for noise. Time grows with the number of pairs within the
    /// distance. Counts do not depend on the number of threads.
    ///
    /// # Errors
    ///
    /// [`SolidError::Measure`] for a single sample, a distance beyond half the shortest side or below a
    /// millionth of that, and no bins or more than 65,536; points and regions that cannot be judged are refused as by
    /// [`verify_solid`](crate::verify_solid).
    pub fn of(
        points: &[[f64; 3]],
        region: SolidRegion,
        most: f64,
        bins: usize,
        control: Control<'_>,
    ) -> Result<Self, SolidError> {
        check_points(points, region)?;
        let (count, limit) = (points.len(), 2);
        if count < limit {
            return Err(MeasureError::TooFew { count, limit }.into());
        }
        check_count("bins of g(r)", bins, MAX_BINS)?;
        // Up to half the shortest side two samples have one pair of nearest images. Bins need a width: a millionth of
        // the half for all of them together is chosen, not measured.
        let half = 0.5 * region.shortest();
        check_range("the largest distance of g(r)", most, [1e-6 * half, half])?;

        let monitor = Monitor::begin(control, count as u64)?;
        let found = pairs_by_distance(points, &region, most, bins, &monitor)?;

        let (samples, volume) = (count as f64, region.volume());
        let bin_width = most / bins as f64;
        // Noise has N (N - 1) / 2 pairs. At an offset their density is `pairs * room / volume^2`, where `room` is the
        // volume in which a pair with this offset fits. Each pair has the weight `1 / room`, so that `room` drops out.
        // In a periodic region `room` is the whole volume.
        let density = 0.5 * samples * (samples - 1.0) / (volume * volume);
        let shell = |bin: usize| {
            let [inner, outer] = [bin, bin + 1].map(|end| (end as f64 * bin_width).powi(3));
            4.0 / 3.0 * PI * (outer - inner)
        };
        let over_noise = |(bin, weight): (usize, &f64)| weight / (density * shell(bin));
        Ok(Self {
            samples: count,
            bin_width,
            g: found.weights.iter().enumerate().map(over_noise).collect(),
            counts: found.counts,
        })
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::super::spectrum::Random;
    use super::*;
    use crate::region::Boundary;

    /// Scattered points of a box, and the box.
    fn noise(count: usize, boundary: Boundary) -> (Vec<[f64; 3]>, SolidRegion) {
        let [width, height, depth] = [5.0, 6.0, 7.0];
        let region = SolidRegion {
            width,
            height,
            depth,
            boundary,
        };
        let mut random = Random(2017);
        let point = |_| region.size().map(|side| side * random.unit());
        let points = (0..count).map(point).collect();
        (points, region)
    }

    fn of(
        points: &[[f64; 3]],
        region: SolidRegion,
        most: f64,
    ) -> Result<SolidCorrelation, SolidError> {
        SolidCorrelation::of(points, region, most, 10, &|_| ControlFlow::Continue(()))
    }

    #[test]
    fn every_pair_is_counted_once() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let (points, region) = noise(400, boundary);
            let found = of(&points, region, 2.0).unwrap();
            let mut expected = vec![0; 10];
            for (index, &one) in points.iter().enumerate() {
                for &other in &points[..index] {
                    let bin = (region.distance(one, other) / 0.2) as usize;
                    if bin < 10 {
                        expected[bin] += 1;
                    }
                }
            }
            assert_eq!(found.counts, expected);
        }
    }

    /// Near the border of a bounded box a sample has fewer neighbours, for which the correction makes up.
    #[test]
    fn noise_has_the_correlation_1() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let (points, region) = noise(4_000, boundary);
            let found = of(&points, region, 2.0).unwrap();
            let uncorrected = |bin: usize| {
                let pairs = 0.5 * 4_000.0 * 3_999.0 / region.volume();
                let [inner, outer] = [bin, bin + 1].map(|end| (0.2 * end as f64).powi(3));
                found.counts[bin] as f64 / (pairs * 4.0 / 3.0 * PI * (outer - inner))
            };
            for bin in 2..10 {
                // Without borders the counts scatter as those of independent pairs. Beside borders the pairs of one sample
                // have different weights, and the sum over 4,000 samples scatters by a hundredth.
                let chance = match boundary {
                    Boundary::Periodic => 5.0 / (found.counts[bin] as f64).sqrt(),
                    Boundary::Bounded => 0.05,
                };
                assert!(
                    (found.g[bin] - 1.0).abs() < chance,
                    "{bin}: {}",
                    found.g[bin]
                );
            }
            let is_low = uncorrected(9) < 0.8;
            assert_eq!(is_low, boundary == Boundary::Bounded, "{}", uncorrected(9));
        }
    }

    #[test]
    fn too_few_samples_and_distances_too_large_are_refused() {
        let (points, region) = noise(10, Boundary::Bounded);
        let text = of(&points, region, 2.6).unwrap_err().to_string();
        assert!(
            text.starts_with("the largest distance of g(r) is 2.6"),
            "{text}"
        );
        let text = of(&points[..1], region, 2.0).unwrap_err().to_string();
        assert!(
            text.starts_with("the number of samples, 1, is too small"),
            "{text}"
        );
    }
}
