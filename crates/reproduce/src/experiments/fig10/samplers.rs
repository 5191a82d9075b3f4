//! The samplers that are compared: each gives a number of samples in the unit square, by a seed. Sets of the
//! reference sampler and of KDRT are verified here.

use rayon::prelude::*;
use tilescope_core::{Boundary, Domain, Key, MAXIMAL_DENSITY, Parameters, Stream, radius_estimate};

use crate::control::Control;
use crate::error::Result;
use crate::sets::Set;
use crate::study::Settings;

/// Shortest edge of a block of KDRT, in radii.
pub const LEAF: f64 = 40.0;
/// Ready-made patterns that sets take in turn.
const PATTERNS: u64 = 8;

/// A way to get samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampler {
    /// Independent of each other and evenly distributed.
    Random,
    /// One anywhere in each cell of a square grid.
    Jittered,
    /// One in the middle of each cell of a square grid.
    Grid,
    /// Maximal Poisson-disk samples by dart throwing (Ebeida et al. 2012).
    Reference,
    /// Maximal Poisson-disk samples by randomized tiling.
    Kdrt,
}

impl Sampler {
    /// All of them, in the sequence of the figure.
    pub const ALL: [Self; 5] = [
        Self::Random,
        Self::Jittered,
        Self::Grid,
        Self::Reference,
        Self::Kdrt,
    ];

    /// Returns its name for readers.
    pub const fn name(self) -> &'static str {
        self.words()[0]
    }

    /// Returns its name in keys of units.
    pub const fn key(self) -> &'static str {
        self.words()[1]
    }

    const fn words(self) -> [&'static str; 2] {
        match self {
            Self::Random => ["uniform random", "random"],
            Self::Jittered => ["jittered", "jittered"],
            Self::Grid => ["regular grid", "grid"],
            Self::Reference => ["reference (MPS)", "reference"],
            Self::Kdrt => ["KDRT", "kdrt"],
        }
    }

    /// Returns how many different sets of one size it has, `wanted` at most.
    pub fn sets(self, wanted: u64) -> u64 {
        if self == Self::Grid { 1 } else { wanted }
    }

    /// Returns about `count` samples in the unit square, those of set number `index`.
    pub fn points(
        self,
        count: usize,
        index: u64,
        settings: &Settings,
        control: &Control<'_>,
    ) -> Result<Vec<[f64; 2]>> {
        control.go_on()?;

        let seed = settings.seed_of(index);
        // Samplers by cells make the square number of samples that is about `count`.
        let along = (count as f64).sqrt().round().max(1.0) as u32;

        match self {
            Self::Random => Ok(draws(count as u32, seed, |_, place| place)),
            Self::Jittered => {
                let place = |cell, at| in_cell(cell, at, along);
                Ok(draws(along * along, seed, place))
            }
            Self::Grid => {
                let cells = 0..along * along;
                Ok(cells.map(|cell| in_cell(cell, [0.5; 2], along)).collect())
            }
            Self::Reference => {
                // Maximal sets have this many samples per r^2, which gives the radius for a number of samples.
                let radius = (MAXIMAL_DENSITY / count as f64).sqrt();
                let domain = Domain::from_size([1.0; 2], radius, Boundary::Periodic)?;
                verified(Set::reference(domain, seed, control)?, "reference", control)
            }
            Self::Kdrt => {
                let (set, _summary) = Set::kdrt(&kdrt(count, seed, index)?, control)?;
                verified(set, "KDRT", control)
            }
        }
    }
}

fn verified(set: Set, what: &str, control: &Control<'_>) -> Result<Vec<[f64; 2]>> {
    set.verified(&format!("{what}, {} samples", set.points.len()), control)?;
    Ok(set.points)
}

fn kdrt(count: usize, seed: u64, index: u64) -> Result<Parameters> {
    let mut parameters = Parameters {
        seed,
        leaf: LEAF,
        ..Parameters::default()
    };
    parameters.pattern.seed = index % PATTERNS;
    parameters.radius = radius_estimate(&parameters, count as u64)?;
    Ok(parameters)
}

/// Returns `count` places made from draws in the unit square.
fn draws(count: u32, seed: u64, place: impl Fn(u32, [f64; 2]) -> [f64; 2] + Sync) -> Vec<[f64; 2]> {
    // The key differs from that of the seed, which samplers use.
    let key = Key::from_seed(seed).derive(Stream::Pattern, u32::MAX);
    let unit = |word: u32| f64::from(word) / (f64::from(u32::MAX) + 1.0);
    (0..count)
        .into_par_iter()
        .map(|index| place(index, key.draw(Stream::Dart, index).map(unit)))
        .collect()
}

fn in_cell(cell: u32, [x, y]: [f64; 2], along: u32) -> [f64; 2] {
    let column = f64::from(cell % along) + x;
    let row = f64::from(cell / along) + y;
    [column, row].map(|at| at / f64::from(along))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::tests::alone;

    #[test]
    fn jittered_samples_are_one_in_each_cell_and_random_ones_are_not() {
        alone(&Settings::default(), |control| {
            let settings = Settings::default();
            let full = |sampler: Sampler| -> Result<usize> {
                let points = sampler.points(900, 0, &settings, control)?;
                let mut cells = vec![0; 900];
                for at in &points {
                    cells[(30.0 * at[1]) as usize * 30 + (30.0 * at[0]) as usize] += 1;
                }
                assert_eq!(points.len(), 900);
                Ok(cells.iter().filter(|count| **count == 1).count())
            };
            assert_eq!((full(Sampler::Jittered)?, full(Sampler::Grid)?), (900, 900));
            assert!(full(Sampler::Random)? < 500);
            Ok(())
        });
    }

    #[test]
    fn a_seed_gives_the_same_samples_and_another_one_others() {
        alone(&Settings::default(), |control| {
            for sampler in Sampler::ALL {
                let made = |seed, index| {
                    let settings = Settings {
                        seed,
                        ..Settings::default()
                    };
                    sampler.points(4000, index, &settings, control)
                };
                let first = made(1, 0)?;
                assert_eq!(first, made(1, 0)?, "{sampler:?}");
                let count = first.len() as f64 / 4000.0;
                assert!((count - 1.0).abs() < 0.02, "{sampler:?}: {count}");
                let fixed = sampler == Sampler::Grid;
                assert_eq!(first == made(1, 1)?, fixed, "{sampler:?}");
                assert_eq!(first == made(2, 0)?, fixed, "{sampler:?}");
                let inside = first.iter().flatten().all(|v| (0.0..1.0).contains(v));
                assert!(inside, "{sampler:?}");
            }
            Ok(())
        });
    }
}
