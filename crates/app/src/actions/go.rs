//! The Go menu: playing, ticking, stepping and running through time.

use egui::{Key, Modifiers};
use tilescope_debugger::{Direction, Step, Target};
use tilescope_session::words::grouped;

use super::{List, Menu, NONE, SHIFT, Submenu, no_events, no_session, time_refusals};
use tilescope_workbench::clock::Clock;
use tilescope_workbench::command::{Command, TimeCommand};
use tilescope_workbench::state::State;

/// Adds the actions of the menu.
pub(super) fn add(list: &mut List, state: &State) {
    list.menu = Menu::Go;
    let [at_end, at_start] = time_refusals(&state.runs().first, state.time());
    let why_no_events = no_events(state);

    list.add("Play or pause", Command::Time(TimeCommand::TogglePlay))
        .on_key(Key::Space)
        .refused(no_session(state));
    // The keys Home and End go to the first and the last level of a run with prefixes. A stipple has only one level,
    // and the keys go to its first and its last dot.
    let run = &state.runs().first;
    let [first, last] = match run.prefix() {
        Some(_) if run.shows_stipple() => ["First dot", "Last dot"],
        Some(_) => ["First level", "Last level"],
        None => ["First stage", "Last stage"],
    };
    for (name, key, command, refusal) in [
        (
            "Tick forward",
            Key::ArrowRight,
            TimeCommand::StepForward,
            at_end,
        ),
        ("Tick back", Key::ArrowLeft, TimeCommand::StepBack, at_start),
        (first, Key::Home, TimeCommand::FirstStage, at_start),
        (last, Key::End, TimeCommand::LastStage, at_end),
    ] {
        let action = list.add(name, Command::Time(command));
        action.on_key(key).refused(refusal);
    }

    list.group();
    list.within(Submenu::Ticks, |list| {
        for clock in Clock::ALL {
            let command = Command::Time(TimeCommand::Clock(clock));
            let name = state.runs().first.clock_name(clock);
            list.add(format!("Step by: {name}"), command)
                .refused(state.runs().first.clock_refusal(clock))
                .marked(state.time().playback.clock == clock);
        }
    });

    // Prefixes can be looped over, too: they have a cursor, although they have no events.
    let no_loop = why_no_events.filter(|_| state.runs().first.cursor().is_none());
    let (no_way_on, no_way_back) = (why_no_events.or(at_end), why_no_events.or(at_start));
    let (forwards, backwards) = (Direction::Forwards, Direction::Backwards);

    steps(list, state, forwards, no_way_on);
    // The ways back are in submenus, so that the menu need not scroll.
    list.within(Submenu::Backwards, |list| {
        steps(list, state, backwards, no_way_back);
    });
    list.group();
    runs(list, state, forwards, no_way_on);
    list.within(Submenu::Previous, |list| {
        runs(list, state, backwards, no_way_back);
    });
    list.within(Submenu::Loop, |list| {
        for (name, command) in [
            ("Loop from here", TimeCommand::LoopStart),
            ("Loop up to here", TimeCommand::LoopEnd),
            ("No loop", TimeCommand::Loop(None)),
        ] {
            list.add(name, Command::Time(command)).refused(no_loop);
        }
    });
}

/// Adds stepping, with the keys that debuggers usually have. With one more modifier the same keys step backwards.
fn steps(list: &mut List, state: &State, direction: Direction, refusal: Option<&str>) {
    let is_back = direction == Direction::Backwards;
    let way = if is_back { " backwards" } else { "" };
    let shifted = if is_back { SHIFT } else { NONE };
    let with_alt = if is_back { Modifiers::ALT } else { NONE };
    // Shift means backwards, except with F11: Shift+F11 is stepping out in most debuggers, so that Alt means backwards
    // there. Browsers reload on F5 and go full screen on F11, so that a page uses F8, with which their own debuggers
    // continue, and two letters, chosen freely.
    let [go_on, into, out] = if state.files().in_browser() {
        [(shifted, Key::F8), (shifted, Key::N), (shifted, Key::U)]
    } else {
        let out = (SHIFT | with_alt, Key::F11);
        [(shifted, Key::F5), (with_alt, Key::F11), out]
    };

    for (name, (modifiers, key), step) in [
        ("Step into", into, Step::Into),
        ("Step over", (shifted, Key::F10), Step::Over),
        ("Step out", out, Step::Out),
    ] {
        let command = Command::Time(TimeCommand::Step(step, direction));
        let action = list.add(format!("{name}{way}"), command);
        action.on_keys(modifiers, key).refused(refusal);
    }

    let (modifiers, key) = go_on;
    let command = Command::Time(TimeCommand::Continue(direction));
    let action = list.add(format!("Continue to a breakpoint{way}"), command);
    action.on_keys(modifiers, key).refused(refusal);
}

fn runs(list: &mut List, state: &State, direction: Direction, refusal: Option<&str>) {
    let (which, modifiers) = match direction {
        Direction::Forwards => ("Next", NONE),
        Direction::Backwards => ("Previous", SHIFT),
    };
    for (name, initial, target) in targets(state) {
        let command = Command::Time(TimeCommand::RunTo(target, direction));
        let action = list.add(format!("{which} {name}"), command);
        action.on_keys(modifiers, initial).refused(refusal);
    }
}

/// Returns the events that can be run to, with a key each, which is an initial.
fn targets(state: &State) -> Vec<(String, Key, Target)> {
    let mut targets: Vec<(String, Key, Target)> = [
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
    .map(|(name, key, target)| (name.to_owned(), key, target))
    .collect();

    // H stands for the history of the sample, and L for the line.
    if let Some(id) = state.runs().first.selected {
        let name = format!("event of sample {}", grouped(id as usize));
        targets.push((name, Key::H, Target::Sample(id)));
    }
    if let Some(event) = state.runs().first.debugger.as_ref().and_then(|d| d.event()) {
        let name = "execution of this line".to_owned();
        targets.push((name, Key::L, Target::Line(event.line())));
    }
    targets
}
