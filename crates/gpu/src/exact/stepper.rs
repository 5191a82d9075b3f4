//! An exact tiling that can be stopped after any pass and inspected, as [`crate::Stepper`] can.

use std::sync::Arc;

use tilescope_core::{Parameters, PatternArrivals, Point, Stage};

use super::plan::{DartRoom, ExactPlan};
use super::rows::ExactRows;
use super::{ExactStep, ExactWork};
use crate::buffer_rows::BufferRows;
use crate::constants::{DART_PRESENT, THROW_BITS};
use crate::error::GpuError;
use crate::fit::{MAX_TRIES, memory_of};
use crate::layout::{Dart, Name, counter};
use crate::opened::Gpu;
use crate::pass_report::{PassReport, Recording};
use crate::passes::Command;

/// An exact tiling on a GPU between two passes. If a list needs more room than expected, the run restarts with more, and the
/// reports start again.
pub struct ExactStepper {
    gpu: Arc<Gpu>,
    parameters: Parameters,
    arrived: PatternArrivals,
    room: DartRoom,
    restarts: u32,
    work: ExactWork,
}

impl ExactStepper {
    /// Returns a run before its first pass.
    ///
    /// Fails when the parameters cannot be sampled, and when the run does not fit the device in one go.
    pub async fn new(
        gpu: Arc<Gpu>,
        parameters: &Parameters,
        arrived: &PatternArrivals,
    ) -> Result<Self, GpuError> {
        // More room costs little, as inspected runs are small, and may spare a restart.
        let room = DartRoom::expected(parameters, arrived)?.doubled();
        let work = begin(&gpu, parameters, arrived, room).await?;
        Ok(Self {
            gpu,
            parameters: *parameters,
            arrived: arrived.clone(),
            room,
            restarts: 0,
            work,
        })
    }

    /// Runs one pass and reports it, or returns `None` when the run is finished.
    pub async fn step_pass(&mut self) -> Result<Option<PassReport>, GpuError> {
        // Nothing is queued behind the last step.
        if self.work.step == ExactStep::End {
            return Ok(None);
        }

        let mut needed = self.work.run_pass().await?;
        // After a restart the first pass is run at once, so that there is a report of it.
        while let Some(room) = needed {
            if self.restarts as usize == MAX_TRIES {
                return Err(GpuError::OutOfMemory);
            }
            self.restarts += 1;
            self.room = room;
            self.rewind().await?;
            needed = self.work.run_pass().await?;
        }
        Ok(self.reports().last().cloned())
    }

    /// Goes back to before the first pass, keeping the room that proved large enough.
    pub async fn rewind(&mut self) -> Result<(), GpuError> {
        self.work = begin(&self.gpu, &self.parameters, &self.arrived, self.room).await?;
        Ok(())
    }

    /// Returns the passes so far.
    #[must_use]
    pub fn reports(&self) -> &[PassReport] {
        self.work.device.reports.as_deref().unwrap_or_default()
    }

    /// Returns the stage that the last pass completed, or `None` in the middle of a stage and before the first pass.
    #[must_use]
    pub fn ended_stage(&self) -> Option<Stage> {
        // A run at its beginning has no stage behind it.
        let is_ended = !self.reports().is_empty() && self.work.is_between_stages();
        is_ended.then(|| self.work.stage())
    }

    /// Returns how often the run restarted because its room proved too small.
    #[must_use]
    pub const fn restarts(&self) -> u32 {
        self.restarts
    }

    /// Returns the samples after the stage that was completed last: those laid down; those of the levels decided so far; the
    /// result. All but the result are sorted by place, row by row.
    pub async fn samples(&self) -> Result<Vec<Point>, GpuError> {
        let stage = self.work.stage();
        if stage == Stage::Finish {
            return self.work.points().await;
        }

        // The counter goes on beyond the room of the list, after which the run restarts.
        let count = u64::from(self.work.counter(counter::DARTS).min(self.room.darts));
        let bytes = count * size_of::<Dart>() as u64;
        let darts = self.work.device.bytes(Name::Darts, 0..bytes).await?;
        let darts: Vec<Dart> = bytemuck::pod_collect_to_vec(&darts);
        let states = self.work.device.words(Name::States, 0..count).await?;
        // Samples of later levels are present as they were laid down. They are left out, as in the CPU's samples.
        let is_decided = |dart: &Dart| {
            // The low bits of a label are four times the dart's level, plus the number of its throw in the level. The
            // bits above them are the index of its piece, the part of a block that one copy of the pattern fills.
            let level = (dart.label % (1 << THROW_BITS)) / 4;
            // Iteration 1 has the darts of levels 0 and 1, each later iteration those of the level of its number.
            stage == Stage::Tile || Stage::Iterate(level.max(1)) <= stage
        };
        let present = darts
            .iter()
            .zip(states)
            .filter(|(dart, state)| is_decided(dart) && state & DART_PRESENT != 0);
        let mut points: Vec<Point> = present
            .map(|(dart, _)| Point::new(dart.x, dart.y))
            .collect();
        // The sequence of darts depends on atomics.
        points.sort_unstable_by_key(|point| point.row_major());
        Ok(points)
    }

    /// Returns the first `rows` rows of a buffer. A buffer that is not allocated has no rows.
    pub async fn table(&self, name: Name, rows: u64) -> Result<BufferRows, GpuError> {
        BufferRows::read(&self.work.device, name, rows).await
    }

    /// Returns the data from which the places of buffer rows follow; the rows must be read between the same two passes.
    pub async fn rows(&self) -> Result<ExactRows, GpuError> {
        let ExactWork {
            current,
            throws,
            queue,
            ..
        } = &self.work;
        let throw = match *current {
            ExactStep::Lay => throws.first(),
            ExactStep::Begin(index) | ExactStep::Rounds(index) => throws.get(index),
            // The lists stay as the last throw left them.
            ExactStep::Count | ExactStep::Collect | ExactStep::End => throws.last(),
        };
        // Every level has throws, so that the 0 never stands in.
        let side_bits = throw.map_or(0, |throw| throw.side_bits);

        // As long as the cells of a level wait to be cut or swapped, the open ones are those of the level before, twice as wide.
        let is_cutting = queue.contains(&Command::SwapOpen);
        let open_side_bits = side_bits + u32::from(is_cutting);
        ExactRows::read(
            &self.work.device,
            &self.work.plan,
            [open_side_bits, side_bits],
        )
        .await
    }

    /// Overwrites a word of a buffer between two passes, to inject a fault. An index past the end is ignored.
    pub fn set_word(&self, name: Name, index: u64, word: u32) {
        self.work.device.set_word(name, index, word);
    }
}

async fn begin(
    gpu: &Arc<Gpu>,
    parameters: &Parameters,
    arrived: &PatternArrivals,
    room: DartRoom,
) -> Result<ExactWork, GpuError> {
    room.check(parameters, &gpu.report().limits)?;
    let plan = ExactPlan::new(parameters, arrived, room)?;
    let no_limit = None;
    plan.check(&gpu.report().limits, memory_of(gpu.report(), no_limit))?;
    ExactWork::new(gpu, plan, arrived, Recording::Stages).await
}
