//! `tilescope analyze` of many sets: averages with their bands, groups held against each other, names, pictures
//! of all of them, windows of frequencies.

use crate::support;
use std::fmt::Write;
use std::fs;

use crate::support::analysis::{json, number, write};
use crate::support::tilescope;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

fn sample(folder: &TempDir, arguments: &[&str], out: &str) {
    tilescope(folder)
        .arg("sample")
        .args(arguments)
        .args(["--out", out])
        .assert()
        .success();
}

/// Returns a folder with sets `s1.npy` and on, of the reference sampler and about 1000 samples.
fn sets(count: u64) -> (TempDir, Vec<String>) {
    let folder = tempdir().unwrap();
    let names: Vec<String> = (1..=count).map(|seed| format!("s{seed}.npy")).collect();
    for (seed, name) in (1..).zip(&names) {
        let seed = u64::to_string(&seed);
        let arguments = ["--count", "1000", "--method", "reference", "--seed", &seed];
        sample(&folder, &arguments, name);
    }
    (folder, names)
}

/// Returns independent uniform samples.
fn noise(count: u32) -> String {
    let mut state = 5_u64;
    let mut draw = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut text = "x,y\n".to_owned();
    for _ in 0..count {
        let _ = writeln!(text, "{},{}", draw(), draw());
    }
    text
}

fn with<'a>(before: &[&'a str], names: &'a [String]) -> Vec<&'a str> {
    let names = names.iter().map(String::as_str);
    before.iter().copied().chain(names).collect()
}

fn column(value: &Value, curve: &str, name: &str) -> Vec<f64> {
    let values = value["curves"][curve][name].as_array().unwrap();
    values.iter().map(number).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn an_average_is_the_mean_of_its_files_with_their_spread() {
    let (folder, names) = sets(5);
    let apart = json(&folder, &with(&[], &names), 0);
    let together = json(&folder, &with(&["--average"], &names), 0);
    assert_eq!(apart["average"], Value::Null);
    let (each, average) = (apart["files"].as_array().unwrap(), &together["average"]);
    assert_eq!(average["sets"], 5);
    for key in ["samples", "density", "bond_order", "star_discrepancy"] {
        let values: Vec<f64> = each.iter().map(|file| number(&file[key])).collect();
        let measure = |what: &str| number(&average["measures"][key][what]);
        let truth = mean(&values);
        let squares: f64 = values.iter().map(|value| (value - truth).powi(2)).sum();
        assert!((measure("mean") / truth - 1.0).abs() < 1e-12, "{key}");
        let error = (squares / 20.0).sqrt();
        assert!(
            (measure("standard_error") / error - 1.0).abs() < 1e-9,
            "{key}"
        );
        assert!(values.contains(&measure("least")) && values.contains(&measure("most")));
        assert!(measure("least") < measure("mean") && measure("mean") < measure("most"));
        assert!(measure("lower") < truth - error && truth + error < measure("upper"));
    }
    let pairs = column(average, "pair_correlation", "y");
    for (index, g) in pairs.iter().enumerate() {
        let values: Vec<f64> = (each.iter())
            .map(|file| column(file, "pair_correlation", "y")[index])
            .collect();
        assert!((g - mean(&values)).abs() < 1e-9, "{index}");
    }
    assert_eq!(each[0]["curves"]["pair_correlation"]["lower"], Value::Null);
    assert!(column(average, "pair_correlation", "lower")[150] < pairs[150]);
    // The files' numbers are kept, their curves are not.
    assert_eq!(together["files"][3]["density"], each[3]["density"]);
    assert_eq!(together["files"][3]["curves"], Value::Null);
}

/// Both follow from the number of sets: those of one set would be others.
#[test]
fn the_level_of_anisotropy_and_the_bands_are_those_of_so_many_sets() {
    let (folder, names) = sets(5);
    let one = json(&folder, &[&names[0]], 0)["files"][0].clone();
    let five = json(&folder, &with(&["--average"], &names), 0)["average"].clone();
    let level = |value: &Value| mean(&column(value, "anisotropy_db", "y")[20..]);
    assert!((level(&five) + 10.0 * 5f64.log10()).abs() < 1.0);
    assert!(level(&one).abs() < 1.0);
    let width = |value: &Value| {
        let [lower, upper] = ["lower", "upper"].map(|end| column(value, "power", end)[40]);
        upper - lower
    };
    assert!(width(&five) < 0.6 * width(&one));
    tilescope(&folder)
        .args(["analyze", "--average", "--out", "a.svg"])
        .args(&names)
        .assert()
        .success()
        .stdout(contains("average of 5 sets").and(contains("standard error")));
    let svg = fs::read_to_string(folder.path().join("a.svg")).unwrap();
    assert!(svg.contains("K = 5 sets") && !svg.contains("K = 1 set"));
}

#[test]
fn sets_that_are_not_of_the_first_ones_kind_stay_out_of_an_average() {
    let (folder, names) = sets(3);
    sample(
        &folder,
        &["--count", "1000", "--boundary", "bounded"],
        "bounded.npy",
    );
    sample(&folder, &["--count", "1500"], "many.npy");
    write(&folder, "nan.csv", "x,y\n0.1,0.1\nnan,0.6\n0.3,0.9\n");
    let right = json(&folder, &with(&["--average"], &names), 0);
    let odd = [
        ("bounded.npy", "is not that of s1.npy"),
        ("many.npy", "are not within 10 % of the"),
        ("nan.csv", "NaN"),
        ("missing.npy", "missing.npy"),
        ("./s1.npy", "./s1.npy is the file s1.npy again"),
        ("s2.npy", "s2.npy is given more than once"),
    ];
    for (name, reason) in odd {
        let last = if name == "s2.npy" { 3 } else { 2 };
        let mut arguments = with(&["--average"], &names[..last]);
        arguments.extend([name, "s3.npy"]);
        arguments.dedup();
        if last == 3 {
            arguments.pop();
        }
        let found = json(&folder, &arguments, 2);
        assert_eq!(found["average"], right["average"], "{name}");
        assert_eq!(found["failures"].as_array().unwrap().len(), 1, "{name}");
        let told = found["failures"][0]["reason"].as_str().unwrap();
        assert!(told.contains(reason), "{told}");
    }
    let nothing = json(&folder, &["--average", "missing.npy"], 2);
    assert_eq!(nothing["average"], Value::Null);
}

#[test]
fn equal_groups_differ_within_the_band_and_noise_beyond_it() {
    let (folder, names) = sets(8);
    let against: Vec<String> = (names[4..].iter())
        .map(|name| format!("--against={name}"))
        .collect();
    let mut arguments = with(&["--average"], &names[..4]);
    arguments.extend(against.iter().map(String::as_str));
    let found = json(&folder, &arguments, 0);
    assert_eq!(found["against"]["sets"], 4);
    assert_eq!(found["against"]["files"][0]["file"], "s5.npy");
    let differences = &found["average"]["differences"];
    let outside = |differences: &Value| {
        [
            "power_difference_outside",
            "pair_correlation_difference_outside",
        ]
        .map(|key| number(&differences[key]))
    };
    assert!(
        outside(differences).iter().all(|share| *share < 15.0),
        "{differences}"
    );
    let curve = |name: &str| {
        let values = &found["average"]["curves_of_differences"]["power_difference"][name];
        let values = values.as_array().unwrap();
        values.iter().map(number).collect::<Vec<f64>>()
    };
    let [lower, y, upper] = ["lower", "y", "upper"].map(curve);
    assert!(lower.iter().all(|low| *low < 0.0) && upper.iter().all(|high| *high > 0.0));
    let rms = (mean(&y.iter().map(|y| y * y).collect::<Vec<f64>>())).sqrt();
    let told = number(&differences["power_difference_rms"]);
    assert!((told / rms - 1.0).abs() < 1e-9);
    let largest = y.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
    let told = number(&differences["power_difference_largest"]).abs();
    assert!((told - largest).abs() < 1e-12);
    // Noise is no such set, and has spectra and pairs of its own.
    write(&folder, "noise.csv", &noise(1000));
    let mut arguments = vec!["noise.csv"];
    arguments.extend(against.iter().map(String::as_str));
    let found = json(&folder, &arguments, 0);
    let shares = outside(&found["files"][0]["differences"]);
    assert!(shares[0] > 50.0 && shares[1] > 20.0, "{shares:?}");
}

#[test]
fn a_page_has_all_periodograms_and_a_picture_says_what_it_lacks() {
    let (folder, names) = sets(14);
    let report = |names: &[String], out: &str| {
        let mut command = tilescope(&folder);
        command.arg("analyze").args(names).args(["--out", out]);
        let output = command.assert().success().get_output().clone();
        let text = fs::read_to_string(folder.path().join(out)).unwrap();
        (text, String::from_utf8(output.stderr).unwrap())
    };
    let pictures = |text: &str| text.matches("Periodogram, ").count();
    let (page, errors) = report(&names, "all.html");
    assert_eq!((pictures(&page), errors.as_str()), (14, ""));
    let (svg, errors) = report(&names, "some.svg");
    assert_eq!(pictures(&svg), 12);
    assert!(svg.contains("2 of 14 periodograms are left out"));
    assert!(
        errors.contains("2 of 14 periodograms are left out"),
        "{errors}"
    );
    let (svg, errors) = report(&names[..12], "twelve.svg");
    assert_eq!((pictures(&svg), errors.as_str()), (12, ""));
    assert!(!svg.contains("left out"));
    // Several pictures on one page must not take each other's clips.
    let ids: Vec<&str> = page.split(" id=\"").skip(1).collect();
    let ids: Vec<&str> = ids
        .iter()
        .map(|rest| rest.split('"').next().unwrap())
        .collect();
    let mut once = ids.clone();
    once.sort_unstable();
    once.dedup();
    assert_eq!(once.len(), ids.len());
    for rest in page.split("url(#").skip(1) {
        assert!(ids.contains(&rest.split(')').next().unwrap()));
    }
}

#[test]
fn equal_names_are_told_apart_and_a_file_given_twice_is_told() {
    let (folder, names) = sets(2);
    for place in ["a", "b"] {
        fs::create_dir(folder.path().join(place)).unwrap();
        let from = folder.path().join(&names[usize::from(place == "b")]);
        fs::copy(from, folder.path().join(place).join("x.npy")).unwrap();
    }
    let labels = |arguments: &[&str]| -> Vec<String> {
        let found = json(&folder, arguments, 0);
        let files = found["files"].as_array().unwrap();
        let labels = files.iter().map(|file| file["label"].as_str().unwrap());
        labels.map(str::to_owned).collect()
    };
    assert_eq!(labels(&["a/x.npy", "b/x.npy"]), ["a/x.npy", "b/x.npy"]);
    assert_eq!(labels(&["a/x.npy", "s2.npy"]), ["x.npy", "s2.npy"]);
    assert_eq!(labels(&["s1.npy", "s1.npy"]), ["s1.npy", "s1.npy (2)"]);
    let notes = |arguments: &[&str]| json(&folder, arguments, 0)["notes"].to_string();
    assert!(notes(&["s1.npy", "s1.npy"]).contains("s1.npy is given more than once"));
    assert!(notes(&["s1.npy", "--against", "./s1.npy"]).contains("both sides"));
    assert_eq!(notes(&["s1.npy", "s2.npy"]), "[]");
}

#[test]
fn frequencies_beyond_memory_are_refused_with_value_and_limit() {
    let (folder, names) = sets(1);
    let last = |arguments: &[&str]| {
        let found = json(&folder, arguments, 0);
        *column(&found["files"][0], "power", "x").last().unwrap()
    };
    let name = names[0].as_str();
    assert!((last(&[name]) - 2.5).abs() < 0.1);
    assert!((last(&[name, "--frequencies", "1"]) - 1.0).abs() < 0.1);
    let notes = |arguments: &[&str]| json(&folder, arguments, 0)["notes"].to_string();
    // The long side of an oblong domain has many cycles, the short one few.
    sample(
        &folder,
        &["--count", "8000", "--width", "30"],
        "s1.npy-long.csv",
    );
    assert_eq!(notes(&["s1.npy-long.csv"]), "[]");
    assert_eq!(notes(&[name]), "[]");
    let refused = json(&folder, &[name, "--frequencies", "200"], 2);
    let reason = refused["failures"][0]["reason"].as_str().unwrap();
    for part in ["needs", "where 4294967296 are allowed"] {
        assert!(reason.contains(part), "{reason}");
    }
    for bad in ["0", "-1", "nan", "inf", "1e9", "5000"] {
        tilescope(&folder)
            .args(["analyze", name, "--frequencies", bad, "--out", "r.html"])
            .assert()
            .code(2)
            .stdout("")
            .stderr(contains("--frequencies"));
    }
    let left = support::names(folder.path());
    assert!(
        left.iter().all(|file| file.starts_with("s1.npy")),
        "{left:?}"
    );
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn a_note_says_where_the_spectrum_of_a_large_set_ends() {
    let (folder, _) = sets(0);
    // More memory than is taken unasked.
    sample(&folder, &["--count", "1600000"], "large.npy");
    let notes = json(&folder, &["large.npy"], 0)["notes"].to_string();
    assert!(notes.contains("1023 cycles along a side"), "{notes}");
}
