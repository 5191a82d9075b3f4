use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use tilescope_analysis::{Boundary, Region};

use super::*;
use crate::certificate::Depth;
use crate::check::{CheckError, Overrides};
use crate::export::{ExportContext, Warning};
use crate::{check, check_solid, export_solid, read, read_solid, solid_certificate};

/// A body-centred lattice of spacing 1: its samples are sqrt(3) / 2 apart, and no place is farther than sqrt(5) / 4 from one.
fn lattice(cells: [u32; 3]) -> Vec<[f64; 3]> {
    let count = cells.iter().product::<u32>();
    let corner = |index: u32| {
        let at = [
            index % cells[0],
            index / cells[0] % cells[1],
            index / cells[0] / cells[1],
        ];
        at.map(f64::from)
    };
    let corners = (0..count).map(corner);
    corners
        .flat_map(|place| [place, place.map(|value| value + 0.5)])
        .collect()
}

const RADIUS: f64 = 0.8;

fn context() -> SolidContext {
    let region = Region::new([3.0, 4.0], true);
    SolidContext {
        planar: ExportContext {
            method: "lattice".to_owned(),
            ..ExportContext::new(region, RADIUS)
        },
        depth: 5.0,
        columns: SolidColumns::default(),
    }
}

fn go_on(_: tilescope_analysis::Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn save(path: &Path, points: &[[f64; 3]], context: &SolidContext) -> SolidExported {
    export_solid(path, points, context, &go_on).expect("an export")
}

fn checked(path: &Path) -> SolidCheck {
    let found = check_solid(path, &Overrides::default(), None, &go_on);
    found.expect("a check").1
}

#[test]
fn every_format_keeps_set_and_certificate() {
    let folder = tempfile::tempdir().expect("a folder");
    let points = lattice([3, 4, 5]);
    for name in ["a.ply", "a.npy", "a.csv", "a.xyz", "a.bin", "a.dat"] {
        let path = folder.path().join(name);
        let saved = save(&path, &points, &context());
        assert!(saved.verdict.valid() && saved.warnings.is_empty(), "{name}");
        let stated = &saved.certificate;
        assert_eq!((stated.format_version, stated.depth), (2, Some(Depth(5.0))));
        assert!((stated.density - 120.0 * RADIUS.powi(3) / 60.0).abs() < 1e-12);
        let distance = stated.min_distance.expect("a distance");
        assert!((distance - 0.75f64.sqrt()).abs() < 1e-12);
        let covering = stated.covering_radius.expect("a covering radius");
        assert!((covering - 5f64.sqrt() / 4.0).abs() < 1e-9);

        let found = checked(&path);
        assert!(found.passed(), "{name}: {:?}", found.differences);
        assert!(solid_certificate(&path).is_some());
        let set = read_solid(&path, &Overrides::default(), None).expect("a set");
        assert_eq!((set.region, set.radius), (context().region(), RADIUS));
        let (again, _) = check_solid(&path, &Overrides::default(), None, &go_on).expect("points");
        // Only the unit torus rounds, as its positions are divided by the width.
        let largest = again
            .iter()
            .zip(&points)
            .flat_map(|(a, b)| [0, 1, 2].map(|i| (a[i] - b[i]).abs()));
        assert!(largest.fold(0.0, f64::max) < 1e-14, "{name}");
    }
}

#[test]
fn planted_faults_are_found_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.csv");
    let beside = crate::certificate_path(&path);
    save(&path, &lattice([3, 4, 5]), &context());
    let (text, stated) = (
        fs::read_to_string(&path).expect("a table"),
        fs::read_to_string(&beside).expect("a certificate"),
    );
    let differing = || -> Vec<&str> {
        let found = checked(&path);
        assert!(!found.passed());
        found.differences.iter().map(|one| one.field).collect()
    };

    // A sample less, and one that has moved.
    fs::write(&path, text.replacen("1.5,0.5,0.5\n", "", 1)).expect("fewer");
    let found = differing();
    for field in [
        "digest",
        "positions_digest",
        "count",
        "covering_radius",
        "density",
        "gaps",
        "valid",
    ] {
        assert!(found.contains(&field), "{field}: {found:?}");
    }
    fs::write(&path, text.replacen("1.5,0.5,0.5\n", "1.6,0.6,0.6\n", 1)).expect("moved");
    let found = differing();
    assert!(
        found.contains(&"min_distance") && found.contains(&"conflicts"),
        "{found:?}"
    );
    fs::write(&path, &text).expect("as it was");

    // A set that is only read is not judged, but has to be that of its certificate.
    fs::write(&path, text.replacen("0.5", "0.51", 1)).expect("moved");
    let read = read_solid(&path, &Overrides::default(), None).expect_err("another set");
    assert!(read.to_string().contains("digest"), "{read}");
    fs::write(&path, &text).expect("as it was");

    // Statements of the certificate, each by itself.
    for (from, to, field) in [
        ("\"depth\": 5.0", "\"depth\": 5.5", "density"),
        ("\"radius\": 0.8", "\"radius\": 0.7", "density"),
        ("\"count\": 120", "\"count\": 121", "count"),
        ("\"gaps\": 0", "\"gaps\": 1", "gaps"),
        ("\"method\": \"lattice\"", "\"method\": \"lattice\"", ""),
    ] {
        assert!(stated.contains(from), "{from} in {stated}");
        fs::write(&beside, stated.replacen(from, to, 1)).expect("another statement");
        let found = checked(&path);
        let fields: Vec<&str> = found.differences.iter().map(|one| one.field).collect();
        assert_eq!(found.passed(), field.is_empty(), "{from}");
        assert!(
            field.is_empty() || fields.contains(&field),
            "{from}: {fields:?}"
        );
    }
}

#[test]
fn a_beginning_states_its_factor() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.ply");
    let points = lattice([3, 4, 5]);
    let mut context = context();
    context.planar.made = Some(120);
    let saved = save(&path, &points[..119], &context);
    let prefix = saved.certificate.prefix.expect("a prefix");
    // Its missing sample is the farthest place.
    assert_eq!((prefix.made, prefix.kept), (120, 119));
    assert!(
        (prefix.factor * RADIUS - 0.75f64.sqrt()).abs() < 1e-8,
        "{prefix:?}"
    );
    assert!(saved.verdict.valid() && checked(&path).passed());

    // The control: as a whole set it has a gap.
    context.planar.made = None;
    let whole = save(&path, &points[..119], &context);
    assert!(!whole.certificate.valid && whole.certificate.gaps > 0);
    assert_eq!(whole.warnings.len(), 1);
    assert!(checked(&path).differences.is_empty());
}

#[test]
fn rounding_to_f32_is_stated_and_a_shuffled_set_stays_itself() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.npy");
    let points: Vec<[f64; 3]> = lattice([3, 4, 5])
        .iter()
        .map(|point| point.map(|value| (value + 0.1) % 5.0))
        .collect();
    let mut context = context();
    context.planar.precision = Precision::Single;
    context.planar.shuffle_seed = Some(3);
    let saved = save(&path, &points, &context);
    let rounding = saved.certificate.rounding.as_ref().expect("a statement");
    assert!(
        (1e-9..1e-6).contains(&rounding.largest_shift),
        "{rounding:?}"
    );
    assert!(checked(&path).passed());
}

#[test]
fn readers_of_planar_sets_refuse_them_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.ply");
    save(&path, &lattice([3, 4, 5]), &context());
    let said = read(&path, &Hint::default())
        .expect_err("a set in space")
        .to_string();
    assert!(
        said.contains("third side, 5,") && said.contains("draw --slice"),
        "{said}"
    );
    let said = check(&path, &Overrides::default(), &go_on)
        .expect_err("in space")
        .to_string();
    assert!(said.contains("third side"), "{said}");
    let said = crate::check_stream(&path, &Overrides::default(), &go_on).expect_err("in space");
    assert!(said.to_string().contains("third side"), "{said}");

    // Without its certificate z is read, which is not 0.
    fs::remove_file(crate::certificate_path(&path)).expect("a certificate");
    let said = read(&path, &Hint::default())
        .expect_err("in space")
        .to_string();
    assert!(said.contains("only planar sets (z = 0) are read"), "{said}");
    let unknown = check_solid(&path, &Overrides::default(), None, &go_on);
    assert!(matches!(unknown, Err(CheckError::NoDepth)));
}

#[test]
fn a_box_is_that_of_its_base_and_depth() {
    let region = context().region();
    assert_eq!(region, in_space(Region::new([3.0, 4.0], true), 5.0));
    assert_eq!(region.boundary, Boundary::Periodic);
    assert_eq!(base(&region), Region::new([3.0, 4.0], true));
}

/// Control: a file whose column was changed is another one than its certificate is about.
#[test]
fn columns_stay_with_their_samples_in_any_order_of_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let points = lattice([3, 4, 5]);
    let columns = SolidColumns {
        arrival: (0..120).collect(),
        level: (0..120).map(|number| number / 40).collect(),
    };
    let mut context = SolidContext {
        columns: columns.clone(),
        ..context()
    };
    for (name, seed) in [("a.ply", None), ("b.csv", Some(1)), ("c.ply", Some(2))] {
        let path = folder.path().join(name);
        context.planar.shuffle_seed = seed;
        let saved = save(&path, &points, &context);
        assert!(saved.warnings.is_empty(), "{name}: {:?}", saved.warnings);
        assert!(checked(&path).passed(), "{name}");

        let set = read_solid(&path, &Overrides::default(), None).expect("a set");
        assert_eq!(set.points == points, seed.is_none(), "{name}");
        for (point, (&arrival, &level)) in set
            .points
            .iter()
            .zip(set.columns.arrival.iter().zip(&set.columns.level))
        {
            let index = arrival as usize;
            let bits = |point: &[f64; 3]| point.map(f64::to_bits);
            assert_eq!(bits(point), bits(&points[index]), "{name}");
            assert_eq!(level, columns.level[index], "{name}");
        }
    }
    // Other formats hold places alone, and say so.
    let saved = save(&folder.path().join("a.npy"), &points, &context);
    let format = crate::Format::Npy;
    assert_eq!(saved.warnings, [Warning::ArrivalLeftOut { format }]);

    let path = folder.path().join("b.csv");
    let text = fs::read_to_string(&path).expect("a table");
    fs::write(&path, text.replacen(",119,2\n", ",119,1\n", 1)).expect("changed");
    let found = checked(&path);
    let fields: Vec<&str> = found.differences.iter().map(|one| one.field).collect();
    assert_eq!(fields, ["digest"]);
}
