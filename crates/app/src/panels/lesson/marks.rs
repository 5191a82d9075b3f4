//! The marks of a lesson over the canvas: samples that the question names, the samples and points to choose from, and
//! the answer.

use egui::{FontId, Id, LayerId, Order, Pos2, Rect, Stroke, StrokeKind, Ui, pos2, vec2};
use glam::DVec2;
use tilescope_drawing::palette::Palette;
use tilescope_ui::theme::semibold;
use tilescope_workbench::lessons::MarkKind;
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
    let palette = Palette::of(state.appearance.look);
    let layer = LayerId::new(Order::Middle, Id::unique("marks of the lesson"));
    let painter = ui.ctx().layer_painter(layer).with_clip_rect(viewport);
    let size = session.size_radii();
    let is_periodic = session.run().domain.is_periodic();
    let screen = |at: DVec2| -> Pos2 {
        let turns = if is_periodic {
            ((at - run.camera.center) / size).round()
        } else {
            DVec2::ZERO
        };
        run.camera.screen_from_domain(viewport, at - turns * size)
    };
    if let Some(([low, high], line)) = open.cut() {
        let rect = Rect::from_two_pos(
            run.camera.screen_from_domain(viewport, low),
            run.camera.screen_from_domain(viewport, high),
        );
        painter.rect_stroke(
            rect,
            0.0,
            Stroke::new(2.5, palette.accent),
            StrokeKind::Inside,
        );
        for [from, to] in open.outer_cuts().into_iter().flatten() {
            let ends = [from, to].map(|end| run.camera.screen_from_domain(viewport, end));
            painter.line_segment(ends, Stroke::new(2.5, palette.inserted));
        }
        if let Some([from, to]) = line {
            let ends = [from, to].map(|end| run.camera.screen_from_domain(viewport, end));
            painter.line_segment(ends, Stroke::new(3.0, palette.candidate));
        }
    }
    let marks = open.marks();
    for mark in &marks {
        let at = screen(mark.at);
        if !viewport.expand(20.0).contains(at) {
            continue;
        }
        let (color, width, radius) = match mark.kind {
            MarkKind::Named => (palette.halo, 1.5, 8.0),
            MarkKind::Listed => (palette.accent, 1.5, 8.0),
            MarkKind::Chosen => (palette.candidate, 3.0, 9.0),
            MarkKind::Right => (palette.inserted, 3.0, 9.0),
        };
        painter.circle_stroke(at, radius, Stroke::new(width, color));
        if mark.label.is_empty() {
            for (dx, dy) in [(1.0, 0.0), (0.0, 1.0)] {
                let arm = vec2(dx, dy) * 13.0;
                painter.line_segment([at - arm, at + arm], Stroke::new(width, color));
            }
            continue;
        }
        let font = FontId::new(13.0, semibold());
        // The label is on the side away from the nearest other mark, so that labels do not cover each other.
        let others = marks.iter().map(|other| at - screen(other.at));
        let nearest = others
            .filter(|away| away.length() > 0.5)
            .min_by(|a, b| a.length().total_cmp(&b.length()));
        let is_left = nearest.is_some_and(|away| away.x < 0.0 && away.length() < 60.0);
        let galley = painter.layout_no_wrap(mark.label.clone(), font, color);
        let left = at.x - radius - 2.0 - galley.size().x;
        let corner = pos2(
            if is_left { left } else { at.x + radius + 2.0 },
            at.y - radius - galley.size().y + 4.0,
        );
        let back = Rect::from_min_size(corner, galley.size()).expand2(vec2(3.0, 0.0));
        painter.rect_filled(back, 3.0, palette.panel.gamma_multiply(0.85));
        painter.galley(corner, galley, color);
    }
}
