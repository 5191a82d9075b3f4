//! Single frequencies whose power stands out of the radial mean, as repetition makes them, against the highest that
//! chance allows among all of them. The lowest rings are left out: a mean of few frequencies is not known well enough.

use serde::{Deserialize, Serialize};

use super::distributions::chi_square_quantile;
use super::periodogram::Periodogram;

/// Frequencies, of each opposite pair one, that a ring must have. The mean of 100 exponential powers scatters by a
/// tenth. The number was chosen, not measured.
const MIN_FREQUENCIES: usize = 100;
/// Probability with which chance alone may pass the limit.
const CHANCE: f64 = 0.01;

/// The frequency that stands out most, of a periodogram whose radial mean is smooth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Peaks {
    /// Its power over the radial mean at its frequency.
    pub highest: f64,
    /// The limit that noise exceeds in 1 of 100 cases, with this number of frequencies and sets.
    pub limit: f64,
    /// Frequencies, of each opposite pair one, above the limit.
    pub above: usize,
}

impl Peaks {
    /// Returns the peaks of a mean periodogram.
    #[must_use]
    pub fn of(periodogram: &Periodogram) -> Self {
        let all_rings = rings(periodogram);
        let means: Vec<FrequencyPower> = all_rings.iter().filter_map(|ring| mean(ring)).collect();

        // The mean of a ring of few frequencies is not known well enough for its frequencies to be compared with it. As
        // an end of an interpolation it still serves.
        let large_rings = || {
            let each = all_rings.iter();
            each.filter(|ring| ring.len() >= MIN_FREQUENCIES)
        };
        let frequencies: usize = large_rings().map(Vec::len).sum();
        let limit = highest_by_chance(periodogram.sets as f64, frequencies as f64);

        let ratio = |one: &FrequencyPower| one.power / mean_at(&means, one.length);
        let ratios: Vec<f64> = large_rings().flatten().map(ratio).collect();
        let above = ratios.iter().filter(|ratio| **ratio > limit).count();
        Self {
            highest: ratios.into_iter().fold(0.0, f64::max),
            limit,
            above,
        }
    }

    /// Returns how many times the limit the highest power is.
    #[must_use]
    pub fn over(&self) -> f64 {
        self.highest / self.limit
    }
}

/// The length of a frequency, and the power there; of a ring, the means of both.
#[derive(Clone, Copy)]
struct FrequencyPower {
    length: f64,
    power: f64,
}

/// Returns the limit of the highest ratio. The mean of n exponential powers, times 2 n, is chi-square with 2 n degrees
/// of freedom.
fn highest_by_chance(sets: f64, frequencies: f64) -> f64 {
    // The probability that one frequency is above the limit: the sum over all of them is at least that of any.
    let tail = CHANCE / frequencies.max(1.0);
    chi_square_quantile(tail, 2.0 * sets) / (2.0 * sets)
}

/// Returns the mean length and power of a ring; none for a ring without frequencies.
fn mean(ring: &[FrequencyPower]) -> Option<FrequencyPower> {
    let mean_of =
        |part: fn(&FrequencyPower) -> f64| ring.iter().map(part).sum::<f64>() / ring.len() as f64;
    (!ring.is_empty()).then(|| FrequencyPower {
        length: mean_of(|one| one.length),
        power: mean_of(|one| one.power),
    })
}

/// Returns the mean power at a length by linear interpolation and extrapolation of the ring means, since a steep power
/// varies within a ring.
fn mean_at(means: &[FrequencyPower], length: f64) -> f64 {
    // The means on both sides of the length; before the first and beyond the last one, the two that are nearest.
    let after = means
        .partition_point(|mean| mean.length <= length)
        .min(means.len().saturating_sub(1))
        .max(1);
    match (means.get(after - 1), means.get(after)) {
        (Some(low), Some(high)) => {
            let part = (length - low.length) / (high.length - low.length);
            low.power + part * (high.power - low.power)
        }
        // A single ring has no second mean to interpolate to.
        (Some(only), None) => only.power,
        // No ring has a frequency.
        _ => f64::NAN,
    }
}

/// Returns the frequencies by ring of width 2, one of each pair of opposite ones, within the window's largest circle.
fn rings(periodogram: &Periodogram) -> Vec<Vec<FrequencyPower>> {
    let most = periodogram.window.x.end - 1;
    let mut rings = vec![Vec::new(); (most / 2) as usize];
    for [length, power] in periodogram.half_plane(most, 0..most + 1) {
        // Frequencies in the corners of the window are beyond the last ring.
        if let Some(ring) = rings.get_mut((0.5 * length) as usize) {
            ring.push(FrequencyPower { length, power });
        }
    }
    rings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::FrequencyWindow;
    use crate::region::{Boundary, Region};

    /// Exponential powers, the mean of `sets`.
    fn noise(sets: u64) -> Periodogram {
        let mut state = 7_u64;
        let mut draw = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            -(((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64).ln()
        };
        let window = FrequencyWindow::centered(100);
        let power = window.frequencies();
        let power = power.map(|_| (0..sets).map(|_| draw()).sum::<f64>() / sets as f64);
        Periodogram {
            power: power.collect(),
            window,
            region: Region {
                width: 1.0,
                height: 1.0,
                boundary: Boundary::Periodic,
            },
            samples: 5000.0,
            sets,
        }
    }

    #[test]
    fn a_steep_radial_mean_is_no_spike() {
        let flat = noise(1000);
        let mut steep = flat.clone();
        let window = steep.window.clone();
        for (power, k) in steep.power.iter_mut().zip(window.frequencies()) {
            *power *= (flat.length(k) / 20.0).powi(6);
        }
        let [flat, steep] = [flat, steep].map(|one| Peaks::of(&one));
        assert!((steep.over() - flat.over()).abs() < 0.05, "{steep:?}");
        assert_eq!(steep.above, 0);
    }

    #[test]
    fn noise_stays_within_its_limit_and_a_spike_does_not() {
        for sets in [1, 10] {
            let mut periodogram = noise(sets);
            let found = Peaks::of(&periodogram);
            assert_eq!(found.above, 0, "{found:?}");
            assert!(found.over() > 0.6, "{found:?}");
            let at = periodogram.window.index([40, 30]).unwrap();
            // Far enough above for a ring whose mean it lifts.
            periodogram.power[at] = 1.5 * found.limit;
            let spiked = Peaks::of(&periodogram);
            assert_eq!(spiked.above, 1);
            assert!(spiked.over() > 1.0);
        }
        // One set's powers are exponential; the limit of ten is far lower.
        assert!((highest_by_chance(1.0, 1e4) - 1e6_f64.ln()).abs() < 1e-6);
        assert!(highest_by_chance(10.0, 1e4) < 0.3 * highest_by_chance(1.0, 1e4));
    }
}
