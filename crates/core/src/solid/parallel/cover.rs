//! The samples that can cover places of a cell, listed for all of its cubes, and eight of them compared at a time.

// Only code that is inlined may use the vector instructions of the function that asks for it.
#![allow(clippy::inline_always)]

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, i32x8, u32x8};

use crate::lattice::R_SQUARED;

/// How many samples are compared at a time.
const LANES: usize = 8;

/// The number of no group.
const NO_GROUP: u32 = u32::MAX;

/// How many bits a coordinate has: samples are listed by their offset from a place R below the cell's lowest one on each axis,
/// which is not negative and below 3 R.
const OFFSET_BITS: u32 = 17;
const OFFSET_MASK: u32 = (1 << OFFSET_BITS) - 1;

/// Two numbers hold three coordinates: x and y, and above them the lower and the higher bits of z. So neither is negative as a
/// number with a sign.
const LOW_BITS: u32 = 14;
const LOW_MASK: u32 = (1 << LOW_BITS) - 1;

/// A distance on an axis at and beyond which samples cover nothing: larger ones count as this. It is above R, and three squares
/// of it fit 32 bits without a sign.
const FAR: u32 = 37_000;

/// A sum of squares at or below which a sample covers a part as a whole. Each of three squares is rounded by less than one part
/// in 2^24, and so are their sums; the margin is several times as much.
const SURELY: f32 = R_SQUARED as f32 * (1.0 - 1.0 / (1 << 20) as f32);

/// The lists of all cells of a parcel, in groups of eight samples.
pub(super) struct BallLists {
    groups: Vec<BallGroup>,
    /// The first of the groups that no list has any more.
    free: u32,
}

/// The samples that can cover a place of a cell, as a chain of groups, of which only the first may have free lanes.
#[derive(Clone, Copy)]
pub(super) struct BallList {
    first: u32,
    count: u32,
}

/// Up to eight samples.
#[derive(Clone, Copy)]
struct BallGroup {
    /// x, and the lower bits of z.
    across: [u32; LANES],
    /// y, and the higher bits of z.
    up: [u32; LANES],
    next: u32,
}

/// The halves of a cube along an axis, each from its lowest to its highest place of the domain, by offsets as samples have.
#[derive(Clone, Copy, Default)]
pub(super) struct Halves {
    middles: [f32; 2],
    /// From the middle to either end.
    reaches: [f32; 2],
}

impl BallList {
    pub const EMPTY: Self = Self {
        first: NO_GROUP,
        count: 0,
    };
}

impl BallGroup {
    /// No samples: all coordinates are far above those of a sample that covers anything.
    const EMPTY: Self = Self {
        across: [i32::MAX as u32; LANES],
        up: [i32::MAX as u32; LANES],
        next: NO_GROUP,
    };

    /// Returns the coordinates of the samples.
    #[inline(always)]
    fn unpacked<S: Simd>(&self, simd: S) -> [u32x8<S>; 3] {
        let across = u32x8::simd_from(simd, self.across);
        let up = u32x8::simd_from(simd, self.up);
        let z = (across >> OFFSET_BITS) | ((up >> OFFSET_BITS) << LOW_BITS);
        [across & OFFSET_MASK, up & OFFSET_MASK, z]
    }
}

impl Default for BallLists {
    fn default() -> Self {
        Self {
            groups: Vec::new(),
            free: NO_GROUP,
        }
    }
}

impl BallLists {
    /// Returns room for some lists, all of them empty.
    pub fn for_lists(lists: usize) -> Self {
        // A maximal set has 15 samples to a list, of which a quarter has more than 16.
        Self {
            groups: Vec::with_capacity(lists * 9 / 4),
            ..Self::default()
        }
    }

    /// Appends a sample to a list.
    pub fn push(&mut self, list: &mut BallList, [x, y, z]: [i32; 3]) {
        let lane = list.count as usize % LANES;
        if lane == 0 {
            list.first = self.add_group(BallGroup {
                next: list.first,
                ..BallGroup::EMPTY
            });
        }
        let [x, y, z] = [x, y, z].map(|offset| offset as u32);
        let group = &mut self.groups[list.first as usize];
        group.across[lane] = x | (z & LOW_MASK) << OFFSET_BITS;
        group.up[lane] = y | (z >> LOW_BITS) << OFFSET_BITS;
        list.count += 1;
    }

    /// Returns the number of a new group.
    fn add_group(&mut self, group: BallGroup) -> u32 {
        if self.free == NO_GROUP {
            // Twice as much room as before, which a vector takes by itself, would be wasted: few groups are still to come.
            if self.groups.len() == self.groups.capacity() {
                self.groups.reserve_exact(self.groups.len() / 8 + 8);
            }
            self.groups.push(group);
            return self.groups.len() as u32 - 1;
        }
        let number = self.free;
        let place = &mut self.groups[number as usize];
        self.free = place.next;
        *place = group;
        number
    }

    /// Empties a list, whose groups others may use.
    pub fn release(&mut self, list: &mut BallList) {
        let mut number = list.first;
        while let Some(group) = self.groups.get_mut(number as usize) {
            let next = group.next;
            group.next = self.free;
            self.free = number;
            number = next;
        }
        *list = BallList::EMPTY;
    }

    /// Returns the groups of a list.
    #[inline(always)]
    fn groups(&self, list: BallList) -> impl Iterator<Item = &BallGroup> {
        // The number of no group is beyond all groups.
        let group = |number: u32| self.groups.get(number as usize);
        std::iter::successors(group(list.first), move |before| group(before.next))
    }

    /// Returns whether a sample of a list covers a place, given by offsets as samples are. It is exact.
    #[inline(always)]
    pub fn covers<S: Simd>(&self, simd: S, list: BallList, place: [i32; 3]) -> bool {
        let [x, y, z] = place.map(|offset| offset as u32);
        self.groups(list).any(|group| {
            let samples = group.unpacked(simd);
            let squared = squared(samples[0], x) + squared(samples[1], y) + squared(samples[2], z);
            squared.simd_le(R_SQUARED as u32).any_true()
        })
    }

    /// Returns which octants of a cube one sample of a list covers as a whole, as bits. Of some whose farthest place is covered by
    /// little it does not say so.
    #[inline(always)]
    pub fn covered_octants<S: Simd>(&self, simd: S, list: BallList, cube: &[Halves; 3]) -> u8 {
        // The least squared distance to the farthest place of each octant.
        let mut least = [f32x8::splat(simd, f32::INFINITY); 8];
        for group in self.groups(list) {
            let [x, y, z] = group.unpacked(simd);
            let [x, y, z] = [
                cube[0].farthest(as_float(x)),
                cube[1].farthest(as_float(y)),
                cube[2].farthest(as_float(z)),
            ];
            let squares = [x[0] + y[0], x[1] + y[0], x[0] + y[1], x[1] + y[1]];
            for octant in 0..8 {
                least[octant] = least[octant].min(squares[octant & 3] + z[octant >> 2]);
            }
        }

        let mut covered = 0;
        for (octant, squared) in least.into_iter().enumerate() {
            covered |= u8::from(squared.simd_le(SURELY).any_true()) << octant;
        }
        covered
    }
}

impl Halves {
    /// Returns the halves that begin and end at some offsets.
    #[inline(always)]
    pub fn of(starts: [i32; 2], ends: [i32; 2]) -> Self {
        let half_of = |sum: i32| sum as f32 * 0.5;
        Self {
            middles: [half_of(starts[0] + ends[0]), half_of(starts[1] + ends[1])],
            reaches: [half_of(ends[0] - starts[0]), half_of(ends[1] - starts[1])],
        }
    }

    /// Returns the squared distances on the axis from samples to the farthest places of both halves.
    #[inline(always)]
    fn farthest<S: Simd>(&self, at: f32x8<S>) -> [f32x8<S>; 2] {
        // Middles and reaches are whole numbers and halves below 2^18, which `f32` holds exactly.
        let low = (at - self.middles[0]).abs() + self.reaches[0];
        let high = (at - self.middles[1]).abs() + self.reaches[1];
        [low * low, high * high]
    }
}

/// Returns the squared distance on an axis from samples to a place, or one that is too large to cover.
#[inline(always)]
fn squared<S: Simd>(samples: u32x8<S>, place: u32) -> u32x8<S> {
    let distance = (samples.max(place) - samples.min(place)).min(FAR);
    distance * distance
}

/// Returns numbers below 2^31 as floating-point numbers.
#[inline(always)]
fn as_float<S: Simd>(numbers: u32x8<S>) -> f32x8<S> {
    // Most processors convert only numbers with a sign at once.
    let signed: i32x8<S> = numbers.bitcast();
    f32x8::float_from(signed)
}
