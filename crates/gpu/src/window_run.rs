//! The computation of one window: its buffers, and the sequence of its stages. Begin with [`WindowRun::run`] and
//! `record`. The host records the commands of a step, submits them, and reads counters back only where it must know
//! whether a loop ends.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use tilescope_core::stages::darts::{LAST_LEVEL, throw_key};
use tilescope_core::stages::uniform::gap_key;
use tilescope_core::windows::{PlacedBlock, Rect64, WindowCounts};
use tilescope_core::{Insertion, Point, Run, Source, Stage, Stream};

use crate::constants::FAULT_TILED;
use crate::error::GpuError;
use crate::execute::Device;
use crate::layout::{Name, counter};
use crate::opened::Gpu;
use crate::pass_report::Recording;
use crate::passes::{self, Command};
use crate::plan::{Phase, Room, WindowPlan};
use crate::setup::Setup;

/// A step of the computation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Blocks,
    Tile,
    Eliminate,
    EliminateMore,
    Survive,
    /// The detectors of iteration 1.
    Detectors,
    /// Detection and insertion of an iteration.
    Iterate(u32),
    /// The first cells of uniform insertion.
    Start,
    /// The darts of a level.
    Level(u32),
    /// More rounds of an iteration's insertion.
    ChooseMore(u32),
    /// The cells of the level after this one.
    Split(u32),
    Finish,
    Done,
}

/// Why a window must be computed again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shortage {
    /// A sample in the window depends on samples beyond the frame; a wider halo is needed.
    Halo,
    /// A list was too short; this room is needed.
    Room(Room),
}

/// The samples of a window, in canonical order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct WindowSamples {
    pub points: Vec<Point>,
    pub sources: Vec<Source>,
    pub counts: WindowCounts,
}

/// Buffers copied after an iteration, for inspection of stages.
#[derive(Clone, Debug, Default)]
pub(crate) struct IterationBuffers {
    /// The proposals, as words.
    pub proposals: Vec<u8>,
    /// The active cells, as words.
    pub active: Vec<u8>,
    /// The grid with its detectors marked, in iteration 1.
    pub grid: Vec<u8>,
}

/// A window in progress.
pub(crate) struct WindowRun {
    pub setup: Arc<Setup>,
    pub plan: WindowPlan,
    pub device: Device,
    step: Step,
    stage: Stage,
    queue: VecDeque<Command>,
    counters: [u32; counter::COUNT as usize],
    /// Whether the counters must be read once the queue is empty.
    reads: bool,
    inserted: Vec<u64>,
    /// If the CPU ran the first stages: the first stage of the device, and the run before it.
    pub base: Option<(Stage, Run)>,
    /// The copied buffers by iteration, if stages are recorded.
    pub kept: Option<BTreeMap<u32, IterationBuffers>>,
}

impl WindowRun {
    /// Returns the run of a planned window at its beginning. It takes over the buffers of `before` if given.
    pub(crate) async fn new(
        gpu: &Arc<Gpu>,
        setup: &Arc<Setup>,
        plan: WindowPlan,
        before: Option<Device>,
        recording: Recording,
    ) -> Result<Self, GpuError> {
        let device = Device::new(gpu, setup, &plan, before, recording).await?;
        Ok(Self {
            setup: Arc::clone(setup),
            plan,
            device,
            step: Step::Blocks,
            stage: Stage::Blocks,
            queue: VecDeque::new(),
            counters: [0; counter::COUNT as usize],
            reads: false,
            inserted: Vec::new(),
            base: None,
            kept: (recording == Recording::Stages).then(BTreeMap::new),
        })
    }

    /// Begins with a stage whose input was uploaded. `inserted` has the counts of the iterations before it, and `base`
    /// is the run up to it, which the CPU has made.
    pub(crate) fn begin_at(&mut self, stage: Stage, inserted: Vec<u64>, base: Run) {
        let is_uniform = self.setup.parameters.insertion == Insertion::Uniform;
        self.step = match stage {
            Stage::Tile => Step::Tile,
            Stage::Eliminate => Step::Eliminate,
            // The upload lacks the grid of survivors, which the end of elimination makes.
            Stage::Iterate(1) => Step::Survive,
            Stage::Iterate(k) if is_uniform => Step::Level(k),
            Stage::Iterate(k) => Step::Iterate(k),
            Stage::Finish => Step::Finish,
            // `upload` refuses all other stages.
            _ => Step::Blocks,
        };
        self.inserted = inserted;
        self.stage = stage;
        self.base = Some((stage, base));
    }

    /// Sets a counter as if it had been read.
    pub(crate) fn set_counter(&mut self, counter: u32, value: u32) {
        self.counters[counter as usize] = value;
    }

    /// Records the uploaded active cells of a level.
    pub(crate) fn keep_active(&mut self, k: u32, cells: &[[i32; 2]]) {
        if let Some(kept) = &mut self.kept {
            kept.entry(k).or_default().active = bytemuck::cast_slice(cells).to_vec();
        }
    }

    /// Returns the current stage.
    pub(crate) const fn stage(&self) -> Stage {
        self.stage
    }

    /// Returns the level of the active cells of uniform insertion.
    pub(crate) fn level(&self) -> u32 {
        let first = match self.base {
            Some((Stage::Iterate(k), _)) => k,
            _ => 1,
        };
        // With each next level the two lists of active cells are swapped.
        first + self.device.swaps
    }

    /// Returns a counter as it was read last.
    pub(crate) const fn counter(&self, counter: u32) -> u32 {
        self.counters[counter as usize]
    }

    /// Returns whether the window is finished.
    pub(crate) fn is_done(&self) -> bool {
        self.step == Step::Done && self.queue.is_empty()
    }

    /// Returns whether the next command begins another stage.
    pub(crate) fn is_between_stages(&self) -> bool {
        self.queue.is_empty() && self.stage_of(self.step) != self.stage
    }

    /// Returns whether no pass has run yet; `false` where passes are not reported.
    fn is_at_beginning(&self) -> bool {
        self.device.reports.as_ref().is_some_and(Vec::is_empty)
    }

    /// Returns the last completed stage, or `None` before the first.
    pub(crate) fn last_stage(&self) -> Option<Stage> {
        // A run that begins with iteration 1 first ends the elimination: its next step is of another stage before any
        // stage is complete.
        if self.is_done() || self.is_between_stages() && !self.is_at_beginning() {
            return Some(self.stage);
        }
        match self.stage {
            Stage::Tile => Some(Stage::Blocks),
            Stage::Eliminate => Some(Stage::Tile),
            Stage::Iterate(1) => Some(Stage::Eliminate),
            Stage::Iterate(k) => Some(Stage::Iterate(k - 1)),
            // `inserted` has a count for each iteration. Where there were none, the first one counts as completed: it
            // had nothing to do.
            Stage::Finish => Some(Stage::Iterate(self.inserted.len().max(1) as u32)),
            // While blocks are in work, no stage is complete. A window has no other stages.
            _ => None,
        }
    }

    /// Runs to the end. Whenever the host reads counters, it calls `ask` with the progress of the window, from 0 to 1;
    /// an error from `ask` stops the run. Returns the shortage that ended the window, if one did.
    pub(crate) async fn run(
        &mut self,
        mut ask: impl FnMut(f64) -> Result<(), GpuError>,
    ) -> Result<Option<Shortage>, GpuError> {
        while !self.is_done() {
            self.record().await?;
            let commands: Vec<Command> = self.queue.drain(..).collect();
            self.device.submit(&commands, self.stage)?;
            if self.reads {
                // Between readings the host does not wait, so that no progress can be reported.
                ask(self.share())?;
            }

            if let Some(shortage) = self.settle().await? {
                return Ok(Some(shortage));
            }
        }
        Ok(None)
    }

    /// Returns the progress of the window, by shares of time measured on a software adapter.
    const fn share(&self) -> f64 {
        match self.stage {
            Stage::Eliminate => 0.3,
            Stage::Iterate(1) => 0.5,
            Stage::Iterate(_) => 0.8,
            Stage::Finish => 0.95,
            // Blocks and tiles.
            _ => 0.1,
        }
    }

    /// Runs one pass and the host work that follows it. Returns the shortage that ended the window, if one did.
    pub(crate) async fn run_pass(&mut self) -> Result<Option<Shortage>, GpuError> {
        if self.queue.is_empty() {
            self.record().await?;
        }

        // Commands before the pass, such as those that clear counters, belong to it.
        while let Some(command) = self.queue.pop_front() {
            self.device.submit(&[command], self.stage)?;
            if matches!(command, Command::Dispatch { .. }) {
                // The length of the list that a pass goes over may lie on the device alone.
                self.device.read_workgroups(&command).await?;
                break;
            }
        }

        // A swap after the pass belongs to it, and so do all commands after the last pass of a step.
        let is_pass = |command: &Command| matches!(command, Command::Dispatch { .. });
        while matches!(self.queue.front(), Some(Command::SwapActive))
            || !self.queue.is_empty() && !self.queue.iter().any(is_pass)
        {
            if let Some(command) = self.queue.pop_front() {
                self.device.submit(&[command], self.stage)?;
            }
        }

        if self.queue.is_empty() {
            return self.settle().await;
        }
        Ok(None)
    }

    /// Returns the finished window.
    pub(crate) async fn result(&self) -> Result<WindowSamples, GpuError> {
        let count = u64::from(self.counter(counter::KEPT));
        let bytes = self.device.bytes(Name::Result, 0..8 * count).await?;
        let points = bytes.chunks_exact(8).map(point).collect();
        // The sources need as much memory again.
        drop(bytes);

        let mut sources = Vec::new();
        if self.setup.sources {
            let words = self.device.words(Name::Tags, 0..2 * count).await?;
            sources = words.chunks_exact(2).map(source).collect();
        }

        Ok(WindowSamples {
            points,
            sources,
            counts: self.counts(),
        })
    }

    /// Returns the counts of the window.
    fn counts(&self) -> WindowCounts {
        let window = Rect64::from(self.plan.frame.window);
        // Each block starts in one window, so that the counts of all windows add up.
        let starts_here = |placed: &&PlacedBlock| window.contains(placed.rect.min);
        let mut counts = WindowCounts {
            blocks: self.plan.placed.iter().filter(starts_here).count() as u64,
            eliminated: self.counter(counter::ELIMINATED).into(),
            dropped: self.counter(counter::DROPPED).into(),
            inserted: Vec::new(),
        };

        // An iteration that inserted nothing in this window adds no entry: the list ends with the last one that did.
        for (index, &count) in self.inserted.iter().enumerate() {
            if count > 0 {
                counts.insert(index, count);
            }
        }
        counts
    }

    /// Returns the stage of a step. At the end it is still the last one.
    fn stage_of(&self, step: Step) -> Stage {
        match step {
            Step::Blocks => Stage::Blocks,
            Step::Tile => Stage::Tile,
            Step::Eliminate | Step::EliminateMore | Step::Survive => Stage::Eliminate,
            Step::Iterate(k) | Step::ChooseMore(k) | Step::Level(k) => Stage::Iterate(k),
            Step::Start | Step::Detectors => Stage::Iterate(1),
            Step::Split(k) => Stage::Iterate(k + 1),
            Step::Finish => Stage::Finish,
            Step::Done => self.stage,
        }
    }

    /// Queues the commands of the next step. From then on `step` is the one that follows, unless counters say otherwise
    /// (`decide`).
    async fn record(&mut self) -> Result<(), GpuError> {
        let is_uniform = self.setup.parameters.insertion == Insertion::Uniform;
        let keeps_stages = self.kept.is_some();
        self.stage = self.stage_of(self.step);

        // These steps begin phases, which need other buffers than the phase before. A run that begins within a phase is
        // a recorded one, which holds all buffers from its start.
        let phase = match self.step {
            Step::Survive => Some(Phase::Fill),
            Step::Level(1) => Some(Phase::Levels),
            Step::Finish => Some(Phase::Finish),
            _ => None,
        };
        if let Some(phase) = phase {
            self.device.enter(&self.setup, &self.plan, phase).await?;
        }

        self.reads = self.reads_after(self.step);
        // Cells of level k have sides of 2^side_bits(k) units. Those of the last level have sides of one unit, and each
        // level before has sides twice as long.
        let side_bits = |k: u32| LAST_LEVEL - k;
        let (commands, next) = match self.step {
            Step::Blocks => (passes::blocks(&self.plan), Step::Tile),
            Step::Tile => (passes::tile(&self.plan), Step::Eliminate),
            Step::Eliminate => (passes::eliminate(), Step::EliminateMore),
            Step::EliminateMore => (passes::rounds(), Step::EliminateMore),
            Step::Survive => {
                let next = if is_uniform {
                    Step::Start
                } else {
                    Step::Detectors
                };
                (passes::survive(&self.plan, keeps_stages), next)
            }
            Step::Detectors => (passes::detectors(&self.plan), Step::Iterate(1)),
            Step::Iterate(k) => (self.iteration(k), Step::ChooseMore(k)),
            Step::ChooseMore(k) => (passes::choose(k), Step::ChooseMore(k)),
            Step::Start => {
                let reach = self.setup.first_reach();
                (passes::start(&self.plan, reach), Step::Level(1))
            }
            Step::Level(k) => {
                // From level 1 on a cell throws once, so its throw is number 0.
                let key = throw_key(gap_key(self.setup.key), k, 0).words();
                (passes::level(k, side_bits(k), key), Step::ChooseMore(k))
            }
            Step::Split(k) => (passes::split(side_bits(k)), Step::Level(k + 1)),
            Step::Finish => {
                let commands = passes::finish(&self.plan, self.setup.sources);
                (commands, Step::Done)
            }
            Step::Done => (Vec::new(), Step::Done),
        };

        self.queue.extend(commands);
        self.step = next;
        Ok(())
    }

    /// Returns whether the host reads the counters after a step.
    const fn reads_after(&self, step: Step) -> bool {
        match step {
            Step::Blocks | Step::Done => false,
            // No step depends on the counters of these. Where stages are inspected, they are read as part of the state.
            Step::Tile | Step::Survive | Step::Detectors => self.kept.is_some(),
            // A loop may end with these steps, or a list may have been too short.
            Step::Eliminate
            | Step::EliminateMore
            | Step::Iterate(_)
            | Step::ChooseMore(_)
            | Step::Start
            | Step::Level(_)
            | Step::Split(_)
            | Step::Finish => true,
        }
    }

    /// Returns the commands of iteration `k`: detection, then insertion.
    fn iteration(&self, k: u32) -> Vec<Command> {
        let key = self.setup.key.derive(Stream::Iteration, k).words();
        let mut commands = if k == 1 {
            passes::detect(&self.plan, self.setup.first_reach())
        } else {
            let mut commands = vec![passes::unlink()];
            commands.extend(passes::redetect(&self.plan, self.setup.later_reach(), k));
            commands
        };
        commands.extend(passes::insert(k, Some(key)));
        commands
    }

    /// Reads the counters if the recorded step needs them, and decides by them what comes next; otherwise that is what
    /// `record` has set. Returns the shortage for which the window must be computed again, if there is one.
    async fn settle(&mut self) -> Result<Option<Shortage>, GpuError> {
        if !self.reads {
            return Ok(None);
        }
        self.reads = false;

        let words = self
            .device
            .words(Name::Counters, 0..counter::COUNT.into())
            .await?;
        self.counters.copy_from_slice(&words);
        // All passes before this reading have ended, so their times are known.
        self.device.read_times().await?;

        if let Some(shortage) = self.judge()? {
            return Ok(Some(shortage));
        }
        self.decide().await?;
        Ok(None)
    }

    /// Returns the shortage for which the window must be computed again, if the counters show one. Fails when a shader has
    /// reported a fault.
    fn judge(&self) -> Result<Option<Shortage>, GpuError> {
        let room = self.plan.room();
        // A list that was too short gets room for all its elements, and an eighth to spare.
        let needed = |count: u32, capacity: u32| {
            if count > capacity {
                count + count / 8
            } else {
                capacity
            }
        };

        let wanted = Room {
            tiled: needed(self.counter(counter::TILED), room.tiled),
            open: match self.setup.parameters.insertion {
                Insertion::Circumcentre => needed(self.counter(counter::OPEN), room.open),
                // Uniform insertion lists no open cells, though the pass counts them.
                Insertion::Uniform => room.open,
            },
            unsure: needed(self.counter(counter::UNSURE), room.unsure),
            proposals: needed(self.counter(counter::PROPOSALS), room.proposals),
            // The lists of this level's active cells and of the next one's have the same room.
            active: needed(
                self.counter(counter::ACTIVE)
                    .max(self.counter(counter::NEXT_ACTIVE)),
                room.active,
            ),
            result: needed(self.counter(counter::KEPT), room.result),
        };

        // Room is judged before faults and unsure cells, which may follow from a list that was too short.
        if wanted != room {
            return Ok(Some(Shortage::Room(wanted)));
        }

        match self.counter(counter::FAULT) {
            0 => {}
            // This fault comes with a count of tiled samples beyond their room, for which the window has been given up
            // above. Should it come alone, the window is computed again as it is.
            FAULT_TILED => return Ok(Some(Shortage::Room(wanted))),
            code => {
                let stage = self.stage;
                return Err(GpuError::Fault { stage, code });
            }
        }

        let is_unsure = self.counter(counter::UNSURE_IN_WINDOW) > 0;
        Ok(is_unsure.then_some(Shortage::Halo))
    }

    /// Changes the next step where the counters require it, and keeps buffers of stages. Which step has just ended follows
    /// from `step`, the next one.
    async fn decide(&mut self) -> Result<(), GpuError> {
        // Rounds are numbered from 0, and even and odd ones have a counter each. A step has an even number of rounds,
        // so that its last round is an odd one.
        let undecided = self.counter(counter::UNDECIDED_ODD) > 0;

        match self.step {
            Step::EliminateMore if !undecided => self.step = Step::Survive,
            Step::ChooseMore(k) if !undecided => {
                self.keep(k).await?;
                self.inserted
                    .push(self.counter(counter::INSERTED_IN_WINDOW).into());
                self.step = self.after_iteration(k);
            }
            Step::Iterate(1) => {
                if let Some(kept) = &mut self.kept {
                    // The grid is kept before detection, which removes the marks of the detectors. A cell has four
                    // words, of four bytes each.
                    let cells = self.plan.cells();
                    kept.entry(1).or_default().grid =
                        self.device.bytes(Name::Grid, 0..16 * cells).await?;
                }
            }
            Step::Level(k) => {
                let active = u64::from(self.counter(counter::ACTIVE));
                // Without active cells there is no place left to fill.
                if active == 0 {
                    self.step = Step::Finish;
                } else if let Some(kept) = &mut self.kept {
                    // The place of a cell has two words.
                    let cells = self.device.bytes(Name::Active, 0..8 * active).await?;
                    kept.entry(k).or_default().active = cells;
                }
            }
            // Any other step stays the next one, and nothing is kept before it.
            _ => {}
        }

        Ok(())
    }

    /// Copies the proposals of iteration `k`, if stages are recorded.
    async fn keep(&mut self, k: u32) -> Result<(), GpuError> {
        let count = u64::from(self.counter(counter::PROPOSALS));
        if let Some(kept) = &mut self.kept {
            // A proposal has eight words.
            let proposals = self.device.bytes(Name::Proposals, 0..32 * count).await?;
            kept.entry(k).or_default().proposals = proposals;
        }
        Ok(())
    }

    /// Returns the step that follows iteration `k`.
    fn after_iteration(&self, k: u32) -> Step {
        if self.setup.parameters.insertion == Insertion::Uniform {
            return if k == LAST_LEVEL {
                Step::Finish
            } else {
                Step::Split(k)
            };
        }

        // An iteration that inserts nothing is the last one, unless cells became unsure in it, so that some of their
        // samples are unknown. The next detection must then mark the cells around these unsure cells.
        let are_all_spread = self.counter(counter::UNSURE) == self.counter(counter::SPREAD);
        if self.counter(counter::INSERTED) == 0 && are_all_spread {
            Step::Finish
        } else {
            Step::Iterate(k + 1)
        }
    }
}

/// Returns the point of 8 bytes.
fn point(bytes: &[u8]) -> Point {
    let [x, y] = bytemuck::pod_read_unaligned(bytes);
    Point::new(x, y)
}

/// Returns the source that the two words of a tag stand for.
fn source(tag: &[u32]) -> Source {
    if tag[0] == u32::MAX {
        Source::Inserted { iteration: tag[1] }
    } else {
        Source::Tiled {
            block: tag[0],
            pattern: tag[1],
        }
    }
}
