//! A run in one window that can be stopped after any pass and inspected.

use std::sync::Arc;

use tilescope_core::{Parameters, Pattern, Run, Sequential, Stage, Unobserved};

use crate::buffer_rows::BufferRows;
use crate::error::GpuError;
use crate::fit::{Allowance, HALO, longest_side, memory_of};
use crate::layout::Name;
use crate::opened::Gpu;
use crate::pass_report::{PassReport, Recording};
use crate::plan::WindowPlan;
use crate::row_locator::RowLocator;
use crate::setup::Setup;
use crate::state::State;
use crate::upload;
use crate::window_run::{Shortage, WindowRun};

/// The widest halo, in cells: [`HALO`] doubled three times. Chosen, not measured.
const MAX_HALO: i32 = 192;

/// A run on a GPU between two passes.
///
/// The whole domain is one window, with a halo around it. If a sample depends on others beyond the halo, or a list
/// needs more room than expected, the run restarts with a wider halo or more room, and the reports start again.
pub struct Stepper {
    gpu: Arc<Gpu>,
    setup: Arc<Setup>,
    pattern: Arc<Pattern>,
    first: Stage,
    allowance: Allowance,
    /// The last stage that [`Self::step`] returned.
    reached: Option<Stage>,
    /// How often the run restarted.
    restarts: u32,
    work: WindowRun,
}

impl Stepper {
    /// Returns a run before its first pass. The CPU computes the stages before `first_gpu_stage`; with
    /// [`Stage::Blocks`] the device computes all of them.
    ///
    /// Fails when the parameters cannot be sampled, when the run does not fit the device in one go, when
    /// `first_gpu_stage` is [`Stage::Regions`], and when a run ends before `first_gpu_stage`.
    pub async fn new(
        gpu: Arc<Gpu>,
        parameters: &Parameters,
        pattern: &Arc<Pattern>,
        first_gpu_stage: Stage,
    ) -> Result<Self, GpuError> {
        // Sources give samples their ids (`state.rs`).
        let sources = true;
        let setup = Arc::new(Setup::new(parameters, pattern, sources)?);
        let first = match first_gpu_stage {
            // The device is given a pattern that is ready.
            Stage::Pattern => Stage::Blocks,
            // The parallel engine has this stage in place of all from the blocks on, and a device has each of them.
            Stage::Regions => {
                return Err(GpuError::FirstStage {
                    stage: first_gpu_stage,
                });
            }
            stage => stage,
        };

        check_size(&gpu, &setup)?;
        let allowance = Allowance::new(HALO);
        let work = begin(&gpu, &setup, pattern, first, allowance).await?;

        Ok(Self {
            gpu,
            setup,
            pattern: Arc::clone(pattern),
            first,
            allowance,
            reached: None,
            restarts: 0,
            work,
        })
    }

    /// Runs one pass and reports it, or returns `None` when the run is finished.
    pub async fn step_pass(&mut self) -> Result<Option<PassReport>, GpuError> {
        while !self.work.is_done() {
            let before = (self.reports().len(), self.restarts);
            let shortage = self.work.run_pass().await?;
            self.restart_if_needed(shortage).await?;
            // A step may have no passes, and a run that restarted has no report yet.
            if let Some(report) = self.reports().last()
                && (self.reports().len(), self.restarts) != before
            {
                return Ok(Some(report.clone()));
            }
        }
        Ok(None)
    }

    /// Runs to the end of a stage and returns it, or `None` when the run is finished.
    pub async fn step(&mut self) -> Result<Option<Stage>, GpuError> {
        while self.step_pass().await?.is_some() {
            // A run that restarted goes through the same stages again.
            if let ended @ Some(_) = self.ended_stage()
                && self.reached < ended
            {
                self.reached = ended;
                return Ok(ended);
            }
        }
        Ok(None)
    }

    /// Runs to the end.
    pub async fn finish(&mut self) -> Result<(), GpuError> {
        while !self.work.is_done() {
            let shortage = self.work.run(|_| Ok(())).await?;
            self.restart_if_needed(shortage).await?;
        }
        Ok(())
    }

    /// Restarts the run if the halo or the room proved too small.
    async fn restart_if_needed(&mut self, shortage: Option<Shortage>) -> Result<(), GpuError> {
        let Some(shortage) = shortage else {
            return Ok(());
        };
        self.allowance.grow(shortage, MAX_HALO)?;
        self.restarts += 1;
        self.begin().await
    }

    /// Goes back to before the first pass, keeping the halo and the room that proved large enough. The device cannot
    /// step backwards.
    pub async fn rewind(&mut self) -> Result<(), GpuError> {
        self.reached = None;
        self.begin().await
    }

    async fn begin(&mut self) -> Result<(), GpuError> {
        self.work = begin(
            &self.gpu,
            &self.setup,
            &self.pattern,
            self.first,
            self.allowance,
        )
        .await?;
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
        let has_begun = !self.reports().is_empty();
        let is_at_end = self.work.is_done() || self.work.is_between_stages();
        (has_begun && is_at_end).then(|| self.work.stage())
    }

    /// Returns how often the run restarted because its halo or its room proved too small. The number is the same for
    /// the same parameters and device.
    #[must_use]
    pub const fn restarts(&self) -> u32 {
        self.restarts
    }

    /// Returns the run after the last completed stage, equal to that of core's sequential engine sample by sample and
    /// id by id.
    pub async fn run(&self) -> Result<Run, GpuError> {
        State::read(&self.work)
            .await?
            .run(&self.work, &self.pattern)
    }

    /// Returns the first `rows` rows of a buffer. A buffer that is not allocated has no rows.
    pub async fn table(&self, name: Name, rows: u64) -> Result<BufferRows, GpuError> {
        BufferRows::read(&self.work.device, name, rows).await
    }

    /// Returns a locator for buffer rows read between the same two passes. `stage` is the stage of the inspected pass,
    /// since some buffers hold different data in different stages.
    pub async fn row_locator(&self, stage: Stage) -> Result<RowLocator, GpuError> {
        RowLocator::read(&self.work, stage).await
    }

    /// Overwrites a word of a buffer between two passes, to inject a fault. An index past the end is ignored.
    pub fn set_word(&self, name: Name, index: u64, word: u32) {
        self.work.device.set_word(name, index, word);
    }

    /// Returns the buffers of the run with their lengths in bytes.
    #[must_use]
    pub fn buffers(&self) -> Vec<(Name, u64)> {
        self.work.device.lengths()
    }
}

/// Fails when a run with its halo and the recorded stages does not fit the device.
fn check_size(gpu: &Gpu, setup: &Setup) -> Result<(), GpuError> {
    // Recorded stages take about as much memory as the buffers.
    let no_limit = None;
    let memory = memory_of(gpu.report(), no_limit) / 2;
    let allowed = longest_side(setup, &gpu.report().limits, memory)?;
    let [columns, rows] = setup.cells();
    let needed = columns.max(rows);
    if allowed < needed {
        return Err(GpuError::NotInOneGo { needed, allowed });
    }
    Ok(())
}

/// Returns the run at its first pass on the device, after the stages of the CPU.
async fn begin(
    gpu: &Arc<Gpu>,
    setup: &Arc<Setup>,
    pattern: &Arc<Pattern>,
    first: Stage,
    Allowance { halo, room, .. }: Allowance,
) -> Result<WindowRun, GpuError> {
    let mut plan = WindowPlan::new(setup, &setup.domain.rect(), halo, room)?;
    // Without a room that a restart has asked for, the plan has the estimated one.
    if room.is_none() {
        // More room costs little, as inspected runs are small, and may spare a restart, which would discard the reports of
        // the passes so far.
        plan.double_room();
    }

    let no_buffers = None;
    let mut work = WindowRun::new(gpu, setup, plan, no_buffers, Recording::Stages).await?;

    if first != Stage::Blocks {
        let mut engine = Sequential::new(&setup.parameters, Arc::clone(pattern))?;
        while engine.next().is_some_and(|next| next < first) {
            engine.step(&mut Unobserved)?;
        }
        upload::upload(&mut work, engine, first)?;
    }

    Ok(work)
}
