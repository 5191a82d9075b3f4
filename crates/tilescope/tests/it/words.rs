//! Words from others, in files and in names of files: what they do to a terminal, to a report and to the exit code.

use std::ffi::OsStr;
use std::fs;
use std::path::Path;

use assert_cmd::assert::Assert;
use predicates::str::contains;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::support::tilescope;

/// Clears the screen in two ways, turns words round, and begins a line of its own.
const HOSTILE: &str = "\u{1b}[2J\u{9b}31m\u{7}\u{202e}\r\nFORGED";

/// Asserts that nothing of [`HOSTILE`] reached the terminal but its letters.
fn assert_shown(assert: &Assert, what: &str) {
    let output = assert.get_output();
    for stream in [&output.stdout, &output.stderr] {
        let text = String::from_utf8_lossy(stream);
        let is_obeyed = |c: char| c.is_control() && !matches!(c, '\n' | '\t') || c == '\u{202e}';
        assert!(!text.contains(is_obeyed), "{what}: {text:?}");
        let is_forged = |line: &str| line.trim_start().starts_with("FORGED");
        assert!(!text.lines().any(is_forged), "{what}: {text}");
    }
    // A test that sees nothing of the word tests nothing.
    let both = [&output.stdout[..], &output.stderr[..]].concat();
    assert!(
        String::from_utf8_lossy(&both).contains("FORGED"),
        "{what}: {both:?}"
    );
}

fn run(folder: &TempDir, arguments: &[&OsStr]) -> Assert {
    tilescope(folder).args(arguments).assert()
}

/// Makes a set with its certificate; returns the certificate.
fn set(folder: &TempDir, name: &str) -> Value {
    let make = ["sample", "--radius", "0.1", "--out", name];
    tilescope(folder).args(make).assert().success();
    let path = folder.path().join(format!("{name}.certificate.json"));
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn words_of_a_certificate_are_shown_and_not_obeyed() {
    let folder = tempdir().unwrap();
    let intact = set(&folder, "set.csv");
    let mut parameter = intact.clone();
    parameter["parameters"][HOSTILE] = json!(1);
    let mut digest = intact.clone();
    digest["positions_digest"] = json!(HOSTILE);
    let mut count = intact;
    count["count"] = json!(HOSTILE);
    for (what, certificate) in [
        ("parameter", parameter),
        ("digest", digest),
        ("count", count),
    ] {
        let path = folder.path().join("set.csv.certificate.json");
        fs::write(path, certificate.to_string()).unwrap();
        assert_shown(
            &run(&folder, &["verify".as_ref(), "set.csv".as_ref()]),
            what,
        );
    }
}

#[cfg(unix)]
#[test]
fn names_of_files_are_shown_and_not_obeyed() {
    let folder = tempdir().unwrap();
    set(&folder, "set.csv");
    let path = |ending: &str| format!("a{HOSTILE}{ending}");
    let copied = path(".csv");
    fs::copy(folder.path().join("set.csv"), folder.path().join(&copied)).unwrap();
    fs::write(folder.path().join(path(".md")), "no lesson").unwrap();
    fs::write(folder.path().join(path(".json")), "no results").unwrap();
    let [csv, png, npy, md, json] = [".csv", ".png", ".npy", ".md", ".json"].map(path);
    let missing = path("-missing.csv");
    for arguments in [
        &["verify", &missing][..],
        &["verify", &csv, "--format", "npy"],
        &["analyze", &csv, "--radius", "0.1"],
        &["analyze", &csv, &missing],
        &["draw", &csv, &png],
        &["draw", &missing, &png],
        &["convert", &csv, &npy, "--radius", "0.1"],
        &["lesson", "check", &md],
        &["lesson", "results", &json, "--out", "class.csv"],
        &["lesson", "new", &md],
        &["lesson", "handout", &missing, "--out", "h.html"],
        &["lesson", "play", &missing],
        &["combine", &json],
        &["script", &json],
        &[
            "sample",
            "--radius",
            "0.1",
            "--no-verify",
            "--out",
            &path("/x.csv"),
        ],
        &["web", "--folder", &missing],
        &["verify", "set.csv", &csv],
    ] {
        let arguments: Vec<&OsStr> = arguments.iter().map(OsStr::new).collect();
        assert_shown(&run(&folder, &arguments), &format!("{arguments:?}"));
    }
}

#[test]
fn words_of_lessons_layouts_and_scripts_are_shown_and_not_obeyed() {
    let folder = tempdir().unwrap();
    let hostile = HOSTILE.replace(['\r', '\n'], "");
    let lesson = format!("---\ntitle: T\nobjective: O\n---\n# A\n```{hostile}\n```\n");
    let layout = json!({
        "version": 1, "radius": 0.1, "columns": [1.0], "rows": [1.0], "pieces": [{ "file": HOSTILE }],
    });
    let layout = layout.to_string();
    let script = json!([{ HOSTILE: 1 }]).to_string();
    for (name, text, command) in [
        ("a.md", lesson, vec!["lesson", "check", "a.md"]),
        ("l.json", layout, vec!["combine", "l.json"]),
        ("s.json", script, vec!["script", "s.json"]),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
        let arguments: Vec<&OsStr> = command.iter().map(OsStr::new).collect();
        assert_shown(&run(&folder, &arguments), name);
    }
}

#[cfg(unix)]
#[test]
fn names_that_are_not_utf8_are_written_lossily_and_marked() {
    use std::os::unix::ffi::OsStrExt as _;
    let folder = tempdir().unwrap();
    set(&folder, "set.csv");
    let name = OsStr::from_bytes(b"a\xff.csv");
    let [copy, report] = [Path::new(name), Path::new("r.html")];
    fs::copy(folder.path().join("set.csv"), folder.path().join(copy)).unwrap();
    let command = [
        "analyze".as_ref(),
        name,
        "--out".as_ref(),
        report.as_os_str(),
    ];
    run(&folder, &command).success();
    let page = fs::read_to_string(folder.path().join(report)).unwrap();
    assert!(
        page.contains("tilescope analyze &apos;(not UTF-8) a\u{fffd}.csv&apos;"),
        "{page}"
    );

    // Certificates and other commands do the same.
    let [radius, value] = ["--radius", "0.1"].map(OsStr::new);
    let verify = ["verify".as_ref(), name, radius, value];
    run(&folder, &verify).success();
    let out = OsStr::from_bytes(b"b\xff.csv");
    run(&folder, &["convert".as_ref(), name, out, radius, value]).success();
    let certificate = OsStr::from_bytes(b"b\xff.csv.certificate.json");
    let certificate = fs::read(folder.path().join(Path::new(certificate))).unwrap();
    let certificate: Value = serde_json::from_slice(&certificate).unwrap();
    assert_eq!(certificate["file"], "(not UTF-8) b\u{fffd}.csv");
    let draw = ["draw".as_ref(), name, OsStr::from_bytes(b"c\xff.svg")];
    run(&folder, &draw).success();
    for argument in ["--radius", "--format", "--judge"] {
        let refused = [
            "verify".as_ref(),
            name,
            argument.as_ref(),
            OsStr::from_bytes(b"\xff"),
        ];
        run(&folder, &refused).code(2).stderr(contains("error"));
    }
}
