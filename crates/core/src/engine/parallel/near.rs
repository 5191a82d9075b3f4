//! The samples around one cell, gathered for many queries about places in it. Offsets are from the cell's lowest
//! corner, so that they are exact in `f32`.
//!
//! A *pixel* is an eighth of a cell wide. A *candidate* is a place that may have to be filled, about as far from each
//! of the samples that make it, its *sites*.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::{DVec2, I64Vec2};

use crate::lattice::{R, R_SQUARED};

use super::frame::CELL_BITS;
use super::gaps::{corner, each_bit};
use super::region::Slots;
use super::stamp::PIXEL_SIDE;

/// Samples are handled in groups of this many.
const LANES: usize = 8;

/// Groups that hold the samples of the widest search: 81 cells, three in each. [`Near::gather`] writes up to one group
/// beyond the last sample, and the last group itself may not be full.
const GROUPS: usize = (81 * 3 + 2 * LANES) / LANES;

/// A bound on the error in `f32` of squared distances of up to 4r, 2^34: three roundings of one part in 2^24.
const ROUNDED: f32 = 4_096.0;

/// The offset that fills the last group: farther away than any query.
const FAR: f32 = 1e9;

/// Half a pixel's diagonal and a little: how far a place may be from its pixel's centre.
pub(crate) const HALF_DIAGONAL: f32 = 2_897.5;

/// How much farther than the nearest sample a candidate's sample may be from it, in units: the squares differ by
/// at most 22 R (see `stages::voronoi`), at a distance of at least r. With 1 for rounding in `f32`.
pub(crate) const SITE_SLACK: f32 = 12.5;

/// Squares of this side are not divided further when a place is to be proven covered.
const MIN_SQUARE: i32 = 64;

type Lanes = [f32; LANES];

/// Samples around a cell.
#[derive(Default)]
pub(crate) struct Near {
    count: usize,
    x: [Lanes; GROUPS],
    y: [Lanes; GROUPS],
    squared: [Lanes; GROUPS],
}

/// Measurements of a pixel.
pub(crate) struct MeasuredPixel {
    /// The distance from its centre to the nearest sample.
    pub nearest: f32,
    /// Whether one sample covers it.
    pub covered: bool,
    /// The samples that may make a candidate in it, those about as near as the nearest: a bit for each gathered sample.
    pub sites: u64,
}

/// The square of R, less a margin far above the rounding of `f32`.
const SURELY_COVERED: f32 = (R_SQUARED - 8_192) as f32;

/// Room for all samples that are about as near to a pixel as the nearest one: a disk of 3.6 r holds fewer than 64 that
/// are r apart. (64 would do: the last entry stays unused.)
pub(crate) const MAX_SITES: usize = 65;

/// A square of a cell: its lowest corner and its side.
type Square = (i32, i32, i32);

/// Room for the squares that wait to be proven covered: three of each side below a pixel's, 2,048 to [`MIN_SQUARE`],
/// and one, 19 in all.
const MAX_WAITING: usize = 24;

impl Near {
    /// Gathers the samples of the cells at most `reach` cells from `cell` on both axes. Rows of `slots` have `stride`
    /// cells.
    #[inline(always)]
    pub(crate) fn gather(&mut self, slots: &[Slots], stride: usize, cell: usize, reach: i32) {
        let mut count = 0;
        let (xs, ys) = (self.x.as_flattened_mut(), self.y.as_flattened_mut());
        for row in -reach..=reach {
            let start = (cell as i64 + i64::from(row) * stride as i64 - i64::from(reach)) as usize;
            let cells = &slots[start..=start + 2 * reach as usize];
            for (held, column) in cells.iter().zip(-reach..) {
                // All four slots are written, and those beyond the cell's count are overwritten by the next cell. The
                // fourth holds the complement of the count.
                // A slot has the offset to the right in its lowest bits, and that upwards in the others.
                let (left, bottom) = (column * R, row * R);
                let right = held.map(|slot| ((slot as i32 & (R - 1)) + left) as f32);
                let up = held.map(|slot| ((slot >> CELL_BITS) as i32 + bottom) as f32);
                xs[count..count + 4].copy_from_slice(&right);
                ys[count..count + 4].copy_from_slice(&up);
                count += !held[3] as usize & 3;
            }
        }
        self.count = count;
        // The last group is filled up with samples that are near no place.
        xs[count..count + LANES].fill(FAR);
        ys[count..count + LANES].fill(FAR);
    }

    fn groups(&self) -> usize {
        self.count.div_ceil(LANES)
    }

    /// Measures the pixel whose centre is (x, y) among the samples of 5 x 5 cells. These samples are fewer than 64: the
    /// disks of radius r/2 around them do not overlap, and lie in a square with sides of 6 r, which has room for 45.
    #[inline(always)]
    pub(crate) fn measure<S: Simd>(&mut self, simd: S, x: f32, y: f32) -> MeasuredPixel {
        let (nearest, squared_to_corner) = self.square_distances(simd, x, y);
        let limit = f32x8::splat(simd, site_limit(nearest));
        let mut sites = 0;
        let groups = self.squared[..self.groups()].iter();
        for (squared, shift) in groups.zip((0_u32..).step_by(LANES)) {
            let near = f32x8::simd_from(simd, *squared).simd_le(limit);
            // Fewer than 64 samples are at most eight groups: the shift stays below 64, and needs no test.
            sites |= near.to_bitmask().wrapping_shl(shift);
        }
        MeasuredPixel {
            nearest,
            covered: squared_to_corner <= SURELY_COVERED,
            sites,
        }
    }

    /// Lists the samples that may make a candidate in the pixel whose centre is (x, y), and returns how many there
    /// are: as [`Self::measure`] finds them, for a search so wide that 64 bits do not hold all samples.
    #[inline(always)]
    pub(crate) fn list_sites<S: Simd>(
        &mut self,
        simd: S,
        x: f32,
        y: f32,
        sites: &mut [u8; MAX_SITES],
    ) -> usize {
        let (nearest, _) = self.square_distances(simd, x, y);
        let limit = site_limit(nearest);
        let squared = self.squared.as_flattened()[..self.count].iter();
        let mut count = 0;
        for (k, _) in squared
            .enumerate()
            .filter(|(_, squared)| **squared <= limit)
        {
            // There are never more, see `MAX_SITES`: with this test the index needs no check of its own.
            if count < MAX_SITES {
                // At most 243 samples are gathered (81 cells with three in each): 8 bits hold the index.
                sites[count] = k as u8;
                count += 1;
            }
        }
        count
    }

    /// Stores the squared distances of all samples from (x, y). Returns the smallest distance, and the smallest squared
    /// distance from a sample to the farthest corner of the pixel around (x, y).
    #[inline(always)]
    fn square_distances<S: Simd>(&mut self, simd: S, x: f32, y: f32) -> (f32, f32) {
        const HALF: f32 = (PIXEL_SIDE / 2) as f32;
        // Eight samples are taken at a time. The corner of the pixel that is farthest from a sample is half a side
        // farther on both axes: (dx + h)^2 + (dy + h)^2 = dx^2 + dy^2 + 2 h (dx + dy) + 2 h^2, whose last term is added
        // at the end.
        let (x, y) = (f32x8::splat(simd, x), f32x8::splat(simd, y));
        let mut nearest = f32x8::splat(simd, FAR * FAR);
        let mut corner = f32x8::splat(simd, FAR * FAR);
        let groups = self.groups();
        let offsets = self.x[..groups].iter().zip(&self.y[..groups]);
        for ((xs, ys), squared) in offsets.zip(&mut self.squared[..groups]) {
            let dx = (f32x8::simd_from(simd, *xs) - x).abs();
            let dy = (f32x8::simd_from(simd, *ys) - y).abs();
            let square = dx * dx + dy * dy;
            *squared = square.into();
            nearest = nearest.min(square);
            corner = corner.min(square + (dx + dy) * (2.0 * HALF));
        }
        (
            nearest.reduce_min().sqrt(),
            corner.reduce_min() + 2.0 * HALF * HALF,
        )
    }

    /// Returns the squared distance from (x, y) to the nearest sample, give or take [`ROUNDED`].
    #[inline(always)]
    pub(crate) fn nearest_squared<S: Simd>(&self, simd: S, x: f32, y: f32) -> f32 {
        let (x, y) = (f32x8::splat(simd, x), f32x8::splat(simd, y));
        let mut nearest = f32x8::splat(simd, FAR * FAR);
        for (xs, ys) in self.x[..self.groups()].iter().zip(&self.y) {
            let dx = f32x8::simd_from(simd, *xs) - x;
            let dy = f32x8::simd_from(simd, *ys) - y;
            nearest = nearest.min(dx * dx + dy * dy);
        }
        nearest.reduce_min()
    }

    /// Returns whether a sample is nearer to a lattice point than the root of `limit`, exactly.
    #[inline(always)]
    pub(crate) fn any_nearer<S: Simd>(&self, simd: S, place: I64Vec2, limit: i64) -> bool {
        let nearest = self.nearest_squared(simd, place.x as f32, place.y as f32);
        let limit_rounded = limit as f32;
        if nearest < limit_rounded - ROUNDED {
            return true;
        }
        // Only if the nearest distance is as near to the limit as rounding can reach are exact distances compared,
        // which is rare.
        nearest < limit_rounded + ROUNDED
            && self
                .exact()
                .any(|site| site.distance_squared(place) < limit)
    }

    /// Returns a sample's offset.
    #[inline(always)]
    pub(crate) fn offset(&self, index: u8) -> DVec2 {
        let (group, lane) = (index as usize / LANES, index as usize % LANES);
        DVec2::new(self.x[group][lane].into(), self.y[group][lane].into())
    }

    /// Returns all samples, exactly.
    pub(crate) fn exact(&self) -> impl Iterator<Item = I64Vec2> {
        let x = self.x.as_flattened()[..self.count].iter();
        let y = &self.y.as_flattened()[..self.count];
        x.zip(y).map(|(&x, &y)| I64Vec2::new(x as i64, y as i64))
    }

    /// Returns whether one of the pixels in `open` may hold a lattice point that no sample covers. `false` is
    /// a proof: each was divided until one sample covers each part.
    ///
    /// Not inlined, because it is rare, and inlining it makes the frequent code 8% slower.
    #[inline(never)]
    pub(crate) fn any_open<S: Simd>(&self, simd: S, open: u64) -> bool {
        simd.vectorize(
            #[inline(always)]
            || {
                each_bit(open).any(|pixel| {
                    let (x, y) = corner(pixel);
                    self.square_may_be_open(simd, (x, y, PIXEL_SIDE))
                })
            },
        )
    }

    /// Returns whether a square may have a place that no sample covers: it is cut in four until single samples cover
    /// the parts, or one of the smallest is not covered.
    #[inline(always)]
    fn square_may_be_open<S: Simd>(&self, simd: S, square: Square) -> bool {
        let mut waiting = [square; MAX_WAITING];
        let mut count = 1;
        while count > 0 {
            // The last square goes first, so that few are waiting at a time.
            count -= 1;
            let (x, y, side) = waiting[count];
            if self.covers_square(simd, (x, y, side)) {
                continue;
            }
            if side <= MIN_SQUARE {
                return true;
            }
            let half = side / 2;
            for (right, up) in [(0, 0), (half, 0), (0, half), (half, half)] {
                waiting[count] = (x + right, y + up, half);
                count += 1;
            }
        }
        false
    }

    /// Returns whether one sample surely covers a square.
    #[inline(always)]
    fn covers_square<S: Simd>(&self, simd: S, (x, y, side): Square) -> bool {
        let half = (side / 2) as f32;
        let (x, y) = (x as f32 + half, y as f32 + half);
        let (x, y) = (f32x8::splat(simd, x), f32x8::splat(simd, y));
        let mut corner = f32x8::splat(simd, FAR * FAR);
        for (xs, ys) in self.x[..self.groups()].iter().zip(&self.y) {
            let dx = (f32x8::simd_from(simd, *xs) - x).abs() + half;
            let dy = (f32x8::simd_from(simd, *ys) - y).abs() + half;
            corner = corner.min(dx * dx + dy * dy);
        }
        corner.reduce_min() <= SURELY_COVERED
    }
}

/// Returns the squared distance up to which a sample may make a candidate in a pixel whose nearest
/// sample is at `nearest` from its centre. A place of the pixel is up to half a diagonal farther from that sample, and
/// may itself lie half a diagonal away from the centre on the other sample's side.
#[inline(always)]
fn site_limit(nearest: f32) -> f32 {
    let limit = nearest + 2.0 * HALF_DIAGONAL + SITE_SLACK;
    limit * limit
}
