//! The figure: each procedure's share of a run, for every leaf size.

use tilescope_figures::Palette;

use super::rows::Row;
use super::stages::Plan;
use crate::bars::{
    Bar, Bars, bars_scene, drawn_count, drawn_number as number, whisker, whisker_words,
};
use crate::outcome::Picture;

/// Returns the figure.
pub fn shares(rows: &[Row], plan: &Plan) -> Picture {
    let groups: Vec<Bars> = rows.iter().map(group).collect();
    let title = format!(
        "Share of the time that each procedure takes, about {} samples, one thread",
        number(plan.samples as f64, 3)
    );
    Picture {
        name: "procedures".to_owned(),
        caption: format!(
            "Each procedure's share of a run's time and its milliseconds, for about {} samples on one thread: medians of {} rounds, whiskers \
             {}. Elimination and the first insertion in the first colour.",
            number(plan.samples as f64, 3),
            plan.rounds,
            whisker_words(plan.rounds as usize)
        ),
        scene: bars_scene(
            &title,
            "share of the run's time, %",
            &groups,
            &Palette::LIGHT,
        ),
    }
}

fn group(row: &Row) -> Bars {
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
            spread: Some(whisker(share).map(|part| 100.0 * part)),
            text: format!(
                "{} %, {} ms",
                number(median, 2),
                number(1e3 * seconds.quartiles[1], 3)
            ),
            kind: usize::from(!procedure.is_first()),
        }
    });
    Bars {
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
