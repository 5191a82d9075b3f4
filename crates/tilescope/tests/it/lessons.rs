//! `tilescope lesson`: handouts, lessons made of a session's scenes, and refused arguments.

use std::fs;

use predicates::prelude::*;
use predicates::str::contains;
use tempfile::{TempDir, tempdir};

use crate::support::tilescope;

#[test]
fn a_handout_is_one_file_with_answers_and_languages_on_request() {
    let folder = tempdir().unwrap();
    let handout = |arguments: &[&str]| {
        let mut command = tilescope(&folder);
        command.args(["lesson", "handout", "survivors", "--out", "h.html"]);
        command.args(arguments).assert().success();
        fs::read_to_string(folder.path().join("h.html")).unwrap()
    };
    let plain = handout(&[]);
    assert!(plain.contains("Who survives") && !plain.contains("The answer:"));
    assert!(!plain.contains("src=\"http") && !plain.contains("<script"));
    assert!(handout(&["--answers", "--notes"]).contains("The answer:"));
    let german = handout(&["--language", "de", "--answers"]);
    assert!(german.contains("lang=\"de\"") && german.contains("Die Antwort:"));
    for (arguments, said) in [
        (vec!["nothing", "--out", "h.html"], "nothing"),
        (vec!["survivors", "--out", "h.pdf"], ".html"),
        (
            vec!["survivors", "--out", "h.html", "--language", "fr"],
            "en and de",
        ),
    ] {
        let mut command = tilescope(&folder);
        command.args(["lesson", "handout"]).args(arguments);
        command.assert().code(2).stderr(contains(said));
    }
}

#[test]
fn scenes_of_a_session_become_a_lesson_that_can_be_checked_and_printed() {
    let folder = tempdir().unwrap();
    let session = saved_session(&folder);
    tilescope(&folder)
        .args(["lesson", "from", &session])
        .assert()
        .success()
        .stdout(contains("--present"));
    let lesson = fs::read_to_string(folder.path().join("talk.md")).unwrap();
    assert!(
        lesson.contains("# Tiling") && lesson.contains("```note\nAsk which."),
        "{lesson}"
    );
    let check = ["lesson", "check", "talk.md", "--seeds", "1"];
    tilescope(&folder).args(check).assert().success();
    let handout = [
        "lesson",
        "handout",
        "talk.md",
        "--out",
        "talk.html",
        "--notes",
    ];
    tilescope(&folder).args(handout).assert().success();
    let html = fs::read_to_string(folder.path().join("talk.html")).unwrap();
    assert_eq!(html.matches("data:image/svg+xml,").count(), 2);
    // An existing lesson is not overwritten, and a file that is no session is named.
    let mut again = tilescope(&folder);
    again
        .args(["lesson", "from", &session])
        .assert()
        .code(2)
        .stderr(contains("not overwritten"));
    fs::write(folder.path().join("broken.tilescope"), "{").unwrap();
    let mut broken = tilescope(&folder);
    broken.args(["lesson", "from", "broken.tilescope"]);
    broken.assert().code(2).stderr(contains("broken.tilescope"));
}

/// Saves a session with two scenes, made by a script of the window's commands; returns the file's name.
fn saved_session(folder: &TempDir) -> String {
    let script = r#"[{"time": {"jump": 3000}}, {"scene": "add"},
        {"scene": {"caption": [0, "Tiling. A clip fills each block.\n---\nAsk which."]}},
        {"time": "last-stage"}, {"scene": "add"},
        {"file": {"sheet": "save"}}, {"file": {"path": "talk.tilescope"}}, {"file": "go"}]"#;
    fs::write(folder.path().join("steps.json"), script).unwrap();
    tilescope(folder)
        .args(["script", "steps.json"])
        .assert()
        .success();
    "talk.tilescope".to_owned()
}

#[test]
fn a_lesson_that_is_to_be_presented_needs_a_display() {
    let folder = tempdir().unwrap();
    for lesson in ["gaps", "lecture"] {
        let mut command = tilescope(&folder);
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        command.args(["lesson", "play", lesson, "--present"]);
        command.assert().code(2).stderr(contains("no display"));
    }
}

#[test]
fn results_of_a_class_are_a_table_for_a_spreadsheet_and_statements_with_ids() {
    let folder = tempdir().unwrap();
    let file = |name: &str, learner: &str, score: f64| {
        let results = serde_json::json!({
            "version": 1, "learner": learner,
            "entries": [{
                "lesson": "gaps", "hash": "00", "gate": "first", "seed": 1, "practised": false, "answer": "+1+cmd",
                "score": score, "tries": 1, "hints": 0, "given_up": false, "confidence": 2, "seconds": 12.3,
                "time": 1_700_000_000.0,
            }],
        });
        fs::write(folder.path().join(name), results.to_string()).unwrap();
    };
    file("a.json", "=HYPERLINK(\"http://example.org\")", 1.0);
    file("b.json", "Jürgen Müller, 点", 0.5);
    fs::copy(
        folder.path().join("b.json"),
        folder.path().join("copy.json"),
    )
    .unwrap();
    let merge = |out: &str| {
        let mut command = tilescope(&folder);
        command.args([
            "lesson",
            "results",
            "a.json",
            "b.json",
            "copy.json",
            "--out",
            out,
        ]);
        let said = "2 entries of 2 learners; 1 entries that were given twice count once";
        command.assert().success().stdout(contains(said));
        fs::read_to_string(folder.path().join(out)).unwrap()
    };

    let table = merge("class.csv");
    assert!(
        table.starts_with('\u{feff}') && table.lines().count() == 3,
        "{table}"
    );
    assert!(
        table.contains("\"'=HYPERLINK(") && table.contains(",'+1+cmd,"),
        "{table}"
    );

    let statements: serde_json::Value = serde_json::from_str(&merge("class.json")).unwrap();
    let ids: Vec<&str> = (statements.as_array().unwrap().iter())
        .map(|one| one["id"].as_str().unwrap())
        .collect();
    assert!(ids.len() == 2 && ids[0] != ids[1], "{ids:?}");
    assert_eq!(
        statements[0]["result"]["response"], "+1+cmd",
        "as it was given"
    );

    file("wrong.json", "Eve", 1e300);
    let mut refused = tilescope(&folder);
    refused.args(["lesson", "results", "wrong.json", "--out", "wrong.csv"]);
    refused
        .assert()
        .code(2)
        .stderr(contains("entry 1: score is 1e300"));
    assert!(!folder.path().join("wrong.csv").exists());
}

#[test]
fn lessons_are_written_in_any_script_and_translated_into_any_language() {
    let folder = tempdir().unwrap();
    let lesson = "---\ntitle: 泊松圆盘采样\nobjective: 学习者可以说明\n---\n\n# 冲突在哪里？\n\nTwo samples.\n\n# Где?\n\nHere.\n";
    fs::write(folder.path().join("mine.md"), lesson).unwrap();
    let check = |more: &[&str]| {
        let mut command = tilescope(&folder);
        command
            .args(["lesson", "check", "mine.md", "--seeds", "1"])
            .args(more);
        command.assert().success()
    };
    // The fonts of the program have none of these letters: that is no fault of the lesson.
    check(&[]).stdout(contains("mine.md: warning: the program's fonts lack").and(contains("(U+")));
    let found: serde_json::Value =
        serde_json::from_slice(&check(&["--json"]).get_output().stdout).unwrap();
    assert_eq!(found[0]["warnings"].as_array().unwrap().len(), 1, "{found}");

    for language in ["zh-Hant", "pt-BR", "de"] {
        let mut command = tilescope(&folder);
        command
            .args(["lesson", "translate", "mine.md", language])
            .assert()
            .success();
        assert!(folder.path().join(format!("mine.{language}.md")).exists());
    }
    for language in ["de_DE", "../x", "d"] {
        let mut command = tilescope(&folder);
        command.args(["lesson", "translate", "mine.md", language]);
        command.assert().code(2).stderr(contains("zh-Hant"));
    }

    // A lesson in English has no warning, with typographic marks and formulas.
    let english = "---\ntitle: “r²” ≤ 2r\nobjective: É — ü\n---\n\n# A\n\nText…\n";
    fs::write(folder.path().join("mine.md"), english).unwrap();
    for language in ["zh-Hant", "pt-BR", "de"] {
        fs::remove_file(folder.path().join(format!("mine.{language}.md"))).unwrap();
    }
    let found: serde_json::Value =
        serde_json::from_slice(&check(&["--json"]).get_output().stdout).unwrap();
    assert_eq!(found[0]["warnings"], serde_json::json!([]), "{found}");
}

#[test]
fn faults_are_named_as_editors_read_them() {
    let folder = tempdir().unwrap();
    let check = || {
        let mut command = tilescope(&folder);
        command.args(["lesson", "check", "mine.md", "--seeds", "1"]);
        command.assert().code(1)
    };
    let lesson = "---\ntitle: T\nobjective: O\n---\n\n# A\n\n```run\nradius: 0.06\nleaf: 6\nwhere: samples()\n```\n";
    fs::write(folder.path().join("mine.md"), lesson).unwrap();
    fs::write(folder.path().join("mine.de.md"), "> T\n\nT\n\n> X\n\nX\n").unwrap();
    check()
        .stdout(contains("mine.md:11: this must be true or false").and(contains("mine.de.md:5: ")));

    // A file that cannot be read has one fault.
    let misspelt = lesson.replace("radius", "radios");
    fs::write(folder.path().join("mine.md"), misspelt).unwrap();
    check().stdout(contains("mine.md:9: there is no"));
}
