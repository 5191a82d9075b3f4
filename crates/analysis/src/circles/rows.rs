//! The samples of a stream: those of complete rows are sorted into cells while they are in the caches, and stay so until
//! no later row needs them.

use serde::{Deserialize, Serialize};

use super::samples::{Cells, NO_CELL, sorted};

/// Samples of a stream, as they came.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Held {
    /// In the caller's unit.
    pub points: Vec<[f64; 2]>,
    /// Indices in the stream.
    pub ids: Vec<u32>,
}

impl Held {
    /// Adds samples, the first of which has the index `first`.
    pub fn add(&mut self, points: &[[f64; 2]], first: u32) {
        self.points.extend_from_slice(points);
        self.ids.extend(first..first + points.len() as u32);
    }

    fn push(&mut self, point: [f64; 2], id: u32) {
        self.points.push(point);
        self.ids.push(id);
    }

    pub fn len(&self) -> usize {
        self.points.len()
    }
}

/// The samples of consecutive rows in the sequence of cells.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SortedRows {
    /// The index of the first row.
    pub first: usize,
    /// The first sample of each cell, row by row, and the end.
    pub starts: Vec<u32>,
    /// In the caller's unit.
    pub points: Vec<[f64; 2]>,
    /// Indices in the stream.
    pub ids: Vec<u32>,
}

impl SortedRows {
    /// Begins before the row `first`, without any.
    pub fn new(first: usize) -> Self {
        Self {
            first,
            starts: vec![0],
            points: Vec::new(),
            ids: Vec::new(),
        }
    }

    pub fn count(&self, cells: &Cells) -> usize {
        (self.starts.len() - 1) / cells.counts[0]
    }

    pub fn end(&self, cells: &Cells) -> usize {
        self.first + self.count(cells)
    }

    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Appends the rows from [`Self::end`] up to `end`, without the row `end`: takes their samples out of `open`, and
    /// sorts them by cells. Samples of later rows stay in `open`. If the rows held begin with row 1, as on a torus,
    /// samples of row 0 move to `lowest`.
    pub fn take(&mut self, open: &mut Held, lowest: &mut Held, cells: &Cells, end: usize) {
        let first = self.end(cells);
        let complete = first..end;
        let cell = |point: &[f64; 2]| {
            let position = cells.domain.scale_point(*point);
            if complete.contains(&cells.row(position.y)) {
                cells.cell(position, first) as u32
            } else {
                NO_CELL
            }
        };

        let cell_of: Vec<u32> = open.points.iter().map(cell).collect();

        let (starts, order) = sorted(&cell_of, complete.len() * cells.counts[0]);
        self.append_starts(&starts);

        let indices = order.iter().map(|&index| index as usize);
        self.points
            .extend(indices.clone().map(|index| open.points[index]));
        self.ids.extend(indices.map(|index| open.ids[index]));

        // Samples of later rows move to the front of `open`, in their order.
        let mut kept = 0;
        for (index, cell) in cell_of.into_iter().enumerate() {
            // A sample with a cell was sorted and appended above.
            if cell != NO_CELL {
                continue;
            }
            let (point, id) = (open.points[index], open.ids[index]);
            let row = cells.row(cells.domain.scale_point(point).y);

            // On a torus the rows held begin with row 1. Samples of row 0 may come at any time, so it is sorted last.
            if row < first {
                debug_assert_eq!(row, 0, "rows are complete when they are sorted");
                lowest.push(point, id);
            } else {
                (open.points[kept], open.ids[kept]) = (point, id);
                kept += 1;
            }
        }

        open.points.truncate(kept);
        open.ids.truncate(kept);
    }

    /// Appends the first rows of others.
    pub fn append(&mut self, others: &Self, count: usize, cells: &Cells) {
        let starts = &others.starts[..=count * cells.counts[0]];
        let samples = starts[starts.len() - 1] as usize;
        self.append_starts(starts);
        self.points.extend_from_slice(&others.points[..samples]);
        self.ids.extend_from_slice(&others.ids[..samples]);
    }

    fn append_starts(&mut self, starts: &[u32]) {
        let before = self.len() as u32;
        self.starts
            .extend(starts[1..].iter().map(|start| before + start));
    }

    /// Drops the first rows.
    pub fn drop_first(&mut self, count: usize, cells: &Cells) {
        self.starts.drain(..count * cells.counts[0]);
        let samples = self.starts[0];
        for start in &mut self.starts {
            *start -= samples;
        }
        self.points.drain(..samples as usize);
        self.ids.drain(..samples as usize);
        self.first += count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circles::samples::Samples;
    use crate::domain::Domain;
    use crate::region::{Boundary, Region};

    /// Points of a square of side 20 in nearly row order: some come a unit late.
    fn points() -> Vec<[f64; 2]> {
        let place = |k: u32| {
            let (x, late) = (k.wrapping_mul(2_654_435_761), k.wrapping_mul(40_503) % 8);
            let up = 20.0 * f64::from(k) / 4_000.0 - f64::from(late) / 8.0;
            [20.0 * f64::from(x) / 4_294_967_296.0, up.max(0.0)]
        };
        (0..4_000).map(place).collect()
    }

    fn cells() -> Cells {
        let region = Region {
            width: 20.0,
            height: 20.0,
            boundary: Boundary::Bounded,
        };
        let domain = Domain::new(region).expect("supported");
        Cells::new(domain, domain.scale).expect("few cells")
    }

    /// The indices of samples in the sequence of cells.
    fn ids(samples: &Samples<'_>) -> Vec<u32> {
        (0..samples.len()).map(|rank| samples.at(rank).id).collect()
    }

    #[test]
    fn samples_sorted_as_they_come_are_those_of_the_whole_set() {
        let (points, cells) = (points(), cells());
        let whole = Samples::new(cells, &points).expect("dense");
        let (mut rows, mut open, mut lowest) =
            (SortedRows::new(0), Held::default(), Held::default());
        for (piece, first) in points.chunks(100).zip((0..).step_by(100)) {
            open.add(piece, first);
            // The next samples come at most a unit late.
            let complete = cells.row((piece[99][1] - 2.0).max(0.0) * cells.domain.scale);
            let end = complete.max(rows.end(&cells));
            rows.take(&mut open, &mut lowest, &cells, end);
        }
        assert!(rows.count(&cells) > 5 && open.len() > 100);
        rows.take(&mut open, &mut lowest, &cells, cells.counts[1]);
        assert_eq!((open.len(), lowest.len()), (0, 0));
        let sorted = Samples::of_rows(cells, &rows);
        assert_eq!(ids(&sorted), ids(&whole));
        for row in 0..cells.counts[1] as i64 {
            let columns = 0..cells.counts[0];
            assert_eq!(
                sorted.starts(row, columns.clone()),
                whole.starts(row, columns)
            );
        }
    }

    #[test]
    fn rows_that_are_dropped_and_appended_again_follow_the_others() {
        let (points, cells) = (points(), cells());
        let (mut rows, mut open) = (SortedRows::new(0), Held::default());
        open.add(&points, 0);
        rows.take(&mut open, &mut Held::default(), &cells, cells.counts[1]);
        let before = ids(&Samples::of_rows(cells, &rows));
        let mut first = SortedRows::new(0);
        first.append(&rows, 3, &cells);
        rows.drop_first(3, &cells);
        rows.append(&first, 3, &cells);
        assert_eq!((rows.first, rows.count(&cells)), (3, cells.counts[1]));
        let after = Samples::of_rows(cells, &rows);
        assert!(first.len() > 0 && after.holds(0) && after.holds(2));
        assert_eq!(
            ids(&after),
            [&before[first.len()..], &before[..first.len()]].concat()
        );
        let width = cells.counts[0];
        let lowest = after.starts(0, 0..width);
        assert_eq!(lowest[0] as usize, before.len() - first.len());
    }

    #[test]
    fn late_samples_of_the_lowest_row_are_kept_apart() {
        let (points, cells) = (points(), cells());
        let (mut rows, mut open, mut lowest) =
            (SortedRows::new(1), Held::default(), Held::default());
        open.add(&points, 0);
        rows.take(&mut open, &mut lowest, &cells, 4);
        open.add(&[[7.0, 0.5]], 4_000);
        rows.take(&mut open, &mut lowest, &cells, cells.counts[1]);
        assert_eq!(lowest.ids.last(), Some(&4_000));
        assert_eq!(lowest.len() + rows.len(), points.len() + 1);
        let mut again = SortedRows::new(0);
        again.take(&mut lowest, &mut Held::default(), &cells, 1);
        let samples = Samples::of_rows(cells, &again);
        assert!(ids(&samples).contains(&4_000) && lowest.len() == 0);
    }
}
