//! The bar on top: the name, what is being looked at, the verdict, export and theme.

use egui::{Align, Button, FontId, Layout, RichText, Theme, Ui};

use super::verification;
use crate::command::Command;
use crate::sentence::grouped;
use crate::state::State;
use crate::theme::{Palette, semibold};
use crate::widgets::{Icon, icon_button};

/// Shows the bar.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.theme);
    ui.horizontal_centered(|ui| {
        let title = RichText::new("Tilescope").font(FontId::new(17.0, semibold()));
        ui.label(title);
        ui.add_space(10.0);
        if let Some(session) = &state.session {
            let parameters = &session.run.parameters;
            let text = format!(
                "{} samples   r {}   seed {}",
                grouped(session.summary.count),
                parameters.radius,
                parameters.seed
            );
            ui.label(RichText::new(text).monospace().color(palette.muted));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            theme_button(ui, state, commands);
            if icon_button(ui, Icon::Fit, "Show the whole domain (F)", None, palette).clicked() {
                commands.push(Command::Fit);
            }
            let export = ui.add_enabled(state.session.is_some(), Button::new("Export\u{2026}"));
            let why = "There is nothing to export before the first session is ready.";
            if export.on_disabled_hover_text(why).clicked() {
                commands.push(Command::OpenExport);
            }
            ui.add_space(6.0);
            verification::chip(ui, state, commands);
        });
    });
}

fn theme_button(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let (icon, name) = match state.theme {
        Theme::Dark => (Icon::Sun, "Light theme"),
        Theme::Light => (Icon::Moon, "Dark theme"),
    };
    let palette = Palette::of(state.theme);
    if icon_button(ui, icon, name, None, palette).clicked() {
        commands.push(Command::ToggleTheme);
    }
}
