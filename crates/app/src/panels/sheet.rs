//! Common to all sheets (dialogs over the window): size, position, keys, and focus on the first field when opened.
//! Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{Event, Key, Response, ScrollArea, Ui, Vec2, vec2};

use tilescope_ui::focus;

/// Returns the width of a sheet: `width`, in screen points, or as much as fits.
pub fn width(ui: &Ui, width: f32) -> f32 {
    let margin = ui.spacing().window_margin;
    let room = ui.ctx().content_rect().width() - f32::from(margin.left) - f32::from(margin.right);
    width.min(room - 2.0 * SIDE_MARGIN)
}

/// Shows the contents of a sheet, scrolled if the window is too low.
pub fn scrolled(ui: &mut Ui, wide: f32, add: impl FnOnce(&mut Ui)) {
    ui.set_width(width(ui, wide));
    let room = (ui.ctx().content_rect().height() - FRAME_HEIGHT).max(120.0);
    ScrollArea::vertical()
        .max_height(room)
        .min_scrolled_height(room)
        .show(ui, |ui| {
            add(ui);
            focus::follow(ui);
        });
}

/// Returns the offset of a sheet from the middle of the window: a little above it, if the window is high.
pub fn above_middle(ui: &Ui) -> Vec2 {
    let is_high = ui.ctx().content_rect().height() > LOW_WINDOW_HEIGHT;
    vec2(0.0, if is_high { -40.0 } else { 0.0 })
}

/// In lower windows, in screen points, sheets are centred.
const LOW_WINDOW_HEIGHT: f32 = 600.0;
/// Height of a sheet's frame, above and below its contents.
const FRAME_HEIGHT: f32 = 96.0;
/// Margin beside a sheet, in screen points.
const SIDE_MARGIN: f32 = 6.0;

/// Returns whether the sheet of this name has just opened.
pub fn just_opened(ui: &Ui, name: &str) -> bool {
    let id = egui::Id::unique("sheet").with(name);
    let frame = ui.ctx().cumulative_frame_nr();
    let last: Option<u64> = ui.data(|data| data.get_temp(id));
    ui.data_mut(|data| data.insert_temp(id, frame));
    last.is_none_or(|last| last + 1 < frame)
}

/// Focuses a field and selects its `length` characters, so that typing replaces them.
pub fn select_all(ui: &Ui, response: &Response, length: usize) {
    response.request_focus();
    let mut edit = TextEditState::load(ui.ctx(), response.id).unwrap_or_default();
    let all = CCursorRange::two(CCursor::new(0), CCursor::new(length));
    edit.cursor.set_char_range(Some(all));
    edit.store(ui.ctx(), response.id);
}

/// Returns whether Enter was pressed in a field, ignoring key repeats. The field keeps the focus: a question may
/// follow, which the same key answers.
pub fn entered(ui: &Ui, response: &Response) -> bool {
    let pressed = |event: &Event| {
        matches!(
            event,
            Event::Key {
                key: Key::Enter,
                pressed: true,
                repeat: false,
                ..
            }
        )
    };

    // A field loses its focus by a click elsewhere, too, and by every Enter, repeated or not.
    if !response.lost_focus() || !ui.input(|input| input.key_pressed(Key::Enter)) {
        return false;
    }
    response.request_focus();
    ui.input(|input| input.events.iter().any(pressed))
}

/// Returns whether Escape closes the sheet; the list of actions, if open above it, is closed first.
pub fn escaped(ui: &Ui, state: &tilescope_workbench::state::State) -> bool {
    state.window().finder.is_none() && ui.input(|input| input.key_pressed(Key::Escape))
}
