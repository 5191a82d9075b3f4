//! A filter for gap detection: the Voronoi cell of one sample, built slightly too large in
//! floating point. It only says which samples *may* take part in a candidate; integers decide.
//!
//! A candidate c of a detector i is nearly a Voronoi vertex of i: no sample p is nearer to it than
//! i by more than 22 R in squared distance (12 R by definition, under 9.7 R from rounding c at a
//! distance of at most 3.42 r). So c lies in the cell whose bisectors are moved outwards by
//! `RELAXATION` = 32 R, and the candidate's other samples have bisectors, moved inwards by as
//! much, that reach this cell. The remaining 10 R are at least 1.4 units anywhere in reach, while
//! the clipping errors of f64 at these magnitudes stay far below a thousandth of a unit.

use crate::lattice::R;

const RELAXATION: f64 = 32.0 * R as f64;

/// A relaxed Voronoi cell around the origin.
#[derive(Default)]
pub(crate) struct RelaxedCell {
    vertices: Vec<[f64; 2]>,
    clipped: Vec<[f64; 2]>,
}

impl RelaxedCell {
    /// Starts with a box.
    pub(crate) fn reset(&mut self, min: [f64; 2], max: [f64; 2]) {
        self.vertices.clear();
        self.vertices
            .extend([min, [max[0], min[1]], max, [min[0], max[1]]]);
    }

    /// Cuts off the part that is nearer to a sample at offset `p` than to the origin by more than the relaxation
    /// (Sutherland and Hodgman's clip of a convex polygon).
    pub(crate) fn clip(&mut self, p: (i32, i32)) {
        let (x, y) = (f64::from(p.0), f64::from(p.1));
        let limit = x * x + y * y + RELAXATION;
        let beyond = |v: &[f64; 2]| 2.0 * (v[0] * x + v[1] * y) - limit;
        if self.vertices.iter().all(|v| beyond(v) <= 0.0) {
            return;
        }
        self.clipped.clear();
        for (k, v) in self.vertices.iter().enumerate() {
            let w = &self.vertices[(k + 1) % self.vertices.len()];
            let (a, b) = (beyond(v), beyond(w));
            if a <= 0.0 {
                self.clipped.push(*v);
            }
            if (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0) {
                let t = a / (a - b);
                self.clipped
                    .push([v[0] + t * (w[0] - v[0]), v[1] + t * (w[1] - v[1])]);
            }
        }
        std::mem::swap(&mut self.vertices, &mut self.clipped);
    }

    /// Returns whether the origin's own disk, a thousandth of a unit smaller, covers the cell:
    /// then there is no uncovered point in it.
    pub(crate) fn is_covered(&self) -> bool {
        let limit = (f64::from(R) - 1e-3).powi(2);
        self.vertices
            .iter()
            .all(|v| v[0] * v[0] + v[1] * v[1] <= limit)
    }

    /// Returns whether a sample at offset `p` may be one of a candidate's.
    pub(crate) fn may_concern(&self, p: (i32, i32)) -> bool {
        let (x, y) = (f64::from(p.0), f64::from(p.1));
        let limit = x * x + y * y - RELAXATION;
        self.vertices
            .iter()
            .any(|v| 2.0 * (v[0] * x + v[1] * y) >= limit)
    }
}
