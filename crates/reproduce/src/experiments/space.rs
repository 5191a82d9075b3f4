//! Maximal sets of balls in space, held against saturated random sequential packings of spheres: how many samples a
//! volume has, how many balls a plane meets, how far places and samples are apart, pairs by distance, and the power
//! of low frequencies.
//!
//! The paper has one sentence on space and no number. Every set is periodic, has a seed of its own and is judged
//! twice. Two kinds of sets that are not maximal are the controls: each rule must refute one of them.

mod balls;
mod claims;
mod results;
mod shown;

use std::ops::Range;

use serde_json::json;

use crate::control::Control;
use crate::error::Result;
use crate::outcome::Outcome;
use crate::study::{Settings, Study};
use crate::texts::text;
use balls::{BallKind, MeasuredBalls};
use results::SpaceResults;

/// Sets of a unit of work: an interrupted run loses at most these. At 40 r they have 280,000 samples.
const BATCH: usize = 6;
/// Each group of sets has this many indices of seeds, so that no two sets share darts: those of one seed would, also
/// in cubes of other sizes.
const INDICES: usize = 100;

/// How many sets are made, in cubes of which sides.
#[derive(Clone, Copy, Debug)]
struct SpacePlan {
    /// Side of the large cubes in radii, and the number of their sets.
    side: f64,
    sets: usize,
    /// The same of smaller cubes, whose spectra are measured. Each control has as many of them.
    small_side: f64,
    small_sets: usize,
}

impl SpacePlan {
    fn of(settings: &Settings) -> Self {
        // From set to set, the number of samples has a variance of about 0.06 times its mean. With 24 sets of 47,000
        // samples the error of the density is thus about 0.0002. The error of pairs is then a fifth of a percent. With
        // twelve sets of 10,000 samples the error of low powers is two percent.
        let whole = Self {
            side: 40.0,
            sets: 24,
            small_side: 24.0,
            small_sets: 12,
        };
        // A quick run takes seconds, and leaves most claims open.
        let quick = Self {
            side: 16.0,
            sets: 4,
            small_side: 12.0,
            small_sets: 3,
        };
        settings.pick(whole, quick)
    }
}

pub fn units(settings: &Settings) -> usize {
    let plan = SpacePlan::of(settings);
    // Small cubes have the maximal sets and those of both controls.
    plan.sets.div_ceil(BATCH) + 3 * plan.small_sets.div_ceil(BATCH)
}

/// Makes and measures all sets.
pub fn run(study: &Study<'_>) -> Result<Outcome> {
    let plan = SpacePlan::of(study.settings);
    let small = |group, kind: BallKind| {
        let side = plan.small_side;
        let what = format!("{} in cubes of {side} r", kind.name());
        in_batches(study, group, plan.small_sets, &what, |seed, control| {
            kind.made(side, seed, control)?.with_spectrum(control)
        })
    };
    let large = || {
        let what = format!("maximal sets in cubes of {} r", plan.side);
        in_batches(study, 0, plan.sets, &what, |seed, control| {
            let set = BallKind::Maximal.made(plan.side, seed, control)?;
            set.measured(control)
        })
    };

    // The small cubes come first, since they take only a quarter of the time: what fails in them fails early.
    let found = SpaceResults {
        side: plan.side,
        small_side: plan.small_side,
        small: small(1, BallKind::Maximal)?,
        stopped: small(2, BallKind::Stopped)?,
        scattered: small(3, BallKind::Scattered)?,
        large: large()?,
    };

    let values = json!({
        "side": plan.side, "sets": plan.sets,
        "small_side": plan.small_side, "small_sets": plan.small_sets,
        "stopped": balls::STOPPED.0, "of": balls::STOPPED.1,
    });
    Ok(Outcome {
        claims: claims::claims(&found),
        pictures: vec![shown::picture_of(&found)?],
        tables: shown::tables(&found),
        notes: vec![text("space/how", &values)],
    })
}

/// Makes the sets of a group, a unit for each batch. Seeds follow from the number of the group, counted from 0.
fn in_batches(
    study: &Study<'_>,
    group: usize,
    sets: usize,
    what: &str,
    make: impl Fn(u64, &Control<'_>) -> Result<MeasuredBalls> + Sync,
) -> Result<Vec<MeasuredBalls>> {
    let first = group * INDICES;
    let end = first + sets;
    let batches = (first..end).step_by(BATCH).map(|from| {
        let indices: Range<usize> = from..(from + BATCH).min(end);
        let key = format!("sets-{}-{}", indices.start, indices.end);
        study.sets(&key, what, indices, &make)
    });
    let batches: Result<Vec<Vec<MeasuredBalls>>> = batches.collect();
    Ok(batches?.concat())
}

#[cfg(test)]
mod tests;
