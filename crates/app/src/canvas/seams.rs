//! The seams of a combination: the lines along which its sets meet, and the band around them that gluing may touch.

use egui::{Rect, Shape, pos2};
use tilescope_session::layers::Layer;

use super::paint::Scene;
use super::sprites::Sprites;
use super::strokes::Strokes;

/// The width of a seam, in screen points.
const WIDTH: f32 = 1.6;
/// How strong the band's tint is.
const TINT: f32 = 0.10;

/// Returns the band, tinted.
pub fn band(scene: &Scene<'_>) -> Vec<Shape> {
    let Some(combination) = shown(scene) else {
        return Vec::new();
    };
    let tint = scene.palette.accent.gamma_multiply(TINT);
    // Neighbours share an edge: on whole pixels neither a gap nor a darker line shows between them.
    let pixels = scene.painter.ctx().pixels_per_point();
    let snap = |value: f32| (value * pixels).round() / pixels;
    let rects = combination.band.iter().map(|rect| scene.lattice_rect(rect));
    let seen = rects.filter(|rect| rect.intersects(scene.rect));
    let snapped = seen.map(|rect| {
        let (min, max) = (rect.min, rect.max);
        Rect::from_min_max(
            pos2(snap(min.x), snap(min.y)),
            pos2(snap(max.x), snap(max.y)),
        )
    });
    snapped
        .map(|rect| Shape::rect_filled(rect, 0.0, tint))
        .collect()
}

/// Returns the seams as lines.
pub fn lines(scene: &Scene<'_>, sprites: &mut Sprites) -> Vec<Shape> {
    let mut strokes = Strokes::new(sprites, scene.painter.ctx());
    if let Some(combination) = shown(scene) {
        for &[from, to] in &combination.lines {
            let line = scene.screen_rect(from, to);
            let seen = line.intersect(scene.rect.expand(WIDTH));
            if seen.min.x <= seen.max.x && seen.min.y <= seen.max.y {
                strokes.segment(seen.min, seen.max, WIDTH, scene.palette.accent);
            }
        }
    }
    vec![strokes.into_shape()]
}

fn shown<'a>(scene: &Scene<'a>) -> Option<&'a tilescope_session::combination::Combination> {
    let combination = scene.session.combination.as_ref();
    combination.filter(|_| scene.has(Layer::Seams))
}
