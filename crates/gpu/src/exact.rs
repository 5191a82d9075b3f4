//! A whole run of exact tiling on a device: the counterpart of core's `exact_sample_parallel`, with the same result,
//! bit for bit. Begin with [`passes::begin`](crate::passes), where the rounds of a throw are explained.
//!
//! The host finds the blocks and where each copy of the pattern lies; samples, darts, losses and cells are the device's.

mod plan;
pub(crate) mod reference;
pub(crate) mod rows;
pub(crate) mod stepper;

use std::collections::VecDeque;
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

/// Rounds between two readings of the counters. Throws take one to six; a round too many does nothing. Chosen, not measured on a
/// card.
const ROUNDS: u32 = 4;

/// More rounds than any throw takes: each one decides the earliest dart that is not yet right, and chains of darts within r that
/// depend on each other have been seen to have six. Chosen, not proven: no run has come near it.
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

/// Returns what [`exact_on_gpu`] does, with the report of each pass, and its time where the adapter measures times. Fails
/// likewise.
pub async fn exact_with_reports(
    gpu: &Arc<Gpu>,
    parameters: &Parameters,
    arrived: &PatternArrivals,
    observer: &mut dyn Observer,
) -> Result<(Run, Vec<PassReport>), GpuError> {
    recorded(gpu, parameters, arrived, Recording::Passes, observer).await
}

/// Makes a run on a device. Each time a list turns out to be too short, it begins anew with more room.
async fn recorded(
    gpu: &Arc<Gpu>,
    parameters: &Parameters,
    arrived: &PatternArrivals,
    recording: Recording,
    observer: &mut dyn Observer,
) -> Result<(Run, Vec<PassReport>), GpuError> {
    let limits = gpu.report().limits;
    let no_limit = None;
    let memory = memory_of(gpu.report(), no_limit);
    let mut room = DartRoom::expected(parameters, arrived)?;

    // Room is an estimate. Another try has twice what a list turned out to need, so that few tries are needed.
    for _ in 0..MAX_TRIES {
        room.check(parameters, &limits)?;
        let plan = ExactPlan::new(parameters, arrived, room)?;
        plan.check(&limits, memory)?;

        let mut work = ExactWork::new(gpu, plan, arrived, recording).await?;
        if let Some(needed) = work.run(observer).await? {
            room = needed;
            continue;
        }
        let run = work.result(parameters, arrived).await?;
        let reports = work.device.reports.take().unwrap_or_default();
        return Ok((run, reports));
    }
    Err(GpuError::OutOfMemory)
}

/// A step of an exact tiling, between two readings of the counters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ExactStep {
    Lay,
    /// The beginning of a throw, by its index, with the first rounds.
    Begin(usize),
    /// More rounds of a throw.
    Rounds(usize),
    /// The counting of the samples.
    Count,
    Collect,
    End,
}

/// An exact tiling in progress.
struct ExactWork {
    plan: ExactPlan,
    device: Device,
    throws: Vec<Throw>,
    /// Rounds between two readings of the counters.
    rounds_at_once: u32,
    /// The step that is recorded next.
    step: ExactStep,
    /// The step whose commands are in the queue, or were last.
    current: ExactStep,
    queue: VecDeque<Command>,
    counters: [u32; counter::COUNT as usize],
    /// Rounds of the throw so far.
    rounds: u32,
    /// Whether lists have darts that are no samples.
    is_mixed: bool,
    /// How many samples of the pattern were laid down.
    own: u32,
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
    /// Makes the buffers of a tiling, but for those of the result, and writes what comes from the host.
    async fn new(
        gpu: &Arc<Gpu>,
        plan: ExactPlan,
        arrived: &PatternArrivals,
        recording: Recording,
    ) -> Result<Self, GpuError> {
        let mut device = Device::empty(gpu, recording)?;
        // The result's buffers are made last, when it is known how long they are.
        device.hold(plan.lengths()).await?;

        // All else is written by passes: the laying down clears counters and links.
        device.write(Name::Ground, bytemuck::bytes_of(&plan.ground))?;
        device.write(Name::LaidPieces, bytemuck::cast_slice(&plan.pieces))?;
        device.write(Name::Pattern, bytemuck::cast_slice(&plan.pattern))?;
        gpu.check()?;

        // Where passes are inspected one by one, rounds that do nothing would be in the way.
        let is_inspected = recording == Recording::Stages;
        Ok(Self {
            plan,
            device,
            throws: all_throws(arrived).collect(),
            rounds_at_once: if is_inspected { 1 } else { ROUNDS },
            step: ExactStep::Lay,
            current: ExactStep::Lay,
            queue: VecDeque::new(),
            counters: [0; counter::COUNT as usize],
            rounds: 0,
            is_mixed: false,
            own: 0,
        })
    }

    /// Runs to the end and returns `None`, or until a list is too short and returns the room that is needed. Fails if the
    /// observer stops it.
    async fn run(&mut self, observer: &mut dyn Observer) -> Result<Option<DartRoom>, GpuError> {
        while self.step != ExactStep::End {
            // The host waits for the device once a step, so that a run can be stopped as often.
            self.ask(observer)?;
            self.record().await?;

            let commands: Vec<Command> = self.queue.drain(..).collect();
            self.device.submit(&commands, self.stage())?;
            // What follows a list that was too short would be wrong.
            if let Some(needed) = self.settle().await? {
                return Ok(Some(needed));
            }
        }

        Ok(None)
    }

    /// Runs one pass and the host work that follows it. Returns the room that is needed, if a list is too short.
    async fn run_pass(&mut self) -> Result<Option<DartRoom>, GpuError> {
        if self.queue.is_empty() {
            self.record().await?;
        }

        let is_pass = |command: &Command| matches!(command, Command::Dispatch { .. });
        // Counters that are cleared before the pass belong to it.
        while let Some(command) = self.queue.pop_front() {
            self.device.submit(&[command], self.stage())?;
            if is_pass(&command) {
                // Most passes go over lists, whose lengths lie on the device alone.
                self.device.read_workgroups(&command).await?;
                break;
            }
        }

        // A swap and cleared counters up to the next pass are carried out now, too: a visitor sees the buffers under their new
        // names.
        while let Some(command) = self.queue.pop_front_if(|command| !is_pass(command)) {
            self.device.submit(&[command], self.stage())?;
        }
        if self.queue.is_empty() {
            return self.settle().await;
        }
        Ok(None)
    }

    /// Returns the stage of the step whose commands were queued last.
    fn stage(&self) -> Stage {
        self.stage_of(self.current)
    }

    fn stage_of(&self, step: ExactStep) -> Stage {
        match step {
            ExactStep::Lay => Stage::Tile,
            // Darts of levels 0 and 1 count as inserted in iteration 1, and those of a later level in the iteration of its
            // number.
            ExactStep::Begin(index) | ExactStep::Rounds(index) => {
                Stage::Iterate(self.throws[index].level.max(1))
            }
            ExactStep::Count | ExactStep::Collect | ExactStep::End => Stage::Finish,
        }
    }

    /// Returns whether the last pass ended a stage.
    fn is_between_stages(&self) -> bool {
        let is_over = self.step == ExactStep::End || self.stage_of(self.step) != self.stage();
        self.queue.is_empty() && is_over
    }

    /// Reports progress. Fails if the observer stops the run.
    fn ask(&self, observer: &mut dyn Observer) -> Result<(), SampleError> {
        // How many rounds a throw takes is not known, so that throws are counted. The laying down before them is one step more,
        // and the counting and collecting after them another.
        let throws = self.throws.len() as u64;
        let done = match self.step {
            ExactStep::Lay => 0,
            ExactStep::Begin(index) | ExactStep::Rounds(index) => 1 + index as u64,
            ExactStep::Count | ExactStep::Collect | ExactStep::End => 1 + throws,
        };
        let stage = self.stage_of(self.step);
        let progress = Progress {
            stage,
            done,
            total: throws + 2,
        };
        if observer.observe(progress).is_break() {
            return Err(SampleError::Cancelled { stage });
        }
        Ok(())
    }

    /// Queues the commands of the next step.
    async fn record(&mut self) -> Result<(), GpuError> {
        let ground = self.plan.ground;
        self.current = self.step;

        match self.step {
            ExactStep::Lay => self.queue.extend(passes::lay(&ground)),
            ExactStep::Begin(index) => {
                // Darts that the throw before refused would only lengthen every search.
                self.unlink();
                let throw = self.throws[index];
                self.queue.extend(passes::begin(throw, self.own));
                let rounds = passes::rounds_of(throw, self.rounds_at_once);
                self.queue.extend(rounds);
                self.rounds = self.rounds_at_once;
            }
            // Its last round changed something, so that its answers may not be right yet.
            ExactStep::Rounds(index) => {
                let rounds = passes::rounds_of(self.throws[index], self.rounds_at_once);
                self.queue.extend(rounds);
                self.rounds += self.rounds_at_once;
            }
            ExactStep::Count => {
                // Whatever is linked counts as a sample.
                self.unlink();
                self.queue.extend(passes::finish_exact(&ground));
            }
            ExactStep::Collect => {
                let count = self.counter(counter::KEPT);
                // `hold` gives up every buffer that is not asked for. The lists are asked for again, since an inspector
                // of the last passes still shows them.
                let mut lengths = self.plan.lengths();
                lengths.extend(ExactPlan::result_lengths(count));
                self.device.hold(lengths).await?;
                self.queue.push_back(passes::collect(&ground));
            }
            ExactStep::End => {}
        }
        Ok(())
    }

    /// Queues the pass that takes darts that are no samples out of the lists, if there are any.
    fn unlink(&mut self) {
        if std::mem::take(&mut self.is_mixed) {
            self.queue.push_back(passes::end(&self.plan.ground));
        }
    }

    /// Reads the counters after a step, and decides what comes next. Returns the room that is needed, if a list is too short.
    async fn settle(&mut self) -> Result<Option<DartRoom>, GpuError> {
        let range = 0..counter::COUNT.into();
        let words = self.device.words(Name::Counters, range).await?;
        // There is a word for each counter: of a device that fails `words` returns an error.
        for (counter, word) in self.counters.iter_mut().zip(words) {
            *counter = word;
        }
        // A step has fewer passes than there are timestamps; a run has more.
        self.device.read_times().await?;
        if let needed @ Some(_) = self.shortage() {
            return Ok(needed);
        }

        self.step = match self.current {
            ExactStep::Lay => {
                // Darts that are thrown follow these in the list.
                self.own = self.counter(counter::DARTS);
                ExactStep::Begin(0)
            }
            ExactStep::Begin(index) | ExactStep::Rounds(index) => {
                // A driver that computes wrongly might go on for ever.
                if self.rounds > MAX_ROUNDS {
                    let (stage, code) = (self.stage(), FAULT_ROUNDS);
                    return Err(GpuError::Fault { stage, code });
                }
                // Each round clears this counter first, so that it counts the changes of the last one. A round that
                // changes nothing proves the answers. All later rounds then change nothing, so that the last one tells
                // whether any did.
                if self.counter(counter::CHANGED) > 0 {
                    ExactStep::Rounds(index)
                } else {
                    // Only a dart that was asked about may have turned out to be no sample.
                    self.is_mixed = self.counter(counter::QUESTIONS) > 0;
                    // Without another throw the samples are counted.
                    match index + 1 {
                        next if next < self.throws.len() => ExactStep::Begin(next),
                        _ => ExactStep::Count,
                    }
                }
            }
            ExactStep::Count => ExactStep::Collect,
            ExactStep::Collect | ExactStep::End => ExactStep::End,
        };
        Ok(None)
    }

    const fn counter(&self, counter: u32) -> u32 {
        self.counters[counter as usize]
    }

    /// Returns the room of the next attempt if a list was too short for what the passes so far had to put into it.
    /// `None` if all lists suffice so far.
    fn shortage(&self) -> Option<DartRoom> {
        // Counters go on beyond the room of their lists. That of marked cells is cleared once they are cut; if their list was too
        // short, the pass that cuts them raises the counter of the open cells to their number.
        let lists = [
            counter::FRESH_CELLS,
            counter::OPEN_CELLS,
            counter::NEXT_OPEN_CELLS,
        ];
        let cells = lists.map(|list| self.counter(list)).into_iter().max();
        let room = self.plan.room();

        // Entries left out of a list that is too short may have brought up more. One that suffices keeps its room.
        let grown = |needed: u32, room: u32| {
            if needed > room {
                needed.saturating_mul(2)
            } else {
                room
            }
        };
        let next = DartRoom {
            darts: grown(self.counter(counter::DARTS), room.darts),
            cells: grown(cells.unwrap_or_default(), room.cells),
        };
        (next != room).then_some(next)
    }

    /// Reads the result, in canonical order.
    async fn points(&self) -> Result<Vec<Point>, GpuError> {
        let words = 0..2 * u64::from(self.counter(counter::KEPT));
        let places = self.device.words(Name::Result, words).await?;
        let pairs = places.chunks_exact(2);
        let points = pairs.map(|at| Point::new(at[0] as i32, at[1] as i32));
        Ok(points.collect())
    }

    /// Returns the finished run.
    async fn result(
        &self,
        parameters: &Parameters,
        arrived: &PatternArrivals,
    ) -> Result<Run, GpuError> {
        let count = u64::from(self.counter(counter::KEPT));
        let points = self.points().await?;
        let tags = self.device.words(Name::Tags, 0..2 * count).await?;
        let sources: Vec<Source> = tags.chunks_exact(2).map(source).collect();

        let mut counts = WindowCounts {
            blocks: self.plan.blocks as u64,
            ..WindowCounts::default()
        };
        // A sample of the pattern that is the source of no sample was lost.
        let mut kept = 0;
        for source in &sources {
            match source {
                // Iterations are counted from 1.
                Source::Inserted { iteration } => counts.insert(*iteration as usize - 1, 1),
                Source::Tiled { .. } => kept += 1,
            }
        }
        counts.eliminated = u64::from(self.own) - kept;

        let summary = counts.summary(count);
        let sampled = Sampled {
            points,
            sources: Some(sources),
        };
        let parameters = parameters.as_exact();
        Ok(Run::of_result(
            &parameters,
            arrived.pattern(),
            sampled,
            summary,
        )?)
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
