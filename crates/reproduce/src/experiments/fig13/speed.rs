//! Verdicts on figure 13's rates: whether tiling is several times as fast as sampling from scratch, and why the
//! paper's own ratio cannot be compared.

use crate::experiments::common::ends;
use crate::numbers::number;
use crate::outcome::{Claim, Verdict};
use crate::rates::{EngineRate, distinct};

/// The paper's lower rate over that of sampling from scratch.
const FASTER: f64 = 2.5;

const PLACE: &str = "section 4.1.3, figure 13";

/// Returns the claims: of the direction, and of the ratio.
pub fn claims(rows: &[EngineRate]) -> [Claim; 2] {
    let alone: Vec<&EngineRate> = rows
        .iter()
        .filter(|row| row.leaf.is_some() && row.engine.threads() == Some(1))
        .collect();
    [direction(rows, &alone), ratio(rows, &alone)]
}

fn direction(rows: &[EngineRate], alone: &[&EngineRate]) -> Claim {
    let holds = |row: &&EngineRate| row.ratio.quartiles[1] >= FASTER;
    let densities = alone.iter().map(|row| row.density);
    let [low, high] = ends(densities).map(|density| number(density, 4));
    let of_reference = rows.first().map_or(f64::NAN, |row| row.density);
    Claim::new(
        [
            "Randomized tiling is several times as fast as sampling from scratch",
            PLACE,
            "at least 2.5 times the rate of Ebeida et al.'s sampler",
        ],
        format!(
            "times the rate of the reference sampler, all on one thread: {}; densities N r^2 / area {low} to {high}, the reference sampler's {}",
            by_name(alone),
            number(of_reference, 4)
        ),
        Verdict::if_known(!alone.is_empty(), alone.iter().all(holds)),
        format!(
            "Reproduced if the median ratio of rounds is at least {FASTER} at every leaf size with every engine that runs on one thread, as the \
             reference sampler does; more counts as well."
        ),
    )
}

fn ratio(rows: &[EngineRate], alone: &[&EngineRate]) -> Claim {
    let [low, high] = ends(alone.iter().map(|row| row.ratio.quartiles[1]));
    let rate = rows.first().map_or(f64::NAN, |row| row.rate.quartiles[1]);
    Claim::new(
        [
            "Randomized tiling is 2.5 to 4 times as fast as Ebeida et al.'s sampler",
            PLACE,
            "2.5 to 4 times, both on a GPU",
        ],
        format!(
            "{} to {} times the reference sampler, both on one thread of a processor",
            number(low, 3),
            number(high, 3)
        ),
        Verdict::NotComparable,
        format!(
            "Another baseline: the paper's ratio is of two programs on a GPU, and there is no reference sampler for a GPU here. A ratio says as \
             much about the baseline as about the method; the reference sampler makes {} million samples a second here.",
            number(rate / 1e6, 3)
        ),
    )
}

/// Returns each engine's ratios by leaf.
fn by_name(rows: &[&EngineRate]) -> String {
    let names = distinct(rows.iter().map(|row| row.engine.name()));
    let of = |name: &String| {
        let rows = rows.iter().filter(|row| row.engine.name() == *name);
        let ratios = rows.map(|row| {
            let leaf = row.leaf.unwrap_or_default();
            format!("{} at leaf {leaf} r", number(row.ratio.quartiles[1], 3))
        });
        format!("{name} {}", ratios.collect::<Vec<_>>().join(", "))
    };
    names.iter().map(of).collect::<Vec<_>>().join("; ")
}

#[cfg(test)]
pub mod tests;
