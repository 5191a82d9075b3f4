//! Keyboard focus: a ring around the focused widget, the same for every kind, and lists that scroll to it. egui itself
//! decides which widget has the focus.

use egui::{
    Context, EventFilter, Id, LayerId, Memory, Popup, Role, Stroke, StrokeKind, Ui, WidgetRect,
};

use tilescope_drawing::palette::Palette;

use crate::language::Worded;

/// Width of the ring, and its distance from the focused widget, in screen points. These and the ring's rounding are
/// chosen, not measured.
const WIDTH: f32 = 2.0;
const AROUND: f32 = 2.0;

/// Draws a ring around the focused widget.
pub fn ring(ctx: &Context, palette: &Palette) {
    let focused = ctx.memory(Memory::focused);
    let Some(response) = focused.and_then(|id| ctx.read_response(id)) else {
        return;
    };
    // Widgets scrolled out of view get no ring.
    let seen = response.interact_rect;
    if !seen.is_positive() {
        return;
    }

    // The ring around a widget that fills the window is drawn inside of it.
    let window = ctx.content_rect().shrink(WIDTH);
    let place = seen.expand(AROUND).intersect(window);
    let painter = ctx.layer_painter(response.layer_id);

    // A wider line in the colour of panels sets the ring off from its surroundings.
    let ground = Stroke::new(WIDTH + 2.0, palette.panel);
    let line = Stroke::new(WIDTH, palette.accent);
    painter.rect_stroke(place, 6.0, ground, StrokeKind::Middle);
    painter.rect_stroke(place, 6.0, line, StrokeKind::Middle);
}

/// Keeps egui from moving the focus on left and right, so that the window receives these keys. Menus, text fields and
/// sheets that cover it (`is_covered`) keep them.
pub fn keep_arrows(ctx: &Context, is_covered: bool) {
    let Some(focused) = ctx.memory(Memory::focused) else {
        return;
    };
    // In a text field the arrows move the cursor, in a menu the choice.
    let is_used_there = ctx.text_edit_focused() || Popup::is_any_open(ctx);
    if is_used_there || is_covered {
        return;
    }

    let filter = EventFilter {
        horizontal_arrows: true,
        ..EventFilter::default()
    };
    ctx.memory_mut(|memory| memory.set_focus_lock_filter(focused, filter));
}

/// Scrolls to a widget in `ui` that has just got the focus, unless it is the one that was scrolled to last. Call it
/// inside a scroll area.
pub fn follow(ui: &Ui) {
    let Some(focused) = ui.memory(Memory::focused) else {
        return;
    };
    let id = ui.scope_id().with("followed focus");
    let Some(response) = ui.ctx().read_response(focused) else {
        return;
    };

    // A menu or a sheet over the list has a layer of its own.
    let is_here = response.layer_id == ui.layer_id() && ui.min_rect().contains_rect(response.rect);
    let before = ui.data(|data| data.get_temp::<egui::Id>(id));
    // Once, until another widget here gets the focus, so that the user can scroll away from it.
    if is_here && before != Some(focused) {
        ui.data_mut(|data| data.insert_temp(id, focused));
        ui.scroll_to_rect(response.rect.expand(AROUND + WIDTH), None);
    }
}

/// Gives accessible names to what `egui_tiles` leaves unnamed: draggable borders and rows of tabs. It is called when
/// this pass has shown all of them.
pub fn name_tiles(ctx: &Context) {
    let focusable: Vec<WidgetRect> = ctx.viewport(|viewport| {
        let layers = viewport.this_pass.widgets.layers();
        let widgets = layers.flat_map(|(_, widgets)| widgets);
        widgets
            .filter(|widget| widget.enabled && widget.sense.is_focusable())
            .copied()
            .collect()
    });

    // The words are looked up before the closure below, which is called under the lock that `words` takes.
    let (border, tabs) = (ctx.words("Border between panels"), ctx.words("Row of tabs"));
    for widget in focusable {
        ctx.accesskit_node_builder(widget.id, |node| {
            // Widgets with a role or a name of their own need none.
            if node.role() != Role::Unknown || node.label().is_some() {
                return;
            }
            // Borders and rows of tabs differ only in their sizes.
            if widget.rect.size().min_elem() < ROW_OF_TABS {
                node.set_role(Role::Splitter);
                node.set_label(&*border);
            } else {
                node.set_role(Role::TabList);
                node.set_label(&*tabs);
            }
        });
    }
}

/// Rows of tabs are higher than this, in screen points, and borders are narrower.
const ROW_OF_TABS: f32 = 20.0;

/// An end of the Tab order of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The widget that Tab reaches first.
    First,
    /// The widget that Tab reaches last.
    Last,
}

/// Returns the widget at an end of the Tab order, if any widget can have the focus.
fn widget_at(ctx: &Context, end: End) -> Option<Id> {
    let mut layers: Vec<(LayerId, Vec<Id>)> = ctx.viewport(|viewport| {
        // These are the widgets of the pass before, because this pass may not have shown all of its own yet.
        let layers = viewport.prev_pass.widgets.layers();
        let focusable = layers.map(|(layer, widgets)| {
            let taking = widgets
                .iter()
                .filter(|widget| widget.enabled && widget.sense.is_focusable());
            (*layer, taking.map(|widget| widget.id).collect())
        });
        focusable.collect()
    });

    // Layers below a modal one get no input.
    layers.retain(|(layer, ids)| {
        !ids.is_empty() && ctx.memory(|memory| memory.allows_interaction(*layer))
    });
    // Tab goes through the layers from back to front.
    layers.sort_by_key(|(layer, _)| layer.order);

    let mut ids = layers.iter().flat_map(|(_, ids)| ids);
    match end {
        End::First => ids.next().copied(),
        End::Last => ids.next_back().copied(),
    }
}

/// Gives the focus to the widget at an end of the Tab order.
pub fn enter(ctx: &Context, end: End) {
    if let Some(id) = widget_at(ctx, end) {
        ctx.memory_mut(|memory| memory.request_focus(id));
        ctx.request_repaint();
    }
}

/// Returns whether Tab would wrap around at this end of the Tab order; if so, it clears the focus. An open list wraps
/// within itself until it is closed.
pub fn leave(ctx: &Context, end: End) -> bool {
    let Some(focused) = ctx.memory(Memory::focused) else {
        return false;
    };
    let leaves = !Popup::is_any_open(ctx) && widget_at(ctx, end) == Some(focused);
    if leaves {
        ctx.memory_mut(|memory| memory.surrender_focus(focused));
        ctx.request_repaint();
    }
    leaves
}
