//! The inset of the tiling stage: the pattern in a corner of the picture, with the window from which the current
//! block's samples come. Sizes are in screen points; they and opacities are chosen, not measured, where no reason
//! stands beside them.

use ecolor::Color32;
use emath::{Align2, Pos2, Rect, pos2, vec2};
use tilescope_core::stages::tile::Tile;
use tilescope_core::{Origin, R, Rect as LatticeRect, Standing};
use tilescope_session::units::size;

use crate::scene::Scene;
use crate::surface::{Mark, NO_GROWTH, Stroke, Surface};

/// The side of the inset as a share of the picture's shorter side, and its limits in screen points.
const SHARE: f32 = 0.3;
const SIDES: [f32; 2] = [110.0, 300.0];
/// The distance to the picture's side, in screen points.
const MARGIN: f32 = 14.0;
/// The distance to the picture's upper edge, below the buttons of the projector mode.
const TOP_MARGIN: f32 = 38.0;
/// How far the frame reaches around the pattern, in screen points.
const FRAME: f32 = 6.0;
/// In a lower or narrower picture the inset would cover too much.
const MIN_PICTURE: f32 = 260.0;
/// Of a pattern with more samples only those of the window are drawn.
const MAX_DRAWN: usize = 30_000;

/// Draws the inset while a block is being tiled.
pub fn draw(scene: &Scene<'_>, surface: &mut impl Surface) {
    let run = scene.session.run();
    let block = scene.shown.context().and_then(|context| context.block);
    let tile = block.and_then(|block| run.tiles.get(block as usize));
    let (Some(block), Some(tile)) = (block, tile) else {
        return;
    };

    let leaf = &run.blocks.leaves[block as usize].rect;
    let block_rect = scene.lattice_rect(leaf);
    let Some(inset) = Inset::beside(scene, block_rect) else {
        return;
    };
    ground(scene, surface, &inset);

    let color = scene.palette.block(block);
    let last_copy = draw_copied(scene, surface, &inset, tile, color);
    let extent = run.pattern.domain().rect().max;
    for piece in window(tile, leaf, [extent.x, extent.y]) {
        let [low, high] = piece.map(|[x, y]| inset.at(x, y));
        surface.rect(
            Rect::from_two_pos(low, high),
            None,
            Some(Stroke::new(1.8, color)),
        );
    }

    // A line leads from the pattern to the last copy, and grows while the event is animated. Before the first copy the clip
    // itself comes in.
    let share = scene.subject.drawn_in;
    if let Some((id, from)) = last_copy {
        let to = scene.at(scene.session.position(id));
        let stroke = Stroke::new(1.2, color.gamma_multiply(0.8));
        surface.dashes([from, from.lerp(to, share)], stroke);
    } else {
        let whole = whole_window(tile, leaf, [extent.x, extent.y]);
        fly(scene, surface, &inset, whole, block_rect, color);
    }

    // The label stands four points below the frame, and begins or ends at its side.
    let (below, anchor) = if inset.is_left {
        (
            inset.rect.left_bottom() + vec2(-FRAME, FRAME + 4.0),
            Align2::LEFT_TOP,
        )
    } else {
        (
            inset.rect.right_bottom() + vec2(FRAME, FRAME + 4.0),
            Align2::RIGHT_TOP,
        )
    };
    let text = format!("clip of block {block} in the pattern");
    scene.tag(surface, below, anchor, text);
}

/// The pattern on the screen.
struct Inset {
    rect: Rect,
    /// Screen points per r.
    scale: f32,
    /// Whether it is in the left corner.
    is_left: bool,
}

impl Inset {
    /// Returns the inset in a corner away from a block; `None` in a picture that is too small for it.
    fn beside(scene: &Scene<'_>, block: Rect) -> Option<Self> {
        let room = scene.rect.size().min_elem();
        if room < MIN_PICTURE {
            return None;
        }

        let size_in_r = size(scene.session.run().pattern.domain()).as_vec2();
        let side = (SHARE * room).clamp(SIDES[0], SIDES[1]);
        let scale = side / size_in_r.max_element();
        let extent = vec2(size_in_r.x, size_in_r.y) * scale;

        // The inset is not drawn over the block, which it would hide.
        let is_left = block.center().x > scene.rect.center().x;
        let left = if is_left {
            scene.rect.left() + MARGIN
        } else {
            scene.rect.right() - MARGIN - extent.x
        };
        Some(Self {
            rect: Rect::from_min_size(pos2(left, scene.rect.top() + TOP_MARGIN), extent),
            scale,
            is_left,
        })
    }

    /// Returns the position on the screen of a place of the pattern, in lattice units.
    fn at(&self, x: i32, y: i32) -> Pos2 {
        let units = vec2(x as f32, -y as f32) / R as f32;
        self.rect.left_bottom() + units * self.scale
    }

    /// Returns the radius of a sample's dot, in screen points.
    fn dot(&self) -> f32 {
        (0.2 * self.scale).clamp(0.7, 3.0)
    }
}

/// Draws the frame of the inset, and the pattern in it.
fn ground(scene: &Scene<'_>, surface: &mut impl Surface, inset: &Inset) {
    let palette = scene.palette;
    surface.rect(
        inset.rect.expand(FRAME),
        Some(palette.panel),
        Some(Stroke::new(1.0, palette.line)),
    );
    surface.rect(
        inset.rect,
        Some(palette.domain),
        Some(Stroke::new(1.0, palette.border)),
    );

    let positions = scene.session.run().pattern.samples();
    // Of a larger pattern only the samples of the window are drawn, by `draw_copied`.
    if positions.len() <= MAX_DRAWN {
        let color = palette.sample.gamma_multiply(0.4);
        for point in positions {
            let at = inset.at(point.x, point.y);
            surface.mark(Mark::Dot, at, [inset.dot(), NO_GROWTH], color);
        }
    }
}

/// Draws the samples of the pattern whose copies are in the block by now, and returns the last copy and where it comes from.
fn draw_copied(
    scene: &Scene<'_>,
    surface: &mut impl Surface,
    inset: &Inset,
    tile: &Tile,
    color: Color32,
) -> Option<(u32, Pos2)> {
    let run = scene.session.run();
    let positions = run.pattern.samples();
    let mut last: Option<(u32, Pos2)> = None;
    for id in tile.samples.clone() {
        // Only tiled samples are copies of samples of the pattern.
        let Origin::Tiled { pattern, .. } = run.samples.origins[id as usize] else {
            continue;
        };
        // The ids of the whole block are known, but some of its samples may still be to come.
        if scene.shown.standing(id) == Standing::Absent {
            continue;
        }
        // Origins in a run without a pattern are placeholders.
        let Some(point) = positions.get(pattern as usize) else {
            continue;
        };

        // The mark is a little larger than the dot of the pattern that it covers.
        let from = inset.at(point.x, point.y);
        surface.mark(Mark::Dot, from, [inset.dot() + 0.7, NO_GROWTH], color);
        last = Some((id, from));
    }
    last
}

/// Draws a clip on its way from the pattern to the block, while its event is animated. `window` has two opposite corners of
/// the clip in the pattern.
fn fly(
    scene: &Scene<'_>,
    surface: &mut impl Surface,
    inset: &Inset,
    window: [[i32; 2]; 2],
    block: Rect,
    color: Color32,
) {
    let share = scene.subject.drawn_in;
    // At rest the clip has arrived in the block.
    if share >= 1.0 {
        return;
    }

    // The clip is the block enlarged by r. It grows on its way from the pattern's scale to the picture's scale, and a clip that
    // was turned on its side gets the block's proportions.
    let [one, opposite] = window.map(|[x, y]| inset.at(x, y));
    let from = Rect::from_two_pos(one, opposite);
    let clip = block.expand(scene.scale());
    let rect = Rect::from_min_max(
        from.min.lerp(clip.min, share),
        from.max.lerp(clip.max, share),
    );
    surface.rect(
        rect,
        Some(color.gamma_multiply(0.18)),
        Some(Stroke::new(2.0, color)),
    );
}

/// Returns the part of the pattern that a tile was clipped from, in lattice units: rectangles, each by two opposite
/// corners, more than one where the clip reaches across the border of a periodic pattern.
fn window(tile: &Tile, block: &LatticeRect, extent: [i32; 2]) -> Vec<[[i32; 2]; 2]> {
    // The clip's position is given in the pattern after it was turned and mirrored.
    let turned = if tile.symmetry.0 & SWAPPED != 0 {
        [extent[1], extent[0]]
    } else {
        extent
    };

    // A clip across the border of a periodic pattern goes on at the other side. No piece is longer than the pattern.
    let ranges = |start: i32, length: i32, period: i32| {
        let end = start + length;
        let mut pieces = vec![[start, end.min(period)]];
        if end > period {
            pieces.push([0, (end - period).min(period)]);
        }
        pieces
    };

    // The clip is the block enlarged by r on each side.
    let columns = ranges(tile.start.x, block.width() + 2 * R, turned[0]);
    let rows = ranges(tile.start.y, block.height() + 2 * R, turned[1]);

    let pieces = columns
        .iter()
        .flat_map(|x| rows.iter().map(move |y| [[x[0], y[0]], [x[1], y[1]]]));
    pieces
        .map(|corners| corners.map(|at| turned_back(tile, at, extent)))
        .collect()
}

/// Returns two opposite corners of the part of the pattern that a tile was clipped from, in lattice units, without a cut at
/// the border of a periodic pattern.
fn whole_window(tile: &Tile, block: &LatticeRect, extent: [i32; 2]) -> [[i32; 2]; 2] {
    let start = [tile.start.x, tile.start.y];
    let end = [
        start[0] + block.width() + 2 * R,
        start[1] + block.height() + 2 * R,
    ];
    [start, end].map(|at| turned_back(tile, at, extent))
}

/// The bit of a symmetry that swaps the axes. Bits 0 and 1 mirror x and y.
const SWAPPED: u8 = 4;

/// Returns a place of the pattern, in lattice units, that lies at `at` after the tile's symmetry was applied.
fn turned_back(tile: &Tile, [x, y]: [i32; 2], extent: [i32; 2]) -> [i32; 2] {
    let symmetry = tile.symmetry.0;
    // The axes are swapped last, so that this is undone first.
    let [x, y] = if symmetry & SWAPPED != 0 {
        [y, x]
    } else {
        [x, y]
    };
    let mirrored =
        |at: i32, bit: u8, extent: i32| if symmetry & bit == 0 { at } else { extent - at };
    [mirrored(x, 1, extent[0]), mirrored(y, 2, extent[1])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_core::{Parameters, Point, Unobserved, sample};

    /// Every sample of a tile lies in its window, and the window has its area.
    #[test]
    fn the_window_holds_the_samples_of_its_tile() {
        for dihedral in [false, true] {
            let parameters = Parameters {
                dihedral,
                radius: 0.02,
                ..Parameters::default()
            };
            let run = sample(&parameters, &mut Unobserved).expect("a run");
            let extent = run.pattern.domain().rect().max;
            for (tile, block) in run.tiles.iter().zip(&run.blocks.leaves) {
                let pieces = window(tile, &block.rect, [extent.x, extent.y]);
                let area = |[a, b]: &[[i32; 2]; 2]| {
                    i64::from((a[0] - b[0]).abs()) * i64::from((a[1] - b[1]).abs())
                };
                let whole =
                    i64::from(block.rect.width() + 2 * R) * i64::from(block.rect.height() + 2 * R);
                assert_eq!(pieces.iter().map(area).sum::<i64>(), whole);
                // A window that does not reach across the border is one piece, and the clip begins its way there.
                if let [piece] = pieces[..] {
                    let all = whole_window(tile, &block.rect, [extent.x, extent.y]);
                    assert_eq!(piece, all);
                }
                let holds = |[a, b]: &[[i32; 2]; 2], p: Point| {
                    let within =
                        |at: i32, k: usize| (a[k].min(b[k])..=a[k].max(b[k])).contains(&at);
                    within(p.x, 0) && within(p.y, 1)
                };
                for id in tile.samples.clone() {
                    let Origin::Tiled { pattern, .. } = run.samples.origins[id as usize] else {
                        panic!("sample {id} is of no tile");
                    };
                    let point = run.pattern.samples()[pattern as usize];
                    assert!(pieces.iter().any(|piece| holds(piece, point)), "{id}");
                }
            }
        }
    }
}
