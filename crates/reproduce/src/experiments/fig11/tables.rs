//! The numbers of figure 11.

use super::rows::LeafTimes;
use super::stages::StageRound;
use crate::experiments::timing::{whisker, whisker_columns};
use crate::outcome::Table;
use crate::rates::PassTimes;
use crate::table::table;

/// Returns times and shares of procedures.
pub fn stages(rows: &[LeafTimes], rounds: usize) -> Table {
    let rows = rows.iter().flat_map(|row| {
        let each = row.procedures.iter().map(|(procedure, seconds, share)| {
            (
                row.name(),
                procedure.name(),
                seconds,
                Some(100.0 * share.quartiles[1]),
            )
        });
        let whole = (row.name(), "all".to_owned(), &row.whole, Some(100.0));
        let parallel = row.parallel.iter().map(|seconds| {
            let name = "parallel engine, all stages on all threads".to_owned();
            (row.name(), name, seconds, None)
        });
        each.chain([whole]).chain(parallel).collect::<Vec<_>>()
    });
    let [low, high] = whisker_columns(rounds);
    table(
        "procedures",
        "Time of each procedure, medians of rounds",
        rows,
    )
    .column("run", "run", 1, |row| row.0.clone())
    .column("procedure", "procedure", 1, |row| row.1.clone())
    .column("milliseconds", "ms", 3, |row| 1e3 * row.2.quartiles[1])
    .column(low.0, low.1, 3, |row| 1e3 * whisker(row.2)[0])
    .column(high.0, high.1, 3, |row| 1e3 * whisker(row.2)[1])
    .column("share_percent", "share, %", 2, |row| row.3)
    .shown()
}

/// Returns how many samples the procedures of the first round worked on.
pub fn counts(rounds: &[StageRound]) -> Table {
    let variant = |printed: bool| if printed { "as printed" } else { "staged" };
    let at = |values: &[usize], index: usize| values.get(index).copied();
    let rows = rounds.iter().take(1).flat_map(|round| &round.timed);
    table(
        "counts",
        "What the procedures of the first round worked on: samples",
        rows,
    )
    .column("leaf_r", "leaf, r", 3, |one| one.leaf)
    .column("variant", "Algorithm 4", 1, |one| variant(one.printed))
    .column("blocks", "blocks", 5, |one| one.summary.blocks)
    .column("tiled", "tiled", 7, |one| one.summary.tiled)
    .column("eliminated", "eliminated", 7, |one| one.summary.eliminated)
    .column("detectors_1", "detectors, iteration 1", 7, |one| {
        at(&one.detectors, 0)
    })
    .column("inserted_1", "inserted", 7, |one| {
        at(&one.summary.inserted, 0)
    })
    .column("detectors_2", "detectors, iteration 2", 7, |one| {
        at(&one.detectors, 1)
    })
    .column("inserted_2", "inserted", 7, |one| {
        at(&one.summary.inserted, 1)
    })
    .column("inserted_later", "inserted later", 7, |one| {
        one.summary.inserted.iter().skip(2).sum::<usize>()
    })
    .column("samples", "samples", 7, |one| one.summary.count)
    .shown()
}

/// Returns times of a GPU's passes, by stage.
pub fn passes(passes: &[(String, PassTimes)]) -> Table {
    table(
        "passes",
        "Passes of a GPU, by stage, medians of rounds",
        passes,
    )
    .column("adapter", "GPU", 1, |(adapter, _)| adapter.clone())
    .column("stage", "stage", 1, |(_, one)| one.stage.clone())
    .column("passes", "passes", 4, |(_, one)| one.times)
    .column("milliseconds", "ms", 3, |(_, one)| {
        one.seconds.map(|s| 1e3 * s)
    })
    .shown()
}
