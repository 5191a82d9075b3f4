//! The sheet of saved sessions and pattern files.

use egui::{Align2, ProgressBar, RichText, TextEdit, Ui, Window, vec2};

use super::read_out;
use super::sheet::{entered, escaped, just_opened, select_all};
use crate::command::Command;
use crate::files::{FileCommand, FileForm, Purpose};
use crate::state::State;
use crate::theme::Palette;
use crate::widgets::primary_button;

/// Shows the sheet while it is open.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let mut own = Vec::new();
    dropped(ui, state, &mut own);
    if let Some(form) = &state.file {
        sheet(ui, state, form, &mut own);
    }
    commands.extend(own.into_iter().map(Command::File));
}

fn sheet(ui: &Ui, state: &State, form: &FileForm, own: &mut Vec<FileCommand>) {
    let mut open = true;
    Window::new(form.purpose.title())
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, vec2(0.0, -40.0))
        .show(ui.ctx(), |ui| {
            ui.set_width(480.0);
            contents(ui, state, form, own);
        });
    if !open || escaped(ui, state) {
        own.push(FileCommand::Close);
    }
}

fn contents(ui: &mut Ui, state: &State, form: &FileForm, own: &mut Vec<FileCommand>) {
    let palette = Palette::of(state.look);
    ui.label(RichText::new(form.purpose.explanation()).color(palette.muted));
    ui.add_space(8.0);
    let label = ui.label("File");
    ui.horizontal(|ui| {
        let mut path = form.path.clone();
        let edit = TextEdit::singleline(&mut path)
            .font(egui::TextStyle::Monospace)
            .margin(egui::Margin::symmetric(8, 6))
            .desired_width(370.0);
        let response = ui.add(edit).labelled_by(label.id);
        if just_opened(ui, form.purpose.title()) {
            select_all(ui, &response, path.chars().count());
        }
        if response.changed() {
            own.push(FileCommand::Path(path));
        }
        if entered(ui, &response) && refusal(state, form).is_none() {
            own.push(FileCommand::Go);
        }
        if ui.button("Browse\u{2026}").clicked() {
            own.push(FileCommand::Browse);
        }
    });
    // The line has its room whether or not there is a question.
    let question = if form.asked {
        "There is such a file already."
    } else {
        " "
    };
    let response = ui.label(RichText::new(question).color(palette.conflict));
    read_out(ui, &response);
    ui.add_space(4.0);
    let verb = if form.asked {
        "Replace the file"
    } else {
        form.purpose.verb()
    };
    let button = primary_button(ui, verb, refusal(state, form), palette);
    // The second click of a double click answers no question.
    if button.clicked() && !(form.asked && button.double_clicked()) {
        own.push(FileCommand::Go);
    }
    ui.horizontal(|ui| {
        ui.set_height(24.0);
        progress(ui, state, palette, own);
    });
}

fn refusal(state: &State, form: &FileForm) -> Option<&'static str> {
    if busy(state).is_some() {
        Some("A file is being read or written.")
    } else if form.path.trim().is_empty() {
        Some("Name a file.")
    } else if form.purpose == Purpose::Save {
        state.save_refusal()
    } else {
        None
    }
}

#[cfg(not(target_arch = "wasm32"))]
fn busy(state: &State) -> Option<f32> {
    state.filing.as_ref().map(|filing| filing.job.fraction())
}

#[cfg(target_arch = "wasm32")]
fn busy(_: &State) -> Option<f32> {
    None
}

/// Shows how far a file is read or written, and the way out.
fn progress(ui: &mut Ui, state: &State, palette: &Palette, own: &mut Vec<FileCommand>) {
    if let Some(fraction) = busy(state) {
        if ui.button("Cancel the file").clicked() {
            own.push(FileCommand::Cancel);
        }
        let bar = ProgressBar::new(fraction).desired_height(6.0);
        ui.add(bar.fill(palette.accent));
    }
}

/// Shows that a dropped file is being read, where no sheet says it.
fn dropped(ui: &Ui, state: &State, own: &mut Vec<FileCommand>) {
    if state.file.is_some() || busy(state).is_none() {
        return;
    }
    let palette = Palette::of(state.look);
    Window::new("Opening the dropped file")
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, vec2(0.0, -40.0))
        .show(ui.ctx(), |ui| {
            ui.set_width(320.0);
            ui.horizontal(|ui| progress(ui, state, palette, own));
        });
}
