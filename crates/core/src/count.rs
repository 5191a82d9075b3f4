//! Finds the radius that gives a wanted number of samples: starts with an estimate from the density of maximal sets and
//! corrects it by the counts of actual runs.

use std::sync::Arc;

use crate::engine::parallel::sweep::Sweep;
use crate::engine::sequential::Sequential;
use crate::error::{ParameterError, SampleError};
use crate::lattice::{Boundary, MAX_SIDE_RADII, MIN_SIDE_RADII_BOUNDED, MIN_SIDE_RADII_PERIODIC};
use crate::parameters::{MAX_SEQUENTIAL_SAMPLES, MAXIMAL_DENSITY, Parameters, Variant};
use crate::pattern::Pattern;
use crate::progress::Observer;

/// The result's count may differ from the wanted one by one part in this many, or by one sample.
const TOLERANCE: u64 = 100;

/// The most runs made in search of a count. Large sets need one or two, since their count hardly
/// varies; small ones are cheap.
const MAX_TRIES: u32 = 64;

/// Tries before the radius is also varied by up to a hundredth: the count of a small set jumps as the radius changes,
/// and corrections alone could try the same radii again and again.
const STRAIGHT_TRIES: u32 = 4;

/// Samples that a closed border adds, as a width in radii by which it widens the domain: about, as a search by actual
/// runs corrects the rest.
const BORDER_WIDTH: f64 = 0.45;

/// Returns about the radius, in user units, of a set of `count` samples. It follows from the density of a maximal set,
/// the few samples that seams add, and those that a closed border adds.
///
/// Fails when anything but the radius is wrong with the parameters, and when no radius within the
/// limits gives the given number of samples.
pub fn radius_estimate(parameters: &Parameters, count: u64) -> Result<f64, ParameterError> {
    parameters.validate_but_radius()?;
    let [shortest, longest] = radius_limits(parameters);

    // The estimate may be off, by more for few samples than for many. Without these margins (chosen, not measured) a
    // count could need a radius beyond a limit.
    let minimum = (expected(parameters, longest) * 1.1).ceil() as u64;
    let maximum = (expected(parameters, shortest) * 0.98) as u64;
    if !(minimum..=maximum).contains(&count) {
        return Err(ParameterError::Count {
            count,
            minimum,
            maximum,
        });
    }

    // Counts go as the inverse square of the radius, except for the samples that a border adds. In a periodic domain
    // the first step is exact. In a bounded one a step leaves at most 0.45 / 6.45 of the error, as a side has at least
    // 6 r, and 20 steps leave nothing.
    let mut radius = longest;
    for _ in 0..20 {
        radius *= (expected(parameters, radius) / count as f64).sqrt();
    }

    Ok(radius.clamp(shortest, longest))
}

/// Returns the value that `attempt` makes with a radius for which it reports `count` samples, within 1% or one sample.
///
/// `attempt` is called with one radius after the other. Fails as [`radius_estimate`] and as
/// `attempt`, and when none of many radii gave the count.
pub fn search_radius<T, E: From<ParameterError>>(
    parameters: &Parameters,
    count: u64,
    mut attempt: impl FnMut(f64) -> Result<(u64, T), E>,
) -> Result<T, E> {
    let [shortest, longest] = radius_limits(parameters);
    let mut radius = radius_estimate(parameters, count)?;
    // The count so far that is nearest to the wanted one. Before the first try it stands for none: every count is
    // nearer.
    let mut nearest = u64::MAX;

    for number in 0..MAX_TRIES {
        let (found, made) = attempt(radius)?;
        if found.abs_diff(count) <= (count / TOLERANCE).max(1) {
            return Ok(made);
        }

        if found.abs_diff(count) < nearest.abs_diff(count) {
            nearest = found;
        }

        // Counts go as the inverse square of the radius.
        radius *= (found as f64 / count as f64).sqrt();
        if number >= STRAIGHT_TRIES {
            // Golden-ratio steps through +-1%, so that no two tries repeat each other.
            radius *= 0.99 + 0.02 * (f64::from(number) * 0.618_033_988_749_895).fract();
        }

        radius = radius.clamp(shortest, longest);
    }

    Err(ParameterError::CountMissed { count, nearest }.into())
}

/// For a set larger than this, a smaller set (of [`PROBE`] samples) first shows whether the estimate holds. The large
/// set itself is made for its count only if the estimate misses and the sequential engine could make the same set, or
/// if the domain allows no set of the smaller size.
const LARGE: u64 = 1_000_000;

/// Samples of the set that shows whether the estimate holds: enough that its count hardly varies by chance, at a third
/// of a large set's price at most (chosen, not measured).
const PROBE: u64 = 300_000;

/// If the probe's count differs from its estimate by at most this share, the first try of a search would be its last: a
/// search ends within a hundredth of the count, and the counts of larger sets vary less than the probe's.
const PROBE_TOLERANCE: f64 = 0.007;

/// Returns the radius in user units with which every engine makes `count` samples: the one that [`search_radius`] finds
/// when it makes whole sets, or an estimate for a set too large for the sequential engine. Sets of more than a million
/// samples are made only if a smaller one shows that the estimate misses, or if the domain allows no smaller one.
///
/// Fails as [`search_radius`].
pub fn radius_for_count(
    parameters: &Parameters,
    count: u64,
    pattern: &Arc<Pattern>,
    observer: &mut dyn Observer,
) -> Result<f64, SampleError> {
    let mut count_with = |radius| {
        let parameters = Parameters {
            radius,
            ..*parameters
        };
        count_of(&parameters, pattern, observer)
    };

    let estimate = radius_estimate(parameters, count)?;

    // The density of sets of these parameters over the estimated one. Small sets are searched without a probe,
    // as are those of a domain that allows no set of the probe's size.
    let density = match radius_estimate(parameters, PROBE) {
        Ok(radius) if count > LARGE => Some(count_with(radius)? as f64 / PROBE as f64),
        _ => None,
    };

    match density {
        // A search would begin with the estimate, and end with it.
        Some(density) if (density - 1.0).abs() <= PROBE_TOLERANCE => Ok(estimate),
        // The sequential engine does not make sets of this size: there is no search by whole sets with which the radius
        // must agree. The estimate is corrected by the probe's density.
        Some(density) if count as f64 > MAX_SEQUENTIAL_SAMPLES => Ok(estimate * density.sqrt()),
        // Whole sets are made until one has the count: small ones, those of a domain that allows no probe, and larger
        // ones whose probe missed its estimate.
        _ => search_radius(parameters, count, |radius| {
            Ok((count_with(radius)?, radius))
        }),
    }
}

/// Returns how many samples the set of these parameters has. The set itself is not kept.
fn count_of(
    parameters: &Parameters,
    pattern: &Arc<Pattern>,
    observer: &mut dyn Observer,
) -> Result<u64, SampleError> {
    // Only the sequential engine makes sets by Algorithm 4 as printed.
    if parameters.variant == Variant::AsPrinted {
        let run = Sequential::new(parameters, Arc::clone(pattern))?.finish(observer)?;
        return Ok(run.result.len() as u64);
    }

    let sources = false;
    let mut sweep = Sweep::new(parameters, pattern, sources)?;
    while sweep.step(observer)?.is_some() {}
    Ok(sweep.summary().count as u64)
}

/// Returns about how many samples a radius gives.
fn expected(parameters: &Parameters, radius: f64) -> f64 {
    // Seams add samples, the more the shorter the leaves: a density of 0.6983 was measured at a leaf of 20 r. The
    // shortest leaf has 6 r, and beyond 1000 r (or with a leaf without end) seams no longer count.
    let density = MAXIMAL_DENSITY + 0.05 / parameters.leaf.clamp(6.0, 1e3);

    let border = match parameters.boundary {
        Boundary::Periodic => 0.0,
        Boundary::Bounded => BORDER_WIDTH,
    };
    let side = |side: f64| side / radius + border;
    density * side(parameters.width) * side(parameters.height)
}

/// Returns the shortest and the longest radius that the domain's sides allow, a hair inside.
fn radius_limits(parameters: &Parameters) -> [f64; 2] {
    let Parameters { width, height, .. } = *parameters;
    let least_side = match parameters.boundary {
        Boundary::Periodic => MIN_SIDE_RADII_PERIODIC,
        Boundary::Bounded => MIN_SIDE_RADII_BOUNDED,
    };

    // A hair inside, since a domain compares `side / radius` with its limits, which rounds otherwise.
    let shortest = width.max(height) / MAX_SIDE_RADII * (1.0 + 1e-9);
    let longest = width.min(height) / least_side * (1.0 - 1e-9);
    [shortest, longest]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Unobserved;
    use crate::run::Run;

    /// The run of the sequential engine with a radius that gives the count.
    fn sample_count(
        parameters: &Parameters,
        count: u64,
        pattern: &Arc<Pattern>,
    ) -> Result<Run, SampleError> {
        search_radius(parameters, count, |radius| {
            let parameters = Parameters {
                radius,
                ..*parameters
            };
            let run = Sequential::new(&parameters, Arc::clone(pattern))?.finish(&mut Unobserved)?;
            Ok((run.result.len() as u64, run))
        })
    }

    #[test]
    fn small_counts_are_met_in_both_boundaries() {
        let pattern =
            Arc::new(Pattern::generate(&crate::PatternSpec::default(), &mut Unobserved).unwrap());
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            for (seed, count) in (40..130).step_by(9).enumerate() {
                let base = Parameters {
                    boundary,
                    seed: seed as u64,
                    ..Parameters::default()
                };
                match sample_count(&base, count, &pattern) {
                    Ok(run) => {
                        assert!((run.result.len() as u64).abs_diff(count) <= 1);
                        let radius = radius_for_count(&base, count, &pattern, &mut Unobserved);
                        assert_eq!(radius, Ok(run.parameters.radius), "{count}");
                    }
                    Err(SampleError::Parameters(ParameterError::Count { minimum, .. })) => {
                        assert!(count < minimum && boundary == Boundary::Periodic);
                    }
                    Err(other) => panic!("{boundary:?} {count}: {other}"),
                }
            }
        }
    }

    #[test]
    fn what_is_wrong_is_named_before_any_try() {
        let base = Parameters::default();
        let refused = |p: Parameters, count| radius_estimate(&p, count).unwrap_err().to_string();
        assert!(
            refused(
                Parameters {
                    width: -1.0,
                    ..base
                },
                100
            )
            .contains("the width is -1")
        );
        assert!(
            refused(
                Parameters {
                    height: f64::NAN,
                    ..base
                },
                100
            )
            .contains("the height is NaN")
        );
        assert!(
            refused(
                Parameters {
                    leaf: f64::NAN,
                    ..base
                },
                100
            )
            .contains("the leaf is NaN")
        );
        assert!(refused(base, 0).contains("0 samples were asked for"));
        assert!(refused(base, u64::MAX).contains("must be between"));
    }
}
