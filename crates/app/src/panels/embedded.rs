//! What is shown of the window where it is part of another page: the canvas, and below it the line of time. Menus and panels
//! are left to the page.

use egui::{CentralPanel, Frame, Margin, Ui};

use super::{notice, timeline};
use crate::canvas::Canvas;
use crate::command::Command;
use crate::embedding::Embedding;
use crate::state::State;
use crate::theme::Palette;

/// How high the sentence, the controls and the line are together.
const HEIGHT: f32 = 100.0;

/// Shows what is left of the window.
pub fn show(
    ui: &mut Ui,
    embedding: Embedding,
    state: &State,
    canvas: &mut Canvas,
    commands: &mut Vec<Command>,
) {
    let palette = Palette::of(state.look);
    if embedding == Embedding::Player {
        let frame = Frame::new().fill(palette.panel);
        egui::Panel::bottom("player")
            .exact_size(HEIGHT)
            .frame(frame.inner_margin(Margin::symmetric(12, 6)))
            .show(ui, |ui| timeline::show(ui, state, commands));
    }
    CentralPanel::no_frame()
        .frame(Frame::new())
        .show(ui, |ui| canvas.show(ui, state, commands));
    // A canvas alone shows what went wrong, and nothing else but itself.
    let is_wrong = state.notice.as_ref().is_some_and(|notice| notice.is_error);
    if embedding == Embedding::Player || is_wrong {
        notice::show(ui, state, commands);
    }
}
