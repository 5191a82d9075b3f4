//! Detection and insertion at one level. *Dirty* cells, in which a lost sample may have covered a place, are divided
//! into *pixels*, until one sample covers a pixel or it is an eighth of the cell wide, or a 32nd where the plane goes
//! on beyond the frame. Candidates are sought in the pixels that are left. Whole periodic runs find the same ones
//! sooner ([`super::search`]).
//!
//! *Definition.* A candidate is a lattice point c of the domain that no sample covers and that is
//! - the circumcentre, rounded half up, of three samples,
//! - in a bounded domain, the place of a border line as far from two samples, rounded,
//! - in a bounded domain, a corner,
//!
//! such that no sample p has |p - c|^2 < min over those samples of |. - c|^2, less 12 R. It is that of
//! [`crate::stages::detect`], where the reasons stand why no gap is missed: a gap's deepest place is a candidate. An
//! uncovered lattice point was covered by a tiled sample that was lost, so it lies in a dirty cell.
//!
//! *Where the sites are.* Let m be a pixel's centre, h its half diagonal and d the distance from m to its nearest sample.
//! A candidate in the pixel is at most d + h from that sample, hence its sites are at most d + h + 9 from it (the squares
//! differ by 18 R at most), and d + 2h + 9 from m. A sample that is too near to the candidate is no farther. So the samples within
//! [`PIXEL_SLACK`] and d + 2h of m decide everything in the pixel, now and later, since d never grows.
//!
//! *Unknowns.* An unknown is a disk in which a sample may lie that is not listed. Tiled samples whose fate depends on
//! the plane beyond the frame are unknowns from the beginning. A pixel becomes one if an unknown reaches into that
//! circle, or the strip of width R along the frame's edges in which tiled samples beyond may have been lost. Since d +
//! h > R in an open pixel, the circle also holds every place at which an insertion would cover a place of the pixel.
//! Insertions in the other pixels therefore depend on no unknown, in any iteration.

use glam::IVec2;
use rayon::prelude::*;

use crate::error::SampleError;
use crate::lattice::{Point, Rect};
use crate::progress::Meter;
use crate::radius::Radius;
use crate::random::{Key, Stream};

use super::candidates::{Candidates, GapPlace};
use super::region::{LevelRegion, UnknownDisk, flag};

/// Units by which samples may be farther from a pixel than its nearest one and still be sites: 9 and some for rounding.
const PIXEL_SLACK: f64 = 16.0;

/// How often a cell is halved.
const HALVINGS: u32 = 3;

/// How often it is where unknowns may spread from pixel to pixel: fewer of the small ones lie beside each other.
/// Insertions do not depend on it.
const MORE_HALVINGS: u32 = 5;

/// A square in which there may be a gap.
#[derive(Clone, Copy)]
pub(super) struct GapPixel {
    pub min: Point,
    pub side: i32,
    /// How far from its centre samples decide what happens in it.
    pub sight: f64,
    /// Whether candidates are to be sought in it.
    pub is_due: bool,
}

impl GapPixel {
    /// Returns a pixel of a cell by its number, 0 to 63, row by row.
    pub(super) fn of_cell(cell: &Rect, side: i32, number: u8) -> Self {
        let (column, row) = (i32::from(number) % 8, i32::from(number) / 8);
        Self {
            min: Point::new(cell.min.x + column * side, cell.min.y + row * side),
            side,
            sight: f64::INFINITY,
            is_due: true,
        }
    }

    /// Returns by how much a site may be farther from the centre than the nearest sample.
    pub(super) fn site_slack(&self) -> f64 {
        2.0 * self.half_diagonal() + PIXEL_SLACK
    }

    /// Returns the offset of its centre from its lowest point.
    fn middle(&self) -> f64 {
        f64::from(self.side - 1) / 2.0
    }

    /// Returns the distance from the centre to the corners.
    fn half_diagonal(&self) -> f64 {
        self.middle() * std::f64::consts::SQRT_2
    }

    pub(super) fn rect(&self) -> Rect {
        Rect {
            min: self.min,
            max: Point::new(self.min.x + self.side, self.min.y + self.side),
        }
    }
}

/// Returns how far around a cell samples are gathered: far enough for nearly all of its pixels.
pub(super) const fn gathered(radius: Radius) -> i32 {
    radius.units / 8 * 13
}

/// Cells and pixels of one task of a thread. No result depends on it.
pub(super) const TURN: usize = 256;

/// Cells and pixels between two calls of the observer. No result depends on it.
pub(super) const SHIFT: usize = 256 * TURN;

/// The samples around a cell, as offsets from its lowest point, and the pixels found so far.
#[derive(Default)]
struct Gathered {
    across: Vec<f32>,
    up: Vec<f32>,
    pixels: Vec<GapPixel>,
}

impl LevelRegion {
    /// Fills the gaps of a level, as far as they can be known. `key` is the level's. Uses the current rayon pool. Fails
    /// only when the observer of `meter` stops it.
    pub fn fill(&mut self, key: Key, meter: &mut Meter<'_>) -> Result<(), SampleError> {
        // A plane without an end has no border and no unknowns, and its gaps are found sooner.
        if self.frame.wraps {
            self.fill_endless(key, meter)
        } else {
            self.fill_by_pixels(key, meter)
        }
    }

    /// Fills the gaps in a frame of any kind.
    pub(super) fn fill_by_pixels(
        &mut self,
        key: Key,
        meter: &mut Meter<'_>,
    ) -> Result<(), SampleError> {
        let mut pixels = self.open_pixels(meter)?;
        // Only where the plane goes on beyond the frame something is unknown.
        if self.frame.ends_inside() {
            self.doubt_pixels(&mut pixels);
        }

        for iteration in 1.. {
            let (mut open, mut found) = (Vec::new(), Vec::new());
            for batch in pixels.chunks(SHIFT) {
                let searched = batch.par_chunks(TURN).map(|pixels| {
                    let (mut still_open, mut places) = (Vec::new(), Vec::new());
                    let mut sites = Vec::new();
                    for mut pixel in pixels.iter().copied() {
                        // A pixel that is not due has no candidate now, and may have one after an insertion.
                        if !pixel.is_due || self.find(&mut pixel, &mut sites, &mut places) {
                            still_open.push(pixel);
                        }
                    }
                    (still_open, places)
                });

                let (still_open, candidates): (Vec<_>, Vec<_>) = searched.unzip();
                open.append(&mut still_open.concat());
                let uncovered = candidates
                    .iter()
                    .flatten()
                    .filter(|place| place.is_uncovered);
                found.extend(uncovered.map(|place| place.at));
                meter.ask()?;
            }

            pixels = open;
            if found.is_empty() {
                break;
            }

            self.flags.clear(flag::CHANGED);
            // A cell is marked if it holds the lowest point of a pixel whose centre is no farther than `gathered` from
            // the insertion. The lowest point is less than the pixel's side, at most an eighth of a cell, from the
            // centre.
            let radius = self.grid.radius();
            let reach = gathered(radius) + radius.side() / 8;
            // The flags suffice, without a list of the cells marked.
            let unlisted = |_| ();
            for at in self.insert(key.derive(Stream::Iteration, iteration), &found) {
                self.flags
                    .set_near(&self.grid, at, reach, flag::CHANGED, unlisted);
            }

            // A candidate that was not inserted is covered by one that was, so that only pixels near an insertion can have a
            // candidate in the next iteration. The cells of pixels that see an insertion from no farther than `gathered` are
            // marked; pixels that see farther are searched in any case. The others stay open: a sample of a later iteration
            // may come near them and make a candidate there.
            let marked_to = f64::from(gathered(self.grid.radius()));
            for pixel in &mut pixels {
                let cell = self.grid.layout().cell_at(pixel.min);
                pixel.is_due = self.flags.has(cell, flag::CHANGED) || pixel.sight > marked_to;
            }
        }

        Ok(())
    }

    /// Returns those pixels of dirty cells that no single sample covers whole. Cells along the frame's edges, in which
    /// nothing can be known, are left out.
    fn open_pixels(&self, meter: &mut Meter<'_>) -> Result<Vec<GapPixel>, SampleError> {
        // A tiled sample beyond the frame may have been lost, and have covered places up to R inside its edges: nothing can be
        // known there.
        let inside = self.frame.inside(self.grid.radius().units);

        let mut pixels = Vec::new();
        for batch in self.dirty.chunks(SHIFT) {
            let open = batch.par_chunks(TURN).map(|cells| {
                let mut around = Gathered::default();
                for &cell in cells {
                    let rect = self.grid.layout().cell_rect(cell as usize);
                    let (min, max) = (rect.min, rect.max);
                    let meets_across = min.x < inside.max.x && inside.min.x < max.x;
                    let meets_up = min.y < inside.max.y && inside.min.y < max.y;
                    if meets_across && meets_up {
                        self.open_cell(&rect, &mut around);
                    }
                }
                around.pixels
            });

            pixels.append(&mut open.collect::<Vec<_>>().concat());
            meter.ask()?;
        }

        Ok(pixels)
    }

    /// Gathers the samples near a cell, and divides the cell into pixels to find the open ones.
    fn open_cell(&self, cell: &Rect, around: &mut Gathered) {
        let radius = self.grid.radius();
        let side = radius.side();
        around.across.clear();
        around.up.clear();

        // The samples that may cover a place of the cell, as offsets from its lowest corner. The search is around the
        // middle, from which it has to reach half a side farther.
        let middle = Point::new(cell.min.x + side / 2, cell.min.y + side / 2);
        self.grid
            .any_near(middle, gathered(radius) + side / 2, |offset| {
                around.across.push((offset.x + side / 2) as f32);
                around.up.push((offset.y + side / 2) as f32);
                false
            });

        self.divide(cell, Point::default(), side, around);
    }

    /// Divides a square at `corner`, an offset in a cell, until one sample covers a part or it is small, and adds the small
    /// ones as pixels.
    fn divide(&self, cell: &Rect, corner: Point, side: i32, around: &mut Gathered) {
        let radius = self.grid.radius();
        let min = Point::new(cell.min.x + corner.x, cell.min.y + corner.y);
        // Cells at the upper edges are cut off by the frame.
        if min.x >= cell.max.x || min.y >= cell.max.y {
            return;
        }

        let middle = (side - 1) as f32 / 2.0;
        // A sample no farther than this from the square's centre covers all of it. Four units less outweigh the rounding of
        // squares below 2^44 to 24 bits.
        let limit = radius.units as f32 - middle * std::f32::consts::SQRT_2 - 4.0;

        let (x, y) = (corner.x as f32 + middle, corner.y as f32 + middle);
        let square = |(&across, &up): (&f32, &f32)| {
            let (across, up) = (across - x, up - y);
            across * across + up * up
        };

        let squares = around.across.iter().zip(&around.up).map(square);
        // A comparison, since the compiler does not vectorize `f32::min`.
        let nearest = squares.fold(f32::INFINITY, |a, b| if b < a { b } else { a });

        // One sample covers the whole square. Squared, a negative limit would look like a distance.
        if limit > 0.0 && nearest <= limit * limit {
            return;
        }

        let halvings = if self.frame.ends_inside() {
            MORE_HALVINGS
        } else {
            HALVINGS
        };

        if side > radius.side() >> halvings {
            let half = side / 2;
            for (right, up) in [(0, 0), (half, 0), (0, half), (half, half)] {
                let corner = Point::new(corner.x + right, corner.y + up);
                self.divide(cell, corner, half, around);
            }
            return;
        }

        let mut pixel = GapPixel {
            min,
            side,
            sight: f64::INFINITY,
            is_due: true,
        };

        // Samples farther from the centre than this are no sites of a candidate in the pixel (see the head). Four units are
        // added for the rounding of squares.
        let sight = nearest.sqrt() + pixel.site_slack() as f32 + 4.0;
        if sight < gathered(radius) as f32 {
            pixel.sight = sight.into();
            let squares = around.across.iter().zip(&around.up).map(square);
            // A candidate has three sites or lies on a border. Otherwise there is nothing to find in the pixel until a sample
            // is inserted nearby.
            let sites = squares.filter(|&square| square <= sight * sight).count();
            pixel.is_due = sites >= 3 || self.frame.border.meets(&pixel.rect());
        } else {
            // Its sites may lie beyond the samples gathered around the cell: `look` asks the grid, and sets the sight.
            self.look(&mut pixel, &mut Vec::new());
        }

        around.pixels.push(pixel);
    }

    /// Takes out the pixels in which something unknown may happen, and makes unknowns of them.
    fn doubt_pixels(&mut self, pixels: &mut Vec<GapPixel>) {
        let radius = self.grid.radius();
        let farthest = self.frame.sight(radius);

        // A pixel that becomes unknown may be in sight of pixels that were known so far.
        loop {
            let before = pixels.len();
            pixels.retain(|pixel| {
                let middle = (pixel.side - 1) / 2;
                let centre = Point::new(pixel.min.x + middle, pixel.min.y + middle);

                // Nothing is looked up beyond the farthest sight: a pixel that sees farther counts as unknown.
                let is_far = pixel.sight > f64::from(farthest);
                // The lattice point is up to half a unit off the pixel's centre on either axis: two units more make up for
                // it, and for the fraction that is cut off.
                let sight = pixel.sight.min(f64::from(farthest)) as i32 + 2;

                // The circle of sight must not meet the strip of width R along the edges.
                let deep = self.frame.inside(sight + radius.units);
                // Only the cells around unknowns have this flag, so that few pixels look for them.
                let doubtful = self
                    .flags
                    .has(self.grid.layout().cell_at(pixel.min), flag::DOUBTFUL);

                let is_known = deep.contains(centre)
                    && !is_far
                    && !(doubtful && self.touches_unknown(centre, sight));

                if !is_known {
                    // The disk holds the whole pixel, with the same two units more.
                    self.doubt(UnknownDisk {
                        at: centre,
                        radius: pixel.half_diagonal() as i32 + 2,
                    });
                }

                is_known
            });

            if pixels.len() == before {
                break;
            }
        }
    }

    /// Gathers the samples that decide about a pixel in `sites`, as offsets from its lowest point, and sets the pixel's
    /// sight. Returns whether the pixel is open.
    fn look(&self, pixel: &mut GapPixel, sites: &mut Vec<IVec2>) -> bool {
        let radius = self.grid.radius();
        let (centre, half) = (pixel.middle(), pixel.half_diagonal());
        let square = |site: &IVec2| (site.as_dvec2() - centre).length_squared();
        // The grid is asked about lattice points: this one is up to half a unit off the centre.
        let offset_of_asked = pixel.side / 2;
        let asked = Point::new(pixel.min.x + offset_of_asked, pixel.min.y + offset_of_asked);

        // This reaches far enough for nearly all pixels, whose nearest sample is about R away.
        let mut reach = radius.units + radius.units / 2;
        let limit = loop {
            sites.clear();
            self.grid.any_near(asked, reach, |offset| {
                sites.push(offset + offset_of_asked);
                false
            });

            let squares = sites.iter().map(square);
            let nearest = squares.fold(f64::INFINITY, f64::min).sqrt();
            let limit = nearest + 2.0 * half + PIXEL_SLACK;

            // All samples within the limit were found, as the asked place is less than a unit off.
            if limit < f64::from(reach) - 1.0 {
                break limit;
            }
            // No candidate is farther than 5 R from its sites (see `may_hold` in [`super::candidates`]): all that were
            // found are sites, and the pixel's sight has no end, which `doubt_pixels` takes as unknown.
            if reach > 5 * radius.units {
                break f64::INFINITY;
            }

            reach *= 2;
        };

        pixel.sight = limit;
        sites.retain(|site| square(site) <= limit * limit);

        // The pixel is open unless one sample covers it: unless d + h <= R - 2, with two units for rounding (the head defines d
        // and h).
        limit - half - PIXEL_SLACK > f64::from(radius.units) - 2.0
    }

    /// Appends the places of a pixel to `found`, and returns whether the pixel is open. `sites` is a buffer.
    pub(super) fn find(
        &self,
        pixel: &mut GapPixel,
        sites: &mut Vec<IVec2>,
        found: &mut Vec<GapPlace>,
    ) -> bool {
        let is_open = self.look(pixel, sites);
        if is_open {
            self.find_among(pixel, sites, found);
        }
        is_open
    }

    /// Appends the places that `sites`, all that decide about a pixel, make in it.
    pub(super) fn find_among(&self, pixel: &GapPixel, sites: &[IVec2], found: &mut Vec<GapPlace>) {
        let places = Candidates {
            region: self,
            pixel,
            sites,
        };
        places.find(found);
    }

    /// Inserts candidates in the order of a draw, and returns those inserted; one that a sample covers is passed over.
    pub(super) fn insert(&mut self, key: Key, found: &[Point]) -> Vec<Point> {
        let ranked = |&p: &Point| {
            // A rank is drawn for the place in the domain, so that every frame draws the same.
            let place = self.frame.in_domain(p);
            (key.draw_at(place.x, place.y)[0], place.row_major(), p)
        };

        let mut candidates: Vec<_> = found.iter().map(ranked).collect();
        candidates.sort_unstable_by_key(|(rank, place, _)| (*rank, *place));

        // A place that several triples made is inserted once: then its sample covers it.
        let mut inserted = Vec::new();
        for (_, _, at) in candidates {
            if !self.grid.covers(at) {
                // An inserted sample is not one of a block's pattern, and may be in conflict with samples of the
                // pattern.
                let foreign = true;
                self.keep(at, foreign);
                inserted.push(at);
            }
        }
        inserted
    }
}

#[cfg(test)]
mod tests;
