use std::ops::ControlFlow;

use proptest::prelude::*;
use tilescope_analysis::{Progress, VerifyError};

use super::*;

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// The greedy choice point by point, each compared with all that were kept before it.
fn one_by_one(cloud: &Cloud<'_>) -> Vec<bool> {
    let count = cloud.points.len();
    let mut order: Vec<usize> = (0..count).collect();
    if let Some(ranks) = cloud.ranks {
        order.sort_by_key(|&index| ranks[index]);
    }
    let mut kept: Vec<usize> = Vec::new();
    for index in order {
        let is_near = |&other: &usize| {
            let reach = near::Reach::between(cloud.radii.of(index), cloud.radii.of(other));
            let points = [index, other].map(|at| cloud.points[at]);
            reach.holds(near::offset(points[0], points[1], cloud.period()))
        };
        if !kept.iter().any(is_near) {
            kept.push(index);
        }
    }
    (0..count).map(|index| kept.contains(&index)).collect()
}

/// The choice on so many threads.
fn on_threads(cloud: &Cloud<'_>, threads: usize) -> Vec<bool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let pool = pool.build().expect("threads");
    pool.install(|| thin(cloud, &go_on)).expect("thinned")
}

/// Compares the choice with that point by point, and has it judged.
fn check(cloud: &Cloud<'_>) -> Result<(), TestCaseError> {
    let kept = on_threads(cloud, 1);
    prop_assert_eq!(&kept, &one_by_one(cloud));
    prop_assert_eq!(&kept, &on_threads(cloud, 3));
    let report = judge(cloud, &kept, &go_on).expect("judged");
    prop_assert!(report.valid(), "{:?}", report);
    prop_assert_eq!(
        report.kept,
        kept.iter().filter(|kept| **kept).count() as u64
    );

    // A point more, and a point less, are both seen.
    for index in 0..kept.len() {
        let mut altered = kept.clone();
        altered[index] = !altered[index];
        let report = judge(cloud, &altered, &go_on).expect("judged");
        prop_assert!(!report.valid());
        let fault = if kept[index] {
            report.uncovered
        } else {
            report.conflicts
        };
        prop_assert!(fault > 0, "{:?}", report);
    }
    Ok(())
}

/// A permutation that depends on a number.
fn permuted(count: usize, seed: u64) -> Option<Vec<u32>> {
    (!seed.is_multiple_of(3))
        .then(|| ranks(&ThinningPriority::Random { seed }, count, &[]).expect("a draw"))
}

/// Points on a coarse lattice, of which many are equal and many pairs are at the same distance, or anywhere.
fn points() -> impl Strategy<Value = Vec<[f64; 2]>> {
    let lattice = (0_u8..40, 0_u8..40).prop_map(|(x, y)| [x, y].map(|at| f64::from(at) * 0.1));
    let anywhere = (0.0..4.0, 0.0..4.0).prop_map(|(x, y)| [x, y]);
    prop_oneof![
        prop::collection::vec(lattice, 1..120),
        prop::collection::vec(anywhere, 1..120),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_choice_is_that_point_by_point(
        points in points(), step in 1_u8..12, seed in any::<u64>(), is_torus in any::<bool>()
    ) {
        let ranks = permuted(points.len(), seed);
        check(&Cloud {
            points: &points,
            radii: CloudRadii::Constant(f64::from(step) * 0.1),
            ranks: ranks.as_deref(),
            torus: is_torus.then_some(Torus { origin: [0.0; 2], sides: [4.0; 2] }),
        })?;
    }

    #[test]
    fn radii_that_differ_are_kept_by_their_harmonic_mean(
        points in points(), seed in any::<u64>(), contrast in 1_u32..80, is_torus in any::<bool>()
    ) {
        let ranks = permuted(points.len(), seed);
        let radius = |(index, _): (usize, &[f64; 2])| {
            0.04 * f64::from((index as u32).wrapping_mul(2_654_435_761) % contrast + 1)
        };
        let radii: Vec<f64> = points.iter().enumerate().map(radius).collect();
        check(&Cloud {
            points: &points,
            radii: CloudRadii::Each(&radii),
            ranks: ranks.as_deref(),
            torus: is_torus.then_some(Torus { origin: [0.0; 2], sides: [4.0; 2] }),
        })?;
    }
}

fn cloud(points: &[[f64; 2]], radius: f64) -> Cloud<'_> {
    Cloud {
        points,
        radii: CloudRadii::Constant(radius),
        ranks: None,
        torus: None,
    }
}

#[test]
fn points_exactly_a_radius_apart_stay() {
    let row: Vec<[f64; 2]> = (0..9).map(|at| [f64::from(at), 0.0]).collect();
    let kept = |radius| thin(&cloud(&row, radius), &go_on).expect("thinned");
    assert_eq!(kept(1.0), [true; 9]);
    assert_eq!(
        kept(1.0_f64.next_up()),
        [true, false, true, false, true, false, true, false, true]
    );
}

#[test]
fn of_copies_the_first_by_rank_stays() {
    let points = [[0.3, 0.7]; 5];
    let ranks = [4, 2, 0, 1, 3];
    let cloud = Cloud {
        ranks: Some(&ranks),
        ..cloud(&points, 1e-9)
    };
    let kept = thin(&cloud, &go_on).expect("thinned");
    assert_eq!(kept, [false, false, true, false, false]);
    // Another copy covers the same places, but was not the first.
    let other = [true, false, false, false, false];
    assert_eq!(judge(&cloud, &other, &go_on).expect("judged").uncovered, 4);
}

#[test]
fn a_point_far_from_all_others_costs_nothing() {
    let mut points: Vec<[f64; 2]> = (0..5000).map(|at| [f64::from(at) * 1e-3, 0.5]).collect();
    points.push([1e6, -1e6]);
    let cloud = cloud(&points, 0.01);
    let kept = thin(&cloud, &go_on).expect("thinned");
    assert!(kept[5000] && judge(&cloud, &kept, &go_on).expect("judged").valid());
}

#[test]
fn what_cannot_be_thinned_is_refused_in_words() {
    let refusal = |cloud: &Cloud<'_>| thin(cloud, &go_on).expect_err("refused").to_string();
    let two = [[0.0, 0.0], [1.0, 0.0]];
    assert_eq!(refusal(&cloud(&[], 1.0)), "there is no point to keep");
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-40] {
        assert!(
            refusal(&cloud(&two, radius)).contains("it must be above 0"),
            "{radius}"
        );
    }
    assert!(refusal(&cloud(&two, 1e-12)).contains("the points reach over 1"));
    assert!(refusal(&cloud(&[[-1e308, 0.0], [1e308, 0.0]], 1.0)).contains("reach over"));
    let torus = Some(Torus {
        origin: [0.0; 2],
        sides: [4.0, 2.0],
    });
    let wide = Cloud {
        torus,
        ..cloud(&two, 3.0)
    };
    assert!(refusal(&wide).contains("the radius 3 is more than 2"));
    let stopped = thin(&cloud(&two, 1.0), &|_| ControlFlow::Break(()));
    assert_eq!(stopped, Err(ThinError::Cancelled));
    let stopped = judge(
        &cloud(&two, 1.0),
        &[true, true],
        &|_| ControlFlow::Break(()),
    );
    assert_eq!(stopped, Err(VerifyError::Cancelled));
}
