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

#[test]
fn the_window_makes_the_package_that_the_command_makes() {
    let folder = tempdir().unwrap();
    let page = folder.path().join("web/dist");
    fs::create_dir_all(&page).unwrap();
    // A folder that looks like a built page, with the texts of a package's page in one file.
    let names = [
        "index.html",
        "course.css",
        "course.js",
        "record.js",
        "scorm.js",
    ];
    let course = names.map(|name| {
        (
            name.to_owned(),
            serde_json::json!(format!("{name} [[title]]")),
        )
    });
    let course = serde_json::Value::Object(course.into_iter().collect());
    for (name, text) in [
        (
            "index.html",
            "course-0123456789ab.json lessons-0123456789ab.json <div id=\"site\"><template id=\"program\">",
        ),
        ("course-0123456789ab.json", &course.to_string()),
        (
            "lessons-0123456789ab.json",
            r#"{"lessons":[],"tables":{"de":"Words\n    W"}}"#,
        ),
    ] {
        fs::write(page.join(name), text).unwrap();
    }

    let script = r#"[{"lesson": {"open": "gaps"}}, {"lesson": {"package": "scorm-1.2"}}]"#;
    fs::write(folder.path().join("steps.json"), script).unwrap();
    let mut window = tilescope(&folder);
    window.args(["script", "steps.json"]).assert().success();
    let packed = |options: &[&str]| {
        let mut command = tilescope(&folder);
        command.args(["lesson", "package", "gaps", "--out", "command.zip"]);
        command.args(options).assert().success();
        fs::read(folder.path().join("command.zip")).unwrap()
    };
    let made = fs::read(folder.path().join("gaps-scorm-1.2.zip")).unwrap();
    assert!(made == packed(&["--scorm", "1.2"]));

    // The control: with a score to pass with it is another package.
    assert!(made != packed(&["--scorm", "1.2", "--pass", "60"]));
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

/// Writes the results of a learner with a score in each form of some concepts.
fn write_forms(folder: &TempDir, learner: &str, scores: &[(&str, [f64; 2])]) {
    let entries = scores.iter().flat_map(|&(concept, scores)| {
        ["before", "after"].into_iter().zip(scores).map(move |(form, score)| {
            serde_json::json!({
                "lesson": form, "hash": "00", "gate": concept, "form": form, "concept": concept, "seed": 1,
                "practised": false, "answer": "A", "score": score, "tries": 1, "hints": 0, "given_up": false,
                "confidence": null, "seconds": 12.3, "time": 1_700_000_000.0,
            })
        })
    });
    let entries: Vec<_> = entries.collect();
    let results = serde_json::json!({ "version": 1, "learner": learner, "entries": entries });
    let file = folder.path().join(format!("{learner}.json"));
    fs::write(file, results.to_string()).unwrap();
}

#[test]
fn the_gain_of_a_class_is_a_table_and_a_page_with_a_picture() {
    let folder = tempdir().unwrap();
    write_forms(
        &folder,
        "Ada",
        &[("loss", [0.0, 1.0]), ("reach", [0.0, 1.0])],
    );
    write_forms(
        &folder,
        "Bob",
        &[("loss", [1.0, 1.0]), ("reach", [0.0, 0.0])],
    );
    write_forms(
        &folder,
        "<Cy>",
        &[("loss", [1.0, 1.0]), ("reach", [1.0, 0.0])],
    );
    let results = |arguments: &[&str]| {
        let mut command = tilescope(&folder);
        command.args(["lesson", "results", "Ada.json", "Bob.json", "<Cy>.json"]);
        command.args(arguments).assert()
    };
    results(&["--gain", "gain.csv", "--gain", "gain.html"])
        .success()
        .stdout(contains("gain.csv, gain.html: 12 entries of 3 learners"));

    let table = fs::read_to_string(folder.path().join("gain.csv")).unwrap();
    // Before 0, 1/2 and 1; after 1, 1/2 and 1/2.
    assert!(table.contains("class,all,3,0.500,0.667,0.33,"), "{table}");
    assert!(
        table.contains("learner,Ada,2,0.000,1.000,1.00,,"),
        "{table}"
    );
    assert!(table.contains("learner,<Cy>,2,1.000,0.500,-,,"), "{table}");
    let page = fs::read_to_string(folder.path().join("gain.html")).unwrap();
    assert!(page.contains("<svg") && page.contains("a loss may open a gap"));
    assert!(page.contains("&lt;Cy&gt;") && !page.contains("<Cy>"));
    assert!(!page.contains("src=\"http") && !page.contains("<script"));
    let bytes = fs::read(folder.path().join("gain.html")).unwrap();
    results(&["--gain", "gain.html"]).success();
    assert_eq!(fs::read(folder.path().join("gain.html")).unwrap(), bytes);

    // Nothing is written if one of the files cannot be.
    results(&["--out", "class.csv", "--gain", "gain.pdf"])
        .code(2)
        .stderr(contains("gain.pdf: the file must end in .csv, or in .html"));
    assert!(!folder.path().join("class.csv").exists());
    write_forms(&folder, "Ada", &[]);
    let mut nothing = tilescope(&folder);
    nothing.args(["lesson", "results", "Ada.json", "--gain", "none.csv"]);
    nothing.assert().code(2).stderr(contains("both forms"));
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

#[test]
fn a_question_whose_answer_is_on_the_screen_is_named() {
    let folder = tempdir().unwrap();
    let check = |ask: &str, answer: &str| {
        let run = "radius: 0.06\nleaf: 6\nmoment: end of tile";
        let replies = "otherwise: Not of {samples()}.\nbecause: {samples()}.\npractice: none";
        let gate = format!("type: number\nask: {ask}\nanswer: {answer}\n{replies}");
        let lesson = format!(
            "---\ntitle: T\nobjective: O\n---\n# A\n```run\n{run}\n```\n```gate g\n{gate}\n```\n"
        );
        fs::write(folder.path().join("mine.md"), lesson).unwrap();
        let mut command = tilescope(&folder);
        command.args(["lesson", "check", "mine.md", "--seeds", "1"]);
        command.assert()
    };
    check("How many samples are there?", "samples()")
        .code(1)
        .stdout(contains("mine.md:11: the window gives the answer away"));
    // The control: the window says nothing of conflicts.
    check("How many conflicts are there?", "conflicts()").success();
}
