//! The layout of pieces: checks that their rectangles partition the domain, and finds the seams.

use glam::I64Vec2;

use super::{CombineError, MAX_PIECES, Piece};
use crate::lattice::{Domain, Point, R, R_SQUARED, Rect};
use crate::stages::blocks::Axis;

/// A line along which two pieces meet whose sets do not continue each other. In a periodic domain a seam may lie on the
/// left or lower border, between a piece there and one at the opposite border.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Seam {
    /// The lowest point of it.
    pub from: Point,
    /// Its highest end: `x` or `y` is that of the lowest.
    pub to: Point,
    /// The pieces left of it (or below) and right of it (or above).
    pub pieces: [u32; 2],
}

/// Returns rectangles that partition `domain`: `columns` x `rows` of them, row by row, as equal as the lattice allows.
/// No rectangle is empty while there are at least as many lattice points as columns and rows.
#[must_use]
pub fn grid(domain: &Domain, columns: u32, rows: u32) -> Vec<Rect> {
    let max = domain.rect().max;
    let edge = |k: u32, of: u32, extent: i32| {
        (i64::from(extent) * i64::from(k) / i64::from(of.max(1))) as i32
    };
    let rect = |column: u32, row: u32| Rect {
        min: Point::new(edge(column, columns, max.x), edge(row, rows, max.y)),
        max: Point::new(edge(column + 1, columns, max.x), edge(row + 1, rows, max.y)),
    };
    (0..rows)
        .flat_map(|row| (0..columns).map(move |column| rect(column, row)))
        .collect()
}

/// Fails if there is no rectangle or more than [`MAX_PIECES`] of them, if a rectangle is empty or not inside `domain`,
/// and if the rectangles, one for each piece, overlap or leave a part of `domain` uncovered. [`super::combine`] checks
/// this too; this function is for callers that make sets for the rectangles first.
pub fn check_rects(domain: &Domain, rects: &[Rect]) -> Result<(), CombineError> {
    if rects.is_empty() {
        return Err(CombineError::NoPieces);
    }

    if rects.len() > MAX_PIECES {
        return Err(CombineError::TooManyPieces {
            count: rects.len(),
            maximum: MAX_PIECES,
        });
    }

    // Each rectangle by itself: it lies in the domain, and has places. Together they are checked below.
    let all = domain.rect().max;
    for (piece, Rect { min, max }) in rects.iter().enumerate() {
        let inside = 0 <= min.x && 0 <= min.y && max.x <= all.x && max.y <= all.y;
        if !inside || min.x >= max.x || min.y >= max.y {
            return Err(CombineError::Rectangle {
                piece,
                low: domain.user_from_lattice(*min),
                high: domain.user_from_lattice(*max),
            });
        }
    }

    check_partition(domain, rects)
}

/// Refuses pieces that cannot be combined.
pub(super) fn check(domain: &Domain, pieces: &[Piece]) -> Result<(), CombineError> {
    let rects: Vec<Rect> = pieces.iter().map(|piece| piece.rect).collect();
    check_rects(domain, &rects)?;
    let mut each = pieces.iter().enumerate();
    each.try_for_each(|(piece, placed)| check_set(piece, placed))
}

/// Checks for each strip of rows between two edges that the rectangles in it follow each other without gaps or
/// overlaps.
fn check_partition(domain: &Domain, rects: &[Rect]) -> Result<(), CombineError> {
    let all = domain.rect().max;
    let mut by_column: Vec<usize> = (0..rects.len()).collect();
    by_column.sort_by_key(|&k| rects[k].min.x);

    // Between two edges of rectangles all rows are alike: the lowest one stands for its strip. Row 0 is looked at
    // even if no rectangle begins there.
    let ends = rects.iter().flat_map(|rect| [rect.min.y, rect.max.y]);
    let mut edges: Vec<i32> = ends.chain([0]).filter(|&y| y < all.y).collect();
    edges.sort_unstable();
    edges.dedup();

    for y in edges {
        // How far the row is covered, and the rectangle that ends there.
        // Before the first rectangle `last` is not read, as none begins below 0.
        let (mut end, mut last) = (0, 0);
        let at = |x: i32| domain.user_from_lattice(Point::new(x, y));

        for &k in &by_column {
            let Rect { min, max } = rects[k];
            if !(min.y..max.y).contains(&y) {
                continue;
            }

            // Each rectangle must begin where the one before it ended.
            if min.x > end {
                return Err(CombineError::Uncovered { at: at(end) });
            }
            if min.x < end {
                return Err(CombineError::Overlap {
                    first: k.min(last),
                    second: k.max(last),
                    at: at(min.x),
                });
            }
            (end, last) = (max.x, k);
        }

        if end < all.x {
            return Err(CombineError::Uncovered { at: at(end) });
        }
    }

    Ok(())
}

/// By how many units a bounded set may end inside its rectangle if its samples cover the rest. Quotients of sides and
/// radii are rounded down and may lose a unit; the set's start and the rectangle's edges are rounded, too. Two units
/// for all of them are chosen, not measured.
const SHORT: i32 = 2;

/// Refuses a bounded set that does not cover its rectangle.
fn check_set(piece: usize, placed: &Piece) -> Result<(), CombineError> {
    let own = placed.set.domain();
    // A periodic set repeats without end, and covers any rectangle.
    if own.is_periodic() {
        return Ok(());
    }
    let (start, max) = (placed.start, own.rect().max);

    // The number of points from the start on; 0 for a start outside.
    let points = |start: i32, max: i32| if start < 0 { 0 } else { (max - start).max(0) };
    let has = [points(start.x, max.x), points(start.y, max.y)];
    let needs = [placed.rect.width(), placed.rect.height()];
    let short = [needs[0] - has[0], needs[1] - has[1]];

    if short.iter().any(|&units| units > SHORT) || !covers_beyond(placed, short) {
        let radii = |units: i32| f64::from(units) / f64::from(R);
        return Err(CombineError::TooSmall {
            piece,
            has: has.map(radii),
            needs: needs.map(radii),
        });
    }

    Ok(())
}

/// Returns whether the set covers the last columns and rows of its rectangle, which lie just beyond the set's own
/// domain: `short` of them on each axis, none where that number is not positive.
fn covers_beyond(placed: &Piece, short: [i32; 2]) -> bool {
    let (start, max) = (placed.start, placed.set.domain().rect().max);
    let points = placed.set.samples().iter();
    let for_columns = points.clone().map(|p| (p.y, p.x));
    let for_rows = points.map(|p| (p.x, p.y));
    let mut columns = (0..short[0]).map(|k| max.x + k);
    let mut rows = (0..short[1]).map(|k| max.y + k);
    columns.all(|x| covers_line(for_columns.clone(), x, start.y, placed.rect.height()))
        && rows.all(|y| covers_line(for_rows.clone(), y, start.x, placed.rect.width()))
}

/// Returns whether samples, each with its coordinates along and across a line, cover `length` lattice points of it from
/// `start` on. The line lies at the coordinate `line` across.
fn covers_line(
    samples: impl Iterator<Item = (i32, i32)>,
    line: i32,
    start: i32,
    length: i32,
) -> bool {
    let mut covered: Vec<(i64, i64)> = samples
        .filter_map(|(along, across)| {
            let apart = i64::from(across) - i64::from(line);
            // The disk cuts a chord from the line. Half of its length is rounded down, as only whole units are covered.
            let half_squared = R_SQUARED - apart * apart;
            let half = (half_squared >= 0).then(|| half_squared.isqrt())?;
            Some((i64::from(along) - half, i64::from(along) + half))
        })
        .collect();

    covered.sort_unstable();
    let mut next = i64::from(start);
    for (first, last) in covered {
        // The next point is in none of the chords, which are sorted by their beginning.
        if first > next {
            break;
        }
        next = next.max(last + 1);
    }

    next >= i64::from(start) + i64::from(length)
}

/// Returns whether `b`, moved by `shift` units, continues `a` beyond its rectangle: the same set at the same position.
pub(super) fn continues(a: &Piece, b: &Piece, shift: I64Vec2) -> bool {
    if !std::sync::Arc::ptr_eq(&a.set, &b.set) {
        return false;
    }
    let own = a.set.domain();
    // The place in the plane of the set's own origin.
    let origin = |piece: &Piece| I64Vec2::from(piece.rect.min) - I64Vec2::from(piece.start);
    let apart = origin(b) + shift - origin(a);
    let sides = I64Vec2::new(own.width().into(), own.height().into());
    apart == I64Vec2::ZERO || own.is_periodic() && apart % sides == I64Vec2::ZERO
}

/// Returns the seams: vertical ones by the piece on their left, then horizontal ones by the piece below.
pub(super) fn seams(domain: &Domain, pieces: &[Piece]) -> Vec<Seam> {
    let mut seams = Vec::new();
    for axis in [Axis::X, Axis::Y] {
        let edges = pieces.iter().map(|piece| coordinate(axis, piece.rect.min));
        let mut by_edge: Vec<(i32, u32)> = edges.zip(0..).collect();
        by_edge.sort_unstable();

        let side = coordinate(axis, Point::new(domain.width(), domain.height()));
        // Of horizontal seams the left piece is the one below.
        for left in 0..pieces.len() as u32 {
            let end = coordinate(axis, pieces[left as usize].rect.max);
            // In a periodic domain pieces at the right or upper border meet those at the left or lower one.
            let wraps = domain.is_periodic() && end == side;
            let edge = if wraps { 0 } else { end };

            let first = by_edge.partition_point(|&(min, _)| min < edge);
            let beyond = by_edge[first..].iter().take_while(|&&(min, _)| min == edge);
            let shift = if wraps { side } else { 0 };

            seams.extend(beyond.filter_map(|&(_, right)| seam(axis, pieces, [left, right], shift)));
        }
    }
    seams
}

/// Returns the coordinate of a point on `axis`.
const fn coordinate(axis: Axis, p: Point) -> i32 {
    match axis {
        Axis::X => p.x,
        Axis::Y => p.y,
    }
}

/// Returns the seam between two pieces, if there is one. The second piece, moved along `axis` by `shift` units, begins
/// on the line on which the first one ends.
fn seam(axis: Axis, pieces: &[Piece], [left, right]: [u32; 2], shift: i32) -> Option<Seam> {
    let (a, b) = (&pieces[left as usize], &pieces[right as usize]);
    let shift = i64::from(shift);
    let (along, offset) = match axis {
        Axis::X => (Axis::Y, I64Vec2::new(shift, 0)),
        Axis::Y => (Axis::X, I64Vec2::new(0, shift)),
    };

    let from = coordinate(along, a.rect.min).max(coordinate(along, b.rect.min));
    let to = coordinate(along, a.rect.max).min(coordinate(along, b.rect.max));
    // There is no seam if the pieces do not lie beside each other, or show one set, which has no conflicts where it
    // continues.
    if from >= to || continues(a, b, offset) {
        return None;
    }

    let edge = coordinate(axis, b.rect.min);
    let point = |at: i32| match axis {
        Axis::X => Point::new(edge, at),
        Axis::Y => Point::new(at, edge),
    };

    Some(Seam {
        from: point(from),
        to: point(to),
        pieces: [left, right],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_covered_to_the_last_lattice_point() {
        // Two disks that touch in the point R of line 0, and miss the point above it by a hair.
        let samples = [(0, 0), (2 * R, 0)];
        let covers = |line, start, length| covers_line(samples.into_iter(), line, start, length);
        assert!(covers(0, -R, 4 * R + 1));
        assert!(!covers(0, -R - 1, 4 * R));
        assert!(!covers(0, -R, 4 * R + 2));
        assert!(!covers(1, 0, 2 * R));
        assert!(covers(1, 0, R) && covers(-1, R + 1, R));
        assert!(!covers(R + 1, 0, 1));
    }
}
