//! The File menu: runs, sessions, patterns, links and exports.

use egui::Key;
use tilescope_session::combination::CombineCommand;

use super::{Action, COMMAND, List, Menu, SHIFT, Submenu};
use tilescope_workbench::command::{Command, FormCommand, LinkCommand, Which, WindowCommand};
use tilescope_workbench::export::{ExportCommand, ExportKind};
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::state::{ExportSource, State};

/// Adds the actions of the menu.
pub(super) fn add(list: &mut List, state: &State) {
    list.menu = Menu::File;
    let run = list.add("Run with these parameters", Command::Run);
    run.on_keys(COMMAND, Key::Enter)
        .refused(state.form().refusal(state.gpu()).as_deref());

    let no_sampling = state.runs().first.sampling.is_none();
    list.add("Cancel the run", Command::Cancel(Which::First))
        .refused(no_sampling.then_some("Nothing is being sampled."));
    list.group();
    sessions(list, state);
    list.group();

    let open = (state.files().exports.sheet.as_ref()).map(|form| form.kind);
    // The action that opened a sheet closes it, with the same keys.
    let sheet = |kind| {
        Command::Export(if open == Some(kind) {
            ExportCommand::Close
        } else {
            ExportCommand::Open(kind)
        })
    };

    // The pictures of all scenes have no action of their own: the sheet offers them beside the other kinds.
    for (name, kind) in [
        ("Export samples\u{2026}", ExportKind::Result),
        ("Export samples of this moment\u{2026}", ExportKind::Samples),
        ("Export picture of this moment\u{2026}", ExportKind::Picture),
        ("Export animation\u{2026}", ExportKind::Animation),
    ] {
        let refusal =
            (ExportSource::of(state).kind_refusal(kind)).map(|refusal| refusal.to_string());
        let action = toggle(list, name, sheet(kind), refusal.as_deref());
        match kind {
            ExportKind::Result => action.on_keys(COMMAND, Key::E),
            ExportKind::Picture => action.on_keys(COMMAND | SHIFT, Key::E),
            ExportKind::Samples | ExportKind::Scenes | ExportKind::Animation => action,
        };
    }

    let no_export = state.files().exports.fraction().is_none();
    list.add("Cancel the export", Command::Export(ExportCommand::Cancel))
        .refused(no_export.then_some("Nothing is being exported."));

    list.group();
    list.add("Copy link", Command::Link(LinkCommand::Copy))
        .on_keys(COMMAND | SHIFT, Key::L);
    // A page has no such action, as it is closed by the browser.
    if !state.files().in_browser() {
        list.group();
        list.add("Quit", Command::Window(WindowCommand::Quit))
            .on_keys(COMMAND, Key::Q);
    }
}

/// Adds an action that opens a sheet, or closes it if that is its command; closing is never refused.
fn toggle<'a>(
    list: &'a mut List,
    name: &str,
    command: Command,
    refusal: Option<&str>,
) -> &'a mut Action {
    let is_open = matches!(
        command,
        Command::File(FileCommand::Close) | Command::Export(ExportCommand::Close)
    );
    let close = if is_open { "Close: " } else { "" };
    list.add(format!("{close}{name}"), command)
        .refused(refusal.filter(|_| !is_open))
}

/// Adds opening and saving of sessions and patterns.
fn sessions(list: &mut List, state: &State) {
    let open = state.files().sheet.as_ref().map(|form| form.purpose);
    let sheet = |purpose| {
        // The action that opened a sheet closes it, with the same keys.
        Command::File(if open == Some(purpose) {
            FileCommand::Close
        } else {
            FileCommand::Sheet(purpose)
        })
    };
    // `None` refuses nothing: a file can be opened whatever the window shows.
    toggle(list, "Open session\u{2026}", sheet(Purpose::Open), None).on_keys(COMMAND, Key::O);
    let save = sheet(Purpose::Save);
    toggle(
        list,
        "Save session\u{2026}",
        save,
        state.runs().first.save_refusal(),
    )
    .on_keys(COMMAND, Key::S);

    recent(list, state);
    let combination = sheet(Purpose::Combination);
    toggle(list, "Open a combination\u{2026}", combination, None);
    let nine = Command::Combine(CombineCommand::Nine);
    list.add("Combine nine sets (figure 12)", nine);
    let pattern = sheet(Purpose::Pattern);
    toggle(list, "Use a pattern from a file\u{2026}", pattern, None);

    let is_generated = state.form().own_pattern.is_none();
    let generated = Command::Form(FormCommand::GeneratedPattern);
    list.add("Use a generated pattern", generated)
        .refused(is_generated.then_some("The pattern is already generated."));
}

/// Adds the last session and the files that were opened or saved last.
fn recent(list: &mut List, state: &State) {
    list.within(Submenu::Recent, |list| {
        let has_last = state.files().last_session.is_some();
        let last = list.add("Reopen the last session", Command::File(FileCommand::Last));
        last.refused((!has_last).then_some("No session of an earlier use of the program is kept."));
        for path in &state.files().recent {
            list.add(path, Command::File(FileCommand::Open(path.clone())));
        }
    });
}
