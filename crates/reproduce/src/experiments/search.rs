//! Section 3.2.2: how far detectors have to look. Runs that look 2r far are compared with runs that look 4r far. Sets
//! with gaps are what this experiment is about, so the verifier counts gaps here and no set is refused.

mod gaps;
mod picture;
mod witness;

use rayon::prelude::*;
use tilescope_core::{Parameters, Search, Sequential, Variant};

use crate::control::Control;
use crate::error::ReproduceError;
use crate::experiments::common::{counted, poisson_interval, seed, seeded, square};
use crate::numbers::number;
use crate::outcome::{Claim, Outcome, Verdict};
use crate::sets::{Set, pattern};
use crate::study::{Settings, Study};
use gaps::{GapCounts, GapStatistics};

/// Fewer samples than this cannot confirm that there are no gaps in practice.
const ENOUGH: usize = 1_000_000;

/// A leaf and an arrangement of the two loops.
#[derive(Clone, Copy, Debug)]
struct SearchCase {
    leaf: f64,
    variant: Variant,
}

impl SearchCase {
    /// Sets of this case, and the samples of each.
    fn amounts(self, settings: &Settings) -> (usize, f64) {
        match self.variant {
            Variant::Staged => settings.pick((5, 700_000.0), (2, 100_000.0)),
            Variant::AsPrinted => settings.pick((2, 700_000.0), (1, 30_000.0)),
        }
    }

    fn key(self) -> String {
        let variant = match self.variant {
            Variant::Staged => "staged",
            Variant::AsPrinted => "printed",
        };
        format!("{variant}-{}", self.leaf)
    }

    fn parameters(self, settings: &Settings, index: usize) -> Parameters {
        let base = Parameters {
            variant: self.variant,
            ..square(self.amounts(settings).1, self.leaf)
        };
        seeded(base, seed(settings, index))
    }
}

fn cases(settings: &Settings) -> Vec<SearchCase> {
    let leaves = settings.pick(vec![10.0, 20.0, 40.0, 80.0], vec![20.0, 40.0]);
    let of = |variant| {
        let case = move |leaf: &f64| SearchCase {
            leaf: *leaf,
            variant,
        };
        leaves.iter().map(case).collect::<Vec<_>>()
    };
    [of(Variant::Staged), of(Variant::AsPrinted)].concat()
}

pub fn units(settings: &Settings) -> usize {
    cases(settings).len()
}

pub fn run(study: &Study<'_>) -> Result<Outcome, ReproduceError> {
    let settings = study.settings;
    let mut found: Vec<GapStatistics> = Vec::new();
    for case in cases(settings) {
        let what = format!("{} r, {:?}", case.leaf, case.variant);
        let sets: Vec<GapStatistics> = study.unit(&case.key(), &what, |control| {
            let sets = 0..case.amounts(settings).0;
            sets.into_par_iter()
                .map(|index| measure(case, settings, index, control))
                .collect()
        })?;
        found.extend(sets);
    }
    let control = study.control("the pictures");
    let mut pictures = vec![gaps::bars(&found)?];
    if let Some(worst) = gaps::worst(&found) {
        let case = SearchCase {
            leaf: worst.leaf,
            variant: Variant::Staged,
        };
        let parameters = case.parameters(settings, worst.index);
        let (set, _) = make(&parameters, Search::TwoRadii, &control)?;
        pictures.extend(picture::witnesses(&set, &worst.two.worst)?);
    }
    Ok(Outcome {
        claims: claims(&found),
        pictures,
        tables: vec![gaps::by_leaf(&found), gaps::by_set(&found)],
        notes: vec![NOTE.to_owned()],
    })
}

const NOTE: &str = "A detector fills the circumcentre of itself and two samples that it sees. The three samples around a gap lie up to \
twice the gap's circumradius apart, which is more than 2 r: a place is out of sight when none of its three sites has both others \
within 2 r, so that no detector at all could find it. In stages only inserted samples are detectors after the first iteration; \
Algorithm 4 as printed keeps every mark, so that all samples near a loss look again in each round. Every set has a seed and a \
pattern of its own.";

/// Makes a set, and returns it with the number of samples that were inserted.
fn make(
    parameters: &Parameters,
    search: Search,
    control: &Control<'_>,
) -> Result<(Set, usize), ReproduceError> {
    let parameters = Parameters {
        search,
        ..*parameters
    };
    if parameters.variant == Variant::Staged {
        let (set, summary) = Set::kdrt(&parameters, control)?;
        return Ok((set, summary.inserted.iter().sum()));
    }
    let engine = Sequential::new(&parameters, pattern(&parameters.pattern, control)?)?;
    let run = engine.finish(&mut control.observer())?;
    let inserted = run.summary().inserted.iter().sum();
    Ok((Set::of(&run.domain, &run.points()), inserted))
}

fn measure(
    case: SearchCase,
    settings: &Settings,
    index: usize,
    control: &Control<'_>,
) -> Result<GapStatistics, ReproduceError> {
    let parameters = case.parameters(settings, index);
    let judged = |search| -> Result<GapCounts, ReproduceError> {
        let (set, inserted) = make(&parameters, search, control)?;
        GapCounts::of(&set, inserted, control)
    };
    Ok(GapStatistics {
        leaf: case.leaf,
        printed: case.variant == Variant::AsPrinted,
        index,
        seed: parameters.seed,
        two: judged(Search::TwoRadii)?,
        four: judged(Search::Complete)?,
    })
}

fn claims(found: &[GapStatistics]) -> Vec<Claim> {
    let sight = gaps::sight(found);
    let again = "Here every marked sample looks again in each round.";
    let enough = "2r is enough in practice, not proved";
    let follows = "follows from theorem 3.2";
    let of = |printed, pick: fn(&GapStatistics) -> &GapCounts| -> Vec<&GapCounts> {
        let fits = found.iter().filter(|one| one.printed == printed);
        fits.map(pick).collect()
    };
    let two = |printed| ("Looking 2r far leaves no gap", of(printed, |one| &one.two));
    let four = |printed| ("Looking 4r far leaves no gap", of(printed, |one| &one.four));
    vec![
        claim(two(true), AS_PRINTED, enough, again),
        claim(four(true), AS_PRINTED, follows, again),
        claim(two(false), IN_STAGES, enough, &sight),
        claim(four(false), IN_STAGES, follows, ""),
    ]
}

/// Ways to make sets, and the sections of their claims.
const AS_PRINTED: [&str; 2] = ["Algorithm 4 as printed", "section 3.2.2"];
const IN_STAGES: [&str; 2] = [
    "in this program's arrangement in stages",
    crate::outcome::BEYOND,
];

fn claim(
    (claim, sets): (&str, Vec<&GapCounts>),
    [way, section]: [&str; 2],
    paper: &str,
    more: &str,
) -> Claim {
    let holes: usize = sets.iter().map(|one| one.holes).sum();
    let samples: usize = sets.iter().map(|one| one.count).sum();
    let worst = sets
        .iter()
        .map(|one| one.covering_radius)
        .fold(0.0, f64::max);
    let holds = holes == 0 && sets.iter().all(|one| one.centers == 0);
    let rule = "Holds if the verifier finds no gap in any set; less than a million samples can refute it but not confirm it.";
    Claim::new(
        [&format!("{claim} ({way})"), section, paper],
        format!(
            "{} in {} sets of {} samples in all ({}); covering radius up to {} r",
            match holes {
                0 => "no gap".to_owned(),
                1 => "1 gap".to_owned(),
                _ => format!("{} gaps", counted(holes)),
            },
            sets.len(),
            counted(samples),
            rate(holes, samples),
            number(worst, 7)
        ),
        Verdict::if_known(!holds || samples >= ENOUGH, holds),
        format!("{rule} {more}").trim_end(),
    )
}

/// Returns how frequent gaps are; without any gap, how frequent they may be with 99 % confidence.
fn rate(holes: usize, samples: usize) -> String {
    let a_million = |gaps: f64| number(1e6 * gaps / samples.max(1) as f64, 2);
    let [low, high] = poisson_interval(holes).map(a_million);
    if holes == 0 {
        return format!("with 99 % confidence at most {high} a million");
    }
    format!(
        "{} a million, with 99 % confidence {low} to {high}",
        a_million(holes as f64)
    )
}

#[cfg(test)]
mod tests;
