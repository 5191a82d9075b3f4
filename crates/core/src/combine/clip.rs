//! The contribution of a piece: the samples of its set in its rectangle, and in the margin of r around it if the set
//! extends there. Samples of other pieces are not considered.

use glam::I64Vec2;
use rayon::prelude::*;

use super::Piece;
use super::layout::continues;
use crate::lattice::{Domain, Point, R, Rect64};
use crate::pattern::Symmetry;

/// The samples that a piece contributes.
pub(super) struct Clip {
    /// Samples in the margin and near it, by y, then x, each with its index in the set. Positions are in the result,
    /// before a periodic domain wraps them.
    pub near: Vec<(I64Vec2, u32)>,
    /// Samples deeper inside, each with its index in the set.
    pub deep: Vec<(Point, u32)>,
}

/// Returns every piece's contribution; samples more than `reach` units inside their rectangle are deep.
pub(super) fn clips(domain: &Domain, pieces: &[Piece], reach: i32) -> Vec<Clip> {
    // Pieces may differ much in size: each is a task of its own.
    let each = pieces.par_iter().with_max_len(1);
    each.map(|piece| clip(domain, pieces, piece, reach))
        .collect()
}

/// Returns the contribution of `piece`; samples more than `reach` units inside its rectangle are deep.
fn clip(domain: &Domain, pieces: &[Piece], piece: &Piece, reach: i32) -> Clip {
    // Symmetry 0 leaves the set as it is: sets of pieces are neither turned nor mirrored.
    let (rect, variant) = (piece.rect, piece.set.variant(Symmetry(0)));
    let continued = continuations(domain, pieces, piece);

    // In the set's coordinates the rectangle lies from `start` to `end`, and the clip from `low` to `high`: the
    // rectangle enlarged by r, as far as the set extends.
    let start = I64Vec2::from(piece.start);
    let end = start + I64Vec2::new(rect.width().into(), rect.height().into());
    let (mut low, mut high) = (start - i64::from(R), end + i64::from(R));
    let extent = I64Vec2::new(variant.width.into(), variant.height.into());
    if !variant.periodic {
        (low, high) = (low.max(I64Vec2::ZERO), high.min(extent));
    }

    // The place of the result on which `low` lies.
    let corner = I64Vec2::from(rect.min) - start + low;
    // A clip must begin in the pattern, and a periodic set repeats.
    let wrapped = low.rem_euclid(extent);
    let first = Point::new(wrapped.x as i32, wrapped.y as i32);
    let [width, height] = (high - low).to_array().map(|side| side as i32);

    let (mut near, mut deep) = (Vec::new(), Vec::new());
    variant.clip(first, width, height, |right, up, index| {
        let at = corner + I64Vec2::new(right.into(), up.into());
        // Places of a margin may exceed 32 bits: `point` is then another place, and the sample is not an own one.
        let point = Point::new(at.x as i32, at.y as i32);
        let own = I64Vec2::from(point) == at && rect.contains(point);
        // A sample of the margin is left to a piece in which the set continues: there it is an own one.
        if own && rect.depth(point) > reach {
            deep.push((point, index));
        } else if own || !continued.iter().any(|other| other.contains(at)) {
            near.push((at, index));
        }
    });

    // Near samples are sorted as in the clips of blocks, so that ids follow the rows of the piece. The deep ones get no
    // ids, and their order is made with that of the whole result.
    near.sort_unstable_by_key(|&(at, index)| (at.y, at.x, index));
    Clip { near, deep }
}

/// Returns the rectangles around a piece in which the same set continues unchanged. There the piece's margin would only
/// repeat existing samples.
fn continuations(domain: &Domain, pieces: &[Piece], piece: &Piece) -> Vec<Rect64> {
    let mut found = Vec::new();
    let periodic = domain.is_periodic();

    // In a periodic domain a piece may continue across the border, and continue itself. One side each way is enough: a
    // margin reaches r beyond its rectangle, and the domain is longer than that.
    let shifts = |side: i32| {
        let side = i64::from(side);
        let sides: &[i64] = if periodic { &[-1, 0, 1] } else { &[0] };
        sides.iter().map(move |k| k * side)
    };

    for other in pieces {
        for dx in shifts(domain.width()) {
            for dy in shifts(domain.height()) {
                let shift = I64Vec2::new(dx, dy);
                let itself = std::ptr::eq(other, piece) && shift == I64Vec2::ZERO;
                if !itself && continues(piece, other, shift) {
                    found.push(Rect64::from(other.rect).moved(shift));
                }
            }
        }
    }
    found
}
