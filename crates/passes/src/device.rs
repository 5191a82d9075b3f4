//! The background work on the device: [`survey`] runs all passes once and compares stages with the CPU; [`visit`] reads the
//! buffers before and after a single pass. Both can be cancelled between passes.

use std::ops::ControlFlow;
use std::sync::Arc;

use tilescope_core::{Observer, Parameters, Progress, Rect, SampleError, Stage};
use tilescope_gpu::layout::Name;
use tilescope_gpu::{BufferRows, Gpu, GpuError, RowPlaces};
use tilescope_session::jobs::Monitor;
use tilescope_session::words::sentence;

use super::model::{Badge, PassEntry, Visit};
use super::placed::PlacedRows;
use super::stepper::{AnyReference, AnyStepper};
use super::table::{BufferTable, MAX_NUMBERS};

/// An injected fault: a word that is changed on the device after a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Fault {
    /// The pass, by its index in the run.
    pub after: usize,
    /// The buffer that holds the word.
    pub buffer: Name,
    /// The word's index in it.
    #[serde(rename = "place")]
    pub index: u64,
    /// The value that the word gets.
    pub word: u32,
}

/// The run that is inspected, and where it runs.
#[derive(Clone)]
pub(super) struct DeviceRun {
    pub gpu: Arc<Gpu>,
    pub parameters: Parameters,
    pub fault: Option<Fault>,
}

/// Why the work ended early.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    Cancelled,
    Failed(String),
}

impl From<GpuError> for Stop {
    fn from(error: GpuError) -> Self {
        match error {
            GpuError::Sample(SampleError::Cancelled { .. }) => Self::Cancelled,
            error => Self::Failed(sentence(&error.to_string())),
        }
    }
}

impl From<SampleError> for Stop {
    fn from(error: SampleError) -> Self {
        GpuError::from(error).into()
    }
}

/// A run on the device, stopped between two passes.
pub(super) struct Walker {
    stepper: AnyStepper,
    domain: Rect,
    fault: Option<Fault>,
}

/// The passes that were run.
pub(super) struct Survey {
    pub passes: Vec<PassEntry>,
    /// How often the run was restarted with more memory or a wider halo.
    pub restarts: u32,
    pub walker: Option<Walker>,
    pub stop: Option<Stop>,
}

/// A pass to be visited: its index in the run, and its entry in the list of passes.
pub(super) struct Goal {
    pub pass: usize,
    pub entry: PassEntry,
}

/// How a visit ended, with the run for the next one.
pub(super) struct Arrival {
    pub walker: Option<Walker>,
    pub outcome: Result<Visit, Stop>,
}

impl Walker {
    async fn begin(subject: &DeviceRun, observer: &mut dyn Observer) -> Result<Self, GpuError> {
        let stepper = AnyStepper::new(&subject.gpu, &subject.parameters, observer).await?;
        let domain = subject.parameters.validate().map_err(SampleError::from)?;
        Ok(Self {
            stepper,
            domain: domain.rect(),
            fault: subject.fault,
        })
    }

    /// Returns the number of passes that have been run.
    pub(super) fn passed(&self) -> usize {
        self.stepper.reports().len()
    }

    /// Runs a pass, and changes the fault's word if it is due after it; false when the run is finished.
    async fn step(&mut self) -> Result<bool, GpuError> {
        if self.stepper.step_pass().await?.is_none() {
            return Ok(false);
        }
        if let Some(fault) = self.fault
            && fault.after + 1 == self.passed()
        {
            self.stepper.set_word(fault.buffer, fault.index, fault.word);
        }
        Ok(true)
    }

    /// Reads back the first rows of a buffer, at most [`MAX_NUMBERS`] numbers but at least one row.
    async fn table(&self, name: Name) -> Result<BufferRows, GpuError> {
        // A table that is read without rows still has its columns, whose number decides how many rows are read.
        let columns = self.stepper.table(name, 0).await?.columns.len() as u64;
        let rows = MAX_NUMBERS / columns.max(1);
        self.stepper.table(name, rows.max(1)).await
    }

    /// Returns the named buffers as they are now, and where their rows lie in the plane. `stage` is that of the visited
    /// pass, since some buffers hold other data in other stages.
    async fn side(
        &self,
        names: &[Name],
        stage: Stage,
        monitor: &Monitor,
    ) -> Result<Vec<(BufferRows, RowPlaces)>, Stop> {
        // The places and the tables are read between the same two passes.
        let locator = self.stepper.rows(stage).await?;

        let mut side = Vec::with_capacity(names.len());
        for &name in names {
            continue_unless_cancelled(monitor)?;
            let table = self.table(name).await?;
            let places = locator.locate(name, &table);
            side.push((table, places));
        }
        Ok(side)
    }
}

/// Runs all passes and compares the device with the CPU after every stage.
pub(super) async fn survey(subject: DeviceRun, monitor: Arc<Monitor>) -> Survey {
    let mut survey = Survey {
        passes: Vec::new(),
        restarts: 0,
        walker: None,
        stop: None,
    };
    survey.stop = survey.run(&subject, &monitor).await.err();

    if let Some(walker) = &survey.walker {
        // The entries have copies of the reports from before their times were measured. The device's own reports now
        // have the times.
        for (pass, report) in survey.passes.iter_mut().zip(walker.stepper.reports()) {
            pass.report = report.clone();
        }
    }
    survey
}

impl Survey {
    /// Runs all passes and lists them. The error is why it ended early; the passes until then are listed.
    async fn run(&mut self, subject: &DeviceRun, monitor: &Monitor) -> Result<(), Stop> {
        let parameters = &subject.parameters;
        let mut observer = |_: Progress| match continue_unless_cancelled(monitor) {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        };

        monitor.set_activity("making the pattern");
        let mut cpu = AnyReference::new(parameters, &mut observer)?;
        let begun = Walker::begin(subject, &mut observer).await?;
        let walker = self.walker.insert(begun);

        loop {
            continue_unless_cancelled(monitor)?;
            if !walker.step().await? {
                return Ok(());
            }

            if walker.stepper.restarts() > self.restarts {
                // The run was restarted with more memory or a wider halo, so that its stages come again.
                self.restarts = walker.stepper.restarts();
                self.passes.clear();
                cpu = AnyReference::new(parameters, &mut observer)?;
            }

            let mut badge = Badge::Intermediate;
            // In the middle of a stage the CPU has no state to compare with.
            if let Some(stage) = walker.stepper.ended_stage() {
                let compared = cpu.compare(stage, &walker.stepper, &mut observer);
                let difference = compared.await?;
                badge = difference.map_or(Badge::Equal, Badge::Differs);
            }

            if let Some(report) = walker.stepper.reports().last().cloned() {
                monitor.set_activity(&format!("pass {}, {}", walker.passed(), report.stage));
                monitor.set_fraction(share(report.stage));
                self.passes.push(PassEntry { report, badge });
            }
        }
    }
}

/// Returns the fraction of a run that is done at a stage, estimated, since the number of passes is known only at its
/// end.
const fn share(stage: Stage) -> f32 {
    match stage {
        Stage::Pattern | Stage::Blocks | Stage::Regions => 0.05,
        Stage::Tile => 0.15,
        Stage::Eliminate => 0.4,
        Stage::Iterate(1) => 0.7,
        Stage::Iterate(_) => 0.85,
        Stage::Finish => 0.95,
    }
}

fn continue_unless_cancelled(monitor: &Monitor) -> Result<(), Stop> {
    if monitor.is_cancelled() {
        return Err(Stop::Cancelled);
    }
    Ok(())
}

/// Takes a run to a pass and reads its buffers before and after it. `walker` is the run as the work before left it, if
/// it is still there. A run that is past the pass is restarted.
pub(super) async fn visit(
    subject: DeviceRun,
    walker: Option<Walker>,
    goal: Goal,
    monitor: Arc<Monitor>,
) -> Arrival {
    let mut arrival = Arrival {
        walker,
        // The outcome is not known yet: this value is replaced below.
        outcome: Err(Stop::Cancelled),
    };
    arrival.outcome = arrival.go(&subject, &goal, &monitor).await;

    if matches!(arrival.outcome, Err(Stop::Failed(_))) {
        // The state of the device is unknown after an error.
        arrival.walker = None;
    }
    arrival
}

impl Arrival {
    /// Takes the run to the goal, and returns the buffers read there, or why the work ended early.
    async fn go(
        &mut self,
        subject: &DeviceRun,
        goal: &Goal,
        monitor: &Monitor,
    ) -> Result<Visit, Stop> {
        // The device cannot step backwards: a run that is past the goal, or is not there any more, begins again.
        let replayed = self.walker.as_ref().is_none_or(|w| w.passed() > goal.pass);

        let walker = if let Some(walker) = &mut self.walker {
            if replayed {
                monitor.set_activity("going back to the beginning");
                walker.stepper.rewind().await?;
            }
            walker
        } else {
            // The run's pattern is seldom made again here, as the survey has made it and the last few patterns are kept.
            // So there is little to wait for, and the observer need not stop it.
            let observer = &mut |_: Progress| ControlFlow::Continue(());
            let begun = Walker::begin(subject, observer).await?;
            self.walker.insert(begun)
        };

        while walker.passed() < goal.pass {
            continue_unless_cancelled(monitor)?;
            let (next, last) = (walker.passed() + 1, goal.pass + 1);
            monitor.set_activity(&format!("running pass {next} of {last}"));
            // Reading the buffers counts as one more pass.
            monitor.set_fraction(next as f32 / (last + 1) as f32);
            // The run ended with fewer passes than the list has.
            if !walker.step().await? {
                return Err(other_passes(goal));
            }
        }

        run_and_read(walker, goal, replayed, monitor).await
    }
}

/// Runs the pass of the goal, which is the next one, and reads its buffers before and after it.
async fn run_and_read(
    walker: &mut Walker,
    goal: &Goal,
    replayed: bool,
    monitor: &Monitor,
) -> Result<Visit, Stop> {
    monitor.set_activity("reading buffers");
    let (buffers, stage) = (goal.entry.buffers(), goal.entry.report.stage);
    let names: Vec<Name> = buffers.iter().map(|&(name, ..)| name).collect();

    let before = walker.side(&names, stage, monitor).await?;
    // A step may restart the run with more memory. It is then at its first pass again, and may have other passes.
    let is_next = walker.step().await? && walker.passed() == goal.pass + 1;
    let last = walker.stepper.reports().last();
    if !is_next || last.is_none_or(|report| report.name != goal.entry.report.name) {
        return Err(other_passes(goal));
    }

    let after = walker.side(&names, stage, monitor).await?;
    let mut visit = Visit {
        pass: goal.pass,
        buffers: Vec::with_capacity(names.len()),
        placed: Vec::with_capacity(names.len()),
        domain: walker.domain,
        replayed,
    };

    let sides = before.into_iter().zip(after);
    for ((name, access, bytes), (before, after)) in buffers.into_iter().zip(sides) {
        let ((rows_before, places_before), (rows_after, places_after)) = (before, after);
        let table = BufferTable::new(name, access, bytes, &rows_before, &rows_after);
        visit.buffers.push(table);
        visit
            .placed
            .push(PlacedRows::new(places_before, places_after));
    }

    Ok(visit)
}

/// Returns the failure that the run does not have the same passes again.
fn other_passes(goal: &Goal) -> Stop {
    let (number, name) = (goal.pass + 1, goal.entry.report.name);
    Stop::Failed(format!(
        "The run's passes have changed: pass {number} is no longer {name}. List the passes again."
    ))
}
