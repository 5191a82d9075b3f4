//! Two runs side by side: differences, divergence, and linked cameras and playback.

use egui::{Key, Modifiers, vec2};
use egui_kittest::Harness;
use serde_json::json;
use tilescope_app::App;
use tilescope_core::{Boundary, Parameter, Stage};
use tilescope_debugger::{Direction, Divergence, Step};
use tilescope_workbench::clock::Clock;
use tilescope_workbench::command::{FormCommand, TimeCommand, ViewCommand, Which, WindowCommand};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::draft::Choice;
use tilescope_workbench::layout::Panel;
use tilescope_workbench::state::{RunView, Settings};
use tilescope_workbench::{Command, State};

use crate::support::{is_disabled, node, opened, session, settle, text};

fn apply(harness: &mut Harness<'_, App>, command: Command) {
    harness.state_mut().state.apply(command);
    settle(harness);
}

fn compared(preset: ComparePreset) -> Harness<'static, App> {
    let mut harness = opened();
    apply(
        &mut harness,
        Command::Compare(CompareCommand::Start(preset)),
    );
    harness
}

fn second(state: &State) -> &RunView {
    &state.runs().second.as_ref().expect("a second run").0
}

fn divergence(state: &State) -> Divergence {
    let (side, comparison) = state.runs().second.as_ref().expect("a second run");
    let (a, b) = (
        state.runs().first.session.as_ref().unwrap(),
        side.session.as_ref().unwrap(),
    );
    comparison.divergence(a, b).expect("known").clone()
}

fn cursors(state: &State) -> [usize; 2] {
    let second = second(state).debugger.as_ref().expect("events");
    [
        state.runs().first.cursor().expect("events").0,
        second.state().cursor(),
    ]
}

fn differing(state: &State) -> [usize; 3] {
    let (side, comparison) = state.runs().second.as_ref().expect("a second run");
    let (a, b) = (state.runs().first.shown().unwrap(), side.shown().unwrap());
    let found = comparison.differences.of(&a, &b).expect("known");
    [found.common, found.first.len(), found.second.len()]
}

#[test]
fn another_seed_is_sampled_verified_and_shares_no_sample() {
    let mut harness = opened();
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Compare)),
    );
    node(&harness, "compare.next-seed").click();
    harness.run();
    settle(&mut harness);
    let state = &harness.state().state;
    let side = second(state);
    assert_eq!(side.session.as_ref().unwrap().run().parameters.seed, 2);
    assert_eq!(
        state
            .runs()
            .first
            .session
            .as_ref()
            .unwrap()
            .run()
            .parameters
            .seed,
        1
    );
    let tilescope_workbench::state::Verification::Done(verdict) = &side.verification else {
        panic!("the second run is not verified");
    };
    assert!(verdict.report.valid());
    let [common, first, second] = differing(state);
    assert_eq!(
        common + first,
        state.runs().first.session.as_ref().unwrap().summary.count
    );
    assert!(common < 10 && second > 9_000, "{common} {second}");
    assert!(text(&harness, "run-a").contains("seed 1"));
    assert!(text(&harness, "run-b").contains("seed 2"));
}

#[test]
fn the_same_parameters_give_the_same_run_to_the_last_event() {
    let mut harness = compared(ComparePreset::Typed);
    assert_eq!(divergence(&harness.state().state), Divergence::Same);
    let [_, first, second] = differing(&harness.state().state);
    assert_eq!([first, second], [0, 0]);
    for cursor in [0, 17, 12_345, 40_000] {
        apply(&mut harness, Command::Time(TimeCommand::Jump(cursor)));
        assert_eq!(cursors(&harness.state().state), [cursor; 2]);
    }
    // There is no such event to go to.
    assert!(is_disabled(&harness, "compare.go"));
}

#[test]
fn the_papers_search_parts_where_the_first_longer_search_reaches_further() {
    let mut harness = compared(ComparePreset::Search);
    let Divergence::Events { a, b, .. } = divergence(&harness.state().state) else {
        panic!("the searches must part at an event");
    };
    assert_eq!(a, b);
    let stage = session(&harness);
    assert!(stage.stages[stage.stage_at(a)] >= Stage::Iterate(1));
    // Up to the divergence the cursors are equal, one by one.
    apply(&mut harness, Command::Time(TimeCommand::Jump(a - 5)));
    assert_eq!(cursors(&harness.state().state), [a - 5; 2]);
    harness.key_press(Key::D);
    harness.run();
    settle(&mut harness);
    assert_eq!(cursors(&harness.state().state), [a + 1, b + 1]);
}

#[test]
fn playback_is_linked_until_unlinked() {
    let mut harness = compared(ComparePreset::NextSeed);
    apply(
        &mut harness,
        Command::Time(TimeCommand::Clock(Clock::Stage)),
    );
    harness.key_press(Key::Home);
    harness.run();
    let stages = |state: &State| {
        let side = second(state);
        let other = side.session.as_ref().unwrap().stages[side.stage];
        [state.runs().first.current_stage().unwrap(), other]
    };
    for _ in 0..5 {
        harness.key_press(Key::ArrowRight);
        harness.run();
        let [a, b] = stages(&harness.state().state);
        assert_eq!(a, b);
    }
    apply(
        &mut harness,
        Command::Compare(CompareCommand::LinkPlayback(false)),
    );
    let before = cursors(&harness.state().state);
    let into = TimeCommand::Step(Step::Into, Direction::Backwards);
    apply(&mut harness, Command::Time(into));
    let after = cursors(&harness.state().state);
    assert_eq!((after[0] + 1, after[1]), (before[0], before[1]));
}

#[test]
fn cameras_are_linked_from_either_canvas_until_unlinked() {
    let mut harness = compared(ComparePreset::NextSeed);
    let cameras = |harness: &Harness<'_, App>| {
        let state = &harness.state().state;
        [state.runs().first.camera, second(state).camera]
    };
    apply(
        &mut harness,
        Command::View(Which::First, ViewCommand::Pan(vec2(40.0, 10.0))),
    );
    let [a, b] = cameras(&harness);
    assert_eq!(a, b);
    let at = second(&harness.state().state).viewport.center();
    apply(
        &mut harness,
        Command::View(Which::Second, ViewCommand::Zoom(at, 3.0)),
    );
    let [zoomed, b] = cameras(&harness);
    assert_eq!(zoomed, b);
    assert!((zoomed.scale / a.scale - 3.0).abs() < 1e-9);
    assert!((0..2).all(|k| (zoomed.center[k] - a.center[k]).abs() < 1e-9));
    apply(
        &mut harness,
        Command::Compare(CompareCommand::LinkCameras(false)),
    );
    apply(
        &mut harness,
        Command::View(Which::Second, ViewCommand::Pan(vec2(5.0, 0.0))),
    );
    let [a, b] = cameras(&harness);
    assert_eq!(a, zoomed);
    assert_ne!(a, b);
}

#[test]
fn the_runs_are_swapped_and_the_second_one_is_closed() {
    let mut harness = compared(ComparePreset::NextSeed);
    let seed = |state: &State| {
        state
            .runs()
            .first
            .session
            .as_ref()
            .unwrap()
            .run()
            .parameters
            .seed
    };
    harness.key_press(Key::X);
    harness.run();
    let state = &harness.state().state;
    assert_eq!(seed(state), 2);
    assert_eq!(state.form().draft.parameters.seed, 2);
    assert_eq!(
        second(state)
            .session
            .as_ref()
            .unwrap()
            .run()
            .parameters
            .seed,
        1
    );
    settle(&mut harness);
    let Divergence::Events { .. } = divergence(&harness.state().state) else {
        panic!("two seeds part at an event");
    };
    apply(&mut harness, Command::Compare(CompareCommand::Close));
    assert!(harness.state().state.runs().second.is_none());
    assert_eq!(seed(&harness.state().state), 2);
}

#[test]
fn a_run_is_kept_beside_the_next_one_even_in_another_domain() {
    let mut harness = opened();
    apply(&mut harness, Command::Compare(CompareCommand::Keep));
    assert_eq!(divergence(&harness.state().state), Divergence::Same);
    apply(
        &mut harness,
        Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::Boundary,
            json!(Boundary::Bounded),
        ))),
    );
    apply(
        &mut harness,
        Command::Form(FormCommand::Type(Parameter::Leaf, "12".to_owned())),
    );
    apply(&mut harness, Command::Run);
    let Divergence::Domain { .. } = divergence(&harness.state().state) else {
        panic!("a periodic and a bounded domain cannot be compared");
    };
    node(&harness, "compare.refusal");
    assert!(text(&harness, "run-a").contains("bounded"));
    // Time still advances in both, stage by stage.
    apply(&mut harness, Command::Time(TimeCommand::ShowStage(2)));
    let state = &harness.state().state;
    assert_eq!(state.runs().first.current_stage(), Some(Stage::Tile));
    let side = second(state);
    assert_eq!(
        side.session.as_ref().unwrap().stages[side.stage],
        Stage::Tile
    );
}

#[test]
fn impossible_comparisons_are_explained() {
    let mut harness = opened();
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Compare)),
    );
    assert!(is_disabled(&harness, "compare.engine"));
    let refusal = harness.state().state.runs().preset_refusal(
        ComparePreset::Engine,
        harness.state().state.form(),
        harness.state().state.gpu(),
    );
    assert!(refusal.expect("a reason").contains("GPU"));
    apply(
        &mut harness,
        Command::Form(FormCommand::Type(Parameter::Radius, "0".to_owned())),
    );
    let refusal = harness.state().state.runs().preset_refusal(
        ComparePreset::Typed,
        harness.state().state.form(),
        harness.state().state.gpu(),
    );
    assert!(refusal.expect("a reason").contains("radius"));
    // A refused command does nothing.
    let start = CompareCommand::Start(ComparePreset::Typed);
    apply(&mut harness, Command::Compare(start));
    assert!(harness.state().state.runs().second.is_none());
    harness.key_press_modifiers(Modifiers::NONE, Key::X);
    harness.run();
    assert!(harness.state().state.runs().second.is_none());
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn both_runs_stand_behind_the_first_event_that_differs_however_long_they_are() {
    for preset in [
        ComparePreset::Leaf,
        ComparePreset::Insertion,
        ComparePreset::NextSeed,
    ] {
        let mut harness = compared(preset);
        let Divergence::Events { a, b, .. } = divergence(&harness.state().state) else {
            panic!("{preset:?} parts at an event");
        };
        harness.key_press(Key::D);
        harness.run();
        settle(&mut harness);
        assert_eq!(
            cursors(&harness.state().state),
            [a + 1, b + 1],
            "{preset:?}"
        );
        // From there time advances in both, and goes back to the same moments.
        let mut last = cursors(&harness.state().state);
        for cursor in (a + 2..a + 400).step_by(7) {
            apply(&mut harness, Command::Time(TimeCommand::Jump(cursor)));
            let now = cursors(&harness.state().state);
            assert!(now[1] >= last[1], "{preset:?}: {last:?} {now:?}");
            last = now;
        }
        apply(&mut harness, Command::Time(TimeCommand::Jump(a + 1)));
        assert_eq!(
            cursors(&harness.state().state),
            [a + 1, b + 1],
            "{preset:?}"
        );
    }
}

#[test]
fn a_key_zooms_once_whichever_canvas_has_the_pointer() {
    let mut harness = compared(ComparePreset::NextSeed);
    let scale = |harness: &Harness<'_, App>| harness.state().state.runs().first.camera.scale;
    for viewport in [
        harness.state().state.runs().first.viewport,
        second(&harness.state().state).viewport,
    ] {
        harness.hover_at(viewport.center());
        harness.run();
        let before = scale(&harness);
        // One key has both signs on many keyboards.
        harness.key_press(Key::Plus);
        harness.key_press(Key::Equals);
        harness.run();
        assert!((scale(&harness) / before - 1.25 * 1.25).abs() < 1e-6);
    }
}

#[test]
fn a_kept_run_is_at_the_same_moment_even_when_clocks_are_apart() {
    let mut harness = compared(ComparePreset::NextSeed);
    apply(
        &mut harness,
        Command::Compare(CompareCommand::LinkPlayback(false)),
    );
    apply(&mut harness, Command::Time(TimeCommand::Jump(12_000)));
    apply(&mut harness, Command::Compare(CompareCommand::Keep));
    assert_eq!(cursors(&harness.state().state), [12_000; 2]);
    harness.key_press(Key::X);
    harness.run();
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Events)),
    );
    assert!(harness.state().state.runs().first.rows.is_some());
}

#[test]
fn breakpoints_are_the_users_whichever_run_is_in_front() {
    let mut harness = opened();
    let line = tilescope_debugger::Listings::shipped()
        .find("eliminate.5")
        .expect("a line");
    let set = tilescope_workbench::command::DebugCommand::ToggleBreakpoint(line);
    apply(&mut harness, Command::Debug(set));
    apply(
        &mut harness,
        Command::Compare(CompareCommand::Start(ComparePreset::NextSeed)),
    );
    harness.key_press(Key::X);
    harness.run();
    settle(&mut harness);
    let state = &harness.state().state;
    assert_eq!(
        state
            .runs()
            .first
            .debugger
            .as_ref()
            .unwrap()
            .breakpoints()
            .len(),
        1
    );
    // They are marked where this run would stop.
    let hits = state.runs().first.hits.events().to_vec();
    assert!(hits.len() > 100);
    harness.key_press(Key::Home);
    harness.run();
    for &hit in &hits[..5] {
        harness.key_press(Key::F5);
        harness.run();
        assert_eq!(cursors(&harness.state().state)[0], hit);
    }
}

#[test]
fn marks_that_would_hide_the_picture_are_left_out_and_it_says_so() {
    let note = "Too many samples differ to mark them at this scale: zoom in.";
    let drawn = |preset: ComparePreset, command: Command| {
        let mut harness = compared(preset);
        harness.state_mut().state.restore(Settings {
            prefers_reduced_motion: Some(true),
            ..Settings::default()
        });
        apply(&mut harness, Command::Time(TimeCommand::LastStage));
        apply(&mut harness, command);
        harness.run();
        let said = |shape: &egui::epaint::ClippedShape| match &shape.shape {
            egui::Shape::Text(text) => text.galley.text() == note,
            _ => false,
        };
        harness.output().shapes.iter().any(said)
    };
    assert!(drawn(
        ComparePreset::NextSeed,
        Command::View(Which::First, ViewCommand::Fit)
    ));
    assert!(!drawn(
        ComparePreset::NextSeed,
        Command::View(Which::First, ViewCommand::FlyTo([37.0, 45.0].into(), 9.0))
    ));
    assert!(!drawn(
        ComparePreset::Search,
        Command::View(Which::First, ViewCommand::Fit)
    ));
}
