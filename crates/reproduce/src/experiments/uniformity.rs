//! Equation 1 and section 5.1: whether every place is as likely to hold a sample as any other. The samples of many
//! small sets are counted by place: on a grid of the domain, by distance from borders, and within gaps. One control
//! has no bias, another one has a known bias. Mean curves of many sets say whether pairs and spectra are those of the
//! reference sampler.

mod averages;
mod claims;
mod counted;
mod gaps;
mod offsets;
mod shown;

use serde_json::json;

use crate::error::Result;
use crate::experiments::common::square;
use crate::outcome::Outcome;
use crate::study::{Settings, Study};
use crate::texts::text;
use averages::AveragePlan;
use counted::SeedCounts;
use offsets::UniformityResults;

/// Shortest edge of a block, in radii.
const LEAF: f64 = 20.0;
/// Seeds of a unit of work: an interrupted run loses at most this many.
const BATCH: usize = 25;
/// Side of a cell of the grid, in radii, as near to it as whole cells allow: sets of 10,000 samples have 32 along a side.
pub const CELL: f64 = 3.74;

/// Batches of seeds, samples of a set, cells along a side of the grid.
fn amounts(settings: &Settings) -> (usize, f64, usize) {
    let (batches, samples) = settings.pick((16, 10_000.0), (2, 3_000.0));
    let batches = if settings.many { 5 * batches } else { batches };
    let cells = (square(samples, LEAF).width / CELL).round();
    (batches, samples, cells as usize)
}

pub fn units(settings: &Settings) -> usize {
    amounts(settings).0 + AveragePlan::of(settings).units()
}

/// Counts the samples of many sets by place, and compares the mean curves of each way to make sets.
pub fn run(study: &Study<'_>) -> Result<Outcome> {
    let (batches, samples, cells) = amounts(study.settings);
    let parameters = square(samples, LEAF);
    let mut seeds: Vec<SeedCounts> = Vec::new();

    // Each batch is a unit, so that an interrupted run loses one of them at most.
    for batch in 0..batches {
        let (key, what) = (
            format!("batch-{batch}"),
            format!("sets of batch {} of {batches}", batch + 1),
        );
        let indices = batch * BATCH..(batch + 1) * BATCH;
        seeds.extend(study.sets(&key, &what, indices, |seed, control| {
            SeedCounts::of(&parameters, cells, seed, control)
        })?);
    }

    let found = UniformityResults::of(&seeds)?;
    let against = averages::averages(study)?;

    let mut claims = claims::claims(&found);
    claims.extend(claims::mean_curves(&against));

    let mut pictures = shown::pictures(&found, cells)?;
    pictures.push(shown::mean_curves(&against)?);
    let mut tables = shown::tables(&found);
    tables.push(shown::averages(&against));

    Ok(Outcome {
        claims,
        pictures,
        tables,
        notes: vec![text("uniformity/how", &json!({}))],
    })
}

#[cfg(test)]
mod tests;
