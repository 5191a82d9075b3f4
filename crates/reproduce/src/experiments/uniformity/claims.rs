//! Verdicts on uniformity. An interval that contains zero denies a bias only if it is not wide, and places are judged
//! only if the controls show what they must.

use serde_json::{Value, json};

use super::CELL;
use super::averages::{AgainstReference, AveragedWay};
use super::counted::MOVED;
use super::offsets::{DensityOffset, JUDGED, RankTest, SamplerUniformity, UniformityResults};
use crate::outcome::{Claim, Verdict};
use crate::rule::Rule;
use crate::texts::{claim, text};

/// Deeper than this many radii lies no conflict; the second of the bands' borders.
const INTERIOR: f64 = 3.0;
/// Deviations up to this from the reference sampler's density are treated as zero, whatever the number of sets.
const NEGLIGIBLE: f64 = 0.005;
/// An interval that reaches further than this to either side contains too much to say that two densities are alike.
const TELLING: f64 = 0.02;
/// Fewer inserted samples cannot show that no rank is preferred.
const RANKED: u64 = 1000;
/// Below this probability counts are not uniform.
const UNLIKELY: f64 = 1e-3;
/// Places whose true densities vary by no more than this have a very small bias.
const EVEN: f64 = 0.01;
/// Three standard errors of the density within 1 r of the borders of blocks, relative to the reference sampler's
/// density. They are those of sets with [`SAMPLES_OF_ERRORS`] samples in all, whose leaves have sides of 20 r.
const THREE_ERRORS: f64 = 0.0035;
/// The samples of the sets for which [`THREE_ERRORS`] holds: 400 sets of 10,000 samples.
const SAMPLES_OF_ERRORS: f64 = 4e6;
/// Curves that have one truth leave bands of 95 % in 5 % of their points; of some 150 points this share is beyond chance.
const OUTSIDE: f64 = 0.08;

/// Returns a deviation with its interval.
fn offset(off: &DensityOffset) -> String {
    text("uniformity/offset", &json!(off))
}

fn within(off: &DensityOffset, limit: f64) -> Verdict {
    Rule::near(0.0, limit).verdict(Some(off.interval))
}

/// Whether there is a deviation: intervals that contain zero deny it only if they are not wide.
fn there(each: &[DensityOffset]) -> Verdict {
    // There is none if each place shows none: the claim of several parts is the opposite one.
    let nowhere = |off: &DensityOffset| {
        Rule::NotZero(TELLING)
            .verdict(Some(off.interval))
            .opposite()
    };
    Verdict::of_all(each.iter().map(nowhere)).opposite()
}

/// Returns a verdict if its controls show what they must.
fn if_clean(clean: bool, verdict: Verdict) -> Verdict {
    if clean {
        verdict
    } else {
        Verdict::NotComparable
    }
}

/// Returns the claims about uniformity.
pub fn claims(found: &UniformityResults) -> Vec<Claim> {
    let [reference, moved, circumcentre, uniform, random, exact] = &found.all;
    vec![
        everywhere(
            "insertion at circumcentres",
            [reference, moved, circumcentre],
        ),
        everywhere("uniform insertion", [reference, moved, uniform]),
        interior(reference, circumcentre),
        border("insertion at circumcentres", circumcentre),
        border("uniform insertion", uniform),
        deterministic(found),
        removes(found),
        farthest(circumcentre),
        unbiased(uniform),
        frame_of("KDRT", reference, circumcentre),
        sides("by index, own block first", reference, circumcentre),
        sides("random order", reference, random),
        seams(reference, circumcentre, exact),
        frame_of("exact tiling", reference, exact),
    ]
}

/// Returns the verdict on whether exact tiling is free of the bias at the borders of blocks, which section 5.1 names as
/// the price of tiling: its density within 1 r of them must be that of the reference. There is a verdict only if KDRT
/// fails the same limit, since otherwise too few samples were counted to see its bias, and if the reference sets, which
/// have no bias, keep it.
fn seams(
    reference: &SamplerUniformity,
    kdrt: &SamplerUniformity,
    exact: &SamplerUniformity,
) -> Claim {
    let near = |of: &SamplerUniformity| of.bands()[0];
    // Errors of means shrink with the root of the number of samples.
    let limit = THREE_ERRORS * (SAMPLES_OF_ERRORS / exact.blocks.samples as f64).sqrt();
    let is_seen = near(kdrt).relative.abs() > limit && near(reference).relative.abs() <= limit;

    let verdict = Verdict::if_known(is_seen, near(exact).relative.abs() <= limit);
    let (worst_place, worst_offset) = worst(exact);
    let values = json!({
        "near": offset(&near(exact)), "kdrt": near(kdrt).relative, "limit": limit,
        "reference": near(reference).relative, "sets": exact.sets,
        "name": worst_place, "worst": worst_offset,
    });
    claim("uniformity/seams", verdict, &values)
}

/// Judges whether mean curves of exact tilings are those of reference sets. KDRT's must differ, and those of more
/// reference sets must not. `None` if one of these three was not measured.
pub fn mean_curves(against: &[AgainstReference]) -> Option<Claim> {
    let of = |way: AveragedWay| against.iter().find(|one| one.way == way);
    let [again, kdrt, exact] = [AveragedWay::Again, AveragedWay::Kdrt, AveragedWay::Exact].map(of);
    let (again, kdrt, exact) = (again?, kdrt?, exact?);

    // There is a verdict only if both measures, by annuli of frequencies and by bins of distances, see the bias of KDRT
    // and see none among reference sets.
    let is_within = |one: &AgainstReference| one.outside().map(|share| share <= OUTSIDE);
    let is_seen = is_within(again) == [true; 2] && is_within(kdrt) == [false; 2];
    let verdict = Verdict::if_known(is_seen, is_within(exact) == [true; 2]);

    let values = json!({
        "sets": exact.sets, "exact": curves_of(exact), "kdrt": curves_of(kdrt), "again": curves_of(again),
        "outside": OUTSIDE,
    });
    Some(claim("uniformity/curves", verdict, &values))
}

/// Returns how far mean curves are from the reference's, in words.
fn curves_of(one: &AgainstReference) -> String {
    let [annuli, bins] = one.outside();
    let values = json!({
        "annuli": annuli, "bins": bins, "density": one.density, "anisotropy": one.anisotropy,
    });
    text("uniformity/curves-of", &values)
}

/// Returns the verdict on all places together: bands, strips and cells of sets that need no control.
fn even(ours: &SamplerUniformity) -> Verdict {
    let cells = Rule::Within([f64::NEG_INFINITY, EVEN]).verdict(Some(ours.grid().interval));
    let places = ours.places().into_iter();
    Verdict::of_all(places.map(|(_, off)| within(&off, EVEN)).chain([cells]))
}

/// Returns the name of the band or strip whose density is furthest from the sets' mean, and its deviation in words.
fn worst(ours: &SamplerUniformity) -> (&'static str, String) {
    let far = |(_, off): &(&str, DensityOffset)| off.relative.abs();
    let places = ours.places().into_iter();
    let worst = places.max_by(|a, b| far(a).total_cmp(&far(b)));
    worst.map_or(("nowhere", String::new()), |(name, off)| {
        (name, offset(&off))
    })
}

/// Returns whether no bias is measured of sets that have no bias, neither in cells nor in any band or strip.
fn clean(reference: &SamplerUniformity) -> bool {
    let grid = reference.grid().interval;
    (grid[0] <= 0.0 || grid[1] <= NEGLIGIBLE)
        && reference.places().iter().all(|(_, off)| negligible(off))
}

fn negligible(off: &DensityOffset) -> bool {
    off.around_zero() || within(off, NEGLIGIBLE) == Verdict::Reproduced
}

/// Places of the domain.
fn everywhere(how: &str, [reference, moved, ours]: [&SamplerUniformity; 3]) -> Claim {
    let seen = moved.grid().interval[0] > EVEN && clean(reference);
    let ((name, far), (reference_name, reference_far)) = (worst(ours), worst(reference));
    let values = json!({
        "how": how, "name": name, "worst": far, "cells": ours.cells.deviations.len(), "cell": CELL,
        "grid": ours.grid(), "cramers_v": ours.cells.chi_square.cramers_v,
        "reference_cramers_v": reference.cells.chi_square.cramers_v, "judged": JUDGED, "even": EVEN,
        "moved": MOVED, "moved_rms": moved.grid().rms, "negligible": NEGLIGIBLE,
        "reference_rms": reference.grid().rms, "reference_name": reference_name,
        "reference_worst": reference_far,
    });
    claim("uniformity/everywhere", if_clean(seen, even(ours)), &values)
}

/// The border of a periodic domain.
fn frame_of(how: &str, reference: &SamplerUniformity, ours: &SamplerUniformity) -> Claim {
    let [here, control] = [ours, reference].map(SamplerUniformity::frame);
    let verdict = if_clean(control.around_zero(), there(&[here]).opposite());
    let values = json!({
        "how": how, "frame": offset(&here), "control": control.interval, "telling": TELLING,
    });
    claim("uniformity/frame", verdict, &values)
}

/// Judges whether both sides of the border of a periodic domain have equally many samples. There is a verdict only if
/// those of the reference have.
fn sides(order: &str, reference: &SamplerUniformity, ours: &SamplerUniformity) -> Claim {
    // Two sides count as even if their intervals overlap.
    let even = |subject: &SamplerUniformity| {
        let [after, before] = subject.sides();
        after.interval[0] <= before.interval[1] && before.interval[0] <= after.interval[1]
    };
    let [after, before] = ours.sides();
    // Intervals apart show a difference, however wide they are. That there is none, only narrow ones can show.
    let known = !even(ours) || after.tells(TELLING) && before.tells(TELLING);
    let verdict = Verdict::if_known(even(reference) && known, even(ours));
    let values = json!({
        "order": order, "after": offset(&after), "before": offset(&before), "telling": TELLING,
    });
    claim("uniformity/sides", verdict, &values)
}

/// Where no clip overlaps.
fn interior(reference: &SamplerUniformity, ours: &SamplerUniformity) -> Claim {
    let ([.., deep], [.., control]) = (ours.bands(), reference.bands());
    let verdict = if_clean(negligible(&control), within(&deep, NEGLIGIBLE));
    let values = json!({
        "interior": INTERIOR, "deep": offset(&deep), "limit": NEGLIGIBLE, "control": control.relative,
    });
    claim("uniformity/interior", verdict, &values)
}

/// Places near borders of blocks, where clips overlap.
fn border(how: &str, ours: &SamplerUniformity) -> Claim {
    // Two bands are judged, whose intervals have to hold together.
    let [near, middle, _] = ours.bands().map(|band| band.among(2, ours.sets));
    let values = json!({
        "how": how, "near": offset(&near), "interior": INTERIOR, "middle": offset(&middle),
        "worst": ours.worst_block_class(), "telling": TELLING,
    });
    claim("uniformity/border", there(&[near, middle]), &values)
}

/// What the place of an inserted sample adds to the bias in density.
fn deterministic(found: &UniformityResults) -> Claim {
    let pair = &found.paired;
    let values = json!({
        "difference": offset(&pair.difference), "effect": pair.effect,
        "sets": found.all[2].sets, "telling": TELLING,
    });
    claim(
        "uniformity/deterministic",
        there(&[pair.difference]),
        &values,
    )
}

/// Whether there is a bias without deterministic insertion.
fn removes(found: &UniformityResults) -> Claim {
    // In `NAMES` the third way inserts at circumcentres, and the fourth uniformly.
    let [with, without] = [2, 3].map(|way: usize| found.all[way].bands()[0]);
    let values = json!({
        "with": offset(&with), "without": offset(&without), "removed": found.paired.removed,
        "negligible": NEGLIGIBLE,
    });
    claim("uniformity/removes", within(&without, NEGLIGIBLE), &values)
}

fn farthest(ours: &SamplerUniformity) -> Claim {
    let ranks = ours.ranks();
    let verdict = Verdict::of(ranks.probability < UNLIKELY);
    claim("uniformity/farthest", verdict, &values(ranks))
}

fn unbiased(ours: &SamplerUniformity) -> Claim {
    let ranks = ours.ranks();
    let known = ranks.probability < UNLIKELY || ranks.count >= RANKED;
    let verdict = Verdict::if_known(known, ranks.probability >= UNLIKELY);
    claim("uniformity/unbiased", verdict, &values(ranks))
}

fn values(ranks: RankTest) -> Value {
    json!({ "ranks": ranks, "unlikely": UNLIKELY, "ranked": RANKED })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_intervals_around_zero_deny_nothing() {
        let off = |relative: f64, reach: f64| DensityOffset {
            relative,
            interval: [relative - reach, relative + reach],
        };
        assert_eq!(
            there(&[off(0.03, 0.02), off(0.0, 0.1)]),
            Verdict::Reproduced
        );
        assert_eq!(
            there(&[off(0.001, 0.01), off(0.0, 0.01)]),
            Verdict::NotReproduced
        );
        assert_eq!(
            there(&[off(0.001, 0.01), off(0.0, 0.1)]),
            Verdict::NotComparable
        );
    }
}
