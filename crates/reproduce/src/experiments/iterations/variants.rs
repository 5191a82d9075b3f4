//! Insertion in stages against Algorithm 4 as printed, whose first loop inserts while it eliminates. Only the
//! sequential engine carries out the latter, so these sets are smaller.

use serde::{Deserialize, Serialize};
use serde_json::json;
use tilescope_core::{Order, Parameters, Variant};

use super::counts::IterationCounts;
use crate::control::Control;
use crate::error::ReproduceError;
use crate::experiments::common::{seeded, square};
use crate::outcome::Table;
use crate::sets::{Set, sequential};
use crate::study::{Settings, Study};
use crate::texts::table;

const LEAF: f64 = 20.0;

/// A set of each variant, of one seed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Compared {
    seed: u64,
    staged: InsertionCounts,
    pub printed: InsertionCounts,
}

/// Samples of a set, and those inserted by iteration: as printed, in the first loop and in each round of the second.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct InsertionCounts {
    pub count: usize,
    pub inserted: Vec<usize>,
}

impl InsertionCounts {
    fn at(&self, iteration: usize) -> usize {
        self.inserted.get(iteration).copied().unwrap_or(0)
    }
}

impl From<&IterationCounts> for InsertionCounts {
    fn from(one: &IterationCounts) -> Self {
        Self {
            count: one.summary.count,
            inserted: one.summary.inserted.clone(),
        }
    }
}

/// Returns sets of both variants, and the samples of each.
fn amounts(settings: &Settings) -> (usize, f64) {
    settings.pick((10, 500_000.0), (4, 20_000.0))
}

/// Returns how many sets as large as the paper's are made as printed.
fn large(settings: &Settings) -> u64 {
    settings.pick(2, 0)
}

pub fn units(settings: &Settings) -> usize {
    if large(settings) == 0 { 1 } else { 2 }
}

/// Returns one set of each seed by both variants, verified.
pub fn compare(study: &Study<'_>) -> Result<Vec<Compared>, ReproduceError> {
    let (sets, samples) = amounts(study.settings);
    study.sets(
        "variants",
        "staged and as printed",
        0..sets,
        |seed, control| {
            Ok(Compared {
                seed,
                staged: inserted(samples, seed, Variant::Staged, control)?,
                printed: inserted(samples, seed, Variant::AsPrinted, control)?,
            })
        },
    )
}

/// Returns the sets made as printed that are as large as the paper's. They are made in turn, since each takes gigabytes
/// of memory.
pub fn large_printed(study: &Study<'_>) -> Result<Vec<InsertionCounts>, ReproduceError> {
    let settings = study.settings;
    let indices = 0..large(settings);
    if indices.is_empty() {
        return Ok(Vec::new());
    }
    study.unit("printed", "large sets as printed", |control| {
        let seeds = indices.map(|index| settings.seed_of(index));
        seeds
            .map(|seed| inserted(super::PAPER_SAMPLES, seed, Variant::AsPrinted, control))
            .collect()
    })
}

/// Makes and verifies a set.
fn inserted(
    samples: f64,
    seed: u64,
    variant: Variant,
    control: &Control<'_>,
) -> Result<InsertionCounts, ReproduceError> {
    let parameters = Parameters {
        order: Order::Index,
        variant,
        ..square(samples, LEAF)
    };
    let run = sequential(&seeded(parameters, seed), control)?;
    Set::of_run(&run).verified(&format!("{variant:?}, seed {seed}"), control)?;
    let summary = run.summary();
    Ok(InsertionCounts {
        count: summary.count,
        inserted: summary.inserted,
    })
}

pub fn compared_table(compared: &[Compared]) -> Table {
    let late = |one: &InsertionCounts| one.inserted.iter().skip(2).sum::<usize>();
    table(
        "iterations/variants",
        compared,
        |Compared {
             seed,
             staged,
             printed,
         }| {
            json!({
                "seed": seed, "samples": staged.count,
                "staged_iterations": staged.inserted.len(),
                "staged_1": staged.at(0), "staged_2": staged.at(1), "staged_late": late(staged),
                "printed_iterations": printed.inserted.len(),
                "printed_1": printed.at(0), "printed_2": printed.at(1), "printed_late": late(printed),
            })
        },
    )
}

pub fn printed_table(printed: &[InsertionCounts]) -> Table {
    let rounds = printed
        .iter()
        .map(|one| one.inserted.len())
        .max()
        .unwrap_or(0);
    table("iterations/printed", printed, |one| {
        json!({
            "samples": one.count, "first_loop": one.at(0),
            "round_{n}": (1..rounds).map(|round| (round, one.at(round))).collect::<Vec<_>>(),
        })
    })
}
