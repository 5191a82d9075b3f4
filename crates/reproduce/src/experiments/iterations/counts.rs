//! The iterations and inserted samples of each set, their tables and their charts.

use serde::{Deserialize, Serialize};
use serde_json::json;
use tilescope_core::{Order, Summary};
use tilescope_figures::chart::{Bar, BarGroup};

use crate::error::ReproduceError;
use crate::experiments::common::bar_picture;
use crate::numbers::{drawn_count, drawn_number};
use crate::outcome::{Picture, Table};
use crate::texts::table;

/// Columns of iterations in the table of all sets.
const COLUMNS: usize = 8;

/// The order and leaf size of the sets of a case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct InsertionCase {
    pub order: Order,
    pub leaf: f64,
}

impl InsertionCase {
    fn order(self) -> &'static str {
        match self.order {
            Order::Index => "by index",
            Order::OwnBlockFirst => "own block first",
            Order::Random => "random",
            Order::PhaseGroup => "phase groups",
        }
    }

    pub fn key(self) -> String {
        format!("{}-{}", self.order().replace(' ', "-"), self.leaf)
    }

    pub fn name(self) -> String {
        format!("leaf {} r, {}", self.leaf, self.order())
    }
}

/// The counts of one set.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct IterationCounts {
    pub case: InsertionCase,
    pub seed: u64,
    pub summary: Summary,
    pub min_distance: f64,
    pub covering_radius: f64,
}

impl IterationCounts {
    pub fn iterations(&self) -> usize {
        self.summary.inserted.len()
    }

    /// Returns the samples inserted in an iteration, counted from 0.
    fn in_iteration(&self, k: usize) -> usize {
        self.summary.inserted.get(k).copied().unwrap_or(0)
    }
}

fn of(
    found: &[IterationCounts],
    case: InsertionCase,
) -> impl Iterator<Item = &IterationCounts> + Clone {
    found.iter().filter(move |one| one.case == case)
}

fn most(found: &[IterationCounts]) -> usize {
    found
        .iter()
        .map(IterationCounts::iterations)
        .max()
        .unwrap_or(0)
}

/// Returns the numbers of each case over its sets.
pub fn by_case(found: &[IterationCounts], cases: &[InsertionCase]) -> Table {
    table("iterations/cases", cases, |case| {
        let sets = of(found, *case);
        let total =
            |count: &dyn Fn(&IterationCounts) -> usize| sets.clone().map(count).sum::<usize>();
        let samples = total(&|one| one.summary.count) as f64;
        let inserted = total(&|one| one.summary.inserted.iter().sum()) as f64;
        let by_iteration = (0..most(found)).map(|k| (k + 1, total(&|one| one.in_iteration(k))));
        let iterations = sets.clone().map(IterationCounts::iterations);
        json!({
            "order": case.order(), "leaf_r": case.leaf, "sets": sets.clone().count(),
            "samples": samples / sets.clone().count() as f64,
            "inserted_percent": 100.0 * inserted / samples,
            "least": iterations.clone().min(), "most": iterations.max(),
            "inserted_{n}": by_iteration.collect::<Vec<_>>(),
        })
    })
}

/// Returns the numbers of every set.
pub fn by_set(found: &[IterationCounts]) -> Table {
    table("iterations/sets", found, |one| {
        let inserted = (0..most(found).max(COLUMNS)).map(|k| (k + 1, one.in_iteration(k)));
        json!({
            "order": one.case.order(), "leaf_r": one.case.leaf, "seed": one.seed,
            "samples": one.summary.count, "tiled": one.summary.tiled,
            "eliminated": one.summary.eliminated, "iterations": one.iterations(),
            "min_distance_r": one.min_distance, "covering_radius_r": one.covering_radius,
            "inserted_{n}": inserted.collect::<Vec<_>>(),
        })
    })
}

/// Returns a group of bars for each case, in one colour.
fn groups(cases: &[InsertionCase], bars: impl Fn(InsertionCase) -> Vec<Bar>) -> Vec<BarGroup> {
    let group = |(color, &case): (usize, &InsertionCase)| {
        let bars = bars(case).into_iter().map(|bar| Bar { color, ..bar });
        BarGroup {
            heading: case.name(),
            bars: bars.collect(),
        }
    };
    cases.iter().enumerate().map(group).collect()
}

/// Returns bars of the samples by iteration.
pub fn inserted(
    found: &[IterationCounts],
    cases: &[InsertionCase],
) -> Result<Picture, ReproduceError> {
    let most = most(found);
    let bar = |case: InsertionCase, k: usize| {
        let counts = || of(found, case).map(|one| one.in_iteration(k));
        let (low, high) = (counts().min().unwrap_or(0), counts().max().unwrap_or(0));
        let mean = counts().sum::<usize>() as f64 / counts().count().max(1) as f64;
        let [least, most] = [low, high].map(drawn_count);
        Bar {
            name: format!("iteration {}", k + 1),
            value: mean,
            whisker: Some([low, high].map(|count| count as f64)),
            text: format!("{} ({least} to {most})", drawn_mean(mean)),
            color: 0,
        }
    };
    let groups = groups(cases, |case| (0..most).map(|k| bar(case, k)).collect());
    let largest = found.iter().map(|one| one.summary.count).max().unwrap_or(0);
    let values = json!({ "sets": found.len(), "largest": largest });
    bar_picture(
        "iterations/iterations",
        &values,
        "samples inserted in a set",
        groups,
    )
}

/// Returns a mean of counts with no more digits than a few sets tell: tenths of small ones alone.
fn drawn_mean(mean: f64) -> String {
    if mean >= 10.0 || mean.fract() == 0.0 {
        return drawn_count(mean.round() as usize);
    }
    drawn_number(mean, if mean < 1.0 { 1 } else { 2 })
}

/// Returns bars of the sets by the iterations that they need.
pub fn needed(
    found: &[IterationCounts],
    cases: &[InsertionCase],
) -> Result<Picture, ReproduceError> {
    let least = found.iter().map(IterationCounts::iterations).min();
    let bar = |case: InsertionCase, iterations: usize| {
        let sets = of(found, case).filter(|one| one.iterations() == iterations);
        let sets = sets.count();
        let plural = if iterations == 1 { "" } else { "s" };
        Bar {
            name: format!("{iterations} iteration{plural}"),
            value: sets as f64,
            whisker: None,
            text: format!("{sets} of {} sets", of(found, case).count()),
            color: 0,
        }
    };
    let range = least.unwrap_or(0)..=most(found);
    let groups = groups(cases, |case| range.clone().map(|k| bar(case, k)).collect());
    bar_picture("iterations/needed", &json!({}), "sets", groups)
}
