//! Renders states of the window to pictures, without a display:
//! `cargo run --release -p tilescope-app --example shots SET [FOLDER]`.
//!
//! Most sets are scripts, beside this file: for each picture a name and the commands before it. The others, `buffers`,
//! `hover`, `levels` and `small`, look up in the state where to point, and `playing` is taken while the run plays.

use egui::{Key, Modifiers, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use serde_json::json;
use tilescope_app::App;
use tilescope_core::{Insertion, Parameter};
use tilescope_gpu::layout::Name;
use tilescope_session::layers::Layer;
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_workbench::arrangement::DrawerCommand;
use tilescope_workbench::command::{
    AppearanceCommand, FormCommand, GpuCommand, TimeCommand, ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::curve::CurveNumber;
use tilescope_workbench::device::EngineChoice;
use tilescope_workbench::draft::Choice;
use tilescope_workbench::export::{ExportCommand, ExportKind};
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::passes::{PassCommand, PassSide, Passes};
use tilescope_workbench::{Command, State};

/// The size of the window of most pictures, in screen points.
const SIZE: Vec2 = vec2(1600.0, 1000.0);

fn main() {
    let mut arguments = std::env::args().skip(1);
    let set = arguments.next().unwrap_or_default();
    let folder = arguments.next().unwrap_or_else(|| ".".to_owned());
    // Scripts name files in the folder.
    std::env::set_current_dir(folder).expect("a folder");

    match set.as_str() {
        "window" => Studio::opened(SIZE).run(include_str!("window.json")),
        "analysis" => {
            std::fs::write("noise.csv", independent(10_000)).expect("a writable folder");
            Studio::opened(vec2(1440.0, 900.0)).run(include_str!("analysis.json"));
        }
        "combination" => Studio::opened(SIZE).run(include_str!("combination.json")),
        "compare" => Studio::opened(SIZE).run(include_str!("compare.json")),
        "exact" => Studio::opened(SIZE).run(include_str!("exact.json")),
        "passes" => Studio::opened(SIZE).run(include_str!("passes.json")),
        "buffers" => buffers(&mut Studio::opened(SIZE)),
        "hover" => hover(&mut Studio::opened(SIZE)),
        "levels" => levels(),
        "playing" => playing(&mut Studio::opened(vec2(1440.0, 900.0))),
        "small" => small(),
        _ => eprintln!(
            "usage: shots window|analysis|combination|compare|exact|passes|buffers|hover|levels|playing|small [FOLDER]"
        ),
    }
}

/// A window without a display, and the pictures that are taken of it.
struct Studio {
    harness: Harness<'static, App>,
}

impl Studio {
    /// Returns a window of this size with the default session.
    fn opened(size: Vec2) -> Self {
        Self::with_zoom(size, 1.0)
    }

    /// The same on a screen of so many pixels for a point.
    fn with_zoom(size: Vec2, pixels_per_point: f32) -> Self {
        let harness = Harness::builder()
            .with_size(size)
            .with_pixels_per_point(pixels_per_point)
            .with_max_steps(20_000)
            .wgpu()
            .build_eframe(|creation| {
                let mut app = App::new(&creation.egui_ctx);
                app.draw_with(creation.wgpu_render_state.as_ref().expect("a device"));
                app
            });
        let mut studio = Self { harness };
        studio.apply([]);
        studio
    }

    fn state(&self) -> &State {
        &self.harness.state().state
    }

    /// Applies commands, and waits for the work of each.
    fn apply(&mut self, commands: impl IntoIterator<Item = Command>) {
        for command in commands {
            self.harness.state_mut().state.apply(command);
            self.settle();
        }
        self.settle();
    }

    fn settle(&mut self) {
        self.harness.state_mut().state.settle();
        self.harness.run();
    }

    /// Writes a picture of the window.
    fn shoot(&mut self, name: &str) {
        // A camera that flies arrives, and layers thinned out while it moves are complete in the next frame.
        while self.harness.state_mut().state.advance(1.0) {}
        self.harness.run();
        self.harness.step();

        self.write(name);
    }

    /// Writes a picture of the window as it is, in the middle of whatever moves.
    fn write(&mut self, name: &str) {
        let image = self.harness.render().expect("a picture of the window");
        let file = format!("{}.png", name.to_lowercase().replace(' ', "-"));
        image.save(&file).expect("a writable folder");
        println!("{file}");
    }

    /// Takes the pictures of a script.
    fn run(&mut self, script: &str) {
        let shots: Vec<(String, Vec<Command>)> = serde_json::from_str(script).expect("a script");
        for (name, commands) in shots {
            self.apply(commands);
            self.shoot(&name);
        }
    }
}

fn look(look: Look) -> Command {
    Command::Appearance(AppearanceCommand::Look(look))
}

fn open(panel: Panel) -> Command {
    Command::Window(WindowCommand::OpenPanel(panel))
}

fn near() -> Command {
    Command::View(Which::First, ViewCommand::FlyTo([37.0, 45.0].into(), 18.0))
}

/// Buffers of the GPU on the canvas.
fn buffers(studio: &mut Studio) {
    studio.apply([
        Command::Gpu(GpuCommand::Engine(EngineChoice::Gpu)),
        Command::OpenPasses,
    ]);
    go(studio, "tile", Name::Places);
    studio.apply([open(Panel::Passes)]);
    studio.shoot("buffers-panel");
    studio.apply([Command::Passes(PassCommand::ShowCanvas)]);
    studio.shoot("buffers-places");
    studio.apply([near()]);

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
        go(studio, pass, buffer);
        studio.shoot(&format!("buffers-{pass}-{}", buffer.as_str()));
    }

    go(studio, "detectors", Name::Grid);
    let before = PassCommand::Side(PassSide::Before);
    let filter = PassCommand::Filter("flags>=4".to_owned());
    studio.apply([before, filter, PassCommand::PickRow(Some(9_000))].map(Command::Passes));
    studio.apply([
        Command::View(Which::First, ViewCommand::Fit),
        look(Look::Light),
    ]);
    studio.shoot("buffers-before-filtered-light");

    studio.apply([
        Command::Passes(PassCommand::Filter(String::new())),
        Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::Insertion,
            json!(Insertion::Uniform),
        ))),
        Command::Form(FormCommand::Type(Parameter::Radius, "0.02".to_owned())),
        Command::Run,
        Command::OpenPasses,
    ]);
    go(studio, "throw", Name::Active);
    studio.apply([Command::Passes(PassCommand::ShowCanvas), near()]);
    studio.shoot("buffers-uniform");
}

/// Goes to the first pass of this name, and to one of its buffers.
fn go(studio: &mut Studio, pass: &str, buffer: Name) {
    let passes = studio.state().runs().first.passes.as_ref();
    let mut entries = passes.map(Passes::entries).expect("passes").iter();
    let index = entries.position(|entry| entry.report.name == pass);
    let select = PassCommand::Select(index.expect("such a pass"));
    studio.apply([Command::Passes(select)]);

    let passes = studio.state().runs().first.passes.as_ref();
    let visit = passes.and_then(Passes::visit).expect("a visit");
    let mut tables = visit.buffers.iter();
    let index = tables.position(|table| table.name == buffer);
    studio.apply([Command::Passes(PassCommand::Buffer(index.unwrap_or(0)))]);
}

/// The tag of the thing under the pointer.
fn hover(studio: &mut Studio) {
    studio.apply([Command::Appearance(AppearanceCommand::ToggleReducedMotion)]);
    for (name, stage, position, radii, chosen) in [
        ("hover-block", 1, [20.0, 30.0], 120.0, Look::Dark),
        ("hover-sample", 3, [37.0, 45.0], 18.0, Look::Dark),
        ("hover-margin", 3, [36.9, 41.0], 14.0, Look::Light),
        ("hover-corner", usize::MAX, [1.0, 118.0], 120.0, Look::Light),
        ("hover-projector", 3, [37.0, 45.0], 14.0, Look::Projector),
    ] {
        studio.apply([
            look(chosen),
            Command::Time(TimeCommand::ShowStage(stage)),
            Command::View(Which::First, ViewCommand::FlyTo(position.into(), radii)),
        ]);
        let run = &studio.state().runs().first;
        let at = pointed_at(studio.state(), name, position, radii);
        let pointer = run.camera.screen_from_domain(run.viewport, at);
        studio.harness.hover_at(pointer);
        studio.settle();
        studio.shoot(name);
    }
}

/// Returns the pointer's position for a picture: a gap, a sample, or the position itself.
fn pointed_at(state: &State, name: &str, position: [f64; 2], radii: f64) -> [f64; 2] {
    let run = &state.runs().first;
    let far = |at: [f64; 2]| (at[0] - position[0]).hypot(at[1] - position[1]);

    let gap = || {
        let borders = run.geometry.borders(&run.shown()?)?;
        let outside = borders.arcs.iter().map(|arc| {
            let [from, to] = arc.angles;
            let (sin, cos) = from.midpoint(to).sin_cos();
            (
                to - from,
                [arc.center.x + 1.05 * cos, arc.center.y + 1.05 * sin],
            )
        });
        let near = outside.filter(|&(_, at)| far(at) < 0.4 * radii);
        // Beside the longest arc there is room for a pointer.
        near.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, at)| at)
    };
    let sample = || {
        let session = run.session.as_ref()?;
        let places = (0..session.run().samples.len() as u32).map(|id| session.position(id).into());
        places.min_by(|&a, &b| far(a).total_cmp(&far(b)))
    };
    let thing = match name {
        "hover-margin" => gap(),
        "hover-block" => None,
        _ => sample(),
    };
    thing.unwrap_or(position)
}

/// The analysis and a curve of the run, at moments of a run that plays.
fn playing(studio: &mut Studio) {
    let curve = AppearanceCommand::Curve(CurveNumber::of("conflicts"));
    studio.apply([
        open(Panel::Analysis),
        Command::Appearance(curve),
        Command::Time(TimeCommand::FirstStage),
    ]);
    let play = Command::Time(TimeCommand::TogglePlay);
    studio.harness.state_mut().state.apply(play);
    for (name, frames) in [("tile", 30), ("eliminate", 30), ("iterate", 12)] {
        for _ in 0..frames {
            // A quarter of a second of the run.
            studio.harness.step();
        }
        studio.write(&format!("playing-{name}"));
    }
}

/// Nested levels: all, a prefix within a level, and the first two.
fn levels() {
    for size in [vec2(1280.0, 720.0), vec2(1920.0, 1080.0)] {
        let mut studio = Studio::opened(size);
        studio.apply([
            Command::Appearance(AppearanceCommand::ToggleReducedMotion),
            Command::Form(FormCommand::Count("20000".to_owned())),
            Command::Form(FormCommand::Choose(Choice::Levels(Some(8)))),
            Command::Run,
        ]);
        let session = studio.state().runs().first.session.as_ref();
        let ends = session.expect("a session").ends();

        for chosen in [Look::Dark, Look::Light, Look::Projector] {
            for (name, count, panel) in [
                ("all", ends[7], Panel::Legend),
                ("within", ends[4] + 700, Panel::Statistics),
                ("first", ends[1], Panel::Verification),
            ] {
                let jump = Command::Time(TimeCommand::Jump(count));
                studio.apply([look(chosen), open(panel), jump]);
                // Disks of the last levels are too small to see.
                let disks = Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Disks));
                let disks = (name == "first").then_some(disks);
                studio.apply(disks.clone());
                studio.shoot(&format!("{}-{}-{name}", size.y, chosen.name()));
                studio.apply(disks);
            }
        }
    }
}

/// Small windows, panel by panel, and the keyboard's focus in every look.
fn small() {
    for (name, size) in [
        ("phone", vec2(390.0, 844.0)),
        ("lying", vec2(844.0, 390.0)),
        ("small", vec2(360.0, 640.0)),
    ] {
        let mut studio = opened_small(size, 1.0);
        drawers(&mut studio, name);
        sheets(&mut studio, name);
    }
    opened_small(vec2(390.0, 844.0), 2.0).shoot("phone-2x");

    for chosen in Look::ALL {
        let mut studio = opened_small(vec2(1440.0, 900.0), 1.0);
        studio.apply([look(chosen)]);
        for _ in 0..8 {
            studio.harness.key_press(Key::Tab);
            studio.harness.run();
        }
        studio.shoot(&format!("focus-{}", chosen.name()));
    }
}

fn opened_small(size: Vec2, pixels_per_point: f32) -> Studio {
    let mut studio = Studio::with_zoom(size, pixels_per_point);
    let pick = ViewCommand::Pick(Selection::Sample(40));
    studio.apply([
        Command::Appearance(AppearanceCommand::ToggleReducedMotion),
        Command::View(Which::First, pick),
    ]);
    studio
}

fn drawers(studio: &mut Studio, name: &str) {
    for panel in Panel::all() {
        let show = DrawerCommand::Show(Some(panel));
        studio.apply([Command::Window(WindowCommand::Drawer(show))]);
        studio.apply((panel == Panel::Passes).then_some(Command::OpenPasses));
        studio.shoot(&format!("{name}-{}", panel.name()));
    }
    let start = CompareCommand::Start(ComparePreset::Order);
    studio.apply([Command::Compare(start)]);
    studio.shoot(&format!("{name}-compared"));
    studio.apply([Command::Compare(CompareCommand::Close)]);
}

fn sheets(studio: &mut Studio, name: &str) {
    for kind in [ExportKind::Result, ExportKind::Animation] {
        studio.apply([Command::Export(ExportCommand::Open(kind))]);
        studio.shoot(&format!("{name}-export-{kind:?}"));
    }
    studio.apply([
        Command::Export(ExportCommand::Close),
        Command::File(FileCommand::Sheet(Purpose::Save)),
    ]);
    studio.shoot(&format!("{name}-file"));
    studio.apply([Command::File(FileCommand::Close)]);

    studio
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::K);
    studio.harness.run();
    studio.shoot(&format!("{name}-actions"));
    studio.harness.key_press(Key::Escape);
    studio.harness.run();

    let long = "The file /a/place/of/some/length/samples.ply could not be read: its head names more points than it holds.";
    studio.harness.state_mut().state.report(long.to_owned());
    studio.settle();
    studio.shoot(&format!("{name}-notice"));

    // The menu, its second part open.
    for label in ["Menu", "Edit menu"] {
        studio.harness.get_by_label(label).click();
        studio.harness.run();
    }
    studio.shoot(&format!("{name}-menu"));
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
