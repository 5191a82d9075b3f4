//! `tilescope script`, end to end.

use predicates::prelude::*;
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
fn a_refused_command_is_named_and_ends_the_script_with_its_code() {
    let folder = tempdir().unwrap();
    let script = |text: &str, code: i32| {
        let mut command = tilescope(&folder);
        let done = command.args(["script", "-"]).write_stdin(text).assert();
        done.code(code).stdout(starts_with("{"))
    };
    let wrong = r#"[{"form": {"type": ["seed", "-7"]}}, "run"]"#;
    script(wrong, 1).stderr(contains("error: standard input: command 2: "));
    let missing =
        r#"[{"file": {"sheet": "open"}}, {"file": {"path": "no/file.json"}}, {"file": "go"}]"#;
    script(missing, 2).stderr(contains("command 3: ").and(contains("no/file.json")));
    let unwritten =
        r#"[{"file": {"sheet": "save"}}, {"file": {"path": "no/file.json"}}, {"file": "go"}]"#;
    script(unwritten, 2).stderr(contains("command 3: ").and(contains("no/file.json")));
    // The window has no button for this comparison: exact tiling has no order.
    let compared =
        r#"[{"form": {"choose": {"method": METHOD}}}, "run", {"compare": {"start": "order"}}]"#;
    let by = |method| compared.replace("METHOD", method);
    script(&by("\"exact\""), 1).stderr(contains("command 3: ").and(contains("order")));
    script(&by("\"kdrt\""), 0).stderr("");
    script("[]", 0).stderr("");
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
