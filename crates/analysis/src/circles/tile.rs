//! Some cells of the region with those around them, as coordinates in one frame: copies across the seams lie beyond them.
//! It lists neighbours and scans pairs. It decides conflicts, exactly, and leaves coverage to [`super::cell`].

use std::ops::Range;

use glam::DVec2;

use super::samples::{Cells, Sample, Samples};
use super::table::{FULL, Mask, PER_RADIUS, Table, opposite};
use super::{Declined, Found};
use crate::witness::Conflict;

/// Neighbours noted before they are looked at; runs of samples are cut to so many.
const NOTED: usize = 64;

/// Most pairs of samples in one cell, per sample of a tile.
const MAX_CROWD: usize = 16;

/// A rectangle of cells, counted on across the seams.
#[derive(Clone, Debug)]
pub(super) struct Rectangle {
    pub columns: Range<i64>,
    pub rows: Range<i64>,
}

/// The samples of a rectangle of cells and of the cells around it. One is filled again and again.
#[derive(Debug, Default)]
pub(super) struct Tile {
    /// Cells with the halo.
    size: [usize; 2],
    /// The cells without it, counted from the lowest of the halo.
    own: [Range<usize>; 2],
    /// The first sample of each cell, row by row, and the end.
    starts: Vec<u32>,
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    /// Which of [`Samples::all`] it is, maybe as a copy.
    pub source: Vec<u32>,
    /// What the samples around it cover of each circle.
    masks: Vec<Mask>,
    noted: Vec<Noted>,
}

/// A neighbour of a sample.
#[derive(Clone, Copy, Debug, Default)]
struct Noted {
    index: u32,
    offset: DVec2,
    square: f64,
}

/// Why a tile could not be filled.
pub(super) enum Unfilled {
    /// Rows are wanted that are not held.
    Rows,
    Declined(Declined),
}

impl Tile {
    /// Fills the tile with the samples of a rectangle and of `halo` cells around it.
    pub fn fill(
        &mut self,
        samples: &Samples,
        rectangle: &Rectangle,
        halo: [usize; 2],
    ) -> Result<(), Unfilled> {
        let cells = &samples.cells;
        let axes = [&rectangle.columns, &rectangle.rows];
        let spans = [0, 1].map(|axis| {
            let (range, halo) = (axes[axis], halo[axis] as i64);
            let span = range.start - halo..range.end + halo;
            if cells.domain.periodic {
                span
            } else {
                span.start.max(0)..span.end.min(cells.counts[axis] as i64)
            }
        });
        for axis in [0, 1] {
            let (own, span) = (axes[axis], &spans[axis]);
            self.size[axis] = (span.end - span.start) as usize;
            self.own[axis] = (own.start - span.start) as usize..(own.end - span.start) as usize;
        }
        let [columns, rows] = spans;
        if !rows.clone().all(|row| samples.holds(row)) {
            return Err(Unfilled::Rows);
        }
        let runs = runs(cells, &columns);
        self.count(samples, &rows, &runs)?;
        self.place(samples, &rows, &runs);
        Ok(())
    }

    fn count(&mut self, samples: &Samples, rows: &Range<i64>, runs: &[Run]) -> Result<(), Unfilled> {
        let width = self.size[0];
        self.starts.clear();
        self.starts.resize(width * self.size[1] + 2, 0);
        for (line, row) in rows.clone().enumerate() {
            for run in runs {
                let counts = &mut self.starts[line * width + run.at + 2..];
                let first = run.columns.start;
                samples.visit(row, run.columns.clone(), |_, column| counts[column - first] += 1);
            }
        }
        let (mut total, mut crowd) = (0, 0);
        for start in &mut self.starts[2..] {
            crowd += *start as usize * *start as usize;
            total += *start;
            *start = total;
        }
        if crowd > MAX_CROWD * (256 + total as usize) {
            return Err(Unfilled::Declined(Declined::Crowded));
        }
        let total = total as usize;
        self.x.resize(total, 0.0);
        self.y.resize(total, 0.0);
        self.source.resize(total, 0);
        Ok(())
    }

    fn place(&mut self, samples: &Samples, rows: &Range<i64>, runs: &[Run]) {
        let cells = &samples.cells;
        let width = self.size[0];
        for (line, row) in rows.clone().enumerate() {
            let up = row.div_euclid(cells.counts[1] as i64) as f64 * cells.domain.extent.y;
            for run in runs {
                // Each start moves on to that of the next cell.
                let starts = &mut self.starts[line * width + run.at + 1..];
                let first = run.columns.start;
                samples.visit(row, run.columns.clone(), |index, column| {
                    let position = samples.all[index as usize].position;
                    let at = &mut starts[column - first];
                    self.x[*at as usize] = position.x + run.shift;
                    self.y[*at as usize] = position.y + up;
                    self.source[*at as usize] = index;
                    *at += 1;
                });
            }
        }
        self.starts.pop();
    }

    /// The samples of the tile's own cells, without copies, as indices.
    pub fn own(&self) -> impl Iterator<Item = (usize, [usize; 2])> + use<'_> {
        let [columns, rows] = self.own.clone();
        rows.flat_map(move |row| columns.clone().map(move |column| [column, row]))
            .flat_map(|[column, row]| self.cell(column..column + 1, row).map(move |index| (index, [column, row])))
    }

    pub fn is_proven(&self, index: usize) -> bool {
        self.masks[index] == FULL
    }

    pub fn position(&self, index: usize) -> DVec2 {
        DVec2::new(self.x[index], self.y[index])
    }

    /// The samples of some cells of a row.
    fn cell(&self, columns: Range<usize>, row: usize) -> Range<usize> {
        let line = row * self.size[0];
        self.starts[line + columns.start] as usize..self.starts[line + columns.end] as usize
    }

    /// Calls `each` with every other sample of the cells around a sample's, and its offset.
    pub fn around(
        &self,
        index: usize,
        [column, row]: [usize; 2],
        reach: [usize; 2],
        mut each: impl FnMut(usize, DVec2),
    ) {
        let columns = column.saturating_sub(reach[0])..(column + reach[0] + 1).min(self.size[0]);
        let rows = row.saturating_sub(reach[1])..(row + reach[1] + 1).min(self.size[1]);
        let position = self.position(index);
        for row in rows {
            for other in self.cell(columns.clone(), row) {
                if other != index {
                    each(other, self.position(other) - position);
                }
            }
        }
    }

    /// Scans all pairs of neighbours once: marks in both circles what the other disk of radius `rho` covers, and counts the
    /// conflicts of the tile's own samples.
    ///
    /// A pair belongs to the tile of whichever sample comes first in the sequence of rows and columns, counted on across the
    /// seams, so it is counted in one tile.
    pub fn scan(&mut self, samples: &Samples, rho: f64, radius: f64, found: &mut Found) {
        let table = Table::get();
        let reach = samples.cells.reach;
        let [width, height] = self.size;
        let per_unit = PER_RADIUS / rho;
        let widest = 4.0 * rho * rho;
        let mut masks = std::mem::take(&mut self.masks);
        let mut noted = std::mem::take(&mut self.noted);
        masks.clear();
        masks.resize(self.x.len(), 0);
        noted.resize(NOTED + 1, Noted::default());
        for row in 0..self.own[1].end {
            for column in 0..width {
                let cell = self.cell(column..column + 1, row);
                if cell.is_empty() {
                    continue;
                }
                let is_own = self.own[1].contains(&row) && self.own[0].contains(&column);
                let ahead = (column + reach[0] + 1).min(width);
                let columns = column.saturating_sub(reach[0])..ahead;
                let same_row = self.cell(column..ahead, row).end;
                let above = row + 1..(row + reach[1] + 1).min(height);
                for index in cell {
                    let position = self.position(index);
                    let mut mask = masks[index];
                    let lines = above.clone().map(|row| self.cell(columns.clone(), row));
                    for run in std::iter::once(index + 1..same_row).chain(lines) {
                        for start in run.clone().step_by(NOTED) {
                            let part = start..run.end.min(start + NOTED);
                            let others = [&self.x[part.clone()], &self.y[part]];
                            let count = note(&mut noted, position, others, start, widest);
                            for neighbour in &noted[..count] {
                                let other = neighbour.index as usize;
                                if is_own && neighbour.square <= found.nearby {
                                    self.pair(samples, [index, other], radius, found);
                                }
                                let offset = neighbour.offset * per_unit;
                                let covered = table.mask(offset.x, offset.y);
                                mask |= covered;
                                masks[other] |= opposite(covered);
                            }
                        }
                    }
                    masks[index] = mask;
                }
            }
        }
        self.masks = masks;
        self.noted = noted;
    }

    /// Looks closely at a pair: its distance is that of the samples, the shorter way around a torus, whatever copies are near.
    #[cold]
    fn pair(&self, samples: &Samples, pair: [usize; 2], radius: f64, found: &mut Found) {
        let [one, other] = pair.map(|index| samples.all[self.source[index] as usize]);
        if one.id == other.id {
            return;
        }
        let periods = samples.cells.domain.periods();
        let copies = (0..2).all(|axis| {
            let between = other.position[axis] - one.position[axis];
            let shown = self.position(pair[1])[axis] - self.position(pair[0])[axis];
            let shortest = if 2.0 * between.abs() > periods[axis] {
                -between.signum()
            } else {
                0.0
            };
            periods[axis].is_infinite() || ((shown - between) / periods[axis]).round() == shortest
        });
        if copies {
            found.add_pair(one, other, distance(one, other, periods), radius);
        }
    }
}

/// Notes the samples within reach of a position; returns their number.
#[inline]
fn note(
    noted: &mut [Noted],
    from: DVec2,
    [x, y]: [&[f64]; 2],
    first: usize,
    widest: f64,
) -> usize {
    let mut count = 0;
    for (index, (&x, &y)) in x.iter().zip(y).enumerate() {
        let offset = DVec2::new(x, y) - from;
        let square = offset.length_squared();
        // Written in any case and kept by moving on: a branch would be predicted badly.
        noted[count] = Noted {
            index: (first + index) as u32,
            offset,
            square,
        };
        count += usize::from(square < widest);
    }
    count
}

/// The distance of two samples, the shorter way around a torus. The long way is summed so that its rounding is
/// relative to the offset and not to the period.
pub(super) fn distance(one: Sample, other: Sample, periods: DVec2) -> f64 {
    let along = |axis: usize| {
        let (a, b) = (one.position[axis], other.position[axis]);
        let (low, high) = (a.min(b), a.max(b));
        let direct = high - low;
        if 2.0 * direct > periods[axis] {
            (periods[axis] - high) + low
        } else {
            direct
        }
    };
    let (x, y) = (along(0), along(1));
    let square = x * x + y * y;
    // Squares of less lose digits.
    if square > 1e-280 { square.sqrt() } else { x.hypot(y) }
}

/// Columns of a tile that lie side by side in the region.
struct Run {
    /// The columns in the region.
    columns: Range<usize>,
    /// The first of them in the tile.
    at: usize,
    /// How far the samples are moved.
    shift: f64,
}

fn runs(cells: &Cells, columns: &Range<i64>) -> Vec<Run> {
    let count = cells.counts[0] as i64;
    let mut runs = Vec::new();
    let mut next = columns.start;
    while next < columns.end {
        let (period, first) = (next.div_euclid(count), next.rem_euclid(count));
        let end = columns.end.min(next - first + count);
        runs.push(Run {
            columns: first as usize..(first + end - next) as usize,
            at: (next - columns.start) as usize,
            shift: period as f64 * cells.domain.extent.x,
        });
        next = end;
    }
    runs
}

impl Found {
    /// Counts a pair of samples.
    fn add_pair(&mut self, one: Sample, other: Sample, distance: f64, radius: f64) {
        if distance < radius {
            self.conflicts += 1;
            self.worst_conflicts.push(Conflict {
                first: one.id.min(other.id) as usize,
                second: one.id.max(other.id) as usize,
                distance,
            });
        }
        if distance < self.min_distance {
            self.min_distance = distance;
            let limit = distance.max(radius);
            self.nearby = limit * limit * (1.0 + 1e-9);
        }
    }
}
