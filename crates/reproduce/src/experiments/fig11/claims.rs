//! The verdicts on figure 11: which procedure takes longest.

use super::rows::LeafTimes;
use crate::numbers::percent;
use crate::outcome::{BEYOND, Claim, Verdict};

/// Returns the claims: of the staged algorithm, and of Algorithm 4 as printed.
pub fn claims(rows: &[LeafTimes]) -> Vec<Claim> {
    vec![
        claim(
            [
                "Elimination and the first insertion together take longest",
                "figure 11, caption",
                "one part of the run, the longest, as it is operated against the most samples",
            ],
            rows,
            false,
            "Reproduced if elimination with the first detection and insertion has a larger median share of the sequential engine's \
             time than any other procedure at every leaf size; the paper has both as one part. It does not say which leaf size its figure \
             is of. Shares depend less on how busy the machine is than times do.",
        ),
        claim(
            [
                "Elimination and the first insertion together take longest in Algorithm 4 as printed, too",
                BEYOND,
                "figure 11's caption does not tell which arrangement was timed",
            ],
            rows,
            true,
            "Confirmed by the same rule: if that loop has a larger median share of the time than any other procedure. As printed, marks \
             of gap detectors are never taken back: every iteration after the first looks around all of them again, out to 4 r. The staged \
             algorithm looks around the samples just inserted, and is what the other engines compute.",
        ),
    ]
}

fn claim(names: [&str; 3], rows: &[LeafTimes], printed: bool, reason: &str) -> Claim {
    let rows = || rows.iter().filter(|row| row.printed == printed);
    let text = |row: &LeafTimes| {
        let [first, other] = row.shares().map(|share| percent(share, 2));
        let parts = row
            .first_shares()
            .into_iter()
            .map(|share| percent(share, 2));
        let parts: Vec<String> = parts.collect();
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
    let texts: Vec<String> = rows().map(text).collect();
    let holds = |row: &LeafTimes| row.shares()[0] > row.shares()[1];
    Claim::new(
        names,
        format!("share of a run's time: {}", texts.join("; ")),
        Verdict::if_known(!texts.is_empty(), rows().all(holds)),
        reason,
    )
}

#[cfg(test)]
mod tests {
    use super::super::stages::Procedure;
    use super::*;
    use tilescope_analysis::measures::Summary;

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
