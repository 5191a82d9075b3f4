//! Sessions carried out by text alone.

use std::convert::Infallible;

use tilescope_workbench::script::{ScriptError, carry_out, read, run};

#[test]
fn a_session_is_carried_out_by_text_alone() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("moment.svg");
    let text = r#"[
        {"form": {"type": ["radius", "0.03"]}}, {"form": {"type": ["leaf", "12"]}}, "run",
        {"debug": {"toggle-breakpoint": "eliminate.5"}},
        {"time": "first-stage"}, {"time": {"continue": "forwards"}},
        {"view": ["first", "go-to-current"]}, {"view": ["first", {"pick": {"sample": 3}}]},
        {"appearance": {"toggle-layer": "disks"}},
        {"compare": {"start": "next-seed"}}, {"view": ["second", "fit"]},
        {"export": {"open": "picture"}}, {"export": {"path": PICTURE}}, {"export": "write"}
    ]"#;
    let text = text.replace("PICTURE", &format!("{picture:?}"));
    let mut cursors = Vec::new();
    let state = carry_out(read(&text).unwrap(), |state| {
        cursors.push(state.cursor().unwrap().0);
        Ok::<_, Infallible>(())
    });
    let Ok(state) = state;
    let first = &state.runs.first;
    let samples = first.session.as_ref().unwrap().summary.count;
    assert!((700..1_000).contains(&samples), "{samples}");
    assert!(cursors[4] < cursors[5], "{cursors:?}");
    assert_eq!(first.selected, Some(3));
    assert!(state.runs.second.as_ref().unwrap().0.session.is_some());
    assert!(std::fs::read_to_string(picture).unwrap().contains("<svg"));
}

#[test]
fn the_state_is_printed_after_each_command_or_after_the_last() {
    let printed = |each| {
        let mut lines = Vec::new();
        let text = r#"[{"time": "first-stage"}, {"time": "step-forward"}]"#;
        let verdict = run::<ScriptError>(text, each, &mut |line| {
            lines.push(serde_json::from_str::<serde_json::Value>(line).unwrap());
            Ok(())
        });
        assert_eq!(verdict.unwrap(), Some(true));
        let stages = lines.iter().map(|line| line["stage"].as_str().unwrap());
        stages.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(printed(true), ["pattern", "blocks"]);
    assert_eq!(printed(false), ["blocks"]);
}
