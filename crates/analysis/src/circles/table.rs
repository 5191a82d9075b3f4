//! Which directions around a sample the disk of another one covers, looked up by their offset. The circle is cut into
//! 128 bins, offsets into squares of a 128th of the radius; a mask has the bins that the disk covers wholly *for every
//! offset of its square*, so a union of masks that is full proves the circle covered. It cannot prove a circle
//! uncovered.

use std::f64::consts::TAU;
use std::sync::OnceLock;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, i32x8};
use glam::DVec2;

/// Bins of the circle, one a bit.
const BINS: usize = 128;
/// Squares along the two radii to one side of a sample.
pub(super) const SQUARES: usize = 256;
/// Squares in a radius.
pub(super) const PER_RADIUS: f64 = SQUARES as f64 / 2.0;
/// The largest squared distance, in squares, for which the table is used: a little less than two radii.
pub(super) const WIDEST: f32 = (SQUARES * SQUARES) as f32 * (1.0 - 1.0 / 1024.0);
/// Offsets are known up to this part of a square: more than the rounding of two positions in a tile.
pub(super) const UNCERTAIN: f64 = 1.0 / 64.0;

/// Bins of the circle of a sample that are covered.
pub(super) type Mask = u128;

/// The mask of a circle that is covered wholly.
pub(super) const FULL: Mask = Mask::MAX;

/// The same bins seen from the other one of two samples: opposite directions.
pub(super) const fn opposite(mask: Mask) -> Mask {
    mask.rotate_left(BINS as u32 / 2)
}

/// Returns the stretches of open bins, each as the directions at its beginning and its end. For a stretch of half a turn or more
/// both are NaN, so that no arc covers them.
pub(super) fn open_stretches(mask: Mask) -> impl Iterator<Item = [DVec2; 2]> {
    let directions = first_directions();
    // Bins are turned by `first_covered` so that a covered one comes first and no stretch is cut. If none is covered,
    // all are one stretch.
    let first_covered = if mask == 0 { 0 } else { mask.trailing_zeros() };
    let mut open = (!mask).rotate_right(first_covered);
    let mut at = first_covered;

    std::iter::from_fn(move || {
        let skipped = open.trailing_zeros();
        if skipped == BINS as u32 {
            return None;
        }

        let start = at + skipped;
        let length = (open >> skipped).trailing_ones();
        let end = start + length;
        let rest = skipped + length;

        // A shift by all bins, which has no result, leaves none.
        open = open.checked_shr(rest).unwrap_or(0);
        at = end;

        // The two directions of a longer stretch could also be taken for the ends of the rest of the circle.
        let is_short = length < BINS as u32 / 2;
        Some([start, end].map(|bin| {
            if is_short {
                directions[bin as usize % BINS]
            } else {
                DVec2::NAN
            }
        }))
    })
}

/// The first direction of each bin.
fn first_directions() -> &'static [DVec2; BINS] {
    static DIRECTIONS: OnceLock<[DVec2; BINS]> = OnceLock::new();
    DIRECTIONS.get_or_init(|| {
        std::array::from_fn(|bin| DVec2::from_angle(bin as f64 / BINS as f64 * TAU))
    })
}

/// Bins side by side: the first one in the lower byte, the one after the last in the higher one, both counted on past a whole
/// turn. A table of masks would be eight times as large, and most lookups would miss the caches near the processor.
type Stretch = u16;

/// Most bins of a stretch; only the disk of a sample at the same place covers one more.
const MAX_STRETCH: i32 = 63;

/// A quarter turn of both ends of a stretch. An end beyond the second turn is again in the first.
const QUARTER: Stretch = (BINS / 4) as Stretch * 0x101;

/// The bins before each one, counted on to two turns: in the second turn, all but those before it.
const BEFORE: [Mask; 2 * BINS] = {
    let mut before = [0; 2 * BINS];
    let mut bin = 0;
    while bin < BINS {
        before[bin] = (1 << bin) - 1;
        before[bin + BINS] = !before[bin];
        bin += 1;
    }
    before
};

/// The mask of a stretch, whose ends may lie in either turn.
const fn mask_of(stretch: Stretch) -> Mask {
    BEFORE[(stretch & 0xff) as usize] ^ BEFORE[(stretch >> 8) as usize]
}

/// The stretches of the squares in the first quarter; those of the other squares are turned.
pub(super) struct Table(Box<[Stretch; SQUARES * SQUARES]>);

/// A square around a sample: the index of the square in the first quarter that it is a turn of, and from bit [`TURN_SHIFT`]
/// on the number of quarter turns.
pub(super) type Square = i32;

/// The number of bits of the index of a square in the first quarter.
const TURN_SHIFT: u32 = (SQUARES * SQUARES).trailing_zeros();

impl Table {
    pub fn get() -> &'static Self {
        static TABLE: OnceLock<Table> = OnceLock::new();
        TABLE.get_or_init(Self::new)
    }

    /// Returns the table, computed anew.
    fn new() -> Self {
        // There is one corner more than squares along each axis.
        let side = SQUARES + 1;
        let arcs: Vec<Option<Arc>> = (0..side * side)
            .map(|index| Arc::at([index % side, index / side]))
            .collect();

        let mut stretches = vec![0; SQUARES * SQUARES];
        for y in 0..SQUARES {
            for x in 0..SQUARES {
                // A disk that covers a direction from all corners covers it from every offset of the square (see
                // `common`).
                let corners = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
                let (first, count) = common(corners.map(|(x, y)| arcs[y * side + x]));
                // The first bin is in the lower byte, and the bin after the last one in the higher byte (see
                // `Stretch`).
                let begin = first.rem_euclid(BINS as i32);
                stretches[y * SQUARES + x] = (begin | (begin + count) << 8) as Stretch;
            }
        }

        let stretches = stretches.into_boxed_slice();
        Self(stretches.try_into().expect("a stretch for each square"))
    }

    /// The mask of a square.
    #[inline]
    pub fn mask(&self, square: Square) -> Mask {
        // With the remainder the compiler sees that the index is in range, and leaves out the check.
        let stretch = self.0[square as usize % (SQUARES * SQUARES)];
        let turns = (square >> TURN_SHIFT) as Stretch;
        mask_of(stretch.wrapping_add(turns.wrapping_mul(QUARTER)))
    }
}

/// The squares that hold offsets, which are in units of a square's side.
#[expect(
    clippy::inline_always,
    reason = "it must become a part of what dispatch! compiles for the processor"
)]
#[inline(always)]
pub(super) fn squares_of<S: Simd>(simd: S, dx: f32x8<S>, dy: f32x8<S>) -> i32x8<S> {
    let (left, below) = (dx.simd_lt(0.0), dy.simd_lt(0.0));
    // An odd number of quarter turns exchanges the axes.
    let is_odd = left ^ below;
    let (dx, dy) = (dx.abs(), dy.abs());
    let columns = i32x8::truncate_from(is_odd.select(dy, dx));
    let lines = i32x8::truncate_from(is_odd.select(dx, dy));
    let number = |value: i32| i32x8::splat(simd, value);
    let one = is_odd.select(number(1 << TURN_SHIFT), number(0));
    let two = below.select(number(2 << TURN_SHIFT), number(0));
    lines * number(SQUARES as i32) + columns + one + two
}

/// The square that holds one offset, like [`squares_of`].
fn square_of(dx: f32, dy: f32) -> Square {
    let (left, below) = (dx < 0.0, dy < 0.0);
    let (column, line) = if left == below { (dx, dy) } else { (dy, dx) };
    let turns = i32::from(left != below) + 2 * i32::from(below);
    line.abs() as i32 * SQUARES as i32 + column.abs() as i32 + (turns << TURN_SHIFT)
}

/// A quick test of one circle: whether the disks of other samples certainly cover it.
pub(crate) struct CircleTest {
    table: &'static Table,
    /// How many sides of squares a unit of length has.
    squares_per_unit: f64,
    /// The bins that are certainly covered.
    covered: Mask,
}

impl CircleTest {
    /// Begins with a circle, of the radius of all disks, that none covers.
    pub fn new(radius: f64) -> Self {
        Self {
            table: Table::get(),
            squares_per_unit: PER_RADIUS / radius,
            covered: 0,
        }
    }

    /// Adds the disk of a sample at an offset. One at the same place covers nothing.
    #[inline]
    pub fn add(&mut self, offset: [f64; 2]) {
        let [dx, dy] = offset.map(|value| (value * self.squares_per_unit) as f32);
        // Farther disks hardly meet the circle, and the table does not hold them.
        if dx * dx + dy * dy < WIDEST {
            self.covered |= self.table.mask(square_of(dx, dy));
        }
    }

    /// Whether the circle is certainly covered.
    pub const fn is_covered(&self) -> bool {
        self.covered == FULL
    }
}

/// Directions covered by the disk at an offset: from `start` to `end`, in turns counted anticlockwise.
#[derive(Clone, Copy)]
struct Arc {
    start: f64,
    end: f64,
}

impl Arc {
    /// The directions that the disk covers at a corner of squares of the first quarter, and at all offsets that differ
    /// from it by no more than the uncertainty; none where the disks may not overlap, or may be the same.
    fn at([x, y]: [usize; 2]) -> Option<Self> {
        let [x, y] = [x, y].map(|value| value as f64 / PER_RADIUS);
        // Twice, as an offset is uncertain along both axes.
        let uncertain = 2.0 * UNCERTAIN / PER_RADIUS;
        // Half of the largest distance that the offset may have: the arc of the farthest disk is the shortest.
        let half_distance = x.hypot(y).midpoint(uncertain);
        if half_distance <= 2.0 * uncertain || half_distance >= 1.0 {
            return None;
        }
        // The direction of an offset is off by no more than the angle at which the uncertainty is seen. Above twice the
        // uncertainty `half_distance` is less than the least distance that the offset may have, so that the quotient is
        // more than that angle.
        let (direction, half) = (y.atan2(x), half_distance.acos() - uncertain / half_distance);
        (half > 0.0).then(|| Self {
            start: (direction - half) / TAU,
            end: (direction + half) / TAU,
        })
    }
}

/// The first one and the number of the bins within all four arcs.
///
/// A disk at the offset `d` covers the direction `u` when `d` is in the open unit disk about `u`. That disk is convex: it holds
/// a square when it holds its corners.
fn common(arcs: [Option<Arc>; 4]) -> (i32, i32) {
    let (mut start, mut end) = (f64::NEG_INFINITY, f64::INFINITY);
    for arc in arcs {
        let Some(arc) = arc else { return (0, 0) };
        start = start.max(arc.start);
        end = end.min(arc.end);
    }
    // Starts are above -1/4 and ends below 1/2, so no arc meets itself.
    let (first, end) = (
        (start * BINS as f64).ceil() as i32,
        (end * BINS as f64).floor() as i32,
    );
    (first, (end - first).clamp(0, MAX_STRETCH))
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    /// The square of the offsets from a corner on.
    fn square(corner: [i32; 2]) -> Square {
        let middle = corner.map(|at| at as f32 + 0.5);
        let squares: [Square; 8] = dispatch!(Level::new(), simd => {
            let [dx, dy] = middle.map(|at| f32x8::splat(simd, at));
            squares_of(simd, dx, dy).into()
        });
        squares[0]
    }

    /// By the definition: each bin of a mask is covered, at both ends and in the middle, for offsets all over the square.
    #[test]
    fn masks_cover_what_they_claim_and_little_less() {
        const E: f64 = UNCERTAIN;
        let table = Table::get();
        let (mut claimed, mut covered) = (0, 0);
        for index in (0..4 * SQUARES * SQUARES).step_by(37) {
            let corner =
                [index % (2 * SQUARES), index / (2 * SQUARES)].map(|at| at as i32 - SQUARES as i32);
            let mask = table.mask(square(corner));
            let corner = corner.map(f64::from);
            for bin in 0..BINS {
                let mut all = true;
                for step in 0..=2 {
                    let angle = (bin as f64 + f64::from(step) / 2.0) / BINS as f64 * TAU;
                    let (sin, cos) = angle.sin_cos();
                    for at in [
                        [-E, -E],
                        [1.0 + E, -E],
                        [-E, 1.0 + E],
                        [1.0 + E, 1.0 + E],
                        [0.5, 0.5],
                    ] {
                        let x = (corner[0] + at[0]) / PER_RADIUS;
                        let y = (corner[1] + at[1]) / PER_RADIUS;
                        all &= x * cos + y * sin > 0.5 * (x * x + y * y);
                    }
                }
                let claims = mask >> bin & 1 == 1;
                assert!(all || !claims, "bin {bin} at {corner:?}");
                claimed += u32::from(claims);
                covered += u32::from(all);
            }
        }
        // Only bins that an arc leaves by less than the uncertainty are given up.
        assert!(
            claimed > 0 && f64::from(claimed) > 0.98 * f64::from(covered),
            "{claimed} of {covered}"
        );
    }

    #[test]
    fn one_offset_has_the_square_of_eight() {
        for index in (0..4 * SQUARES * SQUARES).step_by(101) {
            let corner =
                [index % (2 * SQUARES), index / (2 * SQUARES)].map(|at| at as i32 - SQUARES as i32);
            let [dx, dy] = corner.map(|at| at as f32 + 0.5);
            assert_eq!(square_of(dx, dy), square(corner), "{corner:?}");
        }
    }

    #[test]
    fn a_circle_is_covered_by_a_tight_ring_and_not_without_one_of_it() {
        let ring = |count: usize, left_out: usize| {
            let mut test = CircleTest::new(100.0);
            for index in (0..count).filter(|index| *index != left_out) {
                let direction = DVec2::from_angle(index as f64 / count as f64 * TAU);
                test.add((direction * 120.0).to_array());
            }
            test.is_covered()
        };
        assert!(ring(6, 6));
        assert!((0..6).all(|left_out| !ring(6, left_out)));
        assert!(!CircleTest::new(1.0).is_covered());
    }

    #[test]
    fn an_opposite_offset_covers_opposite_directions() {
        let table = Table::get();
        let mask = table.mask(square([40, 20]));
        assert_ne!(mask, 0);
        assert_eq!(table.mask(square([-41, -21])), opposite(mask));
    }

    #[test]
    fn open_stretches_are_those_without_a_bit() {
        let stretches = |mask: Mask| open_stretches(mask).collect::<Vec<_>>();
        let direction = |bin: usize| first_directions()[bin];
        assert!(stretches(FULL).is_empty());
        assert_eq!(stretches(FULL ^ 1 << 5), [[direction(5), direction(6)]]);
        // Across the first bin, and two more.
        let open = [127, 0, 1, 40, 90, 91];
        let mask = open.iter().fold(FULL, |mask, bin| mask ^ 1 << bin);
        let expected = [[40, 41], [90, 92], [127, 2]].map(|ends| ends.map(direction));
        let mut found = stretches(mask);
        found.sort_by_key(|[first, _]| first_directions().iter().position(|at| at == first));
        assert_eq!(found, expected);
        let whole = stretches(0);
        assert!(whole.len() == 1 && whole[0].iter().all(|end| end.is_nan()));
    }
}
