//! The settings that stay, and those that undo restores, when another run replaces the current one.

use serde_json::{Value, json};
use tilescope_core::{Order, Parameter};
use tilescope_debugger::{Listings, Marked, SavedScene};
use tilescope_session::combination::CombineCommand;
use tilescope_session::layers::Layer;
use tilescope_session::selection::Selection;
use tilescope_workbench::command::{
    AppearanceCommand, DebugCommand, FormCommand, LinkCommand, TimeCommand, ViewCommand, Which,
    WindowCommand,
};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::draft::Choice;
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::scenes::SceneCommand;
use tilescope_workbench::{Command, State};

use crate::exporting::opened;

fn apply(state: &mut State, command: Command) {
    state.apply(command);
    state.settle();
}

fn run_with(state: &mut State, field: Parameter, text: &str) {
    apply(
        state,
        Command::Form(FormCommand::Type(field, text.to_owned())),
    );
    apply(state, Command::Run);
}

fn debug(state: &mut State, command: DebugCommand) {
    apply(state, Command::Debug(command));
}

/// A state with a scene, its note, a breakpoint with a condition, and a watch.
fn lecture() -> State {
    let mut state = opened();
    let line = Listings::shipped().find("eliminate.5").unwrap();
    apply(&mut state, Command::Time(TimeCommand::Jump(3_000)));
    for command in [
        DebugCommand::ToggleBreakpoint(line),
        DebugCommand::Condition(0, "distance < 0.4".to_owned()),
        DebugCommand::Watch("distance".to_owned()),
    ] {
        debug(&mut state, command);
    }
    for command in [
        SceneCommand::Add,
        SceneCommand::Caption(0, "here".to_owned()),
    ] {
        state.apply(Command::Scene(command));
    }
    let last = state.runs().first.cursor().unwrap().1;
    apply(&mut state, Command::Time(TimeCommand::Jump(last)));
    state.apply(Command::Scene(SceneCommand::Add));
    state.apply(Command::Scene(SceneCommand::Caption(
        1,
        "the end".to_owned(),
    )));
    state
}

fn marks(state: &State) -> Vec<(Marked, String)> {
    let debugger = state.runs().first.debugger.as_ref().unwrap();
    let marks = debugger.scenes.iter();
    marks
        .map(|mark| (debugger.marked(mark), mark.caption.clone()))
        .collect()
}

/// Breakpoints and watches.
fn stops(state: &State) -> (Vec<String>, Vec<String>) {
    let debugger = state.runs().first.debugger.as_ref().unwrap();
    let conditions = debugger.breakpoints().iter().map(|b| b.condition.clone());
    (conditions.collect(), debugger.watches.clone())
}

#[test]
fn scenes_and_notes_survive_other_parameters_and_come_back_exactly() {
    let mut state = lecture();
    let (set, others) = (marks(&state), stops(&state));
    let seed = state.form().draft.text(Parameter::Seed).to_owned();
    assert!(matches!(set[0].0, Marked::Here(3_000)));
    run_with(&mut state, Parameter::Seed, "7");
    let there = marks(&state);
    assert_eq!(there.len(), 2);
    let end = state.runs().first.cursor().unwrap().1;
    assert!(matches!(there[0].0, Marked::Like(_)));
    assert_eq!(there[1], (Marked::Like(end), "the end".to_owned()));
    assert_eq!(stops(&state), others);
    // A run without events and a combination keep them without showing them.
    apply(&mut state, Command::Combine(CombineCommand::Nine));
    assert!(state.runs().first.debugger.is_none());
    run_with(&mut state, Parameter::Seed, &seed);
    assert_eq!((marks(&state), stops(&state)), (set, others));
}

#[test]
fn scenes_of_other_runs_are_in_sessions_and_links() {
    let mut state = lecture();
    run_with(&mut state, Parameter::Radius, "0.08");
    state.apply(Command::Scene(SceneCommand::Add));
    let set = state.runs().first.debugger.as_ref().unwrap().scenes.clone();
    assert_eq!(set.len(), 3);
    assert!(
        marks(&state)
            .iter()
            .any(|(marked, _)| *marked == Marked::Nowhere)
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lecture.json");
    let path = path.to_string_lossy().into_owned();
    for (purpose, state) in [(Purpose::Save, &mut state), (Purpose::Open, &mut opened())] {
        for command in [
            FileCommand::Sheet(purpose),
            FileCommand::Path(path.clone()),
            FileCommand::Go,
        ] {
            apply(state, Command::File(command));
        }
        assert_eq!(
            state.runs().first.debugger.as_ref().unwrap().scenes,
            set,
            "{purpose:?}"
        );
    }
    let link = state.link();
    let mut there = opened();
    apply(
        &mut there,
        Command::Link(LinkCommand::Open(link.fragment.clone())),
    );
    assert_eq!(there.messages().notice, None);
    let said = |scenes: &[SavedScene]| -> Vec<(usize, String, String, Value)> {
        let said = scenes.iter().map(|scene| {
            // The layout is in the session alone.
            let mut view = scene.view.clone();
            view.as_object_mut().unwrap().remove("layout");
            (scene.event, scene.caption.clone(), scene.run.clone(), view)
        });
        said.collect()
    };
    let scenes = &there.runs().first.debugger.as_ref().unwrap().scenes;
    assert_eq!(said(scenes), said(&set));
    assert_eq!(link.left_out, [""; 0]);
    assert_eq!(there.link().fragment, link.fragment);
}

#[test]
fn scenes_stay_with_the_first_run_after_a_swap() {
    let mut state = lecture();
    let set = marks(&state);
    let start = CompareCommand::Start(ComparePreset::NextSeed);
    apply(&mut state, Command::Compare(start));
    apply(&mut state, Command::Compare(CompareCommand::Swap));
    assert_eq!(marks(&state).len(), set.len());
    // They are kept although the run in which they were set is closed.
    apply(&mut state, Command::Compare(CompareCommand::Close));
    assert_eq!(marks(&state)[1].1, "the end");
}

#[test]
fn selection_and_query_are_kept_if_they_still_apply() {
    let mut state = opened();
    debug(&mut state, DebugCommand::Query("kind:insert".to_owned()));
    state.apply(Command::View(
        Which::First,
        ViewCommand::Pick(Selection::Sample(40)),
    ));
    apply(&mut state, Command::Time(TimeCommand::Loop(Some(100..400))));
    apply(&mut state, Command::Run);
    assert_eq!(state.runs().first.selected, Some(40));
    assert!(!state.runs().first.history_found.events().is_empty());
    assert_eq!(state.time().playback.range, Some(100..400));
    // In another run the sample is a different one, but a place stays the same.
    let place = [20.5, 20.25];
    run_with(&mut state, Parameter::Seed, "7");
    assert_eq!(
        (
            state.runs().first.selected,
            state.time().playback.range.clone()
        ),
        (None, None)
    );
    state.apply(Command::View(
        Which::First,
        ViewCommand::Pick(Selection::Place(place.into())),
    ));
    run_with(&mut state, Parameter::Seed, "8");
    assert_eq!(state.runs().first.place, Some(place.into()));
    run_with(&mut state, Parameter::Radius, "0.05");
    assert_eq!(state.runs().first.place, None);
    // The events found are of this run.
    let debugger = state.runs().first.debugger.as_ref().unwrap();
    let found = state.runs().first.query.found.events();
    let inserted = |&event: &usize| {
        let event = debugger.recording().event(event);
        event.is_some_and(|event| event.kind() == tilescope_debugger::EventKind::Insert)
    };
    assert!(!found.is_empty() && found.iter().all(inserted));
}

/// The radius of the panel, the one of the run shown, and whether the window says that they differ.
fn radii(state: &State) -> (String, String, bool) {
    let run = state
        .runs()
        .first
        .session
        .as_ref()
        .unwrap()
        .run()
        .parameters
        .radius;
    let typed = state.form().draft.text(Parameter::Radius).to_owned();
    (
        typed,
        run.to_string(),
        state
            .form()
            .remark(&state.runs().first, state.gpu())
            .is_some(),
    )
}

fn agreed(radius: &str) -> (String, String, bool) {
    (radius.to_owned(), radius.to_owned(), false)
}

#[test]
fn undoing_a_run_restores_parameters_and_run_together() {
    let mut state = opened();
    let first = state
        .runs()
        .first
        .session
        .as_ref()
        .unwrap()
        .digest()
        .to_owned();
    for text in ["0.0", "0.04"] {
        apply(
            &mut state,
            Command::Form(FormCommand::Type(Parameter::Radius, text.to_owned())),
        );
    }
    apply(
        &mut state,
        Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::Order,
            json!(Order::Index),
        ))),
    );
    let remark = state
        .form()
        .remark(&state.runs().first, state.gpu())
        .unwrap();
    assert!(remark.contains("radius") && remark.contains("who wins") && !remark.contains("seed"));
    apply(&mut state, Command::Run);
    assert_eq!(radii(&state), agreed("0.04"));
    let second = state
        .runs()
        .first
        .session
        .as_ref()
        .unwrap()
        .digest()
        .to_owned();
    // Changes of the view are not steps.
    for command in [
        Command::Window(WindowCommand::OpenPanel(Panel::Scenes)),
        Command::Window(WindowCommand::OpenPanel(Panel::Watches)),
        Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Disks)),
    ] {
        apply(&mut state, command);
    }
    let looked_at = (
        state.window().layout.clone(),
        state.appearance().chosen_layers,
    );
    apply(&mut state, Command::Undo);
    assert_eq!(radii(&state), agreed("0.02"));
    assert_eq!(state.runs().first.session.as_ref().unwrap().digest(), first);
    assert_eq!(state.form().draft.parameters.order, Order::default());
    apply(&mut state, Command::Redo);
    assert_eq!(radii(&state), agreed("0.04"));
    assert_eq!(
        state.runs().first.session.as_ref().unwrap().digest(),
        second
    );
    assert_eq!(
        (
            state.window().layout.clone(),
            state.appearance().chosen_layers
        ),
        looked_at
    );
}

#[test]
fn typed_parameters_without_a_run_are_undone_by_themselves() {
    let mut state = opened();
    run_with(&mut state, Parameter::Radius, "0.03");
    apply(
        &mut state,
        Command::Form(FormCommand::Type(Parameter::Radius, "0.05".to_owned())),
    );
    let differs = |typed: &str, run: &str| (typed.to_owned(), run.to_owned(), true);
    assert_eq!(radii(&state), differs("0.05", "0.03"));
    apply(&mut state, Command::Undo);
    assert_eq!(radii(&state), agreed("0.03"));
    apply(&mut state, Command::Undo);
    assert_eq!(radii(&state), agreed("0.02"));
    for expected in [agreed("0.03"), differs("0.05", "0.03")] {
        apply(&mut state, Command::Redo);
        assert_eq!(radii(&state), expected);
    }
    // Unreadable text also differs from the run.
    apply(
        &mut state,
        Command::Form(FormCommand::Type(Parameter::Radius, "0.03x".to_owned())),
    );
    assert!(radii(&state).2);
}

#[test]
fn a_run_being_made_is_undone_with_its_parameters() {
    let mut state = opened();
    for text in ["0.03", "0.025"] {
        state.apply(Command::Form(FormCommand::Type(
            Parameter::Radius,
            text.to_owned(),
        )));
        state.apply(Command::Run);
    }
    apply(&mut state, Command::Undo);
    assert_eq!(radii(&state), agreed("0.02"));
    apply(&mut state, Command::Redo);
    assert_eq!(radii(&state), agreed("0.025"));
    // Undo while it is being made.
    state.apply(Command::Form(FormCommand::Type(
        Parameter::Radius,
        "0.03".to_owned(),
    )));
    state.apply(Command::Run);
    apply(&mut state, Command::Undo);
    assert_eq!(radii(&state), agreed("0.025"));
    apply(&mut state, Command::Redo);
    assert_eq!(radii(&state), agreed("0.03"));
}

#[test]
fn undoing_a_combination_or_a_link_restores_the_run_before() {
    let mut state = opened();
    run_with(&mut state, Parameter::Radius, "0.03");
    apply(&mut state, Command::Combine(CombineCommand::Nine));
    assert!(
        state
            .form()
            .remark(&state.runs().first, state.gpu())
            .is_some()
    );
    apply(&mut state, Command::Undo);
    assert_eq!(radii(&state), agreed("0.03"));
    apply(
        &mut state,
        Command::Link(LinkCommand::Open("v=1&radius=0.05&leaf=8".to_owned())),
    );
    assert_eq!(radii(&state), agreed("0.05"));
    apply(&mut state, Command::Undo);
    assert_eq!(radii(&state), agreed("0.03"));
    apply(&mut state, Command::Redo);
    assert_eq!(radii(&state), agreed("0.05"));
}

#[test]
fn what_was_made_is_undone_and_where_one_looked_is_not() {
    let mut state = opened();
    let scenes = |state: &State| {
        let debugger = state.runs().first.debugger.as_ref().unwrap();
        let notes = debugger.scenes.iter().map(|mark| mark.caption.clone());
        notes.collect::<Vec<_>>()
    };
    apply(&mut state, Command::Scene(SceneCommand::Add));
    for note in ["a", "an", "and"] {
        let caption = SceneCommand::Caption(0, note.to_owned());
        apply(&mut state, Command::Scene(caption));
    }
    let line = tilescope_debugger::Listings::shipped().find("eliminate.5");
    let line = line.expect("a line");
    apply(
        &mut state,
        Command::Debug(DebugCommand::ToggleBreakpoint(line)),
    );
    apply(
        &mut state,
        Command::Window(WindowCommand::HidePanel(Panel::Legend)),
    );
    // Looking around is no step.
    for command in [
        Command::Window(WindowCommand::OpenPanel(Panel::Events)),
        Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Disks)),
        Command::View(Which::First, ViewCommand::Fit),
        Command::Time(TimeCommand::FirstStage),
        Command::Debug(DebugCommand::Query("insert".to_owned())),
    ] {
        apply(&mut state, command);
    }
    let layers = state.appearance().chosen_layers;
    apply(&mut state, Command::Undo);
    assert!(state.window().layout.hidden().is_empty());
    apply(&mut state, Command::Undo);
    let debugger = state.runs().first.debugger.as_ref().unwrap();
    assert!(debugger.breakpoints().is_empty());
    assert_eq!(scenes(&state), ["and"]);
    apply(&mut state, Command::Undo);
    assert_eq!(scenes(&state), [""], "typing is one step");
    apply(&mut state, Command::Undo);
    assert!(scenes(&state).is_empty());
    assert_eq!(state.appearance().chosen_layers, layers);
    for _ in 0..2 {
        apply(&mut state, Command::Redo);
    }
    assert_eq!(scenes(&state), ["and"]);
    apply(&mut state, Command::Scene(SceneCommand::Remove(0)));
    apply(&mut state, Command::Undo);
    assert_eq!(scenes(&state), ["and"], "a removed scene comes back");
}
