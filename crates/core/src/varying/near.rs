//! The samples around each base cell, listed once for all of its active parts, and eight of them compared at a time.
//!
//! Offsets and radii are whole numbers below 2^24, which `f32` holds exactly: a base cell and the reach around it are at most
//! 2^21 and 2^22 units wide. Squares and products of them are rounded, by less than [`ROUNDED`] altogether.

// Only code that is inlined may use the vector instructions of the function that asks for it.
#![allow(clippy::inline_always)]

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::IVec2;

use super::rule::is_near;
use crate::chains::{Chain, Chains, GROUP_LANES, Lane};

/// The relative error of a comparison: some ten roundings of 2^-24 each, and a margin of four times as much.
const ROUNDED: f32 = 1.0 / (1 << 18) as f32;

/// An offset that no sample has: the square of it is far above that of any reach, and not yet infinite.
const FAR: f32 = 1e15;

/// The lists of all base cells of a parcel.
pub(super) struct NearSamples {
    chains: Chains<SampleGroup>,
    /// The radii of each group's samples; nothing where all places have one radius.
    radii: Vec<[f32; GROUP_LANES]>,
    has_one_radius: bool,
}

/// Up to eight samples, as offsets from a base cell's lowest place: one line of the cache.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct SampleGroup {
    x: [f32; GROUP_LANES],
    y: [f32; GROUP_LANES],
}

/// The quarters of a cell that are tested, by offsets from the base cell's lowest place.
#[derive(Clone, Copy)]
pub(super) struct QuarterTest {
    /// The cell's lowest place.
    pub corner: IVec2,
    /// The side of a quarter.
    pub half: i32,
    /// Of each quarter, row by row, a lower bound of its radii.
    pub least: [i32; 4],
}

impl SampleGroup {
    /// No samples: a lane holds nothing that could be near, until it is written over.
    const EMPTY: Self = Self {
        x: [FAR; GROUP_LANES],
        y: [FAR; GROUP_LANES],
    };
}

impl NearSamples {
    /// Returns room for some lists, all of them empty. If `has_one_radius`, that of all samples and places is the same.
    pub fn for_lists(lists: usize, has_one_radius: bool) -> Self {
        // A fifth of the lists has more than eight samples where the radius hardly varies.
        let groups = lists + lists / 4;
        Self {
            chains: Chains::with_capacity(groups),
            radii: Vec::with_capacity(if has_one_radius { 0 } else { groups }),
            has_one_radius,
        }
    }

    /// Appends a sample to a list, unless it is closed.
    #[inline(always)]
    pub fn push(&mut self, list: &mut Chain, offset: IVec2, radius: i32) {
        if list.is_closed() {
            return;
        }
        let Lane { group, number } = self.chains.add(list, &SampleGroup::EMPTY);
        let samples = self.chains.group_mut(group);
        samples.x[number] = offset.x as f32;
        samples.y[number] = offset.y as f32;

        if !self.has_one_radius {
            if group == self.radii.len() {
                // A lane without a sample needs some radius, too. Any will do: its offset is far beyond all reaches.
                self.radii.push([1.0; GROUP_LANES]);
            }
            self.radii[group][number] = radius as f32;
        }
    }

    /// Closes a list, whose memory others may use.
    pub fn close(&mut self, list: &mut Chain) {
        self.chains.close(list);
    }

    /// Returns the groups of a list, each with the radii of its samples unless all places have `ONE_RADIUS`.
    #[inline(always)]
    fn groups<const ONE_RADIUS: bool>(
        &self,
        list: Chain,
    ) -> impl Iterator<Item = (&SampleGroup, Option<&[f32; GROUP_LANES]>)> {
        let radii = |number: usize| (!ONE_RADIUS).then(|| &self.radii[number]);
        let groups = self.chains.of(list);
        groups.map(move |(number, group)| (group, radii(number)))
    }

    /// Returns which quarters of a cell lie, as a whole, near one sample of a list: a bit each, row by row. A quarter that only just
    /// does may be missing.
    #[inline(always)]
    pub fn covered_quarters<S: Simd>(&self, simd: S, list: Chain, test: &QuarterTest) -> u32 {
        // Decided once, and not for each group.
        if self.has_one_radius {
            self.quarters_near::<S, true>(simd, list, test)
        } else {
            self.quarters_near::<S, false>(simd, list, test)
        }
    }

    #[inline(always)]
    fn quarters_near<S: Simd, const ONE_RADIUS: bool>(
        &self,
        simd: S,
        list: Chain,
        test: &QuarterTest,
    ) -> u32 {
        let half = test.half as f32;
        let [x, y] = [test.corner.x as f32, test.corner.y as f32];
        let mut covered = 0;

        for (group, radii) in self.groups::<ONE_RADIUS>(list) {
            let across = f32x8::simd_from(simd, group.x);
            let up = f32x8::simd_from(simd, group.y);
            let (end, next) = (half - 1.0, half);
            let columns = [
                farther(across, x, x + end),
                farther(across, x + next, x + next + end),
            ];
            let rows = [
                farther(up, y, y + end),
                farther(up, y + next, y + next + end),
            ];

            for quarter in 0..4 {
                let squared = columns[quarter % 2] + rows[quarter / 2];
                let least = test.least[quarter] as f32;
                let is_covered = if let Some(&radii) = radii {
                    // Both sides of d <= 2ab / (a + b) times a + b, and squared: no division is needed. The harmonic mean
                    // without rounding is not above the reach.
                    let radius = f32x8::simd_from(simd, radii);
                    let sum = radius + least;
                    let product = radius * (least * (2.0 - 2.0 * ROUNDED));
                    (squared * (sum * sum)).simd_le(product * product)
                } else {
                    // The reach of two equal radii is that radius. Squaring doubles the margin above: here it is
                    // twice `ROUNDED`, too.
                    squared.simd_le(least * least * (1.0 - 2.0 * ROUNDED))
                };
                covered |= u32::from(is_covered.any_true()) << quarter;
            }
            if covered == 0b1111 {
                break;
            }
        }
        covered
    }

    /// Returns whether a sample of a list is near a place of this radius, exactly.
    #[inline(always)]
    pub fn covers<S: Simd>(&self, simd: S, list: Chain, place: IVec2, radius: i32) -> bool {
        if self.has_one_radius {
            self.any_near::<S, true>(simd, list, place, radius)
        } else {
            self.any_near::<S, false>(simd, list, place, radius)
        }
    }

    #[inline(always)]
    fn any_near<S: Simd, const ONE_RADIUS: bool>(
        &self,
        simd: S,
        list: Chain,
        place: IVec2,
        radius: i32,
    ) -> bool {
        let [x, y] = [place.x as f32, place.y as f32];
        let own = radius as f32;

        let mut is_doubtful = false;
        for (group, radii) in self.groups::<ONE_RADIUS>(list) {
            let dx = f32x8::simd_from(simd, group.x) - x;
            let dy = f32x8::simd_from(simd, group.y) - y;
            let squared = dx * dx + dy * dy;

            let (surely_near, perhaps_near) = if let Some(&radii) = radii {
                let other = f32x8::simd_from(simd, radii);
                let sum = other + own;
                let product = other * (2.0 * own);
                // Multiplied by a + b, as in `quarters_near`. The reach is rounded up by less than 1, so that a sample
                // may be near up to a distance of 2ab / (a + b) + 1.
                let squared = squared * (sum * sum);
                let surely = product * (1.0 - ROUNDED);
                let perhaps = (product + sum) * (1.0 + ROUNDED);
                (
                    squared.simd_le(surely * surely),
                    squared.simd_le(perhaps * perhaps),
                )
            } else {
                // Without radii few numbers are rounded, so that `ROUNDED` itself is margin enough for squares.
                let limit = own * own;
                (
                    squared.simd_le(limit * (1.0 - ROUNDED)),
                    squared.simd_le(limit * (1.0 + ROUNDED)),
                )
            };
            if surely_near.any_true() {
                return true;
            }
            is_doubtful |= perhaps_near.any_true();
        }
        // Rounding decides nothing: a sample that is nearly as far as its reach is compared in integers, which is rare.
        is_doubtful && self.any_near_exactly::<ONE_RADIUS>(list, place, radius)
    }

    #[inline(never)]
    fn any_near_exactly<const ONE_RADIUS: bool>(
        &self,
        list: Chain,
        place: IVec2,
        radius: i32,
    ) -> bool {
        self.groups::<ONE_RADIUS>(list).any(|(group, radii)| {
            (0..GROUP_LANES).any(|lane| {
                // A free lane has no sample, and the square of its offset would not fit 64 bits: it is left out below.
                let [dx, dy] = [group.x[lane] as i64, group.y[lane] as i64];
                let [dx, dy] = [dx - i64::from(place.x), dy - i64::from(place.y)];
                let is_sample = group.x[lane] < FAR;
                let other = radii.map_or(radius, |radii| radii[lane] as i32);
                is_sample && is_near(dx * dx + dy * dy, other, radius)
            })
        })
    }
}

/// Returns the squared distance from samples to the farther one of two ends on an axis.
#[inline(always)]
fn farther<S: Simd>(at: f32x8<S>, low: f32, high: f32) -> f32x8<S> {
    let far = (at - low).abs().max((at - high).abs());
    far * far
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;

    use super::*;
    use crate::instructions::InstructionSet;
    use crate::lattice::R;
    use crate::varying::rule::reach;

    /// Places a unit nearer than the reach, exactly as far and a unit farther get the verdict of the rule.
    #[test]
    fn comparisons_of_eight_agree_with_the_rule() {
        let level = InstructionSet::best().level();
        let radii = [R, R + 1, 40_000, 2 * R - 1, 3 * R, 64 * R];
        let pairs = radii
            .iter()
            .flat_map(|&a| radii.iter().map(move |&b| (a, b)));

        // Samples of one radius are compared without it.
        let radii_kept = |(a, b)| [(a, b, false), (a, b, true)];
        let cases = pairs
            .flat_map(radii_kept)
            .filter(|&(a, b, has_one)| !has_one || a == b);
        for (a, b, has_one_radius) in cases {
            let mut near = NearSamples::for_lists(1, has_one_radius);
            let mut list = Chain::EMPTY;
            near.push(&mut list, IVec2::new(-5, 7), a);

            let farthest = reach(a, b);
            for (distance, expected) in [
                (farthest - 1, true),
                (farthest, true),
                (farthest + 1, false),
            ] {
                let place = IVec2::new(-5, 7 + distance);
                let found: bool = dispatch!(level, simd => near.covers(simd, list, place, b));
                assert_eq!(found, expected, "{a} {b} {distance}");
            }

            // A quarter of one place is never said to be covered beyond the reach, and is well within it.
            for (distance, expected) in [(farthest / 2, 1), (farthest + 1, 0)] {
                let test = QuarterTest {
                    corner: IVec2::new(distance - 5, 7),
                    half: 1,
                    least: [b; 4],
                };
                let found: u32 = dispatch!(level, simd => near.covered_quarters(simd, list, &test));
                assert_eq!(found & 1, expected, "{a} {b} {distance}");
            }
        }
    }
}
