//! The window by clicks, typing and reading.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use serde_json::json;
use tilescope_app::{App, tiles};
use tilescope_core::{Parameter, Search, Stage};
use tilescope_session::combination::CombineCommand;
use tilescope_session::layers::{Layer, SessionKind};
use tilescope_ui::widgets::Kebab;
use tilescope_workbench::Command;
use tilescope_workbench::command::{FormCommand, GpuCommand, WindowCommand};
use tilescope_workbench::device::EngineChoice;
use tilescope_workbench::draft::Choice;
use tilescope_workbench::export::ExportCommand;
use tilescope_workbench::layout::Panel;

use crate::support::{find, focused, is_disabled, node, opened, opened_at, session, settle, text};

fn shown_stage(harness: &Harness<'_, App>) -> Stage {
    harness
        .state()
        .state
        .runs()
        .first
        .current_stage()
        .expect("a session")
}

#[test]
fn it_opens_on_a_finished_verified_session() {
    let harness = opened();
    let state = &harness.state().state;
    assert!(
        state
            .runs()
            .first
            .verdict()
            .expect("a verdict")
            .report
            .valid()
    );
    assert!(text(&harness, "status").contains("10,041"));
    assert!(text(&harness, "counts").contains("45,961 of 45,961"));
    assert_eq!(shown_stage(&harness), Stage::Finish);
}

#[test]
fn stages_go_back_and_forward_by_button_key_and_track() {
    let mut harness = opened();
    node(&harness, "time-step-back").click();
    harness.run();
    assert_eq!(shown_stage(&harness), Stage::Iterate(3));
    for _ in 0..2 {
        harness.key_press(egui::Key::ArrowLeft);
        harness.run();
    }
    assert!(text(&harness, "status").contains("Iteration 1"));
    node(&harness, "stage.eliminate").click();
    harness.run();
    assert_eq!(shown_stage(&harness), Stage::Eliminate);
    node(&harness, "time-step-forward").click();
    harness.run();
    assert_eq!(shown_stage(&harness), Stage::Iterate(1));
}

/// Replaces the text of a field, as a user does.
fn type_into(harness: &mut Harness<'_, App>, id: &str, typed: &str) {
    node(harness, id).focus();
    harness.run();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    node(harness, id).type_text(typed);
    harness.run();
}

#[test]
fn an_error_stands_below_its_field_and_covers_no_other() {
    for size in [[1440.0, 900.0], [1280.0, 720.0]] {
        let mut harness = opened_at(size);
        for (field, wrong, error, next) in [
            ("radius", "0", "refusal-radius", "count"),
            ("count", "abc", "count.refusal", "boundary"),
            ("width", "0.001", "refusal-width", "radius"),
            ("seed", "-1", "refusal-seed", "leaf"),
        ] {
            assert!(!is_disabled(&harness, "run"));
            let before = node(&harness, field).rect().top();
            let right = match field {
                "count" => "10000".to_owned(),
                _ => node(&harness, field).value().expect("a text"),
            };
            type_into(&mut harness, field, wrong);
            let rect = |id: &str| node(&harness, id).rect();
            let (shown, reason, below) = (rect(field), rect(error), rect(next));
            assert!((shown.top() - before).abs() < 1.0, "{field} moved");
            assert!(
                reason.top() >= shown.bottom() - 1.0,
                "{error} covers {field}"
            );
            assert!(
                below.top() >= reason.bottom() - 1.0,
                "{error} covers {next}"
            );
            assert!(is_disabled(&harness, "run"), "{field}");

            // Enter leaves the focus in the field: what is typed next mends it.
            harness.key_press(egui::Key::Enter);
            harness.run();
            let hidden = harness.state().state.window().layout.hidden();
            type_into(&mut harness, field, &right);
            assert_eq!(harness.state().state.window().layout.hidden(), hidden);
            assert!(find(&harness, error).is_none(), "{field}");
        }
    }
}

#[test]
fn a_wrong_field_keeps_the_focus_on_enter() {
    let mut harness = opened();
    type_into(&mut harness, "radius", "0.0x");
    harness.key_press(egui::Key::Enter);
    harness.run();
    assert_eq!(focused(&harness).as_deref(), Some("radius"));
    type_into(&mut harness, "radius", "0.02");
    harness.key_press(egui::Key::Enter);
    harness.step();
    settle(&mut harness);
    assert!(session(&harness).summary.count < 2_000);
}

#[test]
fn numbers_are_typed_as_people_write_them() {
    let mut harness = opened();
    for typed in ["20,000", "2e4", "20 000", "20'000"] {
        type_into(&mut harness, "count", typed);
        let radius = harness.state().state.form().draft.parameters.radius;
        assert!((radius / 0.0059 - 1.0).abs() < 0.01, "{typed}: {radius}");
        assert!(!is_disabled(&harness, "run"), "{typed}");
    }
}

#[test]
fn reset_is_not_where_cancel_is_and_resets_the_engine() {
    let mut harness = opened();
    let [reset, cancel, run] =
        ["reset-parameters", "cancel", "run"].map(|id| node(&harness, id).rect());
    assert!(reset.bottom() < run.top(), "Reset is with the presets");
    assert!(!reset.expand(20.0).intersects(cancel));
    assert!(is_disabled(&harness, "cancel"), "nothing runs");
    let cpu = Command::Gpu(GpuCommand::Engine(EngineChoice::Cpu));
    harness.state_mut().state.apply(cpu);
    node(&harness, "reset-parameters").click();
    harness.run();
    assert_eq!(harness.state().state.gpu().engine, EngineChoice::Auto);
}

#[test]
fn enter_in_a_field_runs() {
    let mut harness = opened();
    node(&harness, "seed").focus();
    harness.run();
    node(&harness, "seed").type_text("7");
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.step();
    settle(&mut harness);
    let session = session(&harness);
    assert_ne!(session.run().parameters.seed, 1);
}

#[test]
fn a_run_can_be_cancelled() {
    let mut harness = opened();
    let count = session(&harness).summary.count;
    harness
        .state_mut()
        .state
        .apply(Command::Form(FormCommand::Type(
            Parameter::Radius,
            "0.0005".to_owned(),
        )));
    harness.step();
    node(&harness, "run").click();
    harness.step();
    harness.step();
    node(&harness, "cancel").click();
    harness.step();
    harness.step();
    settle(&mut harness);
    assert!(text(&harness, "notice").contains("Cancelled"));
    node(&harness, "dismiss").click();
    harness.run();
    assert!(find(&harness, "notice").is_none());
    let after = session(&harness).summary.count;
    assert_eq!(after, count);
}

#[test]
fn a_failing_verdict_is_red_and_flies_to_the_gap() {
    let mut harness = opened();
    for command in [
        Command::Form(FormCommand::Type(Parameter::Leaf, "6".to_owned())),
        Command::Form(FormCommand::Type(Parameter::Radius, "0.004".to_owned())),
        Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::Search,
            json!(Search::TwoRadii),
        ))),
        Command::Run,
    ] {
        harness.state_mut().state.apply(command);
    }
    settle(&mut harness);
    let before = harness.state().state.runs().first.camera;
    let verdict = harness
        .state()
        .state
        .runs()
        .first
        .verdict()
        .expect("a verdict");
    assert!(verdict.report.conflict_free() && !verdict.report.maximal());
    node(&harness, "verdict").click();
    harness.run();
    let after = harness.state().state.runs().first.camera;
    assert!(after.scale > 5.0 * before.scale && (after.center[0] - before.center[0]).abs() > 1e-3);
    assert!(harness.state().state.runs().first.witness_mark.is_some());
}

#[test]
fn every_layer_of_a_run_or_a_combination_has_a_chip_that_toggles_it() {
    let mut harness = opened();
    for kind in [SessionKind::Run, SessionKind::Combination] {
        if kind == SessionKind::Combination {
            let command = Command::Combine(CombineCommand::Nine);
            harness.state_mut().state.apply(command);
            settle(&mut harness);
        }
        for layer in Layer::ALL {
            let id = format!("layer.{}", Kebab(layer));
            let chip = find(&harness, &id);
            assert_eq!(chip.is_some(), layer.is_of(kind), "{layer:?}");
            let before = harness.state().state.appearance().layers(None).has(layer);
            if let Some(chip) = chip {
                assert_eq!(text(&harness, &id), layer.name_in(kind));
                chip.click();
                harness.run();
                assert_ne!(
                    harness.state().state.appearance().layers(None).has(layer),
                    before,
                    "{layer:?}"
                );
            }
        }
    }
    let of_none =
        |layer: &Layer| !layer.is_of(SessionKind::Run) && !layer.is_of(SessionKind::Combination);
    // The field is a layer of sets whose radius depends on the place.
    let others: Vec<Layer> = Layer::ALL.into_iter().filter(of_none).collect();
    assert_eq!(others, [Layer::Field]);
}

#[test]
fn the_theme_toggles_and_both_are_drawn() {
    let mut harness = opened();
    let dark = harness.render().expect("a picture");
    node(&harness, "toggle-theme").click();
    harness.run();
    let light = harness.render().expect("a picture");
    let brightness = |image: &[u8]| image.iter().map(|&v| u64::from(v)).sum::<u64>();
    assert!(brightness(light.as_raw()) > 2 * brightness(dark.as_raw()));
    let other = harness.state().state.appearance().look.other().name();
    assert_eq!(text(&harness, "toggle-theme"), other);
}

#[test]
fn the_export_sheet_refuses_unknown_extensions() {
    let mut harness = opened();
    node(&harness, "export").click();
    harness.run();
    harness
        .state_mut()
        .state
        .apply(Command::Export(ExportCommand::Path("set.jpeg".to_owned())));
    harness.run();
    let format = text(&harness, "export.format");
    assert!(format.contains(".csv"), "{format}");
    assert!(is_disabled(&harness, "export.write"));
}

#[test]
fn the_canvas_zooms_about_the_pointer_and_pans() {
    let mut harness = opened();
    let viewport = harness.state().state.runs().first.viewport;
    assert!(viewport.width() >= 0.6 * 1440.0);
    let at = viewport.center() + egui::vec2(120.0, 60.0);
    let position = harness
        .state()
        .state
        .runs()
        .first
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
    let camera = harness.state().state.runs().first.camera;
    let now = camera.domain_from_screen(viewport, at);
    assert!(camera.scale > 6.0 && (now[0] - position[0]).abs() < 1e-3);
    let center = camera.center;
    harness.drag_at(at);
    harness.run();
    harness.hover_at(at + egui::vec2(50.0, 0.0));
    harness.run();
    harness.drop_at(at + egui::vec2(50.0, 0.0));
    harness.run();
    assert!(harness.state().state.runs().first.camera.center[0] < center[0]);
}

#[test]
fn the_engine_is_chosen_by_its_label_and_a_missing_gpu_leaves_the_cpu() {
    let mut harness = opened();
    assert!(text(&harness, "engine-used").contains("CPU"));
    let missing = Command::Gpu(GpuCommand::NameAdapter(Some("no such adapter".to_owned())));
    harness.state_mut().state.apply(missing);
    node(&harness, "engine").click();
    harness.run();
    assert!(text(&harness, "engine.auto").contains("CPU"));
    node(&harness, "engine.gpu").click();
    harness.step();
    harness.step();
    settle(&mut harness);
    assert!(text(&harness, "notice").contains("GPU"));
    assert_eq!(harness.state().state.gpu().engine, EngineChoice::Auto);
    node(&harness, "dismiss").click();
    harness.run();
    node(&harness, "engine").click();
    harness.run();
    assert!(is_disabled(&harness, "engine.gpu"));
    assert!(!is_disabled(&harness, "run"));
}

#[test]
fn the_gpu_shows_its_name_and_its_verdict() {
    let mut harness = opened();
    harness
        .state_mut()
        .state
        .apply(Command::Gpu(GpuCommand::Engine(EngineChoice::Gpu)));
    harness.step();
    assert!(is_disabled(&harness, "run"));
    settle(&mut harness);
    let refusal = harness.state().state.gpu().device.refusal();
    assert_eq!(refusal, None, "the test has passed");
    node(&harness, "run").click();
    harness.step();
    settle(&mut harness);
    assert!(text(&harness, "engine-used").contains("GPU ("));
    let state = &harness.state().state;
    assert!(
        state
            .runs()
            .first
            .verdict()
            .expect("a verdict")
            .report
            .valid()
    );
}

/// Returns how much of a panel's tab is scrolled out of view.
fn hidden_part(harness: &Harness<'_, App>, panel: Panel) -> f32 {
    let tab = harness.ctx.read_response(tiles::tab_id(panel));
    let tab = tab.expect("it has a tab");
    tab.rect.width() - tab.interact_rect.width()
}

#[test]
fn the_tab_of_an_opened_panel_comes_into_view() {
    for size in [[1440.0, 900.0], [960.0, 600.0]] {
        let mut harness = crate::support::opened_at(size);
        for panel in Panel::all().chain(Panel::all().rev()) {
            // It is alone in its tile, without a tab.
            if panel == Panel::Timeline {
                continue;
            }
            harness
                .state_mut()
                .state
                .apply(Command::Window(WindowCommand::OpenPanel(panel)));
            settle(&mut harness);
            let hidden = hidden_part(&harness, panel);
            assert!(hidden < 1.0, "{hidden} of {panel:?} at {size:?}");
        }
    }
}

#[test]
fn help_lists_keys_and_terms_and_says_how_to_cite() {
    let mut harness = opened();
    harness.key_press(egui::Key::Questionmark);
    harness.run();
    assert!(find(&harness, "help.keys").is_some());
    // Keys go to the sheet: the run stays where it is.
    let before = harness.state().state.runs().first.cursor();
    harness.key_press(egui::Key::Home);
    harness.run();
    assert_eq!(harness.state().state.runs().first.cursor(), before);
    node(&harness, "help.terms").click();
    harness.run();
    node(&harness, "help.about").click();
    harness.run();
    assert!(text(&harness, "help.version").contains(env!("CARGO_PKG_VERSION")));
    node(&harness, "help.copy").click();
    harness.step();
    let copied = harness.output().platform_output.commands.iter();
    let has_citation = |command: &egui::OutputCommand| matches!(command, egui::OutputCommand::CopyText(text) if text.contains("Suda, Reiji"));
    assert!(copied.into_iter().any(has_citation));
    harness.key_press(egui::Key::Escape);
    harness.run();
    assert!(find(&harness, "help.keys").is_none());
    harness.key_press(egui::Key::Home);
    settle(&mut harness);
    assert_ne!(harness.state().state.runs().first.cursor(), before);
}

#[test]
fn the_verification_says_up_to_which_covering_radius_a_set_is_maximal() {
    let harness = opened();
    let report = &harness
        .state()
        .state
        .runs()
        .first
        .verdict()
        .expect("a verdict")
        .report;
    let limit = format!("{:.6} r", 1.0 + report.covering_tolerance);
    assert_eq!(limit, "1.000031 r");
    assert!(report.covering_radius <= (1.0 + report.covering_tolerance) * report.radius);
    assert!(find(&harness, "covering-limit").is_some());
    assert!(
        harness.query_by_label("1.000031 r").is_some(),
        "the limit beside the radius"
    );
    let number = tilescope_analysis::measures::number("covering_radius_r");
    let meaning = number.expect("a number").meaning;
    assert!(meaning.contains("(1 + 2^-15) r"), "{meaning}");
}
