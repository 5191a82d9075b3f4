//! What the pointer and fingers do to a canvas, as commands. Nothing is drawn and nothing is changed.

use egui::{PointerButton, Response, Ui};
use tilescope_core::Standing;

use super::subject::Subject;
use crate::command::{Command, DebugCommand, Selection};

/// How near to a sample the pointer picks it, in screen points.
const PICK_POINTS: f64 = 14.0;

/// Pans, zooms, hovers and selects.
pub fn handle(ui: &Ui, response: &Response, subject: &Subject<'_>, commands: &mut Vec<Command>) {
    handle_input(ui, response, subject, commands);
    pick(response, subject, commands);
}

fn handle_input(ui: &Ui, response: &Response, subject: &Subject<'_>, commands: &mut Vec<Command>) {
    let touch = ui.input(egui::InputState::multi_touch);
    let moved = match touch.filter(|_| response.contains_pointer()) {
        Some(touch) => touch.translation_delta,
        None if response.dragged_by(PointerButton::Primary)
            || response.dragged_by(PointerButton::Middle) =>
        {
            response.drag_delta()
        }
        None => egui::Vec2::ZERO,
    };
    if moved != egui::Vec2::ZERO {
        commands.push(Command::Pan(moved));
    }
    if response.contains_pointer() {
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta(), i.zoom_delta()));
        let factor = f64::from(pinch) * f64::from(scroll.y * 0.0024).exp();
        let at = response.hover_pos().unwrap_or(response.rect.center());
        if (factor - 1.0).abs() > 1e-6 {
            commands.push(Command::Zoom(at, factor));
        }
    }
    if response.double_clicked()
        && let Some(pos) = response.interact_pointer_pos()
    {
        let place = subject.camera.domain_from_screen(response.rect, pos);
        commands.push(Command::FlyToBlock(place));
    }
}

/// Hovers and selects the sample nearest to the pointer.
fn pick(response: &Response, subject: &Subject<'_>, commands: &mut Vec<Command>) {
    let shown = subject.shown;
    let session = shown.session;
    let nearest = response.hover_pos().and_then(|pos| {
        let place = subject.camera.domain_from_screen(response.rect, pos);
        let reach = (PICK_POINTS / subject.camera.scale).min(1.5);
        let mut best: Option<(f64, u32)> = None;
        session.index.visit(place, place, reach, |seen| {
            let distance = (seen.place[0] - place[0]).hypot(seen.place[1] - place[1]);
            let visible = !seen.image && shown.standing(seen.id) != Standing::Absent;
            if visible && distance <= reach && best.is_none_or(|(d, _)| distance < d) {
                best = Some((distance, seen.id));
            }
        });
        best.map(|(_, id)| id)
    });
    if nearest != subject.hovered {
        commands.push(Command::Hover(nearest));
    }
    if response.clicked() {
        let place = response.interact_pointer_pos().map(|pos| {
            let place = subject.camera.domain_from_screen(response.rect, pos);
            let size = session.size_radii();
            let inside = (0..2).all(|k| (0.0..size[k]).contains(&place[k]));
            if inside {
                Selection::Place(place)
            } else {
                Selection::Nothing
            }
        });
        let selection = nearest
            .map(Selection::Sample)
            .or(place)
            .unwrap_or(Selection::Nothing);
        commands.push(Command::Debug(DebugCommand::Pick(selection)));
    }
}
