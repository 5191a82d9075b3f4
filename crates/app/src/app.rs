//! The window: shows the panels each frame, collects commands and has them applied. Tiles are moved
//! here; everything else changes through commands.

use std::sync::Arc;

use eframe::egui_wgpu::RenderState;
use egui::{CentralPanel, Context, Frame, Ui};
use egui_tiles::{Behavior, EditAction, SimplificationOptions, TileId, UiResponse};

use crate::actions;
use crate::canvas::Canvas;
use crate::command::Command;
use crate::files::FileCommand;
use crate::layout::{Layout, Panel};
use crate::panels;
use crate::state::State;
use crate::theme::{self, Look};

/// The application.
pub struct App {
    /// What it shows.
    pub state: State,
    canvas: Canvas,
    commands: Vec<Command>,
    shown_look: Look,
}

impl App {
    /// Returns the application for a window with the context `ctx`; the default session starts.
    #[must_use]
    pub fn new(ctx: &Context) -> Self {
        let waker = ctx.clone();
        let state = State::new(Arc::new(move || waker.request_repaint()));
        theme::install(ctx, state.look.theme());
        Self {
            shown_look: state.look,
            state,
            canvas: Canvas::default(),
            commands: Vec::new(),
        }
    }

    /// Draws samples on the canvas by instancing on the window's device, which `render_state` holds, from now on.
    pub fn draw_with(&mut self, render_state: &RenderState) {
        self.canvas.draw_with(render_state);
    }

    /// Shows one frame.
    pub fn show(&mut self, ui: &mut Ui) {
        self.follow_look(ui.ctx());
        let dt = ui.input(|i| i.stable_dt);
        if self.state.advance(dt) {
            ui.ctx().request_repaint();
        }
        self.take_dropped(ui);
        self.commands
            .extend(actions::pressed(ui.ctx(), &self.state));
        if self.state.look == Look::Projector {
            panels::show_projector(ui, &self.state, &mut self.canvas, &mut self.commands);
        } else {
            if !self.state.bare {
                panels::show_bars(ui, &self.state, &mut self.commands);
            }
            self.show_tiles(ui);
        }
        panels::show_floating(ui, &self.state, &mut self.commands);
        self.apply_commands(ui.ctx());
    }

    /// Takes files that were dropped on the window.
    fn take_dropped(&mut self, ui: &Ui) {
        let dropped = ui.input(|input| input.raw.dropped_files.clone());
        let paths: Vec<String> = dropped
            .iter()
            .map(|file| file.path().to_string_lossy().into_owned())
            .collect();
        if !paths.is_empty() {
            self.commands
                .push(Command::File(FileCommand::Dropped(paths)));
        }
    }

    fn show_tiles(&mut self, ui: &mut Ui) {
        let mut layout = self.state.layout.clone();
        let mut tiles = Shower {
            state: &self.state,
            canvas: &mut self.canvas,
            commands: &mut self.commands,
            edited: false,
        };
        CentralPanel::no_frame().frame(Frame::new()).show(ui, |ui| {
            layout.0.ui(&mut tiles, ui);
        });
        if tiles.edited && layout.is_whole() {
            self.state.replace_layout(layout);
        }
    }

    fn apply_commands(&mut self, ctx: &Context) {
        if self.commands.is_empty() {
            return;
        }
        for command in self.commands.drain(..) {
            self.state.apply(command);
        }
        self.follow_look(ctx);
        ctx.request_repaint();
    }

    fn follow_look(&mut self, ctx: &Context) {
        if self.shown_look != self.state.look {
            self.shown_look = self.state.look;
            ctx.set_theme(self.state.look.theme());
            ctx.set_zoom_factor(self.state.look.zoom());
            ctx.request_repaint();
        }
    }

    /// Takes up what an earlier window remembered.
    pub fn remember(&mut self, storage: &dyn eframe::Storage) {
        if let Some(layout) = eframe::get_value::<Layout>(storage, LAYOUT_KEY)
            && layout.is_whole()
        {
            self.state.layout = layout;
        }
        if let Some((look, reduced_motion)) = eframe::get_value(storage, LOOK_KEY) {
            self.state.look = look;
            self.state.reduced_motion = reduced_motion;
        }
    }
}

const LAYOUT_KEY: &str = "layout";
const LOOK_KEY: &str = "look";

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        self.show(ui);
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, LAYOUT_KEY, &self.state.layout);
        let look = (self.state.look, self.state.reduced_motion);
        eframe::set_value(storage, LOOK_KEY, &look);
    }

    /// Sizes of egui's own widgets follow from the layout; nothing else of egui is remembered.
    fn persist_egui_memory(&self) -> bool {
        false
    }
}

/// Shows what is in each tile.
struct Shower<'a> {
    state: &'a State,
    canvas: &'a mut Canvas,
    commands: &'a mut Vec<Command>,
    edited: bool,
}

impl Behavior<Panel> for Shower<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _: TileId, panel: &mut Panel) -> UiResponse {
        panels::show_panel(ui, *panel, self.state, self.canvas, self.commands);
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, panel: &Panel) -> egui::WidgetText {
        panel.name().into()
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions {
            prune_single_child_tabs: false,
            ..SimplificationOptions::default()
        }
    }

    fn on_edit(&mut self, action: EditAction) {
        // A drag that has only begun has changed nothing yet.
        self.edited |= action != EditAction::TileDragged;
    }

    fn gap_width(&self, _: &egui::Style) -> f32 {
        2.0
    }

    fn min_size(&self) -> f32 {
        64.0
    }

    fn tab_title_spacing(&self, _: &egui::Visuals) -> f32 {
        6.0
    }

    fn tab_bar_height(&self, _: &egui::Style) -> f32 {
        27.0
    }

    fn tab_bar_color(&self, _: &egui::Visuals) -> egui::Color32 {
        theme::Palette::of(self.state.look).outside
    }
}
