//! The analysis panel: its text, its references, and its use by keyboard.

use std::path::PathBuf;

use egui::{Key, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use serde_json::json;
use tilescope_app::App;
use tilescope_core::{Boundary, Parameter};
use tilescope_workbench::Command;
use tilescope_workbench::analysis::AnalysisCommand;
use tilescope_workbench::analysis::brush::{Brush, BrushAxis};
use tilescope_workbench::command::{AppearanceCommand, FormCommand, TimeCommand, WindowCommand};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::curve::CurveNumber;
use tilescope_workbench::draft::Choice;
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::layout::{Layout, Panel};
use tilescope_workbench::state::Settings;

use crate::support::sessions::{apply, folder, go, notice, path_text};
use crate::support::{cursor, find, focused, is_disabled, node, opened_at, session, settle, text};

/// A small session, and its analysis at full height.
pub(crate) fn analysing() -> Harness<'static, App> {
    // High enough for the buttons below the periodogram.
    let mut harness = opened_at([1000.0, 1340.0]);
    for (field, value) in [(Parameter::Radius, "0.02"), (Parameter::Leaf, "8")] {
        apply(
            &mut harness,
            Command::Form(FormCommand::Type(field, value.to_owned())),
        );
    }
    apply(&mut harness, Command::Run);
    harness.state_mut().state.restore(Settings {
        layout: Some(Layout::alone(Panel::Analysis)),
        ..Settings::default()
    });
    settle(&mut harness);
    harness
}

/// The rows of numbers.
const SAMPLES: &str = "analysis.number-samples";
const DENSITY: &str = "analysis.number-density";
const CONFLICTS: &str = "analysis.number-conflicts";

/// Asserts that a widget's text contains all of `facts`.
#[track_caller]
fn says(harness: &Harness<'_, App>, id: &str, facts: &[&str]) {
    let shown = text(harness, id);
    for fact in facts {
        assert!(shown.contains(fact), "{id} does not say {fact}: {shown}");
    }
}

/// Returns the roles and names of the cells of a row.
fn cells(harness: &Harness<'_, App>, row: &str) -> Vec<(Role, String)> {
    let row = node(harness, row);
    let cells = row.accesskit_node().children();
    cells
        .flat_map(|cell| match cell.label() {
            Some(label) => vec![(cell.role(), label)],
            // The cells stand in a container without a name.
            None => (cell.children())
                .map(|cell| (cell.role(), cell.label().unwrap_or_default()))
                .collect(),
        })
        .collect()
}

#[test]
fn the_numbers_are_a_table_with_heads_rows_and_cells() {
    let mut harness = analysing();
    let tables: Vec<_> = harness
        .query_all_by(|node| node.role() == Role::Table)
        .map(|table| table.accesskit_node().label())
        .collect();
    assert_eq!(tables, [Some("Numbers of the sets".to_owned())]);
    let heads = harness.query_all_by(|node| node.role() == Role::ColumnHeader);
    let heads: Vec<_> = heads
        .map(|head| head.accesskit_node().label().unwrap_or_default())
        .collect();
    assert_eq!(heads, ["number", "moment", "reference"]);

    let of_samples = cells(&harness, SAMPLES);
    assert_eq!(of_samples.len(), 3, "{of_samples:?}");
    assert_eq!(of_samples[0], (Role::RowHeader, "Samples".to_owned()));
    assert_eq!(of_samples[1].0, Role::Cell);
    // What the row says as a whole has the same number.
    assert!(text(&harness, SAMPLES).contains(&of_samples[1].1));

    // A second run is two more columns.
    let start = CompareCommand::Start(ComparePreset::NextSeed);
    apply(&mut harness, Command::Compare(start));
    settle(&mut harness);
    let compared = cells(&harness, SAMPLES);
    assert_eq!(compared.len(), 5, "{compared:?}");
    assert_eq!(compared[..2], of_samples[..2]);
}

#[test]
fn the_panel_says_the_numbers_and_describes_its_charts() {
    let mut harness = analysing();
    let state = &harness.state().state;
    let count = state.runs().first.session.as_ref().unwrap().summary.count;
    let count = tilescope_session::words::grouped(count);
    says(&harness, "analysis.status", &[&count, "finish"]);
    says(&harness, SAMPLES, &[&count, "27,8"]);
    says(&harness, "chart.P", &["P(\u{3bd})", "reference"]);
    node(&harness, "chart.periodogram");
    says(&harness, "analysis.reference", &["200 r", "27,8"]);
    apply(&mut harness, Command::Time(TimeCommand::Jump(1_500)));
    says(&harness, "analysis.status", &["1,500", "tile"]);
    assert!(!text(&harness, SAMPLES).contains(&count));
}

/// Writes independent samples of the unit square; returns the file's path.
pub(crate) fn noise(name: &str) -> PathBuf {
    let path = folder(name).join("noise.csv");
    let mut state = 5_u64;
    let mut draw = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let lines: Vec<String> = (0..900)
        .map(|_| format!("{},{}\n", draw(), draw()))
        .collect();
    std::fs::write(&path, format!("x,y\n{}", lines.concat())).unwrap();
    path
}

#[test]
fn a_file_is_held_against_the_run_until_it_is_cleared() {
    let mut harness = analysing();
    node(&harness, "analysis.hold").click();
    harness.run();
    let path = noise("against");
    apply(
        &mut harness,
        Command::File(FileCommand::Path(path_text(&path))),
    );
    apply(&mut harness, Command::File(FileCommand::Go));
    assert!(
        harness.state().state.files().sheet.is_none(),
        "the sheet is closed"
    );
    let state = &harness.state().state;
    let file = (state.analysis())
        .file_for(&state.runs().first)
        .unwrap()
        .unwrap()
        .clone();
    assert_eq!(file.measured.samples, 900);
    // Noise has conflicts with the run's radius.
    assert!(file.measured.verdict().unwrap().conflicts > 100);
    says(&harness, "analysis.file", &["noise.csv", "0.02"]);
    says(&harness, "chart.P", &["noise.csv"]);
    says(&harness, SAMPLES, &["file 900"]);
    assert!(find(&harness, "analysis.unjudged").is_none());
    // With another radius, measures independent of it stay, and verdicts for the old one go.
    let conflicts = file.measured.verdict().unwrap().conflicts as usize;
    let conflicts = format!("file {}", tilescope_session::words::grouped(conflicts));
    says(&harness, CONFLICTS, &[&conflicts]);
    // 900 samples times r squared.
    says(&harness, DENSITY, &["file 0.3600"]);
    apply(
        &mut harness,
        Command::Form(FormCommand::Type(Parameter::Radius, "0.03".to_owned())),
    );
    apply(&mut harness, Command::Run);
    says(&harness, DENSITY, &["file 0.8100"]);
    says(&harness, CONFLICTS, &["file \u{2013}"]);
    says(&harness, "analysis.unjudged", &["0.02", "0.03"]);
    apply(
        &mut harness,
        Command::Form(FormCommand::Type(Parameter::Radius, "0.02".to_owned())),
    );
    apply(&mut harness, Command::Run);
    says(&harness, CONFLICTS, &[&conflicts]);
    // In another domain the file is kept but not drawn, and the panel explains why.
    apply(
        &mut harness,
        Command::Form(FormCommand::Type(Parameter::Width, "2".to_owned())),
    );
    apply(&mut harness, Command::Run);
    assert!(
        harness
            .state()
            .state
            .analysis()
            .file_for(&harness.state().state.runs().first)
            .unwrap()
            .is_err()
    );
    assert!(!text(&harness, SAMPLES).contains("file"));
    let domains = ["1 \u{d7} 1 periodic", "2 \u{d7} 1 periodic"];
    says(&harness, "analysis.refusal", &domains);
    node(&harness, "analysis.clear").click();
    harness.run();
    assert!(
        harness
            .state()
            .state
            .analysis()
            .file_for(&harness.state().state.runs().first)
            .is_none()
    );
    for id in ["analysis.file", "analysis.refusal"] {
        assert!(find(&harness, id).is_none(), "{id}");
    }
    assert!(!text(&harness, "chart.P").contains("noise.csv"));
    assert!(is_disabled(&harness, "analysis.clear"));
}

#[test]
fn sets_of_another_domain_are_refused_in_a_sentence_that_names_both() {
    let mut harness = analysing();
    let path = noise("another-domain");
    for (command, domain) in [
        (
            Command::Form(FormCommand::Type(Parameter::Width, "2".to_owned())),
            "2 \u{d7} 1 periodic",
        ),
        (
            Command::Form(FormCommand::Type(Parameter::Height, "0.5".to_owned())),
            "2 \u{d7} 0.5 periodic",
        ),
    ] {
        apply(&mut harness, command);
        apply(&mut harness, Command::Run);
        apply(&mut harness, Command::DismissNotice);
        go(&mut harness, Purpose::Against, &path);
        let (text, is_error) = notice(&harness);
        assert!(is_error && text.contains("1 \u{d7} 1 periodic"), "{text}");
        assert!(text.contains(domain), "{text}");
        assert!(
            harness
                .state()
                .state
                .analysis()
                .file_for(&harness.state().state.runs().first)
                .is_none()
        );
    }
    // The border counts, too: a file of the unit torus, and a run in a bounded domain.
    let torus = path.with_file_name("torus.txt");
    std::fs::write(&torus, "4\n0.1 0.1\n0.6 0.1\n0.1 0.6\n0.6 0.6\n").unwrap();
    for command in [
        Command::Form(FormCommand::Type(Parameter::Width, "1".to_owned())),
        Command::Form(FormCommand::Type(Parameter::Height, "1".to_owned())),
    ] {
        apply(&mut harness, command);
    }
    apply(&mut harness, Command::Run);
    go(&mut harness, Purpose::Against, &torus);
    assert!(
        harness
            .state()
            .state
            .analysis()
            .file_for(&harness.state().state.runs().first)
            .unwrap()
            .is_ok()
    );
    apply(&mut harness, Command::Analysis(AnalysisCommand::Clear));
    apply(
        &mut harness,
        Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::Boundary,
            json!(Boundary::Bounded),
        ))),
    );
    apply(&mut harness, Command::Run);
    apply(&mut harness, Command::DismissNotice);
    go(&mut harness, Purpose::Against, &torus);
    let (text, _) = notice(&harness);
    assert!(
        text.contains("1 \u{d7} 1 periodic") && text.contains("1 \u{d7} 1 bounded"),
        "{text}"
    );
}

#[test]
fn files_made_to_do_harm_are_refused_and_the_session_stays() {
    let mut harness = analysing();
    let folder = folder("hostile-sets");
    let before = session(&harness);
    let lines = |line: &str, count: usize| format!("x,y\n{}", line.repeat(count)).into_bytes();
    for (name, bytes) in [
        ("empty.csv", Vec::new()),
        ("head.csv", b"x,y\n".to_vec()),
        ("nan.csv", b"x,y\n0.1,NaN\n0.2,0.3\n0.5,0.5\n".to_vec()),
        ("infinite.csv", b"x,y\n0.1,inf\n0.2,0.3\n0.5,0.5\n".to_vec()),
        ("outside.csv", b"x,y\n0.1,7.5\n0.2,0.3\n0.5,0.5\n".to_vec()),
        ("two.csv", b"x,y\n0.1,0.2\n0.2,0.3\n".to_vec()),
        ("one-place.csv", lines("0.25,0.75\n", 50)),
        ("binary.csv", vec![0xff, 0xfe, 0x00, 0x01, 0x80]),
        ("huge-count.txt", b"99999999999\n0.1 0.1\n".to_vec()),
    ] {
        let path = folder.join(name);
        std::fs::write(&path, bytes).unwrap();
        apply(&mut harness, Command::DismissNotice);
        go(&mut harness, Purpose::Against, &path);
        let (text, is_error) = notice(&harness);
        assert!(is_error && text.contains(name), "{name}: {text}");
        assert!(
            harness
                .state()
                .state
                .analysis()
                .file_for(&harness.state().state.runs().first)
                .is_none(),
            "{name}"
        );
    }
    apply(&mut harness, Command::DismissNotice);
    go(&mut harness, Purpose::Against, &folder);
    assert!(notice(&harness).1, "a folder is no file");
    let after = session(&harness);
    assert!(std::sync::Arc::ptr_eq(&before, &after));
    // Two samples at the same position are a conflict, and are measured like others.
    let twice = folder.join("twice.csv");
    let rest = "0.9,0.4\n0.6,0.1\n0.2,0.3\n0.2,0.3\n";
    std::fs::write(&twice, format!("x,y\n{rest}")).unwrap();
    go(&mut harness, Purpose::Against, &twice);
    let state = &harness.state().state;
    let file = (state.analysis())
        .file_for(&state.runs().first)
        .unwrap()
        .unwrap()
        .clone();
    let verdict = file.measured.verdict().expect("a verdict");
    assert!(verdict.conflicts > 0 && file.measured.spectrum.is_some());
}

#[test]
fn the_keyboard_reaches_the_analysis_its_brush_and_the_way_out() {
    let mut harness = opened_at([1440.0, 900.0]);
    assert!(!harness.state().state.window().shows(Panel::Analysis));
    harness.key_press(Key::A);
    harness.run();
    settle(&mut harness);
    assert!(harness.state().state.window().shows(Panel::Analysis));
    let tab_to = |harness: &mut Harness<'_, App>, id: &str| {
        for _ in 0..200 {
            harness.key_press(Key::Tab);
            harness.run();
            if focused(harness).as_deref() == Some(id) {
                return;
            }
        }
        panic!("Tab does not lead to {id}");
    };
    tab_to(&mut harness, "brush.distance");
    harness.key_press(Key::Space);
    harness.run();
    settle(&mut harness);
    let brush = harness.state().state.analysis().brush;
    assert_eq!(brush, Brush::between(BrushAxis::Distance, 1.0, 1.05));
    tab_to(&mut harness, "brush.distance.to");
    assert!(harness.state().state.runs().first.session.is_some());
    harness.key_press(Key::Escape);
    harness.run();
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(harness.state().state.analysis().brush, None);
}

#[test]
fn dragging_over_a_chart_brushes_and_a_click_ends_it() {
    let mut harness = analysing();
    let rect = node(&harness, "chart.g").rect();
    let at = |part: f32| rect.left_center() + egui::vec2(part * rect.width(), 0.0);
    harness.drag_at(at(0.3));
    harness.run();
    harness.hover_at(at(0.4));
    harness.run();
    harness.drop_at(at(0.4));
    harness.run();
    let brush = harness.state().state.analysis().brush.expect("a brush");
    assert_eq!(brush.axis, BrushAxis::Distance);
    let [low, high] = brush.range;
    assert!(low > 1.0 && high < 2.0 && high - low > 0.3, "{brush:?}");
    // Brushing a frequency replaces the brushed distance.
    let rect = node(&harness, "chart.P").rect();
    let at = |part: f32| rect.left_center() + egui::vec2(part * rect.width(), 0.0);
    harness.drag_at(at(0.5));
    harness.run();
    harness.hover_at(at(0.4));
    harness.run();
    harness.drop_at(at(0.4));
    harness.run();
    let brush = harness.state().state.analysis().brush.expect("a brush");
    assert!(brush.axis == BrushAxis::Frequency && brush.range[0] < brush.range[1]);
    node(&harness, "chart.P").click();
    harness.run();
    assert_eq!(harness.state().state.analysis().brush, None);
}

#[test]
fn oblong_domains_are_drawn_with_the_panel_open() {
    let mut harness = analysing();
    for (width, height) in [("2", "1"), ("1", "1.7")] {
        for (field, value) in [(Parameter::Width, width), (Parameter::Height, height)] {
            apply(
                &mut harness,
                Command::Form(FormCommand::Type(field, value.to_owned())),
            );
        }
        apply(&mut harness, Command::Run);
        settle(&mut harness);
        let image = harness.render().expect("a picture of the panel");
        assert_eq!(image.width(), 1000);
        let rect = node(&harness, "chart.periodogram").rect();
        // The picture has as many shades as a periodogram.
        let inside = image
            .enumerate_pixels()
            .filter(|(x, y, _)| rect.contains(egui::pos2(*x as f32, *y as f32)));
        let shades: std::collections::BTreeSet<[u8; 4]> = inside.map(|(_, _, at)| at.0).collect();
        assert!(shades.len() > 50, "{width} x {height}: {}", shades.len());
    }
}

/// Counts the pixels of the canvas that differ.
fn differing(harness: &Harness<'_, App>, a: &[u8], b: &[u8], width: u32) -> usize {
    let canvas = harness.state().state.runs().first.viewport;
    let pixels = a.chunks(4).zip(b.chunks(4)).enumerate();
    let changed = pixels.filter(|(index, (a, b))| {
        let (x, y) = (*index as u32 % width, *index as u32 / width);
        a != b && canvas.contains(egui::pos2(x as f32, y as f32))
    });
    changed.count()
}

#[test]
fn brushed_samples_are_marked_on_the_canvas_until_cleared() {
    let mut harness = opened_at([1440.0, 900.0]);
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Analysis)),
    );
    let width = 1440;
    let mut picture = |brush: Option<Brush>| {
        apply(
            &mut harness,
            Command::Analysis(AnalysisCommand::Brush(brush)),
        );
        let image = harness.render().expect("a picture of the window");
        assert_eq!(image.width(), width);
        image.into_raw()
    };
    let without = picture(None);
    let pairs = picture(Brush::between(BrushAxis::Distance, 1.0, 1.05));
    let ring = picture(Brush::between(BrushAxis::Frequency, 0.8, 1.0));
    let nothing = picture(Brush::between(BrushAxis::Distance, 0.1, 0.9));
    let again = picture(None);
    assert!(differing(&harness, &without, &pairs, width) > 5_000);
    assert!(differing(&harness, &without, &ring, width) > 5_000);
    assert!(differing(&harness, &pairs, &ring, width) > 5_000);
    assert_eq!(differing(&harness, &without, &nothing, width), 0);
    assert_eq!(differing(&harness, &without, &again, width), 0);
}

#[test]
fn the_analysis_moves_with_the_run_and_says_what_follows_at_rest() {
    let mut harness = analysing();
    let jump = Command::Time(TimeCommand::Jump(1_500));
    harness.state_mut().state.apply(jump);
    // A frame, and no waiting for work in the background.
    harness.step();
    says(
        &harness,
        "analysis.status",
        &["1,500", "tile", "frequencies"],
    );
    let state = &harness.state().state;
    let shown = state.runs().first.shown().unwrap();
    let live = state.runs().first.live.of(&shown).expect("live measures");
    let count = tilescope_session::words::grouped(live.samples);
    says(&harness, SAMPLES, &[&count]);
    says(&harness, "analysis.number-oscillation", &["at rest"]);
    for id in [SAMPLES, CONFLICTS, DENSITY] {
        assert!(!text(&harness, id).contains("moment before"), "{id}");
    }

    settle(&mut harness);
    let at_rest = text(&harness, "analysis.number-oscillation");
    assert!(!at_rest.contains("at rest"), "{at_rest}");
}

#[test]
fn the_run_is_drawn_as_a_curve_that_leads_to_its_moments() {
    let mut harness = opened_at([1440.0, 900.0]);
    let number = CurveNumber::of("conflicts");
    let command = Command::Appearance(AppearanceCommand::Curve(number));
    apply(&mut harness, command);
    says(&harness, "curve.chart", &["conflicts", "Highest"]);
    says(
        &harness,
        "curve.row-3",
        &["Eliminate", "0 pairs at its end"],
    );

    let rect = node(&harness, "curve.chart").rect();
    let end = harness.state().state.runs().first.cursor().unwrap().1;
    let at = rect.left_center() + egui::vec2(0.4 * rect.width(), 0.0);
    harness.drag_at(at);
    harness.run();
    harness.drop_at(at);
    harness.run();
    let at = cursor(&harness);
    assert!(at > 0 && at < end, "{at}");
    let value = text(&harness, "curve.value");
    assert!(value.contains("pairs"), "{value}");

    node(&harness, "curve.hide").click();
    harness.run();
    assert!(find(&harness, "curve.chart").is_none());
}

#[test]
fn the_second_run_stands_beside_the_first_with_their_difference() {
    let mut harness = analysing();
    for id in ["chart.difference", "analysis.status-b", "analysis.second"] {
        assert!(find(&harness, id).is_none(), "{id}");
    }
    let start = CompareCommand::Start(ComparePreset::Leaf);
    apply(&mut harness, Command::Compare(start));
    harness.state_mut().state.restore(Settings {
        layout: Some(Layout::alone(Panel::Analysis)),
        ..Settings::default()
    });
    settle(&mut harness);

    let state = &harness.state().state;
    let runs = [
        &state.runs().first,
        &state.runs().second.as_ref().expect("a second run").0,
    ];
    let counts = runs.map(|run| run.session.as_ref().unwrap().summary.count);
    let [a, b] = counts.map(tilescope_session::words::grouped);
    let sign = if counts[1] < counts[0] {
        "\u{2212}"
    } else {
        "+"
    };
    let difference = tilescope_session::words::grouped(counts[0].abs_diff(counts[1]));
    assert_ne!(counts[0], counts[1]);
    let facts = [
        format!("A {a}"),
        format!("B {b}"),
        format!("B \u{2212} A {sign}{difference}"),
    ];
    says(&harness, SAMPLES, &facts.each_ref().map(String::as_str));
    says(&harness, CONFLICTS, &["A 0", "B 0", "B \u{2212} A 0"]);
    says(&harness, "analysis.status-b", &["B: ", &b]);
    says(&harness, "chart.P", &["run A", "run B", "reference"]);
    node(&harness, "chart.periodogram-b");
    says(&harness, "chart.difference", &["B minus A"]);
}

#[test]
fn a_moment_has_one_picture_whichever_moments_were_seen_before() {
    let mut harness = analysing();
    let end = cursor(&harness);
    let picture = |harness: &mut Harness<'_, App>, cursor: usize| {
        apply(harness, Command::Time(TimeCommand::Jump(cursor)));
        let rect = node(harness, "chart.P").rect();
        let texts = harness.output().shapes.iter().filter_map(|clipped| {
            let egui::Shape::Text(text) = &clipped.shape else {
                return None;
            };
            rect.contains(text.pos)
                .then(|| text.galley.text().to_owned())
        });
        texts.collect::<Vec<String>>()
    };
    let before = picture(&mut harness, end);
    // After tiling the power is higher than the axis: its peak is marked with its value.
    let tiled = picture(&mut harness, 1_500);
    assert_ne!(tiled, before);
    assert!(tiled.len() > before.len(), "{tiled:?}");
    assert_eq!(picture(&mut harness, end), before);
}
