//! Painting radii on a canvas: the stroke that the pointer makes, and its picture until the run that it asks for is there. Sizes are
//! in screen points, and chosen, not measured.

use egui::{Id, Painter, PointerButton, Pos2, Response, Shape, Stroke, Ui};
use glam::DVec2;
use tilescope_canvas::touch::Hand;
use tilescope_drawing::palette::Palette;
use tilescope_drawing::subject::Subject;
use tilescope_session::layers::SessionKind;
use tilescope_workbench::command::{Brush, Command, FormCommand, PaintCommand};
use tilescope_workbench::state::{State, is_taught};

/// Places of a stroke are at least this share of the brush apart: between them it is straight.
const STEP: f64 = 0.2;
/// How opaque the picture of a stroke is, of 255.
const OPACITY: u8 = 70;
/// The making of a run begins at most so many frames after its stroke.
const FRAMES: u64 = 3;

/// The brush of a canvas.
pub(super) struct CanvasBrush {
    pub brush: Brush,
    /// Whether a run is being made, of a stroke if there was one.
    pub is_sampling: bool,
    pub palette: &'static Palette,
}

/// A stroke that is being made, or that was made and is not in the picture yet.
#[derive(Clone, Default)]
struct Drawn {
    /// Its places, from the lower corner of the domain, in its unit.
    path: Vec<[f64; 2]>,
    /// The session that was shown and the frame when it was made, once it was.
    made_at: Option<(u64, u64)>,
}

impl CanvasBrush {
    /// Returns the brush of a window, if it was chosen and there is something to paint: in a lesson clicks answer, and neither a
    /// combination nor nested levels nor a set in space have radii that a stroke could change.
    pub fn of(state: &State) -> Option<Self> {
        let (form, run) = (state.form(), &state.runs().first);
        let kind = run.session.as_ref()?.kind();
        let has_radii = match kind {
            SessionKind::Run | SessionKind::Exact | SessionKind::Varying => true,
            SessionKind::Combination | SessionKind::Nested | SessionKind::Solid => false,
        };
        (form.paints && has_radii && !is_taught(state)).then(|| Self {
            brush: form.brush,
            is_sampling: run.sampling.is_some(),
            palette: Palette::of(state.appearance().look),
        })
    }

    /// Follows the pointer: a drag, a click or a touch paints, and issues its stroke when it ends.
    pub fn follow(
        &self,
        ui: &Ui,
        response: &Response,
        hand: Hand,
        subject: &Subject<'_>,
        commands: &mut Vec<Command>,
    ) {
        let id = Id::unique("stroke").with(response.id);
        let mut drawn: Drawn = ui.data(|data| data.get_temp(id)).unwrap_or_default();
        let session = subject.shown.session;
        let frame = ui.ctx().cumulative_frame_nr();
        let place = |pos: Pos2| {
            let at = subject.camera.domain_from_screen(response.rect, pos);
            (at * session.run().domain.radius()).to_array()
        };

        // Two fingers move the picture: what the first of them began is no stroke.
        let is_gesture = matches!(hand, Hand::Gesture | Hand::Cancelled);
        let begins = response.drag_started_by(PointerButton::Primary)
            || response.clicked_by(PointerButton::Primary);
        if begins {
            // A drag begins some points away from its press. A click is found when the press is over, and has no origin any more.
            let origin = ui.input(|input| input.pointer.press_origin());
            let from = origin.or(response.interact_pointer_pos());
            drawn.path = from.map(place).into_iter().collect();
            drawn.made_at = None;
        }
        if is_gesture {
            drawn = Drawn::default();
        }

        let is_drawing = drawn.made_at.is_none() && !drawn.path.is_empty();
        if is_drawing && let Some(pos) = response.interact_pointer_pos() {
            self.go_on(
                &mut drawn.path,
                place(pos),
                session.size_radii() * session.run().domain.radius(),
            );
        }
        let ends = response.drag_stopped_by(PointerButton::Primary)
            || response.clicked_by(PointerButton::Primary);
        if is_drawing && ends {
            let stroke = PaintCommand::Stroke(drawn.path.clone());
            commands.push(Command::Form(FormCommand::Paint(stroke)));
            drawn.made_at = Some((session.generation, frame));
        }

        // A stroke is drawn until the session of its run is shown. If its run was refused, no session comes, and the
        // stroke is drawn until a run would have begun.
        let is_over = drawn.made_at.is_some_and(|(generation, made)| {
            let waits = self.is_sampling || frame < made + FRAMES;
            generation != session.generation || !waits
        });
        if is_over {
            drawn = Drawn::default();
        }

        self.draw(ui, response, subject, &drawn.path);
        ui.data_mut(|data| data.insert_temp(id, drawn));
    }

    /// Adds a place to a path, unless it is too near the last one to make a difference.
    fn go_on(&self, path: &mut Vec<[f64; 2]>, at: [f64; 2], size: DVec2) {
        let step = STEP * self.brush.size * size.max_element();
        let is_far = path
            .last()
            .is_none_or(|last| DVec2::from(*last).distance(at.into()) >= step);
        if is_far {
            path.push(at);
        }
    }

    /// Draws a stroke and the brush. The brush is at the pointer. Without a pointer it is in the middle of the canvas, where keys
    /// paint, as long as the canvas has the focus.
    fn draw(&self, ui: &Ui, response: &Response, subject: &Subject<'_>, path: &[[f64; 2]]) {
        let session = subject.shown.session;
        let painter = ui.painter_at(response.rect);
        let reach = self.brush.size * session.size_radii().max_element() * subject.camera.scale;
        let reach = reach as f32;
        let unit = session.run().domain.radius();
        let on_screen = |at: &[f64; 2]| {
            subject
                .camera
                .screen_from_domain(response.rect, DVec2::from(*at) / unit)
        };

        let accent = self.palette.accent;
        let faint =
            egui::Color32::from_rgba_unmultiplied(accent.r(), accent.g(), accent.b(), OPACITY);
        let places: Vec<Pos2> = path.iter().map(on_screen).collect();
        // A soft brush acts most within half of its radius, so that the line is as wide as its radius.
        match &places[..] {
            [] => {}
            [at] => {
                painter.circle_filled(*at, 0.5 * reach, faint);
            }
            _ => {
                painter.add(Shape::line(places.clone(), Stroke::new(reach, faint)));
            }
        }

        let by_keys = response.has_focus().then(|| response.rect.center());
        if let Some(at) = response.hover_pos().or(by_keys) {
            ring(&painter, at, reach, accent);
        }
    }
}

/// Draws the border of the brush.
fn ring(painter: &Painter, at: Pos2, reach: f32, color: egui::Color32) {
    painter.circle_stroke(at, reach, Stroke::new(1.5, color));
}
