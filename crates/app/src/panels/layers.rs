//! The chips above the canvas that switch its layers, and the meaning of colour.

use egui::{Button, RichText, Ui, vec2};

use crate::canvas::layers::{Colouring, Layer};
use crate::command::Command;
use crate::state::State;
use crate::theme::Palette;
use crate::widgets::chip;

/// Shows the chips.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.theme);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(5.0, 6.0);
        for layer in Layer::ALL {
            if chip(ui, layer, state.layers.has(layer), palette).clicked() {
                commands.push(Command::ToggleLayer(layer));
            }
        }
        ui.add_space(8.0);
        ui.label(RichText::new("Colour").small().color(palette.muted));
        for (colouring, name, explanation) in [
            (
                Colouring::Block,
                "by block",
                "Samples have the colour of the block they were tiled into.",
            ),
            (
                Colouring::Provenance,
                "by origin",
                "Samples inside their own block, from the margin around it, or inserted.",
            ),
        ] {
            let button = Button::selectable(state.colouring == colouring, name);
            if ui.add(button).on_hover_text(explanation).clicked() {
                commands.push(Command::Colour(colouring));
            }
        }
    });
}
