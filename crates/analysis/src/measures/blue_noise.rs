//! Effective Nyquist frequency and oscillation of a radial power curve (Heck, Schloemer and Deussen 2013), and the
//! curve that follows from g(r); psa is a program of Schloemer that measures both. Frequencies are `nu = |k| / sqrt(N)`
//! throughout. Samples enter only by g(r).

use std::f64::consts::{PI, TAU};

use serde::Serialize;

use super::distances::largest_min_distance;
use super::error::MeasureError;
use super::pair_correlation::PairCorrelation;
use super::{check_length, check_rising};
use crate::monitor::Control;
use crate::region::Region;

/// Mean power within a disk at which its radius is the effective Nyquist frequency.
const LOW_POWER: f64 = 0.1;

/// Mean power that psa takes for the end of the low region.
const HALF_POWER: f64 = 0.5;

/// Where psa's search for that end begins, as `nu`.
const SEARCH_FROM: f64 = 0.5;

/// Power that psa takes for 1, where oscillations begin.
const NEARLY_ONE: f64 = 0.98;

/// The length of the range in which oscillations count, as `nu`: ten times half of `sqrt(N)`.
const OSCILLATION_RANGE: f64 = 5.0;

/// How far the pair correlation from which a curve follows reaches, in units of `r_max`, and how many bins it has in a
/// unit.
const MAX_DISTANCE: f64 = 8.0;
const BINS_EACH: f64 = 100.0;
/// The shortest reach that a pair correlation may have: with less, the curve is smoothed until its features are lost.
const NEAREST: f64 = 4.0;

/// Power over frequency, without the zero frequency.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct PowerCurve {
    /// The frequencies `nu`, rising.
    frequencies: Vec<f64>,
    powers: Vec<f64>,
}

impl PowerCurve {
    /// Returns the curve through powers at rising positive frequencies. Where they scatter, as in a radial mean, that adds
    /// to the oscillation and lifts or lowers the powers next to zero: average many sets, or use [`Self::of_samples`].
    ///
    /// # Errors
    ///
    /// [`MeasureError::TooFew`] below two values, [`MeasureError::LengthDiffers`], [`MeasureError::NotRising`] for
    /// frequencies that do not rise from above zero or a power that is not finite.
    pub fn new(frequencies: Vec<f64>, powers: Vec<f64>) -> Result<Self, MeasureError> {
        let count = powers.len();
        check_length("powers of a curve", count, frequencies.len())?;
        if count < 2 {
            return Err(MeasureError::TooFew { count, limit: 2 });
        }

        check_rising("frequencies of a curve", &frequencies, 0.0)?;
        if let Some(index) = powers.iter().position(|power| !power.is_finite()) {
            let (name, value) = ("powers of a curve", powers[index]);
            return Err(MeasureError::NotRising { name, index, value });
        }

        Ok(Self {
            frequencies,
            powers,
        })
    }

    /// Returns the curve of a set from which effective Nyquist frequency and oscillation are read: [`Self::of_pairs`] with `g(r)`
    /// up to eight `r_max`, or half the shorter side, at the frequencies `0.01, 0.02 ... 6`. Unlike a radial mean it hardly
    /// scatters, and its range is the same for any number of samples; what scatter there is adds to the oscillation of sets of a
    /// few hundred. None where half the shorter side is below four `r_max`.
    ///
    /// # Errors
    ///
    /// Those of [`PairCorrelation::of`].
    pub fn of_samples(
        points: &[[f64; 2]],
        region: Region,
        control: Control<'_>,
    ) -> Result<Option<Self>, MeasureError> {
        let r_max = largest_min_distance(points.len(), region.area());
        // A little less than half the shorter side, beyond which `g` is not defined.
        let most = (0.499 * region.shorter_side() / r_max).min(MAX_DISTANCE);
        if most < NEAREST {
            return Ok(None);
        }

        let bins = (BINS_EACH * most).ceil() as usize;
        let pairs = PairCorrelation::of(points, region, most, bins, control)?;
        // Frequencies end at nu = 6: oscillations count over 5 from the first power near 1, which blue noise has below
        // nu = 1.
        let frequencies = (1..=600).map(|i| 0.01 * f64::from(i)).collect();
        Self::of_pairs(&pairs, frequencies).map(Some)
    }

    /// Returns the power at `frequencies` that follows from `g(r)`:
    /// `P(nu) = 1 + 2 pi int (g(s) - 1) J0(2 pi nu s) s w(s) ds`, `s` the distance in units of the mean spacing
    /// `sqrt(area / N)`, `w` a Blackman window that falls to zero at the end of `g`.
    ///
    /// The curve is smoothed over about the inverse of the range of `g`. The bins must be far shorter than a wave:
    /// where 800 bins reach to eight `r_max`, a wave of `nu = 6` is 15 bins long. Unlike psa it takes no absolute
    /// value.
    ///
    /// Among `N` samples `g` tends to `1 + (1 - P(0)) / N`, since all pairs are counted: that is taken off instead of 1, or small
    /// sets would have power at zero by their number alone. [`PairCorrelation::samples`] of 0 stand for any number.
    ///
    /// # Errors
    ///
    /// Those of [`Self::new`].
    pub fn of_pairs(pairs: &PairCorrelation, frequencies: Vec<f64>) -> Result<Self, MeasureError> {
        // Bins are given in units of r_max, and wanted in units of the mean spacing: `largest_min_distance` of one
        // sample to a unit of area.
        let r_max_in_spacings = (2.0 / 3f64.sqrt()).sqrt();
        let (step, bins) = (pairs.bin_width * r_max_in_spacings, pairs.g.len() as f64);

        // Each bin is a ring: the distance of its middle, and its weight in the integral.
        let rings: Vec<[f64; 2]> = (0..pairs.g.len())
            .map(|bin| {
                let s = (bin as f64 + 0.5) * step;
                let phase = PI * (bin as f64 + 0.5) / bins;
                // Blackman's window falls to zero where `g` ends, so that the end makes no waves.
                let window = 0.42 + 0.5 * phase.cos() + 0.08 * (2.0 * phase).cos();
                [s, TAU * s * window * step]
            })
            .collect();

        let far = far_excess(pairs, &rings);
        let weighed: Vec<[f64; 2]> = (rings.iter().zip(&pairs.g))
            .map(|([s, weight], g)| [*s, weight * (g - 1.0 - far)])
            .collect();

        let power = |nu: &f64| {
            let sum: f64 = (weighed.iter())
                .map(|[s, weight]| weight * bessel_j0(TAU * nu * s))
                .sum();
            1.0 + sum
        };

        let powers = frequencies.iter().map(power).collect();
        Self::new(frequencies, powers)
    }

    /// Returns the frequencies `nu`, rising from above zero.
    #[must_use]
    pub fn frequencies(&self) -> &[f64] {
        &self.frequencies
    }

    /// Returns the power at each frequency.
    #[must_use]
    pub fn powers(&self) -> &[f64] {
        &self.powers
    }

    /// Returns the effective Nyquist frequency: the largest `nu` up to which the mean power within every disk
    /// about zero stays below 0.1. As a frequency it is half of that times `sqrt(N)`, so the value compares to the
    /// limit of a square lattice, `sqrt(N) / 2`, as a ratio. Zero for noise; none where the curve ends before.
    #[must_use]
    pub fn effective_nyquist(&self) -> Option<f64> {
        let means = self.disk_means();
        let after = means.iter().position(|mean| *mean >= LOW_POWER)?;
        Some(self.crossing(&means, after))
    }

    /// Returns psa's variant: from the first disk beyond `nu = 1/2` whose mean power exceeds 0.5 back to the last one
    /// below 0.1. It passes over low disks that single strong frequencies lift above 0.1. None where the
    /// mean power never exceeds 0.5.
    #[must_use]
    pub fn effective_nyquist_psa(&self) -> Option<f64> {
        let means = self.disk_means();
        let end = (self.frequencies.iter().zip(&means))
            .position(|(nu, mean)| *nu >= SEARCH_FROM && *mean > HALF_POWER)?;
        let below = means[..end].iter().rposition(|mean| *mean < LOW_POWER);
        Some(below.map_or(0.0, |below| self.crossing(&means, below + 1)))
    }

    /// Returns the oscillation `10 sqrt(mean of (P - 1)^2)` over the ring of frequencies from the first at which the
    /// power is nearly 1 to one that is 5 higher, or to the end of the curve: compare only curves of one range. Zero
    /// for noise, but for its scatter. None where the power never comes near 1, or does so only at the curve's end.
    #[must_use]
    pub fn oscillation(&self) -> Option<f64> {
        let first = self.powers.iter().position(|power| *power >= NEARLY_ONE)?;
        let limit = self.frequencies[first] + OSCILLATION_RANGE;
        let (mut sum, mut area) = (0.0, 0.0);

        for (nu, power) in (self.frequencies.windows(2).zip(self.powers.windows(2))).skip(first) {
            if nu[1] > limit {
                break;
            }

            // The mean is over the area of the ring, by the trapezoidal rule. The factor pi is left out of both sums.
            let ring = nu[1] * nu[1] - nu[0] * nu[0];
            let squares = power.iter().map(|power| (power - 1.0).powi(2)).sum::<f64>();
            sum += 0.5 * squares * ring;
            area += ring;
        }

        (area > 0.0).then(|| 10.0 * (sum / area).sqrt())
    }

    /// The mean power of the disk up to each frequency, by trapezoids; below the first frequency the power counts as
    /// that at it.
    fn disk_means(&self) -> Vec<f64> {
        let (mut before, mut sum) = ([0.0, self.powers[0]], 0.0);
        (self.frequencies.iter().zip(&self.powers))
            .map(|(&nu, &power)| {
                sum += 0.5 * (power + before[1]) * (nu * nu - before[0] * before[0]);
                before = [nu, power];
                sum / (nu * nu)
            })
            .collect()
    }

    /// Where the mean power passes the low level before an index.
    fn crossing(&self, means: &[f64], after: usize) -> f64 {
        let Some(below) = after.checked_sub(1) else {
            return 0.0;
        };
        let part = (LOW_POWER - means[below]) / (means[after] - means[below]);
        let [low, high] = [below, after].map(|index| self.frequencies[index]);
        // The level lies between both means, but for rounding.
        low + part.clamp(0.0, 1.0) * (high - low)
    }
}

/// By how much `g` exceeds 1 far away: the excess `e = (1 - P(0)) / N`. The power at zero depends on it: `P(0) = raw -
/// e W`, where `raw` is the power without it and `W` the sum of the weights. Both equations are solved for `e`.
fn far_excess(pairs: &PairCorrelation, rings: &[[f64; 2]]) -> f64 {
    if pairs.samples == 0 {
        return 0.0;
    }
    let sum = |value: &dyn Fn(usize) -> f64| -> f64 {
        let weights = rings.iter().enumerate();
        weights.map(|(bin, [_, weight])| weight * value(bin)).sum()
    };
    let raw = 1.0 + sum(&|bin| pairs.g[bin] - 1.0);
    // W / N: the part of all samples that the window holds on the average, at most about a fifth.
    let share = sum(&|_| 1.0) / pairs.samples as f64;
    (1.0 - raw) / (1.0 - share) / pairs.samples as f64
}

/// The Bessel function of the first kind of order 0 of a number that is not negative, to about 1e-10: its
/// series, and beyond 14 Hankel's expansion.
fn bessel_j0(x: f64) -> f64 {
    // Below 14 no term of the series exceeds 3e4, so that rounding leaves errors of 1e-11. From 14 on the first term of
    // the expansion that is left out is below 1e-12.
    if x < 14.0 {
        let minus_quarter_square = -0.25 * x * x;
        let (mut sum, mut term, mut k) = (1.0, 1.0, 1.0);
        // Smaller terms are far below the error that is allowed.
        while f64::abs(term) > 1e-18 {
            term *= minus_quarter_square / (k * k);
            sum += term;
            k += 1.0;
        }
        return sum;
    }

    let (mut parts, mut term) = ([0.0; 2], 1.0);
    // The first twenty terms fall, even at 14; later ones of this expansion rise again.
    for k in 0..20_u32 {
        // Even terms are for the cosine below and odd ones for the sine. In each of these two sums the sign changes
        // from one term to the next.
        let sign = if k / 2 % 2 == 0 { 1.0 } else { -1.0 };
        parts[(k % 2) as usize] += sign * term;
        // Terms of the expansion: products of -(2 j - 1)^2 over k! (8 x)^k.
        let odd = f64::from(2 * k + 1);
        term *= -odd * odd / (f64::from(k + 1) * 8.0 * x);
    }

    let (sin, cos) = (x - 0.25 * PI).sin_cos();
    (2.0 / (PI * x)).sqrt() * (parts[0] * cos - parts[1] * sin)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against Bessel's integral, which the midpoint rule gives to all digits.
    #[test]
    fn bessel_is_its_integral() {
        for step in 0..600 {
            let x = 0.1 * f64::from(step);
            let count = 200;
            let sum: f64 = (0..count)
                .map(|i| PI * (f64::from(i) + 0.5) / f64::from(count))
                .map(|angle| (x * angle.sin()).cos())
                .sum();
            let found = bessel_j0(x);
            assert!(
                (found - sum / f64::from(count)).abs() < 3e-10,
                "{x}: {found}"
            );
        }
    }

    /// A power that is off by a constant has ten times it as its oscillation, whatever the frequencies.
    #[test]
    fn oscillation_is_ten_times_the_mean_deviation() {
        let frequencies: Vec<f64> = (1..40)
            .map(|k| 0.1 * f64::from(k) + 0.01 * f64::from(k * k % 7))
            .collect();
        let powers = frequencies.iter().enumerate().map(|(k, _)| match k % 2 {
            0 => 1.2,
            _ => 0.8,
        });
        let curve = PowerCurve::new(frequencies.clone(), powers.collect()).unwrap();
        assert!((curve.oscillation().unwrap() - 2.0).abs() < 1e-12);
    }
}
