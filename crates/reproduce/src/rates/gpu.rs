//! A GPU against all threads, and the time of each of its passes.

use std::sync::Arc;

use pollster::block_on;
use serde::{Deserialize, Serialize};
use tilescope_core::{Parameters, Pattern, PatternArrivals, PatternHistory, PatternSpec, Stage};
use tilescope_gpu::{Gpu, GpuError, GpuSweep, Options, PassReport};

use super::{Bench, EngineRate, EngineTime, rows, timed};
use crate::control::{Control, Watch};
use crate::engines::{Engine, Engines};
use crate::error::{ReproduceError, Result};

/// Bytes copied at a time to measure the speed of the device's memory, and how often: long enough that the start does
/// not matter.
const COPIED: u64 = 64 << 20;
const COPIES: u32 = 32;

/// The time of the passes of one name in one stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PassTimes {
    /// The name of the stage.
    pub stage: String,
    /// The name of the passes.
    pub name: String,
    /// How many passes there were.
    pub times: usize,
    /// The least bytes that they move, where all of them visit all elements.
    pub bytes: Option<u64>,
    /// Seconds on the device, where it measures them.
    pub seconds: Option<f64>,
}

/// A run on a GPU, pass by pass.
#[derive(Clone, Debug)]
pub struct GpuRun {
    /// Times of its passes, in the sequence of the first of each name.
    pub passes: Vec<PassTimes>,
    /// Samples of the set.
    pub samples: usize,
    /// Peak size of its buffers, in bytes.
    pub held_bytes: u64,
}

/// Rates of a GPU.
#[derive(Clone, Debug)]
pub struct GpuRates {
    /// The parallel engine on all threads and the GPU, by turns, for each leaf size; the parallel engine is the
    /// baseline.
    pub rows: Vec<EngineRate>,
    /// Exact tiling on all threads and on the GPU, likewise; that on all threads is the baseline.
    pub exact: ExactGpuRates,
    /// Seconds of the first run, which compiles the passes.
    pub first_seconds: f64,
    /// A run with timed passes.
    pub run: GpuRun,
    /// Bytes a second that the device copies, read and written.
    pub copy_rate: f64,
}

/// Rates of exact tiling on a GPU.
#[derive(Clone, Debug)]
pub enum ExactGpuRates {
    /// The rows of each leaf size.
    Measured(Vec<EngineRate>),
    /// The GPU makes an exact tiling in one go, and one of so many samples does not fit it: why, in words.
    TooLarge(String),
}

impl ExactGpuRates {
    /// Returns the rows; none of a tiling that does not fit.
    #[must_use]
    pub fn rows(&self) -> &[EngineRate] {
        match self {
            Self::Measured(rows) => rows,
            Self::TooLarge(_) => &[],
        }
    }
}

impl Bench {
    /// Times a GPU against the parallel engine on all threads, a run pass by pass, and copies in the device's memory.
    pub fn gpu(&self, gpu: &Arc<Gpu>, watch: &dyn Watch) -> Result<GpuRates> {
        let base = self.base()?;
        let units_done = 0;
        let control = Control::new(watch, units_done, "the first run".to_owned());
        let pattern = Pattern::of_spec(&base.pattern, &mut control.observer())?;

        // The parallel engine runs on all threads, for which no pool has to be opened.
        let open = Engines::open(&[], vec![Arc::clone(gpu)])?;
        let adapter = || gpu.report().name.clone();
        let engines = [Engine::parallel(), Engine::Gpu { adapter: adapter() }];

        // The first run compiles the passes. Its time is reported by itself, and its set is not needed. Where no leaf
        // is asked for, it has the default one.
        let leaf = *self.leaves.first().unwrap_or(&base.leaf);
        let first = Parameters { leaf, ..base };
        let (set, first_seconds) = timed(|| open.make(&engines[1], &first, &pattern, &control));
        drop(set?);

        // Exact tiling has a pattern of its own. Its first run, which compiles its passes, finds out whether it fits.
        let exact = [
            Engine::exact_parallel(),
            Engine::ExactGpu { adapter: adapter() },
        ];
        let of_exact = PatternSpec::for_exact(self.samples as f64, self.seed);
        let arrivals = PatternArrivals::of_spec(&of_exact, &mut control.observer())?;
        let mut open = open.with_arrivals(arrivals);
        let why_too_large = match open.make(&exact[1], &self.most_seams(base), &pattern, &control) {
            Ok(_) => None,
            Err(error) => Some(too_large(error)?),
        };
        if why_too_large.is_none() {
            // The CPU's engine also needs tables. They take longer to make, and are only needed if the tiling fits the
            // GPU.
            let history = PatternHistory::of_spec(&of_exact, &mut control.observer())?;
            open = open.with_history(history);
        }

        // No set is made from scratch: the baseline is the parallel engine, which has leaves as the GPU has.
        let once: &[&[Engine]] = &[];
        let both: &[&[Engine]] = &[&engines, &exact];
        // A tiling that does not fit is not tried again.
        let by_leaf = &both[..if why_too_large.is_none() { 2 } else { 1 }];
        let times = self.rounds(&open, once, by_leaf, &base, &pattern, watch)?;
        // Each of the two methods has a baseline of its own.
        let rates_of = |engines| rows_of(&times, engines);

        let run = run_timed(gpu, &first, &pattern, &control, |report| {
            // Passes of all iterations are added up.
            let stage = match report.stage {
                Stage::Iterate(_) => "iterate".to_owned(),
                stage => stage.to_string(),
            };
            [stage, report.name.to_owned()]
        })?;

        Ok(GpuRates {
            rows: rates_of(&engines),
            exact: match why_too_large {
                None => ExactGpuRates::Measured(rates_of(&exact)),
                Some(why) => ExactGpuRates::TooLarge(why),
            },
            first_seconds,
            run,
            copy_rate: copy_rate(gpu)?,
        })
    }

    /// Returns the parameters of the smallest leaf.
    fn most_seams(&self, base: Parameters) -> Parameters {
        // An exact tiling with more seams has more pieces and takes more memory. If this one fits a GPU, those of all leaves do.
        let smallest = self.leaves.iter().copied().reduce(f64::min);
        Parameters {
            leaf: smallest.unwrap_or(base.leaf),
            ..base
        }
    }
}

/// Returns the rows of a method's two engines, the first of which is the baseline.
fn rows_of(times: &[Vec<EngineTime>], engines: &[Engine; 2]) -> Vec<EngineRate> {
    let of_round = |round: &Vec<EngineTime>| -> Vec<EngineTime> {
        let own = round.iter().filter(|one| engines.contains(&one.engine));
        own.cloned().collect()
    };
    let rounds: Vec<Vec<EngineTime>> = times.iter().map(of_round).collect();
    let rounds: Vec<&[EngineTime]> = rounds.iter().map(Vec::as_slice).collect();
    rows(&rounds, Some(&engines[0]))
}

/// Returns how many bytes a second the device copies, read and written.
fn copy_rate(gpu: &Gpu) -> Result<f64> {
    // The first copy warms the device up and is not timed.
    block_on(gpu.copy(COPIED, 1))?;
    let (copied, seconds) = timed(|| block_on(gpu.copy(COPIED, COPIES)));
    copied?;
    Ok(2.0 * COPIED as f64 * f64::from(COPIES) / seconds)
}

/// Returns why an exact tiling does not fit a GPU, in words. Fails with any other error.
fn too_large(error: ReproduceError) -> Result<String> {
    let is_of_size = match &error {
        ReproduceError::Failed(cause) => matches!(
            cause.downcast_ref(),
            Some(GpuError::ExactTooLarge { .. } | GpuError::OutOfMemory)
        ),
        _ => false,
    };
    if is_of_size {
        Ok(error.to_string())
    } else {
        Err(error)
    }
}

/// Runs once with every pass timed, and adds up the passes to which `names` gives the same stage and name.
pub(crate) fn run_timed(
    gpu: &Arc<Gpu>,
    parameters: &Parameters,
    pattern: &Arc<Pattern>,
    control: &Control<'_>,
    names: impl Fn(&PassReport) -> [String; 2],
) -> Result<GpuRun> {
    let options = Options {
        timed: true,
        ..Options::default()
    };

    let opening = GpuSweep::new(Arc::clone(gpu), parameters, pattern, options);
    let mut sweep = block_on(opening)?;

    let mut samples = 0;
    while let Some(band) = block_on(sweep.step(&mut control.observer()))? {
        samples += band.points.len();
    }

    let mut passes = Vec::new();
    for report in sweep.reports() {
        add(&mut passes, names(report), report);
    }

    Ok(GpuRun {
        passes,
        samples,
        held_bytes: sweep.highest_bytes(),
    })
}

/// Adds the report of a pass to the times of its name in a stage.
fn add(passes: &mut Vec<PassTimes>, [stage, name]: [String; 2], report: &PassReport) {
    let known = passes
        .iter_mut()
        .find(|pass| pass.name == name && pass.stage == stage);

    if let Some(pass) = known {
        pass.times += 1;
        // If one pass has no number, the sum has none: the sum of the others would be too small.
        pass.bytes = pass.bytes.zip(report.bytes()).map(|(a, b)| a + b);
        pass.seconds = pass.seconds.zip(report.seconds).map(|(a, b)| a + b);
    } else {
        passes.push(PassTimes {
            stage,
            name,
            times: 1,
            bytes: report.bytes(),
            seconds: report.seconds,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tiling_that_does_not_fit_is_a_note_and_any_other_failure_an_error() {
        let large = GpuError::ExactTooLarge {
            width: 9_000,
            height: 9_000,
            needed: 1 << 33,
            unit: "bytes",
            limit: "maxStorageBufferBindingSize",
            allowed: 1 << 31,
        };
        let note = too_large(large.into()).unwrap();
        assert!(note.contains("8589934592 bytes") && note.contains("maxStorageBufferBindingSize"));
        assert!(too_large(GpuError::OutOfMemory.into()).is_ok());

        let lost = GpuError::DeviceLost {
            reason: "reset".to_owned(),
        };
        assert!(too_large(lost.into()).is_err());
        assert!(too_large(ReproduceError::Cancelled).is_err());
    }

    #[test]
    fn the_smallest_leaf_decides_whether_exact_tiling_fits() {
        let of_leaves = |leaves: &[f64]| Bench {
            samples: 1_000,
            leaves: leaves.to_vec(),
            threads: Vec::new(),
            sequential: false,
            rounds: 1,
            seed: 1,
            plane: 1_000,
        };
        let base = Parameters::default();
        let leaf = |leaves: &[f64]| of_leaves(leaves).most_seams(base).leaf.to_bits();
        assert_eq!(leaf(&[80.0, 20.0, 40.0]), 20.0_f64.to_bits());
        assert_eq!(leaf(&[]), base.leaf.to_bits());
    }

    #[test]
    fn passes_of_a_name_are_added_up_and_one_that_was_not_measured_leaves_no_sum() {
        let report = |seconds| PassReport {
            stage: Stage::Tile,
            name: "scan",
            indirect: false,
            workgroups: None,
            invocations: None,
            bindings: Vec::new(),
            seconds,
        };
        let mut passes = Vec::new();
        for (name, seconds) in [
            ("scan", Some(0.25)),
            ("detect", Some(0.25)),
            ("detect", Some(0.5)),
            ("scan", None),
        ] {
            let names = ["tile", name].map(str::to_owned);
            add(&mut passes, names, &report(seconds));
        }
        let found: Vec<_> = passes.iter().map(|one| (one.times, one.seconds)).collect();
        assert_eq!(found, [(2, None), (2, Some(0.75))]);
    }
}
