//! Options of fields and shapes that name something that their sets have, or are refused.

use std::fmt::Write;
use std::fs;

use predicates::str::contains;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::support::tilescope;
use crate::varying::{image, park, refused, run, tamper, words};

/// Returns the certificate beside a file.
fn certificate(folder: &TempDir, name: &str) -> Value {
    let path = folder.path().join(format!("{name}.certificate.json"));
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn exactly_so_many_samples_are_the_first_of_a_field_or_of_a_shape() {
    let folder = tempdir().unwrap();
    park(&folder);
    image(&folder, "grey.png", [48, 32], |x, y| x * (1.0 - y));
    for (given, to_verify) in [
        ("--shape park.geojson", ""),
        ("--radius-expression 0.006+0.024*x", ""),
        (
            "--radius-image grey.png --radius 0.01..0.08",
            "--radius-image grey.png",
        ),
        ("--density-image grey.png", "--density-image grey.png"),
    ] {
        let line = format!("sample {given} --exactly 333 --out set.csv --json");
        let made = run(&folder, &line, 0);
        assert_eq!(
            (&made["count"], &made["valid"]),
            (&json!(333), &json!(true))
        );
        assert!(
            made["warnings"][0]
                .as_str()
                .unwrap()
                .contains("the first 333 of")
        );
        let prefix = certificate(&folder, "set.csv")["prefix"].clone();
        assert_eq!(prefix["kept"], json!(333));
        assert!(prefix["made"].as_u64().unwrap() > 333, "{prefix}");

        let verify = format!("verify set.csv {to_verify} --json");
        let verified = run(&folder, &verify, 0);
        assert_eq!(verified["prefix"], prefix, "{given}");
        // The control: a sample less is not the set that the certificate is about.
        tamper(&folder, "set.csv", 20, None);
        assert_eq!(run(&folder, &verify, 1)["passed"], json!(false));
    }
}

#[test]
fn options_that_a_field_or_a_shape_has_no_use_for_are_refused() {
    let folder = tempdir().unwrap();
    park(&folder);
    let shape = "sample --shape park.geojson";
    let field = "sample --radius-expression 0.01+0.02*x";
    let with = |line: &str, more: &str, wanted: &str| {
        refused(&folder, &format!("{line} {more}"), wanted);
    };
    for (more, wanted) in [
        ("--checked-shaders", "--checked-shaders is for KDRT"),
        ("--engine sequential", "--engine sequential is for KDRT"),
        ("--checkpoint 5 --out a.csv", "--checkpoint: "),
        ("--levels 3", "--levels: "),
        ("--exactly 0", "no radii give 0 samples"),
    ] {
        with(field, more, wanted);
    }
    with(
        shape,
        "--radius 2 --exactly 9",
        "'--radius <R>' cannot be used",
    );
    with(shape, "--count 9 --exactly 9", "cannot be used with");
    let exact = "--method exact --exactly 99";
    with(shape, exact, "--exactly: exact tiling of --shape");
    // The control: the same without these options.
    for line in [field, "sample --shape park.geojson --radius 3"] {
        run(&folder, &format!("{line} --engine parallel --json"), 0);
    }
    // Where neither field nor shape is given there is no process whose first samples are spread evenly.
    let plain = tilescope(&folder)
        .args(words("sample --exactly 100"))
        .assert();
    plain.code(2).stderr(contains("--exactly needs --levels K"));
}

#[test]
fn an_image_is_laid_over_a_cloud_of_other_proportions() {
    let folder = tempdir().unwrap();
    image(&folder, "grey.png", [64, 64], |x, _| x);
    // As clouds are: the rectangle around the points is no square.
    let mut table = "x,y\n".to_owned();
    for at in 0..4_000_u32 {
        let [x, y] = [2_654_435_761, 2_246_822_519]
            .map(|factor: u32| f64::from(at.wrapping_mul(factor) >> 8) / 16_777_216.0);
        writeln!(table, "{},{}", 300.0 + 99.987 * x, 60.0 * y).unwrap();
    }
    fs::write(folder.path().join("cloud.csv"), table).unwrap();

    let line = "thin cloud.csv --radius-image grey.png --radius 1..3 --out kept.csv --json";
    let thinned = run(&folder, line, 0);
    let region = &thinned["region"];
    assert_eq!(region["width"], region["height"]);
    assert!((99.0..99.99).contains(&region["width"].as_f64().unwrap()));
    let verify = "verify kept.csv --source cloud.csv --radius-image grey.png --json";
    assert_eq!(run(&folder, verify, 0)["valid"], json!(true));

    // A dark place has more points than a light one; the control: not so under the mirrored image.
    let left_share = || {
        let text = fs::read_to_string(folder.path().join("kept.csv")).unwrap();
        let xs = text
            .lines()
            .skip(1)
            .map(|line| line.split(',').next().unwrap());
        let xs: Vec<f64> = xs.map(|x| x.parse().unwrap()).collect();
        xs.iter().filter(|x| **x < 350.0).count() as f64 / xs.len() as f64
    };
    assert!(left_share() > 0.55);
    image(&folder, "mirrored.png", [64, 64], |x, _| 1.0 - x);
    run(&folder, &line.replace("grey", "mirrored"), 0);
    assert!(left_share() < 0.45);

    // One side gives the other.
    let wide = line.replace("--json", "--width 120 --origin 290 -5 --json");
    assert_eq!(run(&folder, &wide, 0)["region"]["height"], json!(120.0));
}
