//! Who judges: the two judges, and which of them are asked.
//! It judges nothing itself, but compares what both found.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::error::VerifyError;
use crate::report::Report;

/// A judge. Each decides conflicts and maximality by searches of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Judge {
    /// Delaunay triangulations of tiles: the largest empty circles are about Voronoi vertices.
    Delaunay,
    /// Covered circles: the disks cover the region when they cover each other's circles.
    Circles,
}

impl fmt::Display for Judge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Delaunay => "Delaunay triangulation",
            Self::Circles => "covered circles",
        })
    }
}

/// Which judges are asked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum JudgeChoice {
    /// Both up to [`Self::BOTH_UP_TO`] samples, covered circles for more.
    #[default]
    Automatic,
    /// Delaunay triangulation.
    Delaunay,
    /// Covered circles. A set that this judge declines goes to the other one, and the report says so.
    Circles,
    /// Both. They must agree.
    Both,
}

impl JudgeChoice {
    /// Sets of so many samples or fewer are judged twice.
    pub const BOTH_UP_TO: usize = 1 << 20;

    /// Whether the first and the second judge are asked about so many samples.
    pub(crate) const fn asked(self, count: usize) -> [bool; 2] {
        match self {
            Self::Automatic => [count <= Self::BOTH_UP_TO, true],
            Self::Delaunay => [true, false],
            Self::Circles => [false, true],
            Self::Both => [true, true],
        }
    }

    /// How many times all of so many samples are gone over: twice by the first judge, once by the second.
    pub(crate) fn passes(self, count: usize) -> u64 {
        let [by_delaunay, by_circles] = self.asked(count);
        2 * u64::from(by_delaunay) + u64::from(by_circles)
    }
}

/// Relative difference of two lengths within which judges agree.
const SAME_LENGTH: f64 = 1e-9;

/// The first report, naming both judges, where the second says the same; an error otherwise.
///
/// Covering radii may differ by rounding. Where one of them is within rounding of the limit, the judges may differ on
/// maximality, and the second decides: it compares exactly.
pub(crate) fn agreed(first: Report, second: Report) -> Result<Report, VerifyError> {
    let limit = (1.0 + first.covering_tolerance) * first.radius;
    let same_length = |a: f64, b: f64| (a - b).abs() <= SAME_LENGTH * a.max(b);
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
        let changes: [(&str, fn(&mut Report)); 4] = [
            ("conflicts", |report| report.conflicts += 1),
            ("smallest distance", |report| {
                report.min_distance = report.min_distance.next_up()
            }),
            ("covering radius", |report| {
                report.covering_radius *= 1.0 + 1e-8
            }),
            ("maximality", |report| {
                (report.gaps, report.covering_tolerance) = (1, 0.1)
            }),
        ];
        for (name, change) in changes {
            let [first, mut second] = reports();
            let first = Report {
                covering_tolerance: if name == "maximality" {
                    0.1
                } else {
                    first.covering_tolerance
                },
                ..first
            };
            change(&mut second);
            let fault = agreed(first, second).expect_err(name);
            assert!(
                fault
                    .to_string()
                    .starts_with(&format!("the two judges disagree on the {name}")),
                "{fault}"
            );
        }
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
