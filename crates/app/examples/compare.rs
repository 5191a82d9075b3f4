//! Renders two runs side by side, without a display: `cargo run --release -p tilescope-app --example compare FOLDER`.

use std::path::Path;

use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_session::look::Look;
use tilescope_workbench::Command;
use tilescope_workbench::command::{
    AppearanceCommand, FormCommand, TimeCommand, ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::draft::Field;
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
        let image = harness.render().expect("a picture of the window");
        let path = Path::new(&folder).join(format!("{name}.png"));
        image.save(&path).expect("a writable folder");
        println!("{}", path.display());
    };
    let start = |preset| Command::Compare(CompareCommand::Start(preset));
    shoot(
        "none",
        vec![Command::Window(WindowCommand::OpenPanel(Panel::Compare))],
    );
    shoot(
        "order",
        vec![
            start(ComparePreset::Order),
            Command::Time(TimeCommand::ShowStage(3)),
        ],
    );
    shoot("seeds", vec![start(ComparePreset::NextSeed)]);
    shoot(
        "seeds-near",
        vec![Command::View(
            Which::First,
            ViewCommand::FlyTo([37.0, 45.0].into(), 24.0),
        )],
    );
    shoot(
        "order-fitted",
        vec![
            start(ComparePreset::Order),
            Command::View(Which::First, ViewCommand::Fit),
        ],
    );
    let near = Command::View(Which::First, ViewCommand::FlyTo([37.0, 45.0].into(), 24.0));
    shoot("order-near", vec![near.clone()]);
    shoot(
        "light",
        vec![Command::Appearance(AppearanceCommand::ToggleTheme)],
    );
    shoot(
        "search",
        vec![
            Command::Form(FormCommand::Type(Field::Leaf, "6".to_owned())),
            Command::Run,
            start(ComparePreset::Search),
            Command::Compare(CompareCommand::GoToDivergence),
        ],
    );
    shoot(
        "projector",
        vec![
            Command::Appearance(AppearanceCommand::Look(Look::Projector)),
            Command::Time(TimeCommand::Jump(20_000)),
            near,
        ],
    );
    let sheet =
        tilescope_workbench::files::FileCommand::Sheet(tilescope_workbench::files::Purpose::Save);
    shoot("projector-sheet", vec![Command::File(sheet)]);
}
