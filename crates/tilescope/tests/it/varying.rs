//! Sets whose radius varies, and sets that cover shapes, end to end: made, saved, verified, drawn, and refused.

use std::fs;

use png::{BitDepth, ColorType};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::support::tilescope;

/// Runs the program and returns its one JSON object.
pub fn run(folder: &TempDir, line: &str, code: i32) -> Value {
    let assert = tilescope(folder).args(words(line)).assert().code(code);
    serde_json::from_slice(&assert.get_output().stdout).expect("one JSON object")
}

/// Fails unless the program refuses a line with these words.
pub fn refused(folder: &TempDir, line: &str, wanted: &str) {
    let run = tilescope(folder).args(words(line)).assert().code(2);
    run.stderr(contains(wanted));
}

/// Splits a line at blanks; a tilde stands for a blank in a word.
pub fn words(line: &str) -> Vec<String> {
    line.split_whitespace()
        .map(|word| word.replace('~', " "))
        .collect()
}

/// Writes an image whose grey, of 16 bits, is that of a place of the unit square, counted from the top left corner.
pub fn image(folder: &TempDir, name: &str, size: [u32; 2], grey: impl Fn(f64, f64) -> f64) {
    let mut data = Vec::new();
    for row in 0..size[1] {
        for column in 0..size[0] {
            let place = [column, row].map(|at| f64::from(at) + 0.5);
            let grey = grey(place[0] / f64::from(size[0]), place[1] / f64::from(size[1]));
            data.extend(((grey * 65_535.0) as u16).to_be_bytes());
        }
    }
    let file = fs::File::create(folder.path().join(name)).unwrap();
    let mut encoder = png::Encoder::new(file, size[0], size[1]);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Sixteen);
    encoder
        .write_header()
        .unwrap()
        .write_image_data(&data)
        .unwrap();
}

/// Writes a park with a pond, 60 x 40 at map coordinates, the pond's ring in the wrong direction.
pub fn park(folder: &TempDir) {
    let ring = |corners: &[[f64; 2]]| {
        let corners = corners
            .iter()
            .map(|[x, y]| [500_000.0 + x, 5_400_000.0 + y]);
        corners.collect::<Vec<[f64; 2]>>()
    };
    let outer = ring(&[
        [0.0, 0.0],
        [60.0, 5.0],
        [45.0, 40.0],
        [5.0, 30.0],
        [0.0, 0.0],
    ]);
    let pond = ring(&[[20.0, 10.0], [35.0, 12.0], [30.0, 25.0], [20.0, 10.0]]);
    let geometry = json!({ "type": "Polygon", "coordinates": [outer, pond] });
    let feature = json!({ "type": "Feature", "geometry": geometry, "properties": {} });
    let all = json!({ "type": "FeatureCollection", "features": [feature] });
    fs::write(folder.path().join("park.geojson"), all.to_string()).unwrap();
}

/// Makes a set, verifies it, and returns what was said of both.
fn made_and_verified(folder: &TempDir, sample: &str, verify: &str) -> [Value; 2] {
    let made = run(folder, &format!("sample {sample} --json"), 0);
    assert_eq!(
        (&made["valid"], &made["judges"]),
        (&json!(true), &json!(["subdivision"]))
    );
    let verified = run(folder, &format!("verify {verify} --json"), 0);
    assert_eq!(verified["differences"], json!([]), "{verified}");
    assert_eq!(
        (&verified["count"], &verified["passed"]),
        (&made["count"], &json!(true))
    );
    [made, verified]
}

/// Replaces a line of a table by another one, and by none.
pub fn tamper(folder: &TempDir, name: &str, line: usize, other: Option<&str>) {
    let path = folder.path().join(name);
    let text = fs::read_to_string(&path).unwrap();
    let mut lines: Vec<&str> = text.lines().collect();
    lines.remove(line);
    if let Some(other) = other {
        lines.insert(line, other);
    }
    fs::write(path, lines.join("\n") + "\n").unwrap();
}

#[test]
fn sets_of_expressions_images_and_polygons_verify() {
    let folder = tempdir().unwrap();
    let expression =
        "--radius-expression 0.01+0.04*x+0.005*sin(9*y)*exp(-x) --seed 3 --out ramp.csv";
    made_and_verified(&folder, expression, "ramp.csv");
    image(&folder, "grey.png", [48, 32], |x, y| x * (1.0 - y));
    let field = "--radius-image grey.png --radius 0.01..0.08 --boundary periodic --out field.ply";
    made_and_verified(&folder, field, "field.ply --radius-image grey.png");
    park(&folder);
    let trees = "--shape park.geojson --radius 1.5 --out trees.csv";
    let [_, verified] = made_and_verified(&folder, trees, "trees.csv");
    assert_eq!(verified["origin"], json!([500_000.0, 5_400_000.0]));
    assert_eq!(verified["radius"], json!(1.5));
}

#[test]
fn tables_have_the_radius_of_each_sample() {
    let folder = tempdir().unwrap();
    made_and_verified(
        &folder,
        "--radius-expression 0.02+0.05*x --out ramp.csv",
        "ramp.csv",
    );
    let text = fs::read_to_string(folder.path().join("ramp.csv")).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("x,y,radius"));
    for line in lines {
        let row: Vec<f64> = line
            .split(',')
            .map(|number| number.parse().unwrap())
            .collect();
        assert!((0.02 + 0.05 * row[0] - row[2]).abs() < 1e-4, "{line}");
    }

    // Other commands take such a set, or say why not.
    let converted = tilescope(&folder)
        .args(["convert", "ramp.csv", "ramp.ply"])
        .assert()
        .success();
    converted.stdout(contains("verified by    subdivision"));
    run(&folder, "verify ramp.ply --json", 0);
    let head = fs::read(folder.path().join("ramp.ply")).unwrap();
    assert!(String::from_utf8_lossy(&head[..300]).contains("property double radius"));
}

/// Returns the radii of the disks of a picture, in pixels, in their order.
fn disks(folder: &TempDir, line: &str) -> Vec<f64> {
    tilescope(folder)
        .args(words(&format!("draw {line} --size 2000")))
        .assert()
        .success();
    let name = line.split_whitespace().nth(1).unwrap();
    let svg = fs::read_to_string(folder.path().join(name)).unwrap();
    let Some((_, group)) = svg.split_once("aria-label=\"disks\"") else {
        return Vec::new();
    };
    let group = group.split("</g>").next().unwrap();
    let radius = |circle: &str| circle.split('"').next().unwrap().parse().unwrap();
    group.split(" r=\"").skip(1).map(radius).collect()
}

#[test]
fn each_disk_has_the_radius_of_its_sample() {
    let folder = tempdir().unwrap();
    image(&folder, "grey.png", [32, 32], |x, _| x);
    let make = "--radius-image grey.png --radius 0.02..0.08";
    for name in ["a.csv", "a.npy"] {
        run(&folder, &format!("sample {make} --out {name} --json"), 0);
    }
    let text = fs::read_to_string(folder.path().join("a.csv")).unwrap();
    let column = text
        .lines()
        .skip(1)
        .map(|line| line.rsplit(',').next().unwrap());
    let radii: Vec<f64> = column.map(|radius| radius.parse().unwrap()).collect();

    let by_column = disks(&folder, "a.csv a.svg");
    let pixels = by_column[0] / radii[0];
    let is_same = |(drawn, radius): (&f64, &f64)| (drawn - radius * pixels).abs() < 0.01;
    assert_eq!(by_column.len(), radii.len());
    assert!(by_column.iter().zip(&radii).all(is_same));
    // The file has no column: the image must be given, or disks are left out with a note.
    assert_eq!(
        disks(&folder, "a.npy b.svg --radius-image grey.png"),
        by_column
    );
    assert_eq!(disks(&folder, "a.npy c.svg"), Vec::<f64>::new());
    let drawn = ["draw", "a.npy", "d.png"];
    let noted = tilescope(&folder).args(drawn).assert().success();
    noted.stderr(contains("disks are left out").and(contains("--radius-image grey.png")));
    image(&folder, "other.png", [32, 32], |x, _| 1.0 - x);
    refused(
        &folder,
        "draw a.npy e.png --radius-image other.png",
        "give the field that the set was made with",
    );
    refused(
        &folder,
        "draw a.csv e.png --gaps",
        "--gaps: where the radius varies",
    );

    // Tables of others, and formulas of certificates.
    fs::write(
        folder.path().join("own.csv"),
        "x,y,radius\n0.2,0.5,0.1\n0.7,0.5,0.2\n",
    )
    .unwrap();
    let own = disks(&folder, "own.csv own.svg");
    assert_eq!(
        (own.len(), own.first().map(|radius| 2.0 * radius)),
        (2, own.get(1).copied())
    );
    run(
        &folder,
        "sample --radius-expression 0.02+0.05*x --out ramp.npy --json",
        0,
    );
    assert!(disks(&folder, "ramp.npy ramp.svg").len() > 100);
    park(&folder);
    run(
        &folder,
        "sample --shape park.geojson --radius 2 --out trees.csv --json",
        0,
    );
    refused(
        &folder,
        "draw trees.csv e.png --gaps",
        "beyond a shape nothing is covered",
    );
    assert!(!folder.path().join("e.png").exists());
}

#[test]
fn geojson_has_every_bit_and_the_radius_of_each_point() {
    let folder = tempdir().unwrap();
    let ramp = "--radius-expression 0.02+0.05*x --out";
    let [made, _] = made_and_verified(&folder, &format!("{ramp} ramp.geojson"), "ramp.geojson");
    made_and_verified(&folder, &format!("{ramp} ramp.csv"), "ramp.csv");
    let text = fs::read_to_string(folder.path().join("ramp.geojson")).unwrap();
    let collection: Value = serde_json::from_str(&text).unwrap();
    let csv = fs::read_to_string(folder.path().join("ramp.csv")).unwrap();
    for (feature, line) in collection["features"]
        .as_array()
        .unwrap()
        .iter()
        .zip(csv.lines().skip(1))
    {
        let row: Vec<f64> = line.split(',').map(|one| one.parse().unwrap()).collect();
        assert_eq!(feature["geometry"]["coordinates"], json!(row[..2]));
        assert_eq!(feature["properties"], json!({ "radius": row[2] }));
    }
    let stated = fs::read_to_string(folder.path().join("ramp.geojson.certificate.json")).unwrap();
    let stated: Value = serde_json::from_str(&stated).unwrap();
    let has = |name: &str| stated[name].clone();
    assert_eq!(has("file_format"), json!("geojson"));
    assert_eq!(has("positions_digest"), made["positions_digest"]);

    // What is changed is found; converted and renamed it is still a set.
    tilescope(&folder)
        .args(["convert", "ramp.geojson", "again.npy"])
        .assert()
        .success();
    run(&folder, "verify again.npy --json", 0);
    for end in ["", ".certificate.json"] {
        let [from, to] =
            ["ramp.geojson", "named.json"].map(|name| folder.path().join(format!("{name}{end}")));
        fs::copy(from, to).unwrap();
    }
    run(&folder, "verify named.json --json", 0);
    tamper(&folder, "ramp.geojson", 4, None);
    let found = run(&folder, "verify ramp.geojson --json", 1);
    assert!(found["gaps"].as_u64().unwrap() > 0);

    // At map coordinates, with a word on what positions are.
    park(&folder);
    let trees = "sample --shape park.geojson --radius 2 --out trees.geojson";
    let noted = tilescope(&folder).args(words(trees)).assert().success();
    noted.stdout(contains(
        "by its standard (RFC 7946), and these positions are planar",
    ));
    let found = run(&folder, "verify trees.geojson --json", 0);
    assert_eq!(found["origin"], json!([500_000.0, 5_400_000.0]));
}

#[test]
fn positions_of_others_are_in_the_coordinates_of_the_shape() {
    let folder = tempdir().unwrap();
    park(&folder);
    run(
        &folder,
        "sample --shape park.geojson --radius 2 --out trees.csv --json",
        0,
    );
    fs::remove_file(folder.path().join("trees.csv.certificate.json")).unwrap();
    let line = "verify trees.csv --shape park.geojson --radius 2 --json";
    assert_eq!(
        run(&folder, line, 0)["origin"],
        json!([500_000.0, 5_400_000.0])
    );
    let both = "verify trees.csv --radius 2 --radius-expression 2+0*x";
    let refused = tilescope(&folder).args(words(both)).assert().code(2);
    refused.stderr(contains("both --radius and --radius-expression are given"));

    tamper(&folder, "trees.csv", 7, None);
    assert!(run(&folder, line, 1)["gaps"].as_u64().unwrap() > 0);
}

#[test]
fn masks_without_a_certificate_are_judged_whatever_made_them() {
    let folder = tempdir().unwrap();
    image(&folder, "island.png", [37, 37], |x, y| {
        f64::from(u8::from((x - 0.5).hypot(y - 0.5) < 0.45))
    });
    for (method, seed) in [("reference", 1), ("exact", 1), ("exact", 2)] {
        let line = format!(
            "sample --mask island.png --radius 0.02 --seed {seed} --method {method} --out island.csv --json"
        );
        run(&folder, &line, 0);
        fs::remove_file(folder.path().join("island.csv.certificate.json")).unwrap();
        let line = "verify island.csv --mask island.png --radius 0.02 --json";
        assert_eq!(run(&folder, line, 0)["valid"], true, "{method}");
        // Control: one sample less.
        tamper(&folder, "island.csv", 7, None);
        assert!(run(&folder, line, 1)["gaps"].as_u64().unwrap() > 0);
    }
}

#[test]
fn small_exact_tilings_get_a_note_on_their_time_and_other_sets_none() {
    let folder = tempdir().unwrap();
    park(&folder);
    let made = |line: &str| {
        let done = tilescope(&folder).args(words(line)).assert().success();
        let output = done.get_output();
        String::from_utf8_lossy(&[&output.stdout[..], &output.stderr].concat()).into_owned()
    };
    let set = "sample --radius 0.02 --out set.csv";
    let small = made(&format!("{set} --method exact --pattern-side 100"));
    let note = "below about 18,000 samples --method reference takes less time";
    assert!(small.contains(note), "{small}");
    let shape = made("sample --shape park.geojson --radius 2 --method exact --out park.csv");
    assert!(shape.contains("shapes were not timed"), "{shape}");

    // Controls: other methods, a pattern that pays, and one from a file, which is asked for as it is.
    let reference = made(&format!("{set} --method reference"));
    let given = "sample --radius 0.04 --method exact --pattern set.csv --out given.csv";
    let side = "sample --radius 0.02 --method exact --pattern-side 20 --leaf 8 --out side.csv";
    for said in [reference, made(given), made(side), made(set)] {
        assert!(
            said.contains("samples") && !said.contains("less time"),
            "{said}"
        );
    }
}

#[test]
fn counts_are_met_to_within_a_hundredth() {
    let folder = tempdir().unwrap();
    image(&folder, "photo.png", [60, 40], |x, y| {
        0.2 + 0.7 * (x - 0.5).hypot(y - 0.5)
    });
    let near =
        |made: &Value, count: i64| (made["count"].as_i64().unwrap() - count).abs() * 100 <= count;
    let stipple = "--density-image photo.png --count 2000 --out stipple.csv";
    let verify = "stipple.csv --density-image photo.png";
    let [made, _] = made_and_verified(&folder, stipple, verify);
    assert!(near(&made, 2000), "{made}");
    let scaled = "--radius-image photo.png --radius 1..4 --count 900 --out scaled.csv";
    let [made, _] = made_and_verified(&folder, scaled, "scaled.csv --radius-image photo.png");
    assert!(near(&made, 900), "{made}");
    park(&folder);
    let trees = "--shape park.geojson --count 700 --out trees.npy";
    let [made, _] = made_and_verified(&folder, trees, "trees.npy");
    assert!(near(&made, 700), "{made}");
}

#[test]
fn what_was_tampered_with_is_found() {
    let folder = tempdir().unwrap();
    image(&folder, "island.png", [40, 40], |x, y| {
        f64::from(u8::from((x - 0.5).hypot(y - 0.5) < 0.45))
    });
    image(&folder, "other.png", [40, 40], |x, y| {
        f64::from(u8::from((x - 0.5).hypot(y - 0.5) < 0.4))
    });
    let make = || {
        let island = "--mask island.png --radius-expression 0.02+0.03*y --out island.csv";
        made_and_verified(&folder, island, "island.csv --mask island.png");
    };
    let verify = |code: i32| run(&folder, "verify island.csv --mask island.png --json", code);

    make();
    tamper(&folder, "island.csv", 5, None);
    let found = verify(1);
    assert!(
        found["gaps"].as_u64().unwrap() > 0 && found["conflicts"] == 0,
        "{found}"
    );

    make();
    let text = fs::read_to_string(folder.path().join("island.csv")).unwrap();
    let row: Vec<f64> = text
        .lines()
        .nth(9)
        .unwrap()
        .split(',')
        .map(|one| one.parse().unwrap())
        .collect();
    let beside = format!(
        "{},{},0.02",
        row[0] + (0.5 - row[0]) * 0.01,
        row[1] + (0.5 - row[1]) * 0.01
    );
    tamper(&folder, "island.csv", 5, Some(&beside));
    let found = verify(1);
    assert!(found["conflicts"].as_u64().unwrap() > 0, "{found}");

    // Outside of the mask there is no verdict.
    make();
    tamper(&folder, "island.csv", 5, Some("0.01,0.01,0.02"));
    let line = "verify island.csv --mask island.png";
    refused(&folder, line, "lies outside the shape");
    // Another mask, and another field.
    make();
    let found = run(
        &folder,
        "verify island.csv --mask island.png --radius-expression 0.02+0.02*y --json",
        1,
    );
    assert_eq!(found["differences"][0]["field"], "radius", "{found}");
    refused(
        &folder,
        "verify island.csv --mask other.png",
        "lies outside the shape",
    );
    refused(&folder, "verify island.csv", "--mask island.png");

    let path = folder.path().join("island.csv.certificate.json");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace("0.02+0.03*y", "0.02+0.031*y")).unwrap();
    let found = verify(1);
    assert_eq!(found["differences"][0]["field"], "radius", "{found}");
}

/// What is asked for, and what of the refusal names it.
const REFUSED: [(&str, &str); 26] = [
    (
        "--radius-expression 0.02 --method kdrt",
        "--method kdrt: --radius-expression needs",
    ),
    (
        "--radius-expression 0.02 --method exact",
        "--method exact: --radius-expression needs",
    ),
    (
        "--radius-expression 0.02 --levels 3",
        "--levels: --radius-expression needs",
    ),
    ("--radius-expression 0.02 --engine gpu", "--engine gpu"),
    (
        "--radius-expression 0.02 --leaf 20",
        "--leaf: --radius-expression needs",
    ),
    (
        "--radius-expression 0.02 --pattern-seed 2",
        "--pattern-seed: --radius-expression",
    ),
    (
        "--shape park.geojson --radius 1 --dihedral",
        "--dihedral: --shape needs",
    ),
    (
        "--shape park.geojson --radius 1 --search 2",
        "--search: --shape needs",
    ),
    (
        "--shape park.geojson --radius 1 --method kdrt",
        "no pattern, unless --method is exact",
    ),
    (
        "--shape park.geojson --radius 1 --method exact --search 2",
        "--search is for KDRT",
    ),
    (
        "--shape park.geojson --radius 1 --method exact --resume",
        "--resume: exact tiling of --shape has no use",
    ),
    (
        "--radius-expression 0.02 --radius 0.1",
        "cannot be used with",
    ),
    (
        "--radius-expression 0.02+*x",
        "at character 6: `*` stands where",
    ),
    (
        "--radius-expression 0.3*x",
        "the radius is 0 at (0, 0); it must be above 0",
    ),
    (
        "--radius-expression 0.001+x",
        "1001.0 times as much; at most",
    ),
    (
        "--radius-expression 0.00000001",
        "and nodes are 0.0009765625 apart; at least",
    ),
    (
        "--radius-expression 0.02 --judge circles",
        "the judge circles knows of no radius",
    ),
    (
        "--radius-image grey.png --radius 0.01",
        "needs --radius MIN..MAX",
    ),
    (
        "--radius-image grey.png --radius 0.2..0.01",
        "the radii are 0.2 to 0.01; the first must",
    ),
    (
        "--radius-image text.png --radius 0.01..0.1",
        "text.png: it is no PNG or JPEG image",
    ),
    (
        "--radius-image grey.png --radius 0.02..0.1 --width 2 --height 1",
        "pixels must be squares",
    ),
    ("--radius 0.01..0.1", "with --radius-image only"),
    ("--radius 0.01 --count 5", "cannot be used with"),
    (
        "--shape town.geojson --radius 0.01",
        "project them to a plane",
    ),
    (
        "--shape bow.geojson --radius 0.01",
        "cross; edges may only touch",
    ),
    (
        "--radius 0.01 --judge subdivision",
        "the judge subdivision is for sets whose radius",
    ),
];

#[test]
fn what_cannot_be_made_is_refused_by_name_and_nothing_is_written() {
    let folder = tempdir().unwrap();
    park(&folder);
    image(&folder, "grey.png", [20, 20], |x, _| x);
    fs::write(folder.path().join("text.png"), "no image").unwrap();
    let town = r#"{"type": "Polygon", "coordinates": [[[8.5, 47.25], [8.6, 47.25], [8.5, 47.5]]]}"#;
    fs::write(folder.path().join("town.geojson"), town).unwrap();
    let bow = r#"{"type": "Polygon", "coordinates": [[[0, 0], [1, 1], [1, 0], [0, 1]]]}"#;
    fs::write(folder.path().join("bow.geojson"), bow).unwrap();

    for (line, wanted) in REFUSED {
        refused(&folder, &format!("sample {line} --out set.csv"), wanted);
    }
    assert!(!folder.path().join("set.csv").exists());
    run(
        &folder,
        "sample --shape town.geojson --planar --radius 0.01 --json",
        0,
    );
}

#[test]
fn radii_of_samples_without_a_certificate_show_conflicts_and_no_covering() {
    let folder = tempdir().unwrap();
    let line = "sample --radius-expression 0.02+0.03*x --boundary bounded --out a.csv --json";
    let made = run(&folder, line, 0);
    fs::remove_file(folder.path().join("a.csv.certificate.json")).unwrap();
    for domain in ["", "--width 1 --height 1"] {
        let found = run(&folder, &format!("verify a.csv {domain} --json"), 0);
        assert_eq!(found["count"], made["count"]);
        assert_eq!(
            (&found["conflict_free"], &found["maximal"]),
            (&json!(true), &json!(null))
        );
    }
    let said = tilescope(&folder)
        .args(["verify", "a.csv"])
        .assert()
        .success();
    said.stdout(contains("covering       not judged").and(contains("maximal").not()));
    // With its field the same file has a whole verdict, and with one radius another one.
    let field = "verify a.csv --radius-expression 0.02+0.03*x --boundary bounded --json";
    assert_eq!(run(&folder, field, 0)["valid"], true);
    run(
        &folder,
        "verify a.csv --radius 0.05 --boundary bounded --json",
        1,
    );

    // Radii 1 and 3 keep 1.5 apart: at 1.6 there is none in conflict, and at 1.4 there are two.
    let survey = |x: f64| {
        let text = format!("easting,northing,radius\n0,0,1\n{x},0,3\n9,9,1\n");
        fs::write(folder.path().join("b.csv"), text).unwrap();
    };
    let line = "verify b.csv --columns easting northing --json";
    survey(1.6);
    assert_eq!(run(&folder, line, 0)["conflicts"], 0);
    survey(1.4);
    let found = run(&folder, line, 1);
    assert_eq!(found["conflicting"], json!([[0, 1]]));
    // Around a torus of 10 the last sample is near the first.
    survey(1.6);
    let around =
        "verify b.csv --columns easting northing --boundary periodic --width 9.5 --height 9.5";
    assert_eq!(run(&folder, &format!("{around} --json"), 1)["conflicts"], 1);
    let line = "verify b.csv --columns easting northing --width 5 --height 9.5";
    refused(&folder, line, "sample 2 at 9 9 lies outside");
    // Without radii there is nothing to judge by, and a radius that is none is refused.
    fs::write(folder.path().join("c.csv"), "x,y\n0,0\n").unwrap();
    refused(&folder, "verify c.csv", "give --radius");
    fs::write(folder.path().join("c.csv"), "x,y,radius\n0,0,-1\n").unwrap();
    refused(
        &folder,
        "verify c.csv",
        "\"-1\" in column radius is not a finite number above 0",
    );
}

#[test]
fn a_prefix_of_levels_refuses_fields_shapes_and_masks() {
    let folder = tempdir().unwrap();
    image(&folder, "grey.png", [8, 8], |x, _| x);
    run(
        &folder,
        "sample --levels 3 --radius 0.05 --out a.csv --json",
        0,
    );
    run(&folder, "verify a.csv --prefix 20 --json", 0);
    for option in [
        "--mask grey.png",
        "--density-image grey.png",
        "--radius-image grey.png",
        "--radius-expression 0.05",
        "--shape park.geojson",
    ] {
        let name = option.split(' ').next().unwrap();
        let line = format!("verify a.csv --prefix 20 {option}");
        refused(&folder, &line, &format!("{name}: sets with nested levels"));
    }
}
