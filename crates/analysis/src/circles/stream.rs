//! The second judge of a stream: bands of rows are judged as soon as they are complete, and only the rows that later
//! ones need are kept. The first rows of a torus are kept to the end and judged with the last ones; the very first
//! stays open for latecomers. No circle is skipped: a set with a hole too wide for the kept rows is refused. What
//! circles, exposed samples and holes are, [`super::search`] says.

use std::mem;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::found::{Declined, Found, Question};
use super::rows::{Held, SortedRows};
use super::sample::Sample;
use super::samples::{Cells, Samples};
use super::search::Search;
use crate::error::VerifyError;
use crate::monitor::Monitor;

/// Rows kept below a band, and complete above an exposed circle before it is judged: the halo for holes. Chosen, not
/// measured.
const KEPT: usize = 8;

/// Widths, in cells, of the surroundings in which the rim of a hole is searched.
const HALOS: [usize; 2] = [4, KEPT];

/// Least rows of a band: with fewer, the halos of tiles are costly.
const MIN_ROWS: usize = 16;

/// New samples after which those of complete rows are sorted: so few that they are still in the second-level cache.
const UNSORTED: usize = 1 << 15;

/// The samples held of a stream, and the findings so far.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct CircleBands {
    /// Samples that are not yet sorted, as they came.
    open: Held,
    /// How many samples `open` holds when it is sorted next.
    sort_at: usize,
    /// The complete rows that are still needed.
    rows: SortedRows,
    /// The first row of a torus, which stays open to the end. Samples of the first judge's lowest row may come late; it is
    /// lower than this one.
    lowest: Held,
    /// The rows above it that its seam needs, once they are no longer in `rows`.
    seam: SortedRows,
    /// Rows below it are judged, but for the first ones of a torus.
    closed: usize,
    found: Found,
    /// The largest distance of a cell's corner from its sample so far.
    farthest: f64,
    /// The radius of the circles at the beginning; they grow with `farthest`. 0 before the first band is judged.
    least: f64,
}

impl CircleBands {
    pub fn new(question: &Question) -> Self {
        let first = usize::from(question.domain.periodic);
        Self {
            open: Held::default(),
            sort_at: UNSORTED,
            rows: SortedRows::new(first),
            lowest: Held::default(),
            seam: SortedRows::new(first),
            closed: 0,
            found: Found::new(question.witnesses),
            farthest: 0.0,
            least: 0.0,
        }
    }

    /// Adds samples, the first of which has the index `first`. No later sample lies below the ordinate `complete`,
    /// except in the lowest row of a torus.
    pub fn add(
        &mut self,
        question: &Question,
        points: &[[f64; 2]],
        first: u32,
        complete: f64,
    ) -> Result<(), VerifyError> {
        self.open.add(points, first);
        if self.open.len() >= self.sort_at {
            let cells = cells_of(question)?;
            // `complete` is some radii lower than the highest sample, so that it is below 0 at first. A sparse set is
            // not refused here, but where its rows are judged.
            let _ = self.sort(&cells, cells.row(complete.max(0.0)));
        }
        Ok(())
    }

    /// Sorts the samples of the rows below `complete`. Declines rows with far more cells than samples.
    fn sort(&mut self, cells: &Cells, complete: usize) -> Result<(), Declined> {
        let end = complete.max(self.rows.end(cells));
        let dense = cells.check_count(end - self.rows.first, self.len());
        if dense.is_ok() {
            self.rows.take(&mut self.open, &mut self.lowest, cells, end);
        }
        // So that each sample is looked at a few times only, even if a row holds many times `UNSORTED`.
        self.sort_at = 2 * self.open.len() + UNSORTED;
        dense
    }

    /// The number of samples held, sorted or not.
    pub fn len(&self) -> usize {
        self.open.len() + self.rows.len() + self.lowest.len() + self.seam.len()
    }

    /// Returns all samples in the order in which they came; none once a row was judged.
    pub fn unjudged(&self) -> Option<Vec<[f64; 2]>> {
        if self.closed > 0 {
            return None;
        }

        let mut all = vec![[0.0; 2]; self.len()];
        // No row was dropped yet, so that none went to the seam.
        let parts = [
            (&self.open.points, &self.open.ids),
            (&self.rows.points, &self.rows.ids),
            (&self.lowest.points, &self.lowest.ids),
        ];
        for (points, ids) in parts {
            for (&point, &id) in points.iter().zip(ids) {
                // Ids are places in the stream, so that nothing is sorted.
                all[id as usize] = point;
            }
        }
        Some(all)
    }

    /// Whether a region is so high that its rows are worth being judged in bands: it has many times the rows that are
    /// kept (eight times; chosen, not measured), and circles reach no farther than the next row.
    pub fn streams(question: &Question) -> bool {
        let cells = Cells::new(question.domain, question.limit);
        cells.is_ok_and(|cells| cells.counts[1] >= 8 * KEPT && cells.reach[1] == 1)
    }

    /// Judges the rows below the ordinate `complete`, without the highest of them, if they are enough for a band. No
    /// sample can follow below `complete`, except in the lowest row of a torus.
    pub fn judge_complete(
        &mut self,
        question: &Question,
        complete: f64,
        monitor: &Monitor<'_>,
    ) -> Result<(), VerifyError> {
        let cells = cells_of(question)?;
        // Samples may still come in this row and the rows above it. At first `complete` is below 0, as in `add`.
        let open_row = cells.row(complete.max(0.0));
        // The row below it is left for later, too, as its circles reach into the open one.
        let rows = self.closed.max(first_in_turn(&cells))..open_row.saturating_sub(1);
        if rows.len() < MIN_ROWS {
            return Ok(());
        }

        self.sort(&cells, open_row)
            .map_err(|declined| refused(declined, question, self.len()))?;
        // The rows are taken out and put back below, since `judge` borrows all of this while `samples` borrow the rows.
        let held = mem::replace(&mut self.rows, SortedRows::new(0));
        let samples = Samples::of_rows(cells, &held);
        self.judge(question, &samples, rows.clone(), monitor)?;

        // Exposed samples, whose circles reach into holes, wait until all rows are complete from which their Voronoi cells may be
        // cut. For those near the lower border of a torus, these are the last rows.
        let ready = |row: usize| row + KEPT < open_row && (!cells.domain.periodic || row > KEPT);
        self.holes(question, &samples, ready, monitor)?;
        self.rows = held;
        self.closed = rows.end;

        // Rows around circles that still wait are kept. Near the lower border of a torus, `seam` keeps them.
        let exposed = self.found.exposed.iter();
        let pending = exposed
            .map(|sample| cells.row(sample.position.y))
            .filter(|&row| !cells.domain.periodic || row > KEPT);
        let wanted = pending.fold(self.closed, usize::min).saturating_sub(KEPT);
        self.drop_below(&cells, wanted);
        Ok(())
    }

    /// Judges some rows of the samples held, and adds their findings to those so far.
    fn judge(
        &mut self,
        question: &Question,
        samples: &Samples<'_>,
        rows: Range<usize>,
        monitor: &Monitor<'_>,
    ) -> Result<(), VerifyError> {
        if rows.is_empty() {
            return Ok(());
        }
        let mut search = Search::resumed(question, samples, self.farthest, self.least);
        let tiles = search.rectangles(rows.start as i64..rows.end as i64);
        let refuse = |declined| refused(declined, question, samples.len());
        // The first band gives the circles a radius to begin with.
        if self.least == 0.0 {
            search.begin(&tiles).map_err(refuse)?;
        }
        let found = search.tiles(&tiles, monitor)?.map_err(refuse)?;

        (self.farthest, self.least) = (search.farthest(), search.least);
        let before = mem::replace(&mut self.found, Found::new(question.witnesses));
        self.found = before.merge(found);
        Ok(())
    }

    /// Cuts out the Voronoi cells of exposed samples in rows that are ready.
    fn holes(
        &mut self,
        question: &Question,
        samples: &Samples<'_>,
        ready: impl Fn(usize) -> bool,
        monitor: &Monitor<'_>,
    ) -> Result<(), VerifyError> {
        let is_ready = |sample: &Sample| ready(samples.cells.row(sample.position.y));
        // Samples that wait for later rows are set aside during the search, and put back after it.
        let (exposed, later) = mem::take(&mut self.found.exposed)
            .into_iter()
            .partition(is_ready);
        self.found.exposed = exposed;

        let search = Search::resumed(question, samples, self.farthest, self.least);
        let before = mem::replace(&mut self.found, Found::new(question.witnesses));
        let found = search.holes(before, &HALOS, monitor)?;
        self.found = found.map_err(|declined| refused(declined, question, samples.len()))?;

        self.farthest = search.farthest();
        // The search has taken all samples that were ready out of `exposed`, or has declined.
        self.found.exposed = later;
        Ok(())
    }

    /// Drops the rows below `keep`, but for the first ones of a torus.
    fn drop_below(&mut self, cells: &Cells, keep: usize) {
        let dropped = keep.saturating_sub(self.rows.first);
        if cells.domain.periodic {
            let needed = seam_rows(cells).saturating_sub(self.rows.first);
            self.seam.append(&self.rows, dropped.min(needed), cells);
        }
        self.rows.drop_first(dropped, cells);
    }

    /// Judges the remaining rows, those at the seam of a torus included, and returns the findings on all `count` samples.
    pub fn finish(
        mut self,
        question: &Question,
        count: usize,
        monitor: &Monitor<'_>,
    ) -> Result<Found, VerifyError> {
        let cells = cells_of(question)?;
        let all = cells.counts[1];
        let refuse = |declined| refused(declined, question, count);
        self.sort(&cells, all).map_err(refuse)?;

        // The rows go on across the seam: after the last one come the first ones, which were kept for that.
        let mut held = mem::replace(&mut self.rows, SortedRows::new(0));
        if cells.domain.periodic {
            // Only now is row 0 complete: its samples could come until the end of the stream.
            let mut lowest = SortedRows::new(0);
            // All of these samples are in row 0, so that none is set aside as late.
            lowest.take(&mut self.lowest, &mut Held::default(), &cells, 1);
            for rows in [&lowest, &self.seam] {
                held.append(rows, rows.count(&cells), &cells);
            }
        }
        assert_eq!(self.open.len() + self.lowest.len(), 0, "all are sorted");

        let samples = Samples::of_rows(cells, &held);
        self.judge(
            question,
            &samples,
            self.closed.max(first_in_turn(&cells))..all,
            monitor,
        )?;
        if cells.domain.periodic {
            // The first rows of a torus come last: only now the rows below them, across the seam, are held.
            self.judge(question, &samples, 0..first_in_turn(&cells), monitor)?;
        }
        let all_are_ready = |_: usize| true;
        self.holes(question, &samples, all_are_ready, monitor)?;

        let search = Search::resumed(question, &samples, self.farthest, self.least);
        let finished = search.finish(self.found, count);
        finished.map_err(refuse)
    }
}

fn cells_of(question: &Question) -> Result<Cells, VerifyError> {
    let cells = Cells::new(question.domain, question.limit);
    cells.map_err(|declined| refused(declined, question, 0))
}

/// The first row that need not wait for the end: those of a torus below it see the last rows or the open first one.
fn first_in_turn(cells: &Cells) -> usize {
    if cells.domain.periodic {
        1 + cells.reach[1]
    } else {
        0
    }
}

/// Rows kept from the start of a torus: those of circles judged at the end, which are the first ones and, beside a
/// hole, those up to row `KEPT`; and `KEPT` rows above these, which their cells may need.
fn seam_rows(cells: &Cells) -> usize {
    (first_in_turn(cells) + KEPT).max(KEPT + 1) + KEPT
}

/// Returns the error for a stream that the judge declines. Neither the smallest distance nor the place of the hole is
/// passed on: infinity and the corner of the region stand for them.
fn refused(declined: Declined, question: &Question, samples: usize) -> VerifyError {
    let scale = question.domain.scale;
    match declined {
        Declined::Radius | Declined::Sparse => VerifyError::TooSparse {
            min_distance: f64::INFINITY,
            limit: 2.0 * question.limit / scale,
        },
        Declined::Crowded => VerifyError::Crowded { samples },
        Declined::Holes => VerifyError::HoleTooWide {
            corner: [0.0, 0.0],
            reach: 2.0 * KEPT as f64 * question.limit / scale,
        },
    }
}
