//! The passes of a run on a GPU, one by one: their times, their buffers before and after, and whether the CPU has the
//! same. [`Passes`] is the state, [`PassCommand`]s change it, a panel of the window shows it. Nothing is shown that was not measured.

pub mod csv;
mod device;
pub mod filter;
pub mod model;
pub mod placed;
pub mod shown;
pub mod table;
mod work;

use std::sync::Arc;

use glam::DVec2;
use tilescope_core::{Parameters, Stage};
use tilescope_gpu::Gpu;

use tilescope_session::jobs::{Job, Wake};
use tilescope_session::moment::Moment;
use tilescope_session::words::sentence;

pub use device::Fault;
pub use model::{Badge, PassEntry, PassLine, Visit};
pub use placed::OnCanvas;
pub use shown::ShownBuffer;
pub use table::PassSide;

use device::{Arrival, DeviceRun, Survey, Walker};

/// What the panel asks for.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PassCommand {
    /// Go to a pass, by its place in the run.
    Select(usize),
    /// To the pass before.
    Previous,
    /// To the next pass.
    Next,
    /// To the first pass.
    First,
    /// To the last pass.
    Last,
    /// Show a buffer of the pass, by its place.
    Buffer(usize),
    /// Show one side of the pass.
    Side(PassSide),
    /// Show the rows that a filter lets pass.
    Filter(String),
    /// Select a row of the buffer, or none.
    PickRow(Option<u32>),
    /// Point at a row of the buffer, or at none.
    PointRow(Option<u32>),
    /// Show the rows on the canvas, or only in the table.
    OnCanvas(bool),
    /// Bring the canvas into view, and the selected row, if there is one; time then runs by passes.
    ShowCanvas,
    /// Stop what runs in the background.
    Cancel,
    /// Run and list all passes again.
    Again,
    /// The file to write to.
    Path(String),
    /// Write the rows shown to that file; on the web, offer their bytes.
    Export,
    /// Run again, with a word set behind a pass, or as it is.
    Fault(Option<Fault>),
}

/// What runs in the background.
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
    /// Whether the selected pass is still to be visited.
    is_wanted: bool,
    /// The stage to go to once the passes are known.
    wanted_stage: Option<Stage>,
    visit: Option<Visit>,
    shown: ShownBuffer,
    /// Whether the rows shown are on the canvas, too.
    is_on_canvas: bool,
    /// The moment of the timeline at which the passes were dealt with last.
    moment: Option<Moment>,
    notice: Option<String>,
    /// Why the list is not whole.
    unlisted: Option<String>,
    path: Option<String>,
    export: Option<Job<Result<String, String>>>,
    export_told: Option<Result<String, String>>,
    download: Option<(String, Vec<u8>)>,
}

impl Passes {
    /// Begins to run all passes of a run of `parameters` in the background.
    ///
    /// Fails with a sentence when the parameters cannot be sampled, and when the run would be too large to be looked at.
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
            is_on_canvas: true,
            moment: None,
            notice: None,
            unlisted: None,
            path: None,
            export: None,
            export_told: None,
            download: None,
        };
        passes.survey();
        Ok(passes)
    }

    /// Carries out a command.
    pub fn apply(&mut self, command: PassCommand) {
        let last = self.entries.len().saturating_sub(1);
        let at = self.selected.unwrap_or(0);
        match command {
            PassCommand::Select(pass) => self.select(pass),
            PassCommand::Previous => self.select(at.saturating_sub(1)),
            PassCommand::Next => self.select((at + 1).min(last)),
            PassCommand::First => self.select(0),
            PassCommand::Last => self.select(last),
            PassCommand::Buffer(place) => {
                self.export_told = None;
                self.shown.show(self.visit.as_ref(), place);
            }
            PassCommand::Side(side) => self.shown.set_side(self.visit.as_ref(), side),
            PassCommand::Filter(text) => self.shown.set_filter(self.visit.as_ref(), text),
            PassCommand::PickRow(row) => self.shown.pick(row),
            PassCommand::PointRow(row) => self.shown.point(row),
            PassCommand::OnCanvas(is_on_canvas) => self.is_on_canvas = is_on_canvas,
            PassCommand::ShowCanvas => self.shown.point(None),
            PassCommand::Cancel => self.cancel(),
            PassCommand::Again => self.survey(),
            PassCommand::Path(path) => self.path = Some(path),
            PassCommand::Export => self.export(),
            PassCommand::Fault(fault) => {
                self.subject.fault = fault;
                self.survey();
            }
        }
    }

    /// Takes what the background has done and starts what is next. To be called every frame; returns whether anything
    /// changed.
    pub fn poll(&mut self) -> bool {
        let written = self.export.as_ref().and_then(Job::poll);
        let is_written = written.is_some();
        if let Some(outcome) = written {
            self.export = None;
            self.export_told = Some(outcome.unwrap_or_else(|failure| Err(sentence(&failure))));
        }
        let has_arrived = match &self.work {
            PassWork::Idle => false,
            PassWork::Survey(job) => match job.poll() {
                Some(outcome) => self.surveyed(outcome),
                None => false,
            },
            PassWork::Visit(job) => match job.poll() {
                Some(outcome) => self.visited(outcome),
                None => false,
            },
        };
        self.go_on();
        is_written || has_arrived
    }

    /// Waits until nothing runs in the background. For tests and scripts: a window polls.
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
            self.export_told = Some(job.wait().unwrap_or_else(Err));
        }
    }

    /// Goes to the pass that ends a stage; as soon as the passes are known, if they are not. Returns whether there is
    /// such a pass, or may be.
    pub fn select_stage(&mut self, stage: Stage) -> bool {
        if matches!(self.work, PassWork::Survey(_)) {
            self.wanted_stage = Some(stage);
            return true;
        }
        let of_stage = |pass: &PassEntry| pass.report.stage == stage;
        match self.entries.iter().rposition(of_stage) {
            Some(pass) => {
                self.select(pass);
                true
            }
            None => false,
        }
    }

    /// Returns the stage of the selected pass, and whether that pass ends it.
    #[must_use]
    pub fn position(&self) -> Option<(Stage, bool)> {
        let pass = self.selected?;
        let entry = self.entries.get(pass)?;
        Some((entry.report.stage, entry.badge != Badge::Intermediate))
    }

    /// Returns the last stage that is whole behind the selected pass. The blocks are before the first one.
    #[must_use]
    pub fn whole_stage(&self) -> Option<Stage> {
        let passed = self.entries.get(..=self.selected?)?;
        let ends = |entry: &&PassEntry| entry.badge != Badge::Intermediate;
        let last = passed.iter().rev().find(ends);
        Some(last.map_or(Stage::Blocks, |entry| entry.report.stage))
    }

    /// Returns all passes of the run, as far as they are known.
    #[must_use]
    pub fn entries(&self) -> &[PassEntry] {
        &self.entries
    }

    /// Returns the lines of their list.
    #[must_use]
    pub fn lines(&self) -> &[PassLine] {
        &self.lines
    }

    /// Returns how often the run began anew, with more room or a wider halo, until it had enough of both.
    #[must_use]
    pub const fn restarts(&self) -> u32 {
        self.restarts
    }

    /// Returns the place of the selected pass.
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

    /// Returns what is shown of them.
    #[must_use]
    pub const fn shown(&self) -> &ShownBuffer {
        &self.shown
    }

    /// Returns whether the rows shown are to be on the canvas, too.
    #[must_use]
    pub const fn is_on_canvas(&self) -> bool {
        self.is_on_canvas
    }

    /// Returns what the canvas shows of the selected pass; nothing where that was not asked for, and where the pass was
    /// not reached and is not on its way.
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

    /// Returns where the selected row lies, in r, if it has a place.
    #[must_use]
    pub fn picked_place(&self) -> Option<DVec2> {
        let rows = self.on_canvas()?.rows?;
        let spot = rows.places.of(rows.shown.picked()? as usize).first()?;
        Some(tilescope_session::units::place(placed::middle(spot)))
    }

    /// Notes the moment of the timeline at which the passes were dealt with.
    pub const fn note_moment(&mut self, moment: Option<Moment>) {
        self.moment = moment;
    }

    /// Returns the moment of the timeline at which the passes were dealt with last.
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

    /// Returns the word that is set in this run, if any.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        self.subject.fault
    }

    /// Returns what runs in the background and how far it is, from 0 to 1.
    #[must_use]
    pub fn activity(&self) -> Option<(String, f32)> {
        match &self.work {
            PassWork::Idle => None,
            PassWork::Survey(job) => Some((job.activity(), job.fraction())),
            PassWork::Visit(job) => Some((job.activity(), job.fraction())),
        }
    }

    /// Returns what there is to say of the work that ended last: why it did not reach its end, or why the list is not
    /// whole.
    #[must_use]
    pub fn notice(&self) -> Option<&str> {
        self.notice.as_deref().or(self.unlisted.as_deref())
    }

    /// Returns the file that an export would write.
    #[must_use]
    pub fn path(&self) -> String {
        self.path.clone().unwrap_or_else(|| self.file_name())
    }

    /// Returns what became of the last export: a sentence either way.
    #[must_use]
    pub fn export_told(&self) -> Option<&Result<String, String>> {
        self.export_told.as_ref()
    }

    /// Returns the file name and the bytes that were exported where there is no file system. They are handed out once.
    #[must_use]
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
