//! Layouts that are refused, each with its sentence.

use std::fs;

use tilescope_core::Boundary;

use super::*;
use crate::describe;

/// Returns why a layout is refused, in a folder with a set "a.csv" of 20 x 20 r.
fn refusal(layout: &Value) -> String {
    let folder = folder();
    save_reference(&folder, "a.csv", Boundary::Periodic);
    describe(
        &glue(&written(&folder, layout), None)
            .err()
            .expect("a refusal"),
    )
}

/// Returns a layout of a seed and of the file that [`refusal`] has.
fn good() -> Value {
    json!({
        "version": 1, "radius": 0.1, "columns": [1.5, 1.5], "rows": [1.5],
        "pieces": [{ "seed": 1 }, { "file": "a.csv" }],
    })
}

/// That layout with another value.
fn with(key: &str, value: Value) -> String {
    let mut layout = good();
    layout[key] = value;
    refusal(&layout)
}

/// That layout with another second piece.
fn second(piece: Value) -> String {
    with("pieces", Value::Array(vec![json!({ "seed": 1 }), piece]))
}

fn all_say(messages: &[(String, &str)]) {
    for (message, wanted) in messages {
        assert!(
            message.contains(wanted),
            "{message:?} should say {wanted:?}"
        );
    }
}

#[test]
fn the_layout_that_is_spoiled_below_is_good() {
    let folder = folder();
    save_reference(&folder, "a.csv", Boundary::Periodic);
    judged(&written(&folder, &good()));
}

#[test]
fn bad_layouts_are_refused() {
    let seeds = json!(vec![json!({ "seed": 1 }); 4097]);
    all_say(&[
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
        (with("pieces", seeds), "there may be at most 4096"),
    ]);
}

#[test]
fn bad_pieces_are_refused() {
    let offset = json!({ "seed": 1, "offset": [0, 0] });
    let rect = json!({ "rect": [0, 0, 1, 1], "seed": 1 });
    all_say(&[
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
        (second(offset), "has no \"offset\""),
        (
            second(json!({ "seed": 1, "width": 2 })),
            "belong to a \"file\"",
        ),
        (
            second(json!({ "file": "a.csv", "method": "kdrt" })),
            "belongs to a \"seed\"",
        ),
        (second(rect), "has no place in a layout of columns and rows"),
    ]);
}

#[test]
fn files_that_cannot_serve_are_refused() {
    let with = |key: &str, value: Value| {
        let mut piece = json!({ "file": "a.csv" });
        piece[key] = value;
        second(piece)
    };
    all_say(&[
        (with("file", json!("b.csv")), "pieces[1]: "),
        (with("file", json!("b.csv")), "b.csv"),
        (with("file", json!(".")), "this is not a file"),
        (with("file", json!("layout.json")), "layout.json"),
        (
            with("radius", json!(0.11)),
            "a.csv: the set is not conflict-free",
        ),
        (with("radius", json!(0.09)), "a.csv: the set is not maximal"),
        (
            with("boundary", json!("bounded")),
            "a.csv: the set is not maximal",
        ),
        (with("width", json!(1.5)), "is not inside [0, 1.5] x [0, 2]"),
    ]);
}

#[test]
fn parameters_that_cannot_serve_are_refused() {
    let with = |parameters: Value| second(json!({ "parameters": parameters }));
    let experiment = json!({
        "search": "two-radii", "leaf": 6, "seed": 3, "width": 400, "height": 400, "radius": 1,
    });
    let both = json!({ "parameters": { "seed": 1 }, "boundary": "bounded" });
    all_say(&[
        (with(json!({ "sed": 1 })), "there is no parameter \"sed\""),
        (with(json!({ "leaf": 2 })), "the leaf is 2 r"),
        (with(json!({ "width": 2 })), "must be given together"),
        (second(both), "is one of these"),
        (with(experiment), "the set is not maximal"),
        (
            with(json!({ "width": 1, "height": 1, "radius": 5e-5 })),
            "samples would",
        ),
    ]);
}

/// Twenty sets that could be made, but not together.
#[test]
fn sets_are_counted_together() {
    let run = json!({ "parameters": { "width": 1, "height": 1, "radius": 2e-4 } });
    let layout = json!({
        "version": 1, "radius": 0.1, "columns": vec![1; 20], "rows": [2], "pieces": vec![run; 20],
    });
    assert!(refusal(&layout).contains("samples would be made; there may be 2e8"));
}

#[test]
fn rectangles_that_overlap_or_leave_a_hole_name_their_pieces() {
    let with = |rects: [[f64; 4]; 2]| {
        let piece = |rect: [f64; 4]| json!({ "rect": rect, "seed": 1 });
        refusal(&json!({
            "version": 1, "radius": 0.1, "width": 3, "height": 2, "pieces": rects.map(piece),
        }))
    };
    let message = with([[0.0, 0.0, 1.6, 2.0], [1.5, 0.0, 3.0, 2.0]]);
    assert!(
        message.contains("pieces 0 and 1 overlap at (1.5, 0)"),
        "{message}"
    );
    let message = with([[0.0, 0.0, 1.5, 2.0], [1.6, 0.0, 3.0, 2.0]]);
    assert!(message.contains("no piece covers (1.5, 0)"), "{message}");
    let message = with([[0.0, 0.0, 1.5, 2.0], [1.5, 0.0, 3.1, 2.0]]);
    assert!(
        message.contains("pieces[1]: the rect [1.5, 0, 3.1, 2]"),
        "{message}"
    );
    let message = refusal(&json!({
        "version": 1, "radius": 0.1, "width": 3, "height": 2, "pieces": [{ "seed": 1 }],
    }));
    assert!(
        message.contains("pieces[0]: \"rect\" is missing"),
        "{message}"
    );
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
        glue(&path, None)
            .map(|_| ())
            .map_err(|error| describe(&error))
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
    let message = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        describe(&glue(&path, None).err().unwrap())
    };
    assert!(message(b"x,y\n0,0\n").contains("this is not a layout of pieces"));
    assert!(message(b"{\"version\": 1, \"radius\": 1e400}").contains("out of range"));
    assert!(message(b"{}").contains("this is not a layout of pieces"));
    assert!(message(&vec![b' '; (1 << 20) + 1]).contains("the layout has 1048577 bytes"));
    assert!(message(&vec![b'['; 100_000]).contains("this is not a layout of pieces"));
    assert!(describe(&glue(folder.path(), None).err().unwrap()).contains("this is not a file"));
    let command = crate::Command::Combine(arguments(&["missing.json"]));
    let window = crate::FromWindow {
        script: |_, _, _, _| Ok(None),
        handout: |_| Err(String::new()),
        lesson_of_session: |_| Err(String::new()),
        leaks: |_, _| Err(String::new()),
    };
    let code = crate::run(&command, window);
    assert_eq!(code, std::process::ExitCode::from(crate::EXIT_BAD_INPUT));
    let missing = run(&arguments(&["missing.json"])).unwrap_err();
    assert!(describe(&missing).contains("missing.json"));
}
