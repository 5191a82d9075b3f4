//! Combinations that cannot be made or are cancelled, and saved ones: a notice says what is wrong, and the
//! current session stays.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use serde_json::{Value, json};
use tilescope_session::combination::{CombineCommand, NINE};
use tilescope_workbench::command::{TimeCommand, Which};
use tilescope_workbench::files::{FileCommand, Purpose, SaveTask};
use tilescope_workbench::{Command, State};

use crate::combining::{drop_file, drop_text, nine, open};
use crate::exporting::{notice_text, opened, settled};
use crate::gate::Gate;

#[test]
fn a_combination_is_saved_as_its_layout_and_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.json");
    let mut state = nine();
    state.apply(Command::Time(TimeCommand::ShowStage(1)));
    open(&mut state, Purpose::Save, &path);
    assert!(
        notice_text(&state).starts_with("Session saved to"),
        "{}",
        notice_text(&state)
    );
    for drop in [false, true] {
        let mut other = opened();
        if drop {
            drop_file(&mut other, &path);
        } else {
            open(&mut other, Purpose::Open, &path);
        }
        assert!(
            other.runs().first.shows_combination(),
            "{}",
            notice_text(&other)
        );
        assert_eq!(other.runs().first.stage, 1);
        assert_eq!(
            SaveTask::of(&other).combination,
            SaveTask::of(&state).combination
        );
        assert!(other.runs().first.verdict().unwrap().report.valid());
    }
    let saved: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    let mut state = opened();
    for (change, expected) in [
        (("digest", json!("0123456789abcdef")), "0123456789abcdef"),
        (("version", json!(99)), "version 99"),
        (("colour", json!(1)), "unknown field `colour`"),
    ] {
        let mut changed = saved.clone();
        changed[change.0] = change.1;
        refused(&mut state, &path, &changed.to_string(), expected);
    }
    let mut changed = saved.clone();
    changed["combination"]["pieces"][3]["seed"] = json!(77);
    refused(&mut state, &path, &changed.to_string(), "was saved with");
    // A file named in a session is not read.
    let mut changed = saved;
    changed["combination"]["pieces"][3] = json!({ "file": "a.csv", "radius": 0.02 });
    refused(
        &mut state,
        &path,
        &changed.to_string(),
        "pieces[3]: its set is in the file a.csv",
    );
}

/// Opens a file that is refused: a notice says why, and the current session stays.
fn refused(state: &mut State, path: &Path, text: &str, expected: &str) {
    fs::write(path, text).unwrap();
    let before = state.runs().first.session.as_ref().unwrap().generation;
    for purpose in [Purpose::Open, Purpose::Combination] {
        state.apply(Command::DismissNotice);
        open(state, purpose, path);
        let notice = state.messages().notice.clone().expect(expected);
        assert!(
            notice.is_error && notice.text.contains(expected),
            "{}",
            notice.text
        );
        assert!(notice.text.contains("layout.json") || notice.text.contains("session.json"));
        assert_eq!(
            state.runs().first.session.as_ref().unwrap().generation,
            before
        );
        assert!(
            state.files().sheet.is_some(),
            "the sheet stays open for another try"
        );
    }
}

#[test]
fn invalid_layouts_are_refused_with_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("layout.json");
    let mut state = opened();
    let with = |key: &str, value: Value| {
        let mut layout: Value = serde_json::from_str(NINE).unwrap();
        layout[key] = value;
        layout.to_string()
    };
    let free = json!({ "version": 1, "radius": 0.05, "width": 3, "height": 2, "pieces": [
        { "rect": [0, 0, 1.6, 2], "seed": 1 }, { "rect": [1.5, 0, 3, 2], "seed": 2 }] });
    let many = vec![json!({ "seed": 1 }); 4097];
    let mut file = json!(vec![json!({ "seed": 1 }); 9]);
    file[4] = json!({ "file": "nowhere.csv" });
    let mut afar = file.clone();
    afar[4] = json!({ "file": "//machine/a.csv" });
    for (text, expected) in [
        (free.to_string(), "pieces 0 and 1 overlap at (1.5, 0)"),
        (with("radius", Value::Null), "invalid type: null"),
        (with("radius", json!(-1)), "the radius is -1"),
        (with("pieces", json!(many)), "at most 4096"),
        (with("pieces", file), "pieces[4]: "),
        (
            with("pieces", afar),
            "pieces[4]: //machine/a.csv: it lies on another machine",
        ),
        (
            with("radius", json!(1e-3)),
            "the window combines at most 2,000,000, and",
        ),
        (with("version", json!(7)), "version 7"),
        (
            NINE.replace("0.02", "NaN"),
            "not a layout of pieces: expected value",
        ),
        (NINE.replace("0.02", "1e999"), "number out of range"),
    ] {
        // In the sheet for sessions, text that is not JSON has another message.
        if serde_json::from_str::<Value>(&text).is_ok() {
            refused(&mut state, &path, &text, expected);
        } else {
            fs::write(&path, &text).unwrap();
            open(&mut state, Purpose::Combination, &path);
            assert!(
                notice_text(&state).contains(expected),
                "{}",
                notice_text(&state)
            );
        }
    }
    let missing = folder.path().join("nowhere.csv").display().to_string();
    let mut layout: Value = serde_json::from_str(NINE).unwrap();
    layout["pieces"][4] = json!({ "file": "nowhere.csv" });
    drop_text(&mut state, &path, &layout.to_string());
    assert!(
        notice_text(&state).contains(&missing),
        "{}",
        notice_text(&state)
    );
    // A text has no folder to read files from.
    state.apply(Command::Combine(CombineCommand::Text(layout.to_string())));
    state.settle();
    assert!(notice_text(&state).contains("files are read only with a layout that is in a file"));
    state.apply(Command::Combine(CombineCommand::Text("[".to_owned())));
    assert!(notice_text(&state).contains("not a layout of pieces"));
    assert!(!state.runs().first.shows_combination() && state.runs().first.verdict().is_some());
    // A valid layout is opened after all these refusals.
    drop_text(&mut state, &path, NINE);
    assert!(state.runs().first.shows_combination());
}

#[test]
fn a_combination_is_cancelled_while_it_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("layout.json");
    fs::write(&path, NINE).unwrap();
    let gate = Arc::new(Gate::default());
    let wake = Arc::clone(&gate);
    let mut state = settled(Arc::new(move || wake.pass()));
    let before = state.runs().first.session.as_ref().unwrap().generation;
    let sheet = FileCommand::Dropped(vec![path.to_string_lossy().into_owned()]);
    for (start, cancel) in [
        (
            Command::Combine(CombineCommand::Nine),
            Command::Cancel(Which::First),
        ),
        (Command::File(sheet), Command::File(FileCommand::Cancel)),
    ] {
        state.apply(Command::DismissNotice);
        // While sets are made, and while they are glued.
        for reports in [2, 11] {
            gate.close_after(reports);
            state.apply(start.clone());
            gate.wait_for_job();
            state.apply(cancel.clone());
            gate.open();
            state.settle();
            let message = notice_text(&state).to_lowercase();
            assert!(message.contains("cancelled"), "{message}");
            assert!(
                !state
                    .messages()
                    .notice
                    .as_ref()
                    .unwrap()
                    .text
                    .contains("fault")
            );
            assert_eq!(
                state.runs().first.session.as_ref().unwrap().generation,
                before
            );
            assert!(state.runs().first.sampling.is_none() && state.files().filing.is_none());
        }
    }
    state.apply(Command::Combine(CombineCommand::Nine));
    state.settle();
    assert!(state.runs().first.shows_combination());
}

#[test]
fn a_set_is_read_up_to_a_limit_and_its_certificate_too() {
    let folder = tempfile::tempdir().unwrap();
    let layout = json!({ "version": 1, "radius": 0.1, "columns": [2, 3], "rows": [2],
        "pieces": [{ "file": "a.csv", "radius": 0.1 }, { "file": "a.csv", "radius": 0.1 }] });
    let path = folder.path().join("layout.json");
    let set = folder.path().join("a.csv");
    let mut state = opened();
    fs::File::create(&set)
        .unwrap()
        .set_len(100_000_001)
        .unwrap();
    refused(
        &mut state,
        &path,
        &layout.to_string(),
        "100,000,001 bytes; at most 100,000,000",
    );
    fs::write(&set, "0.5,0.5\n").unwrap();
    let certificate = fs::File::create(folder.path().join("a.csv.certificate.json")).unwrap();
    certificate.set_len(100_000_001).unwrap();
    refused(&mut state, &path, &layout.to_string(), "bytes; at most");
}
