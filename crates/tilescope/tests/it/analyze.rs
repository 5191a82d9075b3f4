//! `tilescope analyze` end to end: two sets of the program's own, files that cannot be used, every kind of report.

use std::fs;

use crate::support::analysis::{json, number, write};
use crate::support::{names, tilescope};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// Returns a folder with a set of KDRT and one of the reference sampler.
fn two_sets() -> TempDir {
    two_sets_of("3000")
}

fn two_sets_of(count: &str) -> TempDir {
    let folder = tempdir().unwrap();
    for (name, method) in [("kdrt.csv", "kdrt"), ("reference.npy", "reference")] {
        tilescope(&folder)
            .args(["sample", "--count", count, "--method", method])
            .args(["--out", name])
            .assert()
            .success();
    }
    folder
}

#[test]
fn maximal_sets_have_the_numbers_of_maximal_sets() {
    let folder = two_sets();
    let found = json(&folder, &["kdrt.csv", "reference.npy"], 0);
    let files = found["files"].as_array().unwrap();
    assert_eq!(files.len(), 2);
    for file in files {
        let within = |key: &str, low: f64, high: f64| {
            let value = number(&file[key]);
            assert!((low..=high).contains(&value), "{key}: {value}");
        };
        within("samples", 2970.0, 3030.0);
        within("density", 0.69, 0.71);
        within("relative_radius", 0.77, 0.79);
        within("min_distance_r", 1.0, 1.01);
        within("covering_radius_r", 0.9, 1.0 + 1.0 / 32768.0);
        within("effective_nyquist", 0.64, 0.68);
        within("effective_nyquist_psa", 0.64, 0.68);
        within("oscillation", 1.4, 1.7);
        within("mean_sides", 5.99, 6.01);
        within("star_discrepancy", 1e-4, 0.01);
        assert_eq!((&file["valid"], &file["gaps"]), (&true.into(), &0.0.into()));
        let name = file["file"].as_str().unwrap();
        let format = if name == "kdrt.csv" {
            "CSV"
        } else {
            "NumPy array"
        };
        assert_eq!(file["format"], format, "{name}");
        curves_of_a_maximal_set(&file["curves"]);
    }
    assert_eq!(found["against"], Value::Null);
    assert_eq!(found["failures"], Value::Array(Vec::new()));
}

/// No power at low frequencies and two rings, no pairs at small distances and as many as in noise far out.
fn curves_of_a_maximal_set(curves: &Value) {
    let column = |curve: &str, name: &str| -> Vec<f64> {
        let values = curves[curve][name].as_array().unwrap();
        values.iter().map(number).collect()
    };
    let mean = |curve: &str, from: f64, to: f64| {
        let places = column(curve, "x").into_iter().zip(column(curve, "y"));
        let inside: Vec<f64> = places
            .filter(|(x, _)| (from..to).contains(x))
            .map(|(_, y)| y)
            .collect();
        inside.iter().sum::<f64>() / inside.len() as f64
    };
    assert!(mean("power", 0.0, 0.4) < 0.1);
    assert!(mean("power", 0.9, 1.1) > 1.2);
    assert!(mean("power", 1.6, 1.9) < 0.8 && mean("power", 2.2, 2.5) > 1.1);
    assert!(mean("pair_correlation", 0.0, 0.7) < 1e-9);
    assert!((mean("pair_correlation", 3.0, 5.0) - 1.0).abs() < 0.02);
    assert!(mean("anisotropy_db", 1.0, 2.0).abs() < 1.0);
    let [lower, power, upper] = ["lower", "y", "upper"].map(|name| column("power", name));
    for (index, power) in power.iter().enumerate() {
        assert!(lower[index] < *power && *power < upper[index]);
    }
}

#[test]
fn differences_from_a_reference_are_value_less_reference() {
    let folder = two_sets();
    let found = json(&folder, &["kdrt.csv", "--against", "reference.npy"], 0);
    let (file, base) = (&found["files"][0], &found["against"]);
    assert_eq!(base["file"], "reference.npy");
    for key in ["samples", "density", "relative_radius", "bond_order"] {
        let expected = number(&file[key]) - number(&base[key]);
        assert!(
            (number(&file["differences"][key]) - expected).abs() < 1e-12,
            "{key}"
        );
    }
    let same = json(&folder, &["kdrt.csv", "--against", "kdrt.csv"], 0);
    assert_eq!(same["files"][0]["differences"]["density"], 0.0);
    tilescope(&folder)
        .args(["analyze", "kdrt.csv", "--against", "reference.npy"])
        .assert()
        .success()
        .stdout(contains("reference.npy (reference)").and(contains("less reference.npy")));
}

/// Sets of one radius differ in their numbers of samples: g(r) rises from 0 at that radius in all of them.
#[test]
fn sets_of_one_radius_are_cut_at_that_radius() {
    let folder = tempdir().unwrap();
    for (name, seed) in [("a.npy", "1"), ("b.npy", "2"), ("c.npy", "3")] {
        tilescope(&folder)
            .args(["sample", "--radius", "0.02", "--seed", seed, "--out", name])
            .assert()
            .success();
    }
    let at = |found: &Value, index: usize, end: &str| -> Vec<f64> {
        let values = found["files"][index]["curves"]["pair_correlation"][end].as_array();
        values.unwrap().iter().map(number).collect()
    };
    let found = json(&folder, &["a.npy", "b.npy", "c.npy"], 0);
    let counts = [0, 1, 2].map(|index| number(&found["files"][index]["samples"]));
    assert!(
        counts.iter().any(|count| (count - counts[0]).abs() > 0.5),
        "{counts:?}"
    );
    for index in 0..3 {
        assert_eq!(at(&found, index, "y").len(), 200);
        let (g, x) = (at(&found, index, "y"), at(&found, index, "x"));
        assert_eq!(g.iter().position(|g| *g > 0.0), Some(40));
        for (x, first) in x.iter().zip(at(&found, 0, "x")) {
            assert!((x - first).abs() < 1e-12, "{x} {first}");
        }
    }
    // One of another radius, or of none, and the unit is each set's own spacing, whatever the formats.
    for name in ["d.npy", "d.json", "d.xyz"] {
        tilescope(&folder)
            .args(["sample", "--radius", "0.021", "--out", name])
            .assert()
            .success();
    }
    fs::copy(folder.path().join("d.xyz"), folder.path().join("bare.xyz")).unwrap();
    for other in ["d.npy", "d.json", "d.xyz", "bare.xyz"] {
        let mixed = json(&folder, &["a.npy", other], 0);
        assert_ne!(at(&mixed, 0, "x"), at(&found, 0, "x"), "{other}");
    }
    // Formats that are not read in pieces have radii, too.
    let whole = json(&folder, &["d.json", "d.xyz"], 0);
    for index in 0..2 {
        let g = at(&whole, index, "y");
        assert_eq!(g.iter().position(|g| *g > 0.0), Some(40));
    }
}

/// Equal samples are conflicts and have no cells; everything else is measured, and others are as they were.
#[test]
fn a_set_with_equal_samples_is_measured_but_for_its_cells() {
    let folder = two_sets();
    let text = fs::read_to_string(folder.path().join("kdrt.csv")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let doubled = [&lines[..], &lines[7..8]].concat().join("\n");
    write(&folder, "doubled.csv", &doubled);
    let output = tilescope(&folder)
        .args([
            "analyze",
            "doubled.csv",
            "kdrt.csv",
            "--radius",
            "0.015",
            "--json",
        ])
        .assert()
        .success()
        .stderr(contains("doubled.csv: ").and(contains("measured without cells")))
        .get_output()
        .clone();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let [odd, right] = [0, 1].map(|index| &found["files"][index]);
    assert_eq!(
        (&odd["valid"], &odd["conflicts"]),
        (&false.into(), &1.0.into())
    );
    assert_eq!(
        (&odd["mean_sides"], &odd["min_distance_r"]),
        (&Value::Null, &0.0.into())
    );
    assert!((number(&odd["oscillation"]) - number(&right["oscillation"])).abs() < 0.1);
    assert!(right["mean_sides"].is_number());
}

#[test]
fn two_averages_have_two_names_and_whole_columns() {
    let folder = tempdir().unwrap();
    for name in ["k1.npy", "k2.npy", "r1.npy", "r2.npy"] {
        let seed = &name[1..2];
        let method = if name.starts_with('k') {
            "kdrt"
        } else {
            "reference"
        };
        tilescope(&folder)
            .args([
                "sample", "--count", "400", "--method", method, "--seed", seed,
            ])
            .args(["--out", name])
            .assert()
            .success();
    }
    let output = tilescope(&folder)
        .args(["analyze", "--average", "k1.npy", "k2.npy"])
        .args(["--against", "r1.npy", "--against", "r2.npy"])
        .assert()
        .success()
        .get_output()
        .clone();
    let text = String::from_utf8(output.stdout).unwrap();
    let heads: Vec<&str> = text
        .lines()
        .filter(|line| line.starts_with("measure"))
        .collect();
    assert_eq!(heads.len(), 2, "{text}");
    assert!(
        heads[0].contains("average of 2 sets: r*.npy (reference)"),
        "{text}"
    );
    assert!(heads[1].contains("average of 2 sets: k*.npy"), "{text}");
    assert!(
        heads.iter().all(|head| head.trim_end().ends_with("most")),
        "{text}"
    );
}

#[test]
fn the_table_has_units_and_aligned_columns() {
    let folder = two_sets();
    let output = tilescope(&folder)
        .args(["analyze", "kdrt.csv", "reference.npy"])
        .assert()
        .success()
        .get_output()
        .clone();
    let text = String::from_utf8(output.stdout).unwrap();
    let lengths: Vec<usize> = text.lines().map(|line| line.chars().count()).collect();
    assert!(lengths.iter().all(|length| *length == lengths[0]), "{text}");
    for part in [
        "density, N r\u{b2} / area",
        "relative radius, r_max",
        "1 x 1, periodic",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn csv_is_in_long_form() {
    let folder = two_sets();
    let arguments = ["analyze", "kdrt.csv", "reference.npy", "--out", "all.csv"];
    tilescope(&folder).args(arguments).assert().success();
    let text = fs::read_to_string(folder.path().join("all.csv")).unwrap();
    let text = text.strip_prefix('\u{feff}').expect("a byte-order mark");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("file,measure,x,y,lower,upper"));
    let mut seen = std::collections::BTreeMap::new();
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), 6, "{line}");
        assert!(fields[3].parse::<f64>().unwrap().is_finite(), "{line}");
        assert_eq!(fields[1] == "power", !fields[4].is_empty(), "{line}");
        *seen
            .entry((fields[0].to_owned(), fields[1].to_owned()))
            .or_insert(0) += 1;
    }
    for file in ["kdrt.csv", "reference.npy"] {
        let count = |measure: &str| seen[&(file.to_owned(), measure.to_owned())];
        assert_eq!(count("density"), 1);
        assert!(count("power") > 50 && count("anisotropy_db") > 50);
        assert_eq!(count("pair_correlation"), 200);
    }
}

#[test]
fn the_page_needs_nothing_from_elsewhere() {
    let folder = two_sets();
    fs::rename(
        folder.path().join("kdrt.csv"),
        folder.path().join("a & <b>.csv"),
    )
    .unwrap();
    let arguments = [
        "a & <b>.csv",
        "--radius",
        "0.015",
        "--against",
        "reference.npy",
    ];
    tilescope(&folder)
        .arg("analyze")
        .args(arguments)
        .args(["--out", "report.html"])
        .assert()
        .success();
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("<svg") && page.contains("</svg>") && page.ends_with("</html>\n"));
    for part in ["src=", "href=", "<script", "url(http", "@import", "<link"] {
        assert!(!page.contains(part), "{part}");
    }
    assert!(!page.contains("<b>.csv") && page.contains("a &amp; &lt;b&gt;.csv"));
    assert!(page.contains("analyze &apos;a &amp; &lt;b&gt;.csv&apos; --radius 0.015"));
    assert!(page.contains("relative radius") && page.contains("Differences"));
}

#[test]
fn pictures_are_pictures_and_alike_each_time() {
    let folder = two_sets();
    for name in ["a.png", "b.png", "a.svg", "b.svg"] {
        tilescope(&folder)
            .args(["analyze", "kdrt.csv", "reference.npy", "--out", name])
            .assert()
            .success();
    }
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(read("a.png").starts_with(b"\x89PNG") && read("a.svg").starts_with(b"<svg"));
    assert_eq!(read("a.png"), read("b.png"));
    assert_eq!(read("a.svg"), read("b.svg"));
}

#[test]
fn bad_files_do_not_keep_others_from_being_analysed() {
    // They are analysed twenty times.
    let folder = two_sets_of("600");
    write(&folder, "two.csv", "x,y\n0.1,0.1\n0.6,0.6\n");
    write(
        &folder,
        "same.csv",
        "x,y\n0.5,0.5\n0.5,0.5\n0.5,0.5\n0.5,0.5\n",
    );
    write(
        &folder,
        "nan.csv",
        "x,y\n0.1,0.1\nnan,0.6\n0.3,0.9\n0.7,0.2\n",
    );
    write(&folder, "one.csv", "x,y\n0.1,0.1\n");
    write(&folder, "none.csv", "x,y\n");
    write(&folder, "empty.npy", "");
    write(&folder, "inf.csv", "x,y\n0.1,0.1\n0.2,inf\n0.3,0.9\n");
    write(&folder, "outside.csv", "x,y\n0.1,0.1\n1.2,0.6\n0.3,0.9\n");
    fs::create_dir(folder.path().join("folder")).unwrap();
    assert_eq!(
        json(&folder, &["kdrt.csv", "reference.npy"], 0)["failures"],
        Value::Array(Vec::new())
    );
    let bad = [
        "two.csv",
        "same.csv",
        "nan.csv",
        "missing.csv",
        "one.csv",
        "none.csv",
        "empty.npy",
        "inf.csv",
        "outside.csv",
        "folder",
    ];
    for name in bad {
        let found = json(&folder, &["kdrt.csv", name, "reference.npy"], 2);
        assert_eq!(found["files"].as_array().unwrap().len(), 2, "{name}");
        assert_eq!(found["files"][1]["file"], "reference.npy");
        assert_eq!(found["failures"][0]["file"], name);
        tilescope(&folder)
            .args([
                "analyze",
                "kdrt.csv",
                name,
                "reference.npy",
                "--out",
                "r.html",
            ])
            .assert()
            .code(2)
            .stdout(contains("reference.npy"))
            .stderr(contains("error: ").and(contains(name)));
        let page = fs::read_to_string(folder.path().join("r.html")).unwrap();
        assert!(page.contains("Not analysed") && page.contains(name));
    }
}

#[test]
fn another_domain_than_the_references_is_refused() {
    let folder = two_sets();
    tilescope(&folder)
        .args([
            "sample",
            "--radius",
            "0.03",
            "--boundary",
            "bounded",
            "--out",
            "b.csv",
        ])
        .assert()
        .success();
    let found = json(
        &folder,
        &["b.csv", "kdrt.csv", "--against", "reference.npy"],
        2,
    );
    assert_eq!(found["files"].as_array().unwrap().len(), 1);
    let reason = found["failures"][0]["reason"].as_str().unwrap();
    assert!(
        reason.contains("1 x 1, bounded, is not that of reference.npy"),
        "{reason}"
    );
    // Without a reference both are analysed; a bounded set has no bands.
    let both = json(&folder, &["b.csv", "kdrt.csv"], 0);
    assert_eq!(both["files"][0]["curves"]["power"]["lower"], Value::Null);
    assert!(both["files"][1]["curves"]["power"]["lower"].is_array());
}

#[test]
fn oblong_domains_have_curves_and_a_picture_as_all_others() {
    let folder = two_sets();
    tilescope(&folder)
        .args([
            "sample", "--count", "500", "--width", "3", "--out", "wide.csv",
        ])
        .assert()
        .success();
    for name in ["wide.csv", "kdrt.csv"] {
        tilescope(&folder)
            .args(["analyze", name, "--out", "curves.svg"])
            .assert()
            .success();
        let svg = fs::read_to_string(folder.path().join("curves.svg")).unwrap();
        assert!(svg.contains("Radial mean power") && svg.contains("Pair correlation"));
        assert!(svg.contains(&format!("Periodogram, {name}")));
    }
}

#[test]
fn sets_of_others_take_their_smallest_distance_for_the_radius() {
    let folder = two_sets();
    fs::remove_file(folder.path().join("kdrt.csv.certificate.json")).unwrap();
    let found = json(&folder, &["kdrt.csv"], 0);
    let file = &found["files"][0];
    assert_eq!(
        (&file["radius_known"], &file["valid"]),
        (&false.into(), &Value::Null)
    );
    assert_eq!(
        (&file["gaps"], &file["min_distance_r"]),
        (&Value::Null, &1.0.into())
    );
    let known = json(&folder, &["kdrt.csv", "--radius", "0.01"], 0);
    assert_eq!(known["files"][0]["radius"], 0.01);
    assert_eq!(
        known["files"][0]["valid"], false,
        "gaps are a finding, not an error"
    );
}

#[test]
fn reports_of_unknown_kinds_and_useless_references_are_refused() {
    let folder = two_sets();
    for name in ["report.pdf", "report"] {
        tilescope(&folder)
            .args(["analyze", "kdrt.csv", "--out", name])
            .assert()
            .code(2)
            .stdout("")
            .stderr(contains("must be .html, .png, .svg or .csv"));
    }
    tilescope(&folder)
        .args(["analyze", "kdrt.csv", "--against", "missing.csv"])
        .assert()
        .code(2)
        .stderr(contains("--against").and(contains("missing.csv")));
    let set = fs::read(folder.path().join("kdrt.csv")).unwrap();
    for out in ["kdrt.csv", "./kdrt.csv"] {
        tilescope(&folder)
            .args(["analyze", "kdrt.csv", "--out", out])
            .assert()
            .code(2)
            .stderr(contains("written over this input"));
    }
    assert_eq!(fs::read(folder.path().join("kdrt.csv")).unwrap(), set);
    let before = names(folder.path());
    tilescope(&folder)
        .args(["analyze", "missing.csv", "--out", "report.html"])
        .assert()
        .code(2)
        .stdout("");
    assert_eq!(names(folder.path()), before, "no report of nothing");
}
