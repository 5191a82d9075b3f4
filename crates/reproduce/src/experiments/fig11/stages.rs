//! The time of each stage of a run. Every leaf size has its turn in each round.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use serde::{Deserialize, Serialize};
use tilescope_core::{
    Parameters, Pattern, Point, Progress, Sequential, Stage, Summary, Variant, radius_estimate,
};
use tilescope_gpu::PassReport;

use crate::control::Control;
use crate::engines::{Engine, Engines};
use crate::error::Result;
use crate::experiments::timing::{LEAVES, TimingPlan};
use crate::machine::GPUS;
use crate::rates::{ONE_LEAF, PassTimes, other_set, run_timed, timed};
use crate::sets::{Set, fitting, pattern};
use crate::study::Study;

/// The algorithm as printed is timed with fewer samples, by this factor: it takes about twenty times as long for each.
const FEWER: u64 = 10;

/// A procedure of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Procedure {
    Blocks,
    Tile,
    Eliminate,
    /// Elimination with the first insertion in one loop.
    Both,
    /// An iteration of detection and insertion.
    Iterate(u32),
    /// The last detection, which finds no gap.
    Check,
    /// The result in canonical order.
    Finish,
}

impl Procedure {
    pub fn name(self) -> String {
        match self {
            Self::Blocks => "blocks".to_owned(),
            Self::Tile => "clip and tile".to_owned(),
            Self::Eliminate => "eliminate".to_owned(),
            Self::Both => "eliminate and insert, first loop".to_owned(),
            Self::Iterate(k) => format!("detect and insert, iteration {k}"),
            Self::Check => "last detection".to_owned(),
            Self::Finish => "canonical order".to_owned(),
        }
    }

    /// Whether it is a part of elimination and first insertion.
    pub const fn is_first(self) -> bool {
        matches!(self, Self::Eliminate | Self::Both | Self::Iterate(1))
    }
}

/// A run whose stages were timed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StageTimes {
    pub leaf: f64,
    /// Whether it was Algorithm 4 as printed.
    pub printed: bool,
    pub seconds: Vec<(Procedure, f64)>,
    pub summary: Summary,
    /// Gap detectors of each iteration.
    pub detectors: Vec<usize>,
    /// Seconds of the parallel engine on all threads for the same set, which has one stage; none for the algorithm as
    /// printed.
    pub parallel: Option<f64>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StageRound {
    pub timed: Vec<StageTimes>,
    /// Passes of each stage of a GPU, by its name.
    pub passes: Vec<(String, PassTimes)>,
}

/// Carries out the rounds: in each the stages for every leaf size, the algorithm as printed, and the passes of every GPU.
pub fn run(plan: TimingPlan, study: &Study<'_>) -> Result<Vec<StageRound>> {
    let fewer = plan.samples / FEWER;
    plan.run(
        study,
        "stages",
        |_| Engines::open_all(),
        |base, engines, control| {
            let mut timed = Vec::new();
            for leaf in LEAVES {
                timed.push(staged(&Parameters { leaf, ..*base }, engines, control)?);
            }

            let printed = Parameters {
                variant: Variant::AsPrinted,
                // A larger radius gives the smaller number of samples.
                radius: radius_estimate(base, fewer)?,
                ..*base
            };

            // The printed parameters and the base ones, which the GPUs take, have this leaf size.
            let of_one_leaf = pattern(&fitting(ONE_LEAF), control)?;
            let (times, _) = verified(&printed, &of_one_leaf, control)?;
            timed.push(times);

            let mut passes = Vec::new();
            for gpu in GPUS.iter() {
                let open = engines.gpu(&gpu.name)?;
                // All passes of a stage are one row, whatever their names.
                let by_stage = |report: &PassReport| [report.stage.to_string(), String::new()];
                let made = run_timed(&open, base, &of_one_leaf, control, by_stage)?;
                passes.extend(made.passes.into_iter().map(|one| (gpu.name.clone(), one)));
            }

            Ok(StageRound { timed, passes })
        },
    )
}

/// Times the sequential engine's stages and the parallel engine for the same set.
fn staged(parameters: &Parameters, engines: &Engines, control: &Control<'_>) -> Result<StageTimes> {
    let pattern = pattern(&fitting(parameters.leaf), control)?;
    let (times, points) = verified(parameters, &pattern, control)?;
    let all = Engine::parallel();
    let (made, seconds) = timed(|| engines.make(&all, parameters, &pattern, control));
    if made? != points {
        return Err(other_set(&all.name()));
    }
    Ok(StageTimes {
        parallel: Some(seconds),
        ..times
    })
}

/// Times the stages of a run and verifies its set.
fn verified(
    parameters: &Parameters,
    pattern: &Arc<Pattern>,
    control: &Control<'_>,
) -> Result<(StageTimes, Vec<Point>)> {
    let printed = parameters.variant == Variant::AsPrinted;
    let mut engine = Sequential::new(parameters, Arc::clone(pattern))?;
    let mut seconds = Vec::new();

    loop {
        let began = Instant::now();
        // The last step looks for gaps, finds none, and then finishes the set. The observer notes when finishing
        // begins, so that the time of each of these two parts is known.
        let mut finishing = None;
        let mut observer = |progress: Progress| -> ControlFlow<()> {
            if progress.stage == Stage::Finish {
                finishing.get_or_insert_with(Instant::now);
            }
            control.flow()
        };

        let Some(stage) = engine.step(&mut observer)? else {
            break;
        };
        let ended = Instant::now();
        let checked = finishing.unwrap_or(ended);

        // A step ends with preparing the next one, which counts for the stage of the step.
        let of = procedure(stage, printed);
        if of == Procedure::Finish {
            seconds.push((Procedure::Check, (checked - began).as_secs_f64()));
            seconds.push((Procedure::Finish, (ended - checked).as_secs_f64()));
        } else {
            seconds.push((of, (ended - began).as_secs_f64()));
        }
    }

    let run = engine.run();
    let points = run.points();
    // The set is verified after all stages, so that this counts for none of them.
    let name = format!("leaf {} r", parameters.leaf);
    Set::of(&run.domain, &points).verified(&name, control)?;

    let detectors = run.iterations.iter().map(|one| one.detectors.len());
    let timed = StageTimes {
        leaf: parameters.leaf,
        printed,
        seconds,
        summary: run.summary(),
        detectors: detectors.collect(),
        parallel: None,
    };

    Ok((timed, points))
}

/// Returns what a stage of the sequential engine is called here. That engine has neither the stage of patterns, which
/// are made before, nor that of regions, which the parallel engine has.
const fn procedure(stage: Stage, printed: bool) -> Procedure {
    match stage {
        Stage::Pattern | Stage::Blocks => Procedure::Blocks,
        Stage::Tile => Procedure::Tile,
        Stage::Eliminate if printed => Procedure::Both,
        Stage::Eliminate => Procedure::Eliminate,
        Stage::Iterate(k) => Procedure::Iterate(k),
        Stage::Regions | Stage::Finish => Procedure::Finish,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Settings;
    use crate::study::tests::alone;

    #[test]
    fn every_stage_of_a_run_is_timed_once_and_as_printed_the_first_insertion_has_no_stage() {
        alone(&Settings::default(), |control| {
            let parameters = Parameters {
                radius: 0.01,
                leaf: 20.0,
                ..Parameters::default()
            };
            let pattern = Pattern::of_spec(&parameters.pattern, &mut control.observer())?;
            let (staged, _) = verified(&parameters, &pattern, control)?;
            let of =
                |timed: &StageTimes| timed.seconds.iter().map(|(of, _)| *of).collect::<Vec<_>>();
            let mut expected = vec![Procedure::Blocks, Procedure::Tile, Procedure::Eliminate];
            let iterations = staged.summary.inserted.len() as u32;
            expected.extend((1..=iterations).map(Procedure::Iterate));
            expected.extend([Procedure::Check, Procedure::Finish]);
            assert_eq!(of(&staged), expected);
            let printed = Parameters {
                variant: Variant::AsPrinted,
                ..parameters
            };
            let (printed, _) = verified(&printed, &pattern, control)?;
            assert!(of(&printed).contains(&Procedure::Both));
            assert!(!of(&printed).contains(&Procedure::Iterate(1)));
            Ok(())
        });
    }
}
