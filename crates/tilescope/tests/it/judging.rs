//! Verification end to end: certificates that are not true, files that are no sets, exit codes.

use std::fs;

use crate::support::{names, tilescope};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

/// Runs a command and returns its JSON object.
fn object(folder: &TempDir, arguments: &[&str], code: i32) -> Value {
    let mut command = tilescope(folder);
    let assert = command.args(arguments).arg("--json").assert().code(code);
    serde_json::from_slice(&assert.get_output().stdout).expect("one JSON object")
}

fn sample(folder: &TempDir, more: &[&str]) {
    tilescope(folder)
        .args(["sample", "--radius", "0.05"])
        .args(more)
        .assert()
        .success();
}

/// Changes the certificate of a file.
fn change(folder: &TempDir, file: &str, change: impl FnOnce(&mut Value)) {
    let path = folder.path().join(format!("{file}.certificate.json"));
    let mut certificate: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    change(&mut certificate);
    fs::write(&path, certificate.to_string()).unwrap();
}

/// Returns the names of the fields in which a certificate is not true.
fn fields(verified: &Value) -> Vec<&str> {
    let differences = verified["differences"].as_array().unwrap().iter();
    differences.map(|d| d["field"].as_str().unwrap()).collect()
}

/// Makes a set with a hole whose certificate states a tolerance with which it is none.
fn tolerated_hole(folder: &TempDir) {
    sample(folder, &["--out", "whole.csv"]);
    let text = fs::read_to_string(folder.path().join("whole.csv")).unwrap();
    let mut lines: Vec<&str> = text.lines().collect();
    lines.remove(100);
    fs::write(folder.path().join("holed.csv"), lines.join("\n")).unwrap();
    tilescope(folder)
        .args(["convert", "holed.csv", "set.csv", "--radius", "0.05"])
        .assert()
        .code(1);
    change(folder, "set.csv", |certificate| {
        certificate["covering_tolerance"] = json!(0.5);
        certificate["valid"] = json!(true);
        certificate["gaps"] = json!(0);
    });
}

#[test]
fn the_tolerance_of_a_certificate_is_not_believed() {
    let folder = tempdir().unwrap();
    tolerated_hole(&folder);
    let question = [
        "--radius",
        "0.05",
        "--width",
        "1",
        "--height",
        "1",
        "--boundary",
        "periodic",
    ];
    for more in [&[][..], &question] {
        let verified = object(&folder, &[&["verify", "set.csv"], more].concat(), 1);
        assert_eq!(verified["covering_tolerance"], 1.0 / 32768.0);
        assert_eq!(
            (&verified["maximal"], &verified["passed"]),
            (&json!(false), &json!(false))
        );
        assert!(verified["gaps"].as_u64().unwrap() > 0);
        assert!(
            fields(&verified).contains(&"covering_tolerance"),
            "{verified}"
        );
    }
    tilescope(&folder)
        .args(["verify", "set.csv"])
        .assert()
        .code(1)
        .stdout(contains("covering_tolerance: stated 0.5"));
    tilescope(&folder)
        .args(["analyze", "set.csv", "--json"])
        .assert()
        .code(2)
        .stdout(contains("\"gaps\":0.0").not())
        .stderr(contains("covering_tolerance"));
}

#[test]
fn the_tolerance_stands_beside_the_verdict() {
    let folder = tempdir().unwrap();
    sample(&folder, &["--out", "set.csv"]);
    for arguments in [&["verify", "set.csv"][..], &["sample", "--radius", "0.05"]] {
        assert_eq!(
            object(&folder, arguments, 0)["covering_tolerance"],
            1.0 / 32768.0
        );
        tilescope(&folder)
            .args(arguments)
            .assert()
            .stdout(contains("at most 1.000030518 r"));
    }
}

#[test]
fn parameters_that_contradict_the_region_beside_them_are_not_true() {
    let folder = tempdir().unwrap();
    for (name, value) in [
        ("radius", json!(0.5)),
        ("width", json!(77)),
        ("height", json!(77)),
        ("boundary", json!("bounded")),
    ] {
        sample(&folder, &["--out", "set.csv"]);
        change(&folder, "set.csv", |stated| {
            stated["parameters"][name] = value;
        });
        let verified = object(&folder, &["verify", "set.csv"], 1);
        assert_eq!(fields(&verified), [format!("parameters.{name}")]);
    }
}

#[test]
fn what_no_file_can_show_is_named_as_unchecked() {
    let folder = tempdir().unwrap();
    sample(&folder, &["--out", "set.csv"]);
    change(&folder, "set.csv", |stated| {
        stated["method"] = json!("by hand");
        stated["parameters"]["seed"] = json!(99);
    });
    let verified = object(&folder, &["verify", "set.csv"], 0);
    let unchecked = verified["unchecked"].as_array().unwrap();
    for field in ["program", "method", "parameters.seed"] {
        assert!(unchecked.contains(&json!(field)), "{field}: {unchecked:?}");
    }
    assert!(!unchecked.contains(&json!("parameters.radius")));
    tilescope(&folder)
        .args(["verify", "set.csv"])
        .assert()
        .success()
        .stdout(
            contains("stated only")
                .and(contains("method"))
                .and(contains("seed")),
        );
}

/// The verdict is the same, and so is the exit code, if nobody reads the output.
#[cfg(unix)]
#[test]
fn a_closed_pipe_keeps_the_verdict() {
    let folder = tempdir().unwrap();
    sample(&folder, &["--out", "set.csv"]);
    for arguments in [
        &["verify", "set.csv", "--radius", "0.07"][..],
        &["convert", "two.csv", "two.npy", "--radius", "0.2"],
    ] {
        fs::write(folder.path().join("two.csv"), "x,y\n0.1,0.1\n0.15,0.1\n").unwrap();
        let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("tilescope"))
            .current_dir(folder.path())
            .args(arguments)
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(String::from_utf8_lossy(&output.stderr), "");
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
    }
}

#[test]
fn an_uncertified_file_has_no_certificate_of_an_older_one() {
    let folder = tempdir().unwrap();
    for more in [
        &["--window", "0.1", "0.1", "0.4", "0.4"][..],
        &["--no-verify"],
        &["--no-verify", "--method", "reference"],
        &["--no-verify", "--shuffle", "3"],
    ] {
        sample(&folder, &["--out", "set.npy"]);
        assert_eq!(
            names(folder.path()),
            ["set.npy", "set.npy.certificate.json"]
        );
        sample(
            &folder,
            &[&["--seed", "9", "--out", "set.npy"], more].concat(),
        );
        assert_eq!(names(folder.path()), ["set.npy"], "{more:?}");
    }
}

#[test]
fn a_false_certificate_is_carried_nowhere() {
    let folder = tempdir().unwrap();
    for seed in ["1", "2"] {
        let out = format!("{seed}.ply");
        sample(&folder, &["--seed", seed, "--out", &out]);
    }
    // The points of seed 2 beside the certificate of seed 1.
    let at = |name: &str| folder.path().join(name);
    fs::copy(at("2.ply"), at("1.ply")).unwrap();
    let layout = r#"{ "version": 1, "radius": 0.05, "columns": [1], "rows": [1], "pieces": [{ "file": "1.ply" }] }"#;
    fs::write(at("layout.json"), layout).unwrap();
    let before = names(folder.path());

    let users: [&[&str]; 6] = [
        &["draw", "1.ply", "p.svg"],
        &["analyze", "1.ply", "--out", "r.html"],
        &["analyze", "2.ply", "--against", "1.ply", "--out", "r.html"],
        &["convert", "1.ply", "c.csv"],
        &["combine", "layout.json", "--out", "c.csv"],
        &["sample", "--radius", "0.01", "--pattern", "1.ply"],
    ];
    for user in users {
        let refused = tilescope(&folder).args(user).assert().code(2);
        refused.stderr(contains("is not true: digest: "));
    }
    // There may be a report on the other set, which can be analysed.
    let _ = fs::remove_file(at("r.html"));
    assert_eq!(names(folder.path()), before);

    for user in &[users[0], users[1], users[3]] {
        let said = tilescope(&folder)
            .args(*user)
            .arg("--no-certificate")
            .assert();
        let left_out = contains("1.ply: read without its certificate");
        said.success().stderr(left_out);
    }
    let text = fs::read_to_string(at("c.csv.certificate.json")).unwrap();
    let stated: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(stated["method"], "unknown");
    assert_eq!(stated["parameters"], json!({}));
    // A picture of the true set has its blocks, and one without provenance has none.
    let draw = |set: &str, more: &[&str]| {
        let arguments = [&["draw", set, "p.svg", "--no-disks"], more].concat();
        tilescope(&folder).args(arguments).assert().success();
        fs::metadata(at("p.svg")).unwrap().len()
    };
    assert!(draw("2.ply", &[]) > draw("2.ply", &["--no-certificate"]));
}

/// Without verification the same file is written.
#[test]
fn not_verifying_changes_no_byte() {
    let folder = tempdir().unwrap();
    for more in [
        &["--method", "reference"][..],
        &["--engine", "sequential"],
        &["--shuffle", "3"],
        &[],
    ] {
        let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
        sample(&folder, &[&["--out", "set.ply"], more].concat());
        let verified = read("set.ply");
        let arguments = [
            &[
                "sample",
                "--radius",
                "0.05",
                "--out",
                "set.ply",
                "--no-verify",
            ],
            more,
        ];
        let said = object(&folder, &arguments.concat(), 0);
        assert_eq!(
            (&said["verified"], &said["certificate"]),
            (&json!(false), &json!(null))
        );
        assert_eq!(read("set.ply"), verified, "{more:?}");
    }
}

#[cfg(unix)]
#[test]
fn a_certificate_is_a_regular_file_of_few_bytes() {
    let folder = tempdir().unwrap();
    sample(&folder, &["--out", "set.csv"]);
    let path = folder.path().join("set.csv.certificate.json");
    let refused = |reason: &str| {
        for command in ["verify", "analyze"] {
            tilescope(&folder)
                .args([command, "set.csv"])
                .timeout(std::time::Duration::from_secs(20))
                .assert()
                .code(2)
                .stderr(contains("certificate.json").and(contains(reason.to_owned())));
        }
    };
    fs::remove_file(&path).unwrap();
    std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
    refused("not a regular file");
    fs::remove_file(&path).unwrap();
    let made = std::process::Command::new("mkfifo").arg(&path).status();
    assert!(made.unwrap().success());
    refused("not a regular file");
    fs::remove_file(&path).unwrap();
    // A sparse file takes no room on the disk.
    fs::File::create(&path).unwrap().set_len(1 << 36).unwrap();
    refused("exceed the limit of 16777216");
}

/// A sparse file that is too long is refused before it is read.
#[test]
fn a_file_beyond_memory_is_refused_before_it_is_read() {
    let folder = tempdir().unwrap();
    let file = fs::File::create(folder.path().join("huge.xyz")).unwrap();
    file.set_len(20 << 30).unwrap();
    for arguments in [
        &["analyze", "huge.xyz", "--radius", "0.1"][..],
        &["draw", "huge.xyz", "huge.png"],
        &["verify", "huge.xyz", "--radius", "0.1"],
        &["convert", "huge.xyz", "huge.npy", "--radius", "0.1"],
    ] {
        tilescope(&folder)
            .args(arguments)
            .assert()
            .code(2)
            .stderr(contains("huge.xyz").and(contains("21474836480 bytes")));
    }
}

#[test]
fn convert_ends_with_the_verdict_that_it_prints() {
    let folder = tempdir().unwrap();
    fs::write(
        folder.path().join("three.csv"),
        "x,y\n0.1,0.1\n0.3,0.1\n0.1,0.35\n",
    )
    .unwrap();
    tilescope(&folder)
        .args(["convert", "three.csv", "three.npy"])
        .assert()
        .code(1)
        .stdout(contains("NOT VALID"));
    assert!(folder.path().join("three.npy").exists());
}

#[test]
fn both_sides_of_a_comparison_take_lists() {
    let folder = tempdir().unwrap();
    for seed in ["1", "2", "3", "4"] {
        let name = format!("s{seed}.npy");
        sample(&folder, &["--seed", seed, "--out", &name]);
    }
    for arguments in [
        [
            "--average",
            "s1.npy",
            "s2.npy",
            "--against",
            "s3.npy",
            "s4.npy",
        ],
        [
            "--against",
            "s3.npy",
            "s4.npy",
            "--average",
            "s1.npy",
            "s2.npy",
        ],
    ] {
        let found = object(&folder, &[&["analyze"], &arguments[..]].concat(), 0);
        assert_eq!(found["against"]["sets"], 2, "{arguments:?}");
        assert_eq!(found["against"]["files"][0]["file"], "s3.npy");
        assert_eq!(found["average"]["sets"], 2);
        assert_eq!(found["files"][1]["file"], "s2.npy");
    }
}

/// Sets from other programs: whatever can be read gets a verdict, and the rest a reason.
#[test]
fn sets_of_others_get_a_verdict_or_a_reason() {
    let folder = tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("equal.csv", "x,y\n0.1,0.1\n0.5,0.9\n0.1,0.1\n");
    let found = object(&folder, &["verify", "equal.csv", "--radius", "0.1"], 1);
    assert_eq!(
        (&found["conflicts"], &found["min_distance_r"]),
        (&json!(1), &json!(0.0))
    );
    write("line.csv", "x,y\n0.1,0.5\n0.5,0.5\n0.9,0.5\n");
    let bounded = [
        "verify",
        "line.csv",
        "--radius",
        "0.1",
        "--boundary",
        "bounded",
    ];
    assert_eq!(object(&folder, &bounded, 1)["conflict_free"], true);
    let refused = |name: &str, reason: &'static str| {
        tilescope(&folder)
            .args(["verify", name, "--radius", "0.1"])
            .assert()
            .code(2)
            .stderr(contains(reason));
    };
    write("closed.csv", "x,y\n0,0.5\n1,0.5\n");
    refused("closed.csv", "the upper side is the lower one");
    write("commas.csv", "x,y\n0,5,0,25\n");
    refused("commas.csv", "line 2: 4 columns where 2 are needed");
}

#[test]
fn conflicts_are_counted_up_to_a_limit() {
    let folder = tempdir().unwrap();
    let row = |i: u32| format!("{},{}\n", f64::from(i) * 1e-5, 0.5);
    let rows: String = (0..3000).map(row).collect();
    fs::write(folder.path().join("line.csv"), format!("x,y\n{rows}")).unwrap();
    let arguments = ["verify", "line.csv", "--radius", "0.5"];
    let found = object(&folder, &arguments, 1);
    let expected = (&json!(1_000_000), &json!(true));
    assert_eq!((&found["conflicts"], &found["more_conflicts"]), expected);
    tilescope(&folder)
        .args(arguments)
        .assert()
        .code(1)
        .stdout(contains("NO, 1000000 or more"));
}
