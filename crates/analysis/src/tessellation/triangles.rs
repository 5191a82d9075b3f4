//! Delaunay triangles of a set. Those of a periodic set are read off the corners of its Voronoi cells, so
//! that cocircular samples at a seam are cut into triangles in one way only.

use glam::{DVec2, IVec2};

use super::cells::Cells;
use crate::cover::circle::circumcircle;

/// A Delaunay triangle with its empty circle.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Triangle {
    /// Its samples, by index.
    pub sites: [usize; 3],
    /// Their positions, counter-clockwise; in a periodic domain copies that belong together, which may lie outside it.
    pub corners: [DVec2; 3],
    /// The centre of the circle through them.
    pub center: DVec2,
    /// The radius of that circle: the distance from its centre to the nearest samples.
    pub circumradius: f64,
}

impl Triangle {
    pub(super) fn new(mut sites: [usize; 3], mut corners: [DVec2; 3]) -> Self {
        let [a, b, c] = corners;
        if (b - a).perp_dot(c - a) < 0.0 {
            sites.swap(1, 2);
            corners.swap(1, 2);
        }
        let circle = circumcircle(corners);
        Self {
            sites,
            corners,
            center: circle.center,
            circumradius: circle.square.sqrt(),
        }
    }

    /// The triangle in the unit of the samples.
    pub(super) fn scaled(self, scale: f64) -> Self {
        Self {
            corners: self.corners.map(|corner| corner / scale),
            center: self.center / scale,
            circumradius: self.circumradius / scale,
            ..self
        }
    }
}

/// Returns the triangles of a periodic set: goes once around every Voronoi vertex, and cuts the polygon of the samples around it
/// into triangles.
pub(super) fn around_vertices(cells: &Cells) -> Vec<Triangle> {
    let mut done = vec![false; cells.sides.len()];
    let mut triangles = Vec::with_capacity(2 * cells.samples.len());
    let mut around: Vec<(usize, DVec2)> = Vec::new();

    for start in 0..cells.sides.len() {
        around.clear();
        let (mut side, mut shift) = (start, IVec2::ZERO);
        while !done[side] {
            done[side] = true;
            let sample = cells.sides[side].cell;
            around.push((sample, cells.shifted(cells.samples[sample], shift)));

            // Around the vertex at which the side begins, the next cell lies beyond the side before it. A side without a twin,
            // as rounding may leave one, ends the walk, and the samples met so far make the triangles.
            let before = cells.before(side);
            let (Some(twin), Some(beyond)) = (cells.sides[before].twin, cells.sides[before].beyond)
            else {
                break;
            };
            shift += beyond.shift;
            side = twin;
        }

        // The samples around a vertex lie on one circle. Their polygon is cut into a fan: each triangle has the first
        // sample and a pair of neighbours. The first pair is skipped, as the first sample is in it.
        for pair in around.windows(2).skip(1) {
            let corners = [around[0], pair[0], pair[1]];
            let (samples, places) = (
                corners.map(|corner| corner.0),
                corners.map(|corner| corner.1),
            );
            triangles.push(Triangle::new(samples, places));
        }
    }
    triangles
}
