//! The pseudocode: the line that has run and the one that runs next, breakpoints in the gutter, and counts of
//! executions. A click on the gutter sets a breakpoint; a click on a line goes to its next execution. Sizes are in
//! screen points, and chosen, not measured, where no reason stands beside them.

use std::sync::Arc;

use egui::{
    Align2, Color32, CursorIcon, FontId, Rangef, Rect, RichText, Role, ScrollArea, Sense, Stroke,
    StrokeKind, Ui, WidgetInfo, pos2, vec2,
};
use tilescope_core::{Insertion, TilingMethod, Variant};
use tilescope_debugger::{
    Debugger, Direction, Event, LineId, Listing, ListingLine, Listings, Target,
};
use tilescope_drawing::palette::Palette;
use tilescope_session::glossary;
use tilescope_ui::focus;
use tilescope_ui::theme::{FINGER, is_for_fingers, row_height, semibold};
use tilescope_ui::widgets::Known;

use super::common::no_events;
use super::content::{Content, Room};
use super::context::PanelContext;
use crate::ENABLED;
use tilescope_workbench::command::{Command, DebugCommand, TimeCommand};
use tilescope_workbench::state::RunView;

/// Width of the strip of breakpoints left of the lines, in screen points, unless enlarged for fingers.
const GUTTER: f32 = 22.0;
/// Room for a remark behind a line.
const TAG: f32 = 28.0;

/// Returns the listings of the session's method and variant, in the order of its stages; none without a session.
fn listings_of(context: &PanelContext<'_>) -> Vec<&'static Listing> {
    let Some(session) = &context.run.session else {
        return Vec::new();
    };
    let parameters = &session.run().parameters;

    let names: &[&str] = match (parameters.method, parameters.variant, parameters.insertion) {
        // Exact tiling has neither variants nor ways of insertion, and the variant as printed has no ways of insertion.
        (TilingMethod::Exact, _, _) => &["blocks", "exact", "finish"],
        (TilingMethod::Kdrt, Variant::AsPrinted, _) => {
            &["blocks", "tile", "printed", "gaps", "finish"]
        }
        (TilingMethod::Kdrt, Variant::Staged, Insertion::Circumcentre) => {
            &["blocks", "tile", "eliminate", "detect", "insert", "finish"]
        }
        (TilingMethod::Kdrt, Variant::Staged, Insertion::Uniform) => {
            &["blocks", "tile", "eliminate", "darts", "finish"]
        }
    };

    // The program has a listing of each of these names; one that it lacked would be left out here.
    let all = &Listings::shipped().listings;
    names
        .iter()
        .filter_map(|name| all.iter().find(|listing| listing.name == *name))
        .collect()
}

/// The lines that are highlighted at a moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Now {
    /// The line of the last event, which sentence and canvas show.
    pub done: Option<LineId>,
    /// The line of the next event, where breakpoints stop.
    pub next: Option<LineId>,
}

impl Now {
    /// Returns the lines to highlight at the moment shown.
    pub fn of(context: &PanelContext<'_>, debugger: &Debugger) -> Self {
        let last = context.run.shown().and_then(|shown| shown.last_event());
        Self {
            done: last.map(Event::line),
            next: debugger.event().map(Event::line),
        }
    }

    /// Returns the line to keep in view: that of the last event; before the first event, the next line.
    fn leading(self) -> Option<LineId> {
        self.done.or(self.next)
    }

    /// Returns the remark on a line.
    pub fn tag(self, line: LineId) -> Option<&'static str> {
        match (self.done == Some(line), self.next == Some(line)) {
            (true, true) => Some("done, next"),
            (true, false) => Some("done"),
            (false, true) => Some("next"),
            (false, false) => None,
        }
    }
}

/// Where the lines of the listings were in a frame, in screen points from the top of the first one.
struct Placed {
    /// The lines, each with its upper and its lower end.
    lines: Vec<(LineId, Rangef)>,
    /// The height of all of them.
    height: f32,
    /// The part of it that was in view.
    view: Rangef,
}

impl Placed {
    /// Returns where a line was.
    fn line(&self, line: Option<LineId>) -> Option<Rangef> {
        let placed = self.lines.iter().find(|(id, _)| Some(*id) == line);
        placed.map(|(_, range)| *range)
    }

    /// Returns how far to scroll to have a line in the middle; `None` if it is about there, or was not laid out yet.
    fn scroll_to(&self, line: Option<LineId>) -> Option<f32> {
        let range = self.line(line)?;
        let (middle, size) = (range.center(), self.view.span());
        // Lines that take turns in a loop are near each other: the text stays while they are in the middle half.
        if (self.view.center() - middle).abs() <= 0.25 * size {
            return None;
        }
        let most = (self.height - size).max(0.0);
        Some((middle - 0.5 * size).clamp(0.0, most))
    }

    /// Returns whether the whole line was in view, or as much of it as fits.
    fn shows(&self, line: Option<LineId>) -> bool {
        let view = self.view.expand(1.0);
        let inside = |range: Rangef| range.min >= view.min && range.max <= view.max;
        let is_seen = |range: Rangef| inside(range) || range.span() > view.span();
        self.line(line).is_none_or(is_seen)
    }
}

/// What the panel keeps between frames.
#[derive(Clone)]
struct Seen {
    now: Now,
    placed: Arc<Placed>,
}

pub const CONTENT: Content = Content::of_run(Room::Whole, show);

/// Shows the panel. When the moment changes, its line is brought into the middle, unless it is about there. A user may
/// scroll on from there.
pub fn show(ui: &mut Ui, context: &PanelContext<'_>, commands: &mut Vec<Command>) {
    let Some(debugger) = &context.run.debugger else {
        no_events(ui, context);
        return;
    };
    let now = Now::of(context, debugger);
    let seen_id = ui.scope_id().with("seen");
    let seen: Option<Seen> = ui.data(|data| data.get_temp(seen_id));
    let has_moved = seen.as_ref().is_none_or(|seen| seen.now != now);

    let mut area = ScrollArea::vertical().auto_shrink([false, false]);
    // The lines are taken to be where they were in the frame before: their places in this frame are found only while
    // they are drawn, which is too late to scroll to one of them.
    let offset = seen.and_then(|seen| seen.placed.scroll_to(now.leading()));
    if let Some(offset) = offset.filter(|_| has_moved) {
        area = area.vertical_scroll_offset(offset);
    }
    let mut lines = Vec::new();
    let output = area.show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let top = ui.cursor().top();
        for listing in listings_of(context) {
            title(ui, listing);
            for number in listing.lines.clone() {
                let id = LineId(number);
                if let Some(line) = Listings::shipped().line(id) {
                    let numbered = NumberedLine { id, line };
                    let rect = show_line(ui, context, debugger, numbered, now, commands);
                    lines.push((id, Rangef::new(rect.top() - top, rect.bottom() - top)));
                }
            }
        }
        focus::follow(ui);
    });

    let start = output.state.clamped_offset().y;
    let placed = Placed {
        lines,
        height: output.content_size.y,
        view: Rangef::new(start, start + output.inner_rect.height()),
    };
    if has_moved && !placed.shows(now.leading()) {
        // The line was not laid out in the frame before, or the panel's width has changed since. The place of the line
        // is known now, so that the next frame can scroll to it. That frame scrolls only if its moment differs from the
        // stored one. A moment without lines is stored here, from which every moment with a line differs.
        let unseen = Now::default();
        remember(ui, seen_id, unseen, placed);
        ui.ctx().request_repaint();
    } else {
        remember(ui, seen_id, now, placed);
    }
}

fn remember(ui: &Ui, id: egui::Id, now: Now, placed: Placed) {
    let placed = Arc::new(placed);
    ui.data_mut(|data| data.insert_temp(id, Seen { now, placed }));
}

fn title(ui: &mut Ui, listing: &Listing) {
    ui.add_space(6.0);
    ui.label(RichText::new(&listing.title).font(FontId::new(12.5, semibold())));
    ui.add_space(2.0);
}

/// A line of a listing, and the number by which breakpoints and moments name it.
#[derive(Clone, Copy)]
struct NumberedLine<'a> {
    id: LineId,
    line: &'a ListingLine,
}

/// Shows a line of a listing with its breakpoint and its remark, and returns its rectangle.
fn show_line(
    ui: &mut Ui,
    context: &PanelContext<'_>,
    debugger: &Debugger,
    numbered: NumberedLine<'_>,
    now: Now,
    commands: &mut Vec<Command>,
) -> Rect {
    let NumberedLine { id, line } = numbered;
    let palette = context.palette;
    let tag = now.tag(id);

    let gutter_width = gutter_width(ui);
    let indent = gutter_width + 10.0 * line.indentation as f32;
    // Each line keeps the room for a remark, so that its text does not wrap anew when it has one. In a narrow panel 40
    // points, a chosen number, are left for the text.
    let width = (ui.available_width() - indent - 8.0 - TAG).max(40.0);
    // Lines that neither ran last nor run next are a little paler.
    let color = if tag.is_some() {
        palette.text
    } else {
        palette.text.gamma_multiply(0.82)
    };
    let session = context.run.session.as_ref();
    let words = session.map_or_else(String::new, |session| line.text(&session.run().parameters));
    let font = FontId::monospace(11.5);
    let galley = ui.painter().layout(words.clone(), font, color, width);

    let height = row_height(ui.ctx(), galley.size().y + 6.0);
    let size = vec2(ui.available_width() - 4.0, height);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let top = rect.center().y - galley.size().y / 2.0;
    let gutter = Rect::from_min_size(rect.min, vec2(gutter_width, rect.height()));
    let body = Rect::from_min_max(pos2(gutter.right(), rect.top()), rect.max);

    let is_current = now.done == Some(id);
    let response = ui.interact(body, ui.scope_id().with(("line", id.0)), Sense::click());
    let said = description(line, tag, &words);
    response.widget_info(|| WidgetInfo::selected(Role::Button, ENABLED, is_current, &said));
    response.known_as(format_args!("{}.line", line.id));

    // The current line has a tag as well.
    if tag.is_some() {
        highlight(ui, rect, is_current, palette);
    } else if response.hovered() || response.has_focus() {
        let fill = palette.text.gamma_multiply(0.06);
        ui.painter().rect_filled(body, 4.0, fill);
    }
    let at = pos2(rect.left() + indent, top);
    ui.painter().galley(at, galley, color);
    if let Some(tag) = tag {
        remark(ui, rect, tag, palette);
    }

    breakpoint(ui, debugger, numbered, gutter, palette, commands);

    let response = response
        .on_hover_cursor(CursorIcon::PointingHand)
        .on_hover_ui(|ui| {
            ui.label(explanation(line));
            terms(ui, &words, palette);
        });
    if response.clicked() {
        let run_to = TimeCommand::RunTo(Target::Line(id), Direction::Forwards);
        commands.push(Command::Time(run_to));
    }
    rect
}

/// Returns the width of the column of breakpoints.
fn gutter_width(ui: &Ui) -> f32 {
    if is_for_fingers(ui.ctx()) {
        FINGER - 4.0
    } else {
        GUTTER
    }
}

/// Returns the description of a line for screen readers.
fn description(line: &ListingLine, tag: Option<&str>, words: &str) -> String {
    match tag {
        Some(tag) => format!("Line {}, {tag}: {words}", line.id),
        None => format!("Line {}: {words}", line.id),
    }
}

/// Writes the remark on a line at its end.
fn remark(ui: &Ui, rect: Rect, tag: &str, palette: &Palette) {
    let at = rect.right_center() - vec2(4.0, 0.0);
    let font = FontId::proportional(10.0);
    // The room behind a line has the width of one word.
    let lines = tag.replace(", ", "\n");
    let painter = ui.painter();
    painter.text(at, Align2::RIGHT_CENTER, lines, font, palette.accent);
}

/// Draws the mark of the line of the last event, or otherwise of the next one.
fn highlight(ui: &Ui, rect: Rect, is_current: bool, palette: &Palette) {
    let painter = ui.painter();
    if is_current {
        painter.rect_filled(rect, 4.0, palette.accent.gamma_multiply(0.2));
        let ends = [
            rect.left_top() + vec2(1.0, 2.0),
            rect.left_bottom() + vec2(1.0, -2.0),
        ];
        painter.line_segment(ends, Stroke::new(2.5, palette.accent));
    } else {
        let stroke = Stroke::new(1.0, palette.accent);
        painter.rect_stroke(rect, 4.0, stroke, StrokeKind::Inside);
    }
}

/// Shows the breakpoint of a line in the gutter; a click sets or removes it.
fn breakpoint(
    ui: &mut Ui,
    debugger: &Debugger,
    NumberedLine { id, line }: NumberedLine<'_>,
    gutter: Rect,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let set = debugger.breakpoints().iter().find(|b| b.line == id);
    let response = ui.interact(gutter, ui.scope_id().with(("gutter", id.0)), Sense::click());
    let name = format!("Breakpoint on line {}", line.id);
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, ENABLED, set.is_some(), &name));
    response.known_as(format_args!("{}.breakpoint", line.id));

    let at = gutter.center();
    let painter = ui.painter();
    match set {
        Some(breakpoint) => {
            // A breakpoint that is switched off is an empty ring.
            let fill = if breakpoint.enabled {
                palette.conflict
            } else {
                Color32::TRANSPARENT
            };
            painter.circle(at, 5.0, fill, Stroke::new(1.5, palette.conflict));
            // A breakpoint with a condition has a question mark, since it does not always stop.
            if !breakpoint.condition.is_empty() {
                let ink = if breakpoint.enabled {
                    palette.panel
                } else {
                    palette.conflict
                };
                painter.text(
                    at,
                    egui::Align2::CENTER_CENTER,
                    "?",
                    FontId::monospace(9.0),
                    ink,
                );
            }
        }
        // A muted ring says that a click would set a breakpoint.
        None if response.hovered() || response.has_focus() => {
            painter.circle_stroke(at, 5.0, Stroke::new(1.2, palette.muted));
        }
        None => {}
    }

    if response
        .on_hover_cursor(CursorIcon::PointingHand)
        .on_hover_text(name)
        .clicked()
    {
        commands.push(Command::Debug(DebugCommand::ToggleBreakpoint(id)));
    }
}

fn explanation(line: &ListingLine) -> String {
    match &line.erratum {
        Some(erratum) => format!("{}\n\nErratum: {erratum}", line.explanation),
        None => line.explanation.clone(),
    }
}

/// Explains the terms in a line.
fn terms(ui: &mut Ui, words: &str, palette: &Palette) {
    for term in glossary::terms_in(words) {
        ui.add_space(4.0);
        ui.label(RichText::new(term.name).small().color(palette.accent));
        ui.label(RichText::new(term.meaning).small());
    }
}

/// Returns the text of the next line to run, or after the last event what comes instead. `None` for a session without
/// events, without a session, and for a line that the listings lack.
pub fn next_line(run: &RunView) -> Option<String> {
    let debugger = run.debugger.as_ref()?;
    let parameters = run.session.as_ref()?.run().parameters;
    let Some(event) = debugger.event() else {
        // A lesson cuts the run off where its question begins, so that the next line is not given away.
        let cursor = debugger.state().cursor();
        let is_cut_off = run
            .session
            .as_ref()
            .is_some_and(|session| session.is_cut_off_at(cursor));
        let text = if is_cut_off {
            "the question of the lesson"
        } else {
            "nothing: the run is complete"
        };
        return Some(text.to_owned());
    };
    let line = Listings::shipped().line(event.line())?;
    Some(line.text(&parameters))
}
