//! Darts of exact tiling: the cells that throw them, those that wait, and those that were refused, with their blockers.
//! Sizes are in screen points; they and opacities are chosen, not measured, where no reason stands beside them.

use emath::{Rect, Vec2};
use tilescope_core::{Point, Stage};
use tilescope_debugger::NONE;
use tilescope_session::layers::Layer;
use tilescope_session::units::{position, radii};

use crate::scene::Scene;
use crate::surface::{Mark, NO_GROWTH, Stroke, Surface};

/// Below this many screen points to an r, lines to blockers would be a tangle.
const MIN_SCALE_OF_LINES: f32 = 14.0;

/// Half the side of the smallest square that shows a cell, in screen points: the last cells hold one lattice point.
const LEAST_HALF: f32 = 1.5;

/// Draws the cells that throw darts at the level that is shown, the darts that it refused, and those that wait. They
/// take the places of detectors, of eliminated samples and of candidates, whose layers switch them on.
pub fn draw(scene: &Scene<'_>, surface: &mut impl Surface) {
    // Darts are read from recorded events.
    let Some(debugger) = scene.shown.debugger else {
        return;
    };

    if scene.has(Layer::Detectors)
        && let Stage::Iterate(k) = scene.stage
    {
        cells(scene, surface, k);
    }

    let (recording, cursor) = (debugger.recording(), debugger.state().cursor());
    if scene.has(Layer::Eliminated) {
        // Darts that earlier levels refused are not drawn: the level that is shown begins where the stage before it ends, or
        // with the recording.
        let index = scene.session.stage_index(scene.stage);
        let before = index.checked_sub(1);
        let start = before.and_then(|before| scene.session.stage_end(before));
        for (dart, by) in recording.refused(start.unwrap_or(0)..cursor) {
            refused(scene, surface, dart, by);
        }
    }

    if scene.has(Layer::Candidates) {
        let radius = (0.3 * scene.scale()).clamp(1.4, 8.0);
        for dart in recording.waiting(cursor) {
            if is_seen(scene, dart) {
                let at = scene.point(dart);
                let color = scene.palette.candidate;
                surface.mark(Mark::Triangle, at, [radius, NO_GROWTH], color);
            }
        }
    }
}

/// Draws the cells that throw darts at a level. Levels are the iterations of exact tiling.
fn cells(scene: &Scene<'_>, surface: &mut impl Surface, level: u32) {
    let Some(iteration) = scene.session.iteration(level) else {
        return;
    };
    let color = scene.palette.detector;
    let (fill, stroke) = (color.gamma_multiply(0.18), Stroke::new(1.0, color));
    let end = scene.session.size_radii();
    for cell in &iteration.cells {
        // A cell may reach beyond its block, where it throws no darts. It is cut off only beyond the domain, where it would
        // stand out.
        let side = radii(cell.side);
        let low = position(cell.min);
        let corners = [low, (low + side).min(end)].map(|at| scene.at(at));
        let square = Rect::from_two_pos(corners[0], corners[1]);
        // The last cells hold one lattice point, which is far smaller than a pixel.
        let least = Rect::from_center_size(square.center(), Vec2::splat(2.0 * LEAST_HALF));
        let shown = square.union(least);
        if shown.intersects(scene.rect) {
            surface.rect(shown, Some(fill), Some(stroke));
        }
    }
}

/// Draws a refused dart, and the line to its blocker where there is room.
fn refused(scene: &Scene<'_>, surface: &mut impl Surface, dart: Point, by: u32) {
    if !is_seen(scene, dart) {
        return;
    }
    let (at, color) = (scene.point(dart), scene.palette.muted);
    let size = (0.1 * scene.scale()).clamp(1.2, 4.0);
    surface.mark(Mark::Cross, at, [size, NO_GROWTH], color);
    if by != NONE && scene.scale() >= MIN_SCALE_OF_LINES {
        let blocker = scene.session.image_near(by, position(dart));
        let stroke = Stroke::new(0.8, color.gamma_multiply(0.7));
        surface.line([at, scene.at(blocker)], stroke);
    }
}

fn is_seen(scene: &Scene<'_>, place: Point) -> bool {
    scene.rect.expand(12.0).contains(scene.point(place))
}
