//! Checks that the rules of the window's commands (`crates/workbench/src/rules.rs`) name every command, and that the window's
//! state stays small. The compiler asks for the rules of a new command only as long as nothing there has a default.

use std::fs;
use std::path::Path;

use crate::circles::{product, sources};

/// The most fields of the window's state. What is new belongs to one of its parts.
const MAX_FIELDS: usize = 12;
/// The most functions of the state itself, which may change every part, and the most files with them. They are the counts of the
/// day when the parts were last gone through: lower them with each pass.
const MAX_FUNCTIONS: usize = 59;
const MAX_FILES: usize = 4;

/// Returns the lines that decide about commands that they do not name: conditions, and arms of a match whose pattern is no
/// variant.
fn defaults(rules: &str) -> Vec<String> {
    let code = product(rules);
    let has_default = |line: &&str| {
        let pattern = line.split_once("=>").map(|(pattern, _)| pattern.trim());
        let is_open = pattern.is_some_and(|pattern| !pattern.contains(char::is_uppercase));
        is_open || line.contains("matches!") || line.contains("if ") || line.contains(" == ")
    };
    let found = code.lines().map(str::trim).filter(has_default);
    found.map(str::to_owned).collect()
}

#[test]
fn no_command_falls_to_a_default_rule() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/workbench/src/rules.rs");
    let rules = fs::read_to_string(path).expect("the file of the rules");
    assert_eq!(defaults(&rules), Vec::<String>::new());

    // The control: the same with one default, of each kind.
    let arm = "        FileCommand::Sheet(_)\n";
    assert_eq!(rules.matches(arm).count(), 1);
    for default in [
        "        _ => VIEW,\n",
        "        other => VIEW,\n",
        "        _ if true => VIEW,\n",
        "        reveals: matches!(command, FileCommand::Go),\n",
    ] {
        let loosened = rules.replace(arm, &format!("{default}{arm}"));
        assert_eq!(defaults(&loosened), [default.trim()]);
    }
}

/// Returns how many functions the code of a file adds to the state.
fn functions(text: &str) -> usize {
    let code = product(text);
    let blocks = code.split("\nimpl State {").skip(1);
    let bodies = blocks.map(|block| block.split("\n}\n").next().unwrap_or_default());
    // A function of an `impl` block is indented by four spaces; what stands inside one, by more.
    let heads = bodies
        .flat_map(str::lines)
        .filter_map(|line| line.strip_prefix("    "));
    let is_head = |line: &&str| !line.starts_with(' ') && line.contains("fn ");
    heads.filter(is_head).count()
}

#[test]
fn the_windows_state_is_made_of_parts() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/workbench/src");
    let counts: Vec<usize> = sources(&folder, "")
        .iter()
        .map(|(_, text)| functions(text))
        .filter(|&count| count > 0)
        .collect();
    let all: usize = counts.iter().sum();
    assert!(all <= MAX_FUNCTIONS, "{all} functions");
    assert!(counts.len() <= MAX_FILES, "{} files", counts.len());

    let state = fs::read_to_string(folder.join("state.rs")).expect("the file of the state");
    let fields = product(&state);
    let fields = fields
        .split_once("pub struct State {")
        .expect("the state")
        .1;
    let fields = fields.split('}').next().unwrap_or_default().matches(": ");
    assert!(fields.count() <= MAX_FIELDS);

    // The control.
    assert_eq!(
        functions("\nimpl State {\n    fn a() {\n        fn b() {}\n    }\n}\n"),
        1
    );
}
