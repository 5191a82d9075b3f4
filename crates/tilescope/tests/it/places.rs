//! Inputs and outputs of commands, end to end: links, pipes, devices, contradictory names.

use std::fs;
use std::os::unix::fs::symlink;
use std::os::unix::net::UnixListener;
use std::process::{Command as Process, Stdio};

use predicates::str::contains;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

use crate::support::runs::{json, read};
use crate::support::{names, tilescope};

/// Makes `set.csv`, a set with its certificate, and `plain.csv`, the same without.
fn with_set() -> TempDir {
    let folder = tempdir().unwrap();
    json(&folder, &["sample", "--radius", "0.05", "--out", "set.csv"]);
    fs::copy(
        folder.path().join("set.csv"),
        folder.path().join("plain.csv"),
    )
    .unwrap();
    folder
}

fn pipe(folder: &TempDir, name: &str) {
    let made = Process::new("mkfifo")
        .arg(folder.path().join(name))
        .status();
    assert!(made.unwrap().success());
}

/// Each way to write a file.
const WRITERS: [&[&str]; 7] = [
    &["sample", "--radius", "0.05", "--out"],
    &["sample", "--radius", "0.05", "--no-verify", "--out"],
    &[
        "sample", "--radius", "0.05", "--window", "0", "0", ".5", ".5", "--out",
    ],
    &["convert", "set.csv"],
    &["draw", "set.csv"],
    &["analyze", "set.csv", "--out"],
    &["combine", "layout.json", "--out"],
];

/// Returns a name that the writer would write.
fn out(writer: &[&str], name: &str) -> String {
    let extension = if writer[0] == "draw" { "svg" } else { "csv" };
    format!("{name}.{extension}")
}

const LAYOUT: &str = r#"{ "version": 1, "radius": 0.05, "columns": [1], "rows": [1], "pieces": [{ "file": "set.csv" }] }"#;

#[test]
fn nothing_but_a_file_is_replaced() {
    let folder = with_set();
    fs::write(folder.path().join("layout.json"), LAYOUT).unwrap();
    for extension in ["csv", "svg"] {
        pipe(&folder, &format!("pipe.{extension}"));
        let link = folder.path().join(format!("device.{extension}"));
        symlink("/dev/null", link).unwrap();
        UnixListener::bind(folder.path().join(format!("socket.{extension}"))).unwrap();
        symlink(
            "/dev/stdout",
            folder.path().join(format!("stdout.{extension}")),
        )
        .unwrap();
    }
    let before = names(folder.path());
    for writer in WRITERS {
        for (name, kind) in [
            ("pipe", "a pipe"),
            ("device", "a device"),
            ("socket", "a socket"),
            ("stdout", "a stream of a process"),
        ] {
            let out = out(writer, name);
            let refused = tilescope(&folder).args(writer).arg(&out).assert();
            let said = contains(format!("{out}: this is {kind}; give the name of a file"));
            refused.code(2).stderr(said);
        }
    }
    assert_eq!(names(folder.path()), before);
}

#[test]
fn links_lead_every_writer_to_its_file() {
    let folder = with_set();
    fs::write(folder.path().join("layout.json"), LAYOUT).unwrap();
    fs::create_dir(folder.path().join("data")).unwrap();
    for (k, writer) in WRITERS.into_iter().enumerate() {
        let out = out(writer, &k.to_string());
        symlink(format!("data/{out}"), folder.path().join(&out)).unwrap();
        tilescope(&folder).args(writer).arg(&out).assert().success();
        assert!(folder.path().join(&out).is_symlink(), "{writer:?}");
        assert!(
            read(&folder, &format!("data/{out}")).len() > 100,
            "{writer:?}"
        );
    }
    // Verified sets have a certificate beside them.
    let certified = |name: &String| name.ends_with(".certificate.json");
    let written = names(&folder.path().join("data"));
    assert_eq!(written.iter().filter(|name| certified(name)).count(), 3);
    assert_eq!(written.len(), WRITERS.len() + 3);
    assert!(!names(folder.path()).contains(&"0.csv.certificate.json".to_owned()));
    json(&folder, &["verify", "0.csv"]);
}

#[test]
fn no_output_is_written_over_an_input() {
    let folder = with_set();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("layout.json"), LAYOUT).unwrap();
    fs::write(at("results.json"), "{}").unwrap();
    for (input, extensions) in [
        ("set.csv", &["csv", "svg"][..]),
        ("layout.json", &["csv"]),
        ("results.json", &["csv"]),
    ] {
        let stem = input.split_once('.').unwrap().0;
        for extension in extensions {
            symlink(input, at(&format!("link-{stem}.{extension}"))).unwrap();
            fs::hard_link(at(input), at(&format!("hard-{stem}.{extension}"))).unwrap();
        }
    }
    let before: Vec<(String, Vec<u8>)> = (names(folder.path()).into_iter())
        .map(|name| (name.clone(), read(&folder, &name)))
        .collect();
    let commands: [&[&str]; 8] = [
        &["draw", "set.csv", "link-set.svg"],
        &["draw", "set.csv", "hard-set.svg"],
        &["convert", "set.csv", "set.csv"],
        &["convert", "link-set.csv", "hard-set.csv"],
        &["combine", "layout.json", "--out", "hard-layout.csv"],
        &["combine", "layout.json", "--out", "link-set.csv"],
        &[
            "lesson",
            "results",
            "results.json",
            "--out",
            "hard-results.csv",
        ],
        &[
            "sample",
            "--radius",
            "0.01",
            "--pattern",
            "set.csv",
            "--out",
            "hard-set.csv",
        ],
    ];
    for command in commands {
        let refused = tilescope(&folder).args(command).assert().code(2);
        refused.stderr(contains("would be written over this input"));
    }
    for (name, bytes) in before {
        assert_eq!(read(&folder, &name), bytes, "{name}");
    }
    // A picture over a set that is not its input takes the set's certificate with it.
    fs::copy(at("set.csv"), at("old.svg")).unwrap();
    fs::copy(
        at("set.csv.certificate.json"),
        at("old.svg.certificate.json"),
    )
    .unwrap();
    tilescope(&folder)
        .args(["draw", "set.csv", "old.svg"])
        .assert()
        .success();
    assert!(!at("old.svg.certificate.json").exists());
}

#[test]
fn what_is_written_has_a_name_that_it_can_be_read_by() {
    let folder = with_set();
    let before = names(folder.path());
    for arguments in [
        [
            "sample", "--radius", "0.05", "--out", "y.npy", "--format", "csv",
        ]
        .as_slice(),
        &[
            "sample",
            "--radius",
            "0.05",
            "--no-verify",
            "--out",
            "y.npy",
            "--format",
            "csv",
        ],
        &[
            "sample", "--radius", "0.05", "--window", "0", "0", ".5", ".5", "--out", "y.npy",
            "--format", "csv",
        ],
        &["convert", "set.csv", "y.npy", "--to", "csv"],
    ] {
        let refused = tilescope(&folder).args(arguments).assert();
        refused.code(2).stderr(contains("call it .csv"));
    }
    assert_eq!(names(folder.path()), before);
    json(
        &folder,
        &[
            "sample", "--radius", "0.05", "--out", "y.txt", "--format", "utk-text",
        ],
    );
    let verified = json(&folder, &["verify", "y.txt"]);
    assert_eq!(verified["differences"], Value::Array(vec![]));
}

#[test]
fn a_pipe_is_read_once_whatever_is_given() {
    let folder = with_set();
    let set = read(&folder, "plain.csv");
    let expected = json(&folder, &["verify", "plain.csv", "--radius", "0.05"]);
    let sides: [&[&str]; 3] = [
        &[],
        &["--width", "1"],
        &["--width", "1", "--height", "1", "--boundary", "periodic"],
    ];
    for sides in sides {
        let mut command = tilescope(&folder);
        command.args([
            "verify",
            "/dev/stdin",
            "--radius",
            "0.05",
            "--format",
            "csv",
            "--json",
        ]);
        let output = command
            .args(sides)
            .write_stdin(set.clone())
            .output()
            .unwrap();
        let found: Value = serde_json::from_slice(&output.stdout)
            .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
        assert_eq!(found, expected);
    }
    let commands: [&[&str]; 5] = [
        &["verify", "pipe.csv", "--radius", "0.05"],
        &["convert", "pipe.csv", "out.npy"],
        &["draw", "pipe.csv", "out.svg"],
        &["analyze", "pipe.csv", "--boundary", "periodic"],
        &[
            "sample",
            "--radius",
            "0.01",
            "--pattern",
            "pipe.csv",
            "--pattern-radius",
            "0.05",
        ],
    ];
    pipe(&folder, "pipe.csv");
    for command in commands {
        let mut child = Process::new("sh");
        child
            .current_dir(folder.path())
            .args(["-c", "cat plain.csv > pipe.csv"]);
        let mut writer = child.spawn().unwrap();
        tilescope(&folder).args(command).assert().success();
        assert!(writer.wait().unwrap().success());
    }
}

/// Runs the program in `folder` with a full device as its output, or for its errors. Returns its code.
fn on_full_device(folder: &TempDir, arguments: &[&str], errors: bool) -> Option<i32> {
    let device = fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let mut program = Process::new(tilescope(folder).get_program());
    program
        .current_dir(folder.path())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    if errors {
        program.stderr(device);
    } else {
        program.stdout(device);
    }
    program.status().unwrap().code()
}

#[test]
fn an_output_that_takes_nothing_is_an_error_and_no_panic() {
    let folder = tempdir().unwrap();
    let commands: [&[&str]; 3] = [
        &["completions", "bash"],
        &["sample", "--radius", "0.05"],
        &[],
    ];
    for arguments in commands {
        assert_eq!(
            on_full_device(&folder, arguments, false),
            Some(2),
            "{arguments:?}"
        );
    }
    // The error cannot be printed, but the exit code shows it.
    assert_eq!(
        on_full_device(&folder, &["verify", "missing.csv"], true),
        Some(2)
    );
    let mut program = Process::new(tilescope(&folder).get_program());
    let mut child = program
        .args(["completions", "bash"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stderr.is_empty());
}
