//! How many balls of a set in space a plane meets.

use crate::measures::Summary;

use super::region::SolidRegion;

/// Returns how many balls around the samples planes meet for each squared radius of their area: the summary over evenly spaced
/// planes across each of the three axes, `planes` of them across each.
///
/// A plane meets a ball of which it has a place, so that the mean over all planes of a periodic region is twice the density
/// `N r^3 / volume`. In a bounded region the planes are a radius or more away from the parallel sides: nearer ones meet fewer
/// balls, as there are no samples beyond the side. Across an axis along which the region is shorter than two radii there are
/// none.
///
/// Returns `None` without a plane. Samples outside the region, and radii that are not positive, have no sensible number.
///
/// ```
/// use tilescope_analysis::{Boundary, SolidRegion, disks_in_planes};
///
/// // A cubic lattice of spacing 1 and radius 0.4: planes at 0, 0.5, 1, ... meet 16 of the 64 balls, or none.
/// let axis = |i: i32, step: i32| f64::from(i / step % 4);
/// let points: Vec<[f64; 3]> = (0..64).map(|i| [axis(i, 1), axis(i, 4), axis(i, 16)]).collect();
/// let region = SolidRegion { width: 4.0, height: 4.0, depth: 4.0, boundary: Boundary::Periodic };
/// let disks = disks_in_planes(&points, region, 0.4, 8).unwrap();
/// assert_eq!(disks.count, 24);
/// assert!((disks.most - 0.16).abs() < 1e-12 && disks.least == 0.0);
/// ```
#[must_use]
pub fn disks_in_planes(
    points: &[[f64; 3]],
    region: SolidRegion,
    radius: f64,
    planes: usize,
) -> Option<Summary> {
    let size = region.size();
    let of_plane = |axis: usize, plane: usize| {
        let side = size[axis];
        // All heights are alike in a torus, so that planes may begin at 0.
        let height = if region.is_periodic() {
            side * plane as f64 / planes as f64
        } else {
            // The middles of equal parts of the heights that are far enough from both sides.
            radius + (side - 2.0 * radius) * (plane as f64 + 0.5) / planes as f64
        };
        let meets = |point: &&[f64; 3]| {
            let apart = (point[axis] - height).abs();
            // Around the torus the other way may be shorter.
            let nearest = if region.is_periodic() {
                apart.min(side - apart)
            } else {
                apart
            };
            nearest <= radius
        };
        let area = size[(axis + 1) % 3] * size[(axis + 2) % 3];
        points.iter().filter(meets).count() as f64 * (radius * radius) / area
    };

    // A bounded region must have a height that is a radius away from both sides.
    let axes = (0..3).filter(|&axis| region.is_periodic() || size[axis] >= 2.0 * radius);
    Summary::of(axes.flat_map(|axis| (0..planes).map(move |plane| of_plane(axis, plane))))
}

#[cfg(test)]
mod tests {
    use super::super::spectrum::Random;
    use super::*;
    use crate::region::Boundary;

    fn mean(points: &[[f64; 3]], region: SolidRegion, radius: f64) -> Option<f64> {
        disks_in_planes(points, region, radius, 16).map(|all| all.mean)
    }

    #[test]
    fn planes_meet_twice_the_density_also_beside_a_border() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let [width, height, depth] = [10.0, 12.0, 14.0];
            let region = SolidRegion {
                width,
                height,
                depth,
                boundary,
            };
            let mut random = Random(2017);
            let point = |_| region.size().map(|side| side * random.unit());
            let points: Vec<[f64; 3]> = (0..2_000).map(point).collect();
            let twice = 2.0 * 2_000.0 / region.volume();
            let found = mean(&points, region, 1.0).unwrap();
            // Planes of one axis together meet nearly every sample, so that the mean scatters less than a single plane's
            // number: less than a hundredth in a torus. Without the samples near a border that are not met it is some 3%.
            assert!((found - twice).abs() < 0.08 * twice, "{found} {twice}");
            // The control: half of the samples are half as many.
            assert!(mean(&points[..1_000], region, 1.0).unwrap() < 0.6 * twice);
        }
    }

    #[test]
    fn a_box_without_a_plane_has_no_number() {
        let region = SolidRegion {
            width: 1.0,
            height: 1.0,
            depth: 1.0,
            boundary: Boundary::Bounded,
        };
        assert_eq!(mean(&[[0.5; 3]], region, 0.6), None);
        assert!(mean(&[[0.5; 3]], region, 0.4).is_some());
    }
}
