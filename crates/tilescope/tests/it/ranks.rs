//! Ranks of nested levels, end to end: written, verified, spoilt, kept below a threshold and below a painted one, and in windows.

use std::fs;
use std::path::Path;

use png::ColorType;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::support::{image, tilescope};

/// Runs the program and returns its one JSON object.
fn json(folder: &TempDir, arguments: &[&str], code: i32) -> Value {
    serde_json::from_str(&run(folder, arguments, code)).expect("one JSON object")
}

/// Runs the program and returns what it prints; if it fails, its error.
fn run(folder: &TempDir, arguments: &[&str], code: i32) -> String {
    let assert = tilescope(folder).args(arguments).assert().code(code);
    let output = assert.get_output();
    let said = if code == 2 {
        &output.stderr
    } else {
        &output.stdout
    };
    String::from_utf8_lossy(said).into_owned()
}

/// The rows of a table without its head, each as numbers.
fn rows(folder: &TempDir, name: &str) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(folder.path().join(name)).unwrap();
    let row = |line: &str| {
        line.split(',')
            .map(|number| number.parse().unwrap())
            .collect()
    };
    text.lines().skip(1).map(row).collect()
}

#[test]
fn ranks_are_verified_and_faults_in_them_are_found() {
    let folder = tempdir().unwrap();
    let ask = [
        "sample", "--radius", "0.02", "--levels", "4", "--json", "--out",
    ];
    let made = json(&folder, &[&ask[..], &["set.csv"]].concat(), 0);
    let of_level = |level: usize| made["levels"][level]["count"].as_u64().unwrap();
    let verified = |file: &str, below: &str, code: i32| {
        json(&folder, &["verify", file, "--rank", below, "--json"], code)
    };

    // At the threshold of a level the samples are that level, which is maximal.
    for (level, below) in ["0.125", "0.25", "0.5", "1"].into_iter().enumerate() {
        let found = verified("set.csv", below, 0);
        assert_eq!(found["count"], of_level(level), "{found}");
        assert_eq!(found["covering"], found["distance"], "{found}");
    }
    // Between two they cover as the coarser one, and below the first they promise nothing of that.
    let found = verified("set.csv", "0.3", 0);
    assert!(
        found["covering"].as_f64() > found["distance"].as_f64(),
        "{found}"
    );
    assert_eq!(verified("set.csv", "0.05", 0)["covering"], Value::Null);

    // Every format with columns keeps the ranks to the bit, and one without has none.
    for file in ["set.ply", "set.geojson", "again.csv"] {
        run(&folder, &["convert", "set.csv", file], 0);
        assert_eq!(verified(file, "0.3", 0)["count"], found["count"], "{file}");
    }
    assert_eq!(rows(&folder, "again.csv"), rows(&folder, "set.csv"));
    run(&folder, &["convert", "set.csv", "set.npy"], 0);
    let refused = run(&folder, &["verify", "set.npy", "--rank", "0.3"], 2);
    assert!(refused.contains("it has no column rank"), "{refused}");

    // A sample of the first level that comes late leaves a gap, one of the last that comes early is in conflict.
    let text = fs::read_to_string(folder.path().join("set.csv")).unwrap();
    for (row, rank) in [(1, "0.9"), (text.lines().count() - 1, "0.001")] {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let (before, _) = lines[row].rsplit_once(',').unwrap();
        lines[row] = format!("{before},{rank}");
        fs::write(folder.path().join("set.csv"), lines.join("\n") + "\n").unwrap();
        let found = verified("set.csv", "0.125", 1);
        assert_eq!(
            (&found["misplaced_ranks"], &found["valid"]),
            (&json!(1), &json!(false))
        );
    }
}

#[test]
fn a_stated_level_that_the_file_does_not_have_is_a_difference() {
    let folder = tempdir().unwrap();
    let ask = [
        "sample", "--radius", "0.05", "--levels", "2", "--out", "set.csv", "--json",
    ];
    json(&folder, &ask, 0);
    let differences =
        |code| json(&folder, &["verify", "set.csv", "--json"], code)["differences"].clone();
    assert_eq!(differences(0), json!([]));

    // The level has all measures of the last one, so that its count alone is wrong.
    let path = folder.path().join("set.csv.certificate.json");
    let mut stated: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    let levels = stated["levels"].as_array_mut().unwrap();
    let mut beyond = levels[1].clone();
    beyond["count"] = json!(beyond["count"].as_u64().unwrap() + 1);
    levels.insert(1, beyond);
    fs::write(&path, stated.to_string()).unwrap();
    let found = differences(1);
    assert_eq!(found[0]["field"], "levels", "{found}");
    assert_eq!(found[0]["stated"], "3 levels", "{found}");
}

#[test]
fn samples_are_kept_by_their_ranks() {
    let folder = tempdir().unwrap();
    let ask = [
        "sample", "--radius", "0.02", "--levels", "4", "--out", "set.csv", "--json",
    ];
    json(&folder, &ask, 0);
    let all = rows(&folder, "set.csv");

    // Below a constant they are a set of fewer levels, with ranks up to 1 again.
    run(
        &folder,
        &["convert", "set.csv", "third.csv", "--rank", "0.3"],
        0,
    );
    let found = json(&folder, &["verify", "third.csv", "--json"], 0);
    let below = all.iter().filter(|row| row[3] < 0.3).count();
    assert_eq!(
        (&found["count"], &found["differences"]),
        (&json!(below), &json!([]))
    );
    let kept = rows(&folder, "third.csv");
    let doubled = |row: &Vec<f64>| vec![row[0], row[1], row[2], 2.0 * row[3]];
    assert_eq!(kept, all[..below].iter().map(doubled).collect::<Vec<_>>());
    json(
        &folder,
        &["verify", "third.csv", "--rank", "0.5", "--json"],
        0,
    );

    let refusals: [(&[&str], &str); 5] = [
        (&["--rank", "0"], "--rank is 0; it must be above 0"),
        (&["--rank", "1.5"], "--rank is 1.5"),
        (&["--rank", "0.1"], "hold no whole level"),
        // Another domain would have other levels, and a set with ranks has no shape: neither is left aside in silence.
        (
            &["--rank", "0.3", "--width", "2"],
            "--width is that of the certificate, to which its levels belong; leave it out",
        ),
        (
            &["--rank", "0.3", "--mask", "no.png"],
            "--mask: sets with ranks have one radius and no shape",
        ),
    ];
    for (arguments, reason) in refusals {
        let refused = run(
            &folder,
            &[&["convert", "set.csv", "no.csv"][..], arguments].concat(),
            2,
        );
        assert!(refused.contains(reason), "{refused}");
    }
    let ask = ["verify", "set.csv", "--rank", "0.3", "--height", "2"];
    let refused = run(&folder, &ask, 2);
    assert!(refused.contains("--height is that of"), "{refused}");
}

#[test]
fn samples_are_kept_by_the_darkness_of_an_image() {
    let folder = tempdir().unwrap();
    let ask = [
        "sample", "--radius", "0.02", "--levels", "4", "--out", "set.csv", "--json",
    ];
    let made = json(&folder, &ask, 0);
    let all = rows(&folder, "set.csv");

    // The darkness of an image is a threshold of its own at each place: the left half keeps a quarter.
    let grey = |column: u8| if column < 4 { 191 } else { 0 };
    image(
        &folder,
        "dark.png",
        [8, 1],
        ColorType::Grayscale,
        &(0..8).map(grey).collect::<Vec<u8>>(),
    );
    let said = run(
        &folder,
        &[
            "convert",
            "set.csv",
            "painted.csv",
            "--rank-image",
            "dark.png",
        ],
        0,
    );
    assert!(said.contains("it has no certificate"), "{said}");
    let dark = |row: &Vec<f64>| if row[0] < 0.5 { 64.0 / 255.0 } else { 1.0 };
    let painted: Vec<Vec<f64>> = all
        .iter()
        .filter(|row| row[3] < dark(row))
        .cloned()
        .collect();
    assert_eq!(rows(&folder, "painted.csv"), painted);
    assert!(painted.len() < made["count"].as_u64().unwrap() as usize);
    assert!(!folder.path().join("painted.csv.certificate.json").exists());
}

/// The picture in README.md is what its commands make, for whoever has the repository.
#[test]
fn the_commands_of_the_readme_make_its_picture() {
    const README: &str = include_str!("../../../../README.md");
    const SPIRAL: &str = "assets/pictures/spiral.png";
    let folder = tempdir().unwrap();
    let pictures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/pictures");
    fs::create_dir_all(folder.path().join("assets/pictures")).unwrap();
    fs::copy(pictures.join("spiral.png"), folder.path().join(SPIRAL)).unwrap();

    let mentions = |line: &&str| {
        ["levels.csv", "painted.csv"]
            .iter()
            .any(|name| line.contains(name))
    };
    let commands: Vec<&str> = README.lines().filter(mentions).collect();
    assert_eq!(commands.len(), 4, "{commands:?}");
    for command in commands {
        let arguments: Vec<&str> = command.split(' ').skip(1).collect();
        run(&folder, &arguments, 0);
    }

    let made = fs::read(folder.path().join("painted.png")).unwrap();
    assert!(made == fs::read(pictures.join("ranks.png")).unwrap());
    let kept = rows(&folder, "painted.csv").len();
    let all = rows(&folder, "levels.csv").len();
    let [kept, all] = [kept, all].map(|count| format!("{},{:03}", count / 1000, count % 1000));
    assert!(
        README.contains(&format!("![{kept} of {all} samples")),
        "{kept} {all}"
    );
}

#[test]
fn a_window_of_levels_has_the_ranks_of_the_whole() {
    let folder = tempdir().unwrap();
    let ask = [
        "sample", "--radius", "0.01", "--levels", "3", "--leaf", "40", "--json", "--out",
    ];
    json(&folder, &[&ask[..], &["whole.csv"]].concat(), 0);
    let window = ["part.csv", "--window", "0.2", "0.3", "0.5", "0.45"];
    let part = json(&folder, &[&ask[..], &window].concat(), 0);
    assert_eq!(
        (&part["valid"], part["levels"].as_array().map(Vec::len)),
        (&json!(true), Some(3))
    );

    let shown = |row: &Vec<f64>| (0.2..0.5).contains(&row[0]) && (0.3..0.45).contains(&row[1]);
    let whole: Vec<Vec<f64>> = rows(&folder, "whole.csv")
        .into_iter()
        .filter(shown)
        .collect();
    assert_eq!(rows(&folder, "part.csv"), whole);

    let farthest = [
        "no.csv",
        "--window",
        "0",
        "0",
        "1",
        "1",
        "--order-within",
        "farthest",
    ];
    let refused = run(&folder, &[&ask[..], &farthest].concat(), 2);
    assert!(
        refused.contains("--order-within farthest needs the whole set"),
        "{refused}"
    );
}
