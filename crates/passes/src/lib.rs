//! The passes of a run on a GPU, one by one: their times, their buffers before and after, and the comparison with the CPU.
//! Begin with [`Passes`], the state; [`PassCommand`]s change it, and `tilescope-app` shows it. All times are measured.

pub mod canvas;
pub mod csv;
mod device;
pub mod filter;
pub mod model;
pub mod placed;
pub mod shown;
mod stepper;
pub mod table;
mod work;

use std::sync::Arc;

use glam::DVec2;
use tilescope_core::{Parameters, Stage};
use tilescope_gpu::Gpu;

use tilescope_session::jobs::{Job, Wake};
use tilescope_session::moment::Moment;
use tilescope_session::words::sentence;

pub use canvas::OnCanvas;
pub use device::Fault;
pub use model::{Badge, PassEntry, PassLine, Visit};
pub use shown::ShownBuffer;
pub use table::PassSide;

use device::{Arrival, DeviceRun, Survey, Walker};

/// A command of the panel.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PassCommand {
    /// Goes to a pass, by its index in the run.
    Select(usize),
    /// Goes to the pass before.
    Previous,
    /// Goes to the next pass.
    Next,
    /// Goes to the first pass.
    First,
    /// Goes to the last pass.
    Last,
    /// Shows a buffer of the pass, by its index.
    Buffer(usize),
    /// Shows one side of the pass.
    Side(PassSide),
    /// Shows only the rows that satisfy a filter.
    Filter(String),
    /// Selects a row of the buffer, or none.
    PickRow(Option<u32>),
    /// Points at a row of the buffer, or at none.
    PointRow(Option<u32>),
    /// Shows the rows on the canvas, too, or only in the table.
    OnCanvas(bool),
    /// Opens the canvas, flies to the selected row, if there is one, and chooses passes as the clock.
    ShowCanvas,
    /// Stops the work in the background.
    Cancel,
    /// Runs and lists all passes again.
    Again,
    /// Sets the file to write to.
    Path(String),
    /// Writes the rows shown to that file; in a browser, downloads them.
    Export,
    /// Runs again, with one word changed after a pass, or unchanged.
    Fault(Option<Fault>),
}

/// The work in the background.
enum PassWork {
    Idle,
    Survey(Job<Survey>),
    Visit(Job<Arrival>),
}

/// The passes of one run.
pub struct Passes {
    subject: DeviceRun,
    wake: Wake,
    entries: Vec<PassEntry>,
    lines: Vec<PassLine>,
    restarts: u32,
    work: PassWork,
    walker: Option<Walker>,
    selected: Option<usize>,
    /// Whether the selected pass is to be visited.
    is_wanted: bool,
    /// The stage to go to once the passes are known.
    wanted_stage: Option<Stage>,
    visit: Option<Visit>,
    shown: ShownBuffer,
    /// Whether the rows shown are also drawn on the canvas.
    is_on_canvas: bool,
    /// The moment of the timeline at the last command of the passes.
    moment: Option<Moment>,
    notice: Option<String>,
    /// Why the list is incomplete.
    unlisted: Option<String>,
    path: Option<String>,
    export: Option<Job<Result<String, String>>>,
    export_result: Option<Result<String, String>>,
    /// The name and the bytes of a file that a browser is to save.
    download: Option<(String, Vec<u8>)>,
}

impl Passes {
    /// Starts running all passes of a run of `parameters` in the background.
    ///
    /// Fails when the parameters cannot be sampled and when the run would be too large to inspect.
    pub fn new(gpu: &Arc<Gpu>, parameters: &Parameters, wake: &Wake) -> Result<Self, String> {
        if let Some(refusal) = model::refusal(parameters) {
            return Err(refusal);
        }

        let mut passes = Self {
            subject: DeviceRun {
                gpu: Arc::clone(gpu),
                parameters: *parameters,
                fault: None,
            },
            wake: Arc::clone(wake),
            entries: Vec::new(),
            lines: Vec::new(),
            restarts: 0,
            work: PassWork::Idle,
            walker: None,
            selected: None,
            is_wanted: false,
            wanted_stage: None,
            visit: None,
            shown: ShownBuffer::default(),
            // Rows are drawn on the canvas until the user switches them off.
            is_on_canvas: true,
            moment: None,
            notice: None,
            unlisted: None,
            path: None,
            export: None,
            export_result: None,
            download: None,
        };

        passes.survey();
        Ok(passes)
    }

    /// Carries out a command.
    pub fn apply(&mut self, command: PassCommand) {
        let last = self.entries.len().saturating_sub(1);
        // No pass is selected only while the list is empty, and `select` ignores every index that the list lacks.
        let current = self.selected.unwrap_or(0);

        match command {
            PassCommand::Select(pass) => self.select(pass),
            PassCommand::Previous => self.select(current.saturating_sub(1)),
            PassCommand::Next => self.select((current + 1).min(last)),
            PassCommand::First => self.select(0),
            PassCommand::Last => self.select(last),
            PassCommand::Buffer(index) => {
                // The result of the last export is about another buffer; in the two cases that follow, about other rows.
                self.export_result = None;
                self.shown.show(self.visit.as_ref(), index);
            }
            PassCommand::Side(side) => {
                self.export_result = None;
                self.shown.set_side(self.visit.as_ref(), side);
            }
            PassCommand::Filter(text) => {
                self.export_result = None;
                self.shown.set_filter(self.visit.as_ref(), text);
            }
            PassCommand::PickRow(row) => self.shown.pick(row),
            PassCommand::PointRow(row) => self.shown.point(row),
            PassCommand::OnCanvas(is_on_canvas) => self.is_on_canvas = is_on_canvas,
            // The pointer has left the rows for the button of this command. The rest of it is the workbench's: the canvas,
            // its camera, the clock.
            PassCommand::ShowCanvas => self.shown.point(None),
            PassCommand::Cancel => self.cancel(),
            PassCommand::Again => self.survey(),
            PassCommand::Path(path) => self.path = Some(path),
            PassCommand::Export => self.export(),
            // The fault changes the run, so that all passes run again.
            PassCommand::Fault(fault) => {
                self.subject.fault = fault;
                self.survey();
            }
        }
    }

    /// Takes finished work and starts the next. Called every frame; returns whether anything changed.
    pub fn poll(&mut self) -> bool {
        let written = self.export.as_ref().and_then(Job::poll);
        let is_written = written.is_some();
        if let Some(outcome) = written {
            self.export = None;
            self.export_result = Some(outcome.unwrap_or_else(|failure| Err(sentence(&failure))));
        }

        let has_arrived = match &self.work {
            PassWork::Idle => false,
            PassWork::Survey(job) => {
                let outcome = job.poll();
                outcome.is_some_and(|outcome| self.surveyed(outcome))
            }
            PassWork::Visit(job) => {
                let outcome = job.poll();
                outcome.is_some_and(|outcome| self.visited(outcome))
            }
        };

        // A visit that was asked for meanwhile can begin now.
        self.go_on();
        is_written || has_arrived
    }

    /// Waits for all work in the background. For tests and scripts; a window polls.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) {
        loop {
            match std::mem::replace(&mut self.work, PassWork::Idle) {
                PassWork::Survey(job) => self.surveyed(job.wait()),
                PassWork::Visit(job) => self.visited(job.wait()),
                PassWork::Idle => break,
            };
            self.go_on();
        }
        if let Some(job) = self.export.take() {
            let outcome = job.wait();
            self.export_result = Some(outcome.unwrap_or_else(|failure| Err(sentence(&failure))));
        }
    }

    /// Goes to the pass that ends a stage, at once or when the passes are known. Returns whether there is such
    /// a pass, or may be.
    pub fn select_stage(&mut self, stage: Stage) -> bool {
        if matches!(self.work, PassWork::Survey(_)) {
            self.wanted_stage = Some(stage);
            return true;
        }
        let of_stage = |pass: &PassEntry| pass.report.stage == stage;
        let pass = self.entries.iter().rposition(of_stage);
        pass.inspect(|&pass| self.select(pass)).is_some()
    }

    /// Returns the stage of the selected pass, and whether that pass ends it.
    #[must_use]
    pub fn position(&self) -> Option<(Stage, bool)> {
        let pass = self.selected?;
        let entry = self.entries.get(pass)?;
        Some((entry.report.stage, entry.badge != Badge::Intermediate))
    }

    /// Returns the last stage that is complete after the selected pass. The blocks are complete before the first pass.
    #[must_use]
    pub fn whole_stage(&self) -> Option<Stage> {
        let passed = self.entries.get(..=self.selected?)?;
        let ends = |entry: &&PassEntry| entry.badge != Badge::Intermediate;
        let last = passed.iter().rev().find(ends);
        Some(last.map_or(Stage::Blocks, |entry| entry.report.stage))
    }

    /// Returns the passes of the run that are known so far.
    #[must_use]
    pub fn entries(&self) -> &[PassEntry] {
        &self.entries
    }

    /// Returns the lines of their list.
    #[must_use]
    pub fn lines(&self) -> &[PassLine] {
        &self.lines
    }

    /// Returns how often the run was restarted with more memory or a wider halo.
    #[must_use]
    pub const fn restarts(&self) -> u32 {
        self.restarts
    }

    /// Returns the index of the selected pass.
    #[must_use]
    pub const fn selected(&self) -> Option<usize> {
        self.selected
    }

    /// Returns the selected pass' buffers, once it was visited.
    #[must_use]
    pub fn visit(&self) -> Option<&Visit> {
        let visit = self.visit.as_ref();
        visit.filter(|visit| Some(visit.pass) == self.selected)
    }

    /// Returns the choice of buffer, side and rows, and the rows shown.
    #[must_use]
    pub const fn shown(&self) -> &ShownBuffer {
        &self.shown
    }

    /// Returns whether the rows shown are also drawn on the canvas.
    #[must_use]
    pub const fn is_on_canvas(&self) -> bool {
        self.is_on_canvas
    }

    /// Returns the rows of the selected pass to show on the canvas; `None` if rows are not drawn on the canvas, or if
    /// the pass was not visited and is not about to be.
    #[must_use]
    pub fn on_canvas(&self) -> Option<OnCanvas<'_>> {
        let pass = self.selected.filter(|_| self.is_on_canvas)?;
        let rows = self.visit().and_then(|visit| self.shown.on_canvas(visit));
        (rows.is_some() || self.is_wanted).then_some(OnCanvas {
            pass,
            name: self.entries.get(pass)?.report.name,
            rows,
        })
    }

    /// Returns where the selected row lies, in r, if it has a position.
    #[must_use]
    pub fn picked_position(&self) -> Option<DVec2> {
        let rows = self.on_canvas()?.rows?;
        let spot = rows.places.of(rows.shown.picked()? as usize).first()?;
        Some(tilescope_session::units::position(placed::middle(spot)))
    }

    /// Notes the moment of the timeline at a command of the passes.
    pub const fn note_moment(&mut self, moment: Option<Moment>) {
        self.moment = moment;
    }

    /// Returns the moment of the timeline at the last command of the passes.
    #[must_use]
    pub const fn moment(&self) -> Option<Moment> {
        self.moment
    }

    /// Returns whether the adapter measures times.
    #[must_use]
    pub fn has_timestamps(&self) -> bool {
        self.subject.gpu.report().has_timestamps
    }

    /// Returns the adapter's name.
    #[must_use]
    pub fn adapter(&self) -> &str {
        &self.subject.gpu.report().name
    }

    /// Returns the word changed in this run, if any.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        self.subject.fault
    }

    /// Returns the work in the background and the fraction of it done, from 0 to 1.
    #[must_use]
    pub fn activity(&self) -> Option<(String, f32)> {
        match &self.work {
            PassWork::Idle => None,
            PassWork::Survey(job) => Some((job.activity(), job.fraction())),
            PassWork::Visit(job) => Some((job.activity(), job.fraction())),
        }
    }

    /// Returns a message about the last work: why it ended early, or why the list is incomplete.
    #[must_use]
    pub fn notice(&self) -> Option<&str> {
        self.notice.as_deref().or(self.unlisted.as_deref())
    }

    /// Returns the file that an export would write.
    #[must_use]
    pub fn path(&self) -> String {
        self.path.clone().unwrap_or_else(|| self.file_name())
    }

    /// Returns the result of the last export, as a sentence in both cases.
    #[must_use]
    pub fn export_result(&self) -> Option<&Result<String, String>> {
        self.export_result.as_ref()
    }

    /// Returns the name and bytes of an exported file where there is no file system; taken once.
    pub const fn take_download(&mut self) -> Option<(String, Vec<u8>)> {
        self.download.take()
    }

    /// Returns the rows shown as CSV.
    #[must_use]
    pub fn csv(&self) -> Option<String> {
        let table = self.shown.table(self.visit())?;
        Some(csv::csv(table, self.shown.rows()))
    }
}
