//! The table of stages: what each left behind. A row is a way to go there.

use egui::{Align2, CursorIcon, FontId, Role, Sense, Ui, WidgetInfo, vec2};
use tilescope_core::Stage;

use crate::command::Command;
use crate::sentence::{grouped, stage_name};
use crate::session::{MOST_STAGED, Session};
use crate::state::State;
use crate::theme::Palette;
use crate::widgets::heading;

/// Shows the table.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.look);
    heading(ui, "Stages");
    let Some(session) = &state.session else {
        return;
    };
    ui.spacing_mut().item_spacing.y = 1.0;
    row(ui, ["", "change", "samples"], false, palette, false);
    for (place, &stage) in session.stages.iter().enumerate() {
        let texts = [
            stage_name(stage),
            change(session, stage),
            if stage == Stage::Blocks {
                "\u{2013}".to_owned()
            } else {
                grouped(session.count_after(place))
            },
        ];
        let texts = texts.each_ref().map(String::as_str);
        if row(ui, texts, place == state.stage, palette, true) {
            commands.push(Command::ShowStage(place));
        }
    }
    if !session.has_stages() {
        let most = grouped(MOST_STAGED as usize);
        let text =
            format!("Above {most} samples only the result is kept: the stages between are not.");
        ui.add_space(4.0);
        ui.label(egui::RichText::new(text).color(palette.muted).small());
    }
}

fn change(session: &Session, stage: Stage) -> String {
    let summary = &session.summary;
    match stage {
        Stage::Blocks => format!("{} blocks", grouped(summary.blocks)),
        Stage::Tile => format!("+{}", grouped(summary.tiled)),
        Stage::Eliminate if session.inserted_at_once() > 0 => format!(
            "\u{2212}{} +{}",
            grouped(summary.eliminated),
            grouped(session.inserted_at_once())
        ),
        Stage::Eliminate => format!("\u{2212}{}", grouped(summary.eliminated)),
        Stage::Iterate(k) => format!(
            "+{}",
            grouped(summary.inserted.get(k as usize - 1).copied().unwrap_or(0))
        ),
        Stage::Pattern | Stage::Regions | Stage::Finish => String::new(),
    }
}

fn row(ui: &mut Ui, texts: [&str; 3], current: bool, palette: &Palette, click: bool) -> bool {
    let sense = if click {
        Sense::click()
    } else {
        Sense::hover()
    };
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 24.0), sense);
    if click {
        let label = format!("Row {}", texts[0]);
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, current, &label));
    }
    let painter = ui.painter();
    if current {
        painter.rect_filled(rect, 5.0, palette.accent.gamma_multiply(0.18));
    } else if click && (response.hovered() || response.has_focus()) {
        painter.rect_filled(rect, 5.0, palette.text.gamma_multiply(0.06));
    }
    let color = if click { palette.text } else { palette.muted };
    let name = if click { 13.0 } else { 11.5 };
    let number = |size| {
        if click {
            FontId::monospace(size)
        } else {
            FontId::proportional(11.5)
        }
    };
    let left = rect.left_center() + vec2(8.0, 0.0);
    painter.text(
        left,
        Align2::LEFT_CENTER,
        texts[0],
        FontId::proportional(name),
        color,
    );
    let middle = rect.left_center() + vec2(rect.width() - 82.0, 0.0);
    painter.text(
        middle,
        Align2::RIGHT_CENTER,
        texts[1],
        number(12.0),
        palette.muted,
    );
    let right = rect.right_center() - vec2(8.0, 0.0);
    painter.text(right, Align2::RIGHT_CENTER, texts[2], number(12.5), color);
    if click {
        response.on_hover_cursor(CursorIcon::PointingHand).clicked()
    } else {
        false
    }
}
