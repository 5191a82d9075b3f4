//! The cells of side R over a box and one layer around it. Whatever lies within R beyond a periodic side is an image of a
//! place inside and is held a second time, so that a search never wraps around, whatever the sides are.

use crate::lattice::{Boundary, R, R_SQUARED};

use super::Place;
use super::domain::SolidDomain;

/// A cell as seen from one of its neighbours, or from itself.
#[derive(Clone, Copy)]
struct Neighbour {
    /// Where it lies on each axis: 0 below, 1 beside, 2 above.
    at: [usize; 3],
    /// How far its index is from the other's.
    step: isize,
}

/// Cells of side R, numbered along x, then y, then z.
pub(super) struct BallFrame {
    /// The highest place of the domain.
    last: Place,
    /// The sides of a periodic domain.
    periods: Option<Place>,
    /// Cells along each axis.
    counts: [usize; 3],
    /// Itself, then the cells beyond faces, edges and corners: nearer ones are more likely to answer.
    around: [Neighbour; 27],
}

impl BallFrame {
    pub fn new(domain: &SolidDomain) -> Self {
        let last = domain.last();
        // From the cell below the origin to the one that holds what is R beyond the last place.
        let counts = last.map(|last| ((last + R) >> R.ilog2()) as usize + 2);

        let mut around = [0, 1, 2].map(|z| [0, 1, 2].map(|y| [0, 1, 2].map(|x| [x, y, z])));
        let around: &mut [[usize; 3]] = around.as_flattened_mut().as_flattened_mut();
        around.sort_by_key(|at| at.iter().filter(|&&side| side != 1).count());
        let row = counts[0] as isize;
        let plane = row * counts[1] as isize;
        let neighbour = |k: usize| {
            let at = around[k];
            let [x, y, z] = at.map(|side| side as isize - 1);
            let step = x + y * row + z * plane;
            Neighbour { at, step }
        };

        Self {
            last,
            periods: (domain.boundary() == Boundary::Periodic).then(|| domain.sides()),
            counts,
            around: std::array::from_fn(neighbour),
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

    /// Calls `visit` with the cells that reach within R of a cube, nearest cells first, until it returns `true`; returns
    /// whether it did. Each cell comes with the offset of its lowest place from `min`, the cube's lowest one. The cube lies
    /// in one cell.
    #[inline]
    pub fn any_cell_near(
        &self,
        min: Place,
        side: i32,
        mut visit: impl FnMut(usize, Place) -> bool,
    ) -> bool {
        let inside = min.map(|value| value & (R - 1));
        // Squared distances from the cube to the nearest places of the cells below, beside and above it.
        let gaps = inside.map(|at| [squared(at + 1), 0, squared(R - at - (side - 1))]);
        let home = self.index(min) as isize;

        for Neighbour { at, step } in &self.around {
            let [x, y, z] = *at;
            if gaps[0][x] + gaps[1][y] + gaps[2][z] > R_SQUARED as u32 {
                continue;
            }
            let offset = [x, y, z].map(|side| (side as i32 - 1) * R);
            let offset = [0, 1, 2].map(|axis| offset[axis] - inside[axis]);
            if visit((home + step) as usize, offset) {
                return true;
            }
        }
        false
    }
}

/// Returns the square of a distance of at most R: three of them fit into 32 bits without a sign.
#[inline]
const fn squared(distance: i32) -> u32 {
    distance as u32 * distance as u32
}

/// Returns whether an offset is within the radius: whether a sample covers a place, and whether two samples are in
/// conflict. The first test keeps the sum of squares at most 3 * 2^30, exact in 32 bits without a sign on every device.
#[inline]
pub(super) const fn covers_offset([x, y, z]: Place) -> bool {
    let (x, y, z) = (x.unsigned_abs(), y.unsigned_abs(), z.unsigned_abs());
    let reach = R as u32;
    x <= reach && y <= reach && z <= reach && x * x + y * y + z * z <= R_SQUARED as u32
}
