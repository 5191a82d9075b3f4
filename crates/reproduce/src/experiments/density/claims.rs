//! Verdicts on the density. The published one is confirmed if the difference lies within the errors of both, and if the same
//! rule refuses sets that are known to be wrong. The lattice of the sampler leaves out a few samples; two estimates say
//! how many.

use serde_json::json;
use tilescope_analysis::measures::student_quantile;

use super::results::{DensityResults, OFF, PUBLISHED, PUBLISHED_ERROR, UNFINISHED};
use crate::experiments::common::MISSED;
use crate::outcome::{Claim, Verdict};
use crate::texts::claim;

/// If the interval of their difference reaches farther than this, the two estimates of what the lattice leaves out
/// cannot show that one is wrong. It is about half of the published error.
const TELLING: f64 = 2e-6;

/// Returns the claims on the density.
pub fn claims(found: &DensityResults) -> Vec<Claim> {
    vec![published(found), lattice(found)]
}

/// Judges whether the density is the published one.
fn published(found: &DensityResults) -> Claim {
    // The density is the counted one and what the lattice leaves out together.
    let [density, error] = found.density();
    let [counted, counted_error] = found.all.density();
    let [left_out, doubt] = found.lattice.used();
    let (difference, interval) = found.beside_published(density);

    // The control sets have a radius off by `OFF` to either side, or stop after the level `UNFINISHED`.
    let controls = found
        .controls()
        .map(|control| found.beside_published(control).0);

    let values = json!({
        "published": PUBLISHED, "published_error": PUBLISHED_ERROR,
        "density": density, "error": error, "counted": counted, "counted_error": counted_error,
        "left_out": left_out, "doubt": doubt,
        "difference": difference, "interval": interval,
        "errors": difference / error.hypot(PUBLISHED_ERROR),
        "samples": found.all.sums.samples, "sets": found.all.sums.sets, "side": found.all.side,
        "off": OFF, "last": UNFINISHED, "controls": controls,
        "refused": found.refused(),
    });
    claim("density/published", found.verdict(), &values)
}

/// Judges whether both estimates of what the lattice leaves out agree.
fn lattice(found: &DensityResults) -> Claim {
    let [difference, error] = found.lattice.difference();
    let reach = student_quantile(MISSED, f64::INFINITY) * error;
    let agrees = difference.abs() <= reach;
    // Estimates that differ say so, however wide their errors are.
    let verdict = Verdict::if_known(!agrees || reach <= TELLING, agrees);

    let values = json!({
        "by_levels": found.lattice.by_levels, "by_coarse": found.lattice.by_coarse,
        "difference": difference, "reach": reach, "telling": TELLING,
    });
    claim("density/lattice", verdict, &values)
}
