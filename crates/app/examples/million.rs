//! Times instanced drawing of a million samples, without a display:
//! `cargo run --release -p tilescope-app --example million [COUNT [WIDTH HEIGHT]]`.

use std::time::Instant;

use egui::{Color32, Rect, pos2, vec2};
use egui_kittest::Harness;
use tilescope_canvas::instanced::{InstancedCanvas, Limits, PaintOptions, Symbols};
use tilescope_core::{Boundary, Domain, Point, R};
use tilescope_drawing::camera::Camera;
use tilescope_drawing::look::{SampleLook, Symbol};

/// Frames per measurement.
const FRAMES: u32 = 10;

struct Probe {
    canvas: Option<InstancedCanvas>,
    camera: Camera,
    layers: Vec<PaintOptions>,
}

impl eframe::App for Probe {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let rect = ui.max_rect();
        ui.painter().rect_filled(rect, 0.0, Color32::BLACK);
        if let Some(canvas) = &self.canvas {
            for layer in &self.layers {
                canvas.paint(&ui.painter_at(rect), rect, self.camera, layer);
            }
        }
    }
}

/// Samples spread about as densely as a maximal set, 0.7 per squared r.
fn spread(count: u32, side: f64) -> Vec<Point> {
    let axis = |k: u32, step: f64| ((f64::from(k) * step).fract() * side * f64::from(R)) as i32;
    let one = |k| Point::new(axis(k, 0.754_877_666_246), axis(k, 0.569_840_290_998));
    (1..=count).map(one).collect()
}

fn look(id: u32) -> SampleLook {
    let shade = (id % 200) as u8;
    let color = Color32::from_rgb(250 - shade, 90, 40 + shade);
    let symbol = if id.is_multiple_of(9) {
        Symbol::Diamond
    } else {
        Symbol::Dot
    };
    SampleLook::new(symbol, color).with_disk(true)
}

fn timed<T>(name: &str, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    println!("{name:<44}{:9.2} ms", millis(start));
    result
}

fn millis(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1_000.0
}

/// Returns the milliseconds of a frame from layout to the picture read back, `change` being applied before each.
fn frame_millis(harness: &mut Harness<'_, Probe>, change: impl Fn(&mut Probe, u32)) -> f64 {
    for _ in 0..2 {
        harness.step();
        harness.render().expect("a picture");
    }
    // The minimum of several frames: other programs only slow them down.
    let one = |frame| {
        let start = Instant::now();
        change(harness.state_mut(), frame);
        harness.step();
        harness.render().expect("a picture");
        millis(start)
    };
    (0..FRAMES).map(one).fold(f64::INFINITY, f64::min)
}

fn view(harness: &mut Harness<'_, Probe>, scale: f64, layers: &[PaintOptions]) {
    let probe = harness.state_mut();
    probe.camera.scale = scale;
    probe.layers = layers.to_vec();
}

fn main() {
    let arguments: Vec<f64> = std::env::args().skip(1).flat_map(|a| a.parse()).collect();
    let argument = |k: usize, default: f64| arguments.get(k).copied().unwrap_or(default);
    let count = argument(0, 1e6) as u32;
    let size = vec2(argument(1, 1_600.0) as f32, argument(2, 1_000.0) as f32);
    let side = (f64::from(count) / 0.7).sqrt();
    let domain = Domain::from_size([side; 2], 1.0, Boundary::Periodic).expect("a domain");
    let points = spread(count, side);
    let mut canvas = None;
    let mut harness = Harness::builder()
        .with_size(size)
        .wgpu()
        .build_eframe(|creation| {
            let state = creation.wgpu_render_state.as_ref().expect("a device");
            println!("{}", state.adapter.get_info().name);
            canvas = Some(InstancedCanvas::new(state));
            Probe {
                canvas: None,
                camera: Camera::fitting([side; 2], Rect::from_min_size(pos2(0.0, 0.0), size)),
                layers: Vec::new(),
            }
        });
    let mut canvas = canvas.expect("made above");
    let fitting = harness.state().camera.scale;
    println!(
        "{count} samples, {} x {} pixels, {fitting:.3} px/r when fitted",
        size.x, size.y
    );
    timed("points sorted and uploaded", || {
        canvas.set_points(1, &points, &domain, &[]).expect("room");
    });
    timed("all looks uploaded", || canvas.set_looks(1, look));
    timed("one look in a thousand changed", || {
        let changed = (0..count).step_by(1_000);
        let changes: Vec<(u32, SampleLook)> = changed.map(|id| (id, SampleLook::HIDDEN)).collect();
        canvas.change_looks(2, &changes);
    });
    measure(&mut harness, canvas, fitting);
}

fn pan(probe: &mut Probe, frame: u32) {
    let step = if frame.is_multiple_of(2) { 7.0 } else { -7.0 };
    probe.camera.center[0] += step / probe.camera.scale;
}

const fn rest(_: &mut Probe, _: u32) {}

fn set_still(harness: &mut Harness<'_, Probe>, still: usize) {
    if let Some(canvas) = &mut harness.state_mut().canvas {
        canvas.set_limits(Limits {
            still,
            ..canvas.limits()
        });
    }
}

/// Prints a frame's time beyond that of an empty one: at rest, at rest without cached pictures, and panning.
fn measure(harness: &mut Harness<'_, Probe>, canvas: InstancedCanvas, fitting: f64) {
    println!("ms of a frame beyond those of an empty one, which is read back just as well:");
    println!(
        "{:<28}{:>10}{:>12}{:>10}",
        "", "at rest", "drawn anew", "panning"
    );
    let still = canvas.limits().still;
    harness.state_mut().canvas = Some(canvas);
    let mut empty = 0.0;
    for scale in [fitting, 2.0, 3.0, 5.0, 10.0, 50.0, 1_000.0] {
        let symbols = PaintOptions::symbols(Symbols::ALL, scale);
        let disks = PaintOptions::disks().with_images(true);
        for (name, layers) in [
            ("samples", vec![symbols]),
            ("with disks", vec![disks, symbols]),
        ] {
            view(harness, scale, &[]);
            empty = frame_millis(harness, rest);
            view(harness, scale, &layers);
            let kept = frame_millis(harness, rest) - empty;
            set_still(harness, usize::MAX);
            let anew = frame_millis(harness, rest) - empty;
            set_still(harness, still);
            let panning = frame_millis(harness, pan) - empty;
            let name = format!("{scale:.2} px/r, {name}");
            println!("{name:<28}{kept:>10.1}{anew:>12.1}{panning:>10.1}   (empty: {empty:.1})");
        }
    }
    view(
        harness,
        fitting,
        &[PaintOptions::symbols(Symbols::ALL, fitting)],
    );
    let recolour = |probe: &mut Probe, frame: u32| {
        let canvas = probe.canvas.as_mut().expect("set above");
        canvas.set_looks(u64::from(frame) + 9, |id| look(id + frame));
    };
    let all = frame_millis(harness, recolour) - empty;
    println!("fitted, a new look for every sample in every frame: {all:.1}");
}
