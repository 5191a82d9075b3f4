//! The actions of the comparison.

use egui::{Key, KeyboardShortcut, Modifiers};

use super::{Action, List, Menu};
use tilescope_workbench::command::{Command, Which};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::state::State;

const NO_SECOND: &str = "There is no second run.";

/// Adds the actions to the list.
pub(super) fn compare(list: &mut List, state: &State) {
    let mut add = |name: String, key: Option<Key>, command: Command, refusal: Option<String>| {
        list.actions.push(Action {
            menu: Menu::Compare,
            name,
            shortcut: key.map(|key| KeyboardShortcut::new(Modifiers::NONE, key)),
            also: None,
            command,
            refusal,
        });
    };
    for preset in ComparePreset::ALL {
        let name = format!("Compare with {}", preset.name());
        add(
            name,
            None,
            Command::Compare(CompareCommand::Start(preset)),
            state.preset_refusal(preset),
        );
    }
    let no_session = state
        .runs
        .first
        .session
        .is_none()
        .then(|| "There is no session yet.".to_owned());
    let name = "Keep this run as B".to_owned();
    add(
        name,
        None,
        Command::Compare(CompareCommand::Keep),
        no_session,
    );
    let second = state.runs.second.as_ref();
    let ready = second.is_some_and(|(side, _)| side.session.is_some());
    let refusal = |there: bool| (!there).then(|| NO_SECOND.to_owned());
    add(
        "Swap A and B".to_owned(),
        Some(Key::X),
        Command::Compare(CompareCommand::Swap),
        refusal(ready),
    );
    add(
        "Go to the event where A and B diverge".to_owned(),
        Some(Key::D),
        Command::Compare(CompareCommand::GoToDivergence),
        state.parting_refusal().map(str::to_owned),
    );
    let at_work = second.is_some_and(|(side, _)| side.sampling.is_some());
    let idle = (!at_work).then(|| "B is not being sampled.".to_owned());
    let cancel = Command::Cancel(Which::Second);
    add("Cancel B".to_owned(), None, cancel, idle);
    add(
        "Close B".to_owned(),
        None,
        Command::Compare(CompareCommand::Close),
        refusal(second.is_some()),
    );
    links(list, state);
}

/// Adds switches: what the two runs share, and what is marked.
fn links(list: &mut List, state: &State) {
    let second = state.runs.second.as_ref();
    let refusal = second.is_none().then(|| NO_SECOND.to_owned());
    for (name, on, command) in [
        (
            "Cameras together",
            second.is_none_or(|(_, c)| !c.linked_cameras),
            CompareCommand::LinkCameras as fn(bool) -> CompareCommand,
        ),
        (
            "Playback together",
            second.is_none_or(|(_, c)| !c.linked_playback),
            CompareCommand::LinkPlayback,
        ),
        (
            "Mark differences",
            second.is_none_or(|(_, c)| !c.shows_differences),
            CompareCommand::ShowDifferences,
        ),
    ] {
        let name = format!("{name}: {}", if on { "on" } else { "off" });
        list.actions.push(Action {
            menu: Menu::Compare,
            name,
            shortcut: None,
            also: None,
            command: Command::Compare(command(on)),
            refusal: refusal.clone(),
        });
    }
}
