//! The seams of a combination: the lines along which its sets meet, and the band around them that gluing may touch.

use crate::scene::Scene;
use crate::surface::{Stroke, Surface};

/// The width of a seam, in screen points.
const WIDTH: f32 = 1.6;
/// The opacity of the band's tint.
const TINT: f32 = 0.10;

pub fn band(scene: &Scene<'_>, surface: &mut impl Surface) {
    let Some(combination) = &scene.session.combination else {
        return;
    };
    let tint = scene.palette.accent.gamma_multiply(TINT);
    let rects = combination.band.iter().map(|rect| scene.lattice_rect(rect));
    for rect in rects.filter(|rect| rect.intersects(scene.rect)) {
        surface.rect(rect, Some(tint), None);
    }
}

pub fn lines(scene: &Scene<'_>, surface: &mut impl Surface) {
    let Some(combination) = &scene.session.combination else {
        return;
    };
    let stroke = Stroke::new(WIDTH, scene.palette.accent);
    for ends in &combination.lines {
        if let Some(ends) = scene.visible_line(ends.map(|end| scene.at(end)), WIDTH) {
            surface.line(ends, stroke);
        }
    }
}
