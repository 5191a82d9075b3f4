//! Two ways to count: insertion in stages, and Algorithm 4 as printed, whose first loop inserts while it eliminates.
//! Only the sequential engine makes the latter, so the sets are smaller.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use tilescope_core::{Order, Parameters, Sequential, Variant};

use crate::control::Control;
use crate::error::ReproduceError;
use crate::experiments::common::{seed, seeded, square};
use crate::outcome::{Column, Table};
use crate::sets::{Set, pattern};
use crate::study::{Settings, Study};
use crate::work::Work;

const LEAF: f64 = 20.0;
/// The loop as printed searches all pairs around every mark: it takes about as long as so many staged runs.
const PRINTED_COST: f64 = 3.0;

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

/// Samples inserted in the first loop and in each round of the second, in a set made as printed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Printed {
    pub count: usize,
    pub inserted: Vec<usize>,
}

impl From<&Compared> for Printed {
    fn from(compared: &Compared) -> Self {
        Self {
            count: compared.count,
            inserted: compared.printed.clone(),
        }
    }
}

fn large_work(settings: &Settings) -> Work {
    let (sets, samples) = large(settings);
    Work {
        sequential: PRINTED_COST * samples * sets as f64,
        verified: samples * sets as f64,
        ..Work::default()
    }
}

/// Returns the sets made as printed that are as large as the paper's.
pub fn printed(study: &Study<'_>) -> Result<Vec<Printed>, ReproduceError> {
    let settings = study.settings;
    let (sets, samples) = large(settings);
    if sets == 0 {
        return Ok(Vec::new());
    }
    let unit = ("printed", "large sets as printed");
    study.unit(unit, large_work(settings), |control| {
        let make = |index| {
            let seed = seed(settings, index);
            let (inserted, count) = inserted(&base(samples, seed), Variant::AsPrinted, control)?;
            Ok(Printed { count, inserted })
        };
        // In turn: each takes gigabytes of memory.
        (0..sets).map(make).collect()
    })
}

/// One set by both variants, each verified, among as many at once as there are threads.
pub fn work(settings: &Settings) -> Work {
    compare_work(settings) + large_work(settings)
}

fn compare_work(settings: &Settings) -> Work {
    let (sets, samples) = amounts(settings);
    let threads = rayon::current_num_threads().min(sets) as f64;
    Work {
        sequential: (1.0 + PRINTED_COST) * samples * sets as f64 / threads,
        verified: 2.0 * samples * sets as f64,
        ..Work::default()
    }
}

pub fn compare(study: &Study<'_>) -> Result<Vec<Compared>, ReproduceError> {
    let settings = study.settings;
    let (sets, _) = amounts(settings);
    let unit = ("variants", "staged and as printed");
    study.unit(unit, compare_work(settings), |control| {
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

pub fn table(compared: &[Compared]) -> Table {
    let late = |inserted: &[usize], from: usize| inserted.iter().skip(from).sum::<usize>();
    let at = |inserted: &[usize], k: usize| inserted.get(k).copied().unwrap_or(0);
    let row = |one: &Compared| {
        let mut row = vec![one.seed.into(), one.count.into()];
        for inserted in [&one.staged, &one.printed] {
            row.push(inserted.len().into());
            row.extend([at(inserted, 0), at(inserted, 1), late(inserted, 2)].map(Into::into));
        }
        row
    };
    Table {
        name: "variants".to_owned(),
        title: "Insertion in stages and as printed, leaf 20 r, order by index".to_owned(),
        columns: [
            ("seed", "seed", 6),
            ("samples", "samples", 7),
            ("staged_iterations", "iterations, staged", 2),
            ("staged_1", "inserted in 1, staged", 6),
            ("staged_2", "in 2", 6),
            ("staged_late", "later", 6),
            (
                "printed_iterations",
                "first loop and rounds that insert, as printed",
                2,
            ),
            ("printed_1", "inserted in first loop", 6),
            ("printed_2", "in round 1", 6),
            ("printed_late", "later", 6),
        ]
        .map(|(key, head, digits)| Column::new(key, head, digits))
        .to_vec(),
        rows: compared.iter().map(row).collect(),
        shown: true,
    }
}

pub fn printed_table(printed: &[Printed]) -> Table {
    let most = printed
        .iter()
        .map(|one| one.inserted.len())
        .max()
        .unwrap_or(0);
    let mut columns = vec![
        Column::new("samples", "samples", 9),
        Column::new("first_loop", "inserted in the first loop", 8),
    ];
    for k in 1..most {
        let head = format!("in round {k} of the second");
        columns.push(Column::new(&format!("round_{k}"), &head, 8));
    }
    let row = |one: &Printed| {
        let at = |k: usize| one.inserted.get(k).copied().unwrap_or(0);
        let inserted = (0..most.max(1)).map(|k| at(k).into());
        std::iter::once(one.count.into()).chain(inserted).collect()
    };
    Table {
        name: "printed".to_owned(),
        title: "Algorithm 4 as printed, leaf 20 r, order by index".to_owned(),
        columns,
        rows: printed.iter().map(row).collect(),
        shown: true,
    }
}
