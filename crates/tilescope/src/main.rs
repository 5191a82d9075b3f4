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
    match tilescope_app::run_native(&WindowOptions::default()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => tilescope_cli::run_headless(&HeadlessReason::Failed(error.to_string())),
    }
}
