//! A whole run of exact tiling on a device: the counterpart of core's `exact_sample_parallel`, with the same result, bit for bit.
//! Begin with [`passes::begin`](crate::passes), where the rounds of a throw are explained.
//!
//! The host finds the blocks and where each copy of the pattern lies; samples, darts, losses and cells are the device's.

mod plan;

use std::sync::Arc;

use tilescope_core::stages::darts::{LAST_LEVEL, throws};
use tilescope_core::windows::WindowCounts;
use tilescope_core::{
    Observer, Parameters, PatternArrivals, Point, Progress, R, Run, SampleError, Sampled, Source,
    Stage,
};

use crate::constants::NO_SAMPLE;
use crate::error::GpuError;
use crate::execute::Device;
use crate::fit::{MAX_TRIES, memory_of};
use crate::layout::{Name, counter};
use crate::opened::Gpu;
use crate::pass_report::{PassReport, Recording};
use crate::passes::{self, Command, Throw};

use plan::{DartRoom, ExactPlan};

/// Rounds between two readings of the counters. Most throws take three to six; a round too many does nothing. Chosen, not
/// measured on a card.
const ROUNDS: u32 = 4;

/// More rounds than any throw takes: each one decides the earliest dart that is not yet right, and chains of darts within r that
/// depend on each other have been seen to have a dozen.
const MAX_ROUNDS: u32 = 10_000;

/// The code of the fault that a throw's rounds come to no end, after those of `FAULTS`.
const FAULT_ROUNDS: u32 = 6;

/// Returns the same run as core's `exact_sample`, made by the passes of a device in one go.
///
/// Fails when the parameters cannot be sampled, when the run does not fit the device in one go, when the device fails, and when
/// `observer` stops it.
pub async fn exact_on_gpu(
    gpu: &Arc<Gpu>,
    parameters: &Parameters,
    arrived: &PatternArrivals,
    observer: &mut dyn Observer,
) -> Result<Run, GpuError> {
    let (run, _) = recorded(gpu, parameters, arrived, Recording::Nothing, observer).await?;
    Ok(run)
}

/// Returns what [`exact_on_gpu`] does, with the report of each pass, and its time where the adapter measures them. Fails likewise.
pub async fn exact_with_reports(
    gpu: &Arc<Gpu>,
    parameters: &Parameters,
    arrived: &PatternArrivals,
    observer: &mut dyn Observer,
) -> Result<(Run, Vec<PassReport>), GpuError> {
    recorded(gpu, parameters, arrived, Recording::Passes, observer).await
}

async fn recorded(
    gpu: &Arc<Gpu>,
    parameters: &Parameters,
    arrived: &PatternArrivals,
    recording: Recording,
    observer: &mut dyn Observer,
) -> Result<(Run, Vec<PassReport>), GpuError> {
    let limits = gpu.report().limits;
    let memory = memory_of(gpu.report(), None);
    let mut room = DartRoom::expected(parameters, arrived)?;

    for _ in 0..MAX_TRIES {
        let plan = ExactPlan::new(parameters, arrived, room)?;
        plan.check(&limits, memory)?;
        let work = ExactWork::new(gpu, plan, recording).await?;
        match work.run(parameters, arrived, observer).await? {
            Attempt::Made(run, reports) => return Ok((*run, reports)),
            // A list was too short. Its counter went on, but what was left out may have brought up more.
            Attempt::Short(needed) => room = needed.doubled(),
        }
    }
    Err(GpuError::OutOfMemory)
}

/// How an attempt ended.
enum Attempt {
    Made(Box<Run>, Vec<PassReport>),
    /// A list was too short: at least this room is needed.
    Short(DartRoom),
}

/// An exact tiling in progress.
struct ExactWork {
    plan: ExactPlan,
    device: Device,
    counters: [u32; counter::COUNT as usize],
    observed: u64,
}

/// The throws of all levels, whose numbers are the steps of progress.
fn all_throws(arrived: &PatternArrivals) -> impl Iterator<Item = Throw> + '_ {
    (0..=LAST_LEVEL).flat_map(move |level| {
        (0..throws(level)).map(move |number| Throw {
            level,
            number,
            side_bits: R.ilog2() - level,
            key: arrived.darts().throw_key(level, number).words(),
        })
    })
}

impl ExactWork {
    async fn new(gpu: &Arc<Gpu>, plan: ExactPlan, recording: Recording) -> Result<Self, GpuError> {
        let mut device = Device::empty(gpu, recording)?;
        device.hold(plan.lengths()).await?;
        device.write(Name::Ground, bytemuck::bytes_of(&plan.ground))?;
        device.write(Name::LaidPieces, bytemuck::cast_slice(&plan.pieces))?;
        device.write(Name::Pattern, bytemuck::cast_slice(&plan.pattern))?;
        gpu.check()?;
        Ok(Self {
            plan,
            device,
            counters: [0; counter::COUNT as usize],
            observed: 0,
        })
    }

    /// Runs to the end, or until a list is too short.
    async fn run(
        mut self,
        parameters: &Parameters,
        arrived: &PatternArrivals,
        observer: &mut dyn Observer,
    ) -> Result<Attempt, GpuError> {
        let ground = self.plan.ground;
        self.submit(passes::lay(&ground), Stage::Tile, observer)
            .await?;
        if let Some(needed) = self.shortage() {
            return Ok(Attempt::Short(needed));
        }
        let own = self.counter(counter::DARTS);

        // Lists hold nothing but samples when a throw begins; those of the first throw hold the pattern's.
        let mut unlink: Option<Command> = None;
        for throw in all_throws(arrived) {
            let stage = Stage::Iterate(throw.level.max(1));
            let mut commands: Vec<Command> = unlink.take().into_iter().collect();
            commands.extend(passes::begin(throw, own));
            commands.extend(passes::rounds_of(throw, ROUNDS));
            self.submit(commands, stage, observer).await?;

            let mut rounds = ROUNDS;
            while self.shortage().is_none() && self.counter(counter::CHANGED) > 0 {
                if rounds > MAX_ROUNDS {
                    let code = FAULT_ROUNDS;
                    return Err(GpuError::Fault { stage, code });
                }
                let more = passes::rounds_of(throw, ROUNDS);
                self.submit(more, stage, observer).await?;
                rounds += ROUNDS;
            }
            if let Some(needed) = self.shortage() {
                return Ok(Attempt::Short(needed));
            }
            if self.counter(counter::QUESTIONS) > 0 {
                unlink = Some(passes::end(&ground));
            }
        }

        let mut commands: Vec<Command> = unlink.into_iter().collect();
        commands.extend(passes::finish_exact(&ground));
        self.submit(commands, Stage::Finish, observer).await?;
        self.result(parameters, arrived, own).await
    }

    /// Submits commands, and reads the counters after them. Fails if the observer stops the run.
    async fn submit(
        &mut self,
        commands: Vec<Command>,
        stage: Stage,
        observer: &mut dyn Observer,
    ) -> Result<(), GpuError> {
        // How many rounds a throw takes is not known, so that progress counts submissions, of which there is at least one a throw.
        let least = u64::from(LAST_LEVEL + throws(0)) + 2;
        let progress = Progress {
            stage,
            done: self.observed.min(least),
            total: least,
        };
        self.observed += 1;
        if observer.observe(progress).is_break() {
            return Err(SampleError::Cancelled { stage }.into());
        }

        self.device.submit(&commands, stage)?;
        let words = self
            .device
            .words(Name::Counters, 0..counter::COUNT.into())
            .await?;
        // A device that fails gives fewer words, and `words` reports that.
        for (counter, word) in self.counters.iter_mut().zip(words) {
            *counter = word;
        }
        Ok(())
    }

    const fn counter(&self, counter: u32) -> u32 {
        self.counters[counter as usize]
    }

    /// Returns the room that is needed if a list is too short, as far as the device has come.
    fn shortage(&self) -> Option<DartRoom> {
        let lists = [
            counter::FRESH_CELLS,
            counter::OPEN_CELLS,
            counter::NEXT_OPEN_CELLS,
        ];
        let cells = lists.map(|list| self.counter(list)).into_iter().max();
        let needed = DartRoom {
            darts: self.counter(counter::DARTS),
            cells: cells.unwrap_or_default(),
        };
        let room = self.plan.room();
        let is_short = needed.darts > room.darts || needed.cells > room.cells;
        is_short.then_some(DartRoom {
            darts: needed.darts.max(room.darts),
            cells: needed.cells.max(room.cells),
        })
    }

    /// Reads the result. The first `own` darts are the pattern's samples.
    async fn result(
        mut self,
        parameters: &Parameters,
        arrived: &PatternArrivals,
        own: u32,
    ) -> Result<Attempt, GpuError> {
        let count = self.counter(counter::KEPT);
        let mut lengths = self.plan.lengths();
        lengths.extend(ExactPlan::result_lengths(count));
        self.device.hold(lengths).await?;
        let collect = [passes::collect(&self.plan.ground)];
        self.device.submit(&collect, Stage::Finish)?;

        let words = 0..2 * u64::from(count);
        let places = self.device.words(Name::Result, words.clone()).await?;
        let tags = self.device.words(Name::Tags, words).await?;
        self.device.read_times().await?;

        let points = places.chunks_exact(2);
        let points = points.map(|at| Point::new(at[0] as i32, at[1] as i32));
        let sources: Vec<Source> = tags.chunks_exact(2).map(source).collect();
        let mut counts = WindowCounts {
            blocks: self.plan.blocks as u64,
            ..WindowCounts::default()
        };
        let mut kept = 0;
        for source in &sources {
            match source {
                // Iterations are counted from 1.
                Source::Inserted { iteration } => counts.insert(*iteration as usize - 1, 1),
                Source::Tiled { .. } => kept += 1,
            }
        }
        counts.eliminated = u64::from(own) - kept;

        let summary = counts.summary(count.into());
        let sampled = Sampled {
            points: points.collect(),
            sources: Some(sources),
        };
        let parameters = parameters.as_exact();
        let run = Run::of_result(&parameters, arrived.pattern(), sampled, summary)?;
        let reports = self.device.reports.take().unwrap_or_default();
        Ok(Attempt::Made(Box::new(run), reports))
    }
}

/// Returns the source that two words stand for: block and sample of the pattern, or an iteration.
fn source(words: &[u32]) -> Source {
    match *words {
        [NO_SAMPLE, iteration] => Source::Inserted { iteration },
        [block, pattern] => Source::Tiled { block, pattern },
        _ => unreachable!("a source has two words"),
    }
}

#[cfg(test)]
mod device;
