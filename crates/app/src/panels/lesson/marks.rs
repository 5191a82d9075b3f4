//! The marks of a lesson over the canvas: samples that the question names, the samples and points to choose from, and
//! the answer. Begin with [`show`]. Sizes are in screen points, and chosen, not measured, where no reason stands beside
//! them.

use egui::{
    Color32, FontId, Id, LayerId, Order, Painter, Pos2, Rect, Stroke, StrokeKind, Ui, Vec2, pos2,
    vec2,
};
use glam::DVec2;
use tilescope_classroom::lessons::{Mark, OpenLesson};
use tilescope_drawing::camera::Camera;
use tilescope_drawing::labels::{Labelled, places};
use tilescope_drawing::palette::Palette;
use tilescope_lessons::{MarkKind, Segment};
use tilescope_ui::language::Worded;
use tilescope_ui::theme::semibold;
use tilescope_workbench::state::State;

/// Room between a label and the sides of its ground.
const MARGIN: f32 = 3.0;

/// Shows the marks of the current step. In a periodic domain each mark has many images, and the one nearest to the
/// middle of the view is shown. The box and the lines of a question are shown in the domain itself.
pub fn show(ui: &Ui, state: &State) {
    let Some(open) = &state.lessons().open else {
        return;
    };
    let run = &state.runs().first;
    let (Some(session), viewport) = (&run.session, run.viewport) else {
        return;
    };
    // Before the first frame was laid out there is no canvas to draw on.
    if !viewport.is_positive() {
        return;
    }

    let layer = LayerId::new(Order::Middle, Id::unique("marks of the lesson"));
    let is_periodic = session.run().domain.is_periodic();
    let overlay = Overlay {
        painter: ui.ctx().layer_painter(layer).with_clip_rect(viewport),
        palette: Palette::of(state.appearance().look),
        viewport,
        camera: run.camera,
        period: is_periodic.then(|| session.size_radii()),
    };
    // Marks are drawn last, over the lines and circles, and their labels keep clear of the labels of circles.
    overlay.lines(open);
    let strip = overlay.strips(open);
    let mut taken = overlay.circles(ui, open);
    taken.extend(overlay.marks(&open.marks(), &taken));

    // The label of a strip comes last, and keeps clear of the marks and of their labels.
    if let Some((place, width)) = strip {
        overlay.strip_label(place, ui.words(format!("{width} r")), &taken);
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

    /// Draws the box that the question is about, the line that is chosen, and after the answer the outermost of
    /// the correct lines.
    fn lines(&self, open: &OpenLesson) {
        let Some(lines) = open.lines() else {
            return;
        };
        let (painter, palette) = (&self.painter, self.palette);
        // Both ends are drawn in the domain itself: of each end alone, the image nearest to the middle of the view
        // might belong to another copy of the domain.
        let ends = |segment: Segment| segment.map(|end| self.fixed(end.into()));
        let [low, high] = ends(lines.outline);
        let rect = Rect::from_two_pos(low, high);
        let stroke = Stroke::new(2.5, palette.accent);
        painter.rect_stroke(rect, 0.0, stroke, StrokeKind::Inside);

        for correct in lines.right {
            painter.line_segment(ends(correct), Stroke::new(2.5, palette.inserted));
        }
        if let Some(chosen) = lines.chosen {
            painter.line_segment(ends(chosen), Stroke::new(3.0, palette.candidate));
        }
    }

    /// Draws the circles of a question that is closed, each with its radius at its top. Returns the grounds of the labels.
    fn circles(&self, ui: &Ui, open: &OpenLesson) -> Vec<Rect> {
        let circles = open.circles().into_iter().map(|(center, radius)| {
            let at = self.screen(center);
            let reach = (radius * self.camera.scale) as f32;
            let color = self.palette.inserted;
            self.painter
                .circle_stroke(at, reach, Stroke::new(2.0, color));
            let label = ui.words(format!("{radius} r"));
            self.label(pos2(at.x, at.y - reach - 20.0), label, color)
        });
        circles.collect()
    }

    /// A question may be about the strip along the edges of each block. Once the question is closed, this draws the
    /// inner edges of the strips. Returns the place on an inner edge that is nearest to the middle of the view, for the
    /// label, and the width of the strips in r; `None` while the question is open, for a question without strips, and
    /// if no block has an inner edge, as all blocks are too narrow.
    fn strips(&self, open: &OpenLesson) -> Option<(Pos2, f64)> {
        // Each inside is the part of a block that its strip surrounds.
        let (insides, width) = open.strips()?;
        let drawn = insides.into_iter().map(|[low, high]| {
            // Both corners are moved by the same periods, so that they belong to one image of the block.
            let middle = 0.5 * (low + high);
            let by = self.screen(middle) - self.fixed(middle);
            Rect::from_two_pos(self.fixed(low), self.fixed(high)).translate(by)
        });
        let drawn: Vec<Rect> = drawn.collect();
        let stroke = Stroke::new(2.0, self.palette.inserted);
        for inside in &drawn {
            self.painter
                .rect_stroke(*inside, 0.0, stroke, StrokeKind::Middle);
        }

        let middle = self.viewport.center();
        let away = |inside: &&Rect| inside.distance_to_pos(middle);
        let nearest = drawn.iter().min_by(|a, b| away(a).total_cmp(&away(b)))?;
        Some((nearest_on_edge(nearest, middle), width))
    }

    /// Writes the width of a strip beside a place on its line, where it covers least of the rectangles `taken`.
    fn strip_label(&self, at: Pos2, label: String, taken: &[Rect]) {
        let labelled = Labelled {
            at,
            radius: 2.0,
            size: self.ground(&label),
        };
        let place = places(&[labelled], taken, self.viewport)[0];
        let color = self.palette.inserted;
        self.label(place.min + vec2(MARGIN, 0.0), label, color);
    }

    /// Draws marks as circles, each with its label or, where it has none, with a cross. Labels keep clear of the
    /// rectangles `taken`. Returns the rectangles around the marks and their labels.
    fn marks(&self, marks: &[Mark], taken: &[Rect]) -> Vec<Rect> {
        // The arms of a cross reach 13 points around its place, so that a part of one beyond the border may be in view.
        let near = self.viewport.expand(20.0);
        let drawn: Vec<(&Mark, Pos2)> = marks
            .iter()
            .map(|mark| (mark, self.screen(mark.at)))
            .filter(|(_, at)| near.contains(*at))
            .collect();
        let labelled: Vec<Labelled> = drawn
            .iter()
            .map(|&(mark, at)| {
                let (_, radius) = self.stroke(mark.kind);
                let size = self.ground(&mark.label);
                Labelled { at, radius, size }
            })
            .collect();
        let label_places = places(&labelled, taken, self.viewport);

        for (&(mark, at), place) in drawn.iter().zip(&label_places) {
            let (stroke, radius) = self.stroke(mark.kind);
            self.painter.circle_stroke(at, radius, stroke);
            if mark.label.is_empty() {
                for (dx, dy) in [(1.0, 0.0), (0.0, 1.0)] {
                    let arm = vec2(dx, dy) * 13.0;
                    self.painter.line_segment([at - arm, at + arm], stroke);
                }
            } else {
                self.label(
                    place.min + vec2(MARGIN, 0.0),
                    mark.label.clone(),
                    stroke.color,
                );
            }
        }
        let rings = labelled.iter().map(Labelled::ring);
        rings.chain(label_places).collect()
    }

    /// Returns the stroke and the radius of a mark.
    fn stroke(&self, kind: MarkKind) -> (Stroke, f32) {
        let palette = self.palette;
        let (color, width, radius) = match kind {
            MarkKind::Named => (palette.halo, 1.5, 8.0),
            MarkKind::Listed => (palette.accent, 1.5, 8.0),
            MarkKind::Chosen => (palette.candidate, 3.0, 9.0),
            MarkKind::Right => (palette.inserted, 3.0, 9.0),
        };
        (Stroke::new(width, color), radius)
    }

    /// Returns the size of the ground of a label, zero without one.
    fn ground(&self, label: &str) -> Vec2 {
        if label.is_empty() {
            return Vec2::ZERO;
        }
        let font = FontId::new(13.0, semibold());
        let galley = self
            .painter
            .layout_no_wrap(label.to_owned(), font, self.palette.text);
        galley.size() + vec2(2.0 * MARGIN, 0.0)
    }

    /// Writes a label on a ground of its own, from its upper left corner. Returns the ground.
    fn label(&self, corner: Pos2, text: String, color: Color32) -> Rect {
        let font = FontId::new(13.0, semibold());
        let galley = self.painter.layout_no_wrap(text, font, color);
        let back = Rect::from_min_size(corner, galley.size()).expand2(vec2(MARGIN, 0.0));
        let ground = self.palette.panel.gamma_multiply(0.85);
        self.painter.rect_filled(back, 3.0, ground);
        self.painter.galley(corner, galley, color);
        back
    }
}

/// Returns the place on the edge of a rectangle that is nearest to another place.
fn nearest_on_edge(rect: &Rect, at: Pos2) -> Pos2 {
    if !rect.contains(at) {
        return rect.clamp(at);
    }
    let sides = [
        pos2(rect.left(), at.y),
        pos2(rect.right(), at.y),
        pos2(at.x, rect.top()),
        pos2(at.x, rect.bottom()),
    ];
    let away = |side: &Pos2| side.distance_sq(at);
    let nearest = sides.into_iter().min_by(|a, b| away(a).total_cmp(&away(b)));
    nearest.unwrap_or(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_label_of_a_strip_stands_on_its_line_from_inside_and_outside() {
        let rect = Rect::from_min_max(pos2(10.0, 20.0), pos2(110.0, 80.0));
        for (at, nearest) in [
            (pos2(20.0, 50.0), pos2(10.0, 50.0)),
            (pos2(60.0, 75.0), pos2(60.0, 80.0)),
            (pos2(0.0, 50.0), pos2(10.0, 50.0)),
            (pos2(200.0, 0.0), pos2(110.0, 20.0)),
        ] {
            assert_eq!(nearest_on_edge(&rect, at), nearest, "{at:?}");
        }
    }
}
