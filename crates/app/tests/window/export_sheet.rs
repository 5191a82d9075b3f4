//! The export sheet as a user meets it: by keys and labels, in both themes.

use std::path::Path;

use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::export::{ExportCommand, Kind};
use tilescope_app::theme::Look;
use tilescope_app::{App, Command};

use crate::support::{opened, settle};

fn press(harness: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run();
}

fn kind(harness: &Harness<'_, App>) -> Option<Kind> {
    let form = harness.state().state.export.as_ref();
    form.map(|form| form.kind)
}

/// Types into a field in the place of what is there.
fn retype(harness: &mut Harness<'_, App>, field: &str, text: &str) {
    harness
        .get_by_role_and_label(Role::TextInput, field)
        .focus();
    harness.run();
    press(harness, Modifiers::COMMAND, Key::A);
    harness
        .get_by_role_and_label(Role::TextInput, field)
        .type_text(text);
    harness.run();
}

fn is_disabled(harness: &Harness<'_, App>, label: &str) -> bool {
    harness.get_by_label(label).accesskit_node().is_disabled()
}

fn name_file(harness: &mut Harness<'_, App>, path: &Path) {
    retype(harness, "File", &path.to_string_lossy());
}

#[test]
fn a_picture_is_written_by_keys_and_replaced_only_after_a_question() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("moment.png");
    let mut harness = opened();
    press(&mut harness, Modifiers::NONE, Key::Home);
    press(&mut harness, Modifiers::NONE, Key::E);
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    assert_eq!(kind(&harness), Some(Kind::Picture));
    // What is typed goes into the file's name, in the place of the one proposed.
    harness
        .get_by_role_and_label(Role::TextInput, "File")
        .type_text(&path.to_string_lossy());
    harness.run();
    let form = harness.state().state.export.clone().expect("open");
    assert_eq!(form.file(), path);
    harness.get_by_label_contains("Format: PNG. The extension chooses the format: .png .svg.");
    retype(&mut harness, "Scale", "0.5");
    harness.get_by_label_contains("pixels.");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    settle(&mut harness);
    harness.get_by_label_contains("Wrote the picture to");
    assert_eq!(kind(&harness), None);
    let first = std::fs::read(&path).expect("a picture");
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    name_file(&mut harness, &path);
    harness.get_by_label("moment.png exists already and would be replaced.");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(std::fs::read(&path).expect("still there"), first);
    harness.get_by_label("Replace moment.png?").click();
    harness.step();
    settle(&mut harness);
    assert_eq!(kind(&harness), None);
    assert_ne!(std::fs::read(&path).expect("another"), first);
}

#[test]
fn the_kinds_are_chosen_by_their_names_and_keep_the_file() {
    let mut harness = opened();
    press(&mut harness, Modifiers::COMMAND, Key::E);
    assert_eq!(kind(&harness), Some(Kind::Result));
    harness.get_by_label_contains("10,041 samples.");
    for (name, button, extension) in [
        (
            "Samples of this moment",
            "Write file and certificate",
            ".csv",
        ),
        ("Picture", "Write picture", ".png"),
        ("Animation", "Write animation", ".gif"),
        ("Result", "Write file and certificate", ".csv"),
    ] {
        harness.get_by_role_and_label(Role::Button, name).click();
        harness.run();
        assert!(!is_disabled(&harness, button), "{name}");
        let path = &harness.state().state.export.as_ref().expect("open").path;
        assert!(path.ends_with(extension), "{path}");
    }
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert_eq!(kind(&harness), None);
}

#[test]
fn what_is_wrong_is_said_in_the_sheet_and_in_the_menu() {
    let mut harness = opened();
    press(&mut harness, Modifiers::NONE, Key::Home);
    let export = |command| Command::Export(command);
    harness
        .state_mut()
        .state
        .apply(export(ExportCommand::Open(Kind::Animation)));
    harness.run();
    harness.get_by_label_contains("is empty: there is nothing to animate");
    assert!(is_disabled(&harness, "Write animation"));
    assert!(is_disabled(&harness, "Samples of this moment"));
    harness.state_mut().state.apply(Command::LastStage);
    harness.run();
    retype(&mut harness, "A frame every", "0");
    harness.get_by_label_contains("whole number from 1 to 10,000,000");
    retype(&mut harness, "A frame every", "1");
    retype(&mut harness, "Delay", "5");
    harness.get_by_label_contains("The delay is \"5\" ms");
    retype(&mut harness, "Delay", "40");
    retype(&mut harness, "Scale", "9");
    harness.get_by_label_contains("The scale is \"9\"; it must be a number from 0.5 to 8.");
    retype(&mut harness, "Scale", "2");
    assert!(!is_disabled(&harness, "Write animation"));
    harness.get_by_label("lines").click();
    harness.run();
    harness.get_by_label_contains(" frames of at most 600, ");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    press(&mut harness, Modifiers::NONE, Key::Home);
    for command in [
        Command::TogglePalette,
        Command::PaletteText("export".to_owned()),
    ] {
        harness.state_mut().state.apply(command);
    }
    harness.run();
    assert!(is_disabled(
        &harness,
        "Export samples of this moment\u{2026}"
    ));
    assert!(!is_disabled(
        &harness,
        "Export picture of this moment\u{2026}"
    ));
    assert!(!is_disabled(&harness, "Export animation\u{2026}"));
    assert!(is_disabled(&harness, "Cancel the export"));
}

#[test]
fn every_kind_of_the_sheet_is_drawn_in_both_themes() {
    let mut harness = opened();
    for look in [Look::Dark, Look::Light] {
        let mut pictures = std::collections::BTreeSet::new();
        harness.state_mut().state.apply(Command::Look(look));
        for kind in Kind::ALL {
            let command = Command::Export(ExportCommand::Open(kind));
            harness.state_mut().state.apply(command);
            harness.run();
            let picture = harness.render().expect("a picture");
            pictures.insert(picture.as_raw().clone());
        }
        assert_eq!(pictures.len(), Kind::ALL.len(), "{look:?}");
    }
}
