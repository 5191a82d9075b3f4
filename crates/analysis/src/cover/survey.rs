//! Looks at one tile through its window: the largest value of the distance field, and its gaps.
//! Every place claimed is a Voronoi vertex, a border crossing or a corner of the window's samples.
//! It never judges whether the window was wide enough; its caller compares `side_reach` with the halo.

use spade::{DelaunayTriangulation, Point2, Triangulation};

use super::Task;
use super::border::{self, Site};
use super::circle::{circumcircle, is_below};
use super::tiles::{Tile, Window};
use crate::error::VerifyError;
use crate::report::{Gap, GapKind};

/// What a tile shows through a window.
pub(crate) struct Survey {
    /// Maximum, over the sides of the tile, of the distance to the window's samples. The rest
    /// holds for the whole set if the halo is at least that.
    pub side_reach: f64,
    /// The largest empty circle among the places that count for the region.
    pub covering_radius: f64,
    /// Those places whose circle exceeds the limit, the same place possibly several times.
    pub gaps: Vec<Gap>,
}

impl Survey {
    /// Looks along the sides.
    pub fn of_sides(task: &Task<'_>, tile: &Tile, window: &Window) -> Self {
        let mut survey = Self {
            side_reach: 0.0,
            covering_radius: 0.0,
            gaps: Vec::new(),
        };
        for axis in [0, 1] {
            for upper in [false, true] {
                survey.add_side(task, tile, window, Side { axis, upper });
            }
        }
        survey
    }

    /// A place whose empty circle counts for the region.
    fn claim(&mut self, task: &Task<'_>, gap: Gap) {
        self.covering_radius = self.covering_radius.max(gap.distance);
        if gap.distance > task.limit {
            self.gaps.push(gap);
        }
    }

    fn add_side(&mut self, task: &Task<'_>, tile: &Tile, window: &Window, side: Side) {
        let level = side.level(tile);
        let mut sites = side.sites(level, window);
        let (start, end) = (tile.low[side.axis], tile.high[side.axis]);
        let extent = task.grid.domain.extent;
        let on_border =
            !task.grid.domain.periodic && (level == 0.0 || level == extent[1 - side.axis]);
        for crossing in border::crossings(&mut sites) {
            let at = crossing.at;
            if at < start - task.same || at > end + task.same {
                continue;
            }
            self.side_reach = self.side_reach.max(crossing.distance);
            if on_border && (0.0..=extent[side.axis]).contains(&at) {
                let (center, distance) = (side.place(at, level), crossing.distance);
                let kind = GapKind::Border;
                self.claim(
                    task,
                    Gap {
                        center,
                        distance,
                        kind,
                    },
                );
            }
        }
        for at in [start, end] {
            let distances = sites.iter().map(|site| site.distance(at));
            let distance = distances.fold(f64::INFINITY, f64::min);
            self.side_reach = self.side_reach.max(distance);
            // A corner of the region ends two sides: the sides along x report it.
            if on_border && side.axis == 0 && (at == 0.0 || at == extent[0]) {
                let (center, kind) = (side.place(at, level), GapKind::Corner);
                self.claim(
                    task,
                    Gap {
                        center,
                        distance,
                        kind,
                    },
                );
            }
        }
    }

    /// Looks inside, at the circumcentres of the window's triangles.
    pub fn add_vertices(
        &mut self,
        task: &Task<'_>,
        tile: &Tile,
        points: Vec<Point2<f64>>,
    ) -> Result<(), VerifyError> {
        let domain = &task.grid.domain;
        let triangulation = triangulate(points).map_err(|cause| VerifyError::Triangulation {
            corner: tile.low.map(|value| value / domain.scale),
            cause,
        })?;
        // Beyond the border of a bounded region no place counts, however close.
        let [low, high] = [0, 1].map(|end| {
            let bound = |axis: usize| match end {
                0 if !domain.periodic => (tile.low[axis] - task.same).max(0.0),
                0 => tile.low[axis] - task.same,
                _ if !domain.periodic => (tile.high[axis] + task.same).min(domain.extent[axis]),
                _ => tile.high[axis] + task.same,
            };
            [bound(0), bound(1)]
        });
        let inside =
            |c: [f64; 2]| c[0] >= low[0] && c[0] <= high[0] && c[1] >= low[1] && c[1] <= high[1];
        let limit = task.limit * task.limit * (1.0 - 1e-12);
        let mut largest = 0.0_f64;
        for face in triangulation.inner_faces() {
            let corners = face.positions().map(|p| [p.x, p.y]);
            // Nearly all circles are neither gaps nor the largest so far.
            if is_below(corners, largest.min(limit)) {
                continue;
            }
            let circle = circumcircle(corners);
            if !inside(circle.center) {
                continue;
            }
            largest = largest.max(circle.square);
            if circle.square > limit {
                let (center, distance) = (circle.center, circle.square.sqrt());
                let kind = GapKind::VoronoiVertex;
                self.claim(
                    task,
                    Gap {
                        center,
                        distance,
                        kind,
                    },
                );
            }
        }
        self.covering_radius = self.covering_radius.max(largest.sqrt());
        Ok(())
    }
}

/// One side of a tile.
#[derive(Clone, Copy)]
struct Side {
    /// The axis it runs along.
    axis: usize,
    /// Whether it is the one at the larger coordinate.
    upper: bool,
}

impl Side {
    fn level(self, tile: &Tile) -> f64 {
        let corner = if self.upper { tile.high } else { tile.low };
        corner[1 - self.axis]
    }

    fn place(self, at: f64, level: f64) -> [f64; 2] {
        if self.axis == 0 {
            [at, level]
        } else {
            [level, at]
        }
    }

    /// The samples within the halo of the line. If none further off were nearest anywhere, neither
    /// is the result changed; if one were, the nearest kept is further than the halo, too.
    fn sites(self, level: f64, window: &Window) -> Vec<Site> {
        (window.points.iter())
            .map(|point| {
                let (along, across) = if self.axis == 0 {
                    (point.x, point.y)
                } else {
                    (point.y, point.x)
                };
                let offset = (across - level).abs();
                let foot = along;
                Site { foot, offset }
            })
            .filter(|site| site.offset <= window.halo)
            .collect()
    }
}

/// The Delaunay triangulation; the error is what it said about a coordinate that it refused.
fn triangulate(points: Vec<Point2<f64>>) -> Result<DelaunayTriangulation<Point2<f64>>, String> {
    DelaunayTriangulation::bulk_load(points).map_err(|error| error.to_string())
}

/// Whether three points are exactly on one line.
pub(crate) fn on_a_line(points: [[f64; 2]; 3]) -> bool {
    let tiny = |value: f64| {
        if value.abs() < spade::MIN_ALLOWED_VALUE {
            0.0
        } else {
            value
        }
    };
    let corners = points.map(|[x, y]| Point2::new(tiny(x), tiny(y)));
    // The predicates are exact, so there is a face if and only if the points span one.
    triangulate(corners.to_vec()).is_ok_and(|found| found.num_inner_faces() == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refused_coordinate_is_an_error_and_no_panic() {
        for bad in [f64::NAN, f64::INFINITY, 1e70, 1e-60] {
            let points = vec![Point2::new(0.0, 0.0), Point2::new(bad, 1.0)];
            assert!(triangulate(points).is_err(), "{bad}");
        }
    }

    #[test]
    fn lines_are_recognised_exactly() {
        assert!(on_a_line([[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]]));
        assert!(on_a_line([[0.3, 0.1], [0.3, 0.7], [0.3, 0.2]]));
        let above = f64::from_bits(0.5f64.to_bits() + 1);
        assert!(!on_a_line([[0.0, 0.0], [0.5, above], [1.0, 1.0]]));
    }
}
