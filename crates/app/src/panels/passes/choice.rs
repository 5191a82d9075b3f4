//! The switch that shows a buffer's rows on the canvas. The rows are drawn in `panes/buffers.rs`.

use std::fmt::Write as _;

use egui::{Button, Label, RichText, Ui};
use tilescope_drawing::palette::Palette;
use tilescope_session::words::{counted, grouped};
use tilescope_ui::widgets::Known;

use tilescope_workbench::passes::canvas::Rows;
use tilescope_workbench::passes::model::Visit;
use tilescope_workbench::passes::placed::PlacedCounts;
use tilescope_workbench::passes::{PassCommand, Passes};

/// Shows the switch, and a remark on the rows that it draws.
pub(super) fn show(
    ui: &mut Ui,
    passes: &Passes,
    visit: &Visit,
    palette: &Palette,
    commands: &mut Vec<PassCommand>,
) {
    // The buffer that is shown is kept by its index, and this pass may have fewer buffers.
    let Some(rows) = passes.shown().on_canvas(visit) else {
        return;
    };
    ui.horizontal(|ui| {
        let mut is_on = passes.is_on_canvas();
        let switch = ui.checkbox(&mut is_on, "On the canvas");
        if switch.known_as("passes.on-canvas").changed() {
            commands.push(PassCommand::OnCanvas(is_on));
        }

        let tip =
            "Shows the canvas and selected row; arrow keys and play then go from pass to pass.";
        let button = ui.add_enabled(is_on, Button::new("Show canvas"));
        button.known_as("passes.show-canvas");
        if button.on_hover_text(tip).clicked() {
            commands.push(PassCommand::ShowCanvas);
        }

        let (text, tip) = remark_on(&rows);
        let label =
            ui.add(Label::new(RichText::new(&text).small().color(palette.muted)).truncate());
        label.known_as("passes.marked");
        if !tip.is_empty() {
            label.on_hover_text(tip);
        }
    });
}

/// Returns a remark on the rows drawn, and its explanation, which is empty where the rows of the buffer have no places.
fn remark_on(rows: &Rows<'_>) -> (String, &'static str) {
    let name = rows.table.name.as_str();
    if let Some(why) = rows.places.unplaced() {
        return (format!("nothing of {name}: {why}"), "");
    }
    let PlacedCounts {
        rows: all,
        changed,
        inside,
    } = rows.shown.counts();

    let mut text = format!("{} of {name}", counted(all, "row", "rows"));
    if all > 0 {
        let _ = write!(text, ", {} in the domain", grouped(inside));
    }
    if changed > 0 {
        let _ = write!(text, ", {} changed", grouped(changed));
    }

    // Of a buffer with a row for each cell only rows with a change are drawn, unless a filter chooses the rows; of
    // others all that have a place.
    let tip = if rows.places.are_cells() && !rows.shown.is_filtered() {
        "This buffer has a row for every cell of the frame: cells are drawn where the pass changed something, or where a filter asks for them."
    } else {
        "Rows beyond the domain's border are images in the frame's halo, or were dropped there. Rows behind the end of a list have no position."
    };
    (text, tip)
}
