//! The names of the judges, and which of them are asked. Their code is in `pairs` and `cover` (Delaunay
//! triangulation), in `circles` (covered circles), which `verify` asks, and in `squares` (subdivision).

use std::fmt;

use serde::{Deserialize, Serialize};

/// A judge. Each decides conflicts and maximality by searches of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Judge {
    /// Delaunay triangulations of tiles: the largest empty circles are about Voronoi vertices.
    Delaunay,
    /// Covered circles: the disks, or in space the balls, cover the region when they cover each other's circles.
    Circles,
    /// Subdivision: squares or cubes, cut until each is seen to be covered. It judges what
    /// [`VaryingRegion`](crate::VaryingRegion) describes, and sets in space.
    Subdivision,
}

impl Judge {
    /// Returns "Delaunay triangulation and covered circles".
    #[must_use]
    pub fn joined(judges: &[Self]) -> String {
        let names: Vec<String> = judges.iter().map(Self::to_string).collect();
        names.join(" and ")
    }
}

impl fmt::Display for Judge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Delaunay => "Delaunay triangulation",
            Self::Circles => "covered circles",
            Self::Subdivision => "subdivision",
        })
    }
}

/// Which judges are asked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum JudgeChoice {
    /// Both up to [`Self::BOTH_UP_TO`] samples, covered circles for more; in space, subdivision for more.
    #[default]
    Automatic,
    /// Delaunay triangulation, for any number of samples in the plane.
    Delaunay,
    /// Covered circles. A set that this judge declines goes to the other one, and the report says so.
    Circles,
    /// Both. They must agree.
    Both,
    /// Subdivision, which only sets of a [`VaryingRegion`](crate::VaryingRegion) and in space have.
    Subdivision,
}

impl JudgeChoice {
    /// Sets of this many samples or fewer are judged twice.
    pub const BOTH_UP_TO: usize = 1 << 20;

    /// Whether the first and the second judge are asked about the given number of samples.
    pub(crate) const fn asked(self, count: usize) -> [bool; 2] {
        match self {
            Self::Automatic => [count <= Self::BOTH_UP_TO, true],
            Self::Delaunay => [true, false],
            Self::Circles => [false, true],
            Self::Both => [true, true],
            Self::Subdivision => [false, false],
        }
    }

    /// How many passes over the samples the judges make: two by the first judge, one by the second.
    pub(crate) fn passes(self, count: usize) -> u64 {
        let [by_delaunay, by_circles] = self.asked(count);
        2 * u64::from(by_delaunay) + u64::from(by_circles)
    }
}
