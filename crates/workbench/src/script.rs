//! Scripts: the commands that buttons and keys issue, as a JSON list, run without a window.
//!
//! A command without parameters is its name, `"run"`; others are objects of one key, the group: `{"time":
//! {"jump": 300}}`, `{"form": {"type": ["seed", "7"]}}`, `{"view": ["first", "fit"]}`.

use std::sync::Arc;

use emath::{Pos2, Rect, vec2};
use serde_json::Value;
use thiserror::Error;
use tilescope_session::verification::Verdict;

use crate::command::{Command, ViewCommand, Which};
use crate::compare::CompareCommand;
use crate::files::FileCommand;
use crate::remote::to_json;
use crate::state::{Effect, Settings, State};

/// The most commands of a script. Chosen, not measured.
pub const MAX_COMMANDS: usize = 100_000;
/// The canvas that cameras are fitted into, in screen points. A script has no window; this is a common size of one.
const CANVAS: [f32; 2] = [1280.0, 720.0];

/// Why a text is not a script.
#[derive(Debug, Error)]
pub enum ScriptError {
    /// It is not a JSON list.
    #[error("a script is a JSON list of commands: {0}")]
    NotAList(serde_json::Error),
    /// It is too long.
    #[error("the script has {0} commands; at most {MAX_COMMANDS} are allowed")]
    TooLong(usize),
    /// One of its commands is unknown or has unknown parts.
    #[error("command {number}: {why}")]
    BadCommand {
        /// Its number, from 1.
        number: usize,
        /// The fault in it.
        why: serde_json::Error,
    },
}

/// Returns the commands of a script.
pub fn read(text: &str) -> Result<Vec<Command>, ScriptError> {
    let values: Vec<Value> =
        tilescope_core::json::from_text(text).map_err(ScriptError::NotAList)?;
    if values.len() > MAX_COMMANDS {
        return Err(ScriptError::TooLong(values.len()));
    }
    let command = |(index, value)| {
        serde_json::from_value(value).map_err(|why| ScriptError::BadCommand {
            number: index + 1,
            why,
        })
    };
    values.into_iter().enumerate().map(command).collect()
}

/// A command of a script that was refused, or whose work failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// Its number, from 1.
    pub number: usize,
    /// Why it was refused or failed, in sentences.
    pub why: String,
    /// Whether the command is one of files or exports. Most often a file could not be read or written.
    pub is_of_file: bool,
}

/// Applies commands one after the other, beginning with the default session, and waits for the work that each
/// starts. `after` receives the state after each command, and ends the script by returning an error.
///
/// Cameras jump instead of flying, and playing does not advance by itself.
pub fn apply_all<E>(
    commands: Vec<Command>,
    mut after: impl FnMut(&State) -> Result<(), E>,
) -> Result<State, E> {
    carry_out(commands, |state, _| after(state))
}

/// Does what [`apply_all`] does; `after` also receives why the command was refused, if it was.
fn carry_out<E>(
    commands: Vec<Command>,
    mut after: impl FnMut(&State, Option<Refusal>) -> Result<(), E>,
) -> Result<State, E> {
    let mut state = State::new(Arc::new(|| {}));
    // Cameras jump, as no time for a flight passes between two commands.
    state.restore(Settings {
        prefers_reduced_motion: Some(true),
        ..Settings::default()
    });
    let canvas = Rect::from_min_size(Pos2::ZERO, vec2(CANVAS[0], CANVAS[1]));
    state.apply(Command::View(Which::First, ViewCommand::Viewport(canvas)));
    state.settle();

    let mut commands = commands.into_iter().enumerate().peekable();
    while let Some((index, command)) = commands.next() {
        let next = commands.peek().map(|(_, next)| next);
        // `apply` waits for the work that the command starts, because that may fail, too.
        let why = refusal_before(&state, &command).or_else(|| apply(&mut state, &command, next));
        let refusal = why.map(|why| Refusal {
            number: index + 1,
            why,
            is_of_file: matches!(command, Command::File(_) | Command::Export(_)),
        });
        after(&state, refusal)?;
    }
    Ok(state)
}

/// Returns why a command would do nothing now and show no notice: the window has no button for it in this state.
fn refusal_before(state: &State, command: &Command) -> Option<String> {
    // All other commands do something, or say why not.
    match command {
        Command::Run => state.form().refusal(state.gpu()),
        Command::Compare(CompareCommand::Start(preset)) => {
            state
                .runs()
                .preset_refusal(*preset, state.form(), state.gpu())
        }
        Command::Compare(CompareCommand::GoToDivergence) => {
            state.runs().parting_refusal().map(str::to_owned)
        }
        Command::Compare(CompareCommand::Swap) if state.runs().second.is_none() => {
            Some("There is no second run.".to_owned())
        }
        Command::File(FileCommand::Go) => match &state.files().sheet {
            None => Some("No file sheet is open.".to_owned()),
            Some(form) if form.path.trim().is_empty() => Some("No file is named.".to_owned()),
            Some(_) => None,
        },
        _ => None,
    }
}

/// Applies a command and waits for its work. Returns why it was refused or failed, if it was. `next` is the command after it, if any.
fn apply(state: &mut State, command: &Command, next: Option<&Command>) -> Option<String> {
    // An older notice must not be taken for one about this command.
    let before = state.messages().notice.clone();
    state.carry_out(Which::First, vec![Effect::CloseNotice]);
    state.apply(command.clone());
    state.settle();

    let notice = state.messages().notice.as_ref();
    // A notice with a folder is about a file that was written, which is no failure, whatever it says of the set in the
    // file.
    let failed = notice
        .filter(|notice| notice.is_error && notice.folder.is_none())
        .map(|notice| notice.text.clone());

    // A command without a notice of its own leaves the older one, as in the window.
    if notice.is_none() && !matches!(command, Command::DismissNotice) {
        let again = before.map(Effect::Tell);
        state.carry_out(Which::First, again.into_iter().collect());
    }

    // The first command that would replace a file only asks; the same command once more is the answer.
    let asks = next.is_none_or(|next| next != command) && state.files().asks_to_replace();
    let asked = "The file exists. The same command once more replaces it.".to_owned();
    failed.or_else(|| asks.then_some(asked))
}

/// Reads and runs a script. `print` receives the state as JSON, as pages receive it: after each command if
/// `each` is set, otherwise after the last one. `refused` receives the number of each command that was refused or
/// failed, why, and whether it is one of files or exports; the commands after it are carried out all the same. Returns
/// whether the verifier finds the samples valid at the end; `None` if there is no verdict.
pub fn run<E: From<ScriptError>>(
    text: &str,
    each: bool,
    print: &mut dyn FnMut(&str) -> Result<(), E>,
    refused: &mut dyn FnMut(usize, &str, bool),
) -> Result<Option<bool>, E> {
    let commands = read(text)?;

    let mut print_state = |state: &State| print(&format!("{}\n", to_json(state)));
    let state = carry_out(commands, |state, refusal| {
        if let Some(Refusal {
            number,
            why,
            is_of_file,
        }) = refusal
        {
            refused(number, &why, is_of_file);
        }
        if each { print_state(state) } else { Ok(()) }
    })?;

    if !each {
        print_state(&state)?;
    }
    Ok(state.runs().first.verdict().map(Verdict::valid))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The refusals of a script, as they are reported.
    fn refusals(text: &str) -> Vec<(usize, String, bool)> {
        let mut all = Vec::new();
        let mut note =
            |number, why: &str, is_of_file| all.push((number, why.to_owned(), is_of_file));
        let done: Result<_, ScriptError> = run(text, false, &mut |_| Ok(()), &mut note);
        done.expect("a script");
        all
    }

    #[test]
    fn each_refused_command_is_named_with_its_reason() {
        assert!(refusals(r#"[{"form": {"type": ["seed", "7"]}}, "run"]"#).is_empty());
        let wrong = refusals(r#"[{"form": {"type": ["seed", "-7"]}}, "run", {"file": "go"}]"#);
        let numbers: Vec<_> = wrong
            .iter()
            .map(|(number, _, file)| (*number, *file))
            .collect();
        assert_eq!(numbers, [(2, false), (3, true)], "{wrong:?}");
        assert!(wrong[0].1.to_lowercase().contains("seed"), "{wrong:?}");
    }

    #[cfg(not(target_arch = "wasm32"))]
    #[test]
    fn files_that_cannot_be_read_or_written_are_failures() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("no/file");
        let missing = serde_json::json!(missing.display().to_string());
        let small = r#"{"form": {"type": ["radius", "0.1"]}}, "run""#;
        let export = |kind: &str, name: &str| {
            let path = folder.path().join("no").join(name).display().to_string();
            let path = serde_json::json!(path);
            format!(
                r#"[{small}, {{"export": {{"open": "{kind}"}}}}, {{"export": {{"path": {path}}}}}, {{"export": "write"}}]"#
            )
        };
        for (text, number) in [
            (
                format!(
                    r#"[{{"file": {{"sheet": "open"}}}}, {{"file": {{"path": {missing}}}}}, {{"file": "go"}}]"#
                ),
                3,
            ),
            (
                format!(
                    r#"[{{"file": {{"sheet": "save"}}}}, {{"file": {{"path": {missing}}}}}, {{"file": "go"}}]"#
                ),
                3,
            ),
            (export("samples", "set.csv"), 5),
            (export("picture", "moment.png"), 5),
            (export("animation", "run.gif"), 5),
        ] {
            let found = refusals(&text);
            let [(found, why, true)] = &found[..] else {
                panic!("{text}: {found:?}");
            };
            assert_eq!(*found, number, "{text}: {why}");
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    #[test]
    fn a_file_is_replaced_by_the_same_command_once_more() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("moment.svg");
        std::fs::write(&path, "old").unwrap();
        let named = serde_json::json!(path.display().to_string());
        let script = |more: &str| {
            format!(
                r#"[{{"export": {{"open": "picture"}}}}, {{"export": {{"path": {named}}}}}, {{"export": "write"}}{more}]"#
            )
        };
        let asked = refusals(&script(""));
        assert_eq!((asked.len(), asked[0].0), (1, 3));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert!(refusals(&script(r#", {"export": "write"}"#)).is_empty());
        assert_ne!(std::fs::read(&path).unwrap(), b"old");
    }

    #[test]
    fn invalid_scripts_are_refused_with_the_command() {
        let refused = |text: &str| read(text).unwrap_err().to_string();
        assert!(refused("{}").starts_with("a script is a JSON list of commands: "));
        let unknown = refused(r#"["run", {"time": "stepforward"}]"#);
        assert!(
            unknown.starts_with("command 2: unknown variant `stepforward`, expected one of"),
            "{unknown}"
        );
        let line = refused(r#"[{"debug": {"toggle-breakpoint": "eliminate.99"}}]"#);
        assert!(line.contains("there is no line \"eliminate.99\""), "{line}");
        let long = format!("[{}\"run\"]", "\"run\",".repeat(MAX_COMMANDS));
        assert!(refused(&long).contains("100001 commands; at most 100000"));
    }
}
