//! The table of stages: the numbers of samples, conflicts and gaps after each. A click on a row goes there. Sizes are
//! in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{CursorIcon, FontId, Rangef, Role, Sense, Ui, WidgetInfo, vec2};
use tilescope_core::Stage;
use tilescope_drawing::palette::Palette;
use tilescope_session::combination::Combination;
use tilescope_session::glossary;
use tilescope_session::limits::MAX_STAGED;
use tilescope_session::nested::NestedLevels;
use tilescope_session::sentence::{name_in, stage_sentence};
use tilescope_session::session::Session;
use tilescope_session::words::{grouped, share};
use tilescope_ui::table::{SpokenCell, spoken_row, table};
use tilescope_ui::theme::row_height;
use tilescope_ui::widgets::{Kebab, Known, heading, row as name_and_value};

use super::content::{Content, Room};
use super::context::PanelContext;
use crate::ENABLED;
use tilescope_workbench::command::{Command, TimeCommand};

pub const CONTENT: Content = Content::of_run(Room::Scrolled, show);

/// Shows the table of stages, or of nested levels; of a stipple how many dots were made and kept; and what gluing did,
/// if sets were glued. Without a session only the heading is shown.
pub fn show(ui: &mut Ui, context: &PanelContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    let heads = match context.run.prefix() {
        Some(_) if context.run.shows_stipple() => "Dots",
        Some(_) => "Levels",
        None => "Stages",
    };
    heading(ui, heads);
    let Some(session) = &context.run.session else {
        return;
    };

    ui.spacing_mut().item_spacing.y = 1.0;
    // The heads are a row of each table.
    if let Some(nested) = &session.nested {
        let size = [nested.claims.len() + 1, 3];
        return table(ui, heads, size, Role::Grid, |ui| {
            levels(ui, context, session, nested, commands);
        });
    }

    if let Some(stipple) = session.stipple() {
        // A page counts in 32 bits, and would show a larger number as the largest of these.
        let made = usize::try_from(stipple.made).unwrap_or(usize::MAX);
        name_and_value(ui, "Kept", &grouped(session.summary.count), palette);
        return name_and_value(ui, "Made", &grouped(made), palette);
    }

    let size = [session.stages.len() + 1, 3];
    table(ui, heads, size, Role::Grid, |ui| {
        stages(ui, context, session, commands);
    });

    if !session.has_stages() {
        let most = grouped(MAX_STAGED as usize);
        let text =
            format!("Above {most} samples only the result is kept: the stages between are not.");
        ui.add_space(4.0);
        ui.label(egui::RichText::new(text).color(palette.muted).small());
    }

    if let Some(combination) = &session.combination {
        seams(ui, session, combination, palette);
    }
}

/// Shows the rows of the stages.
fn stages(ui: &mut Ui, context: &PanelContext<'_>, session: &Session, commands: &mut Vec<Command>) {
    let palette = context.palette;
    head(ui, ["stage", "change"], palette);

    for (index, &stage) in session.stages.iter().enumerate() {
        let texts = [
            name_in(session, stage),
            change(session, stage),
            // Blocks are cut before there are samples.
            if stage == Stage::Blocks {
                "\u{2013}".to_owned()
            } else {
                grouped(session.count_after(index))
            },
        ];
        let texts = texts.each_ref().map(String::as_str);
        let key = Kebab(stage).to_string();
        let is_current = index == context.run.stage;
        // The heads are the first row.
        let shown = row(ui, index + 1, texts, is_current, palette, Some(&key));
        if shown
            .on_hover_text(stage_sentence(session, stage))
            .clicked()
        {
            commands.push(Command::Time(TimeCommand::ShowStage(index)));
        }
    }
}

/// Shows the row of the heads, of which the first two are given.
fn head(ui: &mut Ui, [first, middle]: [&str; 2], palette: &Palette) {
    // It is never current. Without a key it cannot be clicked.
    let is_current = false;
    row(ui, 0, [first, middle, "samples"], is_current, palette, None);
}

/// Shows the levels: their radii, and how many samples there are up to the end of each.
fn levels(
    ui: &mut Ui,
    context: &PanelContext<'_>,
    session: &Session,
    nested: &NestedLevels,
    commands: &mut Vec<Command>,
) {
    let palette = context.palette;
    head(ui, ["level", "radius"], palette);

    // Nested levels are always shown as a prefix, of at least one sample.
    let count = context.run.prefix().unwrap_or(1);
    // A claim says of the samples up to the end of a level how many they are, and which distance they keep.
    for (level, claim) in nested.claims.iter().enumerate() {
        let radius = claim.distance / session.run().domain.radius();
        let texts = [
            format!("Level {level}"),
            format!("{radius:.2} r"),
            grouped(claim.count),
        ];
        let texts = texts.each_ref().map(String::as_str);
        // The level of the last sample that is shown is the current one.
        let is_current = level == nested.level_of(count - 1);
        let key = format!("level-{level}");
        // The heads are the first row.
        let shown = row(ui, level + 1, texts, is_current, palette, Some(&key));

        // A level is maximal if its samples cover the domain within the distance that they keep. The last level may be cut short.
        let about = if claim.covering == Some(claim.distance) {
            glossary::LEVEL.meaning
        } else {
            "The set ends within this level, which is not maximal."
        };
        if shown.on_hover_text(about).clicked() {
            commands.push(Command::Time(TimeCommand::ShowStage(level)));
        }
    }
}

/// Shows the results of gluing.
fn seams(ui: &mut Ui, session: &Session, combination: &Combination, palette: &Palette) {
    ui.add_space(6.0);
    heading(ui, "At the seams");

    let summary = &session.summary;
    let inserted: usize = summary.inserted.iter().sum();
    let count_and_share =
        |part: usize, whole: usize| format!("{}  {}", grouped(part), share(part, whole));

    let length = combination.length;
    let seams = grouped(combination.seams.len());
    // The share of the domain that is near enough to a seam to be changed by gluing.
    let in_reach = format!("{:.1}%", 100.0 * combination.in_reach);
    for (name, value) in [
        // The share of eliminated samples is one of all samples that the sets had. Inserted samples are in the result,
        // so that their share is one of the result.
        (
            "Eliminated",
            count_and_share(summary.eliminated, summary.tiled),
        ),
        ("Inserted", count_and_share(inserted, summary.count)),
        ("Seams", format!("{seams}  {length:.1} r")),
        ("Area in reach", in_reach),
        ("Sets from files", grouped(combination.files)),
    ] {
        name_and_value(ui, name, &value, palette);
    }
}

/// Returns what a stage adds and takes away: pieces, blocks or samples.
fn change(session: &Session, stage: Stage) -> String {
    let summary = &session.summary;

    match stage {
        Stage::Blocks if session.combination.is_some() => {
            format!("{} pieces", grouped(summary.blocks))
        }
        Stage::Blocks => format!("{} blocks", grouped(summary.blocks)),
        Stage::Tile => format!("+{}", grouped(summary.tiled)),
        // The variant as printed inserts samples in the same stage.
        Stage::Eliminate if session.inserted_at_once() > 0 => format!(
            "\u{2212}{} +{}",
            grouped(summary.eliminated),
            grouped(session.inserted_at_once())
        ),
        Stage::Eliminate => format!("\u{2212}{}", grouped(summary.eliminated)),
        // Iterations are counted from 1, and the list of their insertions from 0. It ends with the last one that
        // inserted any.
        Stage::Iterate(k) => {
            let inserted = grouped(summary.inserted.get(k as usize - 1).copied().unwrap_or(0));
            // Exact tiling drops samples in each iteration, KDRT before the first one alone.
            if session.is_exact() {
                let lost = session.lost_in(session.stage_index(stage));
                return format!("\u{2212}{} +{inserted}", grouped(lost));
            }
            format!("+{inserted}")
        }
        Stage::Pattern | Stage::Regions | Stage::Finish => String::new(),
    }
}

/// Shows the row of an index. Rows of stages and levels, which have a key, can be clicked; the row of heads has none.
fn row(
    ui: &mut Ui,
    index: usize,
    texts: [&str; 3],
    is_current: bool,
    palette: &Palette,
    key: Option<&str>,
) -> egui::Response {
    let is_clickable = key.is_some();
    let sense = if is_clickable {
        Sense::click()
    } else {
        Sense::hover()
    };

    let (rect, response) = ui.allocate_exact_size(
        vec2(
            ui.available_width(),
            if is_clickable {
                // Rows that can be chosen are enlarged for fingers.
                row_height(ui.ctx(), 24.0)
            } else {
                24.0
            },
        ),
        sense,
    );

    if let Some(key) = key {
        let label = texts.map(str::trim).join(" ");
        let label = label.trim();
        response.widget_info(|| WidgetInfo::selected(Role::Row, ENABLED, is_current, label));
        response.known_as(format_args!("row.{key}"));
    }
    let (first, rest) = match key {
        Some(_) => (Role::RowHeader, Role::Cell),
        None => (Role::ColumnHeader, Role::ColumnHeader),
    };
    // Each third of the row holds the text of its column or its end.
    let third = rect.width() / 3.0;
    let cells = texts.into_iter().enumerate().map(|(column, text)| {
        let left = rect.left() + column as f32 * third;
        let role = if column == 0 { first } else { rest };
        SpokenCell::new(role, text, Rangef::new(left, left + third))
    });
    spoken_row(ui, &response, index, cells);

    let painter = ui.painter();
    if is_current {
        painter.rect_filled(rect, 5.0, palette.accent.gamma_multiply(0.18));
    } else if is_clickable && (response.hovered() || response.has_focus()) {
        painter.rect_filled(rect, 5.0, palette.text.gamma_multiply(0.06));
    }

    // The head of the first column is only read aloud. On the screen it would say no more than the names below it.
    let drawn = if is_clickable {
        texts
    } else {
        ["", texts[1], texts[2]]
    };
    row_texts(painter, rect, drawn, is_clickable, palette);
    if is_clickable {
        response.on_hover_cursor(CursorIcon::PointingHand)
    } else {
        response
    }
}

/// Draws the texts of a row, or of the heads, which are not `is_clickable`.
fn row_texts(
    painter: &egui::Painter,
    rect: egui::Rect,
    texts: [&str; 3],
    is_clickable: bool,
    palette: &Palette,
) {
    let color = if is_clickable {
        palette.text
    } else {
        palette.muted
    };

    let fonts = if is_clickable {
        // Numbers have digits of one width, which stand below each other.
        [
            FontId::proportional(13.0),
            FontId::monospace(12.0),
            FontId::monospace(12.5),
        ]
    } else {
        // The heads are words, and smaller than the rows below them.
        [11.5; 3].map(FontId::proportional)
    };
    let colors = [color, palette.muted, color];
    let galleys = [0, 1, 2].map(|column| {
        let (text, font) = (texts[column].to_owned(), fonts[column].clone());
        painter.layout_no_wrap(text, font, colors[column])
    });

    let ends = column_ends(rect.width(), galleys.each_ref().map(|it| it.size().x));
    for (column, galley) in galleys.into_iter().enumerate() {
        let (width, height) = (galley.size().x, galley.size().y);
        let at = rect.left_center() + vec2(ends[column] - width, -height / 2.0);
        painter.galley(at, galley, colors[column]);
    }
}

/// Returns where the texts of a row end, of these widths: the name on the left, the number on the right, and the change
/// before the number. In a panel that is too narrow, change and number move to the right of the name.
fn column_ends(width: f32, [name, change, number]: [f32; 3]) -> [f32; 3] {
    // The room at both sides of the row and between its texts, in screen points.
    const BESIDE: f32 = 8.0;
    let end_of_name = BESIDE + name;
    // Short numbers take 82 points at the right, so that the changes of all rows end at one line; longer numbers push
    // them left.
    let before_number = (width - BESIDE - number - BESIDE).min(width - 82.0);
    // Without a change the number follows the name.
    let end_of_change = if change > 0.0 {
        before_number.max(end_of_name + BESIDE + change)
    } else {
        end_of_name
    };
    let end_of_number = (width - BESIDE).max(end_of_change + BESIDE + number);
    [end_of_name, end_of_change, end_of_number]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_of_a_row_lies_over_another() {
        for width in [120.0, 170.0, 200.0, 300.0] {
            for texts in [
                [40.0, 56.0, 8.0],
                [35.0, 56.0, 50.0],
                [60.0, 0.0, 50.0],
                [64.0, 110.0, 56.0],
            ] {
                let ends = column_ends(width, texts);
                let starts = [0, 1, 2].map(|k| ends[k] - texts[k]);
                assert!(starts[0] >= 8.0 && ends[0] <= starts[2]);
                if texts[1] > 0.0 {
                    assert!(ends[0] + 8.0 <= starts[1] && ends[1] + 8.0 <= starts[2]);
                }
            }
        }
        // If there is room, columns are aligned.
        assert_eq!(column_ends(300.0, [40.0, 56.0, 50.0])[1..], [218.0, 292.0]);
        assert_eq!(column_ends(300.0, [35.0, 20.0, 40.0])[1..], [218.0, 292.0]);
    }
}
