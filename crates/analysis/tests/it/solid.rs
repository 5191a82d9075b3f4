//! The judge by cubes against the definition: all pairs, and places on a fine grid; lattices whose covering radius is
//! known; faults that were planted.

#![allow(clippy::float_cmp, reason = "the judge computes what is computed here")]

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use proptest::prelude::*;
use tilescope_analysis::{
    Boundary, Judge, JudgeChoice, Progress, SolidError, SolidGap, SolidRegion, SolidReport,
    VerifyOptions, measure_solid, verify_solid,
};

use crate::support::{BOTH, Random, go_on, on_threads};

fn region([width, height, depth]: [f64; 3], boundary: Boundary) -> SolidRegion {
    SolidRegion {
        width,
        height,
        depth,
        boundary,
    }
}

fn judged(points: &[[f64; 3]], region: SolidRegion, radius: f64) -> SolidReport {
    let options = VerifyOptions::default();
    verify_solid(points, region, radius, &options, &go_on).expect("a report")
}

fn distance(region: &SolidRegion, a: [f64; 3], b: [f64; 3]) -> f64 {
    let squared = |axis: usize| {
        let plain = (a[axis] - b[axis]).abs();
        let around = region.size()[axis] - plain;
        let periodic = region.boundary == Boundary::Periodic;
        (if periodic { plain.min(around) } else { plain }).powi(2)
    };
    (squared(0) + squared(1) + squared(2)).sqrt()
}

fn nearest(region: &SolidRegion, points: &[[f64; 3]], place: [f64; 3]) -> f64 {
    let distances = points.iter().map(|&point| distance(region, point, place));
    distances.fold(f64::INFINITY, f64::min)
}

/// Compares a report with all pairs and with places on a grid.
fn check(points: &[[f64; 3]], region: SolidRegion, radius: f64) -> SolidReport {
    let report = judged(points, region, radius);
    let (mut conflicts, mut least) = (0, f64::INFINITY);
    for (k, &a) in points.iter().enumerate() {
        for &b in &points[..k] {
            let apart = distance(&region, a, b);
            least = least.min(apart);
            conflicts += u64::from(apart < radius);
        }
    }
    if region.boundary == Boundary::Periodic {
        let shortest = region.size().into_iter().fold(f64::INFINITY, f64::min);
        least = least.min(shortest);
    }
    assert_eq!((report.conflicts, report.min_distance), (conflicts, least));
    let listed = conflicts.min(16) as usize;
    assert_eq!(report.worst_conflicts.len(), listed);
    if let Some(worst) = report.worst_conflicts.first() {
        assert_eq!(worst.distance, least);
    }

    // The places that circles find lie on spheres of the limit.
    if let Some(circles) = by_circles(points, region, radius) {
        assert_eq!(circles.maximal(), report.maximal());
        assert!((circles.min_distance - least).abs() <= 1e-12 * least);
        for gap in &circles.worst_gaps {
            assert!(
                gap.distance >= report.covering_bound() * (1.0 - 1e-9),
                "{gap:?}"
            );
            assert!(region.contains(gap.center), "{gap:?}");
        }
        assert_eq!(report.judges, [Judge::Subdivision, Judge::Circles]);
    }

    // Whatever is said to be uncovered is, and if nothing is, every place is covered.
    for gap in &report.worst_gaps {
        let apart = nearest(&region, points, gap.center);
        assert!(apart > radius && apart == gap.distance, "{gap:?}");
        assert!(region.contains(gap.center), "{gap:?}");
    }
    assert_eq!(report.gaps == 0, report.worst_gaps.is_empty());
    if report.maximal() {
        let step = |axis: usize, k: u32| region.size()[axis] * f64::from(k) / 15.0;
        for k in 0..15_u32.pow(3) {
            let place = [step(0, k % 15), step(1, k / 15 % 15), step(2, k / 225)];
            assert!(nearest(&region, points, place) <= report.covering_bound());
        }
    }
    report
}

fn by(judges: JudgeChoice, points: &[[f64; 3]], region: SolidRegion, radius: f64) -> SolidReport {
    let options = VerifyOptions {
        judges,
        ..VerifyOptions::default()
    };
    verify_solid(points, region, radius, &options, &go_on).expect("a report")
}

/// The verdict of covered circles alone; `None` if they decline the set.
fn by_circles(points: &[[f64; 3]], region: SolidRegion, radius: f64) -> Option<SolidReport> {
    let report = by(JudgeChoice::Circles, points, region, radius);
    Some(report).filter(|report| report.judges == [Judge::Circles])
}

/// Sets of few points, some of them at one place, in a plane, on a line, or in a corner; some cover everything.
fn sets() -> impl Strategy<Value = (Vec<[f64; 3]>, SolidRegion)> {
    let extent = prop_oneof![3 => 2.1..5.0_f64, 1 => 10.0..40.0_f64];
    let parts = (
        prop::array::uniform3(extent),
        any::<bool>(),
        0_u8..7,
        1_usize..140,
        any::<u64>(),
    );
    parts.prop_map(|(size, is_periodic, kind, count, seed)| {
        let boundary = BOTH[usize::from(!is_periodic)];
        let region = region(size, boundary);
        let mut random = Random::new(seed);
        let mut point = |k: usize| {
            let [x, y, z] = [0, 1, 2].map(|axis| random.uniform() * size[axis] * 0.999_999);
            match kind {
                0 => [x, y, 0.0],
                1 => [x, 0.0, size[2] * 0.5],
                2 => [x * 0.01, y * 0.01, z * 0.01],
                3 if !k.is_multiple_of(3) => [0.25, 0.5, 0.75],
                // On the corners of a grid, and so at one place, too.
                4 => [x, y, z].map(|value| (value * 2.0).floor() / 2.0),
                _ => [x, y, z],
            }
        };
        ((0..count).map(&mut point).collect(), region)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(512), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn reports_say_what_all_pairs_and_places_say((points, region) in sets(), radius in 0.2..1.0_f64) {
        check(&points, region, radius);
        // The same set under another radius is nearly always complete, and full of conflicts.
        let shortest = region.size().into_iter().fold(f64::INFINITY, f64::min);
        check(&points, region, 0.49 * shortest);
        // Without conflicts both judge.
        let least = judged(&points, region, radius).min_distance;
        if least > 0.01 {
            check(&points, region, least.min(0.49 * shortest));
        }
    }
}

/// A lattice of cubes of edge 1, with points in their middles or on their faces: its covering radius is known.
fn lattice(cubes: i32, offsets: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let axis = |k: i32, step: i32| f64::from(k / step % cubes);
    let corners = (0..cubes.pow(3)).map(|k| [axis(k, 1), axis(k, cubes), axis(k, cubes * cubes)]);
    let place = |corner: [f64; 3], offset: &[f64; 3]| [0, 1, 2].map(|i| corner[i] + offset[i]);
    let all = corners.flat_map(|corner| offsets.iter().map(move |offset| place(corner, offset)));
    all.collect()
}

#[test]
fn lattices_are_maximal_from_their_covering_radius_on() {
    let half = 0.5;
    let primitive = [[0.0; 3]].to_vec();
    let centred = [[0.0; 3], [half; 3]].to_vec();
    let faces = [
        [0.0; 3],
        [half, half, 0.0],
        [half, 0.0, half],
        [0.0, half, half],
    ]
    .to_vec();
    for (offsets, spacing, covering) in [
        (primitive, 1.0, 0.75_f64.sqrt()),
        (centred, 0.75_f64.sqrt(), 5.0_f64.sqrt() / 4.0),
        (faces, 0.5_f64.sqrt(), 0.5),
    ] {
        let points = lattice(4, &offsets);
        let torus = region([4.0; 3], Boundary::Periodic);
        let tolerant = 1.0 + 1.0 / 32_768.0;
        for (share, maximal) in [(1.000_000_1, true), (0.999_999_9, false)] {
            let report = judged(&points, torus, covering / tolerant * share);
            assert_eq!(
                (report.maximal(), report.conflicts),
                (maximal, 0),
                "{share}"
            );
            assert!((report.min_distance - spacing).abs() < 1e-12);
        }
        // Two of the three have conflicts at a radius above their spacing.
        let report = judged(&points, torus, spacing * 1.000_000_1);
        assert!(report.conflicts as usize >= 3 * points.len() && report.maximal());
    }
}

/// A cube of the search fits into one ball and holds two samples: the conflict has to be seen although nothing is uncovered.
#[test]
fn conflicts_are_found_in_cubes_that_one_sample_covers() {
    let mut random = Random::new(4);
    for boundary in BOTH {
        // Whole cubes of the search lie in the ball of each of these samples.
        let points = lattice(5, &[[0.5; 3]]);
        let region = region([5.0; 3], boundary);
        assert!(judged(&points, region, 1.0).valid());
        for _ in 0..100 {
            let index = (random.uniform() * points.len() as f64) as usize;
            let near = points[index].map(|value| value + (random.uniform() - 0.5) * 0.99);
            let more = [points.as_slice(), &[near]].concat();
            let report = by(JudgeChoice::Subdivision, &more, region, 1.0);
            assert!(report.maximal() && !report.conflict_free());
            let pairs = report.worst_conflicts.iter().map(|c| (c.first, c.second));
            assert!(
                pairs.clone().any(|pair| pair == (index, points.len())),
                "{near:?}"
            );
            assert_eq!(report.conflicts as usize, pairs.count());
            assert_eq!(report.min_distance, report.worst_conflicts[0].distance);
        }
    }
}

/// Without one of its samples a lattice of spacing 1 leaves a hole of some ten thousandths of the radius around its place.
#[test]
fn each_planted_hole_is_found() {
    let mut random = Random::new(9);
    for boundary in BOTH {
        let points = lattice(6, &[[0.5; 3]]);
        let region = region([6.0; 3], boundary);
        assert!(judged(&points, region, 0.9999).valid());
        for _ in 0..100 {
            let index = (random.uniform() * points.len() as f64) as usize;
            let (mut fewer, place) = (points.clone(), points[index]);
            fewer.swap_remove(index);
            let circles = by_circles(&fewer, region, 0.9999).expect("a verdict");
            assert!(circles.conflict_free() && circles.gaps > 0, "{circles:?}");
            let report = judged(&fewer, region, 0.9999);
            assert_eq!(report.judges, [Judge::Subdivision, Judge::Circles]);
            assert!(report.conflict_free() && !report.maximal());
            let away = distance(&region, report.worst_gaps[0].center, place);
            // At a border the hole reaches up to it.
            let wide = if boundary == Boundary::Periodic {
                0.01
            } else {
                1.0
            };
            assert!(away < wide, "{away}");
        }
    }
}

/// Holes are listed by their depth, and not as they are found: the deepest has its deepest place.
#[test]
fn the_deepest_hole_comes_first() {
    let (points, radius) = (lattice(8, &[[0.5; 3]]), 0.9999);
    let number = |x: usize, y: usize, z: usize| {
        let wanted = [x, y, z].map(|at| at as f64 + 0.5);
        let is_there = |point: &[f64; 3]| {
            distance(&region([8.0; 3], Boundary::Periodic), *point, wanted) < 1e-9
        };
        points
            .iter()
            .position(is_there)
            .expect("a sample of the lattice")
    };
    // A single sample is missing near the beginning of the region, and eight that are neighbours near its end.
    let shallow = vec![number(1, 1, 1)];
    let corners = (0..8).map(|at| number(5 + at % 2, 5 + at / 2 % 2, 5 + at / 4));
    let both: Vec<usize> = shallow.iter().copied().chain(corners).collect();

    let without = |missing: &[usize]| -> Vec<[f64; 3]> {
        let all = points.iter().enumerate();
        all.filter(|(index, _)| !missing.contains(index))
            .map(|(_, point)| *point)
            .collect()
    };
    for boundary in BOTH {
        let region = region([8.0; 3], boundary);
        for judges in [JudgeChoice::Subdivision, JudgeChoice::Circles] {
            let options = VerifyOptions {
                judges,
                ..VerifyOptions::default()
            };
            let measured = |missing: &[usize]| {
                measure_solid(&without(missing), region, radius, false, &options, &go_on)
                    .expect("a verdict")
            };
            let found = measured(&both);
            let gaps = &found.report.worst_gaps;
            assert!(
                gaps.is_sorted_by(|a, b| a.distance >= b.distance),
                "{gaps:?}"
            );
            // The place between the eight is farther from all others than any place of the single hole.
            assert!(
                distance(&region, gaps[0].center, [6.0; 3]) < 0.01,
                "{gaps:?}"
            );
            assert_eq!(gaps[0].distance, found.covering_radius);
            let is_of_single = |gap: &&SolidGap| distance(&region, gap.center, [1.5; 3]) < 0.6;
            assert_eq!(gaps.iter().filter(is_of_single).count(), 1, "{gaps:?}");

            // The control: without the deep hole, the shallow one is the first.
            let gaps = measured(&shallow).report.worst_gaps;
            assert!(
                distance(&region, gaps[0].center, [1.5; 3]) < 0.6,
                "{gaps:?}"
            );
        }
    }
}

#[test]
fn the_report_does_not_depend_on_the_number_of_threads() {
    let mut random = Random::new(2);
    let size = [30.0, 14.0, 11.0];
    let region = region(size, Boundary::Periodic);
    let points: Vec<[f64; 3]> = (0..9_000)
        .map(|_| size.map(|extent| random.uniform() * extent))
        .collect();
    let alone = on_threads(1, || judged(&points, region, 0.7));
    assert!(alone.gaps > 10 && alone.conflicts > 10_000);
    for threads in [2, 5] {
        assert_eq!(on_threads(threads, || judged(&points, region, 0.7)), alone);
    }
}

/// Also of a set that circles decline, since it has conflicts, and that cubes judge then.
#[test]
fn progress_ends_at_all_work_and_never_passes_it() {
    let points = lattice(4, &[[0.0; 3]]);
    let region = region([4.0; 3], Boundary::Periodic);
    for judges in [
        JudgeChoice::Automatic,
        JudgeChoice::Subdivision,
        JudgeChoice::Circles,
    ] {
        for (radius, is_free) in [(1.0, true), (1.1, false)] {
            let options = VerifyOptions {
                judges,
                ..VerifyOptions::default()
            };
            let most = AtomicU64::new(0);
            let control = |progress: Progress| {
                assert!(progress.done <= progress.total, "{progress:?}");
                most.fetch_max(progress.done, Ordering::Relaxed);
                ControlFlow::Continue(())
            };
            let report =
                verify_solid(&points, region, radius, &options, &control).expect("a report");
            assert_eq!(report.conflict_free(), is_free);
            // A pass counts each of the 64 samples once.
            assert!(most.into_inner() >= 64, "{judges:?}");
        }
    }
}

/// More conflicts than are counted, in a clump whose nearest pair is far nearer than the radius.
#[test]
fn crowds_are_judged() {
    let mut random = Random::new(8);
    let mut points: Vec<[f64; 3]> = (0..3_000)
        .map(|_| [0, 1, 2].map(|_| 5.0 + 1e-6 * random.uniform()))
        .collect();
    let region = region([40.0; 3], Boundary::Bounded);
    let report = judged(&points, region, 1.0);
    assert!(report.more_conflicts() && report.gaps > 0);
    let least = points
        .iter()
        .enumerate()
        .fold(f64::INFINITY, |least, (k, &a)| {
            let others = points[..k].iter().map(|&b| distance(&region, a, b));
            others.fold(least, f64::min)
        });
    assert_eq!(report.min_distance, least);
    points.push(points[7]);
    assert_eq!(judged(&points, region, 1.0).min_distance, 0.0);
}

#[test]
fn what_cannot_be_judged_is_refused_with_value_and_limit() {
    let refused = |points: &[[f64; 3]], region: SolidRegion, radius: f64| {
        let options = VerifyOptions::default();
        let error = verify_solid(points, region, radius, &options, &go_on);
        error.expect_err("a refusal").to_string()
    };
    let cube = region([8.0; 3], Boundary::Periodic);
    let inside = [[1.0; 3]];
    assert!(refused(&[], cube, 1.0).contains("empty"));
    assert!(refused(&[[1.0, f64::NAN, 1.0]], cube, 1.0).contains("sample 0 at (1, NaN, 1)"));
    let outside = refused(&[[1.0; 3], [1.0, 1.0, 8.0]], cube, 1.0);
    assert!(outside.contains("sample 1 at (1, 1, 8) lies outside the region periodic [0, 8) x"));
    assert!(refused(&inside, cube, 0.0).contains("radius 0"));
    assert!(refused(&inside, cube, 4.1).contains("shortest side of the periodic region is 8"));
    let long = region([8.0, 8.0, 1e8], Boundary::Bounded);
    assert!(refused(&inside, long, 1.0).contains("8 x 8 x 100000000 is not supported"));

    let options = VerifyOptions {
        judges: JudgeChoice::Delaunay,
        ..VerifyOptions::default()
    };
    let refused = verify_solid(&inside, cube, 1.0, &options, &go_on).expect_err("a refusal");
    let said = refused.to_string();
    assert!(said.contains("judge delaunay") && said.contains("subdivision, circles or both"));
    let stop = |_| std::ops::ControlFlow::Break(());
    let stopped = verify_solid(&inside, cube, 1.0, &VerifyOptions::default(), &stop);
    assert_eq!(stopped, Err(SolidError::Cancelled));
}
