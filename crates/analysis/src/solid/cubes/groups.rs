//! Samples near a cube, eight of which are compared with it, or with all of its parts, at a time.
//!
//! Each lane is rounded as the formula for one sample is: the verdict does not depend on what vectors the processor has.

use fearless_simd::Simd;
use fearless_simd::f64x8;
use fearless_simd::prelude::*;

use super::{Cube, CubeParts, PARTS, halves};

/// How many samples are compared at a time.
pub(super) const LANES: usize = 8;

/// Up to eight samples: their coordinates axis by axis.
#[derive(Clone, Copy)]
pub(super) struct SampleGroup([[f64; LANES]; 3]);

impl SampleGroup {
    /// No samples: a lane at infinity is within the limit of no place.
    const EMPTY: Self = Self([[f64::INFINITY; LANES]; 3]);

    /// Returns samples, of which there are `count`, in groups, all full but the last.
    pub fn all_of(samples: impl Iterator<Item = [f64; 3]>, count: usize) -> Vec<Self> {
        let mut groups = Vec::with_capacity(count.div_ceil(LANES));
        for (index, sample) in samples.enumerate() {
            let lane = index % LANES;
            if lane == 0 {
                groups.push(Self::EMPTY);
            }
            if let Some(group) = groups.last_mut() {
                for (axis, value) in sample.into_iter().enumerate() {
                    group.0[axis][lane] = value;
                }
            }
        }
        groups
    }

    /// Returns which samples are within a squared limit of some place of a cube, a bit for each.
    #[expect(
        clippy::inline_always,
        reason = "it must become a part of what dispatch! compiles for the processor"
    )]
    #[inline(always)]
    fn reaching<S: Simd>(&self, simd: S, cube: &Cube, limit_squared: f64) -> u64 {
        let mut squares = [f64x8::splat(simd, 0.0); 3];
        for (axis, square) in squares.iter_mut().enumerate() {
            let apart = (f64x8::simd_from(simd, self.0[axis]) - cube.middle[axis]).abs();
            // On an axis on which a sample is between the cube's ends, it is as near as can be.
            let beyond = (apart - cube.half[axis]).max(f64x8::splat(simd, 0.0));
            *square = beyond * beyond;
        }
        let [x, y, z] = squares;
        (x + y + z).simd_le(limit_squared).to_bitmask()
    }
}

/// Appends the samples of some groups that are within a squared limit of some place of a cube, in groups of their own.
#[expect(
    clippy::inline_always,
    reason = "it must become a part of what dispatch! compiles for the processor"
)]
#[inline(always)]
pub(super) fn list<S: Simd>(
    simd: S,
    cube: &Cube,
    limit_squared: f64,
    groups: &[SampleGroup],
    out: &mut Vec<SampleGroup>,
) {
    let mut filling = SampleGroup::EMPTY;
    let mut filled = 0;

    for group in groups {
        let mut reaching = group.reaching(simd, cube, limit_squared);
        // The bits are taken from the lowest on.
        while reaching != 0 {
            let lane = reaching.trailing_zeros() as usize % LANES;
            reaching &= reaching - 1;
            for axis in 0..3 {
                filling.0[axis][filled] = group.0[axis][lane];
            }
            filled += 1;

            if filled == LANES {
                out.push(filling);
                (filling, filled) = (SampleGroup::EMPTY, 0);
            }
        }
    }

    // The lanes behind the last sample stay at infinity.
    if filled > 0 {
        out.push(filling);
    }
}

/// What samples say of the parts of a cube, a bit for each part.
#[derive(Clone, Copy, Default)]
pub(super) struct PartFindings {
    /// Parts of which one sample is within the limit of all places.
    pub proven: u32,
    /// Parts whose middle is within the limit of a sample. Of proven parts the bit means nothing.
    pub covered: u32,
}

/// Compares samples with all parts of a cube.
#[expect(
    clippy::inline_always,
    reason = "it must become a part of what dispatch! compiles for the processor"
)]
#[inline(always)]
pub(super) fn compare<S: Simd>(
    simd: S,
    parts: &CubeParts,
    limit_squared: f64,
    groups: &[SampleGroup],
) -> PartFindings {
    let mut found = PartFindings::default();
    let limit = f64x8::splat(simd, limit_squared);
    for group in groups {
        // Parts have two middles on each axis: six squares for each kind of distance serve all of them.
        let mut middle = [[f64x8::splat(simd, 0.0); 2]; 3];
        let mut farthest = middle;
        for axis in 0..3 {
            let samples = f64x8::simd_from(simd, group.0[axis]);
            for upper in 0..2 {
                let apart = (samples - parts.middles[upper][axis]).abs();
                let beyond = apart + parts.half[axis];
                middle[axis][upper] = apart * apart;
                farthest[axis][upper] = beyond * beyond;
            }
        }

        for part in 0..PARTS {
            let [x, y, z] = halves(part);
            let sum = farthest[0][x] + farthest[1][y] + farthest[2][z];
            found.proven |= u32::from(sum.simd_le(limit).any_true()) << part;
        }
        // Most parts are proven, and need no look at their middles.
        let mut unsure = parts.present & !found.proven & !found.covered;
        while unsure != 0 {
            let part = unsure.trailing_zeros() as usize % PARTS;
            unsure &= unsure - 1;
            let [x, y, z] = halves(part);
            let sum = middle[0][x] + middle[1][y] + middle[2][z];
            found.covered |= u32::from(sum.simd_le(limit).any_true()) << part;
        }
        if found.proven & parts.present == parts.present {
            break;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    /// Returns places all over the unit cube.
    fn samples(count: u32) -> Vec<[f64; 3]> {
        let steps = [0.819_172_513_396, 0.671_043_606_703, 0.549_700_477_901];
        let place = |index: u32| steps.map(|step| (f64::from(index) * step).fract());
        (1..=count).map(place).collect()
    }

    /// Returns the finite coordinates of some groups: those of samples.
    fn members(groups: &[SampleGroup]) -> Vec<[f64; 3]> {
        let lanes = groups
            .iter()
            .flat_map(|group| (0..LANES).map(|lane| [0, 1, 2].map(|axis| group.0[axis][lane])));
        lanes.filter(|place| place[0].is_finite()).collect()
    }

    /// Limits are exactly the distances of the formula for one sample, and the next numbers below them: a lane that is
    /// rounded in another way gives another answer to one of the two.
    #[test]
    fn lanes_are_rounded_as_the_formula_for_one_sample() {
        // Two full groups and one with free lanes. The box is not cut along z.
        let samples = samples(21);
        let groups = SampleGroup::all_of(samples.iter().copied(), samples.len());
        let cube = Cube {
            middle: [0.43, 0.51, 0.58],
            half: [0.13, 0.11, 0.07],
        };
        let parts = cube.parts();
        assert_eq!(parts.present, 0b1111);

        for level in [Level::baseline(), Level::new()] {
            for distance in samples.iter().map(|&at| cube.distances(at).nearest) {
                for limit in [distance, distance.next_down()] {
                    let mut listed = Vec::new();
                    dispatch!(level, simd => list(simd, &cube, limit, &groups, &mut listed));
                    let reaching = |&at: &[f64; 3]| cube.distances(at).nearest <= limit;
                    let expected: Vec<_> = samples.iter().copied().filter(reaching).collect();
                    assert_eq!(members(&listed), expected, "{limit}");
                }
            }

            for (number, part) in parts.of(parts.present) {
                let all = samples.iter().map(|&at| part.distances(at));
                let [middle, farthest] = all.fold([f64::INFINITY; 2], |[middle, far], one| {
                    [middle.min(one.middle), far.min(one.farthest)]
                });
                let found = |limit: f64| -> PartFindings {
                    dispatch!(level, simd => compare(simd, &parts, limit, &groups))
                };
                let bits = |limit: f64| {
                    let PartFindings { proven, covered } = found(limit);
                    [proven, covered].map(|bits| bits >> number & 1 == 1)
                };
                assert!(bits(farthest)[0] && !bits(farthest.next_down())[0]);
                // Not proven with this limit, as no sample is at the middle.
                assert!(bits(middle)[1] && !bits(middle.next_down())[1]);
            }
        }
    }
}
