//! Verdicts on figure 13: rates, radial mean powers, and regularity, with patterns that hold the largest block and
//! with smaller ones. Sets of a single block do not count as tilings. Regularity shows only among many blocks, so that
//! sets of few blocks can refute a claim on it but not confirm it; for mean powers they count like all others.

use serde_json::json;

use super::against::Against;
use super::method::Method;
use crate::experiments::common::{ends, largest};
use crate::numbers::number;
use crate::outcome::{Claim, Verdict};
use crate::rates::{EngineRate, distinct};
use crate::texts::{claim, text};

/// Radial mean powers that differ by this share of the power, chance apart, count as very similar.
const SIMILAR: f64 = 0.05;
/// Regularity is serious where it makes this many times what chance alone does: as much again.
const SERIOUS: f64 = 2.0;

/// The paper's lower rate over that of sampling from scratch.
const FASTER: f64 = 2.5;

/// A number that regularity raises.
struct Measure {
    of: fn(&Against) -> f64,
    limit: f64,
    unit: &'static str,
    /// Writes a value with two decimals, without the unit.
    digits: fn(f64) -> String,
}

fn anisotropy() -> Measure {
    Measure {
        of: |one| one.excess,
        limit: 10.0 * SERIOUS.log10(),
        unit: " dB",
        digits: signed,
    }
}

const PEAK: Measure = Measure {
    of: |one| one.peak,
    limit: SERIOUS,
    unit: " times",
    // A peak is a multiple and never negative, so that it has no sign.
    digits: |peak| format!("{peak:.2}"),
};

/// Returns the claims about rates and spectra.
pub fn claims(each: &[Against], rows: &[EngineRate]) -> Vec<Claim> {
    let kdrt = |fits: bool| -> Vec<Against> {
        let is_kdrt = |one: &&Against| matches!(one.method, Method::Kdrt { .. });
        let of_kdrt = each.iter().filter(is_kdrt).copied();
        of_kdrt.filter(|one| one.method.fits() == fits).collect()
    };

    // `holding` are sets whose patterns hold the largest block. In `close`, leaves are nearly as large as the pattern:
    // a block that does not fit into it repeats a part of it.
    let [holding, close] = [true, false].map(kdrt);
    let control = each.iter().find(|one| one.method == Method::Copies);

    let mut claims = Vec::from(self::rates(rows));
    claims.push(similar(&holding));

    // The largest of all radii is taken, since at one radius two groups may be close to each other by chance.
    let apart = largest(each.iter().map(|one| one.apart));
    claims.extend(level([&holding, &close], apart, control));
    claims.extend(spikes(&holding, &close, control));
    claims
}

/// Whether tiling is several times as fast as sampling from scratch, and why the paper's own ratio cannot be compared.
fn rates(rows: &[EngineRate]) -> [Claim; 2] {
    // Rates on one thread are compared, since the reference sampler runs on one.
    // Only tiling has leaves: the row of the reference sampler has none, and is not compared with itself.
    let is_alone = |row: &&EngineRate| row.leaf.is_some() && row.engine.threads() == Some(1);
    let alone: Vec<&EngineRate> = rows.iter().filter(is_alone).collect();
    let holds = alone.iter().all(|row| row.ratio.quartiles[1] >= FASTER);
    let direction = Verdict::if_known(!alone.is_empty(), holds);

    // The first row is that of the reference sampler.
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
        // The paper's ratio is of two programs on a GPU, and there is no reference sampler for a GPU here.
        claim("fig13/ratio", Verdict::NotComparable, &ratio),
    ]
}

/// Returns each engine's ratios by leaf.
fn by_name(rows: &[&EngineRate]) -> String {
    let names = distinct(rows.iter().map(|row| row.engine.name()));
    let ratios_of = |name: &String| {
        let rows = rows.iter().filter(|row| row.engine.name() == *name);
        let ratios = rows.map(|row| {
            // All of these rows have a leaf: `rates` chose them by it.
            let leaf = row.leaf.unwrap_or_default();
            format!("{} at leaf {leaf} r", number(row.ratio.quartiles[1], 3))
        });
        format!("{name} {}", ratios.collect::<Vec<_>>().join(", "))
    };
    names.iter().map(ratios_of).collect::<Vec<_>>().join("; ")
}

/// Judges whether mean powers of KDRT are those of the reference sampler.
fn similar(each: &[Against]) -> Claim {
    // Where chance differences are large, the remainder after subtracting them is uncertain. Twice the limit: chosen,
    // not measured.
    let judged = |one: &&Against| one.tiled() && one.chance <= 2.0 * SIMILAR;
    let quiet: Vec<Against> = each.iter().filter(judged).copied().collect();

    // The words name the leaf and radius with the largest ratio of difference to chance. The verdict is about the
    // largest remainder, which may be that of another leaf or radius.
    let (verdict, words) = match worst(&quiet, Against::ratio) {
        None => (Verdict::NotComparable, text("fig13/loud", &json!({}))),
        Some((ratio, named)) => {
            let left = largest(quiet.iter().map(|one| one.left));
            let values = json!({
                "difference": percent(&quiet, |one| one.difference),
                "chance": percent(&quiet, |one| one.chance), "ratio": ratio, "radius": named.radius,
                "leaf": named.method.leaf(), "left": left,
            });
            (Verdict::of(left <= SIMILAR), text("fig13/similar", &values))
        }
    };

    let values = json!({ "words": words, "similar": SIMILAR, "loud": 2.0 * SIMILAR });
    claim("fig13/similar", verdict, &values)
}

/// Anisotropy, with patterns that hold the largest block and with one that leaves come close to.
fn level([holding, close]: [&[Against]; 2], apart: f64, control: Option<&Against>) -> [Claim; 2] {
    let measure = anisotropy();
    [("fig13/level", holding), ("fig13/level-close", close)].map(|(id, each)| {
        let values = json!({
            "values": by_leaf(each, &measure), "chance": chance(each),
            "detectable": detectable(each, apart), "control": beside(control, &measure),
            "limit": measure.limit, "floor": floor(each),
        });
        claim(id, verdict(each, &measure), &values)
    })
}

/// Single frequencies, with the same two kinds of patterns.
fn spikes(holding: &[Against], close: &[Against], control: Option<&Against>) -> [Claim; 2] {
    [("fig13/spikes", holding), ("fig13/spikes-close", close)].map(|(id, each)| {
        let values = json!({
            "values": by_leaf(each, &PEAK), "control": beside(control, &PEAK),
            "limit": PEAK.limit, "floor": floor(each),
        });
        claim(id, verdict(each, &PEAK), &values)
    })
}

/// Any tiling may refute a claim; it holds only if there was one of enough blocks of every leaf size.
fn verdict(each: &[Against], measure: &Measure) -> Verdict {
    let mut tiled = each.iter().filter(|one| one.tiled());
    if tiled.any(|one| (measure.of)(one) > measure.limit) {
        return Verdict::NotReproduced;
    }
    if each.is_empty() || !coarse(each).is_empty() {
        return Verdict::NotComparable;
    }
    Verdict::Reproduced
}

/// Returns the leaf sizes of which no radius has enough blocks.
fn coarse(each: &[Against]) -> Vec<f64> {
    let often = |leaf: f64| {
        each.iter()
            .any(|one| one.tiled_often() && one.method.leaf() == Some(leaf))
    };
    leaves(each)
        .into_iter()
        .filter(|leaf| !often(*leaf))
        .collect()
}

/// Says what sets of few blocks count for, and which leaf sizes have no others.
fn floor(each: &[Against]) -> String {
    let leaves: Vec<String> = coarse(each)
        .iter()
        .map(|leaf| format!("{leaf} r"))
        .collect();
    let values = json!({ "leaves": leaves.join(", ") });
    let coarse = if leaves.is_empty() {
        String::new()
    } else {
        text("fig13/coarse", &values)
    };
    format!("{}{coarse}.", text("fig13/floor", &values))
}

/// Says how far from zero these numbers are by chance alone.
fn chance(each: &[Against]) -> String {
    worst(&tiled(each), |one| one.reach).map_or_else(String::new, |(reach, _)| {
        text("fig13/chance", &json!({ "reach": reach }))
    })
}

/// Returns a sentence on whether the anisotropy exceeds `apart`, the largest difference of two groups of reference sets
/// at any radius; empty if nothing was tiled.
fn detectable(each: &[Against], apart: f64) -> String {
    let Some((most, _)) = worst(&tiled(each), |one| one.excess) else {
        return String::new();
    };

    let id = if most <= apart {
        "fig13/not-detectable"
    } else {
        "fig13/detectable"
    };
    // The excess is a ratio in decibels: the anisotropy of a tiling over the anisotropy of reference sets. The first is
    // larger than the second by `more` times the second.
    let more = 10_f64.powf(0.1 * most) - 1.0;
    text(
        id,
        &json!({ "apart": apart, "most": signed(most), "more": more }),
    )
}

fn tiled(each: &[Against]) -> Vec<Against> {
    each.iter().filter(|one| one.tiled()).copied().collect()
}

/// The control, which shows that the measure finds regularity.
fn beside(control: Option<&Against>, measure: &Measure) -> String {
    control.map_or_else(String::new, |control| {
        let values = json!({ "value": (measure.of)(control), "unit": measure.unit });
        text("fig13/control", &values)
    })
}

fn worst(each: &[Against], of: fn(&Against) -> f64) -> Option<(f64, Against)> {
    let values = each.iter().map(|one| (of(one), *one));
    values.max_by(|a, b| a.0.total_cmp(&b.0))
}

fn percent(each: &[Against], of: fn(&Against) -> f64) -> String {
    let [low, high] = ends(each.iter().map(|one| 100.0 * of(one))).map(|value| number(value, 2));
    if low == high {
        return format!("{low} %");
    }
    format!("{low} to {high} %")
}

fn leaves(each: &[Against]) -> Vec<f64> {
    distinct(each.iter().filter_map(|one| one.method.leaf()))
}

/// Returns the values by leaf and by radius. Sets of one block, in which nothing was tiled, have words in place of a
/// value.
fn by_leaf(each: &[Against], measure: &Measure) -> String {
    let value = |one: &Against| {
        if one.tiled() {
            (measure.digits)((measure.of)(one))
        } else {
            "one block".to_owned()
        }
    };

    let texts: Vec<String> = (leaves(each).into_iter())
        .map(|leaf| {
            let of_leaf = || each.iter().filter(|one| one.method.leaf() == Some(leaf));
            // Without a tiling at any radius, the words stand once and not for each radius.
            if !of_leaf().any(Against::tiled) {
                return format!("leaf {leaf} r one block: nothing was tiled");
            }
            let values: Vec<String> = of_leaf().map(value).collect();
            format!("leaf {leaf} r {}", values.join(" / "))
        })
        .collect();

    let radii = distinct(each.iter().map(|one| one.radius.to_string()));
    format!("{} (radii {})", texts.join(", "), radii.join(" / "))
}

/// Returns a number with two decimals and its sign; zero has no sign.
fn signed(value: f64) -> String {
    match (100.0 * value).round() as i64 {
        0 => "0.00".to_owned(),
        _ => format!("{value:+.2}").replace('-', "\u{2212}"),
    }
}

#[cfg(test)]
mod tests;
