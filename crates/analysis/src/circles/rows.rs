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
pub(crate) struct Rows {
    pub first: usize,
    /// The first sample of each cell, row by row, and the end.
    pub starts: Vec<u32>,
    /// In the caller's unit.
    pub points: Vec<[f64; 2]>,
    /// Indices in the stream.
    pub ids: Vec<u32>,
}

impl Rows {
    /// No rows.
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

    /// Sorts the samples of the rows below `end` and appends them. Later ones stay in `open`, earlier ones move to `missed`.
    pub fn take(&mut self, open: &mut Held, missed: &mut Held, cells: &Cells, end: usize) {
        let first = self.end(cells);
        let held = first..end;
        let cell = |point: &[f64; 2]| {
            let position = cells.domain.scale_point(*point);
            if held.contains(&cells.row(position.y)) {
                cells.cell(position, first) as u32
            } else {
                NO_CELL
            }
        };
        let cell_of: Vec<u32> = open.points.iter().map(cell).collect();
        let (starts, order) = sorted(&cell_of, held.len() * cells.counts[0]);
        self.append_starts(&starts);
        let order = order.iter().map(|&index| index as usize);
        self.points
            .extend(order.clone().map(|index| open.points[index]));
        self.ids.extend(order.map(|index| open.ids[index]));
        let mut kept = 0;
        for (index, cell) in cell_of.into_iter().enumerate() {
            if cell != NO_CELL {
                continue;
            }
            let (point, id) = (open.points[index], open.ids[index]);
            if cells.row(cells.domain.scale_point(point).y) < first {
                missed.push(point, id);
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
