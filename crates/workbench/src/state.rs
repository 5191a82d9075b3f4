//! The state of the window, and [`State::apply`], through which every command goes. Begin there: `dispatch` passes a command
//! to one of the parts that [`State`] lists, each in a file of `state/`. A part that needs something of another part asks
//! for an effect (`effects`), which the state carries out. No window is needed, so that tests and scripts use the state.

use tilescope_classroom::Classroom;
use tilescope_classroom::room::HIDDEN_LAYER;
use tilescope_core::Stage;
use tilescope_core::combine::file::Layout;
use tilescope_debugger::Target;
use tilescope_drawing::subject::Subject;
use tilescope_session::words::sentence;

use crate::analysis::Analysis;
pub use crate::appearance::Appearance;
use crate::command::{
    AppearanceCommand, Command, FormCommand, GpuCommand, LinkCommand, TimeCommand, ViewCommand,
    Which,
};
use crate::device::EngineChoice;
use crate::link::Link;
use crate::rules::UndoPart;
pub use export::{ExportSource, Exports};
pub use form::Form;
pub use frame::{FrameStart, Requests, Settings};
pub use gpu::GpuState;
pub use link::not_copied;
pub use page::PageStart;
pub use parts::{FileState, Messages, Past, Runs};
pub use run_view::{EventQuery, FoundEvents, Hits, MAX_FOUND, MAX_HITS, RunView};
pub use scenes::Scenes;
use tilescope_session::combination::{CombineCommand, NINE};
use tilescope_session::jobs::{Job, Wake};
use tilescope_session::moment::ShownMoment;
use tilescope_session::verification::Verdict;
pub use time::Time;
use undo::HistoryStep;
pub use window::WindowState;

/// Why a command is refused while a question is open.
const VEILED: &str = "Answer the question of the lesson first, or close the lesson: this would show what comes next.";

/// The state of verification.
pub enum Verification {
    /// There is no session to verify.
    Nothing,
    /// It is at work.
    Pending(Job<Result<Verdict, String>>),
    /// It has a verdict.
    Done(Box<Verdict>),
    /// It failed, and why.
    Failed(String),
}

/// A message to the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// Sentences.
    pub text: String,
    /// Whether something went wrong.
    pub is_error: bool,
    /// The folder of the file that was written, if one was.
    pub folder: Option<std::path::PathBuf>,
}

impl Notice {
    /// Returns a notice.
    #[must_use]
    pub const fn new(text: String, is_error: bool) -> Self {
        Self {
            text,
            is_error,
            folder: None,
        }
    }
}

/// Whether the window can use full screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FullScreen {
    /// It can.
    #[default]
    Free,
    /// The user asked to enter or leave full screen.
    Asked,
    /// It cannot, and why.
    Refused(&'static str),
}

impl FullScreen {
    /// Returns why the window cannot use full screen, if so.
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
    /// The input of the next run.
    form: Form,
    /// The runs that are shown.
    runs: Runs,
    /// Playback.
    time: Time,
    /// The appearance of moments.
    appearance: Appearance,
    /// Panels, drawer, list of actions, full screen.
    window: WindowState,
    /// Files and exports.
    files: FileState,
    /// The engine and the GPU.
    gpu: GpuState,
    /// The analysis.
    analysis: Analysis,
    /// Scenes: the one that is shown, and their pictures.
    scenes: Scenes,
    /// Lessons and talks.
    classroom: Classroom,
    /// Changes to be undone, and what a lesson or the tour has replaced.
    past: Past,
    /// Messages to the user.
    messages: Messages,
}

impl State {
    /// Returns the state of a new window, with the default session being sampled.
    #[must_use]
    pub fn new(wake: Wake) -> Self {
        let mut state = Self {
            form: Form::default(),
            runs: Runs::new(wake),
            time: Time::default(),
            appearance: Appearance::default(),
            window: WindowState::default(),
            files: FileState::default(),
            gpu: GpuState::default(),
            analysis: Analysis::default(),
            scenes: Scenes::default(),
            classroom: Classroom::default(),
            past: Past::default(),
            messages: Messages::default(),
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

    /// Returns the subject of the canvas.
    #[must_use]
    pub fn subject(&self) -> Option<Subject<'_>> {
        let first = &self.runs.first;
        Some(Subject {
            causes: self.causes(),
            ..first.subject(&self.appearance, self.runs.contrast(false))?
        })
    }

    /// Refuses a command that an open question does not allow, or that names something by a number that it does not have.
    /// Returns whether it is refused; a notice says why.
    fn refuse(&mut self, command: &Command) -> bool {
        let lessons = &self.classroom.lessons;
        let hidden = || lessons.hidden_layers(self.current_stage());
        match command {
            Command::Appearance(AppearanceCommand::ToggleLayer(layer)) if hidden().has(*layer) => {
                self.tell(HIDDEN_LAYER.to_owned(), false);
            }
            _ if lessons.veil().is_some() && command.rules().reveals => {
                self.tell(VEILED.to_owned(), false);
            }
            _ => match self.runs.index_refusal(command) {
                Some(text) => self.tell(format!("{text}."), true),
                None => return false,
            },
        }
        true
    }

    /// Applies a command. The user changes the state by commands only.
    pub fn apply(&mut self, command: Command) {
        if self.refuse(&command) {
            return;
        }
        let rules = command.rules();
        // What the tour itself offers is carried out by `take_offer`.
        if rules.ends_tour {
            self.end_tour();
        }
        if let Command::View(Which::First, ViewCommand::Pick(selection)) = command {
            let at = self.runs.first.position_of(selection);
            let lessons = &mut self.classroom.lessons;
            lessons.draft_from_canvas(selection, at);
        }
        if matches!(command, Command::Time(_) | Command::Scene(_)) {
            self.messages.drop_brief();
        }
        // The cursor before a command after which the camera may follow; `None` within leads to the event at once.
        let before = match command {
            Command::Time(_) | Command::Debug(_) => Some(self.cursor()),
            Command::Appearance(AppearanceCommand::ToggleFollow) => Some(None),
            _ => None,
        };
        let seeks = matches!(&command, Command::Time(TimeCommand::RunTo(target, _)) if is_at_a_place(*target));
        match command {
            Command::Undo => self.step_in_history(HistoryStep::Undo),
            Command::Redo => self.step_in_history(HistoryStep::Redo),
            command => match rules.undo {
                Some(part) => {
                    let before = self.memento();
                    let remembered = command.clone();
                    self.dispatch(command);
                    self.remember(before, part, Some(&remembered));
                    self.run_live(&remembered);
                }
                None => self.dispatch(command),
            },
        }
        match before {
            // A conflict, say, that was looked for is to be seen: at the scale of the whole domain it is a speck.
            Some(before) if seeks && self.cursor() != before => {
                self.on(Which::First, |run, context| run.lead_to_event(context));
            }
            Some(before) => self.follow_event(before),
            None => {}
        }
        self.follow();
    }

    /// Brings the parts into line with what has changed: layers with an open question, the second run with the first.
    pub(crate) fn follow(&mut self) {
        let stage = self.current_stage();
        let chosen = &mut self.appearance.chosen_layers;
        *chosen = self.classroom.lessons.permitted(*chosen, stage);
        self.runs.follow_first();
        self.time.follow_passes(&self.runs.first);
    }

    /// Moves the camera to the current event, if it follows and the cursor is no longer `before`.
    fn follow_event(&mut self, before: Option<(usize, usize)>) {
        if self.appearance.follows_events && self.cursor() != before {
            self.on(Which::First, |run, context| run.follow_event(context));
        }
    }

    fn apply_to_form(&mut self, command: FormCommand) {
        // The engine is shown among the parameters; to reset them resets it, too.
        if command == FormCommand::Reset {
            let automatic = GpuCommand::Engine(EngineChoice::Auto);
            self.with(|state, context| state.gpu.apply(automatic, context));
        }
        self.form.apply(command);
    }

    fn dispatch(&mut self, command: Command) {
        match command {
            Command::Form(command) => self.apply_to_form(command),
            Command::Gpu(command) => self.with(|state, context| state.gpu.apply(command, context)),
            Command::Run => self.run(),
            Command::Combine(command) => self.combine(command),
            Command::Cancel(which) => {
                self.on(which, |run, _| run.cancel());
            }
            Command::Undo | Command::Redo => {}

            // The window.
            Command::DismissNotice => self.messages.notice = None,
            Command::OpenFolder(folder) => self.files.folder_to_open = Some(folder),
            Command::Appearance(command) => {
                let stage = self.current_stage();
                self.appearance.apply(command, stage);
                self.end_flights();
            }
            Command::Window(command) => self.window.apply(command),

            // What is shown of the runs.
            Command::OpenPasses => self.with(|state, context| {
                state.runs.first.open_passes(&state.gpu, context);
            }),
            Command::Passes(command) => {
                self.on(Which::First, |run, context| {
                    run.apply_to_passes(command, context);
                });
            }
            Command::Compare(command) => self.with(|state, context| {
                (state.runs).apply(command, &state.form, &state.gpu, context);
            }),
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
            Command::View(which, command) => self.with_of(which, |state, context| match which {
                Which::First => state.runs.first.apply_to_view(command, context),
                Which::Second => state.runs.apply_to_second_view(command, context),
            }),

            // What is made of them.
            Command::Scene(command) => self.in_scenes(|scenes, run, source, context| {
                scenes.apply(command, run, source, context);
            }),
            Command::Lesson(command) => {
                self.in_class(|class, context| class.apply(command, context));
            }
            Command::Talk(command) => {
                self.in_class(|class, context| class.apply_to_talk(command, context));
            }
            Command::File(command) => self.apply_to_files(command),
            Command::Export(command) => self.in_exports(|exports, source, delivery, context| {
                exports.apply(command, source, delivery, context);
            }),
            Command::Link(LinkCommand::Copy) => self.copy_link(),
            Command::Link(LinkCommand::Open(text)) => self.open_link(&text),
        }
    }

    fn copy_link(&mut self) {
        let Link { fragment, left_out } = self.link();
        let address = self.window.address.as_deref();
        let text = link::copied_notice(&left_out, address);
        let link = format!("{}#{fragment}", address.unwrap_or_default());
        self.window.copied = Some(link);
        self.tell(text, false);
    }

    /// Starts making a combination, or shows a notice with the fault of its layout.
    fn combine(&mut self, command: CombineCommand) {
        let text = match command {
            CombineCommand::Nine => NINE.to_owned(),
            CombineCommand::Text(text) => text,
        };
        (self.messages.notice, self.runs.arriving) = (None, None);
        match Layout::from_json(text.as_bytes()) {
            Ok(layout) => {
                self.remember_run(UndoPart::Run);
                self.start_combining(layout);
            }
            Err(error) => self.tell(sentence(&error.to_string()), true),
        }
    }

    /// Sets the system's preference of reduced motion, which counts until the user chooses.
    pub fn prefer_reduced_motion(&mut self, reduced: bool) {
        self.appearance.prefer_reduced_motion(reduced);
        self.end_flights();
    }

    /// Ends flights of cameras at their destinations if motion is reduced.
    fn end_flights(&mut self) {
        if self.appearance.reduced_motion {
            for which in [Which::First, Which::Second] {
                self.on(which, |run, _| run.end_flight());
            }
        }
    }

    /// Stops making and reading sessions, and closes the notice.
    fn stop_making(&mut self) {
        self.files.stop_reading();
        self.runs.stop_making();
        self.messages.notice = None;
    }
}

mod analysis;
mod announce;
mod borrowed;
mod compare;
mod effects;
mod engine;
pub mod export;
mod files;
mod form;
mod frame;
mod gpu;
mod indices;
mod link;
mod page;
mod parts;
pub mod run_view;
mod scenes;
#[cfg(test)]
mod tests;
mod time;
mod undo;
mod unfinished;
mod whole;
mod window;
mod work;

/// Returns whether a target is an event at a place of the domain, rather than a line or a kind of event.
const fn is_at_a_place(target: Target) -> bool {
    match target {
        Target::Conflict
        | Target::Elimination
        | Target::Gap
        | Target::Insertion
        | Target::SecondInsertion
        | Target::Violation => true,
        Target::Line(_) | Target::Kind(_) | Target::Sample(_) => false,
    }
}
