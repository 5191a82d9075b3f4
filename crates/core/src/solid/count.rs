//! Sets of balls of a wanted number: the radius follows from it.
//!
//! A set is made with a radius that the density of large sets gives, and again with a corrected one until the number
//! fits.

use crate::error::{ParameterError, SampleError};
use crate::lattice::{Boundary, MAX_SIDE_RADII, R, check_side};
use crate::progress::Observer;

use super::domain::{MAX_VOLUME_RADII, MIN_SIDE_RADII_SOLID, SolidDomain};
use super::{SOLID_DENSITY, SolidArrivals, solid_arrivals_parallel};

/// Samples that a closed face adds to each squared radius of it. Measured with sides of 8 to 30 r: 0.236, and up to
/// 0.255 in the smallest boxes, whose edges are a larger share.
const FACE_DENSITY: f64 = 0.236;

/// The variance of the number of samples is about this share of it.
const COUNT_VARIANCE: f64 = 0.05;

/// The number of samples that is made differs from the wanted one by at most one part in this many, or by one sample.
const TOLERANCE: u64 = 100;

/// A set from which an exact number of samples is taken may have more samples than were aimed at: the exact number
/// divided by this, and [`FEW`].
const SURPLUS: u64 = 40;

/// More samples than aimed at that a small set may have: one sample is more than a part in [`SURPLUS`] of it.
const FEW: u64 = 3;

/// The most sets made in search of a number. Large ones need one or two; small ones are cheap.
const MAX_TRIES: u32 = 64;

/// Tries before the radius is also varied: the number of a small set jumps as the radius changes, and corrections alone
/// could try the same radii again and again.
const STRAIGHT_TRIES: u32 = 4;

/// What a set of balls is made from whose radius follows from a number of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidRequest {
    /// Width, height and depth, in user units.
    pub size: [f64; 3],
    /// How the box ends.
    pub boundary: Boundary,
    /// The seed of all random draws.
    pub seed: u64,
}

/// A set of balls with its domain, in the order of arrival.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidSample {
    /// The domain, which has the radius that was found.
    pub domain: SolidDomain,
    /// The samples, with their levels.
    pub arrived: SolidArrivals,
    /// How many samples were made, of which [`Self::arrived`] has the first ones.
    pub made: usize,
}

/// Returns about how many samples a box has, whose sides are in radii.
fn expected([x, y, z]: [f64; 3], boundary: Boundary) -> f64 {
    let faces = match boundary {
        Boundary::Periodic => 0.0,
        Boundary::Bounded => 2.0 * (x * y + y * z + z * x),
    };
    SOLID_DENSITY * x * y * z + FACE_DENSITY * faces
}

impl SolidDomain {
    /// Returns about how many samples a maximal set has: by the density of large sets, and by what closed faces add. Of boxes of 10
    /// r and more it is within 3%.
    #[must_use]
    pub fn expected_samples(&self) -> f64 {
        let radii = self.sides().map(|side| f64::from(side) / f64::from(R));
        expected(radii, self.boundary())
    }
}

impl SolidRequest {
    /// Returns about the radius of a set of `count` samples, from the density of large sets and what closed faces add.
    ///
    /// Fails when a side is not a number within [`crate::SIDE_LIMITS`], and when no radius within the limits of a domain
    /// gives so many samples, or only one that is close to a limit.
    pub fn radius_estimate(&self, count: u64) -> Result<f64, ParameterError> {
        for (name, side) in ["width", "height", "depth"].into_iter().zip(self.size) {
            check_side(name, side)?;
        }

        let [shortest, longest] = self.radius_limits();
        // The estimate may be off, by more for few samples than for many. Without these margins (chosen, not measured)
        // a number could need a radius beyond a limit.
        let minimum = (self.expected(longest) * 1.1).ceil() as u64;
        let maximum = (self.expected(shortest) * 0.98) as u64;
        if !(minimum..=maximum).contains(&count) {
            return Err(ParameterError::Count {
                count,
                minimum,
                maximum,
            });
        }

        // Numbers go as the inverse cube of the radius, except for the samples that closed faces add, which go as the
        // inverse square: a step leaves at most a third of the error, and 40 steps leave nothing.
        let mut radius = longest;
        for _ in 0..40 {
            radius *= (self.expected(radius) / count as f64).cbrt();
        }
        Ok(radius.clamp(shortest, longest))
    }

    /// Returns a maximal set of `count` samples, within 1% or one sample. Threads of the current rayon pool share the
    /// work; the samples do not depend on them.
    ///
    /// Fails as [`Self::radius_estimate`] and as [`solid_sample_parallel`], and when none of many radii gave the
    /// number.
    pub fn of_count(
        &self,
        count: u64,
        observer: &mut dyn Observer,
    ) -> Result<SolidSample, SampleError> {
        let off = (count / TOLERANCE).max(1);
        self.search(count, count, |found| found.abs_diff(count) <= off, observer)
    }

    /// Returns the first `count` samples, by their arrival, of a maximal set that has as many or a few more. Of a large
    /// set hardly more than one sample in 40 is left out. Otherwise as [`Self::of_count`].
    ///
    /// Fails as [`Self::of_count`].
    pub fn of_exactly(
        &self,
        count: u64,
        observer: &mut dyn Observer,
    ) -> Result<SolidSample, SampleError> {
        // Three standard deviations more than wanted, rounded up, are seldom too few.
        let spread = (COUNT_VARIANCE * count as f64).sqrt();
        let aim = count + (3.0 * spread) as u64 + 1;
        let most = aim + count / SURPLUS + FEW;
        let fits = |found| (count..=most).contains(&found);

        let mut sample = self.search(count, aim, fits, observer)?;
        sample.arrived.truncate(count as usize);
        Ok(sample)
    }

    /// Makes sets of about `aim` samples until the number of one fits. Errors name `count`, the number that is
    /// wanted, unless only `aim` is too large.
    fn search(
        &self,
        count: u64,
        aim: u64,
        fits: impl Fn(u64) -> bool,
        observer: &mut dyn Observer,
    ) -> Result<SolidSample, SampleError> {
        // The wanted number is checked first, so that an error names it if both are out of range.
        self.radius_estimate(count)?;
        let [shortest, longest] = self.radius_limits();
        let mut radius = self.radius_estimate(aim)?;
        // No set is made yet: any number of samples is nearer to the wanted one than this.
        let mut nearest = u64::MAX;

        for tried in 0..MAX_TRIES {
            let (domain, arrived) = self.attempt(radius, observer)?;
            let made = arrived.places.len();
            let found = made as u64;
            if fits(found) {
                return Ok(SolidSample {
                    domain,
                    arrived,
                    made,
                });
            }

            if found.abs_diff(count) < nearest.abs_diff(count) {
                nearest = found;
            }
            radius *= (found as f64 / aim as f64).cbrt();
            if tried >= STRAIGHT_TRIES {
                // Golden-ratio steps through a percent, so that no two tries repeat each other: numbers then vary by
                // 3%.
                radius *= 0.995 + 0.01 * (f64::from(tried) * 0.618_033_988_749_895).fract();
            }
            radius = radius.clamp(shortest, longest);
        }
        Err(ParameterError::CountMissed { count, nearest }.into())
    }

    fn attempt(
        &self,
        radius: f64,
        observer: &mut dyn Observer,
    ) -> Result<(SolidDomain, SolidArrivals), SampleError> {
        let domain = SolidDomain::from_size(self.size, radius, self.boundary)?;
        let arrived = solid_arrivals_parallel(domain, self.seed, observer)?;
        Ok((domain, arrived))
    }

    /// Returns about how many samples a radius gives.
    fn expected(&self, radius: f64) -> f64 {
        expected(self.size.map(|side| side / radius), self.boundary)
    }

    /// Returns the shortest and the longest radius that the sides allow, a hair inside, since a domain compares
    /// quotients with its limits, which round otherwise.
    fn radius_limits(&self) -> [f64; 2] {
        let longest_side = self.size.into_iter().fold(0.0, f64::max);
        let shortest_side = self.size.into_iter().fold(f64::INFINITY, f64::min);
        let volume: f64 = self.size.iter().product();
        let by_volume = (volume / MAX_VOLUME_RADII).cbrt();
        let shortest = (longest_side / MAX_SIDE_RADII).max(by_volume);
        [
            shortest * (1.0 + 1e-9),
            shortest_side / MIN_SIDE_RADII_SOLID * (1.0 - 1e-9),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Unobserved;

    fn request(size: [f64; 3], boundary: Boundary, seed: u64) -> SolidRequest {
        SolidRequest {
            size,
            boundary,
            seed,
        }
    }

    #[test]
    fn counts_are_met_in_both_boundaries() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            for (seed, count) in [(1, 170), (2, 400), (3, 1_500), (4, 4_000)] {
                let request = request([3.0, 4.0, 5.0], boundary, seed);
                let found = request.of_count(count, &mut Unobserved).unwrap();
                let off = (found.arrived.places.len() as u64).abs_diff(count);
                assert!(off <= (count / 100).max(1), "{boundary:?} {count}: {off}");
                assert_eq!(found.made, found.arrived.places.len());
                // The radius makes the set again.
                let again = request.attempt(found.domain.radius(), &mut Unobserved);
                assert_eq!(again.unwrap().1, found.arrived);
            }
        }
    }

    /// Control: without what faces add, the estimate of a bounded box is far off.
    #[test]
    fn samples_are_estimated_with_those_at_faces() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let domain = SolidDomain::from_size([10.0, 11.0, 14.0], 1.0, boundary).unwrap();
            let made = solid_arrivals_parallel(domain, 5, &mut Unobserved).unwrap();
            let off = |expected: f64| (expected / made.places.len() as f64 - 1.0).abs();
            assert!(off(domain.expected_samples()) < 0.03, "{boundary:?}");
            let inside = SOLID_DENSITY * domain.volume_radii();
            assert_eq!(off(inside) > 0.1, boundary == Boundary::Bounded);
        }
    }

    #[test]
    fn exactly_so_many_samples_are_the_first_of_a_set() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            for (seed, count) in [(1, 151), (2, 1_000), (3, 5_003)] {
                let request = request([1.0; 3], boundary, seed);
                let found = request.of_exactly(count, &mut Unobserved).unwrap();
                assert_eq!(found.arrived.places.len() as u64, count);
                assert_eq!(found.arrived.levels.count() as u64, count);
                let more = found.made as u64 - count;
                assert!(more <= count / 20 + 12, "{boundary:?} {count}: {more}");
                let (_, all) = request
                    .attempt(found.domain.radius(), &mut Unobserved)
                    .unwrap();
                assert_eq!(all.places.len(), found.made);
                let first = all.places.iter().zip(all.levels.of_samples());
                let taken = &found.arrived;
                let taken = taken.places.iter().zip(taken.levels.of_samples());
                assert!(taken.eq(first.take(count as usize)));
            }
        }
    }

    #[test]
    fn numbers_that_no_radius_gives_are_refused_with_the_limits() {
        let refused = |size, count| {
            let request = request(size, Boundary::Periodic, 0);
            request.radius_estimate(count).unwrap_err().to_string()
        };
        assert!(refused([1.0, 0.0, 1.0], 100).contains("the height is 0"));
        assert!(refused([1.0, 1.0, f64::NAN], 100).contains("the depth is NaN"));
        assert!(refused([1.0; 3], 10).contains("10 samples were asked for"));
        assert!(refused([1.0; 3], 1 << 40).contains("it must be between 52 and"));
    }
}
