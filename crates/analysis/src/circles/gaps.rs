//! Gathers the corners of cells so that every gap counts once: three cells or more see it. A gap is dropped only for
//! another one at the same place.

use serde::{Deserialize, Serialize};

use crate::domain::Domain;
use crate::witness::Gap;

/// The corners of a cell as far as they matter to the verdict.
#[derive(Debug, Default)]
pub(crate) struct CellReach {
    /// The distance of the farthest corner.
    pub farthest: f64,
    /// Corners farther than the limit.
    pub gaps: Vec<Gap>,
}

/// The gaps at the corners of some cells, and the distance of the farthest corner.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Gaps {
    pub covering_radius: f64,
    pub all: Vec<Gap>,
}

impl Gaps {
    pub fn add(&mut self, cell: CellReach) {
        self.covering_radius = self.covering_radius.max(cell.farthest);
        self.all.extend(cell.gaps);
    }

    pub fn merge(&mut self, other: Self) {
        self.covering_radius = self.covering_radius.max(other.covering_radius);
        self.all.extend(other.all);
    }

    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Keeps one of all gaps within `same` of each other along both axes, in the order of places. If no gap is left, the covering
    /// radius is at most `limit`.
    pub fn settle(&mut self, domain: &Domain, same: f64, limit: f64) {
        // Around a torus, a gap at the seam may be seen from both sides: its places come together on one side.
        for gap in &mut self.all {
            gap.center = domain.at_seam(gap.center.into(), same).into();
        }

        // Sorted by x, only gaps just before one can be at its place.
        self.all.sort_unstable_by(|a, b| {
            a.center[0]
                .total_cmp(&b.center[0])
                .then_with(|| a.center[1].total_cmp(&b.center[1]))
        });

        let mut kept: Vec<Gap> = Vec::new();
        for gap in self.all.drain(..) {
            let is_near_in_y = |other: &&mut Gap| (other.center[1] - gap.center[1]).abs() <= same;
            let mut near_in_x =
                (kept.iter_mut().rev()).take_while(|other| gap.center[0] - other.center[0] <= same);

            match near_in_x.find(is_near_in_y) {
                Some(other) => {
                    // Cells may compute one circle from different samples on it, and so round it differently. Of two
                    // kinds the later one in the list of `GapKind` counts, which says more of the place (a corner lies
                    // on the border, too), and of two distances the larger one: so the result does not depend on which
                    // cell came first.
                    other.kind = other.kind.max(gap.kind);
                    other.distance = other.distance.max(gap.distance);
                }
                None => kept.push(gap),
            }
        }

        for gap in &mut kept {
            // A centre that `at_seam` put below a seam lies on it.
            gap.center = gap.center.map(|value| value.max(0.0));
        }
        if kept.is_empty() {
            // Radii near the limit were compared exactly, but their rounded values may be beyond it.
            self.covering_radius = self.covering_radius.min(limit);
        }
        self.all = kept;
    }
}
