//! Scripts: whole sessions as text.

use std::collections::BTreeSet;
use std::convert::Infallible;

use serde_json::{Value, json};
use tilescope_workbench::Command;
use tilescope_workbench::script::{ScriptError, apply_all, read, run};

#[test]
fn a_script_runs_a_whole_session() {
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
    let state = apply_all(read(&text).unwrap(), |state| {
        cursors.push(state.runs().first.cursor().unwrap().0);
        Ok::<_, Infallible>(())
    });
    let Ok(state) = state;
    let first = &state.runs().first;
    let samples = first.session.as_ref().unwrap().summary.count;
    assert!((700..1_000).contains(&samples), "{samples}");
    assert!(cursors[4] < cursors[5], "{cursors:?}");
    assert_eq!(first.selected, Some(3));
    assert!(state.runs().second.as_ref().unwrap().0.session.is_some());
    assert!(std::fs::read_to_string(picture).unwrap().contains("<svg"));
}

#[test]
fn the_state_is_printed_after_each_command_or_after_the_last() {
    let printed = |each| {
        let mut lines = Vec::new();
        let text = r#"[{"time": "first-stage"}, {"time": "step-forward"}]"#;
        let mut print = |line: &str| {
            lines.push(serde_json::from_str::<serde_json::Value>(line).unwrap());
            Ok(())
        };
        let mut refused = |number: usize, why: &str, _| panic!("command {number}: {why}");
        let verdict = run::<ScriptError>(text, each, &mut print, &mut refused);
        assert_eq!(verdict.unwrap(), Some(true));
        let stages = lines.iter().map(|line| line["stage"].as_str().unwrap());
        stages.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(printed(true), ["pattern", "blocks"]);
    assert_eq!(printed(false), ["blocks"]);
}

/// Commands that open the system's dialog, which needs a screen.
const DIALOGS: [&str; 2] = ["file.browse", "export.browse"];

/// The names that serde expects instead of `?` in a command: a group's commands, if it is a group.
fn names(command: &Value) -> Vec<String> {
    // A command with a text takes any.
    let Err(error) = serde_json::from_value::<Command>(command.clone()) else {
        return Vec::new();
    };
    let text = error.to_string();
    let Some((_, listed)) = text.split_once("unknown variant `?`, expected ") else {
        return Vec::new();
    };
    let quoted = listed.split('`').skip(1).step_by(2);
    quoted.map(str::to_owned).collect()
}

/// Returns a command of this path whose last name is unknown.
fn asking(path: &[&str]) -> Value {
    let mut value = json!("?");
    for name in path.iter().rev() {
        value = match *name {
            "view" => json!({"view": ["first", value]}),
            name => json!({ name: value }),
        };
    }
    value
}

/// Returns the paths of all commands, and those of the commands of a script.
fn all_and_used(script: &[Value]) -> [BTreeSet<String>; 2] {
    let mut all = BTreeSet::new();
    for group in names(&json!("?")) {
        let own = names(&asking(&[&group]));
        if own.is_empty() || group == "cancel" {
            all.insert(group);
            continue;
        }
        for name in own {
            let path = format!("{group}.{name}");
            let inner = match path.as_str() {
                "window.drawer" => names(&asking(&[&group, &name])),
                _ => Vec::new(),
            };
            if inner.is_empty() {
                all.insert(path);
            } else {
                all.extend(inner.iter().map(|inner| format!("{path}.{inner}")));
            }
        }
    }
    let name_of = |value: &Value| match value {
        Value::String(name) => name.clone(),
        Value::Object(map) => map.keys().next().unwrap().clone(),
        other => panic!("{other}"),
    };
    let path_of = |value: &Value| {
        let group = name_of(value);
        let inner = match group.as_str() {
            "view" => &value["view"][1],
            "cancel" | "open-folder" => return group,
            group => &value[group],
        };
        match inner {
            Value::Null => group,
            inner if group == "window" && inner.get("drawer").is_some() => {
                format!("window.drawer.{}", name_of(&inner["drawer"]))
            }
            inner => format!("{group}.{}", name_of(inner)),
        }
    };
    [all, script.iter().map(path_of).collect()]
}

#[test]
fn every_command_can_be_scripted() {
    let folder = tempfile::tempdir().unwrap();
    let text = include_str!("every_command.json");
    let script: Vec<Value> = serde_json::from_str(text).unwrap();
    let [mut all, used] = all_and_used(&script);
    for dialog in DIALOGS {
        assert!(all.remove(dialog), "{dialog}");
    }
    assert!(all.len() > 110, "{}", all.len());
    let odd: Vec<&String> = all.symmetric_difference(&used).collect();
    assert!(odd.is_empty(), "not in both: {odd:?}");
    let text = text.replace("FOLDER", folder.path().to_str().unwrap());
    let Ok(state) = apply_all(read(&text).unwrap(), |_| Ok::<_, Infallible>(()));
    assert!(state.runs().first.shows_combination());
    for file in [
        "session.json",
        "set.csv",
        "set.csv.certificate.json",
        "results.csv",
        "handout.html",
    ] {
        assert!(folder.path().join(file).exists(), "{file}");
    }
}
