//! The second judge of a stream: bands of rows are judged as soon as they are complete, and only the rows that later
//! ones need are kept. The first rows of a torus are kept to the end and judged with the last ones; the very first
//! stays open for latecomers. No circle is skipped: a set with a hole too wide for the kept rows is refused.

use std::mem;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::found::{Declined, Found, Question};
use super::sample::Sample;
use super::samples::{Cells, Given, Samples};
use super::search::Search;
use crate::error::VerifyError;
use crate::monitor::Monitor;

/// Rows kept below a band, and complete above an exposed circle before it is judged: the halo for holes.
const KEPT: usize = 8;

/// Widths, in cells, of the surroundings in which the rim of a hole is searched.
const HALOS: [usize; 2] = [4, KEPT];

/// Least rows of a band: with fewer, the overlaps are costly.
const MIN_ROWS: usize = 16;

/// Samples of a stream, as they came.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Held {
    /// In the caller's unit.
    points: Vec<[f64; 2]>,
    /// Indices in the stream.
    ids: Vec<u32>,
}

impl Held {
    fn push(&mut self, point: [f64; 2], id: u32) {
        self.points.push(point);
        self.ids.push(id);
    }

    fn append(&mut self, mut other: Self) {
        self.points.append(&mut other.points);
        self.ids.append(&mut other.ids);
    }

    fn given(&self) -> Given<'_> {
        Given {
            points: &self.points,
            ids: Some(&self.ids),
        }
    }

    fn retain(&mut self, mut is_wanted: impl FnMut([f64; 2], u32) -> bool) {
        let mut kept = 0;
        for index in 0..self.points.len() {
            let (point, id) = (self.points[index], self.ids[index]);
            if is_wanted(point, id) {
                (self.points[kept], self.ids[kept]) = (point, id);
                kept += 1;
            }
        }
        self.points.truncate(kept);
        self.ids.truncate(kept);
    }
}

/// The samples held of a stream, and the findings so far.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct CircleBands {
    /// Samples of the rows from `keep` on, as they came, and latecomers of the first row.
    held: Held,
    /// Samples of the first rows of a torus, once they are below `keep`.
    seam: Held,
    /// Rows below it are no longer in `held`.
    keep: usize,
    /// Rows below it are judged, but for the first ones of a torus.
    closed: usize,
    found: Found,
    /// The largest distance of a cell's corner so far, and the radius of the first circles.
    farthest: f64,
    least: f64,
}

impl CircleBands {
    pub fn new(witnesses: usize) -> Self {
        Self {
            held: Held::default(),
            seam: Held::default(),
            keep: 0,
            closed: 0,
            found: Found::new(witnesses),
            farthest: 0.0,
            least: 0.0,
        }
    }

    /// Adds samples, the first of which has the index `first`.
    pub fn add(&mut self, points: &[[f64; 2]], first: u32) {
        self.held.points.extend_from_slice(points);
        self.held.ids.extend(first..first + points.len() as u32);
    }

    /// Samples held.
    pub fn len(&self) -> usize {
        self.held.points.len() + self.seam.points.len()
    }

    /// All samples, if no row was judged.
    pub fn take_unjudged(&mut self) -> Option<Vec<[f64; 2]>> {
        (self.closed == 0).then(|| mem::take(&mut self.held).points)
    }

    /// Whether a region is so high that its rows are worth being judged in bands.
    pub fn streams(question: &Question) -> bool {
        let cells = Cells::new(question.domain, question.limit);
        cells.is_ok_and(|cells| cells.counts[1] >= 8 * KEPT && cells.reach[1] == 1)
    }

    /// Judges the rows below the ordinate `complete`, under which no sample can follow, if there are enough of them.
    pub fn judge_complete(
        &mut self,
        question: &Question,
        complete: f64,
        monitor: &Monitor<'_>,
    ) -> Result<(), VerifyError> {
        let cells = cells(question)?;
        let complete = cells.row(complete.max(0.0));
        let rows = self.closed.max(first(&cells))..complete.saturating_sub(1);
        if rows.len() < MIN_ROWS {
            return Ok(());
        }
        let held = mem::take(&mut self.held);
        let samples = Samples::new(cells, self.keep, complete - self.keep, held.given());
        let count = held.points.len();
        let samples = samples.map_err(|declined| refused(declined, question, count))?;
        self.judge(question, &samples, rows.clone(), monitor)?;
        // Circles that reach into holes wait for the rows that their cells may need.
        let ready = |row: usize| row + KEPT < complete && (!cells.domain.periodic || row > KEPT);
        self.holes(question, &samples, ready, monitor)?;
        self.held = held;
        self.closed = rows.end;
        let pending = self
            .found
            .exposed
            .iter()
            .map(|sample| cells.row(sample.position.y));
        let pending = pending.filter(|&row| !cells.domain.periodic || row > KEPT);
        let wanted = pending.fold(self.closed, usize::min).saturating_sub(KEPT);
        self.drop_below(&cells, wanted);
        Ok(())
    }

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
        if self.least == 0.0 {
            search.begin(&tiles).map_err(refuse)?;
        }
        let found = search.tiles(&tiles, monitor)?.map_err(refuse)?;
        (self.farthest, self.least) = (search.farthest(), search.least);
        let before = mem::replace(&mut self.found, Found::new(question.witnesses));
        self.found = before.merge(found);
        Ok(())
    }

    /// Cuts out the exposed cells of rows that are ready.
    fn holes(
        &mut self,
        question: &Question,
        samples: &Samples<'_>,
        ready: impl Fn(usize) -> bool,
        monitor: &Monitor<'_>,
    ) -> Result<(), VerifyError> {
        let is_ready = |sample: &Sample| ready(samples.cells.row(sample.position.y));
        let (exposed, later) = mem::take(&mut self.found.exposed)
            .into_iter()
            .partition(is_ready);
        self.found.exposed = exposed;
        let search = Search::resumed(question, samples, self.farthest, self.least);
        let before = mem::replace(&mut self.found, Found::new(question.witnesses));
        let found = search.holes(before, &HALOS, monitor)?;
        self.found = found.map_err(|declined| refused(declined, question, samples.len()))?;
        self.farthest = search.farthest();
        self.found.exposed = later;
        Ok(())
    }

    /// Drops the rows below `keep`, but for the first ones of a torus.
    fn drop_below(&mut self, cells: &Cells, keep: usize) {
        let keep = keep.max(self.keep);
        let (seam, periodic) = (&mut self.seam, cells.domain.periodic);
        let seam_rows = seam_rows(cells);
        self.held.retain(|point, id| {
            let row = cells.row(cells.domain.scale_point(point).y);
            if row < keep && row < seam_rows && periodic {
                seam.push(point, id);
            }
            row >= keep
        });
        self.keep = keep;
    }

    /// Judges the remaining rows, those at the seam of a torus included.
    pub fn finish(
        mut self,
        question: &Question,
        count: usize,
        monitor: &Monitor<'_>,
    ) -> Result<Found, VerifyError> {
        let cells = cells(question)?;
        let all = cells.counts[1];
        let seam = if cells.domain.periodic {
            seam_rows(&cells)
        } else {
            0
        };
        let (keep, held) = if all - self.keep + seam < all {
            (self.keep, all - self.keep + seam)
        } else {
            (0, all)
        };
        let mut left = mem::take(&mut self.held);
        left.append(mem::take(&mut self.seam));
        let samples = Samples::new(cells, keep, held, left.given());
        let samples = samples.map_err(|declined| refused(declined, question, count))?;
        self.judge(
            question,
            &samples,
            self.closed.max(first(&cells))..all,
            monitor,
        )?;
        if cells.domain.periodic {
            self.judge(question, &samples, 0..first(&cells), monitor)?;
        }
        self.holes(question, &samples, |_| true, monitor)?;
        let search = Search::resumed(question, &samples, self.farthest, self.least);
        let finished = search.finish(self.found, count);
        finished.map_err(|declined| refused(declined, question, count))
    }
}

fn cells(question: &Question) -> Result<Cells, VerifyError> {
    let cells = Cells::new(question.domain, question.limit);
    cells.map_err(|declined| refused(declined, question, 0))
}

/// The first row that need not wait for the end: those of a torus below it see the last rows or the open first one.
fn first(cells: &Cells) -> usize {
    if cells.domain.periodic {
        1 + cells.reach[1]
    } else {
        0
    }
}

/// Rows kept from the start of a torus: those of circles judged at the end, and those their cells may need.
fn seam_rows(cells: &Cells) -> usize {
    (first(cells) + KEPT).max(KEPT + 1) + KEPT
}

/// Returns the error for a stream that the judge declines.
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
