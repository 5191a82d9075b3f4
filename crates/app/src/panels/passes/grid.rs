//! A table of a buffer's rows. Only visible rows are laid out. Changed rows have a bar and a background, changed cells
//! the accent colour. Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{
    Align2, FontId, Pos2, Rangef, Rect, Response, Role, ScrollArea, Sense, Stroke, StrokeKind,
    TextStyle, Ui, Vec2, WidgetInfo, vec2,
};
use tilescope_drawing::palette::Palette;
use tilescope_ui::table::{SpokenCell, spoken_row, table as spoken};
use tilescope_ui::widgets::Known;

use crate::ENABLED;
use tilescope_workbench::passes::PassCommand;
use tilescope_workbench::passes::shown::ShownBuffer;
use tilescope_workbench::passes::table::{BufferTable, PassSide};

/// The height of a row, in screen points.
const ROW: f32 = 20.0;

/// The room between two columns.
const GAP: f32 = 18.0;

/// Shows the rows in all the room there is.
pub(super) fn show(
    ui: &mut Ui,
    table: &BufferTable,
    shown: &ShownBuffer,
    palette: &Palette,
    commands: &mut Vec<PassCommand>,
) {
    // A buffer of one row has a line for each of its fields instead: its name, and its value before and after the pass.
    if table.total == 1 {
        let size = [table.columns.len() + 1, 3];
        return spoken(ui, "Fields of the buffer", size, Role::Table, |ui| {
            fields(ui, table, palette);
        });
    }

    // The heads are a row too, and the numbers of the rows a column.
    let size = [shown.rows().len() + 1, table.columns.len() + 1];
    spoken(ui, "Rows of the buffer", size, Role::Grid, |ui| {
        rows(ui, table, shown, palette, commands);
    });
}

/// Shows the heads, and below them the rows, which scroll.
fn rows(
    ui: &mut Ui,
    table: &BufferTable,
    shown: &ShownBuffer,
    palette: &Palette,
    commands: &mut Vec<PassCommand>,
) {
    let columns = ColumnEnds::of(ui, table, shown);
    let (head, of_heads) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let names = std::iter::once("row").chain(table.columns.iter().map(String::as_str));
    speak(ui, &of_heads, 0, Role::ColumnHeader, &columns, names);
    ui.spacing_mut().item_spacing.y = 0.0;
    let area = ScrollArea::both().auto_shrink([false, false]);
    let rows = shown.rows();

    let mut pointed = None;
    let output = area.show_rows(ui, ROW, rows.len(), |ui, range| {
        // A row can be clicked over the whole width of the panel.
        let width = columns.width.max(ui.available_width());
        for at in range {
            let number = rows[at];
            let size = vec2(width, ROW);
            let response = row(ui, table, number, shown, &columns, size, palette);
            let cells = (0..table.columns.len()).map(|column| {
                // A cell is read as it is drawn, on the side that is shown.
                table.cell(shown.side(), number as usize, column)
            });
            let texts = std::iter::once(number.to_string()).chain(cells);
            // The heads are the first row.
            speak(ui, &response, at + 1, Role::RowHeader, &columns, texts);
            if response.hovered() {
                pointed = Some(number);
            }
            if response.clicked() {
                let is_picked = shown.picked() == Some(number);
                commands.push(PassCommand::PickRow((!is_picked).then_some(number)));
            }
        }
    });

    // The canvas marks the row that is under the pointer here.
    if pointed != shown.pointed() {
        commands.push(PassCommand::PointRow(pointed));
    }

    // The header is drawn last, since it follows the rows sideways, and only now it is known how far they are scrolled.
    header(
        ui,
        head,
        table,
        &columns,
        output.state.clamped_offset().x,
        palette,
    );
}

/// Right edges of the columns: numbers are right-aligned.
struct ColumnEnds {
    ends: Vec<f32>,
    width: f32,
}

impl ColumnEnds {
    /// Returns where the columns of a table end.
    fn of(ui: &Ui, table: &BufferTable, shown: &ShownBuffer) -> Self {
        let font = TextStyle::Monospace.resolve(ui.style());
        let zero = ui
            .painter()
            .layout_no_wrap("0".to_owned(), font, any_color());
        let character = zero.size().x;
        // The head above the numbers has three letters.
        let digits = table.rows().to_string().len().max(3);
        let mut end = 10.0 + digits as f32 * character;
        let mut ends = vec![end];
        for &width in shown.widths() {
            end += GAP + width as f32 * character;
            ends.push(end);
        }
        Self {
            ends,
            width: end + GAP,
        }
    }
}

/// Gives a drawn row to screen readers as row `index` of the table. Its first cell has the role `first`. If that is a head of a
/// column, the other cells are such heads, too; otherwise they are plain cells.
fn speak<T: Into<String>>(
    ui: &mut Ui,
    row: &Response,
    index: usize,
    first: Role,
    columns: &ColumnEnds,
    texts: impl Iterator<Item = T>,
) {
    let rest = match first {
        Role::ColumnHeader => Role::ColumnHeader,
        _ => Role::Cell,
    };
    let left = row.rect.left();
    let ends = &columns.ends;
    let cells = texts.zip(ends).enumerate().map(|(column, (text, &end))| {
        let begin = column.checked_sub(1).map_or(0.0, |before| ends[before]);
        let role = if column == 0 { first } else { rest };
        SpokenCell::new(role, text, Rangef::new(left + begin, left + end))
    });
    spoken_row(ui, row, index, cells);
}

/// Laying out text needs a colour; this one is never drawn.
const fn any_color() -> egui::Color32 {
    egui::Color32::TRANSPARENT
}

/// Draws the names of the columns, moved to the left by `offset` as the rows are.
fn header(
    ui: &Ui,
    rect: Rect,
    table: &BufferTable,
    columns: &ColumnEnds,
    offset: f32,
    palette: &Palette,
) {
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    let names = std::iter::once("row").chain(table.columns.iter().map(String::as_str));
    for (name, end) in names.zip(&columns.ends) {
        // The heads follow the rows sideways, and stay when these are scrolled down.
        let at = Pos2::new(rect.left() + end - offset, rect.center().y);
        let font = FontId::monospace(11.5);
        painter.text(at, Align2::RIGHT_CENTER, name, font, palette.muted);
    }
    let line = Stroke::new(1.0, palette.line);
    painter.hline(rect.x_range(), rect.bottom() - 0.5, line);
}

/// Shows a row of the table.
fn row(
    ui: &mut Ui,
    table: &BufferTable,
    number: u32,
    shown: &ShownBuffer,
    columns: &ColumnEnds,
    size: Vec2,
    palette: &Palette,
) -> Response {
    let (rect, response) = ui.allocate_exact_size(size, Sense::CLICK);
    let is_picked = shown.picked() == Some(number);
    let number = number as usize;
    let is_changed = table.is_changed(number);
    response
        .widget_info(|| WidgetInfo::selected(Role::Row, ENABLED, is_picked, label(table, number)));
    response.known_as(format_args!("row-{number}"));

    if is_changed {
        mark_changed(ui, rect, palette);
    }
    if is_picked {
        let stroke = Stroke::new(1.5, palette.accent);
        ui.painter()
            .rect_stroke(rect.shrink(1.0), 2.0, stroke, StrokeKind::Inside);
    }

    let font = TextStyle::Monospace.resolve(ui.style());
    let painter = ui.painter();
    let at = |end: f32| Pos2::new(rect.left() + end, rect.center().y);
    // The first of the ends is that of the row's number, which is no column of the table.
    let text = number.to_string();
    let small = FontId::monospace(11.0);
    painter.text(
        at(columns.ends[0]),
        Align2::RIGHT_CENTER,
        text,
        small,
        palette.muted,
    );

    // A cell is marked by what the pass did to it, whichever side is shown.
    let (before, after) = (table.before(number), table.after(number));
    for (column, &end) in columns.ends[1..].iter().enumerate() {
        let has_changed = before.get(column) != after.get(column);
        let color = if has_changed {
            palette.accent
        } else {
            palette.text
        };
        let text = table.cell(shown.side(), number, column);
        painter.text(at(end), Align2::RIGHT_CENTER, text, font.clone(), color);
    }
    response
}

/// Draws the background and the bar of a row or line that the pass changed.
fn mark_changed(ui: &Ui, rect: Rect, palette: &Palette) {
    let painter = ui.painter();
    painter.rect_filled(rect, 0.0, palette.accent.gamma_multiply(0.10));
    let bar = Rect::from_min_size(rect.min, vec2(3.0, rect.height()));
    painter.rect_filled(bar, 0.0, palette.accent);
}

/// Returns a row's text for screen readers.
fn label(table: &BufferTable, number: usize) -> String {
    let mut text = format!("Row {number}");
    if table.is_changed(number) {
        text.push_str(", changed");
    }
    for (column, name) in table.columns.iter().enumerate() {
        text.push_str(", ");
        text.push_str(name);
        text.push(' ');
        text.push_str(&table.cell(PassSide::Both, number, column));
    }
    text
}

/// Shows a buffer of one row: a line for each column, with both sides.
fn fields(ui: &mut Ui, table: &BufferTable, palette: &Palette) {
    let (rect, of_heads) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let sides = [PassSide::Before, PassSide::After].map(PassSide::name);
    speak_field(ui, &of_heads, 0, ["field", sides[0], sides[1]]);
    let painter = ui.painter();
    // The heads stand at the same places as the texts of `field`.
    let ends = field_ends(rect);
    let small = FontId::monospace(11.5);
    let head = |x, align, text| {
        let at = Pos2::new(rect.left() + x, rect.center().y);
        painter.text(at, align, text, small.clone(), palette.muted);
    };
    head(10.0, Align2::LEFT_CENTER, "field");
    head(ends[0], Align2::RIGHT_CENTER, PassSide::Before.name());
    head(ends[1], Align2::RIGHT_CENTER, PassSide::After.name());
    let line = Stroke::new(1.0, palette.line);
    painter.hline(rect.x_range(), rect.bottom() - 0.5, line);

    ui.spacing_mut().item_spacing.y = 0.0;
    let area = ScrollArea::vertical().auto_shrink([false, false]);
    area.show_rows(ui, ROW, table.columns.len(), |ui, range| {
        for column in range {
            field(ui, table, column, palette);
        }
    });
}

/// Gives a drawn line to screen readers as row `index` of the table: a name and two values, or, in row 0, the heads of these.
fn speak_field(ui: &mut Ui, line: &Response, index: usize, texts: [&str; 3]) {
    let left = line.rect.left();
    let ends = field_ends(line.rect);
    // The name begins at the left, and the first value ends at `ends[0]`. Nothing shows where one cell ends and the other begins,
    // so that each gets half.
    let from = [0.0, ends[0] / 2.0, ends[0]];
    let to = [ends[0] / 2.0, ends[0], ends[1]];
    let roles = match index {
        0 => [Role::ColumnHeader; 3],
        _ => [Role::RowHeader, Role::Cell, Role::Cell],
    };
    let cells = [0, 1, 2].map(|column| {
        let across = Rangef::new(left + from[column], left + to[column]);
        SpokenCell::new(roles[column], texts[column], across)
    });
    spoken_row(ui, line, index, cells);
}

/// Returns where the values of both sides end.
fn field_ends(rect: Rect) -> [f32; 2] {
    [260.0_f32, 390.0].map(|end| end.min(rect.width() - 20.0))
}

/// Shows a line with the name of a column and its value before and after the pass.
fn field(ui: &mut Ui, table: &BufferTable, column: usize, palette: &Palette) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let name = &table.columns[column];
    let label = format!("Field {name}: {}", table.cell(PassSide::Both, 0, column));
    response.widget_info(|| WidgetInfo::labeled(Role::Row, ENABLED, &label));
    let [before, after] =
        [PassSide::Before, PassSide::After].map(|side| table.cell(side, 0, column));
    // The heads are the first row.
    speak_field(ui, &response, column + 1, [name.as_str(), &before, &after]);

    // Where the pass changed the value, the line is marked, and the new value has the accent colour.
    let mut color_after = palette.text;
    if before != after {
        mark_changed(ui, rect, palette);
        color_after = palette.accent;
    }

    let font = TextStyle::Monospace.resolve(ui.style());
    let painter = ui.painter();
    let at = |x: f32| Pos2::new(rect.left() + x, rect.center().y);
    let small = FontId::monospace(12.0);
    painter.text(at(10.0), Align2::LEFT_CENTER, name, small, palette.muted);
    let ends = field_ends(rect).map(at);
    let right = Align2::RIGHT_CENTER;
    painter.text(ends[0], right, before, font.clone(), palette.text);
    painter.text(ends[1], right, after, font, color_after);
}
