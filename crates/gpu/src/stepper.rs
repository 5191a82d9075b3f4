//! A run in one go that can be stopped after any pass and looked at.

use std::sync::Arc;

use tilescope_core::{Parameters, Pattern, Run, Sequential, Stage, Unobserved};

use crate::adapter::Gpu;
use crate::error::GpuError;
use crate::execute::Looks;
use crate::fit::{HALO, MAX_TRIES, longest_side, memory_of};
use crate::ground::Ground;
use crate::layout::Name;
use crate::pass_report::PassReport;
use crate::plan::{Plan, Room, whole};
use crate::setup::Setup;
use crate::state::State;
use crate::table::Table;
use crate::upload;
use crate::work::{Outcome, Work};

/// The widest halo, in cells, of a run that is kept stage by stage.
const MAX_HALO: i32 = 192;

/// A run on a GPU between two passes.
///
/// The whole domain is one window, with a halo around it. Should something in it depend on what lies beyond the halo, or
/// need more room than was expected, the run begins anew with more: reports then begin anew, too.
pub struct Stepper {
    gpu: Arc<Gpu>,
    setup: Arc<Setup>,
    pattern: Arc<Pattern>,
    first: Stage,
    halo: i32,
    room: Option<Room>,
    /// How often it asked for more room.
    tries: usize,
    /// The last stage of which [`Self::step`] told.
    reached: Option<Stage>,
    /// How often it began anew.
    restarts: u32,
    work: Work,
}

impl Stepper {
    /// Returns a run that has done nothing yet. Stages before `first_gpu_stage` will have run on the CPU; with
    /// [`Stage::Blocks`] all are the device's.
    ///
    /// Fails when the parameters cannot be sampled, when the run does not fit the device in one go, and when a
    /// run ends before `first_gpu_stage`.
    pub async fn new(
        gpu: Arc<Gpu>,
        parameters: &Parameters,
        pattern: &Arc<Pattern>,
        first_gpu_stage: Stage,
    ) -> Result<Self, GpuError> {
        let setup = Arc::new(Setup::new(parameters, pattern, true)?);
        let first = match first_gpu_stage {
            Stage::Pattern => Stage::Blocks,
            Stage::Regions => {
                return Err(GpuError::FirstStage {
                    stage: first_gpu_stage,
                });
            }
            stage => stage,
        };
        check_size(&gpu, &setup)?;
        let work = begin(&gpu, &setup, pattern, first, HALO, None).await?;
        Ok(Self {
            gpu,
            setup,
            pattern: Arc::clone(pattern),
            first,
            halo: HALO,
            room: None,
            tries: 0,
            reached: None,
            restarts: 0,
            work,
        })
    }

    /// Runs one pass and reports it, or returns `None` when the run is finished.
    pub async fn step_pass(&mut self) -> Result<Option<PassReport>, GpuError> {
        while !self.work.is_done() {
            let before = (self.reports().len(), self.restarts);
            let outcome = self.work.run_pass().await?;
            self.begin_anew(outcome.as_ref()).await?;
            // A step may be without passes, and a run that began anew has no report yet.
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
            // A run that began anew passes stages again.
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
            let outcome = self.work.run(|_| Ok(())).await?;
            self.begin_anew(outcome.as_ref()).await?;
        }
        Ok(())
    }

    /// Begins anew where the halo or the room proved too small.
    async fn begin_anew(&mut self, outcome: Option<&Outcome>) -> Result<(), GpuError> {
        match outcome {
            None | Some(Outcome::Known(_)) => return Ok(()),
            Some(Outcome::Unsure) if self.halo >= MAX_HALO => {
                return Err(tilescope_core::SampleError::Entangled {
                    radii: f64::from(self.halo),
                }
                .into());
            }
            Some(Outcome::Unsure) => {
                self.halo *= 2;
                self.room = None;
            }
            Some(Outcome::TooSmall(_)) if self.tries == MAX_TRIES => {
                return Err(GpuError::OutOfMemory);
            }
            Some(Outcome::TooSmall(room)) => {
                self.tries += 1;
                self.room = Some(*room);
            }
        }
        self.restarts += 1;
        self.begin().await
    }

    /// Goes back to before the first pass, with the halo and the room that proved large enough so far: the device
    /// only goes forwards.
    pub async fn rewind(&mut self) -> Result<(), GpuError> {
        self.reached = None;
        self.begin().await
    }

    async fn begin(&mut self) -> Result<(), GpuError> {
        let (halo, room) = (self.halo, self.room);
        self.work = begin(
            &self.gpu,
            &self.setup,
            &self.pattern,
            self.first,
            halo,
            room,
        )
        .await?;
        Ok(())
    }

    /// Returns the passes so far.
    #[must_use]
    pub fn reports(&self) -> &[PassReport] {
        self.work.device.reports.as_deref().unwrap_or_default()
    }

    /// Returns the stage that the last pass ended, or `None` in the middle of one. Before the first pass there is none.
    #[must_use]
    pub fn ended_stage(&self) -> Option<Stage> {
        let has_begun = !self.reports().is_empty();
        let is_at_end = self.work.is_done() || self.work.is_between_stages();
        (has_begun && is_at_end).then(|| self.work.stage())
    }

    /// Returns how often the run began anew because its halo or its room proved too small. A run of the same parameters
    /// on the same device begins anew as often.
    #[must_use]
    pub const fn restarts(&self) -> u32 {
        self.restarts
    }

    /// Returns the run so far as core's sequential engine has it after the last whole stage: equal to it,
    /// sample by sample and id by id.
    pub async fn run(&self) -> Result<Run, GpuError> {
        State::read(&self.work)
            .await?
            .run(&self.work, &self.pattern)
    }

    /// Returns the first `rows` rows of a buffer as a table. A buffer that the run does not have has no rows.
    pub async fn table(&self, name: Name, rows: u64) -> Result<Table, GpuError> {
        Table::read(&self.work.device, name, rows).await
    }

    /// Returns what tells the rows of tables, read between the same two passes, their places. `stage` is that of the
    /// pass which is looked at, before or after it: some buffers serve several stages.
    pub async fn ground(&self, stage: Stage) -> Result<Ground, GpuError> {
        Ground::read(&self.work, stage).await
    }

    /// Writes a word into a buffer between two passes: what if it were another? A place beyond the end is left alone.
    pub fn set_word(&self, name: Name, place: u64, word: u32) {
        self.work.device.set_word(name, place, word);
    }

    /// Returns the buffers of the run with their lengths in bytes.
    #[must_use]
    pub fn buffers(&self) -> Vec<(Name, u64)> {
        self.work.device.lengths()
    }
}

/// Fails when a run with a halo, and with all that is kept of it, does not fit the device.
fn check_size(gpu: &Gpu, setup: &Setup) -> Result<(), GpuError> {
    // What stages leave behind takes about as much again as their buffers.
    let memory = memory_of(gpu.report(), None) / 2;
    let allowed = longest_side(setup, &gpu.report().limits, memory)?;
    let max = setup.domain.rect().max;
    let needed = (max.x.max(max.y) - 1) as u32 / tilescope_core::R as u32 + 1;
    if allowed < needed {
        return Err(GpuError::NotInOneGo { needed, allowed });
    }
    Ok(())
}

/// Returns the work at its beginning, behind the stages that run on the CPU.
async fn begin(
    gpu: &Arc<Gpu>,
    setup: &Arc<Setup>,
    pattern: &Arc<Pattern>,
    first: Stage,
    halo: i32,
    room: Option<Room>,
) -> Result<Work, GpuError> {
    let mut plan = Plan::new(setup, &whole(setup), halo, room)?;
    if room.is_none() {
        // Runs that are looked at are small; beginning anew would confuse who looks.
        plan.double_room();
    }
    let mut work = Work::new(gpu, setup, plan, None, Looks::AtStages).await?;
    if first != Stage::Blocks {
        let mut engine = Sequential::new(&setup.parameters, Arc::clone(pattern))?;
        while engine.next().is_some_and(|next| next < first) {
            engine.step(&mut Unobserved)?;
        }
        upload::upload(&mut work, engine, first)?;
    }
    Ok(work)
}
