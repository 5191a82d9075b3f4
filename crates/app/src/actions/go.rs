//! The Go menu: playing, ticking, stepping and running through time.

use egui::{Key, Modifiers};
use tilescope_debugger::{Direction, Step, Target};

use super::{List, Menu, NO_SESSION, NONE, SHIFT, Submenu, no_events, time_refusals};
use tilescope_workbench::clock::Clock;
use tilescope_workbench::command::{Command, TimeCommand};
use tilescope_workbench::state::State;

/// Adds the actions of the menu.
pub(super) fn add(list: &mut List, state: &State) {
    let [at_end, at_start] = time_refusals(&state.runs.first, &state.time);
    let no_session = state.runs.first.session.is_none().then_some(NO_SESSION);
    let no_events = no_events(state);
    let play = Command::Time(TimeCommand::TogglePlay);
    let space = Some((NONE, Key::Space));
    list.add(Menu::Go, "Play or pause", space, play, no_session);
    for (name, key, command, refusal) in [
        (
            "Tick forward",
            Key::ArrowRight,
            Command::Time(TimeCommand::StepForward),
            at_end,
        ),
        (
            "Tick back",
            Key::ArrowLeft,
            Command::Time(TimeCommand::StepBack),
            at_start,
        ),
        (
            "First stage",
            Key::Home,
            Command::Time(TimeCommand::FirstStage),
            at_start,
        ),
        (
            "Last stage",
            Key::End,
            Command::Time(TimeCommand::LastStage),
            at_end,
        ),
    ] {
        list.add(Menu::Go, name, Some((NONE, key)), command, refusal);
    }
    list.group();
    list.within(Submenu::Ticks, |list| {
        for clock in Clock::ALL {
            let command = Command::Time(TimeCommand::Clock(clock));
            let refusal = state.runs.first.clock_refusal(clock);
            let name = format!("Step by: {}", clock.name());
            list.add(Menu::Go, name, None, command, refusal);
            list.mark(state.time.playback.clock == clock);
        }
    });
    let (on, back) = (no_events.or(at_end), no_events.or(at_start));
    let (forwards, backwards) = (Direction::Forwards, Direction::Backwards);
    steps(list, state, forwards, on);
    list.within(Submenu::Backwards, |list| {
        steps(list, state, backwards, back);
    });
    list.group();
    runs(list, state, forwards, on);
    list.within(Submenu::Previous, |list| {
        runs(list, state, backwards, back);
    });
    list.within(Submenu::Loop, |list| {
        for (name, command) in [
            ("Loop from here", TimeCommand::LoopStart),
            ("Loop up to here", TimeCommand::LoopEnd),
            ("No loop", TimeCommand::Loop(None)),
        ] {
            list.add(Menu::Go, name, None, Command::Time(command), no_events);
        }
    });
}

/// Adds stepping, with a debugger's usual keys; one more modifier steps backwards. Browsers reload on F5 and go full
/// screen on F11, so the web version uses other keys.
fn steps(list: &mut List, state: &State, direction: Direction, refusal: Option<&str>) {
    let back = direction == Direction::Backwards;
    let way = if back { " backwards" } else { "" };
    let shifted = if back { SHIFT } else { NONE };
    let with_alt = if back { Modifiers::ALT } else { NONE };
    let [on, into, out] = if state.files.in_browser() {
        [(shifted, Key::F8), (shifted, Key::N), (shifted, Key::U)]
    } else {
        let out = (SHIFT | with_alt, Key::F11);
        [(shifted, Key::F5), (with_alt, Key::F11), out]
    };
    for (name, keys, step) in [
        ("Step into", into, Step::Into),
        ("Step over", (shifted, Key::F10), Step::Over),
        ("Step out", out, Step::Out),
    ] {
        let command = Command::Time(TimeCommand::Step(step, direction));
        list.add(
            Menu::Go,
            format!("{name}{way}"),
            Some(keys),
            command,
            refusal,
        );
    }
    let command = Command::Time(TimeCommand::Continue(direction));
    let name = format!("Continue to a breakpoint{way}");
    list.add(Menu::Go, name, Some(on), command, refusal);
}

fn runs(list: &mut List, state: &State, direction: Direction, refusal: Option<&str>) {
    let (which, modifiers) = match direction {
        Direction::Forwards => ("Next", NONE),
        Direction::Backwards => ("Previous", SHIFT),
    };
    for (name, key, target) in targets(state) {
        let command = Command::Time(TimeCommand::RunTo(target, direction));
        let keys = key.map(|key| (modifiers, key));
        list.add(Menu::Go, format!("{which} {name}"), keys, command, refusal);
    }
}

/// Returns the events that can be run to, with a key each.
fn targets(state: &State) -> Vec<(String, Option<Key>, Target)> {
    let mut targets: Vec<(String, Option<Key>, Target)> = [
        ("conflict", Key::C, Target::Conflict),
        ("elimination", Key::E, Target::Elimination),
        ("gap found", Key::G, Target::Gap),
        ("insertion", Key::I, Target::Insertion),
        (
            "second insertion in one gap",
            Key::S,
            Target::SecondInsertion,
        ),
        ("violated invariant", Key::V, Target::Violation),
    ]
    .into_iter()
    .map(|(name, key, target)| (name.to_owned(), Some(key), target))
    .collect();
    if let Some(id) = state.runs.first.selected {
        let name = format!(
            "event of sample {}",
            tilescope_session::words::grouped(id as usize)
        );
        targets.push((name, Some(Key::H), Target::Sample(id)));
    }
    if let Some(event) = state.runs.first.debugger.as_ref().and_then(|d| d.event()) {
        let name = "execution of this line".to_owned();
        targets.push((name, Some(Key::L), Target::Line(event.line())));
    }
    targets
}
