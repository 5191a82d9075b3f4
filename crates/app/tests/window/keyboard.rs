//! A whole session by keyboard alone, as users without a mouse or with a screen reader work.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, ViewportCommand, ViewportId};
use tilescope_debugger::EventKind;

use crate::support;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::App;
use tilescope_app::actions::Action;
use tilescope_tests::some;
use tilescope_workbench::Command;
use tilescope_workbench::command::WindowCommand;
use tilescope_workbench::layout::Panel;

use crate::support::{
    author, cursor, debugger, focused, last_kind, next_kind, node, opened, session, settle, text,
};

const NONE: Modifiers = Modifiers::NONE;

fn press(harness: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run();
    settle(harness);
}

/// Runs the action whose id begins with `id`, by typing its name into the list of actions.
fn act(harness: &mut Harness<'_, App>, id: &str) {
    let all = tilescope_app::actions::actions(&harness.state().state);
    let is_meant = |action: &&Action| action.id().to_string().starts_with(id);
    let action = all.iter().find(is_meant);
    let name = action.unwrap_or_else(|| panic!("no {id}")).name.clone();
    press(harness, Modifiers::COMMAND, Key::K);
    harness.event(Event::Text(name.clone()));
    harness.run();
    press(harness, NONE, Key::Enter);
    assert!(
        harness.state().state.window().finder.is_none(),
        "{name} was not done"
    );
}

/// Presses Tab until the focus is on the widget of an id.
fn tab_to(harness: &mut Harness<'_, App>, id: &str) {
    for _ in 0..200 {
        press(harness, NONE, Key::Tab);
        if focused(harness).as_deref() == Some(id) {
            return;
        }
    }
    panic!("Tab does not lead to {id}");
}

#[test]
fn a_session_needs_no_mouse() {
    let mut harness = opened();
    // A run with another radius, typed into its field.
    act(&mut harness, "view-window-hide-panel-parameters");
    assert!(!harness.state().state.window().shows(Panel::Parameters));
    act(&mut harness, "view-window-open-panel-parameters");
    tab_to(&mut harness, "radius");
    press(&mut harness, Modifiers::COMMAND, Key::A);
    harness.event(Event::Text("0.02".to_owned()));
    harness.run();
    press(&mut harness, Modifiers::COMMAND, Key::Enter);
    let session = session(&harness);
    assert!((session.run().parameters.radius - 0.02).abs() < 1e-12);
    press(&mut harness, NONE, Key::Escape);

    // A breakpoint on eliminations, with a condition.
    act(&mut harness, "go-time-first-stage");
    act(&mut harness, "go-time-run-to-elimination-forwards");
    assert_eq!(last_kind(&harness), Some(EventKind::Eliminate));
    act(&mut harness, "go-time-step-into-backwards");
    assert_eq!(next_kind(&harness), Some(EventKind::Eliminate));
    act(&mut harness, "debug-debug-toggle-breakpoint");
    act(&mut harness, "view-window-open-panel-scenes");
    tab_to(&mut harness, "eliminate.5.condition");
    harness.event(Event::Text("distance < 0.3".to_owned()));
    harness.run();
    press(&mut harness, NONE, Key::Escape);
    act(&mut harness, "go-time-first-stage");
    press(&mut harness, NONE, Key::F5);
    let distance: f64 = debugger(&harness)
        .evaluate("distance")
        .unwrap()
        .parse()
        .unwrap();
    assert!(distance < 0.3);
    assert!(!harness.state().state.runs().first.hits.events().is_empty());

    // The event is announced; go to its cause and back.
    let stopped = cursor(&harness);
    press(&mut harness, NONE, Key::F11);
    assert_eq!(cursor(&harness), stopped + 1);
    let status = node(&harness, "status").accesskit_node();
    assert_eq!(status.live(), egui::accesskit::Live::Polite);
    let sentence = tilescope_debugger::sentence(debugger(&harness).recording(), stopped);
    assert_eq!(text(&harness, "status"), sentence);
    press(&mut harness, NONE, Key::W);
    assert!(cursor(&harness) <= stopped + 1);
    act(&mut harness, "view-window-open-panel-inspector");
    press(&mut harness, Modifiers::SHIFT, Key::F5);
    press(&mut harness, NONE, Key::F5);
    assert_eq!(cursor(&harness), stopped);
    press(&mut harness, NONE, Key::B);
    assert_eq!(debugger(&harness).scenes[0].event, stopped);

    // Pan, and select at the centre.
    act(&mut harness, "view-view-first-zoom");
    let before = harness.state().state.runs().first.camera;
    press(&mut harness, Modifiers::SHIFT, Key::ArrowRight);
    let after = harness.state().state.runs().first.camera;
    assert!(after.center[0] > before.center[0]);
    press(&mut harness, NONE, Key::M);
    let state = &harness.state().state;
    assert!(state.runs().first.selected.is_some() || state.runs().first.place.is_some());

    // Compare with another seed; both runs go to where they diverge.
    act(&mut harness, "compare-compare-start-next-seed");
    act(&mut harness, "compare-compare-go-to-divergence");
    let (second, _) = harness
        .state()
        .state
        .runs()
        .second
        .as_ref()
        .expect("a second run");
    assert!(second.session.is_some());
    assert!(cursor(&harness) < stopped);
    act(&mut harness, "compare-compare-close");
    assert!(harness.state().state.runs().second.is_none());
}

#[test]
fn space_plays_and_pauses_unless_a_button_has_the_focus() {
    let mut harness = opened();
    let playing = |harness: &Harness<'_, App>| harness.state().state.time().playback.is_playing();
    let space = |harness: &mut Harness<'_, App>| {
        harness.key_press(Key::Space);
        harness.step();
        harness.step();
    };
    press(&mut harness, NONE, Key::Home);
    space(&mut harness);
    assert!(playing(&harness));
    space(&mut harness);
    assert!(!playing(&harness));
    press(&mut harness, NONE, Key::End);
    node(&harness, "time-first-stage").focus();
    harness.step();
    space(&mut harness);
    // Space pressed the button and did not start playback.
    assert_eq!(cursor(&harness), 0);
    assert!(!playing(&harness));
}

/// A widget: its role, its text and its id.
type Described = (String, Option<String>);

fn described(node: &egui_kittest::Node<'_>) -> Described {
    let id = author(node);
    let node = node.accesskit_node();
    let name = node.label().or(node.value()).unwrap_or_default();
    (format!("{:?} {name}", node.role()), id)
}

/// Presses Tab until the focus returns to the first widget; returns all focused widgets, in order.
fn tab_round(harness: &mut Harness<'_, App>) -> Vec<Described> {
    let mut round: Vec<Described> = Vec::new();
    let mut first = None;
    for _ in 0..400 {
        harness.key_press(Key::Tab);
        harness.run();
        let focused = harness
            .query_all_by(|node| node.is_focused() && !node.is_hidden())
            .next();
        let Some(node) = focused else { continue };
        let id = node.accesskit_node().id();
        if first == Some(id) {
            return round;
        }
        first = first.or(Some(id));
        round.push(described(&node));
    }
    panic!("Tab goes on and on: {round:?}");
}

/// Returns the enabled widgets that can be pressed or typed into.
fn controls(harness: &Harness<'_, App>) -> Vec<Described> {
    const ROLES: [Role; 8] = [
        Role::Button,
        Role::CheckBox,
        Role::ComboBox,
        Role::TextInput,
        Role::Slider,
        Role::Canvas,
        Role::Link,
        Role::RadioButton,
    ];
    let nodes = harness.query_all_by(|node| ROLES.contains(&node.role()) && !node.is_disabled());
    nodes.map(|node| described(&node)).collect()
}

#[test]
fn tab_reaches_every_control_of_every_panel() {
    for size in some([[1440.0, 900.0], [390.0, 844.0]]) {
        let mut harness = support::opened_at(size);
        for panel in Panel::all() {
            harness
                .state_mut()
                .state
                .apply(Command::Window(WindowCommand::OpenPanel(panel)));
            settle(&mut harness);
            let round = tab_round(&mut harness);
            let missing: Vec<Described> = controls(&harness)
                .into_iter()
                .filter(|control| !round.contains(control))
                .collect();
            assert_eq!(missing, [], "{panel:?} at {size:?}");
        }
    }
}

#[test]
fn tab_goes_through_a_small_window_from_top_to_bottom() {
    let mut harness = support::opened_at([390.0, 844.0]);
    harness
        .state_mut()
        .state
        .apply(Command::Window(WindowCommand::OpenPanel(Panel::Parameters)));
    settle(&mut harness);
    let round = tab_round(&mut harness);
    let index = |id: &str| {
        let found = round.iter().position(|at| at.1.as_deref() == Some(id));
        found.unwrap_or_else(|| panic!("{id} is not in {round:?}"))
    };
    let indices = [
        "menu",
        "canvas",
        "time-first-stage",
        "time-toggle-play",
        "tab.parameters",
        "radius",
        "run",
    ]
    .map(index);
    assert!(indices.is_sorted(), "{round:?}");
}

#[test]
fn arrows_move_a_canvas_that_has_the_focus_and_else_time() {
    let mut harness = opened();
    let last = cursor(&harness);
    node(&harness, "canvas").focus();
    harness.run();
    let before = harness.state().state.runs().first.camera;
    press(&mut harness, NONE, Key::ArrowRight);
    press(&mut harness, NONE, Key::ArrowDown);
    let after = harness.state().state.runs().first.camera;
    assert!(after.center[0] > before.center[0] && after.center[1] < before.center[1]);
    assert_eq!(cursor(&harness), last);
    assert_eq!(focused(&harness).as_deref(), Some("canvas"));
    press(&mut harness, NONE, Key::Plus);
    assert!(harness.state().state.runs().first.camera.scale > after.scale);
    press(&mut harness, NONE, Key::Enter);
    let state = &harness.state().state;
    assert!(state.runs().first.selected.is_some() || state.runs().first.place.is_some());
    // Elsewhere the same keys move in time and leave the focus where it is.
    node(&harness, "time-toggle-play").focus();
    harness.run();
    let camera = harness.state().state.runs().first.camera;
    press(&mut harness, NONE, Key::ArrowLeft);
    assert!(cursor(&harness) < last);
    assert_eq!(focused(&harness).as_deref(), Some("time-toggle-play"));
    assert_eq!(harness.state().state.runs().first.camera, camera);
}

#[test]
fn tabs_rows_and_menus_are_pressed_by_enter() {
    let mut harness = opened();
    tab_to(&mut harness, "tab.events");
    press(&mut harness, NONE, Key::Enter);
    assert!(harness.state().state.window().shows(Panel::Events));
    act(&mut harness, "go-time-first-stage");
    tab_to(&mut harness, "event-0");
    press(&mut harness, NONE, Key::Enter);
    assert!(cursor(&harness) > 0);
    tab_to(&mut harness, "stage.eliminate");
    press(&mut harness, NONE, Key::Enter);
    let stage = harness.state().state.runs().first.current_stage();
    assert_eq!(stage, Some(tilescope_core::Stage::Eliminate));
    // Enter opens a menu, and Tab moves within it.
    tab_to(&mut harness, "menu.file");
    press(&mut harness, NONE, Key::Enter);
    tab_to(&mut harness, "entry.file-file-sheet-save");
    press(&mut harness, NONE, Key::Enter);
    assert!(harness.state().state.files().sheet.is_some());
}

#[test]
fn a_panel_scrolls_to_the_focused_widget() {
    let mut harness = support::opened_at([390.0, 844.0]);
    harness
        .state_mut()
        .state
        .apply(Command::Window(WindowCommand::OpenPanel(Panel::Parameters)));
    settle(&mut harness);
    let window = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(390.0, 844.0));
    let rect = |harness: &Harness<'_, App>| node(harness, "variant").rect();
    let above = |harness: &Harness<'_, App>| node(harness, "run").rect().top();
    assert!(rect(&harness).bottom() > above(&harness));
    tab_to(&mut harness, "variant");
    harness.run();
    let seen = window.with_max_y(above(&harness));
    assert!(seen.contains_rect(rect(&harness)));
}

fn key(key: Key, modifiers: Modifiers) -> Event {
    Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    }
}

#[test]
fn text_typed_in_one_slow_frame_goes_to_the_list() {
    let mut harness = opened();
    let before = cursor(&harness);
    let letters = |text: &str| -> Vec<Event> {
        let pressed = text
            .chars()
            .filter_map(|c| Key::from_name(&c.to_uppercase().to_string()));
        let texts = text.chars().map(|c| Event::Text(c.to_string()));
        pressed
            .map(|one| key(one, NONE))
            .zip(texts)
            .flat_map(|(a, b)| [a, b])
            .collect()
    };
    // All in one frame: the list opens, and the following keys are text, not shortcuts.
    let events = &mut harness.input_mut().events;
    events.push(key(Key::K, Modifiers::COMMAND));
    events.extend(letters("projector"));
    events.push(key(Key::Enter, NONE));
    harness.step();
    settle(&mut harness);
    assert_eq!(
        harness.state().state.appearance().look,
        tilescope_session::look::Look::Projector
    );
    assert!(harness.state().state.window().finder.is_none());
    assert_eq!(cursor(&harness), before);
    // The list is open, but its field does not have the focus yet.
    let events = &mut harness.input_mut().events;
    events.push(key(Key::K, Modifiers::COMMAND));
    events.extend(letters("lig"));
    harness.step();
    assert_eq!(
        harness.state().state.window().finder.as_ref().unwrap().text,
        "lig"
    );
    settle(&mut harness);
    harness.event(Event::Text("ht".to_owned()));
    harness.run();
    press(&mut harness, NONE, Key::Enter);
    assert_eq!(
        harness.state().state.appearance().look,
        tilescope_session::look::Look::Light
    );
    // Enter does nothing before anything was typed.
    let events = &mut harness.input_mut().events;
    events.push(key(Key::K, Modifiers::COMMAND));
    events.push(key(Key::Enter, NONE));
    harness.step();
    press(&mut harness, NONE, Key::Enter);
    assert!(harness.state().state.window().finder.is_some());
    assert!(harness.state().state.runs().first.sampling.is_none());
}

#[test]
fn escape_in_the_frame_of_ctrl_k_closes_the_list() {
    let mut harness = opened();
    let open = key(Key::K, Modifiers::COMMAND);
    let close = key(Key::Escape, NONE);
    let frame = |harness: &mut Harness<'_, App>, events: &[&Event]| {
        let events = events.iter().map(|event| (*event).clone());
        harness.input_mut().events.extend(events);
        harness.run();
        harness.state().state.window().finder.is_some()
    };
    assert!(!frame(&mut harness, &[&open, &close]), "opened and closed");
    assert!(frame(&mut harness, &[&open]));
    assert!(!frame(&mut harness, &[&open, &close]), "closed twice");
    assert!(frame(&mut harness, &[&open]));
    assert!(!frame(&mut harness, &[&close]));
}

#[test]
fn alt_and_enter_ask_for_the_full_screen_and_give_it_back() {
    let mut harness = opened();
    let mut asked = |fullscreen: bool| {
        let viewport = harness.input_mut().viewports.entry(ViewportId::ROOT);
        viewport.or_default().fullscreen = Some(fullscreen);
        let press = key(Key::Enter, Modifiers::ALT);
        harness.input_mut().events.push(press);
        harness.step();
        let viewports = harness.output().viewport_output.values();
        let commands: Vec<ViewportCommand> = viewports.flat_map(|v| v.commands.clone()).collect();
        commands
    };
    let full = |on: bool| vec![ViewportCommand::Fullscreen(on)];
    assert_eq!(asked(false), full(true));
    assert_eq!(asked(true), full(false));
    // The menu shows which it is.
    let all = tilescope_app::actions::actions(&harness.state().state);
    let action = all.iter().find(|action| action.name == "Full screen");
    assert_eq!(action.and_then(|action| action.is_on), Some(true));
}
