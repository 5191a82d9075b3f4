//! `tilescope curve`: numbers of a run over its events.

use std::fs;

use crate::support::{analysis, names, tilescope};
use crate::varying::park;
use predicates::str::contains;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// Runs the command and returns its header and its rows.
fn table(folder: &TempDir, arguments: &[&str]) -> (String, Vec<Vec<String>>) {
    let mut command = tilescope(folder);
    let assert = command.arg("curve").args(arguments).assert().success();
    let text = String::from_utf8(assert.get_output().stdout.clone()).unwrap();
    rows(&text)
}

fn rows(text: &str) -> (String, Vec<Vec<String>>) {
    let mut lines = text.lines();
    let header = lines.next().unwrap().to_owned();
    let cells = |line: &str| line.split(',').map(str::to_owned).collect();
    (header, lines.map(cells).collect())
}

/// Returns the numbers of `tilescope analyze` of the set that the same arguments make.
fn analyzed(folder: &TempDir, arguments: &[&str]) -> Value {
    tilescope(folder)
        .arg("sample")
        .args(arguments)
        .args(["--out", "set.csv"])
        .assert()
        .success();
    analysis::json(folder, &["set.csv"], 0)["files"][0].clone()
}

#[test]
fn the_last_row_is_what_analyze_says_of_the_set() {
    let folder = tempdir().unwrap();
    let runs = [
        &["--radius", "0.03", "--seed", "3"][..],
        &[
            "--radius",
            "0.04",
            "--boundary",
            "bounded",
            "--insertion",
            "uniform",
        ],
        &["--count", "700", "--method", "reference"],
        &["--radius", "0.03", "--levels", "3"],
    ];
    for run in runs {
        let keys = "samples,density,packing,conflicts,gaps,min_distance_r,covering_radius_r,\
            relative_radius,peak,low_power,anisotropy,spectral_slope";
        let asked = [run, &["--numbers", keys, "--moments", "4"]].concat();
        let (header, rows) = table(&folder, &asked);
        assert_eq!(header, format!("event,stage,{keys}"));
        assert_eq!(rows.len(), 4);
        let numbers = analyzed(&folder, run);
        for (key, cell) in keys.split(',').zip(&rows[3][2..]) {
            let expected = numbers[key].as_f64();
            let found: Option<f64> = cell.parse().ok();
            let is_near = |(found, expected): (f64, f64)| {
                (found - expected).abs() <= 1e-3 * expected.abs().max(1.0)
            };
            let pair = found.zip(expected);
            assert!(
                pair.is_some_and(is_near) || found.is_none() && expected.is_none(),
                "{run:?} {key}: {found:?} {expected:?}"
            );
        }
    }
}

#[test]
fn the_last_row_of_a_shape_or_a_field_is_the_verdict_on_the_set() {
    let folder = tempdir().unwrap();
    park(&folder);
    let of_shape = "samples,density,conflicts,gaps,min_distance_r,relative_radius";
    let of_field = "samples,density,conflicts,gaps";
    let shape = ["--shape", "park.geojson", "--radius", "1.5", "--seed", "4"];
    let tiled = ["--method", "exact", "--leaf", "8", "--pattern-side", "30"];
    let field = ["--radius-expression", "0.02 + 0.03*x"];
    let both = ["--radius-expression", "1 + 0.01*(x - 500000)"];
    for (run, keys) in [
        (shape.to_vec(), of_shape),
        ([&shape[..], &tiled].concat(), of_shape),
        (field.to_vec(), of_field),
        ([&both[..], &shape[..2]].concat(), of_field),
    ] {
        let asked = [&run[..], &["--numbers", keys, "--moments", "5"]].concat();
        let (header, rows) = table(&folder, &asked);
        assert_eq!(header, format!("event,stage,{keys}"));
        let mut making = tilescope(&folder);
        let made = making.arg("sample").args(&run).arg("--json").assert();
        let verdict: Value = serde_json::from_slice(&made.success().get_output().stdout).unwrap();
        for (key, cell) in keys.split(',').zip(&rows[4][2..]) {
            let name = if key == "samples" { "count" } else { key };
            let found: f64 = cell.parse().unwrap();
            let expected = verdict[name].as_f64().unwrap();
            let is_near = (found - expected).abs() <= 1e-5 * expected.abs();
            assert!(is_near, "{run:?} {key}: {found} {expected}");
        }
        // A maximal set has about 0.70 for the area that is covered, and more where much of it is border.
        let density: f64 = rows[4][3].parse().unwrap();
        assert!((0.66..0.85).contains(&density), "{run:?} {density}");
        // The control: the run before its end has another number of samples.
        assert_ne!(rows[2][2], rows[4][2]);
    }

    let refused = |arguments: &[&str], said: &str| {
        let mut command = tilescope(&folder);
        let refusal = command.arg("curve").args(arguments).assert().code(2);
        refusal.stdout("").stderr(contains(said));
    };
    let with = |more: &[&'static str]| [&shape[..], more].concat();
    refused(
        &with(&["--numbers", "covering_radius_r"]),
        "is not followed in a shape",
    );
    refused(
        &[&field[..], &["--numbers", "relative_radius"]].concat(),
        "is not followed where the radius varies",
    );
    refused(&with(&["--method", "kdrt"]), "--method kdrt: --shape");
    refused(&with(&["--levels", "3"]), "--levels: --shape");
    refused(&with(&["--depth", "9"]), "--shape: --depth makes");
    refused(
        &["--shape", "park.geojson", "--exactly", "90"],
        "--exactly: moments of a field",
    );
    refused(
        &["--radius", "0.1", "--origin", "1", "2"],
        "--origin: numbers of a run",
    );
}

#[test]
fn a_row_follows_each_change_and_the_file_is_what_is_printed() {
    let folder = tempdir().unwrap();
    let run = ["--radius", "0.05", "--numbers", "samples,conflicts,gaps"];
    let (header, printed) = table(&folder, &run);
    assert_eq!(header, "event,stage,samples,conflicts,gaps");
    assert_eq!(printed[0], ["0", "pattern", "0", "", ""]);
    let count = |row: &Vec<String>| row[2].parse::<i64>().unwrap();
    let inner = &printed[..printed.len() - 1];
    assert!(
        inner
            .windows(2)
            .all(|pair| count(&pair[0]).abs_diff(count(&pair[1])) == 1)
    );
    let last = printed.last().unwrap();
    assert_eq!(
        (last[1].as_str(), &last[3..]),
        ("finish", &["0".to_owned(), "0".to_owned()][..])
    );

    let mut command = tilescope(&folder);
    let saving = command.arg("curve").args(run).args(["--out", "run.csv"]);
    saving.assert().success().stdout("");
    assert_eq!(
        names(folder.path()),
        ["run.csv"],
        "no temporary file is left"
    );
    let saved = fs::read_to_string(folder.path().join("run.csv")).unwrap();
    assert_eq!(rows(&saved), (header, printed));

    // Without numbers, all that need no spectrum.
    let (header, _) = table(&folder, &["--radius", "0.1"]);
    assert!(
        header.starts_with("event,stage,samples,radius,density"),
        "{header}"
    );
    assert!(
        !header.contains("peak") && !header.contains("mean_sides"),
        "{header}"
    );
}

#[test]
fn what_cannot_be_had_is_refused_before_a_run_is_made() {
    let folder = tempdir().unwrap();
    let refused = |arguments: &[&str], said: &str| {
        tilescope(&folder)
            .arg("curve")
            .args(arguments)
            .assert()
            .code(2)
            .stdout("")
            .stderr(contains(said));
    };
    let run = ["--radius", "0.05"];
    let with = |more: &[&'static str]| [&run[..], more].concat();
    refused(
        &with(&["--numbers", "conflict"]),
        "there is no number \"conflict\"; those",
    );
    refused(&with(&["--numbers", "mean_sides"]), "covering_radius_r");
    refused(&with(&["--numbers", "gaps,gaps"]), "named twice");
    refused(&with(&["--moments", "1"]), "at least 2 are needed");
    refused(&with(&["--out", "no/run.csv"]), "there is no such folder");
    refused(
        &with(&["--levels", "3", "--method", "reference"]),
        "make one set",
    );
    refused(&[], "required");
    refused(&["--radius", "0.0001"], "2000000");
    refused(&["--count", "30000", "--numbers", "peak"], "20000");
    refused(&with(&["--session", "a.json"]), "cannot be used with");
    refused(
        &["--session", "a.json", "--seed", "2"],
        "cannot be used with",
    );
    refused(&["--session", "a.json"], "a.json");
    fs::write(folder.path().join("a.json"), "{}").unwrap();
    refused(
        &["--session", "a.json"],
        "a.json: this is not a saved session",
    );
    refused(
        &["--session", "a.json", "--out", "a.json"],
        "over this input",
    );
    assert_eq!(names(folder.path()), ["a.json"]);
}
