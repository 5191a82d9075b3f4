//! Places that no sample covers, with the three samples nearest to each.

use serde::{Deserialize, Serialize};

use crate::numbers::number;
use crate::sets::Set;

/// The largest distance of sites from the circle that they define, in radii.
pub const HAIR: f64 = 1e-6;

/// A position without a sample within r, and the three samples nearest to it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Witness {
    pub center: [f64; 2],
    pub distance: f64,
    /// The samples, relative to the centre.
    pub sites: [[f64; 2]; 3],
}

impl Witness {
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

/// The samples of a set by cell; cells are no shorter than the largest distance that is asked for.
pub struct CellIndex<'a> {
    set: &'a Set,
    period: [f64; 2],
    counts: [usize; 2],
    cells: Vec<Vec<[f64; 2]>>,
}

impl<'a> CellIndex<'a> {
    pub fn of(set: &'a Set, reach: f64) -> Self {
        let period = [set.region.width, set.region.height];
        let mut near = Self {
            set,
            period,
            counts: period.map(|period| ((period / reach) as usize).clamp(1, 4096)),
            cells: Vec::new(),
        };
        near.cells = vec![Vec::new(); near.counts[0] * near.counts[1]];
        for point in &set.points {
            let [x, y] = near.cell(*point);
            near.cells[y * near.counts[0] + x].push(*point);
        }
        near
    }

    fn cell(&self, at: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|k| {
            let count = self.counts[k];
            let share = at[k].rem_euclid(self.period[k]) / self.period[k];
            ((share * count as f64) as usize).min(count - 1)
        })
    }

    /// Returns the samples of the cell of a position and of those around it, each once.
    fn around(&self, at: [f64; 2]) -> impl Iterator<Item = &[f64; 2]> {
        let cell = self.cell(at);
        let [columns, rows] = [0, 1].map(|k| {
            let count = self.counts[k];
            let mut all = [count - 1, 0, 1]
                .map(|step| (cell[k] + step) % count)
                .to_vec();
            all.sort_unstable();
            all.dedup();
            all
        });
        let width = self.counts[0];
        let cells = rows
            .into_iter()
            .flat_map(move |y| columns.clone().into_iter().map(move |x| y * width + x));
        cells.flat_map(|cell| &self.cells[cell])
    }

    /// Returns the position with its three nearest samples, `distance` away.
    pub fn witness(&self, center: [f64; 2], distance: f64) -> Witness {
        let reach = distance + HAIR * self.set.radius;
        let period = self.period;
        let mut sites: Vec<[f64; 2]> = (self.around(center))
            .map(|p| [0, 1].map(|k| p[k] - center[k]))
            .map(|d| [0, 1].map(|k| d[k] - period[k] * (d[k] / period[k]).round()))
            .filter(|d| d[0].hypot(d[1]) <= reach)
            .collect();
        sites.sort_by(|a, b| a[1].atan2(a[0]).total_cmp(&b[1].atan2(b[0])));
        let site = |k: usize| sites.get(k).copied().unwrap_or([f64::NAN; 2]);
        Witness {
            center,
            distance,
            sites: [site(0), site(1), site(2)],
        }
    }
}

/// Returns what a picture's caption says of a witness.
pub fn told(witness: &Witness) -> String {
    let [a, b, c] = witness.sides().map(|side| number(side, 4));
    format!("its sites are {a}, {b} and {c} r apart")
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_analysis::{Boundary, Region};

    #[test]
    fn samples_across_the_border_are_found_once_in_domains_of_any_size() {
        for side in [2.5, 4.0, 40.0] {
            let region = Region {
                width: side,
                height: side,
                boundary: Boundary::Periodic,
            };
            let set = Set {
                points: vec![[0.9, 0.0], [side - 0.9, 0.0], [0.0, side - 0.9]],
                region,
                radius: 0.8,
            };
            let witness = CellIndex::of(&set, 1.0).witness([0.0, 0.0], 0.9);
            let expected = [[0.0, -0.9], [0.9, 0.0], [-0.9, 0.0]];
            for (site, expected) in witness.sites.iter().zip(expected) {
                let off = (site[0] - expected[0]).hypot(site[1] - expected[1]);
                assert!(off < 1e-9, "{side}: {:?}", witness.sites);
            }
        }
    }
}
