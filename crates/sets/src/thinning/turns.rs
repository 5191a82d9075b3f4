//! Cells of points of which each takes its points one after the other: which is next, and which of those before it are kept.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// The points of all cells, each cell's after another's, and how far each cell is.
#[derive(Debug)]
pub(super) struct Turns {
    /// Where the points of each cell begin; the last number is that of all points.
    starts: Vec<u32>,
    /// The first point of each cell that is not decided. The last number, behind all cells, is not used.
    heads: Vec<AtomicU32>,
    /// How many points of each cell are kept.
    counts: Vec<AtomicU32>,
    /// The kept points of each cell, from its start on.
    kept: Vec<AtomicU32>,
    /// Cells that wait for the cells of other bands.
    pub stuck: Vec<AtomicBool>,
}

impl Turns {
    /// Returns cells without a decided point. `starts` says where the points of each begin, and at its end how many points there
    /// are.
    pub fn new(starts: Vec<u32>) -> Self {
        let cells = starts.len().saturating_sub(1);
        let points = starts.last().copied().unwrap_or_default();
        let zeros = |count: usize| (0..count).map(|_| AtomicU32::new(0)).collect();
        Self {
            heads: starts.iter().map(|&start| AtomicU32::new(start)).collect(),
            counts: zeros(cells),
            kept: zeros(points as usize),
            stuck: (0..cells).map(|_| AtomicBool::new(false)).collect(),
            starts,
        }
    }

    /// Returns the first point of a cell that is not decided, if there is one.
    ///
    /// After that, [`Self::kept`] returns all points before it that were kept, also by another thread.
    pub fn head(&self, cell: u32) -> Option<u32> {
        let head = self.heads[cell as usize].load(Ordering::Acquire);
        (head < self.starts[cell as usize + 1]).then_some(head)
    }

    /// Returns the kept points of a cell.
    pub fn kept(&self, cell: u32) -> impl Iterator<Item = u32> {
        let start = self.starts[cell as usize];
        let count = self.counts[cell as usize].load(Ordering::Acquire);
        (start..start + count).map(|slot| self.kept[slot as usize].load(Ordering::Relaxed))
    }

    /// Decides the first open point of a cell, which only one thread at a time may do.
    pub fn decide(&self, cell: u32, is_kept: bool) {
        let cell = cell as usize;
        let head = self.heads[cell].load(Ordering::Relaxed);
        if is_kept {
            let count = self.counts[cell].load(Ordering::Relaxed);
            self.kept[(self.starts[cell] + count) as usize].store(head, Ordering::Relaxed);
            self.counts[cell].store(count + 1, Ordering::Release);
        }
        // Last, so that a thread that reads the new head also reads the kept points.
        self.heads[cell].store(head + 1, Ordering::Release);
    }

    /// Sets the flag of each kept point. `indices` has which flag is that of each point.
    pub fn flag(&self, indices: &[u32], flags: &mut [bool]) {
        let cells = 0..self.counts.len() as u32;
        for point in cells.flat_map(|cell| self.kept(cell)) {
            flags[indices[point as usize] as usize] = true;
        }
    }
}
