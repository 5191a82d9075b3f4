//! Which families of a parcel list a new sample.

use glam::IVec2;

use super::Parcel;
use crate::varying::crowd::NewSample;
use crate::varying::rule::most_reach;

/// A new sample as a parcel sees it, or an image of it.
#[derive(Clone, Copy)]
struct ListedSample {
    /// From the parcel's lowest place.
    at: IVec2,
    radius: i32,
}

impl Parcel {
    /// Adds new samples, moved by `shift`, to the lists of the active families in which they can be near a place.
    pub fn list(&mut self, samples: &[NewSample], shift: IVec2) {
        let last = self.square.side - 1;
        let min = self.square.min;
        // Sides are nearly as long as 32 bits allow, so that steps may wrap; the offset of a sample in a parcel nearby is short.
        let from = IVec2::new(min.x, min.y).wrapping_sub(shift);
        for &NewSample { at, radius, .. } in samples {
            let at = IVec2::new(at.x, at.y).wrapping_sub(from);
            let reach = most_reach(radius, self.greatest);
            let low = (at - reach).max(IVec2::ZERO);
            let high = (at + reach).min(IVec2::splat(last));
            if low.cmpgt(high).any() {
                continue;
            }

            let near = ListedSample { at, radius };
            if self.has_one_width {
                self.list_evenly(near, low, high);
            } else {
                self.list_by_families(near, low, high);
            }
        }
    }

    /// Lists a sample where all families are equally wide. No place of the parcel near the sample is below `low` or above `high`.
    fn list_evenly(&mut self, sample: ListedSample, low: IVec2, high: IVec2) {
        let ListedSample { at, radius } = sample;
        let (low, high) = (low >> self.bits as i32, high >> self.bits as i32);
        let (columns, side) = (self.square.side >> self.bits, 1 << self.bits);
        let reach = i64::from(most_reach(radius, self.greatest));

        for row in low.y..=high.y {
            let up = at.y - (row << self.bits);
            let squared_up = squared_beyond(up, side);
            for column in low.x..=high.x {
                let right = at.x - (column << self.bits);
                let squared = squared_beyond(right, side) + squared_up;
                if squared > reach * reach {
                    continue;
                }
                let number = usize::from(self.family_at[(row * columns + column) as usize]);
                // The number of no family is beyond all lists.
                let Some(list) = self.lists.get_mut(number) else {
                    continue;
                };

                // Families of smaller radii have shorter reaches. Where there are none, families are not looked at: they would
                // be another miss of the cache.
                let is_near = self.has_one_greatest || {
                    let greatest = self.families[number].range.greatest;
                    let reach = i64::from(most_reach(radius, greatest));
                    squared <= reach * reach
                };
                if is_near {
                    self.near.push(list, IVec2::new(right, up), radius);
                }
            }
        }
    }

    /// Lists a sample where families differ. Otherwise as [`Self::list_evenly`].
    fn list_by_families(&mut self, sample: ListedSample, low: IVec2, high: IVec2) {
        let ListedSample { at, radius } = sample;
        let (low, high) = (low >> self.bits as i32, high >> self.bits as i32);
        let columns = self.square.side >> self.bits;

        for row in low.y..=high.y {
            let mut column = low.x;
            while column <= high.x {
                let number = usize::from(self.family_at[(row * columns + column) as usize]);
                let Some(family) = self.families.get(number) else {
                    column += 1;
                    continue;
                };
                let corner = family.min - self.square.min;
                let side = 1 << family.bits;
                // The next family of the row.
                column = (corner.x + side) >> self.bits;
                // A family is met in each of its rows, and counts in the first one.
                let list = &mut self.lists[number];
                if (corner.y >> self.bits).max(low.y) != row || list.is_closed() {
                    continue;
                }

                let offset = at - corner;
                let squared = squared_beyond(offset.x, side) + squared_beyond(offset.y, side);
                let reach = i64::from(most_reach(radius, family.range.greatest));
                if squared <= reach * reach {
                    self.near.push(list, offset, radius);
                }
            }
        }
    }
}

/// Returns the square of how far a place is beyond the ends of an axis of `side` places, or 0 between them.
#[inline]
fn squared_beyond(at: i32, side: i32) -> i64 {
    let beyond = i64::from((-at).max(at - (side - 1)).max(0));
    beyond * beyond
}
