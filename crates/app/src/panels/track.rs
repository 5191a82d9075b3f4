//! The track of the timeline: a segment per stage, wider the more events it has, with the cursor, scenes and the loop.
//! Click or drag to move in time. Nested levels have a segment per level, and the cursor is the prefix that is shown.
//! Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use std::ops::Range;

use egui::accesskit::{Action, ActionData};
use egui::{
    Color32, CursorIcon, FontId, Painter, Rect, Response, Role, Sense, Shape, Stroke, Ui,
    WidgetInfo, pos2, vec2,
};
use tilescope_core::Stage;
use tilescope_debugger::{Marked, Recording};
use tilescope_drawing::looks::level_age;
use tilescope_drawing::palette::Palette;
use tilescope_session::nested::NestedLevels;
use tilescope_session::sentence::name_in;
use tilescope_session::session::Session;
use tilescope_session::words::grouped;
use tilescope_ui::language::Worded;
use tilescope_ui::theme::is_for_fingers;
use tilescope_ui::widgets::{Kebab, Known};

use crate::ENABLED;
use crate::panels::context::TimeContext;
use tilescope_workbench::command::{Command, TimeCommand};

/// Minimum width of a segment, in screen points.
const MIN_WIDTH: f32 = 54.0;
/// Height of the track with its labels.
pub(super) const HEIGHT: f32 = 54.0;
/// Height on a small window, for touch.
pub(super) const COMPACT_HEIGHT: f32 = 44.0;
/// Height of the bars, above their labels.
const BAR: f32 = 24.0;
/// Height of the colour of a level at the bottom of its bar.
const SWATCH: f32 = 5.0;

/// A stage or a level on the track.
pub(super) struct Segment {
    pub index: usize,
    /// Its name, and two shorter ones.
    names: [String; 3],
    /// Its name in ids.
    key: String,
    /// What a click does.
    tip: String,
    pub left: f32,
    pub right: f32,
    pub events: Range<usize>,
}

/// Returns the names of a stage, its name in ids, and what a click on it does.
fn of_stage(session: &Session, stage: Stage, events: usize) -> ([String; 3], String, String) {
    let name = name_in(session, stage);
    let tip = match session.stipple() {
        Some(_) => format!("To all {} dots", grouped(session.summary.count)),
        None => format!("To the end of stage {name}: {} events", grouped(events)),
    };
    let names = [name.clone(), short(&name), number(&name)];
    (names, Kebab(stage).to_string(), tip)
}

/// Returns the names of a level, its name in ids, and what a click on it does.
fn of_level(
    session: &Session,
    nested: &NestedLevels,
    level: usize,
) -> ([String; 3], String, String) {
    // A claim says of the samples up to the end of a level how many they are, and which distance they keep.
    let claim = nested.claims[level];
    let radius = claim.distance / session.run().domain.radius();
    let tip = format!(
        "To the end of level {level}: {} samples",
        grouped(claim.count)
    );
    // A level has no name between the long one and its number.
    let number = level.to_string();
    let names = [
        format!("Level {level}: {radius:.2} r"),
        number.clone(),
        number,
    ];
    (names, format!("level-{level}"), tip)
}

/// Returns the segments of a session between `left` and `right`.
fn segments(session: &Session, left: f32, right: f32) -> Vec<Segment> {
    let ends = session.ends();
    let count = if ends.is_empty() {
        session.stages.len()
    } else {
        ends.len()
    };

    // Without events the cursor is the index of a stage, so that a stage ends at its index.
    let end = |index: usize| ends.get(index).copied().unwrap_or(index);
    let range = |index: usize| index.checked_sub(1).map_or(0, end)..end(index);
    let total: usize = (0..count).map(|index| range(index).len()).sum();
    // Every segment is wide enough to be hit, however few its events. On a narrow track all have the same width.
    let least = MIN_WIDTH.min((right - left) / count as f32);
    let room = (right - left - least * count as f32).max(0.0);

    let mut at = left;
    let segment = |index: usize| {
        let events = range(index);
        let (names, key, tip) = match &session.nested {
            Some(nested) => of_level(session, nested, index),
            None => of_stage(session, session.stages[index], events.len()),
        };
        // A run of one stage may have no events at all: nothing is divided by 0.
        let width = least + room * events.len() as f32 / total.max(1) as f32;
        let from = at;
        at += width;
        Segment {
            index,
            names,
            key,
            tip,
            left: from,
            right: at,
            events,
        }
    };

    (0..count).map(segment).collect()
}

/// Returns the segments of a session on a track at `rect`.
pub(super) fn segments_within(session: &Session, rect: Rect) -> Vec<Segment> {
    segments(session, rect.left() + 4.0, rect.right() - 4.0)
}

/// Returns where a cursor is on the track.
pub(super) fn x_of(segments: &[Segment], cursor: usize) -> f32 {
    let found = segments.iter().find(|segment| cursor <= segment.events.end);
    let Some(segment) = found.or(segments.last()) else {
        return 0.0;
    };
    if segment.events.is_empty() {
        return segment.right;
    }
    let part = cursor.saturating_sub(segment.events.start) as f32 / segment.events.len() as f32;
    segment.left + (segment.right - segment.left) * part.min(1.0)
}

/// Returns the cursor at `x` of the track.
pub(super) fn cursor_at(segments: &[Segment], x: f32) -> usize {
    let found = segments.iter().find(|segment| x <= segment.right);
    let Some(segment) = found.or(segments.last()) else {
        return 0;
    };
    let part = ((x - segment.left) / (segment.right - segment.left)).clamp(0.0, 1.0);
    segment.events.start + (part * segment.events.len() as f32).round() as usize
}

/// Gives assistive tools the range of the track, up to `most`; returns the value that one of them has set, if
/// one has.
fn asked_for(ui: &Ui, response: &Response, most: usize) -> Option<usize> {
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_min_numeric_value(0.0);
        node.set_max_numeric_value(most as f64);
        node.add_action(Action::SetValue);
    });

    ui.input(|input| {
        let requests = input.accesskit_action_requests(response.id, Action::SetValue);
        let values = requests.filter_map(|request| match request.data {
            // The cast makes 0 of NaN and of negative numbers.
            Some(ActionData::NumericValue(value)) => Some((value.round() as usize).min(most)),
            _ => None,
        });
        values.last()
    })
}

/// Shows the track; returns where it is. Without a session its place stays empty.
pub fn show(ui: &mut Ui, context: &TimeContext<'_>, commands: &mut Vec<Command>) -> Rect {
    let palette = context.palette;
    let height = if is_for_fingers(ui.ctx()) {
        COMPACT_HEIGHT
    } else {
        HEIGHT
    };

    // Some room stays free behind the track. The track is never shorter than 80 points: a window that is too narrow
    // cuts off its end.
    let size = vec2((ui.available_width() - 8.0).max(80.0), height);
    let (rect, response) = ui.allocate_exact_size(size, Sense::drag());
    let Some(session) = &context.run.session else {
        return rect;
    };

    let segments = segments_within(session, rect);
    let cursor = (context.run.cursor()).map_or(context.run.stage, |(cursor, _events)| cursor);
    let prefix = context.run.prefix();
    let name = ui.words(prefix.map_or("Moment", |_| "Samples shown"));
    response.widget_info(|| WidgetInfo::slider(ENABLED, cursor as f64, &name));
    response.known_as("moment");

    let dragged = response
        .interact_pointer_pos()
        .filter(|_| response.dragged());
    let asked = asked_for(
        ui,
        &response,
        segments.last().map_or(0, |last| last.events.end),
    );
    if let Some(target) = dragged.map(|pos| cursor_at(&segments, pos.x)).or(asked) {
        match context.run.cursor() {
            Some(_) => commands.push(Command::Time(TimeCommand::Jump(target))),
            // Without events there are only stages to go to.
            None => commands.push(Command::Time(TimeCommand::ShowStage(target))),
        }
    }

    let nested = session.nested.as_ref().zip(prefix);
    let current = nested.map_or(context.run.stage, |(nested, count)| {
        // The current level is that of the last sample shown. Samples are counted from 0.
        nested.level_of(count - 1)
    });
    for segment in &segments {
        let color = nested.map(|(nested, _)| palette.age(level_age(segment.index, nested)));
        show_segment(
            ui,
            palette,
            segment,
            segment.index == current,
            color,
            rect,
            commands,
        );
    }

    let painter = ui.painter_at(rect.expand(6.0));
    if let Some(recording) = session.recording() {
        density(&painter, recording, &segments, rect, palette);
    }
    // Marks lie over the density of events, and the cursor over both.
    marks(&painter, context, &segments, rect, palette);

    draw_cursor(&painter, x_of(&segments, cursor), rect, palette);
    rect
}

/// Draws the cursor at `x`: a line through the bars, with a tip above.
fn draw_cursor(painter: &Painter, x: f32, rect: Rect, palette: &Palette) {
    let ends = [pos2(x, rect.top() - 2.0), pos2(x, rect.top() + BAR + 4.0)];
    painter.line_segment(ends, Stroke::new(2.0, palette.halo));
    let tip = [vec2(-5.0, -4.0), vec2(5.0, -4.0), vec2(0.0, 4.0)].map(|v| ends[0] + v);
    painter.add(Shape::convex_polygon(
        tip.to_vec(),
        palette.halo,
        Stroke::NONE,
    ));
}

/// Draws the bar of a segment, with a swatch of `color` along its lower edge if there is one, and shows its label; a
/// click on the label goes to the end of the segment.
fn show_segment(
    ui: &Ui,
    palette: &Palette,
    segment: &Segment,
    is_current: bool,
    color: Option<Color32>,
    rect: Rect,
    commands: &mut Vec<Command>,
) {
    let names = segment.names.each_ref().map(|name| ui.words(name));
    // A point is left free at both ends, so that neighbouring bars stand apart.
    let bar = Rect::from_min_max(
        pos2(segment.left + 1.0, rect.top()),
        pos2(segment.right - 1.0, rect.top() + BAR),
    );

    let label = Rect::from_min_max(bar.left_bottom(), pos2(bar.right(), rect.bottom()));
    let fill = if is_current {
        palette.accent.gamma_multiply(0.24)
    } else {
        palette.line.gamma_multiply(0.8)
    };

    ui.painter().rect_filled(bar, 3.0, fill);
    if let Some(color) = color {
        let swatch = bar.with_min_y(bar.bottom() - SWATCH);
        ui.painter().rect_filled(swatch, 2.0, color);
    }

    // Only the label below the bar is clicked: on the bar the cursor is dragged.
    let response = ui.interact(
        label,
        ui.scope_id().with(("stage", segment.index)),
        Sense::click(),
    );
    response.widget_info(|| WidgetInfo::selected(Role::Button, ENABLED, is_current, &names[0]));
    response.known_as(format_args!("stage.{}", segment.key));

    let is_hot = response.hovered() || response.has_focus();
    let ink = if is_current || is_hot {
        palette.text
    } else {
        palette.muted
    };

    let laid = |text: &str| {
        let font = FontId::proportional(11.5);
        ui.painter().layout_no_wrap(text.to_owned(), font, ink)
    };

    // A name that does not fit is left out rather than cut off; the tooltip has it. Of the names, from long to short,
    // the first two leave a point free at each end of the bar, and the last may fill all of the segment.
    let rooms = [-2.0, -2.0, 2.0].map(|beyond| label.width() + beyond);
    let mut galleys = names.iter().map(|name| laid(name)).zip(rooms);
    let fitting = galleys.find(|(galley, room)| galley.size().x <= *room);
    if let Some((galley, _)) = fitting {
        let at = label.center_top() + vec2(-galley.size().x / 2.0, 4.0);
        ui.painter().galley(at, galley, ink);
    }

    if response
        .on_hover_cursor(CursorIcon::PointingHand)
        .on_hover_text(ui.words(&segment.tip))
        .clicked()
    {
        commands.push(Command::Time(TimeCommand::ShowStage(segment.index)));
    }
}

/// Draws the density of conflicts, gaps and insertions among all events.
fn density(
    painter: &Painter,
    recording: &Recording,
    segments: &[Segment],
    rect: Rect,
    palette: &Palette,
) {
    for segment in segments {
        // A column is two points wide, with a line in its middle. The bar of a segment leaves a point free at both of
        // its ends, and has one column at least.
        let columns = ((segment.right - segment.left - 2.0) / 2.0).max(1.0) as usize;
        let counts = tilescope_debugger::density(recording, segment.events.clone(), columns);

        for (column, count) in counts.iter().enumerate() {
            // A column without events has shares of 0.
            let total = count.total().max(1) as f32;
            let shares = [count.conflicts, count.gaps, count.insertions].map(|n| n as f32 / total);
            let x = segment.left + 2.0 + 2.0 * column as f32;
            let mut bottom = rect.top() + BAR - 1.0;
            for (share, color) in
                shares
                    .into_iter()
                    .zip([palette.conflict, palette.gap, palette.inserted])
            {
                // The three shares stand on each other. Small ones would be lost, as nothing below half a point is
                // drawn: the root raises them. So the three may be higher than the bar in all, and the last of them are
                // cut off there.
                let height = (share.sqrt() * (BAR - 3.0)).min(bottom - rect.top() - 1.0);
                if height >= 0.5 {
                    let ends = [pos2(x, bottom), pos2(x, bottom - height)];
                    painter.line_segment(ends, Stroke::new(1.6, color.gamma_multiply(0.85)));
                    bottom -= height;
                }
            }
        }
    }
}

/// Draws where breakpoints would stop a run.
fn hits(
    painter: &Painter,
    context: &TimeContext<'_>,
    segments: &[Segment],
    rect: Rect,
    palette: &Palette,
) {
    let mut last = f32::NEG_INFINITY;
    for &event in context.run.hits.events() {
        let x = x_of(segments, event);
        // Two marks within a point would look like one.
        if x - last >= 1.0 {
            last = x;
            let ends = [pos2(x, rect.top() - 1.0), pos2(x, rect.top() + 4.0)];
            painter.line_segment(ends, Stroke::new(1.6, palette.conflict));
        }
    }
}

/// Draws scenes, breakpoint hits and the loop.
fn marks(
    painter: &Painter,
    context: &TimeContext<'_>,
    segments: &[Segment],
    rect: Rect,
    palette: &Palette,
) {
    if let Some(range) = &context.time.playback.range {
        let ends = [range.start, range.end].map(|cursor| x_of(segments, cursor));
        let band = Rect::from_min_max(
            pos2(ends[0], rect.top() - 3.0),
            pos2(ends[1], rect.top() + BAR + 3.0),
        );
        painter.rect_filled(band, 2.0, palette.candidate.gamma_multiply(0.16));
        for x in ends {
            let line = [pos2(x, band.top()), pos2(x, band.bottom())];
            painter.line_segment(line, Stroke::new(1.5, palette.candidate));
        }
    }

    // Scenes and hits are places among events, which only a recorded run has.
    let Some(debugger) = &context.run.debugger else {
        return;
    };
    hits(painter, context, segments, rect, palette);

    for scene in &debugger.scenes {
        let marked = debugger.marked(scene);
        // A scene of another run may have no corresponding event in this one.
        let Some(cursor) = marked.cursor() else {
            continue;
        };
        // A scene of another run stands at the corresponding event, and is muted.
        let color = match marked {
            Marked::Here(_) => palette.accent,
            _ => palette.muted,
        };
        let at = pos2(x_of(segments, cursor), rect.top() + BAR + 2.0);
        let flag = [vec2(0.0, -5.0), vec2(4.0, 1.0), vec2(-4.0, 1.0)].map(|v| at + v);
        painter.add(Shape::convex_polygon(flag.to_vec(), color, Stroke::NONE));
    }
}

/// Returns the number at the end of a stage's name, or else its short name.
fn number(name: &str) -> String {
    let last = name.rsplit(' ').next();
    let digits = last.filter(|word| word.bytes().all(|byte| byte.is_ascii_digit()));
    digits.map_or_else(|| short(name), str::to_owned)
}

/// Returns the short name of a stage.
fn short(name: &str) -> String {
    let shorter = [
        ("Eliminate", "Elim."),
        ("Iterate", "It."),
        ("Pattern", "Patt."),
    ];
    shorter
        .into_iter()
        .fold(name.to_owned(), |name, (long, short)| {
            name.replace(long, short)
        })
}
