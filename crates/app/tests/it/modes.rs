//! Modes: each is left by the key that entered it, and by Escape where users expect that.

use egui::{Key, KeyboardShortcut, Modifiers};
use tilescope_app::actions::actions;
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_workbench::analysis::AnalysisCommand;
use tilescope_workbench::analysis::brush::{Brush, BrushAxis};
use tilescope_workbench::arrangement::{Arrangement, DrawerCommand};
use tilescope_workbench::command::{AppearanceCommand, ViewCommand, Which, WindowCommand};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::export::ExportKind;
use tilescope_workbench::files::Purpose;
use tilescope_workbench::layout::Panel;
use tilescope_workbench::view::SavedView;
use tilescope_workbench::{Command, State};

use crate::exporting::opened;

/// Runs the action of a key pressed outside text fields; returns whether there is one.
fn press(state: &mut State, modifiers: Modifiers, key: Key) -> bool {
    let meant = KeyboardShortcut::new(modifiers, key);
    let all = actions(state);
    let mut able = all.into_iter().filter(|action| action.refusal.is_none());
    let found = able.find(|action| action.keys().any(|shortcut| shortcut == meant));
    let Some(action) = found else {
        return false;
    };
    state.apply(action.command);
    true
}

fn escape(state: &mut State) -> bool {
    press(state, Modifiers::NONE, Key::Escape)
}

#[test]
fn the_projector_mode_returns_to_the_look_before() {
    let mut state = opened();
    for before in [Look::Light, Look::Dark] {
        state.apply(Command::Appearance(AppearanceCommand::Look(before)));
        for way_out in [Key::F2, Key::Escape] {
            let names = || actions(&state).into_iter().map(|action| action.name);
            assert!(names().any(|name| name == "Projector mode"));
            assert!(press(&mut state, Modifiers::NONE, Key::F2));
            assert_eq!(state.appearance().look, Look::Projector);
            let listed = actions(&state);
            let toggle = |name: &str| listed.iter().any(|action| action.name == name);
            assert!(toggle("Leave the projector mode") && !toggle("Projector mode"));
            assert!(press(&mut state, Modifiers::NONE, way_out));
            assert_eq!(state.appearance().look, before, "{way_out:?}");
        }
    }
    assert!(!escape(&mut state), "there is nothing to leave");
    // A saved view may begin in a mode.
    let mut view = SavedView::of(&state);
    view.appearance.look = Look::Projector;
    state.apply(Command::Appearance(AppearanceCommand::Look(Look::Light)));
    state.look_as(&view);
    assert_eq!(state.appearance().look, Look::Projector);
    assert!(escape(&mut state));
    assert_eq!(state.appearance().look, Look::Light);
}

#[test]
fn escape_leaves_one_thing_after_another() {
    let mut state = opened();
    state.apply(Command::Appearance(AppearanceCommand::ToggleProjector));
    let arrange = DrawerCommand::Arrange(Arrangement::Portrait);
    state.apply(Command::Window(WindowCommand::Drawer(arrange)));
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Legend)));
    let brush = Brush::between(BrushAxis::Distance, 1.0, 1.05);
    state.apply(Command::Analysis(AnalysisCommand::Brush(brush)));
    state.apply(Command::View(
        Which::First,
        ViewCommand::Pick(Selection::Sample(3)),
    ));
    let entered = |state: &State| {
        [
            state.runs().first.selected.is_some(),
            state.analysis().brush.is_some(),
            state.window().drawer.open.is_some(),
            state.appearance().look == Look::Projector,
        ]
    };
    for left in 0..4 {
        let expected: [bool; 4] = std::array::from_fn(|k| k >= left);
        assert_eq!(entered(&state), expected);
        assert!(escape(&mut state));
    }
    assert_eq!(entered(&state), [false; 4]);
}

#[test]
fn the_key_that_opens_a_sheet_or_the_list_closes_it() {
    let mut state = opened();
    let both = Modifiers::COMMAND | Modifiers::SHIFT;
    let is_open = |state: &State| {
        (
            state.files().sheet.as_ref().map(|form| form.purpose),
            state.files().exports.sheet.as_ref().map(|form| form.kind),
            state.window().finder.is_some(),
        )
    };
    for (modifiers, key, expected) in [
        (
            Modifiers::COMMAND,
            Key::O,
            (Some(Purpose::Open), None, false),
        ),
        (
            Modifiers::COMMAND,
            Key::S,
            (Some(Purpose::Save), None, false),
        ),
        (
            Modifiers::COMMAND,
            Key::E,
            (None, Some(ExportKind::Result), false),
        ),
        (both, Key::E, (None, Some(ExportKind::Picture), false)),
        (Modifiers::COMMAND, Key::K, (None, None, true)),
    ] {
        assert!(press(&mut state, modifiers, key));
        assert_eq!(is_open(&state), expected, "{key:?}");
        assert!(press(&mut state, modifiers, key));
        assert_eq!(is_open(&state), (None, None, false), "{key:?}");
    }
}

#[test]
fn the_analysis_is_left_by_its_key_where_there_are_no_tabs() {
    let mut state = opened();
    state.apply(Command::Appearance(AppearanceCommand::ToggleProjector));
    for arrangement in [Arrangement::Tiles, Arrangement::Portrait] {
        let arrange = DrawerCommand::Arrange(arrangement);
        state.apply(Command::Window(WindowCommand::Drawer(arrange)));
        for expected in [true, false] {
            assert!(press(&mut state, Modifiers::NONE, Key::A));
            assert_eq!(
                state.window().shows(Panel::Analysis),
                expected,
                "{arrangement:?}"
            );
        }
    }
}

#[test]
fn modes_without_a_key_have_an_action_that_leaves_them() {
    let mut state = opened();
    let has = |state: &State, name: &str| {
        let all = actions(state);
        all.iter()
            .any(|action| action.name == name && action.refusal.is_none())
    };
    assert!(!has(&state, "Close B"));
    let start = CompareCommand::Start(ComparePreset::NextSeed);
    state.apply(Command::Compare(start));
    assert!(has(&state, "Close B"));
    state.apply(Command::Compare(CompareCommand::Close));
    assert!(state.runs().second.is_none());
    // An embedded window has no keys for modes that it could not leave.
    for command in [
        Command::Appearance(AppearanceCommand::ToggleProjector),
        Command::Window(WindowCommand::ToggleFinder),
        Command::Window(WindowCommand::OpenPanel(Panel::Analysis)),
    ] {
        assert!(!command.rules().in_frame);
    }
}
