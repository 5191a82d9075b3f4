//! Stands for the window in a build without it: commands that need the window say so.

use std::path::Path;
use std::process::ExitCode;

use tilescope_cli::lesson::Played;
use tilescope_cli::{FromWindow, HeadlessReason};

/// Why a command that needs the window does nothing.
const WHY: &str =
    "this build has no window, which this needs; build the program with its feature window";

/// The functions of the window's crates that commands call: each says why it does nothing.
pub const WINDOW: FromWindow = FromWindow {
    script: |_, _, _, _| Err(tilescope_cli::refusal(WHY)),
    handout: |_| Err(WHY.to_owned()),
    lesson_of_session: |_| Err(WHY.to_owned()),
    leaks: |_, _| Err(WHY.to_owned()),
};

/// Returns whether a window can be opened.
pub const fn is_possible() -> bool {
    false
}

/// Returns why no window is opened.
pub fn open(
    _: Option<String>,
    _: Option<Played>,
    _: Option<&Path>,
) -> Result<ExitCode, HeadlessReason> {
    Err(HeadlessReason::NotBuilt)
}
