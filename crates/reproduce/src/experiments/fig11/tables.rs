//! The numbers of figure 11.

use tilescope_analysis::measures::Summary;

use super::rows::Row;
use super::stages::{Passes, Round, Timed};
use crate::bars::{whisker, whisker_columns};
use crate::outcome::{Cell, Column, Table};

/// Times and shares of procedures.
pub fn stages(rows: &[Row], rounds: usize) -> Table {
    let rows = rows.iter().flat_map(|row| {
        let of = |name: String, seconds: &Summary, share: f64| {
            let [low, high] = whisker(seconds);
            let [median, low, high] = [seconds.quartiles[1], low, high].map(|s| 1e3 * s);
            vec![
                row.name().into(),
                name.into(),
                median.into(),
                low.into(),
                high.into(),
                share.into(),
            ]
        };
        let each = row
            .procedures
            .iter()
            .map(move |(procedure, seconds, share)| {
                of(procedure.name(), seconds, 100.0 * share.quartiles[1])
            });
        let whole = of("all".to_owned(), &row.whole, 100.0);
        let parallel = row.parallel.iter().map(move |seconds| {
            let name = "parallel engine, all stages on all threads".to_owned();
            of(name, seconds, f64::NAN)
        });
        each.chain([whole]).chain(parallel).collect::<Vec<_>>()
    });
    let [low, high] = whisker_columns(rounds);
    let columns = [
        ("run", "run", 1),
        ("procedure", "procedure", 1),
        ("milliseconds", "ms", 3),
        (low.0, low.1, 3),
        (high.0, high.1, 3),
        ("share_percent", "share, %", 2),
    ];
    table(
        "procedures",
        "Time of each procedure, medians of rounds",
        &columns,
        rows.collect(),
    )
}

/// Key, heading and digits of its columns.
const COUNTS: [(&str, &str, usize); 11] = [
    ("leaf_r", "leaf, r", 3),
    ("variant", "Algorithm 4", 1),
    ("blocks", "blocks", 5),
    ("tiled", "tiled", 7),
    ("eliminated", "eliminated", 7),
    ("detectors_1", "detectors, iteration 1", 7),
    ("inserted_1", "inserted", 7),
    ("detectors_2", "detectors, iteration 2", 7),
    ("inserted_2", "inserted", 7),
    ("inserted_later", "inserted later", 7),
    ("samples", "samples", 7),
];

/// How many samples the procedures of the first round worked on.
pub fn counts(rounds: &[Round]) -> Table {
    let timed = rounds.iter().take(1).flat_map(|round| &round.timed);
    let row = |one: &Timed| {
        let counts = &one.counts;
        let at = |values: &[usize], index: usize| {
            values
                .get(index)
                .map_or(Cell::Missing(()), |value| (*value).into())
        };
        vec![
            one.leaf.into(),
            if one.printed { "as printed" } else { "staged" }.into(),
            counts.blocks.into(),
            counts.tiled.into(),
            counts.eliminated.into(),
            at(&counts.detectors, 0),
            at(&counts.inserted, 0),
            at(&counts.detectors, 1),
            at(&counts.inserted, 1),
            counts.inserted.iter().skip(2).sum::<usize>().into(),
            counts.count.into(),
        ]
    };
    table(
        "counts",
        "What the procedures of the first round worked on: samples",
        &COUNTS,
        timed.map(row).collect(),
    )
}

/// Times of a GPU's passes, by stage.
pub fn passes(passes: &[Passes]) -> Table {
    let row = |one: &Passes| {
        vec![
            one.adapter.clone().into(),
            one.stage.clone().into(),
            one.times.into(),
            one.seconds.map_or(Cell::Missing(()), |s| (1e3 * s).into()),
        ]
    };
    table(
        "passes",
        "Passes of a GPU, by stage, medians of rounds",
        &[
            ("adapter", "GPU", 1),
            ("stage", "stage", 1),
            ("passes", "passes", 4),
            ("milliseconds", "ms", 3),
        ],
        passes.iter().map(row).collect(),
    )
}

fn table(name: &str, title: &str, columns: &[(&str, &str, usize)], rows: Vec<Vec<Cell>>) -> Table {
    let column = |(key, head, digits): &(&str, &str, usize)| Column::new(key, head, *digits);
    Table {
        name: name.to_owned(),
        title: title.to_owned(),
        columns: columns.iter().map(column).collect(),
        rows,
        shown: true,
    }
}
