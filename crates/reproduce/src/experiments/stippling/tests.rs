//! A quick run.

use super::*;
use crate::experiment::Experiment;
use crate::outcome::Verdict;
use crate::study::tests::quick_run;

#[test]
fn a_quick_run_has_the_units_it_said_and_random_dots_are_the_worst() {
    let outcome = quick_run(Experiment::Stippling, &Settings::default());
    assert_eq!(outcome.claims.len(), 5);
    assert_eq!(outcome.tables[0].rows.len(), 12);
    // The control of the measure: independent dots.
    assert_eq!(outcome.claims[4].verdict, Verdict::Reproduced);

    let dots = |row: usize| serde_json::to_value(&outcome.tables[0].rows[row][2]).unwrap();
    for row in [0, 1, 3] {
        assert_eq!(dots(row), 2000);
    }
    // Error diffusion meets the number to within a hundredth.
    assert!((1980..=2020).contains(&dots(2).as_u64().unwrap()));
}
