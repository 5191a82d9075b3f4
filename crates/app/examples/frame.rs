//! Times the CPU's part of a frame of the window, on one thread and without a display or a wait for a GPU:
//! `cargo run --release -p tilescope-app --example frame [mesh] [levels] [RADIUS]`; `mesh` does without instancing, RADIUS
//! replaces the default session's, and `levels` times nested levels while their prefix is dragged.

use std::sync::Arc;
use std::time::Instant;

use egui::{Context, RawInput, Rect, pos2, vec2};
use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_core::Parameter;
use tilescope_session::Session;
use tilescope_session::layers::Layer;
use tilescope_workbench::Command;
use tilescope_workbench::command::{
    AppearanceCommand, FormCommand, TimeCommand, ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::draft::Choice;
use tilescope_workbench::layout::Panel;

/// Frames per measurement.
const FRAMES: u32 = 60;

/// A window without a display.
struct Bench {
    ctx: Context,
    app: App,
}

impl Bench {
    /// Returns the milliseconds of layout and of tessellation of one frame.
    fn frame(&mut self) -> [f64; 2] {
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), vec2(1_600.0, 1_000.0))),
            ..RawInput::default()
        };
        let start = Instant::now();
        let app = &mut self.app;
        let output = self.ctx.run_ui(input, |ui| app.show(ui));
        let laid_out = Instant::now();
        let shapes = self.ctx.tessellate(output.shapes, output.pixels_per_point);
        let done = Instant::now();
        std::hint::black_box(shapes);
        [laid_out - start, done - laid_out].map(|time| time.as_secs_f64() * 1_000.0)
    }

    /// Returns lower quartiles of many frames, `change` being applied before each: other programs only slow frames
    /// down.
    fn frames(&mut self, change: impl Fn(&mut App, u32)) -> [f64; 2] {
        for _ in 0..3 {
            self.frame();
        }
        let mut times: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
        for number in 0..FRAMES {
            change(&mut self.app, number);
            for (times, time) in times.iter_mut().zip(self.frame()) {
                times.push(time);
            }
        }
        times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 4]
        })
    }

    fn apply(&mut self, command: Command) {
        self.app.state.apply(command);
        self.frame();
        self.app.state.settle();
        self.frame();
    }
}

const fn rest(_: &mut App, _: u32) {}

fn pan(app: &mut App, number: u32) {
    let step = if number.is_multiple_of(2) { 3.0 } else { -3.0 };
    app.state.apply(Command::View(
        Which::First,
        ViewCommand::Pan(vec2(step, 0.0)),
    ));
}

/// One event back, one forward.
fn step(app: &mut App, number: u32) {
    if let Some((at, count)) = app.state.runs().first.cursor() {
        let next = if number.is_multiple_of(2) && at > 0 {
            at - 1
        } else {
            (at + 1).min(count)
        };
        app.state.apply(Command::Time(TimeCommand::Jump(next)));
    }
}

/// Another prefix of nested levels in each frame, over the whole track.
fn drag(app: &mut App, number: u32) {
    let all = app
        .state
        .runs()
        .first
        .cursor()
        .map_or(0, |(_, count)| count);
    let prefix = all * (number as usize + 1) / FRAMES as usize;
    app.state.apply(Command::Time(TimeCommand::Jump(prefix)));
}

fn measure(bench: &mut Bench, name: &str) {
    print!("{name:<34}");
    for change in [rest as fn(&mut App, u32), pan, step] {
        let [ui, tessellate] = bench.frames(change);
        print!("{ui:>7.2} +{tessellate:>6.2}   ");
    }
    println!();
}

/// Times views of moments in tiling, where the pattern is inset, in the middle and at the end.
fn measure_all(bench: &mut Bench, session: &Session, layers: &str) {
    let tiling = session.stage_end(2).unwrap_or(0) / 2;
    let middle = session.stage_end(3).unwrap_or(0) * 3 / 4;
    let end = session.recording().map_or(0, |recording| recording.len());
    for (moment, cursor) in [("tiling", tiling), ("middle", middle), ("end", end)] {
        for (view, camera) in [
            ("fitted", Command::View(Which::First, ViewCommand::Fit)),
            (
                "60 r",
                Command::View(Which::First, ViewCommand::FlyTo([40.0, 40.0].into(), 60.0)),
            ),
            (
                "12 r",
                Command::View(Which::First, ViewCommand::FlyTo([40.0, 40.0].into(), 12.0)),
            ),
        ] {
            bench.apply(Command::Time(TimeCommand::Jump(cursor)));
            bench.apply(camera);
            measure(bench, &format!("{layers}, {moment}, {view}"));
        }
    }
}

fn opened(instanced: bool, radius: Option<String>) -> Bench {
    let ctx = Context::default();
    let mut app = App::new(&ctx);
    if let Some(radius) = radius {
        app.state.settle();
        app.state
            .apply(Command::Form(FormCommand::Type(Parameter::Radius, radius)));
        app.state.apply(Command::Run);
    }
    if instanced {
        let mut render = None;
        let _harness = Harness::builder().wgpu().build_eframe(|creation| {
            render.clone_from(&creation.wgpu_render_state);
            App::new(&creation.egui_ctx)
        });
        app.draw_with(&render.expect("a device"));
    }
    let mut bench = Bench { ctx, app };
    bench.frame();
    bench.app.state.settle();
    bench.apply(Command::Appearance(AppearanceCommand::ToggleReducedMotion));
    bench
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let instanced = arguments.iter().all(|argument| argument != "mesh");
    let radius = arguments
        .iter()
        .find(|argument| argument.parse::<f64>().is_ok());
    let mut bench = opened(instanced, radius.cloned());
    if arguments.iter().any(|argument| argument == "levels") {
        bench.apply(Command::Form(FormCommand::Choose(Choice::Levels(Some(8)))));
        bench.apply(Command::Run);
        let [ui, tessellate] = bench.frames(drag);
        println!("dragged over nested levels: {ui:.2} + {tessellate:.2} ms");
        return;
    }

    let session = Arc::clone(
        bench
            .app
            .state
            .runs()
            .first
            .session
            .as_ref()
            .expect("a session"),
    );
    let drawn = if instanced {
        "instancing"
    } else {
        "the mesh painter"
    };
    println!(
        "{} samples in all, {} at the end; drawn by {drawn}; ms of layout + tessellation",
        session.run().samples.len(),
        session.summary.count
    );
    println!(
        "{:<34}{:^17}{:^17}{:^17}",
        "", "at rest", "panning", "stepping"
    );
    measure_all(&mut bench, &session, "usual layers");
    bench.apply(Command::View(Which::First, ViewCommand::Fit));
    measure(&mut bench, "end, fitted");
    let start = Instant::now();
    bench.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    let seconds = start.elapsed().as_secs_f64();
    println!("the moment and the reference are measured in {seconds:.2} s");
    measure(&mut bench, "end, fitted, with the analysis");
    bench.apply(Command::Window(WindowCommand::OpenPanel(Panel::Parameters)));
    for layer in Layer::ALL {
        if !bench.app.state.appearance().layers(None).has(layer) {
            bench.apply(Command::Appearance(AppearanceCommand::ToggleLayer(layer)));
        }
    }
    measure_all(&mut bench, &session, "all layers");
}
