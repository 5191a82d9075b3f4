//! Layouts from end to end but for the process: files in, sets and errors out.

mod refusals;

use std::collections::HashSet;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use serde_json::Value;
use tempfile::TempDir;
use tilescope_analysis::VerifyOptions;
use tilescope_core::{Boundary, Domain, Unobserved, reference_sample};
use tilescope_formats::{ExportContext, PointSet, positions_digest};
use tilescope_sets::region;

use super::*;
use crate::progress::verifying;
use crate::{Arguments, Command, EXIT_FINE};

const NINE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../assets/layouts/nine.json"
);

pub fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

pub fn written(folder: &TempDir, layout: &Value) -> PathBuf {
    let path = folder.path().join("layout.json");
    fs::write(&path, layout.to_string()).unwrap();
    path
}

/// Glues a layout and returns the set, judged by the independent verifier.
fn judged(path: &Path) -> Glued {
    let glued = glue(path, None).unwrap();
    let (made, options) = (&glued.worked.made, VerifyOptions::default());
    let report = verifying(|control| made.judge(&options, control)).unwrap();
    assert!(report.valid(), "{report:?}");
    glued
}

/// Saves a reference set of [0, 2] x [0, 2] with radius 0.1, and returns its positions.
pub fn save_reference(folder: &TempDir, name: &str, boundary: Boundary) -> Vec<[f64; 2]> {
    let domain = Domain::from_size([2.0, 2.0], 0.1, boundary).unwrap();
    let points = reference_sample(domain, 5, &mut Unobserved).unwrap();
    let positions = domain.users_from_lattice(&points);
    let context = ExportContext::new(region(&domain), 0.1);
    let set = PointSet::from_points(positions.clone());
    let path = folder.path().join(name);
    verifying(|control| tilescope_formats::export(&path, &set, &context, control)).unwrap();
    positions
}

pub fn arguments(words: &[&str]) -> CombineArguments {
    let words = [&["tilescope", "combine"], words].concat();
    match Arguments::try_parse_from(words).unwrap().command {
        Some(Command::Combine(arguments)) => arguments,
        other => panic!("{other:?}"),
    }
}

/// The paper's Fig. 12. The digest is pinned: another one is another set.
#[test]
fn nine_sets_become_one() {
    let Glued { worked, seams, .. } = judged(Path::new(NINE));
    let made = worked.made;
    let set = &made.set;
    let blocks = set.provenance.iter().flatten().map(|from| from.block);
    let blocks: HashSet<u32> = blocks.collect();
    assert_eq!(blocks.len(), 10, "nine pieces and what was inserted");
    assert_eq!(seams, 18);
    let summary = made.facts.summary.as_ref().unwrap();
    assert!(summary.eliminated > 500 && summary.inserted.iter().sum::<usize>() > 50);
    assert_eq!(
        (set.len(), positions_digest(&set.points).as_str()),
        (
            15_698,
            "blake3:a0a039606fe50301d6d486f592414acc0ee4ebef6ae5507b6887af0932e54c14"
        )
    );
}

#[test]
fn a_combined_set_is_saved_with_a_true_certificate() {
    let folder = folder();
    let out = folder.path().join("nine.ply");
    let out = out.to_str().unwrap();
    let code = run(&arguments(&[NINE, "--out", out, "--json"])).unwrap();
    assert_eq!(code, EXIT_FINE);
    let overrides = tilescope_formats::Overrides::default();
    let check = verifying(|control| tilescope_formats::check(out.as_ref(), &overrides, control));
    let (_, check) = check.unwrap();
    assert!(check.differences.is_empty() && check.report.valid());
    let certificate = check.certificate.unwrap();
    assert_eq!(certificate.method, "combined");
    assert_eq!(certificate.parameters["layout"]["pieces"][8]["seed"], 9);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

fn every_kind(boundary: &str) -> Value {
    json!({
        "version": 1,
        "boundary": boundary,
        "radius": 0.05,
        "columns": [1, 0.7, 0.9],
        "rows": [0.8, 1],
        "seed": 7,
        "order": "random",
        "insertion": "uniform",
        "pieces": [
            { "file": "a.csv", "offset": [17.3, -2.5] },
            { "seed": 1 },
            { "seed": 2, "method": "reference", "boundary": "bounded" },
            { "file": "b.csv" },
            { "parameters": { "seed": 3, "leaf": 6.5, "pattern": { "seed": 4, "side": 33 } } },
            { "file": "c.txt", "radius": 0.1, "width": 2, "height": 2, "boundary": "bounded" },
        ],
    })
}

#[test]
fn sets_of_every_kind_are_glued_in_both_boundaries() {
    for boundary in ["periodic", "bounded"] {
        let folder = folder();
        save_reference(&folder, "a.csv", Boundary::Periodic);
        let positions = save_reference(&folder, "b.csv", Boundary::Bounded);
        let lines: Vec<String> = positions.iter().map(|[x, y]| format!("{x} {y}")).collect();
        fs::write(folder.path().join("c.txt"), lines.join("\n")).unwrap();
        let glued = judged(&written(&folder, &every_kind(boundary)));
        assert_eq!(glued.census.kinds, [3, 2, 1]);
        let stated = &glued.worked.made.facts.parameters["layout"];
        assert_eq!(stated["pieces"][3]["file"], "b.csv");
        assert!(
            stated["pieces"][3]["digest"]
                .as_str()
                .unwrap()
                .starts_with("blake3:")
        );
    }
}

#[test]
fn a_run_of_its_own_size_may_be_cut() {
    let folder = folder();
    let run = json!({ "width": 1, "height": 1, "radius": 0.02, "boundary": "bounded", "leaf": 12 });
    let layout = json!({
        "version": 1,
        "radius": 1,
        "width": 60,
        "height": 25,
        "pieces": [
            { "rect": [0, 0, 20, 25], "parameters": run, "offset": [0.3, 0.5] },
            { "rect": [20, 0, 60, 10], "seed": 8 },
            { "rect": [20, 10, 60, 25], "parameters": run, "offset": [0.2, 0.7] },
        ],
    });
    judged(&written(&folder, &layout));
}

/// The positions come back to the bit.
#[test]
fn a_periodic_file_in_its_own_domain_comes_back_unchanged() {
    let folder = folder();
    let positions = save_reference(&folder, "a.csv", Boundary::Periodic);
    let mut layout = json!({
        "version": 1, "radius": 0.1, "columns": [2], "rows": [2], "pieces": [{ "file": "a.csv" }],
    });
    let unchanged = |layout: &Value| {
        let glued = judged(&written(&folder, layout));
        assert_eq!(glued.worked.made.set.points, positions);
        assert_eq!(glued.seams, 0);
    };
    unchanged(&layout);

    // Cut in four that continue each other, too.
    layout["columns"] = json!([0.3, 1.7]);
    layout["rows"] = json!([1.1, 0.9]);
    let piece = |x: f64, y: f64| json!({ "file": "a.csv", "offset": [x, y] });
    layout["pieces"] = json!([
        piece(0.0, 0.0),
        piece(0.3, 0.0),
        piece(0.0, 1.1),
        piece(0.3, 1.1)
    ]);
    unchanged(&layout);
}
