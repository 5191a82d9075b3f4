//! Stipples, end to end: made, saved in all formats, verified as prefixes, spoilt, and refused.

use std::fs;

use png::ColorType;
use predicates::str::contains;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::support::{image, names, tilescope};

const PHOTO: &[u8] = include_bytes!("images/photo.jpg");
const PROGRESSIVE: &[u8] = include_bytes!("images/progressive.jpg");
const INKS: &[u8] = include_bytes!("images/cmyk.jpg");

/// Runs the program and returns its one JSON object.
fn run(folder: &TempDir, line: &str, code: i32) -> Value {
    let words = line.split_whitespace();
    let assert = tilescope(folder).args(words).assert().code(code);
    serde_json::from_slice(&assert.get_output().stdout).expect("one JSON object")
}

/// Returns a folder with a photograph.
fn with_photo() -> TempDir {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("photo.jpg"), PHOTO).unwrap();
    folder
}

fn text(folder: &TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join(name)).unwrap()
}

#[test]
fn a_stipple_has_exactly_the_dots_and_is_verified_as_a_prefix() {
    let folder = with_photo();
    let made = run(
        &folder,
        "stipple photo.jpg --dots 900 --out a.svg --json",
        0,
    );
    assert_eq!(
        (&made["count"], &made["valid"]),
        (&json!(900), &json!(true))
    );
    assert!(made["made"].as_u64().unwrap() >= 900);
    // Few runs are needed.
    assert!((1..=4).contains(&made["runs"].as_u64().unwrap()), "{made}");
    let factor = made["covering_factor"].as_f64().unwrap();
    assert!((1.0..1.2).contains(&factor), "{made}");

    let verify = "verify a.svg --density-image photo.jpg";
    let verified = run(&folder, &format!("{verify} --json"), 0);
    assert_eq!(verified["differences"], json!([]), "{verified}");
    let prefix = json!({ "made": made["made"], "kept": 900, "factor": factor });
    assert_eq!(
        (&verified["prefix"], &verified["passed"]),
        (&prefix, &json!(true))
    );
    let said = tilescope(&folder).args(verify.split(' ')).assert();
    let said = String::from_utf8_lossy(&said.get_output().stdout).into_owned();
    assert!(
        said.contains("prefix         yes") && !said.contains("maximal"),
        "{said}"
    );
    // Without the image there is nothing to judge by.
    let refused = tilescope(&folder)
        .args(["verify", "a.svg"])
        .assert()
        .code(2);
    refused.stderr(contains("--density-image photo.jpg"));

    // Each format has the same dots, and a smaller number of dots begins with the same ones only by chance.
    for name in ["a.csv", "a.ply", "a.npy", "a.json", "a.xyz", "a.dat"] {
        let again = run(
            &folder,
            &format!("stipple photo.jpg --dots 900 --out {name} --threads 3 --json"),
            0,
        );
        assert_eq!(
            again["positions_digest"], made["positions_digest"],
            "{name}"
        );
        let line = format!("verify {name} --density-image photo.jpg --json");
        assert_eq!(run(&folder, &line, 0)["prefix"]["kept"], 900, "{name}");
    }
    assert!(text(&folder, "a.csv").starts_with("x,y,radius\n"));
    let other = run(&folder, "stipple photo.jpg --dots 900 --seed 2 --json", 0);
    assert_ne!(other["positions_digest"], made["positions_digest"]);

    // A copy in another format is the same prefix.
    let convert = ["convert", "a.csv", "b.ply", "--density-image", "photo.jpg"];
    let converted = tilescope(&folder).args(convert).assert().success();
    converted.stdout(contains("prefix         yes"));
    run(&folder, "verify b.ply --density-image photo.jpg --json", 0);
}

#[test]
fn tone_white_and_what_runs_on_are_stated_and_made_again() {
    let folder = with_photo();
    fs::write(folder.path().join("progressive.jpg"), PROGRESSIVE).unwrap();
    // The left half is transparent, the right one grey: on paper, in both senses.
    let pixel = |index: usize| [90, 120, 60, if index % 40 < 20 { 0 } else { 255 }];
    let data: Vec<u8> = (0..40 * 30).flat_map(pixel).collect();
    image(&folder, "half.png", [40, 30], ColorType::Rgba, &data);

    for (name, options) in [
        ("photo.jpg", "--gamma 2.2 --contrast 1.3"),
        ("photo.jpg", "--white 0 --width 12.5"),
        ("progressive.jpg", "--invert --run-on"),
        ("half.png", "--invert --white 0.1 --dot-size darkness"),
        ("half.png", "--run-on --dot-radius 0.2"),
    ] {
        let line = format!("stipple {name} --dots 500 {options} --out a.svg --json");
        assert_eq!(run(&folder, &line, 0)["count"], 500, "{options}");
        let verified = run(
            &folder,
            &format!("verify a.svg --density-image {name} --json"),
            0,
        );
        assert_eq!(verified["passed"], true, "{options}: {verified}");
    }

    // No dot lies where the paper is seen.
    let dots = text(&folder, "a.svg");
    let dots = dots
        .lines()
        .filter_map(|line| line.strip_prefix("<circle cx=\""));
    let places = dots.map(|dot| dot.split('"').next().unwrap().parse::<f64>().unwrap());
    assert!(places.clone().all(|x| (20.0..40.0).contains(&x)) && places.count() == 500);
}

#[test]
fn what_is_false_of_a_stipple_is_found() {
    let folder = with_photo();
    let make = || {
        run(
            &folder,
            "stipple photo.jpg --dots 600 --out a.csv --json",
            0,
        )
    };
    let made = make();
    let verify = || run(&folder, "verify a.csv --density-image photo.jpg --json", 1);
    let has = |found: &Value, field: &str| {
        let all = found["differences"].as_array().unwrap();
        all.iter().any(|one| one["field"] == field)
    };
    let path = folder.path().join("a.csv.certificate.json");
    let stated = fs::read_to_string(&path).unwrap();
    let certificate: Value = serde_json::from_str(&stated).unwrap();
    let change = |change: &dyn Fn(&mut Value)| {
        let mut other = certificate.clone();
        change(&mut other);
        fs::write(&path, other.to_string()).unwrap();
        verify()
    };

    let factor = made["covering_factor"].as_f64().unwrap();
    for false_factor in [1.0, factor * 0.999, factor * 1.001] {
        let found = change(&|other| other["prefix"]["factor"] = false_factor.max(1.0).into());
        // The set itself is as it was.
        assert!(
            has(&found, "prefix.factor") && found["valid"] == true,
            "{found}"
        );
    }
    assert!(has(
        &change(&|other| other["prefix"]["kept"] = 599.into()),
        "prefix.kept"
    ));
    let darker = |other: &mut Value| other["parameters"]["density-image"]["gamma"] = 1.1.into();
    assert!(has(&change(&darker), "radius"));
    // The middle of the photograph is not as dark as that: dots there would be outside.
    let mut whiter = certificate.clone();
    whiter["parameters"]["white"] = 0.3.into();
    fs::write(&path, whiter.to_string()).unwrap();
    let line = "verify a.csv --density-image photo.jpg";
    let refused = tilescope(&folder).args(line.split(' ')).assert().code(2);
    refused.stderr(contains("lies outside the shape"));

    // A dot is removed, and everything that follows from the file's bytes is made to agree.
    let whole = text(&folder, "a.csv");
    for line in [1, 100] {
        let kept = (whole.lines().enumerate()).filter(|&(index, _)| index != line);
        let kept: Vec<&str> = kept.map(|(_, line)| line).collect();
        fs::write(folder.path().join("a.csv"), kept.join("\n") + "\n").unwrap();
        let found = change(&|other| {
            other["count"] = 599.into();
            other["prefix"]["kept"] = 599.into();
        });
        assert!(has(&found, "prefix.factor"), "{line}: {found}");
    }
    // A dot is put beside another one.
    let first = whole.lines().nth(1).unwrap();
    fs::write(folder.path().join("a.csv"), format!("{whole}{first}\n")).unwrap();
    let found = change(&|_| ());
    assert_eq!(
        (&found["conflicts"], &found["valid"]),
        (&json!(1), &json!(false))
    );

    // Without the part the set is judged as a whole one, and is none.
    make();
    let mut whole: Value = serde_json::from_str(&stated).unwrap();
    whole.as_object_mut().unwrap().remove("prefix");
    fs::write(&path, whole.to_string()).unwrap();
    let found = verify();
    assert!(
        found["maximal"] == false && found["valid"] == false,
        "{found}"
    );
}

#[test]
fn pictures_stand_upright_in_the_colours_that_are_asked_for() {
    let folder = tempdir().unwrap();
    // The upper half is black, the lower one white.
    let data: Vec<u8> = (0..64 * 64)
        .map(|index| if index < 64 * 32 { 0 } else { 255 })
        .collect();
    image(&folder, "half.png", [64, 64], ColorType::Grayscale, &data);
    let colours = "--paper #ffeedd --ink #102030";
    let line = format!("stipple half.png --dots 300 {colours} --out a.png --size 128 --json");
    let made = run(&folder, &line, 0);
    assert_eq!(
        (&made["valid"], &made["certificate"]),
        (&json!(true), &Value::Null)
    );

    let file = std::io::BufReader::new(fs::File::open(folder.path().join("a.png")).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((info.width, info.height), (128, 128));
    let samples = info.color_type.samples();
    let at = |x: usize, y: usize| &pixels[(y * 128 + x) * samples..][..3];
    let light = |rows: std::ops::Range<usize>| {
        let all = rows.flat_map(|y| (0..128).map(move |x| (x, y)));
        all.filter(|&(x, y)| at(x, y) == [0xff, 0xee, 0xdd]).count()
    };
    assert!(light(68..128) == 60 * 128, "no dot lies below");
    assert!(light(0..60) < 60 * 128 / 2, "and ink above");

    run(
        &folder,
        &format!("stipple half.png --dots 300 {colours} --out a.svg --json"),
        0,
    );
    let svg = text(&folder, "a.svg");
    assert!(svg.contains("fill=\"#ffeedd\"") && svg.contains("fill=\"#102030\""));
    // y points up in the group, where black is above 32.
    assert!(svg.contains("transform=\"matrix(1 0 0 -1 0 64)\""));
    let heights = svg.lines().filter_map(|line| line.split("cy=\"").nth(1));
    let mut heights = heights.map(|rest| rest.split('"').next().unwrap().parse::<f64>().unwrap());
    assert!(heights.all(|y| y >= 32.0));
}

#[test]
fn what_cannot_be_stippled_is_refused_and_nothing_is_lost() {
    let folder = with_photo();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    write("text.png", b"no image");
    write("inks.jpg", INKS);
    write("cut.jpg", &PHOTO[..PHOTO.len() - 90]);
    let white = [255_u8; 16];
    image(&folder, "white.png", [4, 4], ColorType::Grayscale, &white);
    let bytes = fs::read(folder.path().join("white.png")).unwrap();
    let sized = |side: u32| {
        let mut other = bytes.clone();
        other[16..20].copy_from_slice(&side.to_be_bytes());
        other[20..24].copy_from_slice(&side.to_be_bytes());
        other
    };
    write("none.png", &sized(0));
    write("vast.png", &sized(30_000));
    let mut large = PHOTO.to_vec();
    let frame = large
        .windows(2)
        .position(|two| two == [0xff, 0xc0])
        .unwrap();
    large[frame + 5..frame + 9].copy_from_slice(&[0x75, 0x30, 0x75, 0x30]);
    write("vast.jpg", &large);
    let mut animated = png::Encoder::new(
        fs::File::create(folder.path().join("moving.png")).unwrap(),
        1,
        1,
    );
    animated.set_animated(2, 0).unwrap();
    let mut writer = animated.write_header().unwrap();
    writer.write_image_data(&[0]).unwrap();
    writer.write_image_data(&[0]).unwrap();
    writer.finish().unwrap();
    write("a.svg", b"kept");

    let before = names(folder.path());
    for (line, wanted) in [
        ("text.png --dots 9", "text.png: it is no PNG or JPEG image"),
        ("inks.jpg --dots 9", "four inks (CMYK)"),
        ("cut.jpg --dots 9", "cut.jpg: the image cannot be decoded"),
        ("none.png --dots 9", "0 x 0 pixels; from 1 to 67108864"),
        (
            "vast.png --dots 9",
            "30000 x 30000 pixels; from 1 to 67108864",
        ),
        (
            "vast.jpg --dots 9",
            "30000 x 30000 pixels; from 1 to 67108864",
        ),
        ("moving.png --dots 9", "the image is animated"),
        (
            "white.png --dots 9",
            "no place of the image is darker than white",
        ),
        ("photo.jpg --dots 0", "0 is not in 1.."),
        (
            "photo.jpg --dots 9 --gamma 0",
            "the gamma is 0; it must be from 0.1 to 10",
        ),
        (
            "photo.jpg --dots 9 --contrast -1",
            "the contrast is -1; it must be from 0 to 100",
        ),
        (
            "photo.jpg --dots 9 --white 0.7",
            "the white is 0.7; it must be from 0 to 0.5",
        ),
        (
            "photo.jpg --dots 9 --ink red",
            "a colour is written as #rrggbb",
        ),
        ("photo.jpg --dots 9 --dot-radius 0", "--dot-radius is 0"),
        ("photo.jpg --dots 90000000", "90000000 are too many"),
        ("photo.jpg --dots 2", "--dots 2 are too few"),
    ] {
        let words = format!("stipple {line} --out a.svg");
        let refused = tilescope(&folder).args(words.split(' ')).assert().code(2);
        refused.stderr(contains(wanted));
        assert_eq!(text(&folder, "a.svg"), "kept", "{line}");
        assert_eq!(names(folder.path()), before, "{line}");
    }
    // An image is not written over.
    let same = "stipple photo.jpg --dots 9 --format csv --out photo.jpg";
    let refused = tilescope(&folder).args(same.split(' ')).assert().code(2);
    refused.stderr(contains("would be written over this input"));
    assert_eq!(fs::read(folder.path().join("photo.jpg")).unwrap(), PHOTO);
}

#[test]
fn samples_follow_photographs_too() {
    let folder = with_photo();
    let sample = "sample --density-image photo.jpg --count 700 --out a.csv --json";
    assert_eq!(run(&folder, sample, 0)["valid"], true);
    run(&folder, "verify a.csv --density-image photo.jpg --json", 0);
    let radii = "sample --radius-image photo.jpg --radius 0.02..0.1 --out b.csv --json";
    assert_eq!(run(&folder, radii, 0)["valid"], true);
    run(&folder, "verify b.csv --radius-image photo.jpg --json", 0);
}
