//! Detection and insertion at one level in a plane without an end: the whole run of a periodic domain. The candidates are those of
//! [`super::gaps`], found cell by cell: the samples around a cell are gathered once, and all its pixels measured
//! among them. A *pixel* is an eighth of a cell wide. The *sites* of a place are the samples whose circumcentre it is.
//!
//! *Where the next iteration looks.* Let x be an uncovered lattice point, T the Delaunay triangle of the samples that x
//! lies in, c its circumcentre and q its circumradius. With x written as the mean of the corners v of T under weights w,
//!
//! ```text
//! sum of w |x - v|^2 = q^2 - |x - c|^2,
//! ```
//!
//! and the left side exceeds R^2, since no corner covers x. So q > R, and x is nearer to c than the root of q^2 - R^2: this is
//! the *reach* of c. No sample is nearer to c than q. Rounding moves c by 0.71 units: if a sample covers the rounded
//! place, it does so by less than two units, and the search finds such places, too, in the cells that it takes. It
//! takes the cell of the rounded place if no sample covers that. If one does, then q < R + 0.71, and x is nearer to c
//! than the root of 1.42 R + 1: by as much the search goes beyond the cells in which uncovered places may lie
//! ([`centre_margin`]).
//!
//! So by induction over the iterations all such centres are found, and a place left uncovered by an iteration lies within the
//! reach of one of them. Where a single sample covers all of that disk nothing is left. Only the cells that the other disks
//! touch are searched again, one in six.

// An inlined function is compiled for the instructions of the function that asks for it.
#![allow(clippy::inline_always)]

use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch, f32x8};
use glam::{IVec2, Vec2};
use rayon::prelude::*;

use crate::engine::parallel::gaps::each_bit;
use crate::error::SampleError;
use crate::instructions::InstructionSet;
use crate::lattice::{Point, Rect};
use crate::progress::Meter;
use crate::radius::Radius;
use crate::random::{Key, Stream};

use super::candidates::GapPlace;
use super::gaps::{GapPixel, SHIFT, TURN, gathered};
use super::grid::{GatheredSamples, LANES};
use super::region::{LevelRegion, flag};

/// Pixels along a cell's side.
const PIXELS: usize = 8;

/// The square of a distance that no sample has.
const FAR: f32 = 1e18;

/// Returns how much farther cells are searched than uncovered places may lie in them (see the head).
pub(super) const fn centre_margin(radius: Radius) -> i32 {
    (2 * radius.units as i64).isqrt() as i32 + 2
}

/// What a thread needs to search cells.
#[derive(Default)]
struct CellSearch {
    /// The samples around the cell as offsets from its lowest point.
    near: GatheredSamples,
    sites: Vec<IVec2>,
    found: Vec<GapPlace>,
}

impl LevelRegion {
    /// Fills the gaps of a level in a frame that wraps.
    pub(super) fn fill_endless(
        &mut self,
        key: Key,
        meter: &mut Meter<'_>,
    ) -> Result<(), SampleError> {
        self.fill_by_cells(key, meter, Self::cells_again)
    }

    /// Fills the gaps of a level in a frame that wraps. After each iteration `again` lists the cells that are searched next, by
    /// the places that were found.
    pub(super) fn fill_by_cells(
        &mut self,
        key: Key,
        meter: &mut Meter<'_>,
        mut again: impl FnMut(&mut Self, &[GapPlace], &mut Vec<u32>),
    ) -> Result<(), SampleError> {
        // The first search takes the cells in which the samples lost from the tiles may have left a gap.
        let mut cells = std::mem::take(&mut self.dirty);

        for iteration in 1.. {
            let places = self.search_cells(&cells, meter)?;
            let uncovered = places.iter().filter(|place| place.is_uncovered);
            let candidates: Vec<Point> = uncovered.map(|place| place.at).collect();
            if candidates.is_empty() {
                break;
            }

            self.insert(key.derive(Stream::Iteration, iteration), &candidates);
            // A place that is just covered is no candidate, but uncovered places may lie within its reach.
            again(self, &places, &mut cells);
        }

        // The next level empties the list and uses its memory again.
        self.dirty = cells;
        Ok(())
    }

    /// Returns the places found in cells.
    fn search_cells(
        &self,
        cells: &[u32],
        meter: &mut Meter<'_>,
    ) -> Result<Vec<GapPlace>, SampleError> {
        let mut places = Vec::new();
        // A thread takes TURN cells at a time, and after each SHIFT of them the observer is asked whether to go on.
        for batch in cells.chunks(SHIFT) {
            let found = batch.par_chunks(TURN).map(|cells| {
                let mut search = CellSearch::default();
                dispatch!(InstructionSet::best().level(), simd => {
                    for &cell in cells {
                        search.cell(simd, self, cell as usize);
                    }
                });
                search.found
            });

            places.append(&mut found.collect::<Vec<_>>().concat());
            meter.ask()?;
        }
        Ok(places)
    }

    /// Fills `cells` with those in which something may be uncovered after an iteration that found `places`.
    pub(super) fn cells_again(&mut self, places: &[GapPlace], cells: &mut Vec<u32>) {
        let radius = self.grid.radius();
        cells.clear();

        for place in places {
            // A sample as near as this covers the whole disk. One unit is taken off, since `units` is rounded up.
            let inner = radius.units - 1 - place.reach;
            let is_covered = inner >= 0
                && self.grid.any_near(place.at, inner, |offset| {
                    offset.as_i64vec2().length_squared() <= i64::from(inner).pow(2)
                });

            // By the flag, which is unset below, a cell within reach of several places is listed once.
            if !is_covered {
                let reach = place.reach + centre_margin(radius);
                let mark = |cell| cells.push(cell as u32);
                self.flags
                    .set_near(&self.grid, place.at, reach, flag::CHANGED, mark);
            }
        }

        for &cell in cells.iter() {
            self.flags.unset(cell as usize, flag::CHANGED);
        }
    }
}

impl CellSearch {
    /// Finds the places in a cell.
    #[inline(always)]
    fn cell<S: Simd>(&mut self, simd: S, region: &LevelRegion, cell: usize) {
        let radius = region.grid.radius();
        let rect = region.grid.layout().cell_rect(cell);
        let pixel_side = radius.side() / PIXELS as i32;

        // Samples that may cover a place of the cell.
        self.gather(region, &rect, radius.units);
        let nearest = self.measure(simd, pixel_side);

        let half_diagonal = (pixel_side - 1) as f32 / 2.0 * std::f32::consts::SQRT_2;
        // A sample no farther than this from a pixel's centre covers all of it. Four units less outweigh the rounding of
        // squares below 2^44 to 24 bits.
        let limit = radius.units as f32 - half_diagonal - 4.0;
        let mut open = 0;
        for (row, squares) in nearest.iter().enumerate() {
            let is_open =
                f32x8::simd_from(simd, *squares).simd_gt(f32x8::splat(simd, limit * limit));
            open |= is_open.to_bitmask() << (row * PIXELS);
        }

        // Most cells are covered.
        if open != 0 {
            self.open_cell(simd, region, &rect, open, nearest.as_flattened());
        }
    }

    /// Finds the places in the open pixels of a cell, given as bits with the squares of their distances from the nearest of the
    /// samples gathered so far.
    #[inline(always)]
    fn open_cell<S: Simd>(
        &mut self,
        simd: S,
        region: &LevelRegion,
        cell: &Rect,
        open: u64,
        nearest: &[f32],
    ) {
        let radius = region.grid.radius();
        let pixel_side = radius.side() / PIXELS as i32;
        let reach = gathered(radius);
        self.gather_around(region, cell, open, nearest, reach);

        // Which of the gathered samples are in sight of a pixel is given by the bits of one number, if they are no more
        // than 64. More are gathered only where the search reaches far.
        let fit_in_bits = self.near.count <= 64;
        for number in each_bit(open) {
            let mut pixel = GapPixel::of_cell(cell, pixel_side, number);
            // Cells at the upper edges are cut off by the frame.
            if pixel.min.x >= cell.max.x || pixel.min.y >= cell.max.y {
                continue;
            }

            // Samples farther from the centre than this are no sites (see the head of `gaps`). Four units are added for the
            // rounding of squares. If the nearest sample was not among those gathered first, `sight` is too long, which
            // does no harm.
            let sight = nearest[usize::from(number)].sqrt() + pixel.site_slack() as f32 + 4.0;
            if sight >= reach as f32 || !fit_in_bits {
                // Its sites may lie beyond the samples gathered around the cell.
                region.find(&mut pixel, &mut self.sites, &mut self.found);
                continue;
            }

            let centre = (pixel.min - cell.min).as_vec2() + (pixel_side - 1) as f32 / 2.0;
            let near = self.in_sight(simd, centre, sight);
            // A circumcentre has three sites, which three of four pixels lack.
            if near.count_ones() >= 3 {
                self.list_sites(near, &pixel, cell, radius);
                region.find_among(&pixel, &self.sites, &mut self.found);
            }
        }
    }

    /// Gathers the samples that may be sites of open pixels and lie no farther than `reach` from their centres, and
    /// some others.
    #[inline(always)]
    fn gather_around(
        &mut self,
        region: &LevelRegion,
        cell: &Rect,
        open: u64,
        nearest: &[f32],
        reach: i32,
    ) {
        // The first and the last row of the open pixels, of which there is one at least, and the first and the last
        // column: for these all rows are laid over each other.
        let (bottom, top) = (open.trailing_zeros() / 8, open.ilog2() / 8);
        let mut columns = open | open >> 32;
        columns |= columns >> 16;
        columns = (columns | columns >> 8) & 0xff;
        let (left, right) = (columns.trailing_zeros(), columns.ilog2());

        let pixel_side = region.grid.radius().side() / PIXELS as i32;
        // All pixels have the same slack.
        let slack = GapPixel::of_cell(cell, pixel_side, 0).site_slack();
        let open_squares = each_bit(open).map(|number| nearest[usize::from(number)]);
        let farthest = open_squares
            .fold(0.0, |a, b| if b > a { b } else { a })
            .sqrt();
        // This exceeds the `sight` of all open pixels, to which `open_cell` adds only four units.
        let needed = reach.min((farthest + slack as f32) as i32 + 8);

        // The grid gathers from a square. From its middle the centres of the open pixels are no farther than `half` on
        // both axes.
        let between = |first: u32, last: u32| (first + last + 1) as i32 * pixel_side / 2;
        let half = (right - left).max(top - bottom) as i32 * pixel_side / 2;
        let middle = Point::new(
            cell.min.x + between(left, right),
            cell.min.y + between(bottom, top),
        );
        // One unit more, as halves are rounded.
        region
            .grid
            .gather(middle, needed + half + 1, cell.min, &mut self.near);
    }

    /// Gathers the samples at most `reach` from the places of a cell on both axes, and some others.
    fn gather(&mut self, region: &LevelRegion, cell: &Rect, reach: i32) {
        let half = region.grid.radius().side() / 2;
        let middle = Point::new(cell.min.x + half, cell.min.y + half);
        region
            .grid
            .gather(middle, reach + half, cell.min, &mut self.near);
    }

    /// Returns for each pixel the square of the distance from its centre to the nearest gathered sample, row by row.
    #[inline(always)]
    fn measure<S: Simd>(&self, simd: S, pixel_side: i32) -> [[f32; PIXELS]; PIXELS] {
        let first = (pixel_side - 1) as f32 / 2.0;
        let centres: [f32; PIXELS] =
            std::array::from_fn(|k| first + (k as i32 * pixel_side) as f32);
        let centres = f32x8::simd_from(simd, centres);

        let mut nearest = [f32x8::splat(simd, FAR); PIXELS];
        for (x, y) in self.near.samples() {
            let across = f32x8::splat(simd, x) - centres;
            let up = f32x8::splat(simd, y) - centres;
            let across = across * across;
            let up: [f32; PIXELS] = (up * up).into();
            for (nearest, up) in nearest.iter_mut().zip(up) {
                *nearest = nearest.min(across + f32x8::splat(simd, up));
            }
        }
        nearest.map(Into::into)
    }

    /// Returns the gathered samples at most `sight` from `centre`, an offset from the cell's lowest point, as bits. There are at
    /// most 64.
    #[inline(always)]
    fn in_sight<S: Simd>(&self, simd: S, centre: Vec2, sight: f32) -> u64 {
        let (x, y) = (f32x8::splat(simd, centre.x), f32x8::splat(simd, centre.y));
        let limit = f32x8::splat(simd, sight * sight);
        let mut near = 0;
        for ((across, up), shift) in self.near.groups().zip((0_u32..).step_by(LANES)) {
            let dx = f32x8::simd_from(simd, *across) - x;
            let dy = f32x8::simd_from(simd, *up) - y;
            let is_near = (dx * dx + dy * dy).simd_le(limit);
            near |= is_near.to_bitmask().wrapping_shl(shift);
        }
        near
    }

    /// Lists those samples of `near` that may be sites of places in a pixel, as offsets from its lowest point.
    fn list_sites(&mut self, near: u64, pixel: &GapPixel, cell: &Rect, radius: Radius) {
        let corner = pixel.min - cell.min;
        let centre = Vec2::splat((pixel.side - 1) as f32 / 2.0);

        self.sites.clear();
        let (mut nearest, mut least) = (IVec2::ZERO, f32::INFINITY);
        for index in each_bit(near) {
            let site = self.near.offset(index.into()) - corner;
            let square = site.as_vec2().distance_squared(centre);
            if square < least {
                (nearest, least) = (site, square);
            }
            self.sites.push(site);
        }

        // With m the centre of the pixel, n the sample nearest to it, s a site of a place c in the pixel, and u = c - m,
        //
        //     |s - c|^2 - |n - c|^2 = |s - m|^2 - |n - m|^2 - 2 u (s - n),
        //
        // and the left side is at most 18 R, the slack of candidates (see the head of `gaps`). Both axes of 2 u are at
        // most the side. 64 R instead of 18 R outweigh rounding.
        let slack = 64.0 * radius.units as f32;
        self.sites.retain(|site| {
            let apart = (*site - nearest).abs().as_vec2();
            let farther = site.as_vec2().distance_squared(centre) - least;
            farther <= pixel.side as f32 * (apart.x + apart.y) + slack
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::levels::NestedPlane;
    use crate::parameters::Parameters;
    use crate::progress::Unobserved;
    use crate::stage::Stage;

    type Fill = fn(&mut LevelRegion, Key, &mut Meter<'_>) -> Result<(), SampleError>;

    /// Gaps found cell by cell are those found pixel by pixel, and the test finds it if places are searched again too near
    /// to those found before.
    #[test]
    fn gaps_by_cells_are_those_by_pixels() {
        let mut is_control_found = false;
        for (side, levels, leaf, seed) in [(90.0, 4, 9.0, 1), (60.0, 5, 20.0, 2), (31.0, 3, 6.0, 3)]
        {
            let parameters = Parameters {
                width: side,
                height: side * 1.07,
                radius: 1.0,
                leaf,
                seed,
                ..Parameters::default()
            };
            let plane = NestedPlane::new(&parameters, levels, &mut Unobserved).unwrap();
            let filled = |fill: Fill| {
                let mut region = LevelRegion::default();
                let mut unobserved = Unobserved;
                let mut meter =
                    Meter::begin(&mut unobserved, Stage::Regions, levels.into()).unwrap();
                let frame = plane.whole_frame();
                let repeats = false;
                plane
                    .run_filled(&mut region, |_| frame, repeats, &mut meter, fill)
                    .unwrap();
                (region.samples, region.ends)
            };

            let expected = filled(LevelRegion::fill_by_pixels);
            assert_eq!(
                filled(LevelRegion::fill_endless),
                expected,
                "{parameters:?}"
            );

            // Without a reach every place seems to be done with: one sample covers it.
            let too_near: Fill = |region, key, meter| {
                region.fill_by_cells(key, meter, |region, places, cells| {
                    let near: Vec<_> = places
                        .iter()
                        .map(|&place| GapPlace { reach: 0, ..place })
                        .collect();
                    region.cells_again(&near, cells);
                })
            };
            is_control_found |= filled(too_near) != expected;
        }
        assert!(is_control_found, "the test shows nothing");
    }
}
