//! Clouds in space from end to end: thinned, verified, and tampered with.

use super::*;

/// A folder with 2,000 points of a cube as a table, as vertices with a face, and as an array.
fn space_folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let place = |at: u32| {
        // The multiples of irrational numbers are spread evenly.
        let along = |step: f64| (f64::from(at) * step).fract() * 4.0 - 1.0;
        [along(0.618_034), along(0.414_214), along(0.732_051)]
    };
    let (mut table, mut rows) = ("name;z;x;y;height\n".to_owned(), String::new());
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2000, 3), }\n";
    let mut array = b"\x93NUMPY\x01\x00".to_vec();
    array.extend((header.len() as u16).to_le_bytes());
    array.extend(header.as_bytes());

    for at in 0..2000 {
        let [x, y, z] = place(at);
        let height = at.wrapping_mul(2_654_435_761) >> 20;
        writeln!(table, "p{at};{z};{x};{y};{height}").unwrap();
        writeln!(rows, "{x} {y} {z} {height}").unwrap();
        array.extend(
            place(at)
                .iter()
                .flat_map(|&value| (value as f32).to_le_bytes()),
        );
    }

    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 2000\nproperty double x\nproperty double y\nproperty double z\n\
         property int height\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n{rows}3 0 1 2\n"
    );
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    write("cloud.csv", table.as_bytes());
    write("cloud.ply", ply.as_bytes());
    write("cloud.npy", &array);
    folder
}

#[test]
fn clouds_in_space_are_thinned_and_verified_alone_and_against_their_source() {
    let folder = space_folder();
    for (file, options) in [
        ("csv", ""),
        ("csv", "--priority random --seed 7"),
        ("csv", "--priority column height --greatest-first"),
        ("ply", "--priority column height"),
        ("npy", ""),
    ] {
        let line = format!("cloud.{file} --radius 0.5 {options} --out thinned.{file}");
        let made = thin(&folder, &line).expect(&line);
        assert!(made.report.valid() && made.report.given == 2000, "{line}");
        // About 0.74 points for each cubed radius of the cube and half a radius around it.
        assert!(
            (250..600).contains(&made.report.kept),
            "{line}: {}",
            made.report.kept
        );
        assert!(
            made.text().contains("in space, 3.99") && made.json()["region"]["depth"].is_number()
        );
        let certificate = &made.written.as_ref().unwrap().certificate;
        assert!(certificate.depth.is_some() && certificate.thinned.is_some());
        assert_eq!((certificate.format_version, certificate.gaps), (2, 0));

        let name = format!("thinned.{file}");
        assert_eq!(verified(&folder, &name), EXIT_FINE, "{line}");
        let with_source = format!("{name} --source cloud.{file} --json");
        assert_eq!(verified(&folder, &with_source), EXIT_FINE, "{line}");
    }
    // With --xy the same vertices are thinned in the plane: fewer stay.
    let planar = thin(&folder, "cloud.ply --radius 0.5 --xy --out planar.ply").unwrap();
    assert!(planar.report.kept < 120 && planar.json()["region"]["depth"].is_null());
    assert_eq!(
        verified(&folder, "planar.ply --source cloud.ply"),
        EXIT_FINE
    );
}

#[test]
fn what_stands_beside_points_in_space_stays() {
    let folder = space_folder();
    let made = thin(&folder, "cloud.ply --radius 0.5 --out thinned.ply").unwrap();
    assert_eq!(made.written.unwrap().left_out, ["face (1 rows)"]);
    thin(
        &folder,
        "cloud.csv --radius 100 --priority column height --out one.csv",
    )
    .unwrap();
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let (cloud, one) = (read("cloud.csv"), read("one.csv"));
    let rows: Vec<&str> = one.lines().collect();
    assert_eq!(rows.len(), 2);
    assert!(rows[1].ends_with(";0") && cloud.contains(rows[1]), "{one}");
}

/// Controls: a row more, a row less, a moved point and another order are seen.
#[test]
fn changed_sets_in_space_do_not_verify() {
    let folder = space_folder();
    thin(&folder, "cloud.csv --radius 0.5 --out whole.csv").unwrap();
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let (rows, certificate) = (
        String::from_utf8(read("whole.csv")).unwrap(),
        read("whole.csv.certificate.json"),
    );
    let judged = |changed: &[String], line: &str| {
        let text = changed.join("\n") + "\n";
        fs::write(folder.path().join("thinned.csv"), &text).unwrap();
        let mut stated: Value = serde_json::from_slice(&certificate).unwrap();
        // As somebody would who wants to be believed.
        let points =
            tilescope_formats::decode_solid(text.as_bytes(), &Hint::from_name("thinned.csv"));
        let points = points.unwrap().points;
        stated["digest"] = json!(bytes_digest(text.as_bytes()));
        stated["positions_digest"] = json!(tilescope_formats::solid_digest(&points));
        stated["count"] = json!(points.len());
        let density = stated["density"].as_f64().unwrap() * points.len() as f64;
        stated["density"] = json!(density / (rows.lines().count() - 1) as f64);
        stated["file"] = json!("thinned.csv");
        let bytes = serde_json::to_vec(&stated).unwrap();
        fs::write(folder.path().join("thinned.csv.certificate.json"), bytes).unwrap();
        verified(&folder, line)
    };
    let lines: Vec<String> = rows.lines().map(str::to_owned).collect();
    let source = "thinned.csv --source cloud.csv";
    assert_eq!(judged(&lines, source), EXIT_FINE);
    assert_eq!(judged(&lines, "thinned.csv"), EXIT_FINE);

    let mut fewer = lines.clone();
    fewer.remove(9);
    assert_eq!(judged(&fewer, source), EXIT_NEGATIVE);
    // Without the source nothing shows that a point is missing.
    assert_eq!(judged(&fewer, "thinned.csv"), EXIT_FINE);

    let mut exchanged = lines.clone();
    exchanged.swap(5, 6);
    assert_eq!(judged(&exchanged, source), EXIT_NEGATIVE);

    let mut doubled = lines.clone();
    doubled.push(lines[3].replace('p', "q"));
    assert_eq!(judged(&doubled, "thinned.csv"), EXIT_NEGATIVE);
    assert_eq!(judged(&doubled, source), EXIT_NEGATIVE);
}

/// Control: a larger box holds the points, too.
#[test]
fn stated_boxes_hold_the_points() {
    let folder = space_folder();
    thin(&folder, "cloud.csv --radius 0.5 --out thinned.csv").unwrap();
    let beside = folder.path().join("thinned.csv.certificate.json");
    let whole: Value = serde_json::from_slice(&fs::read(&beside).unwrap()).unwrap();
    for (factor, code) in [(2.0, EXIT_FINE), (0.5, EXIT_NEGATIVE)] {
        let mut stated = whole.clone();
        // The density follows from the sides.
        stated["depth"] = json!(whole["depth"].as_f64().unwrap() * factor);
        stated["density"] = json!(whole["density"].as_f64().unwrap() / factor);
        fs::write(&beside, stated.to_string()).unwrap();
        assert_eq!(verified(&folder, "thinned.csv"), code, "{factor}");
        assert_eq!(
            verified(&folder, "thinned.csv --source cloud.csv"),
            code,
            "{factor}"
        );
    }
}

#[test]
fn what_cannot_be_thinned_in_space_is_refused_by_name() {
    let folder = space_folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("nan.csv", "x,y,z\n0,1,1\n2,3,NaN\n");
    write("late.csv", "x,y,z\n0,1,0\n2,3,inf\n");
    write(
        "set.geojson",
        r#"{"type":"MultiPoint","coordinates":[[200,47,3]]}"#,
    );
    for (line, said) in [
        ("cloud.csv", "give --radius R"),
        (
            "cloud.csv --radius 0",
            "the radius is 0; it must be above 0",
        ),
        ("cloud.csv --radius 1e-12", "the points reach over"),
        (
            "cloud.csv --radius-expression 1+x",
            "where one radius is that of all",
        ),
        (
            "cloud.csv --radius 1 --width 5 --height 5",
            "--width: the points lie in space",
        ),
        (
            "cloud.csv --radius 1 --priority column depth",
            "there is no column \"depth\"",
        ),
        (
            "cloud.npy --radius 1 --priority column z",
            "points have no column",
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
            "--xy thins a cloud in space by its x and y",
        ),
        (
            "nan.csv --radius 1",
            "line 3: \"NaN\" in column z is not a finite number",
        ),
        ("late.csv --radius 1", "not a finite number"),
        ("set.geojson --radius 1", "z is 3, and only planar sets"),
    ] {
        let found = refusal(&folder, line);
        assert!(found.contains(said), "{line}: {found}");
    }

    // Other commands do not take it for a maximal set.
    thin(&folder, "cloud.csv --radius 0.5 --out thinned.csv").unwrap();
    let words = words(&folder, "convert", "thinned.csv thinned.npy");
    let Some(Command::Convert(arguments)) = Arguments::try_parse_from(words).unwrap().command
    else {
        panic!("another command");
    };
    assert_eq!(crate::convert::run(&arguments).unwrap(), 1);
    let stated = fs::read_to_string(folder.path().join("thinned.npy.certificate.json")).unwrap();
    assert!(
        stated.contains("\"valid\": false") && !stated.contains("\"thinned\""),
        "{stated}"
    );
}
