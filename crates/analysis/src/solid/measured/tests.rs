use std::ops::ControlFlow;

use super::*;
use crate::region::Boundary;

fn region(size: [f64; 3], boundary: Boundary) -> SolidRegion {
    let [width, height, depth] = size;
    SolidRegion {
        width,
        height,
        depth,
        boundary,
    }
}

fn measured(
    points: &[[f64; 3]],
    region: SolidRegion,
    radius: f64,
    is_prefix: bool,
) -> Result<SolidVerdict, SolidError> {
    let options = VerifyOptions::default();
    let go_on = |_| ControlFlow::Continue(());
    measure_solid(points, region, radius, is_prefix, &options, &go_on)
}

/// Returns scattered points of a box.
fn scattered(count: usize, size: [f64; 3]) -> Vec<[f64; 3]> {
    let mut word = 7_u64;
    let mut draw = |side: f64| {
        word = word.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (word >> 33) as f64 / (1_u64 << 31) as f64 * side
    };
    (0..count).map(|_| size.map(&mut draw)).collect()
}

/// A scan of places finds none that is farther, and one nearly as far: so the search misses none, and makes none up.
#[test]
fn no_place_of_a_scan_is_farther() {
    let size = [4.0, 5.0, 6.0];
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let region = region(size, boundary);
        let points = scattered(60, size);
        let found = measured(&points, region, 1.0, false).unwrap();
        let steps = 40;
        let mut farthest: f64 = 0.0;
        for index in 0..steps * steps * steps {
            let at = [index % steps, index / steps % steps, index / steps / steps];
            let place =
                [0, 1, 2].map(|axis| size[axis] * f64::from(at[axis]) / f64::from(steps - 1));
            let distances = points.iter().map(|&point| region.distance(point, place));
            farthest = farthest.max(distances.fold(f64::INFINITY, f64::min));
        }
        let radius = found.covering_radius;
        assert!(farthest <= radius * (1.0 + 1e-9), "{farthest} {radius}");
        // Half the diagonal of a cell of the scan.
        assert!(radius - farthest < 0.13, "{farthest} {radius}");
    }
}

/// In a bounded box one sample is as far from the farthest corner; a long periodic one has its places on the way round.
#[test]
fn one_sample_is_as_far_as_geometry_says() {
    let bounded = region([4.0, 5.0, 6.0], Boundary::Bounded);
    let found = measured(&[[1.0, 1.0, 1.0]], bounded, 4.0, false).unwrap();
    let corner = (9.0_f64 + 16.0 + 25.0).sqrt();
    assert!((found.covering_radius - corner).abs() < 1e-8, "{found:?}");

    let periodic = region([40.0, 5.0, 6.0], Boundary::Periodic);
    let found = measured(&[[1.0, 1.0, 1.0]], periodic, 1.0, false).unwrap();
    let middle = (400.0_f64 + 6.25 + 9.0).sqrt();
    assert!((found.covering_radius - middle).abs() < 1e-7, "{found:?}");
}

#[test]
fn a_beginning_covers_within_its_factor_and_another_set_has_none() {
    // A cubic lattice without one of its samples, which is then the farthest place.
    let axis = |i: i32, step: i32| f64::from(i / step % 4);
    let points: Vec<[f64; 3]> = (1..64)
        .map(|i| [axis(i, 1), axis(i, 4), axis(i, 16)])
        .collect();
    let region = region([4.0; 3], Boundary::Periodic);
    let beginning = measured(&points, region, 0.9, true).unwrap();
    assert!(beginning.valid(), "{beginning:?}");
    assert!((beginning.covering_factor.unwrap() - 1.0 / 0.9).abs() < 1e-8);
    let whole = measured(&points, region, 0.9, false).unwrap();
    assert_eq!((whole.valid(), whole.covering_factor), (false, None));
    assert!((whole.covering_radius - 1.0).abs() < 1e-8);

    // Conflicts are no matter of the factor, and a factor too large is none.
    assert!(!measured(&points, region, 1.1, true).unwrap().valid());
    let few = measured(&points[..2], region, 1.0, true).unwrap();
    assert_eq!((few.valid(), few.covering_factor), (false, None));
}
