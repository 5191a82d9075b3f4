//! Meshes of many symbols, lines, dashes and arcs: one shape instead of thousands.

use egui::{Color32, Mesh, Pos2, Rect, Shape, Vec2, pos2};
use tilescope_drawing::surface::Arc;

use crate::UNIT;
use crate::sprites::{Sprite, Sprites, Stamp};

/// Half the width of the line that the stroke's picture shows, in screen points.
const HALF_WIDTH: f32 = 0.7;

/// A mesh of one symbol at many positions.
pub struct Stamps {
    stamp: Stamp,
    mesh: Mesh,
}

impl Stamps {
    /// Returns a mesh of `sprite` for symbols of `radius` screen points.
    pub fn of(sprites: &mut Sprites, ctx: &egui::Context, sprite: Sprite, radius: f32) -> Self {
        let stamp = sprites.stamp(ctx, sprite, radius);
        Self {
            stamp,
            mesh: sprites.mesh(stamp.texture),
        }
    }

    pub fn add(&mut self, pos: Pos2, color: Color32) {
        self.add_larger(pos, 0.0, color);
    }

    /// Adds a symbol enlarged by `by` screen points on every side.
    pub fn add_larger(&mut self, pos: Pos2, by: f32, color: Color32) {
        let side = 2.0 * (self.stamp.half + by);
        let rect = Rect::from_center_size(pos, Vec2::splat(side));
        self.mesh.add_rect_with_uv(rect, UNIT, color);
    }

    pub fn into_shape(self) -> Shape {
        Shape::mesh(self.mesh)
    }
}

/// A mesh of lines, soft on both sides.
pub struct Strokes {
    /// Half the width of the texture per screen point of line width.
    half_per_width: f32,
    mesh: Mesh,
}

impl Strokes {
    pub fn new(sprites: &mut Sprites, ctx: &egui::Context) -> Self {
        let stamp = sprites.stamp(ctx, Sprite::Stroke, HALF_WIDTH);
        Self {
            half_per_width: stamp.half / (2.0 * HALF_WIDTH),
            mesh: sprites.mesh(stamp.texture),
        }
    }

    /// Makes room for `count` segments.
    pub fn reserve(&mut self, count: usize) {
        self.mesh.vertices.reserve(4 * count);
        self.mesh.indices.reserve(6 * count);
    }

    /// Adds a line of `width` screen points.
    pub fn segment(&mut self, from: Pos2, to: Pos2, width: f32, color: Color32) {
        let along = to - from;
        // `length` calls a function that guards against overflow.
        let length = along.length_sq().sqrt();
        if length > 0.0 {
            let across = along.rot90() * (width * self.half_per_width / length);
            self.quad(from, to, across, color);
        }
    }

    fn quad(&mut self, from: Pos2, to: Pos2, across: Vec2, color: Color32) {
        self.pair(from, across, color);
        self.pair(to, across, color);
        self.join();
    }

    /// Adds the two vertices across a line at one of its ends.
    fn pair(&mut self, at: Pos2, across: Vec2, color: Color32) {
        let side = |pos, v| egui::epaint::Vertex {
            pos,
            uv: pos2(0.5, v),
            color,
        };
        let sides = [side(at - across, 0.0), side(at + across, 1.0)];
        self.mesh.vertices.extend_from_slice(&sides);
    }

    /// Adds the quad between the last two pairs of vertices.
    fn join(&mut self) {
        let last = self.mesh.vertices.len() as u32;
        let [a, b, c, d] = [last - 4, last - 3, last - 2, last - 1];
        self.mesh.indices.extend_from_slice(&[a, b, c, c, b, d]);
    }

    /// Adds a dashed line; dashes are shorter on short lines.
    pub fn dashes(&mut self, from: Pos2, to: Pos2, width: f32, color: Color32) {
        let length = (to - from).length_sq().sqrt();
        // A line of less than half a point is not visible.
        if length < 0.5 {
            return;
        }

        // On a short line long dashes would look like a whole one. The lengths are chosen, not measured.
        let (dash, gap) = if length > 24.0 {
            (6.0, 4.0)
        } else {
            (2.5, 1.5)
        };

        let along = (to - from) / length;
        let across = along.rot90() * (width * self.half_per_width);

        let mut start = 0.0;
        while start < length {
            let ends = [start, (start + dash).min(length)].map(|t| from + along * t);
            self.quad(ends[0], ends[1], across, color);
            start += dash + gap;
        }
    }

    /// Adds an arc: `sweep` radians from the angle `from`, both with y upwards.
    pub fn arc(
        &mut self,
        center: Pos2,
        radius: f32,
        Arc { from, sweep }: Arc,
        width: f32,
        color: Color32,
    ) {
        // The polygon stays within a tenth of a point of the arc: a chord of the angle `a` is off by radius * a^2 / 8.
        // A radius below a point counts as one, which keeps the division from 0. The limits of the steps are chosen.
        let step = 2.0 * (2.0 * 0.1 / radius.max(1.0)).sqrt();
        let steps = (sweep.abs() / step).ceil().clamp(2.0, 512.0) as u32;

        for k in 0..=steps {
            let (sin, cos) = (from + sweep * k as f32 / steps as f32).sin_cos();
            let outwards = Vec2::new(cos, -sin);
            let across = outwards * (width * self.half_per_width);
            self.pair(center + outwards * radius, across, color);
            if k > 0 {
                self.join();
            }
        }
    }

    pub fn into_shape(self) -> Shape {
        Shape::mesh(self.mesh)
    }
}

/// Cached shapes of layers, valid for one key.
pub struct KeptShapes<K> {
    key: Option<K>,
    layers: Vec<Option<Vec<Shape>>>,
}

impl<K> Default for KeptShapes<K> {
    fn default() -> Self {
        Self {
            key: None,
            layers: Vec::new(),
        }
    }
}

impl<K: PartialEq> KeptShapes<K> {
    /// Clears the cache if the key changed; returns the shapes that were in it.
    pub fn follow(&mut self, key: K) -> Vec<Shape> {
        if self.key.as_ref() == Some(&key) {
            return Vec::new();
        }
        self.key = Some(key);
        self.layers.drain(..).flatten().flatten().collect()
    }

    /// Returns the shapes of a layer, made now if they are not cached.
    pub fn layer(&mut self, number: usize, make: impl FnOnce() -> Vec<Shape>) -> Vec<Shape> {
        if self.layers.len() <= number {
            self.layers.resize(number + 1, None);
        }
        self.layers[number].get_or_insert_with(make).clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh_of(shape: &Shape) -> &Mesh {
        match shape {
            Shape::Mesh(mesh) => mesh,
            other => panic!("{other:?}"),
        }
    }

    fn strokes() -> Strokes {
        let ctx = egui::Context::default();
        Strokes::new(&mut Sprites::default(), &ctx)
    }

    #[test]
    fn a_segment_lies_between_its_ends() {
        let mut strokes = strokes();
        strokes.segment(pos2(10.0, 20.0), pos2(50.0, 20.0), 2.0, Color32::RED);
        let shape = strokes.into_shape();
        let bounds = mesh_of(&shape).calc_bounds();
        assert!((bounds.left() - 10.0).abs() < 1e-4 && (bounds.right() - 50.0).abs() < 1e-4);
        assert!((bounds.center().y - 20.0).abs() < 1e-4);
        assert!(bounds.height() >= 2.0);
    }

    #[test]
    fn an_arc_is_round() {
        let mut strokes = strokes();
        let (center, radius) = (pos2(5.0, 7.0), 40.0);
        strokes.arc(
            center,
            radius,
            Arc {
                from: 0.0,
                sweep: std::f32::consts::PI,
            },
            1.4,
            Color32::RED,
        );
        let shape = strokes.into_shape();
        let mesh = mesh_of(&shape);
        let mut lowest = 0.0_f32;
        for pair in mesh.vertices.chunks(2) {
            let middle = pair[0].pos + (pair[1].pos - pair[0].pos) / 2.0;
            assert!((middle.distance(center) - radius).abs() < 0.01);
            lowest = lowest.max(middle.y - center.y);
        }
        assert!(lowest < 0.01, "the upper half, as y points upwards");
        assert_eq!(mesh.indices.len() / 6, mesh.vertices.len() / 2 - 1);
    }

    #[test]
    fn layers_are_kept_until_the_key_changes() {
        let mut kept = KeptShapes::default();
        let mut made = 0;
        for (key, expected) in [(1, 1), (1, 1), (2, 2), (2, 2), (1, 3)] {
            let old = kept.follow(key);
            assert_eq!(old.is_empty(), made == expected || made == 0, "{key}");
            let shapes = kept.layer(3, || {
                made += 1;
                vec![Shape::Noop]
            });
            assert_eq!(shapes.len(), 1);
            assert_eq!(made, expected, "{key}");
        }
    }
}
