//! The samples that can cover places of a cell, listed for all of its cubes, and eight of them compared at a time.

// Only code that is inlined may use the vector instructions of the function that asks for it.
#![allow(clippy::inline_always)]

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, i32x8, u32x8};
use glam::IVec3;

use crate::chains::{Chain, Chains, GROUP_LANES, Lane};
use crate::lattice::{R, R_SQUARED};

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

/// The lists of all cells of a parcel.
pub(super) struct BallLists(Chains<BallGroup>);

/// Up to eight samples: one line of the cache.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct BallGroup {
    /// x, and the lower bits of z.
    across: [u32; GROUP_LANES],
    /// y, and the higher bits of z.
    up: [u32; GROUP_LANES],
}

/// The halves of a cube along an axis, each from its lowest to its highest place of the domain, by offsets as samples have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Halves {
    middles: [f32; 2],
    /// From the middle to either end.
    reaches: [f32; 2],
}

impl BallGroup {
    /// No samples: all coordinates are far above those of a sample that covers anything.
    const EMPTY: Self = Self {
        across: [i32::MAX as u32; GROUP_LANES],
        up: [i32::MAX as u32; GROUP_LANES],
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

impl BallLists {
    /// Returns room for some lists, all of them empty.
    pub fn for_lists(lists: usize) -> Self {
        // A maximal set has 15 samples to a list, of which a quarter has more than 16.
        Self(Chains::with_capacity(lists * 9 / 4))
    }

    /// Appends a sample to a list.
    pub fn push(&mut self, list: &mut Chain, offset: IVec3) {
        let [x, y, z] = [offset.x as u32, offset.y as u32, offset.z as u32];
        let Lane { group, number } = self.0.add(list, &BallGroup::EMPTY);
        let balls = self.0.group_mut(group);
        balls.across[number] = x | (z & LOW_MASK) << OFFSET_BITS;
        balls.up[number] = y | (z >> LOW_BITS) << OFFSET_BITS;
    }

    /// Closes a list, whose memory others may use.
    pub fn close(&mut self, list: &mut Chain) {
        self.0.close(list);
    }

    /// Returns whether a sample of a list covers a place, given by offsets as samples are. It is exact.
    #[inline(always)]
    pub fn covers<S: Simd>(&self, simd: S, list: Chain, place: IVec3) -> bool {
        for (_, group) in self.0.of(list) {
            let [x, y, z] = group.unpacked(simd);
            let flat = squared(x, place.x as u32) + squared(y, place.y as u32);
            let squared = flat + squared(z, place.z as u32);
            if squared.simd_le(R_SQUARED as u32).any_true() {
                return true;
            }
        }
        false
    }

    /// Returns which octants of a cube one sample of a list covers as a whole, as bits. An octant may be missing if its
    /// farthest place is almost R from the sample: see [`SURELY`].
    #[inline(always)]
    pub fn covered_octants<S: Simd>(&self, simd: S, list: Chain, cube: &[Halves; 3]) -> u8 {
        // The least squared distance to the farthest place of each octant.
        let mut least = [f32x8::splat(simd, f32::INFINITY); 8];
        for (_, group) in self.0.of(list) {
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
    /// Returns the halves of a cube that begins at a place, counted from the cell's lowest one. Each is `half` units wide.
    #[inline(always)]
    pub fn of_whole(low: i32, half: i32) -> Self {
        let (width, reach) = (half as f32, (half - 1) as f32 * 0.5);
        // Samples are counted from a place R below.
        let middle = (low + R) as f32 + reach;
        Self {
            middles: [middle, middle + width],
            reaches: [reach; 2],
        }
    }

    /// Returns the halves that begin and end at some places, counted from the cell's lowest one.
    #[inline(always)]
    pub fn of(starts: [i32; 2], ends: [i32; 2]) -> Self {
        let half_of = |sum: i32| sum as f32 * 0.5;
        Self {
            // Samples are counted from a place R below.
            middles: [
                half_of(starts[0] + ends[0] + 2 * R),
                half_of(starts[1] + ends[1] + 2 * R),
            ],
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

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;

    use super::*;
    use crate::instructions::InstructionSet;
    use crate::random::{Key, Stream, below};

    /// Returns pseudo-random coordinates in a range.
    fn place(index: u32, range: std::ops::Range<i32>) -> IVec3 {
        let key = Key::from_seed(7);
        let ([x, y], [z, _]) = (key.draw(Stream::Dart, index), key.draw(Stream::Rank, index));
        let width = (range.end - range.start) as u32;
        let coordinate = |word: u32| range.start + below(word, width) as i32;
        IVec3::new(coordinate(x), coordinate(y), coordinate(z))
    }

    /// Returns a list of samples, counted from a cell's lowest place.
    fn listed(samples: &[IVec3]) -> (BallLists, Chain) {
        let (mut lists, mut list) = (BallLists::for_lists(1), Chain::EMPTY);
        for &sample in samples {
            lists.push(&mut list, sample + R);
        }
        (lists, list)
    }

    #[test]
    fn a_place_is_covered_up_to_the_radius_and_not_a_unit_farther() {
        let level = InstructionSet::best().level();
        // 12,288^2 + 12,288^2 + 27,780^2 is just below R^2. A unit more along z is just beyond it, and so is (1, 0, R).
        for (offset, expected) in [
            (IVec3::new(0, 0, R), true),
            (IVec3::new(1, 0, R), false),
            (IVec3::new(R, 0, 0), true),
            (IVec3::new(0, R + 1, 0), false),
            (IVec3::new(12_288, 12_288, 27_780), true),
            (IVec3::new(12_288, 12_288, 27_781), false),
            (IVec3::splat(2 * R - 1), false),
        ] {
            for at in [IVec3::ZERO, IVec3::splat(R - 1)] {
                // From the highest place of the cell toward the lower cells.
                let sample = if at == IVec3::ZERO {
                    at + offset
                } else {
                    at - offset
                };
                let (lists, list) = listed(&[sample]);
                let found: bool = dispatch!(level, simd => lists.covers(simd, list, at + R));
                assert_eq!(found, expected, "{at} {offset}");
            }
        }
    }

    #[test]
    fn lists_of_all_lengths_are_read_whole_on_every_instruction_set() {
        let samples: Vec<IVec3> = (0..29).map(|index| place(index, -R..2 * R)).collect();
        let mut seen = [0, 0];
        for count in 0..samples.len() {
            let (lists, list) = listed(&samples[..count]);
            for index in 100..140 {
                let at = place(index, 0..R);
                let is_near =
                    |sample: &IVec3| (*sample - at).as_i64vec3().length_squared() <= R_SQUARED;
                let expected = samples[..count].iter().any(is_near);
                seen[usize::from(expected)] += 1;
                for set in InstructionSet::available() {
                    let found: bool =
                        dispatch!(set.level(), simd => lists.covers(simd, list, at + R));
                    assert_eq!(found, expected, "{count} {at} {set:?}");
                }
            }
        }
        assert!(seen[0] > 100 && seen[1] > 100, "{seen:?}");
    }

    /// An octant that is said to be covered is so in whole numbers, and one that is not is not covered, or by next to nothing.
    #[test]
    fn covered_octants_are_those_that_one_sample_covers_but_for_a_hair() {
        let level = InstructionSet::best().level();
        let samples: Vec<IVec3> = (0..20).map(|index| place(index, -R..2 * R)).collect();
        let (lists, list) = listed(&samples);
        let mut seen = [0, 0];
        for index in 0..400 {
            let half = 1 << (index % 15);
            let low = place(1_000 + index, 0..R) / (2 * half) * (2 * half);
            let starts = [low, low + half];
            let ends = [low + (half - 1), low + (2 * half - 1)];
            let along = |axis: usize| {
                let halves = Halves::of(starts.map(|start| start[axis]), ends.map(|end| end[axis]));
                assert_eq!(halves, Halves::of_whole(low[axis], half));
                halves
            };
            let cube = [along(0), along(1), along(2)];
            let found: u8 = dispatch!(level, simd => lists.covered_octants(simd, list, &cube));
            for set in InstructionSet::available() {
                let again: u8 =
                    dispatch!(set.level(), simd => lists.covered_octants(simd, list, &cube));
                assert_eq!(again, found, "{set:?}");
            }

            for octant in 0..8 {
                let [x, y, z] = [octant & 1, octant >> 1 & 1, octant >> 2];
                let first = IVec3::new(starts[x].x, starts[y].y, starts[z].z);
                let last = first + (half - 1);
                let farthest = |sample: &IVec3| {
                    let far = (*sample - first).abs().max((*sample - last).abs());
                    far.as_i64vec3().length_squared()
                };
                let nearest = samples.iter().map(farthest).min().expect("a sample");
                let is_found = found >> octant & 1 == 1;
                seen[usize::from(is_found)] += 1;
                assert!(!is_found || nearest <= R_SQUARED, "{low} {half} {octant}");
                let hair = R_SQUARED >> 18;
                assert!(
                    is_found || nearest > R_SQUARED - hair,
                    "{low} {half} {octant}"
                );
            }
        }
        assert!(seen[0] > 100 && seen[1] > 100, "{seen:?}");
    }
}
