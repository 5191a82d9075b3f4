//! Sets whose radius varies: whether a place has as many samples, in squares of its own radius, as a place of a set of one radius,
//! whether pairs are as far apart in local radii, which of five rules for two radii does that, and the tones of a ramp.
//!
//! The paper hopes for such sets (section 5.2) and makes none. Here every set is made by the reference sampler for fields of
//! radii and judged by subdivision, but those of the five rules: see `rules`.

mod claims;
mod fields;
mod ramps;
mod rules;
mod shown;
mod tones;

use std::f64::consts::TAU;

use serde_json::json;
use tilescope_core::Boundary;

use crate::error::Result;
use crate::outcome::Outcome;
use crate::study::{Settings, Study};
use crate::texts::text;
use fields::{FieldCounts, Written, integral, plateau, samples};
use ramps::{RAMPS, RampSets};
use rules::{RadiusRule, RuleCounts, RuledField};

/// How many times the least radius the largest is, on waves.
const CONTRASTS: [f64; 4] = [2.0, 4.0, 16.0, 32.0];
/// The length of a wave in least radii. At a contrast of 32 the radius grows by up to 0.29 for each unit, at 16 by 0.13.
const WAVE: f64 = 512.0;
/// Radii of sets of one radius, in least radii of a field. A process whose cells have sizes of powers of two could have other
/// densities just below and above an octave.
const PLATEAUS: [f64; 6] = [1.0, 1.2, 1.41, 1.7, 1.99, 2.0];
/// The sides of their tori, in radii: some hundred times as far as samples are correlated.
const PLATEAU_SIDE: f64 = 128.0;

/// How many sets are made of each kind, and how large the stipples are. The numbers are chosen so that errors are a
/// fraction of the limits of the claims.
#[derive(Clone, Copy, Debug)]
struct VaryingPlan {
    /// Sets on each ramp, each wave, and of each radius.
    ramps: usize,
    waves: usize,
    plateaus: usize,
    /// Sets by each rule for two radii, on each of its fields.
    ruled: usize,
    /// Stipples of the ramp of tones, and the dots of each.
    tones: usize,
    dots: u64,
}

impl VaryingPlan {
    fn of(settings: &Settings) -> Self {
        let whole = Self {
            ramps: 200,
            waves: 16,
            plateaus: 16,
            ruled: 100,
            tones: 20,
            dots: 20_000,
        };
        // A quick run takes seconds, and leaves most claims open.
        let quick = Self {
            ramps: 6,
            waves: 3,
            plateaus: 3,
            ruled: 4,
            tones: 3,
            dots: 5000,
        };
        settings.pick(whole, quick)
    }
}

/// What a run found.
#[derive(Clone, Debug)]
struct VaryingResults {
    ramps: Vec<RampSets>,
    /// Each with its contrast.
    waves: Vec<(f64, FieldCounts)>,
    /// Each with its radius.
    plateaus: Vec<(f64, FieldCounts)>,
    /// Each with its field, one radius first.
    ruled: Vec<(RuledField, RuleCounts)>,
    /// How many dots each stipple has in each step of the ramp.
    tones: Vec<Vec<u64>>,
}

impl VaryingResults {
    /// Returns the density by a rule on a field over that by the same rule for one radius, and the error of this ratio.
    fn relative(&self, rule: usize, field: usize) -> [f64; 2] {
        let [one, one_error] = self.ruled[0].1.by_rule[rule].density();
        let [here, error] = self.ruled[field].1.by_rule[rule].density();
        let ratio = here / one;
        [ratio, ratio * (error / here).hypot(one_error / one)]
    }

    /// Returns dots in steps of the ramp over those that their darkness asks for, and the standard error, by the spread between
    /// stipples.
    fn tone(&self, steps: std::ops::Range<usize>) -> [f64; 2] {
        let share: f64 = steps.clone().map(tones::share).sum();
        let counts = FieldCounts {
            counts: (self.tones.iter())
                .map(|one| one[steps.clone()].iter().sum())
                .collect(),
            // In place of an area: the dots that are asked for.
            area: share * self.tones.first().map_or(0, |one| one.iter().sum::<u64>()) as f64,
        };
        counts.density()
    }
}

pub fn units(_: &Settings) -> usize {
    // The ramp of tones is one unit.
    RAMPS.len() + CONTRASTS.len() + PLATEAUS.len() + RuledField::ALL.len() + 1
}

/// Makes all sets and counts their samples.
pub fn run(study: &Study<'_>) -> Result<Outcome> {
    let plan = VaryingPlan::of(study.settings);
    // Units come in the sequence in which their kinds are counted in `units`.
    let found = VaryingResults {
        ramps: on_ramps(study, plan.ramps)?,
        waves: on_waves(study, plan.waves)?,
        plateaus: on_plateaus(study, plan.plateaus)?,
        ruled: by_rules(study, plan.ruled)?,
        tones: study.sets(
            "tones",
            "ramp of 64 steps",
            0..plan.tones,
            |seed, control| tones::counted(plan.dots, seed, control),
        )?,
    };

    Ok(Outcome {
        claims: claims::claims(&found),
        pictures: vec![shown::picture_of(&found)?],
        tables: shown::tables(&found),
        notes: vec![text(
            "varying/how",
            &json!({ "side": PLATEAU_SIDE, "dots": plan.dots }),
        )],
    })
}

/// Makes sets on each ramp, a unit each.
fn on_ramps(study: &Study<'_>, sets: usize) -> Result<Vec<RampSets>> {
    let units = RAMPS.into_iter().map(|ramp| {
        let (key, what) = (
            format!("ramp-{}", ramp.slope),
            format!("slope {}", ramp.slope),
        );
        let ground = ramp.ground()?;
        let made = study.sets(&key, &what, 0..sets, |seed, control| {
            ramp.made(&ground, seed, control)
        })?;
        Ok(ramp.joined(&made))
    });
    units.collect()
}

/// Makes sets on periodic waves of each contrast, a unit each.
fn on_waves(study: &Study<'_>, sets: usize) -> Result<Vec<(f64, FieldCounts)>> {
    let units = CONTRASTS.into_iter().map(|contrast| {
        // The logarithm of the radius is a wave from 0 to that of the contrast.
        let half = 0.5 * contrast.ln();
        // A torus must be more than four times as high as the largest radius: six times leaves some room. Low contrasts get 32
        // for more samples. Both are chosen, not measured.
        let height = (6.0 * contrast).max(32.0);
        let field = Written {
            radius: format!("exp({half}*(1-cos(2*pi*x/{WAVE})))"),
            size: [WAVE, height],
            boundary: Boundary::Periodic,
        };
        let ground = field.ground()?;
        let what = format!("contrast {contrast}");
        let counts = study.sets(
            &format!("wave-{contrast}"),
            &what,
            0..sets,
            |seed, control| Ok(samples(&ground, seed, control)?.len() as u64),
        )?;

        // How much a unit of x adds to the area in squared local radii.
        let area_at = |x: f64| {
            let radius = (half * (1.0 - (TAU * x / WAVE).cos())).exp();
            height / (radius * radius)
        };
        let area = integral(0.0, WAVE, area_at);
        Ok((contrast, FieldCounts { counts, area }))
    });
    units.collect()
}

/// Makes sets of one radius, at several places between two octaves, a unit each.
fn on_plateaus(study: &Study<'_>, sets: usize) -> Result<Vec<(f64, FieldCounts)>> {
    let units = PLATEAUS.into_iter().map(|octave| {
        let what = format!("radius {octave}");
        let key = format!("plateau-{octave}");
        let counts = study.sets(&key, &what, 0..sets, |seed, control| {
            plateau(octave, PLATEAU_SIDE, seed, control)
        })?;
        let area = PLATEAU_SIDE * PLATEAU_SIDE;
        Ok((octave, FieldCounts { counts, area }))
    });
    units.collect()
}

/// Makes sets by each rule on each field, a unit for each field.
fn by_rules(study: &Study<'_>, sets: usize) -> Result<Vec<(RuledField, RuleCounts)>> {
    let units = RuledField::ALL.into_iter().map(|field| {
        // All rules have the same seeds, and so the same darts.
        let what = format!("five rules, {}", field.name());
        let each = study.sets(
            &format!("rules-{}", field.key()),
            &what,
            0..sets,
            |seed, control| {
                control.go_on()?;
                Ok(RadiusRule::ALL.map(|rule| field.count(rule, seed)))
            },
        )?;
        let of_rule = |rule: usize| field.joined(each.iter().map(|set| set[rule]).collect());
        let by_rule = (0..RadiusRule::ALL.len()).map(of_rule).collect();
        Ok((field, RuleCounts { by_rule }))
    });
    units.collect()
}

#[cfg(test)]
mod tests;
