//! The uncovered set as connected regions with exact borders of arcs and lines.
//! In its Voronoi cell a sample's disk alone decides, so each cell gives strips between an arc and its
//! sides, and strips that share a part of a side belong together.

use glam::{DVec2, IVec2};

use super::borders::Drawn;
use super::cells::Cells;

/// The largest angle of a chord of [`GapRegion::fill`]: it departs from the arc by 0.002 radii.
const CHORD: f64 = 0.126;

/// How far, relative to a strip, a place may lie beyond it.
const SEAM: f64 = 1e-12;

/// A part of a gap's border, with the gap on its left.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Edge {
    /// Part of a disk's border, clockwise about the sample; a whole circle spans a full turn.
    Arc {
        /// The sample, by index.
        sample: usize,
        /// Its position, or that of the copy at the gap.
        center: DVec2,
        /// The direction of the start from the centre, in radians, counter-clockwise from the x axis.
        from_angle: f64,
        /// The direction of the end; smaller than that of the start.
        to_angle: f64,
    },
    /// Part of the border of a bounded domain.
    Line {
        /// Where it begins, with the gap on its left.
        from: DVec2,
        /// Where it ends, going along the gap.
        to: DVec2,
    },
}

/// A connected part of the domain that no disk covers.
///
/// In a periodic domain its places are unwrapped, so that a gap across a seam is in one piece. A gap that
/// goes around the domain meets itself a period further on.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct GapRegion {
    /// The area of the part.
    pub area: f64,
    /// The loops of its border, each with the gap on its left: the outer one and one for each island.
    pub boundary: Vec<Vec<Edge>>,
    /// The samples whose disks bound it or whose Voronoi cells reach into it, in ascending order.
    pub sites: Vec<usize>,
    /// The place furthest from all samples and its distance from the nearest.
    pub deepest: (DVec2, f64),
    /// Triangles that cover it for drawing; they lie over the disks around by 0.002 radii at most.
    pub fill: Vec<[DVec2; 3]>,
    strips: Vec<Strip>,
    radius: f64,
    period: Option<DVec2>,
}

/// The area between a disk and a part of a side.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
struct Strip {
    center: DVec2,
    from: DVec2,
    to: DVec2,
}

impl Strip {
    /// Its ends from the centre of the disk.
    fn ends(&self) -> [DVec2; 2] {
        [self.from - self.center, self.to - self.center]
    }
}

impl GapRegion {
    /// Returns whether a place lies in the gap; in a periodic domain any of its copies will do.
    #[must_use]
    pub fn contains(&self, place: impl Into<DVec2>) -> bool {
        let place = place.into();
        self.strips.iter().any(|strip| {
            let mut offset = place - strip.center;
            if let Some(period) = self.period {
                // No place of a cell is further than half a period from its sample.
                offset -= period * (offset / period).round();
            }
            let [from, to] = strip.ends();
            // A place on a side between two cells must not fall between them by rounding.
            let least = -SEAM * from.length_squared().max(to.length_squared());
            from.perp_dot(offset) >= least
                && offset.perp_dot(to) >= least
                && (to - from).perp_dot(offset - from) >= least
                && offset.length_squared() > self.radius * self.radius
        })
    }
}

/// A part of a side that the disk of its cell leaves uncovered: at the start of the side (its head, which may be the whole
/// side) or at its end (its tail). The number is twice the side's index, and one more for a tail.
pub(super) type Part = usize;

/// Returns the index of the side that a part belongs to.
pub(super) const fn side_of(part: Part) -> usize {
    part / 2
}

/// Returns the part at the start of a side.
pub(super) const fn head_of(side: usize) -> Part {
    2 * side
}

/// Returns the part at the end of a side.
const fn tail_of(side: usize) -> Part {
    2 * side + 1
}

/// Whether a part lies at the start of its side, or is the whole of it.
fn is_head(part: Part) -> bool {
    part.is_multiple_of(2)
}

/// Consecutive parts of one cell, counter-clockwise, and the arc inside them.
pub(super) struct Run {
    pub parts: Vec<Part>,
    /// Whether the arc is the whole circle.
    pub closed: bool,
}

/// The parts of all sides, by run.
pub(super) struct Runs<'a> {
    pub cells: &'a Cells,
    pub list: Vec<Run>,
    /// The index of the run of each part.
    pub run_of: Vec<usize>,
}

/// The run of a part that no gap has.
const NO_RUN: usize = usize::MAX;

/// Returns the gaps, in the unit of the samples.
pub(super) fn find(cells: &Cells, scale: f64) -> Vec<GapRegion> {
    let runs = Runs::new(cells);
    let mut seen = vec![false; runs.list.len()];
    let mut drawn = Drawn::new(&runs);
    let mut gaps = Vec::new();
    for first in 0..runs.list.len() {
        if !seen[first] {
            let members = runs.connected(first, &mut seen);
            gaps.push(runs.gap(&members, &mut drawn).in_user_units(scale));
        }
    }
    gaps
}

impl<'a> Runs<'a> {
    fn new(cells: &'a Cells) -> Self {
        let mut runs = Self {
            cells,
            list: Vec::new(),
            run_of: vec![NO_RUN; 2 * cells.sides.len()],
        };
        for cell in 0..cells.samples.len() {
            runs.add_cell(cell);
        }
        runs
    }

    /// Adds the runs of a cell: parts that follow each other at corners of the cell.
    fn add_cell(&mut self, cell: usize) {
        let sides = &self.cells.sides;
        let has = |part: &Part| {
            let side = &sides[side_of(*part)];
            if is_head(*part) { side.head } else { side.tail }.is_some()
        };
        // The head of each side comes before its tail.
        let mut parts: Vec<Part> = self
            .cells
            .of(cell)
            .flat_map(|side| [head_of(side), tail_of(side)])
            .filter(has)
            .collect();

        // A side leaves the disk by a tail, which begins on the circle. If there is no tail, no side leaves the disk,
        // and so none enters it: all parts are one run, and the circle is whole. It is checked all the same that no
        // part ends on the circle.
        let Some(start) = parts.iter().position(|&part| !is_head(part)) else {
            if !parts.is_empty() {
                let closed = parts.iter().all(|&part| self.ends_at_corner(part));
                self.push(Run { parts, closed });
            }
            return;
        };

        // The first run begins with a tail, and a new run with each further tail.
        parts.rotate_left(start);
        let mut rest = &parts[..];
        while !rest.is_empty() {
            let next = rest[1..].iter().position(|part| !is_head(*part));
            let (run, others) = rest.split_at(next.map_or(rest.len(), |at| at + 1));
            self.push(Run {
                parts: run.to_vec(),
                closed: false,
            });
            rest = others;
        }
    }

    /// Adds a run, to which its parts belong from now on.
    fn push(&mut self, run: Run) {
        for &part in &run.parts {
            self.run_of[part] = self.list.len();
        }
        self.list.push(run);
    }

    /// Whether a part goes on to the end of its side; otherwise it ends on the circle.
    pub fn ends_at_corner(&self, part: Part) -> bool {
        !is_head(part) || self.cells.sides[side_of(part)].head == Some(1.0)
    }

    /// Returns the ends of a part. A part that its side does not have would have no length.
    pub fn places(&self, part: Part) -> [DVec2; 2] {
        let side = &self.cells.sides[side_of(part)];
        let [from, to] = if is_head(part) {
            [0.0, side.head.unwrap_or(0.0)]
        } else {
            [side.tail.unwrap_or(1.0), 1.0]
        };
        [
            self.cells.place(side_of(part), from),
            self.cells.place(side_of(part), to),
        ]
    }

    /// The same part in the cell beyond and how many periods on that is; none on the border, or if that cell has no
    /// such part.
    pub fn across(&self, part: Part) -> Option<(Part, IVec2)> {
        let side = &self.cells.sides[side_of(part)];
        let (twin, beyond) = (side.twin?, side.beyond?);
        // The twin goes the other way, so that a head is its tail; a side that is wholly outside has a head alone.
        let whole = self.cells.sides[twin].head == Some(1.0);
        let other = if whole || !is_head(part) {
            head_of(twin)
        } else {
            tail_of(twin)
        };
        (self.run_of[other] != NO_RUN).then_some((other, beyond.shift))
    }

    /// Returns the runs that make one gap with the first one, each with the periods by which it is moved.
    fn connected(&self, first: usize, seen: &mut [bool]) -> Vec<(usize, IVec2)> {
        // Each run found is added at the end and looked at in its turn, until no other can be reached.
        let mut members = vec![(first, IVec2::ZERO)];
        seen[first] = true;
        let mut next = 0;
        while let Some(&(run, shift)) = members.get(next) {
            next += 1;
            for &part in &self.list[run].parts {
                let Some((part_beyond, by)) = self.across(part) else {
                    continue;
                };
                let run_beyond = self.run_of[part_beyond];
                // A gap around the torus meets its runs again, a period on: the first copy stays.
                if !seen[run_beyond] {
                    seen[run_beyond] = true;
                    members.push((run_beyond, shift + by));
                }
            }
        }
        members
    }

    /// Returns the cell whose sides the parts of a run lie on.
    pub fn cell(&self, run: usize) -> usize {
        self.cells.sides[side_of(self.list[run].parts[0])].cell
    }

    /// Returns the gap of some runs, each with the periods by which it is moved.
    fn gap(&self, members: &[(usize, IVec2)], drawn: &mut Drawn) -> GapRegion {
        let cells = self.cells;
        let mut gap = GapRegion {
            area: 0.0,
            boundary: drawn.boundary(self, members),
            sites: members.iter().map(|&(run, _)| self.cell(run)).collect(),
            deepest: (DVec2::ZERO, 0.0),
            fill: Vec::new(),
            strips: Vec::new(),
            radius: cells.radius,
            period: cells.domain.periodic.then_some(cells.domain.extent),
        };
        // A sample may have several runs in one gap.
        gap.sites.sort_unstable();
        gap.sites.dedup();

        for &(run, shift) in members {
            let center = cells.shifted(cells.samples[self.cell(run)], shift);
            for &part in &self.list[run].parts {
                let [from, to] = self.places(part).map(|place| cells.shifted(place, shift));
                gap.add_strip(Strip { center, from, to });

                // The deepest place is a corner, as the distance is convex on every side. A head begins at a corner, and a tail
                // ends at the corner where the next side begins.
                let side = if is_head(part) {
                    side_of(part)
                } else {
                    cells.next(side_of(part))
                };
                let reach = cells.sides[side].reach;
                if reach > gap.deepest.1 {
                    gap.deepest = (if is_head(part) { from } else { to }, reach);
                }
            }
        }
        gap
    }
}

impl GapRegion {
    /// Adds a strip with its area, which is that of a triangle less a sector of the disk.
    fn add_strip(&mut self, strip: Strip) {
        let [from, to] = strip.ends();
        let angle = from.perp_dot(to).atan2(from.dot(to));
        // On a border that runs through the sample the strip has no area.
        if angle <= 0.0 {
            return;
        }

        self.area += 0.5 * (from.perp_dot(to) - self.radius * self.radius * angle);
        self.strips.push(strip);

        // The strip is drawn in pieces whose chords hardly leave the arc.
        let count = (angle / CHORD).ceil();
        self.fill.reserve(2 * count as usize);
        let first = from.to_angle();
        let across = to - from;
        // The place on the arc and the place on the side in one direction from the sample.
        let at = |k: f64| {
            let ray = DVec2::from_angle(first + angle * (k / count));
            let reach = from.perp_dot(across) / ray.perp_dot(across);
            let inner = ray * self.radius;
            // The outer ends are those of the side itself, so that strips side by side share them.
            let outer = match k {
                0.0 => from,
                _ if k >= count => to,
                _ => ray * reach,
            };
            [strip.center + inner, strip.center + outer]
        };

        let mut before = at(0.0);
        for k in 1..=count as u32 {
            let [[a, b], [d, c]] = [before, at(f64::from(k))];
            self.fill.extend([[a, b, c], [a, c, d]]);
            before = [d, c];
        }
    }

    /// Returns the gap in the units of the user, one of which is `scale` units of the domain.
    fn in_user_units(mut self, scale: f64) -> Self {
        let user = |place: &mut DVec2| *place /= scale;
        self.area /= scale * scale;
        self.radius /= scale;
        self.period = self.period.map(|period| period / scale);
        user(&mut self.deepest.0);
        self.deepest.1 /= scale;
        self.fill.iter_mut().flatten().for_each(user);

        for strip in &mut self.strips {
            let places = [&mut strip.center, &mut strip.from, &mut strip.to];
            places.into_iter().for_each(user);
        }

        for edge in self.boundary.iter_mut().flatten() {
            match edge {
                Edge::Arc { center, .. } => user(center),
                Edge::Line { from, to } => [from, to].into_iter().for_each(user),
            }
        }
        self
    }
}
