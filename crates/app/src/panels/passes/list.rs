//! The list of passes by stage: number, name, time, and a mark for the comparison with the CPU. Arrow keys move through
//! it while it has the focus. Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{
    Align2, Color32, CursorIcon, EventFilter, FontId, Id, Key, Pos2, Rect, Response, Role,
    ScrollArea, Sense, Stroke, StrokeKind, Ui, WidgetInfo, vec2,
};
use tilescope_drawing::palette::Palette;
use tilescope_session::words::{counted, stage_name};
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::{Known, verdict_mark};

use crate::ENABLED;
use tilescope_workbench::passes::model::{Badge, PassEntry, PassLine, duration_text};
use tilescope_workbench::passes::{PassCommand, Passes};

/// The height of a line, in screen points.
const LINE: f32 = 23.0;

/// Shows the list in all the room there is.
pub(super) fn show(
    ui: &mut Ui,
    passes: &Passes,
    palette: &Palette,
    commands: &mut Vec<PassCommand>,
) {
    let focus = frame(ui, passes, palette);
    if focus.has_focus() {
        keys(ui, focus.id, commands);
    }
    let seconds = passes.entries().iter().filter_map(|p| p.report.seconds);
    let longest = seconds.fold(0.0, f64::max);
    let selected = selected_line(passes);
    let selection_moved = has_moved(ui, focus.id, selected);

    ui.spacing_mut().item_spacing.y = 0.0;
    let area = ScrollArea::vertical().auto_shrink([false, false]);
    area.show_rows(ui, LINE, passes.lines().len(), |ui, range| {
        // A key or a button may have selected a pass that is out of view. The list scrolls to it once, when the
        // selection moves, so that a user may scroll on from there. All lines have one height: the place of the
        // selected line follows from that of the first line of `range`, which is at the top.
        if let Some(line) = selected.filter(|_| selection_moved) {
            let top = ui.max_rect().top() + (line as f32 - range.start as f32) * LINE;
            let size = vec2(ui.available_width(), LINE);
            let rect = Rect::from_min_size(Pos2::new(ui.max_rect().left(), top), size);
            // One line more on each side shows what comes before and after it.
            ui.scroll_to_rect(rect.expand2(vec2(0.0, LINE)), None);
        }
        for line in &passes.lines()[range] {
            match line {
                PassLine::Stage { .. } => stage(ui, line, palette),
                PassLine::Pass(index) => {
                    if row(ui, passes, *index, longest, palette).clicked() {
                        focus.request_focus();
                        commands.push(PassCommand::Select(*index));
                    }
                }
            }
        }
    });
}

/// Returns the response of the whole list, and draws a line around the list while it has the focus. The list takes the
/// focus as a whole, so that it is one stop in the Tab order.
fn frame(ui: &Ui, passes: &Passes, palette: &Palette) -> Response {
    let rect = ui.max_rect();
    let id = ui.scope_id().with("passes");
    let response = ui.interact(rect, id, Sense::focusable_noninteractive());
    // 0 says that no pass is selected.
    let number = passes.selected().map_or(0, |index| index + 1);
    let label = format!("Passes: {number} of {}, arrow keys", passes.entries().len());
    response.widget_info(|| WidgetInfo::labeled(Role::ListBox, ENABLED, &label));
    response.known_as("passes");
    if response.has_focus() {
        let stroke = Stroke::new(1.0, palette.accent);
        ui.painter()
            .rect_stroke(rect.shrink(0.5), 6.0, stroke, StrokeKind::Inside);
    }
    response
}

/// Takes the keys that choose a pass, while the list has the focus.
fn keys(ui: &Ui, id: Id, commands: &mut Vec<PassCommand>) {
    let filter = EventFilter {
        vertical_arrows: true,
        horizontal_arrows: true,
        ..EventFilter::default()
    };
    // Arrow keys would otherwise move the focus.
    ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
    ui.input_mut(|input| {
        for (key, command) in [
            (Key::ArrowUp, PassCommand::Previous),
            (Key::ArrowDown, PassCommand::Next),
            (Key::ArrowLeft, PassCommand::Previous),
            (Key::ArrowRight, PassCommand::Next),
            (Key::Home, PassCommand::First),
            (Key::End, PassCommand::Last),
        ] {
            // Consume the keys, so that no other widget reacts to them.
            if input.consume_key(egui::Modifiers::NONE, key) {
                commands.push(command);
            }
        }
    });
}

fn selected_line(passes: &Passes) -> Option<usize> {
    let selected = PassLine::Pass(passes.selected()?);
    passes.lines().iter().position(|line| *line == selected)
}

/// Returns whether the line of the selected pass is another one than in the previous frame; `true` in the first frame.
fn has_moved(ui: &Ui, id: Id, selected: Option<usize>) -> bool {
    let before = ui.data_mut(|data| {
        let before: Option<Option<usize>> = data.get_temp(id);
        data.insert_temp(id, selected);
        before
    });
    before != Some(selected)
}

/// Shows the heading of a stage: its name, and the time that its passes took.
fn stage(ui: &mut Ui, line: &PassLine, palette: &Palette) {
    // The lines of passes are shown by `row`.
    let PassLine::Stage {
        stage,
        passes,
        seconds,
    } = line
    else {
        return;
    };

    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::hover());
    let name = stage_name(*stage);
    let count = counted(*passes, "pass", "passes");
    let label = format!("{name}: {count}");
    response.widget_info(|| WidgetInfo::labeled(Role::Label, ENABLED, &label));

    let painter = ui.painter();
    let font = FontId::new(12.5, semibold());
    let left = rect.left_center() + vec2(8.0, 2.0);
    painter.text(left, Align2::LEFT_CENTER, name, font, palette.text);
    // Without measured times the number of passes stands in their place.
    let right = seconds.map_or(count, duration_text);
    let font = FontId::proportional(11.5);
    let at = rect.right_center() + vec2(-12.0, 2.0);
    painter.text(at, Align2::RIGHT_CENTER, right, font, palette.muted);
}

/// Shows the line of a pass; `longest` is the longest time of a pass, in seconds.
fn row(ui: &mut Ui, passes: &Passes, index: usize, longest: f64, palette: &Palette) -> Response {
    let pass = &passes.entries()[index];
    let is_current = passes.selected() == Some(index);
    let size = vec2(ui.available_width() - 6.0, LINE);
    let (rect, response) = ui.allocate_exact_size(size, Sense::CLICK);
    let text = pass.badge.text();
    let label = format!("Pass {}: {}, {text}", index + 1, pass.report.name);
    response.widget_info(|| WidgetInfo::selected(Role::ListBoxOption, ENABLED, is_current, &label));
    response.known_as(format_args!("pass-{}", index + 1));

    let painter = ui.painter();
    if is_current {
        painter.rect_filled(rect, 5.0, palette.accent.gamma_multiply(0.18));
    } else if response.hovered() {
        painter.rect_filled(rect, 5.0, palette.text.gamma_multiply(0.06));
    }

    time(ui, rect, pass, longest, palette);
    // Numbers end at 34 points, marks stand at 48, and names begin at 62, so that they form columns without lines.
    let left = rect.left_center();
    let number = FontId::monospace(11.0);
    let at = left + vec2(34.0, 0.0);
    let text = (index + 1).to_string();
    painter.text(at, Align2::RIGHT_CENTER, text, number, palette.muted);
    mark(ui, left + vec2(48.0, 0.0), &pass.badge, palette);
    let font = FontId::proportional(13.0);
    let at = left + vec2(62.0, 0.0);
    painter.text(
        at,
        Align2::LEFT_CENTER,
        pass.report.name,
        font,
        palette.text,
    );

    let response = response.on_hover_cursor(CursorIcon::PointingHand);
    match tilescope_gpu::passes::meaning(pass.report.name) {
        Some(meaning) => response.on_hover_text(meaning),
        None => response,
    }
}

/// Draws the time of a pass, and a bar as long as its share of the longest.
fn time(ui: &Ui, rect: Rect, pass: &PassEntry, longest: f64, palette: &Palette) {
    let Some(seconds) = pass.report.seconds else {
        return;
    };
    let painter = ui.painter();
    let right = rect.right() - 8.0;
    // The longest bar is about as wide as the text above it. Where all times are 0, there are no bars.
    if longest > 0.0 {
        let length = 62.0 * (seconds / longest) as f32;
        let min = Pos2::new(right - length, rect.bottom() - 4.0);
        let bar = Rect::from_min_max(min, Pos2::new(right, rect.bottom() - 2.0));
        painter.rect_filled(bar, 1.0, palette.accent.gamma_multiply(0.8));
    }

    // The text is moved up a little, to make room for the bar.
    let at = Pos2::new(right, rect.center().y - 1.0);
    let font = FontId::monospace(11.0);
    let text = duration_text(seconds);
    painter.text(at, Align2::RIGHT_CENTER, text, font, palette.muted);
}

/// Draws a check mark, a cross, or a small dot for passes within a stage.
pub(super) fn mark(ui: &Ui, at: Pos2, badge: &Badge, palette: &Palette) {
    match badge {
        Badge::Equal => verdict_mark(ui.painter(), at, true, palette.inserted),
        Badge::Differs(_) => verdict_mark(ui.painter(), at, false, palette.conflict),
        Badge::Intermediate => {
            ui.painter().circle_filled(at, 1.6, palette.muted);
        }
    }
}

/// Returns the colour of a badge's text.
pub(super) const fn color(badge: &Badge, palette: &Palette) -> Color32 {
    match badge {
        Badge::Equal => palette.inserted,
        Badge::Differs(_) => palette.conflict,
        Badge::Intermediate => palette.muted,
    }
}
