//! The marks of a lesson over the canvas: samples that the question names, the samples and points to choose from, and
//! the answer. Begin with [`show`].

use egui::{FontId, Id, LayerId, Order, Painter, Pos2, Rect, Stroke, StrokeKind, Ui, pos2, vec2};
use glam::DVec2;
use tilescope_drawing::camera::Camera;
use tilescope_drawing::palette::Palette;
use tilescope_ui::language::Worded;
use tilescope_ui::theme::semibold;
use tilescope_workbench::lessons::{Mark, MarkKind, OpenLesson};
use tilescope_workbench::state::State;

/// Shows the marks of the current step, each as its image nearest to the middle of the view.
pub fn show(ui: &Ui, state: &State) {
    let Some(open) = &state.lessons.open else {
        return;
    };
    let run = &state.runs.first;
    let (Some(session), viewport) = (&run.session, run.viewport) else {
        return;
    };
    if !viewport.is_positive() {
        return;
    }

    let layer = LayerId::new(Order::Middle, Id::unique("marks of the lesson"));
    let is_periodic = session.run().domain.is_periodic();
    let overlay = Overlay {
        painter: ui.ctx().layer_painter(layer).with_clip_rect(viewport),
        palette: Palette::of(state.appearance.look),
        viewport,
        camera: run.camera,
        period: is_periodic.then(|| session.size_radii()),
    };
    overlay.cuts(open);
    overlay.circles(ui, open);
    let marks = open.marks();
    for mark in &marks {
        overlay.mark(mark, &marks);
    }
}

/// The layer of the marks, and where places of the domain are on it.
struct Overlay {
    painter: Painter,
    palette: &'static Palette,
    viewport: Rect,
    camera: Camera,
    /// The size of a periodic domain, in r.
    period: Option<DVec2>,
}

impl Overlay {
    /// Returns where a place is, of its images the one nearest to the middle of the view.
    fn screen(&self, at: DVec2) -> Pos2 {
        let turns = |size: DVec2| ((at - self.camera.center) / size).round() * size;
        let by = self.period.map_or(DVec2::ZERO, turns);
        self.fixed(at - by)
    }

    /// Returns where a place of the domain is.
    fn fixed(&self, at: DVec2) -> Pos2 {
        self.camera.screen_from_domain(self.viewport, at)
    }

    /// Draws the box that is to be cut, the cut that is chosen, and after the answer the outermost legal ones.
    fn cuts(&self, open: &OpenLesson) {
        let Some(([low, high], line)) = open.cut() else {
            return;
        };
        let (painter, palette) = (&self.painter, self.palette);
        let rect = Rect::from_two_pos(self.fixed(low), self.fixed(high));
        let stroke = Stroke::new(2.5, palette.accent);
        painter.rect_stroke(rect, 0.0, stroke, StrokeKind::Inside);

        for ends in open.outer_cuts().into_iter().flatten() {
            let ends = ends.map(|end| self.fixed(end));
            painter.line_segment(ends, Stroke::new(2.5, palette.inserted));
        }
        if let Some(ends) = line {
            let ends = ends.map(|end| self.fixed(end));
            painter.line_segment(ends, Stroke::new(3.0, palette.candidate));
        }
    }

    /// Draws the circles of a question that is closed, each with its radius at its top.
    fn circles(&self, ui: &Ui, open: &OpenLesson) {
        for (center, radius) in open.circles() {
            let at = self.screen(center);
            let reach = (radius * self.camera.scale) as f32;
            let color = self.palette.inserted;
            self.painter
                .circle_stroke(at, reach, Stroke::new(2.0, color));
            let label = ui.words(format!("{radius} r"));
            self.label(pos2(at.x, at.y - reach - 20.0), label, color);
        }
    }

    /// Draws a mark with its label, or as a cross if it has none.
    fn mark(&self, mark: &Mark, all: &[Mark]) {
        let at = self.screen(mark.at);
        // Of a mark beyond the border a part may be in view.
        if !self.viewport.expand(20.0).contains(at) {
            return;
        }
        let palette = self.palette;
        let (color, width, radius) = match mark.kind {
            MarkKind::Named => (palette.halo, 1.5, 8.0),
            MarkKind::Listed => (palette.accent, 1.5, 8.0),
            MarkKind::Chosen => (palette.candidate, 3.0, 9.0),
            MarkKind::Right => (palette.inserted, 3.0, 9.0),
        };
        let stroke = Stroke::new(width, color);
        self.painter.circle_stroke(at, radius, stroke);
        if mark.label.is_empty() {
            for (dx, dy) in [(1.0, 0.0), (0.0, 1.0)] {
                let arm = vec2(dx, dy) * 13.0;
                self.painter.line_segment([at - arm, at + arm], stroke);
            }
            return;
        }

        // The label is on the side away from the nearest other mark, so that labels do not cover each other.
        let others = all.iter().map(|other| at - self.screen(other.at));
        let nearest = others
            .filter(|away| away.length() > 0.5)
            .min_by(|a, b| a.length().total_cmp(&b.length()));
        let is_left = nearest.is_some_and(|away| away.x < 0.0 && away.length() < 60.0);
        let font = FontId::new(13.0, semibold());
        let galley = self.painter.layout_no_wrap(mark.label.clone(), font, color);
        let side = if is_left {
            -radius - 2.0 - galley.size().x
        } else {
            radius + 2.0
        };
        let top = at.y - radius - galley.size().y + 4.0;
        self.label(pos2(at.x + side, top), mark.label.clone(), color);
    }

    /// Writes a label on a ground of its own, from its upper left corner.
    fn label(&self, corner: Pos2, text: String, color: egui::Color32) {
        let font = FontId::new(13.0, semibold());
        let galley = self.painter.layout_no_wrap(text, font, color);
        let back = Rect::from_min_size(corner, galley.size()).expand2(vec2(3.0, 0.0));
        let ground = self.palette.panel.gamma_multiply(0.85);
        self.painter.rect_filled(back, 3.0, ground);
        self.painter.galley(corner, galley, color);
    }
}
