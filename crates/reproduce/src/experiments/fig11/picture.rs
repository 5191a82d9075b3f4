//! The figure: each procedure's share of a run, for every leaf size.

use serde_json::json;
use tilescope_figures::chart::{Bar, BarGroup};

use super::rows::LeafTimes;
use crate::error::ReproduceError;
use crate::experiments::common::bar_picture;
use crate::experiments::timing::{TimingPlan, whisker, whisker_words};
use crate::numbers::{drawn_count, drawn_number as number};
use crate::outcome::Picture;

/// Returns the figure.
pub fn shares(rows: &[LeafTimes], plan: TimingPlan) -> Result<Picture, ReproduceError> {
    let values = json!({
        "samples": number(plan.samples as f64, 3), "rounds": plan.rounds,
        "whiskers": whisker_words(plan.rounds as usize),
    });
    let groups = rows.iter().map(group).collect();
    bar_picture(
        "fig11/procedures",
        &values,
        "share of the run's time, %",
        groups,
    )
}

fn group(row: &LeafTimes) -> BarGroup {
    // Iterations that most rounds lack are in the table.
    let most = row
        .procedures
        .iter()
        .filter(|(_, seconds, _)| seconds.quartiles[1] > 0.0);
    let each = most.map(|(procedure, seconds, share)| {
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
