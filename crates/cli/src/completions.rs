//! Completion scripts for shells.

use anyhow::Result;
use clap::Args;
use clap_complete::Shell;

use crate::{EXIT_FINE, output};

/// Arguments of `tilescope completions`.
#[derive(Debug, Args)]
pub struct CompletionsArguments {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

pub fn run(arguments: &CompletionsArguments, command: &mut clap::Command) -> Result<u8> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, command, "tilescope", &mut script);
    output::emit(&String::from_utf8(script)?)?;
    Ok(EXIT_FINE)
}
