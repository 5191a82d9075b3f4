//! The event browser: the events around the cursor with their depths, or those that a query finds. A click goes
//! there.

use egui::{
    Align2, CursorIcon, FontId, RichText, Role, ScrollArea, Sense, TextEdit, Ui, WidgetInfo, vec2,
};
use tilescope_debugger::{Debugger, Listings};

use super::no_events;
use crate::command::{Command, DebugCommand, TimeCommand};
use crate::sentence::{counted, event_row, grouped};
use crate::state::{Found, MOST_FOUND, State};
use crate::theme::Palette;

const ROW: f32 = 20.0;

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.look);
    let Some(debugger) = &state.debugger else {
        no_events(ui, state);
        return;
    };
    let mut text = state.query.text.clone();
    let field = TextEdit::singleline(&mut text)
        .hint_text("insert iteration>1 block=7")
        .desired_width(ui.available_width() - 16.0);
    let response = ui.add(field);
    response.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Find events"));
    if response.changed() {
        commands.push(Command::Debug(DebugCommand::Query(text)));
    }
    let (note, color) = match (&state.query.error, &state.query.found) {
        (Some(error), _) => (error.clone(), palette.conflict),
        (None, Found::Nothing) => (
            format!("{} events", grouped(debugger.recording().len())),
            palette.muted,
        ),
        (None, Found::Pending(_)) => ("looking\u{2026}".to_owned(), palette.muted),
        (None, Found::Events(events)) if events.len() == MOST_FOUND => (
            format!("the first {} events", grouped(MOST_FOUND)),
            palette.muted,
        ),
        (None, Found::Events(events)) => (counted(events.len(), "event", "events"), palette.muted),
    };
    ui.label(RichText::new(note).color(color));
    ui.add_space(2.0);
    let found = match &state.query.found {
        Found::Events(events) => Some(events.as_slice()),
        _ => None,
    };
    list(ui, state, debugger, found, commands);
}

/// Shows rows of events: all of them, or those given.
pub fn list(
    ui: &mut Ui,
    state: &State,
    debugger: &Debugger,
    events: Option<&[usize]>,
    commands: &mut Vec<Command>,
) {
    let count = events.map_or(debugger.recording().len(), <[usize]>::len);
    let event_at = |row: usize| events.map_or(row, |events| events[row]);
    let cursor = debugger.state().cursor();
    ui.spacing_mut().item_spacing.y = 0.0;
    let mut area = ScrollArea::vertical()
        .auto_shrink([false, false])
        .id_salt(events.is_some());
    let here = match events {
        None => cursor,
        Some(events) => events.partition_point(|&event| event < cursor),
    };
    let seen = ui.scope_id().with(("seen", events.is_some()));
    if ui.data(|data| data.get_temp::<usize>(seen)) != Some(cursor) {
        ui.data_mut(|data| data.insert_temp(seen, cursor));
        let offset = here as f32 * ROW - 0.4 * ui.available_height();
        area = area.vertical_scroll_offset(offset.max(0.0));
    }
    area.show_rows(ui, ROW, count, |ui, rows| {
        for row in rows {
            show_row(ui, state, debugger, event_at(row), cursor, commands);
        }
    });
}

fn show_row(
    ui: &mut Ui,
    state: &State,
    debugger: &Debugger,
    index: usize,
    cursor: usize,
    commands: &mut Vec<Command>,
) {
    let palette = Palette::of(state.look);
    let Some(event) = debugger.recording().event(index) else {
        return;
    };
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width() - 10.0, ROW), Sense::click());
    let text = event_row(debugger.recording(), index);
    let next = index == cursor;
    response.widget_info(|| {
        WidgetInfo::selected(
            Role::Button,
            true,
            next,
            format!("Event {}: {text}", grouped(index)),
        )
    });
    if next {
        ui.painter()
            .rect_filled(rect, 3.0, palette.accent.gamma_multiply(0.22));
    } else if response.hovered() || response.has_focus() {
        ui.painter()
            .rect_filled(rect, 3.0, palette.text.gamma_multiply(0.07));
    }
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    let ink = if index < cursor {
        palette.text
    } else {
        palette.muted
    };
    let left = rect.left_center();
    painter.text(
        left + vec2(56.0, 0.0),
        Align2::RIGHT_CENTER,
        grouped(index),
        FontId::monospace(10.5),
        palette.muted,
    );
    let indent = 64.0 + 8.0 * f32::from(event.depth());
    painter.text(
        left + vec2(indent, 0.0),
        Align2::LEFT_CENTER,
        text,
        FontId::proportional(12.0),
        ink,
    );
    let line = Listings::shipped().line(event.line());
    let tip = line.map_or_else(String::new, |line| format!("{}  {}", line.id, line.text));
    if response
        .on_hover_cursor(CursorIcon::PointingHand)
        .on_hover_text(tip)
        .clicked()
    {
        commands.push(Command::Time(TimeCommand::Jump(index)));
    }
}
