//! Panels are hidden and shown by keys, menus and their tabs; the canvas gets the room.

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_workbench::Command;
use tilescope_workbench::command::WindowCommand;
use tilescope_workbench::layout::{Layout, Panel};

use crate::support::{find, node, opened, opened_at};

fn press(harness: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run();
}

fn shows(harness: &Harness<'_, App>, panel: Panel) -> bool {
    harness.state().state.window().shows(panel)
}

fn canvas(harness: &Harness<'_, App>) -> egui::Vec2 {
    node(harness, "canvas").rect().size()
}

#[test]
fn digits_select_a_panel_and_never_hide_one() {
    let mut harness = opened();
    let all = |harness: &Harness<'_, App>| harness.state().state.window().layout.hidden();
    let before = all(&harness);
    for key in [
        Key::Num1,
        Key::Num1,
        Key::Num0,
        Key::Num0,
        Key::Num6,
        Key::Num6,
    ] {
        press(&mut harness, Modifiers::NONE, key);
    }
    assert_eq!(all(&harness), before, "what is typed takes no panel away");
    assert!(shows(&harness, Panel::Events) && find(&harness, "find-events").is_some());
    press(&mut harness, Modifiers::NONE, Key::Num1);
    assert!(find(&harness, "radius").is_some());

    // A hidden panel comes back by its digit, and by undo.
    let hide = Command::Window(WindowCommand::HidePanel(Panel::Events));
    harness.state_mut().state.apply(hide);
    harness.run();
    assert!(find(&harness, "tab.events").is_none());
    press(&mut harness, Modifiers::NONE, Key::Num6);
    assert!(shows(&harness, Panel::Events));
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(find(&harness, "tab.events").is_none());
}

#[test]
fn a_column_without_panels_leaves_its_room_to_the_canvas() {
    let mut harness = opened();
    let before = canvas(&harness);
    press(&mut harness, Modifiers::NONE, Key::F4);
    let wide = canvas(&harness);
    assert!(wide.x > before.x + 500.0 && find(&harness, "tab.legend").is_none());
    press(&mut harness, Modifiers::SHIFT, Key::F4);
    assert!(canvas(&harness).y > wide.y + 50.0 && find(&harness, "time-play").is_none());
    // A panel that a command opens comes back into its place.
    press(&mut harness, Modifiers::NONE, Key::Num2);
    assert!(find(&harness, "tab.inspector").is_some() && find(&harness, "tab.legend").is_none());
    let apply = |harness: &mut Harness<'_, App>, command| {
        harness.state_mut().state.apply(Command::Window(command));
        harness.run();
    };
    apply(&mut harness, WindowCommand::ResetLayout);
    assert_eq!(canvas(&harness), before);
    // Column by column.
    for panel in [
        Panel::Parameters,
        Panel::Events,
        Panel::Scenes,
        Panel::Analysis,
    ] {
        // The panels of a column differ in their smallest widths.
        assert!((canvas(&harness).x - before.x).abs() < 10.0);
        apply(&mut harness, WindowCommand::HidePanel(panel));
    }
    assert!(canvas(&harness).x > before.x + 200.0);
    let layout = &harness.state().state.window().layout;
    let saved = serde_json::to_string(layout).unwrap();
    assert_eq!(serde_json::from_str::<Layout>(&saved).unwrap(), *layout);
}

#[test]
fn a_tab_hides_its_panel() {
    let mut harness = opened();
    node(&harness, "tab.watches").click_secondary();
    harness.run();
    node(&harness, "tab.watches.hide").click();
    harness.run();
    assert!(find(&harness, "tab.watches").is_none());
    node(&harness, "tab.canvas").click_secondary();
    harness.run();
    assert!(
        find(&harness, "tab.canvas.hide").is_none(),
        "the canvas stays"
    );
}

#[test]
fn a_digit_opens_the_drawer_of_a_small_window_and_escape_closes_it() {
    let mut harness = opened_at([412.0, 915.0]);
    press(&mut harness, Modifiers::NONE, Key::Num6);
    assert!(shows(&harness, Panel::Events));
    press(&mut harness, Modifiers::NONE, Key::Num6);
    assert!(
        shows(&harness, Panel::Events),
        "what is typed closes nothing"
    );
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!shows(&harness, Panel::Events));
    let layout = &harness.state().state.window().layout;
    assert!(
        layout.hidden().is_empty(),
        "the layout of a large window stays"
    );
}
