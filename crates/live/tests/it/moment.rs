//! The measures of a moment are those of its samples measured from nothing, wherever the cursor came from.

use tilescope_analysis::measures::{CATALOGUE, MeasuredSet, Part};
use tilescope_live::{LiveMoment, Wanted};

use crate::support::{course, cursors, from_nothing, variants};

const DISTANCES: Wanted = Wanted {
    spectrum: false,
    thinned: false,
    pairs: true,
    cover: true,
};

/// Returns the numbers of both sets that differ, by more than rounding or as counts.
fn differences(found: &MeasuredSet, expected: &MeasuredSet, part: Part) -> Vec<String> {
    let numbers = CATALOGUE.iter();
    let of_part = numbers.filter(|number| number.needs.is_none_or(|needs| needs == part));
    let differs = of_part.filter_map(|number| {
        let (a, b) = (number.of(found), number.of(expected));
        let is_near = match (a, b) {
            // The lattice's side is rounded to whole units, at least 327,680 of them.
            (Some(a), Some(b)) if number.decimals > 0 => (a - b).abs() <= 2e-6 * b.abs(),
            (Some(a), Some(b)) => a.to_bits() == b.to_bits(),
            (None, None) => true,
            (Some(_), None) | (None, Some(_)) => false,
        };
        (!is_near).then(|| format!("{}: {a:?} {b:?}", number.key))
    });
    differs.collect()
}

#[test]
fn distances_and_cover_are_those_of_the_judges_at_every_moment() {
    for parameters in variants() {
        let course = course(&parameters);
        let mut moment = LiveMoment::new(course.clone());
        for cursor in cursors(course.events()) {
            let moved = moment.seek(cursor, DISTANCES, u64::MAX).unwrap();
            assert!(moved.arrived);
            let expected = from_nothing(&course, cursor, &[Part::Report]);
            let found = differences(&moment.measured(), &expected, Part::Report);
            assert_eq!(found, Vec::<String>::new(), "{parameters:?} {cursor}");
        }
    }
}

/// The control: a measure of the moment before is told apart.
#[test]
fn the_comparison_finds_a_sample_that_is_missing() {
    let course = course(&variants()[0]);
    let mut moment = LiveMoment::new(course.clone());
    for change in course.changes().iter().skip(100).step_by(100) {
        let cursor = change.event as usize + 1;
        moment.seek(cursor - 1, DISTANCES, u64::MAX).unwrap();
        let expected = from_nothing(&course, cursor, &[Part::Report]);
        assert!(!differences(&moment.measured(), &expected, Part::Report).is_empty());
    }
}

#[test]
fn what_the_budget_does_not_reach_is_not_the_moments() {
    let course = course(&variants()[0]);
    let mut moment = LiveMoment::new(course.clone());
    let all = Wanted {
        spectrum: true,
        ..DISTANCES
    };

    // One step takes one change of the first measure, and none of the others.
    let moved = moment.seek(course.events(), all, 1).unwrap();
    assert!(!moved.arrived && moved.steps > 0);
    assert!(moment.pairs().is_none() && moment.cover().is_none() && moment.spectrum().is_none());
    assert_eq!(moment.count(), course.final_count());

    // Calls with the same cursor arrive, in slices of about the budget.
    let mut calls = 0;
    while !moment.seek(course.events(), all, 20_000).unwrap().arrived {
        calls += 1;
        assert!(calls < 10_000);
    }
    assert!(calls > 0);
    assert!(moment.pairs().is_some() && moment.cover().is_some() && moment.spectrum().is_some());

    // A step back takes all of them from there.
    let moved = moment.seek(0, Wanted::default(), 0).unwrap();
    assert_eq!((moved.steps, moved.arrived), (0, true));
    assert!(moment.pairs().is_none() && moment.measured().report.is_none());
}

/// A run that is played faster than its spectrum can follow has the spectrum of the moment that was reached, under that moment's
/// cursor.
#[test]
fn a_spectrum_that_stays_behind_is_that_of_its_own_moment() {
    let course = course(&variants()[0]);
    let mut moment = LiveMoment::new(course.clone());
    let wanted = Wanted {
        spectrum: true,
        ..Wanted::default()
    };
    moment.seek(course.events() / 4, wanted, u64::MAX).unwrap();
    assert!(moment.measured_behind().is_none());

    let mut behind = 0;
    for part in 1..=20 {
        let cursor = course.events() / 4 + part * course.events() / 40;
        moment.seek(cursor, wanted, 500).unwrap();
        let Some((reached, found)) = moment.measured_behind() else {
            continue;
        };
        behind += 1;
        let mut anew = LiveMoment::new(course.clone());
        let mut power_at = |cursor| {
            anew.seek(cursor, wanted, u64::MAX).unwrap();
            anew.measured().spectrum.unwrap().picture.power.clone()
        };
        let furthest = |expected: &[f64], power: &[f64]| {
            let each = power.iter().zip(expected).map(|(a, b)| (a - b).abs());
            each.fold(0.0, f64::max)
        };
        let power = &found.spectrum.as_ref().unwrap().picture.power;
        // The sums of a spectrum that changes are rounded to single precision at each change.
        assert!(furthest(&power_at(reached), power) < 1e-3, "{cursor}");
        // The control: the moment that was asked for has another one.
        assert!(furthest(&power_at(cursor), power) > 0.1, "{cursor}");
        assert_ne!(
            found.samples,
            course.count_after(course.changes_before(cursor))
        );
    }
    assert!(behind > 3, "{behind}");
}

/// No call does more than its budget and a slice, wherever it goes, and a moment that it reaches is that from nothing.
#[test]
fn a_far_moment_is_reached_in_slices_of_the_budget() {
    const BUDGET: u64 = 5_000;
    let all = Wanted {
        spectrum: true,
        ..DISTANCES
    };
    let course = course(&variants()[0]);
    let mut moment = LiveMoment::new(course.clone());
    let mut most_calls = 0;

    for cursor in cursors(course.events()) {
        let mut calls = 0;
        loop {
            let moved = moment.seek(cursor, all, BUDGET).unwrap();
            // A slice is a change at most, and that of a sample at the rim of a large hole takes a few thousand steps.
            assert!(moved.steps <= 3 * BUDGET, "{cursor}: {}", moved.steps);
            calls += 1;
            assert!(calls < 10_000, "{cursor}");
            if moved.arrived {
                break;
            }
        }
        most_calls = most_calls.max(calls);
        let expected = from_nothing(&course, cursor, &[Part::Report]);
        let found = differences(&moment.measured(), &expected, Part::Report);
        assert_eq!(found, Vec::<String>::new(), "{cursor}");
    }
    assert!(most_calls > 4, "{most_calls}");
}

/// Time that goes back and forth does not wait for a measure that is being made for a moment which it has left.
#[test]
fn what_is_being_made_for_a_moment_that_was_left_is_given_up() {
    let course = course(&variants()[0]);
    let mut moment = LiveMoment::new(course.clone());
    let (near, far) = (course.events() / 10, course.events());
    moment.seek(near, DISTANCES, u64::MAX).unwrap();
    assert!(!moment.seek(far, DISTANCES, 2_000).unwrap().arrived);

    let moved = moment.seek(near, DISTANCES, u64::MAX).unwrap();
    assert!(moved.arrived && moved.steps < 2_000, "{}", moved.steps);
}

#[test]
fn nothing_is_computed_that_is_not_wanted() {
    let course = course(&variants()[0]);
    let mut moment = LiveMoment::new(course.clone());
    let pairs = Wanted {
        pairs: true,
        ..Wanted::default()
    };
    assert!(
        moment
            .seek(course.events(), pairs, u64::MAX)
            .unwrap()
            .arrived
    );
    assert!(moment.pairs().is_some() && moment.cover().is_none() && moment.spectrum().is_none());
}

#[test]
fn a_long_way_is_made_anew() {
    let course = course(&variants()[0]);
    let distance = |from: usize, to: usize| {
        let mut moment = LiveMoment::new(course.clone());
        moment.seek(from, DISTANCES, u64::MAX).unwrap();
        moment.seek(to, DISTANCES, u64::MAX).unwrap().steps
    };
    let changes = course.changes();
    let last = course.events();
    let near = changes[changes.len() - 10].event as usize;
    // Back over all changes of the tiling, nothing is left to be made.
    assert!(distance(last, 0) < distance(0, last));
    assert!(distance(near, last) < distance(0, last) / 4);
}
