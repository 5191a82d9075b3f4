//! Tilescope: no arguments or a file opens the window, a subcommand runs the command line. This file only
//! chooses between the two.

#[cfg(feature = "window")]
mod window;
#[cfg(not(feature = "window"))]
#[path = "without_window.rs"]
mod window;

use std::process::ExitCode;

use tilescope_cli::Arguments;

/// Carries out a command of the command line, or opens the window. If no window opens and a file or a link was to be
/// shown, that is refused. If no window opens and neither was to be shown, the default session runs headless, even if a
/// lesson was to be played.
fn main() -> ExitCode {
    let arguments = Arguments::read();
    let played = match arguments.played() {
        // The lesson to be played is neither a file nor one of the program's.
        Some(Err(error)) => {
            tilescope_cli::note(&format!("error: {error}"));
            return ExitCode::from(tilescope_cli::EXIT_BAD_INPUT);
        }
        Some(Ok(played)) => Some(played),
        None => None,
    };
    // A lesson is played in the window; without one the command itself says why it cannot be.
    let can_play = played.is_some() && window::is_possible();
    if let (Some(command), false) = (&arguments.command, can_play) {
        return tilescope_cli::run(command, window::WINDOW);
    }

    let (has_link, file) = (arguments.link.is_some(), arguments.open.as_deref());
    match window::open(arguments.link.clone(), played, file) {
        Ok(code) => code,
        Err(reason) => match file {
            Some(file) => tilescope_cli::refuse_file(file, &reason),
            None if has_link => tilescope_cli::refuse_link(&reason),
            None => tilescope_cli::run_headless(&reason),
        },
    }
}
