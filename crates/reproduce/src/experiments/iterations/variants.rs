//! Insertion in stages against Algorithm 4 as printed, whose first loop inserts while it eliminates. Only the
//! sequential engine carries out the latter, so these sets are smaller.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use tilescope_core::{Order, Parameters, Sequential, Variant};

use super::counts::IterationCounts;
use crate::control::Control;
use crate::error::ReproduceError;
use crate::experiments::common::{seed, seeded, square};
use crate::outcome::Table;
use crate::sets::{Set, pattern};
use crate::study::{Settings, Study};
use crate::table::table;

const LEAF: f64 = 20.0;

/// Samples inserted by iteration in one set, by variant.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Compared {
    seed: u64,
    count: usize,
    staged: Vec<usize>,
    printed: Vec<usize>,
}

fn amounts(settings: &Settings) -> (usize, f64) {
    settings.pick((10, 500_000.0), (4, 20_000.0))
}

/// Sets as large as the paper's that are made as printed, and the samples of each.
fn large(settings: &Settings) -> (usize, f64) {
    settings.pick((2, super::PAPER_SAMPLES), (0, 0.0))
}

/// Samples of a set, and those inserted by iteration: as printed, in the first loop and in each round of the second.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SetCounts {
    pub count: usize,
    pub inserted: Vec<usize>,
}

impl From<&Compared> for SetCounts {
    fn from(compared: &Compared) -> Self {
        Self {
            count: compared.count,
            inserted: compared.printed.clone(),
        }
    }
}

impl From<&IterationCounts> for SetCounts {
    fn from(one: &IterationCounts) -> Self {
        Self {
            count: one.summary.count,
            inserted: one.summary.inserted.clone(),
        }
    }
}

/// Returns the sets made as printed that are as large as the paper's.
pub fn printed(study: &Study<'_>) -> Result<Vec<SetCounts>, ReproduceError> {
    let settings = study.settings;
    let (sets, samples) = large(settings);
    if sets == 0 {
        return Ok(Vec::new());
    }
    study.unit("printed", "large sets as printed", |control| {
        let make = |index| {
            let seed = seed(settings, index);
            let (inserted, count) = inserted(&base(samples, seed), Variant::AsPrinted, control)?;
            Ok(SetCounts { count, inserted })
        };
        // In turn: each takes gigabytes of memory.
        (0..sets).map(make).collect()
    })
}

pub fn units(settings: &Settings) -> usize {
    if large(settings).0 == 0 { 1 } else { 2 }
}

/// Returns one set of each seed by both variants, verified.
pub fn compare(study: &Study<'_>) -> Result<Vec<Compared>, ReproduceError> {
    let settings = study.settings;
    let (sets, _) = amounts(settings);
    study.unit("variants", "staged and as printed", |control| {
        (0..sets)
            .into_par_iter()
            .map(|index| one(seed(settings, index), settings, control))
            .collect()
    })
}

fn one(seed: u64, settings: &Settings, control: &Control<'_>) -> Result<Compared, ReproduceError> {
    let base = base(amounts(settings).1, seed);
    let (staged, count) = inserted(&base, Variant::Staged, control)?;
    let (printed, _) = inserted(&base, Variant::AsPrinted, control)?;
    Ok(Compared {
        seed,
        count,
        staged,
        printed,
    })
}

fn base(samples: f64, seed: u64) -> Parameters {
    let base = Parameters {
        order: Order::Index,
        ..square(samples, LEAF)
    };
    seeded(base, seed)
}

/// Returns the samples inserted by iteration, and how many there are in all, of a set that was verified.
fn inserted(
    base: &Parameters,
    variant: Variant,
    control: &Control<'_>,
) -> Result<(Vec<usize>, usize), ReproduceError> {
    let parameters = Parameters { variant, ..*base };
    let engine = Sequential::new(&parameters, pattern(&base.pattern, control)?)?;
    let run = engine.finish(&mut control.observer())?;
    let set = Set::of(&run.domain, &run.points());
    set.verified(&format!("{variant:?}, seed {}", base.seed), control)?;
    let summary = run.summary();
    Ok((summary.inserted, summary.count))
}

pub fn compared_table(compared: &[Compared]) -> Table {
    let at = |inserted: &[usize], k: usize| inserted.get(k).copied().unwrap_or(0);
    let late = |inserted: &[usize]| inserted.iter().skip(2).sum::<usize>();
    let iterations = "first loop and rounds that insert, as printed";
    let title = "Insertion in stages and as printed, leaf 20 r, order by index";
    table("variants", title, compared)
        .column("seed", "seed", 6, |one| one.seed)
        .column("samples", "samples", 7, |one| one.count)
        .column("staged_iterations", "iterations, staged", 2, |one| {
            one.staged.len()
        })
        .column("staged_1", "inserted in 1, staged", 6, |one| {
            at(&one.staged, 0)
        })
        .column("staged_2", "in 2", 6, |one| at(&one.staged, 1))
        .column("staged_late", "later", 6, |one| late(&one.staged))
        .column("printed_iterations", iterations, 2, |one| one.printed.len())
        .column("printed_1", "inserted in first loop", 6, |one| {
            at(&one.printed, 0)
        })
        .column("printed_2", "in round 1", 6, |one| at(&one.printed, 1))
        .column("printed_late", "later", 6, |one| late(&one.printed))
        .shown()
}

pub fn printed_table(printed: &[SetCounts]) -> Table {
    let most = printed.iter().map(|one| one.inserted.len()).max();
    let at = |one: &SetCounts, k: usize| one.inserted.get(k).copied().unwrap_or(0);
    let title = "Algorithm 4 as printed, leaf 20 r, order by index";
    let mut rounds = table("printed", title, printed)
        .column("samples", "samples", 9, |one| one.count)
        .column("first_loop", "inserted in the first loop", 8, |one| {
            at(one, 0)
        });
    for k in 1..most.unwrap_or(0) {
        let head = format!("in round {k} of the second");
        rounds = rounds.column(&format!("round_{k}"), &head, 8, |one| at(one, k));
    }
    rounds.shown()
}
