//! Point sets in text tables as other programs and people write them: the commands read them, or say what would do.

use std::fs;

use crate::support::analysis::json;
use crate::support::tilescope;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// A square lattice of spacing 0.1 in the unit square, periodic, which begins at `first`.
fn lattice(first: f64) -> Vec<[f64; 2]> {
    let side = |i: u32| f64::from(i) / 10.0 + first;
    (0..100).map(|i| [side(i % 10), side(i / 10)]).collect()
}

fn rows_from(first: f64, separator: &str, end: &str) -> String {
    let row = |[x, y]: &[f64; 2]| format!("{x}{separator}{y}{end}");
    lattice(first).iter().map(row).collect()
}

fn rows(separator: &str, end: &str) -> String {
    rows_from(0.05, separator, end)
}

fn write(folder: &TempDir, name: &str, bytes: impl AsRef<[u8]>) {
    fs::write(folder.path().join(name), bytes).unwrap();
}

/// Returns what `verify` finds for the lattice's spacing, a little shortened: the set is valid.
fn verified(folder: &TempDir, arguments: &[&str]) -> Value {
    let mut command = tilescope(folder);
    let assert = command
        .args(["verify", "--radius", "0.0999", "--json"])
        .args(arguments)
        .assert()
        .success();
    serde_json::from_slice(&assert.get_output().stdout).unwrap()
}

fn assert_is_lattice(found: &Value, of: &str) {
    assert_eq!(found["count"], 100, "{of}");
    assert_eq!(found["conflict_free"], true, "{of}");
    let far = found["covering_radius_r"].as_f64().unwrap();
    assert!((far * 0.0999 - 0.5_f64.sqrt() / 10.0).abs() < 1e-9, "{of}");
}

#[test]
fn tables_of_other_programs_are_read() {
    let folder = tempdir().unwrap();
    let utf_16 = |text: &str| -> Vec<u8> {
        let marked = std::iter::once(0xFEFF).chain(text.encode_utf16());
        marked.flat_map(u16::to_le_bytes).collect()
    };
    let quoted = rows("\",\"", "\"\n\"");
    let files = [
        ("cr.csv", format!("x,y\r{}", rows(",", "\r"))),
        ("semicolon.csv", format!("x;y\n{}", rows(";", "\n"))),
        ("tab.tsv", format!("x\ty\r\n{}", rows("\t", "\r\n"))),
        ("blank.csv", rows("  ", "\n")),
        (
            "quoted.csv",
            format!("\"x\",\"y\"\n\"{}", quoted.trim_end_matches('"')),
        ),
        ("stated.csv", format!("sep=;\n{}", rows(";", "\n"))),
        ("near.csv", format!("X_coord,Y [m]\n{}", rows(",", "\n"))),
        ("commas.txt", rows(",", "\n")),
        ("named.dat", format!("X Y\n{}", rows(" ", "\n"))),
        ("cloud.xyz", format!("//X Y Z\n{}", rows(" ", " 0\n"))),
        (
            "counted.pts",
            format!("100\n{}", rows(" ", " 0 -1200 1 2 3\n")),
        ),
    ];
    for (name, text) in &files {
        write(&folder, name, text);
        assert_is_lattice(&verified(&folder, &[name]), name);
        write(&folder, name, utf_16(text));
        assert_is_lattice(&verified(&folder, &[name]), &format!("{name} in UTF-16"));
    }
}

#[test]
fn what_could_be_read_in_two_ways_is_refused_with_its_line() {
    let folder = tempdir().unwrap();
    for (name, text, reason) in [
        (
            "bare.csv",
            "12,5,7,3\n",
            "line 1: 4 columns and no header: the point may be (12, 5), or (12.5, 7.3)",
        ),
        (
            "semicolon.csv",
            "0.5;0.25\n0,5;0,25\n",
            "line 2: \"0,5\" has a decimal comma",
        ),
        (
            "tab.txt",
            "x\ty\n0,5\t0,25\n",
            "line 2: \"0,5\" has a decimal comma",
        ),
        (
            "blank.dat",
            "0,5 0,25\n",
            "line 1: \"0,5\" has a decimal comma",
        ),
        ("cloud.csv", "x,y,z\n0.5,0.25,0.1\n", "line 2: z is 0.1"),
        ("cloud.xyz", "0.5 0.25 12.5\n", "line 1: z is 12.5"),
        (
            "map.csv",
            "lon,lat\n0.5,0.25\n",
            "\"lon\" and \"lat\" are degrees on a sphere",
        ),
        (
            "other.csv",
            "east,north\n0.5,0.25\n",
            "the columns are \"east\", \"north\"",
        ),
    ] {
        write(&folder, name, text);
        tilescope(&folder)
            .args(["verify", name, "--radius", "0.1"])
            .assert()
            .code(2)
            .stderr(contains(reason));
    }
}

#[test]
fn columns_are_chosen_by_name_or_number_in_every_command() {
    let folder = tempdir().unwrap();
    let row = |[x, y]: &[f64; 2]| format!("{y};7;{x}\n");
    let text: String = lattice(0.05).iter().map(row).collect();
    write(&folder, "wall.txt", format!("north;height;east\n{text}"));
    for columns in [["east", "north"], ["3", "1"]] {
        let chosen = ["wall.txt", "--columns", columns[0], columns[1]];
        assert_is_lattice(&verified(&folder, &chosen), columns[0]);
        assert_eq!(json(&folder, &chosen, 0)["files"][0]["samples"], 100);
        for command in [
            &["convert", "wall.txt", "wall.npy", "--radius", "0.0999"][..],
            &["draw", "wall.txt", "wall.svg"],
        ] {
            let mut program = tilescope(&folder);
            program.args(command).args(&chosen[1..]).assert().success();
        }
        assert_is_lattice(&verified(&folder, &["wall.npy"]), "converted");
    }
    for (columns, reason) in [
        (
            ["east", "4"],
            "there is no column \"4\"; the columns are \"north\", \"height\", \"east\", or by number 1 to 3",
        ),
        (["east", "3"], "are the same column"),
    ] {
        tilescope(&folder)
            .args(["draw", "wall.txt", "wall.svg", "--columns"])
            .args(columns)
            .assert()
            .code(2)
            .stderr(contains(reason));
    }
    tilescope(&folder)
        .args(["verify", "wall.npy", "--columns", "1", "2"])
        .assert()
        .code(2)
        .stderr(contains("columns can be chosen in text tables only"));
}

#[test]
fn one_of_several_sets_is_chosen_in_every_command() {
    let folder = tempdir().unwrap();
    let first = rows(" ", "\n");
    let moved = rows_from(0.07, " ", "\n");
    write(&folder, "sets.dat", format!("{first}#\n{moved}"));
    for command in [
        &["verify", "sets.dat", "--radius", "0.0999"][..],
        &["analyze", "sets.dat"],
        &["convert", "sets.dat", "one.csv", "--radius", "0.0999"],
        &["draw", "sets.dat", "one.svg"],
    ] {
        let refused = contains("2 sets, 0 to 1").and(contains("--set I"));
        let mut program = tilescope(&folder);
        program.args(command).assert().code(2).stderr(refused);
        let chosen = |set| {
            let mut program = tilescope(&folder);
            program.args(command).args(["--set", set]).assert()
        };
        chosen("1").success();
        chosen("2").code(2).stderr(contains("2 was chosen"));
    }
    let converted = fs::read_to_string(folder.path().join("one.csv")).unwrap();
    assert!(converted.contains("0.07,0.07"), "{converted}");
    assert_is_lattice(&verified(&folder, &["sets.dat", "--set", "0"]), "the first");

    write(&folder, "only.csv", rows(",", "\n"));
    assert_is_lattice(&verified(&folder, &["only.csv", "--set", "0"]), "the only");
    tilescope(&folder)
        .args(["verify", "only.csv", "--set", "1", "--radius", "0.1"])
        .assert()
        .code(2)
        .stderr(contains("one set, which is set 0; 1 was chosen"));
}

#[test]
fn an_average_takes_all_sets_of_its_files() {
    let folder = tempdir().unwrap();
    let first = rows(" ", "\n");
    let moved = rows_from(0.07, " ", "\n");
    write(&folder, "sets.dat", format!("{first}#\n{moved}"));
    write(&folder, "one.dat", &first);
    let together = json(&folder, &["--average", "sets.dat", "one.dat"], 0);
    assert_eq!(together["average"]["sets"], 3);
    let names = together["files"].as_array().unwrap().iter();
    let names: Vec<&str> = names.map(|file| file["file"].as_str().unwrap()).collect();
    assert_eq!(names, ["sets.dat, set 0", "sets.dat, set 1", "one.dat"]);
    let one = json(&folder, &["--average", "sets.dat", "--set", "1"], 0);
    assert_eq!(one["average"]["sets"], 1);
    let against = json(&folder, &["one.dat", "--against", "sets.dat"], 0);
    assert_eq!(against["against"]["sets"], 2, "{against}");
}

/// A distance that is less than the radius by rounding alone must not be written as the radius.
#[test]
fn a_conflict_by_rounding_is_shown_with_enough_digits() {
    let folder = tempdir().unwrap();
    let near = 1.0_f64.next_down();
    write(&folder, "near.csv", format!("x,y\n0,0\n{near},0\n"));
    let arguments = [
        "verify", "near.csv", "--radius", "1", "--width", "8", "--height", "8",
    ];
    tilescope(&folder).args(arguments).assert().code(1).stdout(
        contains("min distance 0.9999999999999999 r")
            .and(contains("0 and 1, 0.9999999999999999 r apart")),
    );
}
