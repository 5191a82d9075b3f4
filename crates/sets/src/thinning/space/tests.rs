use std::ops::ControlFlow;

use proptest::prelude::*;
use tilescope_analysis::Progress;

use super::super::{ThinningPriority, near::Reach, ranks};
use super::*;

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// The greedy choice point by point, each compared with all that were kept before it.
fn one_by_one(cloud: &SpaceCloud<'_>) -> Vec<bool> {
    let count = cloud.points.len();
    let mut order: Vec<usize> = (0..count).collect();
    if let Some(ranks) = cloud.ranks {
        order.sort_by_key(|&index| ranks[index]);
    }
    let reach = Reach::of(cloud.radius);
    let mut kept: Vec<usize> = Vec::new();
    for index in order {
        let is_near = |&other: &usize| {
            let (a, b) = (cloud.points[index], cloud.points[other]);
            reach.holds([0, 1, 2].map(|axis| a[axis] - b[axis]))
        };
        if !kept.iter().any(is_near) {
            kept.push(index);
        }
    }
    (0..count).map(|index| kept.contains(&index)).collect()
}

fn on_threads(cloud: &SpaceCloud<'_>, threads: usize) -> Vec<bool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let pool = pool.build().expect("threads");
    pool.install(|| thin_space(cloud, &go_on)).expect("thinned")
}

/// Points on a coarse lattice, of which many are equal and many pairs are at the same distance, or anywhere, far from 0 or near.
fn points() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let lattice = (0_u8..12, 0_u8..12, 0_u8..12)
        .prop_map(|(x, y, z)| [x, y, z].map(|at| f64::from(at) * 0.25 - 1.0));
    let anywhere = (0.0..3.0, 100.0..103.0, -1.0..1.0).prop_map(|(x, y, z)| [x, y, z]);
    prop_oneof![
        prop::collection::vec(lattice, 1..200),
        prop::collection::vec(anywhere, 1..200),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_choice_in_space_is_that_point_by_point(
        points in points(), step in 1_u8..12, seed in any::<u64>()
    ) {
        let drawn = ThinningPriority::Random { seed };
        let ranks = ranks(&drawn, points.len(), &[]).filter(|_| !seed.is_multiple_of(3));
        let radius = f64::from(step) * 0.25;
        let cloud = SpaceCloud { points: &points, radius, ranks: ranks.as_deref() };
        let kept = on_threads(&cloud, 1);
        prop_assert_eq!(&kept, &one_by_one(&cloud));
        prop_assert_eq!(&kept, &on_threads(&cloud, 3));
        let report = judge_space(&cloud, &kept, &go_on).expect("judged");
        prop_assert!(report.valid(), "{:?}", report);

        // A point more, and a point less, are both seen.
        for index in 0..kept.len() {
            let mut altered = kept.clone();
            altered[index] = !altered[index];
            let report = judge_space(&cloud, &altered, &go_on).expect("judged");
            let fault = if kept[index] { report.uncovered } else { report.conflicts };
            prop_assert!(fault > 0, "{:?}", report);
        }
    }
}

/// A row of points, of which each waits for the next one, over the borders of all bands.
#[test]
fn chains_across_bands_are_followed() {
    let row: Vec<[f64; 3]> = (0..4000).map(|at| [0.0, 0.0, f64::from(at)]).collect();
    let backwards: Vec<u32> = (0..4000).rev().collect();
    for ranks in [None, Some(backwards.as_slice())] {
        let cloud = SpaceCloud {
            points: &row,
            radius: 1.5,
            ranks,
        };
        let kept = on_threads(&cloud, 3);
        let is_first = |at: usize| at.is_multiple_of(2) == ranks.is_none();
        assert!(
            kept.iter()
                .enumerate()
                .all(|(at, kept)| *kept == is_first(at))
        );
    }
}

#[test]
fn points_a_radius_apart_stay_and_a_far_one_costs_nothing() {
    let mut points: Vec<[f64; 3]> = (0..5000)
        .map(|at| [0.5, 0.5, f64::from(at) * 0.5])
        .collect();
    points.push([1e6, -1e6, 1e6]);
    let thinned = |radius| {
        let cloud = SpaceCloud {
            points: &points,
            radius,
            ranks: None,
        };
        let kept = thin_space(&cloud, &go_on).expect("thinned");
        assert!(judge_space(&cloud, &kept, &go_on).expect("judged").valid());
        kept.into_iter().filter(|kept| *kept).count()
    };
    assert_eq!(thinned(0.5), 5001);
    assert_eq!(thinned(0.5_f64.next_up()), 2501);
}

#[test]
fn what_cannot_be_thinned_in_space_is_refused_in_words() {
    let said = |points: &[[f64; 3]], radius| {
        let cloud = SpaceCloud {
            points,
            radius,
            ranks: None,
        };
        thin_space(&cloud, &go_on).expect_err("refused").to_string()
    };
    let two = [[0.0; 3], [0.0, 0.0, 1.0]];
    assert_eq!(said(&[], 1.0), "there is no point to keep");
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-40] {
        assert!(
            said(&two, radius).contains("it must be above 0"),
            "{radius}"
        );
    }
    assert!(said(&two, 1e-12).contains("the points reach over 1"));
    let cloud = SpaceCloud {
        points: &two,
        radius: 1.0,
        ranks: None,
    };
    let stopped = thin_space(&cloud, &|_| ControlFlow::Break(()));
    assert_eq!(stopped, Err(ThinError::Cancelled));
}
