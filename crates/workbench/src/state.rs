//! The state of the window, and [`State::apply`], through which every command goes. Begin there: `dispatch` passes a command
//! to one of the parts that [`State`] lists, each in a file of `state/`. A part that needs something of another part asks
//! for an effect (`effects`), which the state carries out. No window is needed, so that tests and scripts use the state.

use tilescope_classroom::Classroom;
use tilescope_classroom::room::HIDDEN_LAYER;
use tilescope_debugger::Target;
use tilescope_session::jobs::{Job, Wake};
use tilescope_session::layers::Layer;
use tilescope_session::verification::Verdict;

use crate::analysis::Analysis;
pub use crate::appearance::Appearance;
use crate::command::{
    AppearanceCommand, Command, FormCommand, LinkCommand, PaintCommand, TimeCommand, ViewCommand,
    Which,
};
use crate::files::SaveTask;
use crate::layout::Layout;
use crate::rules::UndoPart;
pub(crate) use effects::Effect;
pub use export::{ExportSource, Exports};
pub use files::session_to_keep;
pub use form::Form;
pub use frame::{FrameStart, PageAddress, Requests, Settings, is_taught, no_side_by_side};
pub use gpu::GpuState;
pub use link::not_copied;
pub use page::PageStart;
pub use parts::{FileState, Messages, Past, Runs};
pub use run_view::{EventQuery, FoundEvents, Hits, MAX_FOUND, MAX_HITS, NO_PLANE, RunView};
pub use scenes::Scenes;
pub use time::Time;
use undo::{HistoryStep, Memento};
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
    /// The message, in whole sentences.
    pub text: String,
    /// Whether something went wrong.
    pub is_error: bool,
    /// The folder of the file that was written, if one was.
    pub folder: Option<std::path::PathBuf>,
}

impl Notice {
    /// Returns a notice that something went wrong, without a folder.
    #[must_use]
    pub const fn error(text: String) -> Self {
        Self {
            text,
            is_error: true,
            folder: None,
        }
    }

    /// Returns a notice that is no error, without a folder.
    #[must_use]
    pub const fn remark(text: String) -> Self {
        Self {
            text,
            is_error: false,
            folder: None,
        }
    }
}

/// Whether the window can use full screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FullScreen {
    /// It can enter and leave full screen.
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
    /// Playback: its clock, speed and loop.
    time: Time,
    /// The appearance of moments.
    appearance: Appearance,
    /// Panels, drawer, list of actions, full screen.
    window: WindowState,
    /// Files and exports, and the sheets for both.
    files: FileState,
    /// The engine and the GPU.
    gpu: GpuState,
    /// The reference that moments are compared with, and the brush.
    analysis: Analysis,
    /// Scenes: the one that is shown, and their pictures.
    scenes: Scenes,
    /// Lessons and talks, apart from the window.
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

    /// Refuses a command that an open question does not allow, or that names something by a number which nothing has.
    /// Returns whether it is refused; a notice says why.
    fn refuse(&mut self, command: &Command) -> bool {
        let lessons = &self.classroom.lessons;
        let hidden = || lessons.hidden_layers(self.runs.first.current_stage());

        // An open question refuses by a remark, as the user did nothing wrong.
        match command {
            // A layer that would show the answer is refused alone; others can be switched.
            Command::Appearance(AppearanceCommand::ToggleLayer(layer)) if hidden().has(*layer) => {
                self.messages.tell(HIDDEN_LAYER.to_owned());
            }
            _ if lessons.veil().is_some() && command.rules().reveals => {
                self.messages.tell(VEILED.to_owned());
            }
            // A script, or a page or file of others, may name a number that is not there.
            _ => match self.runs.index_refusal(command) {
                Some(text) => self.messages.tell_error(format!("{text}.")),
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
        // A command that the tour itself offers does not end it: `take_offer` sends it past this function.
        if rules.ends_tour {
            self.end_tour();
        }

        if let Command::View(Which::First, ViewCommand::Pick(selection)) = command {
            // A click on the canvas may answer an open question.
            let at = self.runs.first.position_of(selection);
            let lessons = &mut self.classroom.lessons;
            lessons.draft_from_canvas(selection, at);
        }

        // A notice that only confirms a command goes once the user moves on in the run.
        if matches!(command, Command::Time(_) | Command::Scene(_)) {
            self.messages.drop_brief();
        }

        // After a move in time, the camera may follow the event if the cursor is no longer where it was before. When
        // the user switches following on, no cursor counts as the one before, so that the camera goes to the event in
        // any case.
        let switches_follow = matches!(
            command,
            Command::Appearance(AppearanceCommand::ToggleFollow)
        );
        let may_follow = switches_follow || matches!(command, Command::Time(_) | Command::Debug(_));
        let before = self.runs.first.cursor().filter(|_| !switches_follow);
        let looks_for_place = matches!(&command, Command::Time(TimeCommand::RunTo(target, _)) if is_at_a_place(*target));

        match command {
            Command::Undo => self.step_in_history(HistoryStep::Undo),
            Command::Redo => self.step_in_history(HistoryStep::Redo),
            // The state is compared with the one before, so that a command that changed nothing is no step.
            command => match rules.undo {
                Some(part) => {
                    let memento = Memento::of(self);
                    let remembered = command.clone();
                    self.dispatch(command);
                    self.remember(memento, part, Some(&remembered));
                    // Small runs follow changed parameters at once.
                    self.run_live(&remembered);
                }
                None => self.dispatch(command),
            },
        }

        // An event that was looked for, such as a conflict, is shown from near: at the scale of the whole domain it
        // would be too small to be seen.
        if looks_for_place && self.runs.first.cursor() != before {
            self.on(Which::First, |run, context| run.lead_to_event(context));
        } else if may_follow && self.appearance.follows_events {
            self.on(Which::First, |run, context| {
                run.follow_event(before, context);
            });
        }

        self.follow();
    }

    /// Brings the parts into line after a change: layers with an open question, the second run with the first.
    pub(crate) fn follow(&mut self) {
        let stage = self.runs.first.current_stage();
        let chosen = &mut self.appearance.chosen_layers;
        *chosen = self.classroom.lessons.permitted(*chosen, stage);
        self.runs.follow_first();
        self.time.follow_passes(&self.runs.first);
    }

    /// Passes a command to the part of the state that it changes.
    fn dispatch(&mut self, command: Command) {
        // Below, `s` is the state and `c` the context, which takes the effects that a part asks for. `with` lends both,
        // `on` and `with_of` lend them for one of the runs, and `in_scenes`, `in_class` and `in_exports` lend what
        // scenes, lessons and exports need.
        match command {
            Command::Form(FormCommand::Paint(PaintCommand::Dab)) => paint_dab(self),
            Command::Form(FormCommand::Paint(PaintCommand::Tool(true))) => choose_brush(self),
            Command::Form(command) => self.with(|s, c| s.form.apply(command, c)),
            Command::Gpu(command) => self.with(|s, c| s.gpu.apply(command, c)),
            Command::Run => self.run(),
            Command::Combine(command) => self.with(|s, c| s.runs.read_layout(command, c)),
            Command::Cancel(which) => {
                self.on(which, |run, _| run.cancel());
            }
            // `apply` carries these out itself.
            Command::Undo | Command::Redo => {}

            // The window.
            Command::DismissNotice => self.messages.notice = None,
            Command::OpenFolder(folder) => self.files.folder_to_open = Some(folder),
            Command::Appearance(command) => {
                let layers = self.runs.first.layers(&self.appearance);
                self.appearance.apply(command, layers);
                // A camera in flight must jump if the command reduced motion.
                self.runs.end_flights(&self.appearance);
            }
            Command::Window(command) => self.window.apply(command),

            // The view of the runs.
            Command::OpenPasses => self.with(|s, c| s.runs.first.open_passes(&s.gpu, c)),
            Command::Passes(command) => self.with(|s, c| s.runs.first.apply_to_passes(command, c)),
            Command::Compare(command) => {
                self.with(|s, c| s.runs.apply(command, &s.form, &s.gpu, c));
            }
            Command::Analysis(command) => {
                self.runs.measure(command);
                self.analysis.apply(command);
            }
            Command::Debug(command) => self.with(|s, c| s.runs.first.apply_to_debugger(command, c)),
            Command::Time(command) => {
                self.with(|s, c| s.time.apply(command, &mut s.runs.first, c));
            }
            Command::View(which, command) => self.with_of(which, |s, c| match which {
                Which::First => s.runs.first.apply_to_view(command, c),
                Which::Second => s.runs.apply_to_second_view(command, c),
            }),

            // Scenes, lessons, files and links, made of the runs.
            Command::Scene(command) => self.in_scenes(|scenes, run, source, c| {
                scenes.apply(command, run, source, c);
            }),
            Command::Lesson(command) => self.in_class(|class, c| class.apply(command, c)),
            Command::Talk(command) => self.in_class(|class, c| class.apply_to_talk(command, c)),
            Command::File(command) => {
                // A session to be saved is made from the whole state, so that it is made before `with` borrows a part of the state.
                let saved = self.files.saves(&command).then(|| SaveTask::of(self));
                self.with(|s, c| s.files.apply(command, &s.runs.first, saved, c));
            }
            Command::Export(command) => self.in_exports(|exports, source, delivery, c| {
                exports.apply(command, source, delivery, c);
            }),
            Command::Link(LinkCommand::Copy) => {
                let link = self.link();
                self.with(|s, c| link.copy(s.window.address.as_deref(), c));
            }
            Command::Link(LinkCommand::Open(text)) => self.open_link(&text),
        }
    }

    /// Adds a step to undo for `command`, if it changed something since `before`.
    fn remember(&mut self, before: Memento, part: UndoPart, command: Option<&Command>) {
        let now = Memento::of(self);
        self.past.history.remember(before, &now, part, command);
    }

    /// Adds the step of a run that is about to replace the current one, if there is one.
    fn remember_run(&mut self, part: UndoPart) {
        if self.runs.first.session.is_some() {
            let now = Memento::of(self);
            self.past.history.remember_run(part, now);
        }
    }

    /// Undoes or redoes a change.
    fn step_in_history(&mut self, step: HistoryStep) {
        let now = Memento::of(self);
        let session = self.runs.first.session.as_ref();
        // After an undo, redo makes the run of the form as it is now. The run of the form may still be in the making,
        // and then the session is of an older form. If the session was not made from a form, as a combination is not,
        // redo brings back the session itself.
        let is_of_form = session.is_none_or(|session| session.has_recipe());
        let typed = is_of_form.then(|| self.form.recipe());
        // The notice may be the question whether to make a large run again, which the same step answers.
        let notice = self.messages.notice.as_ref();
        let asked = notice.map(|notice| notice.text.clone());

        self.with(|state, context| {
            let history = &mut state.past.history;
            history.step(step, now, typed, asked.as_deref(), context);
        });
    }

    /// Takes a layout that the user changed by dragging. Moving a panel can be undone.
    pub fn replace_layout(&mut self, layout: Layout, is_moved: bool) {
        let before = Memento::of(self);
        self.window.layout = layout;
        if is_moved {
            let no_command = None;
            self.remember(before, UndoPart::Layout, no_command);
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
mod view;
mod window;
mod work;

/// Takes the brush, and shows the field that it changes.
fn choose_brush(state: &mut State) {
    let tool = FormCommand::Paint(PaintCommand::Tool(true));
    state.with(|s, c| s.form.apply(tool, c));

    let layers = state.runs.first.layers(&state.appearance);
    if state.form.paints && !layers.has(Layer::Field) {
        let command = AppearanceCommand::ToggleLayer(Layer::Field);
        state.appearance.apply(command, layers);
    }
}

/// Paints a dab in the middle of the view of the first run.
fn paint_dab(state: &mut State) {
    let run = &state.runs.first;
    let Some(session) = &run.session else {
        return;
    };
    // The view is in r, and the brush in the unit of the domain, which the radii of a field do not change.
    let place = run.camera.center * session.run().domain.radius();
    let stroke = PaintCommand::Stroke(vec![place.to_array()]);
    state.apply(Command::Form(FormCommand::Paint(stroke)));
}

/// Returns whether a target is looked for as something at a place, to which the camera then goes. A line, a kind of
/// event and the events of a given sample are not: the camera stays.
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
