//! The search for exposed circles: tiles of a set on all threads, and the cells that reach into holes. The order of the
//! proofs is here; each proof has a module of its own.
//!
//! A circle around a sample is exposed where no other sample's disk covers it. A hole is a place so far from all samples
//! that the Voronoi cells at it reach beyond the grid cells that a tile sees.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec2;
use rayon::prelude::*;

use super::arcs::{self, Arc};
use super::cell::CellCutter;
use super::found::{Declined, Found, Judged, Question};
use super::gaps::Gaps;
use super::sample::Sample;
use super::samples::{Cells, Samples};
use super::table;
use super::tile::{self, Rectangle, Tile, Unfilled};
use crate::border::BorderLine;
use crate::monitor::Monitor;

/// Columns and rows of a tile without its halo: its samples then fit the second-level cache.
const TILE: [usize; 2] = [256, 32];

/// Widths, in cells, of the surroundings in which the rim of a hole is searched before the judge declines. Chosen, not
/// measured.
const HALOS: [usize; 4] = [4, 12, 32, 64];

/// Most exposed circles, and most gaps; a set with more of one of them is far from maximal.
const MAX_EXPOSED: usize = 1 << 20;

/// Sets of this few samples are searched pair by pair when no two samples are near. No more cells than these are cut
/// out to find a radius to begin with.
const FEW: usize = 4096;

/// Judges a whole set. Returns the findings, or the reason for which this judge declines the set.
pub(crate) fn search(
    points: &[[f64; 2]],
    question: &Question,
    monitor: &Monitor<'_>,
) -> Judged<Found> {
    // Circles and disks have at most the limit as their radius. If cells have that size, the cells around the
    // cell of a sample hold all samples whose disks may meet its circle.
    let samples =
        Cells::new(question.domain, question.limit).and_then(|cells| Samples::new(cells, points));
    let samples = match samples {
        Ok(samples) => samples,
        Err(declined) => return Ok(Err(declined)),
    };

    let mut search = Search::new(question, &samples);
    let tiles = search.rectangles(0..samples.cells.counts[1] as i64);
    if let Err(declined) = search.begin(&tiles) {
        return Ok(Err(declined));
    }

    let found_in_tiles = match search.tiles(&tiles, monitor)? {
        Ok(found) => found,
        Err(declined) => return Ok(Err(declined)),
    };
    let found = search.holes(found_in_tiles, &HALOS, monitor)?;
    Ok(found.and_then(|found| search.finish(found, points.len())))
}

/// The search for exposed circles among the samples that are held.
pub(super) struct Search<'a> {
    question: &'a Question,
    samples: &'a Samples<'a>,
    /// The bits of the largest distance so far of a corner of a cell from its sample.
    farthest: AtomicU64,
    /// The radius of the first circles.
    pub least: f64,
}

/// The buffers of a thread.
#[derive(Default)]
pub(super) struct Scratch {
    pub tile: Tile,
    cutter: CellCutter,
    arcs: Vec<Arc>,
}

impl<'a> Search<'a> {
    fn new(question: &'a Question, samples: &'a Samples<'a>) -> Self {
        Self::resumed(question, samples, 0.0, 0.0)
    }

    /// Continues an earlier search with its largest distance and its first radius.
    pub fn resumed(
        question: &'a Question,
        samples: &'a Samples<'a>,
        farthest: f64,
        least: f64,
    ) -> Self {
        Self {
            question,
            samples,
            farthest: AtomicU64::new(farthest.to_bits()),
            least,
        }
    }

    pub fn farthest(&self) -> f64 {
        f64::from_bits(self.farthest.load(Ordering::Relaxed))
    }

    /// The radius of the circles: the largest that is known to be needed, up to the limit.
    fn rho(&self) -> f64 {
        self.farthest().min(self.question.limit)
    }

    fn note_farthest(&self, farthest: f64) {
        // Bits of numbers that are not negative sort as they do.
        self.farthest
            .fetch_max(farthest.to_bits(), Ordering::Relaxed);
    }

    /// Cuts rows into tiles.
    pub fn rectangles(&self, rows: std::ops::Range<i64>) -> Vec<Rectangle> {
        let columns = self.samples.cells.counts[0] as i64;
        let step = TILE.map(|side| side as i64);
        let mut all = Vec::new();

        for row in rows.clone().step_by(TILE[1]) {
            for column in (0..columns).step_by(TILE[0]) {
                all.push(Rectangle {
                    columns: column..columns.min(column + step[0]),
                    rows: row..rows.end.min(row + step[1]),
                });
            }
        }
        all
    }

    /// Judges all samples of some tiles.
    pub fn tiles(&self, tiles: &[Rectangle], monitor: &Monitor<'_>) -> Judged<Found> {
        let nothing = || Ok(Found::new(self.question.witnesses));
        tiles
            .par_iter()
            .map_init(Scratch::default, |scratch, rectangle| {
                let found = self.judge_tile(scratch, rectangle);
                let count: usize = scratch.tile.own().map(|run| run.len()).sum();
                monitor.advance(count as u64)?;
                Ok(found)
            })
            // One tile that is declined declines the set.
            .try_reduce(nothing, |left, right| {
                Ok(left.and_then(|left| Ok(left.merge(right?))))
            })
    }

    /// Cuts out cells until one gives the circles a radius to begin with, which must exceed half of the set's radius.
    /// The scan compares pairs up to twice the circles' radius apart, and so meets every pair closer than the set's
    /// radius.
    pub fn begin(&mut self, tiles: &[Rectangle]) -> Result<(), Declined> {
        let mut scratch = Scratch::default();
        let (reach, limit) = (self.samples.cells.reach, self.question.limit);
        let mut seen = 0;

        for rectangle in tiles {
            self.fill(&mut scratch.tile, rectangle, reach)?;
            for index in scratch.tile.own().flatten() {
                let cell = scratch
                    .cutter
                    .cut(self.samples, &scratch.tile, index, reach, limit);
                // A cell that is larger than its known surroundings reaches the limit at least.
                self.note_farthest(cell.map_or(limit, |cell| cell.farthest));
                self.least = self.rho();
                seen += 1;

                // A half, and a little for rounding.
                if self.least > 0.51 * self.question.radius {
                    return Ok(());
                }
                // If more than `FEW` cells end within half of the radius, and none beyond it, the samples are crowded.
                if seen > FEW {
                    return Err(Declined::Crowded);
                }
            }
        }
        // No cell of these tiles reaches half of the radius, so that the samples are crowded. (A stream passes the
        // tiles of its first band.)
        Err(Declined::Crowded)
    }

    /// Fills a tile. Rows that are needed but not held stand for a hole that is too wide.
    fn fill(
        &self,
        tile: &mut Tile,
        rectangle: &Rectangle,
        halo: [usize; 2],
    ) -> Result<(), Declined> {
        tile.fill(self.samples, rectangle, halo)
            .map_err(|unfilled| match unfilled {
                Unfilled::Declined(declined) => declined,
                Unfilled::Rows => Declined::Holes,
            })
    }

    /// Fills a tile and scans its pairs.
    pub fn scan(
        &self,
        scratch: &mut Scratch,
        rectangle: &Rectangle,
        found: &mut Found,
    ) -> Result<(), Declined> {
        let tile = &mut scratch.tile;
        self.fill(tile, rectangle, self.samples.cells.reach)?;
        tile.scan(self.samples, self.rho(), self.question.radius, found);
        Ok(())
    }

    /// The arcs of a circle that others and the outside of the region cover: the direction of the middle of each, and the cosine
    /// of its half.
    pub fn covering_arcs(&self, scratch: &mut Scratch, index: usize) -> Vec<(DVec2, f64)> {
        self.list_arcs(&scratch.tile, index, &mut scratch.arcs);
        let arcs = scratch
            .arcs
            .iter()
            .map(|arc| (arc.toward, arc.least / arc.toward.length()));
        // An arc whose line does not meet the circle covers no part of it.
        arcs.filter(|(_, cos)| *cos < 1.0).collect()
    }

    /// Returns the findings on a tile. Cells are cut out only for the circles that neither the scan nor the arcs prove covered.
    fn judge_tile(&self, scratch: &mut Scratch, rectangle: &Rectangle) -> Result<Found, Declined> {
        let mut found = Found::new(self.question.witnesses);
        self.scan(scratch, rectangle, &mut found)?;

        let Scratch { tile, cutter, arcs } = scratch;
        let (reach, limit) = (self.samples.cells.reach, self.question.limit);
        for index in tile.open() {
            if self.arcs_prove(tile, index, arcs) {
                continue;
            }
            match cutter.cut(self.samples, tile, index, reach, limit) {
                Some(cell) => {
                    self.note_farthest(cell.farthest);
                    found.gaps.add(cell);
                }
                // The sample's cell reaches beyond the grid cells around it, into a hole: it is cut out later, with more
                // grid cells.
                None => (found.exposed).push(self.samples.at(tile.source[index] as usize)),
            }
        }
        Ok(found)
    }

    /// Whether the ends of arcs prove a sample's circle covered.
    fn arcs_prove(&self, tile: &Tile, index: usize, arcs: &mut Vec<Arc>) -> bool {
        let rho = self.list_arcs(tile, index, arcs);
        let extent = self.question.domain.extent.max_element() / rho;
        // Far above the errors of directions, and of offsets across a seam; see the head of `circles`.
        let margin = 2f64.powi(-40) + 2f64.powi(-49) * extent;
        let two_cover = |stretch| arcs::two_cover(arcs, stretch, margin);
        table::open_stretches(tile.mask(index)).all(two_cover)
            || arcs::certainly_cover(arcs, margin)
    }

    /// Lists the arcs that may cover a sample's circle: those of the disks near it and of the sides of the region.
    /// Returns the circle's radius.
    fn list_arcs(&self, tile: &Tile, index: usize, arcs: &mut Vec<Arc>) -> f64 {
        let domain = &self.question.domain;
        let rho = self.rho();
        let per_rho = 1.0 / rho;

        arcs.clear();
        tile.around(index, self.samples.cells.reach, |_, offset| {
            let offset = offset * per_rho;
            arcs.push(Arc::of_disk(offset));
            // The disks of samples two radii apart or more do not meet. Their arcs are dropped without a branch, which would
            // be mispredicted for a third of the samples.
            let is_near = offset.length_squared() < 4.0;
            arcs.truncate(arcs.len() - usize::from(!is_near));
        });

        // Places beyond a side of the region need no cover. So the part of the circle beyond the side counts as
        // covered, as an arc whose middle lies straight toward the side.
        let of_border = |line: &BorderLine| Arc {
            toward: line.outward(),
            least: line.depth(tile.position(index), domain.extent) / rho,
        };
        arcs.extend(domain.border().iter().map(of_border));
        rho
    }

    /// Cuts out the cells that reach into holes, with wider and wider surroundings.
    pub fn holes(&self, mut found: Found, halos: &[usize], monitor: &Monitor<'_>) -> Judged<Found> {
        let mut exposed = std::mem::take(&mut found.exposed);
        if exposed.len() > MAX_EXPOSED {
            return Ok(Err(Declined::Holes));
        }

        for &around in halos {
            if exposed.is_empty() {
                break;
            }
            // These samples were counted with their tiles; the caller may still cancel here.
            monitor.advance(0)?;
            match self.holes_within(&mut found, exposed, around) {
                Ok(rest) => exposed = rest,
                Err(declined) => return Ok(Err(declined)),
            }
        }

        // A hole that the widest surroundings do not close has more samples on its rim than are worth a search here. A
        // set with more gaps than `MAX_EXPOSED` has too many holes.
        Ok(if exposed.is_empty() && found.gaps.len() <= MAX_EXPOSED {
            Ok(found)
        } else {
            Err(Declined::Holes)
        })
    }

    /// Cuts out the Voronoi cells of exposed samples, each by the samples within `around` rows of the grid and twice as many
    /// columns. Returns the samples whose Voronoi cells reach beyond these rows and columns.
    fn holes_within(
        &self,
        found: &mut Found,
        mut exposed: Vec<Sample>,
        around: usize,
    ) -> Result<Vec<Sample>, Declined> {
        let cells = &self.samples.cells;
        // Cells of the grid are twice as high as wide, so that twice as many columns reach as far. A radius above the
        // period needs a wider reach, which may exceed a narrow halo.
        let halo = [cells.reach[0].max(2 * around), cells.reach[1].max(around)];

        // Samples in one row, in the same block of `around` columns, share a tile.
        let group = |sample: &Sample| {
            let (column, row) = (
                cells.column(sample.position.x),
                cells.row(sample.position.y),
            );
            [row, column / around]
        };
        exposed.sort_unstable_by_key(|sample| (group(sample), sample.id));
        let groups: Vec<&[Sample]> = exposed.chunk_by(|a, b| group(a) == group(b)).collect();

        let looked: Vec<_> = groups
            .par_iter()
            .map_init(Scratch::default, |scratch, samples| {
                let [row, block] = group(&samples[0]);
                let columns = block * around..cells.counts[0].min((block + 1) * around);
                // All samples of a group are in one row.
                let rectangle = Rectangle {
                    columns: columns.start as i64..columns.end as i64,
                    rows: row as i64..row as i64 + 1,
                };
                self.fill(&mut scratch.tile, &rectangle, halo)?;
                Ok(self.cut_exposed(scratch, samples, halo))
            })
            .collect::<Result<_, _>>()?;

        let mut rest = Vec::new();
        for (gaps, left) in looked {
            found.gaps.merge(gaps);
            rest.extend(left);
        }
        Ok(rest)
    }

    /// Cuts out the cells of the exposed samples of a tile. Returns their gaps, and the samples whose cells reach farther than
    /// the halo.
    fn cut_exposed(
        &self,
        Scratch { tile, cutter, .. }: &mut Scratch,
        exposed: &[Sample],
        halo: [usize; 2],
    ) -> (Gaps, Vec<Sample>) {
        let (mut gaps, mut rest) = (Gaps::default(), Vec::new());
        for index in tile.own().flatten() {
            let sample = self.samples.at(tile.source[index] as usize);
            // Not all samples in the tile's own cells are exposed. `holes_within` sorted the exposed ones by id.
            if exposed
                .binary_search_by_key(&sample.id, |sample| sample.id)
                .is_err()
            {
                continue;
            }

            match cutter.cut(self.samples, tile, index, halo, self.question.limit) {
                Some(cell) => {
                    self.note_farthest(cell.farthest);
                    gaps.add(cell);
                }
                None => rest.push(sample),
            }
        }
        (gaps, rest)
    }

    /// Returns the findings on all `count` samples: completes the smallest distance and settles the gaps.
    pub fn finish(&self, mut found: Found, count: usize) -> Result<Found, Declined> {
        let Question {
            domain,
            radius,
            limit,
            ..
        } = *self.question;
        let samples = self.samples;

        // The scan notes all pairs up to twice the radius of the first circles. A smallest distance beyond that may not be the
        // true one.
        if found.min_distance > 2.0 * self.least {
            // All pairs of many samples would take too long. Of a stream, only some rows are still held.
            if count > FEW || count > samples.len() {
                return Err(Declined::Sparse);
            }
            for index in 0..samples.len() {
                for later in index + 1..samples.len() {
                    let [one, other] = [index, later].map(|rank| samples.at(rank));
                    let distance = tile::distance(one, other, domain.periods());
                    found.min_distance = found.min_distance.min(distance);
                }
            }
        }

        // The scan passes over pairs of a sample and its own copy. The nearest copy is the shorter period away.
        if domain.periodic {
            found.add_own_copies(count, domain.extent.min_element(), radius);
        }
        found.gaps.settle(&domain, domain.same_place(limit), limit);
        Ok(found)
    }
}
