//! Engines, windows and sets written band by band, end to end: the real binary, real files, real interruptions.

use std::fs;
use std::process::{Command as Process, ExitStatus};

use crate::support::runs::{json, partial, paused, read, signal};
use crate::support::{names, tilescope};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// A set so large that it is written in several bands.
const LARGE: [&str; 7] = [
    "sample", "--count", "1300000", "--leaf", "40", "--seed", "5",
];

#[test]
fn engines_write_the_same_bytes() {
    let folder = tempdir().unwrap();
    for (k, options) in [
        vec![],
        vec!["--boundary", "bounded", "--order", "random", "--leaf", "11"],
        vec!["--insertion", "uniform", "--dihedral", "--order", "index"],
        vec![
            "--order",
            "phase-group",
            "--search",
            "2",
            "--pattern-side",
            "33",
        ],
    ]
    .into_iter()
    .enumerate()
    {
        // Whether engines agree does not depend on the format, so that one run has all of them.
        let extensions = ["ply", "json", "csv", "npy"];
        for extension in &extensions[..if k == 0 { 4 } else { 1 }] {
            // JSON files name themselves.
            let name = |engine: &str| format!("{engine}/{k}.{extension}");
            for engine in ["sequential", "parallel", "auto"] {
                let out = name(engine);
                fs::create_dir_all(folder.path().join(engine)).unwrap();
                let mut arguments = vec!["sample", "--radius", "0.012", "--seed", "3"];
                arguments.extend(["--engine", engine, "--threads", "3", "--out", &out]);
                arguments.extend(&options);
                tilescope(&folder).args(arguments).output().unwrap();
            }
            let bytes = read(&folder, &name("sequential"));
            assert!(bytes.len() > 30_000);
            assert!(
                bytes == read(&folder, &name("parallel")),
                "{options:?} {extension}"
            );
            assert!(
                bytes == read(&folder, &name("auto")),
                "{options:?} {extension}"
            );
        }
    }
}

#[test]
fn a_large_set_is_the_same_whoever_makes_it_and_verifies() {
    let folder = tempdir().unwrap();
    let with = |more: &[&'static str]| [LARGE.as_slice(), more].concat();
    let streamed = json(&folder, &with(&["--out", "streamed.npy"]));
    let whole = json(
        &folder,
        &with(&["--engine", "sequential", "--out", "whole.npy"]),
    );
    let unwritten = json(&folder, &with(&["--threads", "1"]));
    for key in [
        "count",
        "conflicts",
        "gaps",
        "min_distance_r",
        "covering_radius_r",
        "radius",
    ] {
        assert_eq!(streamed[key], whole[key], "{key}");
        assert_eq!(streamed[key], unwritten[key], "{key}");
    }
    for key in ["blocks", "tiled", "eliminated", "inserted"] {
        assert_eq!(streamed[key], whole[key], "{key}");
    }
    assert!(read(&folder, "streamed.npy") == read(&folder, "whole.npy"));
    let certificate = |name: &str| -> Value {
        serde_json::from_slice(&read(&folder, &format!("{name}.certificate.json"))).unwrap()
    };
    let (mut a, b) = (certificate("streamed.npy"), certificate("whole.npy"));
    assert_eq!(a["valid"], true);
    a["file"] = b["file"].clone();
    assert_eq!(a, b);
    let verified = json(&folder, &["verify", "streamed.npy"]);
    assert_eq!(verified["differences"], Value::Array(vec![]));
    // Negative control: one sample moved is a conflict and another digest.
    let path = folder.path().join("streamed.npy");
    let mut bytes = fs::read(&path).unwrap();
    let (from, to) = ((bytes.len() / 2) & !15, (bytes.len() / 2 + 16) & !15);
    let sample: Vec<u8> = bytes[from..from + 16].to_vec();
    bytes[to..to + 16].copy_from_slice(&sample);
    bytes[to] ^= 1;
    fs::write(&path, bytes).unwrap();
    let mut verify = tilescope(&folder);
    verify.args(["verify", "streamed.npy"]).assert().code(1);
}

#[test]
fn without_verification_there_is_no_certificate_and_the_file_is_the_same() {
    let folder = tempdir().unwrap();
    let base = ["sample", "--radius", "0.004", "--out"];
    let verified = json(&folder, &[base.as_slice(), &["a.npy"]].concat());
    let plain = json(
        &folder,
        &[base.as_slice(), &["b.npy", "--no-verify"]].concat(),
    );
    assert_eq!(plain["count"], verified["count"]);
    assert_eq!(plain["verified"], false);
    assert_eq!(plain["valid"], Value::Null);
    assert!(read(&folder, "a.npy") == read(&folder, "b.npy"));
    assert_eq!(
        names(folder.path()),
        ["a.npy", "a.npy.certificate.json", "b.npy"]
    );
}

/// Exact tilings are made band by band without a verdict, and as a whole with one. Controls: another seed makes another
/// file, and what cannot be made by bands cannot be resumed.
#[test]
fn an_exact_set_is_the_same_by_bands_and_as_a_whole() {
    let folder = tempdir().unwrap();
    let made = |seed: &str, more: &[&str]| {
        let words = "sample --method exact --radius 0.005 --leaf 12 --pattern-side 60 --seed";
        let words: Vec<&str> = words.split(' ').chain([seed]).collect();
        json(&folder, &[&words, more].concat())
    };
    let whole = made("5", &["--out", "whole.npy"]);
    let bands = made("5", &["--out", "bands.npy", "--no-verify"]);
    for key in ["count", "blocks", "tiled", "eliminated", "inserted"] {
        assert_eq!(whole[key], bands[key], "{key}");
    }
    assert!(read(&folder, "whole.npy") == read(&folder, "bands.npy"));
    made("6", &["--out", "other.npy", "--no-verify"]);
    assert!(read(&folder, "whole.npy") != read(&folder, "other.npy"));

    for (words, message) in [
        ("--radius 0.005", "there is nothing to resume"),
        (
            "--count 3000",
            "--resume with --method exact needs --radius",
        ),
    ] {
        let words = format!("sample --method exact {words} --out new.npy --resume");
        let mut command = tilescope(&folder);
        command.args(words.split(' '));
        command.assert().code(2).stderr(contains(message));
    }
}

/// An exact tiling that was killed goes on from its checkpoint to the file of a run that was not. Control: KDRT does not go on
/// with it.
#[test]
fn an_exact_set_that_was_killed_goes_on_by_its_method_alone() {
    let folder = tempdir().unwrap();
    let words = "sample --radius 0.002 --leaf 12 --pattern-side 60 --no-verify";
    let set: Vec<&str> = words.split(' ').collect();
    let exact = [&set[..], &["--method", "exact"]].concat();
    json(&folder, &[&exact[..], &["--out", "whole.npy"]].concat());
    let mut child = paused(&folder, &exact, "set.npy");
    signal(&child, "KILL");
    child.wait().unwrap();

    let resume = ["--out", "set.npy", "--resume"];
    let mut other = tilescope(&folder);
    other.args(&set).args(resume);
    let said = contains("it was by another --method");
    other.assert().code(2).stderr(said);
    json(&folder, &[&exact[..], &resume[..]].concat());
    assert!(read(&folder, "set.npy") == read(&folder, "whole.npy"));
}

/// Starts a large run and sends it a signal after its first checkpoint. Returns how it ended.
fn interrupted(folder: &TempDir, name: &str, kill: &str) -> ExitStatus {
    let mut child = paused(folder, &LARGE, name);
    signal(&child, kill);
    signal(&child, "CONT");
    let status = child.wait().unwrap();
    assert!(!status.success(), "{kill} did not stop the run");
    status
}

#[test]
fn what_was_killed_goes_on_to_the_same_file() {
    let folder = tempdir().unwrap();
    let whole = json(
        &folder,
        &[LARGE.as_slice(), &["--out", "whole.npy"]].concat(),
    );
    for (kill, name) in [
        ("KILL", "killed.npy"),
        ("INT", "stopped.npy"),
        ("TERM", "ended.npy"),
        ("HUP", "left.npy"),
    ] {
        let status = interrupted(&folder, name, kill);
        if kill != "KILL" {
            assert_eq!(status.code(), Some(130), "{kill}");
            assert!(!folder.path().join(format!("{name}.lock")).exists());
        }
        assert!(
            !folder.path().join(name).exists(),
            "{kill}: an unfinished file has the name"
        );
        assert!(partial(&folder, name).exists());
        let checkpoint = format!("{name}.resume.json");
        let kept = read(&folder, &checkpoint);
        let resume = [LARGE.as_slice(), &["--out", name, "--resume"]].concat();
        let resumed = json(&folder, &resume);
        for key in [
            "count",
            "blocks",
            "tiled",
            "eliminated",
            "inserted",
            "covering_radius_r",
        ] {
            assert_eq!(resumed[key], whole[key], "{kill}: {key}");
        }
        assert!(read(&folder, name) == read(&folder, "whole.npy"), "{kill}");
        assert!(!partial(&folder, name).exists());
        let verified = json(&folder, &["verify", name]);
        assert_eq!(verified["differences"], Value::Array(vec![]));
        // As if it had been killed once more, just before it removed its checkpoint.
        fs::write(folder.path().join(&checkpoint), kept).unwrap();
        fs::write(folder.path().join(format!("{name}.lock")), "").unwrap();
        assert_eq!(json(&folder, &resume)["count"], whole["count"]);
        let mut left = names(folder.path());
        left.retain(|left| left.starts_with(name));
        assert_eq!(left, [name.to_owned(), format!("{name}.certificate.json")]);
    }
}

#[test]
fn a_second_run_of_a_name_is_refused() {
    let folder = tempdir().unwrap();
    let mut first = paused(&folder, &LARGE, "set.npy");
    for more in [[].as_slice(), &["--resume"]] {
        let mut second = tilescope(&folder);
        second.args(LARGE).args(["--out", "set.npy"]).args(more);
        let said = contains("set.npy: this or another process is writing it");
        second.assert().code(2).stderr(said);
    }
    signal(&first, "TERM");
    signal(&first, "CONT");
    assert_eq!(first.wait().unwrap().code(), Some(130));
    assert!(partial(&folder, "set.npy").exists());
}

#[test]
fn a_resume_that_cannot_be_is_refused_and_nothing_is_lost() {
    let folder = tempdir().unwrap();
    let mut nothing = tilescope(&folder);
    nothing.args(LARGE).args(["--out", "set.npy", "--resume"]);
    nothing.assert().code(2).stderr(contains("set.npy"));
    interrupted(&folder, "set.npy", "KILL");
    let mut other = tilescope(&folder);
    other
        .args(LARGE)
        .args(["--order", "random", "--out", "set.npy", "--resume"]);
    other.assert().code(2).stderr(contains("order"));
    let mut unverified = tilescope(&folder);
    unverified
        .args(LARGE)
        .args(["--out", "set.npy", "--resume", "--no-verify"]);
    unverified
        .assert()
        .code(2)
        .stderr(contains("verified, without --no-verify"));
    assert!(partial(&folder, "set.npy").exists());
    // A byte of the unfinished file is wrong.
    let path = partial(&folder, "set.npy");
    let mut bytes = fs::read(&path).unwrap();
    bytes[5_000] ^= 1;
    fs::write(&path, &bytes).unwrap();
    let mut damaged = tilescope(&folder);
    damaged.args(LARGE).args(["--out", "set.npy", "--resume"]);
    damaged.assert().code(2).stderr(contains("set.npy.partial"));
    assert!(!folder.path().join("set.npy").exists());
}

#[test]
fn a_full_disk_leaves_no_file_and_keeps_the_old_one() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("set.npy"), b"old").unwrap();
    let binary = assert_cmd::cargo::cargo_bin("tilescope");
    // A limit on file sizes makes writes fail as a full disk does.
    let script = format!("ulimit -f 2000; exec '{}' \"$@\"", binary.display());
    let output = Process::new("sh")
        .current_dir(folder.path())
        .args(["-c", &script, "sh"])
        .args(LARGE)
        .args(["--out", "set.npy"])
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(errors.contains("set.npy"), "{errors}");
    assert_eq!(read(&folder, "set.npy"), b"old");
    assert_eq!(names(folder.path()), ["set.npy"]);
}

/// The address space of a process of [`limited`], in KiB: some 3 GB, which a small set is made in.
const ADDRESSES: u32 = 3_000_000;

/// Runs `tilescope sample` in a process that gets no more memory.
fn limited(folder: &TempDir, arguments: &[&str]) -> std::process::Output {
    let binary = assert_cmd::cargo::cargo_bin("tilescope");
    let script = format!(
        "ulimit -v {ADDRESSES}; exec '{}' sample --threads 2 \"$@\"",
        binary.display()
    );
    let mut shell = Process::new("sh");
    let shell = shell.current_dir(folder.path()).args(["-c", &script, "sh"]);
    shell.args(arguments).output().unwrap()
}

#[test]
fn a_whole_set_that_there_is_no_memory_for_is_refused() {
    let folder = tempdir().unwrap();
    for way in [
        // Other formats are written by the parallel engine without holding the set.
        ["--engine", "parallel", "--out", "set.json"],
        ["--engine", "sequential", "--out", "set.npy"],
        ["--method", "reference", "--out", "set.npy"],
        ["--levels", "4", "--out", "set.npy"],
    ] {
        let made = limited(&folder, &[&["--count", "20000"][..], &way[..]].concat());
        let errors = String::from_utf8_lossy(&made.stderr);
        assert_eq!(made.status.code(), Some(0), "{way:?}: {errors}");
        for file in names(folder.path()) {
            fs::remove_file(folder.path().join(file)).unwrap();
        }

        let refused = limited(&folder, &[&["--count", "60000000"][..], &way[..]].concat());
        let errors = String::from_utf8_lossy(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{way:?}: {errors}");
        assert!(
            errors.contains("GB of memory are needed"),
            "{way:?}: {errors}"
        );
        assert_eq!(names(folder.path()), [""; 0], "{way:?}");
    }
}

/// Returns the positions of a CSV file.
fn positions(folder: &TempDir, name: &str) -> Vec<[f64; 2]> {
    let text = String::from_utf8(read(folder, name)).unwrap();
    let number = |part: Option<&str>| part.unwrap().parse::<f64>().unwrap();
    text.lines()
        .skip(1)
        .map(|line| {
            let mut parts = line.split(',');
            [number(parts.next()), number(parts.next())]
        })
        .collect()
}

#[test]
fn a_window_holds_what_the_whole_set_has_there() {
    let folder = tempdir().unwrap();
    for boundary in ["periodic", "bounded"] {
        let base = [
            "sample",
            "--radius",
            "0.01",
            "--boundary",
            boundary,
            "--leaf",
            "9",
        ];
        json(
            &folder,
            &[base.as_slice(), &["--out", "whole.csv"]].concat(),
        );
        let whole = positions(&folder, "whole.csv");
        for window in [["0.2", "0.3", "0.7", "0.45"], ["0.9", "-0.1", "1.3", "0.2"]] {
            let mut arguments = [base.as_slice(), &["--window"], &window].concat();
            arguments.extend(["--out", "part.csv"]);
            let found = json(&folder, &arguments);
            assert_eq!(found["valid"], true, "{boundary} {window:?}");
            let [x0, y0, x1, y1] = window.map(|v| v.parse::<f64>().unwrap());
            let inside = |value: f64, low: f64, high: f64| {
                let images = if boundary == "periodic" {
                    -1..=1
                } else {
                    0..=0
                };
                images
                    .into_iter()
                    .any(|k| (low..high).contains(&(value + f64::from(k))))
            };
            let expected: Vec<[f64; 2]> = whole
                .iter()
                .copied()
                .filter(|p| inside(p[0], x0, x1) && inside(p[1], y0, y1))
                .collect();
            assert!(expected.len() > 100);
            assert_eq!(
                positions(&folder, "part.csv"),
                expected,
                "{boundary} {window:?}"
            );
        }
    }
}

#[test]
fn windows_that_meet_share_no_sample_and_miss_none() {
    let folder = tempdir().unwrap();
    let base = ["sample", "--radius", "0.02", "--boundary", "bounded"];
    json(
        &folder,
        &[base.as_slice(), &["--out", "whole.csv"]].concat(),
    );
    let mut found = Vec::new();
    for [low, high] in [["-1e-3", "0.5"], ["0.5", "1"]] {
        let window = ["--window", "0", low, "1", high, "--out", "part.csv"];
        json(&folder, &[base.as_slice(), &window].concat());
        found.extend(positions(&folder, "part.csv"));
    }
    let whole = positions(&folder, "whole.csv");
    assert!(
        whole.iter().any(|p| p[0] >= 1.0 || p[1] >= 1.0),
        "none on the border"
    );
    assert_eq!(found, whole);
    let mut text = tilescope(&folder);
    text.args(base).args(["--window", "0.5", "0", "1", "0.5"]);
    text.assert()
        .success()
        .stdout(contains("[0.5, 1] x [0, 0.5) of"));
}

#[test]
fn a_window_without_a_sample_makes_no_file() {
    let folder = tempdir().unwrap();
    let empty = [
        "sample", "--radius", "0.05", "--window", "0.5", "0.5", "0.5001", "0.5001",
    ];
    let found = json(&folder, &empty);
    assert_eq!(found["count"], 0);
    let mut command = tilescope(&folder);
    command.args(empty).args(["--out", "part.csv"]);
    let said = contains("part.csv: no sample lies in the window");
    command.assert().code(2).stderr(said);
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_window_of_a_huge_plane_comes_at_once() {
    let folder = tempdir().unwrap();
    let window = ["--window", "0.7", "0.2", "0.702", "0.202"];
    let base = ["sample", "--count", "2500000000", "--leaf", "40"];
    let found = json(&folder, &[base.as_slice(), &window].concat());
    let count = found["count"].as_u64().unwrap();
    assert!((9_000..11_000).contains(&count), "{count}");
    assert_eq!(found["valid"], true);
}

#[test]
fn what_cannot_be_is_refused_with_value_and_limit() {
    let folder = tempdir().unwrap();
    let base = ["sample", "--radius", "0.01"];
    for (more, message) in [
        (
            vec!["--threads", "0"],
            "--threads is 0; it must be between 1 and 1024",
        ),
        (
            vec!["--engine", "parallel", "--variant", "as-printed"],
            "needs the sequential engine",
        ),
        (vec!["--window", "0", "0", "nan", "1"], "NaN"),
        (vec!["--window", "0.5", "0", "0.5", "1"], "from 0.5 to 0.5"),
        (vec!["--window", "0", "0", "1.5", "1"], "at most 1 long"),
        (
            vec!["--window", "0", "0", "1", "1", "--engine", "sequential"],
            "--window needs the parallel",
        ),
        (vec!["--resume", "--out", "a.json"], "written band by band"),
        (
            vec!["--resume", "--engine", "sequential", "--out", "a.npy"],
            "needs the parallel engine",
        ),
    ] {
        let mut command = tilescope(&folder);
        command.args(base).args(&more);
        command.assert().code(2).stderr(contains(message));
    }
    let mut outside = tilescope(&folder);
    outside
        .args(base)
        .args(["--boundary", "bounded", "--window", "2", "0", "2.5", "1"]);
    outside.assert().code(2).stderr(contains(
        "from 2 to 2.5 and holds no place of the domain, 0 to 1",
    ));
    let mut wide = tilescope(&folder);
    wide.args([
        "sample", "--radius", "2e-5", "--window", "0", "0", "1", "0.5",
    ]);
    wide.assert().code(2).stderr(contains("the limit is 2e7"));
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_soak_compares_and_verifies() {
    let folder = tempdir().unwrap();
    let samples = tilescope_tests::cases(80_000);
    let asked = samples.to_string();
    let found = json(&folder, &["soak", "--samples", &asked, "--seed", "7"]);
    assert!(found["samples"].as_u64().unwrap() >= u64::from(samples));
    for key in ["conflicts", "gaps", "unequal"] {
        assert_eq!(found[key], 0, "{key}");
    }
    assert!(found["covering_radius_r"].as_f64().unwrap() > 1.0);

    let mut text = tilescope(&folder);
    text.args(["soak", "--samples", "1"]);
    text.assert()
        .success()
        .stdout(contains("as promised").and(contains("rounds")));
}

#[test]
fn a_soak_of_fields_and_shapes_compares_and_verifies() {
    let folder = tempdir().unwrap();
    let soak = |arguments: &[&str]| {
        let words = [&["soak", "--method", "varying", "--seed", "3"], arguments].concat();
        json(&folder, &words)
    };
    // Where few samples are asked for, few rounds are made.
    let few = soak(&["--samples", "500"]);
    assert!(few["rounds"].as_u64().unwrap() < 16 && few["samples"].as_u64().unwrap() >= 500);

    let found = soak(&["--samples", "15000"]);
    assert!(found["rounds"].as_u64() > few["rounds"].as_u64());
    assert!(found["samples"].as_u64().unwrap() >= 15_000);
    for key in ["conflicts", "gaps", "unequal", "failed"] {
        assert_eq!(found[key], 0, "{key}");
    }

    // A round can be made again alone.
    let [first, second] = ["0", "1"].map(|round| soak(&["--round", round]));
    assert_eq!(first["rounds"], 1);
    assert_ne!(first["samples"], second["samples"]);
    let sum = first["samples"].as_u64().unwrap() + second["samples"].as_u64().unwrap();
    assert!(sum < found["samples"].as_u64().unwrap());
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn a_soak_of_exact_tiling_compares_and_verifies() {
    let folder = tempdir().unwrap();
    let exact = json(
        &folder,
        &["soak", "--samples", "16000", "--method", "exact"],
    );
    for key in ["conflicts", "gaps", "unequal", "failed"] {
        assert_eq!(exact[key], 0, "{key}");
    }
}
