//! The run as a curve: a number of the catalogue over the events, above the track of the timeline and as wide as that.
//! Hovering shows the value of a moment, a click goes there; the number and the height can be chosen. Sizes are in
//! screen points, and chosen, not measured, where no reason stands beside them.

use egui::{
    Align2, Button, ComboBox, CursorIcon, FontId, Id, Painter, Pos2, Rect, Response, RichText,
    Role, Sense, Stroke, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};
use tilescope_analysis::measures::SetNumber;
use tilescope_drawing::palette::Palette;
use tilescope_session::session::Session;
use tilescope_session::words::{capital, grouped};
use tilescope_ui::language::Worded;
use tilescope_ui::widgets::{Known, heading};

use super::context::TimeContext;
use super::track::{self, Segment};
use crate::ENABLED;
use tilescope_workbench::command::{AppearanceCommand, Command, TimeCommand};
use tilescope_workbench::curve::{CurveFormat, CurveNumber, CurvePoints};
use tilescope_workbench::files::FileCommand;

/// The gap between the curve and the controls below it, in screen points.
const APART: f32 = 6.0;
/// The height of the border that changes the curve's height.
const BORDER: f32 = 6.0;
/// The least width beside the curve in which the number is chosen.
const MIN_BESIDE: f32 = 150.0;

/// Returns the height of the curve with the gap below it; 0 if no number is chosen.
pub fn height(context: &TimeContext<'_>) -> f32 {
    let curve = context.curve;
    curve
        .number
        .map_or(0.0, |_| f32::from(curve.height) + APART)
}

/// Shows the curve in `room`, above a track that is at `track`; nothing while no number is chosen or there is no
/// session.
pub fn show(
    ui: &mut Ui,
    context: &TimeContext<'_>,
    room: Rect,
    track: Rect,
    commands: &mut Vec<Command>,
) {
    let (Some(number), Some(session)) = (number_of(context), &context.run.session) else {
        return;
    };

    let bordered = Rect::from_x_y_ranges(track.x_range(), room.top()..=room.bottom() - APART);
    // The chooser ends 14 points before the chart, as the controls below it do before the track.
    let beside = Rect::from_x_y_ranges(room.left()..=bordered.left() - 14.0, bordered.y_range());
    // Where the chooser does not fit, the actions of the View menu choose the number.
    if beside.width() >= MIN_BESIDE {
        let mut side = ui.new_child(UiBuilder::new().max_rect(beside));
        chooser(&mut side, context, commands);
    }

    border(ui, context, bordered, commands);
    let chart = bordered.with_min_y(bordered.top() + BORDER);
    // The events of the curve stand above those of the track.
    let segments = track::segments_within(session, track);
    chart_of(ui, context, session, number, &segments, chart, commands);
}

/// Shows the curve where it has the width to itself, as in the panel of a small window: the choice of its number, and the chart
/// below. The track of such a window has no room above it that the canvas does not need.
pub fn show_alone(ui: &mut Ui, context: &TimeContext<'_>, commands: &mut Vec<Command>) {
    let Some(session) = &context.run.session else {
        return;
    };
    heading(ui, "Curve of the run");
    chooser(ui, context, commands);
    if let Some(number) = number_of(context) {
        let room = vec2(ui.available_width(), f32::from(context.curve.height));
        let (chart, _) = ui.allocate_exact_size(room, Sense::hover());
        let segments = track::segments_within(session, chart);
        chart_of(ui, context, session, number, &segments, chart, commands);
    }
}

/// Returns the number of the curve with the unit that it has in this run. One that the run does not have stays as it was chosen, and
/// in the place of its curve stands why.
fn number_of(context: &TimeContext<'_>) -> Option<CurveNumber> {
    let number = context.curve.number?;
    let session = context.run.session.as_deref();
    number.of_run(session).or(Some(number))
}

/// Shows the chart, or why there is none yet.
fn chart_of(
    ui: &mut Ui,
    context: &TimeContext<'_>,
    session: &Session,
    number: CurveNumber,
    segments: &[Segment],
    rect: Rect,
    commands: &mut Vec<Command>,
) {
    let Some(points) = context.run.curve.points() else {
        return unknown(ui, context, rect);
    };
    let frame = CurveFrame {
        points,
        number: number.row(),
        segments,
        rect,
        range: ends(points),
    };
    frame.show(ui, context, session, commands);
}

/// Shows the choice of the number, its value at the moment, and the buttons that save and hide the curve.
fn chooser(ui: &mut Ui, context: &TimeContext<'_>, commands: &mut Vec<Command>) {
    let number = number_of(context);
    let named = |number: Option<CurveNumber>| {
        number.map_or_else(
            || "No curve".to_owned(),
            |number| capital(number.row().name),
        )
    };

    let combo = ComboBox::from_id_salt("curve").width(ui.available_width().min(230.0));
    let selected = ui.words(named(number));
    let shown = combo.selected_text(selected).show_ui(ui, |ui| {
        // A number that runs of this kind do not have is left out. Some numbers have another meaning in space:
        // `of_run` gives each number with its meaning in this run.
        let session = context.run.session.as_deref();
        let of_run = CurveNumber::all().filter_map(|number| number.of_run(session));
        for other in [None].into_iter().chain(of_run.map(Some)) {
            let row = ui.selectable_label(other == number, ui.words(named(other)));
            row.known_as(format_args!(
                "curve.{}",
                other.map_or("none", CurveNumber::key)
            ));
            let meaning = other.map_or("", |other| other.row().meaning);
            if row.on_hover_text(ui.words(meaning)).clicked() {
                commands.push(Command::Appearance(AppearanceCommand::Curve(other)));
            }
        }
    });

    let response = shown.response;
    let name = ui.words("Number of the curve");
    response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, ENABLED, &name));
    response.known_as("curve.number");
    let Some(number) = number else {
        return;
    };

    ui.horizontal_wrapped(|ui| {
        let points = context.run.curve.points();
        ui.label(RichText::new(ui.words("Save as")).small());
        for format in CurveFormat::ALL {
            let button = Button::new(format.name()).small();
            // Before the curve is made there is nothing to save.
            let save = ui.add_enabled(points.is_some(), button);
            let id = format_args!("curve.save-{}", format.extension());
            save.issues(id, Command::File(FileCommand::SaveCurve(format)), commands);
        }
        let command = Command::Appearance(AppearanceCommand::Curve(None));
        ui.add(Button::new(ui.words("Hide")).small())
            .issues("curve.hide", command, commands);

        let now = points.zip(context.run.cursor());
        let value = now.map(|(points, (cursor, _))| value_of(points, number.row(), cursor));
        let text = RichText::new(ui.words(value.unwrap_or_default())).monospace();
        ui.label(text.color(context.palette.muted))
            .known_as("curve.value");
    });
}

/// Lets the upper border of the curve be dragged, which changes the height. `bordered` is the room of the chart with
/// its border.
fn border(ui: &Ui, context: &TimeContext<'_>, bordered: Rect, commands: &mut Vec<Command>) {
    let strip = bordered.with_max_y(bordered.top() + BORDER);
    let response = ui.interact(strip, Id::unique("border of the curve"), Sense::drag());
    let name = ui.words("Height of the curve");
    response.widget_info(|| WidgetInfo::labeled(Role::Splitter, ENABLED, &name));
    response.known_as("curve.height");

    if let Some(pointer) = response.interact_pointer_pos()
        && response.dragged()
    {
        // Within the range of `u16` the cast drops nothing but the fraction.
        let height = (bordered.bottom() - pointer.y).clamp(0.0, f32::from(u16::MAX)) as u16;
        commands.push(Command::Appearance(AppearanceCommand::CurveHeight(height)));
    }

    let is_hot = response.hovered() || response.dragged();
    response.on_hover_cursor(CursorIcon::ResizeVertical);
    let color = if is_hot {
        context.palette.accent
    } else {
        context.palette.line
    };
    let stroke = Stroke::new(1.0, color);
    ui.painter()
        .hline(strip.x_range(), strip.center().y, stroke);
}

/// Shows how far the curve is made, or why there is none.
fn unknown(ui: &mut Ui, context: &TimeContext<'_>, chart: Rect) {
    let curve = &context.run.curve;
    let percent = 100.0 * curve.progress().unwrap_or_default();
    let words = match curve.failure() {
        Some(why) => why.to_owned(),
        None => format!("The curve is being made: {percent:.0}%"),
    };
    let text = RichText::new(ui.words(words)).color(context.palette.muted);
    ui.put(chart, egui::Label::new(text).wrap())
        .known_as("curve.status");
}

/// Returns the ends of the vertical axis. They differ even if all values are equal.
fn ends(points: &CurvePoints) -> [f64; 2] {
    let [low, high] = points.range().unwrap_or([0.0, 1.0]);
    if high > low {
        [low, high]
    } else {
        [low - 0.5, high + 0.5]
    }
}

/// Returns a value as the table of numbers has it, with its unit.
fn written(number: &SetNumber, value: f64) -> String {
    let text = match number.decimals {
        _ if !value.is_finite() => "none".to_owned(),
        0 => grouped(value as usize),
        decimals => format!("{value:.decimals$}"),
    };
    [&*text, number.unit].join(" ").trim_end().to_owned()
}

/// Returns the value at a cursor, in words.
fn value_of(points: &CurvePoints, number: &SetNumber, cursor: usize) -> String {
    written(number, points.values[points.at(cursor)])
}

/// A curve and its rectangle.
struct CurveFrame<'a> {
    points: &'a CurvePoints,
    number: &'static SetNumber,
    segments: &'a [Segment],
    rect: Rect,
    range: [f64; 2],
}

impl CurveFrame<'_> {
    /// Shows the chart; a click or a drag goes to a moment.
    fn show(
        &self,
        ui: &Ui,
        context: &TimeContext<'_>,
        session: &Session,
        commands: &mut Vec<Command>,
    ) {
        let palette = context.palette;
        // A curve has no text: screen readers read a table of its values instead.
        self.table(ui, session);
        let id = Id::unique("curve of the run");
        let response = ui.interact(self.rect, id, Sense::CLICK | Sense::DRAG);
        let description = ui.words(self.description());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, ENABLED, &description));
        response.known_as("curve.chart");

        let painter = ui.painter_at(self.rect);
        self.ground(ui, &painter, palette);
        self.line(&painter, palette);
        if let Some((cursor, _)) = context.run.cursor() {
            self.mark(&painter, cursor, palette);
        }

        let pointer = response.interact_pointer_pos();
        let is_chosen = response.clicked() || response.dragged();
        if let Some(at) = pointer.filter(|_| is_chosen) {
            let cursor = track::cursor_at(self.segments, at.x);
            commands.push(Command::Time(TimeCommand::Jump(cursor)));
        }
        self.hover(ui, response, session);
    }

    /// Shows the value under the pointer.
    fn hover(&self, ui: &Ui, response: Response, session: &Session) {
        let Some(at) = response.hover_pos() else {
            return;
        };
        let cursor = track::cursor_at(self.segments, at.x);
        let stage = session.stages[session.stage_at(cursor)];
        let name = tilescope_session::sentence::name_in(session, stage);
        let value = value_of(self.points, self.number, cursor);
        let text = format!(
            "{}: {}\n{}, {}",
            ui.words(self.number.name),
            ui.words(value),
            ui.words(format!("event {}", grouped(cursor))),
            ui.words(name)
        );
        response
            .on_hover_cursor(CursorIcon::PointingHand)
            .on_hover_text_at_pointer(RichText::new(text).monospace());
    }

    /// Gives screen readers the values at the start and the end of each stage, in a row for each.
    fn table(&self, ui: &Ui, session: &Session) {
        let value_at = |cursor: usize| value_of(self.points, self.number, cursor);
        for (index, segment) in self.segments.iter().enumerate() {
            let rect = Rect::from_x_y_ranges(segment.left..=segment.right, self.rect.y_range());
            let row = ui.interact(
                rect,
                Id::unique(("row of the curve", index)),
                Sense::hover(),
            );

            // In a nested set each segment is a level. Levels have a number and no name.
            let events = &segment.events;
            let name = match session.nested {
                Some(_) => format!("Level {index}"),
                None => tilescope_session::sentence::name_in(session, session.stages[index]),
            };
            let text = ui.words(format!(
                "{name}: {} {} at its start, {} at its end, event {}",
                self.number.name,
                value_at(events.start),
                value_at(events.end),
                grouped(events.end)
            ));
            row.widget_info(|| WidgetInfo::labeled(Role::Row, ENABLED, &text));
            row.known_as(format_args!("curve.row-{index}"));
        }
    }

    /// Returns a description of the curve for screen readers.
    fn description(&self) -> String {
        let name = self.number.name;
        let values = self.points.values.iter().enumerate();
        let defined = values.filter(|(_, value)| value.is_finite());
        match defined.max_by(|a, b| a.1.total_cmp(b.1)) {
            Some((index, value)) => format!(
                "Curve: {name} over the events. Highest: {} at event {}.",
                written(self.number, *value),
                grouped(self.points.events[index])
            ),
            None => format!("Curve: {name} over the events. It is not defined in this run."),
        }
    }

    fn y_of(&self, value: f64) -> f32 {
        let [low, high] = self.range;
        let part = ((value - low) / (high - low)) as f32;
        // Three points at the top and at the bottom leave room for the width of the line.
        self.rect.bottom() - 3.0 - part * (self.rect.height() - 6.0)
    }

    /// Draws the stages and the ends of the axis.
    fn ground(&self, ui: &Ui, painter: &Painter, palette: &Palette) {
        painter.rect_filled(self.rect, 2.0, palette.domain);
        let stroke = Stroke::new(1.0, palette.line);
        for segment in self.segments {
            painter.vline(segment.right, self.rect.y_range(), stroke);
        }

        let font = FontId::monospace(10.0);
        let [low, high] = (self.range).map(|value| ui.words(written(self.number, value)));
        for (at, align, text) in [
            (self.rect.left_top(), Align2::LEFT_TOP, high),
            (self.rect.left_bottom(), Align2::LEFT_BOTTOM, low),
        ] {
            let at = at + vec2(4.0, 0.0);
            painter.text(at, align, text, font.clone(), palette.muted);
        }
    }

    /// Draws the curve: in each column of pixels from the least to the largest value there, so that no peak is lost.
    fn line(&self, painter: &Painter, palette: &Palette) {
        // Every session has a stage, and so a segment.
        let (left, right) = (self.segments[0].left, self.rect.right());
        let mut line: Vec<Pos2> = Vec::new();
        let mut first = 0;
        let mut x = left;

        while x < right {
            // The column ends where the next pixel begins.
            let last = self.points.at(track::cursor_at(self.segments, x + 1.0));
            let values = &self.points.values[first..=last];
            // Events at which the number is not defined are skipped, and the line joins those around them.
            let defined = values.iter().copied().filter(|value| value.is_finite());
            let [low, high] = defined.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], value| {
                [a.min(value), b.max(value)]
            });
            if low <= high {
                // The next column begins with this column's last value, so that the line ends there. Where that is not
                // defined, the largest value is the end; any other of the column would do.
                let last_value = values[values.len() - 1];
                let end = if last_value.is_finite() {
                    last_value
                } else {
                    high
                };
                let drawn = if low < high {
                    &[low, high, end][..]
                } else {
                    &[end][..]
                };
                line.extend(drawn.iter().map(|value| pos2(x, self.y_of(*value))));
            }
            (first, x) = (last, x + 1.0);
        }

        painter.line(line, Stroke::new(1.4, palette.accent));
    }

    /// Marks the moment on the curve.
    fn mark(&self, painter: &Painter, cursor: usize, palette: &Palette) {
        let x = track::x_of(self.segments, cursor);
        let stroke = Stroke::new(1.0, palette.halo);
        painter.vline(x, self.rect.y_range(), stroke);
        let value = self.points.values[self.points.at(cursor)];
        if value.is_finite() {
            painter.circle_filled(pos2(x, self.y_of(value)), 3.0, palette.halo);
        }
    }
}
