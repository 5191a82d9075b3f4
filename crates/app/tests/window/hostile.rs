//! Session files that are broken, newer, too large or malicious: each is refused with a message, and the current
//! session stays.

use serde_json::{Value, json};
use tilescope_workbench::Command;
use tilescope_workbench::files::{Purpose, SaveTask};

use crate::support::opened;
use crate::support::sessions::{apply, busy, folder, go, notice};

/// Saves a session, changes its text, and opens it; returns the message.
fn changed(name: &str, change: impl FnOnce(&mut Value)) -> (String, bool) {
    let path = folder(name).join("changed.json");
    let mut harness = busy();
    go(&mut harness, Purpose::Save, &path);
    let mut value: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    change(&mut value);
    std::fs::write(&path, value.to_string()).unwrap();
    let before = SaveTask::of(&harness.state().state).run;
    apply(&mut harness, Command::DismissNotice);
    go(&mut harness, Purpose::Open, &path);
    let message = notice(&harness);
    if message.1 {
        // The previous session is still shown, and so is the sheet.
        assert_eq!(SaveTask::of(&harness.state().state).run, before);
        assert!(harness.state().state.files().sheet.is_some());
    }
    message
}

#[test]
fn a_bad_session_file_is_reported_and_the_current_session_stays() {
    let (message, is_error) = changed("newer", |value| {
        value["version"] = json!(99);
    });
    assert!(is_error && message.contains("version 99"), "{message}");
    let (message, is_error) = changed("digest", |value| {
        value["digest"] = json!("0123456789abcdef");
    });
    assert!(
        is_error && message.contains("0123456789abcdef"),
        "{message}"
    );
    let (message, is_error) = changed("cursor", |value| {
        value["cursor"] = json!(99_999_999);
    });
    assert!(is_error && message.contains("99999999"), "{message}");
    let (message, is_error) = changed("line", |value| {
        value["breakpoints"][0]["line"] = json!("eliminate.999");
    });
    assert!(is_error && message.contains("eliminate.999"), "{message}");
    let (message, is_error) = changed("huge", |value| {
        value["parameters"]["radius"] = json!(1e-4);
    });
    assert!(is_error && message.contains("at most 2000000"), "{message}");
    let (message, is_error) = changed("radius", |value| {
        value["parameters"]["radius"] = json!(0.0);
    });
    assert!(is_error && message.contains("radius"), "{message}");
}

#[test]
fn parts_of_a_view_that_make_no_sense_are_named_and_the_rest_is_opened() {
    let (message, is_error) = changed("view", |value| {
        value["view"]["camera"]["scale"] = json!(-4.0);
        value["view"]["selection"] = json!({"sample": 4_000_000});
    });
    assert!(!is_error);
    assert!(
        message.ends_with("left out: camera, selection."),
        "{message}"
    );
}

#[test]
fn files_that_are_no_sessions_are_refused() {
    let folder = folder("corrupt");
    let mut harness = opened();
    for (name, bytes) in [
        ("empty.json", &b""[..]),
        ("cut.json", b"{\"version\": 1, \"parameters\": {"),
        ("list.json", b"[1, 2, 3]"),
        ("binary.json", b"\xff\xfe\x00\x01"),
    ] {
        let path = folder.join(name);
        std::fs::write(&path, bytes).unwrap();
        go(&mut harness, Purpose::Open, &path);
        let (message, is_error) = notice(&harness);
        assert!(is_error && message.contains(name), "{message}");
        assert!(message.contains("not a saved session"), "{message}");
    }
    let missing = folder.join("missing.json");
    go(&mut harness, Purpose::Open, &missing);
    let (message, is_error) = notice(&harness);
    assert!(is_error && message.contains("missing.json"), "{message}");
    let long = folder.join("long.json");
    let file = std::fs::File::create(&long).unwrap();
    file.set_len(17_000_000).unwrap();
    go(&mut harness, Purpose::Open, &long);
    let (message, _) = notice(&harness);
    assert!(
        message.contains("17,000,000 bytes") && message.contains("at most 16,000,000"),
        "{message}"
    );
    // A path that cannot be written.
    let nowhere = folder.join("no-such-folder").join("x.json");
    go(&mut harness, Purpose::Save, &nowhere);
    let (message, is_error) = notice(&harness);
    assert!(is_error && message.contains("not written"), "{message}");
}

#[test]
fn saved_views_are_limited() {
    let (message, is_error) = changed("view-huge", |value| {
        let mut second = value["parameters"].clone();
        second["radius"] = json!(0.000_1);
        second["variant"] = json!("as-printed");
        value["view"]["second"] = second;
        value["view"]["selection"] = json!({"place": [150_000.0, 3.0]});
        // A layout that contains itself.
        let column = json!({"children": [1], "dir": "Vertical", "shares": {"shares": {}}});
        let tiles = json!({"1": {"Container": {"Linear": column}}});
        value["view"]["layout"] = json!({"root": 1, "tiles": {"tiles": tiles}});
    });
    assert!(!is_error);
    let expected = "left out: layout, second, selection.";
    assert!(message.ends_with(expected), "{message}");
}

#[test]
#[cfg(unix)]
fn a_pattern_that_is_no_file_is_not_read() {
    let (message, is_error) = changed("device", |value| {
        value["pattern"] = json!({"path": "/dev/zero", "digest": "0123456789abcdef"});
    });
    assert!(
        is_error && message.contains("/dev/zero is not a regular file"),
        "{message}"
    );
    let (message, is_error) = changed("elsewhere", |value| {
        let path = "//elsewhere/sets/own.csv";
        value["pattern"] = json!({"path": path, "digest": "0123456789abcdef"});
    });
    assert!(
        is_error && message.contains("on another machine"),
        "{message}"
    );
}

#[test]
fn sessions_that_could_not_be_reopened_are_not_saved() {
    let path = folder("too-much").join("notes.json");
    let mut harness = busy();
    let note = "n".repeat(10_001);
    let note = tilescope_workbench::scenes::SceneCommand::Caption(0, note);
    apply(&mut harness, Command::Scene(note));
    go(&mut harness, Purpose::Save, &path);
    let (message, is_error) = notice(&harness);
    assert!(is_error && message.contains("10000"), "{message}");
    assert!(!path.exists());
}
