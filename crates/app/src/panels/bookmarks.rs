//! Bookmarks: moments to come back to, each with a note, and the breakpoints with their conditions.

use egui::{KeyboardShortcut, RichText, Role, TextEdit, Ui, WidgetInfo};
use tilescope_debugger::{Bookmark, Debugger, Listings, Marked};
use tilescope_drawing::palette::Palette;
use tilescope_session::words::grouped;
use tilescope_ui::widgets::{Icon, Known, heading, icon_button};

use super::common::no_events;
use super::context::PanelContext;
use tilescope_workbench::command::{Command, DebugCommand, TimeCommand};

/// Shows the panel.
pub fn show(
    ui: &mut Ui,
    context: &PanelContext<'_>,
    run_on: Option<KeyboardShortcut>,
    commands: &mut Vec<Command>,
) {
    let palette = context.palette;
    let Some(debugger) = &context.run.debugger else {
        no_events(ui, context);
        return;
    };
    heading(ui, "Bookmarks");
    if debugger.bookmarks.is_empty() {
        ui.label(RichText::new("Press B to bookmark this moment.").color(palette.muted))
            .known_as("no-bookmarks");
    }
    for (index, mark) in debugger.bookmarks.iter().enumerate() {
        ui.horizontal(|ui| {
            let name = format!("Remove bookmark {}", index + 1);
            let remove = icon_button(ui, Icon::Close, &name, None, palette);
            let id = format_args!("bookmark-{}.remove", index + 1);
            if remove.known_as(id).clicked() {
                commands.push(Command::Debug(DebugCommand::RemoveBookmark(index)));
            }
            moment(ui, debugger, (index, mark), palette, commands);
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
            response.known_as(format_args!("bookmark-{}.note", index + 1));
            if response.changed() {
                commands.push(Command::Debug(DebugCommand::Note(index, note)));
            }
        });
    }
    ui.add_space(10.0);
    heading(ui, "Breakpoints");
    if debugger.breakpoints().is_empty() {
        let keys = run_on.map(|keys| ui.ctx().format_shortcut(&keys));
        let keys = keys.unwrap_or_default();
        let text =
            format!("A click beside a line of pseudocode sets one; {keys} runs to the next.");
        ui.label(RichText::new(text).color(palette.muted))
            .known_as("no-breakpoints");
    }
    breakpoints(ui, debugger, palette, commands);
    if let Some(text) = context.run.hits.description() {
        ui.label(RichText::new(text).color(palette.muted))
            .known_as("hits");
    }
}

/// Shows the moment of a bookmark in this run, and its name in the run where it was set if that was another.
fn moment(
    ui: &mut Ui,
    debugger: &Debugger,
    (index, mark): (usize, &Bookmark),
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let marked = debugger.marked(mark);
    let anchor = mark.anchor.map(|anchor| anchor.to_string());
    let origin = format!(
        "It was set in another run, at event {}{}.",
        grouped(mark.event),
        anchor.map_or(String::new(), |anchor| format!(" ({anchor})"))
    );
    let Some(cursor) = marked.cursor() else {
        let text = RichText::new("not in this run").color(palette.muted);
        let label = ui.label(text);
        label.known_as(format_args!("bookmark-{}", index + 1));
        label.on_hover_text(origin);
        return;
    };
    let about = if matches!(marked, Marked::Here(_)) {
        ""
    } else {
        "~ "
    };
    let text = RichText::new(format!("{about}event {}", grouped(cursor))).monospace();
    let event = tilescope_debugger::short(debugger.recording(), cursor);
    let link = ui.link(text);
    link.known_as(format_args!("bookmark-{}", index + 1));
    let link = link.on_hover_text(match marked {
        Marked::Here(_) => event,
        _ => format!("{event}\n{origin} This is the corresponding event of its stage."),
    });
    if link.clicked() {
        commands.push(Command::Time(TimeCommand::Jump(cursor)));
    }
}

fn breakpoints(ui: &mut Ui, debugger: &Debugger, palette: &Palette, commands: &mut Vec<Command>) {
    for (index, breakpoint) in debugger.breakpoints().iter().enumerate() {
        let line = Listings::shipped().line(breakpoint.line);
        let id = line.map_or("?", |line| line.id.as_str());
        ui.horizontal(|ui| {
            let name = format!("Remove the breakpoint on {id}");
            let remove = icon_button(ui, Icon::Close, &name, None, palette);
            if remove.known_as(format_args!("{id}.remove")).clicked() {
                commands.push(Command::Debug(DebugCommand::RemoveBreakpoint(index)));
            }
            let mut enabled = breakpoint.enabled;
            let switch = ui.checkbox(&mut enabled, id);
            if switch.known_as(format_args!("{id}.enabled")).changed() {
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
        response.known_as(format_args!("{id}.condition"));
        if response.changed() {
            commands.push(Command::Debug(DebugCommand::Condition(index, condition)));
        }
        if let Some(error) = breakpoint.error() {
            ui.label(RichText::new(error.to_string()).color(palette.conflict))
                .known_as(format_args!("{id}.refusal"));
        }
        ui.add_space(4.0);
    }
}
