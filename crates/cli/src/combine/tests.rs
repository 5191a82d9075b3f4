//! Layouts from end to end but for the process: files in, sets and errors out.

use std::collections::HashSet;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use tempfile::TempDir;
use tilescope_core::{Boundary, Domain, Unobserved, reference_sample};
use tilescope_formats::{ExportContext, positions_digest};

use super::*;
use crate::{Arguments, Command, EXIT_FINE, describe};

const NINE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../assets/layouts/nine.json"
);

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn written(folder: &TempDir, layout: &Value) -> PathBuf {
    let path = folder.path().join("layout.json");
    fs::write(&path, layout.to_string()).unwrap();
    path
}

/// Glues a layout and returns the set, judged by the independent verifier.
fn judged(path: &Path) -> Glued {
    let glued = glue(path).unwrap();
    let facts = &glued.made.facts;
    let report = make::judge(&glued.made.set.points, facts.region, facts.radius).unwrap();
    assert!(report.valid(), "{report:?}");
    glued
}

/// Returns why a layout is refused, in a folder with a set "a.csv" of 20 x 20 r.
fn refusal(layout: &Value) -> String {
    let folder = folder();
    save_reference(&folder, "a.csv", Boundary::Periodic);
    describe(&glue(&written(&folder, layout)).err().expect("a refusal"))
}

/// Saves a reference set of [0, 2] x [0, 2] with radius 0.1, and returns its positions.
fn save_reference(folder: &TempDir, name: &str, boundary: Boundary) -> Vec<[f64; 2]> {
    let domain = Domain::from_size([2.0, 2.0], 0.1, boundary).unwrap();
    let points = reference_sample(domain, 5, &mut Unobserved).unwrap();
    let positions = make::positions(&domain, &points);
    let context = ExportContext::new(region(&domain), 0.1);
    let set = PointSet::from_points(positions.clone());
    let path = folder.path().join(name);
    verifying(|control| tilescope_formats::export(&path, &set, &context, control)).unwrap();
    positions
}

fn arguments(words: &[&str]) -> CombineArguments {
    let words = [&["tilescope", "combine"], words].concat();
    match Arguments::try_parse_from(words).unwrap().command {
        Some(Command::Combine(arguments)) => arguments,
        other => panic!("{other:?}"),
    }
}

/// The paper's Fig. 12. The digest is pinned: another one is another set.
#[test]
fn nine_sets_become_one() {
    let glued = judged(Path::new(NINE));
    let set = &glued.made.set;
    let blocks = set.provenance.iter().flatten().map(|from| from.block);
    let blocks: HashSet<u32> = blocks.collect();
    assert_eq!(blocks.len(), 10, "nine pieces and what was inserted");
    assert_eq!(glued.seams, 18);
    let summary = glued.made.facts.summary.as_ref().unwrap();
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
    let check = check.unwrap();
    assert!(check.differences.is_empty() && check.report.valid());
    let certificate = check.certificate.unwrap();
    assert_eq!(certificate.method, "combined");
    assert_eq!(certificate.parameters["layout"]["pieces"][8]["seed"], 9);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn sets_of_every_kind_are_glued_in_both_boundaries() {
    for boundary in ["periodic", "bounded"] {
        let folder = folder();
        save_reference(&folder, "a.csv", Boundary::Periodic);
        let positions = save_reference(&folder, "b.csv", Boundary::Bounded);
        let plain: String = positions
            .iter()
            .map(|[x, y]| format!("{x} {y}\n"))
            .collect();
        fs::write(folder.path().join("c.txt"), plain).unwrap();
        let layout = json!({
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
        });
        let glued = judged(&written(&folder, &layout));
        assert_eq!(
            (
                glued.census.files,
                glued.census.runs,
                glued.census.references
            ),
            (3, 2, 1)
        );
        let stated = &glued.made.facts.parameters["layout"];
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
    let glued = judged(&written(&folder, &layout));
    assert_eq!((glued.made.set.points, glued.seams), (positions.clone(), 0));
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
    let glued = judged(&written(&folder, &layout));
    assert_eq!((glued.made.set.points, glued.seams), (positions, 0));
}

#[test]
fn bad_layouts_are_refused_with_a_sentence() {
    let good = json!({
        "version": 1, "radius": 0.1, "columns": [1.5, 1.5], "rows": [1.5],
        "pieces": [{ "seed": 1 }, { "file": "a.csv" }],
    });
    judged_copy(&good);
    let with = |key: &str, value: Value| {
        let mut layout = good.clone();
        layout[key] = value;
        refusal(&layout)
    };
    let second = |piece: Value| with("pieces", json!([{ "seed": 1 }, piece]));
    for (said, wanted) in [
        (
            with("version", json!(2)),
            "has version 2; this program reads version 1",
        ),
        (with("radius", json!(-1)), "the radius is -1"),
        (
            with("radius", json!(0.16)),
            "r long; it must be at least 10 r",
        ),
        (with("radius", json!(1e-9)), "r long; it must be at most"),
        (with("radius", json!(5e-5)), "samples would be made"),
        (with("colour", json!(1)), "unknown field `colour`"),
        (with("boundary", json!("round")), "unknown variant `round`"),
        (with("columns", json!([1.5, -1.5])), "columns[1] is -1.5"),
        (
            with("columns", json!([1.5])),
            "1 columns and 1 rows make 1 rectangles; there are 2 pieces",
        ),
        (with("rows", Value::Null), "either \"columns\" and \"rows\""),
        (with("width", json!(3)), "either \"columns\" and \"rows\""),
        (
            with("pieces", json!([])),
            "make 2 rectangles; there are 0 pieces",
        ),
        (
            with("pieces", json!(vec![json!({ "seed": 1 }); 4097])),
            "there may be at most 4096",
        ),
        (second(json!({})), "pieces[1]: a piece is one of"),
        (
            second(json!({ "seed": 1, "file": "a.csv" })),
            "pieces[1]: a piece is one of",
        ),
        (second(json!({ "seed": -1 })), "invalid value"),
        (
            second(json!({ "seed": 1, "method": "best" })),
            "unknown variant `best`",
        ),
        (
            second(json!({ "seed": 1, "offset": [0, 0] })),
            "has no \"offset\"",
        ),
        (
            second(json!({ "seed": 1, "width": 2 })),
            "belong to a \"file\"",
        ),
        (
            second(json!({ "file": "a.csv", "method": "kdrt" })),
            "belongs to a \"seed\"",
        ),
        (second(json!({ "file": "b.csv" })), "b.csv"),
        (second(json!({ "file": "." })), "this is no file"),
        (second(json!({ "file": "layout.json" })), "layout.json"),
        (
            second(json!({ "file": "a.csv", "radius": 0.11 })),
            "a.csv: the set is not conflict-free",
        ),
        (
            second(json!({ "file": "a.csv", "radius": 0.09 })),
            "a.csv: the set is not maximal",
        ),
        (
            second(json!({ "file": "a.csv", "boundary": "bounded" })),
            "a.csv: the set is not maximal",
        ),
        (
            second(json!({ "rect": [0, 0, 1, 1], "seed": 1 })),
            "has no place in a layout of columns and rows",
        ),
        (
            second(json!({ "parameters": { "sed": 1 } })),
            "there is no parameter \"sed\"",
        ),
        (
            second(json!({ "parameters": { "leaf": 2 } })),
            "the leaf is 2 r",
        ),
        (
            second(json!({ "parameters": { "width": 2 } })),
            "must be given together",
        ),
        (
            second(json!({ "parameters": { "seed": 1 }, "boundary": "bounded" })),
            "is one of these",
        ),
        (
            second(
                json!({ "parameters": { "search": "two-radii", "leaf": 6, "seed": 3,
            "width": 400, "height": 400, "radius": 1 } }),
            ),
            "the set is not maximal",
        ),
        (
            second(json!({ "parameters": { "width": 1, "height": 1, "radius": 5e-5 } })),
            "samples would",
        ),
    ] {
        assert!(said.contains(wanted), "{said:?} should say {wanted:?}");
    }
}

fn judged_copy(layout: &Value) {
    let folder = folder();
    save_reference(&folder, "a.csv", Boundary::Periodic);
    judged(&written(&folder, layout));
}

#[test]
fn rectangles_that_overlap_or_leave_a_hole_name_their_pieces() {
    let with = |rects: [[f64; 4]; 2]| {
        let piece = |rect: [f64; 4]| json!({ "rect": rect, "seed": 1 });
        refusal(&json!({
            "version": 1, "radius": 0.1, "width": 3, "height": 2, "pieces": rects.map(piece),
        }))
    };
    let said = with([[0.0, 0.0, 1.6, 2.0], [1.5, 0.0, 3.0, 2.0]]);
    assert!(
        said.contains("pieces 0 and 1 overlap at (1.5, 0)"),
        "{said}"
    );
    let said = with([[0.0, 0.0, 1.5, 2.0], [1.6, 0.0, 3.0, 2.0]]);
    assert!(said.contains("no piece covers (1.5, 0)"), "{said}");
    let said = with([[0.0, 0.0, 1.5, 2.0], [1.5, 0.0, 3.1, 2.0]]);
    assert!(
        said.contains("pieces[1]: the rect [1.5, 0, 3.1, 2]"),
        "{said}"
    );
    let said = refusal(&json!({
        "version": 1, "radius": 0.1, "width": 3, "height": 2, "pieces": [{ "seed": 1 }],
    }));
    assert!(said.contains("pieces[0]: \"rect\" is missing"), "{said}");
}

#[test]
fn a_set_that_ends_inside_its_rectangle_is_refused() {
    let folder = folder();
    save_reference(&folder, "b.csv", Boundary::Bounded);
    let layout = |offset: f64| {
        let path = written(
            &folder,
            &json!({
                "version": 1, "radius": 0.1, "columns": [1.9], "rows": [2],
                "pieces": [{ "file": "b.csv", "offset": [offset, 0] }],
            }),
        );
        glue(&path).map(|_| ()).map_err(|error| describe(&error))
    };
    assert_eq!(layout(0.1), Ok(()));
    assert!(
        layout(0.2)
            .unwrap_err()
            .contains("the set of piece 0 ends inside its rectangle")
    );
    assert!(
        layout(-0.1)
            .unwrap_err()
            .contains("the offset -0.1 is not inside the set")
    );
}

#[test]
fn what_is_no_layout_is_refused() {
    let folder = folder();
    let path = folder.path().join("layout.json");
    let said = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        describe(&glue(&path).err().unwrap())
    };
    assert!(said(b"x,y\n0,0\n").contains("this is no layout of pieces"));
    assert!(said(b"{\"version\": 1, \"radius\": 1e400}").contains("out of range"));
    assert!(said(b"{}").contains("this is no layout of pieces"));
    assert!(said(&vec![b' '; (1 << 20) + 1]).contains("the layout has 1048577 bytes"));
    assert!(said(&[b'['; 100_000]).contains("this is no layout of pieces"));
    assert!(describe(&glue(folder.path()).err().unwrap()).contains("this is no file"));
    let missing = run(&arguments(&["missing.json"])).unwrap_err();
    assert!(describe(&missing).contains("missing.json"));
}
