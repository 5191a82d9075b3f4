//! Renders combinations, without a display: `cargo run --release -p tilescope-app --example combine FOLDER`.

use std::path::Path;

use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_session::combination::CombineCommand;
use tilescope_session::layers::{Colouring, Layer};
use tilescope_session::look::Look;
use tilescope_workbench::Command;
use tilescope_workbench::command::{
    AppearanceCommand, TimeCommand, ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::layout::Panel;

fn main() {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".to_owned());
    let mut harness = Harness::builder()
        .with_size([1600.0, 1000.0])
        .with_max_steps(64)
        .build_eframe(|creation| App::new(&creation.egui_ctx));
    harness.state_mut().state.settle();
    harness.run();
    let mut shoot = |name: &str, commands: Vec<Command>| {
        for command in commands {
            harness.state_mut().state.apply(command);
            harness.state_mut().state.settle();
            harness.run();
        }
        while harness.state_mut().state.advance(1.0) {}
        harness.run();
        let image = harness.render().expect("a picture of the window");
        let path = Path::new(&folder).join(format!("{name}.png"));
        image.save(&path).expect("a writable folder");
        println!("{}", path.display());
    };
    let near = || Command::View(Which::First, ViewCommand::FlyTo([50.0, 50.0].into(), 30.0));
    shoot(
        "nine",
        vec![
            Command::Combine(CombineCommand::Nine),
            Command::Window(WindowCommand::OpenPanel(Panel::Statistics)),
            Command::Window(WindowCommand::OpenPanel(Panel::Legend)),
        ],
    );
    shoot("nine-near", vec![near()]);
    shoot(
        "nine-placed-near",
        vec![Command::Time(TimeCommand::ShowStage(1))],
    );
    shoot(
        "nine-eliminated-near",
        vec![Command::Time(TimeCommand::ShowStage(2))],
    );
    shoot(
        "nine-pieces",
        vec![
            Command::Time(TimeCommand::FirstStage),
            Command::View(Which::First, ViewCommand::Fit),
        ],
    );
    shoot(
        "light",
        vec![
            Command::Time(TimeCommand::LastStage),
            Command::Appearance(AppearanceCommand::ToggleTheme),
        ],
    );
    shoot(
        "light-origin-near",
        vec![
            near(),
            Command::Appearance(AppearanceCommand::Colour(Colouring::Provenance)),
        ],
    );
    shoot(
        "projector",
        vec![
            Command::Appearance(AppearanceCommand::Colour(Colouring::Block)),
            Command::Appearance(AppearanceCommand::Look(Look::Projector)),
        ],
    );
    shoot(
        "projector-fit",
        vec![Command::View(Which::First, ViewCommand::Fit)],
    );
    shoot(
        "bare",
        vec![
            Command::Appearance(AppearanceCommand::Look(Look::Light)),
            Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Blocks)),
            Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Gaps)),
        ],
    );
}
