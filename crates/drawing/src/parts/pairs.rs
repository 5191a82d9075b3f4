//! The pairs at brushed distances, as edges.

use emath::{Pos2, Rect};

use crate::brushed::Cause;
use crate::scene::Scene;
use crate::surface::{Stroke, Surface};

/// The most edges drawn: those nearest to the middle of the view.
pub const MAX_PAIRS: usize = 20_000;
/// The width of an edge, in screen points.
const WIDTH: f32 = 1.5;

pub fn draw(scene: &Scene<'_>, surface: &mut impl Surface) {
    draw_these(scene, &in_view(scene).0, surface);
}

/// Draws pairs, given by their ends on the screen.
pub fn draw_these(scene: &Scene<'_>, pairs: &[[Pos2; 2]], surface: &mut impl Surface) {
    surface.reserve(pairs.len());
    for ends in pairs {
        surface.line(*ends, Stroke::new(WIDTH, scene.palette.margin));
    }
}

/// Returns the edges in view by their ends on the screen, limited to the [`MAX_PAIRS`] nearest to its middle, and how many there
/// are in all.
#[must_use]
pub fn in_view(scene: &Scene<'_>) -> (Vec<[Pos2; 2]>, usize) {
    // Before tiling there are no samples to join.
    let is_tiled = scene.stage >= tilescope_core::Stage::Tile;
    let cause = scene.subject.causes.map(|found| &found.cause);
    let Some(Cause::Pairs { pairs, .. }) = cause.filter(|_| is_tiled) else {
        return (Vec::new(), 0);
    };

    let all_ends = pairs.iter().map(|pair| {
        let from = scene.session.position(pair.ids[0]);
        [scene.at(from), scene.at(from + pair.offset)]
    });
    let seen = |ends: &[Pos2; 2]| scene.rect.intersects(Rect::from_two_pos(ends[0], ends[1]));
    let mut ends: Vec<[Pos2; 2]> = all_ends.filter(seen).collect();

    let count = ends.len();
    if count > MAX_PAIRS {
        let middle = scene.rect.center();
        let distance = |ends: &[Pos2; 2]| ends[0].lerp(ends[1], 0.5).distance_sq(middle);
        // Which ones are nearest matters, not their order: a selection is faster than sorting.
        ends.select_nth_unstable_by(MAX_PAIRS, |a, b| distance(a).total_cmp(&distance(b)));
        ends.truncate(MAX_PAIRS);
    }

    (ends, count)
}
