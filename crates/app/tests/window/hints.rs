//! What the window says where nothing else would: in dialogs, menus and empty panels.

use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_app::actions::{actions, shortcut_text};
use tilescope_debugger::Listings;
use tilescope_session::layers::Layer;
use tilescope_workbench::Command;
use tilescope_workbench::command::{AppearanceCommand, DebugCommand, TimeCommand, WindowCommand};
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::scenes::SceneCommand;

use crate::support::{find, is_disabled, node, opened, settle, text};

fn apply(harness: &mut Harness<'_, App>, command: Command) {
    harness.state_mut().state.apply(command);
    settle(harness);
    harness.run();
}

#[test]
fn a_missing_folder_is_named_while_it_is_typed() {
    let mut harness = opened();
    apply(
        &mut harness,
        Command::File(FileCommand::Sheet(Purpose::Save)),
    );
    assert!(!is_disabled(&harness, "file.go"));
    let path = "no such folder/lecture.json".to_owned();
    apply(&mut harness, Command::File(FileCommand::Path(path)));
    let said = text(&harness, "file.question");
    assert_eq!(said, "There is no folder \"no such folder\".");
    assert!(is_disabled(&harness, "file.go"));
}

#[test]
fn an_error_of_a_dialog_stands_in_it_and_has_no_number_of_the_system() {
    let mut harness = opened();
    apply(
        &mut harness,
        Command::File(FileCommand::Sheet(Purpose::Open)),
    );
    let path = "no such file.json".to_owned();
    apply(&mut harness, Command::File(FileCommand::Path(path)));
    apply(&mut harness, Command::File(FileCommand::Go));
    let said = text(&harness, "notice");
    assert!(
        said.contains("no such file.json") && !said.contains("os error"),
        "{said}"
    );
    let (error, button) = (
        node(&harness, "notice").rect(),
        node(&harness, "file.go").rect(),
    );
    assert!(error.top() >= button.bottom() && error.left() >= button.left() - 1.0);
    // Another dialog begins without it.
    apply(
        &mut harness,
        Command::File(FileCommand::Sheet(Purpose::Save)),
    );
    assert!(find(&harness, "notice").is_none());
}

#[test]
fn empty_circles_of_a_maximal_set_are_said_to_be_none() {
    let mut harness = opened();
    assert!(find(&harness, "no-empty-circles").is_none());
    let layer = AppearanceCommand::ToggleLayer(Layer::Circumcircles);
    apply(&mut harness, Command::Appearance(layer));
    assert!(text(&harness, "no-empty-circles").contains("maximal"));
    apply(&mut harness, Command::Time(TimeCommand::FirstStage));
    assert!(find(&harness, "no-empty-circles").is_none());
}

#[test]
fn a_new_scene_is_announced_where_its_panel_is_not_in_view() {
    let mut harness = opened();
    apply(&mut harness, Command::Scene(SceneCommand::Add));
    assert!(text(&harness, "notice").starts_with("Scene 1 is made"));
    apply(&mut harness, Command::Time(TimeCommand::StepBack));
    assert!(find(&harness, "notice").is_none(), "it goes by itself");
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Scenes)),
    );
    apply(&mut harness, Command::Scene(SceneCommand::Add));
    assert!(find(&harness, "notice").is_none());
    assert!(find(&harness, "scene-2").is_some());
}

#[test]
fn the_debug_menu_has_the_breakpoints_and_the_file_menu_quits() {
    let mut harness = opened();
    let line = Listings::shipped().find("eliminate.5").expect("a line");
    apply(
        &mut harness,
        Command::Debug(DebugCommand::ToggleBreakpoint(line)),
    );
    let all = actions(&harness.state().state);
    let switch = all
        .iter()
        .find(|action| action.name.starts_with("Breakpoint: eliminate.5, "));
    let switch = switch.expect("the breakpoint").clone();
    assert_eq!(switch.is_on, Some(true));
    apply(&mut harness, switch.command);
    let state = &harness.state().state;
    let debugger = state.runs().first.debugger.as_ref().expect("a debugger");
    assert!(!debugger.breakpoints()[0].enabled);
    assert!(
        all.iter()
            .any(|action| action.command == Command::Window(WindowCommand::Quit))
    );
}

#[test]
fn keys_of_signs_are_shown_as_signs() {
    let harness = opened();
    let all = actions(&harness.state().state);
    let shown: Vec<String> = all
        .iter()
        .filter_map(|action| action.shortcut)
        .map(|keys| shortcut_text(&harness.ctx, &keys))
        .collect();
    for sign in [".", "+", "?"] {
        assert!(shown.iter().any(|keys| keys == sign), "{sign} in {shown:?}");
    }
    for name in ["Period", "Plus", "Questionmark"] {
        assert!(!shown.iter().any(|keys| keys.contains(name)), "{name}");
    }
}

#[test]
fn the_panel_of_passes_offers_the_gpu_that_it_needs() {
    let mut harness = opened();
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Passes)),
    );
    assert!(is_disabled(&harness, "passes.run"));
    assert!(find(&harness, "passes.choose-gpu").is_some());
}
