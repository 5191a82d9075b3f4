//! `tilescope combine` end to end: the real binary, real layouts, exit codes.

use std::fs;
use std::path::Path;

use crate::support::{names, tilescope};
use predicates::prelude::*;
use predicates::str::contains;
use tempfile::tempdir;

const NINE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../assets/layouts/nine.json"
);

#[test]
fn the_example_layout_becomes_a_verified_file() {
    let folder = tempdir().unwrap();
    tilescope(&folder)
        .args(["combine", NINE, "--out", "nine.csv"])
        .assert()
        .success()
        .stdout(contains("9 by the reference sampler").and(contains("verdict        valid")));
    assert_eq!(
        names(folder.path()),
        ["nine.csv", "nine.csv.certificate.json"]
    );
    tilescope(&folder)
        .args(["verify", "nine.csv"])
        .assert()
        .success();
}

#[test]
fn files_beside_the_layout_are_pieces_wherever_the_program_runs() {
    let folder = tempdir().unwrap();
    let inner = folder.path().join("sets");
    fs::create_dir(&inner).unwrap();
    for (name, boundary) in [("a.npy", "periodic"), ("b.npy", "bounded")] {
        tilescope(&folder)
            .args(["sample", "--radius", "0.03", "--boundary", boundary])
            .arg("--out")
            .arg(Path::new("sets").join(name))
            .assert()
            .success();
    }
    let layout = r#"{
        "version": 1, "boundary": "bounded", "radius": 0.06, "columns": [2, 1.4], "rows": [2],
        "pieces": [{ "file": "b.npy" }, { "file": "a.npy", "offset": [0.9, -4] }]
    }"#;
    fs::write(inner.join("layout.json"), layout).unwrap();
    for threads in ["1", "2"] {
        tilescope(&folder)
            .args(["combine", "sets/layout.json", "--threads", threads, "--out"])
            .arg(format!("{threads}.npy"))
            .assert()
            .success();
    }
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(read("1.npy"), read("2.npy"));
}

#[test]
fn what_cannot_be_combined_is_refused_and_nothing_is_written() {
    let folder = tempdir().unwrap();
    let layout = r#"{ "version": 1, "radius": 0.05, "columns": [1], "rows": [1], "pieces": [{ "file": "a.csv" }] }"#;
    fs::write(folder.path().join("layout.json"), layout).unwrap();
    // Two samples cover no square.
    fs::write(folder.path().join("a.csv"), "x,y\n0.1,0.1\n0.9,0.5\n").unwrap();
    let refused = |wanted: &str| {
        tilescope(&folder)
            .args(["combine", "layout.json", "--out", "set.csv"])
            .assert()
            .code(2)
            .stderr(contains(wanted))
            .stdout(predicate::str::is_empty());
        assert_eq!(names(folder.path()), ["a.csv", "layout.json"]);
    };
    refused("layout.json: pieces[0]");
    refused("the set has no certificate; give its \"radius\"");
    let layout = layout.replace("\"a.csv\"", "\"a.csv\", \"radius\": 0.05");
    fs::write(folder.path().join("layout.json"), layout).unwrap();
    refused("the set is not maximal");
}
