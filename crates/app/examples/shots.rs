//! Renders states of the window to pictures, without a display:
//! `cargo run --release -p tilescope-app --example shots FOLDER`.

use std::path::Path;

use egui_kittest::Harness;
use tilescope_app::canvas::layers::{Colouring, Layer};
use tilescope_app::command::{Choice, DebugCommand, Field, Selection, TimeCommand, Witness};
use tilescope_app::export::{Entry, ExportCommand, Kind};
use tilescope_app::layout::Panel;
use tilescope_app::theme::Look;
use tilescope_app::{App, Command};
use tilescope_core::Search;
use tilescope_debugger::{Direction, Step, Target};

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
        }
        harness.state_mut().state.settle();
        harness.run();
        let image = harness.render().expect("a picture of the window");
        let path = Path::new(&folder).join(format!("{name}.png"));
        image.save(&path).expect("a writable folder");
        println!("{}", path.display());
    };
    let near = || Command::FlyTo([37.0, 45.0], 18.0);
    shoot("finish", vec![]);
    shoot("tile", vec![Command::ShowStage(2)]);
    shoot("tile-zoom", vec![near()]);
    shoot(
        "eliminate-zoom",
        vec![Command::StepForward, Command::ToggleLayer(Layer::Disks)],
    );
    shoot("iterate-zoom", vec![Command::StepForward]);
    shoot(
        "finish-zoom",
        vec![Command::LastStage, Command::Colour(Colouring::Provenance)],
    );
    shoot(
        "largest-hole",
        vec![Command::FlyToWitness(Witness::LargestHole)],
    );
    shoot("pattern", vec![Command::ShowStage(0), Command::Fit]);
    shoot(
        "light-blocks",
        vec![Command::ToggleTheme, Command::ShowStage(1)],
    );
    shoot(
        "light",
        vec![Command::LastStage, Command::ToggleLayer(Layer::Disks)],
    );
    shoot(
        "light-eliminate",
        vec![
            Command::ShowStage(3),
            near(),
            Command::Export(ExportCommand::Open(Kind::Result)),
        ],
    );
    shoot(
        "light-iterate",
        vec![Command::Export(ExportCommand::Close), Command::StepForward],
    );
    exports(&mut shoot);
    moments(&mut shoot);
    let gaps = vec![
        Command::Choose(Choice::Search(Search::TwoRadii)),
        Command::Type(Field::Leaf, "6".to_owned()),
        Command::Type(Field::Radius, "0.004".to_owned()),
        Command::ToggleTheme,
        Command::Run,
    ];
    shoot("two-radii", gaps);
    shoot(
        "two-radii-witness",
        vec![Command::FlyToWitness(Witness::Verdict)],
    );
    let large = vec![
        Command::Choose(Choice::Search(Search::Complete)),
        Command::Type(Field::Leaf, "40".to_owned()),
        Command::Type(Field::Radius, "0.0007".to_owned()),
        Command::Run,
    ];
    shoot("large", large);
    shoot("large-zoom", vec![near()]);
    let bad = vec![
        Command::Type(Field::Radius, "0".to_owned()),
        Command::Type(Field::Leaf, "2".to_owned()),
    ];
    shoot("bad", bad);
}

/// The export sheet, in what it can write.
fn exports(shoot: &mut dyn FnMut(&str, Vec<Command>)) {
    for (name, kind) in [
        ("export-result", Kind::Result),
        ("export-samples", Kind::Samples),
        ("export-picture", Kind::Picture),
        ("export-animation", Kind::Animation),
    ] {
        let open = Command::Export(ExportCommand::Open(kind));
        shoot(name, vec![open, Command::ToggleTheme]);
    }
    let wrong = |entry, text: &str| Command::Export(ExportCommand::Type(entry, text.to_owned()));
    shoot(
        "export-refused",
        vec![wrong(Entry::Every, "1"), wrong(Entry::Scale, "1e9")],
    );
    shoot("export-closed", vec![Command::Export(ExportCommand::Close)]);
}

/// Moments in the middle of stages, with the debugger's panels.
fn moments(shoot: &mut dyn FnMut(&str, Vec<Command>)) {
    let run_to = |target| Command::Time(TimeCommand::RunTo(target, Direction::Forwards));
    let into = || Command::Time(TimeCommand::Step(Step::Into, Direction::Forwards));
    let debug = Command::Debug;
    shoot(
        "moment-elimination",
        vec![
            Command::ToggleTheme,
            Command::FirstStage,
            run_to(Target::Elimination),
            into(),
            Command::OpenPanel(Panel::Events),
            Command::OpenPanel(Panel::Watches),
            debug(DebugCommand::Watch("distance".to_owned())),
            debug(DebugCommand::Watch("nonsense(".to_owned())),
        ],
    );
    shoot(
        "moment-gap",
        vec![
            run_to(Target::Gap),
            into(),
            debug(DebugCommand::Pick(Selection::Sample(900))),
            Command::OpenPanel(Panel::Inspector),
            debug(DebugCommand::Query("insert iteration>1".to_owned())),
            Command::GoToCurrent,
        ],
    );
    shoot("moment-gap-light", vec![Command::ToggleTheme]);
    let nets = [Layer::Delaunay, Layer::Voronoi, Layer::Circumcircles];
    shoot("moment-geometry", nets.map(Command::ToggleLayer).to_vec());
    shoot(
        "moment-no-geometry",
        nets.map(Command::ToggleLayer).to_vec(),
    );
    shoot(
        "moment-insertion",
        vec![
            run_to(Target::SecondInsertion),
            into(),
            debug(DebugCommand::Bookmark),
            Command::OpenPanel(Panel::Bookmarks),
            Command::GoToCurrent,
        ],
    );
    shoot(
        "passes",
        vec![
            Command::Engine(tilescope_app::device::Engine::Gpu),
            Command::OpenPanel(Panel::Passes),
        ],
    );
    shoot("passes-run", vec![Command::OpenPasses]);
    shoot("passes-closed", vec![Command::OpenPanel(Panel::Canvas)]);
    shoot("projector", vec![Command::Look(Look::Projector)]);
    let actions = Command::PaletteText("next".to_owned());
    shoot(
        "actions",
        vec![Command::Look(Look::Dark), Command::TogglePalette, actions],
    );
    shoot(
        "actions-closed",
        vec![Command::TogglePalette, Command::LastStage],
    );
}
