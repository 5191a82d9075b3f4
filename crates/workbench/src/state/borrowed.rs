//! What lessons and the tour borrow of the window, and how it is given back: panels, parameters, run, moment and camera. They
//! borrow once, however many lessons follow each other; `State::give_back` in `effects.rs` ends them.

use std::sync::Arc;

use tilescope_session::recipe::Recipe;
use tilescope_session::session::Session;

use super::undo::History;
use super::window::KeptPanels;
use super::{Form, RunView};
use crate::appearance::Appearance;
use crate::clock::Playback;
use crate::compare::Comparison;
use crate::layout::Layout;
use crate::scenes::ShownScene;

/// The parts of the state that a lesson or the tour replaces.
pub(super) struct Borrowed {
    pub panels: KeptPanels,
    pub form: Form,
    pub appearance: Appearance,
    pub playback: Playback,
    pub scene: Option<ShownScene>,
    pub history: History,
    /// The run that was shown; `None` if the first run was still being made.
    pub run: Option<Box<RunView>>,
    /// The second run with the comparison, if there was one.
    pub second: Option<(RunView, Comparison)>,
}

impl Borrowed {
    /// Returns the layout that was replaced.
    pub(super) const fn layout(&self) -> &Layout {
        self.panels.layout()
    }

    /// Returns the session that was set aside, if it is the recorded run of a recipe.
    pub(super) fn session_of(&self, recipe: &Recipe) -> Option<Arc<Session>> {
        let session = self.run.as_ref()?.session.as_ref()?;
        let is_same = session.has_recipe() && session.recipe() == *recipe;
        let is_recorded = is_same && session.recording().is_some();
        is_recorded.then(|| Arc::clone(session))
    }
}

#[cfg(test)]
mod tests {
    use super::super::State;
    use super::super::tests::settled;
    use crate::command::{
        AppearanceCommand, Command, FormCommand, TimeCommand, ViewCommand, Which, WindowCommand,
    };
    use crate::layout::Panel;
    use crate::scenes::{SceneCommand, SceneList};
    use crate::tour::tour;
    use tilescope_classroom::lessons::LessonCommand;
    use tilescope_core::{Parameter, Parameters};
    use tilescope_debugger::Direction;
    use tilescope_lessons::shipped::TEMPLATE;
    use tilescope_session::layers::Layer;
    use tilescope_session::recipe::Recipe;
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
        for (field, text) in [(Parameter::Seed, "7"), (Parameter::Radius, "0.03")] {
            let command = FormCommand::Type(field, text.to_owned());
            apply(&mut state, Command::Form(command));
        }
        apply(&mut state, Command::Run);
        let command = FormCommand::Type(Parameter::Leaf, "9".to_owned());
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
            state.runs.first.cursor(),
            (run.camera, run.is_fitted(), run.selection()),
            state.window.layout,
            state.form.draft,
            state.appearance,
            state.time.playback,
            run.stops().scenes,
            state.past.history.can_undo(),
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
        // A click that answers opens no panel, and tells nothing about the clicked object.
        view(&mut state, ViewCommand::Pick(Selection::Sample(3)));
        view(&mut state, ViewCommand::Inspect);
        assert!(!state.window.shows_sides() && !state.window.shows(Panel::Inspector));
        assert_ne!(seen(&state), before);
        // What a program stores that is closed now is the layout that comes back.
        assert_eq!(state.past.layout_to_store(&state.window), &layout);
        lesson(&mut state, LessonCommand::Leave);
        assert_eq!(seen(&state), before);
        assert!(state.runs.first.verdict().is_some());
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
        assert_eq!(SceneList::Own.scenes(&state.runs.first).len(), 2);
    }

    #[test]
    fn a_lesson_that_opens_the_window_leaves_its_run() {
        let mut state = State::new(std::sync::Arc::new(|| {}));
        open_template(&mut state);
        lesson(&mut state, LessonCommand::Leave);
        assert!(state.window.shows_sides() && state.runs.first.verdict().is_some());
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
        assert!(!state.runs.first.verdict().unwrap().report.maximal() && state.scenes.is_touring());
        // The other button mends it.
        scene(&mut state, SceneCommand::Offer(1));
        assert!(state.runs.first.verdict().unwrap().report.maximal());
        scene(&mut state, SceneCommand::Offer(0));
        while state.scenes.is_touring() {
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
        assert!(state.scenes.is_touring());
        // The card before it offers the comparison with exact tiling, and the one before that breaks the set.
        scene(&mut state, SceneCommand::Step(Direction::Backwards));
        scene(&mut state, SceneCommand::Offer(0));
        assert!(state.runs.second.is_some());
        scene(&mut state, SceneCommand::Offer(1));
        assert!(state.runs.second.is_none());
        scene(&mut state, SceneCommand::Step(Direction::Backwards));
        scene(&mut state, SceneCommand::Offer(0));
        scene(&mut state, SceneCommand::Leave);
        let session = state.runs.first.session.as_ref().unwrap();
        assert_eq!(session.recipe(), state.form.recipe());
        assert!(state.runs.first.is_at_end() && state.runs.first.is_fitted());
        assert_eq!(state.window.layout, layout);
        assert!(state.runs.first.verdict().unwrap().report.maximal());
    }

    #[test]
    fn a_tour_at_the_start_is_not_shown_in_the_run_of_a_link() {
        let mut state = State::new(std::sync::Arc::new(|| {}));
        state.open_link("v=1&radius=0.03");
        state.apply(Command::Scene(SceneCommand::Tour));
        state.settle();
        let session = state.runs.first.session.as_ref().unwrap();
        assert_eq!(session.recipe(), Recipe::from(Parameters::default()));
        assert!(state.scenes.is_touring());

        // Control: without the tour the link's run is made.
        let mut state = State::new(std::sync::Arc::new(|| {}));
        state.open_link("v=1&radius=0.03");
        state.settle();
        let session = state.runs.first.session.as_ref().unwrap();
        assert_ne!(session.recipe(), Recipe::from(Parameters::default()));
    }

    #[test]
    fn own_work_ends_the_tour_where_the_user_was_before() {
        let mut state = at_work();
        let seed = state.form.draft.parameters.seed;
        scene(&mut state, SceneCommand::Tour);
        let command = FormCommand::Nudge(Parameter::Seed, 1);
        apply(&mut state, Command::Form(command));
        assert!(!state.scenes.is_touring() && state.window.shows_sides());
        assert_eq!(state.form.draft.parameters.seed, seed + 1);
    }
}
