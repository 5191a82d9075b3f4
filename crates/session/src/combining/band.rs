//! The band around the seams in which gluing can have changed samples, as rectangles that do not overlap. It is
//! computed from the pieces' rectangles, without looking at samples.

use tilescope_core::combine::{Piece, Seam, TOUCHED};
use tilescope_core::{Domain, Point, Rect};

/// Returns the band, piece by piece: everything within reach of a seam, or of a border of a bounded domain that cuts a
/// piece's set. `None` once `stops` returns true, which is checked throughout.
pub fn of(
    domain: &Domain,
    pieces: &[Piece],
    seams: &[Seam],
    stops: &dyn Fn() -> bool,
) -> Option<Vec<Rect>> {
    let whole = domain.rect();
    let mut lines: Vec<Rect> = seams
        .iter()
        .flat_map(|seam| images(domain, seam.from, seam.to))
        .chain(pieces.iter().flat_map(|piece| cut(domain, piece)))
        .map(|line| grown(&line))
        // Images that lie outside the domain are of no use.
        .filter(|line| common(line, &whole).is_some())
        .collect();
    lines.sort_unstable_by_key(|line| line.min.y);

    let mut band = Vec::new();
    for piece in pieces {
        if stops() {
            return None;
        }

        // Lines are sorted by their lower ends. Those that begin above the piece do not reach it.
        let below = lines.partition_point(|line| line.min.y < piece.rect.max.y);
        let near = lines[..below].iter();
        let parts = near.filter_map(|line| common(line, &piece.rect));
        // The pieces do not overlap, so that their parts of the band do not, either.
        union(parts.collect(), stops, &mut band)?;
    }
    Some(band)
}

/// Returns a line and its images across the borders of a periodic domain.
fn images(domain: &Domain, from: Point, to: Point) -> Vec<Rect> {
    let shifts = |side: i32| -> Vec<i32> {
        if domain.is_periodic() {
            vec![0, -side, side]
        } else {
            vec![0]
        }
    };
    let ups = shifts(domain.height());
    let rights = shifts(domain.width()).into_iter();

    let images = rights.flat_map(|right| ups.iter().map(move |&up| (right, up)));
    images
        .map(|(right, up)| Rect {
            // A shifted line may leave the range of coordinates. It is then far outside the domain.
            min: Point::new(from.x.saturating_add(right), from.y.saturating_add(up)),
            max: Point::new(to.x.saturating_add(right), to.y.saturating_add(up)),
        })
        .collect()
}

/// Returns the sides of a piece that lie on the border of a bounded domain and cut its set: samples that covered places
/// inside are lost there.
fn cut(domain: &Domain, piece: &Piece) -> Vec<Rect> {
    if domain.is_periodic() {
        return Vec::new();
    }

    let (rect, own) = (&piece.rect, piece.set.domain());
    let (start, end) = (piece.start, domain.rect().max);
    let (low, high) = (rect.min, rect.max);

    // Returns whether the set, which is `extent` long, goes on beyond the piece, which takes `length` of it from `start` on.
    let beyond = |start: i32, length: i32, extent: i32| {
        i64::from(start) + i64::from(length) < i64::from(extent)
    };

    let side = |on_border: bool, is_larger: bool, min: Point, max: Point| Side {
        on_border,
        is_larger,
        line: Rect { min, max },
    };
    // Left, below, right and above.
    let sides = [
        side(low.x == 0, start.x > 0, low, Point::new(low.x, high.y)),
        side(low.y == 0, start.y > 0, low, Point::new(high.x, low.y)),
        side(
            high.x == end.x,
            beyond(start.x, rect.width(), own.width()),
            Point::new(high.x, low.y),
            high,
        ),
        side(
            high.y == end.y,
            beyond(start.y, rect.height(), own.height()),
            Point::new(low.x, high.y),
            high,
        ),
    ];

    // A periodic set goes on beyond every side, and a bounded one only where it is larger than the rectangle.
    let is_cut = |side: &Side| side.on_border && (side.is_larger || own.is_periodic());
    let cut = sides.into_iter().filter(is_cut);
    cut.map(|side| side.line).collect()
}

/// A side of a piece.
struct Side {
    /// Whether it lies on the border of the domain.
    on_border: bool,
    /// Whether the piece's set is larger than the piece at this side.
    is_larger: bool,
    line: Rect,
}

/// Returns the rectangle within reach of a line, in which gluing can have changed samples.
fn grown(line: &Rect) -> Rect {
    Rect {
        min: Point::new(
            line.min.x.saturating_sub(TOUCHED),
            line.min.y.saturating_sub(TOUCHED),
        ),
        max: Point::new(
            line.max.x.saturating_add(TOUCHED),
            line.max.y.saturating_add(TOUCHED),
        ),
    }
}

fn common(a: &Rect, b: &Rect) -> Option<Rect> {
    let min = Point::new(a.min.x.max(b.min.x), a.min.y.max(b.min.y));
    let max = Point::new(a.max.x.min(b.max.x), a.max.y.min(b.max.y));
    (min.x < max.x && min.y < max.y).then_some(Rect { min, max })
}

/// Adds to `band` rectangles that cover the union of `parts` without overlap. The plane is cut into rows at the
/// parts' edges; equal consecutive rows become one rectangle. `None` once `stops` returns true.
fn union(mut parts: Vec<Rect>, stops: &dyn Fn() -> bool, band: &mut Vec<Rect>) -> Option<()> {
    parts.sort_unstable_by_key(|part| (part.min.y, part.min.x));

    let mut edges: Vec<i32> = parts
        .iter()
        .flat_map(|part| [part.min.y, part.max.y])
        .collect();
    edges.sort_unstable();
    edges.dedup();

    let mut coming = parts.into_iter().peekable();
    // The parts that reach across the row, from left to right.
    let mut over: Vec<Rect> = Vec::new();
    // The rectangles of the row before, which this one may lengthen.
    let mut open: Vec<Rect> = Vec::new();

    for [bottom, top] in edges.array_windows() {
        if stops() {
            return None;
        }

        // Rows come in order from below, so that each part enters and leaves the list once.
        over.retain(|part| part.max.y > *bottom);
        while let Some(part) = coming.next_if(|part| part.min.y <= *bottom) {
            let at = over.partition_point(|other| other.min.x <= part.min.x);
            over.insert(at, part);
        }

        let spans = spans(&over);
        // If a row has the same spans as the one before, its rectangles are only lengthened, so that the band has few of them.
        let alike = spans.len() == open.len()
            && (open.iter().zip(&spans)).all(|(rect, span)| [rect.min.x, rect.max.x] == *span);
        if !alike {
            band.append(&mut open);
            open = spans.iter().map(|&span| across(span, *bottom)).collect();
        }

        for rect in &mut open {
            rect.max.y = *top;
        }
    }
    band.append(&mut open);
    Some(())
}

/// Returns the horizontal intervals that `parts`, sorted by their left edges, cover.
fn spans(parts: &[Rect]) -> Vec<[i32; 2]> {
    let mut spans: Vec<[i32; 2]> = Vec::new();
    for part in parts {
        match spans.last_mut() {
            Some(last) if part.min.x <= last[1] => last[1] = last[1].max(part.max.x),
            _ => spans.push([part.min.x, part.max.x]),
        }
    }
    spans
}

const fn across(span: [i32; 2], y: i32) -> Rect {
    Rect {
        min: Point::new(span[0], y),
        max: Point::new(span[1], y),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use tilescope_core::combine::{CombineOptions, combine, grid};
    use tilescope_core::{Boundary, Pattern, R, Source, Unobserved};

    fn glued(boundary: Boundary, own: Boundary) -> (Domain, Vec<Piece>) {
        let domain = Domain::from_size([60.0, 45.0], 1.0, boundary).unwrap();
        let pieces = (1..).zip(grid(&domain, 2, 2)).map(|(seed, rect)| Piece {
            set: {
                let own = Domain::of_rect(&rect, own).unwrap();
                Arc::new(Pattern::of_reference(own, seed, &mut Unobserved).unwrap())
            },
            rect,
            start: Point::default(),
        });
        (domain, pieces.collect())
    }

    #[test]
    fn the_band_holds_everything_within_reach_of_a_seam_and_its_parts_do_not_overlap() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            for own in [Boundary::Periodic, Boundary::Bounded] {
                let (domain, pieces) = glued(boundary, own);
                let options = CombineOptions::default();
                let combined = combine(domain, &pieces, &options, &mut Unobserved).unwrap();
                let band = of(&domain, &pieces, &combined.seams, &|| false).unwrap();
                let holds = |point: Point| band.iter().filter(|rect| rect.contains(point)).count();
                let each = combined.points.iter().zip(&combined.sources);
                let inserted = each.filter(|(_, source)| matches!(source, Source::Inserted { .. }));
                let touched: Vec<Point> = inserted
                    .map(|(&point, _)| point)
                    .chain(combined.eliminated.iter().map(|lost| lost.point))
                    .collect();
                assert!(touched.len() > 20);
                assert!(touched.iter().all(|&point| holds(point) == 1));
                // The middle of a piece is outside the band, so the band is not the whole domain.
                assert_eq!(holds(Point::new(15 * R, 11 * R)), 0);
                assert!(combined.points.iter().any(|&point| holds(point) == 0));
                assert!(combined.points.iter().all(|&point| holds(point) <= 1));
            }
        }
    }

    #[test]
    fn one_periodic_piece_has_no_band() {
        let domain = Domain::from_size([30.0, 30.0], 1.0, Boundary::Periodic).unwrap();
        let set = Pattern::of_reference(domain, 1, &mut Unobserved).unwrap();
        let piece = Piece {
            set: Arc::new(set),
            rect: domain.rect(),
            start: Point::default(),
        };
        assert_eq!(of(&domain, &[piece], &[], &|| false), Some(Vec::new()));
    }

    /// Returns a square of `across` units of r with a ring of `4 * (across - 1)` squares around one piece.
    fn ringed(across: i32) -> (Domain, Vec<Piece>, Vec<Seam>) {
        let side = f64::from(across);
        let domain = Domain::from_size([side, side], 1.0, Boundary::Bounded).unwrap();
        let own = Domain::from_size([12.0, 12.0], 1.0, Boundary::Periodic).unwrap();
        let set = Arc::new(Pattern::of_reference(own, 1, &mut Unobserved).unwrap());
        let rect = |min: [i32; 2], max: [i32; 2]| Rect {
            min: Point::new(min[0] * R, min[1] * R),
            max: Point::new(max[0] * R, max[1] * R),
        };
        let last = across - 1;
        let mut rects = vec![rect([1, 1], [last, last])];
        for k in 0..last {
            rects.push(rect([k, 0], [k + 1, 1]));
            rects.push(rect([last, k], [across, k + 1]));
            rects.push(rect([k + 1, last], [k + 2, across]));
            rects.push(rect([0, k + 1], [1, k + 2]));
        }
        let line = |from: Point, to: Point| Seam {
            from,
            to,
            pieces: [0, 1],
        };
        let seams = rects.iter().flat_map(|rect| {
            let (low, high) = (rect.min, rect.max);
            [
                line(low, Point::new(high.x, low.y)),
                line(low, Point::new(low.x, high.y)),
            ]
        });
        let seams = seams.collect();
        let piece = |rect: Rect| Piece {
            set: Arc::clone(&set),
            rect,
            start: Point::default(),
        };
        let pieces = rects.into_iter().map(piece).collect();
        (domain, pieces, seams)
    }

    #[test]
    fn a_piece_with_thousands_of_neighbours_has_a_small_band_and_can_be_stopped() {
        let (domain, pieces, seams) = ringed(1002);
        assert_eq!(pieces.len(), 4005);
        let asked = std::cell::Cell::new(0);
        let stops = |after: usize| {
            let asked = &asked;
            move || {
                asked.set(asked.get() + 1);
                asked.get() > after
            }
        };
        let band = of(&domain, &pieces, &seams, &stops(usize::MAX)).unwrap();
        // The ring is all band, and so is everything within reach of it.
        let of_piece = |rect: &Rect| common(rect, &pieces[0].rect).is_some();
        assert!(band.iter().filter(|rect| of_piece(rect)).count() <= 8);
        assert!(band.len() < 2 * pieces.len(), "{}", band.len());
        let area = |rect: &Rect| i64::from(rect.width()) * i64::from(rect.height());
        let square = |side: i32| i64::from(side) * i64::from(side);
        let free = square(1000 * R - 2 * TOUCHED);
        let covered: i64 = band.iter().map(area).sum();
        assert_eq!(covered, square(1002 * R) - free);
        // `stops` is also checked in the middle of the large piece.
        let all = asked.replace(0);
        assert!(all > pieces.len() + 1000, "{all}");
        for after in [0, 500, all - 1] {
            asked.set(0);
            assert_eq!(of(&domain, &pieces, &seams, &stops(after)), None);
            assert_eq!(asked.get(), after + 1);
        }
    }

    #[test]
    fn a_union_covers_its_parts_once_and_nothing_else() {
        let at = |k: u32, range: u32| (k.wrapping_mul(2_654_435_761) >> 8) as i32 % range as i32;
        for seed in 0..50 {
            let parts: Vec<Rect> = (0..12)
                .map(|k| {
                    let draw = |n: u32, range| at(seed * 97 + k * 7 + n + 1, range);
                    let min = Point::new(draw(0, 20), draw(1, 20));
                    let max = Point::new(min.x + 1 + draw(2, 8), min.y + 1 + draw(3, 8));
                    Rect { min, max }
                })
                .collect();
            let mut band = Vec::new();
            union(parts.clone(), &|| false, &mut band).unwrap();
            let holds = |rect: &Rect, x: i32, y: i32| {
                rect.min.x <= x && x < rect.max.x && rect.min.y <= y && y < rect.max.y
            };
            for x in 0..30 {
                for y in 0..30 {
                    let covered = parts.iter().any(|part| holds(part, x, y));
                    let times = band.iter().filter(|rect| holds(rect, x, y)).count();
                    assert_eq!(times, usize::from(covered), "{x} {y} of {seed}");
                }
            }
        }
    }
}
