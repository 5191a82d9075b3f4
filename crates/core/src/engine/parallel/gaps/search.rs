//! The search of one pixel for candidates made by the samples that are about as near to it as the nearest one.

use fearless_simd::Simd;
use glam::{DVec2, I64Vec2};

use crate::circumcentre::circumcentre;
use crate::lattice::{Point, R, R_SQUARED, Rect};

use super::super::frame::CELL_BITS;
use super::super::region::{MAX_REACH, Region};
use super::super::stamp::PIXEL_SIDE;
use super::candidate::MadePlace;
use super::pixel::{PlacedPixel, centre, each_bit};
use super::{GapBuffers, Rules, corner};

/// Which samples are detectors.
#[derive(Clone, Copy)]
pub(super) enum Detectors {
    /// Those near lost samples.
    First,
    /// Those inserted in the iteration before.
    Inserted,
}

/// A pixel under search.
#[derive(Clone, Copy)]
pub(super) struct SearchedPixel {
    pub cell: usize,
    pub number: u8,
    pub detectors: Detectors,
    /// Whether the samples of the wider surroundings are used.
    pub wide: bool,
    /// How many of the listed sites are those of this pixel.
    pub site_count: usize,
}

impl<const TAGS: bool> Region<TAGS> {
    /// Searches one pixel and adds its candidates to `gaps.candidates`; cells that depend on the plane beyond the frame
    /// are added to `unsure`. `gaps.near` holds the samples around `cell`, and `pixel.sites` has the bits of those
    /// among them that may make a candidate.
    #[inline(always)]
    pub(super) fn search_pixel<S: Simd>(
        &self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        PlacedPixel { cell, pixel }: PlacedPixel,
        detectors: Detectors,
        unsure: &mut Vec<usize>,
    ) {
        let mut site_count = 0;
        for k in each_bit(pixel.sites) {
            gaps.sites[site_count] = k;
            site_count += 1;
        }

        let searched = SearchedPixel {
            cell,
            number: pixel.number,
            detectors,
            wide: false,
            site_count,
        };
        self.search_sites(simd, gaps, rules, searched, unsure);
    }

    /// Searches a pixel whose sites may lie outside the gathered cells: it is measured again, with cells farther away.
    #[cold]
    pub(super) fn search_wide<S: Simd>(
        &self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        PlacedPixel { cell, pixel }: PlacedPixel,
        detectors: Detectors,
        unsure: &mut Vec<usize>,
    ) {
        let (x, y) = centre(pixel.number);
        gaps.wide
            .gather(&self.slots, self.frame.stride(), cell, MAX_REACH);
        let site_count = gaps.wide.list_sites(simd, x, y, &mut gaps.sites);
        let searched = SearchedPixel {
            cell,
            number: pixel.number,
            detectors,
            wide: true,
            site_count,
        };
        self.search_sites(simd, gaps, rules, searched, unsure);
    }

    /// Tries all candidates that the sites may make in the pixel.
    #[inline(always)]
    fn search_sites<S: Simd>(
        &self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        searched: SearchedPixel,
        unsure: &mut Vec<usize>,
    ) {
        let count = searched.site_count;
        let offset = |gaps: &GapBuffers, k: usize| {
            if searched.wide {
                gaps.wide.offset(gaps.sites[k])
            } else {
                gaps.near.offset(gaps.sites[k])
            }
        };

        for i in 0..count {
            for m in i + 1..count {
                for k in m + 1..count {
                    let three = [offset(gaps, i), offset(gaps, m), offset(gaps, k)];
                    // A filter in floats: integers compute the centres of the triples that pass it.
                    if may_make(three, searched.number) {
                        let sites = three.map(DVec2::as_i64vec2);
                        let [a, b, c] = sites;
                        if let Some(from_a) = circumcentre(b - a, c - a) {
                            let made = MadePlace {
                                place: from_a + a,
                                sites: &sites,
                            };
                            self.try_place(simd, gaps, rules, searched, made, unsure);
                        }
                    }
                }
            }
        }

        // The border makes candidates too, in the pixels through which it runs.
        if !rules.domain.is_periodic() && self.frame.border.meets(&self.pixel_rect(searched)) {
            self.search_border(simd, gaps, rules, searched, unsure);
        }
    }

    /// Returns the places of a pixel in the frame.
    fn pixel_rect(&self, searched: SearchedPixel) -> Rect {
        let (column, row) = self.frame.column_row(searched.cell);
        let (x, y) = corner(searched.number);
        let min = Point::new((column << CELL_BITS) + x, (row << CELL_BITS) + y);
        Rect {
            min,
            max: Point::new(min.x + PIXEL_SIDE, min.y + PIXEL_SIDE),
        }
    }

    /// Tries the candidates on the lines of a closed border that run through the pixel.
    #[cold]
    fn search_border<S: Simd>(
        &self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        searched: SearchedPixel,
        unsure: &mut Vec<usize>,
    ) {
        // Only the lines through this pixel: the search of another pixel tries the places there.
        let through = self.frame.border.through(&self.pixel_rect(searched));

        // Places are offsets from the cell's lowest point, as the sites are.
        let (column, row) = self.frame.column_row(searched.cell);
        let cell = Point::new(column << CELL_BITS, row << CELL_BITS);
        let border = through.seen_from(cell.into());

        let gathered = if searched.wide {
            &gaps.wide
        } else {
            &gaps.near
        };
        let sites: Vec<I64Vec2> = gaps.sites[..searched.site_count]
            .iter()
            .map(|&k| gathered.offset(k).as_i64vec2())
            .collect();

        for (k, &a) in sites.iter().enumerate() {
            for (place, other) in border.places(a, &sites[k + 1..], |m| *m) {
                // A place on a line is as far from `a` as from another site; a corner of the domain is seen from `a`
                // alone.
                let made_by = match other {
                    Some(&m) => &[a, m][..],
                    None => &[a],
                };
                let made = MadePlace {
                    place,
                    sites: made_by,
                };
                self.try_place(simd, gaps, rules, searched, made, unsure);
            }
        }
    }

    /// Returns the domain's point of a site of a cell.
    pub(super) fn site_point(&self, cell: usize, site: I64Vec2) -> Point {
        let (column, row) = self.frame.column_row(cell);
        self.frame.point(
            (column << CELL_BITS) + site.x as i32,
            (row << CELL_BITS) + site.y as i32,
        )
    }
}

/// Returns whether the centre of three sites may, rounded, be an uncovered place of the pixel. With sides above
/// R and a circumradius below 3.5 R, `d` is above R^2 / 3.5, so that the few units by which the largest
/// products round in f64 move the centre by far less than the two units, and 8 R of squared distance, allowed.
#[inline(always)]
fn may_make([a, b, c]: [DVec2; 3], pixel: u8) -> bool {
    let (b, c) = (b - a, c - a);
    let d = 2.0 * b.perp_dot(c);
    // `place` is the offset of the circumcentre from a, times d: without a division.
    let place = (c.length_squared() * b - b.length_squared() * c).perp();
    let (x, y) = centre(pixel);
    let off = (place - (DVec2::new(x.into(), y.into()) - a) * d).abs();
    let half = f64::from(PIXEL_SIDE / 2 + 2) * d.abs();
    let least = (R_SQUARED - 8 * i64::from(R)) as f64;
    off.x <= half && off.y <= half && place.length_squared() > least * d * d
}
