//! Differences of curves from a reference, with the band about zero that they keep to where both have one truth.
//! Differences are taken at the first curve's values of x; the reference is interpolated between its own.

use serde::Serialize;

use super::check_range;
use super::distributions::{beta_quantile, student_quantile};
use super::error::MeasureError;
use super::radial::{Annulus, RadialProfile};
use super::statistics::LEVELS;

/// A mean curve with the spread between the sets behind it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeanCurve {
    /// The values of x, rising.
    pub x: Vec<f64>,
    /// The mean at each.
    pub y: Vec<f64>,
    /// Standard errors of the means; none for one set.
    pub errors: Option<Vec<f64>>,
    /// How many sets the curve is a mean of.
    pub sets: u64,
}

/// The difference of a curve from a reference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DifferenceCurve {
    /// Points `[x, value less reference]`, where both curves are known.
    pub points: Vec<[f64; 2]>,
    /// The interval of each difference that holds it with the level's probability where the truth is the same; none
    /// where the spread is not known.
    pub bands: Option<Vec<[f64; 2]>>,
}

impl DifferenceCurve {
    /// Returns the difference of two radial mean powers over `nu`. The band follows from the number of powers behind both alone
    /// ([`power_difference_band`]), so that one set on each side is enough. It is right for periodic sets only: the
    /// taper of bounded ones makes neighbouring powers depend on each other.
    ///
    /// # Errors
    ///
    /// Those of [`power_difference_band`].
    pub fn of_powers(
        profile: &RadialProfile,
        reference: &RadialProfile,
        level: f64,
    ) -> Result<Self, MeasureError> {
        let (own_x, reference_x) = (
            profile.relative_frequencies(),
            reference.relative_frequencies(),
        );
        // A frequency and its opposite have one power, so that half of the frequencies are independent values.
        let values = |annulus: &Annulus, sets: u64| 0.5 * annulus.count as f64 * sets as f64;

        let (mut points, mut bands) = (Vec::new(), Vec::new());
        for (x, annulus) in own_x.into_iter().zip(&profile.annuli) {
            // Where the reference is not known, there is no difference.
            let Some(between) = Between::of(x, &reference_x) else {
                continue;
            };

            let [low, high] = between.ends.map(|end| &reference.annuli[end]);
            let power = between.mean(low.power, high.power);

            // The interpolated value has the variance of a mean of `reference_count` powers: each end has the variance 1 over
            // its number of values, and enters by its share.
            let [a, b] = [low, high].map(|annulus| 1.0 / values(annulus, reference.sets));
            let reference_count =
                1.0 / ((1.0 - between.part).powi(2) * a + between.part.powi(2) * b);
            let counts = [values(annulus, profile.sets), reference_count];

            points.push([x, annulus.power - power]);
            bands.push(power_difference_band(
                [annulus.power, power],
                counts,
                level,
            )?);
        }
        Ok(Self {
            points,
            bands: Some(bands),
        })
    }

    /// Returns the difference of two mean curves. The band is Student's for two means of values of one deviation, which is that
    /// between the sets of both; none where both are of one set.
    ///
    /// # Errors
    ///
    /// [`MeasureError::OutOfRange`] for a level outside 0.01 to 0.999999.
    pub fn of_means(
        curve: &MeanCurve,
        reference: &MeanCurve,
        level: f64,
    ) -> Result<Self, MeasureError> {
        check_range("the confidence level", level, LEVELS)?;
        let sets = [curve.sets, reference.sets].map(|sets| sets as f64);
        // Each mean takes one degree of freedom. One set on each side leaves none, and so no band.
        let freedom = sets[0] + sets[1] - 2.0;
        let quantile = (freedom > 0.0).then(|| student_quantile(1.0 - level, freedom));

        let (mut points, mut bands) = (Vec::new(), Vec::new());
        for (index, (x, y)) in curve.x.iter().zip(&curve.y).enumerate() {
            // Where the reference is not known, there is no difference.
            let Some(between) = Between::of(*x, &reference.x) else {
                continue;
            };
            let at =
                |values: &[f64]| between.mean(values[between.ends[0]], values[between.ends[1]]);
            points.push([*x, y - at(&reference.y)]);

            // A single set has no error of its own: the other side's deviation serves both.
            let errors = [
                curve.errors.as_ref().map_or(0.0, |errors| errors[index]),
                reference.errors.as_deref().map_or(0.0, at),
            ];
            // The squares of deviations from each mean are added up again: error^2 is their sum over n (n - 1).
            let squares: f64 = (errors.iter().zip(sets))
                .map(|(error, n)| error * error * n * (n - 1.0))
                .sum();
            let error = (squares / freedom * (1.0 / sets[0] + 1.0 / sets[1])).sqrt();
            bands.extend(quantile.map(|quantile| [-quantile * error, quantile * error]));
        }
        Ok(Self {
            bands: (freedom > 0.0).then_some(bands),
            points,
        })
    }

    /// Returns the root of the mean square of the differences; none where the curves have no common range.
    #[must_use]
    pub fn rms(&self) -> Option<f64> {
        let squares: f64 = self.points.iter().map(|point| point[1] * point[1]).sum();
        (!self.points.is_empty()).then(|| (squares / self.points.len() as f64).sqrt())
    }

    /// Returns the point with the difference of largest magnitude.
    #[must_use]
    pub fn largest(&self) -> Option<[f64; 2]> {
        let by_size = |a: &&[f64; 2], b: &&[f64; 2]| a[1].abs().total_cmp(&b[1].abs());
        self.points.iter().max_by(by_size).copied()
    }

    /// Returns the share of differences outside their band: about `1 - level` where both curves have one truth.
    #[must_use]
    pub fn outside(&self) -> Option<f64> {
        let bands = self.bands.as_ref().filter(|bands| !bands.is_empty())?;
        let outside = (self.points.iter().zip(bands))
            .filter(|(point, band)| !(band[0]..=band[1]).contains(&point[1]))
            .count();
        Some(outside as f64 / bands.len() as f64)
    }
}

/// Returns the interval that holds the difference of two mean powers, the first less the second, with probability `level` if both
/// are means of `counts` independent exponential powers of one expectation. Given the sum of all powers, the share of
/// it that belongs to the first mean is a beta variable. So the interval is exact for any number of powers.
///
/// # Errors
///
/// [`MeasureError::OutOfRange`] for a level outside 0.01 to 0.999999, or for a number of powers below 0.5 or above 1e8.
pub fn power_difference_band(
    powers: [f64; 2],
    counts: [f64; 2],
    level: f64,
) -> Result<[f64; 2], MeasureError> {
    check_range("the confidence level", level, LEVELS)?;
    for count in counts {
        // An annulus of a single frequency, one of two opposite ones, has half a value.
        check_range("the number of powers", count, [0.5, 1e8])?;
    }

    // A share of the sum of all powers belongs to the first mean, and the rest to the second one.
    let sum = powers[0] * counts[0] + powers[1] * counts[1];
    let tails = [0.5 - 0.5 * level, 0.5 + 0.5 * level];
    Ok(tails.map(|part| {
        let share = beta_quantile(part, counts[0], counts[1]);
        sum * (share / counts[0] - (1.0 - share) / counts[1])
    }))
}

/// Two neighbours among rising values, and how far between them a value lies.
struct Between {
    ends: [usize; 2],
    part: f64,
}

impl Between {
    /// Returns where a value lies among rising ones; none beyond their ends.
    fn of(x: f64, rising: &[f64]) -> Option<Self> {
        let above = rising.partition_point(|value| *value < x);
        let high = *rising.get(above)?;
        // A value that is one of the rising ones needs no neighbour below it: the first one has none.
        if high <= x {
            return Some(Self {
                ends: [above, above],
                part: 0.0,
            });
        }

        let below = above.checked_sub(1)?;
        Some(Self {
            ends: [below, above],
            part: (x - rising[below]) / (high - rising[below]),
        })
    }

    /// Returns the value between two, which are those at the ends.
    fn mean(&self, low: f64, high: f64) -> f64 {
        low + self.part * (high - low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exponential values of mean 1.
    fn exponential(state: &mut u64) -> f64 {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        -(((*state >> 11) as f64 + 1.0) / (1u64 << 53) as f64).ln()
    }

    fn profile(state: &mut u64, scale: f64, sets: u64) -> RadialProfile {
        let annulus = |index: u64| {
            let pairs = 1 + index / 4;
            let values = pairs * sets;
            let sum: f64 = (0..values).map(|_| exponential(state)).sum();
            Annulus {
                frequency: 1.0 + index as f64,
                power: scale * sum / values as f64,
                anisotropy_db: 0.0,
                count: 2 * pairs,
            }
        };
        RadialProfile {
            annuli: (0..100).map(annulus).collect(),
            samples: 100.0,
            sets,
        }
    }

    fn share_outside(scale: f64) -> f64 {
        let state = &mut 7;
        let shares = (0..40).map(|_| {
            let (a, b) = (profile(state, 1.0, 1), profile(state, scale, 3));
            let difference = DifferenceCurve::of_powers(&a, &b, 0.95).unwrap();
            difference.outside().unwrap()
        });
        shares.sum::<f64>() / 40.0
    }

    #[test]
    fn equal_powers_leave_the_band_as_often_as_it_says_and_others_more_often() {
        // 4000 points: five standard deviations are 0.017.
        let equal = share_outside(1.0);
        assert!((equal - 0.05).abs() < 0.017, "{equal}");
        let other = share_outside(2.0);
        assert!(other > 0.3, "{other}");
    }

    #[test]
    fn means_leave_their_band_as_often_as_it_says_and_other_means_more_often() {
        let state = &mut 3;
        let mut normal = || (0..12).map(|_| exponential(state)).sum::<f64>() - 12.0;
        let mut curve = |sets: u64, shift: f64| {
            let mut average = super::super::Average::new(1000);
            for _ in 0..sets {
                let values: Vec<f64> = (0..1000).map(|_| normal() + shift).collect();
                average.add(&values).unwrap();
            }
            MeanCurve {
                x: (0..1000).map(f64::from).collect(),
                y: average.means().to_vec(),
                errors: average.standard_errors(),
                sets,
            }
        };
        let reference = curve(8, 0.0);
        let outside = |curve: &MeanCurve| {
            let found = DifferenceCurve::of_means(curve, &reference, 0.95).unwrap();
            found.outside().unwrap()
        };
        for sets in [1, 5] {
            let (same, other) = (outside(&curve(sets, 0.0)), outside(&curve(sets, 7.0)));
            assert!((same - 0.05).abs() < 0.035, "{sets}: {same}");
            assert!(other > 0.3, "{sets}: {other}");
        }
        let one = curve(1, 0.0);
        let alone = DifferenceCurve::of_means(&one, &curve(1, 0.0), 0.95).unwrap();
        assert_eq!((alone.bands.as_ref(), alone.outside()), (None, None));
    }

    #[test]
    fn differences_are_taken_at_the_first_curves_x() {
        let curve = |x: &[f64], y: &[f64]| MeanCurve {
            x: x.to_vec(),
            y: y.to_vec(),
            errors: None,
            sets: 1,
        };
        let first = curve(&[0.5, 1.0, 2.5, 3.0, 4.0], &[9.0, 5.0, 5.0, 5.0, 9.0]);
        let reference = curve(&[1.0, 2.0, 3.0], &[1.0, 2.0, 7.0]);
        let found = DifferenceCurve::of_means(&first, &reference, 0.95).unwrap();
        assert_eq!(found.points, [[1.0, 4.0], [2.5, 0.5], [3.0, -2.0]]);
        assert_eq!(found.largest(), Some([1.0, 4.0]));
        let rms = found.rms().unwrap();
        assert!((rms - (20.25f64 / 3.0).sqrt()).abs() < 1e-15);
        let apart = DifferenceCurve::of_means(&first, &curve(&[8.0], &[1.0]), 0.95).unwrap();
        assert_eq!((apart.rms(), apart.largest()), (None, None));
    }

    /// With one power each the ratio of exponential values is known: the share of the first is uniform.
    #[test]
    fn single_powers_have_a_uniform_share() {
        let band = power_difference_band([3.0, 1.0], [1.0, 1.0], 0.95).unwrap();
        assert!((band[0] + 3.8).abs() < 1e-12 && (band[1] - 3.8).abs() < 1e-12);
        assert!(power_difference_band([1.0; 2], [0.0, 1.0], 0.95).is_err());
        assert!(power_difference_band([1.0; 2], [1.0, 1.0], 1.0).is_err());
    }
}
