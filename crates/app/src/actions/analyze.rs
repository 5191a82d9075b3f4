//! The Analyze menu: measures of the moment, the reference, and brushing.

use egui::Key;

use super::{List, Menu, NO_SESSION, NONE};
use tilescope_workbench::analysis::AnalysisCommand;
use tilescope_workbench::analysis::brush::{Brush, BrushAxis, FIRST_PEAK};
use tilescope_workbench::arrangement::DrawerCommand;
use tilescope_workbench::command::{Command, WindowCommand};
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::state::State;

/// Adds the actions of the menu.
pub(super) fn add(list: &mut List, state: &State) {
    let mut add = |name: &str, key: Option<Key>, command, refusal: Option<&str>| {
        let keys = key.map(|key| (NONE, key));
        list.add(Menu::Analyze, name, keys, command, refusal);
    };
    let analysis = &state.analysis;
    let no_session = state.runs.first.session.is_none().then_some(NO_SESSION);
    // With tiles, tabs lead away from the analysis; the projector mode and small windows have no tabs.
    let open = Command::Window(WindowCommand::OpenPanel(Panel::Analysis));
    let (name, command) = if !state.analyses() {
        ("Show analysis", open)
    } else if state.window.drawer.arrangement.is_compact() {
        (
            "Hide analysis",
            Command::Window(WindowCommand::Drawer(DrawerCommand::Show(None))),
        )
    } else if state.appearance.look.is_projector() {
        (
            "Hide analysis",
            Command::Window(WindowCommand::OpenPanel(Panel::Parameters)),
        )
    } else {
        ("Show analysis", open)
    };
    add(name, Some(Key::A), command, None);
    let against = Command::File(FileCommand::Sheet(Purpose::Against));
    add("Compare with a file\u{2026}", None, against, no_session);
    let none = "This run is not compared with a file.";
    let clear = Command::Analysis(AnalysisCommand::Clear);
    let refusal = analysis.reference_file.is_none().then_some(none);
    add("Remove the comparison file", None, clear, refusal);
    let idle = "Nothing is being measured.";
    let refusal = analysis.progress().is_none().then_some(idle);
    let stop = Command::Analysis(AnalysisCommand::Stop);
    add("Cancel measuring", None, stop, refusal);
    let stopped = state
        .shown()
        .is_some_and(|shown| analysis.is_stopped(&shown));
    let refusal = (!stopped).then_some("Measuring this moment was not cancelled.");
    let resume = Command::Analysis(AnalysisCommand::Resume);
    add("Measure this moment", None, resume, refusal);
    list.group();
    brushes(list, state);
}

/// Adds brushing by keyboard.
fn brushes(list: &mut List, state: &State) {
    let mut add = |name: &str, key: Option<Key>, command, refusal: Option<&str>| {
        let keys = key.map(|key| (NONE, key));
        list.add(Menu::Analyze, name, keys, command, refusal);
    };
    let no_session = state.runs.first.session.is_none().then_some(NO_SESSION);
    for (name, axis, [from, to]) in [
        (
            "Brush frequencies about the first peak",
            BrushAxis::Frequency,
            FIRST_PEAK,
        ),
        (
            "Brush frequencies below the first peak",
            BrushAxis::Frequency,
            [0.1, 0.6],
        ),
        (
            "Brush distances just above r",
            BrushAxis::Distance,
            [1.0, 1.05],
        ),
    ] {
        let brush = Command::Analysis(AnalysisCommand::Brush(Brush::between(axis, from, to)));
        add(name, None, brush, no_session);
    }
    let refusal = state
        .analysis
        .brush
        .is_none()
        .then_some("Nothing is brushed.");
    let clear = Command::Analysis(AnalysisCommand::Brush(None));
    add("Clear the brush", None, clear, refusal);
}
