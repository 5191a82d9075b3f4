//! What the sheets over the window share: the keyboard is in their first field as soon as they open.

use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{Response, Ui};

/// Returns whether the sheet of this name was not there in the frame before.
pub fn just_opened(ui: &Ui, name: &str) -> bool {
    let id = egui::Id::unique("sheet").with(name);
    let frame = ui.ctx().cumulative_frame_nr();
    let last: Option<u64> = ui.data(|data| data.get_temp(id));
    ui.data_mut(|data| data.insert_temp(id, frame));
    last.is_none_or(|last| last + 1 < frame)
}

/// Has the keyboard write into a field of `length` characters, in the place of what is there.
pub fn select_all(ui: &Ui, response: &Response, length: usize) {
    response.request_focus();
    let mut edit = TextEditState::load(ui.ctx(), response.id).unwrap_or_default();
    let all = CCursorRange::two(CCursor::new(0), CCursor::new(length));
    edit.cursor.set_char_range(Some(all));
    edit.store(ui.ctx(), response.id);
}
