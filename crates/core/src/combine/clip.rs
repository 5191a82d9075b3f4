//! What a piece contributes: the samples of its set in its rectangle, and in the margin of r around it as far as
//! the set goes on. It never looks at another piece's samples.

use rayon::prelude::*;

use super::Piece;
use super::layout::continues;
use crate::lattice::{Domain, Point, R};
use crate::pattern::Symmetry;

/// A piece's contribution.
pub(super) struct Clip {
    /// Samples in the margin and near it, by y, then x, each with its index in the set. Places are the result's, where they
    /// are before a periodic domain wraps.
    pub near: Vec<(i64, i64, u32)>,
    /// Samples deeper inside than what was asked for.
    pub deep: Vec<(Point, u32)>,
}

/// Returns every piece's contribution; samples more than `reach` units inside their rectangle are deep.
pub(super) fn clips(domain: &Domain, pieces: &[Piece], reach: i32) -> Vec<Clip> {
    let each = pieces.par_iter().with_max_len(1);
    each.map(|piece| clip(domain, pieces, piece, reach))
        .collect()
}

fn clip(domain: &Domain, pieces: &[Piece], piece: &Piece, reach: i32) -> Clip {
    let (rect, variant) = (piece.rect, piece.set.variant(Symmetry(0)));
    let twins = twins(domain, pieces, piece);
    let (from_x, width) = margined(piece.start.x, rect.width(), variant.width, variant.periodic);
    let (from_y, height) = margined(
        piece.start.y,
        rect.height(),
        variant.height,
        variant.periodic,
    );
    let wrapped = |from: i64, extent: i32| from.rem_euclid(extent.into()) as i32;
    let start = Point::new(
        wrapped(from_x, variant.width),
        wrapped(from_y, variant.height),
    );
    let mut clip = Clip {
        near: Vec::new(),
        deep: Vec::new(),
    };
    let corner = (
        i64::from(rect.min.x) - i64::from(piece.start.x) + from_x,
        i64::from(rect.min.y) - i64::from(piece.start.y) + from_y,
    );
    variant.clip(start, width, height, |x, y, index| {
        let (x, y) = (corner.0 + i64::from(x), corner.1 + i64::from(y));
        // Places in the rectangle have 32-bit coordinates; those of the margin are not in it.
        let point = Point::new(x as i32, y as i32);
        let own = i64::from(point.x) == x && i64::from(point.y) == y && rect.contains(point);
        if own && rect.depth(point) > reach {
            clip.deep.push((point, index));
        } else if own || !twins.iter().any(|twin| twin.contains(x, y)) {
            clip.near.push((y, x, index));
        }
    });
    clip.near.sort_unstable();
    for sample in &mut clip.near {
        *sample = (sample.1, sample.0, sample.2);
    }
    clip
}

/// Returns where a clip of `side` units from `start` on begins in its set, and how long it is, when it is
/// enlarged by r on both ends as far as the set goes.
fn margined(start: i32, side: i32, extent: i32, periodic: bool) -> (i64, i32) {
    let low = i64::from(start) - i64::from(R);
    let high = i64::from(start) + i64::from(side) + i64::from(R);
    let (low, high) = if periodic {
        (low, high)
    } else {
        (low.max(0), high.min(extent.into()))
    };
    (low, (high - low) as i32)
}

/// A rectangle of the plane.
struct Twin {
    min: [i64; 2],
    max: [i64; 2],
}

impl Twin {
    fn contains(&self, x: i64, y: i64) -> bool {
        (self.min[0]..self.max[0]).contains(&x) && (self.min[1]..self.max[1]).contains(&y)
    }
}

/// Returns the rectangles around a piece in which the set goes on as it is: there the piece's margin
/// would only repeat samples that are there.
fn twins(domain: &Domain, pieces: &[Piece], piece: &Piece) -> Vec<Twin> {
    let mut twins = Vec::new();
    let periodic = domain.is_periodic();
    let shifts = |side: i32| {
        let side = i64::from(side);
        let sides: &[i64] = if periodic { &[-1, 0, 1] } else { &[0] };
        sides.iter().map(move |k| k * side)
    };
    for other in pieces {
        for dx in shifts(domain.width()) {
            for dy in shifts(domain.height()) {
                let itself = std::ptr::eq(other, piece) && dx == 0 && dy == 0;
                if !itself && continues(piece, other, [dx, dy]) {
                    let (min, max) = (other.rect.min, other.rect.max);
                    twins.push(Twin {
                        min: [i64::from(min.x) + dx, i64::from(min.y) + dy],
                        max: [i64::from(max.x) + dx, i64::from(max.y) + dy],
                    });
                }
            }
        }
    }
    twins
}
