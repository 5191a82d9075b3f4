//! What the pointer, fingers and keys do to a canvas, as commands. Nothing is drawn and nothing is changed.

use egui::{Context, EventFilter, Id, Key, PointerButton, Pos2, Response, Ui, Vec2, vec2};
use tilescope_core::Standing;

use super::subject::Subject;
use super::touch::{Hand, Touch};
use crate::command::{Command, DebugCommand, Selection};
use crate::layout::Panel;

/// How near to a sample the pointer picks it, in screen points.
const PICK_POINTS: f64 = 14.0;
/// How near a finger does, which hides what it points at.
const PICK_BY_FINGER: f64 = 24.0;
/// By how many screen points an arrow key moves the view.
const PAN: f32 = 80.0;

/// Pans, zooms, hovers and selects; returns where the pointer is, if it is one that hovers.
pub fn handle(
    ui: &Ui,
    response: &Response,
    subject: &Subject<'_>,
    commands: &mut Vec<Command>,
) -> Option<Pos2> {
    let touch = Touch::follow(ui, response);
    if touch.hand == Hand::Cancelled {
        return None;
    }
    move_view(ui, response, &touch, commands);
    pick(response, subject, &touch, commands);
    keys(ui, response, commands);
    if response.double_clicked()
        && touch.hand != Hand::Gesture
        && let Some(pos) = response.interact_pointer_pos()
    {
        let place = subject.camera.domain_from_screen(response.rect, pos);
        commands.push(Command::FlyToBlock(place));
    }
    response.hover_pos().filter(|_| touch.hand == Hand::Mouse)
}

/// Moves and zooms: two fingers about their middle, the wheel about the pointer.
fn move_view(ui: &Ui, response: &Response, touch: &Touch, commands: &mut Vec<Command>) {
    let is_dragged =
        response.dragged_by(PointerButton::Primary) || response.dragged_by(PointerButton::Middle);
    let moved = match touch.pinch {
        Some(pinch) => pinch.moved,
        // What one finger of two does when the other is lifted is still their gesture.
        None if is_dragged => response.drag_delta(),
        None => Vec2::ZERO,
    };
    if moved != Vec2::ZERO {
        commands.push(Command::Pan(moved));
    }
    let (at, factor) = if let Some(pinch) = touch.pinch {
        (pinch.middle, f64::from(pinch.factor))
    } else if response.contains_pointer() && touch.hand == Hand::Mouse {
        let (scroll, zoom) = ui.input(|i| (i.smooth_scroll_delta(), i.zoom_delta()));
        let factor = f64::from(zoom) * f64::from(scroll.y * 0.0024).exp();
        let at = response.hover_pos().unwrap_or(response.rect.center());
        (at, factor)
    } else {
        return;
    };
    if (factor - 1.0).abs() > 1e-6 {
        commands.push(Command::Zoom(at, factor));
    }
}

/// Hovers and selects the sample nearest to the pointer; a finger that stays selects and opens the history.
fn pick(response: &Response, subject: &Subject<'_>, touch: &Touch, commands: &mut Vec<Command>) {
    let reach = match touch.hand {
        Hand::Mouse => PICK_POINTS,
        _ => PICK_BY_FINGER,
    };
    // A finger points at nothing before it presses, and at nothing when it is lifted.
    let pointer = response.hover_pos().filter(|_| touch.hand == Hand::Mouse);
    let hovered = pointer.and_then(|pos| nearest(response, subject, pos, reach));
    if hovered != subject.hovered {
        commands.push(Command::Hover(hovered));
    }
    if touch.hand == Hand::Gesture {
        return;
    }
    let is_long = response.long_touched();
    // Enter selects what is in the middle.
    let by_key = response.has_focus() && response.interact_pointer_pos().is_none();
    if !(is_long || response.clicked() && !by_key) {
        return;
    }
    let selection = response.interact_pointer_pos().map(|pos| {
        let sample = nearest(response, subject, pos, reach).map(Selection::Sample);
        sample.unwrap_or_else(|| place(response, subject, pos))
    });
    let selection = selection.unwrap_or(Selection::Nothing);
    commands.push(Command::Debug(DebugCommand::Pick(selection)));
    if is_long && selection != Selection::Nothing {
        commands.push(Command::OpenPanel(Panel::Inspector));
    }
}

/// Returns the sample nearest to a place of the screen, within `reach` screen points.
fn nearest(response: &Response, subject: &Subject<'_>, pos: Pos2, reach: f64) -> Option<u32> {
    let shown = subject.shown;
    let place = subject.camera.domain_from_screen(response.rect, pos);
    let reach = (reach / subject.camera.scale).min(1.5);
    let mut best: Option<(f64, u32)> = None;
    shown.session.index.visit(place, place, reach, |seen| {
        let distance = (seen.place[0] - place[0]).hypot(seen.place[1] - place[1]);
        let visible = !seen.image && shown.standing(seen.id) != Standing::Absent;
        if visible && distance <= reach && best.is_none_or(|(d, _)| distance < d) {
            best = Some((distance, seen.id));
        }
    });
    best.map(|(_, id)| id)
}

/// Returns the place of the domain at a place of the screen.
fn place(response: &Response, subject: &Subject<'_>, pos: Pos2) -> Selection {
    let place = subject.camera.domain_from_screen(response.rect, pos);
    let size = subject.shown.session.size_radii();
    let inside = (0..2).all(|k| (0.0..size[k]).contains(&place[k]));
    if inside {
        Selection::Place(place)
    } else {
        Selection::Nothing
    }
}

fn focused_id() -> Id {
    Id::unique("the canvas that has the focus")
}

/// Returns whether a canvas has the focus: arrows are meant for it.
pub fn has_focus(ctx: &Context) -> bool {
    let focused = ctx.memory(egui::Memory::focused);
    focused.is_some() && focused == ctx.data(|data| data.get_temp(focused_id()))
}

/// Whoever came to the canvas by Tab moves it by arrows and selects its middle by Enter; plus and minus zoom everywhere.
fn keys(ui: &Ui, response: &Response, commands: &mut Vec<Command>) {
    if !response.has_focus() {
        return;
    }
    ui.data_mut(|data| data.insert_temp(focused_id(), response.id));
    let filter = EventFilter {
        horizontal_arrows: true,
        vertical_arrows: true,
        ..EventFilter::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let moves = [
        (Key::ArrowLeft, vec2(PAN, 0.0)),
        (Key::ArrowRight, vec2(-PAN, 0.0)),
        (Key::ArrowUp, vec2(0.0, PAN)),
        (Key::ArrowDown, vec2(0.0, -PAN)),
    ];
    ui.input_mut(|input| {
        for (key, delta) in moves {
            let count = input.count_and_consume_key(egui::Modifiers::NONE, key);
            commands.extend((0..count).map(|_| Command::Pan(delta)));
        }
        if input.consume_key(egui::Modifiers::NONE, Key::Enter) {
            commands.push(Command::SelectMiddle);
        }
    });
}
