//! The accessibility tree: every focusable widget has a name, no two fields on the screen share a name, and no two
//! widgets an id.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use egui::accesskit::{Action, NodeId, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::App;
use tilescope_core::Parameter;
use tilescope_session::selection::Selection;
use tilescope_ui::spoken::Spoken;
use tilescope_workbench::Command;
use tilescope_workbench::command::{DebugCommand, TimeCommand, ViewCommand, Which, WindowCommand};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::export::{ExportCommand, ExportKind};
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::scenes::SceneCommand;

use crate::support::sessions::{apply, busy};
use crate::support::{cursor, ids, node, opened_at, settle};

/// Fields that hold a value: their names must be unique.
const FIELDS: [Role; 5] = [
    Role::TextInput,
    Role::MultilineTextInput,
    Role::ComboBox,
    Role::Slider,
    Role::SpinButton,
];

/// A focusable widget: id, role and name.
fn focusable(harness: &Harness<'_, App>) -> Vec<(NodeId, Role, String)> {
    let nodes = harness.query_all_by(|node| node.data().supports_action(Action::Focus));
    let names = nodes.map(|node| {
        let node = node.accesskit_node();
        let name = node.label().unwrap_or_default();
        (node.locate().0, node.role(), name.trim().to_owned())
    });
    names.collect()
}

fn check(harness: &Harness<'_, App>, view: &str) {
    let all = focusable(harness);
    assert!(!all.is_empty(), "{view}: nothing can have the focus");
    let nameless: Vec<_> = all.iter().filter(|(.., name)| name.is_empty()).collect();
    assert!(nameless.is_empty(), "{view}: without a name: {nameless:?}");
    let mut fields: BTreeMap<(String, &str), usize> = BTreeMap::new();
    for (_, role, name) in all.iter().filter(|(_, role, _)| FIELDS.contains(role)) {
        *fields.entry((format!("{role:?}"), name)).or_default() += 1;
    }
    fields.retain(|_, count| *count > 1);
    assert!(fields.is_empty(), "{view}: equal names: {fields:?}");
    let mut ids = ids(harness);
    ids.sort_unstable();
    let twice: Vec<_> = ids.windows(2).filter(|pair| pair[0] == pair[1]).collect();
    assert!(ids.len() > 8 && twice.is_empty(), "{view}: {twice:?}");
}

/// Adds two each of watches, scenes and breakpoints.
fn crowded() -> Harness<'static, App> {
    let mut harness = busy();
    let line = tilescope_debugger::Listings::shipped()
        .find("eliminate.4")
        .expect("a line");
    for command in [
        Command::Debug(DebugCommand::ToggleBreakpoint(line)),
        Command::Debug(DebugCommand::Watch("block".to_owned())),
        Command::Time(TimeCommand::Jump(3_100)),
        Command::Scene(SceneCommand::Add),
        Command::View(Which::First, ViewCommand::Pick(Selection::Sample(40))),
        Command::Compare(CompareCommand::Start(ComparePreset::Order)),
    ] {
        apply(&mut harness, command);
    }
    harness
}

#[test]
fn whatever_can_have_the_focus_has_a_name_of_its_own() {
    let mut harness = crowded();
    for size in [[1440.0, 900.0], [390.0, 844.0]] {
        harness.set_size(size.into());
        harness.run();
        for panel in Panel::all() {
            apply(
                &mut harness,
                Command::Window(WindowCommand::OpenPanel(panel)),
            );
            check(&harness, &format!("{panel:?} at {size:?}"));
        }
    }
}

#[test]
fn sheets_and_lists_have_names_too() {
    let mut harness = opened_at([1440.0, 900.0]);
    for kind in ExportKind::ALL {
        apply(&mut harness, Command::Export(ExportCommand::Open(kind)));
        check(&harness, &format!("the sheet of {kind:?}"));
    }
    harness.key_press(egui::Key::Escape);
    settle(&mut harness);
    for purpose in [
        Purpose::Save,
        Purpose::Open,
        Purpose::Pattern,
        Purpose::Combination,
        Purpose::Against,
    ] {
        apply(&mut harness, Command::File(FileCommand::Sheet(purpose)));
        check(&harness, purpose.title());
        apply(&mut harness, Command::File(FileCommand::Close));
    }
    apply(&mut harness, Command::Window(WindowCommand::ToggleFinder));
    check(&harness, "the list of all actions");
    apply(&mut harness, Command::Window(WindowCommand::ToggleFinder));
    for id in ["clock", "menu.view"] {
        node(&harness, id).click();
        harness.run();
        check(&harness, id);
        harness.key_press(egui::Key::Escape);
        harness.run();
    }
}

/// The announcements since the last call.
fn taken(announced: &Mutex<Vec<Spoken>>) -> Vec<Spoken> {
    std::mem::take(&mut announced.lock().expect("nothing failed"))
}

fn texts(announced: &Mutex<Vec<Spoken>>) -> Vec<String> {
    taken(announced)
        .into_iter()
        .map(|spoken| spoken.text)
        .collect()
}

#[test]
fn the_focused_widget_and_its_changes_are_announced() {
    let mut harness = opened_at([1440.0, 900.0]);
    let announced = Arc::new(Mutex::new(Vec::new()));
    let received = Arc::clone(&announced);
    App::speak_to(&harness.ctx, move |spoken| {
        received
            .lock()
            .expect("nothing failed")
            .push(spoken.clone());
    });
    harness.run();
    assert_eq!(taken(&announced), []);
    let focus = |harness: &mut Harness<'_, App>, role, name| {
        harness.get_by_role_and_label(role, name).focus();
        harness.run();
    };
    // A field is named by its label.
    focus(&mut harness, Role::TextInput, "Radius");
    let spoken = taken(&announced);
    let typed = |harness: &Harness<'_, App>| {
        let draft = &harness.state().state.form().draft;
        draft.text(Parameter::Radius).to_owned()
    };
    let before = typed(&harness);
    assert_eq!(spoken[0].text, format!("Radius, text field, {before}"));
    assert_eq!(spoken[0].field, "Radius");
    harness.event(egui::Event::Text("5".to_owned()));
    harness.run();
    assert_ne!(typed(&harness), before);
    assert_eq!(texts(&announced), [typed(&harness)]);
    focus(&mut harness, Role::ComboBox, "Clock");
    let spoken = taken(&announced);
    assert_eq!(spoken[0].text, "Clock, drop-down list, stage");
    assert_eq!(spoken[0].field, "");
    focus(&mut harness, Role::CheckBox, "Disks");
    assert!(texts(&announced)[0].starts_with("Disks, check box, "));
    harness.key_press(egui::Key::Space);
    harness.run();
    let changed = texts(&announced);
    assert!(
        ["checked", "not checked"].contains(&changed[0].as_str()),
        "{changed:?}"
    );
    // Values that change during playback are not announced.
    apply(&mut harness, Command::Time(TimeCommand::FirstStage));
    focus(&mut harness, Role::Slider, "Moment");
    assert_eq!(texts(&announced), ["Moment, slider, 0"]);
    harness
        .state_mut()
        .state
        .apply(Command::Time(TimeCommand::TogglePlay));
    for _ in 0..8 {
        harness.step();
    }
    assert!(cursor(&harness) > 0);
    assert_eq!(texts(&announced), Vec::<String>::new());
    harness
        .state_mut()
        .state
        .apply(Command::Time(TimeCommand::TogglePlay));
    harness.run();
    taken(&announced);
    // In the list of actions the field keeps the focus, and the selection is announced.
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::K);
    harness.run();
    let opened = texts(&announced).join(" ");
    assert!(opened.contains("Find an action, text field"), "{opened}");
    harness.key_press(egui::Key::ArrowDown);
    harness.run();
    let second = tilescope_app::actions::actions(&harness.state().state)[1]
        .name
        .clone();
    assert_eq!(texts(&announced), [second]);
    // After the focus has left, no field has the keyboard.
    harness.key_press(egui::Key::Escape);
    harness.run();
    assert_eq!(taken(&announced).last(), Some(&Spoken::default()));
}
