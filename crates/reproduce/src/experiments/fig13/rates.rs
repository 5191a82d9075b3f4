//! The rounds of figure 13: every engine at every leaf size, and the patterns that the rounds generate.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use tilescope_core::{Parameters, Pattern};

use crate::control::Control;
use crate::engines::{Engine, Engines};
use crate::error::Result;
use crate::experiments::timing::{LEAVES, TimingPlan};
use crate::machine::GPUS;
use crate::rates::{EngineTime, timed, times};
use crate::sets::fitting;
use crate::study::Study;

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RateRound {
    pub timed: Vec<EngineTime>,
    /// Sides in radii of the patterns, and the seconds that making each took.
    pub patterns: Vec<(f64, f64)>,
}

/// Returns the engines of KDRT; the first one's set is verified.
fn engines() -> Vec<Engine> {
    let mut engines = vec![Engine::Parallel { threads: 1 }, Engine::Sequential];
    if rayon::current_num_threads() > 1 {
        engines.insert(1, Engine::parallel());
    }
    let name = |gpu: &tilescope_gpu::AdapterReport| gpu.name.clone();
    engines.extend(GPUS.iter().map(|gpu| Engine::Gpu { adapter: name(gpu) }));
    engines
}

fn references() -> Vec<Engine> {
    match rayon::current_num_threads() {
        1 => vec![Engine::Reference],
        threads => vec![Engine::Reference, Engine::Combined { threads }],
    }
}

pub fn run(plan: TimingPlan, study: &Study<'_>) -> Result<Vec<RateRound>> {
    plan.run(study, "rates", warm, round)
}

/// Opens the engines and makes a small set with each: the first one of a GPU compiles its passes.
fn warm(control: &Control<'_>) -> Result<Engines> {
    let open = Engines::open_all()?;
    let base = Parameters::default();
    let pattern = Arc::new(Pattern::generate(&base.pattern, &mut control.observer())?);
    for engine in references().iter().chain(&engines()) {
        open.make(engine, &base, &pattern, control)?;
    }
    Ok(open)
}

/// Makes and times the sets of a round.
fn round(base: &Parameters, open: &Engines, control: &Control<'_>) -> Result<RateRound> {
    let (mut all, mut patterns) = (Vec::new(), Vec::new());

    let mut make_pattern = |leaf: f64| -> Result<Arc<Pattern>> {
        let spec = fitting(leaf);
        let (pattern, seconds) = timed(|| Pattern::generate(&spec, &mut control.observer()));
        patterns.push((spec.side, seconds));
        Ok(Arc::new(pattern?))
    };

    let of_base = make_pattern(base.leaf)?;
    // A call of `times` verifies the set of its first engine, and expects the same set from its other engines. The
    // references make different sets, so that each has a call of its own.
    for engine in references() {
        all.extend(times(open, &[engine], base, &of_base, control)?);
    }

    for leaf in LEAVES {
        let (parameters, pattern) = (Parameters { leaf, ..*base }, make_pattern(leaf)?);
        all.extend(times(open, &engines(), &parameters, &pattern, control)?);
    }

    // Nothing is concluded from a round with a wrong set.
    for one in &all {
        one.check()?;
    }

    // Of each side the shortest time stays: within a side the order is by time, and the first entry is kept.
    patterns.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    patterns.dedup_by_key(|(side, _)| side.to_bits());

    Ok(RateRound {
        timed: all,
        patterns,
    })
}
