//! Windows of sets whose radius varies, and of sets that cover shapes: their files beside those of the whole sets.

use std::fs;

use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::varying::{image, park, refused, run};

/// Returns the lines of a table that lie in a window.
fn rows_in(folder: &TempDir, name: &str, [left, bottom, right, top]: [f64; 4]) -> Vec<String> {
    let text = fs::read_to_string(folder.path().join(name)).unwrap();
    let is_inside = |line: &&str| {
        let mut numbers = line
            .split(',')
            .filter_map(|number| number.parse::<f64>().ok());
        let [x, y] = [(); 2].map(|()| numbers.next().expect("a number"));
        (left..right).contains(&x) && (bottom..top).contains(&y)
    };
    let rows = text.lines().skip(1).filter(is_inside);
    rows.map(str::to_owned).collect()
}

/// Makes a set and a window of it, and compares their tables. Returns what was said of the window.
fn compared(folder: &TempDir, line: &str, corners: [f64; 4]) -> Value {
    let window = corners.map(|corner| corner.to_string()).join(" ");
    run(
        folder,
        &format!("sample {line} --seed 3 --out whole.csv --json"),
        0,
    );
    let part = format!("sample {line} --seed 3 --window {window} --out part.csv --json");
    let made = run(folder, &part, 0);
    let expected = rows_in(folder, "whole.csv", corners);
    let everywhere = [-1e9, -1e9, 1e9, 1e9];
    assert!(expected.len() > 10, "{}", expected.len());
    assert_eq!(rows_in(folder, "part.csv", everywhere), expected);
    assert_eq!(
        (
            &made["count"],
            &made["valid"],
            &made["gaps"],
            &made["conflicts"]
        ),
        (&json!(expected.len()), &json!(true), &json!(0), &json!(0))
    );

    // A part of a set has no certificate, and another seed makes another set.
    let certificate = folder.path().join("part.csv.certificate.json");
    assert!(!certificate.exists());
    let other = part.replace("--seed 3", "--seed 4");
    assert_ne!(
        run(folder, &other, 0)["positions_digest"],
        made["positions_digest"]
    );
    made
}

#[test]
fn windows_have_the_rows_of_the_whole() {
    let folder = tempdir().unwrap();
    let ramp = "--radius-expression 0.01+0.04*x+0.005*sin(9*y)";
    let made = compared(&folder, ramp, [0.2, 0.3, 0.7, 0.75]);
    assert_eq!(
        (&made["method"], &made["window"]),
        (&json!("reference"), &json!([0.2, 0.3, 0.7, 0.75]))
    );

    image(&folder, "grey.png", [48, 32], |x, y| x * (1.0 - y));
    let field = "--radius-image grey.png --radius 0.01..0.08 --boundary periodic";
    compared(&folder, field, [0.0, 0.1, 0.9, 0.4]);
    compared(
        &folder,
        "--density-image grey.png --radius 0.006",
        [0.1, 0.1, 0.6, 0.5],
    );

    park(&folder);
    let corners = [500_003.0, 5_400_002.0, 500_041.0, 5_400_027.0];
    let trees = "--shape park.geojson --radius 1.5";
    compared(&folder, trees, corners);
    let tiled = compared(
        &folder,
        &format!("{trees} --method exact --pattern-side 40"),
        corners,
    );
    assert_eq!(tiled["method"], json!("exact"));
    let both = "--shape park.geojson --radius-expression 0.5+0.02*(x-500000)";
    compared(&folder, both, corners);
}

/// Over the border of a periodic domain a window shows the samples of the other side, with the places that they have there.
#[test]
fn windows_over_the_border_and_outside_of_shapes_are_made() {
    let folder = tempdir().unwrap();
    let field =
        "--radius-expression 0.04+0.01*sin(6.283185307179586*x) --boundary periodic --seed 2";
    run(
        &folder,
        &format!("sample {field} --out whole.csv --json"),
        0,
    );
    let line = format!("sample {field} --window 0.75 0.5 1.25 0.75 --json");
    let rows = [[0.75, 0.5, 1.0, 0.75], [0.0, 0.5, 0.25, 0.75]];
    let expected: usize = rows
        .map(|part| rows_in(&folder, "whole.csv", part).len())
        .iter()
        .sum();
    let made = run(&folder, &line, 0);
    assert_eq!(
        (&made["count"], &made["valid"]),
        (&json!(expected), &json!(true))
    );

    // In the pond there is nothing to cover.
    park(&folder);
    let pond = "sample --shape park.geojson --radius 1.5 --window 500027 5400014 500029 5400016";
    let made = run(&folder, &format!("{pond} --json"), 0);
    assert_eq!((&made["count"], &made["valid"]), (&json!(0), &json!(true)));
    refused(
        &folder,
        &format!("{pond} --out part.csv"),
        "no sample lies in the window",
    );
    assert!(!folder.path().join("part.csv").exists());
}

#[test]
fn windows_that_cannot_be_made_are_refused_by_name() {
    let folder = tempdir().unwrap();
    park(&folder);
    let ramp = "sample --radius-expression 0.01+0.04*x";
    for (line, wanted) in [
        (
            "--window 0 0 0.5 0.5 --count 500",
            "--count and --exactly would make the whole set",
        ),
        (
            "--window 0 0 0.5 0.5 --exactly 500",
            "--count and --exactly would make the whole set",
        ),
        (
            "--window 2 0 2.5 0.5",
            "holds no place of the domain, 0 to 1",
        ),
        ("--window 0 0 0.5 1.5", "at most 1 long"),
        (
            "--window 0 0 0.5 0.5 --judge circles",
            "subdivision judges such sets",
        ),
        ("--window 0 0 0.5 0.5 --method kdrt", "--method kdrt"),
        ("--window 0 0 0.5 0.5 --levels 3", "--levels"),
    ] {
        refused(&folder, &format!("{ramp} {line}"), wanted);
    }
    // Corners are named in the coordinates of the shape.
    let away = "sample --shape park.geojson --radius 1 --window 0 0 1 1";
    refused(&folder, away, "500000 to 500060");
    // The number of samples in a shape is only bounded; the control is a field without one.
    let large = "sample --shape park.geojson --radius 0.001 --window 500000 5400000 500040 5400040";
    refused(
        &folder,
        large,
        "in the window, if the shape covers all of it; the limit",
    );
    let all = "sample --radius-expression 0.00004+0*x --window 0 0 1 1";
    refused(&folder, all, "samples lie in the window; the limit");
    let origin = "sample --radius 0.05 --origin 5 5 --window 0 0 1 1";
    refused(&folder, origin, "--origin");
}

/// The whole would have hundreds of millions of samples, which no computer that builds this makes here.
#[test]
fn a_set_too_large_for_the_memory_has_windows() {
    let folder = tempdir().unwrap();
    let line = "sample --radius-expression 4e-5+1e-5*x --window 0.5 0.5 0.503 0.503 --json";
    let made = run(&folder, line, 0);
    assert_eq!(made["valid"], json!(true));
    assert!(
        (2_700..3_500).contains(&made["count"].as_u64().unwrap()),
        "{}",
        made["count"]
    );
}
