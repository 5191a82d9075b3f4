//! The File menu: runs, sessions, patterns, links and exports.

use egui::Key;
use tilescope_session::combination::CombineCommand;

use super::{COMMAND, List, Menu, SHIFT};
use tilescope_workbench::command::{Command, FormCommand, LinkCommand, Which};
use tilescope_workbench::export::{ExportCommand, ExportKind};
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::state::State;

/// Adds the actions of the menu.
pub(super) fn add(list: &mut List, state: &State) {
    let add = |list: &mut List, name: &str, keys, command, refusal: Option<&str>| {
        list.add(Menu::File, name, keys, command, refusal);
    };
    let refusal = state.run_refusal();
    add(
        list,
        "Run with these parameters",
        Some((COMMAND, Key::Enter)),
        Command::Run,
        refusal.as_deref(),
    );
    let idle = state
        .runs
        .first
        .sampling
        .is_none()
        .then_some("Nothing is being sampled.");
    add(
        list,
        "Cancel the run",
        None,
        Command::Cancel(Which::First),
        idle,
    );
    list.group();
    sessions(list, state);
    list.group();
    for (name, keys, kind) in [
        (
            "Export samples\u{2026}",
            Some((COMMAND, Key::E)),
            ExportKind::Result,
        ),
        (
            "Export samples of this moment\u{2026}",
            None,
            ExportKind::Samples,
        ),
        (
            "Export picture of this moment\u{2026}",
            Some((COMMAND | SHIFT, Key::E)),
            ExportKind::Picture,
        ),
        ("Export animation\u{2026}", None, ExportKind::Animation),
    ] {
        let refusal = state
            .export_source()
            .kind_refusal(kind)
            .map(|refusal| refusal.to_string());
        let sheet = state.files.exports.sheet.as_ref();
        let is_open = sheet.is_some_and(|form| form.kind == kind);
        let command = Command::Export(if is_open {
            ExportCommand::Close
        } else {
            ExportCommand::Open(kind)
        });
        let refusal = refusal.filter(|_| !is_open);
        add(
            list,
            &sheet_name(name, is_open),
            keys,
            command,
            refusal.as_deref(),
        );
    }
    let idle = state
        .files
        .exports
        .fraction()
        .is_none()
        .then_some("Nothing is being exported.");
    let cancel = Command::Export(ExportCommand::Cancel);
    add(list, "Cancel the export", None, cancel, idle);
    list.group();
    let keys = Some((COMMAND | SHIFT, Key::L));
    let copy = Command::Link(LinkCommand::Copy);
    add(list, "Copy link", keys, copy, None);
}

/// Returns the name of an action that toggles a sheet.
fn sheet_name(name: &str, is_open: bool) -> String {
    let close = if is_open { "Close: " } else { "" };
    format!("{close}{name}")
}

/// Adds opening and saving of sessions and patterns.
fn sessions(list: &mut List, state: &State) {
    let open = state.files.sheet.as_ref().map(|form| form.purpose);
    let sheet = |purpose| {
        Command::File(if open == Some(purpose) {
            FileCommand::Close
        } else {
            FileCommand::Sheet(purpose)
        })
    };
    let generated = state
        .form
        .own_pattern
        .is_none()
        .then_some("The pattern is already generated.");
    for (name, key, command, refusal) in [
        (
            "Open session\u{2026}",
            Some(Key::O),
            sheet(Purpose::Open),
            None,
        ),
        (
            "Save session\u{2026}",
            Some(Key::S),
            sheet(Purpose::Save),
            state.save_refusal(),
        ),
        (
            "Open a combination\u{2026}",
            None,
            sheet(Purpose::Combination),
            None,
        ),
        (
            "Combine nine sets (figure 12)",
            None,
            Command::Combine(CombineCommand::Nine),
            None,
        ),
        (
            "Use a pattern from a file\u{2026}",
            None,
            sheet(Purpose::Pattern),
            None,
        ),
        (
            "Use a generated pattern",
            None,
            Command::Form(FormCommand::GeneratedPattern),
            generated,
        ),
    ] {
        let keys = key.map(|key| (COMMAND, key));
        let is_open = command == Command::File(FileCommand::Close);
        let refusal = refusal.filter(|_| !is_open);
        list.add(
            Menu::File,
            sheet_name(name, is_open),
            keys,
            command,
            refusal,
        );
    }
}
