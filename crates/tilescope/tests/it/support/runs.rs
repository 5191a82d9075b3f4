//! Helpers of the end-to-end tests of large sets: runs with their JSON object, files, and runs that are interrupted.

use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command as Process, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

use crate::support::tilescope;

/// Runs a command that must end well and returns its JSON object.
pub fn json(folder: &TempDir, arguments: &[&str]) -> Value {
    let mut command = tilescope(folder);
    let output = command.args(arguments).arg("--json").output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {errors}");
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

/// Returns the bytes of a file.
pub fn read(folder: &TempDir, name: &str) -> Vec<u8> {
    fs::read(folder.path().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Starts a run that makes checkpoints of the file `name` as often as it can, and waits for the first, or
/// for its end.
pub fn started(folder: &TempDir, arguments: &[&str], name: &str) -> Child {
    let binary = assert_cmd::cargo::cargo_bin("tilescope");
    let mut child = Process::new(binary)
        .current_dir(folder.path())
        .args(arguments)
        .args(["--threads", "1", "--checkpoint", "0", "--out", name])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let checkpoint = folder.path().join(format!("{name}.resume.json"));
    let began = Instant::now();
    while !checkpoint.exists() && child.try_wait().unwrap().is_none() {
        assert!(
            began.elapsed() < Duration::from_mins(2),
            "no checkpoint came"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

/// Returns where the unfinished file of `name` is.
pub fn partial(folder: &TempDir, name: &str) -> PathBuf {
    folder.path().join(format!("{name}.partial"))
}
