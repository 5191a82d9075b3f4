//! A window as small as a phone: every panel can be opened, every action used, and nothing lies outside.

use egui::{Pos2, Rect, Vec2, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::App;
use tilescope_classroom::lessons::LessonCommand;
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_workbench::Command;
use tilescope_workbench::arrangement::{Arrangement, DrawerCommand};
use tilescope_workbench::command::{AppearanceCommand, ViewCommand, Which, WindowCommand};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::curve::CurveNumber;
use tilescope_workbench::layout::Panel;
use tilescope_workbench::scenes::SceneCommand;
use tilescope_workbench::state::Settings;

use crate::support::{cursor, find, is_disabled, node, opened_at, settle};

const PHONE: [f32; 2] = [390.0, 844.0];

/// The tab of each panel, and an id that only this panel shows.
const TABS: [(&str, Panel, &str); 14] = [
    ("tab.parameters", Panel::Parameters, "run"),
    ("tab.canvas", Panel::Canvas, "layer.disks"),
    ("tab.timeline", Panel::Timeline, "loop-start"),
    ("tab.inspector", Panel::Inspector, "inspector.hint"),
    ("tab.pseudocode", Panel::Pseudocode, "blocks.1.breakpoint"),
    ("tab.statistics", Panel::Statistics, "row.tile"),
    ("tab.verification", Panel::Verification, "largest-hole"),
    ("tab.events", Panel::Events, "find-events"),
    ("tab.scenes", Panel::Scenes, "no-scenes"),
    ("tab.watches", Panel::Watches, "add-watch"),
    ("tab.analysis", Panel::Analysis, "brush.status"),
    ("tab.compare", Panel::Compare, "compare.keep"),
    ("tab.passes", Panel::Passes, "passes.run"),
    ("tab.legend", Panel::Legend, "colour.provenance"),
];

fn click(harness: &mut Harness<'_, App>, id: &str) {
    node(harness, id).click_accesskit();
    harness.run();
    settle(harness);
}

/// Returns the widgets outside of the window to the left or right, except scrolled ones.
fn outside(harness: &Harness<'_, App>, width: f32) -> Vec<String> {
    let is_tab = |id: &str| TABS.iter().any(|tab| tab.0 == id);
    let nodes = harness.query_all_by(|node| node.bounding_box().is_some());
    nodes
        .filter_map(|node| {
            let label = node.accesskit_node().label().unwrap_or_default();
            let value = node.accesskit_node().value().unwrap_or_default();
            let rect = node.rect();
            let is_out = rect.left() < -0.5 || rect.right() > width + 0.5;
            let is_said = !(label.is_empty() && value.is_empty());
            let scrolls = node.accesskit_node().author_id().is_some_and(is_tab);
            (is_out && is_said && !scrolls).then(|| format!("{label}{value}: {rect:?}"))
        })
        .collect()
}

#[test]
fn every_panel_has_a_tab_and_fits() {
    for size in [PHONE, [360.0, 640.0], [844.0, 390.0], [768.0, 1024.0]] {
        let mut harness = opened_at(size);
        for (tab, panel, part) in TABS {
            click(&mut harness, tab);
            assert_eq!(harness.state().state.window().drawer.open, Some(panel));
            assert!(find(&harness, part).is_some(), "{tab} lacks {part}");
            assert_eq!(outside(&harness, size[0]), Vec::<String>::new(), "{tab}");
        }
        click(&mut harness, "drawer.close");
        assert_eq!(harness.state().state.window().drawer.open, None);
        // The same tab opens and closes.
        click(&mut harness, "tab.legend");
        click(&mut harness, "tab.legend");
        assert_eq!(harness.state().state.window().drawer.open, None);
    }
}

#[test]
fn widgets_outside_the_window_are_found() {
    let harness = opened_at(PHONE);
    assert!(!outside(&harness, 300.0).is_empty());
}

#[test]
fn the_curve_is_in_the_panel_of_playback_and_leaves_the_canvas_its_room() {
    for size in [PHONE, [360.0, 640.0], [844.0, 390.0]] {
        let mut harness = opened_at(size);
        harness.run();
        let room = canvas(&harness);
        let number = CurveNumber::of("conflicts");
        let curve = Command::Appearance(AppearanceCommand::Curve(number));
        harness.state_mut().state.apply(curve);
        settle(&mut harness);
        harness.run();
        assert_eq!(canvas(&harness), room);
        assert!(find(&harness, "curve.chart").is_none());

        click(&mut harness, "tab.timeline");
        for id in [
            "curve.number",
            "curve.save-csv",
            "curve.save-png",
            "curve.chart",
        ] {
            assert!(find(&harness, id).is_some(), "{size:?} lacks {id}");
        }
        assert!(node(&harness, "curve.chart").rect().width() > 250.0);
        assert_eq!(outside(&harness, size[0]), Vec::<String>::new());
        click(&mut harness, "curve.hide");
        assert!(find(&harness, "curve.chart").is_none());
        assert!(
            find(&harness, "curve.number").is_some(),
            "to choose another one"
        );
    }
}

fn canvas(harness: &Harness<'_, App>) -> Rect {
    harness.state().state.runs().first.viewport
}

#[test]
fn the_canvas_has_half_of_the_window() {
    let mut harness = opened_at(PHONE);
    harness.run();
    assert!(canvas(&harness).height() > 0.7 * PHONE[1]);
    for size in [PHONE, [360.0, 640.0], [768.0, 1024.0]] {
        let mut harness = opened_at(size);
        click(&mut harness, "tab.parameters");
        let canvas_rect = canvas(&harness);
        assert!(
            canvas_rect.height() >= 0.5 * size[1] - 1.0,
            "{canvas_rect:?}"
        );
        assert!((canvas_rect.width() - size[0]).abs() < 1.0);
        // A panel that needs more room can be enlarged and shrunk again.
        click(&mut harness, "drawer.tall");
        assert!(canvas(&harness).height() < 0.5 * size[1]);
        click(&mut harness, "drawer.tall");
        assert_eq!(canvas(&harness), canvas_rect);
    }
    let mut lying = opened_at([844.0, 390.0]);
    click(&mut lying, "tab.events");
    let canvas_rect = canvas(&lying);
    assert!(canvas_rect.left() < 1.0 && canvas_rect.width() >= 422.0);
    assert!((canvas_rect.height() - 390.0).abs() < 1.0);
}

#[test]
fn all_of_a_desktops_window_magnified_four_times_can_be_scrolled_to() {
    // 400% of 1280 by 1024.
    let size = [320.0, 256.0];
    let window = Rect::from_min_size(pos2(0.0, 0.0), Vec2::from(size)).expand(0.5);
    let mut harness = opened_at(size);
    harness.run();
    let is_within =
        |harness: &Harness<'_, App>, id: &str| window.contains_rect(node(harness, id).rect());

    // From the start on there are controls, stages and some of the canvas.
    for id in [
        "menu",
        "time-toggle-play",
        "moment",
        "stage.tile",
        "stage.finish",
    ] {
        let rect = node(&harness, id).rect();
        assert!(window.contains_rect(rect), "{id}: {rect:?}");
    }
    assert!(canvas(&harness).height() > 70.0);

    // The control: the row of panels is below the edge. It comes into view with the focus, and by the wheel.
    assert!(!is_within(&harness, "tab.parameters"));
    for (tab, _, part) in TABS {
        for id in [tab, "menu", tab] {
            node(&harness, id).focus();
            harness.run();
            assert!(is_within(&harness, id), "{id}");
        }
        click(&mut harness, tab);
        // By the wheel the window scrolls on, to the panel below its tab.
        let before = node(&harness, tab).rect().top();
        let at = node(&harness, "status").rect().center();
        scroll(&mut harness, at, -600.0);
        let row = node(&harness, tab).rect();
        assert!(row.top() < before && row.bottom() < window.bottom() - 90.0);
        assert!(find(&harness, part).is_some(), "{tab} lacks {part}");
        assert_eq!(outside(&harness, size[0]), Vec::<String>::new(), "{tab}");
        assert!(is_within(&harness, "drawer.close"));
        click(&mut harness, "drawer.close");
    }
    let at = node(&harness, "status").rect().center();
    scroll(&mut harness, at, 600.0);
    assert!(is_within(&harness, "menu"));
}

/// Turns the wheel over a place.
fn scroll(harness: &mut Harness<'_, App>, at: Pos2, by: f32) {
    harness.hover_at(at);
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, by),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: egui::Modifiers::NONE,
    });
    harness.run();
}

#[test]
fn the_size_of_the_window_decides_at_once_and_tiles_stay() {
    let mut harness = opened_at([1440.0, 900.0]);
    harness
        .state_mut()
        .state
        .apply(Command::Window(WindowCommand::OpenPanel(Panel::Events)));
    settle(&mut harness);
    let before = harness.state().state.window().layout.clone();
    let arrangement =
        |harness: &Harness<'_, App>| harness.state().state.window().drawer.arrangement;
    assert_eq!(arrangement(&harness), Arrangement::Tiles);
    harness.set_size(Vec2::from(PHONE));
    harness.step();
    assert_eq!(arrangement(&harness), Arrangement::Portrait);
    harness.run();
    for (tab, ..) in TABS {
        click(&mut harness, tab);
    }
    harness
        .state_mut()
        .state
        .apply(Command::Window(WindowCommand::OpenPanel(Panel::Scenes)));
    settle(&mut harness);
    assert_eq!(
        harness.state().state.window().drawer.open,
        Some(Panel::Scenes)
    );
    harness.set_size(vec2(844.0, 390.0));
    harness.step();
    assert_eq!(arrangement(&harness), Arrangement::Landscape);
    harness.set_size(vec2(1440.0, 900.0));
    harness.step();
    harness.run();
    assert_eq!(arrangement(&harness), Arrangement::Tiles);
    // Frames may differ in the active tab they remember; all else is equal.
    assert_eq!(harness.state().state.window().layout, before);
    node(&harness, "find-events");
}

#[test]
fn the_picture_of_a_lesson_has_half_of_a_phone() {
    let mut harness = opened_at(PHONE);
    let open = LessonCommand::Open("survivors".to_owned());
    harness.state_mut().state.apply(Command::Lesson(open));
    settle(&mut harness);
    harness.run();
    let picture = canvas(&harness);
    assert!(picture.height() >= 0.5 * PHONE[1] - 1.0, "{picture:?}");
    node(&harness, "lesson-step");
}

#[test]
fn the_bar_leads_to_the_lessons() {
    for size in [PHONE, [360.0, 640.0], [768.0, 1024.0]] {
        let mut harness = opened_at(size);
        let button = node(&harness, "lessons-list").rect();
        let chip = node(&harness, "verdict").rect();
        assert!(!button.intersects(chip), "{button:?} and {chip:?}");
        click(&mut harness, "lessons-list");
        assert!(harness.state().state.lessons().shows_list);
        node(&harness, "lesson-welcome");
        click(&mut harness, "lessons-list");
        assert!(!harness.state().state.lessons().shows_list);
    }
}

#[test]
fn the_list_of_lessons_ends_the_tour() {
    let mut harness = opened_at(PHONE);
    harness
        .state_mut()
        .state
        .apply(Command::Scene(SceneCommand::Tour));
    settle(&mut harness);
    node(&harness, "caption-title");
    click(&mut harness, "lessons-list");
    assert!(
        harness.state().state.lessons().shows_list && !harness.state().state.scenes().is_touring()
    );
    assert!(find(&harness, "caption-title").is_none());
    // The tour, in turn, closes the list.
    harness
        .state_mut()
        .state
        .apply(Command::Scene(SceneCommand::Tour));
    settle(&mut harness);
    assert!(!harness.state().state.lessons().shows_list);
}

#[test]
fn fingers_have_room() {
    let mut harness = opened_at(PHONE);
    for id in [
        "time-first-stage",
        "time-step-back",
        "time-toggle-play",
        "time-step-forward",
        "time-last-stage",
        "menu",
        "lessons-list",
        "tab.parameters",
    ] {
        let rect = node(&harness, id).rect();
        assert!(rect.width() >= 40.0 && rect.height() >= 40.0, "{id}");
    }
    click(&mut harness, "tab.parameters");
    assert!(node(&harness, "radius").rect().height() >= 36.0);
    click(&mut harness, "tab.canvas");
    assert!(node(&harness, "layer.disks").rect().height() >= 36.0);
}

/// Runs an action by the single menu; `menu` may name a submenu after a slash.
fn menu(harness: &mut Harness<'_, App>, menu: &str, action: &str) {
    // The menu stays open after an action was run elsewhere.
    if find(harness, "menu.file").is_none() {
        click(harness, "menu");
    }
    let (menu, submenu) = menu.split_once('/').unwrap_or((menu, ""));
    let mut headings = vec![format!("menu.{menu}")];
    if !submenu.is_empty() {
        headings.push(format!("submenu.{submenu}"));
    }
    for heading in headings {
        let toggled = node(harness, &heading).accesskit_node().toggled();
        if toggled != Some(egui::accesskit::Toggled::True) {
            node(harness, &heading).click_accesskit();
            harness.run();
        }
    }
    let entry = format!("entry.{menu}-{action}");
    assert!(!is_disabled(harness, &entry), "{action}");
    click(harness, &entry);
}

#[test]
fn every_primary_action_can_be_done() {
    let mut harness = opened_at(PHONE);
    click(&mut harness, "time-first-stage");
    assert_eq!(cursor(&harness), 0);
    click(&mut harness, "time-step-forward");
    assert!(cursor(&harness) > 0);
    click(&mut harness, "time-step-back");
    assert_eq!(cursor(&harness), 0);
    click(&mut harness, "time-last-stage");
    click(&mut harness, "fit");
    // The verdict leads to the conflict or gap that decides it.
    click(&mut harness, "verdict");
    assert!(harness.state().state.runs().first.witness_mark.is_some());
    click(&mut harness, "tab.parameters");
    click(&mut harness, "run");
    assert!(harness.state().state.runs().first.session.is_some());
    menu(&mut harness, "view/look", "appearance-look-light");
    assert_eq!(harness.state().state.appearance().look, Look::Light);
    menu(
        &mut harness,
        "view/look",
        "appearance-toggle-reduced-motion",
    );
    assert!(harness.state().state.appearance().reduced_motion);
    menu(&mut harness, "compare/presets", "compare-start-next-seed");
    assert!(harness.state().state.runs().second.is_some());
    assert_eq!(outside(&harness, PHONE[0]), Vec::<String>::new());
    menu(&mut harness, "compare", "compare-close");
    menu(&mut harness, "analyze", "window-open-panel-analysis");
    assert!(harness.state().state.window().shows(Panel::Analysis));
}

#[test]
fn sheets_and_notices_fit() {
    for size in [PHONE, [360.0, 640.0], [844.0, 390.0]] {
        let window = Rect::from_min_size(pos2(0.0, 0.0), Vec2::from(size)).expand(0.5);
        let mut harness = opened_at(size);
        menu(&mut harness, "file", "export-open-result");
        for kind in ["export.picture", "export.animation"] {
            click(&mut harness, kind);
            assert_eq!(outside(&harness, size[0]), Vec::<String>::new());
        }
        // Both ends of the sheet are visible; a low window scrolls to the focus.
        for id in ["export.write", "export.result"] {
            node(&harness, id).focus();
            harness.run();
            let rect = node(&harness, id).rect();
            assert!(window.contains_rect(rect), "{id}: {rect:?}");
        }
        harness.key_press(egui::Key::Escape);
        harness.run();
        menu(&mut harness, "file", "file-sheet-save");
        let write = node(&harness, "file.browse").rect();
        assert!(window.contains_rect(write), "{write:?}");
        assert_eq!(outside(&harness, size[0]), Vec::<String>::new());
        harness.key_press(egui::Key::Escape);
        harness.run();
        menu(&mut harness, "edit", "window-toggle-finder");
        let field = node(&harness, "find-action").rect();
        assert!(window.contains_rect(field), "{field:?}");
        assert_eq!(outside(&harness, size[0]), Vec::<String>::new());
        harness.key_press(egui::Key::Escape);
        harness.run();
        let text =
            "A notice of many words that say what has happened, where, and what can be done. ";
        harness.state_mut().state.report(text.repeat(3));
        harness.run();
        let dismiss = node(&harness, "dismiss").rect();
        assert!(window.contains_rect(dismiss), "{dismiss:?}");
        assert_eq!(outside(&harness, size[0]), Vec::<String>::new());
    }
}

#[test]
fn a_selected_sample_and_two_runs_fit() {
    let mut harness = opened_at(PHONE);
    let state = &mut harness.state_mut().state;
    for command in [
        Command::View(Which::First, ViewCommand::Pick(Selection::Sample(40))),
        Command::Compare(CompareCommand::Start(ComparePreset::Order)),
        Command::Window(WindowCommand::Drawer(DrawerCommand::Show(Some(
            Panel::Inspector,
        )))),
    ] {
        state.apply(command);
    }
    settle(&mut harness);
    assert_eq!(outside(&harness, PHONE[0]), Vec::<String>::new());
    // Stacked, since side by side they would be too narrow.
    let rects = ["canvas-a", "canvas-b"].map(|id| node(&harness, id).rect());
    assert!(rects[0].bottom() <= rects[1].top());
    assert!(rects.iter().all(|rect| rect.width() > 380.0));
}

#[test]
fn the_systems_wish_for_less_motion_counts_until_the_user_chooses() {
    let mut harness = opened_at([1440.0, 900.0]);
    let state = &mut harness.state_mut().state;
    state.restore(Settings {
        prefers_reduced_motion: Some(true),
        ..Settings::default()
    });
    assert_eq!(
        (
            state.appearance().reduced_motion,
            state.appearance().motion_chosen()
        ),
        (true, None)
    );
    // It is not stored as a choice, and may change while the window is open.
    let stored = |chosen| Settings {
        reduced_motion: Some(chosen),
        ..Settings::default()
    };
    state.restore(stored(None));
    state.restore(Settings {
        prefers_reduced_motion: Some(false),
        ..Settings::default()
    });
    assert!(!state.appearance().reduced_motion);
    state.apply(Command::Appearance(AppearanceCommand::ToggleReducedMotion));
    assert_eq!(state.appearance().motion_chosen(), Some(true));
    state.restore(Settings {
        prefers_reduced_motion: Some(false),
        ..Settings::default()
    });
    assert!(state.appearance().reduced_motion);
    state.restore(stored(Some(false)));
    state.restore(Settings {
        prefers_reduced_motion: Some(true),
        ..Settings::default()
    });
    assert!(!state.appearance().reduced_motion);
}

#[test]
fn reduced_motion_stops_animations() {
    let mut harness = opened_at([1440.0, 900.0]);
    let moves = |harness: &Harness<'_, App>| {
        let style = harness.ctx.global_style();
        [
            style.animation_time > 0.0,
            style.scroll_animation != egui::style::ScrollAnimation::none(),
        ]
    };
    let fly = Command::View(Which::First, ViewCommand::FlyTo([30.0, 30.0].into(), 10.0));
    harness.state_mut().state.apply(fly.clone());
    assert!(harness.state().state.runs().first.flight.is_some());
    harness
        .state_mut()
        .state
        .apply(Command::Appearance(AppearanceCommand::ToggleReducedMotion));
    // A camera flight in progress ends at once, and no other begins.
    let state = &harness.state().state;
    assert!(state.runs().first.flight.is_none());
    assert!((state.runs().first.camera.center[0] - 30.0).abs() < 1e-9);
    harness
        .state_mut()
        .state
        .apply(Command::View(Which::First, ViewCommand::Fit));
    harness.state_mut().state.apply(fly);
    assert!(harness.state().state.runs().first.flight.is_none());
    harness.run();
    assert_eq!(moves(&harness), [false; 2]);
    for look in [Look::Light, Look::Projector, Look::Dark] {
        harness
            .state_mut()
            .state
            .apply(Command::Appearance(AppearanceCommand::Look(look)));
        harness.run();
        assert_eq!(moves(&harness), [false; 2], "{look:?}");
    }
    harness
        .state_mut()
        .state
        .apply(Command::Appearance(AppearanceCommand::ToggleReducedMotion));
    harness.run();
    assert_eq!(moves(&harness), [true; 2]);
}

#[test]
fn a_projector_in_a_phone_is_a_light_phone() {
    let mut harness = opened_at(PHONE);
    let projector = Command::Appearance(AppearanceCommand::Look(Look::Projector));
    harness.state_mut().state.apply(projector);
    harness.run();
    let state = &harness.state().state;
    assert_eq!(state.window().drawer.arrangement, Arrangement::Portrait);
    assert!((harness.ctx.zoom_factor() - 1.0).abs() < 1e-6);
    node(&harness, "menu");
}
