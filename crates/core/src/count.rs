//! The radius that gives a wanted number of samples. It tries: an estimate from the density of
//! maximal sets, corrected by what the runs really gave.

use std::sync::Arc;

use crate::engine::sequential::Sequential;
use crate::error::SampleError;
use crate::lattice::{MAX_SIDE_RADII, MIN_SIDE_RADII_BOUNDED, MIN_SIDE_RADII_PERIODIC};
use crate::parameters::{
    Boundary, MAX_SEQUENTIAL_SAMPLES, MAXIMAL_DENSITY, ParameterError, Parameters,
};
use crate::pattern::Pattern;
use crate::progress::Observer;
use crate::run::Run;

/// How far the result's count may be from the wanted one: 1%, rounded down to whole samples.
const TOLERANCE: u64 = 100;

/// The most runs made in search of a count. Large sets need one or two, since their count hardly
/// varies; small ones are cheap.
const MAX_TRIES: u32 = 48;

/// Returns the first radius to try for `count` samples: from the density of a maximal set, the
/// few more that seams make, and the half radius by which a closed border widens a domain.
#[must_use]
pub fn radius_estimate(parameters: &Parameters, count: u64) -> f64 {
    let Parameters { width, height, .. } = *parameters;
    let density = MAXIMAL_DENSITY + 0.05 / parameters.leaf.clamp(6.0, 1e3);
    let mut radius = (density * width * height / count as f64).sqrt();
    if parameters.boundary == Boundary::Bounded {
        for _ in 0..20 {
            let area = (width + 0.45 * radius) * (height + 0.45 * radius);
            radius = (density * area / count as f64).sqrt();
        }
    }
    radius
}

/// Returns the run of `parameters` with the radius chosen so that the result has `count` samples
/// to within 1%; the run's parameters state the radius.
///
/// Fails with [`ParameterError::Count`] when no radius within the limits gives so many.
pub fn sample_count(
    parameters: &Parameters,
    count: u64,
    pattern: &Arc<Pattern>,
    observer: &mut dyn Observer,
) -> Result<Run, SampleError> {
    let (minimum, maximum) = count_limits(parameters);
    if !(minimum..=maximum).contains(&count) {
        return Err(ParameterError::Count {
            count,
            minimum,
            maximum,
        }
        .into());
    }
    let mut radius = radius_estimate(parameters, count);
    let mut nearest = u64::MAX;
    for attempt in 0..MAX_TRIES {
        let parameters = Parameters {
            radius,
            ..*parameters
        };
        let run = Sequential::new(&parameters, Arc::clone(pattern))?.finish(observer)?;
        let found = run.result.len() as u64;
        if found.abs_diff(count) <= count / TOLERANCE {
            return Ok(run);
        }
        if found.abs_diff(count) < nearest.abs_diff(count) {
            nearest = found;
        }
        // The later tries of a small set are spread a little: its count jumps as the radius moves.
        let spread = 1.0 + 2e-4 * f64::from(attempt * attempt % 7);
        radius *= (found as f64 / count as f64).sqrt() * spread;
    }
    Err(ParameterError::CountMissed { count, nearest }.into())
}

/// Returns the fewest and the most samples that can be asked for in the parameters' domain.
fn count_limits(parameters: &Parameters) -> (u64, u64) {
    let Parameters {
        width,
        height,
        boundary,
        ..
    } = *parameters;
    let minimum_side = match boundary {
        Boundary::Periodic => MIN_SIDE_RADII_PERIODIC,
        Boundary::Bounded => MIN_SIDE_RADII_BOUNDED,
    };
    let (short, long) = (width.min(height), width.max(height));
    let area = |radius: f64| width * height / (radius * radius);
    let fewest = area(short / minimum_side) * 0.75;
    let most = (area(long / MAX_SIDE_RADII) * 0.6).min(MAX_SEQUENTIAL_SAMPLES * 0.99);
    (fewest.ceil() as u64, most as u64)
}
