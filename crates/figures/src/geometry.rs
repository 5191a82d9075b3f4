//! Outlines of markers and the lines of hatching, for every exporter alike.
//!
//! Lengths are in pixels. Only exact constants and square roots are used, since a platform's trigonometry may round
//! differently.

use glam::DVec2;

use crate::scene::{Marker, Rect};

/// The arms of a cross lie along its diagonals. The width of an arm is √2 times this fraction of the cross's size.
const ARM: f64 = 0.16;

/// Returns the corners of a marker `size` pixels wide at `center`; a dot has none.
pub(crate) fn marker_outline(marker: Marker, center: DVec2, size: f64) -> Vec<DVec2> {
    let half = size / 2.0;
    let arm = ARM * size;

    let corners: Vec<[f64; 2]> = match marker {
        Marker::Dot => Vec::new(),
        Marker::Square => vec![[-half, -half], [half, -half], [half, half], [-half, half]],
        Marker::Diamond => vec![[0.0, -half], [half, 0.0], [0.0, half], [-half, 0.0]],
        Marker::Triangle => {
            // The triangle is equilateral, of the given width, with its centroid at the centre. Its tip points up, as y grows
            // downwards.
            let height = size * 0.75_f64.sqrt();
            let below = height / 3.0;
            vec![[0.0, below - height], [half, below], [-half, below]]
        }
        // The corners of a plus that is turned by 45 degrees. The four with a 0 are those between two arms.
        Marker::Cross => {
            let (inner, outer) = (arm, half - arm);
            vec![
                [0.0, -inner],
                [outer, -half],
                [half, -outer],
                [inner, 0.0],
                [half, outer],
                [outer, half],
                [0.0, inner],
                [-outer, half],
                [-half, outer],
                [-inner, 0.0],
                [-half, -outer],
                [-outer, -half],
            ]
        }
    };

    corners
        .into_iter()
        .map(|corner| center + DVec2::from(corner))
        .collect()
}

/// Returns the part of the segment in the rectangle `frame`, if there is any, after Liang & Barsky (1984).
pub(crate) fn clip_segment([a, b]: [DVec2; 2], frame: Rect) -> Option<[DVec2; 2]> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    let (way, lowest, highest) = (b - a, frame.min - a, frame.max - a);

    for axis in [0, 1] {
        let (step, low, high) = (way[axis], lowest[axis], highest[axis]);
        // A segment parallel to these two sides is between them or out of sight, and there is no crossing to compute.
        if step == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }

        let (first, last) = (low / step, high / step);
        enter = enter.max(first.min(last));
        leave = leave.min(first.max(last));
    }

    // Ends at infinity, or too far apart for their difference, have no places between them.
    let is_seen = enter <= leave && way.is_finite();
    is_seen.then(|| [enter, leave].map(|t| a + t * way))
}

/// Returns the polygon cut to a rectangle, by one side of it after the other, after Sutherland & Hodgman (1974).
pub(crate) fn clip_polygon(points: &[DVec2], Rect { min, max }: Rect) -> Vec<DVec2> {
    let mut kept = points.to_vec();
    for (axis, sign, level) in [
        (0, 1.0, min.x),
        (1, 1.0, min.y),
        (0, -1.0, max.x),
        (1, -1.0, max.y),
    ] {
        // How far inside of this side a place lies; below 0 outside.
        let depth = |p: DVec2| sign * (p[axis] - level);
        let mut cut = Vec::with_capacity(kept.len() + 1);
        for [a, b] in edges(&kept) {
            let (u, v) = (depth(a), depth(b));
            if u >= 0.0 {
                cut.push(a);
            }
            // An edge from inside to outside, or back, is cut. The signs differ, so that the divisor is not zero.
            if (u < 0.0) != (v < 0.0) {
                cut.push(a + u / (u - v) * (b - a));
            }
        }

        kept = cut;
    }
    kept
}

/// The most hatching lines of one area; the widest picture has fewer.
const MAX_LINES: f64 = 65_536.0;

/// Returns the pieces of the lines `x + y = k * spacing * sqrt 2` inside the polygon (even-odd rule). A spacing below 1
/// counts as 1.
pub(crate) fn hatch_polygon(points: &[DVec2], spacing: f64) -> Vec<[DVec2; 2]> {
    let mut pieces = Vec::new();
    for level in levels(points.iter().map(|p| p.element_sum()), spacing) {
        let mut crossings: Vec<f64> = edges(points)
            .filter_map(|[a, b]| {
                let (u, v) = (a.element_sum() - level, b.element_sum() - level);
                // Half-open, so that a corner on the line counts once.
                ((u < 0.0) != (v < 0.0)).then(|| a.x + (b.x - a.x) * (u / (u - v)))
            })
            .collect();

        // A closed outline crosses a line an even number of times, and by the even-odd rule every other piece is inside.
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            pieces.push([pair[0], pair[1]].map(|x| DVec2::new(x, level - x)));
        }
    }
    pieces
}

/// Returns the pieces of the same lines inside a circle.
pub(crate) fn hatch_circle(center: DVec2, radius: f64, spacing: f64) -> Vec<[DVec2; 2]> {
    let middle = center.element_sum();
    let reach = radius * std::f64::consts::SQRT_2;
    levels([middle - reach, middle + reach].into_iter(), spacing)
        .map(|level| {
            let offset = (level - middle) / 2.0;
            // A line that just touches the circle may miss it by rounding.
            let half = (radius * radius / 2.0 - offset * offset).max(0.0).sqrt();
            let along = DVec2::new(half, -half);
            [center + offset - along, center + offset + along]
        })
        .collect()
}

/// The sides of a polygon.
pub(crate) fn edges(points: &[DVec2]) -> impl Iterator<Item = [DVec2; 2]> {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(&a, &b)| [a, b])
}

/// Returns the values of x + y of the hatching lines that pass between the least and the greatest of `diagonals`,
/// values of x + y themselves.
fn levels(diagonals: impl Iterator<Item = f64>, spacing: f64) -> impl Iterator<Item = f64> {
    // Lines closer than a pixel would run together. Two lines a distance apart differ by sqrt 2 times as much in x + y.
    let step = spacing.max(1.0) * std::f64::consts::SQRT_2;
    let range = diagonals.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], d| {
        [low.min(d), high.max(d)]
    });
    let first = (range[0] / step).ceil();
    let lines = (range[1] / step - first).floor() + 1.0;
    // An outline without corners has an infinite range, through which no line passes.
    let count = if lines.is_finite() {
        lines.clamp(0.0, MAX_LINES) as u32
    } else {
        0
    };
    (0..count).map(move |k| (first + f64::from(k)) * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(pieces: &[[DVec2; 2]]) -> f64 {
        pieces.iter().map(|[a, b]| a.distance(*b)).sum()
    }

    #[test]
    fn hatching_covers_the_area_at_its_spacing() {
        // Line length times spacing approaches the area.
        let square = Rect::new([3.0, 2.0], [103.0, 102.0]).corners();
        assert!((length(&hatch_polygon(&square, 1.0)) / 1e4 - 1.0).abs() < 0.01);
        let disk = hatch_circle(DVec2::splat(50.0), 50.0, 2.0);
        let area = std::f64::consts::PI * 2500.0;
        assert!((length(&disk) * 2.0 / area - 1.0).abs() < 0.01);
    }

    #[test]
    fn hatching_leaves_notches_empty() {
        let notched = [
            [0.0, 0.0],
            [100.0, 0.0],
            [50.0, 50.0],
            [100.0, 100.0],
            [0.0, 100.0],
        ]
        .map(DVec2::from);
        for [a, b] in hatch_polygon(&notched, 3.0) {
            let middle = a.midpoint(b);
            let in_notch = middle.x > 50.0 + (middle.y - 50.0).abs() + 1e-9;
            assert!(!in_notch, "{middle:?}");
        }
    }

    #[test]
    fn clipping_keeps_what_is_inside() {
        let frame = Rect::new([0.0; 2], [10.0; 2]);
        let clip = |ends: [[f64; 2]; 2]| clip_segment(ends.map(DVec2::from), frame);
        let inside = [[1.0, 2.0], [9.0, 3.0]];
        assert_eq!(clip(inside), Some(inside.map(DVec2::from)));
        let long = clip([[-1e12, -1e12], [1e12, 1e12]]).expect("crosses");
        let near = frame.padded(1e-3);
        assert!(long.iter().all(|p| *p == p.clamp(near.min, near.max)));
        assert_eq!(clip([[-5.0, 1.0], [-5.0, 9.0]]), None);
        assert_eq!(clip([[-1.0, 9.5], [1.0, 12.0]]), None);
        assert_eq!(clip([[f64::INFINITY, 1.0], [1.0, 1.0]]), None);
        let vast = Rect::new([-1e9; 2], [1e9; 2]);
        let mut corners = clip_polygon(&vast.corners(), frame);
        corners.sort_by(|a, b| a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x)));
        corners.swap(2, 3);
        assert_eq!(corners, frame.corners());
        let outside = Rect::new([20.0, 0.0], [30.0, 9.0]);
        assert!(clip_polygon(&outside.corners(), frame).is_empty());
    }

    #[test]
    fn degenerate_areas_have_no_lines() {
        assert!(hatch_polygon(&[], 4.0).is_empty());
        assert!(hatch_polygon(&[DVec2::ONE], 4.0).is_empty());
        assert!(length(&hatch_circle(DVec2::ZERO, 0.0, 4.0)) < 1e-9);
        let vast = [DVec2::ZERO, 1e300 * DVec2::X, 1e300 * DVec2::Y];
        assert!(hatch_polygon(&vast, 1.0).len() <= 65_536);
    }

    #[test]
    fn markers_are_as_wide_as_asked() {
        for marker in [
            Marker::Cross,
            Marker::Triangle,
            Marker::Diamond,
            Marker::Square,
        ] {
            let outline = marker_outline(marker, DVec2::splat(10.0), 6.0);
            let right = outline.iter().map(|p| p.x).fold(0.0, f64::max);
            assert!((right - 13.0).abs() < 1e-12, "{marker:?}");
        }
    }
}
