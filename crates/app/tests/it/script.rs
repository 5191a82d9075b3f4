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

#[test]
fn the_scripts_of_pictures_have_only_commands_that_exist() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/shots");
    let files = std::fs::read_dir(folder).unwrap();
    let paths = files.map(|entry| entry.unwrap().path());
    let scripts: Vec<_> = paths
        .filter(|path| path.extension().is_some_and(|ending| ending == "json"))
        .collect();
    assert!(scripts.len() >= 5, "{scripts:?}");

    for path in scripts {
        let text = std::fs::read_to_string(&path).unwrap();
        let shots: Result<Vec<(String, Vec<Command>)>, _> = serde_json::from_str(&text);
        assert!(shots.is_ok(), "{}: {shots:?}", path.display());
    }
}
