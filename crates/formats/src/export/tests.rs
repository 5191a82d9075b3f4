//! The pipeline on small sets, with and without rounding.

use std::ops::ControlFlow;

use tilescope_analysis::{Boundary, Progress};

use super::*;
use crate::point_set::Provenance;

const GO: fn(Progress) -> ControlFlow<()> = |_| ControlFlow::Continue(());

fn region(width: f64) -> Region {
    Region {
        width,
        height: width,
        boundary: Boundary::Periodic,
    }
}

/// A square lattice of `n` x `n` points in a torus of `width`: valid for the radius width / n.
fn lattice(n: u32, width: f64) -> PointSet {
    let step = width / f64::from(n);
    let point = |i: u32| [f64::from(i % n) * step, f64::from(i / n) * step];
    PointSet::from_points((0..n * n).map(point).collect())
}

/// A context whose radius is exactly the distance of the closest pair, so that rounding makes conflicts.
fn tight(set: &PointSet, width: f64) -> ExportContext {
    let options = VerifyOptions::default();
    let report = verify(&set.points, region(width), width / 100.0, &options, &GO).expect("lattice");
    ExportContext::new(region(width), report.min_distance)
}

#[test]
fn an_exact_export_states_what_the_verifier_found() {
    let set = lattice(8, 8.0);
    let mut context = ExportContext::new(region(8.0), 1.0);
    context
        .parameters
        .insert("seed".to_owned(), u64::MAX.into());
    let exported = export_bytes("set.csv", &set, &context, &GO).expect("valid");
    let certificate = &exported.certificate;
    assert!(certificate.valid && exported.warnings.is_empty());
    assert_eq!(
        (certificate.count, certificate.min_distance),
        (64, Some(1.0))
    );
    assert_eq!(certificate.rounding, None);
    assert_eq!(certificate.digest, Some(bytes_digest(&exported.data)));
    let back = Certificate::from_bytes(&exported.certificate_bytes, "c").expect("own");
    assert_eq!(&back, certificate);
    assert_eq!(back.parameters["seed"].as_u64(), Some(u64::MAX));
}

#[test]
fn rounding_into_conflict_is_said_and_not_hidden() {
    let set = lattice(10, 1.0);
    let context = tight(&set, 1.0);
    let exact = export_bytes("set.csv", &set, &context, &GO).expect("a verdict");
    assert!(exact.certificate.valid);
    let rounded = export_bytes("set.rps", &set, &context, &GO).expect("a verdict");
    let certificate = &rounded.certificate;
    assert!(!certificate.valid && certificate.conflicts > 0);
    let rounding = certificate.rounding.as_ref().expect("f32 moved points");
    assert!(rounding.made_conflicts && !rounding.made_gaps);
    assert!(rounding.largest_shift > 0.0 && rounding.largest_shift < 1e-7);
    assert!(
        rounding.note.contains("made conflicts"),
        "{}",
        rounding.note
    );
    let count = certificate.conflicts;
    let warning = Warning::Conflicts {
        count,
        by_rounding: true,
    };
    assert_eq!(rounded.warnings, [warning]);
}

#[test]
fn a_set_invalid_before_is_not_blamed_on_rounding() {
    let set = lattice(10, 1.0);
    let context = ExportContext::new(region(1.0), 0.2);
    let exported = export_bytes("set.rps", &set, &context, &GO).expect("a verdict");
    let rounding = exported.certificate.rounding.expect("f32 moved points");
    assert!(!rounding.made_conflicts);
    assert!(matches!(
        exported.warnings[..],
        [Warning::Conflicts {
            by_rounding: false,
            ..
        }]
    ));
    let context = ExportContext::new(region(1.0), 0.01);
    let sparse = export_bytes("set.csv", &set, &context, &GO).expect("a verdict");
    assert!(matches!(sparse.warnings[..], [Warning::Gaps { .. }]));
    assert!(!sparse.certificate.valid);
}

#[test]
fn unit_torus_formats_record_their_scale() {
    let set = lattice(8, 8.0);
    let context = ExportContext::new(region(8.0), 1.0);
    let exported = export_bytes("set.txt", &set, &context, &GO).expect("valid");
    assert_eq!(exported.certificate.scale.to_bits(), 8.0_f64.to_bits());
    assert_eq!(exported.certificate.min_distance, Some(1.0));
    assert!(exported.data.starts_with(b"64\n0 0\n0.125 0\n"));
}

#[test]
fn json_carries_its_certificate_and_provenance() {
    let mut set = lattice(4, 4.0);
    set.provenance = Some((0..16).map(|i| Provenance::tiled(i, 0)).collect());
    let context = ExportContext::new(region(4.0), 1.0);
    let exported = export_bytes("set.json", &set, &context, &GO).expect("valid");
    let decoded = decode(&exported.data, &Hint::default()).expect("own file");
    assert_eq!(decoded.set, set);
    let mut outer = exported.certificate;
    outer.digest = None;
    assert_eq!(decoded.certificate, Some(outer));
    let csv = export_bytes("set.csv", &set, &context, &GO).expect("valid");
    let format = Format::Csv;
    assert_eq!(csv.warnings, [Warning::ProvenanceLeftOut { format }]);
}

#[test]
fn a_shuffle_changes_the_order_alone() {
    let set = lattice(8, 8.0);
    let mut context = ExportContext::new(region(8.0), 1.0);
    context.shuffle_seed = Some(5);
    let exported = export_bytes("set.txt", &set, &context, &GO).expect("valid");
    let mut points = decode(&exported.data, &Hint::default())
        .expect("own")
        .set
        .points;
    assert_ne!(points[..8], set.points[..8]);
    points.sort_by(|a, b| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])));
    let scaled: Vec<_> = set.points.iter().map(|p| p.map(|v| v / 8.0)).collect();
    assert_eq!(points, scaled);
    assert_eq!(exported.certificate.shuffle_seed, Some(5));
}

#[test]
fn faulty_storage_is_found_out() {
    let set = lattice(4, 4.0);
    let context = ExportContext::new(region(4.0), 1.0);
    let mut flip = |mut bytes: Vec<u8>| {
        let end = bytes.len();
        bytes[end - 2] ^= 1;
        Ok(bytes)
    };
    let error = export_through(&mut flip, "set.csv", &set, &context, &GO).expect_err("flipped");
    assert!(matches!(error, ExportError::ReadBack { .. }), "{error}");
    let mut lose = |bytes: Vec<u8>| Ok(bytes[..bytes.len() - 4].to_vec());
    let error = export_through(&mut lose, "set.csv", &set, &context, &GO).expect_err("lost");
    assert!(matches!(error, ExportError::ReadBack { .. }), "{error}");
}

#[test]
fn what_has_no_verdict_is_not_exported() {
    let context = ExportContext::new(region(1.0), 0.1);
    let outside = PointSet::from_points(vec![[0.5, 0.5], [1.5, 0.5]]);
    let error = export_bytes("set.csv", &outside, &context, &GO).expect_err("outside");
    assert!(
        error.to_string().contains("lies outside the region"),
        "{error}"
    );
    let stop = |_| ControlFlow::Break(());
    let error = export_bytes("set.csv", &lattice(10, 1.0), &context, &stop);
    let source = VerifyError::Cancelled;
    assert!(matches!(error, Err(ExportError::Verify { source: s, .. }) if s == source));
    let error = export_bytes("set.jpeg", &lattice(10, 1.0), &context, &GO);
    assert!(matches!(
        error,
        Err(ExportError::Format(FormatError::UnknownFormat { .. }))
    ));
}

/// Two levels: a lattice of spacing 2, then the places between.
fn two_levels() -> (PointSet, ExportContext) {
    let mut set = lattice(8, 8.0);
    let is_coarse = |p: &[f64; 2]| p.iter().all(|v| v % 2.0 == 0.0);
    set.points.sort_by_key(|p| !is_coarse(p));
    let mut context = ExportContext::new(region(8.0), 1.0);
    context.levels = vec![PrefixClaim::maximal(16, 2.0), PrefixClaim::maximal(64, 1.0)];
    (set, context)
}

#[test]
fn levels_are_written_judged_and_stated() {
    let (set, context) = two_levels();
    for name in ["set.csv", "set.ply", "set.npy", "set.json"] {
        let exported = export_bytes(name, &set, &context, &GO).expect("valid");
        let levels = &exported.certificate.levels;
        let found: Vec<_> = levels
            .iter()
            .map(|l| (l.count, l.min_distance, l.valid))
            .collect();
        assert_eq!(
            found,
            [(16, Some(2.0), true), (64, Some(1.0), true)],
            "{name}"
        );
        let back = Certificate::from_bytes(&exported.certificate_bytes, "c").expect("own");
        assert_eq!(back.levels, *levels);
        assert_eq!(back.prefix(20).and_then(|claim| claim.covering), Some(2.0));
        let hint = Hint::from_name(name);
        let read = decode(&exported.data, &hint).expect("readable");
        assert_eq!(read.set.points, set.points, "the order is kept");
    }
    let csv = export_bytes("set.csv", &set, &context, &GO)
        .expect("valid")
        .data;
    let text = String::from_utf8(csv).expect("text");
    let ends: Vec<&str> = text
        .lines()
        .filter_map(|line| line.rsplit(',').next())
        .collect();
    assert_eq!(ends.iter().filter(|end| **end == "0").count(), 16);
    assert_eq!((ends[0], ends[16], ends[17]), ("level", "0", "1"));
    let ply = export_bytes("set.ply", &set, &context, &GO)
        .expect("valid")
        .data;
    let head = String::from_utf8_lossy(&ply[..300]);
    assert!(head.contains("property uint level\nend_header"), "{head}");
}

#[test]
fn levels_that_are_none_are_stated_as_such() {
    let (mut set, mut context) = two_levels();
    set.points.swap(3, 20);
    let exported = export_bytes("set.csv", &set, &context, &GO).expect("a verdict");
    let levels = &exported.certificate.levels;
    assert!(exported.certificate.valid && !levels[0].valid && levels[1].valid);
    context.shuffle_seed = Some(1);
    let refused = export_bytes("set.csv", &set, &context, &GO);
    assert!(matches!(
        refused,
        Err(ExportError::ShuffledLevels { seed: 1 })
    ));
}

#[test]
fn gaps_of_levels_that_were_cut_are_warned_of_only_if_a_maximal_set_is_claimed() {
    let (mut set, mut context) = two_levels();
    set.points.truncate(40);
    for (covering, valid, warnings) in [(2.0, true, 0), (1.0, false, 1)] {
        context.levels[1] = PrefixClaim {
            covering: Some(covering),
            ..PrefixClaim::maximal(40, 1.0)
        };
        let exported = export_bytes("set.csv", &set, &context, &GO).expect("a verdict");
        let certificate = &exported.certificate;
        assert!(certificate.gaps > 0 && !certificate.valid);
        assert_eq!(certificate.levels[1].valid, valid);
        assert_eq!(exported.warnings.len(), warnings);
    }
}

#[test]
fn storage_that_changes_a_level_is_found_out() {
    let (set, context) = two_levels();
    let mut faulty = |mut bytes: Vec<u8>| {
        let last = bytes.len() - 2;
        bytes[last] ^= 1;
        Ok(bytes)
    };
    let stored = export_through(&mut faulty, "set.csv", &set, &context, &GO);
    assert!(matches!(stored, Err(ExportError::ReadBack { .. })));
}

#[test]
fn positions_are_stored_with_their_origin() {
    let set = lattice(8, 1.0);
    let origin = [5e5, 5.4e6];
    for format in Format::ALL {
        let name = format!("set.{}", format.extension());
        let context = ExportContext {
            origin,
            format: Some(format),
            ..ExportContext::new(region(1.0), 0.12)
        };
        let exported = export_bytes(&name, &set, &context, &GO);
        if format.is_unit_torus() {
            let error = exported.expect_err("no origin there").to_string();
            assert!(error.contains("begins at 0 0"), "{error}");
            continue;
        }

        let exported = exported.expect("an eighth is stored exactly there");
        let certificate = &exported.certificate;
        assert_eq!(
            (certificate.format_version, certificate.origin),
            (2, Some(origin))
        );
        assert!(
            certificate.valid && certificate.rounding.is_none(),
            "{format}"
        );
        let stored = decode_own(&exported.data, format).expect("own");
        let moved = set
            .points
            .iter()
            .map(|[x, y]| [x + origin[0], y + origin[1]]);
        assert_eq!(stored.set.points, moved.collect::<Vec<_>>(), "{format}");

        let beside = ("c", exported.certificate_bytes.as_slice());
        let read = crate::read_bytes(&exported.data, &Hint::from_name(&name), Some(beside));
        assert_eq!(read.expect("own").set.points, set.points, "{format}");
    }
}

#[test]
fn without_an_origin_a_certificate_is_as_before() {
    let context = ExportContext {
        origin: [0.0, -0.0],
        ..ExportContext::new(region(1.0), 0.12)
    };
    let exported = export_bytes("set.csv", &lattice(8, 1.0), &context, &GO).expect("valid");
    let text = String::from_utf8(exported.certificate_bytes).expect("text");
    assert!(text.starts_with("{\n  \"format_version\": 1,\n"));
    assert!(!text.contains("origin"));
}

#[test]
fn an_origin_that_would_spoil_the_set_is_refused() {
    let context = ExportContext {
        origin: [0.0, 1e10],
        ..ExportContext::new(region(1.0), 0.12)
    };
    let error = export_bytes("set.csv", &lattice(8, 1.0), &context, &GO).expect_err("too far");
    let error = error.to_string();
    assert!(error.contains("are 1.9e-6 apart"), "{error}");
    assert!(error.contains("the radius 0.12"), "{error}");
}
