//! The edges of the box and of the cut, as lines in the picture.

use super::OrbitSet;
use super::projection::Projection;

/// A line of the picture. Lengths are in rays.
pub(super) struct Edge {
    /// Column, row and nearness of its ends.
    pub ends: [[f32; 3]; 2],
    pub width: f32,
    /// How much nearer it counts as: an edge of the cut lies in the flat faces, and would be seen in parts.
    pub lift: f32,
    /// Whether it is an edge of the cut.
    pub is_notch: bool,
}

/// Widths of lines to the longer side of the picture; chosen by eye.
const WIDTH_SHARE: f32 = 1.0 / 640.0;

impl Edge {
    /// Returns the edges of the box, and of the octant that is cut out.
    pub fn all(set: &OrbitSet<'_>, open: Option<[f64; 3]>, projection: &Projection) -> Vec<Self> {
        // A place of the box, by -1, 0 or 1 for each axis: the lower end of the axis, its middle, or the upper end.
        let place = |signs: [f64; 3]| {
            projection.of([0, 1, 2].map(|axis| set.size[axis] * (1.0 + signs[axis]) / 2.0))
        };
        let width = (projection.longer_side() * WIDTH_SHARE).max(1.0);
        let edge_of_box = |from, to| Self {
            ends: [place(from), place(to)],
            width,
            lift: 0.0,
            is_notch: false,
        };
        let edge_of_cut = |from, to| Self {
            // An eighth of a ball's radius: chosen, not measured.
            lift: projection.radius / 8.0,
            is_notch: true,
            ..edge_of_box(from, to)
        };

        let mut edges = Vec::new();
        for axis in 0..3 {
            let [first, second] = others(axis);
            for [one, other] in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
                let mut from = [-1.0; 3];
                (from[first], from[second]) = (one, other);
                let mut to = from;
                to[axis] = 1.0;
                edges.push(edge_of_box(from, to));
            }
        }

        let Some(signs) = open else {
            return edges;
        };
        for axis in 0..3 {
            // From the middle of the box to the middle of a side, and there along the borders of the square that is cut out.
            let mut side = [0.0; 3];
            side[axis] = signs[axis];
            edges.push(edge_of_cut([0.0; 3], side));
            for other in others(axis) {
                let mut border = side;
                border[other] = signs[other];
                edges.push(edge_of_cut(side, border));
            }
        }
        edges
    }
}

/// Returns the two other axes.
const fn others(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}
