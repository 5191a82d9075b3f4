//! The command line end to end: the real binary, real files, exit codes.

use std::fs;

use crate::support::{names, tilescope};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

fn json(folder: &TempDir, arguments: &[&str], code: i32) -> Value {
    let output = tilescope(folder)
        .args(arguments)
        .assert()
        .code(code)
        .get_output()
        .clone();
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

const FORMATS: [&str; 10] = [
    "set.csv", "set.txt", "set.rps", "set.dat", "set.bin", "set.npy", "set.ply", "set.xyz",
    "set.json", "set.svg",
];

#[test]
fn every_format_is_saved_verified_and_verifies_again() {
    let folder = tempdir().unwrap();
    for name in FORMATS {
        let made = json(
            &folder,
            &["sample", "--radius", "0.02", "--out", name, "--json"],
            0,
        );
        assert_eq!(made["valid"], true, "{name}: {made}");
        let verified = json(&folder, &["verify", name, "--json"], 0);
        assert_eq!(verified["differences"], Value::Array(vec![]), "{name}");
        assert_eq!(verified["count"], made["count"], "{name}");
    }
}

#[test]
fn nested_levels_are_stated_level_by_level_and_their_prefixes_verify() {
    let folder = tempdir().unwrap();
    let levels = ["--levels", "4", "--out", "set.csv", "--json"];
    let made = json(
        &folder,
        &[&["sample", "--radius", "0.02"][..], &levels].concat(),
        0,
    );
    let counts: Vec<u64> = (made["levels"].as_array().unwrap().iter())
        .map(|level| level["count"].as_u64().unwrap())
        .collect();
    assert!(counts.len() == 4 && counts.is_sorted(), "{made}");
    let text = fs::read_to_string(folder.path().join("set.csv")).unwrap();
    assert!(text.starts_with("x,y,level,rank\n"), "{text}");
    json(&folder, &["verify", "set.csv", "--json"], 0);
    let between = (counts[1] + 1).to_string();
    let prefix = ["verify", "set.csv", "--prefix", &between, "--json"];
    let found = json(&folder, &prefix, 0);
    assert_eq!(found["valid"], true, "{found}");
    assert!(
        found["covering"].as_f64() > found["distance"].as_f64(),
        "{found}"
    );
    // A file in another order does not hold what its certificate states.
    let mut lines: Vec<&str> = text.lines().collect();
    lines.swap(1, counts[2] as usize + 1);
    fs::write(folder.path().join("set.csv"), lines.join("\n")).unwrap();
    let found = json(&folder, &prefix, 1);
    assert_eq!(found["valid"], false, "{found}");
}

#[test]
fn the_last_of_nested_levels_has_a_count() {
    let folder = tempdir().unwrap();
    for (count, order) in [(500, "random"), (900, "farthest")] {
        let asked = count.to_string();
        let ask = [
            "--count",
            &asked,
            "--levels",
            "3",
            "--order-within",
            order,
            "--json",
        ];
        let made = json(&folder, &[&["sample"][..], &ask].concat(), 0);
        let found = made["count"].as_u64().unwrap();
        assert!(found.abs_diff(count) <= count / 100, "{made}");
        // Unlike the first so many of a larger set, these leave no gap.
        assert_eq!(
            (&made["valid"], &made["maximal"]),
            (&json!(true), &json!(true))
        );

        // Its radius gives the same set.
        let radius = made["radius"].to_string();
        let ask = [
            "--radius",
            &radius,
            "--levels",
            "3",
            "--order-within",
            order,
            "--json",
        ];
        let again = json(&folder, &[&["sample"][..], &ask].concat(), 0);
        assert_eq!(
            again["positions_digest"], made["positions_digest"],
            "{count}"
        );
    }
}

#[test]
fn nested_levels_are_saved_without_a_verdict() {
    let folder = tempdir().unwrap();
    let levels = ["sample", "--radius", "0.05", "--levels", "3", "--out"];
    let judged = json(&folder, &[&levels[..], &["a.csv", "--json"]].concat(), 0);
    let unjudged = [&levels[..], &["b.csv", "--no-verify", "--json"]].concat();
    let unjudged = json(&folder, &unjudged, 0);
    assert_eq!(
        (&unjudged["verified"], &unjudged["certificate"]),
        (&json!(false), &Value::Null)
    );
    assert_eq!(unjudged["positions_digest"], judged["positions_digest"]);

    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(read("a.csv"), read("b.csv"), "the levels are in the file");
    assert!(!folder.path().join("b.csv.certificate.json").exists());
}

#[test]
fn the_digest_of_a_set_is_that_of_its_file_and_needs_none() {
    let folder = tempdir().unwrap();
    let digest = |more: &[&str]| {
        let made = json(
            &folder,
            &[&["sample", "--json", "--radius"][..], more].concat(),
            0,
        );
        made["positions_digest"].as_str().unwrap().to_owned()
    };
    let certified = |name: &str| {
        let path = folder.path().join(format!("{name}.certificate.json"));
        let certificate: Value = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
        certificate["positions_digest"].as_str().unwrap().to_owned()
    };
    let alone = digest(&["0.05"]);
    assert_eq!(digest(&["0.05", "--out", "a.npy"]), alone);
    assert_eq!(certified("a.npy"), alone);
    assert_ne!(digest(&["0.05", "--seed", "2"]), alone);

    // A file that rounds or shuffles has another digest; the set that was made has not.
    assert_eq!(digest(&["0.05", "--out", "b.npy", "--shuffle", "3"]), alone);
    assert_ne!(certified("b.npy"), alone);

    // Band by band, and a window of the whole.
    let banded = ["0.05", "--no-verify", "--out", "c.npy"];
    assert_eq!(digest(&banded), alone);
    assert_eq!(digest(&["0.05", "--window", "0", "0", "1", "1"]), alone);
}

const FORMAT_NAMES: [&str; 12] = [
    "csv",
    "psa-text",
    "psa-rps",
    "utk-text",
    "utk-binary",
    "npy",
    "ply-ascii",
    "ply-binary",
    "xyz",
    "json",
    "geojson",
    "svg",
];

#[test]
fn shells_complete_the_names_of_formats_and_help_lists_them() {
    let folder = tempdir().unwrap();
    for (command, option) in [
        ("convert", "--to"),
        ("sample", "--format"),
        ("combine", "--format"),
        ("verify", "--format"),
        ("analyze", "--format"),
        ("draw", "--format"),
    ] {
        let mut help = tilescope(&folder);
        let text = help.args([command, "--help"]).assert().success();
        let text = String::from_utf8(text.get_output().stdout.clone()).unwrap();
        let (_, of_option) = text.split_once(option).expect("the option");
        for name in FORMAT_NAMES {
            assert!(
                of_option.contains(&format!("- {name}:")),
                "{command} {option}: {name}"
            );
        }
    }
    let mut completions = tilescope(&folder);
    let script = completions.args(["completions", "bash"]).assert().success();
    let script = String::from_utf8(script.get_output().stdout.clone()).unwrap();
    let names = format!("compgen -W \"{}\"", FORMAT_NAMES.join(" "));
    assert!(script.contains(&names), "{script}");

    let wrong = ["convert", "a.csv", "b", "--to", "jpeg"];
    let mut refused = tilescope(&folder);
    refused
        .args(wrong)
        .assert()
        .code(2)
        .stderr(contains("ply-ascii"));
}

#[test]
fn a_count_is_given_exactly() {
    let folder = tempdir().unwrap();
    let order = ["--order-within", "farthest", "--json"];
    let asked = ["sample", "--exactly", "500", "--levels", "3"];
    let made = json(&folder, &[&asked[..], &order].concat(), 0);
    assert_eq!(made["count"], 500, "{made}");
    // It is verified by its levels, since it is not maximal for the finest radius, and keeps them in other formats.
    let made = json(
        &folder,
        &[&asked[..], &["--json", "--out", "set.csv"]].concat(),
        0,
    );
    assert_eq!(made["valid"], false, "{made}");
    let converted = tilescope(&folder)
        .args(["convert", "set.csv", "set.ply"])
        .assert();
    converted.code(0).stdout(contains("covering radius up to"));
    for file in ["set.csv", "set.ply"] {
        let found = json(&folder, &["verify", file, "--json"], 0);
        assert_eq!(found["levels"].as_array().map(Vec::len), Some(3), "{found}");
        assert_eq!(found["passed"], true, "{found}");
    }
    tilescope(&folder)
        .args(["verify", "set.csv"])
        .assert()
        .code(0)
        .stdout(contains("verdict        valid"));
    let uncovered = ["sample", "--exactly", "500", "--levels", "1"];
    tilescope(&folder)
        .args(uncovered)
        .assert()
        .code(2)
        .stderr(contains("at least 2"));
    let refused = ["sample", "--radius", "0.02", "--levels", "20"];
    tilescope(&folder)
        .args(refused)
        .assert()
        .code(2)
        .stderr(contains("there must be between 1 and 11"));
}

#[test]
fn the_json_object_tells_the_whole_run() {
    let folder = tempdir().unwrap();
    let run = json(
        &folder,
        &[
            "sample",
            "--radius",
            "0.01",
            "--seed",
            "18446744073709551615",
            "--json",
        ],
        0,
    );
    for key in [
        "count",
        "density",
        "min_distance_r",
        "covering_radius_r",
        "gaps",
        "conflicts",
        "iterations",
        "inserted",
        "eliminated",
        "tiled",
        "blocks",
        "radius",
    ] {
        assert!(run[key].is_number() || run[key].is_array(), "{key}: {run}");
    }
    assert_eq!(run["parameters"]["seed"], u64::MAX);
    assert_eq!(run["parameters"]["order"], "own-block-first");
    assert_eq!(stages(&run), ["pattern", "regions"]);
    let arguments = ["sample", "--radius", "0.01", "--engine", "sequential"];
    let staged = json(&folder, &[arguments.as_slice(), &["--json"]].concat(), 0);
    let stages = stages(&staged);
    assert_eq!(
        stages[..5],
        ["pattern", "blocks", "tile", "eliminate", "iterate 1"]
    );
    assert_eq!(*stages.last().unwrap(), "finish");
}

fn stages(run: &Value) -> Vec<&str> {
    let seconds = run["seconds"].as_array().unwrap().iter();
    seconds.map(|s| s["stage"].as_str().unwrap()).collect()
}

#[test]
fn equal_seeds_give_equal_files() {
    let folder = tempdir().unwrap();
    for name in ["a.npy", "b.npy"] {
        tilescope(&folder)
            .args(["sample", "--radius", "0.01", "--out", name])
            .assert()
            .success();
    }
    tilescope(&folder)
        .args([
            "sample", "--radius", "0.01", "--seed", "2", "--out", "c.npy",
        ])
        .assert()
        .success();
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(read("a.npy"), read("b.npy"));
    assert_ne!(read("a.npy"), read("c.npy"));
}

#[test]
fn counts_are_met_within_one_percent() {
    let folder = tempdir().unwrap();
    for (count, extra) in [
        (100, ["--boundary", "periodic"]),
        (777, ["--boundary", "bounded"]),
        (5000, ["--insertion", "uniform"]),
        (5000, ["--method", "reference"]),
        (20_000, ["--height", "0.3"]),
    ] {
        let text = count.to_string();
        let mut arguments = vec!["sample", "--count", &text, "--json"];
        arguments.extend(extra);
        let run = json(&folder, &arguments, 0);
        let found = run["count"].as_u64().unwrap();
        assert!(found.abs_diff(count) <= count / 100, "{count}: {found}");
        assert!(run["radius"].as_f64().unwrap() > 0.0);
    }
}

#[test]
fn the_search_of_two_radii_is_a_negative_verdict() {
    let folder = tempdir().unwrap();
    let arguments = [
        "sample", "--radius", "0.002", "--leaf", "40", "--search", "2", "--json",
    ];
    let run = json(&folder, &arguments, 1);
    assert_eq!(run["conflict_free"], true);
    assert!(run["gaps"].as_u64().unwrap() > 0);
}

#[test]
fn a_spoiled_file_is_refused_and_the_difference_named() {
    let folder = tempdir().unwrap();
    tilescope(&folder)
        .args(["sample", "--radius", "0.02", "--out", "set.csv"])
        .assert()
        .success();
    let path = folder.path().join("set.csv");
    let text = fs::read_to_string(&path).unwrap();
    let mut lines: Vec<&str> = text.lines().collect();
    lines.remove(700);
    fs::write(&path, lines.join("\n")).unwrap();
    tilescope(&folder)
        .args(["verify", "set.csv"])
        .assert()
        .code(1)
        .stdout(
            contains("NOT TRUE")
                .and(contains("digest"))
                .and(contains("count")),
        );
    tilescope(&folder)
        .args(["convert", "set.csv", "set.npy"])
        .assert()
        .code(2)
        .stderr(contains("certificate is not true"));
    assert!(!folder.path().join("set.npy").exists());
}

/// Arguments that are refused, each with a part of the message.
const BAD: &[(&[&str], &str)] = &[
    (
        &["sample"],
        "<--radius <R>|--count <N>|--exactly <N>|--radius-expression <FORMULA>>",
    ),
    (
        &[
            "sample", "--width", ".7", "--height", ".7", "--radius", ".07",
        ],
        "is 9.999999999999998 r long; it must be at least 10 r",
    ),
    (&["sample", "--radius", "1e300"], "is 1e-300 r long"),
    (&["sample", "--radius", "-1e-300"], "the radius is -1e-300"),
    (
        &["sample", "--radius", "0.01", "--out", "a.zebra"],
        "npy, ply, xyz",
    ),
    (
        &["sample", "--radius", ".05", "--gpu-adapter", "zebra"],
        "no GPU adapter",
    ),
    (
        &[
            "sample",
            "--radius",
            ".05",
            "--gpu-adapter",
            "zebra",
            "--method",
            "reference",
        ],
        "--gpu-adapter",
    ),
    (
        &[
            "sample",
            "--radius",
            ".05",
            "--gpu-adapter",
            "zebra",
            "--window",
            "0",
            "0",
            "1",
            "1",
        ],
        "--window needs the parallel engine",
    ),
    (
        &[
            "sample", "--radius", ".05", "--window", "5000", "0", "5000.5", "1",
        ],
        "begins at 5,000; it must begin between -1,000 and 1,000",
    ),
    (&["--link", "#r=0.05"], "--link needs one"),
    (&["soak", "--samples", "0"], "0 is not in 1.."),
    (
        &["sample", "--radius", "0", "--out", "a.csv"],
        "the radius is 0",
    ),
    (&["sample", "--radius", "nan"], "NaN"),
    (
        &["sample", "--radius", "0.5"],
        "is 2 r long; it must be at least 10 r",
    ),
    (
        &["sample", "--radius", "0.01", "--leaf", "5"],
        "the leaf is 5 r",
    ),
    (&["sample", "--radius", "1e-9"], "at most 65,532 r"),
    (
        &[
            "sample",
            "--radius",
            "2e-5",
            "--engine",
            "sequential",
            "--leaf",
            "1e9",
        ],
        "at most 2e8",
    ),
    (&["sample", "--count", "3"], "must be between"),
    (&["sample", "--count", "99999999999"], "must be between"),
    (
        &["sample", "--radius", "0.01", "--pattern-side", "3"],
        "between 10 r and 2,000 r",
    ),
    (
        &["sample", "--radius", "0.01", "--pattern", "missing.csv"],
        "missing.csv",
    ),
    (
        &[
            "sample",
            "--radius",
            "0.01",
            "--pattern-boundary",
            "bounded",
            "--leaf",
            "60",
        ],
        "does not fit a bounded pattern",
    ),
    (
        &["sample", "--radius", "0.01", "--out", "a.zebra"],
        "the extension names no format",
    ),
    (
        &["sample", "--radius", "0.01", "--out", "no/such/a.csv"],
        "no such folder",
    ),
    (&["sample", "--radius", "0.01", "--seed", "-1"], "-1"),
    (
        &["sample", "--radius", "0.01", "--search", "3"],
        "[possible values: 4, 2]",
    ),
    (
        &[
            "sample",
            "--radius",
            "0.01",
            "--variant",
            "as-printed",
            "--insertion",
            "uniform",
        ],
        "staged",
    ),
    (&["verify", "missing.csv", "--radius", "0.1"], "missing.csv"),
    (&["verify", "bad.csv", "--radius", "0.1"], "zebra"),
    (
        &["verify", "empty.csv", "--radius", "0.1"],
        "empty.csv: CSV: the set has no points",
    ),
    (&["verify", "nan.csv", "--radius", "0.1"], "NaN"),
    (
        &["verify", "good.csv", "--radius", "-1"],
        "good.csv: the set has no verdict: the radius",
    ),
    (&["sample", "--radius", "-1"], "the radius is -1"),
    (
        &["sample", "--count", "100", "--width", "-1"],
        "the width is -1",
    ),
    (
        &["sample", "--count", "100", "--leaf", "nan"],
        "the leaf is NaN",
    ),
    (
        &["sample", "--count", "0", "--method", "reference"],
        "0 samples were asked for",
    ),
    (&["bench", "--samples", "0"], "0 samples were asked for"),
    (&["bench", "--leaf", "20", "5"], "the leaf is 5 r"),
    (
        &["draw", "good.csv", "a.png", "--window", "5", "5", "6", "6"],
        "outside the domain",
    ),
    (&["convert", "bad.csv", "b.npy"], "zebra"),
    (&["draw", "empty.csv", "a.png"], "no points"),
    (&["draw", "bad.csv", "a.gif"], ".png or .svg"),
    (
        &["draw", "nan.csv", "a.png", "--size", "0"],
        "between 16 and 32768",
    ),
    (&["bench", "--rounds", "0"], "--rounds is 0"),
];

#[test]
fn bad_input_names_the_value_and_the_limit_and_leaves_nothing() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("bad.csv"), "x,y\n0.5,zebra\n").unwrap();
    fs::write(folder.path().join("empty.csv"), "x,y\n").unwrap();
    fs::write(folder.path().join("nan.csv"), "x,y\n0.1,0.2\nNaN,0.5\n").unwrap();
    fs::write(folder.path().join("good.csv"), "x,y\n0.1,0.2\n0.7,0.5\n").unwrap();
    let before = names(folder.path());
    for (arguments, expected) in BAD {
        tilescope(&folder)
            .args(*arguments)
            .assert()
            .code(2)
            .stderr(contains(*expected));
    }
    assert_eq!(names(folder.path()), before, "nothing was written");
}

#[test]
fn an_existing_file_survives_a_failed_export() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("set.csv");
    fs::write(&path, "precious").unwrap();
    // The set is made and written; then its certificate cannot take the place of a folder.
    let obstacle = folder.path().join("set.csv.certificate.json");
    fs::create_dir(&obstacle).unwrap();
    fs::write(obstacle.join("inside"), "").unwrap();
    let before = names(folder.path());
    tilescope(&folder)
        .args(["sample", "--radius", "0.02", "--out", "set.csv"])
        .assert()
        .code(2)
        .stderr(contains("set.csv.certificate.json"));
    assert_eq!(fs::read_to_string(&path).unwrap(), "precious");
    assert_eq!(names(folder.path()), before);
}

/// If the reader of a pipe ends after the first lines, the program ends without an error.
#[cfg(unix)]
#[test]
fn a_closed_pipe_is_no_error() {
    let folder = tempdir().unwrap();
    let binary = assert_cmd::cargo::cargo_bin("tilescope");
    let mut child = std::process::Command::new(binary)
        .current_dir(folder.path())
        .args(["sample", "--radius", "0.02"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn a_saved_set_serves_as_a_pattern() {
    let folder = tempdir().unwrap();
    let pattern = [
        "sample",
        "--radius",
        "0.02",
        "--method",
        "reference",
        "--out",
        "pattern.npy",
    ];
    tilescope(&folder).args(pattern).assert().success();
    let run = json(
        &folder,
        &[
            "sample",
            "--radius",
            "0.01",
            "--leaf",
            "12",
            "--pattern",
            "pattern.npy",
            "--json",
        ],
        0,
    );
    assert_eq!(run["valid"], true);
    assert_eq!(run["parameters"]["pattern"]["file"], "pattern.npy");
    let kdrt = ["sample", "--radius", "0.02", "--out", "kdrt.ply"];
    tilescope(&folder).args(kdrt).assert().success();
    let run = json(
        &folder,
        &[
            "sample",
            "--radius",
            "0.01",
            "--pattern",
            "kdrt.ply",
            "--dihedral",
            "--json",
        ],
        0,
    );
    assert_eq!(run["valid"], true);
    fs::write(folder.path().join("two.csv"), "x,y\n0.1,0.1\n0.5,0.5\n").unwrap();
    tilescope(&folder)
        .args([
            "sample",
            "--radius",
            "0.01",
            "--pattern",
            "two.csv",
            "--pattern-radius",
            "0.05",
        ])
        .assert()
        .code(2)
        .stderr(contains("not maximal"));
}

#[test]
fn sets_of_others_are_verified_converted_and_drawn() {
    let folder = tempdir().unwrap();
    let rows: Vec<String> = (0..64)
        .map(|k| format!("{} {}", f64::from(k % 8) / 8.0, f64::from(k / 8) / 8.0))
        .collect();
    fs::write(
        folder.path().join("lattice.txt"),
        format!("64\n{}\n", rows.join("\n")),
    )
    .unwrap();
    let verified = json(
        &folder,
        &["verify", "lattice.txt", "--radius", "0.125", "--json"],
        0,
    );
    assert_eq!(verified["certificate"], false);
    json(
        &folder,
        &["verify", "lattice.txt", "--radius", "0.08", "--json"],
        1,
    );
    json(
        &folder,
        &["verify", "lattice.txt", "--radius", "0.13", "--json"],
        1,
    );
    tilescope(&folder)
        .args(["verify", "lattice.txt"])
        .assert()
        .code(2)
        .stderr(contains("--radius"));
    tilescope(&folder)
        .args(["convert", "lattice.txt", "lattice.ply"])
        .assert()
        .success();
    let again = json(&folder, &["verify", "lattice.ply", "--json"], 0);
    assert_eq!(again["radius"], 0.125);
    tilescope(&folder)
        .args(["draw", "lattice.ply", "lattice.svg"])
        .assert()
        .success();
    let svg = fs::read_to_string(folder.path().join("lattice.svg")).unwrap();
    assert!(svg.matches("<circle").count() >= 64);
}

#[test]
fn gaps_are_drawn_as_the_arcs_around_them() {
    let folder = tempdir().unwrap();
    // A lattice of spacing 1/8 covers with disks of 0.09, but not without its first sample.
    let rows = |first| {
        let rows =
            (first..64).map(|k| format!("{},{}", f64::from(k % 8) / 8.0, f64::from(k / 8) / 8.0));
        rows.collect::<Vec<String>>().join("\n")
    };
    fs::write(folder.path().join("whole.csv"), rows(0)).unwrap();
    fs::write(folder.path().join("hole.csv"), rows(1)).unwrap();
    let arcs = |file: &str| {
        let drawn = ["draw", file, "arcs.svg", "--radius", "0.09", "--gaps"];
        tilescope(&folder).args(drawn).assert().success();
        let svg = fs::read_to_string(folder.path().join("arcs.svg")).unwrap();
        svg.matches("<polyline").count()
    };
    assert_eq!(arcs("whole.csv"), 0);
    // Four neighbours of the missing sample and its copies at the other corners of the torus.
    assert!(arcs("hole.csv") >= 4);
    let refused = ["draw", "whole.csv", "arcs.svg", "--gaps"];
    tilescope(&folder)
        .args(refused)
        .assert()
        .code(2)
        .stderr(contains("--radius"));
}

#[test]
fn pictures_have_the_asked_size() {
    let folder = tempdir().unwrap();
    tilescope(&folder)
        .args(["sample", "--radius", "0.05", "--out", "set.ply"])
        .assert()
        .success();
    tilescope(&folder)
        .args([
            "draw", "set.ply", "set.png", "--size", "320", "--theme", "dark",
        ])
        .assert()
        .success();
    let bytes = fs::read(folder.path().join("set.png")).unwrap();
    assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
    assert_eq!(u32::from_be_bytes(bytes[16..20].try_into().unwrap()), 320);
}

/// Without a display the program runs the same session and explains how to open the window.
#[test]
fn without_a_display_the_default_session_runs_headless() {
    let folder = tempdir().unwrap();
    tilescope(&folder).assert().success().stdout(
        contains("There is no display")
            .and(contains("verdict        valid"))
            .and(contains("DISPLAY")),
    );
    let written = names(&folder.path().join("tilescope-out"));
    for name in [
        "set.csv",
        "set.csv.certificate.json",
        "1-blocks.png",
        "2-tile.png",
        "3-eliminate.png",
        "4-iterate-1.png",
    ] {
        assert!(written.iter().any(|w| w == name), "{name}: {written:?}");
    }
    assert!(
        written.iter().all(|name| !name.contains("tmp")),
        "{written:?}"
    );
    tilescope(&folder)
        .args(["verify", "tilescope-out/set.csv"])
        .assert()
        .success();
}

#[test]
fn help_has_examples_and_completions_are_printed() {
    let folder = tempdir().unwrap();
    tilescope(&folder)
        .arg("--help")
        .assert()
        .success()
        .stdout(contains("Examples:"));
    for command in ["sample", "verify", "convert", "draw", "bench", "gpu"] {
        tilescope(&folder)
            .args([command, "--help"])
            .assert()
            .success()
            .stdout(contains("Example"));
    }
    for shell in ["bash", "zsh", "fish", "powershell"] {
        tilescope(&folder)
            .args(["completions", shell])
            .assert()
            .success()
            .stdout(contains("tilescope"));
    }
}

#[test]
fn bench_verifies_what_it_times() {
    let folder = tempdir().unwrap();
    let bench = json(
        &folder,
        &[
            "bench",
            "--samples",
            "20000",
            "--rounds",
            "1",
            "--leaf",
            "30",
            "--threads",
            "1",
            "2",
            "--sequential",
            "--plane",
            "100000000",
            "--json",
        ],
        0,
    );
    for windows in ["windows", "exact_windows"] {
        assert_eq!(bench[windows]["valid"], true, "{windows}");
        let counts = bench[windows]["counts"].as_array().unwrap();
        assert!((9_500..10_500).contains(&counts[0].as_u64().unwrap()));
    }
    // Control: the windows are of one place, by two methods.
    assert_ne!(bench["windows"]["counts"], bench["exact_windows"]["counts"]);
    let rows = bench["rows"].as_array().unwrap();
    let engines: Vec<_> = rows.iter().map(|row| row["engine"].as_str()).collect();
    let expected = [
        "reference",
        "sequential",
        "parallel",
        "parallel",
        "exact",
        "exact",
    ];
    assert_eq!(engines, expected.map(Some));
    for (row, threads) in [(3, 2), (4, 1), (5, 2)] {
        assert_eq!(rows[row]["threads"], threads);
        assert!(rows[row]["ratio_to_one_thread"].as_f64().unwrap() > 0.0);
    }
    for row in rows {
        assert_eq!(row["valid"], true);
        let (nothing, seconds) = (&row["seconds_from_nothing"], &row["seconds"][0]);
        assert!(nothing.as_f64() >= seconds.as_f64());
        assert!(row["samples_per_second"].as_f64().unwrap() > 0.0);
        assert!((0.68..0.72).contains(&row["density"].as_f64().unwrap()));
    }
}

/// Ctrl-C leaves no incomplete file and no temporary one.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_nothing_behind() {
    let folder = tempdir().unwrap();
    let binary = assert_cmd::cargo::cargo_bin("tilescope");
    let child = std::process::Command::new(binary)
        .current_dir(folder.path())
        .args(["sample", "--radius", "0.0001", "--out", "big.npy"])
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // Seventy million samples take far longer than the signal needs; the handler is installed
    // before any work, and a signal that came earlier still would end the process without a file.
    std::thread::sleep(std::time::Duration::from_millis(300));
    let killed = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(killed.unwrap().success());
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    // Before the handler is installed the signal itself ends the process, which is as good.
    match output.status.code() {
        Some(code) => assert!(
            code == 130 && said.contains("interrupted"),
            "{code}: {said}"
        ),
        None => assert_eq!(said, ""),
    }
    assert_eq!(names(folder.path()), Vec::<String>::new());
}
