//! Exports that write no file: cancelled, refused, or waiting for confirmation.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use emath::{Rect, pos2, vec2};
use tilescope_formats::certificate_path;
use tilescope_workbench::command::{TimeCommand, ViewCommand, Which};
use tilescope_workbench::export::{
    ExportCommand, ExportKind, ExportRefusal, MAX_FRAMES, NumberField,
};
use tilescope_workbench::state::ExportSource;
use tilescope_workbench::{Command, State};

use crate::exporting::{export, fill_in, notice_text, opened, settled, write};
use crate::gate::Gate;

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).unwrap();
    let name = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    entries.map(|entry| name(entry.unwrap())).collect()
}

/// The sheet's description of the export, or its refusal.
fn prospect(state: &State) -> Result<String, ExportRefusal> {
    state.files().exports.prospect(ExportSource::of(state))
}

#[test]
fn a_window_that_closes_leaves_no_unfinished_file() {
    let gate = Arc::new(Gate::default());
    let wake = Arc::clone(&gate);
    let mut state = settled(Arc::new(move || wake.pass()));
    state.apply(Command::Time(TimeCommand::Loop(Some(1_200..1_260))));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.gif");
    fill_in(&mut state, ExportKind::Animation, &path, &[]);
    gate.close_after(4);
    export(&mut state, ExportCommand::Write);
    gate.wait_for_job();
    assert!(!names(folder.path()).contains("film.gif"), "unfinished");
    gate.open();
    drop(state);
    // The export may have ended before it was cancelled.
    let mut left = names(folder.path());
    left.remove("film.gif");
    assert_eq!(left, BTreeSet::new());
}

#[test]
fn a_cancelled_export_leaves_no_file_and_keeps_an_existing_one() {
    let gate = Arc::new(Gate::default());
    let wake = Arc::clone(&gate);
    let mut state = settled(Arc::new(move || wake.pass()));
    state.apply(Command::Time(TimeCommand::Loop(Some(1_200..1_260))));
    // The number of reports after which the job is stopped, in the middle of each kind of work, and of the files that
    // there are then: the unfinished one and the lock of its name.
    for (kind, name, reports, temporary) in [
        (ExportKind::Animation, "film.gif", 4, 2),
        (ExportKind::Animation, "film.apng", 4, 2),
        (ExportKind::Picture, "picture.png", 2, 0),
        (ExportKind::Picture, "picture.svg", 1, 0),
        (ExportKind::Samples, "set.csv", 1, 2),
    ] {
        for before in [None, Some("what was there")] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(name);
            if let Some(text) = before {
                fs::write(&path, text).unwrap();
            }
            fill_in(&mut state, kind, &path, &[]);
            gate.close_after(reports);
            export(&mut state, ExportCommand::Write);
            if before.is_some() {
                assert!(state.files().exports.work.is_none());
                export(&mut state, ExportCommand::Write);
            }
            gate.wait_for_job();
            let there = usize::from(before.is_some()) + temporary;
            assert_eq!(names(folder.path()).len(), there, "{name}: it is running");
            assert!(state.files().exports.fraction().is_some());
            export(&mut state, ExportCommand::Cancel);
            gate.open();
            state.settle();
            assert!(
                notice_text(&state).contains("cancelled"),
                "{}",
                notice_text(&state)
            );
            assert!(
                state.files().exports.sheet.is_some() && state.files().exports.fraction().is_none()
            );
            match before {
                None => assert_eq!(names(folder.path()), BTreeSet::new()),
                Some(text) => {
                    assert_eq!(names(folder.path()).len(), 1);
                    assert_eq!(fs::read_to_string(&path).unwrap(), text);
                }
            }
        }
    }
}

#[test]
fn a_file_is_replaced_only_after_confirmation() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    for (kind, name) in [
        (ExportKind::Picture, "it.svg"),
        (ExportKind::Result, "it.csv"),
    ] {
        let path = folder.path().join(name);
        // An existing certificate alone also needs confirmation.
        let there = match kind {
            ExportKind::Result => certificate_path(&path),
            _ => path.clone(),
        };
        fs::write(&there, "mine").unwrap();
        fill_in(&mut state, kind, &path, &[]);
        let form = state.files().exports.sheet.clone().unwrap();
        assert_eq!((form.taken.as_deref(), form.asked), (Some(&*there), false));
        export(&mut state, ExportCommand::Write);
        state.settle();
        assert!(state.files().exports.sheet.as_ref().unwrap().asked);
        assert_eq!(fs::read_to_string(&there).unwrap(), "mine");
        // Another name needs another confirmation.
        let other = path.with_file_name("other").with_extension("csv");
        let other = other.to_string_lossy().into_owned();
        export(&mut state, ExportCommand::Path(other));
        fill_in(&mut state, kind, &path, &[]);
        assert!(!state.files().exports.sheet.as_ref().unwrap().asked);
        export(&mut state, ExportCommand::Write);
        export(&mut state, ExportCommand::Write);
        state.settle();
        assert!(
            state.files().exports.sheet.is_none(),
            "{}",
            notice_text(&state)
        );
        assert_ne!(fs::read_to_string(&there).unwrap(), "mine");
    }
}

#[test]
fn impossible_exports_are_refused_with_value_and_limit() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mut state = opened();
    let mut refused = |kind, path: &Path, entries: &[(NumberField, &str)], parts: &[&str]| {
        state.apply(Command::DismissNotice);
        export(&mut state, ExportCommand::Close);
        write(&mut state, kind, path, entries);
        let notice = state.messages().notice.clone().expect("a refusal");
        assert!(notice.is_error && state.files().exports.sheet.is_some());
        for part in parts {
            assert!(notice.text.contains(part), "{}", notice.text);
        }
    };
    for scale in ["0", "NaN", "1e9"] {
        let quoted = format!("\"{scale}\"");
        let entries = [(NumberField::Scale, scale)];
        refused(
            ExportKind::Picture,
            &path("a.png"),
            &entries,
            &[&quoted, "0.5 to 8"],
        );
        refused(
            ExportKind::Animation,
            &path("a.gif"),
            &entries,
            &[&quoted, "0.5 to 8"],
        );
    }
    let limit = MAX_FRAMES.to_string();
    let every = [(NumberField::Every, "1")];
    refused(ExportKind::Picture, &path("a.gif"), &[], &[".png .svg"]);
    refused(
        ExportKind::Animation,
        &path("a.mp4"),
        &[],
        &[".gif .apng .png"],
    );
    refused(ExportKind::Samples, &path("a.png"), &[], &[".csv"]);
    refused(
        ExportKind::Animation,
        &path("a.gif"),
        &[(NumberField::Every, "0")],
        &["\"0\"", "10,000,000"],
    );
    refused(
        ExportKind::Animation,
        &path("a.gif"),
        &[(NumberField::Delay, "1")],
        &["\"1\"", "20"],
    );
    refused(ExportKind::Result, Path::new(" "), &[], &["Name a file"]);
    // Folders that are missing or are files.
    fs::write(path("file"), "no folder").unwrap();
    for folder in ["missing", "file"] {
        for (kind, name) in [
            (ExportKind::Result, "a.csv"),
            (ExportKind::Picture, "a.png"),
            (ExportKind::Animation, "a.gif"),
        ] {
            let parts = ["There is no folder", folder];
            refused(kind, &path(folder).join(name), &[], &parts);
        }
    }
    assert_eq!(names(folder.path()).len(), 1);
    let mut state = opened();
    state.apply(Command::Time(TimeCommand::Loop(Some(0..2_000))));
    fill_in(&mut state, ExportKind::Animation, &path("a.gif"), &every);
    let refusal = prospect(&state).unwrap_err().to_string();
    assert!(
        refusal.contains("2,001 frames") && refusal.contains(&limit),
        "{refusal}"
    );
    let enough = [(NumberField::Every, "4")];
    fill_in(&mut state, ExportKind::Animation, &path("a.gif"), &enough);
    assert!(prospect(&state).unwrap().starts_with("501 frames"));
    state.apply(Command::Time(TimeCommand::Loop(None)));
    state.apply(Command::Time(TimeCommand::FirstStage));
    let form = tilescope_workbench::export::ExportForm::default();
    let range = ExportSource::of(&state).range(&form).unwrap();
    fill_in(&mut state, ExportKind::Animation, &path("a.gif"), &enough);
    let refusal = prospect(&state).unwrap_err().to_string();
    assert!(
        refusal.contains(&format!("event 0 to event {}", range.end)),
        "{refusal}"
    );
    // A canvas that is too large for the scale.
    let canvas = Rect::from_min_size(pos2(0.0, 0.0), vec2(5_000.0, 4_000.0));
    state.apply(Command::View(Which::First, ViewCommand::Viewport(canvas)));
    state.apply(Command::Time(TimeCommand::LastStage));
    let eight = [(NumberField::Scale, "8")];
    fill_in(&mut state, ExportKind::Picture, &path("a.png"), &eight);
    let refusal = prospect(&state).unwrap_err().to_string();
    assert!(refusal.contains("268,435,456 pixels"), "{refusal}");
}

#[test]
fn the_sheet_stays_open_for_another_file() {
    let folder = tempfile::tempdir().unwrap();
    let gate = Arc::new(Gate::default());
    let wake = Arc::clone(&gate);
    let mut state = settled(Arc::new(move || wake.pass()));
    let first = folder.path().join("first.svg");
    fill_in(&mut state, ExportKind::Picture, &first, &[]);
    gate.close_after(1);
    export(&mut state, ExportCommand::Write);
    gate.wait_for_job();
    let second = folder.path().join("second.svg");
    fill_in(&mut state, ExportKind::Picture, &second, &[]);
    // One export at a time.
    export(&mut state, ExportCommand::Write);
    gate.open();
    state.settle();
    assert!(first.exists() && !second.exists());
    assert_eq!(state.files().exports.sheet.as_ref().unwrap().file(), second);
    export(&mut state, ExportCommand::Write);
    state.settle();
    assert!(second.exists() && state.files().exports.sheet.is_none());
}
