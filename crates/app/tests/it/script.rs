//! Every action of the window as the text of a script, and back.

use std::convert::Infallible;

use tilescope_app::actions::actions;
use tilescope_workbench::Command;
use tilescope_workbench::script::{apply_all, read};

#[test]
fn every_action_is_a_command_of_scripts() {
    let Ok(state) = apply_all(Vec::new(), |_| Ok::<_, Infallible>(()));
    let all: Vec<Command> = actions(&state).into_iter().map(|a| a.command).collect();
    assert!(all.len() > 100, "{}", all.len());
    let text = serde_json::to_string(&all).unwrap();
    assert_eq!(read(&text).unwrap(), all);
}
