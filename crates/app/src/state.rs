//! Everything the window shows, and the one place where commands change it. It knows no widgets: tests
//! drive it without a window.

use tilescope_core::Stage;

use crate::analysis::Analysis;
use crate::command::{Command, GpuCommand, LinkCommand, WindowCommand};
use crate::device::{Device, Engine};
use crate::jobs::{Job, Wake};
use crate::verification::Verdict;
pub use appearance::Appearance;
pub use debug::{EventQuery, Found, MOST_FOUND};
pub use form::Form;
pub use hits::{Hits, MOST_HITS};
pub use page::PageStart;
use parts::JobContext;
pub use parts::{FileState, GpuState, Links, Messages, Runs, Time};
pub use run_view::RunView;
pub use window::WindowState;

/// What the verifier has said so far.
pub enum Verification {
    /// There is nothing to verify.
    Nothing,
    /// It is at work.
    Pending(Job<Result<Verdict, String>>),
    /// It has judged.
    Done(Box<Verdict>),
    /// It gave no verdict, and why.
    Failed(String),
}

/// Something the user should read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// Sentences.
    pub text: String,
    /// Whether something went wrong.
    pub is_error: bool,
}

/// Whether the window may have the full screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FullScreen {
    /// It may.
    #[default]
    Free,
    /// It is to have it now, or to give it back.
    Asked,
    /// It may not, and why.
    Refused(&'static str),
}

impl FullScreen {
    /// Returns why the window may not have it, if so.
    #[must_use]
    pub const fn refusal(self) -> Option<&'static str> {
        match self {
            Self::Refused(why) => Some(why),
            Self::Free | Self::Asked => None,
        }
    }
}

/// The state of the window.
pub struct State {
    /// What the next run is made from.
    pub form: Form,
    /// The runs that are looked at.
    pub runs: Runs,
    /// How time runs.
    pub time: Time,
    /// How moments are drawn.
    pub appearance: Appearance,
    /// What stands where.
    pub window: WindowState,
    /// What is read and written.
    pub files: FileState,
    /// What is known of the GPU.
    pub gpu: GpuState,
    /// What is measured of the moment.
    pub analysis: Analysis,
    /// Links that come and go.
    pub links: Links,
    /// What the user should read or hear.
    pub messages: Messages,
    history: undo::History,
    jobs: JobContext,
}

impl State {
    /// Returns the state of a window that has just opened: the default session is being sampled.
    #[must_use]
    pub fn new(wake: Wake) -> Self {
        let mut state = Self {
            form: Form::default(),
            runs: Runs::default(),
            time: Time::default(),
            appearance: Appearance::default(),
            window: WindowState::default(),
            files: FileState::default(),
            gpu: GpuState::default(),
            analysis: Analysis::default(),
            links: Links::default(),
            messages: Messages::default(),
            history: undo::History::default(),
            jobs: JobContext {
                wake,
                generation: 0,
            },
        };
        state.apply(Command::Run);
        state
    }

    /// Returns the stage shown.
    #[must_use]
    pub fn current_stage(&self) -> Option<Stage> {
        self.runs
            .first
            .session
            .as_ref()?
            .stages
            .get(self.runs.first.stage)
            .copied()
    }

    /// Returns the verdict, once there is one.
    #[must_use]
    pub fn verdict(&self) -> Option<&Verdict> {
        match &self.runs.first.verification {
            Verification::Done(verdict) => Some(verdict),
            _ => None,
        }
    }

    /// Returns why the draft cannot be run now, or `None` if it can.
    #[must_use]
    pub fn run_refusal(&self) -> Option<String> {
        let refusal = self.form.draft.refusals().into_iter().next();
        let waiting = || match self.gpu.device {
            Device::Testing(_) if self.form.engine == Engine::Gpu => self.gpu.device.said(),
            _ => None,
        };
        refusal.map(|refusal| refusal.reason).or_else(waiting)
    }

    /// Carries out a command: the only way in which the state changes for a user.
    pub fn apply(&mut self, command: Command) {
        match command {
            Command::Undo => self.undo(),
            Command::Redo => self.redo(),
            command => match undo::concerns(&command) {
                Some(part) => {
                    let before = self.memento();
                    let remembered = command.clone();
                    self.carry_out(command);
                    self.remember(before, part, Some(&remembered));
                }
                None => self.carry_out(command),
            },
        }
        self.follow_first();
        self.follow_passes();
    }

    fn carry_out(&mut self, command: Command) {
        match command {
            Command::Form(command) => self.form.apply(command),
            Command::Gpu(GpuCommand::Engine(engine)) => self.choose_engine(engine),
            Command::Gpu(GpuCommand::NameAdapter(name)) => self.name_adapter(name),
            Command::Run => self.run(),
            Command::Combine(command) => self.combine(command),
            Command::Cancel => {
                if let Some(job) = &self.runs.first.sampling {
                    job.cancel();
                }
            }
            Command::DismissNotice => self.messages.notice = None,
            Command::Appearance(command) => {
                if self.appearance.apply(command) {
                    self.end_flight();
                }
            }
            Command::Window(WindowCommand::Inspect) => self.inspect(),
            Command::Window(command) => self.window.apply(command),
            Command::Undo | Command::Redo => {}
            Command::OpenPasses => self.open_passes(),
            Command::Passes(command) => self.apply_to_passes(command),
            Command::File(command) => self.apply_to_files(command),
            Command::Compare(command) => self.apply_to_comparison(command),
            Command::OnSecond(command) => self.carry_out_on_second(*command),
            Command::Analysis(command) => self.apply_to_analysis(command),
            Command::Debug(command) => {
                let before = self.runs.first.stage;
                self.apply_to_debugger(command);
                self.follow_cursor();
                self.moved(before);
            }
            Command::Time(command) => self.apply_to_time(command),
            Command::View(command) => self.apply_to_view(command),
            Command::Export(command) => self.apply_to_export(command),
            Command::Link(LinkCommand::Copy) => self.copy_link(),
            Command::Link(LinkCommand::Open(text)) => self.open_link(&text),
        }
    }

    pub(super) fn tell(&mut self, text: String, is_error: bool) {
        self.messages.notice = Some(Notice { text, is_error });
    }
}

mod analysis;
mod announce;
mod appearance;
mod camera;
mod combine;
mod compare;
pub(crate) mod debug;
mod engine;
pub(crate) mod export;
mod files;
mod form;
pub(crate) mod hits;
mod link;
mod page;
mod parts;
mod remote;
mod run_view;
#[cfg(test)]
mod tests;
mod time;
mod undo;
mod view;
mod window;
mod work;
