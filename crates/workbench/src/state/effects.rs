//! The interface between parts of the state: the data that a part may use while it applies a command, and the effects that
//! it asks for, which the state carries out in their order. Lessons and the tour borrow the window, and give it back.

use std::sync::Arc;

use tilescope_classroom::lessons::OpenLesson;
use tilescope_classroom::room::NewFile;
use tilescope_classroom::{self as classroom, Classroom};
use tilescope_debugger::Stops;
use tilescope_drawing::camera::Camera;
use tilescope_session::incoming::NamedBytes;
use tilescope_session::jobs::Wake;
use tilescope_session::layers::{Colouring, Layers};
use tilescope_session::recipe::{OwnPattern, Recipe};
use tilescope_session::session::Session;
use tilescope_sets::{GrayImage, PlanarPolygon, ShapeSource};

use super::borrowed::Borrowed;
use super::parts::JobContext;
use super::scenes::{SceneSource, Scenes};
use super::undo::{History, Made, Memento};
use super::{Appearance, ExportSource, Exports, Form, Notice, RunView, State};
use crate::analysis::reference_file::ReferenceFile;
use crate::clock::{Clock, Playback};
use crate::command::{Command, Which};
use crate::curve::ShownCurve;
use crate::device::EngineChoice;
use crate::files::{Delivery, Opened};
use crate::layout::{Layout, Panel};
use crate::rules::UndoPart;
use crate::scenes::SceneList;
use crate::view::SavedView;

/// A request of a part to the others, which the state carries out after the command.
pub(crate) enum Effect {
    /// Show this notice, in place of another one.
    Tell(Notice),
    /// Copy a text to the clipboard.
    Copy(String),
    /// Open the panel of the selection.
    Inspect,
    /// Download a file through the browser.
    Download(NamedBytes),
    /// Write painted radii to a new file, beside where the program runs, or on a page download them. They count as saved once
    /// they are written.
    SaveRadii(Box<GrayImage>, Box<NewFile>),
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
    /// Draw this curve above the timeline.
    Curve(ShownCurve),
    /// Replace breakpoints, watches and scenes.
    Stops(Stops),
    /// Stop playing at this moment.
    Pause,
    /// Remove the loop of playback.
    EndLoop,
    /// Choose the unit of a tick.
    Clock(Clock),
    /// Replace the state of playback.
    Playback(Box<Playback>),
    /// Close the sheet of files.
    CloseFileSheet,
    /// Close the notice, whatever it says.
    CloseNotice,
    /// Append a sentence to the notice, or show a new one.
    Add(String),
    /// Show a session that was read from a file.
    Open(Box<Opened>),
    /// Open a link, as its command does.
    OpenLink(String),
    /// Compare the runs with a point set.
    Against(Arc<ReferenceFile>),
    /// Clip the next run from a pattern.
    Pattern(Box<OwnPattern>),
    /// Make a set as dense as an image is dark.
    Image(Box<GrayImage>),
    /// Make a set in a polygon.
    Cover(Box<PlanarPolygon>),
    /// Start a run by an engine.
    Sample(Which, Box<Recipe>, EngineChoice),
    /// Make a run or a combination; the current session stays until it is ready.
    Make(Box<Made>),
    /// Stop making and reading sessions, and close the notice.
    StopMaking,
    /// Show a session as the first run.
    Show(Box<Session>),
    /// Set the camera; without one, fit the whole domain.
    Camera(Option<Camera>),
    /// Add the step to undo of a run that is about to replace the current one.
    RememberRun(UndoPart),
    /// Drop all steps to undo, as another session is there.
    Forget,
    /// Show the first scene of the tour.
    StartTour,
    /// End the tour, if it is shown.
    EndTour,
    /// End the lesson or the tour, if one is open, and restore what it had replaced.
    GiveBack,
}

impl Effect {
    /// Asks for a run in place of the one that is shown, by the chosen engine.
    pub(crate) fn run(recipe: Recipe) -> Self {
        Self::Make(Box::new(Made::Run(recipe)))
    }
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

    /// Asks for a notice that is no error.
    pub(super) fn tell(&mut self, text: String) {
        self.ask(Effect::Tell(Notice::remark(text)));
    }

    /// Asks for a notice that something went wrong.
    pub(super) fn tell_error(&mut self, text: String) {
        self.ask(Effect::Tell(Notice::error(text)));
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

/// Opens the inspector on the selection of a run.
fn inspect(state: &mut State, which: Which) {
    // A selection may answer an open question: the window then gets no run.
    let question = state.classroom.lessons.open_question();
    let run = state.runs.get(which).filter(|_| question.is_none());
    state.window.inspect(run);
}

/// Makes the run or the combination of a file.
fn make(state: &mut State, made: Made) {
    match made {
        Made::Run(recipe) => state.start_sampling(Which::First, recipe, state.gpu.engine),
        Made::Combination(layout) => {
            state.files.stop_reading();
            state.with(|state, context| state.runs.combine(layout, context));
        }
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
        self.carry_out(which, context.effects);
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

    /// Carries out, in their order, the effects that parts or the page around the window ask for; notices name the run `which`.
    pub(crate) fn carry_out(&mut self, which: Which, effects: Vec<Effect>) {
        for effect in effects {
            match effect {
                Effect::Tell(notice) => self.messages.tell_of(which, notice),
                Effect::TellBriefly(text) => self.messages.tell_briefly(text),
                Effect::Add(text) => self.messages.add(Notice::remark(text)),
                Effect::CloseNotice => self.messages.notice = None,
                Effect::Copy(text) => self.window.copied = Some(text),
                Effect::Download(file) => self.files.downloads.push(file),
                Effect::SaveRadii(image, file) => {
                    if self.with(|state, context| state.files.save_new(*file, context)) {
                        self.form.saved_radii = Some(*image);
                    }
                }
                Effect::CloseFileSheet => self.files.sheet = None,
                Effect::Issue(command) => self.dispatch(*command),

                // What the window shows.
                Effect::Inspect => inspect(self, which),
                Effect::OpenPanel(panel) => self.window.open_panel(panel),
                Effect::Layout(layout) => self.window.layout = layout,
                Effect::BringPanels => self.past.bring_panels(&mut self.window),
                Effect::Appearance(appearance) => self.appearance.take(&appearance),
                Effect::Layers(layers, colouring) => {
                    (self.appearance.chosen_layers, self.appearance.colouring) =
                        (layers, colouring);
                }
                Effect::Camera(camera) => {
                    // Until there is a canvas to fit the domain into, the camera stays as it is.
                    let without_canvas = self.runs.first.camera;
                    self.runs.first.take_camera(camera, without_canvas);
                }
                Effect::Curve(curve) => self.appearance.curve = curve,
                Effect::Against(file) => self.analysis.reference_file = Some(file),
                Effect::Stops(stops) => self.with(|s, c| s.runs.first.put_stops(stops, c)),
                Effect::Pause => self.time.playback.stop(),
                Effect::EndLoop => self.time.playback.range = None,
                Effect::Clock(clock) => self.time.playback.choose(clock),
                Effect::Playback(playback) => self.time.playback = *playback,

                // Forms, runs, sessions, and steps back to earlier ones.
                Effect::Form(form) => self.form.take(*form),
                Effect::Image(image) => {
                    self.form.draft.set_image(*image);
                    self.run();
                }
                Effect::Cover(polygon) => {
                    self.form.draft.set_shape(ShapeSource::Polygon(*polygon));
                    self.run();
                }
                Effect::Pattern(own) => {
                    let before = Memento::of(self);
                    self.form.own_pattern = Some(*own);
                    let no_command = None;
                    self.remember(before, UndoPart::Form, no_command);
                }
                Effect::Sample(which, recipe, engine) => {
                    self.start_sampling(which, *recipe, engine);
                }
                Effect::Make(made) => make(self, *made),
                Effect::StopMaking => self.stop_making(),
                Effect::Show(session) => self.show(Which::First, *session),
                Effect::Open(opened) => self.show_opened(*opened),
                Effect::OpenLink(link) => self.open_link(&link),
                Effect::RememberRun(part) => self.remember_run(part),
                Effect::Forget => self.past.history = History::default(),
                Effect::StartTour => self.start_tour(),
                Effect::EndTour => self.end_tour(),
                Effect::GiveBack => self.give_back(),
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

    /// Carries out an effect that a lesson or a talk asks for.
    fn carry_out_of_class(&mut self, effect: classroom::Effect) {
        use classroom::Effect as E;

        match effect {
            E::Tell { text, is_error } => {
                self.messages.notice = Some(Notice {
                    is_error,
                    ..Notice::remark(text)
                });
            }
            E::EndTour => self.end_tour(),
            E::Begin => {
                self.end_tour();
                self.borrow_window();
                // The caption of a scene, or an older notice, would cover the lesson.
                (self.scenes.shown, self.messages.notice) = (None, None);
            }
            E::GiveBack(lesson) => self.give_back_of(Some(*lesson)),

            E::MakeRun(recipe) => {
                // The step's run takes the place of a run that an opened link may still wait for.
                self.runs.arriving = None;
                self.time.playback.stop();
                // Lessons need events, which only the CPU records.
                self.start_sampling(Which::First, *recipe, EngineChoice::Cpu);
            }

            E::ShowRun(recording, set, cursor) => self.with(|state, context| {
                let run = &mut state.runs.first;
                let set = set.as_deref();
                (state.time).show_recording((&recording, set), Some(cursor), run, context);
            }),
            E::ShowStep(view) => {
                self.appearance.chosen_layers = view.layers;
                self.with(|state, context| {
                    state.time.show_step(&view, &mut state.runs.first, context);
                });
            }

            // The second camera would count only where the first is missing.
            E::Look(camera) => self.runs.first.take_camera(Some(camera), camera),
            E::ShowSomeRun => {
                if self.runs.first.session.is_none() {
                    self.run();
                }
            }

            E::RememberFile(path) => self.files.remember_file(&path),
            E::Package(order) => {
                self.with(|state, context| state.files.start_packaging(*order, context));
            }
            E::Save(file) => {
                self.with(|state, context| state.files.save_new(file, context));
            }
            E::Copy(text) => self.window.copied = Some(text),
            E::CloseMenus => (self.window.finder, self.window.help) = (None, None),

            E::LessonOfScenes => {
                let made = self.runs.first.lesson_of_scenes();
                self.in_class(|class, context| class.present_scenes(made, context));
            }
        }
    }

    /// Runs `act` on the exports and their input, and carries out the effects it asks for.
    pub(super) fn in_exports<T>(
        &mut self,
        act: impl FnOnce(&mut Exports, ExportSource<'_>, Delivery, &mut Context) -> T,
    ) -> T {
        self.with(|state, context| {
            // The state is taken apart, because the exports are changed while they read its other parts.
            let Self {
                files,
                runs,
                time,
                appearance,
                analysis,
                scenes,
                window,
                ..
            } = state;

            let source = ExportSource {
                run: &runs.first,
                time,
                appearance,
                causes: analysis.causes(&runs.first, window),
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
            view: SavedView::of(self),
            layout: self.window.layout.clone(),
            has_panel: self.window.shows(Panel::Scenes),
            is_embedded: self.window.embedding.is_some(),
        };
        self.with(|state, context| {
            act(&mut state.scenes, &mut state.runs.first, &source, context);
        });
    }
}

/// What a lesson or the tour replaces, and gives back.
impl State {
    /// Sets aside what a lesson or the tour replaces, unless that was done already.
    fn borrow_window(&mut self) {
        // Where lessons follow each other, only the first one finds the user's own window, and sets it aside.
        if self.past.borrowed.is_some() {
            return;
        }

        let has_run = self.runs.first.session.is_some();
        let run = has_run.then(|| Box::new(self.runs.first.set_aside()));
        self.past.borrowed = Some(Box::new(Borrowed {
            panels: self.window.kept_panels(),
            form: self.form.clone(),
            appearance: self.appearance.clone(),
            playback: self.time.playback.clone(),
            scene: self.scenes.shown.take(),
            history: std::mem::take(&mut self.past.history),
            run,
            second: self.runs.second.take(),
        }));

        // A lesson shows another run, so that a loop in this one ends.
        let is_same_run = false;
        self.time.rest(is_same_run);
        // A window in a frame shows no panels, so that none need to be hidden.
        if self.window.embedding.is_none() {
            self.window.hide_sides();
        }
    }

    /// Ends the lesson or the tour, if one is open, and restores what it had replaced.
    pub(super) fn give_back(&mut self) {
        // Closing a lesson brings back what the lesson replaced.
        self.in_class(Classroom::close);
        self.end_tour();
    }

    /// Ends the tour, if it is shown, and restores what it had replaced.
    pub(super) fn end_tour(&mut self) {
        if self.scenes.is_touring() {
            self.scenes.shown = None;
            let no_lesson = None;
            self.give_back_of(no_lesson);
        }
    }

    /// Restores what a lesson that was closed, or the tour, had replaced.
    fn give_back_of(&mut self, lesson: Option<OpenLesson>) {
        let Some(borrowed) = self.past.borrowed.take() else {
            return;
        };
        let borrowed = *borrowed;

        self.window.put_back(borrowed.panels);
        self.form.take(borrowed.form);
        // Look and motion stay, as the user may have chosen them meanwhile.
        self.appearance.chosen_layers = borrowed.appearance.chosen_layers;
        self.appearance.colouring = borrowed.appearance.colouring;

        // Playback comes back as it was set, with its loop, but does not play on. A search for a breakpoint in the run
        // of the lesson ends.
        let is_same_run = false;
        self.time.rest(is_same_run);
        self.time.playback = borrowed.playback;
        self.time.playback.stop();
        self.scenes.shown = borrowed.scene;
        self.past.history = borrowed.history;
        self.runs.second = borrowed.second;

        match (borrowed.run, lesson) {
            // The user's run comes back, also if an opened link still waits for another one.
            (Some(run), _) => {
                self.runs.arriving = None;
                self.on(Which::First, |first, context| first.put_back(*run, context));
            }
            // A window that had no run before the lesson keeps the run of the lesson's step, and shows it whole.
            (None, Some(lesson)) => {
                if let Some(recording) = &lesson.run {
                    let set = lesson.set();
                    self.with(|state, context| {
                        let run = &mut state.runs.first;
                        let no_limit = None;
                        state.time.show_recording(
                            (recording, set.as_ref()),
                            no_limit,
                            run,
                            context,
                        );
                        run.verify(context);
                    });
                }
            }
            // After the tour, a window that had no run before it shows the run that its form describes.
            (None, None) => {
                let (typed, engine) = (self.form.recipe(), self.gpu.engine);
                self.on(Which::First, |run, context| {
                    run.end_as_started(typed, engine, context);
                });
            }
        }
    }

    /// Shows the first scene of the tour. Its scenes are of the run with the default parameters; what the window shows comes
    /// back when the tour ends.
    fn start_tour(&mut self) {
        self.give_back();
        self.classroom.lessons.shows_list = false;
        self.borrow_window();
        self.form.take(Form::default());
        // At the start of the program a link's run may still be being made, in which the scenes of the tour are not: it stops,
        // and the link with it. A run that was set aside is being made there.
        if self.runs.first.sampling.is_some() && self.runs.arriving.is_some() {
            self.runs.stop_making();
        }

        let borrowed = self.past.borrowed.as_ref();
        let known = borrowed.and_then(|borrowed| borrowed.session_of(&self.form.recipe()));
        if let Some(session) = known {
            self.on(Which::First, |run, context| {
                run.show_shared(&session, context);
                run.verify(context);
            });
        } else if self.runs.first.sampling.is_none() {
            // If the window had a run, that run is set aside by now, together with a run that was being made. So a run
            // is being made here only at the start of the program, when the window had no run yet. A tour begins by
            // itself only if the run that is being made is that of the default parameters.
            self.run();
        }
        self.in_scenes(|scenes, run, source, context| {
            scenes.show(SceneList::Tour, 0, run, source, context);
        });
    }
}
