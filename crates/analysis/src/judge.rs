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
