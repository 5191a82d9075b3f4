//! The samples so far, in cells of side R, and what they cover.

use crate::lattice::{R, R_SQUARED};

use super::Place;
use super::domain::SolidDomain;
use super::frame::{BallFrame, covers_offset};

/// Samples in one cell: eight points of a unit cube are at most 1 apart (Schaer 1966), so that a half-open cell of side
/// R holds at most seven samples of a conflict-free set. With one more slot it is a cache line.
const SLOTS: usize = 8;

/// A slot without a sample: coordinates have 15 bits each.
const EMPTY: u64 = u64::MAX;

#[derive(Clone, Copy)]
#[repr(align(64))]
struct Slots([u64; SLOTS]);

/// A conflict-free set of balls of radius R that grows.
pub(super) struct BallGrid {
    frame: BallFrame,
    cells: Vec<Slots>,
}

impl BallGrid {
    pub fn new(domain: &SolidDomain) -> Self {
        let frame = BallFrame::new(domain);
        Self {
            cells: vec![Slots([EMPTY; SLOTS]); frame.count()],
            frame,
        }
    }

    pub const fn frame(&self) -> &BallFrame {
        &self.frame
    }

    /// Adds a sample that no other covers.
    pub fn insert(&mut self, place: Place) {
        let Self { frame, cells } = self;
        frame.each_image(place, |image| {
            let slots = &mut cells[frame.index(image)].0;
            let [x, y, z] = image.map(|value| (value & (R - 1)) as u64);

            let free = slots.iter().position(|&slot| slot == EMPTY);
            debug_assert!(free.is_some(), "the set is conflict-free");
            if let Some(free) = free {
                slots[free] = x | y << 15 | z << 30;
            }
        });
    }

    /// Returns whether any sample covers a place of the domain.
    #[inline]
    pub fn covers(&self, place: Place) -> bool {
        // A place is a cube of one unit, and a sample that just reaches it covers it.
        let (side, depth) = (1, 0);
        self.any_near(place, side, depth, covers_offset)
    }

    /// Calls `visit` with the offset from `min` of samples whose balls reach at least `depth` units into a cube, and of
    /// some others, until it returns `true`; returns whether it did. `min` is the lowest place of the cube, which lies
    /// in one cell and is `side` units wide. Cells from which no ball reaches so deep are left out.
    #[inline]
    fn any_near(
        &self,
        min: Place,
        side: i32,
        depth: i32,
        mut visit: impl FnMut(Place) -> bool,
    ) -> bool {
        let frame = &self.frame;
        // `x`, `y` and `z` lead from `min` to the lowest place of the cell.
        frame.any_cell_near(min, side, depth, |cell, [x, y, z]| {
            let slots = self.cells[cell].0.iter();
            let mut held = slots.take_while(|&&slot| slot != EMPTY);
            held.any(|slot| {
                // A slot has 15 bits for each coordinate within the cell.
                let at = |shift: u32| (slot >> shift) as i32 & (R - 1);
                visit([x + at(0), y + at(15), z + at(30)])
            })
        })
    }

    /// Appends to `out` the octants of a cube that hold places of the domain and are not covered by a single sample.
    pub fn open_octants(&self, min: Place, side: i32, out: &mut Vec<Place>) {
        let half = side / 2;
        // On each axis the highest places of the two halves, from the cube's lowest. The upper half may lie beyond the
        // domain's side, where there is nothing to cover, and both may be cut by it.
        let ends = [0, 1, 2].map(|axis| {
            let last = self.frame.last()[axis] - min[axis];
            [last.min(half - 1), last.min(side - 1)]
        });
        let beyond = [0, 1, 2].map(|axis| if ends[axis][1] < half { UPPER[axis] } else { 0 });
        // Octants without a place of the domain count as covered.
        let mut covered: u8 = beyond[0] | beyond[1] | beyond[2];

        // The first and the last place of an octant are `half - 1` units apart on an axis. A ball that covers the
        // octant reaches at least as deep into the cube. An octant that the domain's side cuts is thinner: no depth is
        // asked for.
        let is_whole = ends.iter().all(|end| end[1] == side - 1);
        let depth = if is_whole { half - 1 } else { 0 };
        self.any_near(min, side, depth, |sample| {
            // Written out, since `map` is a call here, which took a quarter of the time.
            let x = farthest(sample[0], half, ends[0]);
            let y = farthest(sample[1], half, ends[1]);
            let z = farthest(sample[2], half, ends[2]);
            let limit = R_SQUARED as u64;
            // Most samples cover no octant: that is certain if they do not cover the nearest one.
            if x[0].min(x[1]) + y[0].min(y[1]) + z[0].min(z[1]) > limit {
                return false;
            }

            for octant in 0..8 {
                let [i, j, k] = octant_halves(octant);
                if x[i] + y[j] + z[k] <= limit {
                    covered |= 1 << octant;
                }
            }
            covered == u8::MAX
        });

        for octant in 0..8 {
            if covered >> octant & 1 == 0 {
                let upper = octant_halves(octant);
                out.push([0, 1, 2].map(|axis| min[axis] + upper[axis] as i32 * half));
            }
        }
    }
}

/// Returns the squared distances on an axis from a sample to the farthest places of both halves of a cube. The lower
/// half begins at 0, the upper one at `half`, and `ends` are their last places.
#[inline]
fn farthest(at: i32, half: i32, [low, high]: [i32; 2]) -> [u64; 2] {
    // Whichever end is the farther one, the distance to it is not negative.
    let (below, above) = (at.max(low - at), (at - half).max(high - at));
    let squared = |distance: i32| u64::from(distance.unsigned_abs()).pow(2);
    [squared(below), squared(above)]
}

/// The octants in the upper half of each axis, as bits.
pub(super) const UPPER: [u8; 3] = [0b1010_1010, 0b1100_1100, 0b1111_0000];

/// Returns on which half of each axis an octant lies, 0 or 1.
pub(super) const fn octant_halves(octant: usize) -> [usize; 3] {
    [octant & 1, octant >> 1 & 1, octant >> 2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Boundary;
    use crate::random::{Key, Stream, below};

    /// Returns pseudo-random places of a domain.
    fn places(domain: &SolidDomain, count: u32) -> Vec<Place> {
        let key = Key::from_seed(3);
        let place = |index| {
            let [x, y] = key.draw(Stream::Dart, index);
            let [z, _] = key.draw(Stream::Rank, index);
            let sides = domain.sides();
            [(x, sides[0]), (y, sides[1]), (z, sides[2])]
                .map(|(word, side)| below(word, side as u32) as i32)
        };
        (0..count).map(place).collect()
    }

    /// Returns whether a scan of all samples and their images covers a place.
    fn scanned(domain: &SolidDomain, samples: &[Place], place: Place) -> bool {
        samples.iter().any(|sample| {
            let squared = |axis: usize| {
                let plain = i64::from((sample[axis] - place[axis]).abs());
                let around = i64::from(domain.sides()[axis]) - plain;
                let periodic = domain.boundary() == Boundary::Periodic;
                (if periodic { plain.min(around) } else { plain }).pow(2)
            };
            squared(0) + squared(1) + squared(2) <= R_SQUARED
        })
    }

    #[test]
    fn what_is_covered_is_what_a_scan_says() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let size = [4.0, 4.37, 5.91];
            let domain = SolidDomain::from_size(size, 1.0, boundary).unwrap();
            let mut balls = BallGrid::new(&domain);
            let mut samples = Vec::new();
            for place in places(&domain, 4_000) {
                let covered = balls.covers(place);
                assert_eq!(covered, scanned(&domain, &samples, place), "{place:?}");
                if !covered {
                    balls.insert(place);
                    samples.push(place);
                }
            }
            assert!(samples.len() > 50);
        }
    }

    /// Octants of four units and less, place by place. Cubes at the upper sides reach beyond the domain.
    #[test]
    fn open_octants_are_those_that_no_single_sample_covers() {
        let size = [4.000_09, 4.000_06, 4.000_03];
        let domain = SolidDomain::from_size(size, 1.0, Boundary::Bounded).unwrap();
        let last = domain.last();
        let samples: Vec<Place> = [[0, 0, 0], last, [R + 9, R, 3], [3 * R, R - 7, 2 * R]].into();
        let mut balls = BallGrid::new(&domain);
        for &sample in &samples {
            balls.insert(sample);
        }

        let mut seen = [0, 0];
        for base in [
            [R - 8, 0, 0],
            [R, 0, 0],
            [4 * R, 4 * R, 4 * R],
            [4 * R, 3 * R, 4 * R],
        ] {
            for side in [2, 4, 8] {
                let mut open = Vec::new();
                balls.open_octants(base, side, &mut open);
                let half = side / 2;
                for octant in 0..8 {
                    let upper = octant_halves(octant);
                    let min = [0, 1, 2].map(|axis| base[axis] + upper[axis] as i32 * half);
                    let inside = (0..3).all(|axis| min[axis] <= last[axis]);
                    let whole = |sample: &Place| {
                        let far = |axis: usize| {
                            let end = (min[axis] + half - 1).min(last[axis]);
                            let at = sample[axis];
                            i64::from((at - min[axis]).abs().max((at - end).abs())).pow(2)
                        };
                        far(0) + far(1) + far(2) <= R_SQUARED
                    };
                    let expected = inside && !samples.iter().any(whole);
                    assert_eq!(open.contains(&min), expected, "{base:?} {side} {octant}");
                    seen[usize::from(expected)] += 1;
                }
            }
        }
        assert!(seen[0] > 5 && seen[1] > 5, "{seen:?}");
    }
}
