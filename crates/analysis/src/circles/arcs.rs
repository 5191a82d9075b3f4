//! Whether a circle is covered, by the ends of arcs.
//! It computes with directions and a few square roots, without angles, and answers "certainly" or "perhaps not".
//! It never finds where a circle is exposed.
//!
//! Each neighbour, and each side of a bounded region, covers the directions `u` with `u . v > h`: an open arc. Their union is
//! the whole circle when there is an arc at all and the anticlockwise end of each arc is inside another one: a union of open arcs
//! that is neither empty nor everything ends somewhere, at the end of one of them, and no other holds that end.
//! A neighbour of another radius, or the edge of a polygon, is such an arc as well.

use glam::DVec2;

/// The directions `u`, of length one, with `u . toward > least`: those a disk or the outside of a border covers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    pub toward: DVec2,
    pub least: f64,
}

impl Arc {
    /// The part of a circle of radius one that the open disk of the same radius at an offset covers.
    pub fn of_disk(offset: DVec2) -> Option<Self> {
        Self::unless_short(offset, 0.5 * offset.length_squared())
    }

    /// An arc, unless it is so short, or its direction so vague, that its end would be known badly: it is not needed.
    pub fn unless_short(toward: DVec2, least: f64) -> Option<Self> {
        let length = toward.length();
        (length > 1e-9 && least < (1.0 - 1e-6) * length).then_some(Self { toward, least })
    }

    /// The end of the arc, going anticlockwise.
    fn end(&self) -> DVec2 {
        let length = self.toward.length();
        let along = self.toward / length;
        let cos = self.least / length;
        along * cos + along.perp() * (1.0 - cos * cos).max(0.0).sqrt()
    }

    fn holds(&self, direction: DVec2, margin: f64) -> bool {
        direction.dot(self.toward) > self.least + margin
    }
}

/// Whether the arcs certainly cover the circle. `margin` bounds the error of a direction's product with an arc's.
pub(super) fn certainly_cover(arcs: &[Arc], margin: f64) -> bool {
    let ends_inside = |(index, arc): (usize, &Arc)| {
        let end = arc.end();
        let mut others = arcs.iter().enumerate();
        others.any(|(other, arc)| other != index && arc.holds(end, margin))
    };
    !arcs.is_empty() && arcs.iter().enumerate().all(ends_inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MARGIN: f64 = 1e-12;

    fn ring(count: u32, distance: f64) -> Vec<Arc> {
        let at = |index: u32| DVec2::from_angle(f64::from(index) / f64::from(count) * std::f64::consts::TAU);
        (0..count).filter_map(|index| Arc::of_disk(at(index) * distance)).collect()
    }

    #[test]
    fn a_ring_of_disks_covers_the_circle_while_it_is_tight() {
        // Six neighbours cover arcs of half-angle acos(d / 2), which must exceed 30 degrees: d < sqrt 3.
        assert!(certainly_cover(&ring(6, 1.732), MARGIN));
        assert!(!certainly_cover(&ring(6, 1.733), MARGIN));
        assert!(!certainly_cover(&ring(6, 3f64.sqrt()), MARGIN));
        assert!(certainly_cover(&ring(3, 0.999), MARGIN));
        assert!(!certainly_cover(&ring(3, 1.001), MARGIN));
        assert!(!certainly_cover(&[], MARGIN));
    }

    #[test]
    fn every_disk_of_a_tight_ring_is_needed() {
        for index in 0..6 {
            let mut arcs = ring(6, 1.7);
            arcs.remove(index);
            assert!(!certainly_cover(&arcs, MARGIN));
        }
    }

    #[test]
    fn the_outside_of_a_border_counts_as_covered() {
        // Half of the circle is outside; one disk within the region covers the other half when its centre is near.
        let border = Arc { toward: DVec2::NEG_X, least: 0.0 };
        let disk = |x: f64| Arc::of_disk(DVec2::new(x, 0.0)).unwrap();
        assert!(!certainly_cover(&[border], MARGIN));
        assert!(!certainly_cover(&[border, disk(0.5)], MARGIN));
        let above = Arc::of_disk(DVec2::new(0.5, 0.8)).unwrap();
        let below = Arc::of_disk(DVec2::new(0.5, -0.8)).unwrap();
        assert!(certainly_cover(&[border, above, below], MARGIN));
        assert!(!certainly_cover(&[border, above], MARGIN));
    }
}
