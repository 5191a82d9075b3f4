//! The debugger by clicks and keys: breakpoints, steps both ways, the event browser, scenes, watches.

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_core::{Parameter, Stage};
use tilescope_debugger::{EventKind, Listings};
use tilescope_session::layers::Layer;
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_tests::some;
use tilescope_workbench::Command;
use tilescope_workbench::clock::Clock;
use tilescope_workbench::command::{
    AppearanceCommand, DebugCommand, FormCommand, TimeCommand, ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::layout::Panel;

use crate::support::{
    cursor, debugger, find, is_disabled, last_kind, next_kind, node, opened, opened_at, session,
    settle, text,
};

fn apply(harness: &mut Harness<'_, App>, command: Command) {
    harness.state_mut().state.apply(command);
    settle(harness);
}

fn press(harness: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run();
}

#[test]
fn a_conditional_breakpoint_stops_where_it_holds() {
    let mut harness = opened();
    press(&mut harness, Modifiers::NONE, Key::Home);
    assert_eq!(cursor(&harness), 0);
    // The line that has just run is scrolled into view.
    press(&mut harness, Modifiers::NONE, Key::E);
    node(&harness, "eliminate.5.breakpoint").click();
    harness.run();
    press(&mut harness, Modifiers::NONE, Key::Home);
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Scenes)),
    );
    node(&harness, "eliminate.5.condition").focus();
    harness.run();
    node(&harness, "eliminate.5.condition").type_text("distance < 0.2");
    harness.run();
    press(&mut harness, Modifiers::NONE, Key::F5);
    assert_eq!(next_kind(&harness), Some(EventKind::Eliminate));
    let distance: f64 = debugger(&harness)
        .evaluate("distance")
        .unwrap()
        .parse()
        .unwrap();
    assert!(distance < 0.2);
    let first = cursor(&harness);
    press(&mut harness, Modifiers::NONE, Key::F5);
    assert!(cursor(&harness) > first);
    press(&mut harness, Modifiers::SHIFT, Key::F5);
    assert_eq!(cursor(&harness), first);
    // An invalid condition shows its error beside it.
    let broken = DebugCommand::Condition(0, "distance <".to_owned());
    apply(&mut harness, Command::Debug(broken));
    let breakpoints = debugger(&harness).breakpoints();
    let error = breakpoints[0].error().expect("an error").to_string();
    assert_eq!(text(&harness, "eliminate.5.refusal"), error);
}

/// Asserts that the line of the last event, or before the first one the next line, is within the panel of the listings.
fn assert_line_is_in_view(harness: &Harness<'_, App>, when: &str) {
    let recording = debugger(harness).recording();
    let at = cursor(harness);
    let event = recording.event(at.saturating_sub(1)).expect("an event");
    let line = Listings::shipped().line(event.line()).expect("a line");
    let shown = node(harness, format!("{}.line", line.id)).rect();
    let top = node(harness, "tab.pseudocode").rect().bottom();
    let bottom = node(harness, "tab.verification").rect().top();
    let is_within = shown.top() >= top && shown.bottom() <= bottom;
    assert!(
        is_within,
        "{when}: line {} at {shown:?}, panel {top} to {bottom}",
        line.id
    );
}

#[test]
fn the_current_line_is_in_view_wherever_time_goes() {
    for size in [[1440.0, 900.0], [1280.0, 720.0]] {
        let mut harness = opened_at(size);
        assert_line_is_in_view(&harness, "at the end");
        press(&mut harness, Modifiers::NONE, Key::Home);
        assert_line_is_in_view(&harness, "at the start");
        for key in [Key::C, Key::E, Key::G, Key::I, Key::End] {
            press(&mut harness, Modifiers::NONE, key);
            assert_line_is_in_view(&harness, key.name());
        }

        // A breakpoint whose condition is searched for during several frames.
        press(&mut harness, Modifiers::NONE, Key::Home);
        let insert = Listings::shipped().find("insert.3").expect("a line");
        apply(
            &mut harness,
            Command::Debug(DebugCommand::ToggleBreakpoint(insert)),
        );
        let condition = DebugCommand::Condition(0, "iteration > 1".to_owned());
        apply(&mut harness, Command::Debug(condition));
        press(&mut harness, Modifiers::NONE, Key::F5);
        assert!(cursor(&harness) > 0);
        press(&mut harness, Modifiers::NONE, Key::F11);
        assert_line_is_in_view(&harness, "after a breakpoint");
    }
}

#[test]
fn the_current_line_is_in_view_in_every_frame_of_a_run_that_plays() {
    let mut harness = opened();
    press(&mut harness, Modifiers::NONE, Key::Home);
    apply(&mut harness, Command::Time(TimeCommand::WholeRun(10.0)));
    apply(&mut harness, Command::Time(TimeCommand::TogglePlay));
    for frame in 0..60 {
        // Half a second of play goes by between frames: the line is another one in each.
        harness.state_mut().state.advance(0.15);
        harness.step();
        assert_line_is_in_view(&harness, &format!("frame {frame}"));
    }
    apply(&mut harness, Command::Time(TimeCommand::TogglePlay));
    assert_line_is_in_view(&harness, "paused");
}

#[test]
fn time_goes_both_ways_by_keys_alone() {
    let mut harness = opened();
    let end = cursor(&harness);
    press(&mut harness, Modifiers::SHIFT, Key::E);
    assert_eq!(last_kind(&harness), Some(EventKind::Eliminate));
    let at = cursor(&harness);
    press(&mut harness, Modifiers::NONE, Key::F11);
    assert_eq!(cursor(&harness), at + 1);
    press(&mut harness, Modifiers::ALT, Key::F11);
    assert_eq!(cursor(&harness), at);
    press(&mut harness, Modifiers::SHIFT, Key::F11);
    let out = cursor(&harness);
    assert!(out > at);
    press(&mut harness, Modifiers::SHIFT, Key::F10);
    press(&mut harness, Modifiers::NONE, Key::F10);
    assert_eq!(cursor(&harness), out);
    for (key, kind) in [
        (Key::G, EventKind::Candidate),
        (Key::I, EventKind::Insert),
        (Key::S, EventKind::Insert),
    ] {
        press(&mut harness, Modifiers::NONE, key);
        assert_eq!(last_kind(&harness), Some(kind));
    }
    press(&mut harness, Modifiers::NONE, Key::V);
    // No invariant is violated, so the action explains that there is nothing to go to.
    node(&harness, "notice");
    press(&mut harness, Modifiers::NONE, Key::End);
    assert_eq!(cursor(&harness), end);
}

#[test]
fn a_press_counts_with_the_modifiers_of_its_moment() {
    let mut harness = opened();
    let end = cursor(&harness);
    // All in one frame, as on a slow machine: Shift is already up when the frame begins.
    for pressed in [true, false] {
        harness.event_modifiers(
            egui::Event::Key {
                key: Key::E,
                physical_key: None,
                pressed,
                repeat: false,
                modifiers: Modifiers::SHIFT,
            },
            Modifiers::NONE,
        );
    }
    harness.run();
    assert!(cursor(&harness) < end);
    assert_eq!(last_kind(&harness), Some(EventKind::Eliminate));
}

#[test]
fn the_arrows_follow_the_clock() {
    let mut harness = opened();
    press(&mut harness, Modifiers::NONE, Key::ArrowLeft);
    let stage = |harness: &Harness<'_, App>| harness.state().state.runs().first.current_stage();
    assert_eq!(stage(&harness), Some(Stage::Iterate(3)));
    let whole = cursor(&harness);
    apply(
        &mut harness,
        Command::Time(TimeCommand::Clock(Clock::Event)),
    );
    press(&mut harness, Modifiers::NONE, Key::ArrowLeft);
    assert_eq!(cursor(&harness), whole - 1);
    node(&harness, "time-step-forward").click();
    harness.run();
    assert_eq!(cursor(&harness), whole);
    apply(&mut harness, Command::Time(TimeCommand::Clock(Clock::Line)));
    press(&mut harness, Modifiers::NONE, Key::ArrowLeft);
    let recording = debugger(&harness).recording();
    let lines = [whole, cursor(&harness)].map(|at| recording.event(at).unwrap().line());
    assert_ne!(lines[0], lines[1]);
}

#[test]
fn the_event_browser_finds_and_selects_events_and_shows_errors() {
    let mut harness = opened();
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Events)),
    );
    node(&harness, "find-events").focus();
    harness.run();
    node(&harness, "find-events").type_text("insert iteration>1");
    harness.run();
    settle(&mut harness);
    let found = harness
        .state()
        .state
        .runs()
        .first
        .query
        .found
        .events()
        .to_vec();
    assert!(!found.is_empty());
    let row = format!("event-{}", found[0]);
    let number = tilescope_session::words::event_number(found[0]);
    assert!(text(&harness, &row).contains(&number));
    node(&harness, &row).click();
    harness.run();
    assert_eq!(cursor(&harness), found[0] + 1);
    apply(
        &mut harness,
        Command::Debug(DebugCommand::Query("insert colour=3".to_owned())),
    );
    assert!(text(&harness, "found-events").contains("\"colour\""));
    // The tree: selecting a stage goes to the moment after all its events.
    apply(
        &mut harness,
        Command::Debug(DebugCommand::Query(String::new())),
    );
    apply(&mut harness, Command::Time(TimeCommand::Jump(1)));
    let session = session(&harness);
    let index = session
        .stages
        .iter()
        .position(|&stage| stage == Stage::Tile)
        .unwrap();
    let begin = session.stage_end(index - 1).unwrap();
    apply(
        &mut harness,
        Command::Debug(DebugCommand::SelectEvent(begin)),
    );
    assert_eq!(Some(cursor(&harness)), session.stage_end(index));
}

#[test]
fn a_sample_tells_its_history_and_why_leads_to_the_cause() {
    let mut harness = opened();
    apply(&mut harness, Command::Time(TimeCommand::FirstStage));
    press(&mut harness, Modifiers::NONE, Key::E);
    let at = cursor(&harness);
    let sample = {
        let recording = debugger(&harness).recording();
        recording.event(at - 1).unwrap().samples()[0]
    };
    apply(
        &mut harness,
        Command::View(Which::First, ViewCommand::Pick(Selection::Sample(sample))),
    );
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Inspector)),
    );
    let history = harness
        .state()
        .state
        .runs()
        .first
        .history_found
        .events()
        .to_vec();
    assert!(text(&harness, "history").contains(&history.len().to_string()));
    assert!(history.contains(&(at - 1)) && history.len() >= 2);
    press(&mut harness, Modifiers::NONE, Key::W);
    assert!(cursor(&harness) < at);
    // A sample that does not exist yet stays selected: its history lies ahead.
    apply(&mut harness, Command::Time(TimeCommand::FirstStage));
    assert_eq!(harness.state().state.runs().first.selected, Some(sample));
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert_eq!(harness.state().state.runs().first.selected, None);
}

#[test]
fn scenes_and_watches_stay_with_their_moments() {
    let mut harness = opened();
    press(&mut harness, Modifiers::SHIFT, Key::I);
    let at = cursor(&harness);
    press(&mut harness, Modifiers::NONE, Key::B);
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Scenes)),
    );
    node(&harness, "scene-1.caption").focus();
    harness.run();
    node(&harness, "scene-1.caption").type_text("the last one");
    harness.run();
    apply(&mut harness, Command::Time(TimeCommand::FirstStage));
    let number = tilescope_session::words::grouped(at);
    assert!(text(&harness, "scene-1.moment").contains(&number));
    assert!(text(&harness, "scene-1").contains("the last one"));
    node(&harness, "scene-1").click();
    harness.run();
    assert_eq!(cursor(&harness), at);
    assert_eq!(debugger(&harness).scenes[0].caption, "the last one");
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Watches)),
    );
    apply(
        &mut harness,
        Command::Debug(DebugCommand::Watch("inserted + 1".to_owned())),
    );
    let value = debugger(&harness).evaluate("inserted + 1").unwrap();
    let shown = text(&harness, "watch-1.value");
    assert!(shown.ends_with(&value), "{shown}");
    apply(
        &mut harness,
        Command::Debug(DebugCommand::EditWatch(0, "inserted +".to_owned())),
    );
    assert!(!text(&harness, "watch-1.value").ends_with(&value));
}

#[test]
fn the_list_of_actions_opens_and_runs_actions_by_keyboard() {
    let mut harness = opened();
    press(&mut harness, Modifiers::COMMAND, Key::K);
    node(&harness, "find-action").type_text("projector");
    harness.run();
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(harness.state().state.appearance().look, Look::Projector);
    assert!(harness.state().state.window().finder.is_none());
    assert!(text(&harness, "status").contains("10,041"));
    press(&mut harness, Modifiers::COMMAND, Key::K);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.state().state.window().finder.is_none());
    // An unavailable action is listed, but does nothing.
    apply(&mut harness, Command::Window(WindowCommand::ToggleFinder));
    apply(
        &mut harness,
        Command::Window(WindowCommand::FinderText("tick forward".to_owned())),
    );
    assert!(is_disabled(&harness, "action.go-time-step-forward"));
}

#[test]
fn tabs_and_layers_fill_no_undo_and_moved_panels_do() {
    let mut harness = opened();
    let start = harness.state().state.window().layout.clone();
    let seed = harness
        .state()
        .state
        .form()
        .draft
        .text(Parameter::Seed)
        .to_owned();
    let other = Command::Form(FormCommand::Type(Parameter::Seed, "7".to_owned()));
    apply(&mut harness, other);
    apply(
        &mut harness,
        Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Disks)),
    );
    let layers = harness.state().state.appearance().chosen_layers;
    node(&harness, "tab.scenes").click();
    harness.run();
    assert!(harness.state().state.window().layout.shows(Panel::Scenes));
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(
        harness.state().state.form().draft.text(Parameter::Seed),
        seed
    );
    let state = &harness.state().state;
    assert!(
        state.window().layout.shows(Panel::Scenes) && state.appearance().chosen_layers == layers
    );
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(
        harness.state().state.form().draft.text(Parameter::Seed),
        "7"
    );
    apply(&mut harness, Command::Window(WindowCommand::ResetLayout));
    assert_eq!(harness.state().state.window().layout, start);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(harness.state().state.window().layout.shows(Panel::Scenes));
}

#[test]
fn the_projector_shows_a_way_out() {
    let mut harness = opened();
    // What a picture of the window would have, in pixels.
    let pixels = |harness: &Harness<'_, App>| {
        harness.ctx.content_rect().size() * harness.ctx.pixels_per_point()
    };
    let before = pixels(&harness);
    let leave = "leave-projector";
    assert!(find(&harness, leave).is_none());
    press(&mut harness, Modifiers::NONE, Key::F2);
    assert_eq!(harness.state().state.appearance().look, Look::Projector);
    node(&harness, leave).click();
    harness.run();
    assert_eq!(harness.state().state.appearance().look, Look::Dark);
    for key in [Key::F2, Key::Escape] {
        press(&mut harness, Modifiers::NONE, Key::F2);
        // Escape first closes what is open.
        node(&harness, "speed").click();
        harness.run();
        press(&mut harness, Modifiers::NONE, Key::Escape);
        assert_eq!(harness.state().state.appearance().look, Look::Projector);
        press(&mut harness, Modifiers::NONE, key);
        assert_eq!(
            harness.state().state.appearance().look,
            Look::Dark,
            "{key:?}"
        );
    }
    assert_eq!(pixels(&harness), before);
}

#[test]
fn every_panel_is_drawn_in_every_look() {
    let mut harness = opened();
    apply(&mut harness, Command::Time(TimeCommand::FirstStage));
    press(&mut harness, Modifiers::NONE, Key::G);
    press(&mut harness, Modifiers::NONE, Key::F11);
    // The snapshots hold every panel in both.
    for look in some([Look::Dark, Look::Light]) {
        apply(
            &mut harness,
            Command::Appearance(AppearanceCommand::Look(look)),
        );
        let mut pictures = std::collections::BTreeSet::new();
        for panel in Panel::all() {
            apply(
                &mut harness,
                Command::Window(WindowCommand::OpenPanel(panel)),
            );
            assert!(harness.state().state.window().layout.shows(panel));
            let picture = harness.render().expect("a picture");
            pictures.insert(picture.as_raw().clone());
        }
        // Opening a visible panel again changes nothing; opening each of the others changes the picture.
        assert!(pictures.len() >= 8, "{look:?}: {}", pictures.len());
    }
}

#[test]
fn every_line_of_the_listings_that_run_has_a_gutter() {
    let harness = opened();
    for name in ["blocks", "tile", "eliminate", "detect", "insert", "finish"] {
        let listings = &Listings::shipped().listings;
        let listing = listings
            .iter()
            .find(|listing| listing.name == name)
            .unwrap();
        for number in 1..=listing.lines.len() {
            node(&harness, format_args!("{name}.{number}.breakpoint"));
        }
    }
}

#[test]
fn a_query_is_completed_by_known_words() {
    let mut harness = opened();
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Events)),
    );
    let query = |harness: &Harness<'_, App>| harness.state().state.runs().first.query.text.clone();
    let apply_query = |harness: &mut Harness<'_, App>, text: &str| {
        apply(
            harness,
            Command::Debug(DebugCommand::Query(text.to_owned())),
        );
    };
    apply_query(&mut harness, "conf");
    node(&harness, "complete-conflict").click();
    harness.run();
    settle(&mut harness);
    assert_eq!(query(&harness), "conflict ");
    assert!(find(&harness, "complete-conflict").is_none());
    let found = harness
        .state()
        .state
        .runs()
        .first
        .query
        .found
        .events()
        .len();
    assert!(found > 0);
    node(&harness, "query-words").click();
    harness.run();
    node(&harness, "word-gap").click();
    harness.run();
    settle(&mut harness);
    assert_eq!(query(&harness), "conflict gap ");
    // An unknown word has an error that names similar ones.
    apply_query(&mut harness, "confilct");
    assert!(text(&harness, "found-events").ends_with("similar: conflict"));
}
