//! The interface between parts of the state: the data that a part may use while it applies a command, and the effects that
//! it asks for, which the state carries out in their order.

use tilescope_classroom::room::StepView;
use tilescope_classroom::{self as classroom, Classroom};
use tilescope_core::combine::file::Layout as Combination;
use tilescope_debugger::Stops;
use tilescope_session::incoming::NamedBytes;
use tilescope_session::jobs::Wake;
use tilescope_session::layers::{Colouring, Layers};
use tilescope_session::recipe::Recipe;
use tilescope_session::selection::Selection;

use super::parts::JobContext;
use super::scenes::{SceneSource, Scenes};
use super::undo::{History, Made};
use super::{Appearance, ExportSource, Exports, Form, Notice, RunView, State, Time};
use crate::clock::Clock;
use crate::command::{Command, Which};
use crate::device::EngineChoice;
use crate::files::{Delivery, Done};
use crate::layout::{Layout, Panel};

/// A request of a part to the others, which the state carries out after the command.
pub(super) enum Effect {
    /// Show this notice.
    Tell(Notice),
    /// Copy a text to the clipboard.
    Copy(String),
    /// Open the panel of the selection.
    Inspect,
    /// Download a file.
    Download(NamedBytes),
    /// Show a notice that only confirms a command: it goes with the next move in time or the next scene.
    TellBriefly(String),
    /// Carry out a command.
    Issue(Box<Command>),
    /// Bring a panel into view.
    OpenPanel(Panel),
    /// Lay out the panels so.
    Layout(Layout),
    /// Bring back the panels that the tour has hidden.
    BringPanels,
    /// Fill in the form so.
    Form(Box<Form>),
    /// Take layers, colouring and look of this appearance.
    Appearance(Box<Appearance>),
    /// Show these layers and this colouring.
    Layers(Option<Layers>, Colouring),
    /// Replace breakpoints, watches and scenes.
    Stops(Stops),
    /// Stop playing.
    Pause,
    /// Remove the loop.
    EndLoop,
    /// Choose the unit of a tick.
    Clock(Clock),
    /// Close the sheet of files.
    CloseFileSheet,
    /// Close the notice.
    CloseNotice,
    /// Append a sentence to the notice, or show a new one.
    Add(String),
    /// Take what was read from a file or written.
    Done(Box<Done>),
    /// Start a run by an engine.
    Sample(Which, Box<Recipe>, EngineChoice),
    /// Make a run or a combination again, unless it is the current one.
    Make(Option<Box<Made>>),
    /// Drop all steps to undo, as another session is there.
    Forget,
    /// Show the first scene of the tour.
    StartTour,
    /// End the tour, if it is shown.
    EndTour,
}

/// The data of other parts that a part may use while it applies a command.
pub(super) struct Context {
    /// Starts work in the background.
    pub(super) wake: Wake,
    /// Whether the camera jumps instead of flying.
    pub(super) reduced_motion: bool,
    /// The effects asked for so far.
    pub(super) effects: Vec<Effect>,
    /// The generation of the session made last.
    pub(super) generation: u64,
}

impl Context {
    pub(super) fn new(jobs: &JobContext, appearance: &Appearance) -> Self {
        Self {
            wake: Wake::clone(&jobs.wake),
            generation: jobs.generation,
            reduced_motion: appearance.reduced_motion,
            effects: Vec::new(),
        }
    }

    pub(super) fn tell(&mut self, text: String, is_error: bool) {
        self.ask(Effect::Tell(Notice::new(text, is_error)));
    }

    /// Returns the generation for a session that is about to be made.
    pub(super) const fn next_generation(&mut self) -> u64 {
        self.generation += 1;
        self.generation
    }

    pub(super) fn ask(&mut self, effect: Effect) {
        self.effects.push(effect);
    }
}

impl State {
    /// Runs `act`, and carries out the effects it asks for.
    pub(super) fn with<T>(&mut self, act: impl FnOnce(&mut Self, &mut Context) -> T) -> T {
        self.with_of(Which::First, act)
    }

    /// Runs `act` for one of the runs; its notices name that run.
    pub(super) fn with_of<T>(
        &mut self,
        which: Which,
        act: impl FnOnce(&mut Self, &mut Context) -> T,
    ) -> T {
        let mut context = Context::new(&self.runs.jobs, &self.appearance);
        let outcome = act(self, &mut context);
        self.runs.jobs.generation = context.generation;
        self.carry_out_effects(which, context.effects);
        outcome
    }

    /// Runs `act` on a run, if it exists, and carries out the effects it asks for.
    pub(super) fn on<T>(
        &mut self,
        which: Which,
        act: impl FnOnce(&mut RunView, &mut Context) -> T,
    ) -> Option<T> {
        self.with_of(which, |state, context| {
            Some(act(state.runs.get_mut(which)?, context))
        })
    }

    /// Runs `act` on playback and the run that it moves, and carries out the effects they ask for.
    pub(super) fn in_time<T>(
        &mut self,
        act: impl FnOnce(&mut Time, &mut RunView, &mut Context) -> T,
    ) -> T {
        self.with(|state, context| act(&mut state.time, &mut state.runs.first, context))
    }

    fn carry_out_effects(&mut self, which: Which, effects: Vec<Effect>) {
        for effect in effects {
            match effect {
                Effect::Tell(notice) => self.notify(which, notice),
                Effect::Copy(text) => self.window.copied = Some(text),
                Effect::Inspect => self.inspect(which),
                Effect::Download(file) => self.files.downloads.push(file),
                Effect::TellBriefly(text) => {
                    self.messages.brief = Some(text.clone());
                    self.tell(text, false);
                }
                Effect::Issue(command) => self.dispatch(*command),
                Effect::OpenPanel(panel) => self.window.open_panel(panel),
                Effect::Layout(layout) => self.window.layout = layout,
                Effect::BringPanels => self.bring_panels(),
                Effect::Form(form) => self.form.take(*form),
                Effect::Appearance(appearance) => self.appearance.take(&appearance),
                Effect::Layers(layers, colouring) => {
                    (self.appearance.chosen_layers, self.appearance.colouring) =
                        (layers, colouring);
                }
                Effect::Stops(stops) => {
                    self.on(Which::First, |run, context| run.put_stops(stops, context));
                }
                Effect::CloseFileSheet => self.files.sheet = None,
                Effect::CloseNotice => self.messages.notice = None,
                Effect::Add(text) => self.messages.add(&text, false),
                Effect::Done(done) => self.take_done(*done),
                Effect::Pause => self.time.playback.stop(),
                Effect::EndLoop => self.time.playback.range = None,
                Effect::Clock(clock) => self.time.playback.choose(clock),
                Effect::Sample(which, recipe, engine) => {
                    self.start_sampling(which, *recipe, engine);
                }
                Effect::Make(made) => self.make_again(made.map(|made| *made)),
                Effect::Forget => self.past.history = History::default(),
                Effect::StartTour => self.start_tour(),
                Effect::EndTour => self.end_tour(),
            }
        }
    }

    /// Starts a run of `recipe` by `engine`.
    pub(super) fn start_sampling(&mut self, which: Which, recipe: Recipe, engine: EngineChoice) {
        self.with(|state, context| {
            let gpu = state.gpu.for_run(&recipe.parameters, engine);
            state.runs.sample(which, recipe, gpu, context);
        });
    }

    /// Starts making a combination; the current session stays until it is ready.
    pub(super) fn start_combining(&mut self, layout: Combination) {
        self.files.stop_reading();
        self.with(|state, context| state.runs.combine(layout, context));
    }

    /// Makes a run again, unless it is the current one.
    fn make_again(&mut self, made: Option<Made>) {
        self.stop_making();
        if made == Made::of(&self.runs.first) {
            return;
        }
        match made {
            Some(Made::Run(recipe)) => self.start_sampling(Which::First, recipe, self.gpu.engine),
            Some(Made::Combination(layout)) => self.start_combining(layout),
            None => {}
        }
    }

    /// Opens the inspector, if something is selected and the window has panels. A selection that answers a question opens
    /// nothing: the inspector would take room from the picture, and may tell the answer.
    fn inspect(&mut self, which: Which) {
        let run = self.runs.get(which);
        let is_selected = run.is_some_and(|run| run.selected.is_some() || run.place.is_some());
        let is_asked = self.classroom.lessons.open_question().is_some();
        if is_selected && !is_asked && self.window.embedding.is_none() {
            self.window.open_panel(Panel::Inspector);
        }
    }

    pub(super) fn tell(&mut self, text: String, is_error: bool) {
        self.messages.notice = Some(Notice::new(text, is_error));
    }

    /// Shows a notice that concerns one of the runs.
    pub(super) fn tell_of(&mut self, which: Which, text: String, is_error: bool) {
        self.notify(which, Notice::new(text, is_error));
    }

    fn notify(&mut self, which: Which, mut notice: Notice) {
        if which == Which::Second {
            notice.text = format!("Run B: {}", notice.text);
        }
        self.messages.notice = Some(notice);
    }

    /// Runs `act` on lessons and talks, and carries out the effects they ask for.
    pub(crate) fn in_class<T>(
        &mut self,
        act: impl FnOnce(&mut Classroom, &mut classroom::Context) -> T,
    ) -> T {
        let canvas = self.runs.first.canvas_view();
        let mut context = classroom::Context::new(Wake::clone(&self.runs.jobs.wake), canvas);
        let outcome = act(&mut self.classroom, &mut context);
        for effect in context.effects {
            self.carry_out_of_class(effect);
        }
        outcome
    }

    fn carry_out_of_class(&mut self, effect: classroom::Effect) {
        use classroom::Effect as E;
        match effect {
            E::Tell { text, is_error } => self.tell(text, is_error),
            E::EndTour => self.end_tour(),
            E::Begin => {
                self.end_tour();
                self.borrow_window();
                (self.scenes.shown, self.messages.notice) = (None, None);
            }
            E::GiveBack(lesson) => self.give_back_of(Some(*lesson)),
            E::MakeRun(parameters) => {
                self.runs.arriving = None;
                self.time.playback.stop();
                // Lessons need events, which runs of the GPU do not have.
                self.start_sampling(Which::First, Recipe::from(*parameters), EngineChoice::Cpu);
            }
            E::ShowRun(recording, cursor) => self.in_time(|time, run, context| {
                time.show_recording(&recording, Some(cursor), run, context);
            }),
            E::ShowStep(view) => self.show_step(&view),
            E::Look(camera) => self.runs.first.take_camera(Some(camera), camera),
            E::ShowSomeRun => {
                if self.runs.first.session.is_none() {
                    self.run();
                }
            }
            E::RememberFile(path) => self.files.remember_file(&path),
            E::Save(file) => self.with(|state, context| state.files.save_text(file, context)),
            E::CloseMenus => (self.window.finder, self.window.help) = (None, None),
            E::LessonOfScenes => {
                let made = self.runs.first.lesson_of_scenes();
                self.in_class(|class, context| class.present_scenes(made, context));
            }
        }
    }

    /// Shows the moment of a step: up to it if a question is open, otherwise in the whole run.
    fn show_step(&mut self, view: &StepView) {
        self.appearance.chosen_layers = view.layers;
        self.in_time(|time, run, context| {
            time.show_recording(&view.run, view.limit, run, context);
            let before = run.stage;
            run.jump(view.cursor);
            run.moved(before);
            run.pick(Selection::Nothing, context);
            match (view.framed, view.zoom) {
                (Some((center, _)), Some(zoom)) => run.look_from(zoom, center.into(), context),
                (None, Some(zoom)) => run.look_from(zoom, zoom.center, context),
                (Some((center, radii)), None) => run.fly_to(center.into(), radii, context),
                (None, None) => run.fit(context),
            }
        });
    }

    /// Runs `act` on the exports and their input, and carries out the effects it asks for.
    pub(super) fn in_exports<T>(
        &mut self,
        act: impl FnOnce(&mut Exports, ExportSource<'_>, Delivery, &mut Context) -> T,
    ) -> T {
        let are_causes_seen = self.window.shows(Panel::Analysis);
        self.with(|state, context| {
            let Self {
                files,
                runs,
                time,
                appearance,
                analysis,
                scenes,
                ..
            } = state;
            let source = ExportSource {
                run: &runs.first,
                time,
                appearance,
                causes: analysis.causes(&runs.first, are_causes_seen),
                caption: scenes.caption(&runs.first),
            };
            act(&mut files.exports, source, files.delivery, context)
        })
    }

    /// Runs `act` on the scenes and the run that shows them, and carries out the effects they ask for.
    pub(super) fn in_scenes(
        &mut self,
        act: impl FnOnce(&mut Scenes, &mut RunView, &SceneSource, &mut Context),
    ) {
        let source = SceneSource {
            view: self.view(),
            layout: self.window.layout.clone(),
            has_panel: self.window.shows(Panel::Scenes),
            is_embedded: self.window.embedding.is_some(),
        };
        self.with(|state, context| {
            act(&mut state.scenes, &mut state.runs.first, &source, context);
        });
    }
}
