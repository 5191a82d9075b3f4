//! The caption of a scene over the canvas, with the buttons that go on and back.

use egui::{Area, Button, FontId, Frame, Id, Label, Margin, Order, RichText, Stroke, Ui, pos2};
use tilescope_debugger::Direction;
use tilescope_drawing::palette::Palette;
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::{Known, primary_button};
use tilescope_workbench::command::Command;
use tilescope_workbench::scenes::{SceneCommand, SceneList, ShownScene};
use tilescope_workbench::state::State;
use tilescope_workbench::tour::tour;

use super::common::read_out;

/// Font sizes of the caption over the canvas: in the window, and for a projector.
const CAPTION_SIZES: [f32; 2] = [15.0, 17.0];
/// Width of the caption, in screen points.
const CAPTION_WIDTH: f32 = 560.0;
/// The distance of the caption from the canvas' lower edge, above the scale bar.
const ABOVE_EDGE: f32 = 56.0;

/// Shows the caption.
pub fn show(ui: &Ui, state: &State, commands: &mut Vec<Command>) {
    let Some(shown) = state.scene else {
        return;
    };
    let scenes = state.scenes(shown.list);
    let Some(scene) = scenes.get(shown.index) else {
        return;
    };
    let palette = Palette::of(state.appearance.look);
    let of_tour = (shown.list == SceneList::Tour).then(|| &tour()[shown.index]);
    if of_tour.is_none() && scene.caption.is_empty() {
        return;
    }
    let canvas = state.runs.first.viewport;
    let size = CAPTION_SIZES[usize::from(state.appearance.look.is_projector())];
    let width = CAPTION_WIDTH.min(canvas.width() - 24.0).max(200.0);
    let at = pos2(canvas.center().x, canvas.bottom() - ABOVE_EDGE);
    Area::new(Id::unique("caption of the scene"))
        .order(Order::Middle)
        .pivot(egui::Align2::CENTER_BOTTOM)
        .fixed_pos(at)
        .constrain(true)
        .show(ui.ctx(), |ui| {
            Frame::new()
                .fill(palette.raised)
                .stroke(Stroke::new(1.0, palette.accent))
                .corner_radius(10)
                .shadow(ui.visuals().window_shadow)
                .inner_margin(Margin::symmetric(16, 12))
                .show(ui, |ui| {
                    ui.set_width(width - 32.0);
                    if let Some(of_tour) = of_tour {
                        ui.label(RichText::new(&of_tour.title).font(FontId::new(size, semibold())))
                            .known_as("caption-title");
                    }
                    let text = RichText::new(&scene.caption).size(size);
                    let response = ui.add(Label::new(text).wrap());
                    read_out(ui, &response);
                    response.known_as("caption");
                    if let Some(offer) = of_tour.and_then(|scene| scene.offer.as_ref()) {
                        ui.add_space(4.0);
                        let button = primary_button(ui, &offer.name, None, palette);
                        if button.known_as("caption-offer").clicked() {
                            commands.extend(offer.commands.iter().cloned());
                        }
                    }
                    ui.add_space(6.0);
                    ui.horizontal(|ui| {
                        let of = format!("{} of {}", shown.index + 1, scenes.len());
                        ui.label(RichText::new(of).color(palette.muted))
                            .known_as("caption-number");
                        steps(ui, shown, scenes.len(), commands);
                    });
                });
        });
}

/// Shows the buttons that go on, back, and away.
fn steps(ui: &mut Ui, shown: ShownScene, len: usize, commands: &mut Vec<Command>) {
    let is_tour = shown.list == SceneList::Tour;
    let is_last = shown.index + 1 == len;
    let on = match (is_tour, is_last) {
        (true, true) => "Finish (Space)",
        (true, false) => "Next (Space)",
        (false, _) => "Next (PageDown)",
    };
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let mut step = |ui: &mut Ui, name: &str, id: &str, can: bool, command| {
            let button = ui.add_enabled(can, Button::new(name));
            if button.known_as(id).clicked() {
                commands.push(Command::Scene(command));
            }
        };
        step(
            ui,
            on,
            "caption-next",
            is_tour || !is_last,
            SceneCommand::Step(Direction::Forwards),
        );
        let back = SceneCommand::Step(Direction::Backwards);
        step(ui, "Back", "caption-back", shown.index > 0, back);
        step(
            ui,
            "Close (Esc)",
            "caption-close",
            true,
            SceneCommand::Leave,
        );
    });
}
