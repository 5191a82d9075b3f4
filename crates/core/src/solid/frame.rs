//! The cells of side R over a box and one layer around it. Whatever lies within R beyond a periodic side is an image of
//! a place inside and is held a second time, so that a search never wraps around, whatever the sides are.
//!
//! A search is about a cube in a cell. The cells that may matter to it are listed for the smallest *block* that holds
//! the cube: the whole cell, or one of its octants.

use crate::lattice::{Boundary, R, R_SQUARED};

use super::Place;
use super::domain::SolidDomain;

/// How often the side of a cell is halved at most for a block: blocks have sides of R or R / 2. Blocks of R / 4 were
/// not faster, and blocks of R / 8 were slower.
const MAX_HALVINGS: u32 = 1;

/// A cell as seen from one of its neighbours, or from itself.
#[derive(Clone, Copy)]
struct Neighbour {
    /// Where it lies on each axis: 0 below, 1 beside, 2 above.
    at: [usize; 3],
    /// How far its index is from the other's.
    step: isize,
    /// How far its lowest place is from the other's.
    offset: Place,
}

/// Cells of side R, numbered along x, then y, then z.
pub(super) struct BallFrame {
    /// The highest place of the domain.
    last: Place,
    /// The sides of a periodic domain.
    periods: Option<Place>,
    /// Cells along each axis.
    counts: [usize; 3],
    /// The cells around a cell, and the cell itself.
    around: [Neighbour; 27],
    /// For each block of a cell, where in `around` the cells are that come within R of the block, nearest first: near
    /// ones are more likely to answer.
    orders: Vec<Vec<u8>>,
}

impl BallFrame {
    /// Returns the cells over a box.
    pub fn new(domain: &SolidDomain) -> Self {
        let last = domain.last();
        // From the cell below the origin to the one that holds places R beyond the last one.
        let counts = last.map(|last| ((last + R) >> R.ilog2()) as usize + 2);

        let row = counts[0] as isize;
        let plane = row * counts[1] as isize;
        let around = std::array::from_fn(|number| {
            let at = [number % 3, number / 3 % 3, number / 9];
            let [x, y, z] = at.map(|side| side as isize - 1);
            Neighbour {
                at,
                step: x + y * row + z * plane,
                offset: at.map(|side| (side as i32 - 1) * R),
            }
        });

        Self {
            last,
            periods: (domain.boundary() == Boundary::Periodic).then(|| domain.sides()),
            counts,
            orders: orders(&around),
            around,
        }
    }

    /// Returns the highest place of the domain.
    pub const fn last(&self) -> Place {
        self.last
    }

    /// Returns how many cells there are.
    pub fn count(&self) -> usize {
        self.counts.iter().product()
    }

    /// Returns the lowest places of the cells that tile the domain, plane by plane and row by row.
    pub fn cells(&self) -> Vec<Place> {
        let [columns, rows, planes] = self.last.map(|last| last / R + 1);
        let mut cells = Vec::with_capacity((columns * rows * planes) as usize);
        for z in 0..planes {
            for y in 0..rows {
                cells.extend((0..columns).map(|x| [x * R, y * R, z * R]));
            }
        }
        cells
    }

    /// Returns the index of the cell that holds a place, which lies at most R outside of the domain.
    #[inline]
    pub const fn index(&self, [x, y, z]: Place) -> usize {
        let [columns, rows, _] = self.counts;
        let [x, y, z] = [
            ((x >> R.ilog2()) + 1) as usize,
            ((y >> R.ilog2()) + 1) as usize,
            ((z >> R.ilog2()) + 1) as usize,
        ];
        (z * rows + y) * columns + x
    }

    /// Calls `visit` with a place of the domain and with its images that lie at most R outside of it.
    #[inline]
    pub fn each_image(&self, place: Place, mut visit: impl FnMut(Place)) {
        let axis_images = |axis: usize| {
            let value = place[axis];
            let image = self.periods.and_then(|periods| {
                let side = periods[axis];
                // A side has at least 4 R, so that a place is not near both of its ends.
                let below = (value >= side - R).then(|| value - side);
                below.or_else(|| (value < R).then(|| value + side))
            });
            [Some(value), image].into_iter().flatten()
        };

        for z in axis_images(2) {
            for y in axis_images(1) {
                for x in axis_images(0) {
                    visit([x, y, z]);
                }
            }
        }
    }

    /// Calls `visit` with the cells that reach within R of a cube, those nearest to its block first, until it returns
    /// `true`; returns whether it did. Each cell comes with the offset of its lowest place from `min`, the cube's lowest
    /// one. The cube lies in one cell, and its side is a power of two.
    ///
    /// `depth` is how far into the cube a ball must reach, counted from the side at which it enters, to be of use to
    /// the caller: one that covers an octant reaches through half of the cube. Cells from which no ball reaches so deep
    /// are left out, too.
    #[inline]
    pub fn any_cell_near(
        &self,
        min: Place,
        side: i32,
        depth: i32,
        mut visit: impl FnMut(usize, Place) -> bool,
    ) -> bool {
        let inside = min.map(|value| value & (R - 1));
        let x_gaps = squared_gaps(inside[0], side, depth);
        let y_gaps = squared_gaps(inside[1], side, depth);
        let z_gaps = squared_gaps(inside[2], side, depth);
        let home = self.index(min) as isize;

        for &number in &self.orders[block(inside, side)] {
            let Neighbour { at, step, offset } = self.around[usize::from(number)];
            // The list has every cell within R of the block, which may be larger than the cube: a cell of it may be too
            // far from the cube, or too far to reach `depth` into it. `at` is below 3: the mask spares the check of an
            // index.
            let gap = x_gaps[at[0] & 3] + y_gaps[at[1] & 3] + z_gaps[at[2] & 3];
            if gap > R_SQUARED as u64 {
                continue;
            }
            let [x, y, z] = offset;
            let offset = [x - inside[0], y - inside[1], z - inside[2]];
            if visit((home + step) as usize, offset) {
                return true;
            }
        }
        false
    }
}

/// Returns, on an axis, the least squared distance that a sample must reach to get `depth` deep into a cube: for a
/// sample in the cell below the cube's own, in that cell itself, and in the cell above. A sample in the cube's own cell
/// may lie within the cube. It gets to both ends of a part that is `depth` long if it reaches half of `depth` from the
/// middle of the part. The fourth number is never read: with it a masked index, which is below 4, needs no check.
#[inline]
fn squared_gaps(at: i32, side: i32, depth: i32) -> [u64; 4] {
    let squared = |gap: i32| u64::from(gap.unsigned_abs()).pow(2);
    let (below, above) = (at + 1 + depth, R - at - (side - 1) + depth);
    [squared(below), squared(depth / 2), squared(above), 0]
}

/// Returns the number of the block that holds a cube, which begins at a place of its cell.
#[inline]
fn block(inside: Place, side: i32) -> usize {
    let bits = (R.ilog2() - side.ilog2()).min(MAX_HALVINGS);
    let [x, y, z] = inside.map(|at| (at >> (R.ilog2() - bits)) as usize);
    FIRST_BLOCK[bits as usize] + (z << (2 * bits) | y << bits | x)
}

/// The number of the first block of each size.
const FIRST_BLOCK: [usize; 2] = [0, 1];

/// Returns for each block the cells that come within R of it, nearest first.
fn orders(around: &[Neighbour; 27]) -> Vec<Vec<u8>> {
    let mut orders = Vec::new();
    // Blocks of all sizes, from the whole cell down, are listed one after the other.
    for bits in 0..=MAX_HALVINGS {
        let side = R >> bits;
        for number in 0..1 << (3 * bits) {
            // The number of a block has `bits` bits for each axis; this is where the block begins in its cell.
            let mask = (1 << bits) - 1;
            let inside =
                [number, number >> bits, number >> (2 * bits)].map(|at| (at & mask) * side);

            // The square of the shortest distance between places of the block and of a cell. On an axis the cell lies
            // below the block's own cell, beside it, or above it. Counted from the lowest place of the block's own
            // cell, the highest place of the cell below is -1, and the lowest place of the cell above is R.
            let gap = |cell: &u8| {
                let at = around[usize::from(*cell)].at;
                let squared = |axis: usize| {
                    let gaps = [inside[axis] + 1, 0, R - inside[axis] - (side - 1)];
                    i64::from(gaps[at[axis]]).pow(2)
                };
                squared(0) + squared(1) + squared(2)
            };

            // Samples farther than R from the block cover no place in it.
            let mut order: Vec<u8> = (0..27).filter(|cell| gap(cell) <= R_SQUARED).collect();
            order.sort_by_key(gap);
            orders.push(order);
        }
    }
    orders
}

/// Returns whether an offset is within the radius: whether a sample covers a place, and whether two samples are in
/// conflict. The first test keeps the sum of squares at most 3 * 2^30, exact in 32 bits without a sign on every device.
#[inline]
pub(super) const fn covers_offset([x, y, z]: Place) -> bool {
    let (x, y, z) = (x.unsigned_abs(), y.unsigned_abs(), z.unsigned_abs());
    let reach = R as u32;
    x <= reach && y <= reach && z <= reach && x * x + y * y + z * z <= R_SQUARED as u32
}
