//! The KD-tree: the line of every split that was made by now, the thicker the earlier in its branch, numbered as they
//! were made.

use egui::{Align2, FontId, Pos2, Rect, Shape, Stroke, pos2, vec2};
use tilescope_core::stages::blocks::{Axis, Split};
use tilescope_core::{Moment, Stage};
use tilescope_debugger::Event;
use tilescope_session::moment::Shown;
use tilescope_session::units::radii;

use super::paint::Scene;
use super::sprites::Sprites;
use super::strokes::Strokes;

/// A line has a number if it is so many times as long: while nothing but blocks is shown, and later.
pub const MIN_LENGTHS: [f32; 2] = [2.0, 4.0];
/// Wider lines are drawn as such: the picture of a stroke would make their sides blurred.
const WIDEST_SOFT: f32 = 2.0;
/// The width of the first split's line, in screen points.
const WIDEST: f32 = 6.0;
/// The width of the lines deep in the tree.
const THINNEST: f32 = 1.2;
/// By how much a line is thinner than the one above it.
const TAPER: f32 = 0.76;

/// How many splits and leaves there are at a moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Made {
    pub splits: usize,
    pub leaves: usize,
}

impl Made {
    /// Returns how many there are: all of them unless the moment lies within the stage that makes them.
    pub fn at(shown: &Shown<'_>) -> Self {
        let blocks = &shown.session.run().blocks;
        let mut made = Self {
            splits: blocks.splits.len(),
            leaves: blocks.leaves.len(),
        };
        let Some(debugger) = shown.debugger else {
            return made;
        };
        if shown.stage == Stage::Blocks && !shown.ends_stage() {
            (made.splits, made.leaves) = (0, 0);
            let tape = debugger.recording().tape();
            for (_, event) in tape.from(0).take(shown.cursor()) {
                match event.moment() {
                    Some(Moment::Split { .. }) => made.splits += 1,
                    Some(Moment::Leaf { .. }) => made.leaves += 1,
                    _ => {}
                }
            }
        }
        made
    }
}

/// Returns the splits that were made, with their numbers and the ends of their lines as far as they are in view.
fn visible<'a>(scene: &'a Scene<'_>) -> impl Iterator<Item = (usize, &'a Split, [Pos2; 2])> {
    let splits = &scene.session.run().blocks.splits[..scene.made.splits];
    let numbered = (1..).zip(splits);
    numbered.filter_map(|(number, split)| {
        let rect = &split.rect;
        let (low, high) = match split.axis {
            Axis::X => ([split.plane, rect.min.y], [split.plane, rect.max.y]),
            Axis::Y => ([rect.min.x, split.plane], [rect.max.x, split.plane]),
        };
        let line = scene.screen_rect(low.map(radii), high.map(radii));
        let seen = line.intersect(scene.rect.expand(WIDEST));
        let is_seen = seen.min.x <= seen.max.x && seen.min.y <= seen.max.y;
        is_seen.then_some((number, split, [seen.min, seen.max]))
    })
}

/// Returns how wide the line of a split is, in screen points.
pub fn width(split: &Split) -> f32 {
    (WIDEST * TAPER.powi(split.depth as i32)).max(THINNEST)
}

/// Returns the lines.
pub fn lines(scene: &Scene<'_>, sprites: &mut Sprites) -> Vec<Shape> {
    let mut strokes = Strokes::new(sprites, scene.painter.ctx());
    let just_made = match scene.shown.last_event().and_then(Event::moment) {
        Some(Moment::Split { index, .. }) => index as usize + 1,
        _ => 0,
    };
    let mut wide = Vec::new();
    // Beside samples the tree steps back.
    let presence = if scene.stage == Stage::Blocks {
        1.0
    } else {
        0.5
    };
    let color = scene.palette.text.gamma_multiply(presence);
    for (number, split, [from, to]) in visible(scene) {
        let width = width(split);
        if number == just_made {
            let halo = Stroke::new(width + 5.0, scene.palette.accent);
            wide.push(Shape::line_segment([from, to], halo));
        }
        if width > WIDEST_SOFT {
            wide.push(Shape::line_segment([from, to], Stroke::new(width, color)));
        } else {
            strokes.segment(from, to, width, color);
        }
    }
    wide.push(strokes.into_shape());
    wide
}

/// Draws the numbers: those of earlier splits where there is no room for all.
pub fn numbers(scene: &Scene<'_>) {
    let mut taken: Vec<Rect> = Vec::new();
    let palette = scene.palette;
    let min_lengths = MIN_LENGTHS[usize::from(scene.stage > Stage::Blocks)];
    for (number, _, [from, to]) in visible(scene) {
        let middle = pos2(f32::midpoint(from.x, to.x), f32::midpoint(from.y, to.y));
        let font = FontId::monospace(11.5);
        let text = number.to_string();
        let galley = scene.painter.layout_no_wrap(text, font, palette.text);
        let place = Align2::CENTER_CENTER.anchor_size(middle, galley.size());
        let ground = place.expand2(vec2(5.0, 2.0));
        let long_enough = (to - from).length() >= min_lengths * ground.width();
        if !long_enough || taken.iter().any(|other| other.intersects(ground)) {
            continue;
        }
        taken.push(ground.expand(2.0));
        let stroke = Stroke::new(1.0, palette.text);
        let painter = scene.painter;
        painter.rect(ground, 8.0, palette.panel, stroke, egui::StrokeKind::Inside);
        painter.galley(place.min, galley, palette.text);
    }
}
