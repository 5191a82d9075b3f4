//! Figure 11: the time of each procedure for a million samples. The sequential engine is timed by stage; the other
//! engines where they have stages. Patterns are ready-made.

mod claims;
mod picture;
mod rows;
mod stages;
mod tables;

use crate::error::ReproduceError;
use crate::machine::no_gpu;
use crate::outcome::Outcome;
use crate::study::{Settings, Study};

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

pub fn run(study: &Study<'_>) -> Result<Outcome, ReproduceError> {
    let plan = plan(study.settings);
    let rounds: Vec<StageRound> = stages::run(plan, study)?;
    let rows = rows::rows(&rounds);
    let passes = rows::passes(&rounds);
    let mut tables = vec![tables::stages(&rows, rounds.len()), tables::counts(&rounds)];
    if !passes.is_empty() {
        tables.push(tables::passes(&passes));
    }
    let mut notes = vec![HOW.to_owned()];
    notes.extend(no_gpu().map(|why| format!("Passes of a GPU were not timed: {why}.")));
    Ok(Outcome {
        claims: claims::claims(&rows),
        pictures: vec![picture::shares(&rows, plan)?],
        tables,
        notes,
    })
}

const HOW: &str = "The sequential engine's stages run one after another, as the paper describes them; each is timed, and a round times every leaf \
size. Leaves of 20 and 40 r have a pattern of 100 r, those of 80 r one of 200 r, so that blocks fit it. What prepares a stage belongs to the stage before it: the grid of survivors and the first gap detectors to elimination. The last iteration finds no \
gap and is a row of its own. Algorithm 4 as printed has elimination and the first insertion in one loop; it is timed, too, with a tenth of the samples. The parallel engine carries \
all stages out region by region, so that its time is one number; its counts are the sequential engine's. Every set is verified, or \
equal to one that is.";

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
