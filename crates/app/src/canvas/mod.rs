//! The canvas: one picture of samples, or two side by side, and what lies over them. It reads the state and pushes
//! commands; what it remembers between frames are pictures that can be made again.

pub(crate) mod age;
pub(crate) mod blocks;
mod brushed;
mod buffers;
mod contrast;
mod geometry;
pub mod hint;
mod hover;
pub mod index;
pub mod input;
pub mod instanced;
pub mod layers;
pub(crate) mod looks;
mod now;
mod overlay;
mod paint;
mod pane;
mod raster;
mod resident;
pub(crate) mod seams;
mod sprites;
mod stack;
mod strokes;
pub mod subject;
mod symbols;
pub mod touch;
pub(crate) mod tree;

use eframe::egui_wgpu::RenderState;
use egui::{Rect, Sense, Ui, vec2};

use crate::command::Command;
use crate::compare::CompareCommand;
use crate::state::State;
use crate::theme::{Look, Palette};
use crate::widgets::Known;
pub(crate) use contrast::mark as contrast_mark;
pub(crate) use input::has_focus;
use pane::Pane;
pub(crate) use seams::symbol as seam_symbol;
use sprites::Sprites;
use subject::Subject;
pub(crate) use tree::Made;

/// More samples than this in view are drawn as points, without symbols and disks.
pub const MAX_SYMBOLS: usize = 90_000;
/// Disks and gaps are drawn from this many screen points per r.
pub const MIN_DISK_SCALE: f64 = 1.25;

const UNIT: Rect = Rect {
    min: egui::pos2(0.0, 0.0),
    max: egui::pos2(1.0, 1.0),
};

/// The canvas between two frames.
#[derive(Default)]
pub struct Canvas {
    first: Pane,
    second: Pane,
    /// What the second picture will draw with.
    device: Option<RenderState>,
    /// The symbols of the rows of buffers.
    marks: Sprites,
}

impl Canvas {
    /// Draws samples by instancing on the device of `render_state` from now on.
    pub fn draw_with(&mut self, render_state: &RenderState) {
        self.first.draw_with(render_state);
        // The second picture asks for its own when there is one: pipelines take a while to be made.
        self.device = Some(render_state.clone());
    }

    /// Shows the canvas in all the space that `ui` has left.
    pub fn show(&mut self, ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
        let size = ui.available_size().max(vec2(1.0, 1.0));
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        let subject = state.subject();
        let Some((second, comparison)) = &state.comparison else {
            let side = Side {
                rect,
                name: "Canvas of samples",
                viewport: state.viewport,
                waiting: state.sampling.is_some(),
                subject,
            };
            side.show(ui, state, &mut self.first, &mut self.marks, commands)
                .known_as("canvas");
            return;
        };
        ui.painter()
            .rect_filled(rect, 0.0, Palette::of(state.look).line);
        let [left, right] = contrast::halves(rect);
        let left = Side {
            rect: contrast::heading(ui, left, state, &contrast::first_title(state)),
            name: "Canvas of run A",
            viewport: state.viewport,
            waiting: state.sampling.is_some(),
            subject,
        };
        left.show(ui, state, &mut self.first, &mut self.marks, commands)
            .known_as("canvas-a");
        if let Some(device) = self.device.take() {
            self.second.draw_with(&device);
        }
        let subject = state.second_subject();
        let right = Side {
            rect: contrast::heading(ui, right, state, &contrast::second_title(state, second)),
            name: "Canvas of run B",
            viewport: second.viewport,
            waiting: second.sampling.is_some(),
            subject,
        };
        let mut own = Vec::new();
        right
            .show(ui, state, &mut self.second, &mut self.marks, &mut own)
            .known_as("canvas-b");
        let on_other = |command| CompareCommand::OnOther(Box::new(command));
        commands.extend(own.into_iter().map(on_other).map(Command::Compare));
        contrast::echo(
            ui,
            [left.rect, right.rect],
            [&left.subject, &right.subject],
            comparison,
            state,
        );
    }
}

/// One of the pictures, and where it goes.
struct Side<'a> {
    rect: Rect,
    name: &'a str,
    /// Where it was in the frame before.
    viewport: Rect,
    /// Whether a run is at work for it.
    waiting: bool,
    subject: Option<Subject<'a>>,
}

impl Side<'_> {
    fn show(
        &self,
        ui: &mut Ui,
        state: &State,
        pane: &mut Pane,
        marks: &mut Sprites,
        commands: &mut Vec<Command>,
    ) -> egui::Response {
        let rect = self.rect;
        let response = ui.interact(rect, ui.scope_id().with(self.name), Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, self.name));
        if rect != self.viewport {
            commands.push(Command::Viewport(rect));
        }
        let palette = Palette::of(state.look);
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, palette.outside);
        let Some(subject) = &self.subject else {
            overlay::waiting(&painter, rect, self.waiting, palette);
            return response;
        };
        let pointer = input::handle(ui, &response, subject, state, commands);
        let note = pane.paint(ui, rect, subject, palette);
        let note = buffers::show(ui, rect, subject, palette, marks, note);
        overlay::scale_bar(&painter, rect, subject, palette);
        overlay::cursor(&painter, rect, subject, pointer, palette);
        overlay::note(&painter, rect, subject, note.as_deref(), palette);
        hint::show(&painter, rect, palette);
        let brief = state.look == Look::Projector;
        if pointer.is_some() {
            hover::show(ui, &painter, &response, subject, palette, brief);
        }
        response
    }
}
