//! The samplers that are compared: each gives a number of samples in the unit square, by a seed.
//! Sets that claim to be maximal are verified here; nothing is measured.

use rayon::prelude::*;
use tilescope_analysis::Region;
use tilescope_core::{
    Boundary, Domain, Key, MAXIMAL_DENSITY, Parameters, PatternSpec, Stream, radius_estimate,
};

use crate::control::Control;
use crate::error::ReproduceError;
use crate::sets::{GivenSet, Set};
use crate::study::Settings;
use crate::work::Work;

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
    /// Samples of a file, by its index.
    Given(usize),
}

impl Sampler {
    /// Those made here.
    pub const MADE: [Self; 5] = [
        Self::Random,
        Self::Jittered,
        Self::Grid,
        Self::Reference,
        Self::Kdrt,
    ];

    /// Returns those made here and those from files.
    pub fn all(settings: &Settings) -> Vec<Self> {
        let given = (0..settings.given.len()).map(Self::Given);
        Self::MADE.into_iter().chain(given).collect()
    }

    /// Returns its name for readers.
    pub fn name(self, settings: &Settings) -> String {
        match self {
            Self::Random => "uniform random",
            Self::Jittered => "jittered",
            Self::Grid => "regular grid",
            Self::Reference => "reference (MPS)",
            Self::Kdrt => "KDRT",
            Self::Given(index) => &settings.given[index].name,
        }
        .to_owned()
    }

    /// Returns its name in keys of units.
    pub fn key(self) -> String {
        match self {
            Self::Random => "random".to_owned(),
            Self::Jittered => "jittered".to_owned(),
            Self::Grid => "grid".to_owned(),
            Self::Reference => "reference".to_owned(),
            Self::Kdrt => "kdrt".to_owned(),
            Self::Given(index) => format!("given-{index}"),
        }
    }

    /// Returns the largest number of samples that it has.
    pub fn most(self, settings: &Settings) -> usize {
        match self {
            Self::Given(index) => held(&settings.given[index]) as usize,
            _ => usize::MAX,
        }
    }

    /// Returns how many different sets of about `count` samples it has, `wanted` at most.
    pub fn sets(self, count: usize, wanted: u64, settings: &Settings) -> u64 {
        match self {
            Self::Grid => 1,
            Self::Given(index) => (cuts(&settings.given[index], count)).min(wanted),
            _ => wanted,
        }
    }

    /// Returns the work of a set.
    pub fn work(self, count: usize) -> Work {
        let count = count as f64;
        match self {
            Self::Random | Self::Jittered | Self::Grid | Self::Given(_) => Work {
                other: 2e-8 * count,
                ..Work::default()
            },
            Self::Reference => Work {
                reference: count,
                verified: count,
                ..Work::default()
            },
            Self::Kdrt => Work {
                tiled: count,
                verified: count,
                ..Work::default()
            },
        }
    }

    /// Returns about `count` samples in the unit square, those of set number `index`.
    pub fn points(
        self,
        (count, index): (usize, u64),
        settings: &Settings,
        control: &Control<'_>,
    ) -> Result<Vec<[f64; 2]>, ReproduceError> {
        control.go_on()?;
        let seed = settings.seed.wrapping_mul(1000).wrapping_add(index);
        let along = (count as f64).sqrt().round().max(1.0) as u32;
        match self {
            Self::Random => Ok(draws(count as u32, seed, |_, place| place)),
            Self::Jittered => Ok(draws(along * along, seed, |cell, at| {
                in_cell(cell, at, along)
            })),
            Self::Grid => Ok((0..along * along)
                .map(|cell| in_cell(cell, [0.5; 2], along))
                .collect()),
            Self::Reference => {
                let radius = (MAXIMAL_DENSITY / count as f64).sqrt();
                let domain = Domain::from_size([1.0; 2], radius, Boundary::Periodic)?;
                verified(Set::reference(domain, seed, control)?, "reference", control)
            }
            Self::Kdrt => {
                let (set, _) = Set::kdrt(&kdrt(count, seed, index)?, control)?;
                verified(set, "KDRT", control)
            }
            Self::Given(given) => Ok(cut(&settings.given[given], count, index)),
        }
    }
}

fn verified(set: Set, what: &str, control: &Control<'_>) -> Result<Vec<[f64; 2]>, ReproduceError> {
    set.verified(&format!("{what}, {} samples", set.points.len()), control)?;
    Ok(set.points)
}

fn kdrt(count: usize, seed: u64, index: u64) -> Result<Parameters, ReproduceError> {
    let parameters = Parameters {
        seed,
        leaf: LEAF,
        pattern: PatternSpec {
            seed: index % PATTERNS,
            ..PatternSpec::default()
        },
        ..Parameters::default()
    };
    let radius = radius_estimate(&parameters, count as u64)?;
    Ok(Parameters {
        radius,
        ..parameters
    })
}

/// Returns `count` places made from draws in the unit square.
fn draws(count: u32, seed: u64, place: impl Fn(u32, [f64; 2]) -> [f64; 2] + Sync) -> Vec<[f64; 2]> {
    // A key of its own: samplers use the seed's.
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

/// Returns the samples that the largest square of a set's region holds, on average.
fn held(set: &GivenSet) -> f64 {
    let Region { width, height, .. } = set.region;
    let side = width.min(height);
    set.points.len() as f64 * (side * side / set.region.area()).min(1.0)
}

/// Returns the side of a square that holds `count` samples on average, and how many fit along x and y. A set that lacks
/// up to a hundredth of the samples gives what it has.
fn squares(set: &GivenSet, count: usize) -> (f64, [u64; 2]) {
    let Region { width, height, .. } = set.region;
    let least = width.min(height);
    let share = count as f64 / held(set).max(1.0);
    let side = if share > 1.0 && share < 1.01 {
        least
    } else {
        least * share.sqrt()
    };
    let along = |extent: f64| (extent / side * (1.0 + 1e-9)).floor() as u64;
    (side, [along(width), along(height)])
}

fn cuts(set: &GivenSet, count: usize) -> u64 {
    let (_, [columns, rows]) = squares(set, count);
    columns * rows
}

/// Returns the samples in square number `index`, scaled to the unit square.
fn cut(set: &GivenSet, count: usize, index: u64) -> Vec<[f64; 2]> {
    let (side, [columns, _]) = squares(set, count);
    let columns = columns.max(1);
    let corner = [index % columns, index / columns].map(|cell| cell as f64 * side);
    (set.points.iter())
        .map(|point| [0, 1].map(|axis| (point[axis] - corner[axis]) / side))
        .filter(|at| at.iter().all(|v| (0.0..1.0).contains(v)))
        .collect()
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::study::tests::alone;

    /// A set of the unit square as a file would have it: other units.
    pub fn given(name: &str, points: &[[f64; 2]]) -> GivenSet {
        GivenSet {
            name: name.to_owned(),
            path: name.to_owned(),
            points: points.iter().map(|p| p.map(|v| 3.0 * v)).collect(),
            region: Region {
                width: 3.0,
                height: 3.0,
                boundary: tilescope_analysis::Boundary::Periodic,
            },
        }
    }

    #[test]
    fn jittered_samples_are_one_in_each_cell_and_random_ones_are_not() {
        alone(&Settings::default(), |control| {
            let settings = Settings::default();
            let full = |sampler: Sampler| -> Result<usize, ReproduceError> {
                let points = sampler.points((900, 0), &settings, control)?;
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
            for sampler in Sampler::MADE {
                let made = |seed, index| {
                    let settings = Settings {
                        seed,
                        ..Settings::default()
                    };
                    sampler.points((4000, index), &settings, control)
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

    #[test]
    fn files_are_cut_into_squares_as_large_as_asked() {
        let settings = Settings::default();
        alone(&settings, |control| {
            let points = Sampler::Random.points((6400, 0), &settings, control)?;
            let with = Settings {
                given: vec![given("a.csv", &points)],
                ..Settings::default()
            };
            let file = Sampler::Given(0);
            assert_eq!((file.most(&with), file.sets(1600, 9, &with)), (6400, 4));
            assert_eq!(
                (file.sets(6440, 9, &with), file.sets(6500, 9, &with)),
                (1, 0)
            );
            assert_eq!(file.points((6400, 0), &with, control)?.len(), 6400);
            let mut all = 0;
            for index in 0..4 {
                let part = file.points((1600, index), &with, control)?;
                assert!(part.len().abs_diff(1600) < 160, "{}", part.len());
                all += part.len();
            }
            assert_eq!(all, 6400);
            Ok(())
        });
    }
}
