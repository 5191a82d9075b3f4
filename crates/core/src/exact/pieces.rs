//! Where a block has each place of the pattern. A block that reaches beyond the pattern's end has parts of several copies.

use glam::{I64Vec2, IVec2};

use crate::lattice::{Point, R, Rect};
use crate::pattern::Symmetry;

/// The part of a block that one copy of the pattern fills. A place of the pattern has one place in the copy, so that
/// nothing wraps within a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SourcePiece {
    /// The index of the block's tile.
    pub(crate) tile: u32,
    /// The places of the pattern that the piece has.
    pub(crate) sources: Rect,
    pub(crate) symmetry: Symmetry,
    /// Where the copy has the pattern's place 0.
    pub(crate) origin: IVec2,
}

impl SourcePiece {
    /// Returns where the copy has a place of the pattern.
    pub(crate) fn place(&self, source: Point) -> Point {
        let turned = self.symmetry.turn(IVec2::new(source.x, source.y));
        // A copy may begin before the first of the integers; what the piece has of it does not.
        let at = self.origin.wrapping_add(turned);
        Point::new(at.x, at.y)
    }

    /// Returns which place of the pattern lies at a place of the domain, if the copy went on beyond its borders.
    pub(crate) fn source(&self, place: Point) -> Point {
        let turned = IVec2::new(place.x, place.y).wrapping_sub(self.origin);
        let source = self.symmetry.turn_back(turned);
        Point::new(source.x, source.y)
    }

    /// Returns what of the pattern lies in a rectangle of the copy, which is not empty.
    pub(crate) fn sources_of(&self, rect: &Rect) -> Rect {
        let last = Point::new(rect.max.x - 1, rect.max.y - 1);
        let [a, b] = [rect.min, last].map(|place| self.source(place));
        spanned(a, b)
    }

    /// Returns which places of the pattern, if the copy went on beyond its borders, lie in a rectangle that holds the piece, and
    /// at most `reach` from the piece.
    pub(crate) fn sources_around(&self, rect: &Rect, reach: i32) -> Rect {
        let Rect { min, max } = self.placed(&self.sources);
        self.sources_of(&Rect {
            min: Point::new(
                min.x.saturating_sub(reach).max(rect.min.x),
                min.y.saturating_sub(reach).max(rect.min.y),
            ),
            max: Point::new(
                max.x.saturating_add(reach).min(rect.max.x),
                max.y.saturating_add(reach).min(rect.max.y),
            ),
        })
    }

    /// Returns where the copy has a rectangle of the pattern, which is not empty.
    pub(crate) fn placed(&self, sources: &Rect) -> Rect {
        let last = Point::new(sources.max.x - 1, sources.max.y - 1);
        let [a, b] = [sources.min, last].map(|source| self.place(source));
        spanned(a, b)
    }
}

/// Returns the pieces of `rect`, a part of a block that is not empty.
///
/// The part, enlarged by r on all sides, is clipped from the pattern, turned by `symmetry` and repeated, as in
/// [`crate::stages::tile`]. `start`, which is not negative, is where the turned pattern has the enlarged part's lowest
/// place. `pattern` is the rectangle of the pattern's places, from 0 on.
pub(crate) fn pieces(
    tile: u32,
    rect: &Rect,
    start: I64Vec2,
    symmetry: Symmetry,
    pattern: &Rect,
) -> Vec<SourcePiece> {
    // How far the turned pattern moves to have its lowest place at 0.
    let corner = symmetry.corner(pattern.max);
    let extent = IVec2::new(pattern.max.x, pattern.max.y);
    // A symmetry may swap the sides.
    let period = symmetry.turn(extent).abs().as_i64vec2();

    // The lowest place of the part, and the first beyond it, in the turned pattern that repeats.
    let first = start + i64::from(R);
    let end = first + I64Vec2::new(rect.width().into(), rect.height().into());

    let mut pieces = Vec::new();
    for row in first.y / period.y..=(end.y - 1) / period.y {
        for column in first.x / period.x..=(end.x - 1) / period.x {
            // The copy's lowest place, and the part's lowest and highest places in it.
            let copy = I64Vec2::new(column, row) * period;
            let [low, high] = [
                (first - copy).max(I64Vec2::ZERO),
                (end - copy).min(period) - 1,
            ];

            let back = |turned: I64Vec2| {
                let source = symmetry.turn_back(turned.as_ivec2() - corner);
                Point::new(source.x, source.y)
            };

            // The copy begins `first - copy` before the part, and has the pattern's place 0 at its `corner`.
            // A place 0 beyond the 32-bit integers keeps its low 32 bits, which is enough for sums that wrap, as in
            // [`SourcePiece::place`].
            let origin = I64Vec2::from(rect.min) - (first - copy) + corner.as_i64vec2();
            pieces.push(SourcePiece {
                tile,
                sources: spanned(back(low), back(high)),
                symmetry,
                origin: origin.as_ivec2(),
            });
        }
    }
    pieces
}

/// Returns the rectangle with two places in opposite corners.
fn spanned(a: Point, b: Point) -> Rect {
    Rect {
        min: Point::new(a.x.min(b.x), a.y.min(b.y)),
        max: Point::new(a.x.max(b.x) + 1, a.y.max(b.y) + 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Boundary;
    use crate::parameters::PatternSpec;
    use crate::pattern::Pattern;
    use crate::progress::Unobserved;

    /// The samples of all pieces are those of the clip, at the same places, for blocks smaller and larger than the pattern.
    #[test]
    fn pieces_hold_what_the_clip_holds() {
        let spec = PatternSpec {
            side: 11.3,
            boundary: Boundary::Periodic,
            seed: 2,
        };
        let pattern = Pattern::generate(&spec, &mut Unobserved).unwrap();
        let held = pattern.domain().rect();
        for symmetry in (0..8).map(Symmetry) {
            let variant = pattern.variant(symmetry);
            for (width, height) in [(5 * R, 3 * R), (13 * R, 40 * R + 7)] {
                let min = Point::new(4 * R, 91);
                let rect = Rect {
                    min,
                    max: Point::new(min.x + width, min.y + height),
                };
                let start = Point::new(variant.width - 9 - R, 5 * R + 3);
                let mut clipped = Vec::new();
                variant.clip(start, width + 2 * R, height + 2 * R, |x, y, id| {
                    let place = Point::new(min.x - R + x, min.y - R + y);
                    if rect.contains(place) {
                        clipped.push((place.row_major(), id));
                    }
                });

                let mut found = Vec::new();
                for piece in pieces(3, &rect, start.into(), symmetry, &held) {
                    for (id, &source) in (0..).zip(pattern.samples()) {
                        if piece.sources.contains(source) {
                            let place = piece.place(source);
                            assert_eq!(piece.source(place), source);
                            found.push((place.row_major(), id));
                        }
                    }
                }
                clipped.sort_unstable();
                found.sort_unstable();
                assert!(clipped.len() > 5);
                assert_eq!(found, clipped);
            }
        }
    }
}
