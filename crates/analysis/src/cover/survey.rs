//! The result for one tile and its window: the largest distance of a place from the samples, and the gaps. Every place
//! claimed is a Voronoi vertex, a border crossing or a corner of the window's samples. A window has the samples within a
//! halo around its tile. Whether it was wide enough is for the caller to decide, who compares `side_reach` with the
//! halo. Two places no more than `same` apart count as one place.

use glam::DVec2;
use spade::{Point2, Triangulation};

use super::CoverSearch;
use super::border::{self, BorderSite};
use super::circle::{circumcircle, is_below};
use super::tiles::{Tile, TileWindow, original};
use crate::border::BorderLine;
use crate::delaunay::delaunay;
use crate::error::VerifyError;
use crate::exact::{Site, circle_exceeds, corner_exceeds, crossing_exceeds, exceeds};
use crate::witness::{Gap, GapKind};

/// The result for a tile and a window.
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
    /// Examines the sides of a tile, and nothing inside of it.
    pub fn of_sides(task: &CoverSearch<'_>, tile: &Tile, window: &TileWindow) -> Self {
        let mut survey = Self {
            side_reach: 0.0,
            covering_radius: 0.0,
            gaps: Vec::new(),
        };
        for line in BorderLine::ALL {
            survey.add_side(task, tile, window, TileSide { line });
        }
        survey
    }

    /// Records a place whose empty circle counts for the region, and which is a gap if the circle exceeds the limit. `exact`
    /// compares its radius with the limit without rounding.
    fn claim(&mut self, task: &CoverSearch<'_>, circle: Gap, exact: impl FnOnce() -> bool) {
        // The factor by which a flat triangle enlarges the error is 1 here: its centre is as exact as that of others.
        if exceeds(circle.distance, task.limit, 1.0, exact) {
            self.covering_radius = self.covering_radius.max(circle.distance);
            self.gaps.push(circle);
        } else {
            // The circle does not exceed the limit, though its rounded radius may.
            let distance = circle.distance.min(task.limit);
            self.covering_radius = self.covering_radius.max(distance);
        }
    }

    /// Examines one side: where it leaves the cell of one sample for that of the next, and its ends.
    fn add_side(
        &mut self,
        task: &CoverSearch<'_>,
        tile: &Tile,
        window: &TileWindow,
        side: TileSide,
    ) {
        let level = side.level(tile);
        let mut sites = side.sites(level, window);
        let (start, end) = (tile.low[side.along()], tile.high[side.along()]);

        let domain = task.domain();
        let extent = domain.extent;
        // Sides between tiles matter for the reach alone; their places are inside the region.
        let on_border = domain.border().contains(&side.line) && level == side.line.level(extent);

        for crossing in border::crossings(&mut sites) {
            let at = crossing.at;
            // The window also holds samples beyond the ends of the side. Crossings beyond the ends belong to other
            // sides; one within `same` of an end may be there by rounding.
            if at < start - task.same || at > end + task.same {
                continue;
            }

            self.side_reach = self.side_reach.max(crossing.distance);
            // A place beyond a corner of the region counts for no side, however close.
            if on_border && (0.0..=extent[side.along()]).contains(&at) {
                let circle = Gap {
                    center: side.place(at, level),
                    distance: crossing.distance,
                    kind: GapKind::Border,
                };
                let nearest = crossing.sites.map(|site| side.site(site, level));
                self.claim(task, circle, || {
                    crossing_exceeds(nearest, side.line, extent, task.limit)
                });
            }
        }

        for at in [start, end] {
            let distances = sites.iter().map(|site| site.distance(at));
            let distance = distances.fold(f64::INFINITY, f64::min);
            self.side_reach = self.side_reach.max(distance);

            // A corner of the region ends two sides: the sides along x report it.
            if on_border && side.along() == 0 && (at == 0.0 || at == extent[0]) {
                let circle = Gap {
                    center: side.place(at, level),
                    distance,
                    kind: GapKind::Corner,
                };
                let corner = DVec2::from(circle.center);
                self.claim(task, circle, || {
                    // The distance to the nearest sample exceeds the limit if those to all samples do. By rounding another
                    // one may be the nearest, but none at more than twice the distance.
                    let mut near = (sites.iter())
                        .filter(|site| site.distance(at) <= 2.0 * distance)
                        .map(|site| side.site(*site, level));

                    near.all(|site| corner_exceeds(site, corner, extent, task.limit))
                });
            }
        }
    }

    /// Examines the inside of a tile: the circumcentres of the triangles of `points`, the window's samples.
    pub fn add_vertices(
        &mut self,
        task: &CoverSearch<'_>,
        tile: &Tile,
        points: Vec<Point2<f64>>,
    ) -> Result<(), VerifyError> {
        let domain = &task.grid.domain;
        let triangulation = delaunay(points).map_err(|cause| VerifyError::Triangulation {
            corner: (tile.low / domain.scale).to_array(),
            cause,
        })?;
        // Samples on a line have no circle.
        let Some(triangulation) = triangulation else {
            return Ok(());
        };

        // Rounding may put a centre on a side beyond it: both tiles at the side claim it, and equal places are merged
        // in the end. Beyond the border of a bounded region no place counts, however close.
        let (mut low, mut high) = (tile.low - task.same, tile.high + task.same);
        if !domain.periodic {
            low = low.max(DVec2::ZERO);
            high = high.min(domain.extent);
        }
        let inside = |place: DVec2| (place.cmpge(low) & place.cmple(high)).all();

        // A circle whose square is within rounding of the limit's is claimed, as `claim` compares it exactly.
        let limit_square = task.limit * task.limit * (1.0 - 1e-12);
        let mut largest_square = 0.0_f64;
        for face in triangulation.inner_faces() {
            let corners = face.positions().map(|p| DVec2::new(p.x, p.y));

            // Nearly all circles are neither gaps nor the largest so far.
            if is_below(corners, largest_square.min(limit_square)) {
                continue;
            }
            let circle = circumcircle(corners);
            // A circle counts in the tile that holds its centre.
            if !inside(circle.center) {
                continue;
            }
            if circle.square <= limit_square {
                largest_square = largest_square.max(circle.square);
                continue;
            }

            let gap = Gap {
                center: circle.center.to_array(),
                distance: circle.square.sqrt(),
                kind: GapKind::VoronoiVertex,
            };
            self.claim(task, gap, || {
                let sites = corners.map(|corner| original(task.grid, corner));
                circle_exceeds(sites, domain.extent, task.limit)
            });
        }
        self.covering_radius = self.covering_radius.max(largest_square.sqrt());
        Ok(())
    }
}

/// One side of a tile, parallel to the line of the border that it may lie on.
#[derive(Clone, Copy)]
struct TileSide {
    line: BorderLine,
}

impl TileSide {
    /// The axis it runs along.
    fn along(self) -> usize {
        1 - self.line.axis
    }

    /// The coordinate of the side on the axis across it.
    fn level(self, tile: &Tile) -> f64 {
        let corner = if self.line.is_far {
            tile.high
        } else {
            tile.low
        };
        corner[self.line.axis]
    }

    /// A sample that was seen from this side, a side of the region.
    fn site(self, seen: BorderSite, level: f64) -> Site {
        let across = if self.line.is_far {
            level - seen.offset
        } else {
            level + seen.offset
        };
        Site::at(self.place(seen.foot, across).into())
    }

    /// The place at a coordinate along the side and one across it.
    fn place(self, at: f64, level: f64) -> [f64; 2] {
        if self.along() == 0 {
            [at, level]
        } else {
            [level, at]
        }
    }

    /// The samples within the halo of the line. Where a sample further off would be the nearest, all samples that are
    /// kept are further than the halo, too, so that the reach exceeds the halo, and the window is widened.
    fn sites(self, level: f64, window: &TileWindow) -> Vec<BorderSite> {
        (window.points.iter())
            .map(|point| {
                let (along, across) = if self.along() == 0 {
                    (point.x, point.y)
                } else {
                    (point.y, point.x)
                };
                let offset = (across - level).abs();
                let foot = along;
                BorderSite { foot, offset }
            })
            .filter(|site| site.offset <= window.halo)
            .collect()
    }
}
