//! Who samples: the chooser of the engine, and what is known of the GPU.

use egui::{Button, ComboBox, RichText, Ui};

use super::parameters::{field_width, labelled};
use crate::command::Command;
use crate::device::Engine;
use crate::state::State;
use crate::theme::Palette;

const EXPLANATION: &str =
    "Who samples. All engines give the same points; choosing the GPU tests it first.";

/// Shows the chooser and, once the GPU has been asked for, its state.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.look);
    labelled(ui, "Engine", palette, |ui, label| {
        let combo = ComboBox::from_id_salt("Engine")
            .selected_text(text(state, state.engine))
            .width(field_width(ui))
            .truncate()
            .show_ui(ui, |ui| {
                for engine in [Engine::Auto, Engine::Cpu, Engine::Gpu] {
                    entry(ui, state, engine, commands);
                }
            });
        combo.response.labelled_by(label).on_hover_text(EXPLANATION);
    });
    if let Some(chosen) = state.chosen() {
        ui.label(RichText::new(chosen).small().color(palette.muted));
    }
    if let Some(said) = state.device.said() {
        let color = match state.device.refusal() {
            Some(_) => palette.conflict,
            None => palette.muted,
        };
        ui.label(RichText::new(said).small().color(color));
    }
}

fn entry(ui: &mut Ui, state: &State, engine: Engine, commands: &mut Vec<Command>) {
    let refusal = match engine {
        Engine::Gpu => state.device.refusal(),
        Engine::Auto | Engine::Cpu => None,
    };
    let button = Button::selectable(state.engine == engine, text(state, engine));
    let mut response = ui.add_enabled(refusal.is_none(), button);
    if let Some(why) = refusal {
        response = response.on_disabled_hover_text(why);
    }
    if response.clicked() && state.engine != engine {
        commands.push(Command::Engine(engine));
    }
}

fn text(state: &State, engine: Engine) -> String {
    match (engine, state.device.name()) {
        (Engine::Auto, Some(name)) if state.device_takes(Engine::Auto) => {
            format!("auto (GPU {name})")
        }
        (Engine::Auto, _) => "auto (CPU)".to_owned(),
        (Engine::Cpu, _) => "CPU".to_owned(),
        (Engine::Gpu, None) => "GPU".to_owned(),
        (Engine::Gpu, Some(name)) => format!("GPU ({name})"),
    }
}
