//! The samples around one cell, gathered for many questions about places in it.
//! Offsets are from the cell's lowest corner, so that they are exact in `f32`.

use crate::lattice::{R, R_SQUARED};

use super::frame::CELL_BITS;
use super::region::Slots;
use super::stamp::PIXEL_SIDE;

/// Cells of the widest search, three samples in each, and room for writing three at once.
const ROOM: usize = 81 * 3 + 5;

/// Half a pixel's diagonal and a little: how far a place may be from its pixel's centre.
pub(crate) const HALF_DIAGONAL: f32 = 2_897.5;

/// How much farther than the nearest sample a candidate's sample may be from it, in units: the squares differ by
/// at most 22 R (see `stages::voronoi`), at a distance of at least r. With 1 for rounding in `f32`.
pub(crate) const SITE_SLACK: f32 = 12.5;

/// Squares of this side are not divided further when a place is to be proven covered.
const FINEST: i32 = 64;

/// Samples around a cell.
pub(crate) struct Near {
    pub count: usize,
    pub x: [f32; ROOM],
    pub y: [f32; ROOM],
    squared: [f32; ROOM],
}

impl Default for Near {
    fn default() -> Self {
        Self {
            count: 0,
            x: [0.0; ROOM],
            y: [0.0; ROOM],
            squared: [0.0; ROOM],
        }
    }
}

/// A sample's offset.
pub(crate) type Site = (i64, i64);

impl Near {
    /// Gathers the samples of the cells at most `reach` cells from `cell`.
    #[inline(always)]
    pub(crate) fn gather(&mut self, slots: &[Slots], stride: usize, cell: usize, reach: i32) {
        let mut count = 0;
        for row in -reach..=reach {
            let start = (cell as i64 + i64::from(row) * stride as i64 - i64::from(reach)) as usize;
            let cells = &slots[start..=start + 2 * reach as usize];
            for (slots, column) in cells.iter().zip(-reach..) {
                let held = !slots[3] as usize & 3;
                for k in 0..held {
                    let (right, up) = (slots[k] as i32 & (R - 1), (slots[k] >> CELL_BITS) as i32);
                    self.x[count] = (right + column * R) as f32;
                    self.y[count] = (up + row * R) as f32;
                    count += 1;
                }
            }
        }
        self.count = count;
    }

    /// Returns the squared distance from (x, y) to the nearest sample, and keeps all of them for
    /// [`Self::sites`].
    #[inline(always)]
    pub(crate) fn nearest_squared(&mut self, x: f32, y: f32) -> f32 {
        let mut nearest = f32::INFINITY;
        let n = self.count;
        for ((sx, sy), squared) in self.x[..n].iter().zip(&self.y[..n]).zip(&mut self.squared[..n]) {
            let (dx, dy) = (sx - x, sy - y);
            *squared = dx * dx + dy * dy;
            nearest = nearest.min(*squared);
        }
        nearest
    }

    /// Fills `sites` with the samples at most `limit` (squared) from the last place asked about.
    #[inline(always)]
    pub(crate) fn sites(&self, limit: f32, sites: &mut Vec<[f64; 2]>) {
        sites.clear();
        for k in 0..self.count {
            if self.squared[k] <= limit {
                sites.push([f64::from(self.x[k]), f64::from(self.y[k])]);
            }
        }
    }

    /// Returns all samples, exactly.
    pub(crate) fn exact(&self) -> impl Iterator<Item = Site> {
        let x = self.x[..self.count].iter();
        x.zip(&self.y[..self.count]).map(|(&x, &y)| (x as i64, y as i64))
    }

    /// Returns whether the pixel at (x, y) may hold a lattice point that no sample covers. `false` is
    /// a proof.
    pub(crate) fn may_be_open(&self, x: i32, y: i32) -> bool {
        self.square_may_be_open(x, y, PIXEL_SIDE)
    }

    fn square_may_be_open(&self, x: i32, y: i32, side: i32) -> bool {
        let (x0, y0, last) = (i64::from(x), i64::from(y), i64::from(side - 1));
        let covered = self.exact().any(|(sx, sy)| {
            let dx = (sx - x0).abs().max((sx - x0 - last).abs());
            let dy = (sy - y0).abs().max((sy - y0 - last).abs());
            dx * dx + dy * dy <= R_SQUARED
        });
        if covered {
            return false;
        }
        if side <= FINEST {
            return true;
        }
        let half = side / 2;
        [(0, 0), (half, 0), (0, half), (half, half)]
            .into_iter()
            .any(|(right, up)| self.square_may_be_open(x + right, y + up, half))
    }
}
