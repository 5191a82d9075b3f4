//! Buffers of the GPU on the canvas: where their rows lie, when they are drawn, and their tags. Needs an adapter; a
//! software one is enough.

use std::collections::BTreeSet;

use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_core::{Fate, Parameter, Stage};
use tilescope_debugger::{Direction, Step};
use tilescope_gpu::RowPlace;
use tilescope_gpu::layout::Name;
use tilescope_session::look::Look;
use tilescope_workbench::clock::Clock;
use tilescope_workbench::command::{
    AppearanceCommand, FormCommand, GpuCommand, TimeCommand, ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::device::EngineChoice;
use tilescope_workbench::layout::Panel;
use tilescope_workbench::passes::canvas::Rows;
use tilescope_workbench::passes::{OnCanvas, PassCommand, PassSide};
use tilescope_workbench::{Command, State};

use crate::support::{find, is_disabled, node, opened, settle, text};

fn apply(harness: &mut Harness<'_, App>, command: Command) {
    harness.state_mut().state.apply(command);
    settle(harness);
}

fn pass(harness: &mut Harness<'_, App>, command: PassCommand) {
    apply(harness, Command::Passes(command));
}

/// Returns the window with the passes of a small run.
fn with_passes() -> Harness<'static, App> {
    let mut harness = opened();
    let radius = Command::Form(FormCommand::Type(Parameter::Radius, "0.02".to_owned()));
    for command in [
        radius,
        Command::Run,
        Command::Gpu(GpuCommand::Engine(EngineChoice::Gpu)),
    ] {
        apply(&mut harness, command);
    }
    apply(&mut harness, Command::OpenPasses);
    assert!(state(&harness).runs().first.passes.is_some());
    harness
}

/// Asserts that the tag of the buffer on the canvas contains all of `facts`.
#[track_caller]
fn on_canvas(harness: &Harness<'_, App>, facts: &[&str]) {
    let said = text(harness, "on-canvas");
    assert!(facts.iter().all(|fact| said.contains(fact)), "{said}");
}

fn state<'a>(harness: &'a Harness<'_, App>) -> &'a State {
    &harness.state().state
}

/// Goes to the first pass of this name, and to one of its buffers.
fn go(harness: &mut Harness<'_, App>, name: &str, buffer: Name) {
    let entries = state(harness)
        .runs()
        .first
        .passes
        .as_ref()
        .unwrap()
        .entries();
    let index = entries.iter().position(|entry| entry.report.name == name);
    pass(harness, PassCommand::Select(index.expect("such a pass")));
    let visit = state(harness)
        .runs()
        .first
        .passes
        .as_ref()
        .unwrap()
        .visit()
        .unwrap();
    let index = visit.buffers.iter().position(|table| table.name == buffer);
    pass(harness, PassCommand::Buffer(index.expect("such a buffer")));
}

fn rows_on_canvas(state: &State) -> Option<OnCanvas<'_>> {
    let clock = state.time().playback.clock;
    let look = state.appearance().look;
    state
        .runs()
        .first
        .buffers_on_canvas(state.window(), look, clock)
}

fn rows<'a>(harness: &'a Harness<'_, App>) -> Rows<'a> {
    let shown = rows_on_canvas(state(harness)).expect("a buffer");
    shown.rows.expect("its rows")
}

/// Returns the points of the rows on the canvas that lie in the domain.
fn points(harness: &Harness<'_, App>) -> BTreeSet<(i32, i32)> {
    let rows = rows(harness);
    let spots = rows.shown.rows().iter().flat_map(|&row| rows.marks(row));
    let inside = spots.filter(|spot| rows.lies_inside(spot));
    let point = |spot: &RowPlace| match *spot {
        RowPlace::Point(p) => Some((p.x, p.y)),
        _ => None,
    };
    inside.filter_map(point).collect()
}

fn samples(harness: &Harness<'_, App>, wanted: impl Fn(Fate) -> bool) -> BTreeSet<(i32, i32)> {
    let run = state(harness).runs().first.session.as_ref().unwrap().run();
    let first = run
        .iterations
        .first()
        .map_or(usize::MAX, |i| i.inserted.start as usize);
    let fated = run
        .samples
        .points
        .iter()
        .zip(&run.samples.fates)
        .take(first);
    let fated = fated.filter(|(_, fate)| wanted(**fate));
    fated.map(|(p, _)| (p.x, p.y)).collect()
}

#[test]
fn places_and_the_grid_are_on_the_canvas_where_the_session_has_its_samples() {
    let mut harness = with_passes();
    go(&mut harness, "tile", Name::Places);
    assert_eq!(points(&harness), samples(&harness, |_| true));
    pass(&mut harness, PassCommand::Side(PassSide::Before));
    assert!(points(&harness).is_empty());
    on_canvas(&harness, &["places", "before"]);
    go(&mut harness, "survive", Name::Grid);
    pass(&mut harness, PassCommand::Side(PassSide::After));
    assert_eq!(
        points(&harness),
        samples(&harness, |fate| fate == Fate::Kept)
    );
    assert_ne!(points(&harness), samples(&harness, |_| true));
}

#[test]
fn the_button_shows_them_the_tag_names_them_and_the_choice_removes_them() {
    let mut harness = with_passes();
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Passes)),
    );
    go(&mut harness, "tile", Name::Places);
    let counts = rows(&harness).shown.counts();
    assert!(counts.inside > 1_000 && counts.inside < counts.rows);
    node(&harness, "passes.show-canvas").click();
    harness.run();
    settle(&mut harness);
    assert!(state(&harness).window().layout.shows(Panel::Canvas));
    assert_eq!(state(&harness).time().playback.clock, Clock::Pass);
    on_canvas(&harness, &["pass 7 tile", "places", "after"]);
    let with = harness.render().expect("a picture");
    pass(&mut harness, PassCommand::OnCanvas(false));
    assert!(find(&harness, "on-canvas").is_none());
    let without = harness.render().expect("a picture");
    assert!(with.as_raw() != without.as_raw());
    pass(&mut harness, PassCommand::OnCanvas(true));
    let again = harness.render().expect("a picture");
    assert!(with.as_raw() == again.as_raw());
    let rows = rows(&harness);
    let is_inside = |&row: &u32| rows.marks(row).iter().any(|spot| rows.lies_inside(spot));
    let inside = rows.shown.rows().iter().copied().find(is_inside);
    pass(&mut harness, PassCommand::PickRow(inside));
    let picked = harness.render().expect("a picture");
    assert!(with.as_raw() != picked.as_raw());
}

#[test]
fn a_run_without_passes_has_the_clock_from_before_them() {
    let mut harness = with_passes();
    let before = Command::Time(TimeCommand::Clock(Clock::Line));
    apply(&mut harness, before);
    pass(&mut harness, PassCommand::ShowCanvas);
    assert_eq!(state(&harness).time().playback.clock, Clock::Pass);
    assert!(
        state(&harness)
            .gpu()
            .engine_text(&tilescope_core::Parameters::default())
            .is_some()
    );
    // The CPU samples next, so the clock of passes and the remark on the GPU are gone.
    apply(
        &mut harness,
        Command::Gpu(GpuCommand::Engine(EngineChoice::Auto)),
    );
    assert_eq!(
        state(&harness)
            .gpu()
            .engine_text(&tilescope_core::Parameters::default()),
        None
    );
    apply(&mut harness, Command::Run);
    assert_eq!(state(&harness).time().playback.clock, Clock::Line);
}

#[test]
fn arrow_keys_go_from_pass_to_pass_and_the_tag_follows() {
    let mut harness = with_passes();
    go(&mut harness, "tile", Name::Places);
    pass(&mut harness, PassCommand::ShowCanvas);
    let tile = ["pass 7 tile", "places", "after"];
    let prepare = ["pass 8 prepare", "buffer", ""];
    let eliminate = ["pass 9 eliminate", "places", "after"];
    for (key, tag) in [
        (egui::Key::ArrowRight, prepare),
        (egui::Key::ArrowRight, eliminate),
        (egui::Key::ArrowLeft, prepare),
        (egui::Key::ArrowLeft, tile),
    ] {
        harness.key_press(key);
        harness.step();
        settle(&mut harness);
        on_canvas(&harness, &tag);
        // The canvas shows the last completed stage.
        assert_eq!(
            state(&harness).runs().first.current_stage(),
            Some(Stage::Tile)
        );
    }
}

#[test]
fn the_timeline_stands_at_the_last_stage_that_is_whole_behind_the_pass() {
    let mut harness = with_passes();
    let entries = state(&harness)
        .runs()
        .first
        .passes
        .as_ref()
        .unwrap()
        .entries()
        .to_vec();
    for (pass, stage) in [("survive", Stage::Eliminate), ("attribute", Stage::Tile)] {
        go(&mut harness, pass, Name::Places);
        assert_eq!(
            state(&harness).runs().first.current_stage(),
            Some(stage),
            "{pass}"
        );
    }
    pass(&mut harness, PassCommand::Select(0));
    assert_eq!(
        state(&harness).runs().first.current_stage(),
        Some(Stage::Blocks)
    );
    // Moving in the timeline selects a pass, and that selection does not move the timeline back.
    apply(&mut harness, Command::Time(TimeCommand::LastStage));
    let passes = state(&harness).runs().first.passes.as_ref().unwrap();
    assert_eq!(passes.selected(), Some(entries.len() - 1));
    assert_eq!(
        state(&harness).runs().first.current_stage(),
        Some(Stage::Finish)
    );
}

#[test]
fn a_session_that_is_stepped_through_by_events_is_not_drawn_over() {
    let mut harness = opened();
    assert!(rows_on_canvas(state(&harness)).is_none());
    drop(harness);
    harness = with_passes();
    assert!(rows_on_canvas(state(&harness)).is_none());
    go(&mut harness, "tile", Name::Places);
    // The canvas is in front, and the timeline is at the moment of the pass.
    assert!(rows_on_canvas(state(&harness)).is_some());
    let there = state(&harness).runs().first.cursor().unwrap().0;
    let step = || Command::Time(TimeCommand::Step(Step::Into, Direction::Forwards));
    apply(&mut harness, step());
    assert!(rows_on_canvas(state(&harness)).is_none());
    apply(&mut harness, Command::Time(TimeCommand::Jump(there)));
    assert!(rows_on_canvas(state(&harness)).is_some());
    apply(&mut harness, step());
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Passes)),
    );
    assert!(rows_on_canvas(state(&harness)).is_some());
    apply(
        &mut harness,
        Command::Appearance(AppearanceCommand::Look(Look::Projector)),
    );
    assert!(rows_on_canvas(state(&harness)).is_none());
}

#[test]
fn a_filter_chooses_the_rows_and_unchanged_cells() {
    let mut harness = with_passes();
    go(&mut harness, "tile", Name::Places);
    pass(&mut harness, PassCommand::Filter("row<10".to_owned()));
    assert_eq!(
        (
            rows(&harness).shown.counts().rows,
            rows(&harness).shown.rows().len()
        ),
        (10, 10)
    );
    on_canvas(&harness, &["after", "10 rows, 10 changed"]);
    pass(&mut harness, PassCommand::Filter(String::new()));
    go(&mut harness, "tile", Name::Starts);
    assert_eq!(rows(&harness).shown.counts().rows, 0);
    on_canvas(&harness, &["starts", "after"]);
    pass(&mut harness, PassCommand::Filter("row<10".to_owned()));
    assert_eq!(rows(&harness).shown.counts().rows, 10);
    go(&mut harness, "tile", Name::Counters);
    on_canvas(&harness, &["counters", "after"]);
}

#[test]
fn too_many_marks_are_left_out_with_a_remark() {
    let mut harness = opened();
    apply(
        &mut harness,
        Command::Gpu(GpuCommand::Engine(EngineChoice::Gpu)),
    );
    apply(&mut harness, Command::OpenPasses);
    go(&mut harness, "tile", Name::Places);
    let all = rows(&harness).shown.counts().rows;
    assert!(all > 20_000);
    let left_out = (all - 20_000).to_string();
    assert!(!text(&harness, "on-canvas").contains(&left_out));
    apply(
        &mut harness,
        Command::View(Which::First, ViewCommand::FlyTo([60.0, 60.0].into(), 260.0)),
    );
    for _ in 0..200 {
        harness.step();
    }
    harness.run();
    on_canvas(&harness, &[&left_out]);
}

#[test]
fn only_the_first_of_two_compared_runs_has_them() {
    let mut harness = with_passes();
    apply(
        &mut harness,
        Command::Compare(CompareCommand::Start(ComparePreset::Typed)),
    );
    go(&mut harness, "tile", Name::Places);
    pass(&mut harness, PassCommand::ShowCanvas);
    assert!(rows_on_canvas(state(&harness)).is_some());
    // There is only one.
    node(&harness, "on-canvas");
    assert!(!is_disabled(&harness, "canvas-b"));
}
