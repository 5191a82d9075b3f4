//! `tilescope script`: the window's commands from a file, without a window. The binary supplies the function that carries
//! them out.

use std::io::Read;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;

use crate::paths::InFile;
use crate::{EXIT_BAD_INPUT, EXIT_FINE, EXIT_NEGATIVE, output, verdict_code};

/// Carries out the text of a script: prints the state after each command or after the last one; passes on the number of
/// each command that was refused or failed, why, and whether a file could not be read or written; returns whether the
/// samples at the end are valid, `None` if the verifier has not judged them.
pub type CarryOut = fn(
    text: &str,
    after_each: bool,
    print: &mut dyn FnMut(&str) -> Result<()>,
    refused: &mut dyn FnMut(usize, &str, bool),
) -> Result<Option<bool>>;

/// Arguments of `tilescope script`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ScriptArguments {
    /// A JSON list of commands; - reads standard input
    file: PathBuf,
    /// Print the state after every command, one JSON object a line
    #[arg(long)]
    each: bool,
}

/// The longest script, in bytes: 16 MiB, chosen, not measured.
const MAX_BYTES: u64 = 16 << 20;

const EXAMPLES: &str = r#"A script begins with the default session. It holds the commands that buttons and keys of the window issue;
each command's work ends before the next command begins. Cameras jump instead of flying, and time does not
run by itself. A command that is refused is named on standard error, and the others are carried out; a file
is replaced by the same command once more.

  [{"form": {"type": ["seed", "7"]}}, "run",
   {"debug": {"toggle-breakpoint": "eliminate.5"}}, {"time": {"continue": "forwards"}},
   {"export": {"open": "picture"}}, {"export": {"path": "moment.svg"}}, {"export": "write"}]

Examples:
  tilescope script steps.json
  echo '[{"time": "first-stage"}]' | tilescope script - --each

Exit codes: 0 all was done, 1 a command was refused or the set is not valid, 2 a file could not be read or
written, or this is no script."#;

/// Carries out the commands of a file, and prints why commands were refused.
pub fn run(arguments: &ScriptArguments, carry_out: CarryOut) -> Result<u8> {
    let is_standard_input = arguments.file.as_os_str() == "-";
    let file = if is_standard_input {
        Path::new("standard input")
    } else {
        &arguments.file
    };
    let text = read(&arguments.file).in_file(file)?;

    let mut refused_code = EXIT_FINE;
    let mut refused = |number: usize, why: &str, is_of_file| {
        output::note(&format!(
            "error: {}: command {number}: {why}",
            file.display()
        ));
        // Files that cannot be used are bad input; other refusals are a negative outcome.
        let code = if is_of_file {
            EXIT_BAD_INPUT
        } else {
            EXIT_NEGATIVE
        };
        refused_code = refused_code.max(code);
    };

    let verdict =
        carry_out(&text, arguments.each, &mut output::emit, &mut refused).in_file(file)?;
    // The graver code is the larger one.
    Ok(verdict.map_or(EXIT_FINE, verdict_code).max(refused_code))
}

/// Returns the text of a script, from a file or from standard input.
fn read(file: &Path) -> Result<String> {
    let source: Box<dyn Read> = if file.as_os_str() == "-" {
        Box::new(std::io::stdin())
    } else {
        Box::new(std::fs::File::open(file)?)
    };
    let mut bytes = Vec::new();
    // One byte more than is allowed shows that there are more. Standard input has no length that could be asked for.
    source.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    ensure!(
        bytes.len() as u64 <= MAX_BYTES,
        "the script is larger than {MAX_BYTES} bytes, the most that is read"
    );
    String::from_utf8(bytes).context("the script is not valid UTF-8")
}
