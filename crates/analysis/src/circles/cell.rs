//! The Voronoi cell of a sample, cut out of a square by one neighbour after the other: where its circle is exposed, if it is.
//! The places of a cell farthest from its sample are corners of the cell, and those are centres of empty circles.
//! Their radii come from the samples on the circles, three or, at a border, two or one, and have the same bits in
//! whichever cell they are seen.

use glam::DVec2;

use super::gaps::CellReach;
use super::sample::Sample;
use super::samples::Samples;
use super::tile::Tile;
use crate::border::BorderLine;
use crate::exact::{DOUBT, Site, circle_exceeds, corner_exceeds, crossing_exceeds, exceeds};
use crate::witness::{Gap, GapKind};

/// The line on which an edge of a cell lies.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Edge {
    /// The border of the surroundings in which all samples are known.
    Unknown,
    /// A line of the border of a bounded region.
    Border(BorderLine),
    /// The bisector with a sample of the tile.
    Bisector(usize),
}

/// A corner of a cell, and the edge from there to the next corner, anticlockwise.
#[derive(Clone, Copy, Debug)]
struct Corner {
    at: DVec2,
    edge: Edge,
}

/// Cuts out cells. Its buffers are reused from cell to cell.
#[derive(Debug, Default)]
pub(super) struct CellCutter {
    corners: Vec<Corner>,
    kept: Vec<Corner>,
}

impl CellCutter {
    /// Returns how far the cell of the tile's sample `index` reaches, and as gaps its corners farther than `limit`. The cell
    /// is cut by the samples within `around` grid cells. Returns `None` if farther samples may matter.
    pub fn cut(
        &mut self,
        samples: &Samples<'_>,
        tile: &Tile,
        index: usize,
        around: [usize; 2],
        limit: f64,
    ) -> Option<CellReach> {
        let known = samples.cells.certain_distance(around);
        self.begin(samples, tile.position(index), known);
        tile.around(index, around, |other, offset| self.clip(offset, other));

        let farthest = (self.corners.iter())
            .map(|corner| corner.at.length())
            .fold(0.0, f64::max);
        // A sample that cuts a corner off is at most twice as far away as the corner. So all samples that matter are known if
        // every corner is within half of the known surroundings, less some rounding, and no side of their square is left.
        let is_unknown = |corner: &Corner| corner.edge == Edge::Unknown;
        if self.corners.iter().any(is_unknown) || 2.0 * farthest * (1.0 + DOUBT) > known {
            return None;
        }

        let mut reach = CellReach::default();
        for (number, corner) in self.corners.iter().enumerate() {
            // A corner lies between the edge from the corner before it and the edge from itself.
            let before = self.corners[(number + self.corners.len() - 1) % self.corners.len()];
            let circles = Circles {
                samples,
                tile,
                index,
            };
            // A corner that only rounding makes has no circle.
            let Some((circle, is_larger)) = circles.at([before.edge, corner.edge], limit) else {
                continue;
            };
            reach.farthest = reach.farthest.max(circle.distance);
            if is_larger {
                reach.gaps.push(circle);
            }
        }
        Some(reach)
    }

    /// Begins with the square around the sample in which all samples are known, cut at the border of a bounded region.
    fn begin(&mut self, samples: &Samples<'_>, position: DVec2, known: f64) {
        let domain = &samples.cells.domain;
        let (mut low, mut high) = (DVec2::splat(-known), DVec2::splat(known));
        let mut edges = [[Edge::Unknown; 2]; 2];
        for &line in domain.border() {
            let depth = line.depth(position, domain.extent);
            // Farther lines do not reach the square.
            if depth <= known {
                // Corners are seen from the sample, so that a line toward the origin has a negative coordinate.
                let corner = if line.is_far { &mut high } else { &mut low };
                corner[line.axis] = line.outward()[line.axis] * depth;
                edges[line.axis][usize::from(line.is_far)] = Edge::Border(line);
            }
        }

        // Corners go anticlockwise from the lowest one on, each with the edge that begins at it.
        let [[left, right], [bottom, top]] = edges;
        self.corners.clear();
        self.corners.extend([
            Corner {
                at: low,
                edge: bottom,
            },
            Corner {
                at: DVec2::new(high.x, low.y),
                edge: right,
            },
            Corner {
                at: high,
                edge: top,
            },
            Corner {
                at: DVec2::new(low.x, high.y),
                edge: left,
            },
        ]);
    }

    /// Cuts off the part of the cell that is nearer to a neighbour, which lies at `offset` from the sample.
    fn clip(&mut self, offset: DVec2, neighbour: usize) {
        // The places p of the bisector have p . offset = |offset|^2 / 2. On the neighbour's side of it `beyond` is positive.
        let limit = 0.5 * offset.length_squared();
        let beyond = |corner: &Corner| corner.at.dot(offset) - limit;
        // A neighbour at the sample's own place has the same cell, and cuts nothing off.
        if limit == 0.0 || self.corners.iter().all(|corner| beyond(corner) <= 0.0) {
            return;
        }

        self.kept.clear();
        for (number, corner) in self.corners.iter().enumerate() {
            let next = &self.corners[(number + 1) % self.corners.len()];
            let (here, there) = (beyond(corner), beyond(next));
            if here <= 0.0 {
                self.kept.push(*corner);
            }

            // The bisector crosses the edge from here to there.
            if (here <= 0.0) != (there <= 0.0) {
                let crossing = corner.at + (next.at - corner.at) * (here / (here - there));
                // Where the outline leaves the part that is kept, it goes on along the bisector; where it comes back, along
                // the old edge.
                let edge = if here <= 0.0 {
                    Edge::Bisector(neighbour)
                } else {
                    corner.edge
                };
                self.kept.push(Corner { at: crossing, edge });
            }
        }
        std::mem::swap(&mut self.corners, &mut self.kept);
    }
}

/// The empty circles about the corners of one sample's cell.
struct Circles<'a> {
    samples: &'a Samples<'a>,
    tile: &'a Tile,
    index: usize,
}

impl Circles<'_> {
    /// The circle about the corner between two edges, and whether it is larger than the limit. None for a corner that only
    /// rounding makes: between parallel sides.
    fn at(&self, edges: [Edge; 2], limit: f64) -> Option<(Gap, bool)> {
        match edges {
            [Edge::Bisector(a), Edge::Bisector(b)] => self.vertex([self.index, a, b], limit),
            [Edge::Bisector(other), Edge::Border(line)]
            | [Edge::Border(line), Edge::Bisector(other)] => {
                self.crossing([self.index, other], line, limit)
            }
            [Edge::Border(one), Edge::Border(other)] if one.axis != other.axis => {
                Some(self.corner([one, other], limit))
            }
            // Two parallel sides of the region. (`cut` has left cells with an unknown edge out.)
            _ => None,
        }
    }

    /// Returns the circle through three samples, and whether it is larger than the limit. None for samples on a line.
    fn vertex(&self, indices: [usize; 3], limit: f64) -> Option<(Gap, bool)> {
        let [first, second, third] = self.in_sequence(indices);
        let (a, b) = (self.between(first, second), self.between(first, third));
        let c = b - a;

        // The centre loses the fewest digits as seen from the corner opposite the longest edge. `corner` is its offset from the
        // first sample; `p` and `q` are the two edges that begin at it.
        let squares = [a, b, c].map(DVec2::length_squared);
        let (corner, p, q) = if squares[2] >= squares[0] && squares[2] >= squares[1] {
            (DVec2::ZERO, a, b)
        } else if squares[1] >= squares[0] {
            (a, c, -a)
        } else {
            (b, -b, -c)
        };
        let double_area = p.perp_dot(q);
        // Three samples on a line have no circle; rounding alone made this corner.
        if double_area == 0.0 {
            return None;
        }

        let (pp, qq) = (p.length_squared(), q.length_squared());
        let offset = (p * qq - q * pp).perp() * (0.5 / double_area);
        let distance = offset.length();
        // How much the division by the area enlarges errors of the lengths.
        let flatness = (pp * qq).sqrt() / double_area.abs();
        let gap = Gap {
            center: self.home(first.position + corner + offset).to_array(),
            distance,
            kind: GapKind::VoronoiVertex,
        };

        let is_larger = exceeds(distance, limit, flatness, || {
            circle_exceeds([first, second, third], self.extent(), limit)
        });
        Some((gap, is_larger))
    }

    /// Returns the circle about the crossing of two samples' bisector with a line of the border, and whether it is larger than
    /// the limit. None for a bisector parallel to the line.
    fn crossing(&self, indices: [usize; 2], line: BorderLine, limit: f64) -> Option<(Gap, bool)> {
        let [first, second] = self.in_sequence(indices);
        let (axis, level) = (line.axis, line.level(self.extent()));
        let [p, q] = [first, second].map(|site| site.position);
        let (p_off, q_off) = (p[axis] - level, q[axis] - level);
        let along = q[1 - axis] - p[1 - axis];
        // The bisector of two samples that differ only in their distance from the line is parallel to it.
        if along == 0.0 {
            return None;
        }

        // Both samples are equally far from the crossing: a linear equation for the step from the first one along the line.
        let step = 0.5 * (along + (q_off - p_off) * (q_off + p_off) / along);
        let distance = step.hypot(p_off);

        let mut center = p;
        center[axis] = level;
        // Rounding may take the centre beyond the end of the line.
        center[1 - axis] = (p[1 - axis] + step).clamp(0.0, self.extent()[1 - axis]);
        let gap = Gap {
            center: center.to_array(),
            distance,
            kind: GapKind::Border,
        };

        // How much the division by `along` enlarges errors of the lengths.
        let flatness = distance / along.abs();
        let is_larger = exceeds(distance, limit, flatness, || {
            crossing_exceeds([first, second], line, self.extent(), limit)
        });
        Some((gap, is_larger))
    }

    /// Returns the circle about a corner of the region, and whether it is larger than the limit.
    fn corner(&self, lines: [BorderLine; 2], limit: f64) -> (Gap, bool) {
        let [site] = self.in_sequence([self.index]);
        let extent = self.extent();
        let mut corner = DVec2::ZERO;
        for line in lines {
            corner[line.axis] = line.level(extent);
        }

        let distance = (corner - site.position).length();
        let gap = Gap {
            center: corner.to_array(),
            distance,
            kind: GapKind::Corner,
        };
        // Nothing is divided, so that no error grows.
        let flatness = 1.0;
        let is_larger = exceeds(distance, limit, flatness, || {
            corner_exceeds(site, corner, extent, limit)
        });
        (gap, is_larger)
    }

    /// Returns samples with the shifts of their copies, in periods, in an order that does not depend on which cell is
    /// cut: by id, and shifted so that the first one is no copy.
    fn in_sequence<const N: usize>(&self, indices: [usize; N]) -> [Site; N] {
        let mut with_ids = indices.map(|index| {
            let Sample { position, id } = self.samples.at(self.tile.source[index] as usize);
            // In a bounded region the periods are infinite, and no sample is moved.
            let moved =
                (self.tile.position(index) - position) / self.samples.cells.domain.periods();
            let periods = moved.to_array().map(|value| value.round() as i64);
            (id, Site { position, periods })
        });

        with_ids.sort_unstable_by_key(|(id, site)| (*id, site.periods));
        let mut sites = with_ids.map(|(_, site)| site);
        // All cells that see these samples shift them alike, and so compute the same bits.
        let home = sites[0].periods;
        for site in &mut sites {
            site.periods = [0, 1].map(|axis| site.periods[axis] - home[axis]);
        }
        sites
    }

    /// The offset of a site from one that is not shifted.
    fn between(&self, first: Site, site: Site) -> DVec2 {
        let periods = DVec2::from(site.periods.map(|count| count as f64));
        (site.position - first.position) + periods * self.extent()
    }

    fn extent(&self) -> DVec2 {
        self.samples.cells.domain.extent
    }

    /// The place within the region: wrapped around a torus, clamped to a bounded region.
    fn home(&self, place: DVec2) -> DVec2 {
        let extent = self.extent();
        if !self.samples.cells.domain.periodic {
            return place.clamp(DVec2::ZERO, extent);
        }
        let wrapped = place - (place / extent).floor() * extent;
        // A place just below 0 may be rounded up to the period, which is 0.
        DVec2::select(wrapped.cmplt(extent), wrapped, DVec2::ZERO)
    }
}
