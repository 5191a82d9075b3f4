//! Every panel in both themes as a small picture, compared with a reviewed one. `UPDATE_SNAPSHOTS=1 cargo test
//! --release -p tilescope-app --test window snapshots` writes them anew; then review what changed.

use egui_kittest::{Harness, SnapshotOptions, SnapshotResults, try_image_snapshot_options};
use tilescope_app::App;
use tilescope_core::Parameter;
use tilescope_debugger::{Direction, Listings, Target};
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_workbench::Command;
use tilescope_workbench::arrangement::DrawerCommand;
use tilescope_workbench::command::{
    AppearanceCommand, DebugCommand, FormCommand, TimeCommand, ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::embedding::Embedding;
use tilescope_workbench::layout::{Layout, Panel};
use tilescope_workbench::scenes::SceneCommand;
use tilescope_workbench::state::Settings;

use crate::support::{find, opened_at, settle};

/// The size of a panel's picture, without the bar.
const SIZE: [f32; 2] = [480.0, 380.0];

/// Software drivers of different versions may round a few edges differently.
fn options() -> SnapshotOptions {
    SnapshotOptions::new().threshold(0.8).max_failed_pixels(60)
}

/// A small run in the middle of its elimination, with something in every panel.
fn prepared(size: [f32; 2]) -> Harness<'static, App> {
    let mut harness = opened_at(size);
    let state = &mut harness.state_mut().state;
    let line = Listings::shipped().find("eliminate.5").expect("a line");
    for command in [
        Command::Appearance(AppearanceCommand::ToggleReducedMotion),
        Command::Form(FormCommand::Type(Parameter::Radius, "0.03".to_owned())),
        Command::Form(FormCommand::Type(Parameter::Leaf, "12".to_owned())),
        Command::Run,
    ] {
        state.apply(command);
    }
    state.settle();
    for command in [
        Command::Time(TimeCommand::FirstStage),
        Command::Time(TimeCommand::RunTo(Target::Elimination, Direction::Forwards)),
        Command::Debug(DebugCommand::ToggleBreakpoint(line)),
        Command::Debug(DebugCommand::Condition(0, "distance < 0.5".to_owned())),
        Command::Debug(DebugCommand::Watch("distance".to_owned())),
        Command::Debug(DebugCommand::Watch("nonsense(".to_owned())),
        Command::Scene(SceneCommand::Add),
        Command::Scene(SceneCommand::Caption(0, "the first one dies".to_owned())),
        Command::View(Which::First, ViewCommand::Pick(Selection::Sample(40))),
        Command::Compare(CompareCommand::Start(ComparePreset::Order)),
    ] {
        state.apply(command);
    }
    settle(&mut harness);
    harness
}

fn alone(harness: &mut Harness<'_, App>, panel: Panel) {
    harness.state_mut().state.restore(Settings {
        layout: Some(Layout::alone(panel)),
        ..Settings::default()
    });
    settle(harness);
}

fn every_panel(look: Look) -> SnapshotResults {
    let mut harness = prepared(SIZE);
    harness.state_mut().state.restore(Settings {
        is_bare: Some(true),
        ..Settings::default()
    });
    harness
        .state_mut()
        .state
        .apply(Command::Appearance(AppearanceCommand::Look(look)));
    let mut results = SnapshotResults::new();
    for panel in Panel::all() {
        alone(&mut harness, panel);
        let theme = look.name().to_lowercase().replace(' ', "-");
        let name = format!("{theme}/{}", panel.name().to_lowercase().replace(' ', "-"));
        let image = harness.render().expect("a picture of the panel");
        results.add(try_image_snapshot_options(&image, name, &options()));
    }
    results
}

#[test]
fn every_panel_looks_as_it_did_in_the_dark() {
    every_panel(Look::Dark).unwrap();
}

#[test]
fn every_panel_looks_as_it_did_in_the_light() {
    every_panel(Look::Light).unwrap();
}

#[test]
fn projector_snapshots_are_unchanged() {
    let mut harness = prepared([800.0, 500.0]);
    harness
        .state_mut()
        .state
        .apply(Command::Appearance(AppearanceCommand::Look(
            Look::Projector,
        )));
    harness
        .state_mut()
        .state
        .apply(Command::Compare(CompareCommand::Close));
    settle(&mut harness);
    let image = harness.render().expect("a picture of the window");
    try_image_snapshot_options(&image, "projector/window", &options()).unwrap();
}

/// Small windows, each with one open panel or without.
fn small(windows: &[(&str, [f32; 2], Option<Panel>)]) -> SnapshotResults {
    let mut results = SnapshotResults::new();
    for &(name, size, panel) in windows {
        let mut harness = prepared(size);
        let state = &mut harness.state_mut().state;
        state.apply(Command::Compare(CompareCommand::Close));
        state.apply(Command::Window(WindowCommand::Drawer(DrawerCommand::Show(
            panel,
        ))));
        settle(&mut harness);
        let image = harness.render().expect("a picture of the window");
        let name = format!("small/{name}");
        results.add(try_image_snapshot_options(&image, name, &options()));
    }
    results
}

#[test]
fn a_phone_shows_the_canvas_and_one_panel() {
    let upright = [390.0, 844.0];
    small(&[
        ("phone", upright, None),
        ("phone-parameters", upright, Some(Panel::Parameters)),
        ("phone-inspector", upright, Some(Panel::Inspector)),
    ])
    .unwrap();
}

#[test]
fn a_lying_a_small_phone_and_a_tablet_have_the_same() {
    small(&[
        ("lying", [844.0, 390.0], Some(Panel::Statistics)),
        ("small-phone", [360.0, 640.0], Some(Panel::Canvas)),
        ("tablet", [768.0, 1024.0], Some(Panel::Events)),
    ])
    .unwrap();
}

#[test]
fn a_projector_has_room_for_all() {
    let mut harness = prepared([1920.0, 1080.0]);
    let state = &mut harness.state_mut().state;
    state.apply(Command::Appearance(AppearanceCommand::Look(
        Look::Projector,
    )));
    state.apply(Command::Compare(CompareCommand::Close));
    settle(&mut harness);
    let image = harness.render().expect("a picture of the window");
    try_image_snapshot_options(&image, "projector/full-hd", &options()).unwrap();
}

#[test]
fn an_embedded_window_shows_canvas_or_player_alone() {
    let mut harness = prepared([640.0, 420.0]);
    let state = &mut harness.state_mut().state;
    state.apply(Command::Compare(CompareCommand::Close));
    let mut results = SnapshotResults::new();
    for embedding in Embedding::ALL {
        harness.state_mut().state.restore(Settings {
            embedding: Some(Some(embedding)),
            ..Settings::default()
        });
        settle(&mut harness);
        for id in ["export", "menu", "layer.disks", "run", "tab.parameters"] {
            let there = find(&harness, id).is_some();
            assert!(!there, "{embedding:?} shows {id}");
        }
        let plays = find(&harness, "time-toggle-play").is_some();
        assert_eq!(plays, embedding == Embedding::Player);
        let image = harness.render().expect("a picture of the window");
        let name = format!("embedded/{}", embedding.name());
        results.add(try_image_snapshot_options(&image, name, &options()));
    }
    // Without it there are panels again.
    harness.state_mut().state.restore(Settings {
        embedding: Some(None),
        ..Settings::default()
    });
    settle(&mut harness);
    assert!(find(&harness, "tab.parameters").is_some());
    results.unwrap();
}

#[test]
fn snapshots_distinguish_panels_and_moments() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("snapshots");
    std::fs::create_dir_all(&folder).unwrap();
    let mut harness = prepared(SIZE);
    harness.state_mut().state.restore(Settings {
        is_bare: Some(true),
        ..Settings::default()
    });
    alone(&mut harness, Panel::Timeline);
    let image = harness.render().expect("a picture");
    image.save(folder.join("known.png")).unwrap();
    let known = options().output_path(&folder);
    assert!(try_image_snapshot_options(&image, "known", &known).is_ok());
    let updating = std::env::var_os("UPDATE_SNAPSHOTS").is_some();
    harness
        .state_mut()
        .state
        .apply(Command::Time(TimeCommand::Jump(3_000)));
    settle(&mut harness);
    let later = harness.render().expect("a picture");
    assert!(try_image_snapshot_options(&later, "known", &known).is_err() || updating);
    alone(&mut harness, Panel::Legend);
    let other = harness.render().expect("a picture");
    assert!(try_image_snapshot_options(&other, "known", &known).is_err() || updating);
}
