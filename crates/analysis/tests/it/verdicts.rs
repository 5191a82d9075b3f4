//! Known answers, and a negative control for every verdict.

#![allow(
    clippy::float_cmp,
    reason = "known answers are exact, and the same number must be the same bits"
)]

use crate::support;

use crate::support::{BOTH, go_on, judge, maximal_set, nearest, region, repeated};
use tilescope_analysis::{Boundary, GapKind, MAX_CONFLICTS, Region, Report, VerifyOptions, verify};

fn report(points: &[[f64; 2]], region: Region, radius: f64) -> Report {
    judge(points, region, radius).expect("a verdict")
}

#[test]
fn maximal_sets_are_valid() {
    for boundary in BOTH {
        for (width, height, radius) in [(1.0, 1.0, 0.05), (3.0, 0.5, 0.04), (0.7, 9.0, 0.1)] {
            let region = region(width, height, boundary);
            let points = maximal_set(region, radius, 7);
            let report = report(&points, region, radius);
            assert!(report.valid(), "{report:?}");
            assert!(report.worst_gaps.is_empty() && report.worst_conflicts.is_empty());
            assert_eq!(report.count, points.len());
            assert!((0.6..0.85).contains(&report.relative_radius));
            assert!(report.covering_radius > 0.9 * radius);
        }
    }
}

#[test]
fn a_pair_too_close_is_a_conflict_and_no_gap() {
    for boundary in BOTH {
        let region = region(1.0, 1.0, boundary);
        let mut points = maximal_set(region, 0.05, 3);
        let [x, y] = points[17];
        let toward = if x < 0.5 { 1e-3 } else { -1e-3 };
        points.push([x + toward, y]);
        let report = report(&points, region, 0.05);
        assert!(!report.conflict_free() && report.maximal() && !report.valid());
        let worst = report.worst_conflicts[0];
        assert_eq!((worst.first, worst.second), (17, points.len() - 1));
        assert!((worst.distance - 1e-3).abs() < 1e-15);
        assert_eq!(report.min_distance, worst.distance);
        assert_eq!(report.conflicts, report.worst_conflicts.len() as u64);
    }
}

#[test]
fn a_removed_sample_leaves_a_gap_where_it_was() {
    for boundary in BOTH {
        let region = region(1.0, 1.0, boundary);
        let mut points = maximal_set(region, 0.05, 4);
        let removed = points.swap_remove(23);
        let report = report(&points, region, 0.05);
        assert!(report.conflict_free() && !report.maximal() && !report.valid());
        assert!(report.gaps >= 1);
        for gap in &report.worst_gaps {
            // All that is uncovered was covered by the removed disk, and the centre is no guess.
            let offset = support::distance(gap.center, removed, region);
            assert!(offset <= 0.05 * (1.0 + 1e-9));
            assert!(region.contains(gap.center));
        }
    }
}

#[test]
fn the_gap_of_a_lattice_is_found_at_its_exact_place() {
    // A square lattice without one sample: the hole is centred where the sample was.
    for boundary in BOTH {
        let region = region(1.0, 1.0, boundary);
        let mut points = centred_lattice(10);
        let removed = points.remove(34);
        // The hole is as large as the spacing: a slightly smaller radius gives exactly this gap.
        let found = report(&points, region, 0.0999);
        assert_eq!((found.gaps, found.worst_gaps.len()), (1, 1));
        let gap = found.worst_gaps[0];
        assert!((gap.center[0] - removed[0]).abs() < 1e-9);
        assert!((gap.center[1] - removed[1]).abs() < 1e-9);
        assert!((gap.distance - 0.1).abs() < 1e-12);
        assert!(report(&points, region, 0.1).maximal());
    }
}

fn centred_lattice(side: u32) -> Vec<[f64; 2]> {
    let at = |index: u32| (f64::from(index) + 0.5) / f64::from(side);
    (0..side * side)
        .map(|i| [at(i % side), at(i / side)])
        .collect()
}

#[test]
fn border_and_corner_gaps_are_named() {
    // One sample in the middle of a bounded square: the corners are the worst places.
    let square = region(2.0, 2.0, Boundary::Bounded);
    let single = report(&[[1.0, 1.0]], square, 1.2);
    assert_eq!((single.gaps, single.covering_radius), (4, 2f64.sqrt()));
    assert!(single.worst_gaps.iter().all(|g| g.kind == GapKind::Corner));
    assert!(single.conflict_free());
    assert_eq!(single.min_distance, f64::INFINITY);
    assert!(report(&[[1.0, 1.0]], square, 1.5).valid());

    // Two samples side by side: their bisector meets the long sides.
    let pair = report(
        &[[0.5, 0.25], [3.5, 0.25]],
        region(4.0, 0.5, Boundary::Bounded),
        1.0,
    );
    assert_eq!(pair.gaps, 2);
    assert!(pair.worst_gaps.iter().all(|g| g.kind == GapKind::Border));
    assert_eq!(pair.worst_gaps[0].center, [2.0, 0.0]);
    assert_eq!(pair.worst_gaps[0].distance, 1.5f64.hypot(0.25));
}

#[test]
fn tiny_periodic_sets_see_their_own_copies() {
    let torus = region(1.0, 1.0, Boundary::Periodic);
    let single = report(&[[0.25, 0.25]], torus, 0.6);
    assert_eq!(single.covering_radius, 0.5f64.sqrt());
    assert_eq!((single.gaps, single.min_distance), (1, 1.0));
    assert_eq!(single.worst_gaps[0].center, [0.75, 0.75]);
    assert!(report(&[[0.25, 0.25]], torus, 0.75).valid());
    let own = report(&[[0.25, 0.25]], torus, 1.5);
    assert_eq!((own.conflicts, own.worst_conflicts[0].second), (1, 0));

    let pair = report(&[[0.25, 0.25], [0.75, 0.75]], torus, 0.5);
    assert_eq!((pair.covering_radius, pair.gaps), (0.5, 0));
    // Samples on a line repeat into a plane.
    let row = [[0.0, 0.5], [0.25, 0.5], [0.5, 0.5], [0.75, 0.5]];
    let found = report(&row, torus, 0.25);
    assert!((found.covering_radius - 0.125f64.hypot(0.5)).abs() < 1e-15);
    assert_eq!(found.min_distance, 0.25);
}

#[test]
fn lattices_have_their_known_covering_radius() {
    for boundary in BOTH {
        let square = report(&centred_lattice(16), region(1.0, 1.0, boundary), 0.0625);
        let expected = 0.0625 * 0.5f64.sqrt();
        assert!((square.covering_radius - expected).abs() < 1e-16);
        assert_eq!(square.min_distance, 0.0625);
        assert!(square.valid());
    }
    // Hexagonal with spacing 1: covering radius 1 / sqrt 3, and the densest packing.
    let rise = 0.75f64.sqrt();
    let hexagonal: Vec<_> = (0..20 * 24)
        .map(|i| (i % 20, i / 20))
        .map(|(i, j)| [f64::from(i) + 0.5 * f64::from(j % 2), f64::from(j) * rise])
        .collect();
    let found = report(
        &hexagonal,
        region(20.0, 24.0 * rise, Boundary::Periodic),
        0.999_999,
    );
    assert!((found.covering_radius - 1.0 / 3f64.sqrt()).abs() < 1e-14);
    assert!((found.relative_radius - 1.0).abs() < 1e-14);
    assert!((found.density - 2.0 / 3f64.sqrt()).abs() < 1e-5);
    assert!(found.valid());
}

#[test]
fn cocircular_samples_make_one_gap() {
    // Every square of the lattice is one place, in whatever way it was triangulated.
    for tile_samples in [1, 7, 60, 1000] {
        for boundary in BOTH {
            let options = VerifyOptions {
                tile_samples,
                ..VerifyOptions::default()
            };
            let square = region(1.0, 1.0, boundary);
            // A spacing of 1/20 is not representable, so the cocircularity is rounded.
            let report = verify(&centred_lattice(20), square, 0.03, &options, &go_on);
            let report = report.expect("a verdict");
            let (places, border) = match boundary {
                Boundary::Periodic => (400, 0),
                // The border's places are half a spacing from their samples, no further.
                Boundary::Bounded => (361, 4 * 19 + 4),
            };
            assert_eq!(report.gaps, places + border, "{tile_samples} {boundary:?}");
        }
    }
}

#[test]
fn scaling_by_a_power_of_two_scales_the_report() {
    let points = maximal_set(region(1.0, 1.0, Boundary::Bounded), 0.08, 5);
    let plain = report(&points, region(1.0, 1.0, Boundary::Bounded), 0.081);
    for factor in [2f64.powi(-90), 2f64.powi(80)] {
        let scaled: Vec<_> = points.iter().map(|p| p.map(|v| v * factor)).collect();
        let large = region(factor, factor, Boundary::Bounded);
        let found = report(&scaled, large, 0.081 * factor);
        assert_eq!(found.covering_radius, plain.covering_radius * factor);
        assert_eq!(found.min_distance, plain.min_distance * factor);
        assert_eq!((found.conflicts, found.gaps), (plain.conflicts, plain.gaps));
        assert!(found.conflicts > 0);
    }
}

#[test]
fn witnesses_are_the_worst_and_counts_are_complete() {
    let torus = region(1.0, 1.0, Boundary::Periodic);
    let points = support::Random::new(11).points(500, torus);
    let options = |witnesses| VerifyOptions {
        witnesses,
        ..VerifyOptions::default()
    };
    let judge = |witnesses| verify(&points, torus, 0.04, &options(witnesses), &go_on);
    let (all, few) = (
        judge(100_000).expect("a verdict"),
        judge(3).expect("a verdict"),
    );
    assert_eq!(all.conflicts, all.worst_conflicts.len() as u64);
    assert_eq!(all.gaps, all.worst_gaps.len() as u64);
    assert_eq!((few.conflicts, few.gaps), (all.conflicts, all.gaps));
    assert_eq!(few.worst_conflicts, all.worst_conflicts[..3]);
    assert_eq!(few.worst_gaps, all.worst_gaps[..3]);
    assert_eq!(all.min_distance, all.worst_conflicts[0].distance);
    assert_eq!(all.covering_radius, all.worst_gaps[0].distance);
    assert!(all.worst_gaps.is_sorted_by(|a, b| a.distance >= b.distance));
    for gap in &all.worst_gaps {
        let copies: Vec<_> = points
            .iter()
            .flat_map(|p| {
                (0..9).map(|c| [p[0] + f64::from(c % 3 - 1), p[1] + f64::from(c / 3 - 1)])
            })
            .collect();
        assert!((nearest(&copies, gap.center) - gap.distance).abs() < 1e-12);
    }
}

#[test]
fn two_hundred_thousand_samples_with_one_removed() {
    let unit = region(1.0, 1.0, Boundary::Periodic);
    let radius = (0.7f64 / 2000.0).sqrt();
    let pattern = maximal_set(unit, radius, 2);
    let (mut points, large) = repeated(&pattern, unit, 10);
    assert!(points.len() > 190_000);
    assert!(report(&points, large, radius).valid());
    let removed = points.swap_remove(100_003);
    let found = report(&points, large, radius);
    assert!(found.conflict_free() && found.gaps > 0);
    let offset = support::distance(found.worst_gaps[0].center, removed, large);
    assert!(offset <= radius);
}

/// Samples at one place are in conflict at distance 0; of several pairs those of the first samples are named.
#[test]
fn equal_samples_are_conflicts() {
    for boundary in BOTH {
        let torus = region(1.0, 1.0, boundary);
        let mut points = maximal_set(torus, 0.1, 3);
        let count = points.len();
        points.push(points[7]);
        let report = report(&points, torus, 0.1);
        assert_eq!((report.conflicts, report.min_distance), (1, 0.0));
        let pair = report.worst_conflicts[0];
        assert_eq!((pair.first, pair.second, pair.distance), (7, count, 0.0));
        assert!(report.maximal() && !report.valid());
    }
    let torus = region(1.0, 1.0, Boundary::Periodic);
    let report = report(&[[0.0, 0.5], [-0.0, 0.5], [0.5, 0.1]], torus, 0.1);
    assert_eq!((report.conflicts, report.min_distance), (1, 0.0));
}

/// A line may cover a narrow region, and does not cover a wide one.
#[test]
fn samples_on_a_line_are_judged() {
    let line: Vec<_> = (0..10).map(|i| [0.05 + 0.1 * f64::from(i), 0.02]).collect();
    let bounded = |height: f64| region(1.0, height, Boundary::Bounded);
    assert!(report(&line, bounded(0.04), 0.09).valid());
    let report = report(&line, bounded(1.0), 0.09);
    assert!(report.conflict_free() && !report.maximal());
    let corner = 0.05_f64.hypot(0.98);
    assert!((report.covering_radius - corner).abs() < 1e-12);
}

/// Sets that no sampler makes: a circle, lines, a cluster, one place. Verification ends, and finds the extremes with
/// which they were made.
#[test]
fn degenerate_sets_of_any_size_are_judged() {
    // What makes the samples, the radius, and the covering radius where it is known.
    type Case<'a> = (&'a dyn Fn(u32) -> [f64; 2], f64, f64);
    const N: u32 = 20_000;
    let part = |i: u32| f64::from(i) / f64::from(N);
    let jitter = |i: u32| 1e-12 * (f64::from(i) * 0.754_877).fract();
    let line = |i: u32| [0.5 + jitter(i), part(i)];
    let crossed = |i: u32| {
        if i.is_multiple_of(2) {
            line(i)
        } else {
            [part(i), 0.5 + jitter(i)]
        }
    };
    let circle = |i: u32| {
        let (sin, cos) = (std::f64::consts::TAU * part(i)).sin_cos();
        [0.5 + 0.3 * cos, 0.5 + 0.3 * sin]
    };
    let cluster =
        |i: u32| [0.754_877, 0.569_84].map(|step| 0.5 + 1e-7 * (f64::from(i) * step).fract());
    let far = 0.5_f64.hypot(0.5);
    let cases: [Case<'_>; 6] = [
        (&|i| [0.5, part(i)], 1e-9, 0.5),
        (&line, 1e-9, 0.5),
        (&crossed, 1e-9, f64::NAN),
        (&circle, 1e-5, f64::NAN),
        (&cluster, 0.1, far),
        (&|_| [0.5, 0.5], 0.1, far),
    ];
    for (index, (point, radius, covering)) in cases.into_iter().enumerate() {
        let points: Vec<_> = (0..N).map(point).collect();
        for boundary in BOTH {
            let report = report(&points, region(1.0, 1.0, boundary), radius);
            assert!(!report.maximal(), "{index}");
            assert_eq!(report.more_conflicts(), radius == 0.1, "{index}");
            let off = (report.covering_radius - covering).abs();
            assert!(
                covering.is_nan() || off < 1e-6,
                "{index}: {}",
                report.covering_radius
            );
        }
    }
}

/// A radius far too large for a set: the smallest distance is exact all the same.
#[test]
fn a_radius_far_too_large_costs_no_time() {
    let point = |i: u32| [0.754_877, 0.569_84].map(|step| (f64::from(i) * step).fract());
    let points: Vec<_> = (0..100_000).map(point).collect();
    let torus = region(1.0, 1.0, Boundary::Periodic);
    let right = report(&points, torus, 1e-9);
    let wrong = report(&points, torus, 0.5);
    assert_eq!(wrong.conflicts, MAX_CONFLICTS);
    assert_eq!(wrong.min_distance, right.min_distance);
    assert_eq!(wrong.covering_radius, right.covering_radius);
    assert_eq!(wrong.worst_conflicts[0].distance, right.min_distance);
}
