//! Sets of balls in a periodic cube, as `tilescope sample` makes them, and two kinds of sets that are not maximal;
//! the measures of each. Lengths are in radii.

use serde::{Deserialize, Serialize};
use tilescope_analysis::{
    SolidCorrelation, SolidRegion, SolidSpectrum, VerifyOptions, disks_in_planes, measure_solid,
};
use tilescope_core::{Boundary, Key, Stream};
use tilescope_sets::{BallSize, SolidRecipe};

use crate::control::Control;
use crate::error::{ReproduceError, Result};

/// A stopped set has this many of so many samples: the second number is the whole.
pub const STOPPED: (usize, usize) = (98, 100);
/// Planes across each axis on which disks are counted. In the smallest cubes, of 12 r, they are 3 r apart: a ball of
/// radius r meets one of them at most.
pub const PLANES: usize = 4;
/// Bins of g(r) to an r.
pub const BINS_IN_R: usize = 20;
/// Pairs are counted up to this distance: past the second peak of g(r), which lies near 2 r.
const FARTHEST_PAIR: f64 = 2.5;

/// How the samples of a set are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BallKind {
    /// By dart throwing until nothing is left to fill.
    Maximal,
    /// By the same process, which is stopped early.
    Stopped,
    /// Independent of each other and evenly distributed, in the number of a maximal set's samples.
    Scattered,
}

impl BallKind {
    /// Returns its name for readers.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Maximal => "maximal sets",
            Self::Stopped => "stopped sets",
            Self::Scattered => "scattered sets",
        }
    }

    /// Makes the set of a seed in a periodic cube and has it judged, by cubes and by covered circles. Fails if a
    /// maximal set is refused.
    pub fn made(self, side: f64, seed: u64, control: &Control<'_>) -> Result<Balls> {
        let recipe = SolidRecipe {
            size: [side; 3],
            boundary: Boundary::Periodic,
            seed,
            balls: BallSize::Radius(1.0),
        };
        let made = recipe.make(&mut control.observer())?;
        let region = made.region();
        let points = match self {
            Self::Maximal => made.points,
            // Samples lie in the order of their arrival.
            Self::Stopped => {
                let (part, whole) = STOPPED;
                made.points[..made.points.len() * part / whole].to_vec()
            }
            Self::Scattered => scattered(made.points.len(), side, seed),
        };

        let options = VerifyOptions::default();
        let is_prefix = false;
        let verdict = measure_solid(
            &points,
            region,
            1.0,
            is_prefix,
            &options,
            &control.analysis(),
        )?;
        let report = &verdict.report;
        if self == Self::Maximal && !verdict.valid() {
            return Err(ReproduceError::Invalid {
                what: format!("cube of {side} r, seed {seed}"),
                conflicts: report.conflicts,
                gaps: report.gaps,
            });
        }

        Ok(Balls {
            least_distance: report.min_distance,
            farthest_place: verdict.covering_radius,
            judges: report.judges.len(),
            points,
            region,
        })
    }
}

/// Returns independent places of a cube.
fn scattered(count: usize, side: f64, seed: u64) -> Vec<[f64; 3]> {
    let unit = |word: u32| f64::from(word) / (f64::from(u32::MAX) + 1.0);
    let place = |index: u32| {
        // Each axis has a key of its own, which differs from that of the seed: the sampler uses that one.
        [0, 1, 2].map(|axis| {
            let key = Key::from_seed(seed).derive(Stream::Pattern, axis);
            let [word, _] = key.draw(Stream::Dart, index);
            side * unit(word)
        })
    };
    (0..count as u32).map(place).collect()
}

/// A set that was made and judged.
pub struct Balls {
    points: Vec<[f64; 3]>,
    region: SolidRegion,
    least_distance: f64,
    farthest_place: f64,
    judges: usize,
}

/// A shell of frequencies, as [`SolidSpectrum`] has it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct ShellPower {
    /// The mean magnitude of its frequencies, times the cube root of the volume of a sample.
    pub nu: f64,
    pub frequencies: usize,
    pub power: f64,
}

/// The measures of a set. The set itself is not kept.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MeasuredBalls {
    pub side: f64,
    pub samples: usize,
    /// The smallest distance of two samples.
    pub least_distance: f64,
    /// The largest distance from a place to its nearest sample.
    pub farthest_place: f64,
    /// How many judges gave the verdict: covered circles decline sets with conflicts.
    pub judges: usize,
    /// Balls of radius r that a plane meets, for each r² of it, the mean of planes across all axes.
    pub disks: f64,
    /// g of each bin of a twentieth of r, from 0 on.
    pub pairs: Vec<f64>,
    /// The power by shells, of whole cycles along a side from one on; empty if it was not measured.
    pub shells: Vec<ShellPower>,
}

impl MeasuredBalls {
    /// Returns N r³ / volume.
    pub fn density(&self) -> f64 {
        self.samples as f64 / self.side.powi(3)
    }
}

impl Balls {
    /// Returns the measures of every set: all but the spectrum.
    pub fn measured(&self, control: &Control<'_>) -> Result<MeasuredBalls> {
        let bins = (FARTHEST_PAIR * BINS_IN_R as f64).round() as usize;
        let correlation = SolidCorrelation::of(
            &self.points,
            self.region,
            FARTHEST_PAIR,
            bins,
            &control.analysis(),
        )?;
        Ok(MeasuredBalls {
            side: self.region.width,
            samples: self.points.len(),
            least_distance: self.least_distance,
            farthest_place: self.farthest_place,
            judges: self.judges,
            disks: self.disks(),
            pairs: correlation.g,
            shells: Vec::new(),
        })
    }

    /// Returns the same with the power by frequency.
    pub fn with_spectrum(&self, control: &Control<'_>) -> Result<MeasuredBalls> {
        let (points, region) = (&self.points, self.region);
        // A shell is as wide as one cycle along a side. Means over sets are taken shell by shell, so that all sets of
        // one side need the same number of shells. The number of cycles therefore follows from the side alone.
        let last_cycle =
            (SolidSpectrum::USUAL * tilescope_core::SOLID_DENSITY.cbrt() * region.width).floor();
        // The unit of frequency depends on the number of samples. Half a cycle more keeps rounding from losing a shell.
        let cycles_in_unit = (points.len() as f64).cbrt();
        let most = (last_cycle + 0.5) / cycles_in_unit;
        let spectrum = SolidSpectrum::of(points, region, most, &control.analysis())?;

        let shells = spectrum.shells.iter().map(|shell| ShellPower {
            nu: shell.nu,
            frequencies: shell.count,
            power: shell.power,
        });
        Ok(MeasuredBalls {
            shells: shells.collect(),
            ..self.measured(control)?
        })
    }

    /// Returns how many balls of radius r a plane meets, for each r² of it.
    fn disks(&self) -> f64 {
        let of_planes = disks_in_planes(&self.points, self.region, 1.0, PLANES);
        of_planes.map_or(f64::NAN, |all| all.mean)
    }
}
