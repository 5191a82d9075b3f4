//! Gathers the gaps of all tiles so that every place counts once. Places within a tiny distance are one: cocircular
//! samples, corners on sides, claims of two tiles. A gap is dropped only for another one at the same place.

use glam::DVec2;

use super::survey::Survey;
use super::tiles::Tile;
use super::{Cover, CoverSearch};
use serde::{Deserialize, Serialize};

use crate::domain::Domain;
use crate::witness::Gap;
use crate::worst::{Witness, Worst};

/// The gaps of some tiles.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Places {
    covering_radius: f64,
    /// Places that no other tile can have claimed.
    count: u64,
    worst: Worst<Gap>,
    /// Places near a side, which neighbours may have claimed as well.
    shared: Vec<Gap>,
}

impl Places {
    pub fn new(witnesses: usize) -> Self {
        Self {
            covering_radius: 0.0,
            count: 0,
            worst: Worst::new(witnesses),
            shared: Vec::new(),
        }
    }

    /// Returns the places of one tile. Those near its sides are not settled, as other tiles may claim them, too.
    pub fn of_tile(task: &CoverSearch<'_>, tile: &Tile, mut survey: Survey) -> Self {
        let mut places = Self::new(task.witnesses);
        places.covering_radius = survey.covering_radius;
        merge_same(&mut survey.gaps, task.same);
        // Other tiles claim up to `same` beyond their sides; twice that leaves no doubt.
        let margin = 2.0 * task.same;

        let inner = |gap: &Gap| {
            let at = DVec2::from(gap.center);
            (at.cmpgt(tile.low + margin) & at.cmplt(tile.high - margin)).all()
        };

        for gap in survey.gaps {
            if inner(&gap) {
                places.add(gap);
            } else {
                places.shared.push(gap);
            }
        }
        places
    }

    pub fn merge(mut self, other: Self) -> Self {
        self.covering_radius = self.covering_radius.max(other.covering_radius);
        self.count += other.count;
        self.worst.merge(other.worst);
        self.shared.extend(other.shared);
        self
    }

    /// Number of places that are not settled yet.
    pub fn shared(&self) -> usize {
        self.shared.len()
    }

    /// Settles the shared places.
    pub fn finish(mut self, domain: &Domain, same: f64) -> Cover {
        let mut shared = std::mem::take(&mut self.shared);
        // A place on a seam is claimed from both sides of it: both claims move to one side, so that they merge.
        for gap in &mut shared {
            gap.center = domain.at_seam(gap.center.into(), same).into();
        }

        merge_same(&mut shared, same);
        for mut gap in shared {
            if domain.periodic {
                // `at_seam` may have put it a little below the seam, which is at 0.
                gap.center = gap.center.map(|value| value.max(0.0));
            }
            self.add(gap);
        }

        Cover {
            covering_radius: self.covering_radius,
            gaps: self.count,
            worst: self.worst,
        }
    }

    fn add(&mut self, gap: Gap) {
        self.count += 1;
        self.worst.push(gap);
    }
}

/// Replaces gaps whose places are within `same` along both axes by one. The result has the same bits in whatever order the gaps
/// come.
fn merge_same(gaps: &mut Vec<Gap>, same: f64) {
    if gaps.len() < 2 {
        return;
    }

    gaps.sort_unstable_by(|a, b| a.center[0].total_cmp(&b.center[0]));
    let mut start = 0;
    for end in 1..=gaps.len() {
        // A column is a run of gaps each of which differs in x from the gap before it by at most `same`. The column is
        // sorted by y, so that gaps at one place become neighbours. Where y is equal, the rank decides, so that the
        // sequence does not depend on the order in which the gaps came.
        if end == gaps.len() || gaps[end].center[0] - gaps[end - 1].center[0] > same {
            gaps[start..end].sort_unstable_by(|a, b| {
                (a.center[1].total_cmp(&b.center[1])).then_with(|| a.rank(b))
            });
            start = end;
        }
    }

    gaps.dedup_by(|next, kept| {
        let equal = (0..2).all(|axis| (next.center[axis] - kept.center[axis]).abs() <= same);
        if equal {
            *kept = joined(kept, next);
        }
        equal
    });
}

/// Returns one gap for two at the same place: kind and place of the more special one, and the larger circle.
fn joined(a: &Gap, b: &Gap) -> Gap {
    let special = if b.kind.cmp(&a.kind).then_with(|| a.rank(b)).is_gt() {
        b
    } else {
        a
    };
    Gap {
        distance: a.distance.max(b.distance),
        ..*special
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region::Region;
    use crate::witness::GapKind;

    fn gap(x: f64, y: f64, distance: f64, kind: GapKind) -> Gap {
        let center = [x, y];
        Gap {
            center,
            distance,
            kind,
        }
    }

    #[test]
    fn equal_places_merge_and_different_ones_stay() {
        let kind = GapKind::VoronoiVertex;
        let mut gaps = vec![
            gap(0.5, 0.5, 1.0, kind),
            gap(0.5, 0.2, 2.0, kind),
            gap(0.5 + 1e-14, 0.5, 1.5, kind),
            gap(0.2, 0.5, 3.0, kind),
            gap(0.5 - 1e-14, 0.2, 1.0, GapKind::Border),
        ];
        merge_same(&mut gaps, 1e-10);
        let expected = [
            gap(0.2, 0.5, 3.0, kind),
            gap(0.5 - 1e-14, 0.2, 2.0, GapKind::Border),
            gap(0.5 + 1e-14, 0.5, 1.5, kind),
        ];
        assert_eq!(gaps, expected);
    }

    #[test]
    fn a_place_on_the_seam_is_the_same_from_both_sides() {
        let domain = |periodic| Domain::new(Region::new([1.5, 1.0], periodic)).expect("supported");
        let at_seam = |x, y| domain(true).at_seam(DVec2::new(x, y), 1e-10).to_array();
        let [x, y] = at_seam(1.5 - 1e-14, 0.25);
        assert!(x.abs() < 1e-13 && y == 0.25);
        assert_eq!(at_seam(-1e-14, 0.25), [-1e-14, 0.25]);
        assert_eq!(at_seam(1.25, 0.0), [1.25, 0.0]);
        // The control: nothing is beyond the far side of a bounded region.
        let corner = DVec2::new(1.5, 1.0);
        assert_eq!(domain(false).at_seam(corner, 1e-10), corner);
    }
}
