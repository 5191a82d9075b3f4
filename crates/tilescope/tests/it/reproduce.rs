//! `tilescope reproduce` end to end: all experiments in their quick form, what they leave behind, how they go on, and what is refused.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::support::{names, tilescope};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

const EXPERIMENTS: [&str; 8] = [
    "fig10",
    "fig11",
    "fig12",
    "fig13",
    "iterations",
    "eq4",
    "search",
    "uniformity",
];

fn reproduced(folder: &TempDir, experiments: &[&str]) -> Value {
    let mut command = tilescope(folder);
    command.arg("reproduce").args(experiments);
    command.args(["--quick", "--out", "out", "--json"]);
    let output = command.assert().success().get_output().clone();
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

/// Files of a folder and when they were written.
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
    let kept = "kept from an earlier run";
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
fn a_plan_says_how_long_it_takes_and_leaves_nothing() {
    let folder = tempdir().unwrap();
    let mut command = tilescope(&folder);
    command.args(["reproduce", "all", "--plan"]);
    let told = command.assert().success().get_output().stdout.clone();
    let told = String::from_utf8(told).unwrap();
    assert!(told.starts_with("expected on this machine: "));
    for name in EXPERIMENTS {
        assert!(told.contains(name), "{told}");
    }
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn what_cannot_be_used_is_named_before_anything_is_made() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("out"), "a file").unwrap();
    fs::write(folder.path().join("two.csv"), "x,y\n0.1,0.1\n0.5,0.5\n").unwrap();
    let far = format!("x,y\n0.1,0.1\n{}", "0.5,7.5\n".repeat(20));
    fs::write(folder.path().join("far.csv"), far).unwrap();
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
        &["fig10", "--quick", "--file", "none.csv", "--out", "d"],
        "none.csv",
    );
    refused(
        &["fig10", "--quick", "--file", "two.csv", "--out", "d"],
        "2 samples are too few",
    );
    refused(
        &["fig10", "--quick", "--file", "far.csv", "--out", "d"],
        "is not inside its domain",
    );
    assert!(!folder.path().join("d").exists());
    let kept = fs::read_to_string(folder.path().join("out")).unwrap();
    assert!(predicate::eq("a file").eval(kept.as_str()));
}

/// A set in the unit square: rows of as many samples.
fn grid(along: u32) -> String {
    let at = |index: u32| (f64::from(index) + 0.5) / f64::from(along);
    let lines = (0..along * along).map(|i| format!("{},{}\n", at(i % along), at(i / along)));
    format!("x,y\n{}", lines.collect::<String>())
}

#[test]
fn files_that_can_be_used_are_whatever_the_others_are_and_can_be_told_apart() {
    let folder = tempdir().unwrap();
    for (name, along) in [("a", 30), ("b", 40), ("few", 20)] {
        fs::create_dir(folder.path().join(name)).unwrap();
        fs::write(folder.path().join(name).join("set.csv"), grid(along)).unwrap();
    }
    let mut command = tilescope(&folder);
    command.args(["reproduce", "fig10", "--quick", "--out", "out", "--json"]);
    command.args(["--boundary", "bounded"]);
    for file in ["a/set.csv", "none.csv", "few/set.csv", "b/set.csv"] {
        command.args(["--file", file]);
    }
    let refused = contains("error: none.csv").and(contains("400 samples are too few to compare"));
    let output = command
        .assert()
        .code(2)
        .stderr(refused)
        .get_output()
        .clone();
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    let left_out: Vec<&str> = (told["left_out"].as_array().unwrap().iter())
        .map(|one| one["file"].as_str().unwrap())
        .collect();
    assert_eq!(left_out, ["none.csv", "few/set.csv"]);
    let verdicts = String::from_utf8(output.stderr).unwrap();
    assert!(verdicts.contains("reproduced (quick)"), "{verdicts}");
    let text = fs::read_to_string(folder.path().join("out/REPORT.md")).unwrap();
    assert!(text.contains("a/set.csv: ") && text.contains("b/set.csv: "));
    // The command that is told makes it again.
    let (_, rest) = text.split_once("Command: `").unwrap();
    let (line, _) = rest.split_once('`').unwrap();
    assert_eq!(
        line,
        "tilescope reproduce fig10 --quick --seed 1 --file 'a/set.csv' --file 'b/set.csv' --boundary bounded --out DIR"
    );
    let words = line.split(' ').skip(1).map(|word| word.trim_matches('\''));
    let mut again = tilescope(&folder);
    again.args(words.map(|word| if word == "DIR" { "out" } else { word }));
    again.arg("--plan").assert().success();
    again.assert().stdout(contains("kept from an earlier run"));
}

#[test]
fn files_that_nothing_can_be_said_of_are_refused_before_anything_is_made() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("grid.csv"), grid(30)).unwrap();
    fs::write(folder.path().join("few.csv"), grid(20)).unwrap();
    let same = format!("x,y\n{}", "0.5,0.5\n".repeat(100));
    fs::write(folder.path().join("same.csv"), same).unwrap();
    let refused = |file: &str, domain: &[&str], why: &str| {
        let mut command = tilescope(&folder);
        command.args(["reproduce", "fig10", "--quick", "--out", "d", "--file"]);
        command.arg(file).args(domain);
        command.assert().code(2).stderr(contains(why));
    };
    refused("grid.csv", &["--width", "inf"], "the region inf x 1 is not");
    refused("grid.csv", &["--height", "-1"], "the region 1 x -1 is not");
    let far = ["--width", "1e9", "--height", "1e9"];
    refused("grid.csv", &far, "less than 0.5 of the domain's 1000000000");
    refused("same.csv", &[], "all 100 samples are at the one place");
    refused("few.csv", &[], "400 samples are too few to compare");
    assert!(!folder.path().join("d").exists());
}
