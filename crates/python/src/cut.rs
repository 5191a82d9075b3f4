//! The verdict on a window of a larger set, by the samples in the window and around it.

use pyo3::prelude::*;
use tilescope_analysis::{VerifyOptions, verify};

use crate::arguments::{SetArgument, verify_options};
use crate::plane::MAX_GAPS;
use crate::task::run;

/// Returns the number of pairs in conflict in a set that was cut from a larger one, and of uncovered places in a window
/// of it. Places outside the window may be uncovered because the set is cut.
#[pyfunction]
pub fn verify_window(
    py: Python<'_>,
    set: SetArgument<'_>,
    window: [f64; 4],
    judge: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(u64, u64)> {
    let (points, region, radius) = (set.points()?, set.region()?, set.radius()?);
    let options = VerifyOptions {
        witnesses: MAX_GAPS,
        ..verify_options(judge)?
    };
    let report = run(py, progress, |watch| {
        let control = watch.control("verify");
        Ok(verify(points, region, radius, &options, &control)?)
    })?;
    let [left, bottom, right, top] = window;
    let inside = |[x, y]: [f64; 2]| (left..=right).contains(&x) && (bottom..=top).contains(&y);
    let listed = report.worst_gaps.len() as u64;
    let gaps = report.worst_gaps.iter().map(|gap| gap.center);
    let gaps = gaps.filter(|center| inside(*center)).count() as u64;
    // Gaps beyond the listed ones count as lying in the window, so that none is overlooked.
    Ok((report.conflicts, gaps + (report.gaps - listed)))
}
