//! Voronoi cells as sides in one list, each with its twin in the cell beyond, and the parts of each side that lie
//! outside the disks. Cells of a bounded domain are clipped to it. Parts are joined across cells in
//! [`super::gap_regions`].

use std::borrow::Cow;
use std::collections::HashMap;

use glam::{DVec2, IVec2};

use super::window::{Corner, Seen, Window, shifted};
use crate::domain::Domain;

/// Corners no further than this beyond the radius, in radii, count as covered: rounding alone makes
/// larger differences than zero where circles of a lattice just touch.
const TOUCH: f64 = 1e-12;

/// In a cell with more sides than this twins are found by a map, not one by one: a sample amid a circle of others may
/// have as many sides as there are samples.
const MANY_SIDES: usize = 64;

/// A directed side of a cell; it ends where the next one of its cell begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// The index of the sample whose cell it bounds.
    pub cell: usize,
    /// The place where it begins.
    pub from: DVec2,
    /// How far that place is from the sample.
    pub reach: f64,
    /// The sample on the other side; none at the border.
    pub beyond: Option<Seen>,
    /// The same side in the cell beyond.
    pub twin: Option<usize>,
    /// How far the part at its start goes that lies outside the disk, as a fraction of the side.
    pub head: Option<f64>,
    /// From where on the part at its end lies outside. A side wholly outside has a head of 1 alone.
    pub tail: Option<f64>,
}

/// The Voronoi cells of a set, with their sides in one list.
pub(super) struct Cells {
    pub domain: Domain,
    /// The radius of the disks, in the domain's unit.
    pub radius: f64,
    pub samples: Vec<DVec2>,
    pub sides: Vec<Side>,
    /// Where the sides of each cell begin.
    starts: Vec<usize>,
}

impl Cells {
    /// Returns the cells of a window's polygons, with what the disks of `radius` leave uncovered of their sides.
    pub fn new(window: &Window, domain: &Domain, radius: f64, same: f64) -> Self {
        let mut cells = Self::alone(window, domain, radius, same);
        // Twins are in other cells, so that they are looked for once all sides are there.
        let of_many = cells.sides_of_many();
        for side in 0..cells.sides.len() {
            cells.sides[side].twin = cells.find_twin(side, &of_many);
            (cells.sides[side].head, cells.sides[side].tail) = cells.outside(side);
        }
        cells
    }

    /// Returns the cells of a window's polygons, each for itself: without twins, and without what disks leave
    /// uncovered. Sides of a length of at most `same` are left out.
    pub fn alone(window: &Window, domain: &Domain, radius: f64, same: f64) -> Self {
        let samples = window.samples.clone();
        // A cell has six sides on average.
        let (mut sides, mut starts) = (Vec::with_capacity(6 * samples.len()), vec![0]);
        for (cell, polygon) in window.polygons.iter().enumerate() {
            let corners = clipped(polygon, domain, samples[cell]);
            // Sides shorter than `same` are rounding: cocircular samples share one corner.
            sides.extend(without_short(&corners, same).map(|corner| Side {
                cell,
                from: corner.at,
                reach: corner.reach,
                beyond: corner.beyond,
                twin: None,
                head: None,
                tail: None,
            }));
            starts.push(sides.len());
        }

        Self {
            domain: *domain,
            radius,
            samples,
            sides,
            starts,
        }
    }

    /// The sides of a cell, in counter-clockwise sequence.
    pub fn of(&self, cell: usize) -> std::ops::Range<usize> {
        self.starts[cell]..self.starts[cell + 1]
    }

    /// The next side of the same cell, counter-clockwise.
    pub fn next(&self, side: usize) -> usize {
        let range = self.of(self.sides[side].cell);
        if side + 1 == range.end {
            range.start
        } else {
            side + 1
        }
    }

    /// The side before, of the same cell.
    pub fn before(&self, side: usize) -> usize {
        let range = self.of(self.sides[side].cell);
        if side == range.start {
            range.end - 1
        } else {
            side - 1
        }
    }

    /// The ends of a side.
    pub fn ends(&self, side: usize) -> [DVec2; 2] {
        [self.sides[side].from, self.sides[self.next(side)].from]
    }

    /// A place of a side, as a fraction.
    pub fn place(&self, side: usize, at: f64) -> DVec2 {
        let [from, to] = self.ends(side);
        if at >= 1.0 {
            to
        } else {
            from.lerp_monotonic(to, at)
        }
    }

    pub fn shifted(&self, place: DVec2, shift: IVec2) -> DVec2 {
        shifted(place, shift, &self.domain)
    }

    /// The sides between two cells, each once.
    pub fn edges(&self) -> impl Iterator<Item = [DVec2; 2]> {
        (0..self.sides.len())
            .filter(
                |&side| match (self.sides[side].twin, self.sides[side].beyond) {
                    (Some(twin), _) => side < twin,
                    // The cell beyond may lack a short side, which then has no twin.
                    (None, beyond) => beyond.is_some(),
                },
            )
            .map(|side| self.ends(side))
    }

    /// The sides of cells that have many, by the cell and the sample beyond.
    fn sides_of_many(&self) -> HashMap<(usize, Seen), usize> {
        let cells = (0..self.samples.len()).filter(|&cell| self.of(cell).len() > MANY_SIDES);
        let mut found = HashMap::new();
        for side in cells.flat_map(|cell| self.of(cell)) {
            if let Side {
                cell,
                beyond: Some(beyond),
                ..
            } = self.sides[side]
            {
                // The first one, as a search one by one would find it.
                found.entry((cell, beyond)).or_insert(side);
            }
        }
        found
    }

    /// Returns the same side as seen from the cell beyond; none at the border of the domain, and where that cell lacks
    /// the side, as it was too short there. `of_many` has the sides of cells with many sides.
    fn find_twin(&self, side: usize, of_many: &HashMap<(usize, Seen), usize>) -> Option<usize> {
        let Side { cell, beyond, .. } = self.sides[side];
        let beyond = beyond?;
        let other = beyond.sample as usize;
        let back = Seen {
            sample: cell as u32,
            shift: -beyond.shift,
        };

        let sides = self.of(other);
        if sides.len() > MANY_SIDES {
            return of_many.get(&(other, back)).copied();
        }

        sides
            .into_iter()
            .find(|&theirs| self.sides[theirs].beyond == Some(back))
    }

    /// Returns the head and the tail of a side: its parts outside the disk of its cell. The distance from the sample is convex
    /// along a side, so that there is one part at each end at most.
    fn outside(&self, index: usize) -> (Option<f64>, Option<f64>) {
        let side = &self.sides[index];
        let beyond_disk = |reach: f64| reach > self.radius * (1.0 + TOUCH);
        let ends_outside = [side.reach, self.sides[self.next(index)].reach].map(beyond_disk);
        // Between two covered ends all is covered, as the distance is convex.
        if ends_outside == [false; 2] {
            return (None, None);
        }

        let sample = self.samples[side.cell];
        let [from, to] = self.ends(index);
        let side_length = from.distance(to);
        let along = (to - from) / side_length;
        let to_sample = sample - from;

        // A side lies half-way to the sample beyond: computed from that, the height has the same bits in both cells.
        let height = match side.beyond {
            Some(Seen {
                sample: other,
                shift,
            }) => 0.5 * sample.distance(self.shifted(self.samples[other as usize], shift)),
            None => along.perp_dot(to_sample).abs(),
        };

        // The circle meets the line of the side at half a chord before and after the foot of the sample.
        let foot = to_sample.dot(along);
        let half_chord = ((self.radius - height) * (self.radius + height))
            .max(0.0)
            .sqrt();
        let (enters, leaves) = (foot - half_chord, foot + half_chord);
        let fraction = |length: f64| (length / side_length).clamp(0.0, 1.0);

        // Both ends may be outside though the circle bulges over the middle.
        let crosses = height < self.radius && enters > 0.0 && leaves < side_length;
        match ends_outside {
            [true, true] if crosses => (Some(fraction(enters)), Some(fraction(leaves))),
            [true, true] => (Some(1.0), None),
            // A head of 1 would say that the whole side is outside.
            [true, false] => (Some(fraction(enters).min(1.0 - f64::EPSILON)), None),
            // The end alone is outside: two covered ends have left above.
            _ => (None, Some(fraction(leaves))),
        }
    }
}

/// The polygon inside a bounded domain; a periodic one has no border.
fn clipped<'a>(polygon: &'a [Corner], domain: &Domain, sample: DVec2) -> Cow<'a, [Corner]> {
    let mut corners = Cow::Borrowed(polygon);
    for &line in domain.border() {
        let inside = |corner: &Corner| line.depth(corner.at, domain.extent) >= 0.0;
        // Most cells do not reach the border.
        if !corners.iter().all(inside) {
            let bound = line.level(domain.extent);
            corners = Cow::Owned(cut(&corners, line.axis, bound, sample, inside));
        }
    }
    corners
}

/// Returns the part of a convex polygon on the inner side of a line of the border, on which the coordinate along `axis` is
/// `bound`.
fn cut(
    corners: &[Corner],
    axis: usize,
    bound: f64,
    sample: DVec2,
    inside: impl Fn(&Corner) -> bool,
) -> Vec<Corner> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (index, a) in corners.iter().enumerate() {
        let b = &corners[(index + 1) % corners.len()];
        let crossing = |beyond| {
            // The crossing is computed from the lower end, so that both cells at a side find the same place.
            let (low, high) = if a.at[axis] < b.at[axis] {
                (a.at, b.at)
            } else {
                (b.at, a.at)
            };
            let part = (bound - low[axis]) / (high[axis] - low[axis]);
            let mut at = low.lerp_monotonic(high, part);
            at[axis] = bound;
            Corner {
                at,
                reach: at.distance(sample),
                beyond,
            }
        };

        match (inside(a), inside(b)) {
            (true, true) => kept.push(*a),
            // The side that begins at the crossing lies on the border.
            (true, false) => kept.extend([*a, crossing(None)]),
            // The rest of the old side begins at the crossing.
            (false, true) => kept.push(crossing(a.beyond)),
            (false, false) => {}
        }
    }
    kept
}

/// Leaves out sides without length: cocircular samples make them, and not the same ones in every cell.
fn without_short(corners: &[Corner], same: f64) -> impl Iterator<Item = &Corner> {
    corners
        .iter()
        .enumerate()
        .filter_map(move |(index, corner)| {
            let next = &corners[(index + 1) % corners.len()];
            (next.at.distance(corner.at) > same).then_some(corner)
        })
}
