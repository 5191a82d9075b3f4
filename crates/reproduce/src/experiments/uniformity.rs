//! Equation 1 and section 5.1: whether every place is as likely to hold a sample as any other. The samples of many
//! small sets are counted by place: on a grid of the domain, by distance from borders, and within gaps. One control
//! has no bias, another one has a known bias.

mod bias;
mod claims;
mod counted;
mod gaps;
mod offsets;
mod shown;

use rayon::prelude::*;

use crate::error::ReproduceError;
use crate::experiments::common::{seed, square};
use crate::outcome::Outcome;
use crate::study::{Settings, Study};
use counted::SeedCounts;
use offsets::UniformityResults;

const LEAF: f64 = 20.0;
/// Seeds of a unit of work.
const BATCH: usize = 25;
/// Side of a cell of the grid, in radii: as near to it as whole cells allow.
pub const CELL: f64 = 3.74;

/// Batches of seeds, samples of a set, cells along a side of the grid.
fn amounts(settings: &Settings) -> (usize, f64, usize) {
    let (batches, samples) = settings.pick((16, 10_000.0), (2, 3_000.0));
    let cells = (square(samples, LEAF).width / CELL).round();
    (batches, samples, cells as usize)
}

pub fn units(settings: &Settings) -> usize {
    amounts(settings).0
}

pub fn run(study: &Study<'_>) -> Result<Outcome, ReproduceError> {
    let settings = study.settings;
    let (batches, samples, cells) = amounts(settings);
    let parameters = square(samples, LEAF);
    let mut seeds: Vec<SeedCounts> = Vec::new();
    for batch in 0..batches {
        let what = format!("sets of batch {} of {batches}", batch + 1);
        let made: Vec<SeedCounts> = study.unit(&format!("batch-{batch}"), &what, |control| {
            (batch * BATCH..(batch + 1) * BATCH)
                .into_par_iter()
                .map(|index| SeedCounts::of(&parameters, cells, seed(settings, index), control))
                .collect()
        })?;
        seeds.extend(made);
    }
    let found = UniformityResults::of(&seeds)?;
    Ok(Outcome {
        claims: claims::claims(&found),
        pictures: shown::pictures(&found, cells)?,
        tables: shown::tables(&found),
        notes: vec![NOTE.to_owned()],
    })
}

const NOTE: &str = "Every seed has a pattern, blocks and a reference set of its own. Intervals come from the spread between sets, \
since samples of one set depend on each other: those that keep a distance are spread more evenly than independent ones. The reference \
set is held against the blocks of the other two, of which it knows nothing; the moved set is the reference set, made denser towards \
the middle of the width. Within a gap an inserted sample is ranked among 39 uniform places of what was left of its gap when it came, \
by the distance to the nearest sample: a sample without bias has each of the 40 ranks as often. Cells of the grid are about 3.7 r \
wide, so that they dilute a strip of 1 r; places are therefore judged by bands and strips of 1 r as well.";

#[cfg(test)]
mod tests;
