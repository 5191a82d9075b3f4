//! Verdicts on maximal sets of balls. Each rule is asked about sets that are not maximal, too: if it does not refute
//! those, it decides nothing.

use serde_json::json;
use tilescope_analysis::COVERING_TOLERANCE;

use super::balls::{BINS_IN_R, MeasuredBalls, PLANES};
use super::results::{
    LOW, PUBLISHED, PUBLISHED_ERROR, SetMean, SpaceResults, bins, floor, middle, pairs, scatter,
};
use crate::experiments::common::ends;
use crate::outcome::{Claim, Verdict};
use crate::rule::Rule;
use crate::texts::claim;

/// The density may differ by this much from the published one. Its interval may reach twice as far: with 24 sets of
/// 47,000 samples it reaches 0.0005.
const DENSITY: f64 = 0.0005;
/// Disks to r² in a plane may differ by this much from those that the density gives.
const DISKS: f64 = 0.01;
/// g(r) of a bin may differ by this share from the expected value.
const PAIRS: f64 = 0.02;
/// g(r) of the bins from r on, as an earlier program for the same law had it.
pub const EXPECTED_PAIRS: [f64; 8] = [3.86, 2.19, 1.69, 1.41, 1.24, 1.12, 1.03, 0.97];
/// Its least value, near 1.6 r, and the largest value behind that, near 2.05 r, by the same program.
pub const EXPECTED_LEAST: f64 = 0.856;
pub const EXPECTED_PEAK: f64 = 1.074;
/// The limits of the mean power of low frequencies: 0.056 is expected.
const FLOOR: [f64; 2] = [0.050, 0.062];

/// Returns all claims.
pub fn claims(found: &SpaceResults) -> Vec<Claim> {
    vec![
        density(found),
        disks(found),
        distances(found),
        pairs_by_distance(found),
        low_powers(found),
    ]
}

/// Returns a verdict if the same rule has refuted its controls, which are known to be wrong. Otherwise it decides
/// nothing.
fn if_refuted(verdict: Verdict, controls: impl IntoIterator<Item = Verdict>) -> Verdict {
    let mut controls = controls.into_iter();
    if controls.all(|control| control == Verdict::NotReproduced) {
        verdict
    } else {
        Verdict::NotComparable
    }
}

fn mean_density(sets: &[MeasuredBalls]) -> SetMean {
    SetMean::of(sets, MeasuredBalls::density)
}

/// Judges whether sets have the published density.
fn density_of(sets: &[MeasuredBalls]) -> Verdict {
    let density = mean_density(sets);
    let Some([low, high]) = density.interval() else {
        return Verdict::NotComparable;
    };
    // An interval without the published density refutes, however near it is. A wide one confirms nothing.
    let is_near = (density.mean - PUBLISHED).abs() <= DENSITY && density.reach() <= 2.0 * DENSITY;
    match ((low..=high).contains(&PUBLISHED), is_near) {
        (false, _) => Verdict::NotReproduced,
        (true, true) => Verdict::Reproduced,
        (true, false) => Verdict::NotComparable,
    }
}

fn density(found: &SpaceResults) -> Claim {
    // Stopped sets lack a fiftieth of the samples, which is thirty times the limit.
    let (here, stopped) = (mean_density(&found.large), mean_density(&found.stopped));
    let verdict = if_refuted(density_of(&found.large), [density_of(&found.stopped)]);
    let samples: usize = found.large.iter().map(|set| set.samples).sum();
    let values = json!({
        "published": PUBLISHED, "published_error": PUBLISHED_ERROR, "limit": DENSITY, "widest": 2.0 * DENSITY,
        "density": here.mean, "error": here.error, "reach": here.reach(),
        "difference": here.mean - PUBLISHED, "errors": (here.mean - PUBLISHED) / here.error,
        "samples": samples, "sets": found.large.len(), "side": found.side,
        "stopped": stopped.mean, "stopped_reach": stopped.reach(),
    });
    claim("space/density", verdict, &values)
}

/// Judges whether a plane meets as many balls as the published density gives.
fn disks_of(sets: &[MeasuredBalls]) -> Verdict {
    // A plane meets the balls whose samples lie within r on either side of it: those of a layer of two r.
    Rule::near(2.0 * PUBLISHED, DISKS).verdict(SetMean::of(sets, |set| set.disks).interval())
}

fn disks(found: &SpaceResults) -> Claim {
    let mean = |sets: &[MeasuredBalls]| SetMean::of(sets, |set| set.disks);
    let (here, stopped) = (mean(&found.large), mean(&found.stopped));
    let verdict = if_refuted(disks_of(&found.large), [disks_of(&found.stopped)]);
    let values = json!({
        "expected": 2.0 * PUBLISHED, "limit": DISKS, "disks": here.mean, "error": here.error,
        "planes": 3 * PLANES, "sets": found.large.len(), "stopped": stopped.mean,
    });
    claim("space/disks", verdict, &values)
}

/// Returns the smallest distance of samples and the farthest place, of all sets.
fn extremes(sets: &[MeasuredBalls]) -> [f64; 2] {
    let [least, _] = ends(sets.iter().map(|set| set.least_distance));
    let [_, farthest] = ends(sets.iter().map(|set| set.farthest_place));
    [least, farthest]
}

/// Judges whether no two samples are within r.
fn is_apart(least: f64) -> Verdict {
    Verdict::of(least >= 1.0)
}

/// Judges whether no place is farther than the limit from all samples.
fn is_covered(farthest: f64) -> Verdict {
    Verdict::of(farthest <= 1.0 + COVERING_TOLERANCE)
}

fn distances(found: &SpaceResults) -> Claim {
    let all = [found.large.clone(), found.small.clone()].concat();
    let [least, farthest] = extremes(&all);
    // Stopped sets have gaps and no conflict. Scattered ones have both, and are asked about conflicts.
    let [_, stopped] = extremes(&found.stopped);
    let [scattered, _] = extremes(&found.scattered);
    let verdict = if_refuted(
        Verdict::of_all([is_apart(least), is_covered(farthest)]),
        [is_covered(stopped), is_apart(scattered)],
    );

    // Every set is to have a verdict of cubes and one of circles.
    let judges = all.iter().map(|set| set.judges).min();
    let values = json!({
        "limit": 1.0 + COVERING_TOLERANCE, "least": least, "farthest": farthest, "sets": all.len(),
        "judges": judges, "stopped": stopped, "scattered": scattered,
    });
    claim("space/distances", verdict, &values)
}

/// Returns the means of g in the bins from r on for which there are expected values.
fn near_contact(sets: &[MeasuredBalls]) -> Vec<SetMean> {
    let first = BINS_IN_R;
    (first..first + EXPECTED_PAIRS.len())
        .map(|bin| pairs(sets, bin))
        .collect()
}

/// Returns the bin of the least value of g between contact and the second peak, and its mean.
fn least(sets: &[MeasuredBalls]) -> (usize, SetMean) {
    // The curve falls from 1 r on, and rises to its peak from 1.9 r on at the latest.
    let all = bins(1.4..1.9).map(|bin| (bin, pairs(sets, bin)));
    all.min_by(|(_, a), (_, b)| a.mean.total_cmp(&b.mean))
        .expect("ten bins")
}

/// Returns the bin of the second peak of g, and its mean.
fn peak(sets: &[MeasuredBalls]) -> (usize, SetMean) {
    let all = bins(1.9..2.4).map(|bin| (bin, pairs(sets, bin)));
    all.max_by(|(_, a), (_, b)| a.mean.total_cmp(&b.mean))
        .expect("ten bins")
}

/// Judges whether pairs are as far apart as expected.
fn pairs_of(sets: &[MeasuredBalls]) -> Verdict {
    let extremes = [
        (least(sets).1, EXPECTED_LEAST),
        (peak(sets).1, EXPECTED_PEAK),
    ];
    let all = near_contact(sets).into_iter().zip(EXPECTED_PAIRS);
    Verdict::of_all(
        all.chain(extremes).map(|(found, expected)| {
            Rule::near(expected, PAIRS * expected).verdict(found.interval())
        }),
    )
}

fn pairs_by_distance(found: &SpaceResults) -> Claim {
    // What arrives last fills gaps between others and adds near pairs: without it the first bin has several percent
    // less.
    let verdict = if_refuted(
        pairs_of(&found.large),
        [pairs_of(&found.stopped), pairs_of(&found.scattered)],
    );

    let g: Vec<f64> = near_contact(&found.large)
        .iter()
        .map(|one| one.mean)
        .collect();
    let differences = g
        .iter()
        .zip(EXPECTED_PAIRS)
        .map(|(here, expected)| here / expected - 1.0);
    let [low, high] = ends(differences);

    let (valley_bin, valley) = least(&found.large);
    let (top_bin, top) = peak(&found.large);
    let values = json!({
        "limit": PAIRS, "g": g, "low": low, "high": high, "expected": EXPECTED_PAIRS,
        "least": valley.mean, "least_at": middle(valley_bin), "peak": top.mean, "peak_at": middle(top_bin),
        "expected_least": EXPECTED_LEAST, "expected_peak": EXPECTED_PEAK,
        "sets": found.large.len(), "side": found.side,
        "stopped": pairs(&found.stopped, BINS_IN_R).mean,
        "scattered": pairs(&found.scattered, BINS_IN_R).mean,
    });
    claim("space/pairs", verdict, &values)
}

/// Judges whether low frequencies have as little power as expected.
fn low_powers_of(sets: &[MeasuredBalls]) -> Verdict {
    Rule::Within(FLOOR).verdict(floor(sets).interval())
}

fn low_powers(found: &SpaceResults) -> Claim {
    let here = floor(&found.small);
    let verdict = if_refuted(
        low_powers_of(&found.small),
        [low_powers_of(&found.scattered)],
    );
    let values = json!({
        "floor": FLOOR, "low": LOW, "power": here.mean, "error": here.error,
        "sets": found.small.len(), "side": found.small_side, "scatter": scatter(&found.large),
        "large": found.large.len(), "scattered": floor(&found.scattered).mean,
    });
    claim("space/floor", verdict, &values)
}
