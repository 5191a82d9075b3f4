//! Renders states of the window to pictures, without a display:
//! `cargo run --release -p tilescope-app --example shots FOLDER`.

use std::path::Path;

use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_core::Search;
use tilescope_debugger::{Direction, Target};
use tilescope_session::layers::{Colouring, Layer};
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_session::verification::Witness;
use tilescope_workbench::command::{
    AppearanceCommand, DebugCommand, FormCommand, GpuCommand, TimeCommand, ViewCommand, Which,
    WindowCommand,
};
use tilescope_workbench::draft::{Choice, Field};
use tilescope_workbench::export::{ExportCommand, ExportKind, NumberField};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::scenes::SceneCommand;
use tilescope_workbench::{Command, State};

fn main() {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".to_owned());
    let mut harness = Harness::builder()
        .with_size([1600.0, 1000.0])
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
        for command in commands {
            harness.state_mut().state.apply(command);
        }
        save(&mut harness, &folder, name);
    };
    let near = || Command::View(Which::First, ViewCommand::FlyTo([37.0, 45.0].into(), 18.0));
    shoot("finish", vec![]);
    shoot("tile", vec![Command::Time(TimeCommand::ShowStage(2))]);
    shoot("tile-zoom", vec![near()]);
    shoot(
        "eliminate-zoom",
        vec![
            Command::Time(TimeCommand::StepForward),
            Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Disks)),
        ],
    );
    shoot(
        "iterate-zoom",
        vec![Command::Time(TimeCommand::StepForward)],
    );
    shoot(
        "finish-zoom",
        vec![
            Command::Time(TimeCommand::LastStage),
            Command::Appearance(AppearanceCommand::Colour(Colouring::Provenance)),
        ],
    );
    shoot(
        "largest-hole",
        vec![Command::View(
            Which::First,
            ViewCommand::FlyToWitness(Witness::LargestHole),
        )],
    );
    shoot(
        "pattern",
        vec![
            Command::Time(TimeCommand::ShowStage(0)),
            Command::View(Which::First, ViewCommand::Fit),
        ],
    );
    shoot(
        "light-blocks",
        vec![
            Command::Appearance(AppearanceCommand::ToggleTheme),
            Command::Time(TimeCommand::ShowStage(1)),
        ],
    );
    shoot(
        "light",
        vec![
            Command::Time(TimeCommand::LastStage),
            Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Disks)),
        ],
    );
    shoot(
        "light-eliminate",
        vec![
            Command::Time(TimeCommand::ShowStage(3)),
            near(),
            Command::Export(ExportCommand::Open(ExportKind::Result)),
        ],
    );
    shoot(
        "light-iterate",
        vec![
            Command::Export(ExportCommand::Close),
            Command::Time(TimeCommand::StepForward),
        ],
    );
    exports(&mut shoot);
    moments(&mut shoot);
    ages_and_tree(&mut shoot);
    other_parameters(&mut shoot);
    pointed_at(&mut harness, &folder);
}

/// A search that is too short, a large run, and parameters that cannot be run.
fn other_parameters(shoot: &mut dyn FnMut(&str, Vec<Command>)) {
    let near = Command::View(Which::First, ViewCommand::FlyTo([37.0, 45.0].into(), 18.0));
    let gaps = vec![
        Command::Form(FormCommand::Choose(Choice::Search(Search::TwoRadii))),
        Command::Form(FormCommand::Type(Field::Leaf, "6".to_owned())),
        Command::Form(FormCommand::Type(Field::Radius, "0.004".to_owned())),
        Command::Appearance(AppearanceCommand::ToggleTheme),
        Command::Run,
    ];
    shoot("two-radii", gaps);
    shoot(
        "two-radii-witness",
        vec![Command::View(
            Which::First,
            ViewCommand::FlyToWitness(Witness::Verdict),
        )],
    );
    let large = vec![
        Command::Form(FormCommand::Choose(Choice::Search(Search::Complete))),
        Command::Form(FormCommand::Type(Field::Leaf, "40".to_owned())),
        Command::Form(FormCommand::Type(Field::Radius, "0.0007".to_owned())),
        Command::Run,
    ];
    shoot("large", large);
    shoot("large-zoom", vec![near]);
    let bad = vec![
        Command::Form(FormCommand::Type(Field::Radius, "0".to_owned())),
        Command::Form(FormCommand::Type(Field::Leaf, "2".to_owned())),
    ];
    shoot("bad", bad);
}

fn save(harness: &mut Harness<'_, App>, folder: &str, name: &str) {
    harness.state_mut().state.settle();
    harness.run();
    // Layers thinned out during camera movement are complete in the next frame.
    harness.step();
    let image = harness.render().expect("a picture of the window");
    let path = Path::new(folder).join(format!("{name}.png"));
    image.save(&path).expect("a writable folder");
    println!("{}", path.display());
}

/// Samples by age, and the KD-tree half built and complete. Restores the window's state.
fn ages_and_tree(shoot: &mut dyn FnMut(&str, Vec<Command>)) {
    let by_age = Command::Appearance(AppearanceCommand::Colour(Colouring::Age));
    let tree = || Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Tree));
    shoot(
        "age",
        vec![
            by_age,
            Command::View(Which::First, ViewCommand::Fit),
            Command::Window(WindowCommand::OpenPanel(Panel::Legend)),
        ],
    );
    shoot(
        "age-zoom",
        vec![Command::View(
            Which::First,
            ViewCommand::FlyTo([37.0, 45.0].into(), 24.0),
        )],
    );
    shoot(
        "age-zoom-light",
        vec![Command::Appearance(AppearanceCommand::Look(Look::Light))],
    );
    shoot(
        "age-light",
        vec![Command::View(Which::First, ViewCommand::Fit)],
    );
    shoot(
        "age-projector",
        vec![Command::Appearance(AppearanceCommand::Look(
            Look::Projector,
        ))],
    );
    shoot(
        "tree-projector",
        vec![Command::Time(TimeCommand::ShowStage(1)), tree()],
    );
    let small = vec![
        Command::Form(FormCommand::Type(Field::Leaf, "6".to_owned())),
        Command::Run,
    ];
    shoot("tree-small-leaf", small);
    let middle = vec![
        Command::Time(TimeCommand::ShowStage(1)),
        Command::Appearance(AppearanceCommand::Look(Look::Light)),
        Command::Time(TimeCommand::Jump(60)),
    ];
    shoot("tree-middle-light", middle);
    shoot(
        "tree-middle",
        vec![Command::Appearance(AppearanceCommand::Look(Look::Dark))],
    );
    shoot("tree-finish", vec![Command::Time(TimeCommand::LastStage)]);
    shoot(
        "tree-zoom",
        vec![Command::View(
            Which::First,
            ViewCommand::FlyTo([37.0, 45.0].into(), 24.0),
        )],
    );
    shoot(
        "tree-default",
        vec![Command::Form(FormCommand::Reset), Command::Run],
    );
    shoot(
        "tree-blocks",
        vec![
            Command::Time(TimeCommand::ShowStage(1)),
            Command::View(Which::First, ViewCommand::Fit),
        ],
    );
    let back = vec![
        tree(),
        Command::Time(TimeCommand::LastStage),
        Command::Appearance(AppearanceCommand::Colour(Colouring::Block)),
    ];
    shoot("tree-off", back);
}

/// The tag of the thing under the pointer.
fn pointed_at(harness: &mut Harness<'_, App>, folder: &str) {
    let start = [
        Command::Form(FormCommand::Reset),
        Command::Run,
        Command::Appearance(AppearanceCommand::ToggleReducedMotion),
    ];
    for command in start {
        harness.state_mut().state.apply(command);
    }
    harness.state_mut().state.settle();
    harness.run();
    for (name, stage, position, radii, look) in [
        ("hover-block", 1, [20.0, 30.0], 120.0, Look::Dark),
        ("hover-sample", 3, [37.0, 45.0], 18.0, Look::Dark),
        ("hover-margin", 3, [36.9, 41.0], 14.0, Look::Light),
        ("hover-corner", usize::MAX, [1.0, 118.0], 120.0, Look::Light),
        ("hover-projector", 3, [37.0, 45.0], 14.0, Look::Projector),
    ] {
        let state = &mut harness.state_mut().state;
        for command in [
            Command::Appearance(AppearanceCommand::Look(look)),
            Command::Time(TimeCommand::ShowStage(stage)),
            Command::View(Which::First, ViewCommand::FlyTo(position.into(), radii)),
        ] {
            state.apply(command);
        }
        harness.state_mut().state.settle();
        harness.run();
        let state = &harness.state().state;
        let at = thing_near(state, name, position, radii);
        let pos = state
            .runs()
            .first
            .camera
            .screen_from_domain(state.runs().first.viewport, at);
        harness.hover_at(pos);
        save(harness, folder, name);
    }
}

/// The export sheet, for each format.
fn exports(shoot: &mut dyn FnMut(&str, Vec<Command>)) {
    for (name, kind) in [
        ("export-result", ExportKind::Result),
        ("export-samples", ExportKind::Samples),
        ("export-picture", ExportKind::Picture),
        ("export-animation", ExportKind::Animation),
    ] {
        let open = Command::Export(ExportCommand::Open(kind));
        shoot(
            name,
            vec![open, Command::Appearance(AppearanceCommand::ToggleTheme)],
        );
    }
    let wrong = |entry, text: &str| Command::Export(ExportCommand::Type(entry, text.to_owned()));
    shoot(
        "export-refused",
        vec![
            wrong(NumberField::Every, "1"),
            wrong(NumberField::Scale, "1e9"),
        ],
    );
    shoot("export-closed", vec![Command::Export(ExportCommand::Close)]);
}

/// Moments in the middle of stages, with the debugger's panels.
fn moments(shoot: &mut dyn FnMut(&str, Vec<Command>)) {
    let run_to = |target| Command::Time(TimeCommand::RunTo(target, Direction::Forwards));
    let debug = Command::Debug;
    shoot(
        "moment-elimination",
        vec![
            Command::Appearance(AppearanceCommand::ToggleTheme),
            Command::Time(TimeCommand::FirstStage),
            run_to(Target::Elimination),
            Command::Window(WindowCommand::OpenPanel(Panel::Events)),
            Command::Window(WindowCommand::OpenPanel(Panel::Watches)),
            debug(DebugCommand::Watch("distance".to_owned())),
            debug(DebugCommand::Watch("nonsense(".to_owned())),
        ],
    );
    shoot(
        "moment-gap",
        vec![
            run_to(Target::Gap),
            Command::View(Which::First, ViewCommand::Pick(Selection::Sample(900))),
            Command::Window(WindowCommand::OpenPanel(Panel::Inspector)),
            debug(DebugCommand::Query("insert iteration>1".to_owned())),
            Command::View(Which::First, ViewCommand::GoToCurrent),
        ],
    );
    shoot(
        "moment-gap-light",
        vec![Command::Appearance(AppearanceCommand::ToggleTheme)],
    );
    let nets = [Layer::Delaunay, Layer::Voronoi, Layer::Circumcircles];
    shoot(
        "moment-geometry",
        nets.map(|x| Command::Appearance(AppearanceCommand::ToggleLayer(x)))
            .to_vec(),
    );
    shoot(
        "moment-no-geometry",
        nets.map(|x| Command::Appearance(AppearanceCommand::ToggleLayer(x)))
            .to_vec(),
    );
    shoot(
        "moment-insertion",
        vec![
            run_to(Target::SecondInsertion),
            Command::Scene(SceneCommand::Add),
            Command::Window(WindowCommand::OpenPanel(Panel::Scenes)),
            Command::View(Which::First, ViewCommand::GoToCurrent),
        ],
    );
    shoot(
        "passes",
        vec![
            Command::Gpu(GpuCommand::Engine(
                tilescope_workbench::device::EngineChoice::Gpu,
            )),
            Command::Window(WindowCommand::OpenPanel(Panel::Passes)),
        ],
    );
    shoot("passes-run", vec![Command::OpenPasses]);
    shoot(
        "passes-closed",
        vec![Command::Window(WindowCommand::OpenPanel(Panel::Canvas))],
    );
    shoot(
        "projector",
        vec![Command::Appearance(AppearanceCommand::Look(
            Look::Projector,
        ))],
    );
    let actions = Command::Window(WindowCommand::FinderText("next".to_owned()));
    shoot(
        "actions",
        vec![
            Command::Appearance(AppearanceCommand::Look(Look::Dark)),
            Command::Window(WindowCommand::ToggleFinder),
            actions,
        ],
    );
    shoot(
        "actions-closed",
        vec![
            Command::Window(WindowCommand::ToggleFinder),
            Command::Time(TimeCommand::LastStage),
        ],
    );
}

/// Returns the pointer's position for a picture: a gap, a sample, or the position itself.
fn thing_near(state: &State, name: &str, position: [f64; 2], radii: f64) -> [f64; 2] {
    // If there is a gap in view, the pointer goes there.
    let deepest = state.shown().and_then(|shown| {
        let tessellation = state.runs().first.geometry.of(&shown)?;
        let near = |gap: &&tilescope_analysis::tessellation::GapRegion| {
            let deepest = gap.deepest.0;
            (deepest[0] - position[0]).hypot(deepest[1] - position[1]) < 0.4 * radii
        };
        tessellation.gaps.iter().find(near).map(|gap| gap.deepest.0)
    });
    let nearest = state.runs().first.session.as_ref().map(|session| {
        let distance = |id: &u32| {
            let at = session.position(*id);
            ((at[0] - position[0]).hypot(at[1] - position[1]) * 1e6) as u64
        };
        let count = session.run().samples.len() as u32;
        session.position((0..count).min_by_key(distance).unwrap_or(0))
    });
    let at = match name {
        "hover-margin" => deepest,
        "hover-block" => None,
        _ => nearest,
    };
    at.unwrap_or(position.into()).into()
}
