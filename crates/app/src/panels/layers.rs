//! The chips above the canvas that switch its layers.

use egui::{Color32, RichText, Sense, Ui, vec2};
use tilescope_classroom::room::HIDDEN_LAYER;
use tilescope_drawing::orbit::{COLOR_BANDS, band_color, level_name};
use tilescope_drawing::palette::Palette;
use tilescope_session::layers::Layer;
use tilescope_session::verification::Verdict;
use tilescope_ui::language::Worded;
use tilescope_ui::widgets::{Kebab, Known, chip, explain, name_group};

use super::content::{Content, Room};
use super::context::PanelContext;
use tilescope_workbench::command::{AppearanceCommand, Command};

const AUTOMATIC: &str = "The layers follow the stage: the KD-tree while blocks are cut, the clips while they are placed. A layer that is \
     switched by hand ends this; T returns to it.";

const SIDE_BY_SIDE: &str = "The samples as dots are shown beside the set, and its radii and its shape as far as it has any.";

pub const CONTENT: Content = Content::of_run(Room::Whole, show);

/// Shows a chip for each layer of this kind of session; over balls, which have no layers, the meaning of their colours.
pub fn show(ui: &mut Ui, context: &PanelContext<'_>, commands: &mut Vec<Command>) {
    if context.run.orbit().is_some() {
        return colors_of_balls(ui, context.palette);
    }
    let row = ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(5.0, 6.0);
        let appearance = context.appearance;
        let shown = context.run.layers(appearance);
        let is_automatic = appearance.chosen_layers.is_none();
        // A layer's chip shows its swatch. "Automatic" is no layer and has none.
        let automatic = ui
            .add(chip((None, "Automatic"), is_automatic, context.palette))
            .on_hover_text(ui.words(AUTOMATIC));
        automatic.known_as("layer.automatic");
        if automatic.clicked() {
            commands.push(Command::Appearance(AppearanceCommand::AutomaticLayers));
        }

        let kind = context.run.kind();
        let offered = |layer: &Layer| layer.is_of(kind);
        for layer in Layer::ALL.into_iter().filter(offered) {
            let named = (Some((layer, kind)), layer.name_in(kind));
            let is_on = shown.has(layer);
            // A layer that would show the answer to a lesson's open question cannot be switched on.
            let is_free = !context.hidden_layers.has(layer);
            let chip = ui
                .add_enabled(is_free, chip(named, is_on, context.palette))
                .on_disabled_hover_text(ui.words(HIDDEN_LAYER))
                .on_hover_ui(|ui| explain(ui, layer, kind, context.palette));
            chip.known_as(format_args!("layer.{}", Kebab(layer)));
            if chip.clicked() {
                commands.push(Command::Appearance(AppearanceCommand::ToggleLayer(layer)));
            }
        }

        let has_ground =
            (context.run.session.as_ref()).is_some_and(|session| session.ground.is_some());
        if has_ground {
            let refusal = context.no_side_by_side;
            let is_on = appearance.is_side_by_side && refusal.is_none();
            let chip = ui
                .add_enabled(
                    refusal.is_none(),
                    chip((None, "Side by side"), is_on, context.palette),
                )
                .on_disabled_hover_text(ui.words(refusal.unwrap_or_default()))
                .on_hover_text(ui.words(SIDE_BY_SIDE));
            chip.known_as("side-by-side");
            if chip.clicked() {
                commands.push(Command::Appearance(AppearanceCommand::ToggleSideBySide));
            }
        }

        if has_no_circles(context) {
            let remark = "No empty circle is larger than r: the set is maximal.";
            let text = RichText::new(ui.words(remark))
                .small()
                .color(context.palette.muted);
            ui.label(text).known_as("no-empty-circles");
        }
    });
    name_group(&row.response, &ui.words("Layers"));
}

/// Shows the colours of balls with the levels that have each.
fn colors_of_balls(ui: &mut Ui, palette: &Palette) {
    let row = ui.horizontal_wrapped(|ui| {
        let heading = ui.words("Balls by the level at which they arrived");
        ui.label(RichText::new(heading).color(palette.muted))
            .known_as("orbit.colours");
        for band in 0..COLOR_BANDS {
            let [red, green, blue] = band_color(palette, band);
            let (square, _) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
            let color = Color32::from_rgb(red, green, blue);
            ui.painter().rect_filled(square, 2.0, color);
            ui.label(RichText::new(ui.words(level_name(band))).small());
        }
    });
    name_group(&row.response, &ui.words("Colours of balls"));
}

/// Returns whether the empty circles are asked for where there are none to draw: at the end of a maximal run.
fn has_no_circles(context: &PanelContext<'_>) -> bool {
    let run = context.run;
    let layers = run.layers(context.appearance);
    let is_maximal = run.verdict().is_some_and(Verdict::maximal);
    layers.has(Layer::Circumcircles) && run.is_at_end() && is_maximal
}
