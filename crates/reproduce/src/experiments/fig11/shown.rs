//! The figure, each procedure's share of a run for every leaf size, and its numbers.

use serde_json::json;
use tilescope_analysis::measures::Summary;
use tilescope_figures::chart::{Bar, BarGroup};

use super::rows::LeafTimes;
use super::stages::StageRound;
use crate::error::Result;
use crate::experiments::common::bar_picture;
use crate::experiments::timing::{TimingPlan, whisker, whiskered};
use crate::numbers::{drawn_count, drawn_number as number};
use crate::outcome::{Picture, Table};
use crate::rates::PassTimes;
use crate::texts::table;

pub fn shares(rows: &[LeafTimes], plan: TimingPlan) -> Result<Picture> {
    let groups = rows.iter().map(group).collect();
    bar_picture("fig11/procedures", &plan.values(), groups)
}

/// Returns the bars of a leaf size: one for each procedure.
fn group(row: &LeafTimes) -> BarGroup {
    // An iteration with the median time 0 is one that most rounds lack: only the table has it.
    let shown = row
        .procedures
        .iter()
        .filter(|(_, seconds, _)| seconds.quartiles[1] > 0.0);
    let each = shown.map(|(procedure, seconds, share)| {
        let median = 100.0 * share.quartiles[1];
        Bar {
            name: procedure.name(),
            value: median,
            whisker: Some(whisker(share).map(|part| 100.0 * part)),
            text: format!(
                "{} %, {} ms",
                number(median, 2),
                number(1e3 * seconds.quartiles[1], 3)
            ),
            // Elimination and the first insertion, which the paper is about, have the first colour, all others the second.
            color: usize::from(!procedure.is_first()),
        }
    });

    BarGroup {
        heading: format!(
            "Leaf {} r{}: {} ms, {} samples",
            row.leaf,
            if row.printed {
                ", Algorithm 4 as printed"
            } else {
                ""
            },
            number(1e3 * row.whole.quartiles[1], 3),
            drawn_count(row.count)
        ),
        bars: each.collect(),
    }
}

/// Returns the table of the times and shares of each leaf size.
pub fn stages(rows: &[LeafTimes]) -> Table {
    // A run, a procedure, its seconds, and its share in percent.
    type Row<'a> = (String, String, &'a Summary, Option<f64>);
    let lines = rows.iter().flat_map(|row| -> Vec<Row<'_>> {
        let percent = |share: &Summary| Some(100.0 * share.quartiles[1]);
        let each = (row.procedures.iter())
            .map(|(of, seconds, share)| (row.name(), of.name(), seconds, percent(share)));

        let whole = (row.name(), "all".to_owned(), &row.whole, Some(100.0));
        // The parallel engine carries out all stages region by region, so that it has one time and no shares.
        let name = "parallel engine, all stages on all threads";
        let parallel = row
            .parallel
            .iter()
            .map(|seconds| (row.name(), name.to_owned(), seconds, None));

        each.chain([whole]).chain(parallel).collect()
    });

    table(
        "fig11/procedures",
        lines,
        |(run, procedure, seconds, share)| {
            // Seconds become milliseconds.
            whiskered(
                seconds,
                1e3,
                json!({
                    "run": run, "procedure": procedure, "milliseconds": 1e3 * seconds.quartiles[1],
                    "share_percent": share,
                }),
            )
        },
    )
}

/// Returns how many blocks, samples and detectors the procedures of the first round had. The other rounds repeat the
/// first one with other seeds, and have no rows.
pub fn counts(rounds: &[StageRound]) -> Table {
    // A set may need fewer iterations than there are columns.
    let at = |values: &[usize], index: usize| values.get(index).copied();
    let rows = rounds.iter().take(1).flat_map(|round| &round.timed);
    table("fig11/counts", rows, |one| {
        let (detectors, inserted) = (&one.detectors, &one.summary.inserted);
        json!({
            "leaf_r": one.leaf, "variant": if one.printed { "as printed" } else { "staged" },
            "blocks": one.summary.blocks, "tiled": one.summary.tiled,
            "eliminated": one.summary.eliminated,
            "detectors_1": at(detectors, 0), "inserted_1": at(inserted, 0),
            "detectors_2": at(detectors, 1), "inserted_2": at(inserted, 1),
            "inserted_later": inserted.iter().skip(2).sum::<usize>(), "samples": one.summary.count,
        })
    })
}

pub fn passes(passes: &[(String, PassTimes)]) -> Table {
    table("fig11/passes", passes, |(adapter, one)| {
        json!({
            "adapter": adapter, "stage": one.stage, "passes": one.times,
            "milliseconds": one.seconds.map(|seconds| 1e3 * seconds),
        })
    })
}
