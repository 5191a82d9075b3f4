//! Section 3.2.3: how many iterations of insertion a run takes until no gap is left. The parallel engine makes the
//! sets, each with seeds of its own; every one is verified.

mod counts;
mod variants;

use tilescope_core::{Order, Parameters};

use crate::control::Control;
use crate::error::ReproduceError;
use crate::experiments::common::{counted, poisson_interval, seed, seeded, square};
use crate::numbers::percent;
use crate::outcome::{Claim, Outcome, Verdict};
use crate::sets::Set;
use crate::study::{Settings, Study};
use counts::{InsertionCase, IterationCounts};
use variants::SetCounts;

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
    settings.pick(PAPER_SAMPLES, 60_000.0)
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

pub fn run(study: &Study<'_>) -> Result<Outcome, ReproduceError> {
    let settings = study.settings;
    let mut found = Vec::new();
    for case in cases() {
        for index in 0..SETS {
            let key = format!("{}-{index}", case.key());
            let what = format!("set {} of {SETS}, {}", index + 1, case.name());
            found.push(study.unit(&key, &what, |control| {
                measure(case, index, settings, control)
            })?);
        }
    }
    let compared = variants::compare(study)?;
    let mut printed: Vec<SetCounts> = compared.iter().map(SetCounts::from).collect();
    printed.extend(variants::printed(study)?);
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
        notes: vec![NOTE.to_owned()],
    })
}

const NOTE: &str = "Every set has a seed of its own and a pattern of its own (side 100 r), so that no two sets repeat each other's \
gaps. The paper does not say which leaf it used; both ends of the range that it recommends are here, each with the order of \
its loop (by index) and with this program's default (own block first). An iteration is a round in which samples were inserted; \
the last look, which finds nothing, is not counted.";

fn measure(
    case: InsertionCase,
    index: usize,
    settings: &Settings,
    control: &Control<'_>,
) -> Result<IterationCounts, ReproduceError> {
    let parameters = Parameters {
        order: case.order,
        ..square(samples(settings), case.leaf)
    };
    let seed = seed(settings, index);
    let (set, summary) = Set::kdrt(&seeded(parameters, seed), control)?;
    let report = set.verified(&format!("{}, seed {seed}", case.name()), control)?;
    Ok(IterationCounts {
        case,
        seed,
        summary,
        min_distance: report.min_distance,
        covering_radius: report.covering_radius,
    })
}

/// A way to make sets, and the counts of its sets.
struct Arrangement {
    name: &'static str,
    section: &'static str,
    /// A sentence that says what counts as an iteration.
    counts: &'static str,
    sets: Vec<SetCounts>,
}

fn claims(found: &[IterationCounts], printed: &[SetCounts]) -> Vec<Claim> {
    let printed = Arrangement {
        name: "Algorithm 4 as printed",
        section: "section 3.2.3",
        counts: "The first loop of Algorithm 4 inserts while it eliminates and counts as one iteration, as does each round of its \
                 second loop that inserts anything.",
        sets: printed.to_vec(),
    };
    let staged = Arrangement {
        name: "in this program's arrangement in stages",
        section: crate::outcome::BEYOND,
        counts: "Here all conflicts are resolved before the first insertion, which the paper does not do.",
        sets: found.iter().map(SetCounts::from).collect(),
    };
    vec![
        suffices(&printed),
        rare(&printed),
        suffices(&staged),
        rare(&staged),
    ]
}

fn suffices(way: &Arrangement) -> Claim {
    let counts = || way.sets.iter().map(|set| set.inserted.len());
    let (least, most) = (counts().min().unwrap_or(0), counts().max().unwrap_or(0));
    let within = counts().filter(|count| *count <= PAPER).count();
    let range = if least == most {
        most.to_string()
    } else {
        format!("{least} to {most}")
    };
    let large = |set: &&SetCounts| set.count as f64 >= 0.9 * PAPER_SAMPLES;
    let large = way.sets.iter().filter(large).count();
    let (sets, are) = (way.sets.len(), if large == 1 { "is" } else { "are" });
    let smallest = way.sets.iter().map(|set| set.count).min().unwrap_or(0);
    let claim = format!("Two iterations of insertion suffice ({})", way.name);
    let paper = "2 iterations for each of 10 sets of 10 million samples";
    Claim::new(
        [&claim, way.section, paper],
        format!(
            "{range} iterations; {within} of {sets} sets need no more than {PAPER}; {large} of {sets} sets {are} of the paper's size \
             (the smallest has {} samples)",
            counted(smallest),
        ),
        Verdict::if_known(most > PAPER || large >= ENOUGH, most <= PAPER),
        format!(
            "Holds if no set needs more than {PAPER} and at least {ENOUGH} sets have the paper's size, which is 9 million \
             samples or more; smaller sets can refute it but not confirm it. That is {large} here. {}",
            way.counts
        ),
    )
}

fn rare(way: &Arrangement) -> Claim {
    let after = |from: usize| -> usize {
        let late = |set: &SetCounts| set.inserted.iter().skip(from).sum::<usize>();
        way.sets.iter().map(late).sum()
    };
    let (late, inserted) = (after(PAPER), after(0));
    let of_all = |count: f64| count / inserted.max(1) as f64;
    let share = of_all(late as f64);
    let [low, high] = poisson_interval(late).map(of_all);
    let claim = format!("Gaps that need more iterations are rare ({})", way.name);
    Claim::new(
        [&claim, way.section, "special cases rarely showed"],
        format!(
            "{} of {} inserted samples came after iteration {PAPER}: {}",
            counted(late),
            counted(inserted),
            percent(share, 2)
        ),
        Verdict::if_known(low > RARE || high <= RARE, high <= RARE),
        format!(
            "Holds if at most {} % of all inserted samples come after iteration {PAPER}, and the 99 % interval of a Poisson variable tells \
             (it ends at {}). {}",
            100.0 * RARE,
            percent(high, 2),
            way.counts
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Experiment;
    use crate::study::tests::quick_run;
    use tilescope_core::Summary;

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
        let printed = |one: &IterationCounts| SetCounts {
            count: one.summary.count,
            inserted: one.summary.inserted[..1].to_vec(),
        };
        claims(found, &found.iter().map(printed).collect::<Vec<_>>())
    }

    fn verdicts(found: &[IterationCounts]) -> Vec<Verdict> {
        let of = both(found);
        assert_eq!(of[1].verdict, Verdict::Reproduced);
        let staged: Vec<Verdict> = of[2..].iter().map(|claim| claim.verdict).collect();
        // The same numbers as printed have the same verdicts.
        let same = claims(&[], &found.iter().map(SetCounts::from).collect::<Vec<_>>());
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
        let few = SetCounts {
            count: 10_000,
            inserted: vec![95, 5],
        };
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
