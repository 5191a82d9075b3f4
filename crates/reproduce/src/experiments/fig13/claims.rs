//! Verdicts on figure 13's spectra: radial mean powers, and regularity, with patterns that hold the largest block and
//! with smaller ones. Sets of a single block do not count as tilings, and sets of few blocks can refute a claim but
//! not confirm it.

use super::against::Against;
use super::method::Method;
use super::speed;
use crate::experiments::common::ends;
use crate::numbers::number;
use crate::outcome::{Claim, Verdict};
use crate::rates::{EngineRate, distinct};

/// Radial mean powers that differ by this share of the power, chance apart, count as very similar.
const SIMILAR: f64 = 0.05;
/// Regularity is serious where it makes this many times what chance alone does: as much again.
const SERIOUS: f64 = 2.0;

/// A number that regularity raises.
struct Measure {
    of: fn(&Against) -> f64,
    limit: f64,
    unit: &'static str,
}

fn anisotropy() -> Measure {
    Measure {
        of: |one| one.excess,
        limit: 10.0 * SERIOUS.log10(),
        unit: " dB",
    }
}

const PEAK: Measure = Measure {
    of: |one| one.peak,
    limit: SERIOUS,
    unit: " times",
};

/// Returns the claims.
pub fn claims(each: &[Against], rows: &[EngineRate]) -> Vec<Claim> {
    let kdrt = |holds: bool| -> Vec<Against> {
        let kind = |one: &&Against| matches!(one.method, Method::Kdrt { .. });
        let kind = each.iter().filter(kind);
        kind.filter(|one| one.method.fits() == holds)
            .copied()
            .collect()
    };
    let [holding, close] = [true, false].map(kdrt);
    let control = each.iter().find(|one| one.method == Method::Copies);
    let mut claims = Vec::from(speed::claims(rows));
    claims.push(similar(&holding));
    // Of all radii: two groups may come close to each other by chance.
    let apart = each.iter().map(|one| one.apart).fold(0.0, f64::max);
    claims.extend(level([&holding, &close], apart, control));
    claims.extend(spikes(&holding, &close, control));
    claims
}

fn similar(each: &[Against]) -> Claim {
    // Where chance differences are large, the remainder after subtracting them is uncertain.
    let judged = |one: &&Against| one.tiled() && one.chance <= 2.0 * SIMILAR;
    let each: Vec<Against> = each.iter().filter(judged).copied().collect();
    let (verdict, ours) = match largest(&each, Against::ratio) {
        None => {
            let loud = "two groups of reference sets differ too much from each other to tell";
            (Verdict::NotComparable, loud.to_owned())
        }
        Some((ratio, worst)) => {
            let left = each.iter().map(|one| one.left).fold(0.0, f64::max);
            let ours = format!(
                "KDRT differs from two groups of reference sets by {} of the power, they from each other by {}; at worst by {} times as much as \
                 they do (radius {}, leaf {} r); chance apart, {} % at most",
                percent(&each, |one| one.difference),
                percent(&each, |one| one.chance),
                number(ratio, 3),
                worst.radius,
                worst.method.leaf().unwrap_or_default(),
                number(100.0 * left, 2)
            );
            (Verdict::of(left <= SIMILAR), ours)
        }
    };
    Claim::new(
        [
            "Spectra are very similar to those of reference sets",
            "section 4.1.1, figure 13",
            "very similar",
        ],
        ours,
        verdict,
        format!(
            "Radial mean powers between 0.1 and 2 nu against two groups of reference sets, root mean square of relative differences; the \
             difference of the two groups is what chance makes, and is subtracted as squares are. Reproduced if what is left is at most {} % at \
             every radius and leaf size where there is more than one block. Radii at which chance makes more than {} % are not judged.",
            100.0 * SIMILAR,
            200.0 * SIMILAR
        ),
    )
}

/// Anisotropy, with patterns that hold the largest block and with one that leaves come close to.
fn level([holding, close]: [&[Against]; 2], apart: f64, control: Option<&Against>) -> [Claim; 2] {
    let measure = anisotropy();
    let reason = format!(
        "The anisotropy is the variance of the power within a ring, over the mean squared; blocks repeat parts of one pattern, and repetition \
         shows here first. It counts as serious where tiling makes as much of the variance as chance does: reproduced if it is at most {} dB above \
         that of reference sets at every radius and leaf size. That limit is about what is serious, not about what is there: anything beyond what \
         two groups of reference sets differ by is detectable, and is named.",
        number(measure.limit, 2)
    );
    let claim = |each: &[Against], claim: &str, paper: &str| {
        let ours = format!(
            "anisotropy above reference sets', in dB: {}{}{}{}",
            by_leaf(each, &measure),
            chance(each),
            detectable(each, apart),
            beside(control, &measure)
        );
        let reason = format!("{reason} {}", floor(each));
        Claim::new(
            [claim, "section 4.1.2", paper],
            ours,
            verdict(each, &measure),
            reason,
        )
    };
    [
        claim(
            holding,
            "Larger leaves cost no serious quality while the pattern holds the largest block",
            "no serious drop of quality with the size of the leaf",
        ),
        claim(
            close,
            "A leaf close to the pattern's own size (80 r of 100 r) costs no serious quality",
            "no serious drop, even at leaves of nearly the pattern's size",
        ),
    ]
}

/// Single frequencies, with the same two kinds of patterns.
fn spikes(holding: &[Against], close: &[Against], control: Option<&Against>) -> [Claim; 2] {
    let claim = |each: &[Against], which: &str| {
        let claim =
            format!("Even tiles of 80 r leave hardly any regular pattern in the spectrum{which}");
        let paper = "barely any regularity to be seen";
        let ours = format!(
            "highest power of a frequency, times what chance passes in one of a hundred such periodograms: {}{}",
            by_leaf(each, &PEAK),
            beside(control, &PEAK)
        );
        let reason = format!(
            "A regular repetition is a spike: a frequency whose power is far above the radial mean. Powers of irregular sets are \
             exponentially distributed, so what chance allows is known; above it a spike is detectable. It is seen beside chance's own highest ones where it is as \
             much again: reproduced if no frequency has more than {SERIOUS} times what chance allows. {}",
            floor(each)
        );
        let names = [&*claim, "section 4.1.3, figure 13", paper];
        Claim::new(names, ours, verdict(each, &PEAK), reason)
    };
    [
        claim(holding, " while the pattern holds the largest block"),
        claim(close, " of a pattern of 100 r"),
    ]
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

/// Tells what sets of few blocks count for, and which leaf sizes have no others.
fn floor(each: &[Against]) -> String {
    let rule = "The more blocks share a pattern, the more regular they are: sets of fewer than nine blocks can refute it but not confirm it";
    let coarse: Vec<String> = (coarse(each).iter())
        .map(|leaf| format!("{leaf} r"))
        .collect();
    if coarse.is_empty() {
        return format!("{rule}.");
    }
    format!(
        "{rule}, and leaves of {} have no others here.",
        coarse.join(", ")
    )
}

/// Tells how far from zero these numbers are by chance alone.
fn chance(each: &[Against]) -> String {
    let tiled: Vec<Against> = each.iter().filter(|one| one.tiled()).copied().collect();
    largest(&tiled, |one| one.reach).map_or_else(String::new, |(reach, _)| {
        format!("; chance alone stays within {} dB (99 %)", number(reach, 2))
    })
}

/// Tells whether the anisotropy is beyond what groups of reference sets lie apart by at any radius.
fn detectable(each: &[Against], apart: f64) -> String {
    let tiled: Vec<Against> = each.iter().filter(|one| one.tiled()).copied().collect();
    match largest(&tiled, |one| one.excess) {
        None => String::new(),
        Some((most, _)) if most <= apart => format!(
            "; not detectable where two groups of reference sets differ by at most {} dB",
            number(apart, 2)
        ),
        Some((most, _)) => format!(
            "; detectable: at most {} dB ({} % more variance) where two groups of reference sets differ by at most {} dB",
            signed(most),
            number(100.0 * (10_f64.powf(0.1 * most) - 1.0), 2),
            number(apart, 2)
        ),
    }
}

/// The control, which shows that the measure finds regularity.
fn beside(control: Option<&Against>, measure: &Measure) -> String {
    control.map_or_else(String::new, |control| {
        let value = number((measure.of)(control), 3);
        format!("; copies side by side {value}{}", measure.unit)
    })
}

fn largest(each: &[Against], of: fn(&Against) -> f64) -> Option<(f64, Against)> {
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
    let mut leaves: Vec<f64> = each.iter().filter_map(|one| one.method.leaf()).collect();
    leaves.sort_by(f64::total_cmp);
    leaves.dedup();
    leaves
}

/// Returns values by leaf and by radius; of sets of one block, that they are.
fn by_leaf(each: &[Against], measure: &Measure) -> String {
    let value = |one: &Against| {
        if !one.tiled() {
            "one block".to_owned()
        } else if measure.unit == PEAK.unit {
            format!("{:.2}", (measure.of)(one))
        } else {
            signed((measure.of)(one))
        }
    };
    let texts = leaves(each).into_iter().map(|leaf| {
        let of_leaf = || each.iter().filter(|one| one.method.leaf() == Some(leaf));
        if !of_leaf().any(Against::tiled) {
            return format!("leaf {leaf} r one block: nothing was tiled");
        }
        let values: Vec<String> = of_leaf().map(value).collect();
        format!("leaf {leaf} r {}", values.join(" / "))
    });
    let texts: Vec<String> = texts.collect();
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
