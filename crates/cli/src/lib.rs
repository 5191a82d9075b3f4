//! The command line of Tilescope: commands and their arguments, progress bars, exit codes.
//! The work is done by the crates below; the window is `tilescope-app`. Begin with [`run`].
//!
//! ```
//! use clap::Parser;
//! use tilescope_cli::{Arguments, Command};
//!
//! let arguments = Arguments::try_parse_from(["tilescope", "verify", "set.csv"])?;
//! assert!(matches!(arguments.command, Some(Command::Verify(_))));
//! assert!(Arguments::try_parse_from(["tilescope", "verify"]).is_err());
//! # Ok::<(), clap::Error>(())
//! ```

mod analyze;
mod bench;
mod bench_common;
mod bench_gpu;
mod bench_live;
mod bench_solid;
mod combine;
mod convert;
mod curve;
mod draw;
mod engine;
mod gpu;
mod ground;
mod headless;
mod interrupt;
pub mod lesson;
mod make;
mod nested;
mod options;
mod output;
mod own_radii;
mod parameters;
mod paths;
mod progress;
mod radius_span;
mod ranks;
mod reproduce;
mod sample;
mod sample_arguments;
mod script;
mod soak;
mod solid;
mod space;
mod stipple;
mod stream;
mod thin;
mod thinned;
mod varying;
mod verify;
mod web;
mod window;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use tilescope_analysis::shown_in_line;
use tilescope_lessons::LessonError;
use tilescope_reproduce::ReproduceError;

pub use headless::{HeadlessReason, refuse_file, refuse_link, run_headless};
pub use output::note;

/// The work was done, and any verdict is positive.
pub const EXIT_FINE: u8 = 0;
/// The work was done, and the verifier's verdict is negative.
pub const EXIT_NEGATIVE: u8 = 1;
/// The arguments or an input cannot be used.
pub const EXIT_BAD_INPUT: u8 = 2;
/// The process was interrupted, as by Ctrl-C.
pub const EXIT_INTERRUPTED: u8 = 130;

/// Tilescope: a visual debugger for maximal Poisson-disk sampling by randomized tiling.
#[derive(Debug, Parser)]
#[command(name = "tilescope", version, about, long_about = None, after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
pub struct Arguments {
    /// The command to run; without one the window opens.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Open the window with the content of a link: the address of a page, or the part after its #
    #[arg(long, value_name = "LINK")]
    pub link: Option<String>,
    /// Open the window with a file: a session, a point set, a lesson or a layout. "tilescope FILE" does the same
    #[arg(long, value_name = "FILE", conflicts_with = "link")]
    pub open: Option<PathBuf>,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Make a maximal Poisson-disk set, verify it and save it
    Sample(Box<sample_arguments::SampleArguments>),
    /// Draw an image in dots: exactly as many as are asked for, verified, as a picture or as a point set
    Stipple(Box<stipple::StippleArguments>),
    /// Verify a point set, against its certificate if it has one
    Verify(verify::VerifyArguments),
    /// Measure point sets: spectra, distances, order; as a table and as a report
    Analyze(analyze::AnalyzeArguments),
    /// Follow numbers of a run, such as conflicts and gaps, over its events; as a table
    Curve(Box<curve::CurveArguments>),
    /// Convert a point set to another format, verified
    Convert(convert::ConvertArguments),
    /// Keep points of a cloud so that no two are closer than a radius, and every other is near a kept one
    Thin(Box<thin::ThinArguments>),
    /// Glue maximal sets, placed side by side by a layout, into one
    Combine(combine::CombineArguments),
    /// Draw a point set as PNG or SVG
    Draw(draw::DrawArguments),
    /// Measure KDRT and exact tiling against the reference sampler, a GPU against the threads, or measures that move with a run
    Bench(bench_common::BenchArguments),
    /// Sample at random parameters with both engines, compare and verify
    Soak(soak::SoakArguments),
    /// Run the default session without a window and save pictures of its stages
    Headless(headless::HeadlessArguments),
    /// List the GPU adapters and test each: small sets, compared with the CPU's
    Gpu(gpu::GpuArguments),
    /// Carry out the paper's experiments and write a report of verdicts, figures and numbers
    Reproduce(reproduce::ReproduceArguments),
    /// Check, write and list lessons, and merge their results
    #[command(subcommand, after_help = lesson::EXAMPLES)]
    Lesson(lesson::LessonCommand),
    /// Serve the page that runs the same program in a browser
    Web(web::WebArguments),
    /// Carry out commands of the window from a file, without a window, and print the state
    Script(script::ScriptArguments),
    /// Print a shell's completion script
    Completions {
        /// The shell
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
}

const EXAMPLES: &str = "\
Examples:
  tilescope                                            open the window
  tilescope lecture.json                               open it with a session, a set, a lesson or a layout
  tilescope sample --count 10000 --out set.csv         a verified set with its certificate
  tilescope sample --radius 0.005 --boundary bounded --seed 7 --json
  tilescope stipple photo.jpg --dots 50000 --out photo.svg
  tilescope verify set.csv
  tilescope analyze set.csv --out report.html          spectra, distances and order, in one page
  tilescope curve --radius 0.01 --out run.csv          conflicts and gaps at every change of a run
  tilescope convert set.csv set.npy
  tilescope thin cloud.ply --radius 0.5 --xy --out thinned.ply
  tilescope combine nine.json --out nine.csv           nine sets, glued along their seams
  tilescope draw set.csv set.svg
  tilescope bench --samples 1000000 --leaf 20 40 80
  tilescope reproduce all --quick --out reproduction   the paper's experiments, with a report
  tilescope gpu                                        the GPU adapters, tested
  tilescope script steps.json                          the window's commands, without a window
  tilescope web --open                                 the same program in a browser

Exit codes: 0 success, 1 the verdict is negative, 2 bad arguments or input, 130 interrupted.";

impl Arguments {
    /// Reads the arguments of this process. Ends the process if they are wrong or ask for help.
    #[must_use]
    pub fn read() -> Self {
        Self::of(std::env::args_os()).unwrap_or_else(|error| {
            // A message repeats words of the command line, which may be names that others gave to files, with characters
            // that a terminal obeys. So the words are read once more, with escapes for such characters, and the message
            // about these is printed. Where they are no error, the first message holds none of those characters.
            let shown = |word: OsString| shown_in_line(&word.to_string_lossy()).into_owned();
            let words = std::env::args_os().map(shown).map(OsString::from);
            Self::of(words).err().unwrap_or(error).exit()
        })
    }

    /// Returns the lesson that the window is to open on, if one is to be played.
    #[must_use]
    pub fn played(&self) -> Option<anyhow::Result<lesson::Played>> {
        match &self.command {
            Some(Command::Lesson(command)) => lesson::played(command),
            _ => None,
        }
    }

    fn of(words: impl IntoIterator<Item = OsString>) -> Result<Self, clap::Error> {
        // Coordinates may be negative; without this clap would take -0.5 for an option.
        let mut command = Self::command().mut_subcommands(|one| one.allow_negative_numbers(true));
        let words: Vec<OsString> = words.into_iter().map(plain).collect();
        let words = with_direction(words);

        // The first word is the name of the program, and the second one that of the command.
        let reads_input = words.get(1).is_some_and(|word| word == "script");
        if !reads_input && words.iter().any(is_dash) {
            return Err(command.error(ErrorKind::InvalidValue, DASH));
        }
        let words = with_file_named(words, &mut command)?;
        let matches = command.try_get_matches_from_mut(words)?;
        Self::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
    }
}

/// Returns the words unchanged unless the second one, behind the program's name, is a file and no command: it then
/// becomes the value of `--open`.
///
/// # Errors
///
/// The second word can only be a file, and there is none of that name.
fn with_file_named(
    mut words: Vec<OsString>,
    command: &mut clap::Command,
) -> Result<Vec<OsString>, clap::Error> {
    let Some(second) = words.get(1) else {
        return Ok(words);
    };
    let text = second.to_string_lossy().into_owned();
    let is_file = Path::new(second).is_file();
    // clap adds `help` only when it parses, so that it is not among the commands yet.
    let is_command = command.find_subcommand(second).is_some() || text == "help";

    // Options are no files. A command comes before a file of its name, which is reached as ./NAME.
    if text.starts_with('-') || is_command {
        return Ok(words);
    }
    if is_file {
        words.insert(1, "--open".into());
        return Ok(words);
    }
    // No command has a dot or a slash in its name; other words may be misspelt commands, for which clap has advice.
    if text.contains(['.', '/', '\\']) {
        let message = format!("{text} is no file, and no command of tilescope\n");
        return Err(command.error(clap::error::ErrorKind::InvalidSubcommand, message));
    }
    Ok(words)
}

/// Why a dash is refused.
const DASH: &str = "- stands for standard input in `tilescope script` alone. Elsewhere give the name of a file: \
    /dev/stdin is standard input where the system has it, with --format; ./- is a file of that name";

/// Returns whether a word, or the value in it, is a dash: the name that programs give to a standard stream.
fn is_dash(word: &OsString) -> bool {
    let word = word.to_string_lossy();
    word == "-" || (word.starts_with("--") && word.ends_with("=-"))
}

/// Writes a negative number without its exponent, which clap would take for an option; returns other words unchanged.
fn plain(word: OsString) -> OsString {
    let number = (word.to_str())
        .filter(|text| text.starts_with('-') && text.contains(['e', 'E']))
        .and_then(|text| text.parse::<f64>().ok())
        .filter(|number| number.is_finite());
    // Decimal digits give back the same number, to the bit.
    number.map_or(word, |number| number.to_string().into())
}

/// Returns the words with a direction behind `--orbit` that begins with a minus joined to that word by `=`.
///
/// A direction may begin with a minus, and clap takes a word that begins with a minus for an option. clap has a setting
/// that allows such values; with it, clap would take `--turn` in `--orbit --turn` for the direction.
fn with_direction(words: Vec<OsString>) -> Vec<OsString> {
    let is_negative_direction = |word: &OsString| {
        let text = word.to_string_lossy();
        let degrees = text.strip_prefix('-').unwrap_or_default();
        // `-20,5`: no option has a digit or a point behind its minus.
        degrees.starts_with(|first: char| first.is_ascii_digit() || first == '.')
    };

    let mut joined: Vec<OsString> = Vec::with_capacity(words.len());
    for word in words {
        match joined.last_mut() {
            Some(last) if *last == "--orbit" && is_negative_direction(&word) => {
                last.push("=");
                last.push(word);
            }
            _ => joined.push(word),
        }
    }
    joined
}

/// Functions of the window's crates that commands call; this crate does not depend on those.
#[derive(Clone, Copy)]
pub struct FromWindow {
    /// Carries out the commands of a script, and passes on its output and its refusals.
    pub script: script::CarryOut,
    /// Returns a handout of a lesson, or why it cannot be made.
    pub handout: fn(lesson::Handout) -> Result<String, String>,
    /// Returns a lesson of the scenes of a saved session, or why it cannot be made.
    pub lesson_of_session: fn(&str) -> Result<String, String>,
    /// Shows the questions of a lesson, by its name and its text, and returns the faults of those whose answer a text of the
    /// window gives away; or why the window cannot show them.
    pub leaks: fn(&str, &str) -> Result<Vec<LessonError>, String>,
}

/// Returns the error of a command that does nothing in this build, with the reason.
#[must_use]
pub fn refusal(why: &'static str) -> anyhow::Error {
    anyhow::anyhow!(why)
}

/// Runs a command and returns the process's exit code; errors go to standard error.
#[must_use]
pub fn run(command: &Command, window: FromWindow) -> ExitCode {
    let outcome = match command {
        Command::Sample(arguments) => sample::run(arguments),
        Command::Stipple(arguments) => stipple::run(arguments),
        Command::Verify(arguments) => verify::run(arguments),
        Command::Analyze(arguments) => analyze::run(arguments),
        Command::Curve(arguments) => curve::run(arguments),
        Command::Convert(arguments) => convert::run(arguments),
        Command::Thin(arguments) => thin::run(arguments),
        Command::Combine(arguments) => combine::run(arguments),
        Command::Draw(arguments) => draw::run(arguments),
        Command::Bench(arguments) => bench::run(arguments),
        Command::Soak(arguments) => soak::run(arguments),
        Command::Headless(arguments) => headless::run(arguments),
        Command::Gpu(arguments) => gpu::run(arguments),
        Command::Reproduce(arguments) => reproduce::run(arguments),
        Command::Lesson(command) => lesson::run(command, window),
        Command::Web(arguments) => web::run(arguments),
        Command::Script(arguments) => script::run(arguments, window.script),
        Command::Completions { shell } => completions(*shell),
    };
    exit_code(outcome)
}

fn completions(shell: clap_complete::Shell) -> anyhow::Result<u8> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "tilescope", &mut script);
    output::emit(&String::from_utf8(script)?)?;
    Ok(EXIT_FINE)
}

/// Returns the exit code of an outcome and prints its error.
fn exit_code(outcome: anyhow::Result<u8>) -> ExitCode {
    match outcome {
        Ok(code) => ExitCode::from(code),
        Err(error) if interrupt::obeyed() => {
            // After a request to end, an error is only its consequence, and is not printed. Finished parts of a
            // reproduction are kept, so that it needs no option to go on.
            let cancelled = |error| matches!(error, &ReproduceError::Cancelled);
            let goes_on = if error.is::<interrupt::Resumable>() {
                "; run the same command with --resume to continue"
            } else if error.downcast_ref().is_some_and(cancelled) {
                "; run the same command again to continue"
            } else {
                ""
            };

            output::note(&format!(
                "interrupted; no file was left half written{goes_on}"
            ));
            ExitCode::from(EXIT_INTERRUPTED)
        }
        Err(error) => {
            output::note(&format!("error: {}", describe(&error)));
            ExitCode::from(EXIT_BAD_INPUT)
        }
    }
}

/// Returns an error and its causes in one line, each once: the message of a library may repeat the file or the cause
/// that another error of the chain names. Line breaks in words from files are written as escapes.
fn describe(error: &anyhow::Error) -> String {
    let mut parts: Vec<String> = Vec::new();
    for part in error.chain().map(ToString::to_string) {
        let part = shown_in_line(&part).into_owned();
        let so_far = parts.join(": ");
        match parts.last_mut() {
            // It begins with the message before it, such as a path, and says all of that.
            Some(last) if part.starts_with(last.as_str()) => *last = part,
            _ if so_far.contains(&part) => {}
            _ => parts.push(part),
        }
    }
    parts.join(": ")
}

/// Returns the exit code of a verdict.
const fn verdict_code(valid: bool) -> u8 {
    if valid { EXIT_FINE } else { EXIT_NEGATIVE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_say_nothing_twice() {
        let cause = anyhow::anyhow!("no such file");
        let error = cause.context("a.csv: no such file").context("a.csv");
        assert_eq!(describe(&error), "a.csv: no such file");
        let error = error.context("--against");
        assert_eq!(describe(&error), "--against: a.csv: no such file");
        let error = anyhow::anyhow!("no a\nverdict  valid");
        assert_eq!(describe(&error), "no a\\u000averdict  valid");
        let error = anyhow::anyhow!("it is empty").context("a.csv");
        assert_eq!(describe(&error), "a.csv: it is empty");
    }

    #[test]
    fn negative_numbers_are_taken_with_an_exponent() {
        let of = |words: &[&str]| Arguments::of(words.iter().map(OsString::from));
        let window = |arguments: Arguments| match arguments.command {
            Some(Command::Sample(sample)) => sample.window,
            _ => None,
        };
        let command = ["tilescope", "sample", "--radius", "1", "--window"];
        let numbers = ["-1e-3", "-2.5E+2", "-1e-300", "-4"];
        let found = of(&[command.as_slice(), &numbers].concat()).map(window);
        let expected = Some(vec![-1e-3, -2.5e2, -1e-300, -4.0]);
        assert_eq!(found.expect("numbers"), expected);
        let radius = ["tilescope", "verify", "set.csv", "--radius", "-1e-3"];
        assert!(of(&radius).is_ok());
        for word in ["-e", "-1e", "-e5", "--radius", "-inf", "1e-3", "-1"] {
            assert_eq!(plain(word.into()), OsString::from(word));
        }
    }

    #[test]
    fn a_first_word_that_is_a_file_is_opened() {
        let of = |words: &[&str]| {
            let words = ["tilescope"].iter().chain(words);
            Arguments::of(words.map(OsString::from))
        };
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("lecture.json");
        std::fs::write(&file, "{}").expect("a file");
        let name = file.to_str().expect("a name");
        let opened = of(&[name]).expect("arguments");
        assert_eq!(
            (opened.open, opened.command.is_none()),
            (Some(file.clone()), true)
        );
        // Commands stay commands: a misspelt or missing one is named.
        assert!(of(&["verify", name]).expect("arguments").command.is_some());
        assert!(of(&[name, "--link", "#v=1"]).is_err());
        let missing = of(&["lecture-2.json"]).expect_err("no such file");
        assert!(
            missing.to_string().contains("lecture-2.json is no file"),
            "{missing}"
        );
        let misspelt = of(&["verfy", name]).expect_err("no such command");
        assert!(misspelt.to_string().contains("verify"), "{misspelt}");
        assert_eq!(missing.exit_code(), 2);
        assert_eq!(misspelt.exit_code(), 2);
    }

    #[test]
    fn a_dash_is_standard_input_of_scripts_and_no_file() {
        let of = |words: &[&str]| {
            let words = ["tilescope"].iter().chain(words).map(OsString::from);
            Arguments::of(words).map_err(|error| error.to_string())
        };
        for words in [
            &["convert", "a.csv", "-", "--to", "csv"][..],
            &["verify", "-"],
            &["sample", "--radius", "0.1", "--out=-"],
            &["lesson", "results", "a.json", "--out", "-"],
        ] {
            let said = of(words).expect_err("refused");
            assert!(said.contains("in `tilescope script` alone"), "{said}");
        }
        assert!(of(&["script", "-"]).is_ok());
        assert!(of(&["convert", "./-", "b.csv"]).is_ok());
    }

    #[test]
    fn the_arguments_are_well_formed() {
        Arguments::command().debug_assert();
    }
}
