//! Helpers of the tests of `tilescope analyze`: its JSON object, and files that a test writes.

use std::fs;

use serde_json::Value;
use tempfile::TempDir;

use crate::support::tilescope;

/// Writes a file.
pub fn write(folder: &TempDir, name: &str, content: &str) {
    fs::write(folder.path().join(name), content).unwrap();
}

/// Returns the JSON object of an analysis, which must end with the given code.
pub fn json(folder: &TempDir, arguments: &[&str], code: i32) -> Value {
    let mut command = tilescope(folder);
    let assert = command.arg("analyze").args(arguments).arg("--json");
    let output = assert.assert().code(code).get_output().clone();
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

/// Returns a number of it.
pub fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}
