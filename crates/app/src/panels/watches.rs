//! Watches: expressions over the variables in scope, with their current values or errors.
//! Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{RichText, Role, TextEdit, Ui, WidgetInfo};
use tilescope_debugger::{ExpressionError, LENGTHS, NAMES, NAMES_OF_NEXT};
use tilescope_drawing::palette::Palette;
use tilescope_ui::widgets::{Icon, Known, heading, icon_button, shown_row};

use super::common::no_events;
use super::content::{Content, Room};
use super::context::PanelContext;
use crate::ENABLED;
use tilescope_workbench::command::{Command, DebugCommand};
use tilescope_workbench::live::WATCH_STEPS;

pub const CONTENT: Content = Content::of_run(Room::Scrolled, show);

/// Shows the watches, and the names that their expressions can use.
pub fn show(ui: &mut Ui, context: &PanelContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    let Some(debugger) = &context.run.debugger else {
        no_events(ui, context);
        return;
    };
    heading(ui, "Watches");
    for (index, (text, value)) in debugger.watch_values(WATCH_STEPS).into_iter().enumerate() {
        watch(ui, index, text, palette, commands);
        let label = match value {
            Ok(value) => ui.label(RichText::new(format!("= {value}")).monospace()),
            Err(ExpressionError::Pending { .. }) => {
                // A frame has a budget of steps. A value that needs more of them is finished in later frames.
                ui.ctx().request_repaint();
                ui.label(RichText::new("= \u{2026}").monospace())
            }
            Err(error) => ui.label(RichText::new(error.to_string()).color(palette.conflict)),
        };
        label.known_as(format_args!("watch-{}.value", index + 1));
        ui.add_space(4.0);
    }

    // A new watch begins with one of the names, as an example to be edited.
    let command = Command::Debug(DebugCommand::Watch("distance".to_owned()));
    ui.button("Add a watch")
        .issues("add-watch", command, commands);
    ui.add_space(10.0);

    // The names of the next event's variables come first in the list.
    let (next, now) = NAMES.split_at(NAMES_OF_NEXT);
    for (title, names) in [("In scope: the next event", next), ("In scope: now", now)] {
        let values = names.iter().map(|&(name, meaning)| {
            let mut value = debugger.evaluate(name).unwrap_or_default();
            // A dash stands for a missing value and has no unit.
            if LENGTHS.contains(&name) && value.parse::<f64>().is_ok() {
                value.push_str(" r");
            }
            (name, value, meaning)
        });
        scope(ui, title, values, palette);
    }
    // The numbers of the moment are listed without values: these would have to be measured in every frame.
    let known = debugger.recording().numbers().into_iter();
    let numbers = known.flat_map(|all| &all.names).map(|number| {
        let limit = number.not_in_conditions.map_or("", |_| "in watches alone");
        (number.name, limit.to_owned(), number.meaning)
    });
    scope(ui, "In scope: numbers of the moment", numbers, palette);

    let unit = "Lengths and places are in r, in watches and conditions, too.";
    ui.label(RichText::new(unit).small().color(palette.muted));
}

/// Shows the field of a watch, and the button that removes it.
fn watch(ui: &mut Ui, index: usize, text: &str, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let name = format!("Remove watch {}", index + 1);
        let remove = icon_button(ui, Icon::Close, &name, None, palette);
        let id = format_args!("watch-{}.remove", index + 1);
        let command = Command::Debug(DebugCommand::RemoveWatch(index));
        remove.issues(id, command, commands);

        let mut typed = text.to_owned();
        let response = ui.add(
            TextEdit::singleline(&mut typed)
                .align(egui::Align2::LEFT_CENTER)
                .code_editor()
                .desired_width(f32::INFINITY),
        );
        response.widget_info(|| {
            WidgetInfo::labeled(Role::TextInput, ENABLED, format!("Watch {}", index + 1))
        });
        response.known_as(format_args!("watch-{}", index + 1));
        if response.changed() {
            commands.push(Command::Debug(DebugCommand::EditWatch(index, typed)));
        }
    });
}

/// Lists names that expressions can use, each with a value and its meaning.
fn scope<'a>(
    ui: &mut Ui,
    title: &str,
    names: impl Iterator<Item = (&'a str, String, &'a str)>,
    palette: &Palette,
) {
    heading(ui, title);
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        for (name, value, meaning) in names {
            shown_row(ui, name, &value, palette).on_hover_text(meaning);
        }
    });
}
