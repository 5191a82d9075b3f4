//! Windows of space without end, and sets in space beside others, end to end.

use std::fs;

use serde_json::json;
use tempfile::tempdir;

use crate::solid::{ends, refused, run};

/// Windows of space without end: judged, equal where they overlap, and refused by name.
#[test]
fn windows_of_space_are_made_judged_and_saved() {
    let folder = tempdir().unwrap();
    let whole = "sample --radius 1 --seed 7 --window -3 20.5 -2 3 24.5 2 --out a.csv";
    let made = run(&folder, whole, 0);
    assert_eq!((&made["valid"], &made["gaps"]), (&json!(true), &json!(0)));
    let part = "sample --radius 1 --seed 7 --window -1 21 -2 3 23 1.5 --out b.csv";
    let said = ends(&folder, part, 0);
    assert!(
        said.contains("of space without end, r = 1") && said.contains("verdict        valid"),
        "{said}"
    );

    // The part has the rows of the whole that lie in it, in the same order.
    let rows = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let (whole, part) = (rows("a.csv"), rows("b.csv"));
    let inside = |row: &&str| {
        let values: Vec<f64> = row
            .split(',')
            .filter_map(|value| value.parse().ok())
            .collect();
        matches!(values[..], [x, y, z, _level] if x >= -1.0 && (21.0..23.0).contains(&y) && z < 1.5)
    };
    let expected: Vec<&str> = whole.lines().filter(inside).collect();
    assert!(expected.len() > 15 && whole.lines().count() > expected.len() + 10);
    assert_eq!(part.lines().skip(1).collect::<Vec<_>>(), expected);
    assert!(!folder.path().join("b.csv.certificate.json").exists());

    for (line, wanted) in [
        (
            "--window 0 0 0 5 5",
            "four numbers, or six in space; 5 are given",
        ),
        (
            "--window 0 0 0 5 5 5 --size 9x9x9",
            "--size: --window of six numbers is a part of space",
        ),
        (
            "--window 0 0 0 5 5 5 --width 9",
            "--width: --window of six numbers makes a set in space",
        ),
        (
            "--window 0 0 0 5 5 5 --leaf 20",
            "--leaf: --window of six numbers",
        ),
        (
            "--window 0 0 0 5 0 5",
            "the window's height runs from 0 to 0",
        ),
        (
            "--window 0 0 0 5 5 7e4",
            "it must lie between -65,280 and 65,280",
        ),
        (
            "--window 0 0 0 5 5 5 --out a.bin",
            "positions in a unit cube",
        ),
        ("--window 0 0 0 5 5 5 --out a.svg", "a picture is planar"),
        (
            "--window 0 0 0 1e4 1e4 1e4",
            "samples lie in the window and within 2 r of it",
        ),
        // It is thin, and what is judged with it is not.
        ("--window 0 0 0 6e3 6e3 1e-3", "about 1.05"),
    ] {
        refused(&folder, &format!("sample --radius 1 {line}"), wanted);
    }
    refused(
        &folder,
        "sample --count 100 --window 0 0 0 1 1 1",
        "give --radius",
    );
}

/// Differences from a set or from an average, and controls: a set does not differ from itself, and random points do.
#[test]
fn sets_in_space_are_compared_with_others() {
    let folder = tempdir().unwrap();
    for seed in 1..=2 {
        let line = format!("sample --size 8x8x8 --radius 1 --seed {seed} --out {seed}.ply");
        ends(&folder, &line, 0);
    }
    let same = &run(&folder, "analyze 1.ply --against 1.ply", 0)["files"][0]["differences"];
    for field in [
        "samples",
        "power_difference_rms",
        "pair_correlation_difference_rms",
    ] {
        assert_eq!(same[field], json!(0.0), "{field}");
    }

    // Sets of one law: the bands of powers hold most differences. Those of random points hold few.
    let found = run(&folder, "analyze 1.ply --against 2.ply", 0);
    let of = &found["files"][0];
    assert_eq!(found["against"]["file"], json!("2.ply"));
    assert!(
        of["differences"]["power_difference_outside"]
            .as_f64()
            .unwrap()
            < 25.0,
        "{of}"
    );
    assert!(of["curves_of_differences"]["power_difference"]["lower"].is_array());
    let points = (0..376_u32).map(|at| {
        let along = |step: f64| {
            (f64::from(at) * step + (f64::from(at) * 12.9898).sin() * 43_758.545).rem_euclid(8.0)
        };
        format!(
            "{},{},{}\n",
            along(0.618_034),
            along(37.414_214),
            along(91.732_051)
        )
    });
    let table = "x,y,z\n".to_owned() + &points.collect::<String>();
    fs::write(folder.path().join("random.csv"), table).unwrap();
    let line = "analyze random.csv --radius 1 --width 8 --height 8 --depth 8 --against 2.ply";
    let random = &run(&folder, line, 0)["files"][0]["differences"];
    assert!(
        random["power_difference_outside"].as_f64().unwrap() > 25.0,
        "{random}"
    );
    assert!(random["conflicts"].as_f64().unwrap() > 100.0);
}

/// Averages and reports of differences.
#[test]
fn differences_in_space_are_averaged_and_reported() {
    let folder = tempdir().unwrap();
    for seed in 1..=4 {
        let line = format!("sample --size 6x6x6 --radius 1 --seed {seed} --out {seed}.ply");
        ends(&folder, &line, 0);
    }

    let average = run(
        &folder,
        "analyze --average 1.ply 2.ply --against 3.ply 4.ply",
        0,
    );
    assert!(average["average"]["standard_errors_of_differences"]["density"].is_number());
    let text = ends(
        &folder,
        "analyze 1.ply --against 3.ply 4.ply --out a.html",
        0,
    );
    assert!(
        text.contains("less mean of 2") && text.contains("radial mean power: RMS difference"),
        "{text}"
    );
    let page = fs::read_to_string(folder.path().join("a.html")).unwrap();
    assert!(page.contains("Differences") && page.contains("Difference of pair correlation"));
    ends(&folder, "analyze 1.ply --against 2.ply --out a.csv", 0);
    let csv = fs::read_to_string(folder.path().join("a.csv")).unwrap();
    assert!(
        csv.contains("1.ply,power_difference_rms,,") && csv.contains("2.ply,power,"),
        "{csv}"
    );
    refused(
        &folder,
        "analyze 1.ply --against none.ply --depth 8",
        "--against",
    );
}
