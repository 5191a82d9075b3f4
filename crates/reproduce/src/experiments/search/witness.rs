//! Places that no sample covers, with the three samples nearest to each.

use serde::{Deserialize, Serialize};
use tilescope_analysis::Gap;

use crate::sets::{Set, shortest};

/// The largest distance of sites from the circle that they define, in radii.
const HAIR: f64 = 1e-6;

/// A position without a sample within r, and the three samples nearest to it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Witness {
    pub center: [f64; 2],
    pub distance: f64,
    /// The samples, relative to the centre.
    pub sites: [[f64; 2]; 3],
}

impl Witness {
    /// Returns the centre of a gap with those three of `samples`, by their indices, that are nearest to it.
    pub fn of(gap: &Gap, set: &Set, samples: &[usize]) -> Self {
        let [x, y] = gap.center;
        let away = |index: &usize| {
            let at = set.points[*index];
            shortest([at[0] - x, at[1] - y], &set.region)
        };
        let reach = gap.distance + HAIR * set.radius;
        let near = samples
            .iter()
            .map(away)
            .filter(|[x, y]| x.hypot(*y) <= reach);
        let mut near: Vec<[f64; 2]> = near.collect();
        near.sort_by(|a, b| a[1].atan2(a[0]).total_cmp(&b[1].atan2(b[0])));
        Self {
            center: gap.center,
            distance: gap.distance,
            sites: [0, 1, 2].map(|k| near.get(k).copied().unwrap_or([f64::NAN; 2])),
        }
    }

    /// Returns the distances between the sites: of the second and third, first and third, first and second.
    pub fn sides(&self) -> [f64; 3] {
        let [a, b, c] = self.sites;
        [(b, c), (a, c), (a, b)].map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1]))
    }

    /// Returns whether no site has both others within 2r: two of the three sides are longer.
    pub fn out_of_sight(&self, radius: f64) -> bool {
        let long = |side: &&f64| **side > 2.0 * radius;
        self.sides().iter().filter(long).count() >= 2
    }
}
