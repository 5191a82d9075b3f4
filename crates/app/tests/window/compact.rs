//! A window as small as a phone: every panel can be opened, every action done, nothing lies outside.

use egui::accesskit::Role;
use egui::{Rect, Vec2, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::arrangement::{Arrangement, DrawerCommand};
use tilescope_app::command::{DebugCommand, Selection};
use tilescope_app::compare::{CompareCommand, Rival};
use tilescope_app::layout::Panel;
use tilescope_app::theme::Look;
use tilescope_app::{App, Command};

use crate::support::{cursor, opened_at, settle};

const PHONE: [f32; 2] = [390.0, 844.0];

/// The tab of each panel, and words that only it shows.
const TABS: [(&str, Panel, &str); 14] = [
    ("Parameters", Panel::Parameters, "Run"),
    ("Layers", Panel::Canvas, "Disks"),
    ("Clocks", Panel::Timeline, "Loop from here"),
    ("Inspector", Panel::Inspector, "Click a sample"),
    ("Pseudocode", Panel::Pseudocode, "Breakpoint on line"),
    ("Statistics", Panel::Statistics, "Row Tile"),
    ("Verification", Panel::Verification, "Covering radius"),
    ("Events", Panel::Events, "Find events"),
    ("Bookmarks", Panel::Bookmarks, "B remembers the moment."),
    ("Watches", Panel::Watches, "Add a watch"),
    ("Analysis", Panel::Analysis, "Drag over a chart"),
    ("Compare", Panel::Compare, "the run after this one"),
    ("GPU passes", Panel::Passes, "Run the passes"),
    ("Legend", Panel::Legend, "by origin"),
];

fn click(harness: &mut Harness<'_, App>, label: &str) {
    harness
        .get_by_role_and_label(Role::Button, label)
        .click_accesskit();
    harness.run();
    settle(harness);
}

/// Returns what lies outside of the window to the left or the right, but for what is scrolled there.
fn outside(harness: &Harness<'_, App>, width: f32) -> Vec<String> {
    let tabs: Vec<&str> = TABS.iter().map(|tab| tab.0).collect();
    let nodes = harness.query_all_by(|node| node.bounding_box().is_some());
    nodes
        .filter_map(|node| {
            let label = node.accesskit_node().label().unwrap_or_default();
            let value = node.accesskit_node().value().unwrap_or_default();
            let rect = node.rect();
            let is_out = rect.left() < -0.5 || rect.right() > width + 0.5;
            let is_said = !(label.is_empty() && value.is_empty());
            let is_tab = tabs.contains(&label.as_str());
            (is_out && is_said && !is_tab).then(|| format!("{label}{value}: {rect:?}"))
        })
        .collect()
}

#[test]
fn every_panel_has_a_tab_and_fits() {
    for size in [PHONE, [360.0, 640.0], [844.0, 390.0], [768.0, 1024.0]] {
        let mut harness = opened_at(size);
        for (tab, panel, words) in TABS {
            click(&mut harness, tab);
            assert_eq!(harness.state().state.drawer.open, Some(panel));
            assert!(
                harness.query_all_by_label_contains(words).next().is_some(),
                "{tab} lacks {words}"
            );
            assert_eq!(outside(&harness, size[0]), Vec::<String>::new(), "{tab}");
        }
        click(&mut harness, "Close the panel");
        assert_eq!(harness.state().state.drawer.open, None);
        // The same tab opens and closes.
        click(&mut harness, "Legend");
        click(&mut harness, "Legend");
        assert_eq!(harness.state().state.drawer.open, None);
    }
}

#[test]
fn what_lies_outside_would_be_found() {
    let harness = opened_at(PHONE);
    assert!(!outside(&harness, 300.0).is_empty());
}

fn canvas(harness: &Harness<'_, App>) -> Rect {
    harness.state().state.viewport
}

#[test]
fn the_canvas_has_half_of_the_window() {
    let mut harness = opened_at(PHONE);
    harness.run();
    assert!(canvas(&harness).height() > 0.7 * PHONE[1]);
    for size in [PHONE, [360.0, 640.0], [768.0, 1024.0]] {
        let mut harness = opened_at(size);
        click(&mut harness, "Parameters");
        let canvas_rect = canvas(&harness);
        assert!(
            canvas_rect.height() >= 0.5 * size[1] - 1.0,
            "{canvas_rect:?}"
        );
        assert!((canvas_rect.width() - size[0]).abs() < 1.0);
        // What needs more room gets it, and gives it back.
        click(&mut harness, "More room for the panel");
        assert!(canvas(&harness).height() < 0.5 * size[1]);
        click(&mut harness, "Less room for the panel");
        assert_eq!(canvas(&harness), canvas_rect);
    }
    let mut lying = opened_at([844.0, 390.0]);
    click(&mut lying, "Events");
    let canvas_rect = canvas(&lying);
    assert!(canvas_rect.left() < 1.0 && canvas_rect.width() >= 422.0);
    assert!((canvas_rect.height() - 390.0).abs() < 1.0);
}

#[test]
fn the_size_of_the_window_decides_at_once_and_tiles_stay() {
    let mut harness = opened_at([1440.0, 900.0]);
    harness
        .state_mut()
        .state
        .apply(Command::OpenPanel(Panel::Events));
    settle(&mut harness);
    let before = harness.state().state.layout.clone();
    let arrangement = |harness: &Harness<'_, App>| harness.state().state.drawer.arrangement;
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
        .apply(Command::OpenPanel(Panel::Bookmarks));
    settle(&mut harness);
    assert_eq!(harness.state().state.drawer.open, Some(Panel::Bookmarks));
    harness.set_size(vec2(844.0, 390.0));
    harness.step();
    assert_eq!(arrangement(&harness), Arrangement::Landscape);
    harness.set_size(vec2(1440.0, 900.0));
    harness.step();
    harness.run();
    assert_eq!(arrangement(&harness), Arrangement::Tiles);
    // Which tab is active is remembered by the frames; what stands where is the same.
    assert_eq!(harness.state().state.layout, before);
    harness.get_by_label("Find events");
}

#[test]
fn fingers_have_room() {
    let mut harness = opened_at(PHONE);
    for (label, least) in [
        ("First stage (Home)", 40.0),
        ("Stage back (Left)", 40.0),
        ("Play (Space)", 40.0),
        ("Stage forward (Right)", 40.0),
        ("Last stage (End)", 40.0),
        ("Menu", 40.0),
        ("Parameters", 40.0),
    ] {
        let rect = harness.get_by_role_and_label(Role::Button, label).rect();
        assert!(rect.width() >= least && rect.height() >= least, "{label}");
    }
    click(&mut harness, "Parameters");
    let field = harness.get_by_role_and_label(Role::TextInput, "Radius");
    assert!(field.rect().height() >= 36.0);
    click(&mut harness, "Layers");
    assert!(harness.get_by_label("Disks").rect().height() >= 36.0);
}

/// Does an action by the one menu.
fn menu(harness: &mut Harness<'_, App>, menu: &str, action: &str) {
    // It stays open when an action was done elsewhere.
    if harness.query_by_label("File menu").is_none() {
        click(harness, "Menu");
    }
    let name = format!("{menu} menu");
    let is_open = {
        let heading = harness.get_by_role_and_label(Role::Button, &name);
        heading.accesskit_node().toggled() == Some(egui::accesskit::Toggled::True)
    };
    if !is_open {
        harness
            .get_by_role_and_label(Role::Button, &name)
            .click_accesskit();
        harness.run();
    }
    let found = harness.query_all_by_role_and_label(Role::Button, action);
    let node = found.last().unwrap_or_else(|| panic!("no {action}"));
    assert!(!node.accesskit_node().is_disabled(), "{action}");
    node.click_accesskit();
    harness.run();
    settle(harness);
}

#[test]
fn every_primary_action_can_be_done() {
    let mut harness = opened_at(PHONE);
    click(&mut harness, "First stage (Home)");
    assert_eq!(cursor(&harness), 0);
    click(&mut harness, "Stage forward (Right)");
    assert!(cursor(&harness) > 0);
    click(&mut harness, "Stage back (Left)");
    assert_eq!(cursor(&harness), 0);
    click(&mut harness, "Last stage (End)");
    click(&mut harness, "Show the whole domain (F)");
    // The verdict leads to its witness.
    click(&mut harness, "Verdict: verified");
    assert!(harness.state().state.sight.is_some());
    click(&mut harness, "Parameters");
    click(&mut harness, "Run");
    assert!(harness.state().state.session.is_some());
    menu(&mut harness, "View", "Light theme");
    assert_eq!(harness.state().state.look, Look::Light);
    menu(&mut harness, "View", "Reduced motion");
    assert!(harness.state().state.reduced_motion);
    menu(&mut harness, "Compare", "Compare with the next seed");
    assert!(harness.state().state.comparison.is_some());
    assert_eq!(outside(&harness, PHONE[0]), Vec::<String>::new());
    menu(&mut harness, "Compare", "Close B");
    menu(&mut harness, "Analyze", "Show analysis");
    assert!(harness.state().state.analyses());
}

#[test]
fn sheets_and_notices_fit() {
    for size in [PHONE, [360.0, 640.0], [844.0, 390.0]] {
        let window = Rect::from_min_size(pos2(0.0, 0.0), Vec2::from(size)).expand(0.5);
        let mut harness = opened_at(size);
        menu(&mut harness, "File", "Export samples\u{2026}");
        for kind in ["Picture", "Animation"] {
            click(&mut harness, kind);
            assert_eq!(outside(&harness, size[0]), Vec::<String>::new());
        }
        // Both ends of the sheet can be seen; a low window scrolls to what has the focus.
        for label in ["Write animation", "Result"] {
            harness.get_by_label(label).focus();
            harness.run();
            let rect = harness.get_by_label(label).rect();
            assert!(window.contains_rect(rect), "{label}: {rect:?}");
        }
        harness.key_press(egui::Key::Escape);
        harness.run();
        menu(&mut harness, "File", "Save session\u{2026}");
        let write = harness.get_by_label("Browse\u{2026}").rect();
        assert!(window.contains_rect(write), "{write:?}");
        assert_eq!(outside(&harness, size[0]), Vec::<String>::new());
        harness.key_press(egui::Key::Escape);
        harness.run();
        menu(&mut harness, "Edit", "All actions\u{2026}");
        let field = harness.get_by_label("Find an action").rect();
        assert!(window.contains_rect(field), "{field:?}");
        assert_eq!(outside(&harness, size[0]), Vec::<String>::new());
        harness.key_press(egui::Key::Escape);
        harness.run();
        let text =
            "A notice of many words that say what has happened, where, and what can be done. ";
        harness.state_mut().state.notice = Some(tilescope_app::state::Notice {
            text: text.repeat(3),
            is_error: true,
        });
        harness.run();
        let dismiss = harness.get_by_label("Dismiss").rect();
        assert!(window.contains_rect(dismiss), "{dismiss:?}");
        assert_eq!(outside(&harness, size[0]), Vec::<String>::new());
    }
}

#[test]
fn a_selected_sample_and_two_runs_fit() {
    let mut harness = opened_at(PHONE);
    let state = &mut harness.state_mut().state;
    for command in [
        Command::Debug(DebugCommand::Pick(Selection::Sample(40))),
        Command::Compare(CompareCommand::Start(Rival::Order)),
        Command::Drawer(DrawerCommand::Show(Some(Panel::Inspector))),
    ] {
        state.apply(command);
    }
    settle(&mut harness);
    assert_eq!(outside(&harness, PHONE[0]), Vec::<String>::new());
    // One above the other: beside each other they would be slits.
    let rects =
        ["Canvas of run A", "Canvas of run B"].map(|name| harness.get_by_label(name).rect());
    assert!(rects[0].bottom() <= rects[1].top());
    assert!(rects.iter().all(|rect| rect.width() > 380.0));
}

#[test]
fn the_systems_wish_for_less_motion_counts_until_the_user_chooses() {
    let mut harness = opened_at([1440.0, 900.0]);
    let state = &mut harness.state_mut().state;
    state.prefer_reduced_motion(true);
    assert_eq!((state.reduced_motion, state.motion_chosen()), (true, None));
    // It is not remembered as a choice, and may change while the window is open.
    state.choose_motion(None);
    state.prefer_reduced_motion(false);
    assert!(!state.reduced_motion);
    state.apply(Command::ToggleReducedMotion);
    assert_eq!(state.motion_chosen(), Some(true));
    state.prefer_reduced_motion(false);
    assert!(state.reduced_motion);
    state.choose_motion(Some(false));
    state.prefer_reduced_motion(true);
    assert!(!state.reduced_motion);
}

#[test]
fn reduced_motion_stops_what_moves_by_itself() {
    let mut harness = opened_at([1440.0, 900.0]);
    let moves = |harness: &Harness<'_, App>| {
        let style = harness.ctx.global_style();
        [
            style.animation_time > 0.0,
            style.scroll_animation != egui::style::ScrollAnimation::none(),
        ]
    };
    let fly = Command::FlyTo([30.0, 30.0], 10.0);
    harness.state_mut().state.apply(fly.clone());
    assert!(harness.state().state.flight.is_some());
    harness
        .state_mut()
        .state
        .apply(Command::ToggleReducedMotion);
    // A flight at work arrives at once, and there are no more.
    let state = &harness.state().state;
    assert!(state.flight.is_none());
    assert!((state.camera.center[0] - 30.0).abs() < 1e-9);
    harness.state_mut().state.apply(Command::Fit);
    harness.state_mut().state.apply(fly);
    assert!(harness.state().state.flight.is_none());
    harness.run();
    assert_eq!(moves(&harness), [false; 2]);
    for look in [Look::Light, Look::Projector, Look::Dark] {
        harness.state_mut().state.apply(Command::Look(look));
        harness.run();
        assert_eq!(moves(&harness), [false; 2], "{look:?}");
    }
    harness
        .state_mut()
        .state
        .apply(Command::ToggleReducedMotion);
    harness.run();
    assert_eq!(moves(&harness), [true; 2]);
}

#[test]
fn a_projector_in_a_phone_is_a_light_phone() {
    let mut harness = opened_at(PHONE);
    let projector = Command::Look(Look::Projector);
    harness.state_mut().state.apply(projector);
    harness.run();
    let state = &harness.state().state;
    assert_eq!(state.drawer.arrangement, Arrangement::Portrait);
    assert!((harness.ctx.zoom_factor() - 1.0).abs() < 1e-6);
    harness.get_by_label("Menu");
}
