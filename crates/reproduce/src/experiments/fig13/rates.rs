//! Rates of every engine. In each round every engine makes one set, and ratios are taken within a round, so that what
//! disturbs a round disturbs both sides. Every set is verified, or equal to one that is.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use tilescope_analysis::Report;
use tilescope_analysis::measures::Summary;
use tilescope_core::{Parameters, Pattern, PatternSpec, Point};

use crate::control::Control;
use crate::engines::{Engine, Engines};
use crate::error::ReproduceError;
use crate::experiments::timing::{LEAVES, TimingPlan, median, same, timed};
use crate::machine::gpus;
use crate::sets::{Set, pattern_side};
use crate::study::Study;

/// A set that was timed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EngineTime {
    pub name: String,
    pub leaf: Option<f64>,
    pub threads: Option<usize>,
    pub seconds: f64,
    pub count: usize,
    pub density: f64,
    /// In radii.
    pub min_distance: f64,
    pub covering_radius: f64,
}

/// A round.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RateRound {
    pub timed: Vec<EngineTime>,
    /// Sides in radii of the patterns, and the seconds that making each took.
    pub patterns: Vec<(f64, f64)>,
}

/// What tells a method from others in all rounds: name, bits of the leaf, threads.
type Key<'a> = (&'a str, Option<u64>, Option<usize>);

impl EngineTime {
    fn key(&self) -> Key<'_> {
        (&self.name, self.leaf.map(f64::to_bits), self.threads)
    }
}

impl RateRound {
    fn of(&self, key: &Key<'_>) -> Option<&EngineTime> {
        self.timed.iter().find(|one| one.key() == *key)
    }
}

/// Returns the engines of KDRT; the first one's set is verified.
fn engines() -> Vec<Engine> {
    let mut engines = vec![Engine::Parallel { all: false }, Engine::Sequential];
    if rayon::current_num_threads() > 1 {
        engines.insert(1, Engine::Parallel { all: true });
    }
    let name = |gpu: &tilescope_gpu::AdapterReport| gpu.name.clone();
    engines.extend(gpus().iter().map(|gpu| Engine::Gpu { adapter: name(gpu) }));
    engines
}

fn references() -> Vec<Engine> {
    match rayon::current_num_threads() {
        1 => vec![Engine::Reference],
        _ => vec![Engine::Reference, Engine::Combined],
    }
}

/// Carries out all rounds.
pub fn run(plan: TimingPlan, study: &Study<'_>) -> Result<Vec<RateRound>, ReproduceError> {
    plan.run(study, "rates", warm, round)
}

/// Opens the engines and makes a small set with each: the first one of a GPU compiles its passes.
fn warm(control: &Control<'_>) -> Result<Engines, ReproduceError> {
    let open = Engines::open()?;
    let base = Parameters::default();
    let pattern = Arc::new(Pattern::generate(&base.pattern, &mut control.observer())?);
    for engine in references().iter().chain(&engines()) {
        open.make(engine, &base, &pattern, control)?;
    }
    Ok(open)
}

fn round(
    base: &Parameters,
    open: &Engines,
    control: &Control<'_>,
) -> Result<RateRound, ReproduceError> {
    let (mut all, mut patterns) = (Vec::new(), Vec::new());
    let mut pattern = |leaf: f64| -> Result<Arc<Pattern>, ReproduceError> {
        let side = pattern_side(leaf);
        let spec = PatternSpec {
            side,
            ..PatternSpec::default()
        };
        let (pattern, seconds) = timed(|| Pattern::generate(&spec, &mut control.observer()));
        patterns.push((side, seconds));
        Ok(Arc::new(pattern?))
    };
    let of_base = pattern(base.leaf)?;
    for engine in references() {
        all.extend(times(open, &[engine], base, &of_base, control)?);
    }
    for leaf in LEAVES {
        let (parameters, pattern) = (Parameters { leaf, ..*base }, pattern(leaf)?);
        all.extend(times(open, &engines(), &parameters, &pattern, control)?);
    }
    patterns.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    patterns.dedup_by_key(|(side, _)| side.to_bits());
    Ok(RateRound {
        timed: all,
        patterns,
    })
}

/// Makes the same set with each engine; the first one's is verified, and the others must be equal to it.
fn times(
    open: &Engines,
    engines: &[Engine],
    parameters: &Parameters,
    pattern: &Arc<Pattern>,
    control: &Control<'_>,
) -> Result<Vec<EngineTime>, ReproduceError> {
    let mut first: Option<(Vec<Point>, Report)> = None;
    let mut all = Vec::new();
    for engine in engines {
        let name = engine.name();
        let (points, seconds) = timed(|| open.make(engine, parameters, pattern, control));
        let points = points?;
        let (_, report) = match &mut first {
            Some(verified) => {
                same(&name, &points, &verified.0)?;
                verified
            }
            none => {
                let set = Set::of(&parameters.validate()?, &points);
                let report = set.verified(&name, control)?;
                none.insert((points, report))
            }
        };
        let from_scratch = matches!(engine, Engine::Reference | Engine::Combined);
        all.push(EngineTime {
            name,
            leaf: (!from_scratch).then_some(parameters.leaf),
            threads: engine.threads(),
            seconds,
            count: report.count,
            density: report.density,
            min_distance: report.min_distance / report.radius,
            covering_radius: report.covering_radius / report.radius,
        });
    }
    Ok(all)
}

/// A method over all rounds.
#[derive(Clone, Debug)]
pub struct EngineRate {
    pub name: String,
    pub leaf: Option<f64>,
    pub threads: Option<usize>,
    pub count: f64,
    /// Samples a second.
    pub rate: Summary,
    /// Rate over that of the first method, the reference sampler on one thread.
    pub ratio: Summary,
    pub density: f64,
    pub min_distance: f64,
    pub covering_radius: f64,
}

/// Returns the methods' rows in the sequence in which the rounds have them. Rounds may have been kept from machines with other threads
/// and GPUs: a row is of the rounds that have it.
pub fn rows(rounds: &[RateRound]) -> Vec<EngineRate> {
    let mut keys: Vec<Key<'_>> = Vec::new();
    for key in rounds
        .iter()
        .flat_map(|round| &round.timed)
        .map(EngineTime::key)
    {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    // Every round begins with the reference sampler on one thread.
    let Some(first) = keys.first() else {
        return Vec::new();
    };
    keys.iter()
        .filter_map(|key| row(rounds, key, first))
        .collect()
}

fn row(rounds: &[RateRound], key: &Key<'_>, first: &Key<'_>) -> Option<EngineRate> {
    let of: Vec<&EngineTime> = rounds.iter().filter_map(|round| round.of(key)).collect();
    let rate = |one: &EngineTime| one.count as f64 / one.seconds;
    let ratios = rounds
        .iter()
        .filter_map(|round| Some(rate(round.of(key)?) / rate(round.of(first)?)));
    let median = |value: fn(&EngineTime) -> f64| median(of.iter().map(|one| value(one)));
    let least = of.iter().map(|one| one.min_distance);
    let most = of.iter().map(|one| one.covering_radius);
    let one = of.first()?;
    Some(EngineRate {
        name: one.name.clone(),
        leaf: one.leaf,
        threads: one.threads,
        count: median(|one| one.count as f64)?,
        rate: Summary::of(of.iter().map(|one| rate(one)))?,
        ratio: Summary::of(ratios)?,
        density: median(|one| one.density)?,
        min_distance: least.fold(f64::INFINITY, f64::min),
        covering_radius: most.fold(0.0, f64::max),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    pub fn timed(name: &str, leaf: Option<f64>, seconds: f64) -> EngineTime {
        EngineTime {
            name: name.to_owned(),
            leaf,
            threads: Some(1),
            seconds,
            count: 1000,
            density: 0.7,
            min_distance: 1.0,
            covering_radius: 1.0,
        }
    }

    #[test]
    fn ratios_are_taken_within_a_round() {
        // The second round was disturbed: both took ten times as long.
        let round = |slow: f64| RateRound {
            timed: vec![timed("a", None, 4.0 * slow), timed("b", Some(20.0), slow)],
            patterns: Vec::new(),
        };
        let rows = rows(&[round(1.0), round(10.0), round(1.0)]);
        assert_eq!(rows.len(), 2);
        assert!((rows[1].ratio.least - 4.0).abs() < 1e-12);
        assert!((rows[1].ratio.most - 4.0).abs() < 1e-12);
        assert!((rows[1].rate.quartiles[1] - 1000.0).abs() < 1e-9);
        assert!((rows[1].rate.least - 100.0).abs() < 1e-9);
        assert!((rows[0].ratio.mean - 1.0).abs() < 1e-12);
    }

    #[test]
    fn rounds_of_other_threads_and_gpus_do_not_mix_methods() {
        let round = |timed: Vec<EngineTime>| RateRound {
            timed,
            patterns: Vec::new(),
        };
        let all = |seconds: f64| EngineTime {
            threads: Some(8),
            ..timed("b", Some(20.0), seconds)
        };
        let reference = || timed("a", None, 8.0);
        let rows = rows(&[
            round(vec![reference(), timed("b", Some(20.0), 4.0)]),
            round(vec![
                reference(),
                all(1.0),
                timed("b", Some(20.0), 4.0),
                timed("b", Some(40.0), 2.0),
            ]),
        ]);
        let found: Vec<(Option<usize>, usize, f64)> = rows
            .iter()
            .map(|row| (row.threads, row.rate.count, row.ratio.mean))
            .collect();
        let expected = [
            (Some(1), 2, 1.0),
            (Some(1), 2, 2.0),
            (Some(8), 1, 8.0),
            (Some(1), 1, 4.0),
        ];
        assert_eq!(found, expected);
        // Places in the list would have given the second row eight times the reference in one round.
        assert!((rows[1].ratio.most - 2.0).abs() < 1e-12);
    }
}
