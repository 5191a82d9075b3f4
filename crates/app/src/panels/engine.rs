//! The choice of the engine that samples, and a remark on it.

use egui::{Button, ComboBox, RichText, Ui};
use tilescope_ui::widgets::{Kebab, Known};

use super::parameters::{FormContext, changed_mark, field_width, labelled};
use tilescope_workbench::command::{Command, GpuCommand};
use tilescope_workbench::device::EngineChoice;

const EXPLANATION: &str =
    "What computes the run. All engines give the same points; choosing the GPU tests it first.";

/// Shows the chooser and, where there is more to say of the engine than its name, a remark.
pub fn show(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    labelled(ui, ("Engine", EXPLANATION), palette, |ui, label| {
        // The mark says that the next run will be made by another engine than the run shown.
        if context.engine_differs {
            changed_mark(ui, palette);
        }

        let combo = ComboBox::from_id_salt("Engine")
            .selected_text(text(context, context.gpu.engine))
            .width(field_width(ui))
            .truncate()
            .show_ui(ui, |ui| {
                for engine in [EngineChoice::Auto, EngineChoice::Cpu, EngineChoice::Gpu] {
                    entry(ui, context, engine, commands);
                }
            });
        let response = combo.response.labelled_by(label);
        response.known_as("engine");
        response.on_hover_text(EXPLANATION);
    });

    // The tooltip of the remark's short line has the full text.
    if let Some((line, all)) = &context.engine {
        let line = RichText::new(line).small().color(palette.muted);
        let label = ui.label(line);
        label.known_as("engine-status");
        label.on_hover_text(all);
    }
}

/// Shows the entry of an engine, which is disabled where there is no such engine.
fn entry(
    ui: &mut Ui,
    context: &FormContext<'_>,
    engine: EngineChoice,
    commands: &mut Vec<Command>,
) {
    // Only a GPU can be missing.
    let refusal = match engine {
        EngineChoice::Gpu => context.gpu.device.refusal(),
        EngineChoice::Auto | EngineChoice::Cpu => None,
    };
    let button = Button::selectable(context.gpu.engine == engine, text(context, engine));
    let mut response = ui.add_enabled(refusal.is_none(), button);
    response.known_as(format_args!("engine.{}", Kebab(engine)));
    if let Some(why) = refusal {
        response = response.on_disabled_hover_text(why);
    }
    if response.clicked() && context.gpu.engine != engine {
        commands.push(Command::Gpu(GpuCommand::Engine(engine)));
    }
}

fn text(context: &FormContext<'_>, engine: EngineChoice) -> &'static str {
    match engine {
        EngineChoice::Auto if context.auto_is_gpu => "auto (GPU)",
        EngineChoice::Auto => "auto (CPU)",
        EngineChoice::Cpu => "CPU",
        EngineChoice::Gpu => "GPU",
    }
}
