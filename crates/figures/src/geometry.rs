//! Outlines of markers and the lines of hatching, for every exporter alike.
//!
//! Works in scene pixels. Never depends on a platform's trigonometry: only exact constants and square roots.

use crate::scene::Marker;

/// Half the width of a cross's arm, as a fraction of its size.
const ARM: f64 = 0.16;

/// The corners of a marker `size` pixels wide at `center`; a dot has none.
pub(crate) fn marker_outline(marker: Marker, center: [f64; 2], size: f64) -> Vec<[f64; 2]> {
    let half = size / 2.0;
    // 12 corners of a saltire: an upright plus of arm ARM, turned by 45 degrees in place.
    let arm = ARM * size;
    let corners: Vec<[f64; 2]> = match marker {
        Marker::Dot => Vec::new(),
        Marker::Square => vec![[-half, -half], [half, -half], [half, half], [-half, half]],
        Marker::Diamond => vec![[0.0, -half], [half, 0.0], [0.0, half], [-half, 0.0]],
        Marker::Triangle => {
            // Equilateral, of the given width, its centroid at the centre.
            let height = size * 0.75_f64.sqrt();
            let below = height / 3.0;
            vec![[0.0, below - height], [half, below], [-half, below]]
        }
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
        .map(|[x, y]| [center[0] + x, center[1] + y])
        .collect()
}

/// The part of the segment in the rectangle `frame` (left, top, right, bottom), after Liang & Barsky (1984).
pub(crate) fn clip_segment([a, b]: [[f64; 2]; 2], frame: [f64; 4]) -> Option<[[f64; 2]; 2]> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in [0, 1] {
        let step = b[axis] - a[axis];
        let (low, high) = (frame[axis] - a[axis], frame[axis + 2] - a[axis]);
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
    let at = |t: f64| [0, 1].map(|axis| a[axis] + t * (b[axis] - a[axis]));
    let seen = enter <= leave && (b[0] - a[0]).is_finite() && (b[1] - a[1]).is_finite();
    seen.then(|| [at(enter), at(leave)])
}

/// The polygon cut to the rectangle `frame`, after Sutherland & Hodgman (1974).
pub(crate) fn clip_polygon(points: &[[f64; 2]], frame: [f64; 4]) -> Vec<[f64; 2]> {
    let mut kept = points.to_vec();
    for (side, &level) in frame.iter().enumerate() {
        let (axis, sign) = (side % 2, if side < 2 { 1.0 } else { -1.0 });
        let depth = |p: [f64; 2]| sign * (p[axis] - level);
        let mut cut = Vec::with_capacity(kept.len() + 4);
        for (a, b) in edges(&kept) {
            let (u, v) = (depth(a), depth(b));
            if u >= 0.0 {
                cut.push(a);
            }
            if (u < 0.0) != (v < 0.0) {
                let t = u / (u - v);
                cut.push([0, 1].map(|k| a[k] + t * (b[k] - a[k])));
            }
        }
        kept = cut;
    }
    kept
}

/// The most hatching lines of one area; the widest picture has fewer.
const MAX_LINES: f64 = 65_536.0;

/// Pieces of the lines `x + y = k * spacing * sqrt 2` inside the polygon (even-odd rule).
pub(crate) fn hatch_polygon(points: &[[f64; 2]], spacing: f64) -> Vec<[[f64; 2]; 2]> {
    let diagonal = |p: [f64; 2]| p[0] + p[1];
    let mut pieces = Vec::new();
    for level in levels(points.iter().map(|&p| diagonal(p)), spacing) {
        let mut crossings: Vec<f64> = edges(points)
            .filter_map(|(a, b)| {
                let (u, v) = (diagonal(a) - level, diagonal(b) - level);
                // Half-open, so that a corner on the line counts once.
                ((u < 0.0) != (v < 0.0)).then(|| a[0] + (b[0] - a[0]) * (u / (u - v)))
            })
            .collect();
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            pieces.push([pair[0], pair[1]].map(|x| [x, level - x]));
        }
    }
    pieces
}

/// Pieces of the same lines inside a circle.
pub(crate) fn hatch_circle(center: [f64; 2], radius: f64, spacing: f64) -> Vec<[[f64; 2]; 2]> {
    let middle = center[0] + center[1];
    let reach = radius * std::f64::consts::SQRT_2;
    levels([middle - reach, middle + reach].into_iter(), spacing)
        .map(|level| {
            let offset = (level - middle) / 2.0;
            let half = (radius * radius / 2.0 - offset * offset).max(0.0).sqrt();
            let (x, y) = (center[0] + offset, center[1] + offset);
            [[x - half, y + half], [x + half, y - half]]
        })
        .collect()
}

fn edges(points: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    let next = points.iter().cycle().skip(1);
    points.iter().copied().zip(next.copied())
}

/// Values of x + y where lines pass through the range of `diagonals`.
fn levels(diagonals: impl Iterator<Item = f64>, spacing: f64) -> impl Iterator<Item = f64> {
    let step = spacing.max(1.0) * std::f64::consts::SQRT_2;
    let range = diagonals.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], d| {
        [low.min(d), high.max(d)]
    });
    let first = (range[0] / step).ceil();
    let count = (range[1] / step - first).floor() + 1.0;
    let count = if count.is_finite() {
        count.clamp(0.0, MAX_LINES) as u32
    } else {
        0
    };
    (0..count).map(move |k| (first + f64::from(k)) * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(pieces: &[[[f64; 2]; 2]]) -> f64 {
        let piece = |[a, b]: &[[f64; 2]; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        pieces.iter().map(piece).sum()
    }

    #[test]
    fn hatching_covers_the_area_at_its_spacing() {
        // Line length times spacing approaches the area.
        let square = [[3.0, 2.0], [103.0, 2.0], [103.0, 102.0], [3.0, 102.0]];
        assert!((length(&hatch_polygon(&square, 1.0)) / 1e4 - 1.0).abs() < 0.01);
        let disk = hatch_circle([50.0, 50.0], 50.0, 2.0);
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
        ];
        for [a, b] in hatch_polygon(&notched, 3.0) {
            let middle = [f64::midpoint(a[0], b[0]), f64::midpoint(a[1], b[1])];
            let in_notch = middle[0] > 50.0 + (middle[1] - 50.0).abs() + 1e-9;
            assert!(!in_notch, "{middle:?}");
        }
    }

    #[test]
    fn clipping_keeps_what_is_inside() {
        let frame = [0.0, 0.0, 10.0, 10.0];
        let inside = [[1.0, 2.0], [9.0, 3.0]];
        assert_eq!(clip_segment(inside, frame), Some(inside));
        let long = clip_segment([[-1e12, -1e12], [1e12, 1e12]], frame).expect("crosses");
        assert!(long.iter().flatten().all(|v| (-1e-3..=10.001).contains(v)));
        assert_eq!(clip_segment([[-5.0, 1.0], [-5.0, 9.0]], frame), None);
        assert_eq!(clip_segment([[-1.0, 9.5], [1.0, 12.0]], frame), None);
        assert_eq!(
            clip_segment([[f64::INFINITY, 1.0], [1.0, 1.0]], frame),
            None
        );
        let vast = [[-1e9, -1e9], [1e9, -1e9], [1e9, 1e9], [-1e9, 1e9]];
        let mut corners = clip_polygon(&vast, frame);
        corners.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        assert_eq!(
            corners,
            [[0.0, 0.0], [0.0, 10.0], [10.0, 0.0], [10.0, 10.0]]
        );
        assert!(clip_polygon(&[[20.0, 0.0], [30.0, 0.0], [20.0, 9.0]], frame).is_empty());
    }

    #[test]
    fn degenerate_areas_have_no_lines() {
        assert!(hatch_polygon(&[], 4.0).is_empty());
        assert!(hatch_polygon(&[[1.0, 1.0]], 4.0).is_empty());
        assert!(length(&hatch_circle([0.0, 0.0], 0.0, 4.0)) < 1e-9);
        assert!(hatch_polygon(&[[0.0, 0.0], [1e300, 0.0], [0.0, 1e300]], 1.0).len() <= 65_536);
    }

    #[test]
    fn markers_are_as_wide_as_asked() {
        for marker in [
            Marker::Cross,
            Marker::Triangle,
            Marker::Diamond,
            Marker::Square,
        ] {
            let outline = marker_outline(marker, [10.0, 10.0], 6.0);
            let right = outline.iter().map(|p| p[0]).fold(0.0, f64::max);
            assert!((right - 13.0).abs() < 1e-12, "{marker:?}");
        }
    }
}
