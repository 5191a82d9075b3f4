//! egui's surface for the parts of a picture: collects their lines, marks and disks into a few meshes.

use egui::epaint::{CircleShape, RectShape};
use egui::{Color32, FontId, Painter, Pos2, Rect, Shape, StrokeKind, Vec2, pos2};
use tilescope_drawing::surface::{Arc, Mark, Stroke, Surface, Tag};
use tilescope_drawing::{DISK_FILL, DISK_RING};
use tilescope_ui::language::Worded;

use crate::sprites::{Sprite, Sprites};
use crate::strokes::{Stamps, Strokes};

/// Disks larger than this are drawn as circles, not as sprites, in screen points.
const MAX_DISK_SPRITE: f32 = 160.0;
/// Wider lines are drawn as egui strokes: the texture of a thin line would blur their sides.
const MAX_SOFT_WIDTH: f32 = 2.0;
/// The number of kinds of stamps: disks, and every kind of mark.
const STAMPS: usize = 1 + Mark::ALL.len();

/// Shapes of one part.
pub struct Sheet<'a> {
    painter: &'a Painter,
    sprites: &'a mut Sprites,
    shapes: Vec<Shape>,
    /// Lines added since the last shape of another kind.
    strokes: Option<Strokes>,
    /// Disks, then marks by kind.
    stamps: [Option<Stamps>; STAMPS],
}

impl<'a> Sheet<'a> {
    /// Creates an empty sheet. Text is laid out with the fonts of `painter`.
    pub fn new(painter: &'a Painter, sprites: &'a mut Sprites) -> Self {
        Self {
            painter,
            sprites,
            shapes: Vec::new(),
            strokes: None,
            stamps: [const { None }; STAMPS],
        }
    }

    /// Returns the shapes drawn.
    pub fn into_shapes(mut self) -> Vec<Shape> {
        self.end_strokes();
        let stamps = self.stamps.into_iter().flatten();
        self.shapes.extend(stamps.map(Stamps::into_shape));
        self.shapes
    }

    fn strokes(&mut self) -> &mut Strokes {
        let (sprites, painter) = (&mut *self.sprites, self.painter);
        self.strokes
            .get_or_insert_with(|| Strokes::new(sprites, painter.ctx()))
    }

    fn end_strokes(&mut self) {
        let strokes = self.strokes.take();
        self.shapes.extend(strokes.map(Strokes::into_shape));
    }

    fn add(&mut self, shape: Shape) {
        self.end_strokes();
        self.shapes.push(shape);
    }

    fn stamps(&mut self, kind: usize, sprite: Sprite, radius: f32) -> &mut Stamps {
        let (sprites, painter) = (&mut *self.sprites, self.painter);
        self.stamps[kind].get_or_insert_with(|| Stamps::of(sprites, painter.ctx(), sprite, radius))
    }

    /// Returns a text in the language of the window.
    fn words(&self, english: &str) -> String {
        self.painter.ctx().words(english)
    }

    /// Returns a rectangle snapped to whole pixels: neighbours then leave no gap and do not overlap.
    fn snapped(&self, rect: Rect) -> Rect {
        let pixels = self.painter.ctx().pixels_per_point();
        let snap = |value: f32| (value * pixels).round() / pixels;
        let corner = |at: Pos2| pos2(snap(at.x), snap(at.y));
        Rect::from_min_max(corner(rect.min), corner(rect.max))
    }
}

fn line(stroke: Stroke) -> egui::Stroke {
    egui::Stroke::new(stroke.width, stroke.color)
}

impl Surface for Sheet<'_> {
    fn rect(&mut self, rect: Rect, fill: Option<Color32>, stroke: Option<Stroke>) {
        self.add(match (fill, stroke) {
            (Some(fill), None) => Shape::rect_filled(self.snapped(rect), 0.0, fill),
            (fill, stroke) => {
                let kind = fill.map_or(StrokeKind::Middle, |_| StrokeKind::Outside);
                let fill = fill.unwrap_or(Color32::TRANSPARENT);
                let stroke = stroke.map_or(egui::Stroke::NONE, line);
                RectShape::new(rect, 0.0, fill, stroke, kind).into()
            }
        });
    }

    fn line(&mut self, ends: [Pos2; 2], stroke: Stroke) {
        if stroke.width > MAX_SOFT_WIDTH {
            self.add(Shape::line_segment(ends, line(stroke)));
        } else {
            self.strokes()
                .segment(ends[0], ends[1], stroke.width, stroke.color);
        }
    }

    fn dashes(&mut self, ends: [Pos2; 2], stroke: Stroke) {
        self.strokes()
            .dashes(ends[0], ends[1], stroke.width, stroke.color);
    }

    fn circle(&mut self, center: Pos2, radius: f32, fill: Option<Color32>, stroke: Option<Stroke>) {
        let fill = fill.unwrap_or(Color32::TRANSPARENT);
        let stroke = stroke.map_or(egui::Stroke::NONE, line);
        let circle = CircleShape {
            center,
            radius,
            fill,
            stroke,
        };
        self.add(circle.into());
    }

    fn arc(&mut self, center: Pos2, radius: f32, arc: Arc, stroke: Stroke) {
        self.strokes()
            .arc(center, radius, arc, stroke.width, stroke.color);
    }

    fn disk(&mut self, center: Pos2, radius: f32, color: Color32) {
        if radius <= MAX_DISK_SPRITE {
            self.stamps(0, Sprite::Disk, radius).add(center, color);
            return;
        }
        let ring = Stroke::new(0.9, color.gamma_multiply(DISK_RING));
        let fill = color.gamma_multiply(DISK_FILL);
        self.circle(center, radius, Some(fill), Some(ring));
    }

    fn mark(&mut self, mark: Mark, center: Pos2, [radius, growth]: [f32; 2], color: Color32) {
        let sprite = match mark {
            Mark::Cross => Sprite::Cross,
            Mark::Dot => Sprite::Dot,
            Mark::Diamond => Sprite::Diamond,
            Mark::Detector => Sprite::Detector,
            Mark::Triangle => Sprite::Triangle,
            Mark::Halo => Sprite::Halo,
        };
        self.stamps(1 + mark as usize, sprite, radius)
            .add_larger(center, growth, color);
    }

    fn outline(&mut self, corners: &[Pos2], stroke: Stroke) {
        self.add(Shape::closed_line(corners.to_vec(), line(stroke)));
    }

    fn tag(&mut self, tag: &Tag) {
        let font = FontId::monospace(tag.size);
        let galley = self
            .painter
            .layout_no_wrap(self.words(&tag.text), font, tag.ink);
        let rect = tag.anchor.anchor_size(tag.pos, galley.size());

        let ground = rect.expand2(tag.padding);
        let border = tag.border.map_or(egui::Stroke::NONE, line);
        let kind = StrokeKind::Inside;
        let plate = RectShape::new(ground, tag.rounding, tag.ground, border, kind);
        self.add(plate.into());
        self.add(Shape::galley(rect.min, galley, tag.ink));
    }

    fn text_size(&self, text: &str, size: f32) -> Vec2 {
        let font = FontId::monospace(size);
        let galley = self
            .painter
            .layout_no_wrap(self.words(text), font, Color32::WHITE);
        galley.size()
    }

    fn reserve(&mut self, lines: usize) {
        self.strokes().reserve(lines);
    }
}
