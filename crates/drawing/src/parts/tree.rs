//! The KD-tree: the lines of all splits made so far, thicker for earlier ones in a branch, and their numbers. Sizes are
//! in screen points; they and opacities are chosen, not measured, where no reason stands beside them.

use emath::{Align2, Pos2, Rect, vec2};
use tilescope_core::stages::blocks::{Axis, Split};
use tilescope_core::{RunEvent, Stage};
use tilescope_debugger::Event;
use tilescope_session::units::radii;

use crate::scene::Scene;
use crate::surface::{Stroke, Surface, Tag};

/// The length of a line, relative to its number's width, from which the number is shown: at the stage of the
/// blocks, and later.
const MIN_LENGTHS: [f32; 2] = [2.0, 4.0];
/// The width of the first split's line, in screen points.
const MAX_WIDTH: f32 = 6.0;
/// The width of the lines deep in the tree.
const MIN_WIDTH: f32 = 1.2;
/// Wider lines are drawn before the others: on the canvas they are strokes by themselves, whereas thinner ones share a
/// texture.
const WIDE: f32 = 2.0;
/// The width of a line relative to its parent's.
const TAPER: f32 = 0.76;

/// Returns the splits made so far, with their numbers and the visible parts of their lines.
fn visible<'a>(scene: &'a Scene<'_>) -> impl Iterator<Item = (usize, &'a Split, [Pos2; 2])> {
    let splits = &scene.session.run().blocks.splits[..scene.made.splits];
    let numbered = (1..).zip(splits);
    numbered.filter_map(|(number, split)| {
        let rect = &split.rect;
        let (low, high) = match split.axis {
            Axis::X => ([split.plane, rect.min.y], [split.plane, rect.max.y]),
            Axis::Y => ([rect.min.x, split.plane], [rect.max.x, split.plane]),
        };
        let ends = [low, high].map(|end| scene.at(end.map(radii)));
        let seen = scene.visible_line(ends, MAX_WIDTH)?;
        Some((number, split, seen))
    })
}

/// Returns the width of a split's line, in screen points.
fn width(split: &Split) -> f32 {
    (MAX_WIDTH * TAPER.powi(split.depth as i32)).max(MIN_WIDTH)
}

/// Draws the lines of the splits, with a halo around the one that was just made.
pub fn lines(scene: &Scene<'_>, surface: &mut impl Surface) {
    // Splits are numbered from 1, so that no split has the number 0.
    let just_made = match scene.shown.last_event().and_then(Event::run_event) {
        Some(RunEvent::Split { index, .. }) => index as usize + 1,
        _ => 0,
    };

    // The tree is dimmed where samples are shown.
    let presence = if scene.stage == Stage::Blocks {
        1.0
    } else {
        0.5
    };
    let color = scene.palette.text.gamma_multiply(presence);

    // The halo of the line that was just made lies below all lines.
    for (number, split, ends) in visible(scene) {
        if number == just_made {
            surface.line(ends, Stroke::new(width(split) + 5.0, scene.palette.accent));
        }
    }

    // In the order of the splits the canvas would change between strokes and the texture of thin lines again and again.
    // As lines hardly cross, another order looks the same.
    for is_wide in [true, false] {
        for (_, split, ends) in visible(scene) {
            let line_width = width(split);
            if (line_width > WIDE) == is_wide {
                surface.line(ends, Stroke::new(line_width, color));
            }
        }
    }
}

/// Draws the numbers of the lines that are long enough for them, earlier splits first if there is no room for all.
pub fn numbers(scene: &Scene<'_>, surface: &mut impl Surface) {
    let mut taken: Vec<Rect> = Vec::new();
    let palette = scene.palette;
    let min_length = MIN_LENGTHS[usize::from(scene.stage > Stage::Blocks)];

    for (number, _, [from, to]) in visible(scene) {
        let (text, size, padding) = (number.to_string(), 11.5, vec2(5.0, 2.0));
        let middle = from.lerp(to, 0.5);

        let rect = Align2::CENTER_CENTER.anchor_size(middle, surface.text_size(&text, size));
        let ground = rect.expand2(padding);

        let is_long_enough = (to - from).length() >= min_length * ground.width();
        // Splits come in the order in which they were made, so that the earlier of two keeps its place.
        if !is_long_enough || taken.iter().any(|other| other.intersects(ground)) {
            continue;
        }

        // Two points more on each side keep two numbers apart.
        taken.push(ground.expand(2.0));
        surface.tag(&Tag {
            text,
            pos: middle,
            anchor: Align2::CENTER_CENTER,
            size,
            ink: palette.text,
            ground: palette.panel,
            border: Some(Stroke::new(1.0, palette.text)),
            padding,
            rounding: 8.0,
        });
    }
}
