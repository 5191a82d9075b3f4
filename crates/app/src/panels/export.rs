//! The export sheet: which file, which number type. The file is verified before it appears.

use std::path::Path;

use egui::{Align2, Button, ProgressBar, RichText, TextEdit, Ui, Window, vec2};
use tilescope_formats::{Format, Precision};

use crate::command::Command;
use crate::export::ExportForm;
use crate::state::State;
use crate::theme::Palette;
use crate::widgets::primary_button;

/// Shows the sheet while it is open.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let Some(form) = &state.export else {
        return;
    };
    let palette = Palette::of(state.look);
    let mut open = true;
    Window::new("Export")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, vec2(0.0, -40.0))
        .show(ui.ctx(), |ui| {
            ui.set_width(460.0);
            contents(ui, state, form, palette, commands);
        });
    if !open || ui.input(|i| i.key_pressed(egui::Key::Escape)) {
        commands.push(Command::CloseExport);
    }
}

fn contents(
    ui: &mut Ui,
    state: &State,
    form: &ExportForm,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let text = "The result is written, read back and verified; its certificate is put beside it.";
    ui.label(RichText::new(text).color(palette.muted));
    ui.add_space(8.0);
    let label = ui.label("File");
    ui.horizontal(|ui| {
        let mut path = form.path.clone();
        let edit = TextEdit::singleline(&mut path)
            .font(egui::TextStyle::Monospace)
            .margin(egui::Margin::symmetric(8, 6))
            .desired_width(350.0);
        if ui.add(edit).labelled_by(label.id).changed() {
            commands.push(Command::ExportPath(path));
        }
        if ui.button("Browse\u{2026}").clicked() {
            commands.push(Command::BrowseExport);
        }
    });
    let format = Format::from_path(Path::new(form.path.trim()));
    let names: Vec<String> = Format::ALL
        .iter()
        .filter(|f| **f != Format::PlyAscii)
        .map(|f| format!(".{}", f.extension()))
        .collect();
    let told = match format {
        Some(format) => format!("Format: {format}"),
        None => format!("The extension chooses the format: {}.", names.join(" ")),
    };
    let color = if format.is_some() {
        palette.muted
    } else {
        palette.conflict
    };
    ui.label(RichText::new(told).small().color(color));
    ui.add_space(6.0);
    precision(ui, form, format, commands);
    ui.add_space(10.0);
    let refusal = refusal(state, form, format);
    if primary_button(ui, "Write file and certificate", refusal, palette).clicked() {
        commands.push(Command::Export);
    }
    progress(ui, state, palette);
}

fn refusal(state: &State, form: &ExportForm, format: Option<Format>) -> Option<&'static str> {
    if busy(state).is_some() {
        Some("An export is at work.")
    } else if form.path.trim().is_empty() {
        Some("Name a file.")
    } else if format.is_none() {
        Some("No format has this extension.")
    } else {
        None
    }
}

fn precision(ui: &mut Ui, form: &ExportForm, format: Option<Format>, commands: &mut Vec<Command>) {
    let has_choice =
        format.is_some_and(|f| f.precision(Precision::Single) != f.precision(Precision::Double));
    ui.horizontal(|ui| {
        ui.label("Coordinates");
        for (precision, name) in [
            (Precision::Double, "f64, to the bit"),
            (Precision::Single, "f32, rounded"),
        ] {
            let shown = format.map_or(form.precision, |f| f.precision(form.precision));
            let button = Button::selectable(shown == precision, name);
            let response = ui.add_enabled(has_choice, button);
            let why = "This format leaves no choice.";
            if response.on_disabled_hover_text(why).clicked() {
                commands.push(Command::ExportPrecision(precision));
            }
        }
    });
}

#[cfg(not(target_arch = "wasm32"))]
fn busy(state: &State) -> Option<f32> {
    state.exporting.as_ref().map(crate::jobs::Job::fraction)
}

#[cfg(target_arch = "wasm32")]
fn busy(_: &State) -> Option<f32> {
    None
}

/// The bar has its room whether or not there is progress.
fn progress(ui: &mut Ui, state: &State, palette: &Palette) {
    match busy(state) {
        Some(fraction) => {
            let bar = ProgressBar::new(fraction)
                .desired_height(6.0)
                .fill(palette.accent);
            ui.add(bar);
        }
        None => ui.add_space(6.0),
    }
}
