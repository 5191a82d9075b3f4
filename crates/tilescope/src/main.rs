//! Tilescope: no arguments opens the window, a subcommand runs the command line. This file only
//! chooses between the two.

use std::process::ExitCode;

use clap::Parser;
use tilescope_app::WindowOptions;
use tilescope_cli::{Arguments, HeadlessReason};

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if let Some(command) = &arguments.command {
        return tilescope_cli::run(command);
    }
    if !tilescope_app::display_available() {
        return tilescope_cli::run_headless(&HeadlessReason::NoDisplay);
    }
    let options = WindowOptions {
        link: arguments.link,
        ..WindowOptions::default()
    };
    match tilescope_app::run_native(&options) {
        Ok(()) => ExitCode::SUCCESS,
        // Nothing that was not asked for is written because a window is lost.
        Err(error) if error.was_open() => {
            eprintln!("tilescope: {error}");
            ExitCode::FAILURE
        }
        Err(error) => tilescope_cli::run_headless(&HeadlessReason::Failed(error.to_string())),
    }
}
