//! Announcements for screen readers: each once, when it is new.

use tilescope_workbench::Command;
use tilescope_workbench::command::{LinkCommand, TimeCommand};

use super::support::{settle, state};

#[test]
fn news_is_announced_once() {
    let mut state = state();
    settle(&mut state);
    let first = state.messages().announcement().expect("something to say");
    assert!(
        first.contains("Finish: ") || first.contains("Verified"),
        "{first}"
    );
    state.advance(0.0);
    assert_eq!(
        state.messages().announcement(),
        Some(first.clone()),
        "nothing is new"
    );
    state.apply(Command::Time(TimeCommand::Jump(1_000)));
    state.advance(0.0);
    let moment = state.messages().announcement().unwrap();
    assert!(moment != first && !moment.contains("Verified"), "{moment}");
    state.apply(Command::Link(LinkCommand::Copy));
    state.advance(0.0);
    let copied = state.messages().announcement().unwrap();
    assert!(copied.starts_with("The link is copied"), "{copied}");
    state.apply(Command::DismissNotice);
    state.advance(0.0);
    assert_eq!(state.messages().announcement(), Some(copied));
    // The same notice, shown again, is announced again.
    state.apply(Command::Time(TimeCommand::StepBack));
    state.apply(Command::Link(LinkCommand::Copy));
    state.advance(0.0);
    assert!(
        state
            .messages()
            .announcement()
            .unwrap()
            .contains("The link is copied")
    );
}

#[test]
fn errors_and_verdicts_are_announced() {
    let mut state = state();
    settle(&mut state);
    state.open_link("v=1&radius=0.03&search=two-radii&seed=5&boundary=bounded");
    settle(&mut state);
    let verdict = state.messages().announcement().unwrap();
    assert!(verdict.contains("erifie"), "{verdict}");
    let text = "{".to_owned();
    let layout = tilescope_session::combination::CombineCommand::Text(text);
    state.apply(Command::Combine(layout));
    state.advance(0.0);
    let error = state.messages().announcement().unwrap();
    assert!(error.starts_with("Error: "), "{error}");
}

#[test]
fn during_playback_only_stages_are_announced() {
    let mut state = state();
    settle(&mut state);
    state.apply(Command::Time(TimeCommand::FirstStage));
    state.apply(Command::Time(TimeCommand::Clock(
        tilescope_workbench::clock::Clock::Event,
    )));
    state.apply(Command::Time(TimeCommand::Speed(64.0)));
    state.apply(Command::Time(TimeCommand::TogglePlay));
    let mut heard = std::collections::HashSet::new();
    for _ in 0..200 {
        state.advance(0.02);
        heard.insert(state.messages().announcement().unwrap());
    }
    assert!(
        heard.iter().any(|text| text.starts_with("Playing: ")),
        "{heard:?}"
    );
    assert!(heard.len() <= 4, "{heard:?}");
}
