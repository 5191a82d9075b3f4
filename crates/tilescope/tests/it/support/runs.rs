//! Helpers of the end-to-end tests of large sets: runs with their JSON object, files, and runs that are interrupted.

use std::fs;
use std::path::{Path, PathBuf};
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

/// How often a run is started again if it ends before it is seen to be past its first checkpoint.
const STARTS: usize = 20;

/// Sends a process a signal.
pub fn signal(child: &Child, name: &str) {
    let mut kill = Process::new("kill");
    let status = kill
        .args([format!("-{name}"), child.id().to_string()])
        .status();
    assert!(status.unwrap().success());
}

/// Starts a run that makes checkpoints of the file `name` as often as it can.
fn started(folder: &TempDir, arguments: &[&str], name: &str) -> Child {
    Process::new(assert_cmd::cargo::cargo_bin("tilescope"))
        .current_dir(folder.path())
        .args(arguments)
        .args(["--threads", "1", "--checkpoint", "0", "--out", name])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// Lets a run advance in short turns until its checkpoint is there, and leaves it stopped. Returns `false` if it ended before.
fn reaches(child: &mut Child, checkpoint: &Path) -> bool {
    let began = Instant::now();
    while !checkpoint.exists() {
        assert!(
            began.elapsed() < Duration::from_mins(5),
            "no checkpoint came"
        );
        signal(child, "CONT");
        std::thread::sleep(Duration::from_millis(2));
        signal(child, "STOP");
        if child.try_wait().unwrap().is_some() {
            return false;
        }
    }
    true
}

/// Starts a run that makes checkpoints of the file `name` as often as it can. Returns it stopped after its first checkpoint; the
/// signal `CONT` lets it go on.
pub fn paused(folder: &TempDir, arguments: &[&str], name: &str) -> Child {
    let checkpoint = folder.path().join(format!("{name}.resume.json"));
    for _ in 0..STARTS {
        let mut child = started(folder, arguments, name);
        if reaches(&mut child, &checkpoint) {
            return child;
        }
        child.wait().unwrap();
        fs::remove_file(folder.path().join(name)).unwrap();
    }
    panic!("{STARTS} runs ended between their first checkpoint and the next look");
}

/// Returns where the unfinished file of `name` is.
pub fn partial(folder: &TempDir, name: &str) -> PathBuf {
    folder.path().join(format!("{name}.partial"))
}
