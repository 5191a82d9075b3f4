//! Completion scripts for shells.

use clap::Args;
use clap_complete::Shell;

/// Arguments of `tilescope completions`.
#[derive(Debug, Args)]
pub struct CompletionsArguments {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

pub fn run(arguments: &CompletionsArguments, command: &mut clap::Command) {
    clap_complete::generate(
        arguments.shell,
        command,
        "tilescope",
        &mut std::io::stdout(),
    );
}
