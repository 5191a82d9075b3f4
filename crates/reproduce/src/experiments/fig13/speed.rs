//! Verdicts on figure 13's rates: whether tiling is several times as fast as sampling from scratch, and why the
//! paper's own ratio cannot be compared.

use serde_json::json;

use crate::experiments::common::ends;
use crate::numbers::number;
use crate::outcome::{Claim, Verdict};
use crate::rates::{EngineRate, distinct};
use crate::texts::claim;

/// The paper's lower rate over that of sampling from scratch.
const FASTER: f64 = 2.5;

/// Returns the claims: of the direction, and of the ratio.
pub fn claims(rows: &[EngineRate]) -> [Claim; 2] {
    let alone = |row: &&EngineRate| row.leaf.is_some() && row.engine.threads() == Some(1);
    let alone: Vec<&EngineRate> = rows.iter().filter(alone).collect();
    let holds = alone.iter().all(|row| row.ratio.quartiles[1] >= FASTER);
    let direction = Verdict::if_known(!alone.is_empty(), holds);
    let values = json!({
        "ratios": by_name(&alone), "densities": ends(alone.iter().map(|row| row.density)),
        "reference": rows.first().map(|row| row.density), "faster": FASTER,
    });
    let ratio = json!({
        "ratios": ends(alone.iter().map(|row| row.ratio.quartiles[1])),
        "millions": rows.first().map(|row| row.rate.quartiles[1] / 1e6),
    });
    [
        claim("fig13/direction", direction, &values),
        // The baselines differ.
        claim("fig13/ratio", Verdict::NotComparable, &ratio),
    ]
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
