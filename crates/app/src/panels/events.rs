//! The event browser: the tree of events, or the results of a query. Selecting an event goes to the moment after it and
//! all its children. Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::text::{LayoutJob, TextWrapping};
use egui::{
    Align, Align2, CursorIcon, FontId, Rect, RichText, Role, ScrollArea, Sense, TextEdit, Ui,
    WidgetInfo, pos2, style::ScrollAnimation, vec2,
};
use tilescope_debugger::{Debugger, OutlineRows, query};
use tilescope_drawing::palette::Palette;
use tilescope_session::words::{counted, event_number, grouped};
use tilescope_ui::focus;
use tilescope_ui::theme::{is_for_fingers, row_height};
use tilescope_ui::widgets::Known;

use super::common::no_events;
use super::content::{Content, Room};
use super::context::PanelContext;
use crate::ENABLED;
use tilescope_workbench::command::{Command, DebugCommand};
use tilescope_workbench::state::{FoundEvents, MAX_FOUND};

/// Height of a row, unless enlarged for touch.
const ROW: f32 = 20.0;

pub const CONTENT: Content = Content::of_run(Room::Whole, show);

/// Shows the query, and the events that it finds.
pub fn show(ui: &mut Ui, context: &PanelContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    let Some(debugger) = &context.run.debugger else {
        no_events(ui, context);
        return;
    };

    let mut text = context.run.query.text.clone();
    let mut chosen = None;
    let typing = ui.horizontal(|ui| {
        let field = TextEdit::singleline(&mut text)
            .align(egui::Align2::LEFT_CENTER)
            .hint_text("insert iteration>1 block=7")
            .desired_width(ui.available_width() - WORDS);
        let response = ui.add(field);
        response.widget_info(|| WidgetInfo::labeled(Role::TextInput, ENABLED, "Find events"));
        response.known_as("find-events");
        chosen = words(ui, &context.run.query.text);
        response.changed()
    });

    let is_changed = typing.inner;
    if is_changed {
        chosen = Some(text);
    }
    // In the frame of a change no completions are shown: they would be those of the text before the change.
    if let Some(text) = chosen.or_else(|| completions(ui, &context.run.query.text)) {
        commands.push(Command::Debug(DebugCommand::Query(text)));
    }

    let (note, color) = match (&context.run.query.error, &context.run.query.found) {
        (Some(error), _) => (error.clone(), palette.conflict),
        (None, FoundEvents::Nothing) => (
            format!("{} events", grouped(debugger.recording().len())),
            palette.muted,
        ),
        (None, FoundEvents::Pending(_)) => ("looking\u{2026}".to_owned(), palette.muted),
        // The search ends at this number of events, so that there may be more.
        (None, FoundEvents::Events(events)) if events.len() == MAX_FOUND => (
            format!("the first {} events", grouped(MAX_FOUND)),
            palette.muted,
        ),
        (None, FoundEvents::Failed(why)) => (why.clone(), palette.conflict),
        (None, FoundEvents::Events(events)) => {
            (counted(events.len(), "event", "events"), palette.muted)
        }
    };

    ui.label(RichText::new(note).color(color))
        .known_as("found-events");
    ui.add_space(2.0);

    // Without found events the tree of all events is shown.
    let found = match &context.run.query.found {
        FoundEvents::Events(events) => Some(events.as_slice()),
        _ => None,
    };
    list(ui, context, debugger, found, commands);
}

/// The most completions shown.
const MAX_COMPLETIONS: usize = 6;

/// Room for the button of all words, in screen points.
const WORDS: f32 = 84.0;

/// Shows a menu of all words; returns the query with the chosen one added, if one was chosen.
fn words(ui: &mut Ui, text: &str) -> Option<String> {
    let mut chosen = None;
    let button = ui.menu_button("Words", |ui| {
        let height = ui.ctx().content_rect().height() - BESIDE_WORDS;
        let area = ScrollArea::vertical().max_height(height);
        area.min_scrolled_height(height).show(ui, |ui| {
            for (word, meaning) in query::words() {
                let button = ui.button(word);
                button.known_as(format_args!("word-{word}"));
                if button.on_hover_text(meaning).clicked() {
                    // Behind a blank the chosen word is a new one, instead of completing the last. An empty query gets
                    // no blank before its first word.
                    let start = format!("{} ", text.trim_end());
                    chosen = Some(query::completed(start.trim_start(), word));
                    ui.close();
                }
            }
        });
    });

    button.response.opens_menu(button.inner.is_some());
    let button = button.response;
    button.known_as("query-words");
    button.on_hover_text("The words that a query can have");
    chosen
}

/// Room above and below the list of words, in screen points.
const BESIDE_WORDS: f32 = 160.0;

/// Shows the words that the last word of the query may become; returns the query completed by a chosen one,
/// if one was chosen.
fn completions(ui: &mut Ui, text: &str) -> Option<String> {
    let near = query::completions(text);
    if near.is_empty() {
        return None;
    }
    let mut chosen = None;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (word, meaning) in near.into_iter().take(MAX_COMPLETIONS) {
            let button = ui.small_button(word);
            button.known_as(format_args!("complete-{word}"));
            if button.on_hover_text(meaning).clicked() {
                chosen = Some(query::completed(text, word));
            }
        }
    });
    chosen
}

/// A row to be shown.
struct EventRow {
    event: usize,
    /// How many events of the tree are around it, by which it is indented.
    level: usize,
    /// Whether the events within it are shown; `None` where there are none, and among found events.
    expanded: Option<bool>,
}

/// Shows the tree of events, or those that were found.
fn list(
    ui: &mut Ui,
    context: &PanelContext<'_>,
    debugger: &Debugger,
    found: Option<&[usize]>,
    commands: &mut Vec<Command>,
) {
    // The cursor is the number of events that have happened. Events are counted from 0, so that the last one is one less.
    let last = debugger.state().cursor().checked_sub(1);
    let tree = context.run.rows.as_ref();
    let count = found.map_or_else(|| tree.map_or(0, OutlineRows::len), <[usize]>::len);

    let line_of = |row: usize| match found {
        Some(events) => Some(EventRow {
            event: events[row],
            level: 0,
            expanded: None,
        }),
        None => tree?.row(row).map(|row| EventRow {
            event: row.event,
            level: row.level,
            expanded: row.has_children.then_some(row.expanded),
        }),
    };

    // The row of the last event that has happened is current. Of found events it is the last one up to that event; in the tree
    // the event may be folded away, and the row of an event around it is current.
    let here = match (found, last) {
        (Some(events), Some(last)) => events
            .partition_point(|&event| event <= last)
            .checked_sub(1),
        (None, Some(last)) => visible_row(context, last),
        (_, None) => None,
    };

    ui.spacing_mut().item_spacing.y = 0.0;
    let height = row_height(ui.ctx(), ROW);
    let area = ScrollArea::vertical()
        .auto_shrink([false, false])
        // The tree and the results are scrolled independently.
        .id_salt(found.is_some());
    let seen = ui.scope_id().with(("seen", found.is_some()));

    area.show_rows(ui, height, count, |ui, rows| {
        let top = ui.max_rect().top() - rows.start as f32 * height;
        for row in rows {
            if let Some(line) = line_of(row) {
                show_row(ui, context, debugger, &line, here == Some(row), commands);
            }
        }
        focus::follow(ui);
        // The list scrolls to the current row when that or the number of rows changes, so that a user may scroll on from there.
        // It scrolls after the rows are laid out: before that, egui would stop at the last row of the previous frame.
        let now = (here, count);
        if ui.data(|data| data.get_temp::<(Option<usize>, usize)>(seen)) != Some(now) {
            ui.data_mut(|data| data.insert_temp(seen, now));
            let at = pos2(
                ui.max_rect().left(),
                // Without a current row the list begins at its top.
                top + here.unwrap_or(0) as f32 * height,
            );
            let row = Rect::from_min_size(at, vec2(1.0, height));
            let at_once = ScrollAnimation::none();
            ui.scroll_to_rect_animation(row, Some(Align::Center), at_once);
        }
    });
}

/// Returns the row of an event, or of its nearest visible ancestor.
fn visible_row(context: &PanelContext<'_>, event: usize) -> Option<usize> {
    let rows = context.run.rows.as_ref()?;
    let outline = context.run.session.as_ref()?.outline.as_ref()?;
    let mut around = std::iter::once(event).chain(outline.parents(event));
    around.find_map(|event| rows.row_of(event))
}

/// Shows a row of the list: the arrow that unfolds an event around others, the event in words, and its number. A click
/// goes to the event.
fn show_row(
    ui: &mut Ui,
    context: &PanelContext<'_>,
    debugger: &Debugger,
    line: &EventRow,
    is_current: bool,
    commands: &mut Vec<Command>,
) {
    let palette = context.palette;
    let index = line.event;
    // The row ends before the scroll bar.
    let (rect, response) = ui.allocate_exact_size(
        vec2(ui.available_width() - 10.0, row_height(ui.ctx(), ROW)),
        Sense::click(),
    );

    let text = tilescope_debugger::short(debugger.recording(), index);
    let label = format!("Event {}: {text}", event_number(index));
    response.widget_info(|| WidgetInfo::selected(Role::Button, ENABLED, is_current, &label));
    response.known_as(format_args!("event-{index}"));

    if is_current {
        ui.painter()
            .rect_filled(rect, 3.0, palette.accent.gamma_multiply(0.22));
    } else if response.hovered() || response.has_focus() {
        ui.painter()
            .rect_filled(rect, 3.0, palette.text.gamma_multiply(0.07));
    }

    let indent = 10.0 * line.level as f32;
    if let Some(expanded) = line.expanded {
        arrow(ui, rect, indent, index, expanded, palette, commands);
    }

    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    // Events that are still to come are muted.
    let has_happened = index < debugger.state().cursor();
    let ink = if has_happened {
        palette.text
    } else {
        palette.muted
    };
    let number = painter.text(
        rect.right_center() - vec2(2.0, 0.0),
        Align2::RIGHT_CENTER,
        event_number(index),
        FontId::monospace(10.0),
        palette.muted,
    );

    // The text begins behind the room of the arrow, which not every row has.
    let left = rect.left() + 18.0 + indent;
    let mut job = LayoutJob::simple_singleline(text, FontId::proportional(12.0), ink);
    // A text that would run into the number ends with an ellipsis. The tooltip has all of it.
    job.wrap = TextWrapping::truncate_at_width((number.left() - 6.0 - left).max(0.0));
    let galley = painter.layout_job(job);
    let at = pos2(left, rect.center().y - 0.5 * galley.size().y);
    painter.galley(at, galley, ink);

    let tip = tilescope_debugger::sentence(debugger.recording(), index);
    if response
        .on_hover_cursor(CursorIcon::PointingHand)
        .on_hover_text(tip)
        .clicked()
    {
        commands.push(Command::Debug(DebugCommand::SelectEvent(index)));
    }
}

/// Shows the arrow that expands or collapses an event of the tree, at the left of its row `rect`.
fn arrow(
    ui: &Ui,
    rect: egui::Rect,
    indent: f32,
    event: usize,
    is_expanded: bool,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let at = rect.left_center() + vec2(9.0 + indent, 0.0);
    let area = egui::Rect::from_center_size(
        at,
        vec2(
            // A finger needs more room than the arrow has.
            if is_for_fingers(ui.ctx()) { 36.0 } else { 16.0 },
            rect.height(),
        ),
    );

    let response = ui.interact(area, ui.scope_id().with(("arrow", event)), Sense::click());
    let name = format!(
        "{} event {}",
        if is_expanded { "Collapse" } else { "Expand" },
        event_number(event)
    );
    response.widget_info(|| WidgetInfo::labeled(Role::Button, ENABLED, &name));
    response.known_as(format_args!("event-{event}.expand"));

    // The arrow points down at the events that follow, and right where they are folded away.
    let offsets = if is_expanded {
        [vec2(-4.0, -2.0), vec2(4.0, -2.0), vec2(0.0, 3.0)]
    } else {
        [vec2(-2.0, -4.0), vec2(3.0, 0.0), vec2(-2.0, 4.0)]
    };
    let color = if response.hovered() || response.has_focus() {
        palette.text
    } else {
        palette.muted
    };

    let corners = offsets.map(|offset| at + offset).to_vec();
    ui.painter().add(egui::Shape::convex_polygon(
        corners,
        color,
        egui::Stroke::NONE,
    ));
    if response.clicked() {
        commands.push(Command::Debug(DebugCommand::ToggleEvent(event)));
    }
}
