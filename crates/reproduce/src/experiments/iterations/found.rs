//! What is found of each set, its tables and its charts. No verdict is decided here.

use serde::{Deserialize, Serialize};
use tilescope_core::Order;
use tilescope_figures::Palette;

use crate::bars::{Bar, Bars, bars_scene, drawn_count, drawn_number};
use crate::experiments::common::{columns, counted};
use crate::outcome::{Cell, Column, Picture, Table};

/// Columns of iterations in the table of all sets.
const COLUMNS: usize = 8;

/// What the sets of a case have in common.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    pub order: Order,
    pub leaf: f64,
}

impl Case {
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

/// What is found of one set.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Found {
    pub case: Case,
    pub seed: u64,
    pub count: usize,
    pub tiled: usize,
    pub eliminated: usize,
    /// Samples inserted by iteration.
    pub inserted: Vec<usize>,
    pub min_distance: f64,
    pub covering_radius: f64,
}

impl Found {
    pub fn iterations(&self) -> usize {
        self.inserted.len()
    }

    /// Returns the samples inserted after so many iterations.
    pub fn after(&self, iterations: usize) -> usize {
        self.inserted.iter().skip(iterations).sum()
    }
}

fn of(found: &[Found], case: Case) -> impl Iterator<Item = &Found> + Clone {
    found.iter().filter(move |one| one.case == case)
}

fn most(found: &[Found]) -> usize {
    found.iter().map(Found::iterations).max().unwrap_or(0)
}

const CASE: [(&str, &str, usize); 7] = [
    ("order", "order", 3),
    ("leaf_r", "leaf, r", 3),
    ("sets", "sets", 3),
    ("samples", "samples of a set, mean", 4),
    ("inserted_percent", "inserted, % of samples", 3),
    ("least", "fewest iterations", 2),
    ("most", "most iterations", 2),
];

/// Returns the numbers of each case over its sets.
pub fn by_case(found: &[Found], cases: &[Case]) -> Table {
    let most = most(found);
    let mut heads = columns(&CASE);
    for k in 1..=most {
        let head = format!("inserted in iteration {k}, all sets");
        heads.push(Column::new(&format!("inserted_{k}"), &head, 8));
    }
    let row = |&case: &Case| {
        let sets = || of(found, case);
        let total = |count: fn(&Found) -> usize| sets().map(count).sum::<usize>() as f64;
        let number = sets().count();
        let iterations = || sets().map(Found::iterations);
        let mut row: Vec<Cell> = vec![
            case.order().into(),
            case.leaf.into(),
            number.into(),
            (total(|one| one.count) / number as f64).into(),
            (100.0 * total(|one| one.after(0)) / total(|one| one.count)).into(),
            iterations().min().unwrap_or(0).into(),
            iterations().max().unwrap_or(0).into(),
        ];
        let in_iteration = |k: usize| sets().filter_map(|one| one.inserted.get(k)).sum::<usize>();
        row.extend((0..most).map(|k| Cell::from(in_iteration(k))));
        row
    };
    Table {
        name: "cases".to_owned(),
        title: "Samples inserted by iteration".to_owned(),
        columns: heads,
        rows: cases.iter().map(row).collect(),
        shown: true,
    }
}

const SET: [(&str, &str, usize); 9] = [
    ("order", "order", 3),
    ("leaf_r", "leaf, r", 3),
    ("seed", "seed", 6),
    ("samples", "samples", 9),
    ("tiled", "tiled", 9),
    ("eliminated", "eliminated", 9),
    ("iterations", "iterations", 2),
    ("min_distance_r", "min. distance, r", 7),
    ("covering_radius_r", "covering radius, r", 7),
];

/// Returns the numbers of every set.
pub fn by_set(found: &[Found]) -> Table {
    let most = most(found).max(COLUMNS);
    let mut heads = columns(&SET);
    for k in 1..=most {
        heads.push(Column::new(
            &format!("inserted_{k}"),
            &format!("inserted {k}"),
            8,
        ));
    }
    let row = |one: &Found| {
        let mut row: Vec<Cell> = vec![
            one.case.order().into(),
            one.case.leaf.into(),
            one.seed.into(),
            one.count.into(),
            one.tiled.into(),
            one.eliminated.into(),
            one.iterations().into(),
            one.min_distance.into(),
            one.covering_radius.into(),
        ];
        row.extend((0..most).map(|k| Cell::from(one.inserted.get(k).copied().unwrap_or(0))));
        row
    };
    Table {
        name: "sets".to_owned(),
        title: "Every set".to_owned(),
        columns: heads,
        rows: found.iter().map(row).collect(),
        shown: false,
    }
}

/// Returns the pictures: samples by iteration, and sets by the number of iterations.
pub fn pictures(found: &[Found], cases: &[Case]) -> Vec<Picture> {
    vec![inserted(found, cases), needed(found, cases)]
}

/// Returns bars of the samples by iteration.
fn inserted(found: &[Found], cases: &[Case]) -> Picture {
    let most = most(found);
    let group = |(kind, &case): (usize, &Case)| {
        let bar = |k: usize| {
            let counts = || of(found, case).map(|one| one.inserted.get(k).copied().unwrap_or(0));
            let (low, high) = (counts().min().unwrap_or(0), counts().max().unwrap_or(0));
            let mean = counts().sum::<usize>() as f64 / counts().count().max(1) as f64;
            Bar {
                name: format!("iteration {}", k + 1),
                value: mean,
                spread: Some([low, high].map(|count| count as f64)),
                text: format!(
                    "{} ({} to {})",
                    drawn_mean(mean),
                    drawn_count(low),
                    drawn_count(high)
                ),
                kind,
            }
        };
        Bars {
            heading: case.name(),
            bars: (0..most).map(bar).collect(),
        }
    };
    let groups: Vec<Bars> = cases.iter().enumerate().map(group).collect();
    let largest = found.iter().map(|one| one.count).max().unwrap_or(0);
    let title = "Samples inserted by iteration (in stages), mean of the sets";
    Picture {
        name: "iterations".to_owned(),
        caption: format!(
            "Samples inserted by iteration, in stages, {} sets of up to {} samples. Whiskers, and the numbers in brackets: fewest and \
             most of a set.",
            found.len(),
            counted(largest)
        ),
        scene: bars_scene(title, "samples inserted in a set", &groups, &Palette::LIGHT),
    }
}

/// Returns a mean of counts with no more digits than a few sets tell: tenths of small ones alone.
fn drawn_mean(mean: f64) -> String {
    if mean >= 10.0 || mean.fract() == 0.0 {
        return drawn_count(mean.round() as usize);
    }
    drawn_number(mean, if mean < 1.0 { 1 } else { 2 })
}

/// Returns bars of the sets by the iterations that they need.
fn needed(found: &[Found], cases: &[Case]) -> Picture {
    let counts = || found.iter().map(Found::iterations);
    let (least, most) = (counts().min().unwrap_or(0), counts().max().unwrap_or(0));
    let group = |(kind, &case): (usize, &Case)| {
        let all = of(found, case).count();
        let bar = |iterations: usize| {
            let sets = of(found, case).filter(|one| one.iterations() == iterations);
            let sets = sets.count();
            let plural = if iterations == 1 { "" } else { "s" };
            Bar {
                name: format!("{iterations} iteration{plural}"),
                value: sets as f64,
                spread: None,
                text: format!("{sets} of {all} sets"),
                kind,
            }
        };
        Bars {
            heading: case.name(),
            bars: (least..=most).map(bar).collect(),
        }
    };
    let groups: Vec<Bars> = cases.iter().enumerate().map(group).collect();
    let title = "Sets by the iterations that they need (in stages)";
    Picture {
        name: "needed".to_owned(),
        caption: "How many iterations of insertion in stages sets need, by order and leaf."
            .to_owned(),
        scene: bars_scene(title, "sets", &groups, &Palette::LIGHT),
    }
}
