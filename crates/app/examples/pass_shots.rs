//! Renders the panel of GPU passes to pictures, without a display:
//! `cargo run --release -p tilescope-app --example pass_shots FOLDER`.

use std::path::Path;
use std::sync::Arc;

use egui_kittest::Harness;
use tilescope_app::show_passes;
use tilescope_core::{Parameters, Stage};
use tilescope_drawing::palette::Palette;
use tilescope_gpu::layout::Name;
use tilescope_gpu::{Choice, Gpu};
use tilescope_session::look::Look;
use tilescope_ui::theme::install;
use tilescope_workbench::passes::{Fault, PassCommand, Passes};

struct Shown {
    passes: Passes,
    look: Look,
}

fn main() {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".to_owned());
    let choice = Choice {
        software: true,
        ..Choice::default()
    };
    let gpu = pollster::block_on(Gpu::open(&choice)).expect("an adapter");
    let parameters = Parameters {
        radius: 0.01,
        ..Parameters::default()
    };
    let wake: tilescope_session::jobs::Wake = Arc::new(|| {});
    let passes = Passes::new(&Arc::new(gpu), &parameters, &wake).expect("a small run");
    let shown = Shown {
        passes,
        look: Look::Dark,
    };
    let mut harness = Harness::builder()
        .with_size([1060.0, 640.0])
        .with_max_steps(64)
        .build_ui_state(
            |ui, shown: &mut Shown| {
                install(ui.ctx(), shown.look);
                let palette = Palette::of(shown.look);
                ui.painter()
                    .rect_filled(ui.ctx().content_rect(), 0.0, palette.panel);
                let mut commands = Vec::new();
                show_passes(ui, &shown.passes, palette, &mut commands);
            },
            shown,
        );
    harness.step();
    shoot(&mut harness, &folder, "surveying");
    let places = |passes: &mut Passes| {
        passes.settle();
        passes.select_stage(Stage::Tile);
        passes.settle();
    };
    for (look, name) in [(Look::Dark, "dark"), (Look::Light, "light")] {
        harness.state_mut().look = look;
        places(&mut harness.state_mut().passes);
        let mut take = |what: &str, commands: Vec<PassCommand>| {
            for command in commands {
                harness.state_mut().passes.apply(command);
                harness.state_mut().passes.settle();
            }
            harness.run();
            shoot(&mut harness, &folder, &format!("{name}-{what}"));
        };
        take("tile", vec![]);
        take("tile-filter", vec![PassCommand::Filter("q>1".to_owned())]);
        take(
            "next",
            vec![
                PassCommand::Filter(String::new()),
                PassCommand::Next,
                PassCommand::Next,
            ],
        );
        take("last", vec![PassCommand::Last]);
        let fault = Fault {
            after: 73,
            buffer: Name::Result,
            index: 40,
            word: 77,
        };
        take("fault", vec![PassCommand::Fault(Some(fault))]);
        take("frame", vec![PassCommand::Buffer(0)]);
        take("undone", vec![PassCommand::Fault(None)]);
    }
}

fn shoot(harness: &mut Harness<'_, Shown>, folder: &str, name: &str) {
    let image = harness.render().expect("a picture");
    let path = Path::new(folder).join(format!("passes-{name}.png"));
    image.save(&path).expect("a writable folder");
    println!("{}", path.display());
}
