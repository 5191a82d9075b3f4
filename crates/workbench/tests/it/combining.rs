//! Helpers: a state that shows a combination, and opening files.

use std::fs;
use std::path::Path;

use tilescope_session::combination::CombineCommand;
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::{Command, State};

use crate::exporting::opened;

pub fn nine() -> State {
    let mut state = opened();
    state.apply(Command::Combine(CombineCommand::Nine));
    state.settle();
    state
}

pub fn open(state: &mut State, purpose: Purpose, path: &Path) {
    state.apply(Command::File(FileCommand::Sheet(purpose)));
    let name = path.to_string_lossy().into_owned();
    state.apply(Command::File(FileCommand::Path(name)));
    state.apply(Command::File(FileCommand::Go));
    state.settle();
}

pub fn drop_file(state: &mut State, path: &Path) {
    let name = path.to_string_lossy().into_owned();
    state.apply(Command::File(FileCommand::Dropped(vec![name])));
    state.settle();
}

pub fn drop_text(state: &mut State, path: &Path, text: &str) {
    fs::write(path, text).unwrap();
    drop_file(state, path);
}
