//! The building blocks that exist at the moment: tints, borders, numbers, and the clips around them. Sizes are in
//! screen points; they and opacities are chosen, not measured, where no reason stands beside them.

use emath::{Align2, Rect, vec2};
use tilescope_core::Stage;

use crate::scene::Scene;
use crate::surface::{Stroke, Surface, Tag};

/// The shortest side of a block that shows its number, in screen points.
const MIN_LABELLED: f32 = 84.0;
/// The opacity of the tints: at the stage of the blocks, and later.
const TINTS: [f32; 2] = [0.20, 0.085];

fn visible(scene: &Scene<'_>) -> impl Iterator<Item = (u32, Rect)> {
    let leaves = &scene.session.run().blocks.leaves[..scene.made.leaves];
    let rects = leaves.iter().map(|block| scene.lattice_rect(&block.rect));
    let numbered = (0..).zip(rects);
    numbered.filter(|(_, rect)| rect.intersects(scene.rect))
}

pub fn tints(scene: &Scene<'_>, surface: &mut impl Surface) {
    let strength = TINTS[usize::from(scene.stage != Stage::Blocks)];
    for (index, rect) in visible(scene) {
        let color = scene.palette.block(index).gamma_multiply(strength);
        surface.rect(rect, Some(color), None);
    }
}

pub fn borders(scene: &Scene<'_>, surface: &mut impl Surface) {
    for (index, rect) in visible(scene) {
        let color = scene.palette.block(index).gamma_multiply(0.55);
        surface.rect(rect, None, Some(Stroke::new(1.0, color)));
    }
}

/// Draws the numbers of the blocks that have room for them.
pub fn numbers(scene: &Scene<'_>, surface: &mut impl Surface) {
    for (index, rect) in visible(scene) {
        // A number would fill a small block, and many of them would hide the picture.
        if rect.width().min(rect.height()) < MIN_LABELLED {
            continue;
        }

        let padding = vec2(4.5, 2.5);
        surface.tag(&Tag {
            text: index.to_string(),
            // A block that reaches out of the picture keeps its number in sight.
            pos: rect.intersect(scene.rect).left_top() + padding,
            anchor: Align2::LEFT_TOP,
            size: 11.0,
            ink: scene.palette.block(index),
            ground: scene.palette.domain.gamma_multiply(0.86),
            border: None,
            padding,
            rounding: 0.0,
        });
    }
}

/// Draws the clip of each block, dashed: the block enlarged by r, as it is laid on the pattern. While blocks are tiled, only the
/// current one is drawn.
pub fn clips(scene: &Scene<'_>, surface: &mut impl Surface) {
    let is_tiling = scene.stage == Stage::Tile && !scene.shown.ends_stage();
    let context = scene.shown.context().filter(|_| is_tiling);
    let is_drawn = |index: u32| context.is_none_or(|context| context.block == Some(index));
    // The clips of exact tiling are the blocks themselves.
    let margin_in_radii = if scene.session.is_exact() { 0.0 } else { 1.0 };
    // The scale is the screen points in one r.
    let margin = margin_in_radii * scene.scale();

    for (index, rect) in visible(scene).filter(|(index, _)| is_drawn(*index)) {
        // A clip is cut a little outside the view, since there could be millions of dashes farther out.
        let clip = rect.expand(margin).intersect(scene.rect.expand(20.0));

        let corners = [
            clip.left_top(),
            clip.right_top(),
            clip.right_bottom(),
            clip.left_bottom(),
            clip.left_top(),
        ];

        let stroke = Stroke::new(1.0, scene.palette.block(index).gamma_multiply(0.9));
        for ends in corners.array_windows() {
            surface.dashes(*ends, stroke);
        }
    }
}
