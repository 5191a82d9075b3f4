//! An idle window does not redraw, which saves power.

use std::time::Duration;

use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_workbench::Command;
use tilescope_workbench::command::WindowCommand;
use tilescope_workbench::layout::Panel;

use crate::support::{node, opened, settle};

/// Asserts that no frame is requested without input.
fn assert_rests(harness: &mut Harness<'_, App>, what: &str) {
    settle(harness);
    // Until fades have ended.
    harness.run_steps(30);
    harness.run();
    harness.step();
    let output = &harness.output().viewport_output[&egui::ViewportId::ROOT];
    assert!(
        output.repaint_delay > Duration::from_hours(1),
        "{what}: due in {:?}, because of {:?}",
        output.repaint_delay,
        harness.ctx.repaint_causes()
    );
}

#[test]
fn every_panel_comes_to_rest() {
    let mut harness = opened();
    for panel in Panel::all() {
        harness
            .state_mut()
            .state
            .apply(Command::Window(WindowCommand::OpenPanel(panel)));
        assert_rests(&mut harness, panel.name());
    }
}

#[test]
fn a_field_that_has_the_focus_comes_to_rest() {
    let mut harness = opened();
    let seed = |harness: &Harness<'_, App>| {
        let session = harness.state().state.runs().first.session.clone();
        session.expect("a session").run().parameters.seed
    };
    let before = seed(&harness);
    node(&harness, "seed").click();
    harness.run();
    node(&harness, "seed").type_text("2");
    harness.run();
    assert!(harness.ctx.text_edit_focused());
    assert_rests(&mut harness, "a field");
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Enter);
    harness.step();
    settle(&mut harness);
    assert_ne!(seed(&harness), before);
    assert!(harness.ctx.text_edit_focused());
    assert_rests(&mut harness, "a field after its run");
}
