//! The menu of a place on the canvas.

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_core::Stage;
use tilescope_session::layers::Layer;
use tilescope_session::selection::Selection;
use tilescope_workbench::Command;
use tilescope_workbench::command::{AppearanceCommand, TimeCommand, ViewCommand, Which};
use tilescope_workbench::layout::Panel;

use crate::support::sessions::apply;
use crate::support::{cursor, debugger, find, node, opened, session, settle};

fn view(harness: &mut Harness<'_, App>, command: ViewCommand) {
    apply(harness, Command::View(Which::First, command));
}

fn choose(harness: &mut Harness<'_, App>, entry: &str) {
    node(harness, "canvas").click_secondary();
    harness.run();
    node(harness, format!("canvas-menu.{entry}")).click();
    harness.run();
    settle(harness);
}

/// Returns the window with a sample in the middle of the view, which is not selected.
fn at_sample(sample: u32) -> Harness<'static, App> {
    let mut harness = opened();
    let still = AppearanceCommand::ToggleReducedMotion;
    apply(&mut harness, Command::Appearance(still));
    view(&mut harness, ViewCommand::GoToSample(sample));
    view(&mut harness, ViewCommand::Pick(Selection::Nothing));
    harness
}

#[test]
fn the_menu_of_a_sample_leads_to_its_history_and_its_moments() {
    let mut harness = at_sample(40);
    choose(&mut harness, "history");
    let state = &harness.state().state;
    assert_eq!(state.runs().first.selected, Some(40));
    assert!(state.window().shows(Panel::Inspector));
    choose(&mut harness, "placed");
    let life = debugger(&harness).recording().life(40).unwrap();
    assert_eq!(cursor(&harness), life.born as usize + 1);
    choose(&mut harness, "kept");
    assert_eq!(cursor(&harness), life.kept as usize + 1);
    choose(&mut harness, "scene");
    assert_eq!(debugger(&harness).scenes.len(), 1);
    // What never happened is not offered.
    node(&harness, "canvas").click_secondary();
    harness.run();
    assert!(find(&harness, "canvas-menu.lost").is_none());
    assert!(find(&harness, "canvas-menu.inserted").is_none());
}

#[test]
fn the_menu_key_opens_it_at_the_selection() {
    let mut harness = at_sample(40);
    view(&mut harness, ViewCommand::Pick(Selection::Sample(40)));
    node(&harness, "canvas").focus();
    harness.run();
    harness.key_press_modifiers(Modifiers::NONE, Key::Menu);
    harness.run();
    node(&harness, "canvas-menu.placed").click();
    harness.run();
    let life = debugger(&harness).recording().life(40).unwrap();
    assert_eq!(cursor(&harness), life.born as usize + 1);
}

#[test]
fn a_place_can_be_asked_about_copied_and_zoomed_to() {
    let mut harness = at_sample(40);
    let before = harness.state().state.runs().first.camera;
    view(
        &mut harness,
        ViewCommand::Pan(egui::vec2(0.4 * before.scale as f32, 0.0)),
    );
    let middle = harness.state().state.runs().first.camera.center;
    choose(&mut harness, "place");
    assert_eq!(harness.state().state.runs().first.selected, None);
    let place = harness.state().state.runs().first.place.expect("a place");
    assert!(place.distance(middle) < 0.1);
    choose(&mut harness, "block");
    assert!(harness.state().state.runs().first.camera.scale < 0.5 * before.scale);
    let center = glam::dvec2(20.0, 30.0);
    view(&mut harness, ViewCommand::Centre(center));
    assert_eq!(harness.state().state.runs().first.camera.center, center);
    let state = &mut harness.state_mut().state;
    let copy = ViewCommand::CopyPosition(center);
    state.apply(Command::View(Which::First, copy));
    let radius = 0.008_36;
    let expected = format!("{:.6}, {:.6}", 20.0 * radius, 30.0 * radius);
    assert_eq!(state.window().copied.as_ref(), Some(&expected));
}

#[test]
fn a_gap_is_named_and_flown_to() {
    let mut harness = at_sample(40);
    let stages = session(&harness).stages.clone();
    let stage = stages.iter().position(|stage| *stage == Stage::Eliminate);
    let show = TimeCommand::ShowStage(stage.expect("the stage"));
    apply(&mut harness, Command::Time(show));
    // A layer that needs the triangulation: without one it is not made.
    let voronoi = AppearanceCommand::ToggleLayer(Layer::Voronoi);
    apply(&mut harness, Command::Appearance(voronoi));
    let deepest = {
        let run = &harness.state().state.runs().first;
        let tessellation = run.geometry.of(&run.shown().unwrap()).expect("gaps");
        let mut places = tessellation.gaps.iter().map(|gap| gap.deepest.0);
        // Gaps at the border may be deepest beyond it.
        let is_inside = |at: &glam::DVec2| at.min_element() > 5.0 && at.max_element() < 110.0;
        places.find(is_inside).expect("a gap")
    };
    view(&mut harness, ViewCommand::FlyTo(deepest, 20.0));
    node(&harness, "canvas").click_secondary();
    harness.run();
    assert!(find(&harness, "canvas-menu.block").is_none());
    node(&harness, "canvas-menu.gap").click();
    harness.run();
    let camera = harness.state().state.runs().first.camera;
    assert!(camera.center.distance(deepest) < 0.1);
    choose(&mut harness, "place");
    assert!(harness.state().state.runs().first.place.is_some());
}
