//! Tilescope: no arguments opens the window, a subcommand runs the command line. This file only
//! chooses between the two.

use std::io::Write;
use std::process::ExitCode;

use tilescope_app::WindowOptions;
use tilescope_cli::lesson::Played;
use tilescope_cli::{Arguments, HeadlessReason};
use tilescope_workbench::lessons::LessonCommand;

fn main() -> ExitCode {
    let arguments = Arguments::read();
    let played = match arguments.played() {
        Some(Err(error)) => {
            let _ = writeln!(std::io::stderr(), "error: {error}");
            return ExitCode::from(tilescope_cli::EXIT_BAD_INPUT);
        }
        Some(Ok(played)) => Some(played),
        None => None,
    };
    let can_play = played.is_some() && tilescope_app::display_available();
    if let (Some(command), false) = (&arguments.command, can_play) {
        return tilescope_cli::run(command, tilescope_workbench::script::run);
    }
    let has_link = arguments.link.is_some();
    let without_window = |reason: &HeadlessReason| {
        if has_link {
            tilescope_cli::refuse_link(reason)
        } else {
            tilescope_cli::run_headless(reason)
        }
    };
    if !tilescope_app::display_available() {
        return without_window(&HeadlessReason::NoDisplay);
    }
    let options = WindowOptions {
        link: arguments.link,
        lesson: played.map(|played| match played {
            Played::Shipped(name) => LessonCommand::Open(name),
            Played::File(file) => LessonCommand::File(file),
        }),
        ..WindowOptions::default()
    };
    match tilescope_app::run_native(&options) {
        Ok(()) => ExitCode::SUCCESS,
        // Nothing that was not asked for is written because a window is lost.
        Err(error) if error.was_open() => {
            let _ = writeln!(std::io::stderr(), "tilescope: {error}");
            ExitCode::FAILURE
        }
        Err(error) => without_window(&HeadlessReason::Failed(error.to_string())),
    }
}
