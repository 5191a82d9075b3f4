//! How parcels tile a box, and which ones are near each other.

use crate::lattice::{Boundary, R};

use super::parcel::CellParcel;
use crate::solid::Place;
use crate::solid::domain::SolidDomain;

/// A parcel is this many cells of side R wide, as a power of two. With fewer, more samples are listed by several parcels, and
/// with more, small boxes have too few parcels for several threads.
const CELL_BITS: u32 = 3;

/// How many cells a parcel has along each axis. Those that hold no place of the domain stay empty.
pub(super) const CELLS: i32 = 1 << CELL_BITS;

/// The binary logarithm of the side of a parcel, in units.
const PARCEL_BITS: u32 = CELL_BITS + R.ilog2();

/// The parcels of a box, numbered along x, then y, then z.
pub(super) struct ParcelGrid {
    /// The highest place of the domain.
    last: Place,
    /// Parcels along each axis.
    counts: [usize; 3],
    /// For each axis and each parcel along it, the parcels along it that come within R of it.
    beside: [Vec<Vec<Beside>>; 3],
}

/// A parcel along an axis as seen from another one.
#[derive(Clone, Copy)]
pub(super) struct Beside {
    pub number: usize,
    /// What leads from its places to those near the other: 0, or a period of the box.
    pub shift: i32,
}

impl Beside {
    /// Returns how far a coordinate near the other parcel is from the lowest place of this one, shifted.
    #[inline]
    pub const fn offset(&self, at: i32) -> i32 {
        // Sides are nearly as long as 32 bits allow, so that steps may wrap; the sum is short.
        let first = (self.number as i32) << PARCEL_BITS;
        at.wrapping_sub(self.shift).wrapping_sub(first)
    }
}

/// Returns the number of the cell of a parcel at its numbers along the axes.
#[inline]
pub(super) const fn cell_number([x, y, z]: [usize; 3]) -> usize {
    (z << CELL_BITS | y) << CELL_BITS | x
}

impl ParcelGrid {
    /// Returns the parcels of a domain.
    pub fn new(domain: &SolidDomain) -> Self {
        let last = domain.last();
        let beside = [0, 1, 2].map(|axis| {
            let period = match domain.boundary() {
                Boundary::Periodic => domain.sides()[axis],
                Boundary::Bounded => 0,
            };
            let numbers = 0..=last[axis] >> PARCEL_BITS;
            numbers
                .map(|number| parcels_beside(number, last[axis], period))
                .collect()
        });
        Self {
            last,
            counts: last.map(|last| (last >> PARCEL_BITS) as usize + 1),
            beside,
        }
    }

    /// Returns how many parcels there are.
    pub fn count(&self) -> usize {
        self.counts.iter().product()
    }

    /// Returns the parcel of a number before the first throw.
    pub fn parcel(&self, number: usize) -> CellParcel {
        let min = self.position(number).map(|at| (at as i32) << PARCEL_BITS);
        // The highest place of the domain that lies in it, from its lowest one.
        let ends = [0, 1, 2].map(|axis| (self.last[axis] - min[axis]).min((1 << PARCEL_BITS) - 1));
        CellParcel::new(min, ends)
    }

    /// Returns the parcels along each axis that come within R of a parcel, itself among them.
    pub fn beside(&self, number: usize) -> [&[Beside]; 3] {
        let position = self.position(number);
        [0, 1, 2].map(|axis| &*self.beside[axis][position[axis]])
    }

    /// Returns the number of the parcel at its numbers along the axes.
    pub fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    /// Returns the parcels that come within R of one, itself among them, each with what leads from its places to those near
    /// that one. In a narrow periodic box a parcel comes near another from several sides.
    pub fn around(&self, number: usize) -> impl Iterator<Item = (usize, Place)> {
        let [along_x, along_y, along_z] = self.beside(number);
        along_z.iter().flat_map(move |z| {
            along_y.iter().flat_map(move |y| {
                along_x.iter().map(move |x| {
                    let number = self.number([x.number, y.number, z.number]);
                    (number, [x.shift, y.shift, z.shift])
                })
            })
        })
    }

    /// Returns the numbers along the axes of a parcel.
    const fn position(&self, number: usize) -> [usize; 3] {
        let [columns, rows, _] = self.counts;
        [
            number % columns,
            number / columns % rows,
            number / columns / rows,
        ]
    }
}

/// Returns the parcels along an axis that come within R of one of them. `last` is the highest place on the axis, and `period` is
/// 0 where the box is bounded.
fn parcels_beside(number: i32, last: i32, period: i32) -> Vec<Beside> {
    // Sides are nearly as long as 32 bits allow, so that sums of them are computed in 64.
    let [last, reach] = [last, R].map(i64::from);
    let first = i64::from(number) << PARCEL_BITS;
    let end = (first + (1 << PARCEL_BITS) - 1).min(last);

    let shifts: &[i32] = if period == 0 {
        &[0]
    } else {
        &[0, period, -period]
    };
    let mut beside = Vec::new();
    for &shift in shifts {
        // The places of the box that are within R of the parcel after the shift.
        let low = (first - reach - i64::from(shift)).max(0);
        let high = (end + reach - i64::from(shift)).min(last);
        if low <= high {
            let numbers = (low >> PARCEL_BITS) as usize..=(high >> PARCEL_BITS) as usize;
            beside.extend(numbers.map(|number| Beside { number, shift }));
        }
    }
    beside
}
