//! Compares the reports of both judges on one set.

use crate::error::VerifyError;
use crate::exact::covering_limit;
use crate::judge::Judge;
use crate::report::Report;

/// Relative difference of two lengths within which judges agree: far above the rounding of either judge, and far below
/// the default tolerance of maximality, 2^-15.
const SAME_LENGTH: f64 = 1e-9;

/// Returns one report that names both judges, if their results are the same; otherwise an error.
///
/// Covering radii may differ by rounding. Both judges compare a radius near the limit exactly, but rounding may let
/// them choose different samples on nearly the same circle. So the judges may differ on maximality if both covering
/// radii are within rounding of the limit. Then the second report is returned; in all other cases the first.
pub(crate) fn agreed(first: Report, second: Report) -> Result<Report, VerifyError> {
    let limit = covering_limit(first.covering_tolerance, first.radius);
    let same_length = |a: f64, b: f64| (a - b).abs() <= SAME_LENGTH * a.max(b);

    // Both judges take the smallest distance from the same two samples by one formula, and must agree on all of its bits. A
    // covering radius can be computed from other samples or by other formulas.
    let difference = if first.conflicts != second.conflicts {
        Some("conflicts")
    } else if first.min_distance.to_bits() != second.min_distance.to_bits() {
        Some("smallest distance")
    } else if !same_length(first.covering_radius, second.covering_radius) {
        Some("covering radius")
    } else if first.maximal() != second.maximal() && !same_length(first.covering_radius, limit) {
        Some("maximality")
    } else {
        None
    };

    if let Some(difference) = difference {
        return Err(VerifyError::Disagreement {
            difference,
            reports: Box::new([first, second]),
        });
    }

    let judges = vec![Judge::Delaunay, Judge::Circles];
    // If the judges differ here, the covering radius is within rounding of the limit.
    Ok(if first.maximal() == second.maximal() {
        Report { judges, ..first }
    } else {
        Report { judges, ..second }
    })
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::judge::JudgeChoice;
    use crate::region::{Boundary, Region};
    use crate::verify::{VerifyOptions, verify};

    /// The reports of both judges on a square lattice whose gaps are as large as the radius.
    fn reports() -> [Report; 2] {
        let points: Vec<_> = (0..64)
            .map(|i| [f64::from(i % 8), f64::from(i / 8)])
            .collect();
        let region = Region {
            width: 8.0,
            height: 8.0,
            boundary: Boundary::Periodic,
        };
        [JudgeChoice::Delaunay, JudgeChoice::Circles].map(|judges| {
            let options = VerifyOptions {
                judges,
                ..VerifyOptions::default()
            };
            let go_on = |_| ControlFlow::Continue(());
            verify(&points, region, 0.5f64.sqrt(), &options, &go_on).expect("a report")
        })
    }

    #[test]
    fn equal_reports_become_one_that_names_both() {
        let [first, second] = reports();
        assert_eq!(
            [&first.judges[..], &second.judges[..]],
            [[Judge::Delaunay], [Judge::Circles]]
        );
        let report = agreed(first, second).expect("equal");
        assert_eq!(report.judges, [Judge::Delaunay, Judge::Circles]);
    }

    #[test]
    fn every_difference_is_a_fault() {
        let tolerant = |report: Report| Report {
            covering_tolerance: 0.1,
            ..report
        };
        let fault = |change: fn(Report) -> Report| {
            let [first, second] = reports().map(tolerant);
            assert!(agreed(first.clone(), second.clone()).is_ok());
            agreed(first, change(second))
                .expect_err("a fault")
                .to_string()
        };
        let on = |name: &str| format!("the two judges disagree on the {name}: ");
        let conflicts = fault(|report| Report {
            conflicts: 1,
            ..report
        });
        assert!(conflicts.starts_with(&on("conflicts")), "{conflicts}");
        let distance = fault(|report| Report {
            min_distance: report.min_distance.next_up(),
            ..report
        });
        assert!(distance.starts_with(&on("smallest distance")), "{distance}");
        let covering = fault(|report| Report {
            covering_radius: report.covering_radius * (1.0 + 1e-8),
            ..report
        });
        assert!(covering.starts_with(&on("covering radius")), "{covering}");
        let maximality = fault(|report| Report { gaps: 1, ..report });
        assert!(maximality.starts_with(&on("maximality")), "{maximality}");
    }

    /// Within rounding of the limit the second judge, which compares exactly, decides.
    #[test]
    fn a_doubt_is_the_second_judges_to_settle() {
        let [mut first, second] = reports();
        (first.gaps, first.covering_tolerance) = (1, 0.0);
        let second = Report {
            covering_tolerance: 0.0,
            covering_radius: second.radius,
            ..second
        };
        assert!(!first.maximal() && second.maximal());
        let report = agreed(first, second).expect("a doubt");
        assert!(report.maximal());
    }
}
