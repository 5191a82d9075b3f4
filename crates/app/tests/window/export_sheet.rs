//! The export sheet by keys and clicks, in both themes.

use std::path::Path;

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_classroom::lessons::LessonCommand;
use tilescope_session::look::Look;
use tilescope_workbench::Command;
use tilescope_workbench::command::{AppearanceCommand, TimeCommand, WindowCommand};
use tilescope_workbench::export::{ExportCommand, ExportKind};

use crate::language::texts;
use crate::support::{find, is_disabled, node, opened, opened_at, settle, text};

fn press(harness: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run();
}

fn kind(harness: &Harness<'_, App>) -> Option<ExportKind> {
    let form = harness.state().state.files().exports.sheet.as_ref();
    form.map(|form| form.kind)
}

/// Replaces the text of a field.
fn retype(harness: &mut Harness<'_, App>, field: &str, text: &str) {
    node(harness, field).focus();
    harness.run();
    press(harness, Modifiers::COMMAND, Key::A);
    node(harness, field).type_text(text);
    harness.run();
}

fn name_file(harness: &mut Harness<'_, App>, path: &Path) {
    retype(harness, "export.path", &path.to_string_lossy());
}

#[test]
fn a_picture_is_written_by_keys_and_replaced_only_after_a_question() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("moment.png");
    let mut harness = opened();
    press(&mut harness, Modifiers::NONE, Key::Home);
    press(&mut harness, Modifiers::NONE, Key::E);
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    assert_eq!(kind(&harness), Some(ExportKind::Picture));
    // Typing replaces the proposed file name.
    node(&harness, "export.path").type_text(&path.to_string_lossy());
    harness.run();
    let form = harness
        .state()
        .state
        .files()
        .exports
        .sheet
        .clone()
        .expect("open");
    assert_eq!(form.file(), path);
    let format = text(&harness, "export.format");
    assert!(format.contains("PNG"), "{format}");
    node(&harness, "export.format.svg").click();
    harness.run();
    assert!(text(&harness, "export.format").contains("SVG"));
    node(&harness, "export.format.png").click();
    harness.run();
    retype(&mut harness, "export.scale", "0.5");
    let prospect = text(&harness, "export.prospect");
    assert!(prospect.contains("pixels"), "{prospect}");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    settle(&mut harness);
    assert!(text(&harness, "notice").contains("moment.png"));
    assert_eq!(kind(&harness), None);
    let first = std::fs::read(&path).expect("a picture");
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    name_file(&mut harness, &path);
    assert!(text(&harness, "export.taken").contains("moment.png"));
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(std::fs::read(&path).expect("still there"), first);
    assert!(text(&harness, "export.write").contains("moment.png"));
    node(&harness, "export.write").click();
    harness.step();
    settle(&mut harness);
    assert_eq!(kind(&harness), None);
    assert_ne!(std::fs::read(&path).expect("another"), first);
}

#[test]
fn the_kinds_are_chosen_by_their_names_and_keep_the_file() {
    let mut harness = opened();
    press(&mut harness, Modifiers::COMMAND, Key::E);
    assert_eq!(kind(&harness), Some(ExportKind::Result));
    assert!(text(&harness, "export.prospect").contains("10,041"));
    for (kind, extension) in [
        ("export.samples", ".csv"),
        ("export.picture", ".png"),
        ("export.animation", ".gif"),
        ("export.result", ".csv"),
    ] {
        node(&harness, kind).click();
        harness.run();
        assert!(!is_disabled(&harness, "export.write"), "{kind}");
        let path = &harness
            .state()
            .state
            .files()
            .exports
            .sheet
            .as_ref()
            .expect("open")
            .path;
        assert!(path.ends_with(extension), "{path}");
    }
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert_eq!(kind(&harness), None);
}

#[test]
fn errors_are_shown_in_the_sheet_and_in_the_menu() {
    let mut harness = opened();
    press(&mut harness, Modifiers::NONE, Key::Home);
    let export = |command| Command::Export(command);
    harness
        .state_mut()
        .state
        .apply(export(ExportCommand::Open(ExportKind::Animation)));
    harness.run();
    assert!(is_disabled(&harness, "export.write"));
    assert!(is_disabled(&harness, "export.samples"));
    harness
        .state_mut()
        .state
        .apply(Command::Time(TimeCommand::LastStage));
    harness.run();
    for (field, wrong, facts, right) in [
        ("export.every", "0", ["1", "10,000,000"], "1"),
        ("export.delay", "5", ["delay", "\"5\" ms"], "40"),
        ("export.scale", "9", ["\"9\"", "from 0.5 to 8"], "2"),
    ] {
        retype(&mut harness, field, wrong);
        let said = text(&harness, "export.prospect");
        assert!(facts.iter().all(|fact| said.contains(fact)), "{said}");
        assert!(is_disabled(&harness, "export.write"), "{field}");
        retype(&mut harness, field, right);
        assert!(!is_disabled(&harness, "export.write"), "{field}");
    }
    node(&harness, "export.line").click();
    harness.run();
    assert!(text(&harness, "export.prospect").contains("600"));
    press(&mut harness, Modifiers::NONE, Key::Escape);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    press(&mut harness, Modifiers::NONE, Key::Home);
    for command in [
        Command::Window(WindowCommand::ToggleFinder),
        Command::Window(WindowCommand::FinderText("export".to_owned())),
    ] {
        harness.state_mut().state.apply(command);
    }
    harness.run();
    for (action, is_refused) in [
        ("export-open-samples", true),
        ("export-open-picture", false),
        ("export-open-animation", false),
        ("export-cancel", true),
    ] {
        let id = format!("action.file-{action}");
        assert_eq!(is_disabled(&harness, &id), is_refused, "{action}");
    }
}

#[test]
fn every_kind_of_the_sheet_is_drawn_in_both_themes() {
    let mut harness = opened_at([1100.0, 760.0]);
    for look in [Look::Dark, Look::Light] {
        let mut pictures = std::collections::BTreeSet::new();
        harness
            .state_mut()
            .state
            .apply(Command::Appearance(AppearanceCommand::Look(look)));
        for kind in ExportKind::ALL {
            let command = Command::Export(ExportCommand::Open(kind));
            harness.state_mut().state.apply(command);
            harness.run();
            let picture = harness.render().expect("a picture");
            pictures.insert(picture.as_raw().clone());
        }
        assert_eq!(pictures.len(), ExportKind::ALL.len(), "{look:?}");
    }
}

#[test]
fn the_analysis_is_put_beside_pictures_by_a_click() {
    let mut harness = opened();
    for kind in [
        ExportKind::Picture,
        ExportKind::Animation,
        ExportKind::Result,
    ] {
        let command = Command::Export(ExportCommand::Open(kind));
        harness.state_mut().state.apply(command);
        harness.run();
        // Samples have no picture that something could be beside.
        if kind == ExportKind::Result {
            assert!(find(&harness, "export.analysis").is_none());
            continue;
        }
        let before = text(&harness, "export.prospect");
        node(&harness, "export.analysis").click();
        harness.run();
        let after = text(&harness, "export.prospect");
        assert_ne!(before, after, "the picture is wider");
        node(&harness, "export.analysis").click();
        harness.run();
        assert_eq!(text(&harness, "export.prospect"), before);
    }
}

#[test]
fn the_sheet_has_the_language_of_the_window() {
    let shown = |language: &str| {
        let mut harness = opened();
        // The language of the window is that of an open lesson.
        let lesson = LessonCommand::Open("welcome".to_owned());
        for command in [
            Command::Lesson(LessonCommand::Language(language.to_owned())),
            Command::Lesson(lesson),
            Command::Export(ExportCommand::Open(ExportKind::Picture)),
        ] {
            harness.state_mut().state.apply(command);
            settle(&mut harness);
        }
        harness.run();
        texts(&harness)
    };
    let english = shown("en");
    let others = ["de", "es"].map(shown);
    let canvas = "The canvas as it is, with the parameters inside. Marks of a comparison and of GPU buffers are left out.";
    for text in [
        canvas,
        "Scale",
        "Colours",
        "for print",
        "below the picture",
        "pixels for a point of the window",
        "Write picture",
    ] {
        assert!(english.contains(text), "{text}");
        assert!(others.iter().all(|texts| !texts.contains(text)), "{text}");
    }
    let [german, spanish] = &others;
    assert!(german.contains("Bild schreiben") && spanish.contains("Escribir imagen"));
}
