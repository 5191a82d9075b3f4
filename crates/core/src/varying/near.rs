//! The samples around a base cell, gathered once for all of its active parts, and eight of them compared at a time.
//!
//! Offsets and radii are whole numbers below 2^24, which `f32` holds exactly: a base cell and the reach around it are at most
//! 2^21 and 2^22 units wide. Squares and products of them are rounded, by less than [`ROUNDED`] altogether.

// Only code that is inlined may use the vector instructions of the function that asks for it.
#![allow(clippy::inline_always)]

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::IVec2;

use super::octaves::{Octaves, Sight};
use super::rule::is_near;
use crate::lattice::Point;

/// How many samples are compared at a time.
const LANES: usize = 8;

/// The relative error of a comparison: some ten roundings of 2^-24 each, and a margin of four times as much.
const ROUNDED: f32 = 1.0 / (1 << 18) as f32;

/// An offset that no sample has: the square of it is far above that of any reach, and not yet infinite.
const FAR: f32 = 1e15;

/// Samples around some places, as offsets from a base cell's lowest place.
#[derive(Default)]
pub(super) struct NearSamples {
    count: usize,
    x: Vec<[f32; LANES]>,
    y: Vec<[f32; LANES]>,
    radii: Vec<[f32; LANES]>,
}

/// The places of a rectangle, by offsets from the base cell's lowest place.
#[derive(Clone, Copy)]
pub(super) struct Places {
    pub lowest: IVec2,
    /// The highest place, which is one of them.
    pub highest: IVec2,
}

/// Eight samples.
#[derive(Clone, Copy)]
struct Eight<S: Simd> {
    x: f32x8<S>,
    y: f32x8<S>,
    radius: f32x8<S>,
}

/// The quarters of a cell that are tested, by offsets from the base cell's lowest place.
#[derive(Clone, Copy)]
pub(super) struct QuarterTest {
    /// The cell's lowest place.
    pub corner: IVec2,
    /// The side of a quarter.
    pub half: i32,
    /// Of each quarter, row by row, a radius that no place in it is below.
    pub least: [i32; 4],
}

impl NearSamples {
    /// Gathers the samples that can be near one of some places, where no radius is above `greatest`.
    pub fn gather(
        &mut self,
        samples: &Octaves,
        origin: Point,
        Places { lowest, highest }: Places,
        greatest: i32,
        sight: Sight,
    ) {
        self.count = 0;
        let extent = highest - lowest;
        let shift = lowest + extent / 2;
        let middle = Point::new(origin.x + shift.x, origin.y + shift.y);
        // From the middle to the farther one of two sides.
        let slack = extent.max_element() / 2 + 1;
        let (low, high) = (lowest - shift, highest - shift);

        samples.any_near(middle, greatest, slack, sight, |offset, radius| {
            // A reach is at most the mean of both radii, and at most twice the smaller one.
            let mean = (radius + greatest + 1) / 2;
            let limit = i64::from(mean.min(2 * radius.min(greatest)));
            // How far the sample is beyond the sides; nothing on an axis on which it is between them.
            let beyond = (low - offset).max(offset - high).max(IVec2::ZERO);
            if beyond.as_i64vec2().length_squared() <= limit * limit {
                self.push(offset + shift, radius);
            }
            // The search goes on to all samples.
            false
        });
    }

    fn push(&mut self, offset: IVec2, radius: i32) {
        let (group, lane) = (self.count / LANES, self.count % LANES);
        if lane == 0 {
            // The lanes of a new group hold nothing that could be near, until they are written over.
            let fill = |groups: &mut Vec<[f32; LANES]>, value: f32| {
                groups.truncate(group);
                groups.push([value; LANES]);
            };
            fill(&mut self.x, FAR);
            fill(&mut self.y, FAR);
            fill(&mut self.radii, 1.0);
        }
        self.x[group][lane] = offset.x as f32;
        self.y[group][lane] = offset.y as f32;
        self.radii[group][lane] = radius as f32;
        self.count += 1;
    }

    #[inline(always)]
    fn groups<S: Simd>(&self, simd: S) -> impl Iterator<Item = Eight<S>> {
        let groups = self.count.div_ceil(LANES);
        let places = self.x[..groups].iter().zip(&self.y[..groups]);
        places
            .zip(&self.radii[..groups])
            .map(move |((x, y), radii)| Eight {
                x: f32x8::simd_from(simd, *x),
                y: f32x8::simd_from(simd, *y),
                radius: f32x8::simd_from(simd, *radii),
            })
    }

    /// Returns which quarters of a cell lie near one sample as a whole, as bits. Of some whose farthest place is near a sample by
    /// little it does not say so.
    #[inline(always)]
    pub fn covered_quarters<S: Simd>(&self, simd: S, test: &QuarterTest) -> u32 {
        let half = test.half as f32;
        let [x, y] = [test.corner.x as f32, test.corner.y as f32];
        let mut covered = 0;

        for eight in self.groups(simd) {
            // The farther one of the two ends of each half of the cell, squared.
            let farther = |at: f32x8<S>, low: f32| {
                let near_end = (at - low).abs();
                let far_end = (at - (low + (half - 1.0))).abs();
                let far = near_end.max(far_end);
                far * far
            };
            let columns = [farther(eight.x, x), farther(eight.x, x + half)];
            let rows = [farther(eight.y, y), farther(eight.y, y + half)];

            for quarter in 0..4 {
                let squared = columns[quarter % 2] + rows[quarter / 2];
                let least = test.least[quarter] as f32;
                // Both sides of d <= 2ab / (a + b) times a + b, and squared: no division is needed. The harmonic mean without
                // rounding is not above the reach.
                let sum = eight.radius + least;
                let product = eight.radius * (least * (2.0 - 2.0 * ROUNDED));
                let is_covered = (squared * (sum * sum)).simd_le(product * product);
                covered |= u32::from(is_covered.any_true()) << quarter;
            }
            if covered == 0b1111 {
                break;
            }
        }
        covered
    }

    /// Returns whether a gathered sample is near a place of this radius, exactly.
    #[inline(always)]
    pub fn covers<S: Simd>(&self, simd: S, place: IVec2, radius: i32) -> bool {
        let [x, y] = [place.x as f32, place.y as f32];
        let own = radius as f32;

        let mut is_doubtful = false;
        for eight in self.groups(simd) {
            let (dx, dy) = (eight.x - x, eight.y - y);
            let sum = eight.radius + own;
            let product = eight.radius * (2.0 * own);

            // As above; the reach is rounded up, by less than 1.
            let squared = (dx * dx + dy * dy) * (sum * sum);
            let surely = product * (1.0 - ROUNDED);
            if squared.simd_le(surely * surely).any_true() {
                return true;
            }
            let perhaps = (product + sum) * (1.0 + ROUNDED);
            is_doubtful |= squared.simd_le(perhaps * perhaps).any_true();
        }
        // Rounding decides nothing: a sample that is nearly as far as its reach is compared in integers, which is rare.
        is_doubtful && self.covers_exactly(place, radius)
    }

    #[inline(never)]
    fn covers_exactly(&self, place: IVec2, radius: i32) -> bool {
        (0..self.count).any(|index| {
            let (group, lane) = (index / LANES, index % LANES);
            let at = IVec2::new(self.x[group][lane] as i32, self.y[group][lane] as i32);
            let squared = (at - place).as_i64vec2().length_squared();
            is_near(squared, self.radii[group][lane] as i32, radius)
        })
    }
}
