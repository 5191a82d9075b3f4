//! Bookmarks: moments to come back to, each with a note, and the breakpoints with their conditions.

use egui::{RichText, Role, TextEdit, Ui, WidgetInfo};
use tilescope_debugger::{Debugger, Listings};

use super::no_events;
use crate::command::{Command, DebugCommand, TimeCommand};
use crate::sentence::grouped;
use crate::state::State;
use crate::theme::Palette;
use crate::widgets::{Icon, heading, icon_button};

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.look);
    let Some(debugger) = &state.debugger else {
        no_events(ui, state);
        return;
    };
    heading(ui, "Bookmarks");
    if debugger.bookmarks.is_empty() {
        ui.label(RichText::new("B remembers the moment.").color(palette.muted));
    }
    for (index, mark) in debugger.bookmarks.iter().enumerate() {
        ui.horizontal(|ui| {
            if icon_button(
                ui,
                Icon::Close,
                &format!("Remove bookmark {}", index + 1),
                None,
                palette,
            )
            .clicked()
            {
                commands.push(Command::Debug(DebugCommand::RemoveBookmark(index)));
            }
            let text = RichText::new(format!("event {}", grouped(mark.event))).monospace();
            let link = ui
                .link(text)
                .on_hover_text(tilescope_debugger::short(debugger.recording(), mark.event));
            if link.clicked() {
                commands.push(Command::Time(TimeCommand::Jump(mark.event)));
            }
            let mut note = mark.note.clone();
            let response = ui.add(
                TextEdit::singleline(&mut note)
                    .align(egui::Align2::LEFT_CENTER)
                    .hint_text("note")
                    .desired_width(f32::INFINITY),
            );
            response.widget_info(|| {
                WidgetInfo::labeled(
                    Role::TextInput,
                    true,
                    format!("Note of bookmark {}", index + 1),
                )
            });
            if response.changed() {
                commands.push(Command::Debug(DebugCommand::Note(index, note)));
            }
        });
    }
    ui.add_space(10.0);
    heading(ui, "Breakpoints");
    if debugger.breakpoints().is_empty() {
        let text = "A click beside a line of pseudocode sets one; F5 runs to the next.";
        ui.label(RichText::new(text).color(palette.muted));
    }
    breakpoints(ui, debugger, palette, commands);
    if let Some(said) = state.hits.said() {
        ui.label(RichText::new(said).color(palette.muted));
    }
}

fn breakpoints(ui: &mut Ui, debugger: &Debugger, palette: &Palette, commands: &mut Vec<Command>) {
    for (index, breakpoint) in debugger.breakpoints().iter().enumerate() {
        let line = Listings::shipped().line(breakpoint.line);
        let id = line.map_or("?", |line| line.id.as_str());
        ui.horizontal(|ui| {
            if icon_button(
                ui,
                Icon::Close,
                &format!("Remove the breakpoint on {id}"),
                None,
                palette,
            )
            .clicked()
            {
                commands.push(Command::Debug(DebugCommand::RemoveBreakpoint(index)));
            }
            let mut enabled = breakpoint.enabled;
            if ui.checkbox(&mut enabled, id).changed() {
                commands.push(Command::Debug(DebugCommand::Enable(index, enabled)));
            }
        });
        let mut condition = breakpoint.condition.clone();
        let field = TextEdit::singleline(&mut condition)
            .align(egui::Align2::LEFT_CENTER)
            .hint_text("condition, such as block == 7 && distance < 0.9")
            .code_editor()
            .desired_width(ui.available_width() - 8.0);
        let response = ui.add(field);
        response.widget_info(|| {
            WidgetInfo::labeled(Role::TextInput, true, format!("Condition on {id}"))
        });
        if response.changed() {
            commands.push(Command::Debug(DebugCommand::Condition(index, condition)));
        }
        if let Some(error) = breakpoint.error() {
            ui.label(RichText::new(error.to_string()).color(palette.conflict));
        }
        ui.add_space(4.0);
    }
}
