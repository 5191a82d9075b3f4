//! A quick run, and verdicts on sets that are known.

use super::balls::{BINS_IN_R, ShellPower};
use super::claims::{EXPECTED_LEAST, EXPECTED_PAIRS, EXPECTED_PEAK};
use super::results::{PUBLISHED, bins};
use super::*;
use crate::experiment::Experiment;
use crate::outcome::Verdict;
use crate::study::tests::{alone, quick_run};

/// A set as it is expected, with a density that is off by a share.
fn expected(side: f64, off: f64) -> MeasuredBalls {
    let mut pairs = vec![0.0; BINS_IN_R];
    pairs.extend(EXPECTED_PAIRS);
    pairs.resize(bins(0.0..2.5).end, 0.95);
    pairs[bins(1.6..2.0).start] = EXPECTED_LEAST;
    pairs[bins(2.05..2.4).start] = EXPECTED_PEAK;
    let shell = |nu: f64, power| ShellPower {
        nu,
        frequencies: 100,
        power,
    };
    MeasuredBalls {
        side,
        samples: (PUBLISHED * side.powi(3) * (1.0 + off)).round() as usize,
        least_distance: 1.000_001,
        farthest_place: 1.000_002,
        judges: 2,
        disks: 2.0 * PUBLISHED * (1.0 + off),
        pairs,
        shells: vec![shell(0.1, 0.055 + off), shell(0.5, 0.3)],
    }
}

/// Sets whose densities scatter by a thousandth around the one that is off by a share.
fn sets(side: f64, off: f64) -> Vec<MeasuredBalls> {
    let scatter = (0..24).map(|index| if index % 2 == 0 { 1e-3 } else { -1e-3 });
    scatter.map(|more| expected(side, off + more)).collect()
}

/// Results in which all is as expected.
fn good() -> SpaceResults {
    let mut stopped = sets(24.0, -0.01);
    let mut scattered = sets(24.0, 0.0);
    for set in &mut stopped {
        set.farthest_place = 1.2;
        set.pairs[BINS_IN_R] *= 0.95;
    }
    for set in &mut scattered {
        set.pairs.fill(1.0);
        set.shells.iter_mut().for_each(|shell| shell.power = 1.0);
        set.least_distance = 0.01;
    }
    SpaceResults {
        side: 40.0,
        small_side: 24.0,
        large: sets(40.0, 0.0),
        small: sets(24.0, 0.0),
        stopped,
        scattered,
    }
}

fn verdicts(found: &SpaceResults) -> Vec<Verdict> {
    let claims = claims::claims(found);
    claims.iter().map(|claim| claim.verdict).collect()
}

/// Returns the verdicts that are all confirmed but one.
fn all_but(index: usize, other: Verdict) -> Vec<Verdict> {
    let mut all = vec![Verdict::Reproduced; 5];
    all[index] = other;
    all
}

#[test]
fn sets_as_expected_are_confirmed_and_each_that_is_off_is_refuted() {
    assert_eq!(verdicts(&good()), vec![Verdict::Reproduced; 5]);

    let spoils: [fn(&mut MeasuredBalls); 5] = [
        // The density alone is off, and disks are not: these are counted apart.
        |set| set.samples += 90,
        |set| set.disks += 0.012,
        |set| set.farthest_place = 1.000_04,
        |set| set.pairs[BINS_IN_R + 3] *= 1.03,
        |set| set.shells[0].power = 0.07,
    ];
    for (index, spoil) in spoils.into_iter().enumerate() {
        let mut found = good();
        found.large.iter_mut().for_each(spoil);
        found.small.iter_mut().for_each(spoil);
        assert_eq!(verdicts(&found), all_but(index, Verdict::NotReproduced));
    }
}

#[test]
fn a_rule_that_does_not_refute_its_control_decides_nothing() {
    let spoils: [fn(&mut SpaceResults); 5] = [
        |found| (found.stopped.iter_mut()).for_each(|set| set.samples += set.samples / 100),
        |found| (found.stopped.iter_mut()).for_each(|set| set.disks *= 1.01),
        |found| (found.stopped.iter_mut()).for_each(|set| set.farthest_place = 1.0),
        |found| (found.scattered.iter_mut()).for_each(|set| set.pairs = expected(24.0, 0.0).pairs),
        |found| (found.scattered.iter_mut()).for_each(|set| set.shells[0].power = 0.056),
    ];
    for (index, spoil) in spoils.into_iter().enumerate() {
        let mut found = good();
        spoil(&mut found);
        assert_eq!(verdicts(&found), all_but(index, Verdict::NotComparable));
    }
}

#[test]
fn one_set_leaves_open_what_needs_a_spread() {
    let mut found = good();
    found.large.truncate(1);
    found.small.truncate(1);
    let open = Verdict::NotComparable;
    assert_eq!(
        verdicts(&found),
        [open, open, Verdict::Reproduced, open, open]
    );
}

#[test]
fn controls_are_not_maximal_and_a_maximal_set_is() {
    alone(&Settings::default(), |control| {
        let [maximal, stopped, scattered] =
            [BallKind::Maximal, BallKind::Stopped, BallKind::Scattered].map(|kind| {
                kind.made(8.0, 5, control)
                    .unwrap()
                    .with_spectrum(control)
                    .unwrap()
            });
        assert_eq!(scattered.samples, maximal.samples);
        assert_eq!(stopped.samples, maximal.samples * 98 / 100);
        assert!(maximal.least_distance >= 1.0 && maximal.farthest_place < 1.000_031);
        assert!(stopped.least_distance >= 1.0 && stopped.farthest_place > 1.000_031);
        assert!(scattered.least_distance < 0.5);
        // Before contact there is no pair but of scattered samples.
        let near = |set: &MeasuredBalls| set.pairs[..BINS_IN_R].iter().sum::<f64>();
        assert!(near(&maximal) == 0.0 && near(&stopped) == 0.0 && near(&scattered) > 10.0);
        assert_eq!((maximal.judges, scattered.judges), (2, 1));
        Ok(())
    });
}

#[test]
fn a_quick_run_has_the_units_it_said_and_a_density_near_the_published_one() {
    let outcome = quick_run(Experiment::Space, &Settings::default());
    assert_eq!(outcome.claims.len(), 5);
    let cell = |row: usize, column: usize| {
        let value = serde_json::to_value(&outcome.tables[0].rows[row][column]).unwrap();
        value.as_f64().unwrap()
    };
    // Four sets of 3,000 samples: a standard error of 0.0015.
    assert!((cell(0, 4) - PUBLISHED).abs() < 0.006);
    // Contact, and the floor of low powers.
    assert!((cell(1, 7) - EXPECTED_PAIRS[0]).abs() < 0.2);
    assert!(cell(1, 8) < 0.12 && cell(3, 8) > 0.6);
    // No set that is maximal is refused, and every other one is.
    assert_eq!(outcome.claims[2].verdict, Verdict::Reproduced);
}
