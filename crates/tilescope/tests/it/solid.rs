//! Sets in space, end to end: made, saved, verified, converted, cut by planes, and refused.

use std::fmt::Write as _;
use std::fs;

use predicates::str::contains;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::support::tilescope;

/// Runs the program and returns its one JSON object.
pub fn run(folder: &TempDir, line: &str, code: i32) -> Value {
    let line = format!("{line} --json");
    let assert = tilescope(folder).args(line.split_whitespace()).assert();
    let assert = assert.code(code);
    serde_json::from_slice(&assert.get_output().stdout).expect("one JSON object")
}

/// Runs the program, and fails unless it ends with this code.
pub fn ends(folder: &TempDir, line: &str, code: i32) -> String {
    let assert = tilescope(folder).args(line.split_whitespace()).assert();
    let assert = assert.code(code);
    String::from_utf8(assert.get_output().stdout.clone()).expect("text")
}

/// Fails unless the program refuses a line with these words.
pub fn refused(folder: &TempDir, line: &str, wanted: &str) {
    let run = tilescope(folder).args(line.split_whitespace()).assert();
    run.code(2).stderr(contains(wanted));
}

fn certificate(folder: &TempDir, name: &str) -> Value {
    let path = folder.path().join(format!("{name}.certificate.json"));
    serde_json::from_slice(&fs::read(path).expect("a certificate")).expect("JSON")
}

#[test]
fn sets_are_made_saved_and_verified() {
    let folder = tempdir().unwrap();
    for (name, boundary) in [("a.ply", "periodic"), ("a.npy", "bounded")] {
        let line =
            format!("sample --size 6x5x7 --radius 1 --boundary {boundary} --seed 7 --out {name}");
        let made = run(&folder, &line, 0);
        assert_eq!(made["valid"], json!(true), "{made}");
        assert_eq!(made["judges"], json!(["subdivision", "circles"]));
        let stated = certificate(&folder, name);
        assert_eq!(
            (&stated["format_version"], &stated["depth"]),
            (&json!(2), &json!(7.0))
        );
        assert_eq!(stated["parameters"]["depth"], json!(7.0));

        let found = run(&folder, &format!("verify {name}"), 0);
        assert_eq!(
            (&found["differences"], &found["passed"]),
            (&json!([]), &json!(true))
        );
        for field in ["count", "density", "covering_radius_r"] {
            assert_eq!(found[field], made[field], "{field}");
        }
        for judge in ["subdivision", "circles", "both"] {
            let found = run(&folder, &format!("verify {name} --judge {judge}"), 0);
            assert_eq!(found["passed"], json!(true), "{judge}");
        }
        refused(
            &folder,
            &format!("verify {name} --judge delaunay"),
            "judges planar sets alone",
        );
    }

    // The side of --depth is over --width and --height; threads do not matter.
    let one = run(
        &folder,
        "sample --width 6 --height 5 --depth 7 --radius 1 --seed 7 --threads 1",
        0,
    );
    let two = run(
        &folder,
        "sample --size 6x5x7 --radius 1 --seed 7 --threads 3",
        0,
    );
    assert_eq!(one["positions_digest"], two["positions_digest"]);
    let text = ends(&folder, "sample --size 6x5x7 --radius 1 --seed 7", 0);
    assert!(
        text.contains("6 x 5 x 7, periodic, r = 1") && text.contains("N r^3 / volume"),
        "{text}"
    );
}

#[test]
fn planted_faults_are_seen() {
    let folder = tempdir().unwrap();
    ends(&folder, "sample --size 5x5x5 --radius 1 --out a.csv", 0);
    let path = folder.path().join("a.csv");
    let text = fs::read_to_string(&path).unwrap();
    let rows: Vec<&str> = text.lines().collect();

    // One sample less: a hole; one sample twice as another: a conflict.
    fs::write(&path, [&rows[..1], &rows[2..]].concat().join("\n") + "\n").unwrap();
    let found = run(&folder, "verify a.csv", 1);
    assert_eq!(
        (&found["maximal"], &found["conflict_free"]),
        (&json!(false), &json!(true))
    );
    let said = ends(&folder, "verify a.csv", 1);
    // The first gap is the deepest, which is as deep as the set is bare.
    let covering = said.split("covering radius ").nth(1).expect("a radius");
    let gap = said.split("gap: (").nth(1).expect("a gap");
    let deepest = gap.split(") is ").nth(1).expect("a depth");
    assert_eq!(covering[..7], deepest[..7], "{said}");
    // Places have no more digits than are of use.
    let place = gap.split(')').next().expect("a place");
    assert!(place.split(", ").all(|number| number.len() <= 8), "{said}");
    let beside: Vec<f64> = rows[1]
        .split(',')
        .map(|field| field.parse().unwrap())
        .collect();
    let near = beside[0] + if beside[0] < 2.0 { 0.3 } else { -0.3 };
    let more = format!("{text}{near},{},{},999,0\n", beside[1], beside[2]);
    fs::write(&path, more).unwrap();
    let found = run(&folder, "verify a.csv", 1);
    assert_eq!(
        (&found["maximal"], &found["conflict_free"]),
        (&json!(true), &json!(false))
    );
    let fields: Vec<&Value> = found["differences"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| &one["field"])
        .collect();
    assert!(
        fields.contains(&&json!("digest")) && fields.contains(&&json!("count")),
        "{fields:?}"
    );
    refused(
        &folder,
        "convert a.csv b.ply",
        "its certificate is not true",
    );
}

#[test]
fn numbers_of_samples_are_met() {
    let folder = tempdir().unwrap();
    let made = run(
        &folder,
        "sample --size 1x1x2 --count 900 --boundary bounded --out a.xyz",
        0,
    );
    let count = made["count"].as_i64().unwrap();
    assert!(
        (count - 900).abs() <= 9 && made["maximal"] == json!(true),
        "{made}"
    );

    let made = run(&folder, "sample --size 1x1x2 --exactly 1001 --out a.ply", 0);
    assert_eq!(
        (&made["count"], &made["valid"]),
        (&json!(1001), &json!(true))
    );
    let factor = made["covering_factor"].as_f64().expect("a factor");
    assert!((1.0..1.6).contains(&factor), "{factor}");
    let prefix = &certificate(&folder, "a.ply")["prefix"];
    assert_eq!(
        (&prefix["kept"], &prefix["made"]),
        (&json!(1001), &made["made"])
    );
    let found = run(&folder, "verify a.ply", 0);
    assert_eq!(found["differences"], json!([]));

    // The control: a certificate that states a smaller factor is not true.
    let path = folder.path().join("a.ply.certificate.json");
    let text = fs::read_to_string(&path).unwrap();
    let stated = format!("\"factor\": {}", prefix["factor"]);
    assert!(text.contains(&stated), "{text}");
    fs::write(&path, text.replace(&stated, "\"factor\": 1.0001")).unwrap();
    let found = run(&folder, "verify a.ply", 1);
    assert_eq!(found["differences"][0]["field"], json!("prefix.factor"));
}

#[test]
fn formats_are_converted_and_planes_are_cut() {
    let folder = tempdir().unwrap();
    let made = run(&folder, "sample --size 6x6x6 --radius 1 --out a.ply", 0);
    for name in ["b.npy", "c.csv", "d.xyz", "e.bin", "f.dat"] {
        ends(&folder, &format!("convert a.ply {name}"), 0);
        let found = run(&folder, &format!("verify {name}"), 0);
        assert_eq!(
            (&found["count"], &found["differences"]),
            (&made["count"], &json!([])),
            "{name}"
        );
        let stated = certificate(&folder, name);
        assert_eq!(stated["method"], json!("reference"), "{name}");
        // Each is what its name says.
        let said = ends(&folder, &format!("verify {name}"), 0);
        let first = said.lines().next().unwrap();
        assert!(first.contains("by its extension:"), "{first}");
    }
    refused(
        &folder,
        "convert a.ply g.svg",
        "SVG holds no third coordinate",
    );
    refused(
        &folder,
        "sample --size 6x6x6 --radius 1 --out g.json",
        "JSON holds no third coordinate",
    );

    let said = ends(&folder, "convert a.ply disks.csv --slice z=3", 0);
    assert!(said.contains("the plane z = 3 meets"), "{said}");
    let table = fs::read_to_string(folder.path().join("disks.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("x,y,radius,depth"));
    let mut count = 0;
    for line in lines {
        let row: Vec<f64> = line
            .split(',')
            .map(|field| field.parse().unwrap())
            .collect();
        assert!(
            (row[2] * row[2] + row[3] * row[3] - 1.0).abs() < 1e-9,
            "{line}"
        );
        count += 1;
    }
    // A ball of radius r meets a plane in 2 r: 1.47 disks for each r^2.
    assert!((30..80).contains(&count), "{count}");

    for picture in ["plane.png", "plane.svg"] {
        ends(
            &folder,
            &format!("draw a.ply {picture} --slice x=2.5 --size 200"),
            0,
        );
        assert!(folder.path().join(picture).exists());
    }
    // Places in no disk have the colour of gaps if they are asked for, and no dot has it.
    ends(
        &folder,
        "draw a.ply gaps.svg --slice x=2.5 --size 200 --gaps",
        0,
    );
    let has_gaps = |picture: &str| {
        let text = fs::read_to_string(folder.path().join(picture)).unwrap();
        text.contains("a83f92")
    };
    assert!(has_gaps("gaps.svg") && !has_gaps("plane.svg"));
    // A part of the plane has a part of its samples; the whole plane is the control.
    let drawn = |options: &str| {
        let said = ends(
            &folder,
            &format!("draw a.ply part.png --slice z=3 --size 200{options}"),
            0,
        );
        said.split(" samples drawn").next().unwrap().to_owned()
    };
    assert_eq!(drawn(""), count.to_string());
    let part = drawn(" --window 0 0 3 3");
    let (shown, all) = part.split_once(" of ").expect("a part of all");
    assert!(
        all == count.to_string() && shown.parse::<i32>().unwrap() < count / 2,
        "{part}"
    );
    refused(&folder, "draw a.ply plane.png", "--slice z=PLACE");
    refused(
        &folder,
        "convert a.ply disks.csv --slice z=7",
        "from 0 to 6",
    );
    refused(
        &folder,
        "convert a.ply disks.npy --slice z=3",
        "written as csv",
    );
    refused(&folder, "convert a.ply disks.csv --slice w=3", "no plane");
}

#[test]
fn balls_are_drawn_as_pictures_and_turn() {
    let folder = tempdir().unwrap();
    let made = "sample --size 5x5x5 --radius 1 --out a.ply";
    ends(&folder, made, 0);
    for (line, file) in [
        ("draw a.ply a.png --orbit --size 120", "a.png"),
        (
            "draw a.ply whole.png --orbit 300,30,1,whole --size 120",
            "whole.png",
        ),
        (
            "draw a.ply a.svg --orbit 10,-20 --size 120 --theme dark",
            "a.svg",
        ),
        // A direction that begins with a minus is no option.
        ("draw a.ply back.png --orbit -20,5 --size 120", "back.png"),
    ] {
        let said = ends(&folder, line, 0);
        assert!(said.contains("balls drawn into"), "{said}");
        assert!(folder.path().join(file).exists());
    }
    let pictures = ["a.png", "whole.png"].map(|name| fs::read(folder.path().join(name)).unwrap());
    assert_ne!(pictures[0], pictures[1]);
    let svg = fs::read_to_string(folder.path().join("a.svg")).unwrap();
    assert!(
        svg.contains("seen from 20 degrees below") && svg.contains("by the level"),
        "{svg}"
    );
    // The title is one sentence, with each fact once.
    let title = svg
        .split("<title>")
        .nth(1)
        .and_then(|rest| rest.split("</title>").next());
    assert_eq!(
        title.expect("a title").matches("balls").count(),
        1,
        "{title:?}"
    );

    // The colours are the levels of the file, whatever its order. Without them they are the order, if that is the one of
    // arrival, and otherwise there is one colour, without a legend.
    for (name, options, wanted) in [
        ("b.ply", "--shuffle 3", Some("by the level")),
        ("c.npy", "", Some("by arrival")),
        ("d.npy", "--shuffle 3", None),
    ] {
        ends(
            &folder,
            &made.replace("a.ply", &format!("{name} {options}")),
            0,
        );
        ends(
            &folder,
            &format!("draw {name} {name}.svg --orbit --size 120"),
            0,
        );
        let svg = fs::read_to_string(folder.path().join(format!("{name}.svg"))).unwrap();
        for legend in ["by the level", "by arrival"] {
            assert_eq!(svg.contains(legend), wanted == Some(legend), "{name}");
        }
    }

    let said = ends(&folder, "draw a.ply a.gif --orbit --turn --size 32", 0);
    assert!(said.contains("turned in 72 frames"), "{said}");
    assert!(
        fs::read(folder.path().join("a.gif"))
            .unwrap()
            .starts_with(b"GIF89a")
    );

    for (line, wanted) in [
        (
            "draw a.ply x.gif --orbit",
            "animations are those of --orbit --turn",
        ),
        ("draw a.ply x.svg --orbit --turn", ".gif, .apng or .png"),
        ("draw a.ply x.png --turn", "--orbit"),
        // Beside options that cannot stand with --orbit, --turn needs it all the same.
        ("draw a.ply x.gif --slice z=1 --turn", "give --orbit"),
        ("draw a.ply x.png --slice z=1 --turn", "give --orbit"),
        ("draw a.ply x.gif --gaps --turn", "give --orbit"),
        ("draw a.ply x.gif --slice z=1", "must be .png or .svg"),
        ("draw a.ply x.jpg --slice z=1", "must be .png or .svg"),
        ("draw a.ply x.png --orbit north", "is no direction"),
        ("draw a.ply x.png --orbit 300,120", "it must be -89 to 89"),
        ("draw a.ply x.png --orbit 300,30,50", "must be 0.5 to 20"),
        ("draw a.ply x.png --orbit --size 5000", "at most 4096"),
        (
            "draw a.ply x.png --orbit --slice z=1",
            "cannot be used with",
        ),
    ] {
        refused(&folder, line, wanted);
    }
    for file in ["x.png", "x.gif", "x.jpg", "x.svg"] {
        assert!(!folder.path().join(file).exists(), "{file}");
    }
    ends(&folder, "sample --radius 0.1 --out planar.csv", 0);
    refused(&folder, "draw planar.csv x.png --orbit", "no third side");
    refused(&folder, "draw a.ply x.png", "or of its balls, --orbit");
}

/// The memory of the whole command is asked for before: an allocation that fails would end the program, with a lock left
/// beside the file.
#[test]
#[cfg(target_os = "linux")]
fn what_memory_does_not_hold_is_refused_with_need_and_limit() {
    let folder = tempdir().unwrap();
    let limited = |options: &str| {
        let program = assert_cmd::cargo::cargo_bin("tilescope");
        let program = program.display();
        let line = format!(
            "ulimit -v 3000000; exec '{program}' sample --size 1x1x1 --threads 2 {options}"
        );
        let run = std::process::Command::new("sh")
            .args(["-c", &line])
            .current_dir(folder.path())
            .output();
        let run = run.expect("a shell");
        (
            run.status.code(),
            String::from_utf8_lossy(&run.stderr).into_owned(),
        )
    };
    // 27 million samples take more than ten gigabytes.
    let (code, said) = limited("--radius 0.003 --out a.npy");
    assert_eq!(code, Some(2), "{said}");
    for wanted in [
        "GB of memory are needed to make and verify",
        "(--no-verify)",
        "the system gives",
    ] {
        assert!(said.contains(wanted), "{said}");
    }
    let (code, said) = limited("--radius 0.003 --no-verify --out a.npy");
    assert!(
        code == Some(2) && said.contains("needed to make some"),
        "{said}"
    );
    assert_eq!(
        fs::read_dir(folder.path()).unwrap().count(),
        0,
        "a lock is left"
    );
    // The control: a set that fits is made under the same limit.
    let (code, said) = limited("--radius 0.1 --out a.npy");
    assert_eq!(code, Some(0), "{said}");
}

/// Sides are read in one word wherever single ones are.
#[test]
fn three_sides_in_one_word_are_read_by_all_commands() {
    let folder = tempdir().unwrap();
    ends(
        &folder,
        "sample --size 6X5\u{d7}7 --radius 1 --out a.xyz",
        0,
    );
    let found = run(
        &folder,
        "verify a.xyz --no-certificate --radius 1 --size 6x5x7",
        0,
    );
    assert_eq!(found["region"]["depth"], json!(7.0));
    ends(
        &folder,
        "convert a.xyz b.npy --no-certificate --radius 1 --size 6x5x7",
        0,
    );
    assert_eq!(certificate(&folder, "b.npy")["depth"], json!(7.0));
    run(
        &folder,
        "analyze a.xyz --no-certificate --radius 1 --size 6x5x7",
        0,
    );
    refused(
        &folder,
        "verify a.xyz --size 6x5x7 --depth 7",
        "cannot be used with",
    );
    refused(
        &folder,
        "verify a.xyz --size 6,5,7",
        "written with x between them",
    );
    // A box that is too small is said to be so, and what states another one.
    refused(
        &folder,
        "analyze a.xyz --no-certificate --depth 7",
        "--width, --height",
    );
}

/// A window has coordinates of space without end: an origin says where its box begins.
#[test]
fn windows_are_read_again_with_their_corner() {
    let folder = tempdir().unwrap();
    ends(
        &folder,
        "sample --radius 1 --window 5 -20 0.5 15 -10 10.5 --out w.csv",
        0,
    );
    let given = "--radius 1 --size 10x10x10 --boundary bounded";
    refused(&folder, &format!("verify w.csv {given}"), "--origin");
    // As of a window of a plane, gaps are along its sides alone: samples beyond them are not in the file.
    let corner = "--origin 5 -20 --origin-z 0.5";
    let found = run(&folder, &format!("verify w.csv {given} {corner}"), 1);
    assert_eq!(
        (&found["conflict_free"], &found["maximal"]),
        (&json!(true), &json!(false))
    );
    assert_eq!(found["origin"], json!([5.0, -20.0, 0.5]));
    let said = ends(&folder, &format!("verify w.csv {given} {corner}"), 1);
    assert!(said.contains("bounded at 5 -20 0.5"), "{said}");
    // Gaps are told at their places in the file.
    let place = said
        .split("gap: (")
        .nth(1)
        .and_then(|rest| rest.split(", ").nth(1));
    assert!(place.unwrap().starts_with('-'), "{said}");
    let said = ends(&folder, &format!("convert w.csv v.ply {given} {corner}"), 1);
    assert!(said.contains("conflict-free  yes"), "{said}");
    run(&folder, "verify v.ply", 1);
    // There --size is that of the picture.
    let sides = "--radius 1 --width 10 --height 10 --depth 10 --boundary bounded";
    ends(
        &folder,
        &format!("draw w.csv w.svg {sides} {corner} --slice y=-15 --size 100"),
        0,
    );
    // What is refused is named by its place in the file, too.
    refused(
        &folder,
        &format!("draw w.csv w.svg {sides} {corner} --slice y=5"),
        "the plane y = 5 lies beyond the domain, where y is from -20 to -10",
    );
    let below = "--origin 5 -20 --origin-z -2";
    refused(
        &folder,
        &format!("verify w.csv {given} {below}"),
        "[0, 10] from its corner at (5, -20, -2)",
    );
    // Planar sets have no third coordinate, and a certificate of a set in space states a box at 0.
    refused(
        &folder,
        "verify w.csv --radius 1 --origin 5 5 --origin-z 1",
        "--origin-z",
    );
    refused(&folder, "verify v.ply --origin 5 5", "begins at 0");
}

/// A thinned cloud is drawn, measured and converted by its own certificate.
#[test]
fn thinned_clouds_are_read_by_their_certificate() {
    let folder = tempdir().unwrap();
    // Far from 0, as clouds are.
    let mut text = "x,y,z\n".to_owned();
    for index in 0..1000 {
        let [x, y, z] = [index % 10, index / 10 % 10, index / 100];
        let _ = writeln!(text, "{},{},{}", 1000 + x, y - 50, f64::from(z) / 2.0);
    }
    fs::write(folder.path().join("cloud.csv"), text).unwrap();
    ends(&folder, "thin cloud.csv --radius 1.5 --out a.csv", 0);
    let disks = ends(&folder, "convert a.csv disks.csv --slice z=2", 0);
    assert!(disks.contains("the plane z = 2 meets"), "{disks}");
    let table = fs::read_to_string(folder.path().join("disks.csv")).unwrap();
    assert!(table.lines().nth(1).unwrap().starts_with("100"), "{table}");
    ends(&folder, "draw a.csv a.svg --slice x=1005 --size 100", 0);
    refused(
        &folder,
        "draw a.csv b.svg --slice x=5 --size 100",
        "beyond the domain",
    );
    ends(&folder, "draw a.csv a.png --orbit --size 64", 0);
    let found = run(&folder, "analyze a.csv", 0);
    assert_eq!(found["files"].as_array().unwrap().len(), 1);
    let said = ends(&folder, "convert a.csv b.ply", 0);
    assert!(said.contains("conflict-free  yes"), "{said}");
    assert_eq!(certificate(&folder, "b.ply")["thinned"], Value::Null);
    // The control: with a false certificate nothing is read.
    let path = folder.path().join("a.csv");
    let rows = fs::read_to_string(&path).unwrap();
    fs::write(&path, rows.trim_end().rsplit_once('\n').unwrap().0).unwrap();
    refused(&folder, "draw a.csv c.svg --slice z=2", "--no-certificate");

    // One that was thinned by x and y is a planar set.
    ends(
        &folder,
        "thin cloud.csv --radius 1.5 --xy --out flat.csv",
        0,
    );
    let said = ends(&folder, "draw flat.csv flat.png --size 100", 0);
    assert!(said.contains("samples drawn"), "{said}");
}

/// Two columns, or more than three without names, are no set in space; a cloud keeps what stands beside its points.
#[test]
fn other_numbers_of_columns_are_refused_with_what_is_needed() {
    let folder = tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let given = "--radius 1 --size 10x10x10";
    for (name, text, wanted) in [
        (
            "four.xyz",
            "1 2 3 1\n4 5 6 1\n",
            "line 1: 4 columns and no header, and a set in space has three",
        ),
        (
            "element.xyz",
            "C 1 2 3\nC 4 5 6\n",
            "4 columns and no header",
        ),
        (
            "two.xyz",
            "1 2\n4 5\n",
            "2 columns and no header, and a set in space has three: x, y and z",
        ),
        ("two.csv", "1,2\n4,5\n", "2 columns and no header"),
        ("four.csv", "1,2,3,4\n", "4 columns and no header"),
        (
            "named.csv",
            "x,y,w\n1,2,3\n",
            "no column is named z, and a set in space has x, y and z",
        ),
        (
            "others.csv",
            "a,b,c\n1,2,3\n",
            "no column is named x, and a set in space has x, y and z",
        ),
    ] {
        write(name, text);
        refused(&folder, &format!("verify {name} {given}"), wanted);
        refused(&folder, &format!("convert {name} out.ply {given}"), wanted);
    }
    // The controls: three columns, and names.
    write("three.xyz", "1 2 3\n4 5 6\n");
    write("names.xyz", "# x y z intensity\n1 2 3 1\n4 5 6 1\n");
    for name in ["three.xyz", "names.xyz"] {
        assert_eq!(
            run(&folder, &format!("verify {name} {given}"), 1)["count"],
            json!(2),
            "{name}"
        );
    }
    ends(&folder, "thin four.xyz --radius 1 --out thinned.xyz", 0);
    assert_eq!(
        fs::read_to_string(folder.path().join("thinned.xyz")).unwrap(),
        "1 2 3 1\n4 5 6 1\n"
    );
}

/// A verdict by one judge says why the other one, who was asked, did not judge.
#[test]
fn a_judge_that_declines_is_said_to_have_declined() {
    let folder = tempdir().unwrap();
    ends(&folder, "sample --size 5x5x5 --radius 1 --out a.csv", 0);
    let why = "(covered circles judge sets without conflicts alone)";
    for judge in ["", "--judge circles", "--judge both"] {
        let said = ends(
            &folder,
            &format!("verify a.csv --no-certificate --size 5x5x5 --radius 1.1 {judge}"),
            1,
        );
        assert!(said.contains(&format!("subdivision   {why}")), "{said}");
        let said = ends(&folder, &format!("verify a.csv {judge}"), 0);
        assert!(!said.contains(why), "{said}");
    }
    // Who asked for cubes alone needs no reason.
    let said = ends(
        &folder,
        "verify a.csv --no-certificate --size 5x5x5 --radius 1.1 --judge subdivision",
        1,
    );
    assert!(!said.contains(why), "{said}");
}

/// When each sample arrived, in columns of the file, goes with it through all commands.
#[test]
fn columns_of_arrival_and_level_stay_with_their_samples() {
    let folder = tempdir().unwrap();
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let made = "sample --size 6x5x7 --radius 1 --seed 7";
    let said = ends(&folder, &format!("{made} --out a.csv"), 0);
    assert!(!said.contains("note:"), "{said}");
    let table = read("a.csv");
    let (head, rows) = table.split_once('\n').unwrap();
    assert_eq!(head, "x,y,z,arrival,level");
    let rows: Vec<&str> = rows.lines().collect();
    for (number, row) in rows.iter().enumerate() {
        let fields: Vec<&str> = row.split(',').collect();
        assert_eq!(fields[3], number.to_string());
    }
    let level_of = |row: &str| -> u32 { row.rsplit(',').next().unwrap().parse().unwrap() };
    assert!(rows.is_sorted_by_key(|row| level_of(row)));
    assert!(level_of(rows[0]) == 0 && level_of(rows[rows.len() - 1]) > 3);

    // Through PLY and back it is the same table, byte for byte; a format without columns says that it has none.
    ends(&folder, "convert a.csv b.ply", 0);
    ends(&folder, "convert b.ply c.csv", 0);
    assert_eq!(read("c.csv"), table);
    let said = ends(&folder, "convert b.ply d.npy", 0);
    assert!(
        said.contains("PLY and CSV also keep when each sample arrived"),
        "{said}"
    );
    ends(&folder, "convert d.npy d.csv", 0);
    assert!(read("d.csv").starts_with("x,y,z\n"));

    // Shuffled files and thinned clouds have some of the rows, or all in another order.
    ends(&folder, &format!("{made} --shuffle 2 --out e.csv"), 0);
    ends(&folder, "thin a.csv --radius 1.6 --out f.csv", 0);
    for (name, is_whole) in [("e.csv", true), ("f.csv", false)] {
        let text = read(name);
        let found: Vec<&str> = text.lines().skip(1).collect();
        assert!(
            text.starts_with(head) && found.iter().all(|row| rows.contains(row)),
            "{name}"
        );
        assert_eq!(found.len() == rows.len(), is_whole, "{name}");
        assert_ne!(found, rows, "{name}");
    }
    for line in [
        "verify e.csv",
        "verify f.csv",
        "analyze e.csv",
        "draw b.ply z.png --slice z=3 --size 40",
    ] {
        ends(&folder, line, 0);
    }
    // Of the first samples of a set, too.
    ends(&folder, "sample --size 6x5x7 --exactly 150 --out g.csv", 0);
    assert_eq!(read("g.csv").lines().count(), 151);
    assert!(read("g.csv").lines().last().unwrap().contains(",149,"));

    // A window of space without end has levels, but no first sample from which arrivals could be counted.
    let window = "sample --radius 1 --window 0 0 0 5 5 5";
    let said = ends(&folder, &format!("{window} --out h.csv"), 0);
    assert!(!said.contains("note:"), "{said}");
    assert!(read("h.csv").starts_with("x,y,z,level\n"));

    // A file without a verdict says, too, that its format has no columns.
    for line in [
        format!("{window} --out h.npy"),
        format!("{made} --no-verify --out i.npy"),
    ] {
        let said = ends(&folder, &line, 0);
        assert!(said.contains("note: NumPy array keeps"), "{said}");
    }
}

/// The picture in README.md is what its commands make, for whoever has the repository.
#[test]
fn the_commands_of_the_readme_make_its_picture_of_balls() {
    const README: &str = include_str!("../../../../README.md");
    let folder = tempdir().unwrap();
    let is_wanted =
        |line: &&str| line.ends_with("--out balls.ply") || line.contains("orbit.png --orbit");
    let commands: Vec<&str> = README.lines().filter(is_wanted).collect();
    assert_eq!(commands.len(), 2, "{commands:?}");
    for command in commands {
        ends(&folder, command.trim_start_matches("tilescope "), 0);
    }
    let pictures = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/pictures");
    let made = fs::read(folder.path().join("orbit.png")).unwrap();
    assert!(made == fs::read(pictures.join("orbit.png")).unwrap());
}

#[test]
fn files_of_others_are_sets_in_space_where_a_third_side_is_given() {
    let folder = tempdir().unwrap();
    // A body-centred lattice in a box of 3.
    let mut text = String::new();
    for index in 0..27 {
        let corner = [index % 3, index / 3 % 3, index / 9].map(f64::from);
        for half in [0.0, 0.5] {
            let [x, y, z] = corner.map(|value| value + half);
            let _ = writeln!(text, "{x} {y} {z}");
        }
    }
    fs::write(folder.path().join("a.xyz"), text).unwrap();
    refused(
        &folder,
        "verify a.xyz --radius 0.8",
        "--depth gives a set in space its third side",
    );
    refused(
        &folder,
        "verify a.xyz --radius 0.8",
        "draw and convert take a plane of one by --slice",
    );
    // A thinned cloud needs no domain, and no third side.
    run(&folder, "thin a.xyz --radius 0.8 --out b.xyz", 0);
    refused(&folder, "thin a.xyz --radius-expression 0.8", "--xy");
    refused(
        &folder,
        "verify a.xyz --depth 3 --width 3 --height 3",
        "give --radius",
    );
    let given = "--width 3 --height 3 --depth 3";
    let found = run(&folder, &format!("verify a.xyz --radius 0.8 {given}"), 0);
    assert_eq!(
        (&found["passed"], &found["certificate"]),
        (&json!(true), &json!(false))
    );
    assert_eq!(
        run(&folder, &format!("verify a.xyz --radius 0.9 {given}"), 1)["passed"],
        json!(false)
    );
    refused(
        &folder,
        "verify a.xyz --radius 0.3 --depth 2",
        "--depth, --boundary, --origin and --origin-z state another domain",
    );

    // The smallest distance is the radius where none is known.
    ends(&folder, &format!("convert a.xyz a.ply {given}"), 0);
    let radius = certificate(&folder, "a.ply")["radius"].as_f64().unwrap();
    assert!((radius - 0.75_f64.sqrt()).abs() < 1e-12);

    // Three columns with z = 0 stay a planar set.
    fs::write(folder.path().join("flat.xyz"), "0.25 0.25 0\n0.75 0.75 0\n").unwrap();
    let found = run(&folder, "verify flat.xyz --radius 0.5", 0);
    assert_eq!(found["region"]["width"], json!(1.0));
}

#[test]
fn sets_are_analyzed_alone_and_averaged() {
    let folder = tempdir().unwrap();
    for seed in 1..=3 {
        let line = format!("sample --size 10x10x10 --radius 1 --seed {seed} --out {seed}.ply");
        ends(&folder, &line, 0);
    }

    let one = run(&folder, "analyze 1.ply --out report.html", 0);
    let measures = &one["files"][0]["measures"];
    let number = |key: &str| measures[key].as_f64().unwrap();
    assert!((number("density") - 0.7336).abs() < 0.01, "{measures}");
    assert!(
        (number("disks") - 2.0 * number("density")).abs() < 0.05,
        "{measures}"
    );
    assert!(number("min_distance_r") >= 1.0 && number("covering_radius_r") < 1.001);
    // Such sets have little power at low frequencies; noise has 1.
    assert!(
        number("low_power") < 0.1 && number("peak_power") > 1.3,
        "{measures}"
    );
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("Pair correlation") && page.contains("close packing"));
    // The three planes of the set, and those of no other.
    for axis in ["x", "y", "z"] {
        let title = format!("Power at k_{axis} = 0, 1.ply");
        assert_eq!(page.matches(&title).count(), 1, "{title}");
    }

    let all = run(
        &folder,
        "analyze 1.ply 2.ply 3.ply --average --out all.csv",
        0,
    );
    let pairs = &all["average"]["curves"]["pair_correlation"];
    let g = |bin: usize| pairs["y"][bin].as_f64().unwrap();
    // Nothing below the radius, and most just above it: 3.86 in large sets.
    assert!(g(19) < 1e-9);
    assert!((g(20) - 3.86).abs() < 0.3, "{pairs}");
    assert!(pairs["lower"][20].as_f64().unwrap() < g(20));
    assert_eq!(all["files"].as_array().unwrap().len(), 3);
    let table = fs::read_to_string(folder.path().join("all.csv")).unwrap();
    assert!(table.contains("density_standard_error"));
    ends(&folder, "analyze 1.ply 2.ply --average --out all.svg", 0);
    let picture = fs::read_to_string(folder.path().join("all.svg")).unwrap();
    assert!(picture.contains("Power at k_z = 0, mean of 2"));

    ends(&folder, "sample --radius 0.05 --out planar.csv", 0);
    refused(&folder, "analyze 1.ply planar.csv", "a planar one");
    refused(&folder, "analyze 1.ply --frequencies 0.01", "not between");
    // A set of another box is named, and the others are averaged.
    ends(&folder, "sample --size 6x6x6 --radius 1 --out small.ply", 0);
    let mixed = run(&folder, "analyze 1.ply small.ply 2.ply --average", 2);
    assert_eq!(mixed["files"].as_array().unwrap().len(), 2);
    assert!(
        mixed["failures"][0]["reason"]
            .as_str()
            .unwrap()
            .contains("its domain")
    );
}

#[test]
fn what_makes_no_set_in_space_is_refused_by_name() {
    let folder = tempdir().unwrap();
    let sample = |options: &str, wanted: &str| {
        refused(&folder, &format!("sample --size 6x6x6 {options}"), wanted);
    };
    for (options, name) in [
        ("--radius 1 --method kdrt", "--method kdrt"),
        ("--radius 1 --method exact", "--method exact"),
        ("--radius 1 --levels 3", "--levels"),
        ("--radius 1 --engine gpu", "--engine gpu"),
        ("--radius 1 --leaf 20", "--leaf"),
        ("--radius 1 --window 0 0 1 1", "--window"),
        ("--radius 1 --mask a.png", "--mask"),
        ("--radius-expression 1+x", "--radius-expression"),
        ("--radius 1 --origin 5 5", "--origin"),
        ("--radius 1 --judge delaunay", "judges planar sets alone"),
    ] {
        sample(options, name);
    }

    sample(
        "--radius 2",
        "the width is 3 r long; it must be at least 4 r",
    );
    sample("--count 5", "5 samples were asked for");
    refused(&folder, "sample --size 6x6x0 --radius 1", "the depth is 0");
    refused(&folder, "sample --size 6x6 --radius 1", "three are needed");
    refused(&folder, "sample --depth -1 --radius 0.1", "the depth is -1");
    refused(
        &folder,
        "sample --size 1x1x1 --radius 1e-4",
        "cubes of side r; it must hold at most",
    );
    refused(
        &folder,
        "sample --exactly 100",
        "--exactly needs --levels K, which KDRT alone has, or a third side",
    );
    ends(&folder, "sample --size 5x5x5 --radius 1 --out a.ply", 0);
    refused(&folder, "verify a.ply --prefix 5", "--prefix");
    refused(&folder, "verify a.ply --origin 1 1", "--origin");
    sample("--radius 1 --levels 3", "leave --levels out");

    // Combination is of planar sets, in a layout and in its files.
    let layout = |piece: &str, more: &str| {
        let text = format!(
            r#"{{"version": 1, "radius": 0.1, "boundary": "bounded", "columns": [1], "rows": [1], {more}"pieces": [{piece}]}}"#
        );
        fs::write(folder.path().join("layout.json"), text).unwrap();
    };
    layout(r#"{"file": "a.ply", "radius": 1}"#, "");
    refused(
        &folder,
        "combine layout.json",
        "its certificate states a third side",
    );
    layout(r#"{"seed": 1}"#, r#""depth": 2, "#);
    refused(
        &folder,
        "combine layout.json",
        "sets in space are not combined",
    );
}
