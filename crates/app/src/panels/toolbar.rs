//! The bar on top: the name, what is being looked at, the verdict, export and theme.

use egui::{Align, Button, FontId, Layout, RichText, Ui};

use super::verification;
use crate::actions::{Action, Menu, actions};
use crate::command::Command;
use crate::export::{ExportCommand, Kind};
use crate::sentence::grouped;
use crate::state::State;
use crate::theme::{Look, Palette, semibold};
use crate::widgets::{Icon, icon_button};

/// From this much room behind the menus on, in screen points, the run is named.
const ROOM_FOR_RUN: f32 = 620.0;
/// From this much on, the engine is, too.
const ROOM_FOR_ENGINE: f32 = 740.0;

/// Shows the bar.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.look);
    ui.horizontal_centered(|ui| {
        let title = RichText::new("Tilescope").font(FontId::new(17.0, semibold()));
        ui.label(title);
        ui.add_space(6.0);
        menus(ui, state, commands);
        ui.add_space(10.0);
        let room = ui.available_width();
        if let Some(session) = state.session.as_ref().filter(|_| room >= ROOM_FOR_RUN) {
            let parameters = &session.run().parameters;
            let text = format!(
                "{} samples   r {}   seed {}",
                grouped(session.summary.count),
                parameters.radius,
                parameters.seed
            );
            ui.label(RichText::new(text).monospace().color(palette.muted));
            if room >= ROOM_FOR_ENGINE {
                let engine = format!("engine: {}", session.engine);
                ui.label(RichText::new(engine).color(palette.muted));
            }
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            theme_button(ui, state, commands);
            if icon_button(ui, Icon::Fit, "Show the whole domain (F)", None, palette).clicked() {
                commands.push(Command::Fit);
            }
            let export = ui.add_enabled(state.session.is_some(), Button::new("Export\u{2026}"));
            let why = "There is nothing to export before the first session is ready.";
            if export.on_disabled_hover_text(why).clicked() {
                commands.push(Command::Export(ExportCommand::Open(Kind::Result)));
            }
            ui.add_space(6.0);
            verification::chip(ui, state, commands);
        });
    });
}

fn theme_button(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let other = state.look.other();
    let icon = if other == Look::Light {
        Icon::Sun
    } else {
        Icon::Moon
    };
    let name = other.name();
    let palette = Palette::of(state.look);
    if icon_button(ui, icon, name, None, palette).clicked() {
        commands.push(Command::ToggleTheme);
    }
}

fn menus(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let all = std::cell::OnceCell::new();
    for menu in Menu::ALL {
        ui.menu_button(menu.name(), |ui| {
            let all: &Vec<Action> = all.get_or_init(|| actions(state));
            egui::ScrollArea::vertical()
                .max_height(620.0)
                .show(ui, |ui| {
                    for action in all.iter().filter(|action| action.menu == menu) {
                        entry(ui, action, commands);
                    }
                });
        });
    }
}

fn entry(ui: &mut Ui, action: &Action, commands: &mut Vec<Command>) {
    let keys = action
        .shortcut
        .map_or_else(String::new, |keys| ui.ctx().format_shortcut(&keys));
    let button = Button::new(action.name.as_str()).shortcut_text(keys);
    let response = ui.add_enabled(action.refusal.is_none(), button);
    let response = response.on_disabled_hover_text(action.refusal.as_deref().unwrap_or_default());
    if response.clicked() {
        commands.push(action.command.clone());
        ui.close();
    }
}
