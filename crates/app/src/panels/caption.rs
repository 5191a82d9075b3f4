//! The caption of a scene over the canvas, with the buttons that go on and back.

use egui::{Area, Button, FontId, Frame, Id, Label, Margin, Order, RichText, Stroke, Ui, pos2};
use tilescope_debugger::Direction;
use tilescope_drawing::palette::Palette;
use tilescope_ui::theme::{is_for_fingers, semibold};
use tilescope_ui::widgets::{Known, primary_button};
use tilescope_workbench::command::Command;
use tilescope_workbench::scenes::{SceneCommand, SceneList, ShownScene, split_caption};
use tilescope_workbench::state::State;
use tilescope_workbench::tour::tour;

use super::common::read_out;

/// Font sizes of the caption over the canvas: in the window, and for a projector.
const CAPTION_SIZES: [f32; 2] = [15.0, 17.0];
/// Largest width of the caption, in screen points, and the smallest one between the scale bar and the zoom.
const CAPTION_WIDTHS: [f32; 2] = [560.0, 380.0];
/// Room for the scale bar, and for the zoom, beside the caption.
const BESIDE: f32 = 130.0;
/// The distance of the caption from the canvas' lower edge: between the scale bar and the zoom, and above them.
const ABOVE_EDGE: [f32; 2] = [14.0, 56.0];

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
    let [widest, least] = CAPTION_WIDTHS;
    let between = canvas.width() - 2.0 * BESIDE;
    let (room, above) = if between >= least {
        (between, ABOVE_EDGE[0])
    } else {
        (canvas.width() - 24.0, ABOVE_EDGE[1])
    };
    let width = room.clamp(200.0, widest);
    let at = pos2(canvas.center().x, canvas.bottom() - above);
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
                    let text = RichText::new(split_caption(&scene.caption).0).size(size);
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
    // A finger has no keys.
    let named = |name: &str, key: &str| {
        if is_for_fingers(ui.ctx()) {
            name.to_owned()
        } else {
            format!("{name} ({key})")
        }
    };
    let on = match (is_tour, is_last) {
        (true, true) => named("Finish", "Space"),
        (true, false) => named("Next", "Space"),
        (false, _) => named("Next", "PageDown"),
    };
    let close = named("Close", "Esc");
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let mut step = |ui: &mut Ui, name: &str, id: &str, can: bool, command| {
            ui.add_enabled(can, Button::new(name))
                .issues(id, Command::Scene(command), commands);
        };
        step(
            ui,
            &on,
            "caption-next",
            is_tour || !is_last,
            SceneCommand::Step(Direction::Forwards),
        );
        let back = SceneCommand::Step(Direction::Backwards);
        step(ui, "Back", "caption-back", shown.index > 0, back);
        step(ui, &close, "caption-close", true, SceneCommand::Leave);
    });
}
