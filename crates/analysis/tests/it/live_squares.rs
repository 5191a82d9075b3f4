//! The judge by squares for samples that come and go, against the judge of all of them, at every moment.

use proptest::prelude::*;
use tilescope_analysis::LiveSquares;
use tilescope_analysis::live::{LiveSample, Renewal};
use tilescope_analysis::{LatticeRegion, Radii, Shape, SquaresJudge};

use crate::squares::{cases, filled};
use crate::support::{Random, go_on};

/// Returns the conflicts and the open places that the judge of all samples finds.
fn judged(judge: &SquaresJudge, samples: &[LiveSample]) -> [u64; 2] {
    let places: Vec<[i32; 2]> = samples.iter().map(|&(_, place)| place).collect();
    let report = judge.judge(&places, 0, &go_on).expect("a report");
    [report.conflicts, report.uncovered]
}

fn counts(live: &LiveSquares) -> [u64; 2] {
    [live.conflicts(), live.open_places()]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(128), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn counts_are_those_of_the_judge_at_every_moment(case in cases(), seed in any::<u64>()) {
        let judge = case.judge();
        let mut live = LiveSquares::new(&judge).expect("few squares");
        let (mut random, places) = (Random::new(seed), case.places());
        let mut below = |count: usize| (random.uniform() * count as f64) as usize;
        let mut present: Vec<LiveSample> = Vec::new();
        prop_assert_eq!(counts(&live), judged(&judge, &present));
        if places.is_empty() {
            return Ok(());
        }

        for sample in 0..40 {
            // Forwards more often than backwards, so that the domain fills.
            if below(5) < 2 && !present.is_empty() {
                let (sample, place) = present.swap_remove(below(present.len()));
                live.remove(sample, place);
            } else {
                let place = places[below(places.len())];
                live.insert(sample, place);
                present.push((sample, place));
            }
            prop_assert_eq!(live.count(), present.len());
            prop_assert_eq!(counts(&live), judged(&judge, &present));
        }

        // Made anew at once, and in slices.
        let mut renewal = Renewal::of(&live, present.clone());
        while !renewal.is_made() {
            renewal.proceed();
        }
        prop_assert_eq!(counts(&renewal.finish()), judged(&judge, &present));
        live.rebuild(&present);
        prop_assert_eq!(counts(&live), judged(&judge, &present));
    }
}

#[test]
fn a_change_that_is_left_out_shows() {
    let region = LatticeRegion {
        width: 400,
        height: 300,
        boundary: tilescope_analysis::Boundary::Periodic,
    };
    let judge = SquaresJudge::new(region, Radii::Constant(20), &Shape::Rectangle).expect("a judge");
    let mut live = LiveSquares::new(&judge).expect("few squares");
    let samples = [(0, [50, 50]), (1, [65, 50]), (2, [200, 150])];
    for (sample, place) in samples {
        live.insert(sample, place);
    }
    assert_eq!(counts(&live), judged(&judge, &samples));
    assert_eq!(live.conflicts(), 1);

    // The control: of fewer samples the judge counts something else.
    assert_ne!(counts(&live)[0], judged(&judge, &samples[1..])[0]);
    assert_ne!(counts(&live)[1], judged(&judge, &samples[..2])[1]);
}

/// Of many samples the judge begins with squares that are smaller than the radius in a part of the region: each is a hole of its
/// own there.
#[test]
fn many_samples_in_a_part_leave_as_many_holes_as_the_judge_counts() {
    let region = LatticeRegion {
        width: 1 << 12,
        height: 1 << 11,
        boundary: tilescope_analysis::Boundary::Periodic,
    };
    // Nodes of 16 columns and 8 rows: in the right half radii beyond 2^9, the side of the squares that few samples have.
    let radius = |node: usize| {
        if (9..15).contains(&(node % 16)) {
            600
        } else {
            12
        }
    };
    let nodes: Vec<i32> = (0..16 * 8).map(radius).collect();
    let radii = Radii::Nodes {
        pitch_bits: 8,
        columns: 16,
        nodes: &nodes,
    };
    let judge = SquaresJudge::new(region, radii, &Shape::Rectangle).expect("a judge");
    let mut live = LiveSquares::new(&judge).expect("few squares");
    let few = counts(&live)[1];
    assert_eq!(few, judged(&judge, &[])[1]);

    // 2^16 samples in the left half, 8 apart.
    let place = |index: u32| [8 * (index % 256) as i32, 8 * (index / 256) as i32];
    let samples: Vec<LiveSample> = (0..1 << 16).map(|index| (index, place(index))).collect();
    live.rebuild(&samples);
    let many = counts(&live)[1];
    assert_eq!(many, judged(&judge, &samples)[1]);
    // The control: the squares of few samples would count fewer holes than there are now.
    assert!(many > few, "{many} {few}");
}

#[test]
fn a_field_with_too_many_squares_is_not_followed() {
    // A large domain with a tiny radius: more than a million squares.
    let region = LatticeRegion {
        width: 1 << 12,
        height: 1 << 12,
        boundary: tilescope_analysis::Boundary::Bounded,
    };
    let of = |radius| {
        let judge = SquaresJudge::new(region, Radii::Constant(radius), &Shape::Rectangle);
        LiveSquares::new(&judge.expect("a judge"))
    };
    assert!(of(3).is_none() && of(40).is_some());
}

#[test]
fn steps_are_about_those_that_are_announced() {
    let region = LatticeRegion {
        width: 3_000,
        height: 2_000,
        boundary: tilescope_analysis::Boundary::Periodic,
    };
    let (judge, places) = filled(region, 96);
    let samples: Vec<LiveSample> = (0..).zip(places).collect();
    let mut live = LiveSquares::new(&judge).expect("few squares");
    let anew = live.rebuild(&samples);
    let announced = live.cost_of_rebuild(samples.len());

    let mut changes = 0;
    for &(sample, place) in &samples[..300] {
        changes += live.remove(sample, place);
        changes += live.insert(sample, place);
    }
    assert_eq!(counts(&live), [0, 0]);
    let of_change = changes / 600;

    // Otherwise moments would be made anew where changes are quicker, or the other way round.
    let is_about = |steps: u64, expected: u64| steps <= 3 * expected && expected <= 3 * steps;
    let are_about = is_about(of_change, live.cost_of_change()) && is_about(anew, announced);
    assert!(
        are_about,
        "a change {of_change}, anew {anew} of {announced}"
    );

    // No slice takes a frame.
    let mut renewal = Renewal::of(&live, samples.clone());
    let mut largest = 0;
    while !renewal.is_made() {
        largest = largest.max(renewal.proceed());
    }
    assert!(largest < 20_000, "{largest}");
}
