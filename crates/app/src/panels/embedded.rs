//! The parts of the window shown when it is embedded in another page: the canvas, with the sentence, the controls and
//! the track below. Menus and panels are not shown.
//! Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{Color32, Context, Rect, Ui, Vec2, vec2};
use tilescope_drawing::palette::Palette;
use tilescope_ui::widgets::{Icon, Known, icon_button};

use super::compact::part;
use super::context::TimeContext;
use super::notice;
use super::timeline::{PLAYER_MARGIN, Player};
use crate::panes::Canvas;
use crate::panes::CanvasContext;
use tilescope_workbench::command::{Command, ViewCommand, Which};
use tilescope_workbench::embedding::Embedding;
use tilescope_workbench::state::State;

/// Distance of the button from the canvas's corner, in screen points.
const INSET: Vec2 = vec2(8.0, 8.0);

/// Shows the embedded window: the canvas alone, or a player, whose controls lie below the canvas.
pub fn show(
    ui: &mut Ui,
    embedding: Embedding,
    state: &State,
    canvas: &mut Canvas,
    commands: &mut Vec<Command>,
) {
    let palette = Palette::of(state.appearance().look);
    let room = ui.available_rect_before_wrap();

    let player = (embedding == Embedding::Player).then(|| Player::of(room.size()));
    let height = player.map_or(0.0, |_| player_height(ui.ctx(), room.size(), state));
    let (above, below) = room.split_top_bottom_at_y(room.bottom() - height);
    // The Tab key visits the parts in the order in which they are shown: the canvas comes first.
    part(
        ui,
        "canvas",
        above,
        Vec2::ZERO,
        Color32::TRANSPARENT,
        |ui| {
            canvas.show(ui, &CanvasContext::of(state), commands);
        },
    );

    if state.runs().first.session.is_some() && !state.runs().first.is_fitted() {
        whole_domain(ui, above, palette, commands);
    }

    if let Some(player) = player {
        part(ui, "player", below, PLAYER_MARGIN, palette.panel, |ui| {
            player.show(ui, &TimeContext::of(state), commands);
        });
    }
    // A player shows every notice, a canvas without controls only errors.
    let is_error = state
        .messages()
        .notice
        .as_ref()
        .is_some_and(|notice| notice.is_error);
    if embedding == Embedding::Player || is_error {
        notice::show(ui, state, commands);
    }
}

/// Returns the height of the controls below the canvas in a window of this size.
pub fn player_height(ctx: &Context, size: Vec2, state: &State) -> f32 {
    let width = size.x - 2.0 * PLAYER_MARGIN.x;
    Player::of(size).height(ctx, &TimeContext::of(state), width)
}

/// Shows a button in the upper right corner of the canvas that fits the whole domain again. The caller shows it only where the
/// view has changed.
fn whole_domain(ui: &mut Ui, canvas: Rect, palette: &Palette, commands: &mut Vec<Command>) {
    let corner = canvas.shrink2(INSET);
    let builder = egui::UiBuilder::new()
        .id_salt("whole domain")
        .max_rect(corner)
        .layout(egui::Layout::right_to_left(egui::Align::Min));
    ui.scope_builder(builder, |ui| {
        // The ground lies below the button, and is as large as the button, whose size is known only once it is shown.
        let ground = ui.painter().add(egui::Shape::Noop);
        let name = "Fit the domain (F)";
        let response = icon_button(ui, Icon::Fit, name, None, palette);
        response.known_as("fit");

        let color = palette.panel.gamma_multiply(0.82);
        let fill = egui::Shape::rect_filled(response.rect, 7.0, color);
        ui.painter().set(ground, fill);
        if response.clicked() {
            commands.push(Command::View(Which::First, ViewCommand::Fit));
        }
    });
}
