//! Rates of engines, for experiments and for `tilescope bench`. In each round every engine makes one set, and ratios
//! are taken within a round, so that a disturbance affects both sides. Every set is verified, or equal to one that
//! is.

mod bench;
mod gpu;

use std::sync::Arc;
use std::time::Instant;

use serde::{Deserialize, Serialize};
use tilescope_analysis::Report;
use tilescope_analysis::measures::Summary;
use tilescope_core::{Parameters, Pattern, Point, radius_estimate};

use crate::control::Control;
use crate::engines::Engines;
use crate::error::{ReproduceError, Result};
use crate::sets::Set;

pub use crate::engines::Engine;
pub use bench::{Bench, CpuRates, WindowTimes};
pub(crate) use gpu::run_timed;
pub use gpu::{ExactGpuRates, GpuRates, GpuRun, PassTimes};

/// The leaf size in radii where one is enough.
pub(crate) const ONE_LEAF: f64 = 40.0;

/// A set whose making was timed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EngineTime {
    /// The engine that made it.
    pub engine: Engine,
    /// Leaf size in radii; `None` for sets made from scratch.
    pub leaf: Option<f64>,
    /// Seconds of making it.
    pub seconds: f64,
    /// Seconds of verifying it, or the set that it equals.
    pub verify_seconds: f64,
    /// Whether it equals the first engine's set with these parameters.
    pub equal: bool,
    /// The report of the verifier.
    pub report: Report,
}

/// Identifies a method in all rounds: the engine, and the bits of the leaf size.
type Key<'a> = (&'a Engine, Option<u64>);

impl EngineTime {
    fn key(&self) -> Key<'_> {
        (&self.engine, self.leaf.map(f64::to_bits))
    }

    fn rate(&self) -> f64 {
        self.report.count as f64 / self.seconds
    }

    /// Fails unless the set is valid and equal to the first engine's.
    pub(crate) fn check(&self) -> Result<()> {
        let what = self.engine.name();
        if !self.equal {
            return Err(other_set(&what));
        }
        if !self.report.valid() {
            return Err(ReproduceError::invalid(&what, &self.report));
        }
        Ok(())
    }
}

/// The error of an engine whose set is not the one that was verified.
pub(crate) fn other_set(name: &str) -> ReproduceError {
    ReproduceError::Engine(format!("{name} made another set than the engine before it"))
}

/// Returns the parameters of a timed set of about the given number of samples.
pub(crate) fn sized(samples: u64, seed: u64) -> Result<Parameters> {
    let base = Parameters {
        leaf: ONE_LEAF,
        seed,
        ..Parameters::default()
    };
    let radius = radius_estimate(&base, samples)?;
    Ok(Parameters { radius, ..base })
}

/// Returns a result and the seconds that it took.
pub(crate) fn timed<T>(make: impl FnOnce() -> T) -> (T, f64) {
    let began = Instant::now();
    let made = make();
    (made, began.elapsed().as_secs_f64())
}

/// Returns the median of values, or `None` if there are none.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    Summary::of(values).map(|summary| summary.quartiles[1])
}

/// Makes the same set with each engine, and returns their times in this order. Verifies the first one's set, and every other
/// that differs from it.
pub(crate) fn times(
    open: &Engines,
    engines: &[Engine],
    parameters: &Parameters,
    pattern: &Arc<Pattern>,
    control: &Control<'_>,
) -> Result<Vec<EngineTime>> {
    let domain = parameters.validate()?;
    // The first engine's set, its report, and the seconds that its verification took.
    let mut first: Option<(Vec<Point>, Report, f64)> = None;
    let mut all = Vec::new();

    for engine in engines {
        let (made, seconds) = timed(|| open.make(engine, parameters, pattern, control));
        let points = made?;

        // A set that equals the verified one has its report. The first set counts as equal to itself.
        let known = first.as_ref().filter(|(verified, ..)| *verified == points);
        let equal = first.is_none() || known.is_some();

        let (report, verify_seconds) = if let Some((_, report, seconds)) = known {
            (report.clone(), *seconds)
        } else {
            let set = Set::of(&domain, &points);
            let (report, seconds) = timed(|| set.judge(control));
            (report?, seconds)
        };

        first.get_or_insert_with(|| (points, report.clone(), verify_seconds));
        all.push(EngineTime {
            engine: engine.clone(),
            leaf: engine.tiles().then_some(parameters.leaf),
            seconds,
            verify_seconds,
            equal,
            report,
        });
    }

    Ok(all)
}

/// A method over all rounds.
#[derive(Clone, Debug)]
pub struct EngineRate {
    /// The engine that made its sets.
    pub engine: Engine,
    /// Leaf size in radii; `None` for sets made from scratch.
    pub leaf: Option<f64>,
    /// Its sets, one a round.
    pub times: Vec<EngineTime>,
    /// Median number of samples.
    pub count: f64,
    /// Samples made a second.
    pub rate: Summary,
    /// Median of the samples verified a second.
    pub verify_rate: f64,
    /// Rate over that of the baseline in the same round.
    pub ratio: Summary,
    /// Median rate over that of one thread in the same round: for an engine on several threads over its own, for exact tiling
    /// on one thread over that of the parallel engine of KDRT.
    pub thread_ratio: Option<f64>,
    /// Median of `N r^2 / area`.
    pub density: f64,
    /// The smallest distance of any set, in radii.
    pub min_distance: f64,
    /// The largest covering radius of any set, in radii.
    pub covering_radius: f64,
}

impl EngineRate {
    /// Returns whether all its sets equal the first engine's with the same parameters.
    #[must_use]
    pub fn equal(&self) -> bool {
        self.times.iter().all(|one| one.equal)
    }

    /// Returns whether all its sets are valid.
    #[must_use]
    pub fn valid(&self) -> bool {
        self.times.iter().all(|one| one.report.valid())
    }
}

/// Returns values in the sequence of their first, each once.
pub(crate) fn distinct<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<T> {
    let mut distinct = Vec::new();
    for value in values {
        if !distinct.contains(&value) {
            distinct.push(value);
        }
    }
    distinct
}

/// Returns the methods' rows in the sequence in which the rounds have them. The baseline is `baseline` with the same
/// leaf size, or the first method of all. A row is of the rounds that have it.
pub(crate) fn rows(rounds: &[&[EngineTime]], baseline: Option<&Engine>) -> Vec<EngineRate> {
    let keys = distinct(rounds.iter().copied().flatten().map(EngineTime::key));
    let row_of = |key: &Key<'_>| row(rounds, key, baseline.map_or(keys[0], |one| (one, key.1)));
    keys.iter().filter_map(row_of).collect()
}

/// Returns the row of the method `key`; `None` if no round has it together with the baseline.
fn row(rounds: &[&[EngineTime]], key: &Key<'_>, baseline: Key<'_>) -> Option<EngineRate> {
    let find = |round: &&[EngineTime], key: Key<'_>| {
        let one = round.iter().find(|one| one.key() == key);
        one.cloned()
    };

    let times: Vec<EngineTime> = rounds
        .iter()
        .filter_map(|round| find(round, *key))
        .collect();

    // Both rates are of one round, so that what disturbs the round disturbs both.
    let ratio_to = |other: Key<'_>| {
        let in_round = |round| Some(find(round, *key)?.rate() / find(round, other)?.rate());
        Summary::of(rounds.iter().filter_map(in_round))
    };

    // The second of the three quartiles is the median.
    let summary_of = |value: fn(&EngineTime) -> f64| Summary::of(times.iter().map(value));
    let median_of = |value| summary_of(value).map(|summary| summary.quartiles[1]);

    // For several threads the ratio to one thread shows what the other threads gain. For exact tiling on one thread the ratio
    // compares the two methods.
    let kdrt = Engine::Parallel { threads: 1 };
    let compared_with = match key.0 {
        Engine::Parallel { threads } if *threads > 1 => Some(&kdrt),
        Engine::ExactParallel { threads } if *threads > 1 => Some(&Engine::Exact),
        Engine::Exact => Some(&kdrt),
        Engine::Parallel { .. }
        | Engine::ExactParallel { .. }
        | Engine::Reference
        | Engine::Combined { .. }
        | Engine::Sequential
        | Engine::Gpu { .. }
        | Engine::ExactGpu { .. } => None,
    };

    Some(EngineRate {
        engine: key.0.clone(),
        leaf: times.first()?.leaf,
        count: median_of(|one| one.report.count as f64)?,
        rate: summary_of(EngineTime::rate)?,
        verify_rate: median_of(|one| one.report.count as f64 / one.verify_seconds)?,
        ratio: ratio_to(baseline)?,
        thread_ratio: compared_with
            .and_then(|other| ratio_to((other, key.1)))
            .map(|ratio| ratio.quartiles[1]),
        density: median_of(|one| one.report.density)?,
        // The worst of all sets, since each of them has to be valid.
        min_distance: summary_of(|one| one.report.min_distance / one.report.radius)?.least,
        covering_radius: summary_of(|one| one.report.covering_radius / one.report.radius)?.most,
        times,
    })
}

#[cfg(test)]
pub(crate) mod tests;
