//! The analysis of a set in space in the window: numbers that move with the run, and charts at rest.

use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_core::Parameter;
use tilescope_session::language::Language;
use tilescope_session::words::grouped;
use tilescope_workbench::Command;
use tilescope_workbench::command::{FormCommand, TimeCommand};
use tilescope_workbench::layout::{Layout, Panel};
use tilescope_workbench::state::Settings;

use crate::support::sessions::apply;
use crate::support::{find, node, opened_at, settle, text};

/// A window with a set in a box of 12 x 11 x 10 r, and its analysis at full height.
fn analysing() -> Harness<'static, App> {
    let mut harness = opened_at([1000.0, 900.0]);
    for (parameter, value) in [
        (Parameter::Width, "6"),
        (Parameter::Height, "5.5"),
        (Parameter::Radius, "0.5"),
    ] {
        let command = FormCommand::Type(parameter, value.to_owned());
        apply(&mut harness, Command::Form(command));
    }
    let depth = FormCommand::Depth("5".to_owned());
    apply(&mut harness, Command::Form(depth));
    apply(&mut harness, Command::Run);
    harness.state_mut().state.restore(Settings {
        layout: Some(Layout::alone(Panel::Analysis)),
        ..Settings::default()
    });
    settle(&mut harness);
    harness
}

#[test]
fn the_panel_shows_the_numbers_of_six_moments_in_both_directions() {
    let mut harness = analysing();
    let end = harness.state().state.runs().first.cursor().unwrap().1;
    assert!(text(&harness, "analysis.number-density").ends_with("reference 0.7336"));
    let mut said = Vec::new();
    for part in [0.1, 0.3, 0.31, 0.9, 0.05, 1.0] {
        let cursor = (end as f64 * part) as usize;
        apply(&mut harness, Command::Time(TimeCommand::Jump(cursor)));
        settle(&mut harness);

        let run = &harness.state().state.runs().first;
        let shown = run.shown().unwrap();
        let there = shown.moment().covering(shown.session).len();
        let samples = grouped(there);
        // The volume is 12 x 11 x 10 cubed radii.
        let density = format!("{:.4}", there as f64 / 1_320.0);
        let status = text(&harness, "analysis.status");
        for part in [
            &*grouped(cursor),
            &format!("{samples} samples"),
            "no conflicts",
        ] {
            assert!(status.contains(part), "{status} lacks {part}");
        }
        for (row, value) in [
            ("samples", &*samples),
            ("density", &density),
            ("conflicts", "0"),
        ] {
            let row = text(&harness, format_args!("analysis.number-{row}"));
            assert!(row.contains(&format!(": {value},")), "{row} is not {value}");
        }
        said.push(text(&harness, "analysis.number-active_cubes"));
    }
    assert!(said.pop().is_some_and(|row| row.contains(": 0,")));
    assert!(said.iter().all(|row| !row.contains(": 0,")), "{said:?}");

    // Planar sets have no row in common with spectra here, and those at rest have their charts.
    assert!(find(&harness, "analysis.number-gaps").is_none());
    assert!(text(&harness, "analysis.rest").contains("of this moment"));
    assert!(text(&harness, "chart.P").contains("this moment"));
    node(&harness, "chart.g");

    // Nothing that the panel says is left in English.
    let german = Language::of("de").unwrap();
    for id in ["analysis.status", "analysis.global", "analysis.rest"] {
        let english = text(&harness, id);
        assert_ne!(german.text(&english), english, "{id}");
    }
}
