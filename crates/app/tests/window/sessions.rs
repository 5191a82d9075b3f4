//! Saving and opening sessions, patterns from files, and errors in such files.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use serde_json::json;
use tilescope_app::App;
use tilescope_classroom::lessons::LessonCommand;
use tilescope_core::Parameter;
use tilescope_session::layers::Layer;
use tilescope_session::look::Look;
use tilescope_workbench::Command;
use tilescope_workbench::command::{AppearanceCommand, FormCommand, TimeCommand, WindowCommand};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::files::{FileCommand, Purpose, SaveTask};
use tilescope_workbench::layout::Panel;

use crate::support::sessions::{apply, busy, folder, go, notice, path_text};
use crate::support::{is_disabled, node, opened, session, settle, text};

#[test]
fn a_session_is_opened_where_it_was_left() {
    let path = folder("round").join("one.json");
    let mut harness = busy();
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Events)),
    );
    apply(
        &mut harness,
        Command::Appearance(AppearanceCommand::Look(Look::Light)),
    );
    let before = SaveTask::of(&harness.state().state).run.expect("a session");
    let digest = before.digest.clone();
    go(&mut harness, Purpose::Save, &path);
    let (message, is_error) = notice(&harness);
    assert!(
        !is_error && message.contains(&path_text(&path)),
        "{message}"
    );
    drop(harness);

    let mut other = opened();
    assert_ne!(
        SaveTask::of(&other.state().state)
            .run
            .expect("a session")
            .digest,
        digest
    );
    go(&mut other, Purpose::Open, &path);
    let state = &other.state().state;
    let after = SaveTask::of(state).run.expect("a session");
    assert_eq!(after, before);
    assert!(
        state
            .runs()
            .first
            .verdict()
            .expect("verified")
            .report
            .valid()
    );
    assert_eq!(state.runs().first.selected, Some(40));
    assert_eq!(state.appearance().look, Look::Light);
    assert!(state.appearance().layers(None).has(Layer::Disks));
    assert!(state.window().layout.shows(Panel::Events));
    assert_eq!(state.form().draft.parameters, before.parameters);
    assert_eq!(
        state.runs().first.debugger.as_ref().unwrap().scenes[0].caption,
        "here"
    );
}

#[test]
fn the_second_run_comes_back_too() {
    let path = folder("second").join("two.json");
    let mut harness = busy();
    let start = CompareCommand::Start(ComparePreset::NextSeed);
    apply(&mut harness, Command::Compare(start));
    go(&mut harness, Purpose::Save, &path);
    let mut other = opened();
    go(&mut other, Purpose::Open, &path);
    let (side, _) = other
        .state()
        .state
        .runs()
        .second
        .as_ref()
        .expect("a second run");
    assert_eq!(side.session.as_ref().unwrap().run().parameters.seed, 2);
}

#[test]
fn the_sheet_is_used_by_keys_and_asks_before_it_replaces() {
    let path = folder("keys").join("mine.json");
    std::fs::write(&path, "somebody else's").unwrap();
    let mut harness = busy();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    harness.run();
    // The whole name is selected: typing replaces it, Enter saves.
    harness.event(egui::Event::Text(path_text(&path)));
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    settle(&mut harness);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "somebody else's");
    assert!(asks(&harness));
    harness.key_press(Key::Enter);
    harness.run();
    settle(&mut harness);
    assert!(
        std::fs::read_to_string(&path)
            .unwrap()
            .contains("\"digest\"")
    );
    assert!(harness.state().state.files().sheet.is_none());
    // The file now belongs to this session.
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    harness.run();
    assert!(!asks(&harness));
    node(&harness, "file.go").click();
    harness.run();
    settle(&mut harness);
    assert!(harness.state().state.files().sheet.is_none());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::O);
    harness.run();
    node(&harness, "file.go");
    harness.key_press(Key::Escape);
    harness.run();
    assert!(harness.state().state.files().sheet.is_none());
}

/// Returns whether the sheet asks before it replaces a file.
fn asks(harness: &Harness<'_, App>) -> bool {
    !text(harness, "file.question").trim().is_empty()
}

/// Writes a user's pattern: the result of a small run, with its certificate.
pub(crate) fn pattern(harness: &mut Harness<'_, App>, folder: &Path) -> PathBuf {
    let path = folder.join("own.csv");
    let session = session(harness);
    let run = session.run();
    let region = tilescope_analysis::Region {
        width: 1.0,
        height: 1.0,
        boundary: tilescope_analysis::Boundary::Periodic,
    };
    let context = tilescope_formats::ExportContext::new(region, run.domain.radius());
    let control = |_| std::ops::ControlFlow::Continue(());
    let set = tilescope_formats::PointSet {
        points: run.positions(),
        provenance: None,
    };
    tilescope_formats::export(&path, &set, &context, &control).expect("an export");
    path
}

#[test]
fn a_pattern_of_ones_own_is_used_saved_and_missed_when_it_is_gone() {
    let folder = folder("pattern");
    let mut harness = busy();
    let own = pattern(&mut harness, &folder);
    go(&mut harness, Purpose::Pattern, &own);
    let (message, is_error) = notice(&harness);
    assert!(!is_error && message.contains("own.csv"), "{message}");
    apply(
        &mut harness,
        Command::Form(FormCommand::Type(Parameter::Seed, "3".to_owned())),
    );
    apply(&mut harness, Command::Run);
    let session = session(&harness);
    let own_pattern = session.own.as_ref().expect("a pattern of one's own");
    assert_eq!(own_pattern.file.path, path_text(&own));
    assert_eq!(
        session.run().pattern.samples().len(),
        own_pattern.pattern.samples().len()
    );
    assert!(
        harness
            .state()
            .state
            .runs()
            .first
            .verdict()
            .unwrap()
            .report
            .valid()
    );
    let path = folder.join("with-pattern.json");
    go(&mut harness, Purpose::Save, &path);
    let saved = SaveTask::of(&harness.state().state).run;

    let mut other = opened();
    go(&mut other, Purpose::Open, &path);
    assert_eq!(SaveTask::of(&other.state().state).run, saved);
    // The same content elsewhere, beside the session.
    let moved = folder.join("moved");
    std::fs::create_dir(&moved).unwrap();
    for name in ["own.csv", "with-pattern.json"] {
        std::fs::copy(folder.join(name), moved.join(name)).unwrap();
    }
    let certificate = tilescope_formats::certificate_path(&own);
    let name = certificate.file_name().unwrap();
    std::fs::copy(&certificate, moved.join(name)).unwrap();
    std::fs::remove_file(&own).unwrap();
    go(&mut other, Purpose::Open, &moved.join("with-pattern.json"));
    let found = other
        .state()
        .state
        .runs()
        .first
        .session
        .as_ref()
        .unwrap()
        .own
        .clone();
    assert_eq!(found.expect("found").file.digest, own_pattern.file.digest);
    // The pattern file is missing.
    go(&mut other, Purpose::Open, &path);
    let (message, is_error) = notice(&other);
    assert!(is_error && message.contains("own.csv"), "{message}");
}

#[test]
fn files_that_are_not_patterns_are_refused() {
    let folder = folder("no-pattern");
    let mut harness = opened();
    let bare = folder.join("bare.csv");
    std::fs::write(&bare, "x,y\n0.1,0.2\n0.5,0.6\n").unwrap();
    go(&mut harness, Purpose::Pattern, &bare);
    let (message, is_error) = notice(&harness);
    assert!(is_error && message.contains("certificate"), "{message}");
    assert!(harness.state().state.form().own_pattern.is_none());
    go(&mut harness, Purpose::Pattern, &folder.join("none.csv"));
    assert!(notice(&harness).1);
}

#[test]
fn a_dropped_file_is_opened_by_its_kind() {
    let folder = folder("dropped");
    let path = folder.join("dropped.json");
    let mut harness = busy();
    go(&mut harness, Purpose::Save, &path);
    let saved = SaveTask::of(&harness.state().state).run;
    let own = pattern(&mut harness, &folder);
    let mut other = opened();
    apply(
        &mut other,
        Command::File(FileCommand::Dropped(vec![path_text(&path)])),
    );
    assert_eq!(SaveTask::of(&other.state().state).run, saved);
    apply(
        &mut other,
        Command::File(FileCommand::Dropped(vec![path_text(&own)])),
    );
    assert!(other.state().state.form().own_pattern.is_some());
    apply(
        &mut other,
        Command::Window(WindowCommand::OpenPanel(Panel::Parameters)),
    );
    assert!(text(&other, "own-pattern").contains(&path_text(&own)));
    node(&other, "generated-pattern").click();
    other.run();
    assert!(other.state().state.form().own_pattern.is_none());
}

/// A file that is dropped on a window, by its path alone.
#[derive(Debug)]
struct DroppedPath(PathBuf);

impl egui::DroppedFile for DroppedPath {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("the window reads files by their paths".to_owned())
    }
}

/// Beside a lesson a small window shows a player alone, which has no sheets, and takes files nevertheless.
#[test]
fn a_file_dropped_beside_a_lesson_in_a_small_window_is_opened() {
    let path = folder("dropped-beside").join("dropped.json");
    let mut harness = busy();
    go(&mut harness, Purpose::Save, &path);
    let saved = SaveTask::of(&harness.state().state).run;

    let mut other = opened();
    other.set_size([700.0, 560.0].into());
    let open = LessonCommand::Open("clips".to_owned());
    apply(&mut other, Command::Lesson(open));
    let window = other.state().state.window();
    assert!(window.drawer.arrangement.is_compact() && window.embedding.is_none());
    assert_ne!(SaveTask::of(&other.state().state).run, saved);

    let dropped = Arc::new(DroppedPath(path));
    other.input_mut().dropped_files.push(dropped);
    other.step();
    settle(&mut other);
    assert_eq!(SaveTask::of(&other.state().state).run, saved);
}

#[test]
fn one_block_and_the_fewest_samples_are_sessions_and_three_are_refused_with_the_limit() {
    let mut harness = opened();
    // A domain of a single block: conflicts occur only across the border.
    apply(
        &mut harness,
        Command::Form(FormCommand::Type(Parameter::Radius, "0.05".to_owned())),
    );
    apply(&mut harness, Command::Run);
    let state = &harness.state().state;
    let session = state.runs().first.session.as_ref().unwrap();
    assert_eq!(session.summary.blocks, 1);
    assert!(state.runs().first.verdict().unwrap().report.valid());
    for index in 0..session.stages.len() {
        apply(&mut harness, Command::Time(TimeCommand::ShowStage(index)));
    }
    // As few samples as there can be: a side of 6 r.
    apply(
        &mut harness,
        Command::Form(FormCommand::Choose(
            tilescope_workbench::draft::Choice::Parameter(Parameter::Boundary, json!("bounded")),
        )),
    );
    apply(
        &mut harness,
        Command::Form(FormCommand::Type(Parameter::Radius, "0.1666".to_owned())),
    );
    apply(&mut harness, Command::Run);
    let state = &harness.state().state;
    let count = state.runs().first.session.as_ref().unwrap().summary.count;
    assert!((15..40).contains(&count), "{count}");
    assert!(state.runs().first.verdict().unwrap().report.valid());
    let all = [
        Layer::Disks,
        Layer::Delaunay,
        Layer::Voronoi,
        Layer::Circumcircles,
    ];
    for layer in all {
        apply(
            &mut harness,
            Command::Appearance(AppearanceCommand::ToggleLayer(layer)),
        );
    }
    for _ in 0..200 {
        harness
            .state_mut()
            .state
            .apply(Command::Time(TimeCommand::Step(
                tilescope_debugger::Step::Into,
                tilescope_debugger::Direction::Backwards,
            )));
        harness.run();
    }
    // Three samples leave no room for a gap detector's disk.
    let before = SaveTask::of(&harness.state().state).run;
    apply(
        &mut harness,
        Command::Form(FormCommand::Type(Parameter::Radius, "0.5".to_owned())),
    );
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Parameters)),
    );
    assert!(is_disabled(&harness, "run"));
    let refusal = text(&harness, "refusal-radius");
    assert!(refusal.contains("4 r"), "{refusal}");
    apply(&mut harness, Command::Run);
    assert_eq!(SaveTask::of(&harness.state().state).run, before);
}

#[test]
fn a_session_that_is_opened_stays_when_a_run_at_work_ends() {
    let path = folder("at-work").join("one.json");
    let mut harness = busy();
    go(&mut harness, Purpose::Save, &path);
    let saved = SaveTask::of(&harness.state().state).run;
    let mut other = opened();
    let state = &mut other.state_mut().state;
    state.apply(Command::Form(FormCommand::Type(
        Parameter::Seed,
        "77".to_owned(),
    )));
    state.apply(Command::Run);
    for command in [
        FileCommand::Sheet(Purpose::Open),
        FileCommand::Path(path_text(&path)),
        FileCommand::Go,
    ] {
        state.apply(Command::File(command));
    }
    settle(&mut other);
    assert_eq!(SaveTask::of(&other.state().state).run, saved);
    // A run started while a file is read is not replaced by it.
    let state = &mut other.state_mut().state;
    state.apply(Command::File(FileCommand::Sheet(Purpose::Open)));
    state.apply(Command::File(FileCommand::Go));
    state.apply(Command::Form(FormCommand::Type(
        Parameter::Seed,
        "78".to_owned(),
    )));
    state.apply(Command::Run);
    settle(&mut other);
    let session = other.state().state.runs().first.session.clone().unwrap();
    assert_eq!(session.run().parameters.seed, 78);
}

#[test]
fn a_sheet_that_is_closed_opens_nothing_and_another_session_is_not_the_files() {
    let path = folder("closed").join("one.json");
    let mut harness = busy();
    go(&mut harness, Purpose::Save, &path);
    let first = std::fs::read_to_string(&path).unwrap();
    let mut other = opened();
    let before = SaveTask::of(&other.state().state).run;
    let state = &mut other.state_mut().state;
    for command in [
        FileCommand::Sheet(Purpose::Open),
        FileCommand::Path(path_text(&path)),
        FileCommand::Go,
        FileCommand::Close,
    ] {
        state.apply(Command::File(command));
    }
    settle(&mut other);
    assert_eq!(SaveTask::of(&other.state().state).run, before);
    // After another run has started, the file no longer belongs to the session.
    go(&mut other, Purpose::Open, &path);
    apply(
        &mut other,
        Command::Form(FormCommand::Type(Parameter::Seed, "5".to_owned())),
    );
    apply(&mut other, Command::Run);
    go(&mut other, Purpose::Save, &path);
    assert!(asks(&other));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), first);
}
