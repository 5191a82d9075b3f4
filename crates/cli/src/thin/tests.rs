//! Files from end to end but for the process: thinned, verified, and tampered with.

use std::fmt::Write;
use std::fs;

use clap::Parser;
use tempfile::TempDir;
use tilescope_formats::{bytes_digest, positions_digest};

mod space;

use super::*;
use crate::{Arguments, Command, EXIT_FINE, EXIT_NEGATIVE, verify};

/// A folder with a table of 60 x 60 points, a tenth apart, with columns beside x and y.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut table = "id,x,y,height,name,reach\n".to_owned();
    for at in 0..3600_u32 {
        let (x, y) = (f64::from(at % 60) * 0.1, f64::from(at / 60) * 0.1 + 500.0);
        let height = at.wrapping_mul(2_654_435_761) >> 20;
        let reach = 0.15 + f64::from(height % 8) * 0.1;
        writeln!(table, "{at},{x},{y},{height},\"a, {at}\",{reach}").unwrap();
    }
    fs::write(folder.path().join("cloud.csv"), table).unwrap();
    folder
}

/// Runs a command on files of a folder: words that end in a known extension are files.
fn words(folder: &TempDir, command: &str, words: &str) -> Vec<String> {
    let is_file = |word: &str| {
        [".csv", ".ply", ".npy", ".geojson"]
            .iter()
            .any(|end| word.ends_with(end))
    };
    let word = |word: &str| {
        if is_file(word) {
            folder.path().join(word).display().to_string()
        } else {
            word.to_owned()
        }
    };
    let all = ["tilescope", command].map(str::to_owned).into_iter();
    all.chain(words.split_whitespace().map(word)).collect()
}

fn thin(folder: &TempDir, line: &str) -> Result<ThinnedFile> {
    let words = words(folder, "thin", line);
    match Arguments::try_parse_from(words)?.command {
        Some(Command::Thin(arguments)) => make(&arguments),
        other => panic!("{other:?}"),
    }
}

fn refusal(folder: &TempDir, line: &str) -> String {
    let error = thin(folder, line).err().expect(line);
    format!("{error:#}")
}

fn verified(folder: &TempDir, line: &str) -> u8 {
    match Arguments::try_parse_from(words(folder, "verify", line))
        .unwrap()
        .command
    {
        Some(Command::Verify(arguments)) => verify::run(&arguments).expect(line),
        other => panic!("{other:?}"),
    }
}

#[test]
fn what_is_thinned_is_verified_alone_and_against_its_source() {
    let folder = folder();
    for (options, kept) in [
        ("--radius 0.1", None),
        ("--radius 0.45", None),
        ("--radius 0.45 --priority random --seed 7", None),
        (
            "--radius 0.45 --priority column height --greatest-first",
            None,
        ),
        (
            "--radius 0.25 --width 6 --height 6 --origin 0 500 --boundary periodic",
            Some(400),
        ),
        ("--radius-expression 0.2+0.05*x", None),
        (
            "--radius-column reach --priority column height --greatest-first",
            None,
        ),
        ("--radius-column 6 --priority random", None),
    ] {
        let made = thin(&folder, &format!("cloud.csv {options} --out thinned.csv")).expect(options);
        assert!(made.report.valid(), "{options}");
        let certificate = made.written.as_ref().unwrap().certificate.clone();
        assert_eq!((certificate.format_version, certificate.gaps), (2, 0));
        if let Some(kept) = kept {
            assert_eq!(made.report.kept, kept);
        }
        assert!(made.text().contains("verdict        valid") && made.json()["valid"] == true);

        assert_eq!(verified(&folder, "thinned.csv"), EXIT_FINE, "{options}");
        assert_eq!(
            verified(&folder, "thinned.csv --source cloud.csv --json"),
            EXIT_FINE
        );
    }

    // The highest point of all is the first, with everything beside it.
    thin(
        &folder,
        "cloud.csv --radius 100 --priority column height --greatest-first --out one.csv",
    )
    .unwrap();
    let one = fs::read_to_string(folder.path().join("one.csv")).unwrap();
    let cloud = fs::read_to_string(folder.path().join("cloud.csv")).unwrap();
    let height = |line: &&str| line.split(',').nth(3).unwrap().parse::<u32>().unwrap();
    let highest = cloud
        .lines()
        .rev()
        .filter(|line| !line.starts_with("id"))
        .max_by_key(height)
        .unwrap();
    assert_eq!(one, format!("id,x,y,height,name,reach\n{highest}\n"));
}

/// Rewrites the thinned table, and its certificate as somebody would who wants to be believed.
fn tamper(folder: &TempDir, change: impl FnOnce(&mut Vec<String>)) {
    let path = folder.path().join("thinned.csv");
    let text = fs::read_to_string(&path).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    change(&mut lines);
    let text = lines.join("\n") + "\n";
    fs::write(&path, &text).unwrap();

    let points: Vec<[f64; 2]> = (lines[1..].iter())
        .map(|line| {
            let mut fields = line.split(',').skip(1).map(|field| field.parse().unwrap());
            [fields.next().unwrap(), fields.next().unwrap()]
        })
        .collect();
    let beside = folder.path().join("thinned.csv.certificate.json");
    let mut stated: Value = serde_json::from_slice(&fs::read(&beside).unwrap()).unwrap();
    let region = &stated["region"];
    let area = region["width"].as_f64().unwrap() * region["height"].as_f64().unwrap();
    stated["count"] = json!(points.len());
    // Of radii in a column the certificate states the least and the greatest.
    if stated["radius"].is_object() {
        let radii = lines[1..]
            .iter()
            .map(|line| line.rsplit(',').next().unwrap());
        let radii: Vec<f64> = radii.map(|radius| radius.parse().unwrap()).collect();
        stated["radius"]["least"] = json!(radii.iter().copied().fold(f64::INFINITY, f64::min));
        stated["radius"]["greatest"] = json!(radii.iter().copied().fold(0.0, f64::max));
    }
    let radius = &stated["radius"];
    let least = radius.as_f64().or(radius["least"].as_f64()).unwrap();
    stated["density"] = json!(points.len() as f64 * least.powi(2) / area);
    stated["digest"] = json!(bytes_digest(text.as_bytes()));
    stated["positions_digest"] = json!(positions_digest(&points));
    fs::write(beside, stated.to_string()).unwrap();
}

#[test]
fn what_was_tampered_with_is_found() {
    let folder = folder();
    let fresh = || {
        thin(&folder, "cloud.csv --radius 0.45 --out thinned.csv")
            .map(drop)
            .unwrap();
    };
    let codes = || {
        let alone = verified(&folder, "thinned.csv");
        [alone, verified(&folder, "thinned.csv --source cloud.csv")]
    };

    // The control, and a certificate that only says the same in other words.
    fresh();
    assert_eq!(codes(), [EXIT_FINE; 2]);
    tamper(&folder, |_| {});
    assert_eq!(codes(), [EXIT_FINE; 2]);

    // Without the source nobody can know that a point is gone, or that a name is another one.
    tamper(&folder, |lines| drop(lines.remove(7)));
    assert_eq!(codes(), [EXIT_FINE, EXIT_NEGATIVE]);
    fresh();
    tamper(&folder, |lines| lines[7] = lines[7].replace("a, ", "b, "));
    assert_eq!(codes(), [EXIT_FINE, EXIT_NEGATIVE]);
    // A point that was left out, and one that was never there.
    fresh();
    tamper(&folder, |lines| {
        lines.insert(2, "1,0.1,500,0,\"a, 1\",0.15".to_owned());
    });
    assert_eq!(codes(), [EXIT_NEGATIVE; 2]);
    fresh();
    tamper(&folder, |lines| {
        lines[3] = lines[3].replacen(',', ",0.0", 1);
    });
    assert_eq!(codes()[1], EXIT_NEGATIVE);

    // Statements of the certificate alone.
    let beside = folder.path().join("thinned.csv.certificate.json");
    for (field, value) in [
        ("digest", json!(bytes_digest(b"other"))),
        ("positions_digest", json!(bytes_digest(b"other"))),
        ("count", json!(3)),
        ("conflicts", json!(2)),
        ("radius", json!(0.46)),
        ("covering_tolerance", json!(0.5)),
        ("min_distance", json!(0.46)),
    ] {
        fresh();
        let mut stated: Value = serde_json::from_slice(&fs::read(&beside).unwrap()).unwrap();
        stated[field] = value;
        fs::write(&beside, stated.to_string()).unwrap();
        assert_eq!(codes(), [EXIT_NEGATIVE; 2], "{field}");
    }
    for (field, value) in [
        ("source", json!(bytes_digest(b"other"))),
        ("given", json!(3601)),
        ("priority", json!("random 3")),
        ("priority", json!("least of height")),
    ] {
        fresh();
        let mut stated: Value = serde_json::from_slice(&fs::read(&beside).unwrap()).unwrap();
        stated["thinned"][field] = value;
        fs::write(&beside, stated.to_string()).unwrap();
        assert_eq!(codes(), [EXIT_FINE, EXIT_NEGATIVE], "{field}");
    }
}

#[test]
fn radii_of_a_column_are_judged_from_the_file() {
    let folder = folder();
    let fresh = || thin(&folder, "cloud.csv --radius-column reach --out thinned.csv").unwrap();
    let codes = || {
        let alone = verified(&folder, "thinned.csv");
        [alone, verified(&folder, "thinned.csv --source cloud.csv")]
    };

    // The certificate names the column, and the extremes are those of the points that are kept.
    let made = fresh();
    let certificate = made.written.as_ref().unwrap().certificate.clone();
    let stated = serde_json::to_value(&certificate).unwrap();
    assert_eq!(stated["radius"]["column"], "reach");
    assert_eq!(stated["parameters"]["radius-column"], "reach");
    assert_eq!(stated["radius"]["least"], 0.15);
    assert!(made.text().contains("the column reach"), "{}", made.text());
    assert_eq!(codes(), [EXIT_FINE; 2]);

    // A point becomes larger than its neighbours allow, and one smaller, which only the source shows.
    let set_radius = |radius: &'static str| {
        move |lines: &mut Vec<String>| {
            let (row, _) = lines[9].rsplit_once(',').unwrap();
            lines[9] = format!("{row},{radius}");
        }
    };
    tamper(&folder, set_radius("8.5"));
    assert_eq!(codes(), [EXIT_NEGATIVE; 2]);
    fresh();
    tamper(&folder, set_radius("0.151"));
    assert_eq!(codes(), [EXIT_FINE, EXIT_NEGATIVE]);

    // Statements on the column that are not those of the file.
    let beside = folder.path().join("thinned.csv.certificate.json");
    for (field, value) in [("least", json!(0.1)), ("greatest", json!(7.5))] {
        fresh();
        let mut stated: Value = serde_json::from_slice(&fs::read(&beside).unwrap()).unwrap();
        stated["radius"][field] = value;
        fs::write(&beside, stated.to_string()).unwrap();
        assert_eq!(codes(), [EXIT_NEGATIVE; 2], "{field}");
    }

    // Without the column the error names the file that lacks it, and not its source.
    fresh();
    let certified = fs::read(&beside).unwrap();
    fs::write(folder.path().join("bare.csv"), "name,x,y\na,1,501\n").unwrap();
    fs::write(folder.path().join("bare.csv.certificate.json"), &certified).unwrap();
    let words = words(&folder, "verify", "bare.csv --source cloud.csv");
    let Some(Command::Verify(arguments)) = Arguments::try_parse_from(words).unwrap().command else {
        panic!("another command");
    };
    let said = format!("{:#}", verify::run(&arguments).expect_err("no column"));
    assert!(
        said.contains("bare.csv: ") && said.contains("\"reach\""),
        "{said}"
    );

    // A set that was not thinned has no such radii: nothing would judge the places between its points.
    fresh();
    let mut stated: Value = serde_json::from_slice(&fs::read(&beside).unwrap()).unwrap();
    stated.as_object_mut().unwrap().remove("thinned");
    let error = Certificate::from_bytes(stated.to_string().as_bytes(), "c.json").unwrap_err();
    assert!(
        error.to_string().contains("only in a thinned set"),
        "{error}"
    );
}

#[test]
fn vertices_are_thinned_with_their_properties() {
    let folder = tempfile::tempdir().unwrap();
    let mut file = b"ply\nformat binary_big_endian 1.0\nelement vertex 400\nproperty float x\nproperty float y\n\
        property float z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        .to_vec();
    for at in 0..400_u16 {
        let place = [f32::from(at % 20), f32::from(at / 20), f32::from(at)];
        file.extend(place.iter().flat_map(|value| value.to_be_bytes()));
        file.push(at as u8);
    }
    file.extend([3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2]);
    fs::write(folder.path().join("cloud.ply"), file).unwrap();

    // Without --xy they are thinned in space, where more stay.
    let solid = thin(&folder, "cloud.ply --radius 2").unwrap();
    assert!(solid.report.valid() && solid.report.kept > 100);
    let made = thin(
        &folder,
        "cloud.ply --radius 2 --xy --priority column z --greatest-first --out thinned.ply",
    )
    .unwrap();
    let written = made.written.as_ref().unwrap();
    assert_eq!(
        (made.report.kept, &written.left_out[..]),
        (100, &["face (1 rows)".to_owned()][..])
    );
    assert!(made.text().contains("face (1 rows) numbers vertices"));
    assert_eq!(verified(&folder, "thinned.ply"), EXIT_FINE);
    assert_eq!(
        verified(&folder, "thinned.ply --source cloud.ply"),
        EXIT_FINE
    );

    // Other commands do not take it for a maximal set.
    let words = words(&folder, "convert", "thinned.ply thinned.npy");
    let Some(Command::Convert(arguments)) = Arguments::try_parse_from(words).unwrap().command
    else {
        panic!("another command");
    };
    let said = format!(
        "{:#}",
        crate::convert::run(&arguments).expect_err("thinned")
    );
    assert!(said.contains("chosen from another set"), "{said}");
}

#[test]
fn what_cannot_be_thinned_is_refused_by_name() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("nan.csv", "x,y\n0,1\n2,NaN\n");
    write("none.csv", "x,y\n");
    write("empty.csv", "");
    write(
        "earth.geojson",
        r#"{"type":"MultiPoint","coordinates":[[8.5,47.4],[8.6,47.5]]}"#,
    );
    for (line, said) in [
        ("cloud.csv", "give --radius R"),
        (
            "cloud.csv --radius 0",
            "the radius is 0; it must be above 0",
        ),
        ("cloud.csv --radius -1", "the radius is -1"),
        ("cloud.csv --radius NaN", "the radius is NaN"),
        ("cloud.csv --radius 1e-12", "the points reach over"),
        ("cloud.csv --radius 1..2", "with --radius-image only"),
        ("cloud.csv --radius-expression x-1", "the radius"),
        (
            "cloud.csv --radius 1 --seed 3",
            "--seed is that of --priority random",
        ),
        (
            "cloud.csv --radius 1 --greatest-first",
            "--greatest-first is for --priority column",
        ),
        (
            "cloud.csv --radius 1 --priority height",
            "--priority height: give order",
        ),
        (
            "cloud.csv --radius 1 --priority column depth",
            "there is no column \"depth\"",
        ),
        (
            "cloud.csv --radius 1 --priority column name",
            "line 2: \"a, 0\" in column name",
        ),
        (
            "cloud.csv --radius 1 --width 5 --height 5",
            "point 0 at (0, 500) lies outside the domain",
        ),
        (
            "cloud.csv --radius 1 --width 6",
            "--width needs --height; with --radius-image it follows",
        ),
        ("cloud.csv --radius 1 --height 6", "--height needs --width"),
        (
            "cloud.csv --radius 1 --origin 0 500",
            "--origin needs the sides of the domain",
        ),
        (
            "cloud.csv --radius 1 --boundary periodic",
            "--boundary needs the sides",
        ),
        (
            "cloud.csv --radius 1 --out cloud.csv",
            "would be written over this input",
        ),
        (
            "cloud.csv --radius 1 --out thinned.ply",
            "called thinned.ply, the file would be read as",
        ),
        (
            "nan.csv --radius 1",
            "line 3: the coordinate NaN is not a finite number",
        ),
        ("none.csv --radius 1", "the set has no points"),
        ("empty.csv --radius 1", "no points"),
        ("earth.geojson --radius 1", "as longitudes and latitudes do"),
    ] {
        let found = refusal(&folder, line);
        assert!(found.contains(said), "{line}: {found}");
    }
    thin(
        &folder,
        "earth.geojson --radius 1 --planar --out thinned.geojson",
    )
    .unwrap();
    let others: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(
        others.len(),
        7,
        "no file beside what was given and what was written"
    );
}

#[test]
fn columns_without_a_radius_for_each_point_are_refused_by_row() {
    let folder = folder();
    for (name, radii) in [
        ("zero.csv", ["1", "0"]),
        ("negative.csv", ["1", "-2"]),
        ("no-number.csv", ["1", "NaN"]),
        ("unlike.csv", ["1", "5000"]),
    ] {
        let [first, second] = radii;
        let text = format!("x,y,w\n0,1,{first}\n2,3,{second}\n");
        fs::write(folder.path().join(name), text).unwrap();
    }
    for (line, said) in [
        (
            "cloud.csv --radius-column depth",
            "there is no column \"depth\"",
        ),
        (
            "zero.csv --radius-column w",
            "line 3: \"0\" in column w is not a finite number above 0",
        ),
        (
            "negative.csv --radius-column w",
            "line 3: \"-2\" in column w",
        ),
        (
            "no-number.csv --radius-column w",
            "line 3: \"NaN\" in column w",
        ),
        (
            "unlike.csv --radius-column w",
            "the radii in column w are from 1 (point 0) to 5000 (point 1)",
        ),
        (
            "cloud.csv --radius-column reach --radius 1",
            "cannot be used with",
        ),
    ] {
        let found = refusal(&folder, line);
        assert!(found.contains(said), "{line}: {found}");
    }

    // A single point has a region as wide as its radius, unless that is none.
    let single = |radius: &str| {
        let text = format!("x,y,w\n0,1,{radius}\n");
        fs::write(folder.path().join("single.csv"), text).unwrap();
        thin(&folder, "single.csv --radius-column w")
    };
    assert_eq!(single("0.5").unwrap().report.kept, 1);
    let said = format!("{:#}", single("inf").err().expect("no radius"));
    assert!(said.contains("line 2: \"inf\" in column w"), "{said}");
}
