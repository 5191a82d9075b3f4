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
        // The time is that of the set, without the tries before it.
        assert!(!made["seconds"].as_array().unwrap().is_empty());
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

/// Writes polygons of one ring each as features of a file.
fn polygons(folder: &TempDir, name: &str, rings: &[Vec<[f64; 2]>]) {
    let feature = |ring: &Vec<[f64; 2]>| {
        let geometry = json!({ "type": "Polygon", "coordinates": [ring] });
        json!({ "type": "Feature", "geometry": geometry, "properties": {} })
    };
    let features: Vec<Value> = rings.iter().map(feature).collect();
    let all = json!({ "type": "FeatureCollection", "features": features });
    fs::write(folder.path().join(name), all.to_string()).unwrap();
}

/// A square of 100 x 100 at map coordinates, its corners shifted along x.
fn square(shift: f64) -> Vec<[f64; 2]> {
    let corners = [
        [200.0, 200.0],
        [300.0, 200.0],
        [300.0, 300.0],
        [200.0, 300.0],
    ];
    corners.map(|[x, y]| [x + shift, y]).to_vec()
}

/// Returns what the program prints.
fn printed(folder: &TempDir, line: &str) -> String {
    let assert = tilescope(folder).args(words(line)).assert().success();
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

#[test]
fn a_shape_is_the_same_in_any_direction_and_names_places_of_its_file() {
    let folder = tempdir().unwrap();
    polygons(&folder, "square.geojson", &[square(0.0)]);
    let mut reversed = square(0.0);
    reversed.reverse();
    reversed.rotate_left(1);
    polygons(&folder, "reversed.geojson", &[reversed]);
    let mut wider = square(0.0);
    wider[3][0] = 199.5;
    polygons(&folder, "wider.geojson", &[wider]);
    let line = "sample --shape square.geojson --radius 8 --out set.csv";
    let said = printed(&folder, line);
    assert!(
        said.contains("in a polygon of 1 ring with 4 corners"),
        "{said}"
    );
    let verify = |shape: &str, code| {
        run(
            &folder,
            &format!("verify set.csv --shape {shape} --json"),
            code,
        )
    };
    assert_eq!(verify("reversed.geojson", 0)["differences"], json!([]));
    // The control: another shape, told apart by its digest.
    let differs = &verify("wider.geojson", 1)["differences"];
    let [stated, found] = ["stated", "found"].map(|key| differs[0][key].as_str().unwrap());
    assert!(stated != found && found.contains("1 rings with 4 corners and the digest"));

    // A sample that lies outside of a narrower shape, as the file has it.
    polygons(
        &folder,
        "narrow.geojson",
        &[vec![[200.0, 200.0], [300.0, 300.0], [200.0, 300.0]]],
    );
    let outside = tilescope(&folder)
        .args(words("verify set.csv --shape narrow.geojson"))
        .assert()
        .code(2);
    let said = String::from_utf8(outside.get_output().stderr.clone()).unwrap();
    let (_, place) = said.split_once(" at (").expect("a place");
    let place: Vec<f64> = place
        .split(')')
        .next()
        .unwrap()
        .split(", ")
        .map(|number| number.parse().unwrap())
        .collect();
    assert!(
        place.iter().all(|at| (200.0..=300.0).contains(at)),
        "{said}"
    );

    // The same square twice would be a hole.
    polygons(&folder, "twice.geojson", &[square(0.0), square(0.0)]);
    let twice = "sample --shape twice.geojson --radius 8";
    refused(&folder, twice, "polygons 1 and 2 overlap, as at (250, 250)");
    polygons(&folder, "beside.geojson", &[square(0.0), square(100.0)]);
    run(
        &folder,
        "sample --shape beside.geojson --radius 8 --json",
        0,
    );
    polygons(
        &folder,
        "degrees.geojson",
        &[vec![[8.5, 47.0], [9.0, 47.0], [9.0, 47.5]]],
    );
    let degrees = "sample --shape degrees.geojson --radius 0.01";
    refused(&folder, degrees, "--planar takes them as they are");
    run(&folder, &format!("{degrees} --planar --json"), 0);
}

#[test]
fn an_image_and_two_radii_judge_a_set_without_a_certificate() {
    let folder = tempdir().unwrap();
    image(&folder, "grey.png", [32, 32], |x, y| x * y);
    let radii = "--radius-image grey.png --radius 0.02..0.06";
    run(&folder, &format!("sample {radii} --out set.csv --json"), 0);
    let text = printed(&folder, "verify set.csv --radius-image grey.png");
    assert!(
        text.contains("r = 0.0200") && text.contains(", a field"),
        "{text}"
    );
    fs::remove_file(folder.path().join("set.csv.certificate.json")).unwrap();
    let text = printed(&folder, &format!("verify set.csv {radii}"));
    assert!(text.contains(", a field"), "{text}");
    printed(&folder, &format!("draw set.csv set.svg {radii}"));

    // The controls: other radii, one radius, and two radii without an image.
    let larger = radii.replace("0.06", "0.07");
    run(&folder, &format!("verify set.csv {larger} --json"), 1);
    let one = "verify set.csv --radius-image grey.png --radius 0.02";
    refused(&folder, one, "--radius-image needs --radius MIN..MAX");
    for command in ["verify set.csv", "draw set.csv a.png", "analyze set.csv"] {
        let line = format!("{command} --radius 0.02..0.06");
        refused(
            &folder,
            &line,
            "--radius takes two radii, MIN..MAX, with --radius-image only",
        );
    }
}

#[test]
fn sets_of_fields_are_analyzed_and_judged_from_their_beginning() {
    let folder = tempdir().unwrap();
    let ramp = "sample --radius-expression 0.01+0.02*x --out ramp";
    for end in [".csv", ".json"] {
        run(&folder, &format!("{ramp}{end} --json"), 0);
    }
    let analyzed = run(&folder, "analyze ramp.csv --json", 0);
    assert_eq!(analyzed["files"][0]["valid"], json!(true), "{analyzed}");
    let text = fs::read_to_string(folder.path().join("ramp.json")).unwrap();
    let document: Value = serde_json::from_str(&text).unwrap();
    let radii = document["radius"].as_array().unwrap();
    assert_eq!(radii.len(), document["points"].as_array().unwrap().len());
    for (radius, point) in radii.iter().zip(document["points"].as_array().unwrap()) {
        let expected = 0.01 + 0.02 * point[0].as_f64().unwrap();
        assert!((radius.as_f64().unwrap() - expected).abs() < 1e-5);
    }
    run(&folder, "verify ramp.json --json", 0);

    image(&folder, "photo.png", [64, 64], |x, y| x * (1.0 - y));
    run(
        &folder,
        "stipple photo.png --dots 2000 --out dots.csv --json",
        0,
    );
    let prefix = |count: u32, code| {
        let line = format!("verify dots.csv --density-image photo.png --prefix {count} --json");
        run(&folder, &line, code)
    };
    let factor = |found: &Value| found["covering_factor"].as_f64().unwrap();
    let (whole, half) = (prefix(2000, 0), prefix(1000, 0));
    assert_eq!(
        (&half["count"], &half["valid"]),
        (&json!(1000), &json!(true))
    );
    assert!(factor(&whole) < factor(&half));
    let beyond = "verify dots.csv --density-image photo.png --prefix";
    refused(
        &folder,
        &format!("{beyond} 2001"),
        "--prefix is 2001; the set has 2000",
    );
    refused(
        &folder,
        &format!("{beyond} 20"),
        "farther than 4 times the radius",
    );
    // The control: dots in another order do not begin with a set.
    let path = folder.path().join("dots.csv");
    let text = fs::read_to_string(&path).unwrap();
    let mut lines: Vec<&str> = text.lines().collect();
    lines[1..].sort_unstable();
    fs::write(&path, lines.join("\n") + "\n").unwrap();
    refused(
        &folder,
        &format!("{beyond} 1000"),
        "farther than 4 times the radius",
    );
    let jpg = "stipple photo.png --dots 20 --out dots.jpg";
    refused(&folder, jpg, "known: png, csv");
}

#[test]
fn contrasts_up_to_a_limit_are_made_and_what_is_cut_off_is_said() {
    let folder = tempdir().unwrap();
    let line = "sample --radius-expression 0.01+0.63*x --out set.csv --json";
    assert_eq!(run(&folder, line, 0)["valid"], json!(true));
    run(&folder, "verify set.csv --json", 0);
    refused(
        &folder,
        "sample --radius-expression 0.01+0.64*x",
        "at most 64.0 times is possible",
    );
    image(&folder, "grey.png", [64, 64], |x, _| match x {
        x if x < 0.1 => 0.0,
        x if x > 0.9 => 1.0,
        x => x,
    });
    let steep = "sample --radius-image grey.png --radius 0.0075..0.3";
    refused(
        &folder,
        steep,
        "a least radius of 0.0078125 allows 64 times",
    );
    run(
        &folder,
        &format!("{} --json", steep.replace("0.0075", "0.0078125")),
        0,
    );

    let capped = run(
        &folder,
        "sample --density-image grey.png --count 1000 --json",
        0,
    );
    let note = capped["warnings"][0].as_str().unwrap();
    assert!(
        note.contains("pixels are too light for the largest radius"),
        "{note}"
    );
    image(&folder, "dark.png", [64, 64], |x, _| 0.9 * x);
    let dark = run(
        &folder,
        "sample --density-image dark.png --count 1000 --json",
        0,
    );
    assert_eq!(dark["warnings"], json!([]));
    image(&folder, "white.png", [64, 64], |_, _| 1.0);
    refused(
        &folder,
        "sample --density-image white.png --radius 0.01",
        "white.png: the image is white everywhere",
    );
}
