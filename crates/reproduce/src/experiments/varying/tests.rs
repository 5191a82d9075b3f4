//! A quick run, and verdicts on densities and tones that are known.

use super::*;
use crate::experiment::Experiment;
use crate::experiments::density::PUBLISHED;
use crate::outcome::Verdict;
use crate::study::tests::quick_run;

/// Counts of several sets with about this density, that scatter as little as those of a million samples.
fn counts(density: f64) -> FieldCounts {
    let count = |off: f64| ((density * 1e5) + off).round() as u64;
    FieldCounts {
        counts: [-40.0, 40.0, -40.0, 40.0].map(count).to_vec(),
        area: 1e5,
    }
}

/// Results in which all is as it is asked for.
fn good() -> VaryingResults {
    let rules = |field: RuledField| {
        // Rules other than the harmonic mean have twice the samples on all fields but that of one radius.
        let of = |rule: usize| {
            counts(if field == RuledField::Level || rule == 0 {
                0.7
            } else {
                1.4
            })
        };
        (
            field,
            RuleCounts {
                by_rule: (0..5).map(of).collect(),
            },
        )
    };
    let ramp = |slope| RampSets {
        slope,
        counts: counts(PUBLISHED),
        pairs: vec![[1.0, 0.001]; ramps::BINS],
    };
    let asked = |step: usize| (1e6 * tones::share(step)).round() as u64;
    VaryingResults {
        ramps: [0.0, 0.1, 0.2].map(ramp).to_vec(),
        waves: vec![(2.0, counts(PUBLISHED))],
        plateaus: vec![(1.0, counts(PUBLISHED)), (2.0, counts(PUBLISHED))],
        ruled: RuledField::ALL.map(rules).to_vec(),
        tones: vec![(0..tones::STEPS).map(asked).collect(); 3],
    }
}

#[test]
fn results_as_asked_for_are_confirmed_and_each_that_is_off_is_refuted() {
    let verdicts = |found: &VaryingResults| -> Vec<Verdict> {
        claims::claims(found)
            .iter()
            .map(|claim| claim.verdict)
            .collect()
    };
    assert_eq!(verdicts(&good()), vec![Verdict::Reproduced; 6]);

    let spoils: [fn(&mut VaryingResults); 6] = [
        |found| found.ramps[1].counts = counts(1.02 * PUBLISHED),
        |found| found.waves[0].1 = counts(0.98 * PUBLISHED),
        |found| found.plateaus[1].1 = counts(PUBLISHED + 0.006),
        |found| found.ramps[1].pairs[3][0] = 1.2,
        |found| found.ruled[2].1.by_rule[0] = counts(0.9),
        |found| found.tones.iter_mut().for_each(|one| one[5] *= 2),
    ];
    for (index, spoil) in spoils.into_iter().enumerate() {
        let mut found = good();
        spoil(&mut found);
        let expected = |claim: usize| {
            if claim == index {
                Verdict::NotReproduced
            } else {
                Verdict::Reproduced
            }
        };
        assert_eq!(verdicts(&found), (0..6).map(expected).collect::<Vec<_>>());
    }
}

#[test]
fn a_quick_run_has_the_units_it_said_and_densities_near_the_published_one() {
    let outcome = quick_run(Experiment::Varying, &Settings::default());
    assert_eq!(outcome.claims.len(), 6);
    // Level ground, a gentle slope, the least contrast and all plateaus: some thousand samples each.
    for (table, rows) in [(0, 2), (1, 1), (2, 6)] {
        for row in &outcome.tables[table].rows[..rows] {
            let relative = serde_json::to_value(&row[5]).unwrap().as_f64().unwrap();
            assert!((relative - 1.0).abs() < 0.02, "{row:?}");
        }
    }
}
