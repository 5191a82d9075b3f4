//! The building blocks that there are at the moment: tints, borders, numbers, and the clips around them.

use egui::{Color32, FontId, Pos2, Rect, Shape, Stroke, StrokeKind, vec2};
use tilescope_core::Stage;

use super::paint::Scene;
use super::sprites::Sprites;
use super::strokes::Strokes;

/// Blocks at least this wide show their number, in screen points.
pub const MIN_LABELLED: f32 = 84.0;
/// How strong the tints are: while nothing but blocks is shown, and later.
pub const TINTS: [f32; 2] = [0.20, 0.085];

fn visible(scene: &Scene<'_>) -> impl Iterator<Item = (u32, Rect)> {
    let leaves = &scene.session.run().blocks.leaves[..scene.made.leaves];
    let rects = leaves.iter().map(|block| scene.lattice_rect(&block.rect));
    let numbered = (0..).zip(rects);
    numbered.filter(|(_, rect)| rect.intersects(scene.rect))
}

/// Returns the tints of the blocks.
pub fn tints(scene: &Scene<'_>) -> Vec<Shape> {
    let strength = TINTS[usize::from(scene.stage != Stage::Blocks)];
    let tint = |(index, rect)| {
        let color = scene.palette.block(index).gamma_multiply(strength);
        Shape::rect_filled(rect, 0.0, color)
    };
    visible(scene).map(tint).collect()
}

/// Returns the borders of the blocks.
pub fn borders(scene: &Scene<'_>) -> Vec<Shape> {
    let border = |(index, rect)| {
        let color = scene.palette.block(index).gamma_multiply(0.55);
        Shape::rect_stroke(rect, 0.0, Stroke::new(1.0, color), StrokeKind::Middle)
    };
    visible(scene).map(border).collect()
}

/// Draws the numbers of the blocks where there is room. Text is laid out anew for each frame: its glyphs may move.
pub fn numbers(scene: &Scene<'_>) {
    for (index, rect) in visible(scene) {
        if rect.width().min(rect.height()) >= MIN_LABELLED {
            let corner = rect.intersect(scene.rect).left_top();
            number(scene, index, corner, scene.palette.block(index));
        }
    }
}

fn number(scene: &Scene<'_>, index: u32, corner: Pos2, color: Color32) {
    let painter = scene.painter;
    let galley = painter.layout_no_wrap(index.to_string(), FontId::monospace(11.0), color);
    let tag = Rect::from_min_size(corner, galley.size() + vec2(9.0, 5.0));
    let ground = scene.palette.domain.gamma_multiply(0.86);
    painter.rect_filled(tag, 0.0, ground);
    painter.galley(corner + vec2(4.5, 2.5), galley, color);
}

/// Returns each block enlarged by r, dashed.
pub fn clips(scene: &Scene<'_>, sprites: &mut Sprites) -> Vec<Shape> {
    let mut strokes = Strokes::new(sprites, scene.painter.ctx());
    for (index, rect) in visible(scene) {
        // Dashing what is far outside the view could take millions of dashes.
        let clip = rect
            .expand(scene.scale())
            .intersect(scene.rect.expand(20.0));
        let corners = [
            clip.left_top(),
            clip.right_top(),
            clip.right_bottom(),
            clip.left_bottom(),
            clip.left_top(),
        ];
        let color = scene.palette.block(index).gamma_multiply(0.9);
        for ends in corners.windows(2) {
            strokes.dashes(ends[0], ends[1], 1.0, color);
        }
    }
    vec![strokes.into_shape()]
}
