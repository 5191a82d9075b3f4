//! The verdict on a window of a larger set, by the samples in the window and around it.

use pyo3::prelude::*;
use tilescope_analysis::verify_cut;

use crate::arguments::{SetArgument, verify_options};
use crate::memory::ask_to_judge;
use crate::task::run;

/// Returns the number of pairs in conflict in a set that was cut from a larger one, and of uncovered places in a rectangular
/// window of it. Other places may be uncovered because the set is cut.
#[pyfunction]
pub fn verify_window(
    py: Python<'_>,
    set: SetArgument<'_>,
    window: [f64; 4],
    judge: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(u64, u64)> {
    set.refuse_ground("a window")?;
    let points = set.points()?;
    let asked = (set.region()?, set.radius()?);
    let options = verify_options(judge)?;

    let [left, bottom, right, top] = window;
    let corners = [[left, bottom], [right, top]];
    run(py, progress, |watch| {
        ask_to_judge(points.len())?;
        let control = watch.control("verify");
        let report = verify_cut(points, asked, corners, &options, &control)?;
        // Two samples are too near wherever they lie, but places beyond the window may be uncovered because the set is
        // cut.
        Ok((report.whole.conflicts, report.gaps))
    })
}
