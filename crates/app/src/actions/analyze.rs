//! The Analyze menu: measures of the moment, the reference, and brushing.

use egui::Key;

use super::{List, Menu, no_session};
use tilescope_workbench::analysis::AnalysisCommand;
use tilescope_workbench::analysis::brush::{Brush, BrushAxis, FIRST_PEAK};
use tilescope_workbench::arrangement::DrawerCommand;
use tilescope_workbench::command::{Command, WindowCommand};
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::state::State;

/// Adds the actions of the menu.
pub(super) fn add(list: &mut List, state: &State) {
    list.menu = Menu::Analyze;
    let analysis = state.analysis();
    // Where there are tiles, a tab of another panel leads away from the analysis. Small windows and the projector mode have no
    // tiles, so that this action also hides the analysis.
    let (name, command) = if !state.window().shows(Panel::Analysis) {
        ("Show analysis", WindowCommand::OpenPanel(Panel::Analysis))
    } else if state.window().drawer.arrangement.is_compact() {
        let close = DrawerCommand::Show(None);
        ("Hide analysis", WindowCommand::Drawer(close))
    } else if state.appearance().look.is_projector() {
        // The projector mode shows the analysis alone: to open any other panel hides it.
        ("Hide analysis", WindowCommand::OpenPanel(Panel::Parameters))
    } else {
        ("Show analysis", WindowCommand::OpenPanel(Panel::Analysis))
    };
    list.add(name, Command::Window(command)).on_key(Key::A);

    let against = Command::File(FileCommand::Sheet(Purpose::Against));
    list.add("Compare with a file\u{2026}", against)
        .refused(no_session(state));
    let is_without = analysis.reference_file.is_none();
    let clear = Command::Analysis(AnalysisCommand::Clear);
    list.add("Remove the comparison file", clear)
        .refused(is_without.then_some("This run is not compared with a file."));

    let measuring = &state.runs().first.measuring;
    let in_space = &state.runs().first.solid_measuring;
    let is_idle = measuring.progress().is_none() && in_space.progress().is_none();
    let stop = Command::Analysis(AnalysisCommand::Stop);
    list.add("Cancel measuring", stop)
        .refused(is_idle.then_some("Nothing is being measured."));

    let shown = state.runs().first.shown();
    let is_stopped = shown.is_some_and(|shown| measuring.is_stopped(&shown));
    let resume = Command::Analysis(AnalysisCommand::Resume);
    list.add("Measure this moment", resume)
        .refused((!is_stopped).then_some("Measuring this moment was not cancelled."));

    list.group();
    brushes(list, state);
}

/// Adds brushing by keyboard.
fn brushes(list: &mut List, state: &State) {
    // Without a pointer no range can be dragged on a chart: these actions brush some ranges, and the panel has fields
    // for others. Below the first peak the power of a maximal set is least, and distances just above r are the most
    // frequent in it. The ends are chosen.
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
        list.add(name, brush).refused(no_session(state));
    }

    let is_nothing = state.analysis().brush.is_none();
    let clear = Command::Analysis(AnalysisCommand::Brush(None));
    list.add("Clear the brush", clear)
        .refused(is_nothing.then_some("Nothing is brushed."));
}
