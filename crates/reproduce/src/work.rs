//! How long something will take: amounts of work of a few kinds, and this machine's rates of them.
//! Rates are measured, never assumed.

use std::ops::{Add, Mul, Sub};
use std::time::Instant;

use serde::{Deserialize, Serialize};
use tilescope_analysis::VerifyOptions;
use tilescope_analysis::measures::{Periodogram, Spectrum};
use tilescope_core::{Parameters, Pattern, Sweep, Unobserved, radius_estimate, reference_sample};

use crate::error::ReproduceError;
use crate::sets::region;

/// Amounts of work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Work {
    /// Samples made by the parallel engine.
    pub tiled: f64,
    /// Samples made by the sequential engine.
    pub sequential: f64,
    /// Samples made by the reference sampler.
    pub reference: f64,
    /// Samples verified.
    pub verified: f64,
    /// Samples whose spectrum is looked at.
    pub transformed: f64,
    /// Seconds of anything else, on a machine that verifies a million samples a second.
    pub other: f64,
}

impl Add for Work {
    type Output = Self;

    fn add(self, more: Self) -> Self {
        Self {
            tiled: self.tiled + more.tiled,
            sequential: self.sequential + more.sequential,
            reference: self.reference + more.reference,
            verified: self.verified + more.verified,
            transformed: self.transformed + more.transformed,
            other: self.other + more.other,
        }
    }
}

impl Mul<f64> for Work {
    type Output = Self;

    fn mul(self, times: f64) -> Self {
        Self {
            tiled: self.tiled * times,
            sequential: self.sequential * times,
            reference: self.reference * times,
            verified: self.verified * times,
            transformed: self.transformed * times,
            other: self.other * times,
        }
    }
}

/// What is left of work when some is done; never less than none.
impl Sub for Work {
    type Output = Self;

    fn sub(self, done: Self) -> Self {
        let left = |all: f64, done: f64| (all - done).max(0.0);
        Self {
            tiled: left(self.tiled, done.tiled),
            sequential: left(self.sequential, done.sequential),
            reference: left(self.reference, done.reference),
            verified: left(self.verified, done.verified),
            transformed: left(self.transformed, done.transformed),
            other: left(self.other, done.other),
        }
    }
}

impl std::iter::Sum for Work {
    fn sum<I: Iterator<Item = Self>>(each: I) -> Self {
        each.fold(Self::default(), Add::add)
    }
}

/// Samples a second, by kind of work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// Of the parallel engine.
    pub tiled: f64,
    /// Of the sequential engine.
    pub sequential: f64,
    /// Of the reference sampler.
    pub reference: f64,
    /// Of the verifier.
    pub verified: f64,
    /// Of the transform behind a spectrum.
    pub transformed: f64,
}

/// Samples of the sets that rates are measured with.
const PROBE: u64 = 60_000;

impl Rates {
    /// Measures this machine's rates; takes about half a second.
    pub fn measure() -> Result<Self, ReproduceError> {
        let base = Parameters::default();
        let radius = radius_estimate(&base, PROBE)?;
        let parameters = Parameters { radius, ..base };
        let domain = parameters.validate()?;
        let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
        let count = PROBE as f64;
        let rate = |began: Instant| count / began.elapsed().as_secs_f64().max(1e-6);
        let began = Instant::now();
        let (sampled, _) = Sweep::new(&parameters, &pattern, false)?.finish(&mut Unobserved)?;
        let tiled = rate(began);
        let began = Instant::now();
        tilescope_core::Sequential::new(&parameters, pattern)?.finish(&mut Unobserved)?;
        let sequential = rate(began);
        let began = Instant::now();
        reference_sample(domain, 1, &mut Unobserved)?;
        let reference = rate(began);
        let points: Vec<[f64; 2]> = (sampled.points.iter())
            .map(|p| domain.user_from_lattice(*p))
            .collect();
        let region = region(&domain);
        let go_on = |_| std::ops::ControlFlow::Continue(());
        let began = Instant::now();
        let options = VerifyOptions::default();
        tilescope_analysis::verify(&points, region, domain.radius(), &options, &go_on)?;
        let verified = rate(began);
        let began = Instant::now();
        Periodogram::of(&points, region, &Spectrum::window(count, region), &go_on)?;
        let transformed = rate(began);
        Ok(Self {
            tiled,
            sequential,
            reference,
            verified,
            transformed,
        })
    }

    /// Returns the seconds that work will take at these rates.
    #[must_use]
    pub fn seconds(&self, work: &Work) -> f64 {
        work.tiled / self.tiled
            + work.sequential / self.sequential
            + work.reference / self.reference
            + work.verified / self.verified
            + work.transformed / self.transformed
            + work.other * 1e6 / self.verified
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_work_over_rates() {
        let rates = Rates {
            tiled: 10.0,
            sequential: 5.0,
            reference: 2.0,
            verified: 1e6,
            transformed: 4.0,
        };
        let work = Work {
            tiled: 20.0,
            reference: 2.0,
            other: 3.0,
            ..Work::default()
        };
        assert!((rates.seconds(&work) - 6.0).abs() < 1e-12);
        let twice = work + work;
        assert!((rates.seconds(&twice) - 12.0).abs() < 1e-12);
        assert_eq!(twice, work * 2.0);
        assert_eq!(twice - work, work);
        assert_eq!(work - twice, Work::default());
    }

    #[test]
    fn every_rate_is_measured() {
        let rates = Rates::measure().unwrap();
        let all = [
            rates.tiled,
            rates.sequential,
            rates.reference,
            rates.verified,
            rates.transformed,
        ];
        assert!(all.iter().all(|rate| rate.is_finite() && *rate > 1000.0));
    }
}
