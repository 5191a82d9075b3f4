//! The legend: each symbol with its meaning, and what the colour of samples means.

use egui::{Button, RichText, Sense, Ui, vec2};

use crate::canvas::layers::{Colouring, Layer};
use crate::command::Command;
use crate::state::State;
use crate::theme::Palette;
use crate::widgets::{heading, symbol};

/// Shows the legend.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.look);
    heading(ui, "Legend");
    colouring(ui, state, commands);
    ui.add_space(2.0);
    ui.spacing_mut().item_spacing.y = 1.0;
    for (layer, meaning) in [
        (Layer::Samples, "sample"),
        (Layer::Disks, "disk of radius r"),
        (Layer::Blocks, "building block"),
        (Layer::Pattern, "clip: block enlarged by r"),
        (Layer::Conflicts, "conflict: closer than r"),
        (Layer::Eliminated, "eliminated sample"),
        (Layer::Gaps, "gap: covered by no disk"),
        (Layer::Detectors, "gap detector"),
        (Layer::Candidates, "candidate place"),
        (Layer::Inserted, "inserted sample"),
    ] {
        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(vec2(22.0, 20.0), Sense::hover());
            symbol(ui.painter(), layer, rect.center(), palette);
            ui.label(RichText::new(meaning).size(12.5).color(palette.muted));
        });
    }
}

fn colouring(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.look);
    ui.horizontal(|ui| {
        ui.label(RichText::new("Colour").color(palette.muted));
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
