//! The window as a user meets it: found by its labels, clicked, typed into, looked at.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::canvas::layers::Layer;
use tilescope_app::combination::CombineCommand;
use tilescope_app::command::{Choice, Field};
use tilescope_app::device::Engine;
use tilescope_app::export::ExportCommand;
use tilescope_app::layout::Panel;
use tilescope_app::{App, Command};
use tilescope_core::{Search, Stage};

use crate::support::{opened, settle};

fn shown_stage(harness: &Harness<'_, App>) -> Stage {
    harness.state().state.current_stage().expect("a session")
}

#[test]
fn it_opens_on_a_finished_verified_session() {
    let harness = opened();
    harness.get_by_label("Verdict: verified");
    harness.get_by_label_contains("Finish: 10,041 samples");
    harness.get_by_label_contains("event 45,961 of 45,961");
    assert_eq!(shown_stage(&harness), Stage::Finish);
}

#[test]
fn stages_go_back_and_forward_by_button_key_and_track() {
    let mut harness = opened();
    harness.get_by_label("Stage back (Left)").click();
    harness.run();
    assert_eq!(shown_stage(&harness), Stage::Iterate(3));
    for _ in 0..2 {
        harness.key_press(egui::Key::ArrowLeft);
        harness.run();
    }
    harness.get_by_label_contains("Iteration 1:");
    harness.get_by_label("Eliminate").click();
    harness.run();
    assert_eq!(shown_stage(&harness), Stage::Eliminate);
    harness.get_by_label("Stage forward (Right)").click();
    harness.run();
    assert_eq!(shown_stage(&harness), Stage::Iterate(1));
}

#[test]
fn a_bad_radius_is_refused_beside_its_field_and_run_is_disabled() {
    let mut harness = opened();
    assert!(!harness.get_by_label("Run").accesskit_node().is_disabled());
    harness
        .get_by_role_and_label(Role::TextInput, "Radius")
        .focus();
    harness.run();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness
        .get_by_role_and_label(Role::TextInput, "Radius")
        .type_text("0");
    harness.run();
    let reason = harness.get_by_label_contains("must be a finite number above 0");
    let field = harness
        .get_by_role_and_label(Role::TextInput, "Radius")
        .rect();
    assert!(reason.rect().top() >= field.top() && reason.rect().top() < field.bottom() + 12.0);
    assert!(harness.get_by_label("Run").accesskit_node().is_disabled());
}

#[test]
fn enter_in_a_field_runs() {
    let mut harness = opened();
    harness
        .get_by_role_and_label(Role::TextInput, "Seed")
        .focus();
    harness.run();
    harness
        .get_by_role_and_label(Role::TextInput, "Seed")
        .type_text("7");
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.step();
    settle(&mut harness);
    let session = harness.state().state.session.clone().expect("a session");
    assert_ne!(session.run().parameters.seed, 1);
}

#[test]
fn a_run_can_be_cancelled() {
    let mut harness = opened();
    let count = harness
        .state()
        .state
        .session
        .as_ref()
        .expect("a session")
        .summary
        .count;
    harness
        .state_mut()
        .state
        .apply(Command::Type(Field::Radius, "0.0005".to_owned()));
    harness.step();
    harness.get_by_label("Run").click();
    harness.step();
    harness.step();
    harness.get_by_label("Cancel").click();
    harness.step();
    harness.step();
    settle(&mut harness);
    harness.get_by_label_contains("Cancelled during stage");
    harness.get_by_label("Dismiss").click();
    harness.run();
    assert!(
        harness
            .query_by_label_contains("Cancelled during stage")
            .is_none()
    );
    let after = harness
        .state()
        .state
        .session
        .as_ref()
        .expect("a session")
        .summary
        .count;
    assert_eq!(after, count);
}

#[test]
fn a_failing_verdict_is_red_and_flies_to_the_gap() {
    let mut harness = opened();
    for command in [
        Command::Type(Field::Leaf, "6".to_owned()),
        Command::Type(Field::Radius, "0.004".to_owned()),
        Command::Choose(Choice::Search(Search::TwoRadii)),
        Command::Run,
    ] {
        harness.state_mut().state.apply(command);
    }
    settle(&mut harness);
    let before = harness.state().state.camera;
    harness.get_by_label("Verdict: not maximal").click();
    harness.run();
    let after = harness.state().state.camera;
    assert!(after.scale > 5.0 * before.scale && (after.center[0] - before.center[0]).abs() > 1e-3);
    assert!(harness.state().state.sight.is_some());
}

#[test]
fn every_layer_of_a_run_or_a_combination_has_a_chip_that_toggles_it() {
    let mut harness = opened();
    for combination in [false, true] {
        if combination {
            let command = Command::Combine(CombineCommand::Nine);
            harness.state_mut().state.apply(command);
            settle(&mut harness);
        }
        for layer in Layer::ALL {
            let chip = harness.query_by_role_and_label(Role::CheckBox, layer.name_in(combination));
            assert_eq!(chip.is_some(), layer.is_of(combination), "{layer:?}");
            let before = harness.state().state.layers.has(layer);
            if let Some(chip) = chip {
                chip.click();
                harness.run();
                assert_ne!(harness.state().state.layers.has(layer), before, "{layer:?}");
            }
        }
    }
    let of_none = |layer: &Layer| !layer.is_of(false) && !layer.is_of(true);
    assert_eq!(Layer::ALL.iter().find(|layer| of_none(layer)), None);
}

#[test]
fn the_theme_toggles_and_both_are_drawn() {
    let mut harness = opened();
    let dark = harness.render().expect("a picture");
    harness.get_by_label("Light theme").click();
    harness.run();
    let light = harness.render().expect("a picture");
    let brightness = |image: &[u8]| image.iter().map(|&v| u64::from(v)).sum::<u64>();
    assert!(brightness(light.as_raw()) > 2 * brightness(dark.as_raw()));
    harness.get_by_label("Dark theme");
}

#[test]
fn the_export_sheet_refuses_unknown_extensions() {
    let mut harness = opened();
    harness.get_by_label("Export\u{2026}").click();
    harness.run();
    harness
        .state_mut()
        .state
        .apply(Command::Export(ExportCommand::Path("set.jpeg".to_owned())));
    harness.run();
    harness.get_by_label_contains("The extension chooses the format");
    let write = harness.get_by_label("Write file and certificate");
    assert!(write.accesskit_node().is_disabled());
}

#[test]
fn the_canvas_zooms_about_the_pointer_and_pans() {
    let mut harness = opened();
    let viewport = harness.state().state.viewport;
    assert!(viewport.width() >= 0.6 * 1440.0);
    let at = viewport.center() + egui::vec2(120.0, 60.0);
    let place = harness
        .state()
        .state
        .camera
        .domain_from_screen(viewport, at);
    harness.hover_at(at);
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, 200.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: egui::Modifiers::NONE,
    });
    harness.run();
    let camera = harness.state().state.camera;
    let now = camera.domain_from_screen(viewport, at);
    assert!(camera.scale > 6.0 && (now[0] - place[0]).abs() < 1e-3);
    let center = camera.center;
    harness.drag_at(at);
    harness.run();
    harness.hover_at(at + egui::vec2(50.0, 0.0));
    harness.run();
    harness.drop_at(at + egui::vec2(50.0, 0.0));
    harness.run();
    assert!(harness.state().state.camera.center[0] < center[0]);
}

#[test]
fn the_engine_is_chosen_by_its_label_and_a_missing_gpu_leaves_the_cpu() {
    let mut harness = opened();
    harness.get_by_label("engine: CPU");
    let missing = Command::NameAdapter(Some("no such adapter".to_owned()));
    harness.state_mut().state.apply(missing);
    harness
        .get_by_role_and_label(Role::ComboBox, "Engine")
        .click();
    harness.run();
    harness.get_by_label("auto (CPU)");
    harness.get_by_label("GPU").click();
    harness.step();
    harness.step();
    settle(&mut harness);
    harness.get_by_label_contains("The GPU cannot serve.");
    assert_eq!(harness.state().state.engine, Engine::Auto);
    harness.get_by_label("Dismiss").click();
    harness.run();
    harness
        .get_by_role_and_label(Role::ComboBox, "Engine")
        .click();
    harness.run();
    let entry = harness.get_by_label("GPU");
    assert!(entry.accesskit_node().is_disabled());
    assert!(!harness.get_by_label("Run").accesskit_node().is_disabled());
}

#[test]
fn the_gpu_shows_its_name_and_its_verdict() {
    let mut harness = opened();
    harness
        .state_mut()
        .state
        .apply(Command::Engine(Engine::Gpu));
    harness.step();
    assert!(harness.get_by_label("Run").accesskit_node().is_disabled());
    settle(&mut harness);
    harness.get_by_label_contains("self-test passed");
    harness.get_by_label("Run").click();
    harness.step();
    settle(&mut harness);
    harness.get_by_label_contains("engine: GPU (");
    harness.get_by_label("Verdict: verified");
}

/// Returns how much of a panel's tab is scrolled out of view.
fn hidden_part(harness: &Harness<'_, App>, panel: Panel) -> f32 {
    let tree = &harness.state().state.layout.0;
    let tile = tree.tiles.find_pane(&panel).expect("every panel is there");
    let tab = harness.ctx.read_response(tile.egui_id(tree.id()));
    let tab = tab.expect("it has a tab");
    tab.rect.width() - tab.interact_rect.width()
}

#[test]
fn the_tab_of_an_opened_panel_comes_into_view() {
    for size in [[1440.0, 900.0], [960.0, 600.0]] {
        let mut harness = crate::support::opened_at(size);
        for panel in Panel::ALL.into_iter().chain(Panel::ALL.into_iter().rev()) {
            // It stands alone, without a tab.
            if panel == Panel::Timeline {
                continue;
            }
            harness.state_mut().state.apply(Command::OpenPanel(panel));
            settle(&mut harness);
            let hidden = hidden_part(&harness, panel);
            assert!(hidden < 1.0, "{hidden} of {panel:?} at {size:?}");
        }
    }
}
