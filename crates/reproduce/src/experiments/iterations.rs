//! Section 3.2.3: how many iterations of insertion a run takes until no gap is left. The parallel engine makes the ten
//! sets of a case, each with a seed of its own. Sets of the algorithm as printed are made in `variants`. Every set is
//! verified.

mod counts;
mod variants;

use serde_json::json;
use tilescope_analysis::measures::poisson_interval;
use tilescope_core::{Order, Summary};

use crate::control::Control;
use crate::error::Result;
use crate::experiments::common::{MISSED, seeded, square};
use crate::outcome::{Claim, Outcome, Verdict};
use crate::sets::Set;
use crate::study::{Settings, Study};
use crate::texts::{claim, text};
use counts::{InsertionCase, IterationCounts};

/// Sets of each case, as in the paper.
const SETS: usize = 10;
/// Iterations that the paper saw.
const PAPER: usize = 2;
/// Samples of the paper's sets; fewer than nine tenths of that cannot confirm what it saw.
const PAPER_SAMPLES: f64 = 1e7;
/// Fewer sets of that size confirm nothing.
const ENOUGH: usize = 2;
/// Up to this share of all insertions counts as rare.
const RARE: f64 = 0.01;

fn samples(settings: &Settings) -> f64 {
    settings.pick(PAPER_SAMPLES, 20_000.0)
}

fn cases() -> [InsertionCase; 4] {
    let case = |order, leaf| InsertionCase { order, leaf };
    [
        case(Order::Index, 20.0),
        case(Order::Index, 40.0),
        case(Order::OwnBlockFirst, 20.0),
        case(Order::OwnBlockFirst, 40.0),
    ]
}

pub fn units(settings: &Settings) -> usize {
    cases().len() * SETS + variants::units(settings)
}

/// Counts the iterations of the sets of all cases, and compares runs by stages with the algorithm as printed.
pub fn run(study: &Study<'_>) -> Result<Outcome> {
    let settings = study.settings;
    let mut found = Vec::new();
    for case in cases() {
        // Each set is a unit, so that an interrupted run loses one of them at most.
        for index in 0..SETS {
            let key = format!("{}-{index}", case.key());
            let what = format!("set {} of {SETS}, {}", index + 1, case.name());
            let seed = settings.seed_of(index as u64);
            found.push(study.unit(&key, &what, |control| {
                measure(case, seed, samples(settings), control)
            })?);
        }
    }

    let compared = variants::compare(study)?;
    let mut printed: Vec<Summary> = compared.iter().map(|one| one.printed.clone()).collect();
    // The claims on the algorithm as printed rest on its small and its large sets together.
    printed.extend(variants::large_printed(study)?);

    Ok(Outcome {
        claims: claims(&found, &printed),
        pictures: vec![
            counts::inserted(&found, &cases())?,
            counts::needed(&found, &cases())?,
        ],
        tables: vec![
            counts::by_case(&found, &cases()),
            variants::compared_table(&compared),
            variants::printed_table(&printed),
            counts::by_set(&found),
        ],
        notes: vec![text("iterations/how", &json!({}))],
    })
}

/// Makes and verifies a set, and returns its counts.
fn measure(
    case: InsertionCase,
    seed: u64,
    samples: f64,
    control: &Control<'_>,
) -> Result<IterationCounts> {
    let mut parameters = seeded(square(samples, case.leaf), seed);
    parameters.order = case.order;
    let (set, summary) = Set::kdrt(&parameters, control)?;
    let report = set.verified(&format!("{}, seed {seed}", case.name()), control)?;

    Ok(IterationCounts {
        case,
        seed,
        summary,
        min_distance: report.min_distance,
        covering_radius: report.covering_radius,
    })
}

fn claims(found: &[IterationCounts], printed: &[Summary]) -> Vec<Claim> {
    let staged: Vec<Summary> = found.iter().map(|one| one.summary.clone()).collect();
    let both = [("printed", printed), ("staged", &staged)];
    both.into_iter()
        .flat_map(|(how, sets)| [suffices(how, sets), rare(how, sets)])
        .collect()
}

/// Judges whether the paper's number of iterations suffices for all sets.
fn suffices(how: &str, sets: &[Summary]) -> Claim {
    // A summary has the iterations up to the last one that inserted samples, so that their number is the one needed.
    let counts = || sets.iter().map(|set| set.inserted.len());
    let (least, most) = (counts().min().unwrap_or(0), counts().max().unwrap_or(0));

    let large = sets
        .iter()
        // A set has about as many samples as it was made for.
        .filter(|set| set.count as f64 >= 0.9 * PAPER_SAMPLES)
        .count();
    // A single set that needs more iterations refutes the claim, whatever its size. Only sets of the paper's size
    // confirm it.
    let verdict = Verdict::if_known(most > PAPER || large >= ENOUGH, most <= PAPER);

    let values = json!({
        "range": if least == most { most.to_string() } else { format!("{least} to {most}") },
        "within": counts().filter(|count| *count <= PAPER).count(), "allowed": PAPER,
        "sets": sets.len(), "large": large, "are": if large == 1 { "is" } else { "are" },
        "smallest": sets.iter().map(|set| set.count).min().unwrap_or(0), "enough": ENOUGH,
    });
    claim(&format!("iterations/suffices-{how}"), verdict, &values)
}

/// Judges whether insertions after the paper's number of iterations are rare.
fn rare(how: &str, sets: &[Summary]) -> Claim {
    let after = |from: usize| -> usize {
        let late = |set: &Summary| set.inserted.iter().skip(from).sum::<usize>();
        sets.iter().map(late).sum()
    };

    let (late, inserted) = (after(PAPER), after(0));
    // With a divisor of at least 1 the share is 0 where nothing was inserted. The interval then ends far above the
    // limit, so that there is no verdict.
    let share = |count: f64| count / inserted.max(1) as f64;
    let [low, high] = poisson_interval(late, MISSED).map(share);
    // There is a verdict only if the whole interval lies on one side of the limit.
    let verdict = Verdict::if_known(low > RARE || high <= RARE, high <= RARE);

    let values = json!({
        "late": late, "inserted": inserted, "share": share(late as f64),
        "allowed": PAPER, "rare": RARE, "high": high,
    });
    claim(&format!("iterations/rare-{how}"), verdict, &values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Experiment;
    use crate::study::tests::quick_run;

    fn found(count: usize, inserted: &[usize]) -> IterationCounts {
        IterationCounts {
            case: cases()[0],
            seed: 1,
            summary: Summary {
                blocks: 1,
                tiled: 2 * count,
                dropped: 0,
                eliminated: count,
                inserted: inserted.to_vec(),
                count,
            },
            min_distance: 1.0,
            covering_radius: 1.0,
        }
    }

    /// Of sets made in stages, and of the same made as printed with one iteration less.
    fn both(found: &[IterationCounts]) -> Vec<Claim> {
        let printed = |one: &IterationCounts| Summary {
            inserted: one.summary.inserted[..1].to_vec(),
            ..one.summary.clone()
        };
        claims(found, &found.iter().map(printed).collect::<Vec<_>>())
    }

    fn verdicts(found: &[IterationCounts]) -> Vec<Verdict> {
        let of = both(found);
        assert_eq!(of[1].verdict, Verdict::Reproduced);
        let staged: Vec<Verdict> = of[2..].iter().map(|claim| claim.verdict).collect();
        // The same numbers as printed have the same verdicts.
        let same = found.iter().map(|one| one.summary.clone());
        let same = claims(&[], &same.collect::<Vec<_>>());
        assert_eq!([same[0].verdict, same[1].verdict], staged[..]);
        staged
    }

    #[test]
    fn verdicts_follow_from_the_numbers() {
        use Verdict::{NotComparable, NotReproduced, Reproduced};
        let large = 10_000_000;
        let two = found(large, &[1000, 50]);
        let three = found(large, &[1000, 50, 1]);
        let pair = [two.clone(), two.clone()];
        assert_eq!(verdicts(&pair), [Reproduced, Reproduced]);
        assert_eq!(verdicts(&[two.clone(), three]), [NotReproduced, Reproduced]);
        let often = found(large, &[1000, 50, 100]);
        assert_eq!(
            verdicts(&[two.clone(), often]),
            [NotReproduced, NotReproduced]
        );
        let small = found(10_000, &[100, 5]);
        // One large set among small ones is not enough.
        let mixed = [two, small.clone(), small];
        assert_eq!(verdicts(&mixed), [NotComparable, Reproduced]);
        assert!(
            both(&mixed)[0]
                .ours
                .contains("1 of 3 sets is of the paper's size")
        );
        let small = found(10_000, &[1000, 5, 1]);
        assert_eq!(verdicts(&[small]), [NotReproduced, Reproduced]);
        // None late of a hundred does not say that one in a hundred is too many.
        let few = found(10_000, &[95, 5]).summary;
        assert_eq!(claims(&[], &[few])[1].verdict, NotComparable);
    }

    #[test]
    fn the_paper_is_judged_by_its_own_algorithm() {
        let large = found(10_000_000, &[1000, 50, 1]);
        let claims = both(&[large.clone(), large]);
        assert_eq!(claims[0].verdict, Verdict::Reproduced);
        assert_eq!(claims[2].verdict, Verdict::NotReproduced);
        let places: Vec<&str> = claims.iter().map(|claim| &*claim.place).collect();
        assert_eq!(places[..2], ["section 3.2.3"; 2]);
        assert_eq!(places[2..], ["beyond the paper"; 2]);
    }

    #[test]
    fn a_quick_run_has_the_units_it_said() {
        let outcome = quick_run(Experiment::Iterations, &Settings::default());
        assert_eq!(outcome.claims.len(), 4);
        assert_eq!(outcome.tables[3].rows.len(), 4 * SETS);
        assert_eq!(outcome.pictures.len(), 2);
    }
}
