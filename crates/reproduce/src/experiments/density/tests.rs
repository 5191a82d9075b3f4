//! Verdicts on densities that are known, and a quick run.

use serde_json::Value;

use super::results::{DensityResults, LatticeError, OFF, PUBLISHED};
use super::sums::CountSums;
use super::torus::{LEVELS, TorusSets};
use super::*;
use crate::experiment::Experiment;
use crate::outcome::Verdict;
use crate::study::tests::{alone, quick_run, studied};

/// What the lattice leaves out here.
const LEFT_OUT: f64 = 9e-6;

/// Results of sets whose mean density is `density` on the lattice, with the spread that sets of this size have.
fn found(density: f64, sets: u64) -> DensityResults {
    let mean = density * SIDE * SIDE;
    // Counts of sets scatter by a root of 0.055 of themselves.
    let deviation = (0.055 * mean).sqrt();
    let pair = |sign: f64| CountSums::of((mean + sign * deviation).round() as usize);
    let mut sums = CountSums::default();
    for _ in 0..sets / 2 {
        sums = sums.joined(pair(1.0)).joined(pair(-1.0));
    }

    let mut by_level = [0; LEVELS];
    let samples = sums.samples as f64;
    for (level, count) in by_level.iter_mut().enumerate() {
        *count = (0.4 * samples * 0.5_f64.powi(level as i32)) as u64;
    }
    let all = TorusSets {
        side: SIDE,
        sums,
        by_level,
    };
    let lattice = LatticeError {
        by_levels: [LEFT_OUT, 2e-7],
        by_coarse: [LEFT_OUT, 4e-7],
    };
    let found = DensityResults::of(&[all], &[], Vec::new()).unwrap();
    // All levels behind the last one would insert as much as it does.
    let expected = 0.4 * density / 32_768.0;
    let [left_out, _] = found.lattice.by_levels;
    assert!((left_out / expected - 1.0).abs() < 0.5, "{left_out}");
    DensityResults { lattice, ..found }
}

#[test]
fn the_published_density_is_confirmed_and_one_of_a_radius_that_is_off_is_refused() {
    let verdict = |density: f64, sets| found(density - LEFT_OUT, sets).verdict();
    let many = 40_000;
    assert_eq!(verdict(PUBLISHED, many), Verdict::Reproduced);
    for factor in [1.0 - OFF, 1.0 + OFF] {
        let wrong = PUBLISHED * factor * factor;
        assert_eq!(verdict(wrong, many), Verdict::NotReproduced);
    }
    // Without what the lattice leaves out it would be refused as well; few sets decide nothing.
    assert_eq!(verdict(PUBLISHED - 3e-5, many), Verdict::NotReproduced);
    assert_eq!(verdict(PUBLISHED, 20), Verdict::NotComparable);
}

#[test]
fn estimates_of_the_lattice_s_error_that_differ_are_refused() {
    let mut found = found(PUBLISHED, 1000);
    let verdict = |found: &DensityResults| claims::claims(found)[1].verdict;
    assert_eq!(verdict(&found), Verdict::Reproduced);
    found.lattice.by_coarse[0] += 3e-6;
    assert_eq!(verdict(&found), Verdict::NotReproduced);
    // The difference is part of the error from then on.
    assert!(found.lattice.used()[1] > 2.9e-6);
    found.lattice.by_coarse[1] = 3e-6;
    assert_eq!(verdict(&found), Verdict::NotComparable);
}

#[test]
fn controls_are_refused_and_the_set_itself_is_not() {
    alone(&Settings::default(), |control| {
        torus::refuse_controls(160.0, 5, control)?;
        let sets = TorusSets::made(40.0, vec![5, 6], control)?;
        let inserted: u64 = sets.by_level.iter().sum();
        assert_eq!((sets.sums.sets, sets.sums.samples), (2, inserted));
        let each = [5, 6].map(|seed| TorusSets::made(40.0, vec![seed], control));
        let [a, b] = each.map(Result::unwrap);
        assert_eq!(b.joined(&a), sets);
        Ok(())
    });
}

#[test]
fn a_quick_run_has_the_units_it_said() {
    let outcome = quick_run(Experiment::Density, &Settings::default());
    assert_eq!(outcome.claims.len(), 2);
    let cell = |row: usize, column: usize| {
        let value: Value = serde_json::to_value(&outcome.tables[0].rows[row][column]).unwrap();
        value.as_f64().unwrap()
    };
    // Eight sets of 46,000 samples: a standard error of 0.0003.
    assert!((cell(3, 1) - PUBLISHED).abs() < 0.001);
    // 0.3 of the lattice's spacing is left out: the levels of few sets show it roughly, coarse lattices better.
    assert!((cell(1, 1) - 1e-5).abs() < 4.0 * cell(1, 2));
    assert!((7e-6..1.4e-5).contains(&cell(2, 1)));
}

#[test]
fn a_stopped_run_concludes_from_the_batches_that_it_left() {
    let settings = Settings {
        kept: true,
        ..Settings::default()
    };
    studied(Experiment::Density, &settings, |study| {
        let error = run(study).unwrap_err();
        assert!(error.to_string().contains("no batch is kept"), "{error}");

        // The second of two batches, as if the first had been lost.
        let left = study.unit("batch-1", "left", |control| {
            TorusSets::made(SIDE, vec![3, 4], control)
        })?;
        let outcome = run(study)?;
        let batches = outcome.tables.last().unwrap();
        assert_eq!(batches.rows.len(), 1);
        let samples = serde_json::to_value(&batches.rows[0][1]).unwrap();
        assert_eq!(samples.as_u64(), Some(left.sums.samples));
        Ok(())
    })
    .unwrap();
}
