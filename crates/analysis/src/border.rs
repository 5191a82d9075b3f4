//! The border of a bounded region, line by line.

use glam::DVec2;

/// A line of the border of a bounded region: the coordinate along an axis is 0, or the region's extent. Both judges list the
/// lines by it, so that the four cases of a rectangle stand in one place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BorderLine {
    /// The axis that the line is perpendicular to.
    pub axis: usize,
    /// Whether the line lies at the extent.
    pub is_far: bool,
}

impl BorderLine {
    /// The lines of a bounded region.
    pub const ALL: [Self; 4] = [
        Self::new(0, false),
        Self::new(0, true),
        Self::new(1, false),
        Self::new(1, true),
    ];

    pub const fn new(axis: usize, is_far: bool) -> Self {
        Self { axis, is_far }
    }

    /// The coordinate of all its places along the axis.
    pub fn level(self, extent: DVec2) -> f64 {
        if self.is_far { extent[self.axis] } else { 0.0 }
    }

    /// How far a place is from the line on the region's side; below 0 on the other one.
    pub fn depth(self, place: DVec2, extent: DVec2) -> f64 {
        if self.is_far {
            extent[self.axis] - place[self.axis]
        } else {
            place[self.axis]
        }
    }

    /// The direction away from the region.
    pub fn outward(self) -> DVec2 {
        let axis = if self.axis == 0 { DVec2::X } else { DVec2::Y };
        if self.is_far { axis } else { -axis }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_lies_on_the_inner_side_of_its_lines() {
        let extent = DVec2::new(3.0, 2.0);
        let place = DVec2::new(0.5, 1.25);
        let depths = BorderLine::ALL.map(|line| line.depth(place, extent));
        assert_eq!(depths, [0.5, 2.5, 1.25, 0.75]);

        for line in BorderLine::ALL {
            let on_line = place + line.outward() * line.depth(place, extent);
            assert_eq!(on_line[line.axis], line.level(extent));
            assert_eq!(line.depth(on_line, extent), 0.0);
            assert!(line.depth(on_line + line.outward(), extent) < 0.0);
        }
    }
}
