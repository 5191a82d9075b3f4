//! The density of maximal sets: how many samples random sequential addition leaves to an area once no further one fits.
//! Independent periodic sets of the reference sampler are counted, since tiling repeats its pattern and adds no independent
//! samples. Their places are integers, so that a few gaps are missed: two estimates say how many.

mod claims;
mod coarse;
mod line;
mod results;
mod shown;
mod sums;
mod torus;

use std::ops::Range;

use serde_json::json;

use crate::error::{ReproduceError, Result};
use crate::outcome::Outcome;
use crate::study::{Settings, Study};
use crate::texts::text;
use coarse::CoarseSets;
use results::DensityResults;
pub use results::PUBLISHED;
use torus::TorusSets;

/// Side of a set's torus, in radii: some hundred times as far as samples are correlated (see `SMALL_SIDES`). A core makes 0.72
/// million samples a second in sets of these 46,000; 0.80 in sets of 11,000, 0.62 in sets of 730,000 and 0.56 in those of
/// 2.9 million.
const SIDE: f64 = 256.0;
/// Sides of smaller tori, which show from where on the size no longer matters.
const SMALL_SIDES: [f64; 4] = [10.0, 14.0, 20.0, 40.0];
/// Sets on smaller tori have seeds from this number on, times the number of the torus: more than a run has batches.
const SMALL_SEEDS: u64 = 1 << 28;

/// How much is made.
#[derive(Clone, Copy, Debug)]
struct DensityPlan {
    /// Units of sets on the large torus.
    batches: u64,
    /// Sets of a batch.
    sets: u64,
    /// Samples on each of the smaller tori, about.
    small: f64,
    /// Sets on each of the coarse lattices.
    coarse: u64,
}

impl DensityPlan {
    fn of(settings: &Settings) -> Self {
        // 96 batches have 2.2 x 10^9 samples, whose error is about that of the published density. 480 have 1.1 x 10^10,
        // for a smaller error. The other numbers are chosen, not measured.
        let batches = if settings.many { 480 } else { 96 };
        let whole = Self {
            batches,
            sets: 500,
            small: 2e7,
            coarse: 10_000,
        };
        // A quick run shows that all units work. Nothing can be concluded from so few sets.
        let quick = Self {
            batches: 2,
            sets: 4,
            small: 3e4,
            coarse: 40,
        };
        settings.pick(whole, quick)
    }

    /// Returns the indices of the sets of a batch.
    fn indices(self, batch: u64) -> Range<u64> {
        batch * self.sets..(batch + 1) * self.sets
    }
}

/// Returns the seed of a set. Runs of two seeds share no set: each has 2^32 indices.
fn seed_of(settings: &Settings, index: u64) -> u64 {
    settings.seed.rotate_left(32) ^ index
}

pub fn units(settings: &Settings) -> usize {
    let batches = DensityPlan::of(settings).batches as usize;
    coarse::RADII.len() + SMALL_SIDES.len() + batches
}

/// Counts the samples of all sets, and what the lattice leaves out.
pub fn run(study: &Study<'_>) -> Result<Outcome> {
    // The short units come first, so that a long run that is stopped has all that a conclusion needs.
    let coarse = on_coarse_lattices(study)?;
    let small = on_small_tori(study)?;
    let batches = on_large_tori(study)?;
    let found = DensityResults::of(&batches, &small, coarse)?;

    Ok(Outcome {
        claims: claims::claims(&found),
        pictures: vec![shown::picture_of(&found)?],
        tables: shown::tables(&found),
        notes: vec![text("density/how", &json!({ "side": SIDE }))],
    })
}

/// Makes the sets on each of the coarse lattices, a unit each.
fn on_coarse_lattices(study: &Study<'_>) -> Result<Vec<CoarseSets>> {
    let sets = DensityPlan::of(study.settings).coarse;
    let units = coarse::RADII.map(|radius| {
        let what = format!("lattice of {radius} units to r");
        study.unit(&format!("coarse-{radius}"), &what, |control| {
            let seeds = (0..sets).map(|index| seed_of(study.settings, index));
            CoarseSets::made(radius, seeds.collect(), control)
        })
    });
    units.into_iter().collect()
}

/// Makes the sets on each of the small tori, a unit each.
fn on_small_tori(study: &Study<'_>) -> Result<Vec<TorusSets>> {
    let samples = DensityPlan::of(study.settings).small;
    let units = (1..).zip(SMALL_SIDES).map(|(number, side)| {
        let sets = (samples / (results::PUBLISHED * side * side)).ceil() as u64;
        let first = number * SMALL_SEEDS;
        let what = format!("tori of {side} r");
        study.unit(&format!("torus-{side}"), &what, |control| {
            let seeds = (first..first + sets).map(|index| seed_of(study.settings, index));
            TorusSets::made(side, seeds.collect(), control)
        })
    });
    units.collect()
}

/// Makes the batches of sets on the large torus, a unit each, or returns those that are kept.
fn on_large_tori(study: &Study<'_>) -> Result<Vec<TorusSets>> {
    let plan = DensityPlan::of(study.settings);
    let mut found = Vec::new();

    for batch in 0..plan.batches {
        let key = format!("batch-{batch}");
        // With `kept` only the batches count that an earlier run, which may have been stopped, has left.
        if study.settings.kept && !study.has_kept::<TorusSets>(&key) {
            study.skip();
            continue;
        }

        let what = format!("batch {} of {}", batch + 1, plan.batches);
        found.push(study.unit(&key, &what, |control| {
            let indices = plan.indices(batch);
            let seeds: Vec<u64> = indices
                .map(|index| seed_of(study.settings, index))
                .collect();
            // Once in each batch the judge has to refuse sets that are wrong: the batch fails if it does not.
            torus::refuse_controls(SIDE, seeds[0], control)?;
            TorusSets::made(SIDE, seeds, control)
        })?);
    }

    // One batch is enough: the error comes from the spread between sets, of which a batch has several.
    if found.is_empty() {
        let none = "no batch is kept; run the same command without --kept".to_owned();
        return Err(ReproduceError::Engine(none));
    }
    Ok(found)
}

#[cfg(test)]
mod tests;
