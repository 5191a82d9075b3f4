//! Candidates: applies the definition of `stages::detect` to a place, and inserts candidates in order.
//!
//! A cell is searched by its 8 x 8 *pixels*. Places and sites are offsets from the lowest point of the cell. *Lost* samples
//! were tiled and are not among the survivors. *Unknown* ones depend on the plane beyond the frame. A cell is *unsure* if it
//! may hold an unknown sample, and *hot* if one may yet be inserted in it or beside it.

use fearless_simd::Simd;
use glam::{I64Vec2, IVec2};

use crate::lattice::{Point, R_SQUARED};
use crate::random::Stream;
use crate::stages::detect::{DETECTOR_REACH, NEARER_SLACK, Reach};

use super::super::frame::{CELL_BITS, PAD};
use super::super::region::{Loss, LostSample, Region, flag, pack};
use super::super::stamp::PIXEL_SIDE;
use super::search::{Detectors, SearchedPixel};
use super::{GapBuffers, Inserted, Rules, corner, inserted_tag};

/// A candidate, compared by the order of insertion.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct RankedCandidate {
    rank: u32,
    /// Its position in the domain, y first.
    row_major: (i32, i32),
    /// Its position in the frame.
    x: i32,
    y: i32,
}

/// An answer that may depend on the plane beyond the frame.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Known {
    Yes,
    No,
    Unknown,
}

/// A place that may be a candidate, with the samples that make it.
#[derive(Clone, Copy)]
pub(super) struct MadePlace<'a> {
    pub place: I64Vec2,
    pub sites: &'a [I64Vec2],
}

impl<const TAGS: bool> Region<TAGS> {
    /// Adds a place, which the samples `sites` make, to the candidates if it lies in the pixel and satisfies the
    /// definition. Where that depends on the plane beyond the frame, adds the cell to `unsure`.
    pub(super) fn try_place<S: Simd>(
        &self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        searched: SearchedPixel,
        MadePlace { place, sites }: MadePlace<'_>,
        unsure: &mut Vec<usize>,
    ) {
        let (left, bottom) = corner(searched.number);
        let is_in_pixel =
            |v: i64, low: i32| (0..i64::from(PIXEL_SIDE)).contains(&(v - i64::from(low)));
        // A place in another pixel is found when that one is searched.
        if !is_in_pixel(place.x, left) || !is_in_pixel(place.y, bottom) {
            return;
        }

        let (column, row) = self.frame.column_row(searched.cell);
        let x = (column << CELL_BITS) + place.x as i32;
        let y = (row << CELL_BITS) + place.y as i32;
        // The last pixels of a bounded domain reach beyond its border.
        if !self.frame.holds(x, y) {
            return;
        }

        // The definition asks that no sample covers the place, and that no sample is nearer to it than the nearest
        // site. The place was rounded to the lattice, so that squared distances may differ by up to the slack.
        let square = |site: &I64Vec2| site.distance_squared(place);
        // A place has at least one site.
        let nearest_square = sites.iter().map(square).min().unwrap_or(0);
        // A sample covers the place if its squared distance is at most R^2. Squared distances are whole numbers: this
        // means below R^2 + 1. One search below the larger of the two limits answers both questions.
        let limit = (nearest_square - NEARER_SLACK).max(R_SQUARED + 1);

        // A pixel whose sites may lie beyond the usual cells was searched with the samples of more cells.
        let gathered = if searched.wide {
            &gaps.wide
        } else {
            &gaps.near
        };
        // The search is compiled for the instructions of `simd`, whichever this function is compiled for.
        if simd.vectorize(
            #[inline(always)]
            || gathered.any_nearer(simd, place, limit),
        ) {
            return;
        }

        match self.is_found(gaps, rules, searched, place, sites) {
            Known::No => {}
            Known::Unknown => unsure.push(searched.cell),
            Known::Yes => {
                let point = self.frame.point(x, y);
                gaps.candidates.push(RankedCandidate {
                    // Ranks are drawn when all candidates are found (`insert_candidates`).
                    rank: 0,
                    row_major: point.row_major(),
                    x,
                    y,
                });
            }
        }
    }

    /// Returns whether one of the sites is a detector that finds the place.
    fn is_found(
        &self,
        gaps: &GapBuffers,
        rules: &Rules,
        searched: SearchedPixel,
        place: I64Vec2,
        sites: &[I64Vec2],
    ) -> Known {
        let mut known = Known::No;
        for site in sites {
            // The position of a detector matters only near closed borders.
            let point = if self.frame.periodic {
                Point::default()
            } else {
                self.site_point(searched.cell, *site)
            };

            let reach = Reach::new(&rules.domain, rules.search, point);
            let within = |other: I64Vec2, distance: i32| {
                site.distance_squared(other) <= i64::from(distance) * i64::from(distance)
            };

            // By definition a detector finds places within its radius, made by samples within its search radius
            // (paper, Algorithm 4, line 17).
            if !within(place, reach.radius)
                || !sites.iter().all(|other| within(*other, reach.search))
            {
                continue;
            }

            match self.is_detector(gaps, searched, *site) {
                Known::Yes => return Known::Yes,
                Known::Unknown => known = Known::Unknown,
                Known::No => {}
            }
        }

        known
    }

    /// Returns whether a site is a detector of this detection.
    fn is_detector(&self, gaps: &GapBuffers, searched: SearchedPixel, site: I64Vec2) -> Known {
        let (column, row) = self.frame.column_row(searched.cell);
        let x = (column << CELL_BITS) + site.x as i32;
        let y = (row << CELL_BITS) + site.y as i32;
        match searched.detectors {
            Detectors::First => self.is_first_detector(searched.cell, x, y),
            Detectors::Inserted => {
                // Only certain samples are inserted, so that the answer is certain, too.
                let key = site_key(self.frame.cell_at(x, y), pack(x, y));
                match gaps.detectors.binary_search(&key) {
                    Ok(_) => Known::Yes,
                    Err(_) => Known::No,
                }
            }
        }
    }

    /// Returns whether a lost sample is within [`DETECTOR_REACH`] of (x, y), a site of a place in `cell`.
    fn is_first_detector(&self, cell: usize, x: i32, y: i32) -> Known {
        let limit = i64::from(DETECTOR_REACH) * i64::from(DETECTOR_REACH);
        let reaches = |lost: &LostSample| {
            let offset = IVec2::new(lost.x - x, lost.y - y);
            offset.as_i64vec2().length_squared() <= limit
        };

        // The lost sample that covered the place is nearly always near enough to the site, too. It lies in one of the nine
        // cells around the place, which are looked at first.
        let stride = self.frame.stride();
        let middles = [cell, cell - stride, cell + stride].into_iter();
        let mut around = middles.flat_map(|middle| [middle, middle - 1, middle + 1]);
        let proves = |lost: &LostSample| lost.loss == Loss::Certain && reaches(lost);
        if around.any(|c| self.lost_in(c).any(proves)) {
            return Known::Yes;
        }

        let (column, row) = (x >> CELL_BITS, y >> CELL_BITS);
        let [columns, rows] = self.frame.cells;
        let [[left, right], [bottom, top]] = self.frame.goes_on;

        // `DETECTOR_REACH`, 2 r and 4 units, ends at most three cells away.
        let reach = 3;
        let mut known = Known::No;
        // Near the frame's edge a lost sample may lie beyond it.
        if left && column < reach
            || right && column >= columns - reach
            || bottom && row < reach
            || top && row >= rows - reach
        {
            known = Known::Unknown;
        }

        // Dropped samples lie in the padding.
        for row in (row - reach).max(-PAD)..=(row + reach).min(rows + PAD - 1) {
            for column in (column - reach).max(-PAD)..=(column + reach).min(columns + PAD - 1) {
                for lost in self.lost_in(self.frame.cell(column, row)) {
                    if reaches(lost) {
                        if lost.loss == Loss::Certain {
                            return Known::Yes;
                        }
                        known = Known::Unknown;
                    }
                }
            }
        }
        known
    }

    /// Inserts the candidates that no sample covers, in the order of a draw for their places.
    #[inline(always)]
    pub(super) fn insert_candidates<S: Simd>(
        &mut self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        iteration: u32,
    ) {
        let key = rules.key.derive(Stream::Iteration, iteration);
        for candidate in &mut gaps.candidates {
            let (y, x) = candidate.row_major;
            [candidate.rank, _] = key.draw_at(x, y);
        }

        // Several triples of samples may make one place, which is one candidate.
        gaps.candidates.sort_unstable();
        gaps.candidates.dedup();

        for k in 0..gaps.candidates.len() {
            let RankedCandidate { x, y, .. } = gaps.candidates[k];
            // Every candidate was uncovered when it was found, but a sample inserted before this one may cover it.
            if self.covered(simd, x, y) {
                continue;
            }
            let cell = self.frame.cell_at(x, y);
            // An unknown sample in this cell or beside it may be inserted before the candidate, and cover it. The
            // candidate's fate is then unknown, too.
            if self.flags[cell] & flag::HOT != 0 {
                self.make_hot(cell);
                continue;
            }

            self.insert(x, y, inserted_tag(iteration));
            gaps.inserted.push(Inserted { x, y, iteration });
        }
    }
}

/// Returns the key of a sample: its cell and its slot.
pub(super) fn site_key(cell: usize, packed: u32) -> u64 {
    (cell as u64) << 32 | u64::from(packed)
}
