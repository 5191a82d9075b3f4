//! Parts are read as they were written, and none is passed over.

use std::ops::ControlFlow;

use proptest::prelude::*;
use serde_json::json;

use super::*;
use crate::certificate::Certificate;
use crate::export::{ExportContext, export_bytes};
use crate::point_set::PointSet;

/// The certificate of a lattice of spacing 1, as JSON.
fn certificate() -> Value {
    let point = |i: u32| [f64::from(i % 4), f64::from(i / 4)];
    let set = PointSet::from_points((0..16).map(point).collect());
    let context = ExportContext::new(Region::new([4.0, 4.0], true), 0.9);
    let go_on = |_| ControlFlow::Continue(());
    let file = export_bytes("set.csv", &set, &context, &go_on).expect("a valid lattice");
    serde_json::to_value(file.certificate).expect("plain data")
}

/// The certificate in version 2, with a field set to a value.
fn with(field: &str, value: &Value) -> Value {
    let mut changed = certificate();
    changed["format_version"] = 2.into();
    changed[field] = value.clone();
    changed
}

/// What a reader says of a certificate.
fn refusal(certificate: &Value) -> String {
    let bytes = certificate.to_string();
    let read = Certificate::from_bytes(bytes.as_bytes(), "c");
    read.expect_err(&bytes).to_string()
}

/// A radius that varies, as it is written.
fn field() -> Value {
    json!({
        "rule": "harmonic-mean", "digest": digest(), "pitch": 0.25, "least": 0.5, "greatest": 2.0
    })
}

fn digest() -> String {
    crate::bytes_digest(b"a field")
}

/// A value of each part that has a field of its own, as it is written.
fn parts() -> [(&'static str, Value); 7] {
    let ring = [[0.5, 0.0], [3.5, 0.25], [2.0, 4.0]];
    [
        ("origin", json!([5e5, -8.0])),
        ("depth", json!(4.0)),
        ("shape", json!({ "kind": "polygon", "rings": [ring, ring] })),
        (
            "shape",
            json!({ "kind": "mask", "digest": digest(), "pitch": 0.25 }),
        ),
        ("prefix", json!({ "made": 20, "kept": 16, "factor": 1.008 })),
        (
            "thinned",
            json!({ "source": digest(), "given": 20, "priority": "random 7" }),
        ),
        ("radius", field()),
    ]
}

#[test]
fn parts_come_back_as_they_were_and_make_version_2() {
    for (name, value) in parts() {
        let stated = with(name, &value);
        let read: Certificate = serde_json::from_value(stated.clone()).expect(name);
        assert_eq!(serde_json::to_value(&read).expect("plain data"), stated);

        let older = Certificate {
            format_version: 1,
            ..read.clone()
        };
        assert_eq!(older.with_version(), read, "{name}");
    }

    let plain: Certificate = serde_json::from_value(certificate()).expect("version 1");
    assert_eq!(plain.format_version, 1);
    assert_eq!(plain.clone().with_version(), plain);
}

#[test]
fn a_part_that_no_judge_takes_into_account_is_refused_by_name() {
    for (name, value) in parts() {
        let stated = with(name, &value);
        let mut older = stated.clone();
        older["format_version"] = 1.into();
        assert!(refusal(&older).contains(&format!("version 1 has no {name}")));

        // The control: parts that are judged.
        if ["origin", "depth", "shape", "radius", "thinned"].contains(&name) {
            let text = stated.to_string();
            Certificate::from_bytes(text.as_bytes(), "c").expect("a part that is judged");
            continue;
        }
        assert_eq!(name, "prefix");
        assert!(
            refusal(&stated).contains("`prefix`, which is judged only where the radius varies")
        );
        for (part, value) in [("radius", field()), ("depth", json!(4.0))] {
            let mut judged = stated.clone();
            judged[part] = value;
            let text = judged.to_string();
            Certificate::from_bytes(text.as_bytes(), "c").expect("a prefix that is judged");
        }
    }

    // No part but a prefix and a choice of points stands beside a third side.
    for (name, value) in parts() {
        let mut stated = with("depth", &json!(4.0));
        stated[name] = value;
        if !["depth", "prefix", "thinned"].contains(&name) {
            let said = refusal(&stated);
            assert!(
                said.contains(&format!("the part `{name}")) && said.contains("beside `depth`"),
                "{said}"
            );
        }
    }

    let said = refusal(&with("judges", &json!(["oracle"])));
    assert!(said.contains("unknown variant `oracle`"), "{said}");
}

#[test]
fn a_part_inside_the_file_is_refused_too() {
    let inside = |certificate: &Value| {
        let file = json!({ "certificate": certificate, "points": [[0, 0]] }).to_string();
        let read = crate::decode(file.as_bytes(), &crate::Hint::from_name("set.json"));
        read.map(drop).map_err(|error| error.to_string())
    };
    assert!(inside(&with("origin", &json!([1, 2]))).is_ok());
    let mut beside = with("depth", &json!(4));
    beside["origin"] = json!([1, 2]);
    let said = inside(&beside).expect_err("a third side at an origin");
    assert!(said.contains("the part `origin` beside `depth`"), "{said}");
    let said = inside(&with("foo", &json!(4))).expect_err("unknown");
    assert!(
        said.contains("the certificate has the part `foo`, which this version does not know"),
        "{said}"
    );
}

#[test]
fn a_malformed_part_is_named_with_its_value_and_the_limit() {
    let short = json!({ "kind": "polygon", "rings": [[[0, 0], [1, 0]]] });
    let mask =
        |digest: &str, pitch: f64| json!({ "kind": "mask", "digest": digest, "pitch": pitch });
    let prefix =
        |made: u32, kept: u32, factor: f64| json!({ "made": made, "kept": kept, "factor": factor });
    let thinned = |source: &str, given: u32, priority: &str| json!({ "source": source, "given": given, "priority": priority });
    let capital = digest().to_uppercase();
    let cases = [
        ("origin", json!([1, 2, 3]), "invalid length 3"),
        ("origin", json!(null), "invalid type: null"),
        ("depth", json!(null), "invalid type: null"),
        ("depth", json!("4"), "invalid type: string"),
        ("depth", json!(0.0), "a side must be from 2^-100 to 2^100"),
        ("depth", json!(-4), "a side must be from 2^-100 to 2^100"),
        ("shape", json!({ "kind": "disk" }), "unknown variant `disk`"),
        (
            "shape",
            json!({ "kind": "polygon", "rings": [] }),
            "at least one ring",
        ),
        ("shape", short, "at least 3 corners"),
        ("shape", mask("md5:0", 1.0), "64 hexadecimal digits"),
        ("shape", mask(&capital, 1.0), "64 hexadecimal digits"),
        (
            "shape",
            mask(&digest(), 0.0),
            "the pitch must be from 2^-100",
        ),
        ("radius", json!("0.9"), "invalid type: string"),
        ("radius", json!({}), "missing field `rule`"),
        (
            "radius",
            json!({ "rule": "least", "digest": digest(), "pitch": 1 }),
            "`least`",
        ),
        ("prefix", prefix(15, 16, 1.0), "from 1 to `made`"),
        ("prefix", prefix(15, 0, 1.0), "from 1 to `made`"),
        ("prefix", prefix(16, 15, 0.5), "at least 1"),
        (
            "prefix",
            json!({ "made": 9, "kept": 4, "factor": 1, "seed": 3 }),
            "`seed`",
        ),
        ("thinned", thinned(&digest(), 20, ""), "no name"),
        ("thinned", thinned("", 20, "order"), "64 hexadecimal digits"),
        (
            "thinned",
            thinned(&digest(), 0, "order"),
            "at least one point",
        ),
    ];
    for (name, value, limit) in cases {
        let said = refusal(&with(name, &value));
        assert!(said.contains(limit), "{said}");
        // The radius is no part as long as it is a number.
        if name != "radius" || value.is_object() {
            assert!(said.contains(&format!("`{name}` is {value}")), "{said}");
        }
    }

    let mut reversed = field();
    reversed["least"] = 3.0.into();
    let said = refusal(&with("radius", &reversed));
    assert!(
        said.contains("`radius` is {") && said.contains("no more than the greatest"),
        "{said}"
    );
    let ring = vec![[0.125, 0.5]; 1000];
    let many = json!({ "kind": "polygon", "rings": [ring, []] });
    let said = refusal(&with("shape", &many));
    assert!(
        said.contains("...: a ring has at least 3 corners") && said.len() < 300,
        "{said}"
    );
}

fn any_shape() -> impl Strategy<Value = CertifiedShape> {
    let corner = prop::array::uniform2(-1e9..1e9_f64);
    let ring = prop::collection::vec(corner, MIN_CORNERS..9);
    let polygon =
        prop::collection::vec(ring, 1..4).prop_map(|rings| CertifiedShape::Polygon { rings });
    let mask = any::<u64>().prop_map(|seed| CertifiedShape::Mask {
        digest: crate::bytes_digest(&seed.to_le_bytes()),
        pitch: (seed >> 1 | 1) as f64,
    });
    prop_oneof![polygon, mask]
}

proptest! {
    #[test]
    fn every_number_of_a_part_comes_back_to_the_bit(
        shape in any_shape(),
        depth in 1e-30..1e30_f64,
        kept in 1..u64::MAX,
        factor in 1.0..1e9_f64,
    ) {
        let stated = Certificate {
            depth: Some(Depth(depth)),
            shape: Some(shape),
            prefix: Some(CertifiedPrefix { made: u64::MAX, kept, factor }),
            thinned: Some(Thinned {
                source: digest(),
                given: kept,
                priority: factor.to_string(),
            }),
            ..serde_json::from_value(certificate()).expect("version 1")
        };
        let stated = stated.with_version();
        let bytes = stated.to_bytes().expect("plain data");
        let read: Certificate = serde_json::from_slice(&bytes).expect("own");
        prop_assert_eq!(read, stated);
    }

    #[test]
    fn any_value_of_any_field_is_read_or_refused_without_harm(
        field in prop::sample::select(vec![
            "origin", "depth", "shape", "radius", "prefix", "thinned", "judges", "levels", "other",
        ]),
        text in "[\\[\\]{}\":,0-9a-z.eE+-]{0,40}",
    ) {
        let once = certificate().to_string();
        let more = once.replacen('{', &format!("{{\"{field}\":{text},"), 1);
        // Where the certificate has the field, it has it twice now.
        prop_assert!(Certificate::from_bytes(more.as_bytes(), "c").is_err());
    }
}

#[test]
fn polygons_are_the_same_in_any_direction_and_from_any_corner() {
    let polygon = |rings: &[Vec<[f64; 2]>]| CertifiedShape::Polygon {
        rings: rings.to_vec(),
    };
    let outer = vec![[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 8.0]];
    let hole = vec![[2.0, 2.0], [3.0, 2.0], [3.0, 3.0]];
    let stated = polygon(&[outer.clone(), hole.clone()]);
    let mut turned = outer.clone();
    turned.reverse();
    turned.rotate_left(1);
    turned[0] = turned[0].map(|at| if at == 0.0 { -0.0 } else { at });
    let other = polygon(&[hole.clone(), turned]);
    assert!(stated != other && stated.is_same(&other));
    assert_eq!(stated.digest(), other.digest());

    // The controls: another corner, another sequence of corners, and a ring less.
    let mut moved = outer.clone();
    moved[3] = [0.0, 8.5];
    let mut crossed = outer.clone();
    crossed.swap(1, 2);
    for rings in [vec![moved, hole.clone()], vec![crossed, hole], vec![outer]] {
        let other = polygon(&rings);
        assert!(!stated.is_same(&other) && stated.digest() != other.digest());
    }
}
