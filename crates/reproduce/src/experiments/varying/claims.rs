//! Verdicts on sets whose radius varies.

use serde_json::{Value, json};
use tilescope_analysis::measures::student_quantile;

use super::fields::FieldCounts;
use super::ramps::middle;
use super::rules::RadiusRule;
use super::tones::STEPS;
use super::{RuledField, VaryingResults};
use crate::experiments::common::{MISSED, interval, largest};
use crate::experiments::density::PUBLISHED;
use crate::outcome::{Claim, Verdict};
use crate::rule::Rule;
use crate::texts::claim;

/// Densities on gentle fields may differ from that of one radius by this share.
const GENTLE: f64 = 0.01;
/// Ramps up to this slope, and waves up to this contrast, are gentle. The design expects 0.6 % more at a slope of 0.2, and 2 %
/// at 0.4.
const GENTLE_SLOPE: f64 = 0.2;
const GENTLE_CONTRAST: f64 = 16.0;
/// Densities of plateaus may differ by this much from the published one.
const PLATEAU: f64 = 0.003;
/// Pair correlations on ramps may differ by this much from those of one radius.
const PAIRS: f64 = 0.1;
/// Pairs are judged up to this slope. The steeper a ramp, the less its pairs are those of one radius.
const PAIR_SLOPE: f64 = 0.1;
/// Classes of tones may have this share of their dots too many or too few.
const TONE: f64 = 0.03;
/// Steps of a class.
pub const CLASS: usize = 8;
/// Densities by a rule that keeps the request may be off by this share: a step costs some of it by any rule.
const KEPT: f64 = 0.15;

/// Returns all claims.
pub fn claims(found: &VaryingResults) -> Vec<Claim> {
    vec![
        slopes(found),
        contrasts(found),
        plateaus(found),
        pairs(found),
        rules(found),
        tones(found),
    ]
}

/// Returns the verdict that a density is within `limit` of the published one.
fn near_published(counts: &FieldCounts, limit: f64) -> Verdict {
    let interval = interval(counts.density(), counts.counts.len());
    Rule::near(PUBLISHED, limit).verdict(interval)
}

/// Returns the verdict on all of these densities, and the values of their texts.
fn all_near<'a>(
    counts: impl Iterator<Item = &'a FieldCounts> + Clone,
    limit: f64,
) -> (Verdict, Value) {
    let verdict = Verdict::of_all(counts.clone().map(|one| near_published(one, limit)));
    let off = counts.clone().map(|one| {
        let [density, _standard_error] = one.density();
        density - PUBLISHED
    });
    // The largest difference from the published density, with its sign.
    let worst = off.fold(
        0.0,
        |worst: f64, off| if off.abs() > worst.abs() { off } else { worst },
    );
    let samples: u64 = counts.clone().map(FieldCounts::samples).sum();
    let error = largest(counts.map(|one| one.density()[1]));
    let values = json!({
        "published": PUBLISHED, "limit": limit, "worst": worst, "share": worst / PUBLISHED,
        "samples": samples, "error": error, "gentle": GENTLE,
        "slope": GENTLE_SLOPE, "contrast": GENTLE_CONTRAST,
    });
    (verdict, values)
}

fn slopes(found: &VaryingResults) -> Claim {
    let gentle = found.ramps.iter().filter(|one| one.slope <= GENTLE_SLOPE);
    let (verdict, values) = all_near(gentle.map(|one| &one.counts), GENTLE * PUBLISHED);
    claim("varying/slopes", verdict, &values)
}

fn contrasts(found: &VaryingResults) -> Claim {
    let gentle = found
        .waves
        .iter()
        .filter(|(contrast, _)| *contrast <= GENTLE_CONTRAST);
    let (verdict, values) = all_near(gentle.map(|(_, counts)| counts), GENTLE * PUBLISHED);
    claim("varying/contrasts", verdict, &values)
}

fn plateaus(found: &VaryingResults) -> Claim {
    let (verdict, values) = all_near(found.plateaus.iter().map(|(_, counts)| counts), PLATEAU);
    claim("varying/plateaus", verdict, &values)
}

/// Judges whether pairs on ramps of slopes up to [`PAIR_SLOPE`] are as far apart, in local radii, as pairs of one
/// radius.
fn pairs(found: &VaryingResults) -> Claim {
    // The first ramp has a slope of 0: one radius.
    let level = &found.ramps[0].pairs;
    let judged = (found.ramps[1..].iter()).filter(|one| one.slope <= PAIR_SLOPE);
    // The errors of pairs are those of counts, not of a spread: their quantile is the normal one.
    let quantile = student_quantile(MISSED, f64::INFINITY);
    let (mut verdicts, mut widest) = (Vec::new(), 0.0_f64);
    // The largest difference in a bin, and the distance of that bin. Distances of pairs begin at 1.
    let (mut worst, mut at) = (0.0_f64, 1.0);
    for ramp in judged {
        for (bin, ([here, error_here], [on_level, error_on_level])) in
            ramp.pairs.iter().zip(level).enumerate()
        {
            let (difference, error) = (here - on_level, error_here.hypot(*error_on_level));
            let reach = quantile * error;
            verdicts.push(
                Rule::near(0.0, PAIRS).verdict(Some([difference - reach, difference + reach])),
            );
            if difference.abs() > worst.abs() {
                (worst, at) = (difference, middle(bin));
            }
            widest = widest.max(reach);
        }
    }

    let values = json!({
        "limit": PAIRS, "slope": PAIR_SLOPE, "worst": worst, "at": at, "reach": widest,
        "contact": level.first().map(|one| one[0]),
    });
    claim("varying/pairs", Verdict::of_all(verdicts), &values)
}

/// Judges which rules keep the request on slopes and on strips: the harmonic mean must, and no other one may.
fn rules(found: &VaryingResults) -> Claim {
    // Densities are relative to those of the first field, which has one radius.
    let fields = 1..found.ruled.len();
    let sets = found.ruled[0].1.by_rule[0].counts.len();
    let kept = |rule: usize| {
        Verdict::of_all(fields.clone().map(|field| {
            Rule::near(1.0, KEPT).verdict(interval(found.relative(rule, field), sets))
        }))
    };
    // The rules begin with the harmonic mean.
    let others = (1..RadiusRule::ALL.len()).map(|rule| kept(rule).opposite());
    let verdict = Verdict::of_all(others.chain([kept(0)]));

    // Of each rule the field on which it is farthest off.
    let worst = |rule: usize| {
        let off = fields
            .clone()
            .map(|field| (found.relative(rule, field)[0] - 1.0, field));
        let (off, field) = off.fold((0.0_f64, 0), |worst, one| {
            if one.0.abs() > worst.0.abs() {
                one
            } else {
                worst
            }
        });
        json!({ "off": off, "field": RuledField::ALL[field].name() })
    };
    let each: Vec<Value> = (0..RadiusRule::ALL.len()).map(worst).collect();
    claim(
        "varying/rules",
        verdict,
        &json!({ "kept": KEPT, "rules": each }),
    )
}

/// Judges the tones of the ramp by classes of steps.
fn tones(found: &VaryingResults) -> Claim {
    // By single steps chance would decide: the lightest has a few dots.
    let classes = (0..STEPS)
        .step_by(CLASS)
        .map(|first| found.tone(first..first + CLASS));
    let classes: Vec<[f64; 2]> = classes.collect();
    let verdicts = (classes.iter())
        .map(|&tone| Rule::near(1.0, TONE).verdict(interval(tone, found.tones.len())));

    let tones = classes.iter().map(|tone| tone[0]);
    let [low, high] = crate::experiments::common::ends(tones);
    let values = json!({
        "limit": TONE, "low": low, "high": high, "class": CLASS,
        "error": largest(classes.iter().map(|tone| tone[1])), "stipples": found.tones.len(),
    });
    claim("varying/tones", Verdict::of_all(verdicts), &values)
}
