//! Tests of the report: contents and markup of the page of a folder, and the digits of its numbers.

use std::fs;

use super::*;
use crate::machine::Machine;
use crate::numbers::{csv, number, readable};
use crate::outcome::{BEYOND, Cell, Claim, Column, Table, Verdict};

fn column(key: &str, head: &str, digits: usize) -> Column {
    let (key, head) = (key.to_owned(), head.to_owned());
    Column { key, head, digits }
}

fn finished() -> Finished {
    Finished {
        experiment: Experiment::Fig12,
        quick: true,
        many: false,
        seed: 3,
        machine: Machine::this(),
        version: "1.2.3".to_owned(),
        claims: vec![Claim {
            claim: "Sets | combine".to_owned(),
            place: "section 4.2".to_owned(),
            paper: "yes".to_owned(),
            ours: "9 < 10".to_owned(),
            verdict: Verdict::of(false),
            reason: "Since.".to_owned(),
        }],
        pictures: vec![("seams".to_owned(), "A picture".to_owned())],
        tables: vec![Table {
            name: "sets".to_owned(),
            title: "Sets".to_owned(),
            columns: vec![column("name", "name", 3), column("rate", "rate, 1/s", 3)],
            rows: vec![
                vec![Cell::of("a,b".into()), Cell::of(1_234_567.0.into())],
                vec![Cell::of("c".into()), Cell::of(f64::NAN.into())],
            ],
            shown: true,
        }],
        notes: Vec::new(),
    }
}

#[test]
fn a_folder_s_report_holds_verdict_command_table_and_picture_and_breaks_no_markup() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    fs::create_dir_all(out.join("data")).unwrap();
    fs::create_dir_all(out.join("figures")).unwrap();
    let json = serde_json::to_vec(&finished()).unwrap();
    fs::write(out.join("data/fig12.json"), json).unwrap();
    fs::write(out.join("figures/fig12-seams.svg"), "<svg id=\"x\">#</svg>").unwrap();
    write(out).unwrap();
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("not reproduced") && page.contains("9 &lt; 10"));
    assert!(page.contains("--quick --seed 3 --out DIR"));
    assert!(page.contains("%3Csvg id=%22x%22%3E%23%3C/svg%3E"));
    assert!(
        !page.contains("<svg"),
        "names within pictures must not meet"
    );
    let text = fs::read_to_string(out.join("REPORT.md")).unwrap();
    assert!(text.contains("figures/fig12-seams.png"));
    // Each row leads to its section, which says how it was made.
    assert!(text.contains("| [Sets \\| combine](#fig12) |"));
    let (_, section) = text.split_once("<a id=\"fig12\"></a>").unwrap();
    for line in [
        "Command: `tilescope reproduce fig12 --quick --seed 3 --out DIR`",
        "Seed: 3",
        &format!("Machine: {}", Machine::this().line()),
        "Verdict: **not reproduced (quick)**",
    ] {
        assert!(section.contains(line), "{line}");
    }
    // What the paper does not say stands apart, in other words.
    let beyond = Claim {
        place: BEYOND.to_owned(),
        ..finished().claims[0].clone()
    };
    let with = Finished {
        claims: vec![finished().claims[0].clone(), beyond],
        ..finished()
    };
    fs::write(
        out.join("data/fig12.json"),
        serde_json::to_vec(&with).unwrap(),
    )
    .unwrap();
    write(out).unwrap();
    let text = fs::read_to_string(out.join("REPORT.md")).unwrap();
    assert!(text.contains("## Beyond the paper") && text.contains("refuted (quick)"));
    // What is damaged is told.
    fs::write(out.join("data/fig10.json"), "{").unwrap();
    write(out).unwrap();
    let text = fs::read_to_string(out.join("REPORT.md")).unwrap();
    assert!(text.contains("The kept results of fig10 cannot be read"));
    // A picture that is gone is told, and the report is made all the same.
    fs::remove_file(out.join("figures/fig12-seams.svg")).unwrap();
    write(out).unwrap();
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("The picture is missing"));
}

#[test]
fn numbers_have_all_digits_in_files_and_few_for_readers() {
    let table = &finished().tables[0];
    assert_eq!(csv(table), "name,rate\n\"a,b\",1234567\nc,\n");
    assert_eq!(readable(&table.rows[0][1], 3), "1\u{202f}230\u{202f}000");
    assert_eq!(readable(&table.rows[1][1], 3), "\u{2013}");
    assert_eq!(readable(&Cell::Count(1234), 2), "1234");
    assert_eq!(number(0.012_345, 3), "0.0123");
    assert_eq!(number(-12.345, 3), "\u{2212}12.3");
    assert_eq!(number(1.5e-9, 2), "1.5e-9");
    assert_eq!(number(0.0, 3), "0");
    assert_eq!(number(9.996, 3), "10.0");
}
