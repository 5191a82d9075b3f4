//! Closing the window, and the files that its menu lists as recent.

use egui::{ViewportCommand, ViewportEvent, ViewportId};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tilescope_app::App;
use tilescope_workbench::Command;
use tilescope_workbench::files::Purpose;
use tilescope_workbench::scenes::SceneCommand;
use tilescope_workbench::state::Settings;

use crate::support::sessions::{apply, busy, folder, go, path_text};
use crate::support::{find, is_disabled, node, opened, session, settle, text};

/// The ids of the question's buttons.
const STAY: &str = "closing.stay";
const SAVE: &str = "closing.save";
const CLOSE: &str = "closing.close";

/// Asks the window to close, as the system does, and returns whether it refuses to.
fn ask_to_close(harness: &mut Harness<'_, App>) -> bool {
    let viewports = &mut harness.input_mut().viewports;
    let root = viewports.entry(ViewportId::ROOT).or_default();
    root.events.push(ViewportEvent::Close);
    harness.step();

    let refuses = commands(harness).contains(&ViewportCommand::CancelClose);
    // The request is that of one frame.
    let viewports = &mut harness.input_mut().viewports;
    viewports
        .entry(ViewportId::ROOT)
        .or_default()
        .events
        .clear();
    harness.run();
    refuses
}

/// What the last frame asked of the system's window.
fn commands(harness: &Harness<'_, App>) -> Vec<ViewportCommand> {
    let outputs = &harness.output().viewport_output;
    let root = outputs.get(&ViewportId::ROOT);
    root.map(|output| output.commands.clone())
        .unwrap_or_default()
}

/// Returns a window with a scene that no file has.
fn with_a_scene() -> Harness<'static, App> {
    let mut harness = opened();
    apply(&mut harness, Command::Scene(SceneCommand::Add));
    harness
}

fn press(harness: &mut Harness<'_, App>, id: &str) {
    node(harness, id).click();
    harness.run();
}

#[test]
fn a_window_without_unsaved_work_closes_unasked() {
    let mut harness = opened();
    assert!(!ask_to_close(&mut harness));
    assert!(find(&harness, STAY).is_none());
}

#[test]
fn closing_asks_while_a_scene_is_unsaved() {
    let mut harness = with_a_scene();
    assert!(ask_to_close(&mut harness));
    assert_eq!(text(&harness, "closing.reason-1"), "1 scene is not saved.");

    press(&mut harness, STAY);
    assert!(find(&harness, STAY).is_none());
    // It asks again the next time.
    assert!(ask_to_close(&mut harness));
    assert!(find(&harness, STAY).is_some());

    press(&mut harness, SAVE);
    assert!(find(&harness, STAY).is_none());
    let sheet = harness.state().state.files().sheet.as_ref();
    assert_eq!(sheet.map(|sheet| sheet.purpose), Some(Purpose::Save));
}

#[test]
fn close_anyway_closes() {
    let mut harness = with_a_scene();
    assert!(ask_to_close(&mut harness));
    node(&harness, CLOSE).click();

    // A click takes two frames, press and release.
    let mut closes = false;
    for _ in 0..4 {
        harness.step();
        closes |= commands(&harness).contains(&ViewportCommand::Close);
    }
    assert!(closes);
    assert!(!ask_to_close(&mut harness), "the answer holds");
}

#[test]
fn files_that_were_saved_are_listed_as_recent_and_open_again() {
    let path = folder("recent").join("kept.json");
    let mut harness = busy();
    go(&mut harness, Purpose::Save, &path);
    let saved = session(&harness).recipe();
    let recent = harness.state().state.files().recent.clone();
    assert_eq!(recent, [path_text(&path)]);
    drop(harness);

    let mut harness = opened();
    assert_ne!(session(&harness).recipe(), saved);
    harness.state_mut().state.restore(Settings {
        recent: Some(recent),
        ..Settings::default()
    });
    for step in ["menu.file", "submenu.recent"] {
        press(&mut harness, step);
    }
    // No session of an earlier use is kept in this window.
    assert!(is_disabled(&harness, "entry.file-file-last"));
    harness.get_by_label(&path_text(&path)).click();
    // The click takes effect in a frame, and the file is then read in the background.
    harness.run();
    settle(&mut harness);
    assert_eq!(session(&harness).recipe(), saved);
}
