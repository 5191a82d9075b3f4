//! The pairs of a range of distances, against a search through all pairs and all images. It shares nothing with the
//! measure but the samples.

use crate::support::{BOTH, Random, check_reports, distance, go_on, on_threads, region};
use tilescope_analysis::measures::{
    DistantPairs, MAX_PAIRS, MeasureError, PairCorrelation, pairs_between,
};
use tilescope_analysis::{Boundary, Region};

fn pairs(points: &[[f64; 2]], region: Region, distances: [f64; 2], limit: usize) -> DistantPairs {
    pairs_between(points, region, distances, limit, &go_on).expect("pairs")
}

/// Pairs as the definition has them, with the nearest of nine images.
fn all_pairs(
    points: &[[f64; 2]],
    region: Region,
    [least, most]: [f64; 2],
) -> Vec<(u32, u32, [f64; 2])> {
    let turns = match region.boundary {
        Boundary::Periodic => -1..=1,
        Boundary::Bounded => 0..=0,
    };
    let mut found = Vec::new();
    for (i, a) in points.iter().enumerate() {
        for (j, b) in points.iter().enumerate().skip(i + 1) {
            let images = turns
                .clone()
                .flat_map(|x| turns.clone().map(move |y| [x, y]));
            let offset = images
                .map(|[x, y]| {
                    let x = b[0] + f64::from(x) * region.width - a[0];
                    [x, b[1] + f64::from(y) * region.height - a[1]]
                })
                .min_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])))
                .expect("an image");
            if (least..most).contains(&distance(*a, *b, region)) {
                found.push((i as u32, j as u32, offset));
            }
        }
    }
    found
}

#[test]
fn pairs_are_those_of_all() {
    let mut random = Random::new(12);
    for boundary in BOTH {
        for (width, height) in [(1.0, 1.0), (30.0, 7.0), (3e-20, 4e-19), (1e9, 1.0)] {
            let region = region(width, height, boundary);
            let half = 0.5 * width.min(height);
            for count in [1, 2, 3, 10, 60, 300] {
                let mut points = random.points(count, region);
                points[0] = [0.0, 0.0];
                points[count / 2] = points[count - 1];
                for range in [[0.0, half], [0.5 * half, half], [0.1 * half, 0.2 * half]] {
                    let found = pairs(&points, region, range, MAX_PAIRS);
                    let expected = all_pairs(&points, region, range);
                    assert_eq!(
                        found.total,
                        expected.len() as u64,
                        "{region} {count} {range:?}"
                    );
                    assert_eq!(found.pairs.len(), expected.len());
                    for (pair, (first, second, offset)) in found.pairs.iter().zip(expected) {
                        assert_eq!((pair.first, pair.second), (first, second));
                        let [dx, dy] = [0, 1].map(|axis| pair.offset[axis] - offset[axis]);
                        assert!(
                            dx.hypot(dy) < 1e-12 * width.max(height),
                            "{pair:?} {offset:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn a_range_is_half_open_and_a_pair_is_drawn_across_the_seam() {
    let torus = region(16.0, 8.0, Boundary::Periodic);
    // At distances of 2 across the seam, of 3, of 5 (3, 4 and 5 is a right triangle), and at one place.
    let points = [[1.0, 1.0], [15.0, 1.0], [4.0, 1.0], [1.0, 1.0]];
    let indices = |range: [f64; 2]| -> Vec<(u32, u32)> {
        let found = pairs(&points, torus, range, 10);
        found
            .pairs
            .iter()
            .map(|pair| (pair.first, pair.second))
            .collect()
    };
    assert_eq!(indices([2.0, 3.0]), [(0, 1), (1, 3)]);
    assert_eq!(indices([3.0, 4.0]), [(0, 2), (2, 3)]);
    assert_eq!(indices([2.5, 3.0]), []);
    assert_eq!(indices([0.0, 1.0]), [(0, 3)]);
    let offsets: Vec<_> = (pairs(&points, torus, [2.0, 3.0], 10).pairs.iter())
        .map(|pair| pair.offset)
        .collect();
    assert_eq!(offsets, [[-2.0, 0.0], [2.0, 0.0]]);
    let bounded = region(16.0, 8.0, Boundary::Bounded);
    assert_eq!(pairs(&points, bounded, [2.0, 3.0], 10).total, 0);
}

#[test]
fn a_limit_holds_some_and_counts_all() {
    let torus = region(3.0, 2.0, Boundary::Periodic);
    let points = Random::new(14).points(500, torus);
    let all = pairs(&points, torus, [0.1, 0.3], MAX_PAIRS);
    for limit in [1, 7, 100, all.pairs.len() - 1, all.pairs.len()] {
        let some = pairs(&points, torus, [0.1, 0.3], limit);
        assert_eq!((some.total, some.pairs.len()), (all.total, limit));
        assert!(
            some.pairs
                .is_sorted_by_key(|pair| (pair.first, pair.second))
        );
        assert!(some.pairs.iter().all(|pair| all.pairs.contains(pair)));
    }
    // They are as many as the pair correlation counts.
    let found = PairCorrelation::of(&points, torus, 4.0, 8, &go_on).expect("a correlation");
    for (bin, count) in found.counts.iter().enumerate() {
        let range = [bin, bin + 1].map(|bin| bin as f64 * found.bin_width * found.r_max);
        assert_eq!(pairs(&points, torus, range, 1).total, *count, "{bin}");
    }
}

#[test]
fn distances_that_are_none_are_named() {
    let points = [[0.5, 0.5], [0.1, 0.2]];
    let refused = |region: Region, distances: [f64; 2], limit: usize| {
        pairs_between(&points, region, distances, limit, &go_on).expect_err("a refusal")
    };
    for boundary in BOTH {
        let square = region(4.0, 1.0, boundary);
        let beyond = 0.5 + f64::EPSILON;
        for (range, named) in [
            ([-0.1, 0.2], "-0.1"),
            ([f64::NAN, 0.2], "NaN"),
            ([0.1, f64::NAN], "NaN"),
            ([0.1, beyond], "0.5000000000000002"),
            ([0.1, f64::INFINITY], "inf"),
        ] {
            let error = refused(square, range, 5);
            assert!(
                matches!(error, MeasureError::OutOfRange { most: 0.5, .. }),
                "{range:?}"
            );
            assert!(error.to_string().contains(named), "{error}");
        }
        for range in [[0.2, 0.2], [0.3, 0.2]] {
            let error = refused(square, range, 5);
            assert!(matches!(error, MeasureError::NotRising { value: 0.2, .. }));
        }
        for limit in [0, MAX_PAIRS + 1] {
            let error = refused(square, [0.1, 0.2], limit);
            assert!(
                matches!(error, MeasureError::BadCount { count, limit: MAX_PAIRS, .. } if count == limit)
            );
        }
        let outside = pairs_between(&[[0.5, 1.5]], square, [0.1, 0.2], 5, &go_on);
        assert!(matches!(outside, Err(MeasureError::Set(_))));
        let none = pairs_between(&[], square, [0.1, 0.2], 5, &go_on);
        assert!(matches!(none, Err(MeasureError::TooFew { .. })));
    }
}

#[test]
fn a_search_can_be_stopped_anywhere_and_tells_how_far_it_is() {
    let torus = region(1.0, 1.0, Boundary::Periodic);
    let points = Random::new(2).points(20_000, torus);
    check_reports(|control| pairs_between(&points, torus, [0.01, 0.02], 500, control).err());
}

#[test]
fn threads_change_no_bit() {
    for boundary in BOTH {
        let region = region(2.0, 1.0, boundary);
        let points = Random::new(4).points(20_000, region);
        let with = |threads| on_threads(threads, || pairs(&points, region, [0.01, 0.02], 5000));
        assert_eq!(with(1), with(3));
    }
}
