//! Sets on a torus by the reference sampler, judged one by one, and what each of their levels inserted.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use tilescope_analysis::{JudgeChoice, VerifyOptions};
use tilescope_core::stages::darts::{LAST_LEVEL, throws};
use tilescope_core::{Boundary, Domain, Recorder, RunEvent, reference_recorded};

use super::results::{OFF, UNFINISHED};
use super::sums::CountSums;
use crate::control::Control;
use crate::error::{ReproduceError, Result};
use crate::sets::Set;

/// Levels of the dart process: the cells of the last have sides of one unit.
pub const LEVELS: usize = LAST_LEVEL as usize + 1;

/// Counts what each level inserts.
#[derive(Default)]
struct LevelRecorder([u64; LEVELS]);

impl Recorder for LevelRecorder {
    fn record(&mut self, run_event: RunEvent) {
        if let RunEvent::IterationEnd { number, inserted } = run_event {
            // Level 0 has the first throws; from then on each level has one.
            let level = number.saturating_sub(throws(0)) as usize;
            self.0[level] += u64::from(inserted);
        }
    }
}

/// Sets on tori of one size, counted. Every one was judged by covered circles, and none was refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TorusSets {
    /// The side of the torus, in radii.
    pub side: f64,
    pub sums: CountSums,
    /// The samples that each level inserted, of all sets.
    pub by_level: [u64; LEVELS],
}

impl TorusSets {
    fn none(side: f64) -> Self {
        Self {
            side,
            sums: CountSums::default(),
            by_level: [0; LEVELS],
        }
    }

    /// Makes, judges and counts a set of each seed, on all threads: a thread holds one set at a time.
    pub fn made(side: f64, seeds: Vec<u64>, control: &Control<'_>) -> Result<Self> {
        let each = seeds.into_par_iter().map(|seed| {
            let (set, levels) = drawn(side, seed, control)?;
            let report = set.judged(&by_circles(), control)?;
            if !report.valid() {
                let what = format!("torus of {side} r, seed {seed}");
                return Err(ReproduceError::invalid(&what, &report));
            }
            Ok(Self {
                side,
                sums: CountSums::of(set.points.len()),
                by_level: levels.0,
            })
        });
        each.try_reduce(|| Self::none(side), |a, b| Ok(a.joined(&b)))
    }

    /// Returns the sets of both, on tori of one size.
    pub fn joined(&self, other: &Self) -> Self {
        let mut by_level = self.by_level;
        for (sum, more) in by_level.iter_mut().zip(other.by_level) {
            *sum += more;
        }
        Self {
            side: self.side,
            sums: self.sums.joined(other.sums),
            by_level,
        }
    }

    /// Returns the density, N r^2 / area, and its standard error.
    pub fn density(&self) -> [f64; 2] {
        let area = self.side * self.side;
        [self.sums.mean() / area, self.sums.error() / area]
    }

    /// Returns the area of all sets, in squared radii.
    pub fn area(&self) -> f64 {
        self.sums.sets as f64 * self.side * self.side
    }
}

/// Covered circles judge twice as fast as triangulations.
fn by_circles() -> VerifyOptions {
    VerifyOptions {
        judges: JudgeChoice::Circles,
        ..VerifyOptions::default()
    }
}

/// Returns the set of a seed, in the order of insertion, and what each level inserted.
fn drawn(side: f64, seed: u64, control: &Control<'_>) -> Result<(Set, LevelRecorder)> {
    let domain = Domain::from_size([side; 2], 1.0, Boundary::Periodic)?;
    let mut levels = LevelRecorder::default();
    let points = reference_recorded(domain, seed, &mut control.observer(), &mut levels)?;
    Ok((Set::of(&domain, &points), levels))
}

/// Fails if the judge accepts what it must refuse: a set under a radius that is off by a ten thousandth, to either side, or
/// one whose last levels were not made.
pub fn refuse_controls(side: f64, seed: u64, control: &Control<'_>) -> Result<()> {
    let (set, levels) = drawn(side, seed, control)?;

    let radius = |factor: f64| Set {
        radius: factor * set.radius,
        ..set.clone()
    };
    let early = levels.0[..=UNFINISHED].iter().sum::<u64>() as usize;
    let unfinished = Set {
        points: set.points[..early].to_vec(),
        ..set.clone()
    };

    let controls = [
        ("under a radius that is too large", radius(1.0 + OFF)),
        ("under a radius that is too small", radius(1.0 - OFF)),
        ("without its last levels", unfinished),
    ];
    for (what, wrong) in controls {
        if wrong.judged(&by_circles(), control)?.valid() {
            let text = format!("the judge accepts a set {what} (torus of {side} r, seed {seed})");
            return Err(ReproduceError::Engine(text));
        }
    }
    Ok(())
}
