//! What the sheets over the window share: the keyboard is in their first field as soon as they open.

use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{Event, Key, Response, Ui};

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

/// Returns whether Enter was pressed in a field; a key that is held counts once. The field keeps the keyboard: a question
/// may follow, to be answered by the same key.
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
    if !response.lost_focus() || !ui.input(|input| input.key_pressed(Key::Enter)) {
        return false;
    }
    response.request_focus();
    ui.input(|input| input.events.iter().any(pressed))
}

/// Returns whether the sheet is to be closed by a key: what lies over it goes first.
pub fn escaped(ui: &Ui, state: &crate::state::State) -> bool {
    state.palette.is_none() && ui.input(|input| input.key_pressed(Key::Escape))
}
