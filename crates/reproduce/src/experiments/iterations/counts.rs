//! The iterations and inserted samples of each set, their tables and their charts.

use serde::{Deserialize, Serialize};
use tilescope_core::{Order, Summary};
use tilescope_figures::chart::{Bar, BarGroup};

use crate::error::ReproduceError;
use crate::experiments::common::{bar_picture, counted};
use crate::numbers::{drawn_count, drawn_number};
use crate::outcome::{Picture, Table};
use crate::table::table;

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

    /// Returns the samples inserted after so many iterations.
    pub fn after(&self, iterations: usize) -> usize {
        self.summary.inserted.iter().skip(iterations).sum()
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

/// A case and its sets.
type Sets<'a> = (InsertionCase, Vec<&'a IterationCounts>);

/// Returns the numbers of each case over its sets.
pub fn by_case(found: &[IterationCounts], cases: &[InsertionCase]) -> Table {
    let total = |sets: &Sets<'_>, count: fn(&IterationCounts) -> usize| {
        sets.1.iter().map(|one| count(one)).sum::<usize>() as f64
    };
    let iterations =
        |sets: &Sets<'_>| -> Vec<usize> { sets.1.iter().map(|one| one.iterations()).collect() };
    let rows = cases
        .iter()
        .map(|&case| -> Sets<'_> { (case, of(found, case).collect()) });
    let mut numbers = table("cases", "Samples inserted by iteration", rows)
        .column("order", "order", 3, |sets| sets.0.order())
        .column("leaf_r", "leaf, r", 3, |sets| sets.0.leaf)
        .column("sets", "sets", 3, |sets| sets.1.len())
        .column("samples", "samples of a set, mean", 4, |sets| {
            total(sets, |one| one.summary.count) / sets.1.len() as f64
        })
        .column("inserted_percent", "inserted, % of samples", 3, |sets| {
            100.0 * total(sets, |one| one.after(0)) / total(sets, |one| one.summary.count)
        })
        .column("least", "fewest iterations", 2, |sets| {
            iterations(sets).into_iter().min()
        })
        .column("most", "most iterations", 2, |sets| {
            iterations(sets).into_iter().max()
        });
    for k in 0..most(found) {
        let head = format!("inserted in iteration {}, all sets", k + 1);
        numbers = numbers.column(&format!("inserted_{}", k + 1), &head, 8, |sets| {
            sets.1.iter().map(|one| one.in_iteration(k)).sum::<usize>()
        });
    }
    numbers.shown()
}

/// Returns the numbers of every set.
pub fn by_set(found: &[IterationCounts]) -> Table {
    let mut numbers = table("sets", "Every set", found)
        .column("order", "order", 3, |one| one.case.order())
        .column("leaf_r", "leaf, r", 3, |one| one.case.leaf)
        .column("seed", "seed", 6, |one| one.seed)
        .column("samples", "samples", 9, |one| one.summary.count)
        .column("tiled", "tiled", 9, |one| one.summary.tiled)
        .column("eliminated", "eliminated", 9, |one| one.summary.eliminated)
        .column("iterations", "iterations", 2, |one| one.iterations())
        .column("min_distance_r", "min. distance, r", 7, |one| {
            one.min_distance
        })
        .column("covering_radius_r", "covering radius, r", 7, |one| {
            one.covering_radius
        });
    for k in 0..most(found).max(COLUMNS) {
        let (key, head) = (format!("inserted_{}", k + 1), format!("inserted {}", k + 1));
        numbers = numbers.column(&key, &head, 8, |one| one.in_iteration(k));
    }
    numbers.hidden()
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
    let title = "Samples inserted by iteration (in stages), mean of the sets";
    let caption = format!(
        "Samples inserted by iteration, in stages, {} sets of up to {} samples. Whiskers, and the numbers in brackets: fewest and \
         most of a set.",
        found.len(),
        counted(largest)
    );
    bar_picture(
        "iterations",
        title,
        caption,
        ("samples inserted in a set", groups),
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
    let title = "Sets by the iterations that they need (in stages)";
    let caption = "How many iterations of insertion in stages sets need, by order and leaf.";
    bar_picture("needed", title, caption.to_owned(), ("sets", groups))
}
