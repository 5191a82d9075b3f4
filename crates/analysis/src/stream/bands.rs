//! Bands of rows: which samples are held, when they are judged, and which of them are kept. All rows below `closed` are
//! judged but for the first ones of a torus and postponed tiles. A row is dropped only when no pair and no tile needs
//! it. Sets that would need more memory than allowed are refused.

use std::mem;
use std::ops::Range;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::circles::Question;
use crate::cover::{self, CoverSearch, Places, Visit};
use crate::domain::Domain;
use crate::error::VerifyError;
use crate::exact::covering_limit;
use crate::findings::Findings;
use crate::grid::{Entry, Grid, Rows, cell_at};
use crate::monitor::Monitor;
use crate::pairs::{self, Pairs};
use crate::region::Region;
use crate::verify::{VerifyOptions, of_delaunay};

use super::{PIECE, STREAM_LAG, StreamBand};

/// Sides of a cell in radii: as many samples per cell as the verifier in memory has in a maximal set.
const CELL: f64 = 1.3125;
/// Rows kept below a band. They show windows of up to ten radii, where two do for a maximal set.
const BELOW: usize = 8;
/// Rows above a band that must be complete before it is judged: those of the first windows.
const ABOVE: usize = 4;
/// Rows kept from the start of a torus: those judged at the end and those their windows show.
const SEAM: usize = 2 * BELOW;
/// Most cells held, four bytes each.
const MAX_CELLS: usize = 1 << 24;
/// Most gaps on sides of tiles, 40 bytes each. They are few but in made-up sets full of gaps.
const MAX_SHARED: usize = 1 << 20;

/// The question and the grid on which it is answered.
#[derive(Clone, Debug)]
pub(super) struct StreamSearch {
    pub region: Region,
    pub radius: f64,
    pub options: VerifyOptions,
    pub domain: Domain,
    /// The radius in the domain's unit.
    pub scaled_radius: f64,
    pub band: StreamBand,
    /// Whether all samples are held and judged at the end.
    pub whole: bool,
    /// Columns and rows of the whole region.
    cells: [usize; 2],
    /// Distance below which two places are the same.
    same: f64,
}

impl StreamSearch {
    /// Returns a search that has no rows yet.
    pub fn new(
        region: Region,
        radius: f64,
        options: VerifyOptions,
        domain: Domain,
        scaled_radius: f64,
    ) -> Self {
        let cells = domain.extent.to_array().map(|extent| {
            // An axis has at least one cell. The largest counts are not used: no set of that many cells is streamed.
            (extent / (CELL * scaled_radius)).clamp(1.0, 1e12) as usize
        });
        Self {
            region,
            radius,
            options,
            domain,
            scaled_radius,
            band: StreamBand::default(),
            whole: false,
            cells,
            same: domain.same_place(scaled_radius),
        }
    }

    /// Whether bands are possible; a region few cells wide or high, and one of too many cells
    /// in a row, is held as a whole. The fewest columns and rows were chosen, not measured.
    fn streams(&self) -> bool {
        let [columns, rows] = self.cells;
        let held = (self.band.rows + SEAM).saturating_mul(columns);
        !self.whole && columns >= 8 && rows >= 4 * SEAM && held <= MAX_CELLS
    }

    /// The row of an ordinate in the domain's unit; it does not fall when that rises.
    pub fn row(&self, y: f64) -> usize {
        cell_at(&self.domain, self.cells, DVec2::new(0.0, y))[1]
    }

    /// The first row whose tiles need not wait for the end: those of a torus see the last rows.
    fn first_tiles(&self) -> usize {
        if self.domain.periodic { BELOW } else { 0 }
    }

    /// The first row whose pairs need not wait for the end: that of a torus may still get samples.
    fn first_pairs(&self) -> usize {
        usize::from(self.domain.periodic)
    }

    /// The ordinate under which no sample can follow after one of ordinate `highest`, but for the lowest row of a torus.
    pub fn complete(&self, highest: f64) -> f64 {
        highest - STREAM_LAG * self.scaled_radius
    }

    /// The same question for the second judge.
    pub fn question(&self) -> Question {
        Question {
            domain: self.domain,
            radius: self.scaled_radius,
            limit: self.limit(),
            witnesses: self.options.witnesses,
        }
    }

    fn task<'a>(&self, grid: &'a Grid) -> CoverSearch<'a> {
        let witnesses = self.options.witnesses;
        CoverSearch::with_same(grid, self.scaled_radius, self.limit(), witnesses, self.same)
    }

    const fn limit(&self) -> f64 {
        covering_limit(self.options.covering_tolerance, self.scaled_radius)
    }
}

/// The samples held of the set, and the findings so far.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Bands {
    /// Samples of the rows from `keep` on, as they came, and latecomers of the first row.
    pub held: Vec<Entry>,
    /// Samples of the first rows of a torus, once they are below `keep`.
    pub seam: Vec<Entry>,
    /// Rows below it are no longer in `held`.
    pub keep: usize,
    /// In the rows below it pairs are compared and tiles judged.
    pub closed: usize,
    /// Samples held at which to look for a complete band.
    pub next: usize,
    /// Tiles that need later rows.
    pub postponed: Vec<Visit>,
    pub pairs: Pairs,
    pub places: Places,
}

impl Bands {
    pub fn new(search: &StreamSearch) -> Self {
        let witnesses = search.options.witnesses;
        Self {
            held: Vec::new(),
            seam: Vec::new(),
            keep: 0,
            closed: 0,
            next: 0,
            postponed: Vec::new(),
            pairs: Pairs::new(witnesses),
            places: Places::new(witnesses),
        }
    }

    pub fn add(&mut self, entry: Entry) {
        if self.held.len() == self.held.capacity() {
            // The buffer grows by a quarter, since doubling would take much more memory than needed.
            self.held.reserve_exact(PIECE + self.held.len() / 4);
        }
        self.held.push(entry);
    }

    /// Judges the rows that are complete now that ordinates have reached `highest`, if they make a band.
    pub fn judge_complete(
        &mut self,
        search: &StreamSearch,
        highest: f64,
        monitor: &Monitor<'_>,
    ) -> Result<(), VerifyError> {
        let most_samples = search.band.most_samples;
        let samples = self.held.len() + self.seam.len();

        if search.streams() {
            // All rows below `complete`, the row of the lowest ordinate that a sample may still have, have their
            // samples.
            let complete = search.row(search.complete(highest));
            let end = complete.saturating_sub(ABOVE);
            let begin = self.closed.max(search.first_tiles());

            // At the limit of samples, or at half of the limit of cells, a band of any height is judged, to free memory
            // before the next samples come. A band has one row at least, also where the caller asks for none.
            let is_tight =
                samples > most_samples || (complete - self.keep) * search.cells[0] > MAX_CELLS / 2;
            let least_rows = if is_tight { 1 } else { search.band.rows };
            let is_due = self.held.len() >= self.next.max(search.band.samples) || is_tight;
            if is_due && end >= begin + least_rows.max(1) {
                self.judge(search, begin..end, complete, monitor)?;
                self.next = self.held.len() + search.band.samples;
            }

            // The rows that are left now cannot be judged yet: their cells must fit.
            let cells = (complete - self.keep).saturating_mul(search.cells[0]);
            if cells > MAX_CELLS {
                return Err(self.too_large(search));
            }
        }

        if self.held.len() + self.seam.len() > most_samples {
            return Err(self.too_large(search));
        }
        Ok(())
    }

    /// Returns the error of a set for which more samples, cells or gaps on sides of tiles would have to be held than
    /// may be. Its two numbers are of samples in any case.
    fn too_large(&self, search: &StreamSearch) -> VerifyError {
        VerifyError::BandTooLarge {
            samples: self.held.len() + self.seam.len(),
            limit: search.band.most_samples,
        }
    }

    /// Judges the band `rows`, with the rows below `complete` that its tiles see, and drops the rows that no later band needs.
    fn judge(
        &mut self,
        search: &StreamSearch,
        rows: Range<usize>,
        complete: usize,
        monitor: &Monitor<'_>,
    ) -> Result<(), VerifyError> {
        // The lowest row of a torus stays open to the end.
        let first = self.keep.max(search.first_pairs());
        let count = complete - first;

        // The samples at the seam are needed at the end alone.
        let parts = [&self.held[..], &[]];
        let grid = Grid::of_rows(search.domain, search.cells, Rows { first, count }, parts);
        check_crowd(&grid)?;

        // Pairs of the first rows of a torus are scanned with the first band, though the tiles there wait for the end.
        let scanned = self.closed.max(search.first_pairs())..rows.end;
        self.scan(search, &grid, scanned, monitor)?;

        // Tiles that were postponed, as they wanted rows above, come first.
        let task = search.task(&grid);
        let mut visits = mem::take(&mut self.postponed);
        visits.extend(new_visits(&task, rows.clone(), search));
        for visit in self.visit(&task, visits, monitor)? {
            self.postpone(search, first, visit)?;
        }
        if self.places.shared() > MAX_SHARED {
            return Err(self.too_large(search));
        }

        self.closed = rows.end;
        self.drop_rows(search);
        Ok(())
    }

    /// Adds the pairs of some rows to those found so far.
    fn scan(
        &mut self,
        search: &StreamSearch,
        grid: &Grid,
        rows: Range<usize>,
        monitor: &Monitor<'_>,
    ) -> Result<(), VerifyError> {
        let witnesses = search.options.witnesses;
        let found = pairs::scan(grid, rows, search.scaled_radius, witnesses, monitor)?;
        self.pairs.merge(found);
        Ok(())
    }

    /// Judges tiles, and adds the places that are found to those so far. Returns the visits that need rows that are not
    /// held.
    fn visit(
        &mut self,
        task: &CoverSearch<'_>,
        visits: Vec<Visit>,
        monitor: &Monitor<'_>,
    ) -> Result<Vec<Visit>, VerifyError> {
        let (found, postponed) = cover::visit(task, visits, monitor)?;
        let places = mem::replace(&mut self.places, Places::new(task.witnesses));
        self.places = places.merge(found);
        Ok(postponed)
    }

    /// Postpones a tile until the rows that it needs are held; fails if some of them were dropped.
    fn postpone(
        &mut self,
        search: &StreamSearch,
        first: usize,
        visit: Visit,
    ) -> Result<(), VerifyError> {
        if visit.wants.start < first as i64 {
            return Err(too_wide(search, &visit));
        }
        self.postponed.push(visit);
        Ok(())
    }

    /// Drops the rows that are no longer needed.
    fn drop_rows(&mut self, search: &StreamSearch) {
        // No postponed tile wants rows below zero: `postpone` has refused it.
        let wanted = (self.postponed.iter())
            .map(|visit| visit.wants.start as usize)
            .fold(self.closed.saturating_sub(BELOW), usize::min);
        // Rows below `keep` are dropped already, so that it never falls.
        self.keep = self.keep.max(wanted);
        let (keep, seam) = (self.keep, &mut self.seam);

        self.held.retain(|entry| {
            let row = search.row(entry.position[1]);
            // The last rows of a torus will need its first ones.
            if row < keep && row < SEAM && search.domain.periodic {
                seam.push(*entry);
            }
            row >= keep
        });
    }

    /// All samples in the caller's unit, if no band was judged.
    pub fn take_unjudged(&mut self, search: &StreamSearch) -> Option<Vec<[f64; 2]>> {
        (self.closed == 0).then(|| {
            let scale = search.domain.scale;
            let held = mem::take(&mut self.held);
            let unscaled = |entry: Entry| (entry.position / scale).to_array();
            held.into_iter().map(unscaled).collect()
        })
    }

    /// Judges the remaining rows, those at the seam of a torus included, and returns all findings. At least one band
    /// was judged before: otherwise [`Self::take_unjudged`] has returned the samples.
    pub fn finish(
        &mut self,
        search: &StreamSearch,
        monitor: &Monitor<'_>,
    ) -> Result<Findings, VerifyError> {
        let all = search.cells[1];
        let periodic = search.domain.periodic;
        let count = all - self.keep + if periodic { SEAM } else { 0 };
        // If the remaining rows and those at the seam are all rows of a torus, or more, the grid holds each row once.
        let (first, count) = if count < all {
            (self.keep, count)
        } else {
            (0, all)
        };
        if count.saturating_mul(search.cells[0]) > MAX_CELLS {
            return Err(self.too_large(search));
        }

        let (held, seam) = (mem::take(&mut self.held), mem::take(&mut self.seam));
        let parts = [&held[..], &seam[..]];
        let grid = Grid::of_rows(search.domain, search.cells, Rows { first, count }, parts);
        // The grid has copied the samples, so that their memory can be given back.
        drop((held, seam));
        check_crowd(&grid)?;

        self.scan(search, &grid, self.closed..all, monitor)?;
        // The lowest row of a torus was open until now.
        self.scan(search, &grid, 0..search.first_pairs(), monitor)?;

        let task = search.task(&grid);
        let mut visits = mem::take(&mut self.postponed);
        visits.extend(new_visits(&task, self.closed..all, search));
        visits.extend(new_visits(&task, 0..search.first_tiles(), search));
        // A tile that needs still more rows has a hole too wide for the rows that are held.
        if let Some(visit) = self.visit(&task, visits, monitor)?.first() {
            return Err(too_wide(search, visit));
        }

        // Pairs farther apart than the certain distance may not all have been seen.
        let limit = pairs::certain_distance(&grid);
        if self.pairs.min_distance > limit {
            let scale = search.domain.scale;
            let (min_distance, limit) = (self.pairs.min_distance / scale, limit / scale);
            return Err(VerifyError::TooSparse {
                min_distance,
                limit,
            });
        }

        // The findings are taken out, and empty ones stay behind.
        let places = mem::replace(&mut self.places, Places::new(0));
        let pairs = mem::replace(&mut self.pairs, Pairs::new(0));
        let cover = places.finish(&search.domain, search.same);
        Ok(of_delaunay(pairs, cover))
    }
}

/// Refuses rows with too many pairs to compare.
fn check_crowd(grid: &Grid) -> Result<(), VerifyError> {
    if grid.is_crowded() {
        let samples = grid.entries().len();
        return Err(VerifyError::Crowded { samples });
    }
    Ok(())
}

/// Returns the first visits to the tiles of some rows.
fn new_visits(task: &CoverSearch<'_>, rows: Range<usize>, search: &StreamSearch) -> Vec<Visit> {
    if rows.is_empty() {
        return Vec::new();
    }
    let tiles = cover::split(task.grid, rows, search.options.tile_samples);
    let visits = tiles.into_iter().map(|tile| Visit::first(task, tile));
    visits.collect()
}

/// Returns the error of a tile that needs rows which were dropped or cannot be held.
fn too_wide(search: &StreamSearch, visit: &Visit) -> VerifyError {
    let scale = search.domain.scale;
    VerifyError::HoleTooWide {
        corner: (visit.tile.low / scale).to_array(),
        reach: visit.halo / scale,
    }
}
