//! The surface of pictures in files: the parts of a drawing become shapes of `tilescope_figures` on it.

use ecolor::Color32;
use emath::{Pos2, Rect, Vec2, vec2};
use glam::DVec2;
use tilescope_figures::{
    Anchor, Baseline, Color, Font, Group, Marker, Rect as PictureRect, Shape, Style, Text,
    text_width, with_alpha,
};

use crate::surface::{Arc, Mark, Stroke, Surface, Tag};
use crate::{DISK_FILL, DISK_RING};

/// Circles of a larger radius, in pixels, are left out: within the picture they would be nearly straight lines. Arcs,
/// which are drawn as polygons, have no such limit.
const MAX_CIRCLE: f32 = 10_000.0;
/// The height of a line of text, relative to its font size.
const LINE_HEIGHT: f32 = 1.27;
/// The largest distance of a polygon from the arc that it approximates, in pixels.
const ARC_ERROR: f32 = 0.02;

/// Returns a colour of the window for a picture.
#[must_use]
pub fn color(color: Color32) -> Color {
    let [red, green, blue, alpha] = color.to_srgba_unmultiplied();
    with_alpha([red, green, blue, 255], alpha)
}

pub(super) fn line(stroke: Stroke) -> tilescope_figures::Stroke {
    tilescope_figures::Stroke::new(color(stroke.color), f64::from(stroke.width))
}

pub(super) fn style(fill: Option<Color32>, stroke: Option<Stroke>) -> Style {
    let mut style = fill.map_or_else(Style::default, |fill| Style::filled(color(fill)));
    style.stroke = stroke.map(line);
    style
}

/// Returns a place of the screen for a picture.
#[must_use]
pub fn at(pos: Pos2) -> DVec2 {
    DVec2::new(pos.x.into(), pos.y.into())
}

pub(super) fn rect(rect: Rect) -> PictureRect {
    PictureRect::new(at(rect.min), at(rect.max))
}

/// The shapes of one part.
#[derive(Default)]
pub(super) struct Shapes {
    drawn: Vec<Shape>,
    /// Consecutive lines of one style.
    lines: Vec<[DVec2; 2]>,
    /// The style of these lines, and whether they are dashed.
    stroke: Option<(Stroke, bool)>,
    /// Marks of each kind, in the order of [`Mark::ALL`].
    marks: [Vec<Shape>; Mark::ALL.len()],
}

impl Shapes {
    /// Returns the shapes as a group of this name, followed by groups of marks, in drawing order. Nothing if nothing
    /// was drawn.
    pub(super) fn into_groups(
        mut self,
        name: &'static str,
        clip: Rect,
    ) -> impl Iterator<Item = Group> {
        self.end_lines();
        // Marks lie above the other shapes of their part, kind by kind.
        let marks = Mark::ALL.into_iter().map(Mark::name).zip(self.marks);
        let all = [(name, self.drawn)].into_iter().chain(marks);

        let groups = all.filter(|(_, shapes)| !shapes.is_empty());
        groups.map(move |(name, shapes)| Group {
            clip: Some(rect(clip)),
            shapes,
            ..Group::new(name)
        })
    }

    fn end_lines(&mut self) {
        if let Some((stroke, dashed)) = self.stroke.take() {
            let stroke = line(stroke);
            self.drawn.push(Shape::Segments {
                segments: std::mem::take(&mut self.lines),
                stroke: if dashed {
                    stroke.dashed(6.0, 4.0)
                } else {
                    stroke
                },
            });
        }
    }

    fn add(&mut self, shape: Shape) {
        self.end_lines();
        self.drawn.push(shape);
    }

    fn segment(&mut self, ends: [Pos2; 2], stroke: Stroke, dashed: bool) {
        if self.stroke != Some((stroke, dashed)) {
            self.end_lines();
            self.stroke = Some((stroke, dashed));
        }
        self.lines.push(ends.map(at));
    }
}

impl Surface for Shapes {
    fn rect(&mut self, area: Rect, fill: Option<Color32>, stroke: Option<Stroke>) {
        let (rect, style) = (rect(area), style(fill, stroke));
        self.add(Shape::Rect { rect, style });
    }

    fn line(&mut self, ends: [Pos2; 2], stroke: Stroke) {
        self.segment(ends, stroke, false);
    }

    fn dashes(&mut self, ends: [Pos2; 2], stroke: Stroke) {
        self.segment(ends, stroke, true);
    }

    fn circle(&mut self, center: Pos2, radius: f32, fill: Option<Color32>, stroke: Option<Stroke>) {
        if radius < MAX_CIRCLE {
            let style = style(fill, stroke);
            self.add(Shape::circle(at(center), f64::from(radius), style));
        }
    }

    fn arc(&mut self, center: Pos2, radius: f32, arc: Arc, stroke: Stroke) {
        if arc == Arc::WHOLE {
            return self.circle(center, radius, None, Some(stroke));
        }
        // A chord of a small angle is off its arc by radius * angle^2 / 8: for this one, by ARC_ERROR. The limits of
        // the radius, which may be 0, and of the steps are chosen.
        let step = 2.0 * (2.0 * ARC_ERROR / radius.max(1.0)).sqrt();
        let steps = (arc.sweep.abs() / step).ceil().clamp(2.0, 1_000.0) as u32;

        let on = |k: u32| {
            let (sin, cos) = (arc.from + arc.sweep * k as f32 / steps as f32).sin_cos();
            at(center + vec2(cos, -sin) * radius)
        };

        let points = (0..=steps).map(on).collect();
        self.add(Shape::Polyline {
            points,
            stroke: line(stroke),
        });
    }

    fn disk(&mut self, center: Pos2, radius: f32, color: Color32) {
        let ring = Stroke::new(0.9, color.gamma_multiply(DISK_RING));
        let fill = color.gamma_multiply(DISK_FILL);
        self.circle(center, radius, Some(fill), Some(ring));
    }

    fn mark(&mut self, mark: Mark, center: Pos2, [radius, growth]: [f32; 2], ink: Color32) {
        // The widths below are chosen, not measured.
        let stroked = |width: f32| style(None, Some(Stroke::new(width, ink)));
        let (marker, marker_style) = match mark {
            Mark::Cross => (Marker::Cross, stroked(1.2)),
            Mark::Dot => (Marker::Dot, style(Some(ink), None)),
            Mark::Diamond => (Marker::Diamond, style(Some(ink), None)),
            Mark::Detector => (Marker::Dot, stroked(1.4)),
            Mark::Triangle => (Marker::Triangle, stroked(1.4)),
            Mark::Halo => (Marker::Dot, stroked(2.0)),
        };

        // The width of a mark: twice the radius of its kind and its own growth.
        let size = 2.0 * f64::from(radius + growth);
        let shape = Shape::marker(marker, at(center), size, marker_style);
        self.marks[mark as usize].push(shape);
        // A detector is a ring with a dot, which no marker of the scene has.
        if mark == Mark::Detector {
            let dot = Shape::marker(Marker::Dot, at(center), 0.3 * size, style(Some(ink), None));
            self.marks[mark as usize].push(dot);
        }
    }

    fn outline(&mut self, corners: &[Pos2], stroke: Stroke) {
        self.add(Shape::Polygon {
            points: corners.iter().map(|corner| at(*corner)).collect(),
            style: style(None, Some(stroke)),
        });
    }

    fn tag(&mut self, tag: &Tag) {
        let rect = tag
            .anchor
            .anchor_size(tag.pos, self.text_size(&tag.text, tag.size));
        self.rect(rect.expand2(tag.padding), Some(tag.ground), tag.border);
        let (size, ink) = (f64::from(tag.size), color(tag.ink));
        let mut text = Text::new(at(rect.left_center()), tag.text.clone(), size, ink);
        (text.font, text.anchor, text.baseline) = (Font::Mono, Anchor::Start, Baseline::Middle);
        self.add(Shape::Text(text));
    }

    fn text_size(&self, text: &str, size: f32) -> Vec2 {
        let width = text_width(text, Font::Mono, f64::from(size));
        vec2(width as f32, LINE_HEIGHT * size)
    }
}
