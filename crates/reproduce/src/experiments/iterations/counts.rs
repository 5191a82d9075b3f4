//! The iterations and inserted samples of each set, their tables and their charts.

use serde::{Deserialize, Serialize};
use serde_json::json;
use tilescope_core::{Order, Summary};
use tilescope_figures::chart::{Bar, BarGroup};

use super::variants::inserted as inserted_in;
use crate::error::Result;
use crate::experiments::common::{bar_picture, ends};
use crate::numbers::{drawn_count, drawn_number};
use crate::outcome::{Picture, Table};
use crate::texts::table;

/// Columns of iterations that the table of all sets has at least. Chosen, not measured: sets with more iterations add
/// columns.
const COLUMNS: usize = 8;

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
}

fn of(found: &[IterationCounts], case: InsertionCase) -> Vec<&IterationCounts> {
    found.iter().filter(|one| one.case == case).collect()
}

fn most_iterations(found: &[IterationCounts]) -> usize {
    let iterations = found.iter().map(IterationCounts::iterations);
    iterations.max().unwrap_or(0)
}

/// Returns the numbers of each case over its sets. Means of a case without sets are null.
pub fn by_case(found: &[IterationCounts], cases: &[InsertionCase]) -> Table {
    table("iterations/cases", cases, |case| {
        let sets = of(found, *case);
        let total = |count: &dyn Fn(&Summary) -> usize| -> usize {
            sets.iter().map(|one| count(&one.summary)).sum()
        };

        let samples = total(&|set| set.count) as f64;
        let inserted = total(&|set| set.inserted.iter().sum()) as f64;
        // All cases have the columns of the one with the most iterations; the number of an iteration takes the place of
        // `{n}` in the key below.
        let in_each =
            (0..most_iterations(found)).map(|k| (k + 1, total(&|set| inserted_in(set, k))));
        let iterations = || sets.iter().map(|one| one.iterations());

        json!({
            "order": case.order(), "leaf_r": case.leaf, "sets": sets.len(),
            "samples": samples / sets.len() as f64, "inserted_percent": 100.0 * inserted / samples,
            "least": iterations().min(), "most": iterations().max(),
            "inserted_{n}": in_each.collect::<Vec<_>>(),
        })
    })
}

pub fn by_set(found: &[IterationCounts]) -> Table {
    table("iterations/sets", found, |one| {
        let columns = most_iterations(found).max(COLUMNS);
        let inserted = (0..columns).map(|k| (k + 1, inserted_in(&one.summary, k)));
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
fn groups_of(
    cases: &[InsertionCase],
    bars_of: impl Fn(InsertionCase) -> Vec<Bar>,
) -> Vec<BarGroup> {
    let group = |(color, &case): (usize, &InsertionCase)| {
        let bars = bars_of(case).into_iter().map(|bar| Bar { color, ..bar });
        BarGroup {
            heading: case.name(),
            bars: bars.collect(),
        }
    };
    cases.iter().enumerate().map(group).collect()
}

/// Returns a picture of how many samples each iteration inserts: means of the sets, with their extremes.
pub fn inserted(found: &[IterationCounts], cases: &[InsertionCase]) -> Result<Picture> {
    let iterations = most_iterations(found);
    let bar = |case: InsertionCase, k: usize| {
        let sets = of(found, case);
        let counts: Vec<f64> = sets
            .iter()
            .map(|one| inserted_in(&one.summary, k) as f64)
            .collect();

        // A case without sets has no mean and no extremes: the chart refuses such a bar.
        let mean = counts.iter().sum::<f64>() / counts.len() as f64;
        let whisker = ends(counts.into_iter());
        let [least, most] = whisker.map(|count| drawn_count(count as usize));

        Bar {
            name: format!("iteration {}", k + 1),
            value: mean,
            whisker: Some(whisker),
            text: format!("{} ({least} to {most})", drawn_mean(mean)),
            // `groups_of` sets the colour.
            color: 0,
        }
    };

    let groups = groups_of(cases, |case| {
        (0..iterations).map(|k| bar(case, k)).collect()
    });
    let largest = found.iter().map(|one| one.summary.count).max().unwrap_or(0);
    let values = json!({ "sets": found.len(), "largest": largest });
    bar_picture("iterations/iterations", &values, groups)
}

/// Returns a mean of counts with no more digits than a few sets tell: tenths of small ones alone.
fn drawn_mean(mean: f64) -> String {
    if mean >= 10.0 || mean.fract() == 0.0 {
        return drawn_count(mean.round() as usize);
    }
    drawn_number(mean, if mean < 1.0 { 1 } else { 2 })
}

/// Returns bars of the sets by the iterations that they need.
pub fn needed(found: &[IterationCounts], cases: &[InsertionCase]) -> Result<Picture> {
    let least = found.iter().map(IterationCounts::iterations).min();
    let bar = |case: InsertionCase, iterations: usize| {
        let all = of(found, case);
        let sets = all
            .iter()
            .filter(|one| one.iterations() == iterations)
            .count();

        let plural = if iterations == 1 { "" } else { "s" };
        Bar {
            name: format!("{iterations} iteration{plural}"),
            value: sets as f64,
            whisker: None,
            text: format!("{sets} of {} sets", all.len()),
            // `groups_of` sets the colour.
            color: 0,
        }
    };

    // All cases have bars for the same numbers of iterations, so that they can be compared. The study has sets, so that
    // 0 never stands in.
    let range = least.unwrap_or(0)..=most_iterations(found);
    let groups = groups_of(cases, |case| range.clone().map(|k| bar(case, k)).collect());
    bar_picture("iterations/needed", &json!({}), groups)
}
