//! Sets at an origin, `GeoJSON` and other inputs, through the commands as their arguments are given.

use std::ffi::OsString;
use std::fs;

use anyhow::Result;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::{Arguments, Command, analyze, convert, curve, draw, sample, verify};

/// Runs a command; the words `@name` stand for files of the folder.
fn run(folder: &TempDir, words: &[&str]) -> Result<u8> {
    let word = |word: &&str| match word.strip_prefix('@') {
        Some(name) => folder.path().join(name).into_os_string(),
        None => OsString::from(word),
    };
    let words = std::iter::once("tilescope".into()).chain(words.iter().map(word));
    match Arguments::of(words)?.command.expect("a command") {
        Command::Sample(arguments) => sample::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Analyze(arguments) => analyze::run(&arguments),
        Command::Convert(arguments) => convert::run(&arguments),
        Command::Draw(arguments) => draw::run(&arguments),
        Command::Curve(arguments) => curve::run(&arguments),
        other => panic!("{other:?} reads no set"),
    }
}

fn refusal(folder: &TempDir, words: &[&str]) -> String {
    let error = run(folder, words).expect_err("a refusal");
    crate::describe(&error)
}

fn read(folder: &TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join(name)).expect(name)
}

fn certificate(folder: &TempDir, name: &str) -> Value {
    let text = read(folder, &format!("{name}.certificate.json"));
    serde_json::from_str(&text).expect("JSON")
}

const ORIGIN: [&str; 3] = ["--origin", "500000", "5400000"];

/// A folder with `at.csv`, a set at an origin, and `alone.csv`, the same without its certificate.
fn at_origin() -> TempDir {
    let folder = tempdir().expect("a folder");
    let words = ["sample", "--radius", "0.08", "--out", "@at.csv"];
    assert_eq!(
        run(&folder, &[&words[..], &ORIGIN].concat()).expect("made"),
        0
    );
    let [from, to] = ["at.csv", "alone.csv"].map(|name| folder.path().join(name));
    fs::copy(from, to).expect("copied");
    folder
}

#[test]
fn a_set_is_made_and_read_at_its_origin() {
    let folder = at_origin();
    assert!(
        read(&folder, "at.csv")
            .lines()
            .skip(1)
            .all(|row| row.starts_with("50000"))
    );
    let stated = certificate(&folder, "at.csv");
    assert_eq!(stated["format_version"], 2);
    assert_eq!(stated["origin"], json!([500_000.0, 5_400_000.0]));
    assert_eq!(stated["region"]["width"], 1.0);

    for words in [
        &["verify", "@at.csv"][..],
        &["analyze", "@at.csv"],
        &["draw", "@at.csv", "@at.svg"],
        &["convert", "@at.csv", "@at.ply"],
        &["verify", "@at.ply"],
        &["convert", "@at.csv", "@torus.txt"],
        &["verify", "@torus.txt"],
    ] {
        assert_eq!(run(&folder, words).expect("done"), 0, "{words:?}");
    }
    assert_eq!(certificate(&folder, "at.ply")["origin"], stated["origin"]);
    assert_eq!(certificate(&folder, "torus.txt")["format_version"], 1);
}

#[test]
fn the_option_stands_in_for_a_certificate() {
    let folder = at_origin();
    let outside = refusal(&folder, &["verify", "@alone.csv", "--radius", "0.08"]);
    assert!(
        outside.contains("and --origin state another domain"),
        "{outside}"
    );
    for words in [
        &["verify", "@alone.csv", "--radius", "0.08"][..],
        &["analyze", "@alone.csv"],
        &["draw", "@alone.csv", "@alone.png", "--size", "64"],
        &[
            "draw",
            "@alone.csv",
            "@part.png",
            "--size",
            "64",
            "--window",
            "500000",
            "5400000",
            "500000.5",
            "5400000.5",
        ],
        &["convert", "@alone.csv", "@alone.npy", "--radius", "0.08"],
    ] {
        let words = [words, &ORIGIN].concat();
        assert_eq!(run(&folder, &words).expect("done"), 0, "{words:?}");
    }
    assert_eq!(certificate(&folder, "alone.npy")["origin"][1], 5_400_000.0);

    // The certificate's origin is compared with another that is given.
    let moved = [
        "verify", "@at.csv", "--origin", "499999.9", "5400000", "--width", "2",
    ];
    assert_eq!(run(&folder, &moved).expect("a verdict"), 1);
}

#[test]
fn an_origin_is_refused_where_it_would_spoil_the_set() {
    let folder = tempdir().expect("a folder");
    let made = [
        "sample", "--radius", "0.08", "--out", "@far.csv", "--origin", "0",
    ];
    let far = refusal(&folder, &[&made[..], &["1e10"]].concat());
    assert!(
        far.contains("are 1.9e-6 apart, more than 0.00001 of the radius 0.08"),
        "{far}"
    );
    assert!(!folder.path().join("far.csv").exists());
    let torus = [
        "sample", "--radius", "0.08", "--out", "@far.rps", "--origin", "1", "1",
    ];
    assert!(refusal(&folder, &torus).contains("begins at 0 0"));
    let zero = [
        "sample",
        "--radius",
        "0.08",
        "--out",
        "@zero.csv",
        "--origin",
        "0",
        "0",
    ];
    assert_eq!(run(&folder, &zero).expect("made"), 0);
    assert_eq!(certificate(&folder, "zero.csv")["format_version"], 1);
}

#[test]
fn degrees_are_refused_unless_they_are_said_to_be_planar() {
    let folder = tempdir().expect("a folder");
    let text = r#"{"type": "MultiPoint", "coordinates": [[8.5, 47.4], [8.6, 47.3], [8.7, 47.5]]}"#;
    fs::write(folder.path().join("a.geojson"), text).expect("written");
    for words in [
        &["verify", "@a.geojson", "--radius", "0.01"][..],
        &["convert", "@a.geojson", "@a.csv"],
        &["draw", "@a.geojson", "@a.svg"],
    ] {
        let refused = refusal(&folder, words);
        assert!(
            refused.contains("point 0 at (8.5, 47.4) lies beyond the domain"),
            "{refused}"
        );
        assert!(
            refused.ends_with("--planar takes them as they are"),
            "{refused}"
        );
    }
    let planar = ["verify", "@a.geojson", "--radius", "0.01", "--planar"];
    assert!(refusal(&folder, &planar).contains("lies outside the region"));
    let within = ["--width", "60", "--height", "60", "--boundary", "bounded"];
    let verify = ["verify", "@a.geojson", "--radius", "0.01"];
    assert_eq!(
        run(&folder, &[&verify[..], &within].concat()).expect("a verdict"),
        1
    );
}

/// The bytes of a picture of gaps, as they are on every machine: no function of the platform is in them.
const GAPS: &str = "blake3:938e41c567f06365586a72d4af1b674a9b0ad7e2711a62c27e1ab374088540f1";

#[test]
fn pictures_of_gaps_have_the_same_bytes_everywhere() {
    let folder = tempdir().expect("a folder");
    let rows = (1..64).map(|k| format!("{},{}", f64::from(k % 8) / 8.0, f64::from(k / 8) / 8.0));
    let rows = rows.collect::<Vec<String>>().join("\n");
    fs::write(folder.path().join("hole.csv"), rows).expect("written");
    let words = [
        "draw",
        "@hole.csv",
        "@arcs.svg",
        "--radius",
        "0.09",
        "--gaps",
    ];
    run(&folder, &words).expect("drawn");
    let svg = read(&folder, "arcs.svg");
    assert!(svg.contains("<polyline"));
    assert_eq!(tilescope_formats::bytes_digest(svg.as_bytes()), GAPS);
}

#[test]
fn parquet_is_refused_by_name() {
    let folder = tempdir().expect("a folder");
    fs::write(folder.path().join("a.parquet"), b"PAR1\x15\x04PAR1").expect("written");
    let refused = refusal(&folder, &["verify", "@a.parquet", "--radius", "0.1"]);
    assert!(
        refused.contains("Parquet and GeoParquet cannot be read here; the Python package"),
        "{refused}"
    );
}

#[test]
fn layouts_and_results_bear_a_byte_order_mark() {
    let mark = |text: &str| format!("\u{FEFF}{text}");
    let layout = r#"{ "version": 1, "radius": 0.05, "columns": [1], "rows": [1], "pieces": [{ "seed": 1 }] }"#;
    let read = |text: &str| tilescope_core::combine::file::Layout::from_json(text.as_bytes());
    assert_eq!(
        read(&mark(layout)).expect("marked"),
        read(layout).expect("plain")
    );
    let results = r#"{ "version": 1, "learner": "Ada", "entries": [] }"#;
    let read = tilescope_lessons::results::Results::read;
    assert_eq!(
        read(&mark(results)).expect("marked"),
        read(results).expect("plain")
    );
}

#[test]
fn errors_advise_what_the_command_has() {
    let folder = tempdir().expect("a folder");
    let few = refusal(&folder, &["sample", "--exactly", "200", "--levels", "3"]);
    assert!(
        few.ends_with("must be at least 20 r: choose fewer levels or more samples"),
        "{few}"
    );
}

#[test]
fn a_small_bounded_domain_is_sampled() {
    let folder = tempdir().expect("a folder");
    let sides = ["--width", "30", "--height", "20", "--boundary", "bounded"];
    for method in ["kdrt", "reference"] {
        for engine in ["sequential", "parallel"] {
            let words = [
                "sample", "--radius", "5", "--method", method, "--engine", engine,
            ];
            assert_eq!(
                run(&folder, &[&words[..], &sides].concat()).expect("made"),
                0
            );
        }
    }
    let narrow = ["sample", "--radius", "5.1"];
    let refused = refusal(&folder, &[&narrow[..], &sides].concat());
    assert!(refused.contains("it must be at least 4 r"), "{refused}");
}

/// A set by exact tiling has a true certificate, and the options that it states make the same set.
#[test]
fn an_exact_set_is_made_again_from_its_certificate() {
    let folder = tempdir().expect("a folder");
    let size = ["--count", "700", "--boundary", "bounded", "--seed", "9"];
    let made = [
        "sample",
        "--method",
        "exact",
        "--dihedral",
        "--out",
        "@a.csv",
    ];
    assert_eq!(run(&folder, &[&made[..], &size].concat()).expect("made"), 0);
    assert_eq!(run(&folder, &["verify", "@a.csv"]).expect("judged"), 0);
    assert_eq!(
        run(&folder, &["draw", "@a.csv", "@a.svg"]).expect("drawn"),
        0
    );

    let first = certificate(&folder, "a.csv");
    let stated = &first["parameters"];
    assert_eq!(first["method"], "exact");
    // A small set has a pattern of 200 r, and of its own seed.
    assert_eq!(
        (&stated["pattern"]["side"], &stated["pattern"]["seed"]),
        (&200.0.into(), &9.into())
    );
    let independent = stated["pattern_samples"].as_f64().expect("a number");
    assert!((27_000.0..29_000.0).contains(&independent));
    let count = first["count"].as_f64().expect("a number");
    assert_eq!(stated["samples_per_pattern_sample"], count / independent);
    assert!(
        stated["law"]
            .as_str()
            .expect("words")
            .starts_with("exact in every window in which no part")
    );
    assert!(stated.get("order").is_none() && stated.get("insertion").is_none());

    let text = |value: &Value| value.to_string().trim_matches('"').to_owned();
    let pattern = &stated["pattern"];
    let options = [
        ("--radius", &stated["radius"]),
        ("--width", &stated["width"]),
        ("--height", &stated["height"]),
        ("--boundary", &stated["boundary"]),
        ("--seed", &stated["seed"]),
        ("--leaf", &stated["leaf"]),
        ("--pattern-side", &pattern["side"]),
        ("--pattern-seed", &pattern["seed"]),
        ("--pattern-boundary", &pattern["boundary"]),
    ];
    let options: Vec<[String; 2]> = options
        .map(|(name, value)| [name.to_owned(), text(value)])
        .into();
    let options: Vec<&str> = options.iter().flatten().map(String::as_str).collect();
    let again = [
        "sample",
        "--method",
        "exact",
        "--dihedral",
        "--out",
        "@b.csv",
    ];
    assert_eq!(
        run(&folder, &[&again[..], &options].concat()).expect("made"),
        0
    );
    assert_eq!(read(&folder, "a.csv"), read(&folder, "b.csv"));
    assert_eq!(certificate(&folder, "b.csv")["parameters"], *stated);
}

#[test]
fn exact_tiling_refuses_by_its_name_what_it_has_no_use_for() {
    let folder = tempdir().expect("a folder");
    let given: [&[&str]; 7] = [
        &["--order", "own-block-first"],
        &["--insertion", "uniform"],
        &["--search", "2"],
        &["--variant", "staged"],
        &["--levels", "2"],
        &["--engine", "gpu"],
        &["--resume", "--out", "@set.csv", "--engine", "sequential"],
    ];
    for options in given {
        let words = ["sample", "--radius", "0.05", "--method", "exact"];
        let refused = refusal(&folder, &[&words[..], options].concat());
        assert!(refused.starts_with(options[0]), "{refused}");
    }

    // A default that is typed is meant, too.
    let words = [
        "sample", "--radius", "0.05", "--method", "exact", "--search", "4",
    ];
    assert!(refusal(&folder, &words).starts_with("--search is for KDRT"));
    let curve = [
        "curve", "--radius", "0.05", "--method", "exact", "--order", "index",
    ];
    let refused = refusal(&folder, &curve);
    assert!(refused.starts_with("--order is for KDRT"), "{refused}");
    let curve = [
        "curve",
        "--radius",
        "0.05",
        "--method",
        "exact",
        "--pattern",
        "@set.csv",
    ];
    let refused = refusal(&folder, &curve);
    assert!(refused.starts_with("--pattern needs"), "{refused}");
}

/// A set by the reference sampler is a pattern of exact tiling: its darts are thrown again from the seed of its
/// certificate, and the file must have the samples that they make. Controls: sets of which that is not true are refused,
/// each with the reason.
#[test]
fn exact_tiling_takes_a_set_by_the_reference_sampler_as_its_pattern() {
    let folder = tempdir().expect("a folder");
    let reference = "sample --radius 0.05 --method reference --seed 7";
    let made = |words: &str| {
        let words: Vec<&str> = words.split(' ').collect();
        assert_eq!(run(&folder, &words).expect("made"), 0, "{words:?}");
    };
    for words in [
        "--out @set.csv",
        "--out @narrow.npy --precision f32 --shuffle 3",
        "--boundary bounded --out @bounded.csv",
        "--width 1.1 --out @oblong.csv",
    ] {
        made(&format!("{reference} {words}"));
    }
    made("sample --radius 0.05 --seed 7 --out @kdrt.csv");

    let exact = "sample --count 900 --leaf 8 --method exact --dihedral";
    made(&format!("{exact} --pattern @set.csv --out @a.csv"));
    made(&format!("{exact} --pattern @narrow.npy --out @b.csv"));
    // The pattern of the same side and seed has other darts, and so makes another set.
    made(&format!(
        "{exact} --pattern-side 20 --pattern-seed 7 --out @c.csv"
    ));
    assert_eq!(read(&folder, "a.csv"), read(&folder, "b.csv"));
    assert_ne!(read(&folder, "a.csv"), read(&folder, "c.csv"));
    let parameters = &certificate(&folder, "a.csv")["parameters"];
    let pattern = &parameters["pattern"];
    assert_eq!(
        (&pattern["file"], &pattern["seed"]),
        (&json!("set.csv"), &json!(7))
    );
    let count = &certificate(&folder, "set.csv")["count"];
    assert_eq!(parameters["pattern_samples"], *count);

    // The third sample is moved by less than the lattice would show. The other certificate states another seed.
    let text = read(&folder, "set.csv");
    let third = text.lines().nth(3).expect("a sample");
    let (x, y) = third.split_once(',').expect("two numbers");
    let right = x.parse::<f64>().expect("a number") + 1e-9;
    let moved = text.replace(third, &format!("{right},{y}"));
    let stated = certificate(&folder, "set.csv");
    let mut other = stated.clone();
    other["parameters"]["seed"] = json!(8);
    for (name, text, stated) in [("moved.csv", &moved, stated), ("other.csv", &text, other)] {
        let path = |name: &str| folder.path().join(name);
        fs::write(path(name), text).expect("written");
        let beside = format!("{name}.certificate.json");
        fs::write(path(&beside), stated.to_string()).expect("written");
    }

    for (file, why) in [
        ("kdrt.csv", "the pattern is a set by \"kdrt\""),
        ("bounded.csv", "the pattern's domain is bounded"),
        ("oblong.csv", "the pattern's domain is 1.1 x 1"),
        ("moved.csv", "is not true: digest"),
        ("other.csv", "sample 1 of the pattern"),
    ] {
        let words = format!("{exact} --pattern @{file}");
        let words: Vec<&str> = words.split(' ').collect();
        let refused = refusal(&folder, &words);
        assert!(refused.contains(why), "{refused}");
    }
}

/// A window of an exact tiling has the whole's samples there, and is refused where the whole would have to be made.
#[test]
fn a_window_of_an_exact_set_has_the_samples_of_the_whole() {
    let folder = tempdir().expect("a folder");
    let words = ["sample", "--method", "exact", "--radius", "0.02"];
    let window = ["--window", "0.4", "0.3", "0.9", "0.8", "--out", "@part.csv"];
    for options in [&["--out", "@whole.csv"][..], &window] {
        let made = run(&folder, &[&words[..], options].concat());
        assert_eq!(made.expect("made"), 0);
    }

    let places = |name: &str| -> Vec<[f64; 2]> {
        let text = fs::read_to_string(folder.path().join(name)).expect("a file");
        let number = |word: &str| word.trim().parse().ok();
        let place = |line: &str| {
            let (x, y) = line.split_once(',')?;
            Some([number(x)?, number(y)?])
        };
        text.lines().filter_map(place).collect()
    };
    let inside = |[x, y]: &[f64; 2]| (0.4..0.9).contains(x) && (0.3..0.8).contains(y);
    let mut expected: Vec<_> = places("whole.csv").into_iter().filter(inside).collect();
    let mut found = places("part.csv");
    for places in [&mut expected, &mut found] {
        places.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    }
    assert!(found.len() > 300 && found == expected, "{}", found.len());

    let counted = ["sample", "--method", "exact", "--count", "500"];
    let refused = refusal(&folder, &[&counted[..], &window].concat());
    assert!(
        refused.starts_with("--count would make the whole set"),
        "{refused}"
    );
}
