//! The commands of pointer, fingers and keys on a canvas. Nothing is drawn and nothing is changed.
//!
//! Where the canvas is part of another page, the plain wheel and one finger scroll that page. The wheel zooms together with
//! Ctrl there, and two fingers move the picture.

use egui::{
    Context, Event, EventFilter, FocusDirection, Id, Key, Modifiers, PointerButton, Pos2, Response,
    Ui, Vec2, vec2,
};
use glam::DVec2;
use tilescope_core::Standing;
use tilescope_session::layers::Layer;
use tilescope_session::selection::Selection;

use super::CanvasContext;
use tilescope_canvas::hint::{self, Hint};
use tilescope_canvas::touch::{Hand, Touch};
use tilescope_drawing::scene::drawn_around;
use tilescope_drawing::subject::Subject;
use tilescope_workbench::command::ViewCommand;

/// Pick radius of the pointer, in screen points. The sizes here were chosen, not measured.
pub(super) const PICK_POINTS: f64 = 14.0;
/// Pick radius of a finger, which hides its target.
const PICK_BY_FINGER: f64 = 24.0;
/// How far an arrow key pans the view, in screen points.
const PAN: f32 = 80.0;

/// Pans, zooms, hovers and selects; returns the pointer's position, if it hovers. Where a brush paints the canvas
/// (`is_painted`), nothing is selected, and the primary button and a single finger do not pan.
pub fn handle(
    ui: &Ui,
    response: &Response,
    subject: &Subject<'_>,
    context: &CanvasContext<'_>,
    is_painted: bool,
    touch: Touch,
    commands: &mut Vec<ViewCommand>,
) -> Option<Pos2> {
    // A cancelled touch moves and selects nothing.
    if touch.hand == Hand::Cancelled {
        return None;
    }

    move_view(
        ui,
        response,
        &touch,
        context.is_embedded,
        is_painted,
        commands,
    );
    let is_picked = !is_painted && pick(response, subject, &touch, commands);
    keys(ui, response, commands);

    // Two fingers that are lifted one after the other make no double tap.
    let flies = response.double_clicked() && touch.hand != Hand::Gesture && !is_painted;
    if flies && let Some(pos) = response.interact_pointer_pos() {
        let position = subject.camera.domain_from_screen(response.rect, pos);
        commands.push(ViewCommand::FlyToBlock(position));
    }

    inspect_later(ui, response, is_picked, flies, context, commands);
    // Only a mouse hovers: the place of a finger that was lifted would stay otherwise.
    response.hover_pos().filter(|_| touch.hand == Hand::Mouse)
}

/// Opens the panel of the selection, if a click or a tap of this frame (`is_picked`) or of one before has set it. In a
/// small window it would cover a part of the canvas, so it waits until a double tap, which `flies` to the block, is no
/// longer possible.
fn inspect_later(
    ui: &Ui,
    response: &Response,
    is_picked: bool,
    flies: bool,
    context: &CanvasContext<'_>,
    commands: &mut Vec<ViewCommand>,
) {
    let id = Id::unique("picked at").with(response.id);
    let now = ui.input(|input| input.time);
    let picked_at = if is_picked {
        Some(now)
    } else {
        ui.data(|data| data.get_temp::<f64>(id))
    };
    let Some(picked_at) = picked_at else {
        return;
    };

    // Beside tiles the panel covers nothing, and opens at once.
    let wait = if context.is_compact {
        ui.options(|options| options.input_options.max_double_click_delay)
    } else {
        0.0
    };
    let rest = picked_at + wait - now;
    if rest > 0.0 && !flies {
        // A later frame opens the panel, once no second tap can follow.
        ui.data_mut(|data| data.insert_temp(id, picked_at));
        ui.ctx()
            .request_repaint_after(std::time::Duration::from_secs_f64(rest));
        return;
    }

    ui.data_mut(|data| data.remove::<f64>(id));
    if !flies {
        commands.push(ViewCommand::Inspect);
    }
}

/// Pans, by a drag or by two fingers, and zooms: two fingers about their middle, the wheel about the pointer.
fn move_view(
    ui: &Ui,
    response: &Response,
    touch: &Touch,
    is_embedded: bool,
    is_painted: bool,
    commands: &mut Vec<ViewCommand>,
) {
    let by_primary = response.dragged_by(PointerButton::Primary) && !is_painted;
    let is_dragged = by_primary || response.dragged_by(PointerButton::Middle);
    // In an embedded window one finger scrolls the page around it: a hint says that two fingers move the picture.
    if is_embedded && is_dragged && touch.hand == Hand::Finger {
        hint::give(ui, Hint::Fingers);
        return;
    }

    let moved = match touch.pinch {
        Some(pinch) => pinch.moved,
        // When one of two fingers is lifted, the other one goes on moving the picture.
        None if is_dragged => response.drag_delta(),
        None => Vec2::ZERO,
    };
    if moved != Vec2::ZERO {
        commands.push(ViewCommand::Pan(moved));
    }

    let (at, factor) = if let Some(pinch) = touch.pinch {
        (pinch.middle, f64::from(pinch.factor))
    } else if response.contains_pointer() && touch.hand == Hand::Mouse {
        let (scroll, zoom) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        // In an embedded window the plain wheel scrolls the page around it: a hint says that it zooms with Ctrl.
        let scroll = if is_embedded {
            if ui.input(|input| input.events.iter().any(is_plain_wheel)) {
                hint::give(ui, Hint::Wheel);
            }
            0.0
        } else {
            scroll
        };
        // Equal turns of the wheel change the scale by equal factors. 100 points change it by e^0.24 = 1.27, a
        // chosen speed.
        let factor = f64::from(zoom) * f64::from(scroll * 0.0024).exp();
        // While another widget is dragged over the canvas, nothing hovers: the wheel zooms about the middle then.
        let at = response.hover_pos().unwrap_or(response.rect.center());
        (at, factor)
    } else {
        return;
    };

    // Rounding alone is no movement of the wheel.
    if (factor - 1.0).abs() > 1e-6 {
        commands.push(ViewCommand::Zoom(at, factor));
    }
}

fn is_plain_wheel(event: &Event) -> bool {
    matches!(event, Event::MouseWheel { modifiers, .. } if !leads_zoom(*modifiers))
}

/// Returns whether the wheel zooms with these modifiers, even where the plain wheel scrolls the surrounding page.
#[must_use]
pub fn leads_zoom(modifiers: Modifiers) -> bool {
    modifiers.command || modifiers.ctrl
}

/// Hovers and selects the sample nearest to the pointer; returns whether the selection was set or cleared.
fn pick(
    response: &Response,
    subject: &Subject<'_>,
    touch: &Touch,
    commands: &mut Vec<ViewCommand>,
) -> bool {
    let reach = match touch.hand {
        Hand::Mouse => PICK_POINTS,
        _ => PICK_BY_FINGER,
    };
    // Only a mouse hovers: a finger that is down drags or selects.
    let pointer = response.hover_pos().filter(|_| touch.hand == Hand::Mouse);
    let hovered = pointer.and_then(|pos| nearest(response, subject, pos, reach));
    if hovered != subject.hovered {
        commands.push(ViewCommand::Hover(hovered));
    }

    // Two fingers move the picture and select nothing.
    if touch.hand == Hand::Gesture {
        return false;
    }

    // Enter clicks a focused widget, without a pointer. `keys` selects at the centre then.
    let by_key = response.has_focus() && response.interact_pointer_pos().is_none();
    if !(response.long_touched() || response.clicked() && !by_key) {
        return false;
    }

    let picked = response.interact_pointer_pos().map(|pos| {
        let sample = nearest(response, subject, pos, reach).map(Selection::Sample);
        sample.unwrap_or_else(|| selection_at(response, subject, pos))
    });
    // A click without a pointer, as screen readers make them, is at no place.
    let selection = picked.unwrap_or(Selection::Nothing);
    commands.push(ViewCommand::Pick(selection));
    true
}

/// Returns the sample nearest to a point on the screen, within `reach` screen points; if there is none, that of an
/// exposed arc there, while such arcs are shown.
pub(super) fn nearest(
    response: &Response,
    subject: &Subject<'_>,
    pos: Pos2,
    reach: f64,
) -> Option<u32> {
    let shown = subject.shown;
    let position = subject.camera.domain_from_screen(response.rect, pos);
    // The scale is in screen points for an r. Zoomed out, the reach on the screen would cover many samples: it ends at 1.5 times
    // the distance of neighbours, a chosen number.
    let in_radii = (reach / subject.camera.scale).min(1.5 * shown.spacing());

    let mut found: Option<(f64, u32)> = None;
    let index = &shown.session.index;

    // A copy across a periodic border is drawn, and a click on it selects its sample.
    let around = drawn_around(shown.session);
    // The rectangle around which the index looks is the position alone.
    index.visit_around(position, position, in_radii, around, |seen| {
        let distance = seen.position.distance(position);
        let visible = shown.standing(seen.id) != Standing::Absent;
        if visible && distance <= in_radii && found.is_none_or(|(least, _)| distance < least) {
            found = Some((distance, seen.id));
        }
    });

    // Where no sample is near, an exposed arc leads to the sample of its circle.
    if found.is_none() && subject.layers.has(Layer::CoveredCircles) {
        return subject.geometry.exposed_at(&shown, position, in_radii);
    }
    found.map(|(_, id)| id)
}

/// Returns the selection of the place at a point on the screen: in a copy around a periodic domain that of the domain,
/// farther out nothing.
fn selection_at(response: &Response, subject: &Subject<'_>, pos: Pos2) -> Selection {
    let session = subject.shown.session;
    let position = subject.camera.domain_from_screen(response.rect, pos);
    let (size, margin) = (session.size_radii(), drawn_around(session));
    let inside = position.cmpge(DVec2::splat(-margin)) & position.cmplt(size + margin);
    if inside.all() {
        // In a bounded domain the place is inside, and stays as it is.
        let wrapped = position.rem_euclid(size);
        // The remainder of a tiny negative number is rounded up to the divisor, which is the border at 0.
        let place = DVec2::select(wrapped.cmplt(size), wrapped, DVec2::ZERO);
        Selection::Place(place)
    } else {
        Selection::Nothing
    }
}

/// Returns the place in egui's memory where a canvas with the focus leaves its id, for [`has_focus`].
fn focused_id() -> Id {
    Id::unique("the canvas that has the focus")
}

/// Returns whether a canvas or the list of its objects has the focus and so receives the arrow keys.
pub fn has_focus(ctx: &Context) -> bool {
    let focused = ctx.memory(egui::Memory::focused);
    focused.is_some() && focused == ctx.data(|data| data.get_temp(focused_id()))
}

/// Keeps the arrow keys for a canvas or its list, which has the focus: egui would move the focus with them otherwise.
pub(super) fn keep_arrows(ui: &Ui, response: &Response) {
    ui.data_mut(|data| data.insert_temp(focused_id(), response.id));
    let filter = EventFilter {
        horizontal_arrows: true,
        vertical_arrows: true,
        ..EventFilter::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));

    // egui heeds this filter only from the second frame in which the widget has the focus. In a slow window a key may
    // be pressed before that frame, so that the move of the focus is taken back.
    let is_arrow = ui.input(|input| {
        let arrows = [
            Key::ArrowLeft,
            Key::ArrowRight,
            Key::ArrowUp,
            Key::ArrowDown,
        ];
        arrows.into_iter().any(|key| input.key_pressed(key))
    });
    if is_arrow {
        ui.memory_mut(|memory| memory.move_focus(FocusDirection::None));
    }
}

/// With the keyboard focus on the canvas, arrows pan and Enter selects at its centre. Plus and minus zoom whatever has
/// the focus: they are keys of actions.
fn keys(ui: &Ui, response: &Response, commands: &mut Vec<ViewCommand>) {
    if !response.has_focus() {
        return;
    }
    keep_arrows(ui, response);

    // An arrow moves the view, so that the picture moves the other way.
    let moves = [
        (Key::ArrowLeft, vec2(PAN, 0.0)),
        (Key::ArrowRight, vec2(-PAN, 0.0)),
        (Key::ArrowUp, vec2(0.0, PAN)),
        (Key::ArrowDown, vec2(0.0, -PAN)),
    ];

    ui.input_mut(|input| {
        for (key, delta) in moves {
            // Several presses of a key may fall into one slow frame.
            let count = input.count_and_consume_key(egui::Modifiers::NONE, key);
            commands.extend((0..count).map(|_| ViewCommand::Pan(delta)));
        }
        if input.consume_key(egui::Modifiers::NONE, Key::Enter) {
            commands.push(ViewCommand::SelectMiddle);
        }
    });
}
