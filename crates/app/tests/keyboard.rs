//! A whole session by keyboard alone, as somebody without a mouse, or with a screen reader, goes through it.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::App;
use tilescope_debugger::Kind;

mod support;
use support::{cursor, next_kind, opened, settle};

const NONE: Modifiers = Modifiers::NONE;

fn press(harness: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run();
    settle(harness);
}

/// Does an action by its name in the list of all actions.
fn act(harness: &mut Harness<'_, App>, name: &str) {
    press(harness, Modifiers::COMMAND, Key::K);
    harness.event(Event::Text(name.to_owned()));
    harness.run();
    press(harness, NONE, Key::Enter);
    assert!(
        harness.state().state.palette.is_none(),
        "{name} was not done"
    );
}

/// Presses Tab until the focus is on what has this role and this label.
fn tab_to(harness: &mut Harness<'_, App>, role: Role, label: &str) {
    for _ in 0..200 {
        press(harness, NONE, Key::Tab);
        let there = harness.query_all_by_role(role).any(|node| {
            node.accesskit_node().is_focused()
                && node.accesskit_node().label().as_deref() == Some(label)
        });
        if there {
            return;
        }
    }
    panic!("Tab does not lead to {label}");
}

#[test]
fn a_session_needs_no_mouse() {
    let mut harness = opened();
    // A run of one's own: the radius is typed into its field.
    act(&mut harness, "panel: parameters");
    tab_to(&mut harness, Role::TextInput, "Radius");
    press(&mut harness, Modifiers::COMMAND, Key::A);
    harness.event(Event::Text("0.02".to_owned()));
    harness.run();
    press(&mut harness, Modifiers::COMMAND, Key::Enter);
    let session = harness.state().state.session.clone().expect("a session");
    assert!((session.run().parameters.radius - 0.02).abs() < 1e-12);
    press(&mut harness, NONE, Key::Escape);

    // A breakpoint where samples die, with a condition.
    act(&mut harness, "first stage");
    act(&mut harness, "next elimination");
    assert_eq!(next_kind(&harness), Some(Kind::Eliminate));
    act(&mut harness, "breakpoint on the next line");
    act(&mut harness, "panel: bookmarks");
    tab_to(&mut harness, Role::TextInput, "Condition on eliminate.5");
    harness.event(Event::Text("distance < 0.3".to_owned()));
    harness.run();
    press(&mut harness, NONE, Key::Escape);
    act(&mut harness, "first stage");
    press(&mut harness, NONE, Key::F5);
    let debugger = harness.state().state.debugger.as_ref().expect("events");
    let distance: f64 = debugger.evaluate("distance").unwrap().parse().unwrap();
    assert!(distance < 0.3);
    assert!(!harness.state().state.hits.events().is_empty());

    // What is going on is read out; the cause is asked for; back again.
    let stopped = cursor(&harness);
    press(&mut harness, NONE, Key::F11);
    assert_eq!(cursor(&harness), stopped + 1);
    let mut said = harness.query_all_by(|node| {
        node.live() == egui::accesskit::Live::Polite
            && node.value().is_some_and(|said| said.contains("eliminates"))
    });
    assert!(said.next().is_some());
    drop(said);
    press(&mut harness, NONE, Key::W);
    assert!(cursor(&harness) <= stopped + 1);
    act(&mut harness, "panel: inspector");
    press(&mut harness, Modifiers::SHIFT, Key::F5);
    press(&mut harness, NONE, Key::F5);
    assert_eq!(cursor(&harness), stopped);
    press(&mut harness, NONE, Key::B);
    let debugger = harness.state().state.debugger.as_ref().expect("events");
    assert_eq!(debugger.bookmarks[0].event, stopped);

    // The view moves, and what is in its middle is selected.
    act(&mut harness, "zoom in");
    let before = harness.state().state.camera;
    press(&mut harness, Modifiers::SHIFT, Key::ArrowRight);
    let after = harness.state().state.camera;
    assert!(after.center[0] > before.center[0]);
    press(&mut harness, NONE, Key::M);
    let state = &harness.state().state;
    assert!(state.selected.is_some() || state.place.is_some());

    // Beside it the same with another seed; both at once to where they part.
    act(&mut harness, "compare with the next seed");
    act(&mut harness, "go to where A and B part");
    let (second, _) = harness
        .state()
        .state
        .comparison
        .as_ref()
        .expect("a second run");
    assert!(second.session.is_some());
    assert!(cursor(&harness) < stopped);
    act(&mut harness, "close B");
    assert!(harness.state().state.comparison.is_none());
}

#[test]
fn space_plays_and_pauses_unless_a_button_has_the_focus() {
    let mut harness = opened();
    let playing = |harness: &Harness<'_, App>| harness.state().state.playback.is_playing();
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
    harness.get_by_label("First stage (Home)").focus();
    harness.step();
    space(&mut harness);
    // The button was pressed, and nothing plays.
    assert_eq!(cursor(&harness), 0);
    assert!(!playing(&harness));
}
