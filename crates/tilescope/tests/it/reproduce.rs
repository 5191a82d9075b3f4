//! `tilescope reproduce` end to end: all experiments in their quick form, the files that they leave, continued runs,
//! and refused arguments.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::support::{names, tilescope};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

const EXPERIMENTS: [&str; 12] = [
    "fig10",
    "fig11",
    "fig12",
    "fig13",
    "iterations",
    "eq4",
    "search",
    "uniformity",
    "density",
    "varying",
    "stippling",
    "space",
];

fn reproduced(folder: &TempDir, experiments: &[&str]) -> Value {
    let mut command = tilescope(folder);
    command.arg("reproduce").args(experiments);
    command.args(["--quick", "--out", "out", "--json"]);
    let output = command.assert().success().get_output().clone();
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

/// The files of a folder with the times when they were written.
fn written(folder: &Path) -> BTreeMap<PathBuf, SystemTime> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    entries
        .map(|entry| (entry.path(), entry.metadata().unwrap().modified().unwrap()))
        .collect()
}

/// Every CSV has rows of as many cells as its head, and numbers in them.
fn check_table(path: &Path) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let columns = lines.next().unwrap().split(',').count();
    let rows: Vec<&str> = lines.collect();
    assert!(!rows.is_empty(), "{} has no row", path.display());
    let plain = rows.iter().filter(|row| !row.contains('"'));
    for row in plain {
        assert_eq!(row.split(',').count(), columns, "{}: {row}", path.display());
    }
    let number = |cell: &str| cell.parse::<f64>().is_ok_and(f64::is_finite);
    assert!(
        rows.iter().any(|row| row.split(',').any(number)),
        "{}",
        path.display()
    );
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn all_experiments_in_their_quick_form_leave_a_whole_report() {
    let folder = tempdir().unwrap();
    let told = reproduced(&folder, &["all"]);
    let out = folder.path().join("out");
    let names: Vec<&str> = (told["experiments"].as_array().unwrap().iter())
        .map(|one| one["experiment"].as_str().unwrap())
        .collect();
    assert_eq!(names, EXPERIMENTS);
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    let text = fs::read_to_string(out.join("REPORT.md")).unwrap();
    let mut claims = 0;
    let mut beyond = 0;
    for one in told["experiments"].as_array().unwrap() {
        let name = one["experiment"].as_str().unwrap();
        let of = |key: &str| one[key].as_array().unwrap().clone();
        assert!(!of("claims").is_empty(), "{name} says nothing of the paper");
        assert!(!of("tables").is_empty(), "{name} has no numbers");
        assert!(!of("pictures").is_empty(), "{name} has no picture");
        for claim in of("claims") {
            claims += 1;
            beyond += u64::from(claim["place"] == "beyond the paper");
            for key in ["claim", "place", "paper", "ours", "reason"] {
                assert!(!claim[key].as_str().unwrap().is_empty(), "{name}: {key}");
            }
        }
        for picture in of("pictures") {
            let file = format!("{name}-{}", picture[0].as_str().unwrap());
            let png = fs::read(out.join("figures").join(format!("{file}.png"))).unwrap();
            assert!(png.starts_with(b"\x89PNG"));
            let svg = fs::read_to_string(out.join("figures").join(format!("{file}.svg"))).unwrap();
            assert!(svg.contains("</svg>"));
            assert!(text.contains(&format!("figures/{file}.png")));
        }
        for table in of("tables") {
            let file = format!("{name}-{}.csv", table["name"].as_str().unwrap());
            check_table(&out.join("data").join(file));
        }
        let command = format!("tilescope reproduce {name} --quick --seed 1");
        assert!(page.contains(&command) && text.contains(&command));
    }
    let verdicts = ["reproduced", "not_reproduced", "not_comparable"];
    let counted: u64 = verdicts.iter().map(|key| told[key].as_u64().unwrap()).sum();
    assert_eq!(counted, claims - beyond, "only what the paper says counts");
    // The page needs nothing from elsewhere.
    assert!(!page.contains("src=\"http") && !page.contains("<link") && !page.contains("<script"));
    assert!(!page.contains("The picture is missing"));
}

#[test]
fn what_was_finished_is_kept_and_only_that_which_is_missing_is_made() {
    let folder = tempdir().unwrap();
    let first = reproduced(&folder, &["eq4"]);
    let parts = folder.path().join("out/parts/eq4");
    let before = written(&parts);
    assert!(before.len() > 2);
    assert_eq!(reproduced(&folder, &["eq4"]), first);
    assert_eq!(written(&parts), before);
    let plan = |more: &[&str]| {
        let mut command = tilescope(&folder);
        command.args(["reproduce", "eq4", "--quick", "--out", "out", "--plan"]);
        let told = command.args(more).assert().success().get_output().clone();
        String::from_utf8(told.stdout).unwrap()
    };
    let kept = ", 9 kept from an earlier run";
    assert!(plan(&[]).contains(kept) && !plan(&["--fresh"]).contains(kept));
    assert!(!plan(&["--seed", "2"]).contains(kept));
    // As after an interruption and a full disk: one part is gone, one is cut short.
    let mut names = before.keys();
    let (gone, short) = (names.next().unwrap(), names.next().unwrap());
    fs::remove_file(gone).unwrap();
    let bytes = fs::read(short).unwrap();
    fs::write(short, &bytes[..bytes.len() / 2]).unwrap();
    assert_eq!(reproduced(&folder, &["eq4"]), first);
    let after = written(&parts);
    let changed: Vec<&PathBuf> = before
        .keys()
        .filter(|path| after[*path] != before[*path])
        .collect();
    assert_eq!(changed, [gone, short]);
}

#[test]
fn another_seed_and_another_number_of_threads_are_another_experiment() {
    let folder = tempdir().unwrap();
    let told = |arguments: &[&str]| -> Value {
        let mut command = tilescope(&folder);
        command.args(["reproduce", "fig12", "--quick", "--out", "out", "--json"]);
        let output = command
            .args(arguments)
            .assert()
            .success()
            .get_output()
            .clone();
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let row = |told: &Value| told["experiments"][0]["tables"][0]["rows"][0].clone();
    let first = told(&["--threads", "1"]);
    assert_eq!(told(&["--threads", "1"]), first, "times are kept, too");
    let two = told(&["--threads", "2"]);
    assert_ne!(
        row(&two),
        row(&first),
        "times of one thread are not those of two"
    );
    assert_eq!(row(&two)[1], row(&first)[1], "one seed, one set");
    assert_ne!(
        row(&told(&["--threads", "2", "--seed", "2"]))[1],
        row(&two)[1]
    );
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn detectors_in_stages_that_look_2r_far_leave_gaps_and_4r_far_none() {
    let folder = tempdir().unwrap();
    let told = reproduced(&folder, &["search"]);
    let table = folder.path().join("out/data/search-sets.csv");
    let text = fs::read_to_string(table).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|key| *key == name).unwrap();
    let (variant, near, far) = (column("variant"), column("gaps_2r"), column("gaps_4r"));
    let gaps = |row: &Vec<&str>, at: usize| row[at].parse::<u64>().unwrap();
    let staged = rows[1..]
        .iter()
        .filter(|row| row[variant].contains("stages"));
    assert!(staged.map(|row| gaps(row, near)).sum::<u64>() > 0);
    assert_eq!(rows[1..].iter().map(|row| gaps(row, far)).sum::<u64>(), 0);
    let claims = told["experiments"][0]["claims"].as_array().unwrap();
    let refuted = |claim: &&Value| claim["verdict"] == "not-reproduced";
    let refuted: Vec<&Value> = claims.iter().filter(refuted).collect();
    assert_eq!(refuted.len(), 1, "{claims:?}");
    assert!(refuted[0]["claim"].as_str().unwrap().contains('2'));
}

#[test]
fn a_plan_counts_the_units_and_leaves_nothing() {
    let folder = tempdir().unwrap();
    let mut command = tilescope(&folder);
    command.args(["reproduce", "all", "--plan"]);
    let told = command.assert().success().get_output().stdout.clone();
    let told = String::from_utf8(told).unwrap();
    assert!(told.starts_with("units of work: "));
    for name in EXPERIMENTS {
        assert!(told.contains(name), "{told}");
    }
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn what_cannot_be_used_is_named_before_anything_is_made() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("out"), "a file").unwrap();
    let refused = |arguments: &[&str], why: &str| {
        let mut command = tilescope(&folder);
        command.arg("reproduce").args(arguments);
        command.assert().code(2).stderr(contains(why));
    };
    refused(&["fig9", "--out", "d"], "fig9 is no experiment");
    refused(
        &["fig12", "--quick", "--out", "out"],
        "--out names a folder",
    );
    refused(&["fig12"], "--out");
    refused(
        &["fig12", "density", "--kept", "--out", "d"],
        "--kept is for density alone",
    );
    assert!(!folder.path().join("d").exists());
    let kept = fs::read_to_string(folder.path().join("out")).unwrap();
    assert!(predicate::eq("a file").eval(kept.as_str()));
}
