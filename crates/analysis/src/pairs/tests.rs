//! The pair search in the domain's own unit, where distances can be chosen exactly.

use super::*;
use crate::findings::MAX_CONFLICTS;
use crate::region::{Boundary, Region};
use std::ops::ControlFlow;

fn run(points: &[[f64; 2]], width: f64, height: f64, periodic: bool, radius: f64) -> Pairs {
    let boundary = if periodic {
        Boundary::Periodic
    } else {
        Boundary::Bounded
    };
    let domain = Domain::new(Region {
        width,
        height,
        boundary,
    })
    .expect("supported");
    assert_eq!(domain.scale, 1.0, "tests work in the domain's unit");
    let grid = Grid::new(points, domain, cell_side(&domain, points.len()));
    let go_on = |_| ControlFlow::Continue(());
    let monitor = Monitor::new(&go_on, 0);
    let found = search(&grid, points, radius, 4, &monitor).expect("not cancelled");
    let mut swept = sweep::search(&grid, radius, 4, &monitor).expect("not cancelled");
    if periodic {
        add_own_copies(&grid, radius, &mut swept);
    }
    // Either may count somewhat further.
    let counted = |pairs: &Pairs| pairs.conflicts.min(MAX_CONFLICTS);
    assert_eq!(counted(&found), counted(&swept));
    assert_eq!(found.min_distance, swept.min_distance);
    let worst = |pairs: &Pairs| pairs.worst.clone().into_sorted();
    assert_eq!(worst(&found), worst(&swept));
    found
}

#[test]
fn a_pair_at_the_radius_is_no_conflict_and_a_closer_one_is() {
    let points = [[0.25, 0.5], [0.5, 0.5]];
    assert_eq!(run(&points, 1.0, 1.0, false, 0.25).conflicts, 0);
    let pairs = run(&points, 1.0, 1.0, false, 0.25 + 1e-15);
    assert_eq!((pairs.conflicts, pairs.min_distance), (1, 0.25));
}

#[test]
fn the_torus_joins_opposite_sides() {
    let points = [[0.0625, 0.5], [0.9375, 0.5]];
    assert_eq!(run(&points, 1.0, 1.0, true, 0.2).min_distance, 0.125);
    assert_eq!(run(&points, 1.0, 1.0, true, 0.2).conflicts, 1);
    assert_eq!(run(&points, 1.0, 1.0, false, 0.2).min_distance, 0.875);
    assert_eq!(run(&points, 1.0, 1.0, false, 0.2).conflicts, 0);
}

#[test]
fn a_sample_conflicts_with_its_own_copy_across_a_short_period() {
    let pairs = run(&[[0.3, 0.1]], 1.0, 0.25, true, 0.5);
    assert_eq!((pairs.conflicts, pairs.min_distance), (1, 0.25));
    assert_eq!(pairs.worst.into_sorted()[0].second, 0);
    assert_eq!(
        run(&[[0.3, 0.1]], 1.0, 0.25, false, 0.5).min_distance,
        f64::INFINITY
    );
}

#[test]
fn far_pairs_and_tiny_distances_are_found() {
    let far = [[0.0, 0.0], [1.0, 1.0]];
    assert_eq!(run(&far, 1.0, 1.0, false, 1e-9).min_distance, 2.0f64.sqrt());
    let mut line: Vec<_> = (0..10).map(|i| [f64::from(i) * 0.1, 1e-4]).collect();
    let smallest = run(&line, 1.0, 1e-3, false, 1e-9).min_distance;
    assert!((smallest - 0.1).abs() < 1e-15);
    line.push([0.0, 0.0]);
    line.push([1e-300, 0.0]);
    assert_eq!(run(&line, 1.0, 1e-3, false, 1e-9).min_distance, 1e-300);
}

/// In a grid of 3 x 3 cells the closest pair, of the first two, has a cell between.
#[test]
fn the_closest_pair_is_found_beyond_touching_cells() {
    let points = [
        [0.33, 0.0],
        [0.67, 0.0],
        [0.0, 0.3],
        [1.0, 0.3],
        [0.5, 0.4],
        [0.0, 0.7],
        [1.0, 0.7],
        [0.5, 0.76],
        [0.25, 1.0],
        [0.75, 1.0],
    ];
    let boundary = Boundary::Bounded;
    let (width, height) = (1.0, 1.0);
    let region = Region {
        width,
        height,
        boundary,
    };
    let grid = Grid::new(&points, Domain::new(region).expect("supported"), 0.0);
    assert_eq!(grid.cells, [3, 3]);
    let go_on = |_| ControlFlow::Continue(());
    let monitor = Monitor::new(&go_on, 0);
    let pairs = search(&grid, &points, 0.1, 4, &monitor).expect("not cancelled");
    assert!((pairs.min_distance - 0.34).abs() < 1e-15);
}

/// One column of cells, and two clusters in one cell that are close across the seam only.
#[test]
fn a_cluster_on_the_seam_of_a_narrow_torus_is_counted_in_full() {
    let points: Vec<_> = (0..20)
        .flat_map(|i| [1e-4, 0.0099].map(|x| [x, 0.5 + f64::from(i) * 1e-5]))
        .collect();
    let pairs = run(&points, 0.01, 1.0, true, 1e-3);
    assert_eq!(pairs.conflicts, 40 * 39 / 2);
    assert_eq!(run(&points, 0.01, 1.0, false, 1e-3).conflicts, 20 * 19);
}

#[test]
fn a_cluster_in_one_cell_is_counted_in_full() {
    // 40 x 30 samples in one cell of a sparse region, spacing 2^-20.
    let step = 2f64.powi(-20);
    let points: Vec<_> = (0..1200)
        .map(|i| {
            [
                0.4 + f64::from(i % 40) * step,
                0.4 + f64::from(i / 40) * step,
            ]
        })
        .collect();
    let pairs = run(&points, 1.0, 1.0, true, 1.25 * step);
    assert_eq!(pairs.conflicts, 39 * 30 + 40 * 29);
    assert_eq!(run(&points, 1.0, 1.0, true, 0.9).conflicts, 1200 * 1199 / 2);
}

/// Every pair of random and clustered sets, by the definition.
#[test]
fn both_searches_count_every_pair_once() {
    let fraction = |i: usize, step: f64| (i as f64 * step).fract();
    for (scale, count) in [(1.0, 300), (1e-3, 200), (1e-9, 100)] {
        let point =
            |i| [0.754_877, 0.569_84].map(|step| (0.9995 + scale * fraction(i, step)).fract());
        let points: Vec<_> = (0..count).map(point).collect();
        for (periodic, radius) in [
            (true, 0.05),
            (true, 0.7),
            (true, 1e-9),
            (false, 0.05),
            (false, 2.0),
        ] {
            let along = |a: f64, b: f64| {
                let direct = (a - b).abs();
                if periodic {
                    direct.min(1.0 - direct)
                } else {
                    direct
                }
            };
            let distance = |i: usize, j: usize| {
                let [dx, dy] = [0, 1].map(|axis| along(points[i][axis], points[j][axis]));
                dx.hypot(dy)
            };
            let pairs = (0..count).flat_map(|i| (0..i).map(move |j| (i, j)));
            let expected = pairs.filter(|&(i, j)| distance(i, j) < radius).count() as u64;
            assert_eq!(run(&points, 1.0, 1.0, periodic, radius).conflicts, expected);
        }
    }
}

/// Half a million and more pairs beyond the limit, and samples at one place: the extremes stay exact.
#[test]
fn counting_ends_and_the_closest_pairs_are_found_all_the_same() {
    let step = 2f64.powi(-20);
    let mut points: Vec<_> = (0..4000)
        .map(|i| {
            [
                0.25 + f64::from(i % 100) * step,
                0.25 + f64::from(i / 100) * step,
            ]
        })
        .collect();
    points.push([0.75, 0.75]);
    points.push([0.75 + 0.5 * step, 0.75]);
    for periodic in [false, true] {
        let pairs = run(&points, 1.0, 1.0, periodic, 0.25);
        assert!(pairs.conflicts >= MAX_CONFLICTS);
        assert_eq!(pairs.min_distance, 0.5 * step);
        assert_eq!(pairs.worst.into_sorted()[0].first, 4000);
    }
    let same = vec![[0.5, 0.5]; 5000];
    let pairs = run(&same, 1.0, 1.0, true, 0.1);
    assert_eq!(
        (pairs.conflicts >= MAX_CONFLICTS, pairs.min_distance),
        (true, 0.0)
    );
    let worst: Vec<_> = pairs
        .worst
        .into_sorted()
        .iter()
        .map(|pair| (pair.first, pair.second))
        .collect();
    assert_eq!(worst, [(0, 1), (0, 2), (0, 3), (0, 4)]);
}
