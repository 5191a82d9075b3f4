//! Helpers: a state with a small session, and the export sheet filled in by commands.

use std::path::Path;
use std::sync::Arc;

use emath::{Rect, pos2, vec2};
use tilescope_core::Parameter;
use tilescope_drawing::picture::PictureView;
use tilescope_session::jobs::Wake;
use tilescope_workbench::command::{FormCommand, ViewCommand, Which};
use tilescope_workbench::export::{ExportCommand, ExportKind, ExportRefusal, NumberField};
use tilescope_workbench::state::ExportSource;
use tilescope_workbench::{Command, State};

pub fn settled(wake: Wake) -> State {
    let mut state = State::new(wake);
    let canvas = Rect::from_min_size(pos2(200.0, 40.0), vec2(500.0, 400.0));
    state.apply(Command::View(Which::First, ViewCommand::Viewport(canvas)));
    for (field, text) in [(Parameter::Radius, "0.02"), (Parameter::Leaf, "8")] {
        state.apply(Command::Form(FormCommand::Type(field, text.to_owned())));
    }
    state.settle();
    state.apply(Command::Run);
    state.settle();
    state.apply(Command::View(
        Which::First,
        ViewCommand::FlyTo([25.0, 20.0].into(), 30.0),
    ));
    while state.advance(0.5) {}
    state.settle();
    state
}

pub fn opened() -> State {
    settled(Arc::new(|| {}))
}

pub fn export(state: &mut State, command: ExportCommand) {
    state.apply(Command::Export(command));
}

/// Fills in the sheet and exports.
pub fn write(state: &mut State, kind: ExportKind, path: &Path, entries: &[(NumberField, &str)]) {
    fill_in(state, kind, path, entries);
    export(state, ExportCommand::Write);
    state.settle();
}

pub fn fill_in(state: &mut State, kind: ExportKind, path: &Path, entries: &[(NumberField, &str)]) {
    export(state, ExportCommand::Open(kind));
    let path = path.to_string_lossy().into_owned();
    export(state, ExportCommand::Path(path));
    for &(entry, text) in entries {
        export(state, ExportCommand::Type(entry, text.to_owned()));
    }
}

pub fn notice_text(state: &State) -> String {
    state
        .messages()
        .notice
        .as_ref()
        .map_or_else(String::new, |notice| notice.text.clone())
}

/// The view of an export of this kind.
pub fn export_view(state: &State, kind: ExportKind) -> Result<PictureView, ExportRefusal> {
    let sheet = state.files().exports.sheet.as_ref();
    let print = sheet.is_some_and(|form| form.print);
    ExportSource::of(state).view(kind, print)
}
