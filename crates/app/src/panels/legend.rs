//! The legend: each symbol with its meaning.

use egui::{RichText, Sense, Ui, vec2};

use crate::canvas::layers::Layer;
use crate::theme::Palette;
use crate::widgets::{heading, symbol};

/// Shows the legend.
pub fn show(ui: &mut Ui, palette: &Palette) {
    heading(ui, "Legend");
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
