//! What lessons and the tour borrow of the window, and how it is given back: panels, parameters, run, moment and camera. They
//! borrow once, however many lessons follow each other; [`State::give_back`] ends them.

use std::sync::Arc;

use tilescope_debugger::Recording;
use tilescope_session::session::Session;

use super::undo::History;
use super::window::KeptPanels;
use super::{Form, RunView, State};
use crate::appearance::Appearance;
use crate::classroom::Classroom;
use crate::clock::Playback;
use crate::command::Which;
use crate::compare::Comparison;
use crate::layout::Layout;
use crate::lessons::OpenLesson;
use crate::scenes::ShownScene;

/// The parts of the state that a lesson or the tour replaces.
pub(super) struct Borrowed {
    panels: KeptPanels,
    form: Form,
    appearance: Appearance,
    playback: Playback,
    scene: Option<ShownScene>,
    history: History,
    /// The run that was shown; `None` if the first run was still being made.
    run: Option<Box<RunView>>,
    second: Option<(RunView, Comparison)>,
}

impl State {
    /// Sets aside what a lesson or the tour replaces, unless it is already.
    pub(super) fn borrow_window(&mut self) {
        if self.borrowed.is_some() {
            return;
        }
        let has_run = self.runs.first.session.is_some();
        let run = has_run.then(|| Box::new(self.runs.first.set_aside()));
        self.borrowed = Some(Box::new(Borrowed {
            panels: self.window.kept_panels(),
            form: self.form.clone(),
            appearance: self.appearance.clone(),
            playback: self.time.playback.clone(),
            scene: self.scene.take(),
            history: std::mem::take(&mut self.history),
            run,
            second: self.runs.second.take(),
        }));
        self.time.rest(false);
        // A window in a frame has no panels; its layout is that of the whole app.
        if self.window.embedding.is_none() {
            self.window.hide_sides();
        }
    }

    /// Shows the session that was set aside, at its end, if the parameters are those of its run. Returns whether it is
    /// shown.
    pub(super) fn show_borrowed_session(&mut self) -> bool {
        let borrowed = self.borrowed.as_ref();
        let run = borrowed.and_then(|borrowed| borrowed.run.as_ref());
        let session = run.and_then(|run| run.session.clone());
        let typed = self.typed();
        let is_same = |session: &&Arc<Session>| {
            session.has_recipe() && session.recipe() == typed && session.recording().is_some()
        };
        let Some(session) = session.as_ref().filter(is_same) else {
            return false;
        };
        self.on(Which::First, |run, context| {
            run.show_shared(session, context);
            run.verify(context);
        });
        true
    }

    /// Ends the lesson or the tour, if one is open, and restores what it had replaced.
    pub(super) fn give_back(&mut self) {
        // To close a lesson gives back what it replaced.
        self.in_class(Classroom::close);
        self.end_tour();
    }

    /// Ends the tour, if it is shown, and restores what it had replaced.
    pub(super) fn end_tour(&mut self) {
        if self.is_touring() {
            self.scene = None;
            self.give_back_of(None);
        }
    }

    /// Restores what a lesson that was closed, or the tour, had replaced.
    pub(super) fn give_back_of(&mut self, lesson: Option<OpenLesson>) {
        let Some(borrowed) = self.borrowed.take() else {
            return;
        };
        let borrowed = *borrowed;
        self.window.put_back(borrowed.panels);
        let live = self.form.live;
        self.form = Form {
            live,
            ..borrowed.form
        };
        self.appearance.chosen_layers = borrowed.appearance.chosen_layers;
        self.appearance.colouring = borrowed.appearance.colouring;
        self.time.rest(false);
        self.time.playback = borrowed.playback;
        self.time.playback.stop();
        self.scene = borrowed.scene;
        self.history = borrowed.history;
        self.runs.second = borrowed.second;
        match (borrowed.run, lesson) {
            (Some(run), _) => self.put_run_back(*run),
            (None, Some(lesson)) => self.keep_run_of_lesson(lesson.run.as_ref()),
            (None, None) => self.end_at_first_run(),
        }
    }

    /// Shows the whole run of a lesson that was closed, if it was made, and verifies it.
    fn keep_run_of_lesson(&mut self, run: Option<&Arc<Recording>>) {
        if let Some(run) = run {
            self.show_recording(run, None);
            self.on(Which::First, |run, context| run.verify(context));
        }
    }

    /// Shows a recorded run, whole or up to a cursor, without verifying it.
    pub(super) fn show_recording(&mut self, run: &Arc<Recording>, limit: Option<usize>) {
        self.jobs.generation += 1;
        let shown = match limit {
            Some(cursor) => Arc::new(run.until(cursor)),
            None => Arc::clone(run),
        };
        let session = Session::from_recording(shown, self.jobs.generation);
        let same_run = self.runs.first.is_same_run(&session);
        self.time.rest(same_run);
        self.on(Which::First, |run, context| {
            run.show_unverified(session, context);
        });
    }

    fn put_run_back(&mut self, run: RunView) {
        let stops = self.runs.first.take_stops();
        let viewport = self.runs.first.viewport;
        self.links.arriving = None;
        self.runs.first = run;
        self.on(Which::First, |run, context| {
            // The window may have another size now.
            run.follow_viewport(viewport);
            drop(run.take_stops());
            run.put_stops(stops, context);
        });
    }

    /// Ends the tour of a program that had no run before it: its first run is shown as after the start.
    fn end_at_first_run(&mut self) {
        let run = &self.runs.first;
        let typed = self.typed();
        let session = run.session.as_ref();
        let is_typed = session.is_some_and(|made| made.has_recipe() && made.recipe() == typed);
        if is_typed && run.sampling.is_none() {
            self.on(Which::First, |run, context| {
                run.show_stage(usize::MAX);
                run.fit(context);
            });
        } else if session.is_some() {
            // The tour has made another run since.
            self.start_sampling(Which::First, typed, self.gpu.engine);
        }
    }

    /// Returns the layout to store: while a lesson or the tour hides panels, the one before it.
    #[must_use]
    pub fn layout_to_store(&self) -> &Layout {
        let borrowed = self.borrowed.as_ref();
        borrowed.map_or(&self.window.layout, |borrowed| borrowed.panels.layout())
    }

    /// Brings back the panels that the tour has hidden, while the tour goes on.
    pub(super) fn bring_panels(&mut self) {
        if let Some(borrowed) = &self.borrowed
            && self.window.embedding.is_none()
        {
            self.window.put_back(borrowed.panels.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::settled;
    use crate::State;
    use crate::command::{
        AppearanceCommand, Command, FormCommand, TimeCommand, ViewCommand, Which, WindowCommand,
    };
    use crate::draft::Field;
    use crate::layout::Panel;
    use crate::lessons::LessonCommand;
    use crate::scenes::{SceneCommand, SceneList};
    use crate::tour::tour;
    use tilescope_debugger::Direction;
    use tilescope_lessons::shipped::TEMPLATE;
    use tilescope_session::layers::Layer;
    use tilescope_session::selection::Selection;

    fn apply(state: &mut State, command: Command) {
        state.apply(command);
        state.settle();
    }

    fn view(state: &mut State, command: ViewCommand) {
        apply(state, Command::View(Which::First, command));
    }

    fn window(state: &mut State, command: WindowCommand) {
        apply(state, Command::Window(command));
    }

    fn scene(state: &mut State, command: SceneCommand) {
        apply(state, Command::Scene(command));
    }

    /// A window at work: other parameters than the default ones, which are not all run, a moment, a camera, a layer and a
    /// panel of the user's choice.
    fn at_work() -> State {
        let mut state = settled();
        for (field, text) in [(Field::Seed, "7"), (Field::Radius, "0.03")] {
            let command = FormCommand::Type(field, text.to_owned());
            apply(&mut state, Command::Form(command));
        }
        apply(&mut state, Command::Run);
        let command = FormCommand::Type(Field::Leaf, "9".to_owned());
        apply(&mut state, Command::Form(command));
        apply(&mut state, Command::Time(TimeCommand::Jump(700)));
        window(&mut state, WindowCommand::HidePanel(Panel::Legend));
        window(&mut state, WindowCommand::OpenPanel(Panel::Events));
        let layer = AppearanceCommand::ToggleLayer(Layer::Voronoi);
        apply(&mut state, Command::Appearance(layer));
        view(&mut state, ViewCommand::FlyTo([9.0, 11.0].into(), 8.0));
        while state.advance(0.1) {}
        view(&mut state, ViewCommand::Pick(Selection::Sample(12)));
        state
    }

    /// Everything that is given back, as text.
    fn seen(state: &State) -> String {
        let run = &state.runs.first;
        let session = run.session.as_ref().unwrap();
        format!(
            "{:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?}",
            session.recipe(),
            session.generation,
            state.cursor(),
            (run.camera, run.is_fitted(), run.selection()),
            state.window.layout,
            state.form.draft,
            state.appearance,
            state.time.playback,
            run.stops().scenes,
            state.can_undo(),
        )
    }

    fn lesson(state: &mut State, command: LessonCommand) {
        apply(state, Command::Lesson(command));
    }

    fn open_template(state: &mut State) {
        let read = LessonCommand::Read("template".to_owned(), TEMPLATE.to_owned());
        lesson(state, read);
        lesson(state, LessonCommand::Step(Direction::Forwards));
        assert!(state.classroom.lessons.open_question().is_some());
    }

    #[test]
    fn a_lesson_gives_back_what_it_borrowed() {
        let mut state = at_work();
        let before = seen(&state);
        let layout = state.window.layout.clone();
        open_template(&mut state);
        assert!(!state.window.shows_sides());
        // A click that answers opens no panel, and tells nothing about what was clicked.
        view(&mut state, ViewCommand::Pick(Selection::Sample(3)));
        view(&mut state, ViewCommand::Inspect);
        assert!(!state.window.shows_sides() && !state.window.shows(Panel::Inspector));
        assert_ne!(seen(&state), before);
        // What a program stores that is closed now is the layout that comes back.
        assert_eq!(state.layout_to_store(), &layout);
        lesson(&mut state, LessonCommand::Leave);
        assert_eq!(seen(&state), before);
        assert!(state.verdict().is_some());
        // Panels that were opened during the lesson are not those from before it, and a second lesson borrows the same.
        open_template(&mut state);
        window(&mut state, WindowCommand::OpenPanel(Panel::Inspector));
        open_template(&mut state);
        window(&mut state, WindowCommand::ToggleSides);
        lesson(&mut state, LessonCommand::Leave);
        assert_eq!(seen(&state), before);
    }

    #[test]
    fn outside_of_questions_a_click_opens_the_inspector() {
        let mut state = settled();
        window(&mut state, WindowCommand::ToggleSides);
        view(&mut state, ViewCommand::Pick(Selection::Sample(3)));
        view(&mut state, ViewCommand::Inspect);
        assert!(state.window.shows(Panel::Inspector));
    }

    #[test]
    fn scenes_that_were_made_in_a_lesson_stay() {
        let mut state = at_work();
        scene(&mut state, SceneCommand::Add);
        open_template(&mut state);
        scene(&mut state, SceneCommand::Add);
        lesson(&mut state, LessonCommand::Leave);
        assert_eq!(state.scenes(SceneList::Own).len(), 2);
    }

    #[test]
    fn a_lesson_that_opens_the_window_leaves_its_run() {
        let mut state = State::new(std::sync::Arc::new(|| {}));
        open_template(&mut state);
        lesson(&mut state, LessonCommand::Leave);
        assert!(state.window.shows_sides() && state.verdict().is_some());
    }

    #[test]
    fn the_tour_gives_back_camera_run_and_parameters() {
        let mut state = at_work();
        let before = seen(&state);
        scene(&mut state, SceneCommand::Tour);
        assert!(!state.window.shows_sides());
        scene(&mut state, SceneCommand::Step(Direction::Forwards));
        scene(&mut state, SceneCommand::Leave);
        assert_eq!(seen(&state), before);
        // The same at its end, after the set was broken.
        scene(&mut state, SceneCommand::Tour);
        let offers = tour().iter().position(|scene| !scene.offers.is_empty());
        for _ in 0..offers.unwrap() {
            scene(&mut state, SceneCommand::Step(Direction::Forwards));
        }
        scene(&mut state, SceneCommand::Offer(0));
        assert!(!state.verdict().unwrap().report.maximal() && state.is_touring());
        // The other button mends it.
        scene(&mut state, SceneCommand::Offer(1));
        assert!(state.verdict().unwrap().report.maximal());
        scene(&mut state, SceneCommand::Offer(0));
        while state.is_touring() {
            scene(&mut state, SceneCommand::Step(Direction::Forwards));
        }
        assert_eq!(seen(&state), before);
    }

    #[test]
    fn the_first_tour_ends_at_the_first_run_with_all_panels() {
        let mut state = State::new(std::sync::Arc::new(|| {}));
        let layout = state.window.layout.clone();
        state.apply(Command::Scene(SceneCommand::Tour));
        state.settle();
        assert!(!state.window.shows_sides());
        let last = tour().len() - 1;
        for _ in 0..last {
            scene(&mut state, SceneCommand::Step(Direction::Forwards));
        }
        // The last card leads to the panels.
        assert_eq!(state.window.layout, layout);
        assert!(state.is_touring());
        scene(&mut state, SceneCommand::Step(Direction::Backwards));
        scene(&mut state, SceneCommand::Offer(0));
        scene(&mut state, SceneCommand::Leave);
        let session = state.runs.first.session.as_ref().unwrap();
        assert_eq!(session.recipe(), state.typed());
        assert!(state.runs.first.is_at_end() && state.runs.first.is_fitted());
        assert_eq!(state.window.layout, layout);
        assert!(state.verdict().unwrap().report.maximal());
    }

    #[test]
    fn own_work_ends_the_tour_where_the_user_was_before() {
        let mut state = at_work();
        let seed = state.form.draft.parameters.seed;
        scene(&mut state, SceneCommand::Tour);
        let command = FormCommand::Nudge(Field::Seed, 1);
        apply(&mut state, Command::Form(command));
        assert!(!state.is_touring() && state.window.shows_sides());
        assert_eq!(state.form.draft.parameters.seed, seed + 1);
    }
}
