//! The window: shows the panels and the canvas each frame, collects commands and has them applied.

use std::sync::Arc;

use egui::{CentralPanel, Context, Frame, Theme, Ui};

use crate::canvas::Canvas;
use crate::command::Command;
use crate::panels;
use crate::state::State;
use crate::theme;

/// The application.
pub struct App {
    /// What it shows.
    pub state: State,
    canvas: Canvas,
    commands: Vec<Command>,
    shown_theme: Theme,
}

impl App {
    /// Returns the application for a window with the context `ctx`; the default session starts.
    #[must_use]
    pub fn new(ctx: &Context) -> Self {
        let waker = ctx.clone();
        let state = State::new(Arc::new(move || waker.request_repaint()));
        theme::install(ctx, state.theme);
        Self {
            shown_theme: state.theme,
            state,
            canvas: Canvas::default(),
            commands: Vec::new(),
        }
    }

    /// Shows one frame.
    pub fn show(&mut self, ui: &mut Ui) {
        self.follow_theme(ui.ctx());
        let dt = ui.input(|i| i.stable_dt);
        if self.state.advance(dt) {
            ui.ctx().request_repaint();
        }
        panels::show(ui, &self.state, &mut self.commands);
        CentralPanel::no_frame().frame(Frame::new()).show(ui, |ui| {
            self.canvas.show(ui, &self.state, &mut self.commands);
        });
        panels::show_floating(ui, &self.state, &mut self.commands);
        self.apply_commands(ui.ctx());
    }

    fn apply_commands(&mut self, ctx: &Context) {
        if self.commands.is_empty() {
            return;
        }
        for command in self.commands.drain(..) {
            self.state.apply(command);
        }
        self.follow_theme(ctx);
        ctx.request_repaint();
    }

    fn follow_theme(&mut self, ctx: &Context) {
        if self.shown_theme != self.state.theme {
            self.shown_theme = self.state.theme;
            ctx.set_theme(self.state.theme);
            ctx.request_repaint();
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        self.show(ui);
    }
}
