//! The actions of the comparison.

use egui::Key;

use super::{List, Menu, NO_SESSION, NONE, Submenu};
use tilescope_workbench::command::{Command, Which};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::state::State;

const NO_SECOND: &str = "There is no second run.";

/// Adds the actions to the list.
pub(super) fn compare(list: &mut List, state: &State) {
    list.within(Submenu::Presets, |list| {
        for preset in ComparePreset::ALL {
            let command = Command::Compare(CompareCommand::Start(preset));
            let refusal = state.preset_refusal(preset);
            let name = format!("Compare with {}", preset.name());
            list.add(Menu::Compare, name, None, command, refusal.as_deref());
        }
    });
    let mut add = |name: &str, key: Option<Key>, command, refusal: Option<&str>| {
        let keys = key.map(|key| (NONE, key));
        list.add(Menu::Compare, name, keys, command, refusal);
    };
    let no_session = state.runs.first.session.is_none().then_some(NO_SESSION);
    let keep = Command::Compare(CompareCommand::Keep);
    add("Keep this run as B", None, keep, no_session);
    let second = state.runs.second.as_ref();
    let ready = second.is_some_and(|(side, _)| side.session.is_some());
    let refusal = |there: bool| (!there).then_some(NO_SECOND);
    let swap = Command::Compare(CompareCommand::Swap);
    add("Swap A and B", Some(Key::X), swap, refusal(ready));
    add(
        "Go to the event where A and B diverge",
        Some(Key::D),
        Command::Compare(CompareCommand::GoToDivergence),
        state.parting_refusal(),
    );
    let at_work = second.is_some_and(|(side, _)| side.sampling.is_some());
    let idle = (!at_work).then_some("B is not being sampled.");
    add("Cancel B", None, Command::Cancel(Which::Second), idle);
    let close = Command::Compare(CompareCommand::Close);
    add("Close B", None, close, refusal(second.is_some()));
    links(list, state);
}

/// Adds switches: what the two runs share, and what is marked.
fn links(list: &mut List, state: &State) {
    let comparison = state.runs.second.as_ref().map(|(_, comparison)| comparison);
    let refusal = comparison.is_none().then_some(NO_SECOND);
    list.group();
    for (name, is_on, command) in [
        (
            "Cameras together",
            comparison.is_some_and(|c| c.linked_cameras),
            CompareCommand::LinkCameras as fn(bool) -> CompareCommand,
        ),
        (
            "Playback together",
            comparison.is_some_and(|c| c.linked_playback),
            CompareCommand::LinkPlayback,
        ),
        (
            "Mark differences",
            comparison.is_some_and(|c| c.shows_differences),
            CompareCommand::ShowDifferences,
        ),
    ] {
        let command = Command::Compare(command(!is_on));
        list.add(Menu::Compare, name, None, command, refusal);
        list.mark(is_on);
    }
}
