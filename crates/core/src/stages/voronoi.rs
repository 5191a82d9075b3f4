//! A filter for gap detection: the Voronoi cell of one sample, built slightly too large in
//! floating point. It only says which samples *may* take part in a candidate; integers decide.
//!
//! A candidate c of a detector i is nearly a Voronoi vertex of i: no sample p is nearer to it than
//! i by more than 22 R in squared distance (12 R by definition, under 9.7 R from rounding c at a
//! distance of at most 3.42 r). So c lies in the cell whose bisectors are moved outwards by
//! `RELAXATION` = 32 R, and the candidate's other samples have bisectors, moved inwards by as
//! much, that reach this cell. The remaining 10 R are at least 1.4 units anywhere in reach, while
//! the clipping errors of f64 at these magnitudes stay far below a thousandth of a unit.

use glam::{DVec2, IVec2};

use crate::lattice::R;

const RELAXATION: f64 = 32.0 * R as f64;

/// A relaxed Voronoi cell around the origin.
#[derive(Default)]
pub(crate) struct RelaxedCell {
    vertices: Vec<DVec2>,
    clipped: Vec<DVec2>,
}

impl RelaxedCell {
    /// Starts with a box.
    pub(crate) fn reset(&mut self, min: DVec2, max: DVec2) {
        self.vertices.clear();
        self.vertices
            .extend([min, min.with_x(max.x), max, max.with_x(min.x)]);
    }

    /// Cuts off the part that is nearer to a sample at offset `p` than to the origin by more than the relaxation
    /// (Sutherland and Hodgman's clip of a convex polygon).
    pub(crate) fn clip(&mut self, p: IVec2) {
        let p = p.as_dvec2();
        let limit = p.length_squared() + RELAXATION;
        let beyond = |v: DVec2| 2.0 * v.dot(p) - limit;

        // A cell has about six edges, and dozens of samples are tried: most cut nothing off.
        if self.vertices.iter().all(|v| beyond(*v) <= 0.0) {
            return;
        }

        self.clipped.clear();
        for (k, &v) in self.vertices.iter().enumerate() {
            let w = self.vertices[(k + 1) % self.vertices.len()];
            let (a, b) = (beyond(v), beyond(w));
            if a <= 0.0 {
                self.clipped.push(v);
            }
            // An edge whose ends lie strictly on opposite sides crosses the line. A vertex on the line needs no crossing: it
            // is taken as a vertex. So a and b have different signs, and the quotient does not divide by 0.
            if (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0) {
                self.clipped.push(v + a / (a - b) * (w - v));
            }
        }

        std::mem::swap(&mut self.vertices, &mut self.clipped);
    }

    /// Returns whether the origin's own disk, a thousandth of a unit smaller, covers the cell:
    /// then there is no uncovered point in it.
    pub(crate) fn is_covered(&self) -> bool {
        let limit = (f64::from(R) - 1e-3).powi(2);
        self.vertices.iter().all(|v| v.length_squared() <= limit)
    }

    /// Returns whether a sample at offset `p` may be one of a candidate's.
    pub(crate) fn may_concern(&self, p: IVec2) -> bool {
        let p = p.as_dvec2();
        let limit = p.length_squared() - RELAXATION;
        self.vertices.iter().any(|v| 2.0 * v.dot(p) >= limit)
    }
}
