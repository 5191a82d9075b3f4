//! Checks that the rules of the window's commands (`crates/workbench/src/rules.rs`) name every command. The compiler asks for
//! the rules of a new command only as long as nothing there has a default.

use std::fs;
use std::path::Path;

use crate::circles::product;

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
