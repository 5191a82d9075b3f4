//! What is read of a certificate: a complete one that is true for the file, or none.

use std::ops::ControlFlow;

use serde_json::{Map, Value, json};
use tilescope_analysis::{Boundary, PrefixClaim, Progress, Region};

use super::*;
use crate::certificate::CertifiedRadius;
use crate::export::{ExportContext, ExportedBytes, export_bytes};
use crate::format::{Format, Precision};
use crate::point_set::{PointSet, Provenance};

const GO: fn(Progress) -> ControlFlow<()> = |_| ControlFlow::Continue(());

/// A lattice of spacing 1, moved to the right, exported as a set of `seed`.
fn exported(name: &str, seed: u64, right: f64) -> ExportedBytes {
    let region = Region {
        width: 4.0,
        height: 4.0,
        boundary: Boundary::Periodic,
    };
    let point = |i: u32| [f64::from(i % 4) + right, f64::from(i / 4)];
    let set = PointSet {
        points: (0..16).map(point).collect(),
        provenance: Some((0..16).map(|i| Provenance::tiled(i % 3, i)).collect()),
    };
    let mut context = ExportContext::new(region, 0.9);
    context.parameters.insert("seed".to_owned(), seed.into());
    context
        .parameters
        .insert("pattern".to_owned(), json!({ "side": 100.0 }));
    export_bytes(name, &set, &context, &GO).expect("a valid lattice")
}

fn read_as(
    file: &[u8],
    name: &str,
    certificate: &[u8],
    used: CertificateUse,
) -> Result<ReadSet, FormatError> {
    let hint = Hint {
        name,
        certificate: used,
        ..Hint::default()
    };
    read_bytes(file, &hint, Some(("set.certificate.json", certificate)))
}

#[test]
fn the_certificate_of_another_set_is_refused_or_left_out() {
    for format in Format::ALL {
        let name = format!("set.{}", format.extension());
        let [own, other] = [(1, 0.0), (2, 0.5)].map(|(seed, right)| exported(&name, seed, right));
        let of = |used| read_as(&own.data, &name, &other.certificate_bytes, used);

        // The negative control: its own certificate is true.
        let true_one = read_as(
            &own.data,
            &name,
            &own.certificate_bytes,
            CertificateUse::Checked,
        );
        assert_eq!(
            true_one.expect("true").certificate,
            Some(own.certificate.clone())
        );

        let error = of(CertificateUse::Checked).expect_err("another set's");
        assert!(
            matches!(error, FormatError::FalseCertificate { .. }),
            "{error}"
        );
        let said = error.to_string();
        assert!(
            said.starts_with("the certificate set.certificate.json is not true: digest: "),
            "{said}"
        );

        let stated = of(CertificateUse::AsStated).expect("as it is").certificate;
        assert_eq!(stated, Some(other.certificate));
        let plain = of(CertificateUse::LeftOut).expect("without it");
        assert!(plain.certificate.is_none() && plain.set.provenance.is_none());
    }
}

#[test]
fn numbers_that_contradict_each_other_are_refused_without_a_judge() {
    type Change = fn(&mut Certificate);
    let file = exported("set.csv", 1, 0.0);
    let changes: [(&str, Change); 4] = [
        ("density", |c| c.radius = CertifiedRadius::Constant(0.8)),
        ("valid", |c| c.valid = false),
        ("valid", |c| c.conflicts = 3),
        ("count", |c| c.count = 17),
    ];
    for (field, change) in changes {
        let mut certificate = file.certificate.clone();
        change(&mut certificate);
        let bytes = certificate.to_bytes().expect("plain data");
        let read = read_as(&file.data, "set.csv", &bytes, CertificateUse::Checked);
        let said = read.expect_err(field).to_string();
        assert!(said.contains(&format!("is not true: {field}: ")), "{said}");
    }
}

#[test]
fn a_false_certificate_inside_the_file_is_refused_too() {
    let file = exported("set.json", 1, 0.0);
    let text = String::from_utf8(file.data).expect("text");
    let moved = text.replacen("[0.0, 0.0]", "[0.5, 0.0]", 1);
    assert_ne!(moved, text);
    let of = |text: &str, certificate| {
        let hint = Hint {
            name: "set.json",
            certificate,
            ..Hint::default()
        };
        read_bytes(text.as_bytes(), &hint, None)
    };
    assert!(of(&text, CertificateUse::Checked).is_ok());
    let said = of(&moved, CertificateUse::Checked).expect_err("moved");
    assert!(said.to_string().contains("inside the file is not true"));
    assert!(of(&moved, CertificateUse::AsStated).is_ok());

    // What is left out need not even be readable.
    let broken = text.replacen("\"program\"", "\"programme\"", 1);
    let said = of(&broken, CertificateUse::Checked).expect_err("no program");
    assert!(said.to_string().contains("missing field `program`"));
    let plain = of(&broken, CertificateUse::LeftOut).expect("without it");
    assert!(plain.certificate.is_none() && plain.set.provenance.is_none());
}

/// The objects of a certificate whose fields are fixed: a name for messages, and where it is.
const OBJECTS: [(&str, &[&str]); 4] = [
    ("the certificate", &[]),
    ("region", &["region"]),
    ("rounding", &["rounding"]),
    ("a level", &["levels", "0"]),
];

/// Fields that may be missing.
const OPTIONAL: [&str; 1] = ["levels"];

/// Fields that may be null, and mean something then.
const NULLABLE: [&str; 5] = [
    "min_distance",
    "relative_radius",
    "rounding",
    "shuffle_seed",
    "covering",
];

/// A certificate with everything that one may have.
fn full() -> Value {
    let region = Region {
        width: 8.0,
        height: 8.0,
        boundary: Boundary::Periodic,
    };
    let coarse = (0..16).map(|i: u32| [f64::from(2 * (i % 4)) + 0.1, f64::from(2 * (i / 4))]);
    let between = coarse.clone().map(|[x, y]| [x + 1.0, y + 1.0]);
    let points: Vec<[f64; 2]> = coarse.chain(between).collect();
    let mut context = ExportContext::new(region, 1.9 / 2.0_f64.sqrt());
    context.precision = Precision::Single;
    context.levels = vec![
        PrefixClaim::maximal(16, 1.9),
        PrefixClaim::maximal(32, context.radius),
    ];
    let set = PointSet::from_points(points);
    let file = export_bytes("set.npy", &set, &context, &GO).expect("a verdict");
    assert!(file.certificate.rounding.is_some());
    serde_json::to_value(&file.certificate).expect("plain data")
}

/// The object at a place of a certificate.
fn object<'a>(certificate: &'a mut Value, place: &[&str]) -> &'a mut Map<String, Value> {
    let pointer: Vec<&str> = place.iter().flat_map(|&key| ["/", key]).collect();
    let found = certificate.pointer_mut(&pointer.concat());
    found.and_then(Value::as_object_mut).expect("an object")
}

fn parsed(certificate: &str) -> Result<Certificate, String> {
    let read = Certificate::from_bytes(certificate.as_bytes(), "set.certificate.json");
    read.map_err(|error| error.to_string())
}

#[test]
fn every_field_is_there_once_with_its_type_and_no_other() {
    let whole = full();
    assert!(parsed(&whole.to_string()).is_ok());
    let mut cases = 0;
    for (what, place) in OBJECTS {
        let fields: Vec<String> = object(&mut whole.clone(), place).keys().cloned().collect();
        for field in fields {
            let with = |value: Option<Value>| {
                let mut changed = whole.clone();
                let object = object(&mut changed, place);
                match value {
                    Some(value) => object.insert(field.clone(), value),
                    None => object.remove(&field),
                };
                parsed(&changed.to_string())
            };

            let missing = with(None);
            if OPTIONAL.contains(&&*field) {
                assert!(missing.is_ok(), "{what}: {field} may be missing");
            } else {
                let said = missing.expect_err(&field);
                assert!(said.contains(&format!("missing field `{field}`")), "{said}");
            }

            let is_null = with(Some(Value::Null)).is_ok();
            let may_be_null = NULLABLE.contains(&&*field);
            assert_eq!(is_null, may_be_null, "{what}: {field} as null");

            // No field may be a list of lists.
            assert!(with(Some(json!([[]]))).is_err(), "{what}: {field} retyped");
            cases += 1;
        }

        let mut changed = whole.clone();
        object(&mut changed, place).insert("hue".to_owned(), json!(1));
        let said = parsed(&changed.to_string()).expect_err(what);
        let is_named = said.contains("unknown field `hue`") || said.contains("the part `hue`");
        assert!(is_named, "{said}");
    }
    assert!(cases >= 37, "{cases} fields were tried");
}

#[test]
fn no_field_is_there_twice() {
    let whole = full();
    for (what, place) in OBJECTS {
        let own = object(&mut whole.clone(), place).clone();
        for (field, value) in &own {
            let once = serde_json::to_string(&own).expect("plain data");
            let twice = once.replacen('{', &format!("{{\"{field}\":{value},"), 1);
            let text = whole.to_string().replacen(&once, &twice, 1);
            assert_ne!(text, whole.to_string());
            let said = parsed(&text).expect_err(field);
            assert!(
                said.contains(&format!("duplicate field `{field}`")),
                "{what}: {said}"
            );
        }
    }

    // Parameters have any names, at any depth, but each once.
    let file = exported("set.csv", 1, 0.0);
    let text = String::from_utf8(file.certificate_bytes).expect("text");
    for (name, once, twice) in [
        ("seed", "\"seed\": 1", "\"seed\": 2, \"seed\": 1"),
        ("side", "\"side\": 100.0", "\"side\": 9, \"side\": 100.0"),
    ] {
        assert!(parsed(&text).is_ok());
        let said = parsed(&text.replacen(once, twice, 1)).expect_err(name);
        assert!(
            said.contains(&format!("duplicate field `{name}`")),
            "{said}"
        );
    }
}

#[test]
fn the_digest_is_null_only_inside_the_file() {
    let file = exported("set.json", 1, 0.0);
    let inside = decode(&file.data, &Hint::from_name("set.json")).expect("own file");
    let inside = inside.certificate.expect("inside");
    assert!(inside.digest.is_none());
    let said = parsed(&serde_json::to_string(&inside).expect("plain data")).expect_err("beside");
    assert!(said.contains("`digest` is null"), "{said}");
}
