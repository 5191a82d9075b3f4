//! Figure 11: the time of each procedure for a million samples. The sequential engine is timed by stage; the other
//! engines where they have stages. Patterns are ready-made.

mod claims;
mod rows;
mod shown;
mod stages;

use serde_json::json;

use crate::error::Result;
use crate::machine::no_gpu;
use crate::outcome::Outcome;
use crate::study::{Settings, Study};
use crate::texts::text;

use super::timing::TimingPlan;
use stages::StageRound;

fn plan(settings: &Settings) -> TimingPlan {
    TimingPlan {
        samples: settings.pick(1_000_000, 100_000),
        rounds: settings.pick(5, 2),
    }
}

pub fn units(settings: &Settings) -> usize {
    plan(settings).rounds as usize
}

pub fn run(study: &Study<'_>) -> Result<Outcome> {
    let plan = plan(study.settings);
    let rounds: Vec<StageRound> = stages::run(plan, study)?;
    let rows = rows::rows(&rounds);
    let passes = rows::passes(&rounds);
    let mut tables = vec![shown::stages(&rows), shown::counts(&rounds)];
    if !passes.is_empty() {
        tables.push(shown::passes(&passes));
    }
    let mut notes = vec![text("fig11/how", &json!({}))];
    notes.extend(no_gpu().map(|why| text("fig11/no-gpu", &json!({ "why": why }))));
    Ok(Outcome {
        claims: claims::claims(&rows),
        pictures: vec![shown::shares(&rows, plan)?],
        tables,
        notes,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Experiment;
    use crate::outcome::Verdict;
    use crate::study::tests::quick_run;

    #[test]
    fn a_quick_run_has_all_units_and_comparable_claims() {
        let outcome = quick_run(Experiment::Fig11, &Settings::default());
        assert_eq!(outcome.claims.len(), 2);
        assert_ne!(outcome.claims[0].verdict, Verdict::NotComparable);
    }
}
