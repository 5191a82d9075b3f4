//! The notice: a message over the canvas, until it is dismissed. Sizes are in screen points, and chosen, not measured,
//! where no reason stands beside them.

use egui::{Align2, Area, Frame, Id, Margin, Order, RichText, Stroke, Ui, vec2};
use tilescope_drawing::palette::Palette;
use tilescope_ui::language::Worded;
use tilescope_ui::widgets::{Icon, Known, icon_button, verdict_mark};

use tilescope_workbench::command::Command;
#[cfg(not(target_arch = "wasm32"))]
use tilescope_workbench::state::Notice;
use tilescope_workbench::state::State;

/// Returns whether the notice is an error that an open sheet shows.
fn is_in_sheet(state: &State) -> bool {
    let is_error = state
        .messages()
        .notice
        .as_ref()
        .is_some_and(|notice| notice.is_error);
    is_error && state.files().has_sheet()
}

/// Shows an error within the open sheet, where it arose.
pub fn in_sheet(ui: &mut Ui, state: &State) {
    let Some(notice) = state
        .messages()
        .notice
        .as_ref()
        .filter(|_| is_in_sheet(state))
    else {
        return;
    };
    let palette = Palette::of(state.appearance().look);
    let text = RichText::new(ui.words(&notice.text)).color(palette.conflict);
    let response = ui.add(egui::Label::new(text).wrap());
    super::common::read_out(ui, &response);
    response.known_as("notice");
}

/// Shows the notice, if there is one, over the canvas. An open sheet shows errors itself.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let Some(notice) = &state.messages().notice else {
        return;
    };
    if is_in_sheet(state) {
        return;
    }

    let palette = Palette::of(state.appearance().look);
    let color = if notice.is_error {
        palette.conflict
    } else {
        palette.accent
    };

    // The notice keeps clear of the time controls: a small window has them below the canvas, so that the notice hangs under the
    // bar there. An embedded window has no bar. In other windows the notice stands above the timeline.
    let (corner, offset) = if state.window().embedding.is_some() {
        (Align2::CENTER_TOP, vec2(0.0, 8.0))
    } else if state.window().drawer.arrangement.is_compact() {
        (Align2::CENTER_TOP, vec2(0.0, 56.0))
    } else {
        (Align2::CENTER_BOTTOM, vec2(0.0, -128.0))
    };

    Area::new(Id::unique("notice"))
        .order(Order::Foreground)
        .anchor(corner, offset)
        .show(ui.ctx(), |ui| {
            Frame::new()
                .fill(palette.raised)
                .stroke(Stroke::new(1.0, color))
                .corner_radius(10)
                .shadow(ui.visuals().window_shadow)
                .inner_margin(Margin::symmetric(14, 8))
                .show(ui, |ui| {
                    let width = super::sheet::width(ui, 640.0);
                    ui.set_max_width(width);
                    ui.horizontal(|ui| {
                        let size = vec2(16.0, 22.0);
                        let (rect, _) = ui.allocate_exact_size(size, egui::Sense::hover());
                        let is_good = !notice.is_error;
                        verdict_mark(ui.painter(), rect.center(), is_good, color);
                        ui.scope(|ui| {
                            // The rest of the width is for the mark and the buttons beside the text.
                            ui.set_max_width(
                                width - if notice.folder.is_some() { 180.0 } else { 80.0 },
                            );
                            let text = RichText::new(ui.words(&notice.text));
                            let response = ui.add(egui::Label::new(text).wrap());
                            super::common::read_out(ui, &response);
                            response.known_as("notice");
                        });
                        #[cfg(not(target_arch = "wasm32"))]
                        open_folder(ui, notice, commands);
                        let command = Command::DismissNotice;
                        icon_button(ui, Icon::Close, "Dismiss", None, palette)
                            .issues("dismiss", command, commands);
                    });
                });
        });
}

/// Shows the button that opens the folder of the file that was written, if one was.
#[cfg(not(target_arch = "wasm32"))]
fn open_folder(ui: &mut Ui, notice: &Notice, commands: &mut Vec<Command>) {
    let Some(folder) = &notice.folder else {
        return;
    };
    let button = ui.button(ui.words("Open folder"));
    button.known_as("open-folder");
    if button.on_hover_text(folder.display().to_string()).clicked() {
        commands.push(Command::OpenFolder(folder.clone()));
    }
}
