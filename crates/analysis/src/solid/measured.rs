//! The verdict on a set in space with its covering radius, as certificates state it.

use serde::{Deserialize, Serialize};

use crate::exact::covering_limit;
use crate::monitor::{Control, Monitor};
use crate::verify::VerifyOptions;

use super::{
    SolidError, SolidQuestion, SolidRegion, SolidReport, deepest, error, farthest, memory,
    verify_solid,
};

/// The largest factor of the radius that is measured. In a periodic region of 4 radii no place is near two images of a sample up
/// to it.
const MAX_SOLID_FACTOR: f64 = 1.9;

/// A factor that the judges are given is larger by this share than the one that was measured, which may be too small by one
/// part in 2^30: far less than this share of 2^-26.
const SLACK: f64 = 1.0 / (1 << 26) as f64;

/// The verdict on a set in space with what only certificates need. Lengths are in the unit of the samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidVerdict {
    /// What the judges found. Of the beginning of a larger set, within the factor below.
    pub report: SolidReport,
    /// Largest distance from a place of the region to its nearest sample, to within one part in 2^30 of it.
    pub covering_radius: f64,
    /// The factor of the radius within which the beginning of a larger set covers, 1 or more; `None` of other sets, and where
    /// it would be above 1.9.
    pub covering_factor: Option<f64>,
}

impl SolidVerdict {
    /// Returns the smallest distance over that of as many samples in the densest packing of balls.
    #[must_use]
    pub fn relative_radius(&self) -> f64 {
        let report = &self.report;
        // Of the close packing, whose balls are the root of 2 to a cubed distance.
        let packed = (2f64.sqrt() * report.region.volume() / report.count as f64).cbrt();
        report.min_distance / packed
    }

    /// Whether the set is conflict-free and maximal; of a beginning, conflict-free and covering within its factor.
    #[must_use]
    pub fn valid(&self) -> bool {
        self.report.valid()
    }
}

/// Judges a set in space as [`verify_solid`] does, and measures its covering radius. Of a set that is said to be the beginning of
/// a larger one (`is_prefix`) the judges are asked about the factor of the radius that was measured, if it is 1.9 or less.
///
/// ```
/// use std::ops::ControlFlow;
/// use tilescope_analysis::{Boundary, SolidRegion, VerifyOptions, measure_solid};
///
/// // A cubic lattice of spacing 1: the middles of its cubes are sqrt(3) / 2 from all samples.
/// let axis = |i: i32, step: i32| f64::from(i / step % 4);
/// let points: Vec<[f64; 3]> = (0..64).map(|i| [axis(i, 1), axis(i, 4), axis(i, 16)]).collect();
/// let region = SolidRegion { width: 4.0, height: 4.0, depth: 4.0, boundary: Boundary::Periodic };
/// let measure = |radius, is_prefix| {
///     let options = VerifyOptions::default();
///     measure_solid(&points, region, radius, is_prefix, &options, &|_| ControlFlow::Continue(()))
/// };
/// let whole = measure(0.8, false)?;
/// assert!((whole.covering_radius - 0.75f64.sqrt()).abs() < 1e-9 && !whole.valid());
/// let beginning = measure(0.8, true)?;
/// assert!(beginning.valid() && (beginning.covering_factor.unwrap() - 0.75f64.sqrt() / 0.8).abs() < 1e-9);
/// # Ok::<(), tilescope_analysis::SolidError>(())
/// ```
///
/// # Errors
///
/// As [`verify_solid`].
pub fn measure_solid(
    points: &[[f64; 3]],
    region: SolidRegion,
    radius: f64,
    is_prefix: bool,
    options: &VerifyOptions,
    control: Control<'_>,
) -> Result<SolidVerdict, SolidError> {
    let question = SolidQuestion {
        points,
        region,
        radius,
        tolerance: options.covering_tolerance,
        // The search for the farthest place lists none.
        witnesses: 0,
    };
    // `verify_solid` checks the same below; the search needs it now.
    error::check(&question)?;
    memory::ask(points.len())?;
    // Measured first, since the factor of a beginning is what the judges are asked about.
    let monitor = Monitor::begin(control, points.len() as u64)?;
    let farthest = farthest::search(&question, &monitor)?;
    let measured = farthest.distance;

    // A set that covers within less than its radius has the factor 1. The tolerance that the judges are given leaves
    // room for the error of the measured factor, and is never less than that of the caller.
    let factor = (measured / radius).max(1.0);
    let covering_factor = (is_prefix && factor <= MAX_SOLID_FACTOR).then_some(factor);
    let tolerance = match covering_factor {
        Some(factor) => (factor * (1.0 + SLACK) - 1.0).max(options.covering_tolerance),
        None => options.covering_tolerance,
    };

    let options = VerifyOptions {
        covering_tolerance: tolerance,
        ..options.clone()
    };
    let mut report = verify_solid(points, region, radius, &options, control)?;
    let covering_radius = agreed(measured, &report, covering_limit(tolerance, radius))?;
    if !report.maximal() {
        // The judges list a place of each hole; of the deepest hole, the deepest place is known here.
        let listed = std::mem::take(&mut report.worst_gaps);
        let all = std::iter::once(farthest).chain(listed);
        report.worst_gaps = deepest(all, &region, radius, options.witnesses);
    }
    Ok(SolidVerdict {
        report,
        covering_radius,
        covering_factor,
    })
}

/// Returns the covering radius on the side of the limit on which the judges saw it. They decide by a search of their own, and the
/// two may differ where it is a hair from the limit.
fn agreed(measured: f64, report: &SolidReport, limit: f64) -> Result<f64, SolidError> {
    if report.maximal() {
        let bound = report.covering_bound();
        if measured > bound * (1.0 + SLACK) {
            return Err(SolidError::Farther { measured, bound });
        }
        return Ok(measured.min(limit));
    }
    // Of a set with gaps each of the places listed is beyond the limit.
    let gaps = report.worst_gaps.iter().map(|gap| gap.distance);
    Ok(gaps.fold(measured, f64::max))
}

#[cfg(test)]
mod tests;
