//! The keyboard's focus: a ring around what has it, the same for everything, and lists that scroll to it. Who gets the
//! focus is egui's.

use egui::{Context, EventFilter, Memory, Popup, Stroke, StrokeKind, Ui};

use crate::state::State;
use crate::theme::Palette;

/// How wide the ring is, and how far around what has the focus, in screen points.
const WIDTH: f32 = 2.0;
const AROUND: f32 = 2.0;

/// Draws a ring around what has the focus.
pub fn ring(ctx: &Context, palette: &Palette) {
    let focused = ctx.memory(Memory::focused);
    let Some(response) = focused.and_then(|id| ctx.read_response(id)) else {
        return;
    };
    // What is scrolled out of view has no ring; what fills the window has it inside.
    let seen = response.interact_rect;
    if !seen.is_positive() {
        return;
    }
    let window = ctx.content_rect().shrink(WIDTH);
    let place = seen.expand(AROUND).intersect(window);
    let painter = ctx.layer_painter(response.layer_id);
    let ground = Stroke::new(WIDTH + 2.0, palette.panel);
    let line = Stroke::new(WIDTH, palette.accent);
    painter.rect_stroke(place, 6.0, ground, StrokeKind::Middle);
    painter.rect_stroke(place, 6.0, line, StrokeKind::Middle);
}

/// Has left and right go through time wherever the focus is, instead of moving it, too; menus and fields keep them.
pub fn keep_arrows(ctx: &Context, state: &State) {
    let Some(focused) = ctx.memory(Memory::focused) else {
        return;
    };
    let is_theirs = ctx.text_edit_focused() || Popup::is_any_open(ctx);
    if is_theirs || state.palette.is_some() || state.has_sheet() {
        return;
    }
    let filter = EventFilter {
        horizontal_arrows: true,
        ..EventFilter::default()
    };
    ctx.memory_mut(|memory| memory.set_focus_lock_filter(focused, filter));
}

/// Scrolls to what has got the focus, if it is in `ui`, which is the inside of a scroll area.
pub fn follow(ui: &Ui) {
    let Some(focused) = ui.memory(Memory::focused) else {
        return;
    };
    let id = ui.scope_id().with("followed focus");
    let Some(response) = ui.ctx().read_response(focused) else {
        return;
    };
    let is_here = response.layer_id == ui.layer_id() && ui.min_rect().contains_rect(response.rect);
    let before = ui.data(|data| data.get_temp::<egui::Id>(id));
    if is_here && before != Some(focused) {
        ui.data_mut(|data| data.insert_temp(id, focused));
        ui.scroll_to_rect(response.rect.expand(AROUND + WIDTH), None);
    }
}
