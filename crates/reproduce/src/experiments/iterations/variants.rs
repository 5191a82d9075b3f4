//! Insertion in stages against Algorithm 4 as printed, whose first loop inserts while it eliminates. The algorithm as
//! printed is carried out by the sequential engine alone, so these sets are smaller.

use serde::{Deserialize, Serialize};
use serde_json::json;
use tilescope_core::{Order, Summary, Variant};

use crate::control::Control;
use crate::error::Result;
use crate::experiments::common::{seeded, square};
use crate::outcome::Table;
use crate::sets::{Set, sequential};
use crate::study::{Settings, Study};
use crate::texts::table;

/// Shortest edge of a block, in radii.
const LEAF: f64 = 20.0;

/// A set of each variant, of one seed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Compared {
    seed: u64,
    staged: Summary,
    pub printed: Summary,
}

/// Returns how many sets of each variant are made, and about how many samples each has.
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

/// Makes and verifies a set of each seed by each of the two variants. Returns the summaries of the sets.
pub fn compare(study: &Study<'_>) -> Result<Vec<Compared>> {
    let (sets, samples) = amounts(study.settings);
    study.sets(
        "variants",
        "staged and as printed",
        0..sets,
        |seed, control| {
            Ok(Compared {
                seed,
                staged: made(samples, seed, Variant::Staged, control)?,
                printed: made(samples, seed, Variant::AsPrinted, control)?,
            })
        },
    )
}

/// Returns the sets made as printed that are as large as the paper's. They are made in turn, since each takes gigabytes
/// of memory.
pub fn large_printed(study: &Study<'_>) -> Result<Vec<Summary>> {
    let settings = study.settings;
    let indices = 0..large(settings);
    if indices.is_empty() {
        return Ok(Vec::new());
    }
    study.unit("printed", "large sets as printed", |control| {
        let seeds = indices.map(|index| settings.seed_of(index));
        let made = |seed| made(super::PAPER_SAMPLES, seed, Variant::AsPrinted, control);
        seeds.map(made).collect()
    })
}

/// Makes and verifies a set. As printed, the first iteration is the first loop, and the others are rounds of the second.
fn made(samples: f64, seed: u64, variant: Variant, control: &Control<'_>) -> Result<Summary> {
    let mut parameters = seeded(square(samples, LEAF), seed);
    (parameters.order, parameters.variant) = (Order::Index, variant);
    let run = sequential(&parameters, control)?;
    Set::of_run(&run).verified(&format!("{variant:?}, seed {seed}"), control)?;
    Ok(run.summary())
}

/// Returns the samples inserted in an iteration, counted from 0.
pub fn inserted(set: &Summary, iteration: usize) -> usize {
    set.inserted.get(iteration).copied().unwrap_or(0)
}

pub fn compared_table(compared: &[Compared]) -> Table {
    // After the two iterations that the paper saw.
    let late = |set: &Summary| set.inserted.iter().skip(2).sum::<usize>();
    table("iterations/variants", compared, |one| {
        let (staged, printed) = (&one.staged, &one.printed);
        json!({
            "seed": one.seed, "samples": staged.count,
            "staged_iterations": staged.inserted.len(), "staged_1": inserted(staged, 0),
            "staged_2": inserted(staged, 1), "staged_late": late(staged),
            "printed_iterations": printed.inserted.len(), "printed_1": inserted(printed, 0),
            "printed_2": inserted(printed, 1), "printed_late": late(printed),
        })
    })
}

pub fn printed_table(printed: &[Summary]) -> Table {
    let rounds = printed.iter().map(|set| set.inserted.len()).max();
    table("iterations/printed", printed, |set| {
        let each = (1..rounds.unwrap_or(0)).map(|round| (round, inserted(set, round)));
        json!({
            "samples": set.count, "first_loop": inserted(set, 0),
            "round_{n}": each.collect::<Vec<_>>(),
        })
    })
}
