//! The panels around the canvas. Each reads the state and pushes commands; none changes anything.

mod engine;
mod export;
mod inspector;
mod layers;
mod legend;
mod notice;
mod parameters;
mod stages;
mod timeline;
mod toolbar;
mod verification;

use egui::{Frame, Margin, Panel, ScrollArea, Ui};

use crate::command::Command;
use crate::state::State;
use crate::theme::Palette;

/// Width of the left panel, in screen points.
const LEFT_WIDTH: f32 = 276.0;
/// Width of the right panel, in screen points.
const RIGHT_WIDTH: f32 = 288.0;

/// Shows every panel that has a fixed place; what is left of `ui` is the canvas.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.theme);
    let frame = Frame::new().fill(palette.panel);
    let bar = frame.inner_margin(Margin::symmetric(14, 0));
    Panel::top("toolbar")
        .exact_size(48.0)
        .frame(bar)
        .show(ui, |ui| toolbar::show(ui, state, commands));
    Panel::bottom("timeline")
        .exact_size(104.0)
        .frame(frame.inner_margin(Margin::symmetric(18, 10)))
        .show(ui, |ui| timeline::show(ui, state, commands));
    let side = frame.inner_margin(Margin {
        left: 16,
        right: 4,
        top: 10,
        bottom: 10,
    });
    Panel::left("parameters")
        .exact_size(LEFT_WIDTH)
        .resizable(false)
        .frame(side)
        .show(ui, |ui| {
            scrolled(ui, |ui| {
                parameters::show(ui, state, commands);
                stages::show(ui, state, commands);
            });
        });
    Panel::right("inspector")
        .exact_size(RIGHT_WIDTH)
        .resizable(false)
        .frame(side)
        .show(ui, |ui| {
            scrolled(ui, |ui| {
                verification::show(ui, state, commands);
                inspector::show(ui, state, commands);
                legend::show(ui, state, commands);
            });
        });
    Panel::top("layers")
        .frame(bar.inner_margin(Margin::symmetric(12, 8)))
        .show(ui, |ui| layers::show(ui, state, commands));
}

/// Shows what floats above the window: the export sheet and the notice.
pub fn show_floating(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    export::show(ui, state, commands);
    notice::show(ui, state, commands);
}

fn scrolled(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    ScrollArea::vertical()
        .auto_shrink([false, false])
        .show(ui, |ui| {
            ui.set_max_width(ui.available_width() - 12.0);
            add(ui);
        });
}

/// A thin line between two sections.
fn divide(ui: &mut Ui, palette: &Palette) {
    ui.add_space(10.0);
    let (rect, _) =
        ui.allocate_exact_size(egui::vec2(ui.available_width(), 1.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 0.0, palette.line);
    ui.add_space(6.0);
}
