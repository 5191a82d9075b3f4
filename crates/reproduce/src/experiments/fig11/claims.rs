//! The verdict on figure 11: which procedure takes longest.

use super::rows::Row;
use crate::numbers::number;
use crate::outcome::{Claim, Verdict};

/// Returns the claims: of the staged algorithm, and of Algorithm 4 as printed.
pub fn claims(rows: &[Row]) -> Vec<Claim> {
    let of = |printed: bool| {
        rows.iter()
            .filter(|row| row.printed == printed)
            .collect::<Vec<_>>()
    };
    vec![
        Claim {
            claim: "Elimination and the first insertion together take longest".to_owned(),
            paper: "one part of the run, the longest, as it is operated against the most samples"
                .to_owned(),
            reason: format!(
                "{RULE} at every leaf size; the paper has both as one part. It does not say which leaf size its figure is of. Shares depend less on how busy the machine is \
                 than times do."
            ),
            ..claim(&of(false))
        },
        Claim {
            claim:
                "Elimination and the first insertion together take longest in Algorithm 4 as printed, too"
                    .to_owned(),
            place: crate::outcome::BEYOND.to_owned(),
            paper: "figure 11's caption does not tell which arrangement was timed".to_owned(),
            reason: format!(
                "{BEYOND_RULE}. As printed, marks of gap detectors are never taken back: every iteration after the first looks around all of them again, out \
                 to 4 r. The staged algorithm looks around the samples just inserted, and is what the other engines compute."
            ),
            ..claim(&of(true))
        },
    ]
}

const RULE: &str = "Reproduced if elimination with the first detection and insertion has a larger median share of the sequential engine's \
                    time than any other procedure";
const BEYOND_RULE: &str = "Confirmed by the same rule: if that loop has a larger median share of the time than any other procedure";

fn claim(rows: &[&Row]) -> Claim {
    let text = |row: &&Row| {
        let percent = |share: f64| format!("{} %", number(100.0 * share, 2));
        let [first, other] = row.shares().map(percent);
        let parts: Vec<String> = row.first_shares().into_iter().map(percent).collect();
        let parts = if parts.len() > 1 {
            format!(" ({})", parts.join(" and "))
        } else {
            String::new()
        };
        format!(
            "{}: {first}{parts}, the longest other one {other}",
            row.name()
        )
    };
    let texts: Vec<String> = rows.iter().map(text).collect();
    let holds = |row: &&Row| {
        let [first, other] = row.shares();
        first > other
    };
    Claim {
        claim: String::new(),
        place: "figure 11, caption".to_owned(),
        paper: String::new(),
        ours: format!("share of a run's time: {}", texts.join("; ")),
        verdict: if rows.is_empty() {
            Verdict::NotComparable
        } else {
            Verdict::of(rows.iter().all(holds))
        },
        reason: String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::stages::Procedure;
    use super::*;
    use tilescope_analysis::measures::Summary;

    fn row(shares: &[(Procedure, f64)]) -> Row {
        let of = |value| Summary::of([value]).unwrap();
        let each = shares
            .iter()
            .map(|(procedure, share)| (*procedure, of(*share), of(*share)));
        Row {
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
        let printed = Row {
            printed: true,
            ..bad.clone()
        };
        let both = claims(&[good, printed]);
        assert_eq!(both[0].verdict, Verdict::Reproduced);
        assert_eq!(both[1].verdict, Verdict::NotReproduced);
    }
}
