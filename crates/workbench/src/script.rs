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
use crate::state::State;

/// The most commands of a script.
pub const MAX_COMMANDS: usize = 100_000;
/// The canvas that cameras are fitted into, in screen points.
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

/// Applies commands one after the other, beginning with the default session, and waits for the work that each
/// starts. `after` receives the state after each command, and ends the script by returning an error.
///
/// Cameras jump instead of flying, and playing does not advance by itself.
pub fn apply_all<E>(
    commands: Vec<Command>,
    mut after: impl FnMut(&State) -> Result<(), E>,
) -> Result<State, E> {
    let mut state = State::new(Arc::new(|| {}));
    state.prefer_reduced_motion(true);
    let canvas = Rect::from_min_size(Pos2::ZERO, vec2(CANVAS[0], CANVAS[1]));
    let canvas = ViewCommand::Viewport(canvas);
    state.apply(Command::View(Which::First, canvas));
    state.settle();
    for command in commands {
        state.apply(command);
        state.settle();
        after(&state)?;
    }
    Ok(state)
}

/// Reads and runs a script. `print` receives the state as JSON, as pages receive it: after each command if
/// `each` is set, otherwise after the last one. Returns the verifier's verdict on the session at the end.
pub fn run<E: From<ScriptError>>(
    text: &str,
    each: bool,
    print: &mut dyn FnMut(&str) -> Result<(), E>,
) -> Result<Option<bool>, E> {
    let commands = read(text)?;
    let mut print_state = |state: &State| print(&format!("{}\n", state.to_json()));
    let state = apply_all(
        commands,
        |state| if each { print_state(state) } else { Ok(()) },
    )?;
    if !each {
        print_state(&state)?;
    }
    Ok(state.verdict().map(Verdict::valid))
}

#[cfg(test)]
mod tests {
    use super::*;

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
