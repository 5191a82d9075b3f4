//! Everything the window shows, and the one place where commands change it. It knows no widgets: tests
//! drive it without a window.

use tilescope_core::Stage;

use crate::analysis::Analysis;
pub use crate::appearance::Appearance;
use crate::command::{Command, LinkCommand, ViewCommand, Which};
use crate::export::ExportCommand;
use crate::layout::Panel;
use effects::{Context, Effect};
pub use export::{ExportSource, Exports};
pub use form::Form;
pub use gpu::GpuState;
pub use page::PageStart;
use parts::JobContext;
pub use parts::{FileState, Links, Messages, Runs};
pub use run_view::{EventQuery, FoundEvents, Hits, MAX_FOUND, MAX_HITS, RunView};
use tilescope_drawing::subject::Subject;
use tilescope_session::jobs::{Job, Wake};
use tilescope_session::moment::ShownMoment;
use tilescope_session::verification::Verdict;
pub use time::Time;
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
        self.runs.first.current_stage()
    }

    /// Returns the verdict, once there is one.
    #[must_use]
    pub fn verdict(&self) -> Option<&Verdict> {
        self.runs.first.verdict()
    }

    /// Returns the moment that is shown.
    #[must_use]
    pub fn shown(&self) -> Option<ShownMoment<'_>> {
        self.runs.first.shown()
    }

    /// Returns the cursor, and how many events there are; `None` for a session without events.
    #[must_use]
    pub fn cursor(&self) -> Option<(usize, usize)> {
        self.runs.first.cursor()
    }

    /// Returns what the canvas shows.
    #[must_use]
    pub fn subject(&self) -> Option<Subject<'_>> {
        let first = &self.runs.first;
        Some(Subject {
            causes: self.causes(),
            ..first.subject(&self.appearance, self.contrast(false))?
        })
    }

    /// Returns why the draft cannot be run now, or `None` if it can.
    #[must_use]
    pub fn run_refusal(&self) -> Option<String> {
        let refusal = self.form.draft.refusals().into_iter().next();
        let refusal = refusal.map(|refusal| refusal.reason);
        refusal.or_else(|| self.gpu.waiting())
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
            Command::Gpu(command) => self.with(|state, context| state.gpu.apply(command, context)),
            Command::Run => self.run(),
            Command::Combine(command) => self.combine(command),
            Command::Cancel(which) => {
                self.on(which, |run, _| {
                    if let Some(job) = &run.sampling {
                        job.cancel();
                    }
                });
            }
            Command::DismissNotice => self.messages.notice = None,
            Command::Appearance(command) => {
                self.appearance.apply(command);
                self.end_flights();
            }
            Command::Window(command) => self.window.apply(command),
            Command::Undo | Command::Redo => {}
            Command::OpenPasses => self.open_passes(),
            Command::Passes(command) => self.apply_to_passes(command),
            Command::File(command) => self.apply_to_files(command),
            Command::Compare(command) => self.apply_to_comparison(command),
            Command::Analysis(command) => {
                let shown = self.runs.first.shown();
                self.analysis.apply(command, shown.as_ref());
            }
            Command::Debug(command) => {
                self.on(Which::First, |run, context| {
                    run.apply_to_debugger(command, context);
                });
            }
            Command::Time(command) => {
                self.in_time(|time, run, context| time.apply(command, run, context));
            }
            Command::View(Which::First, command) => self.apply_to_view(command),
            Command::View(Which::Second, command) => self.apply_to_second_view(command),
            Command::Export(command) => {
                if matches!(command, ExportCommand::Open(_)) {
                    self.files.sheet = None;
                }
                self.in_exports(|exports, source, delivery, context| {
                    exports.apply(command, source, delivery, context);
                });
            }
            Command::Link(LinkCommand::Copy) => self.copy_link(),
            Command::Link(LinkCommand::Open(text)) => self.open_link(&text),
        }
    }

    /// Takes up what the user chose of motion earlier.
    pub fn choose_motion(&mut self, chosen: Option<bool>) {
        self.appearance.choose_motion(chosen);
        self.end_flights();
    }

    /// Takes up what the system prefers, which counts until the user chooses.
    pub fn prefer_reduced_motion(&mut self, reduced: bool) {
        self.appearance.prefer_reduced_motion(reduced);
        self.end_flights();
    }

    /// Where motion is reduced the flights at work end where they lead.
    fn end_flights(&mut self) {
        if self.appearance.reduced_motion {
            for which in [Which::First, Which::Second] {
                self.on(which, |run, _| run.end_flight());
            }
        }
    }

    fn apply_to_view(&mut self, command: ViewCommand) {
        self.on(Which::First, |run, context| {
            run.apply_to_view(command, context);
        });
    }

    /// Has parts do something, and does what they ask of the others.
    fn with<T>(&mut self, act: impl FnOnce(&mut Self, &mut Context) -> T) -> T {
        self.with_of(Which::First, act)
    }

    /// Does the same for one of the runs: what it tells is told of that run.
    fn with_of<T>(&mut self, which: Which, act: impl FnOnce(&mut Self, &mut Context) -> T) -> T {
        let mut context = Context::new(&self.jobs, &self.appearance);
        let outcome = act(self, &mut context);
        self.jobs.generation = context.generation;
        self.carry_out_effects(which, context.effects);
        outcome
    }

    /// Has a run do something, if it is there, and does what it asks of the other parts.
    fn on<T>(
        &mut self,
        which: Which,
        act: impl FnOnce(&mut RunView, &mut Context) -> T,
    ) -> Option<T> {
        self.with_of(which, |state, context| {
            Some(act(state.runs.get_mut(which)?, context))
        })
    }

    /// Has time do something with the run that it moves, and does what they ask of the other parts.
    fn in_time<T>(&mut self, act: impl FnOnce(&mut Time, &mut RunView, &mut Context) -> T) -> T {
        self.with(|state, context| act(&mut state.time, &mut state.runs.first, context))
    }

    fn carry_out_effects(&mut self, which: Which, effects: Vec<Effect>) {
        for effect in effects {
            match effect {
                Effect::Tell(Notice { text, is_error }) => self.tell_of(which, text, is_error),
                Effect::Inspect => self.inspect(which),
                Effect::Download(file) => self.files.downloads.push(file),
            }
        }
    }

    /// Brings what is known of the selection into view, if there is a selection and the window has panels.
    fn inspect(&mut self, which: Which) {
        let run = self.runs.get(which);
        let is_selected = run.is_some_and(|run| run.selected.is_some() || run.place.is_some());
        if is_selected && self.window.embedding.is_none() {
            self.window.open_panel(Panel::Inspector);
        }
    }

    pub(super) fn tell(&mut self, text: String, is_error: bool) {
        self.messages.notice = Some(Notice { text, is_error });
    }

    /// Tells something that concerns one of the runs.
    pub(super) fn tell_of(&mut self, which: Which, text: String, is_error: bool) {
        self.tell(
            match which {
                Which::First => text,
                Which::Second => format!("Run B: {text}"),
            },
            is_error,
        );
    }
}

mod analysis;
mod announce;
mod combine;
mod compare;
mod effects;
mod engine;
pub mod export;
mod files;
mod form;
mod gpu;
mod link;
mod page;
mod parts;
mod remote;
pub mod run_view;
#[cfg(test)]
mod tests;
mod time;
mod undo;
mod view;
mod window;
mod work;
