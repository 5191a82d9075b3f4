//! Figure 11: the time of each procedure for a million samples. The sequential engine is timed by stage; the other
//! engines where they have stages. Patterns are ready-made.

mod rows;
mod shown;
mod stages;

use serde_json::json;

use crate::error::Result;
use crate::machine::no_gpu;
use crate::numbers::percent;
use crate::outcome::{Claim, Outcome, Verdict};
use crate::study::{Settings, Study};
use crate::texts::{claim, text};

use super::timing::TimingPlan;
use rows::LeafTimes;
use stages::StageRound;

fn plan_of(settings: &Settings) -> TimingPlan {
    let (samples, rounds) = settings.pick((1_000_000, 5), (50_000, 2));
    TimingPlan { samples, rounds }
}

pub fn units(settings: &Settings) -> usize {
    plan_of(settings).rounds as usize
}

/// Times the stages of the engines, and judges whether elimination with the first insertion takes longest.
pub fn run(study: &Study<'_>) -> Result<Outcome> {
    let plan = plan_of(study.settings);
    let rounds: Vec<StageRound> = stages::run(plan, study)?;
    let rows = rows::rows(&rounds);
    let passes = rows::passes(&rounds);

    let mut tables = vec![shown::stages(&rows), shown::counts(&rounds)];
    // Without a GPU there are no passes.
    if !passes.is_empty() {
        tables.push(shown::passes(&passes));
    }

    let mut notes = vec![text("fig11/how", &json!({}))];
    notes.extend(no_gpu().map(|why| text("fig11/no-gpu", &json!({ "why": why }))));

    Ok(Outcome {
        claims: claims(&rows),
        pictures: vec![shown::shares(&rows, plan)?],
        tables,
        notes,
    })
}

/// Returns the claims: of the staged algorithm, and of Algorithm 4 as printed.
fn claims(rows: &[LeafTimes]) -> Vec<Claim> {
    let (staged, printed) = (false, true);
    vec![
        longest("fig11/staged", rows, staged),
        longest("fig11/printed", rows, printed),
    ]
}

/// Judges whether elimination with the first insertion is the longest part.
fn longest(id: &str, rows: &[LeafTimes], printed: bool) -> Claim {
    let judged = || rows.iter().filter(|row| row.printed == printed);
    let words = |row: &LeafTimes| {
        // The paper has elimination and the first insertion as one part.
        let [first, other] = row.shares().map(|share| percent(share, 2));

        let each: Vec<String> = (row.first_shares().into_iter())
            .map(|share| percent(share, 2))
            .collect();
        let parts = match &each[..] {
            [_, _, ..] => format!(" ({})", each.join(" and ")),
            // One loop that does both has no parts to tell apart.
            _ => String::new(),
        };

        let name = row.name();
        format!("{name}: {first}{parts}, the longest other one {other}")
    };

    let shares: Vec<String> = judged().map(words).collect();
    let holds = judged().all(|row| row.shares()[0] > row.shares()[1]);
    let values = json!({ "shares": shares.join("; ") });
    claim(id, Verdict::if_known(!shares.is_empty(), holds), &values)
}

#[cfg(test)]
mod tests {
    use super::stages::Procedure;
    use super::*;
    use crate::experiment::Experiment;
    use crate::study::tests::quick_run;
    use tilescope_analysis::measures::Summary;

    #[test]
    fn a_quick_run_has_all_units_and_comparable_claims() {
        let outcome = quick_run(Experiment::Fig11, &Settings::default());
        assert_eq!(outcome.claims.len(), 2);
        assert_ne!(outcome.claims[0].verdict, Verdict::NotComparable);
    }

    fn row(shares: &[(Procedure, f64)]) -> LeafTimes {
        let of = |value| Summary::of([value]).unwrap();
        let each = shares
            .iter()
            .map(|(procedure, share)| (*procedure, of(*share), of(*share)));
        LeafTimes {
            leaf: 20.0,
            printed: false,
            procedures: each.collect(),
            whole: of(1.0),
            parallel: None,
            count: 1,
        }
    }

    #[test]
    fn both_together_count_against_each_other_one_at_every_leaf() {
        // Neither of both alone is the longest.
        let good = row(&[
            (Procedure::Tile, 0.4),
            (Procedure::Eliminate, 0.2),
            (Procedure::Iterate(1), 0.3),
            (Procedure::Finish, 0.1),
        ]);
        let bad = row(&[
            (Procedure::Tile, 0.4),
            (Procedure::Eliminate, 0.1),
            (Procedure::Iterate(1), 0.2),
            // Later insertions are no part of it.
            (Procedure::Iterate(2), 0.3),
        ]);
        let claim = &claims(std::slice::from_ref(&good))[0];
        assert_eq!(claim.verdict, Verdict::Reproduced);
        assert!(claim.claim.contains("together"));
        let told = "leaf 20 r: 50 % (20 % and 30 %), the longest other one 40 %";
        assert!(claim.ours.contains(told), "{}", claim.ours);
        assert_eq!(
            claims(&[good.clone(), bad.clone()])[0].verdict,
            Verdict::NotReproduced
        );
        assert_eq!(claims(&[])[0].verdict, Verdict::NotComparable);
        let printed = LeafTimes {
            printed: true,
            ..bad.clone()
        };
        let both = claims(&[good, printed]);
        assert_eq!(both[0].verdict, Verdict::Reproduced);
        assert_eq!(both[1].verdict, Verdict::NotReproduced);
    }
}
