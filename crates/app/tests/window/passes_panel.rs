//! The panel of GPU passes by clicks and typing. Needs an adapter; a software one is enough.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock, RwLock};

use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::show_passes;
use tilescope_core::{Parameters, Stage};
use tilescope_drawing::palette::Palette;
use tilescope_gpu::{Choice, Gpu};
use tilescope_session::jobs::Wake;
use tilescope_session::look::Look;
use tilescope_ui::theme::install;
use tilescope_workbench::passes::{Badge, PassCommand, Passes};

use crate::support::{find, is_disabled, node, text};

struct Shown {
    passes: Passes,
    look: Look,
}

fn gpu() -> &'static Arc<Gpu> {
    static GPU: OnceLock<Arc<Gpu>> = OnceLock::new();
    GPU.get_or_init(|| {
        let choice = Choice {
            software: true,
            ..Choice::default()
        };
        let opened = pollster::block_on(Gpu::open(&choice));
        Arc::new(opened.expect("these tests need a GPU adapter; a software one will do"))
    })
}

/// Background work blocks at its next progress report while this is locked.
#[derive(Default)]
struct Gate {
    lock: RwLock<()>,
    reached: AtomicBool,
}

/// Returns the panel; its background work is blocked by `gate`.
fn begun(gate: &Arc<Gate>) -> Harness<'static, Shown> {
    let parameters = Parameters {
        radius: 0.02,
        ..Parameters::default()
    };
    let gate = Arc::clone(gate);
    let wake: Wake = Arc::new(move || {
        gate.reached.store(true, Ordering::SeqCst);
        drop(gate.lock.read());
    });
    let shown = Shown {
        passes: Passes::new(gpu(), &parameters, &wake).expect("a small run"),
        look: Look::Dark,
    };
    Harness::builder()
        .with_size([1060.0, 640.0])
        .with_max_steps(64)
        .build_ui_state(
            |ui, shown: &mut Shown| {
                install(ui.ctx(), shown.look);
                let mut commands = Vec::new();
                show_passes(ui, &shown.passes, Palette::of(shown.look), &mut commands);
                for command in commands {
                    shown.passes.apply(command);
                }
            },
            shown,
        )
}

fn opened() -> Harness<'static, Shown> {
    let mut harness = begun(&Arc::default());
    settle(&mut harness);
    harness
}

fn settle(harness: &mut Harness<'_, Shown>) {
    harness.state_mut().passes.settle();
    harness.run();
}

fn tiled() -> Harness<'static, Shown> {
    let mut harness = opened();
    assert!(harness.state_mut().passes.select_stage(Stage::Tile));
    settle(&mut harness);
    harness
}

#[test]
fn the_list_is_cancelled_while_it_is_made_and_made_again() {
    let gate = Arc::<Gate>::default();
    let closed = gate.lock.write().expect("the gate");
    let mut harness = begun(&gate);
    // From here on the layout does not change, so the button stays in its place.
    while !gate.reached.load(Ordering::SeqCst) {
        std::thread::yield_now();
    }
    harness.run();
    node(&harness, "passes.cancel").click();
    harness.step();
    harness.step();
    drop(closed);
    settle(&mut harness);
    node(&harness, "passes.notice");
    node(&harness, "passes.again").click();
    harness.step();
    harness.step();
    settle(&mut harness);
    assert!(text(&harness, "passes.summary").contains(", 0 "));
}

#[test]
fn passes_are_chosen_by_click_button_and_arrow_key() {
    let mut harness = opened();
    assert!(text(&harness, "pass-3").contains("count"));
    node(&harness, "pass-3").click();
    harness.step();
    settle(&mut harness);
    assert_eq!(harness.state().passes.selected(), Some(2));
    for (key, pass) in [
        (egui::Key::ArrowDown, 3),
        (egui::Key::ArrowDown, 4),
        (egui::Key::ArrowUp, 3),
        (egui::Key::Home, 0),
        (egui::Key::End, harness.state().passes.entries().len() - 1),
    ] {
        harness.key_press(key);
        harness.step();
        settle(&mut harness);
        assert_eq!(harness.state().passes.selected(), Some(pass), "{key:?}");
    }
    assert!(is_disabled(&harness, "passes.next"));
    assert!(text(&harness, "passes.place").contains("Finish"));
    node(&harness, "passes.previous").click();
    harness.step();
    settle(&mut harness);
    let visit = harness.state().passes.visit().expect("a visit");
    assert!(visit.replayed);
    let count = harness.state().passes.entries().len();
    assert_eq!(harness.state().passes.selected(), Some(count - 2));
}

#[test]
fn the_selected_pass_is_in_sight() {
    let mut harness = opened();
    let last = harness.state().passes.entries().len();
    let name = harness.state().passes.entries()[last - 1].report.name;
    let row = format!("pass-{last}");
    assert!(find(&harness, &row).is_none());
    harness.state_mut().passes.apply(PassCommand::Last);
    settle(&mut harness);
    assert!(text(&harness, &row).contains(name));
    let rect = node(&harness, &row).rect();
    assert!(rect.top() > 0.0 && rect.bottom() < 640.0);
}

#[test]
fn a_buffer_is_chosen_filtered_and_its_error_is_beside_the_box() {
    let mut harness = tiled();
    node(&harness, "buffer.origins").click();
    harness.step();
    settle(&mut harness);
    let row = text(&harness, "row-0");
    let facts = ["changed", "image 0", "pattern index 0 \u{2192}"];
    assert!(facts.iter().all(|fact| row.contains(fact)), "{row}");
    let all = harness.state().passes.shown().rows().len();
    assert!(find(&harness, format_args!("row-{}", all - 1)).is_none());
    node(&harness, "filter").focus();
    harness.run();
    node(&harness, "filter").type_text("picture>1");
    harness.run();
    assert!(text(&harness, "filtered").contains("\"picture\""));
    let [error, field] = ["filtered", "filter"].map(|id| node(&harness, id).rect());
    assert!(error.left() > field.right() && (error.center().y - field.center().y).abs() < 8.0);
    harness
        .state_mut()
        .passes
        .apply(PassCommand::Filter("row<2".to_owned()));
    harness.run();
    assert!(text(&harness, "filtered").starts_with("2 of "));
    assert!(find(&harness, "row-2").is_none());
    node(&harness, "side.before").click();
    harness.run();
    assert_eq!(harness.state().passes.shown().rows(), [0, 1]);
}

#[test]
fn the_rows_of_a_buffer_are_those_of_a_table() {
    let mut harness = tiled();
    node(&harness, "buffer.origins").click();
    harness.step();
    settle(&mut harness);

    let grid = harness
        .query_all_by(|node| node.role() == Role::Grid)
        .map(|grid| {
            let grid = grid.accesskit_node();
            (grid.label(), grid.data().row_count())
        })
        .collect::<Vec<_>>();
    // Rows that are not drawn count too, and so do the heads.
    let all = harness.state().passes.shown().rows().len() + 1;
    assert_eq!(grid, [(Some("Rows of the buffer".to_owned()), Some(all))]);
    let of = |role: Role| {
        harness
            .query_all_by(move |node| node.role() == role)
            .count()
    };
    let (rows, columns) = (of(Role::Row), of(Role::ColumnHeader));
    assert!(rows > 3 && rows < all && columns > 2);
    assert_eq!(of(Role::RowHeader), rows - 1);
    assert_eq!(of(Role::Cell), (rows - 1) * (columns - 1));

    // The choices are groups of their names.
    for name in ["Buffers of the pass", "Side of the pass"] {
        let named = harness.query_all_by(move |node| node.label().as_deref() == Some(name));
        assert_eq!(named.count(), 1, "{name}");
    }
}

#[test]
fn a_word_is_tried_and_undone() {
    let mut harness = tiled();
    node(&harness, "passes.try").click();
    harness.step();
    settle(&mut harness);
    assert!(harness.state().passes.fault().is_some());
    assert!(text(&harness, "passes.fault").contains("word 0 of "));
    node(&harness, "passes.undo").click();
    harness.step();
    settle(&mut harness);
    assert!(harness.state().passes.fault().is_none());
    let entries = harness.state().passes.entries();
    assert!(!entries.is_empty());
    assert!(
        entries
            .iter()
            .all(|e| !matches!(e.badge, Badge::Differs(_)))
    );
}

#[test]
fn both_themes_are_drawn() {
    let mut harness = tiled();
    let dark = harness.render().expect("a picture");
    harness.state_mut().look = Look::Light;
    harness.run();
    let light = harness.render().expect("a picture");
    assert_ne!(dark.as_raw(), light.as_raw());
}

#[test]
fn rows_are_selected_by_click_and_the_canvas_is_a_choice() {
    let mut harness = tiled();
    node(&harness, "row-3").click();
    harness.run();
    assert_eq!(harness.state().passes.shown().picked(), Some(3));
    // The pointer is there still.
    assert_eq!(harness.state().passes.shown().pointed(), Some(3));
    node(&harness, "row-3").click();
    harness.run();
    assert_eq!(harness.state().passes.shown().picked(), None);
    assert!(harness.state().passes.on_canvas().is_some());
    node(&harness, "passes.on-canvas").click();
    harness.run();
    assert!(harness.state().passes.on_canvas().is_none());
    assert!(is_disabled(&harness, "passes.show-canvas"));
}
