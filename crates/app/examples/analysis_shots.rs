//! Renders the live analysis to pictures, without a display:
//! `cargo run --release -p tilescope-app --example analysis_shots FOLDER`.

use std::path::Path;

use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_debugger::{Direction, Target};
use tilescope_session::look::Look;
use tilescope_workbench::Command;
use tilescope_workbench::analysis::AnalysisCommand;
use tilescope_workbench::analysis::brush::{Brush, BrushAxis};
use tilescope_workbench::command::{
    AppearanceCommand, FormCommand, TimeCommand, ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::draft::Field;
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::layout::{Layout, Panel};
use tilescope_workbench::state::Settings;

fn main() {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".to_owned());
    let noise = Path::new(&folder).join("noise.csv");
    std::fs::write(&noise, independent(10_000)).expect("a writable folder");
    let mut harness = Harness::builder()
        .with_size([1440.0, 900.0])
        .with_max_steps(64)
        .wgpu()
        .build_eframe(|creation| {
            let mut app = App::new(&creation.egui_ctx);
            app.draw_with(creation.wgpu_render_state.as_ref().expect("a device"));
            app
        });
    harness.state_mut().state.settle();
    harness.run();
    let mut shoot = |name: &str, commands: Vec<Command>| {
        save(&mut harness, &folder, name, commands);
    };
    let brush =
        |axis, from, to| Command::Analysis(AnalysisCommand::Brush(Brush::between(axis, from, to)));
    shoot(
        "analysis",
        vec![Command::Window(WindowCommand::OpenPanel(Panel::Analysis))],
    );
    shoot(
        "analysis-tiled",
        vec![Command::Time(TimeCommand::ShowStage(2))],
    );
    shoot(
        "analysis-pattern",
        vec![Command::Time(TimeCommand::FirstStage)],
    );
    let middle = TimeCommand::RunTo(Target::Elimination, Direction::Forwards);
    shoot(
        "analysis-light",
        vec![
            Command::Time(middle),
            Command::Appearance(AppearanceCommand::Look(Look::Light)),
        ],
    );
    let sheet = Command::File(FileCommand::Sheet(Purpose::Against));
    let path = Command::File(FileCommand::Path(noise.to_string_lossy().into_owned()));
    let go = Command::File(FileCommand::Go);
    shoot(
        "analysis-sheet",
        vec![Command::Time(TimeCommand::LastStage), sheet, path],
    );
    shoot("analysis-file", vec![go]);
    let near = || Command::View(Which::First, ViewCommand::FlyTo([37.0, 45.0].into(), 18.0));
    let distances = brush(BrushAxis::Distance, 1.0, 1.05);
    shoot("analysis-distances", vec![near(), distances]);
    shoot("analysis-ring", vec![brush(BrushAxis::Frequency, 0.8, 1.0)]);
    shoot(
        "analysis-ring-dark",
        vec![
            Command::Appearance(AppearanceCommand::Look(Look::Dark)),
            Command::View(Which::First, ViewCommand::Fit),
        ],
    );
    shoot(
        "analysis-projector",
        vec![Command::Appearance(AppearanceCommand::Look(
            Look::Projector,
        ))],
    );
    let large = vec![
        brush(BrushAxis::Distance, 1.0, 1.01),
        Command::Appearance(AppearanceCommand::Look(Look::Dark)),
        Command::Form(FormCommand::Type(Field::Radius, "0.0014".to_owned())),
        Command::Run,
    ];
    shoot("analysis-large", large);
    harness.state_mut().state.restore(Settings {
        layout: Some(Layout::alone(Panel::Analysis)),
        ..Settings::default()
    });
    save(&mut harness, &folder, "analysis-alone", vec![]);
    let light = vec![Command::Appearance(AppearanceCommand::Look(Look::Light))];
    save(&mut harness, &folder, "analysis-alone-light", light);
    harness.set_size(egui::vec2(310.0, 1400.0));
    save(&mut harness, &folder, "analysis-narrow-light", vec![]);
    let dark = vec![Command::Appearance(AppearanceCommand::Look(Look::Dark))];
    save(&mut harness, &folder, "analysis-narrow", dark);
}

fn save(harness: &mut Harness<'_, App>, folder: &str, name: &str, commands: Vec<Command>) {
    for command in commands {
        harness.state_mut().state.apply(command);
    }
    harness.state_mut().state.settle();
    harness.run();
    harness.step();
    let image = harness.render().expect("a picture of the window");
    let path = Path::new(folder).join(format!("{name}.png"));
    image.save(&path).expect("a writable folder");
    println!("{}", path.display());
}

/// Returns independent samples as a file of the unit square.
fn independent(count: u32) -> String {
    let mut state = 7_u64;
    let mut draw = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let lines = (0..count).map(|_| format!("{},{}\n", draw(), draw()));
    format!("x,y\n{}", lines.collect::<Vec<String>>().concat())
}
