//! Whether a circle is covered, by the ends of arcs. It computes with directions and a few square roots, without
//! angles, and answers "certainly" or "perhaps not". Where a circle is exposed is found elsewhere ([`super::cell`],
//! [`super::exposed`]).
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
    pub fn of_disk(offset: DVec2) -> Self {
        Self {
            toward: offset,
            least: 0.5 * offset.length_squared(),
        }
    }

    /// The end of the arc, going anticlockwise; none if the arc is so short, or its direction so imprecise, that the
    /// end would be inaccurate.
    fn end(&self) -> Option<DVec2> {
        let length = self.toward.length();
        // 1e-9 was chosen: the direction of a shorter offset may be mostly rounding. With 1e-6 the sine below is 0.0014
        // or more, and its error under 10^-13, less than a margin.
        if length < 1e-9 || self.least > (1.0 - 1e-6) * length {
            return None;
        }

        let along = self.toward / length;
        let cos = self.least / length;
        Some(along * cos + along.perp() * (1.0 - cos * cos).sqrt())
    }

    fn holds(&self, direction: DVec2, margin: f64) -> bool {
        direction.dot(self.toward) > self.least + margin
    }
}

/// Whether the arcs certainly cover the circle. `margin` bounds the error of a direction's product with an arc's.
///
/// Arcs with inaccurate ends are removed from the list.
pub(super) fn certainly_cover(arcs: &mut Vec<Arc>, margin: f64) -> bool {
    arcs.retain(|arc| arc.end().is_some());
    let ends_inside = |(index, arc): (usize, &Arc)| {
        let mut others = arcs.iter().enumerate();
        arc.end()
            .is_some_and(|end| others.any(|(other, arc)| other != index && arc.holds(end, margin)))
    };
    !arcs.is_empty() && arcs.iter().enumerate().all(ends_inside)
}

/// Whether two arcs certainly cover all directions from `first` anticlockwise to `last`, less than half a turn away: one holds
/// the first, the other the last, and the end of the one is inside the other.
pub(super) fn two_cover(arcs: &[Arc], [first, last]: [DVec2; 2], margin: f64) -> bool {
    let from = arcs.iter().filter(|arc| arc.holds(first, margin));
    let mut ends = from.filter_map(Arc::end);
    ends.any(|end| {
        arcs.iter()
            .any(|arc| arc.holds(last, margin) && arc.holds(end, margin))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const MARGIN: f64 = 1e-12;

    fn ring(count: u32, distance: f64) -> Vec<Arc> {
        let at = |index: u32| {
            DVec2::from_angle(f64::from(index) / f64::from(count) * std::f64::consts::TAU)
        };
        (0..count)
            .map(|index| Arc::of_disk(at(index) * distance))
            .collect()
    }

    #[test]
    fn a_ring_of_disks_covers_the_circle_while_it_is_tight() {
        // Six neighbours cover arcs of half-angle acos(d / 2), which must exceed 30 degrees: d < sqrt 3.
        assert!(certainly_cover(&mut ring(6, 1.732), MARGIN));
        assert!(!certainly_cover(&mut ring(6, 1.733), MARGIN));
        assert!(!certainly_cover(&mut ring(6, 3f64.sqrt()), MARGIN));
        assert!(certainly_cover(&mut ring(3, 0.999), MARGIN));
        assert!(!certainly_cover(&mut ring(3, 1.001), MARGIN));
        assert!(!certainly_cover(&mut Vec::new(), MARGIN));
    }

    #[test]
    fn every_disk_of_a_tight_ring_is_needed() {
        for index in 0..6 {
            let mut arcs = ring(6, 1.7);
            arcs.remove(index);
            assert!(!certainly_cover(&mut arcs, MARGIN));
        }
    }

    #[test]
    fn the_outside_of_a_border_counts_as_covered() {
        // Half of the circle is outside; one disk within the region covers the other half when its centre is near.
        let border = Arc {
            toward: DVec2::NEG_X,
            least: 0.0,
        };
        let disk = |x: f64| Arc::of_disk(DVec2::new(x, 0.0));
        assert!(!certainly_cover(&mut vec![border], MARGIN));
        assert!(!certainly_cover(&mut vec![border, disk(0.5)], MARGIN));
        let above = Arc::of_disk(DVec2::new(0.5, 0.8));
        let below = Arc::of_disk(DVec2::new(0.5, -0.8));
        assert!(certainly_cover(&mut vec![border, above, below], MARGIN));
        assert!(!certainly_cover(&mut vec![border, above], MARGIN));
    }

    #[test]
    fn two_arcs_cover_a_stretch_that_they_share() {
        let at = |degrees: f64| DVec2::from_angle(degrees.to_radians());
        // Disks at distance 1 cover 60 degrees to either side.
        let arcs = |degrees: f64| [0.0, degrees].map(|angle| Arc::of_disk(at(angle)));
        let stretch = [at(-50.0), at(110.0)];
        assert!(two_cover(&arcs(119.0), stretch, MARGIN));
        assert!(!two_cover(&arcs(121.0), stretch, MARGIN));
        assert!(!two_cover(&arcs(119.0), [at(-61.0), at(110.0)], MARGIN));
        assert!(!two_cover(&arcs(49.0), stretch, MARGIN));
    }
}
