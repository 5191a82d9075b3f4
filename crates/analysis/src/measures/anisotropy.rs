//! The anisotropy of a whole profile above that of noise, and how far chance alone takes it.

use super::radial::{Annulus, RadialProfile, anisotropy_reference_db};
use super::statistics::Summary;

/// Frequencies, of each opposite pair one, that an annulus must have for its anisotropy to count: a variance of few
/// is biased. Chosen, not measured.
const MIN_PAIRS: u64 = 100;
/// How many standard deviations hold a normal variable with probability 95 %, and 99 %.
const NORMAL: [f64; 2] = [1.959_964, 2.575_829];

impl Annulus {
    /// Whether it has frequencies enough for its anisotropy to count.
    #[must_use]
    pub fn has_anisotropy(&self) -> bool {
        self.count >= 2 * MIN_PAIRS && self.anisotropy_db.is_finite()
    }

    /// Returns where its anisotropy lies with probability 95 % if the sets have no preferred directions, in decibels.
    #[must_use]
    pub fn anisotropy_noise_db(&self, sets: u64) -> [f64; 2] {
        let reach = NORMAL[0] * noise_deviation(self, sets);
        [-reach, reach].map(|off| 10.0 * (1.0 + off).log10() + anisotropy_reference_db(sets))
    }
}

impl RadialProfile {
    /// Returns how far the anisotropy lies above that of noise, in decibels: all annuli alike. NaN where none counts.
    #[must_use]
    pub fn anisotropy_excess_db(&self) -> f64 {
        let annuli = self
            .annuli
            .iter()
            .filter(|annulus| annulus.has_anisotropy());
        let ratios = annuli.map(|annulus| 10_f64.powf(0.1 * annulus.anisotropy_db));
        let mean = Summary::of(ratios).map_or(f64::NAN, |summary| summary.mean);
        10.0 * mean.log10() - anisotropy_reference_db(self.sets)
    }

    /// Returns a bound in decibels: if the sets have no preferred directions, [`Self::anisotropy_excess_db`] lies
    /// nearer to zero with probability 99 %. NaN where no annulus counts.
    #[must_use]
    pub fn anisotropy_excess_reach_db(&self) -> f64 {
        let annuli = self
            .annuli
            .iter()
            .filter(|annulus| annulus.has_anisotropy());
        let [variances, count] = annuli.fold([0.0; 2], |[variances, count], annulus| {
            [
                variances + noise_deviation(annulus, self.sets).powi(2),
                count + 1.0,
            ]
        });
        // The variances of the annuli's ratios add up, as these are independent: the root over the count is the
        // standard deviation of their mean. In decibels a ratio of 1 less the reach lies a little farther from zero
        // than one of 1 plus the reach: the difference is of second order, and is left out.
        10.0 * (1.0 + NORMAL[1] * variances.sqrt() / count).log10()
    }
}

/// Standard deviation of variance over squared mean, in parts of it, among independent means of `sets` exponential
/// values: by the moments of the gamma distribution, to first order.
fn noise_deviation(annulus: &Annulus, sets: u64) -> f64 {
    let pairs = 0.5 * annulus.count as f64;
    ((2.0 + 2.0 / sets as f64) / pairs).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile(anisotropy_db: f64, count: u64) -> RadialProfile {
        let annulus = Annulus {
            frequency: 1.0,
            power: 1.0,
            anisotropy_db,
            count,
        };
        RadialProfile {
            annuli: vec![annulus; 25],
            samples: 1000.0,
            sets: 10,
        }
    }

    #[test]
    fn noise_has_no_excess_and_few_frequencies_count_for_nothing() {
        let level = anisotropy_reference_db(10);
        assert!(profile(level, 1000).anisotropy_excess_db().abs() < 1e-12);
        assert!((profile(level + 3.0, 1000).anisotropy_excess_db() - 3.0).abs() < 1e-12);
        assert!(profile(level, 199).anisotropy_excess_db().is_nan());
    }

    #[test]
    fn chance_reaches_less_far_with_more_frequencies() {
        let reach = |count| profile(0.0, count).anisotropy_excess_reach_db();
        // 500 pairs in each of 25 annuli: a relative deviation of sqrt(2.2 / 500) / 5.
        let expected = 10.0 * (1.0 + 2.575_829 * (2.2_f64 / 500.0).sqrt() / 5.0).log10();
        assert!((reach(1000) - expected).abs() < 1e-12);
        assert!(reach(4000) < 0.51 * reach(1000));
        let annulus = profile(0.0, 1000).annuli[0];
        let [low, high] = annulus.anisotropy_noise_db(10);
        let level = anisotropy_reference_db(10);
        assert!(low < level && level < high && high - low < 1.2);
    }
}
