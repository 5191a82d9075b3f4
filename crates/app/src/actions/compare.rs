//! The Compare menu: a second run, what the two share, and the marks of what differs.

use egui::Key;

use super::{List, Menu, Submenu, no_session};
use tilescope_workbench::command::{Command, Which};
use tilescope_workbench::compare::{CompareCommand, ComparePreset, Comparison};
use tilescope_workbench::state::State;

const NO_SECOND: &str = "There is no second run.";

/// Adds the actions of the menu.
pub(super) fn add(list: &mut List, state: &State) {
    list.menu = Menu::Compare;
    list.within(Submenu::Presets, |list| {
        for preset in ComparePreset::ALL {
            let command = Command::Compare(CompareCommand::Start(preset));
            list.add(format!("Compare with {}", preset.name()), command)
                .refused(
                    state
                        .runs()
                        .preset_refusal(preset, state.form(), state.gpu())
                        .as_deref(),
                );
        }
    });

    list.add("Keep this run as B", Command::Compare(CompareCommand::Keep))
        .refused(no_session(state));

    let second = state.runs().second.as_ref();
    // After the swap all panels show this run, so that it must be there.
    let is_ready = second.is_some_and(|(side, _)| side.session.is_some());
    let not_ready = match second {
        None => NO_SECOND,
        Some(_) => "The second run is not ready yet.",
    };
    list.add("Swap A and B", Command::Compare(CompareCommand::Swap))
        .on_key(Key::X)
        .refused((!is_ready).then_some(not_ready));

    let go = Command::Compare(CompareCommand::GoToDivergence);
    list.add("Go to the event where A and B diverge", go)
        .on_key(Key::D)
        .refused(state.runs().parting_refusal());

    let is_at_work = second.is_some_and(|(side, _)| side.sampling.is_some());
    list.add("Cancel B", Command::Cancel(Which::Second))
        .refused((!is_at_work).then_some("B is not being sampled."));
    let no_second = second.is_none().then_some(NO_SECOND);
    list.add("Close B", Command::Compare(CompareCommand::Close))
        .refused(no_second);

    list.group();
    let comparison = second.map(|(_, comparison)| comparison);
    // Without a second run every switch is off. A switch issues the opposite of its state.
    let switched = |switch: fn(&Comparison) -> bool| comparison.is_some_and(switch);
    let cameras = switched(|comparison| comparison.linked_cameras);
    let playback = switched(|comparison| comparison.linked_playback);
    let marks = switched(|comparison| comparison.shows_differences);

    for (name, is_on, command) in [
        (
            "Cameras together",
            cameras,
            CompareCommand::LinkCameras(!cameras),
        ),
        (
            "Playback together",
            playback,
            CompareCommand::LinkPlayback(!playback),
        ),
        (
            "Mark differences",
            marks,
            CompareCommand::ShowDifferences(!marks),
        ),
    ] {
        let action = list.add(name, Command::Compare(command));
        action.refused(no_second).marked(is_on);
    }
}
