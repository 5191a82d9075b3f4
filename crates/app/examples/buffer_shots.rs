//! Renders buffers of the GPU on the canvas to pictures, without a display:
//! `cargo run --release -p tilescope-app --example buffer_shots FOLDER`.

use std::path::Path;

use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_core::Insertion;
use tilescope_gpu::layout::Name;
use tilescope_workbench::Command;
use tilescope_workbench::command::{
    AppearanceCommand, FormCommand, GpuCommand, ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::device::EngineChoice;
use tilescope_workbench::draft::{Choice, Field};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::passes::{PassCommand, PassSide, Passes};

fn main() {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".to_owned());
    let mut harness = Harness::builder()
        .with_size([1600.0, 1000.0])
        .with_max_steps(64)
        .build_eframe(|creation| App::new(&creation.egui_ctx));
    let near = || Command::View(Which::First, ViewCommand::FlyTo([37.0, 45.0].into(), 18.0));
    apply(&mut harness, vec![]);
    apply(
        &mut harness,
        vec![Command::Gpu(GpuCommand::Engine(EngineChoice::Gpu))],
    );
    apply(&mut harness, vec![Command::OpenPasses]);
    let canvas = || Command::Passes(PassCommand::ShowCanvas);
    go(&mut harness, "tile", Name::Places);
    apply(
        &mut harness,
        vec![Command::Window(WindowCommand::OpenPanel(Panel::Passes))],
    );
    shoot(&mut harness, &folder, "panel");
    apply(&mut harness, vec![canvas()]);
    shoot(&mut harness, &folder, "places");
    apply(&mut harness, vec![near()]);
    shoot(&mut harness, &folder, "places-near");
    for (pass, buffer) in [
        ("tile", Name::Heads),
        ("blocks", Name::Pieces),
        ("count", Name::Images),
        ("sort blocks", Name::TileImages),
        ("eliminate", Name::Places),
        ("attribute", Name::By),
        ("survive", Name::Grid),
        ("detectors", Name::Grid),
        ("open", Name::List),
        ("place", Name::Proposals),
        ("gather", Name::Result),
        ("gather", Name::Counters),
    ] {
        go(&mut harness, pass, buffer);
        apply(&mut harness, vec![]);
        let buffer = buffer.as_str();
        shoot(
            &mut harness,
            &folder,
            &format!("{}-{buffer}", pass.replace(' ', "-")),
        );
    }
    go(&mut harness, "detectors", Name::Grid);
    let before = PassCommand::Side(PassSide::Before);
    let filter = PassCommand::Filter("flags>=4".to_owned());
    let commands = [before, filter, PassCommand::PickRow(Some(9_000))].map(Command::Passes);
    apply(&mut harness, commands.to_vec());
    apply(
        &mut harness,
        vec![
            Command::View(Which::First, ViewCommand::Fit),
            Command::Appearance(AppearanceCommand::ToggleTheme),
        ],
    );
    shoot(&mut harness, &folder, "before-filtered-light");
    let uniform = vec![
        Command::Passes(PassCommand::Filter(String::new())),
        Command::Form(FormCommand::Choose(Choice::Insertion(Insertion::Uniform))),
        Command::Form(FormCommand::Type(Field::Radius, "0.02".to_owned())),
        Command::Run,
    ];
    apply(&mut harness, uniform);
    apply(&mut harness, vec![Command::OpenPasses]);
    go(&mut harness, "throw", Name::Active);
    apply(&mut harness, vec![canvas(), near()]);
    shoot(&mut harness, &folder, "uniform");
}

fn apply(harness: &mut Harness<'_, App>, commands: Vec<Command>) {
    for command in commands {
        harness.state_mut().state.apply(command);
    }
    harness.state_mut().state.settle();
    harness.run();
}

/// Goes to the first pass of this name, and to one of its buffers.
fn go(harness: &mut Harness<'_, App>, pass: &str, buffer: Name) {
    let passes = |harness: &Harness<'_, App>| harness.state().state.runs().first.passes.is_some();
    assert!(passes(harness), "the passes have not been run");
    let state = &harness.state().state;
    let entries = state.runs().first.passes.iter().flat_map(Passes::entries);
    let index = entries
        .map(|entry| entry.report.name)
        .position(|name| name == pass);
    let select = PassCommand::Select(index.expect("such a pass"));
    apply(harness, vec![Command::Passes(select)]);
    let state = &harness.state().state;
    let visit = state
        .runs()
        .first
        .passes
        .as_ref()
        .and_then(|passes| passes.visit());
    let mut tables = visit.expect("a visit").buffers.iter();
    let index = tables.position(|table| table.name == buffer);
    let choose = PassCommand::Buffer(index.unwrap_or(0));
    apply(harness, vec![Command::Passes(choose)]);
}

fn shoot(harness: &mut Harness<'_, App>, folder: &str, name: &str) {
    let image = harness.render().expect("a picture of the window");
    let path = Path::new(folder).join(format!("buffers-{name}.png"));
    image.save(&path).expect("a writable folder");
    println!("{}", path.display());
}
