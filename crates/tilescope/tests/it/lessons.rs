//! `tilescope lesson`: handouts, lessons made of a session's scenes, and refused arguments.

use std::fs;

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
