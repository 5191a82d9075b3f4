//! `tilescope script`, end to end.

use predicates::str::{contains, starts_with};
use serde_json::Value;
use tempfile::tempdir;

use crate::support::tilescope;

#[test]
fn a_script_is_carried_out_and_the_state_is_printed() {
    let folder = tempdir().unwrap();
    let script = r#"[{"form": {"type": ["radius", "0.05"]}}, {"form": {"type": ["leaf", "10"]}}, "run",
        {"export": {"open": "samples"}}, {"export": {"path": "set.csv"}}, {"export": "write"}]"#;
    std::fs::write(folder.path().join("steps.json"), script).unwrap();
    let output = tilescope(&folder)
        .args(["script", "steps.json", "--each"])
        .assert()
        .success();
    let text = String::from_utf8(output.get_output().stdout.clone()).unwrap();
    let states: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(states.len(), 6);
    assert_eq!(states[5]["parameters"]["radius"], 0.05);
    assert_eq!(states[5]["verified"], true);
    // The set that a script writes is verified like any other.
    tilescope(&folder)
        .args(["verify", "set.csv"])
        .assert()
        .success();
}

#[test]
fn what_is_no_script_is_refused_before_anything_is_done() {
    let folder = tempdir().unwrap();
    let refused = |text: &str| {
        tilescope(&folder)
            .args(["script", "-"])
            .write_stdin(text)
            .assert()
            .code(2)
            .stdout("")
    };
    refused(r#"["run", "runn"]"#).stderr(starts_with(
        "error: standard input: command 2: unknown variant `runn`",
    ));
    refused("run").stderr(contains("a script is a JSON list of commands"));
    tilescope(&folder)
        .args(["script", "missing.json"])
        .assert()
        .code(2)
        .stderr(starts_with("error: missing.json: "));
}
