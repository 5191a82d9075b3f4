//! The spectral slope: the exponent b of a power law `P ~ nu^b` through the radial mean of the power at low frequencies. It
//! decides how fast the error falls when functions are averaged over the samples (Pilleboue, Singh, Coeurjolly, Kazhdan and
//! Ostromoukhov, "Variance analysis for Monte Carlo integration", ACM Transactions on Graphics 34 (4), 2015), and is the
//! exponent of the structure factor that physics calls hyperuniform if it is positive down to zero (Torquato, "Hyperuniform
//! states of matter", Physics Reports 745, 2018).
//!
//! It is fitted to the whole range below [`MAX_NU`], not to the limit at zero, of which a set of some thousands of samples has
//! only a few frequencies.

use super::super::radial::RadialProfile;

/// The end of the range as `nu = |k| / sqrt(N)`: half of the frequency around which blue noise has its first peak, so that
/// the rise to the peak is left out. In maximal sets it is 0.42 / r. It needs no radius, so that it serves any set.
const MAX_NU: f64 = 0.5;

/// The fewest rings that are fitted, those of about 300 samples in a square. The slope of noise then scatters by 0.2.
const MIN_RINGS: usize = 8;

/// Power that is taken for none: rounding makes it of the zeros of a lattice, and its logarithm says nothing.
const NO_POWER: f64 = 1e-9;

/// Returns the slope, without unit, by least squares of `ln P` over `ln nu`. `None` if the spectrum has fewer than
/// [`MIN_RINGS`] rings below [`MAX_NU`], ends before it, or has a ring without power there.
pub(super) fn slope(profile: &RadialProfile) -> Option<f64> {
    let frequencies = profile.relative_frequencies();
    frequencies.last().filter(|last| **last >= MAX_NU)?;

    let low: Vec<_> = (frequencies.iter().zip(&profile.annuli))
        .take_while(|(nu, _)| **nu < MAX_NU)
        .map(|(nu, annulus)| (nu.ln(), annulus))
        .collect();
    if low.len() < MIN_RINGS || low.iter().any(|(_, annulus)| annulus.power <= NO_POWER) {
        return None;
    }

    // The logarithm of a mean of n powers has a variance of about 1 / n, so that n is its weight. With equal weights the lowest
    // rings, of four and eight frequencies, would decide the slope.
    let sum = |value: &dyn Fn(f64, f64) -> f64| -> f64 {
        let weighed = low.iter().map(|(x, annulus)| {
            let weight = annulus.count as f64;
            weight * value(*x, annulus.power.ln())
        });
        weighed.sum()
    };
    let weight = sum(&|_, _| 1.0);
    let [mean_x, mean_y] = [sum(&|x, _| x) / weight, sum(&|_, y| y) / weight];

    let covariance = sum(&|x, y| (x - mean_x) * (y - mean_y));
    Some(covariance / sum(&|x, _| (x - mean_x).powi(2)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::{Annulus, MeasuredSet, Part};
    use crate::region::Region;

    /// Rings of a square domain with 1600 samples up to `nu = rings / 40`, with the power that a function gives.
    fn profile(rings: u32, power: impl Fn(f64) -> f64) -> RadialProfile {
        let ring = |k: u32| Annulus {
            frequency: f64::from(k),
            power: power(f64::from(k) / 40.0),
            anisotropy_db: f64::NAN,
            count: 6 * u64::from(k),
        };
        RadialProfile {
            annuli: (1..=rings).map(ring).collect(),
            samples: 1600.0,
            sets: 1,
        }
    }

    /// Returns the slope of a power law whose exponent changes at a frequency.
    fn of_power(below: f64, above: f64, change: f64) -> Option<f64> {
        let exponent = |nu| if nu < change { below } else { above };
        slope(&profile(60, |nu| 0.3 * nu.powf(exponent(nu))))
    }

    #[test]
    fn a_power_law_has_its_exponent() {
        for exponent in [-1.0, 0.0, 0.7, 3.0] {
            let found = of_power(exponent, exponent, 1.0).unwrap();
            assert!((found - exponent).abs() < 1e-9, "{exponent}: {found}");
        }

        // Frequencies beyond the range do not count.
        assert!((of_power(1.0, 3.0, MAX_NU).unwrap() - 1.0).abs() < 1e-9);
        assert!((of_power(1.0, 3.0, 0.8 * MAX_NU).unwrap() - 1.0).abs() > 0.1);
    }

    #[test]
    fn spectra_that_are_too_small_have_none() {
        assert!(slope(&profile(20, |nu| nu)).is_some());
        assert!(slope(&profile(19, |nu| nu)).is_none(), "it ends before");
        assert!(slope(&profile(60, |nu| if nu > 0.2 { nu } else { 0.0 })).is_none());

        let of_samples = |samples| {
            slope(&RadialProfile {
                samples,
                ..profile(60, |nu| nu)
            })
        };
        assert!(of_samples(17f64.powi(2)).is_some());
        assert!(of_samples(16f64.powi(2)).is_none(), "seven rings");
    }

    /// Returns the slopes of sets of 1600 samples: one in each cell of a square grid, or anywhere.
    fn of_sets(is_jittered: bool) -> Vec<f64> {
        let mut state = 1_u64;
        let mut draw = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut place = |cell: u32| {
            let part = draw();
            if is_jittered {
                (f64::from(cell) + part) / 40.0
            } else {
                part
            }
        };

        let mut found = |_| {
            let points: Vec<_> = (0..1600).map(|i| [place(i % 40), place(i / 40)]).collect();
            let mut set = MeasuredSet::new(1600, Region::new([1.0, 1.0], true), None);
            let control = |_| std::ops::ControlFlow::Continue(());
            set.measure(Part::Spectrum, &points, &control).unwrap();
            slope(&set.spectrum.unwrap().profile).unwrap()
        };
        (0..20).map(&mut found).collect()
    }

    /// White noise has equal power everywhere. Of a jittered grid `P = 1 - (sinc nu_x sinc nu_y)^2`, which is nearly
    /// `pi^2 nu^2 / 3` and a little less at the end of the range.
    #[test]
    fn noise_has_no_slope_and_a_jittered_grid_has_nearly_two() {
        let mean = |slopes: &[f64]| slopes.iter().sum::<f64>() / slopes.len() as f64;
        let (noise, jittered) = (of_sets(false), of_sets(true));
        assert!(noise.iter().all(|slope| slope.abs() < 0.4), "{noise:?}");
        assert!(mean(&noise).abs() < 0.1, "{}", mean(&noise));
        let found = mean(&jittered);
        assert!((1.6..2.0).contains(&found), "{found}");
    }
}
