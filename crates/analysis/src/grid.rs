//! A uniform grid over the region, or over some of its rows, with the samples sorted by cell: the one index of the
//! verifier. Cells of a row follow each other and each is sorted by x, so a row is, too. Samples are not copied across
//! the border; searches that need copies make them.

use std::ops::Range;

use glam::DVec2;
use rayon::prelude::*;

use serde::{Deserialize, Serialize};

use crate::domain::Domain;

/// A sample in the domain's unit with its index in the caller's set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Entry {
    pub position: DVec2,
    pub id: u32,
}

/// The samples of a region, or of some of its rows, sorted by cell.
pub(crate) struct Grid {
    pub domain: Domain,
    /// Cells along x and y, of the whole region.
    pub cells: [usize; 2],
    rows: Rows,
    /// Where each cell that is held begins in `entries`, row by row, and the end of the last one.
    starts: Vec<u32>,
    /// The samples, cell by cell; those of a cell by x, then y, then index.
    entries: Vec<Entry>,
}

/// The rows of cells that a grid holds: all, or a stretch that may go on across the upper seam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rows {
    pub first: usize,
    pub count: usize,
}

impl Rows {
    /// The index of a row of the region in the stretch; none if it is not held.
    fn index(self, row: usize, all: usize) -> Option<usize> {
        let index = if row >= self.first {
            row - self.first
        } else {
            row + all - self.first
        };
        (index < self.count).then_some(index)
    }
}

impl Grid {
    /// Mean square of the samples of a cell, weighed by samples, at which a set is crowded. It is 1 to 3 for maximal sets and
    /// noise.
    const CROWD: u64 = 64;

    /// Samples that 32-bit indices can name.
    pub const MAX_SAMPLES: usize = u32::MAX as usize;

    /// Sorts the samples, of which there must be one at least, into cells whose sides are at least `side` where the
    /// region is so large.
    ///
    /// There are at most about as many cells as samples, whatever the side.
    pub fn new(points: &[[f64; 2]], domain: Domain, side: f64) -> Self {
        let side = side.max(domain.spacing(points.len()));
        // Along a thin region the cap matters: there, cells of that side would outnumber the samples.
        let cells = (domain.extent / side)
            .to_array()
            .map(|cells| (cells as usize).clamp(1, points.len()));
        let rows = Rows {
            first: 0,
            count: cells[1],
        };
        let entry = |id: usize| Entry {
            position: domain.scale_point(points[id]),
            id: id as u32,
        };
        Self::filled(domain, cells, rows, points.len(), entry)
    }

    /// Sorts those samples of both parts that lie in `rows` of a region of `cells`; the others are
    /// not held.
    pub fn of_rows(
        domain: Domain,
        cells: [usize; 2],
        rows: Rows,
        [one, two]: [&[Entry]; 2],
    ) -> Self {
        let entry = |index: usize| match one.get(index) {
            Some(entry) => *entry,
            None => two[index - one.len()],
        };
        Self::filled(domain, cells, rows, one.len() + two.len(), entry)
    }

    /// Returns the grid that holds `rows`, filled by a counting sort over its cells. `entry` returns each of the `count`
    /// samples by its index; samples of other rows are left out.
    fn filled(
        domain: Domain,
        cells: [usize; 2],
        rows: Rows,
        count: usize,
        entry: impl Fn(usize) -> Entry + Sync,
    ) -> Self {
        // No cell has this number: only the grids of a stream leave samples out, and a stream holds 2^24 cells at most
        // (see `stream/bands.rs`).
        const NOT_HELD: u32 = u32::MAX;
        let cell_of = |index: usize| {
            let [column, row] = cell_at(&domain, cells, entry(index).position);
            (rows.index(row, cells[1])).map_or(NOT_HELD, |row| (row * cells[0] + column) as u32)
        };

        let keys: Vec<u32> = (0..count).into_par_iter().map(cell_of).collect();

        // Each cell's samples are counted one entry on, so that the sums are the starts of the cells.
        let mut starts = vec![0; cells[0] * rows.count + 1];
        for &key in keys.iter().filter(|&&key| key != NOT_HELD) {
            starts[key as usize + 1] += 1;
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }

        let mut entries = vec![Entry::default(); starts[starts.len() - 1] as usize];
        // Here `starts[c]` is where the next sample of cell c goes.
        for (index, &key) in keys.iter().enumerate().filter(|(_, key)| **key != NOT_HELD) {
            let cursor = &mut starts[key as usize];
            entries[*cursor as usize] = entry(index);
            *cursor += 1;
        }

        // While samples were placed, the start of each cell became its end, which is the start of the next cell.
        starts.pop();
        starts.insert(0, 0);

        // Samples of a cell are sorted by place, so that their order does not depend on the order in which they came.
        sort_cells(&starts, &mut entries);

        Self {
            domain,
            cells,
            rows,
            starts,
            entries,
        }
    }

    /// Bound of the rounding of a cell coordinate: two roundings of relative size 2^-53 on at most
    /// 2^32 cells, with room to spare.
    pub const ROUNDING: f64 = 1e-6;

    /// Sides of a cell.
    pub fn cell_sides(&self) -> DVec2 {
        self.domain.extent / DVec2::from(self.cells.map(|cells| cells as f64))
    }

    /// Number of cells held.
    pub fn cell_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether every row of the region is held, from the first on: cells held are then those of the region.
    pub fn is_whole(&self) -> bool {
        self.rows.first == 0 && self.rows.count == self.cells[1]
    }

    /// Whether a row of the region is held.
    pub fn holds(&self, row: usize) -> bool {
        self.rows.index(row, self.cells[1]).is_some()
    }

    /// The entries of the cells `columns` of one row.
    pub fn run(&self, row: usize, columns: &Range<usize>) -> &[Entry] {
        &self.entries[self.run_range(row, columns)]
    }

    /// Where [`Self::run`] lies in [`Self::entries`].
    ///
    /// # Panics
    ///
    /// If the row is not held, since it must not pass for an empty one.
    pub fn run_range(&self, row: usize, columns: &Range<usize>) -> Range<usize> {
        let index = self.rows.index(row, self.cells[1]);
        let first = index.expect("the row is held") * self.cells[0];
        let start = self.starts[first + columns.start] as usize;
        start..self.starts[first + columns.end] as usize
    }

    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Number of samples in a rectangle of cells.
    pub fn count(&self, columns: &Range<usize>, rows: &Range<usize>) -> usize {
        (rows.clone())
            .map(|row| self.run_range(row, columns).len())
            .sum()
    }

    /// Whether so many samples share cells that comparing all pairs of touching cells would take too long.
    pub fn is_crowded(&self) -> bool {
        let pairs = |bounds: &[u32]| u64::from(bounds[1] - bounds[0]).pow(2);
        let all: u64 = self.starts.windows(2).map(pairs).sum();
        all > Self::CROWD * self.entries.len() as u64
    }

    /// The largest number of samples of a cell among those of a rectangle.
    pub fn fullest(&self, columns: &Range<usize>, rows: &Range<usize>) -> usize {
        let cells = rows
            .clone()
            .flat_map(|row| columns.clone().map(move |column| (row, column)));
        cells
            .map(|(row, column)| self.run_range(row, &(column..column + 1)).len())
            .max()
            .unwrap_or(0)
    }
}

/// From this number of cells on two threads share them: enough to hide the scheduling.
const CELLS_TOGETHER: usize = 4096;

/// Sorts the entries within each cell, for cells that follow each other. `starts` has the bounds of these cells, counted over
/// the whole grid: the first of `entries` has the number `starts[0]`.
fn sort_cells(starts: &[u32], entries: &mut [Entry]) {
    // There is one bound more than cells.
    if starts.len() > CELLS_TOGETHER {
        // The middle bound is the end of the left half and the start of the right one.
        let middle = starts.len() / 2;
        let (left, right) = entries.split_at_mut((starts[middle] - starts[0]) as usize);
        rayon::join(
            || sort_cells(&starts[..=middle], left),
            || sort_cells(&starts[middle..], right),
        );
        return;
    }

    // Samples at one place are in the order of their indices, so that even an unstable sort has one result.
    let order = |a: &Entry, b: &Entry| {
        (a.position.x.total_cmp(&b.position.x))
            .then_with(|| a.position.y.total_cmp(&b.position.y))
            .then_with(|| a.id.cmp(&b.id))
    };

    for bounds in starts.windows(2) {
        let [start, end] = [0, 1].map(|side| (bounds[side] - starts[0]) as usize);
        if end > start + 1 {
            entries[start..end].sort_unstable_by(order);
        }
    }
}

/// Column and row of a scaled position; neither falls when its coordinate rises. Rounding may move a
/// sample at a cell's side into the next cell, by at most [`Grid::ROUNDING`] of a cell.
pub(crate) fn cell_at(domain: &Domain, cells: [usize; 2], position: DVec2) -> [usize; 2] {
    [0, 1].map(|axis| {
        let cell = position[axis] / domain.extent[axis] * cells[axis] as f64;
        (cell as usize).min(cells[axis] - 1)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region::{Boundary, Region};

    fn domain(width: f64, height: f64) -> Domain {
        let boundary = Boundary::Bounded;
        Domain::new(Region {
            width,
            height,
            boundary,
        })
        .expect("supported")
    }

    fn scattered(count: usize, width: f64, height: f64) -> Vec<[f64; 2]> {
        let fraction = |x: f64| x - x.floor();
        (0..count)
            .map(|i| i as f64)
            .map(|i| {
                [
                    width * fraction(i * 0.754_877),
                    height * fraction(i * 0.569_84),
                ]
            })
            .collect()
    }

    #[test]
    fn holds_every_sample_once_and_rows_are_sorted_by_x() {
        let points = scattered(1000, 1.5, 1.0);
        let grid = Grid::new(&points, domain(1.5, 1.0), 0.05);
        let mut ids: Vec<u32> = grid.entries().iter().map(|entry| entry.id).collect();
        ids.sort_unstable();
        assert!(ids.iter().copied().eq(0..1000));
        for row in 0..grid.cells[1] {
            let run = grid.run(row, &(0..grid.cells[0]));
            assert!(run.is_sorted_by_key(|entry| entry.position.x));
        }
        assert_eq!(grid.count(&(0..grid.cells[0]), &(0..grid.cells[1])), 1000);
    }

    #[test]
    fn never_makes_many_more_cells_than_samples() {
        for (width, height) in [(1.0, 1.0), (1.0, 1e-9), (1e-9, 1.0)] {
            let points = scattered(50, width, height);
            let grid = Grid::new(&points, domain(width, height), 0.0);
            assert!(grid.cell_count() <= 64, "{width} {height}");
        }
    }

    #[test]
    fn only_clusters_crowd() {
        let mut points = scattered(1000, 1.0, 1.0);
        let crowded = |points: &[[f64; 2]]| Grid::new(points, domain(1.0, 1.0), 0.0).is_crowded();
        assert!(!crowded(&points));
        points.extend((0..1000).map(|i| [0.5, 0.5 + 1e-9 * f64::from(i)]));
        assert!(crowded(&points));
        let grid = Grid::new(&points, domain(1.0, 1.0), 0.0);
        let fullest = grid.fullest(&(0..grid.cells[0]), &(0..grid.cells[1]));
        assert!((1000..1010).contains(&fullest), "{fullest}");
    }
}
