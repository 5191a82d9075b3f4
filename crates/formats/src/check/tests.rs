//! Checks every statement of a certificate, true and falsified.

use std::ops::ControlFlow;

use super::*;
use crate::export::{ExportContext, ExportedBytes, export_bytes};
use tilescope_analysis::{Boundary, PrefixClaim, Progress};

const GO: fn(Progress) -> ControlFlow<()> = |_| ControlFlow::Continue(());

fn exported(name: &str) -> ExportedBytes {
    let region = Region {
        width: 4.0,
        height: 4.0,
        boundary: Boundary::Periodic,
    };
    let point = |i: u32| [f64::from(i % 4), f64::from(i / 4)];
    let set = PointSet::from_points((0..16).map(point).collect());
    let context = ExportContext::new(region, 0.9);
    export_bytes(name, &set, &context, &GO).expect("a valid lattice")
}

fn fields(check: &Check) -> Vec<&'static str> {
    check.differences.iter().map(|d| d.field).collect()
}

fn check_of(data: &[u8], name: &str, certificate: &[u8], overrides: &Overrides) -> Check {
    let checked = check_bytes(data, name, Some(certificate), overrides, &GO);
    checked.expect("a verdict").1
}

#[test]
fn an_untouched_export_of_every_format_passes() {
    for format in Format::ALL {
        let name = format!("set.{}", format.extension());
        let file = exported(&name);
        let check = check_of(
            &file.data,
            &name,
            &file.certificate_bytes,
            &Overrides::default(),
        );
        assert!(check.passed(), "{format}: {:?}", check.differences);
        assert_eq!(check.report.min_distance.to_bits(), 1.0_f64.to_bits());
    }
}

#[test]
fn each_falsified_statement_is_named() {
    let file = exported("set.csv");
    let falsify = |change: &dyn Fn(&mut Certificate)| {
        let mut certificate = file.certificate.clone();
        change(&mut certificate);
        let bytes = certificate.to_bytes().expect("plain data");
        fields(&check_of(
            &file.data,
            "set.csv",
            &bytes,
            &Overrides::default(),
        ))
    };
    assert!(falsify(&|_| ()).is_empty());
    assert_eq!(falsify(&|c| c.digest = Some("blake3:0".into())), ["digest"]);
    assert_eq!(
        falsify(&|c| c.positions_digest.clear()),
        ["positions_digest"]
    );
    assert_eq!(falsify(&|c| c.file_format = Format::Npy), ["file_format"]);
    assert_eq!(falsify(&|c| c.precision = Precision::Single), ["precision"]);
    assert_eq!(falsify(&|c| c.count += 1), ["count"]);
    assert_eq!(falsify(&|c| c.scale = 4.0), ["scale"]);
    assert_eq!(falsify(&|c| c.min_distance = Some(1.001)), ["min_distance"]);
    assert_eq!(falsify(&|c| c.min_distance = None), ["min_distance"]);
    assert_eq!(
        falsify(&|c| c.covering_radius = c.covering_radius.map(|radius| radius * 1.001)),
        ["covering_radius"]
    );
    assert_eq!(falsify(&|c| c.density *= 1.001), ["density"]);
    assert_eq!(falsify(&|c| c.relative_radius = None), ["relative_radius"]);
    assert_eq!(falsify(&|c| c.conflicts = 1), ["conflicts"]);
    assert_eq!(falsify(&|c| c.gaps = 1), ["gaps"]);
    assert_eq!(falsify(&|c| c.valid = false), ["valid"]);
    assert_eq!(
        falsify(&|c| c.covering_tolerance = 0.5),
        ["covering_tolerance"]
    );
    let parameter = |name: &str, value: serde_json::Value| {
        falsify(&|c| drop(c.parameters.insert(name.to_owned(), value.clone())))
    };
    assert_eq!(parameter("radius", 0.8.into()), ["parameters.radius"]);
    assert_eq!(parameter("width", 5.0.into()), ["parameters.width"]);
    assert_eq!(parameter("height", "4".into()), ["parameters.height"]);
    assert_eq!(
        parameter("boundary", "bounded".into()),
        ["parameters.boundary"]
    );
    assert!(parameter("radius", 0.9.into()).is_empty());
    assert!(parameter("boundary", "periodic".into()).is_empty());
}

/// A gap that a certificate hides by stating a large tolerance.
#[test]
fn the_tolerance_is_not_the_certificates() {
    let file = exported("set.csv");
    let text = String::from_utf8(file.data).expect("text");
    let holed = text.replacen("1,1\n", "", 1);
    let mut stated = file.certificate;
    stated.covering_tolerance = 0.5;
    let bytes = stated.to_bytes().expect("plain data");
    let check = check_of(holed.as_bytes(), "set.csv", &bytes, &Overrides::default());
    assert!(check.report.gaps > 0 && !check.report.valid() && !check.passed());
    assert!(fields(&check).contains(&"covering_tolerance"));
}

#[test]
fn what_no_file_can_bear_out_is_named() {
    let mut stated = exported("set.csv").certificate;
    stated.parameters.insert("seed".to_owned(), 7.into());
    stated.parameters.insert("width".to_owned(), 4.0.into());
    stated.shuffle_seed = Some(1);
    assert_eq!(
        stated.unchecked(),
        [
            "program",
            "program_version",
            "method",
            "file",
            "judges",
            "shuffle_seed",
            "parameters.seed"
        ]
    );
}

#[test]
fn a_removed_sample_shows_in_everything_it_changes() {
    let file = exported("set.csv");
    let text = String::from_utf8(file.data).expect("text");
    let shorter = text.replacen("1,1\n", "", 1);
    let check = check_of(
        shorter.as_bytes(),
        "set.csv",
        &file.certificate_bytes,
        &Overrides::default(),
    );
    assert!(!check.passed() && !check.report.maximal());
    let found = fields(&check);
    for field in [
        "digest",
        "positions_digest",
        "count",
        "covering_radius",
        "gaps",
        "valid",
    ] {
        assert!(found.contains(&field), "{field}");
    }
    assert!(!found.contains(&"min_distance"));
    let count = check.differences.iter().find(|d| d.field == "count");
    assert_eq!(
        count.expect("there").to_string(),
        "count: the certificate states 16, found 15"
    );
}

#[test]
fn a_moved_sample_and_a_reformatted_file_are_told_apart() {
    let file = exported("set.csv");
    let text = String::from_utf8(file.data).expect("text");
    let certificate = &file.certificate_bytes;
    let windows = text.replace('\n', "\r\n");
    let check = check_of(
        windows.as_bytes(),
        "set.csv",
        certificate,
        &Overrides::default(),
    );
    assert_eq!(fields(&check), ["digest"], "the same positions");
    let moved = text.replacen("1,1\n", "1,1.25\n", 1);
    let check = check_of(
        moved.as_bytes(),
        "set.csv",
        certificate,
        &Overrides::default(),
    );
    assert!(fields(&check).contains(&"min_distance"));
    assert_eq!(check.report.conflicts, 1);
}

#[test]
fn another_question_is_not_held_against_the_answers() {
    let file = exported("set.csv");
    let overrides = Overrides {
        radius: Some(0.8),
        ..Overrides::default()
    };
    let check = check_of(&file.data, "set.csv", &file.certificate_bytes, &overrides);
    assert_eq!(fields(&check), ["radius"]);
    assert!(check.report.valid());
}

#[test]
fn the_certificate_inside_json_is_used_and_can_be_falsified() {
    let file = exported("set.json");
    let overrides = Overrides::default();
    let alone = |data: &[u8]| check_bytes(data, "set.json", None, &overrides, &GO);
    let (_, check) = alone(&file.data).expect("a verdict");
    assert!(check.passed() && check.certificate.is_some());
    let text = String::from_utf8(file.data).expect("text");
    let falsified = text.replacen("\"count\": 16", "\"count\": 17", 1);
    assert_eq!(
        fields(&alone(falsified.as_bytes()).expect("a verdict").1),
        ["count"]
    );
    let newer = text.replacen("\"format_version\": 1", "\"format_version\": 9", 1);
    let error = alone(newer.as_bytes()).expect_err("from the future");
    assert!(error.to_string().contains("format_version is 9"), "{error}");
}

#[test]
fn without_a_certificate_the_question_must_be_asked() {
    let unit = exported("set.txt").data;
    let csv = exported("set.csv").data;
    let ask = |data: &[u8], name: &str, overrides: &Overrides| {
        check_bytes(data, name, None, overrides, &GO)
    };
    let mut overrides = Overrides::default();
    assert!(matches!(
        ask(&unit, "set.txt", &overrides),
        Err(CheckError::NoRadius)
    ));
    overrides.radius = Some(0.25);
    let (_, check) = ask(&unit, "set.txt", &overrides).expect("the unit torus is implied");
    assert!(check.passed() && check.certificate.is_none());
    assert!(matches!(
        ask(&csv, "set.csv", &overrides),
        Err(CheckError::NoRegion(Format::Csv))
    ));
}

/// Exports a lattice of spacing 2 and then all but one of the places between, and returns what a check finds once the
/// certificate has been changed.
fn checked_levels(change: impl FnOnce(&mut Certificate)) -> Check {
    let region = Region {
        width: 8.0,
        height: 8.0,
        boundary: Boundary::Periodic,
    };
    let coarse = (0..16).map(|i: u32| [f64::from(2 * (i % 4)), f64::from(2 * (i / 4))]);
    let between = coarse.clone().map(|[x, y]| [x + 1.0, y + 1.0]);
    let points: Vec<[f64; 2]> = coarse.chain(between).take(31).collect();
    let (coarse, fine) = (1.9, 1.9 / 2.0_f64.sqrt());
    let mut context = ExportContext::new(region, fine);
    let cut = PrefixClaim {
        covering: Some(coarse),
        ..PrefixClaim::maximal(31, fine)
    };
    context.levels = vec![PrefixClaim::maximal(16, coarse), cut];
    let file = export_bytes("set.csv", &PointSet::from_points(points), &context, &GO);
    let mut file = file.expect("a verdict");
    change(&mut file.certificate);
    let certificate = file.certificate.to_bytes().expect("plain data");
    check_of(&file.data, "set.csv", &certificate, &Overrides::default())
}

#[test]
fn a_set_of_levels_passes_by_its_levels() {
    let check = checked_levels(|_| ());
    assert!(check.passed(), "{:?}", check.differences);
    assert_eq!(check.levels.len(), 2);
    assert!(check.report.conflict_free() && !check.report.maximal());
}

#[test]
fn levels_are_not_believed() {
    type Change = fn(&mut Certificate);
    let changes: [(&str, Change); 5] = [
        ("levels.min_distance", |c| {
            c.levels[0].min_distance = Some(1.5);
        }),
        ("levels.covering_radius", |c| {
            c.levels[1].covering_radius = 0.5;
        }),
        ("levels", |c| c.levels[1].covering = None),
        ("levels", |c| c.levels[1].covering = Some(9.0)),
        ("levels", |c| c.levels[1].count = 64),
    ];
    for (field, change) in changes {
        let check = checked_levels(change);
        assert_eq!(fields(&check), [field]);
        assert!(!check.passed());
    }
    // With one sample more the first level has a conflict, whatever is stated of it.
    let check = checked_levels(|c| c.levels[0].count = 17);
    assert!(!check.levels[0].valid && !check.passed());
}

/// A lattice in a square whose lower corner the file holds at an origin.
fn exported_at(name: &str, origin: [f64; 2]) -> ExportedBytes {
    let region = Region {
        width: 4.0,
        height: 4.0,
        boundary: Boundary::Bounded,
    };
    let point = |i: u32| [f64::from(i % 5), f64::from(i / 5)];
    let set = PointSet::from_points((0..25).map(point).collect());
    let context = ExportContext {
        origin,
        ..ExportContext::new(region, 0.9)
    };
    export_bytes(name, &set, &context, &GO).expect("a valid lattice")
}

#[test]
fn sets_with_an_origin_are_checked_there() {
    for name in [
        "set.csv", "set.npy", "set.ply", "set.json", "set.xyz", "set.svg",
    ] {
        let file = exported_at(name, [5e5, -8.0]);
        let check = check_of(
            &file.data,
            name,
            &file.certificate_bytes,
            &Overrides::default(),
        );
        assert!(check.passed(), "{name}: {:?}", check.differences);

        let alone = |origin| Overrides {
            region: Some(file.certificate.region),
            radius: Some(0.9),
            origin,
            ..Overrides::default()
        };
        // JSON holds its certificate, which states the origin.
        if name != "set.json" {
            let outside = check_bytes(&file.data, name, None, &alone(None), &GO);
            assert!(matches!(
                outside,
                Err(CheckError::Verify(VerifyError::OutOfRegion { .. }))
            ));
        }
        let told = check_bytes(&file.data, name, None, &alone(Some([5e5, -8.0])), &GO);
        assert!(told.expect("a verdict").1.passed());
    }
}

#[test]
fn an_origin_is_not_believed() {
    let file = exported_at("set.csv", [5e5, -8.0]);
    let with = |change: &dyn Fn(&mut Certificate), overrides: &Overrides| {
        let mut certificate = file.certificate.clone();
        change(&mut certificate);
        let bytes = certificate.to_bytes().expect("plain data");
        check_bytes(&file.data, "set.csv", Some(&bytes), overrides, &GO)
    };
    let moved = with(
        &|c| c.origin = Some([5e5 + 1.0, -8.0]),
        &Overrides::default(),
    );
    // The sample and the domain are named where they lie in the file.
    let said = moved.expect_err("outside").to_string();
    assert!(
        said.contains("at (500000, ") && said.contains("from its corner at (500001, -8)"),
        "{said}"
    );

    let other = Overrides {
        origin: Some([5e5, -8.0]),
        ..Overrides::default()
    };
    let (_, check) = with(&|c| c.origin = Some([5e5 + 1.0, -8.0]), &other).expect("a verdict");
    assert_eq!(fields(&check), ["origin"]);
    assert!(!check.passed());

    let far = Overrides {
        origin: Some([1e15, 0.0]),
        ..Overrides::default()
    };
    let refused = with(&|_| (), &far).expect_err("too far").to_string();
    assert!(
        refused.contains("numbers (f64) are 1.2e-1 apart"),
        "{refused}"
    );
}

#[test]
fn parts_that_version_2_does_not_have_are_refused_by_name() {
    let file = exported_at("set.json", [5e5, -8.0]);
    let text = String::from_utf8(file.certificate_bytes).expect("text");
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        let changed = text.replacen(from, to, 1);
        let read = Certificate::from_bytes(changed.as_bytes(), "c");
        read.map_err(|error| error.to_string())
    };
    assert!(with("\"count\"", "\"count\"").is_ok());
    let more = with("\"count\"", "\"rotation\": 30, \"count\"");
    let more = more.expect_err("unknown");
    assert!(
        more.contains("the part `rotation`, which this version does not know"),
        "{more}"
    );
    let inner = with("\"width\"", "\"shear\": 1, \"width\"");
    let inner = inner.expect_err("unknown");
    assert!(inner.contains("unknown field `shear`"), "{inner}");
    assert!(with("\"count\"", "\"levels\": [], \"count\"").is_ok());

    // A program of version 1 would take the positions for others.
    let older = with("\"format_version\": 2", "\"format_version\": 1");
    assert!(
        older
            .expect_err("an origin")
            .contains("version 1 has no origin")
    );
    let none = with("\"format_version\": 2", "\"format_version\": 2").expect("as it was");
    let none = Certificate {
        origin: None,
        ..none
    };
    let none = none.to_bytes().expect("text");
    let none = Certificate::from_bytes(&none, "c").expect_err("none");
    assert!(
        none.to_string().contains("version 2 needs an origin"),
        "{none}"
    );

    let inside = String::from_utf8(file.data).expect("text");
    let inside = inside.replacen("\"count\"", "\"rotation\": 30, \"count\"", 1);
    let error = check_bytes(
        inside.as_bytes(),
        "set.json",
        None,
        &Overrides::default(),
        &GO,
    );
    let error = error.expect_err("unknown").to_string();
    assert!(error.contains("the part `rotation`"), "{error}");
}

#[test]
fn degrees_are_refused_where_they_reach_beyond_the_domain() {
    let positions =
        |points: &[[f64; 2]]| format!("{{\"type\": \"MultiPoint\", \"coordinates\": {points:?}}}");
    let check = |text: &str, width: f64, planar: bool| {
        let overrides = Overrides {
            region: Some(Region::new([width, width], false)),
            radius: Some(width),
            planar,
            ..Overrides::default()
        };
        check_bytes(text.as_bytes(), "a.geojson", None, &overrides, &GO)
    };
    let zurich = positions(&[[8.5, 47.4], [8.6, 47.3]]);
    let refused = check(&zurich, 1.0, false).expect_err("degrees").to_string();
    assert!(
        refused.contains("point 0 at (8.5, 47.4) lies beyond the domain, 1 x 1"),
        "{refused}"
    );
    assert!(refused.contains("project the points"), "{refused}");
    // Told that they are planar, the verifier has the word.
    let outside = check(&zurich, 1.0, true);
    assert!(matches!(
        outside,
        Err(CheckError::Verify(VerifyError::OutOfRegion { .. }))
    ));
    assert!(check(&zurich, 60.0, false).is_ok());
    // Metres are no degrees.
    let metres = check(&positions(&[[500.0, 0.5]]), 1.0, false);
    assert!(matches!(
        metres,
        Err(CheckError::Verify(VerifyError::OutOfRegion { .. }))
    ));
}

#[test]
fn positions_that_are_not_divided_by_the_width_are_refused_with_what_would_do() {
    let text = b"0.5 0.5\n12.5 7.5\n";
    let region = |side| Region {
        width: side,
        height: side,
        boundary: Boundary::Periodic,
    };
    let overrides = |side, format| Overrides {
        region: Some(region(side)),
        radius: Some(0.5),
        format,
        ..Overrides::default()
    };
    let check = |overrides: &_| check_bytes(text, "set.txt", None, overrides, &GO);
    let message = |overrides: &_| check(overrides).expect_err("outside").to_string();
    assert!(message(&overrides(20.0, None)).contains("--format csv"));
    assert!(!message(&overrides(1.0, None)).contains("--format csv"));
    check(&overrides(20.0, Some(Format::Csv))).expect("a verdict");
}
