//! Renders small windows to pictures, panel by panel, without a display:
//! `cargo run --release -p tilescope-app --example small_shots FOLDER`.

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tilescope_app::App;
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_workbench::Command;
use tilescope_workbench::arrangement::DrawerCommand;
use tilescope_workbench::command::{AppearanceCommand, ViewCommand, Which, WindowCommand};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::export::{ExportCommand, ExportKind};
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::layout::Panel;

fn main() {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".to_owned());
    for (name, size) in [
        ("phone", [390.0, 844.0]),
        ("lying", [844.0, 390.0]),
        ("small", [360.0, 640.0]),
    ] {
        let mut harness = opened(size, 1.0);
        panels(&mut harness, &folder, name);
        sheets(&mut harness, &folder, name);
    }
    let mut harness = opened([390.0, 844.0], 2.0);
    save(&mut harness, &folder, "phone-2x");
    for look in Look::ALL {
        let mut harness = opened([1440.0, 900.0], 1.0);
        harness
            .state_mut()
            .state
            .apply(Command::Appearance(AppearanceCommand::Look(look)));
        for _ in 0..8 {
            harness.key_press(Key::Tab);
            harness.run();
        }
        save(&mut harness, &folder, &format!("focus-{}", look.name()));
    }
}

fn opened(size: [f32; 2], pixels_per_point: f32) -> Harness<'static, App> {
    let mut harness = Harness::builder()
        .with_size(size)
        .with_pixels_per_point(pixels_per_point)
        .with_max_steps(64)
        .build_eframe(|creation| App::new(&creation.egui_ctx));
    harness.state_mut().state.settle();
    let state = &mut harness.state_mut().state;
    state.apply(Command::Appearance(AppearanceCommand::ToggleReducedMotion));
    state.apply(Command::View(
        Which::First,
        ViewCommand::Pick(Selection::Sample(40)),
    ));
    harness
}

fn panels(harness: &mut Harness<'_, App>, folder: &str, name: &str) {
    for panel in Panel::all() {
        let command = DrawerCommand::Show(Some(panel));
        harness
            .state_mut()
            .state
            .apply(Command::Window(WindowCommand::Drawer(command)));
        if panel == Panel::Passes {
            harness.state_mut().state.apply(Command::OpenPasses);
        }
        save(harness, folder, &format!("{name}-{}", panel.name()));
    }
    let start = Command::Compare(CompareCommand::Start(ComparePreset::Order));
    harness.state_mut().state.apply(start);
    save(harness, folder, &format!("{name}-compared"));
    let close = Command::Compare(CompareCommand::Close);
    harness.state_mut().state.apply(close);
}

fn sheets(harness: &mut Harness<'_, App>, folder: &str, name: &str) {
    for kind in [ExportKind::Result, ExportKind::Animation] {
        let open = Command::Export(ExportCommand::Open(kind));
        harness.state_mut().state.apply(open);
        save(harness, folder, &format!("{name}-export-{kind:?}"));
    }
    let state = &mut harness.state_mut().state;
    state.apply(Command::Export(ExportCommand::Close));
    state.apply(Command::File(FileCommand::Sheet(Purpose::Save)));
    save(harness, folder, &format!("{name}-file"));
    harness
        .state_mut()
        .state
        .apply(Command::File(FileCommand::Close));
    harness.key_press_modifiers(Modifiers::COMMAND, Key::K);
    harness.run();
    save(harness, folder, &format!("{name}-actions"));
    harness.key_press(Key::Escape);
    harness.run();
    harness.state_mut().state.report("The file /a/place/of/some/length/samples.ply could not be read: its head names more points than it holds.".to_owned());
    save(harness, folder, &format!("{name}-notice"));
    // The menu, its second part open.
    harness.get_by_label("Menu").click();
    harness.run();
    harness.get_by_label("Edit menu").click();
    harness.run();
    save(harness, folder, &format!("{name}-menu"));
}

fn save(harness: &mut Harness<'_, App>, folder: &str, name: &str) {
    harness.state_mut().state.settle();
    harness.run();
    harness.state_mut().state.settle();
    harness.run();
    let image = harness.render().expect("a picture of the window");
    let name = name.to_lowercase().replace(' ', "-");
    let path = std::path::Path::new(folder).join(format!("{name}.png"));
    image.save(&path).expect("a file that can be written");
}
