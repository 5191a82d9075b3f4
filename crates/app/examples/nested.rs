//! Renders nested levels, without a display: `cargo run --release -p tilescope-app --example nested FOLDER`. With a number
//! of samples instead of a folder it measures frames while the prefix is dragged.

use std::path::Path;
use std::time::Instant;

use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_session::layers::Layer;
use tilescope_session::look::Look;
use tilescope_workbench::Command;
use tilescope_workbench::command::{AppearanceCommand, FormCommand, TimeCommand, WindowCommand};
use tilescope_workbench::draft::Choice;
use tilescope_workbench::layout::Panel;

fn window(size: [f32; 2], count: &str) -> Harness<'static, App> {
    let mut harness = Harness::builder()
        .with_size(size)
        .with_max_steps(20_000)
        .wgpu()
        .build_eframe(|creation| {
            let mut app = App::new(&creation.egui_ctx);
            app.draw_with(creation.wgpu_render_state.as_ref().expect("a device"));
            app
        });
    harness.state_mut().state.settle();
    for command in [
        Command::Appearance(AppearanceCommand::ToggleReducedMotion),
        Command::Form(FormCommand::Count(count.to_owned())),
        Command::Form(FormCommand::Choose(Choice::Levels(Some(8)))),
        Command::Run,
    ] {
        harness.state_mut().state.apply(command);
    }
    harness.state_mut().state.settle();
    harness.run();
    harness
}

fn main() {
    let argument = std::env::args().nth(1).unwrap_or_else(|| ".".to_owned());
    if argument.parse::<u64>().is_ok() {
        return drag(&argument);
    }
    for size in [[1280.0, 720.0], [1920.0, 1080.0]] {
        let mut harness = window(size, "20000");
        let end = harness.state().state.runs().first.session.clone();
        let ends = end.expect("a session").ends();
        for look in [Look::Dark, Look::Light, Look::Projector] {
            for (name, count, panel) in [
                ("all", ends[7], Panel::Legend),
                ("within", ends[4] + 700, Panel::Statistics),
                ("first", ends[1], Panel::Verification),
            ] {
                let disks = Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Disks));
                let mut commands = vec![
                    Command::Appearance(AppearanceCommand::Look(look)),
                    Command::Window(WindowCommand::OpenPanel(panel)),
                    Command::Time(TimeCommand::Jump(count)),
                ];
                if name == "first" {
                    commands.push(disks.clone());
                }
                for command in commands {
                    harness.state_mut().state.apply(command);
                }
                harness.state_mut().state.settle();
                harness.run();
                let image = harness.render().expect("a picture of the window");
                let file = format!("{}-{}-{name}.png", size[1], look.name().replace(' ', "-"));
                let path = Path::new(&argument).join(file);
                image.save(&path).expect("a writable folder");
                println!("{}", path.display());
                if name == "first" {
                    harness.state_mut().state.apply(disks);
                }
            }
        }
    }
}

/// Measures frames while the prefix is dragged over the whole track.
fn drag(count: &str) {
    let mut harness = window([1280.0, 720.0], count);
    let all = harness.state().state.cursor().expect("levels").1;
    let _ = harness.render();
    let mut times = Vec::new();
    for step in 1..=60 {
        let begin = Instant::now();
        let jump = TimeCommand::Jump(all * step / 60);
        harness.state_mut().state.apply(Command::Time(jump));
        harness.step();
        let laid = begin.elapsed();
        let _ = harness.render();
        times.push((laid, begin.elapsed()));
    }
    times.sort_unstable();
    println!(
        "{all} samples: a frame is laid out in {:?} (median), {:?} (longest)",
        times[30].0, times[59].0
    );
    times.sort_unstable_by_key(|(_, whole)| *whole);
    println!("with drawing by this device {:?} (median)", times[30].1);
}
