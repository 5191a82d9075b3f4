//! The verdict on a window of a larger set, by the samples in the window and around it.

use pyo3::prelude::*;
use tilescope_analysis::{Region, VerifyOptions, verify};

use crate::arguments::{SetArgument, verify_options};
use crate::failure::Failure;
use crate::task::{TaskWatch, run};

/// Gaps that the verifier lists, more than the cut borders of a window have.
const MAX_GAPS: usize = 1 << 20;

/// Returns the number of pairs in conflict in a set that was cut from a larger one, and of uncovered places in the part of it
/// that `is_inside` says. Other places may be uncovered because the set is cut.
pub fn judge_within(
    points: &[[f64; 2]],
    (region, radius): (Region, f64),
    options: VerifyOptions,
    is_inside: impl Fn([f64; 2]) -> bool,
    watch: &TaskWatch,
) -> Result<(u64, u64), Failure> {
    let options = VerifyOptions {
        witnesses: MAX_GAPS,
        ..options
    };
    let report = verify(points, region, radius, &options, &watch.control("verify"))?;
    let listed = report.worst_gaps.len() as u64;
    let gaps = report.worst_gaps.iter().map(|gap| gap.center);
    let gaps = gaps.filter(|center| is_inside(*center)).count() as u64;
    // Gaps beyond the listed ones count as lying inside, so that none is overlooked.
    Ok((report.conflicts, gaps + (report.gaps - listed)))
}

/// Returns what [`judge_within`] finds in a rectangular window of a set.
#[pyfunction]
pub fn verify_window(
    py: Python<'_>,
    set: SetArgument<'_>,
    window: [f64; 4],
    judge: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(u64, u64)> {
    let (points, asked) = (set.points()?, (set.region()?, set.radius()?));
    let options = verify_options(judge)?;
    let [left, bottom, right, top] = window;
    let inside = |[x, y]: [f64; 2]| (left..=right).contains(&x) && (bottom..=top).contains(&y);
    run(py, progress, |watch| {
        judge_within(points, asked, options, inside, watch)
    })
}
