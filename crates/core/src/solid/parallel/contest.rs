//! Which of the darts that no earlier throw's sample covers become samples.
//!
//! Taken one after another in the order of their arrival, a dart becomes a sample unless an earlier sample of the throw covers it.
//! Here any dart may be asked first: it looks for the earlier darts near it, and asks those. Each question is about an
//! earlier dart, so that it ends. Chains of questions are short, since ranks are random: a chain of length k has one order
//! of k! that count, and a dart has few others near it.

use std::ops::RangeInclusive;

use glam::IVec3;
use rayon::prelude::*;

use super::parcel::CellParcel;
use super::parcels::{Beside, CELLS, ParcelGrid, cell_number};
use crate::fate::Fate;
use crate::lattice::R;
use crate::solid::Place;
use crate::solid::frame::covers_offset;

/// A sample of the last throw.
#[derive(Clone, Copy)]
pub(super) struct NewBall {
    rank: u32,
    pub place: Place,
}

impl NewBall {
    /// Returns the order of arrival within a throw, as that of [`crate::solid::darts::SolidDart`].
    pub const fn arrival(&self) -> (u32, [i32; 3]) {
        let [x, y, z] = self.place;
        (self.rank, [z, y, x])
    }
}

/// A dart that no sample of an earlier throw covers.
pub(super) struct Contender {
    pub ball: NewBall,
    fate: Fate,
}

impl Contender {
    pub const fn new(rank: u32, place: Place) -> Self {
        Self {
            ball: NewBall { rank, place },
            fate: Fate::undecided(),
        }
    }
}

/// All contenders of a throw.
pub(super) struct Contest<'a> {
    pub parcels: &'a [CellParcel],
    pub grid: &'a ParcelGrid,
}

impl Contest<'_> {
    /// Returns the contenders that become samples, by parcels.
    pub fn decided(&self) -> Vec<Vec<NewBall>> {
        let of_parcel = |parcel: usize| {
            let contenders = (0..).zip(&self.parcels[parcel].contenders);
            contenders
                .filter(|&(number, _)| self.is_kept(parcel, number))
                .map(|(_, contender)| contender.ball)
                .collect()
        };
        (0..self.parcels.len())
            .into_par_iter()
            .map(of_parcel)
            .collect()
    }

    /// Returns whether a contender becomes a sample.
    fn is_kept(&self, parcel: usize, number: usize) -> bool {
        let contender = &self.parcels[parcel].contenders[number];
        contender.fate.is_kept(|| !self.is_covered(parcel, number))
    }

    /// Returns whether an earlier contender that becomes a sample covers one.
    fn is_covered(&self, parcel: usize, number: usize) -> bool {
        let asked = Asked {
            parcel,
            number,
            ball: self.parcels[parcel].contenders[number].ball,
        };
        let [along_x, along_y, along_z] = self.grid.beside(parcel);

        // Of the parcels around its own most are too far from the place on some axis.
        for z in along_z {
            let Some(planes) = asked.cells_near(z, 2) else {
                continue;
            };
            for y in along_y {
                let Some(rows) = asked.cells_near(y, 1) else {
                    continue;
                };
                for x in along_x {
                    let Some(columns) = asked.cells_near(x, 0) else {
                        continue;
                    };
                    let other = self.grid.number([x.number, y.number, z.number]);
                    let shift = [x.shift, y.shift, z.shift];
                    if self.any_covers(&asked, other, shift, [&columns, &rows, &planes]) {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// Returns whether an earlier contender in some cells of a parcel becomes a sample and covers the one asked about. `shift`
    /// leads from the parcel's places to those near it.
    fn any_covers(
        &self,
        asked: &Asked,
        parcel: usize,
        shift: Place,
        [columns, rows, planes]: [&RangeInclusive<usize>; 3],
    ) -> bool {
        let CellParcel {
            contenders, starts, ..
        } = &self.parcels[parcel];
        // A parcel without contenders does not keep where those of each cell begin.
        if contenders.is_empty() {
            return false;
        }
        // Sides are nearly as long as 32 bits allow, so that sums may wrap; the offsets of places that are compared are short.
        let place = IVec3::from(asked.ball.place).wrapping_sub(shift.into());

        for z in planes.clone() {
            for y in rows.clone() {
                // The contenders of a row of cells follow each other.
                let row = cell_number([0, y, z]);
                let first = starts[row + columns.start()] as usize;
                let end = starts[row + columns.end() + 1] as usize;
                for (number, other) in contenders.iter().enumerate().take(end).skip(first) {
                    // Half of all others come later, which is found before any distance.
                    if other.ball.rank > asked.ball.rank {
                        continue;
                    }
                    let offset = IVec3::from(other.ball.place).wrapping_sub(place);
                    // Two darts of a cube may have one place and one rank: the first one counts as earlier, so that they do
                    // not both stay.
                    let is_earlier = || {
                        (other.ball.arrival(), parcel, number)
                            < (asked.ball.arrival(), asked.parcel, asked.number)
                    };
                    if covers_offset(offset.into()) && is_earlier() && self.is_kept(parcel, number)
                    {
                        return true;
                    }
                }
            }
        }
        false
    }
}

/// A contender about which is asked.
struct Asked {
    parcel: usize,
    /// Its number in its parcel.
    number: usize,
    ball: NewBall,
}

impl Asked {
    /// Returns the numbers along an axis of the cells of a parcel that come within R of the place.
    #[inline]
    fn cells_near(&self, beside: &Beside, axis: usize) -> Option<RangeInclusive<usize>> {
        let at = beside.offset(self.ball.place[axis]);
        let first = ((at - R) >> R.ilog2()).max(0);
        let last = ((at + R) >> R.ilog2()).min(CELLS - 1);
        (first <= last).then_some(first as usize..=last as usize)
    }
}
