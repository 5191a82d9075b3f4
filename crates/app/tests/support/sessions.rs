//! Helpers: sessions in progress, and a folder of files for each test.

use std::path::{Path, PathBuf};

use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_core::Parameter;
use tilescope_debugger::Listings;
use tilescope_session::layers::Layer;
use tilescope_session::selection::Selection;
use tilescope_workbench::Command;
use tilescope_workbench::clock::Clock;
use tilescope_workbench::command::{
    AppearanceCommand, DebugCommand, FormCommand, TimeCommand, ViewCommand, Which,
};
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::scenes::SceneCommand;

use super::{opened, settle};

pub fn apply(harness: &mut Harness<'_, App>, command: Command) {
    harness.state_mut().state.apply(command);
    settle(harness);
}

/// An empty folder for this test.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("sessions")
        .join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}

pub fn path_text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

pub fn go(harness: &mut Harness<'_, App>, purpose: Purpose, path: &Path) {
    apply(harness, Command::File(FileCommand::Sheet(purpose)));
    apply(harness, Command::File(FileCommand::Path(path_text(path))));
    apply(harness, Command::File(FileCommand::Go));
}

pub fn notice(harness: &Harness<'_, App>) -> (String, bool) {
    let notice = harness
        .state()
        .state
        .messages()
        .notice
        .clone()
        .expect("a notice");
    (notice.text, notice.is_error)
}

/// A small run with a breakpoint, a watch and a scene, in the middle of elimination.
pub fn busy() -> Harness<'static, App> {
    let mut harness = opened();
    apply(
        &mut harness,
        Command::Form(FormCommand::Type(Parameter::Radius, "0.02".to_owned())),
    );
    apply(
        &mut harness,
        Command::Form(FormCommand::Type(Parameter::Leaf, "12".to_owned())),
    );
    apply(&mut harness, Command::Run);
    let line = Listings::shipped().find("eliminate.5").expect("a line");
    for command in [
        DebugCommand::ToggleBreakpoint(line),
        DebugCommand::Condition(0, "distance < 0.4".to_owned()),
        DebugCommand::Watch("distance".to_owned()),
    ] {
        apply(&mut harness, Command::Debug(command));
    }
    let pick = ViewCommand::Pick(Selection::Sample(40));
    apply(&mut harness, Command::View(Which::First, pick));
    apply(&mut harness, Command::Time(TimeCommand::Jump(3_000)));
    apply(&mut harness, Command::Scene(SceneCommand::Add));
    let caption = SceneCommand::Caption(0, "here".to_owned());
    apply(&mut harness, Command::Scene(caption));
    apply(&mut harness, Command::Time(TimeCommand::Jump(3_456)));
    apply(&mut harness, Command::Time(TimeCommand::Clock(Clock::Line)));
    apply(
        &mut harness,
        Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Disks)),
    );
    apply(
        &mut harness,
        Command::View(Which::First, ViewCommand::FlyTo([20.0, 21.0].into(), 9.0)),
    );
    harness.state_mut().state.advance(5.0);
    harness.run();
    harness
}
