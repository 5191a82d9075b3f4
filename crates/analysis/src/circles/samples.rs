//! Samples in rows of cells, so that the neighbours of a sample are in the cells around its own.
//! Some rows of the region or all of them; a row lies in blocks of columns, and a block holds its samples in any sequence.
//! It decides nothing.

use glam::DVec2;

use super::found::Declined;
use super::sample::Sample;
use crate::domain::Domain;

/// Columns of a block.
const BLOCK: usize = 32;

/// Sides of a cell in radii: fewer and longer runs of samples are scanned than in square cells.
const SHAPE: DVec2 = DVec2::new(1.0, 2.0);

/// Blocks of columns that even a set of few samples may have.
const MIN_BUCKETS: usize = 1 << 16;

/// Cells are larger than the radius by this factor, which pays for the rounding of their borders.
const SLACK: f64 = 1.0 + 1.0 / 1_048_576.0;

/// Most cells along an axis: the rounding of a cell's index is then far below [`SLACK`].
const MAX_CELLS: f64 = 1_073_741_824.0;

/// Most cells around a sample along an axis, to either side. More are needed only where the radius exceeds the period.
const MAX_REACH: f64 = 16.0;

/// The cells of a region.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cells {
    pub domain: Domain,
    /// Columns and rows.
    pub counts: [usize; 2],
    per_unit: DVec2,
    pub sides: DVec2,
    /// Cells to either side, along each axis, that hold all samples within two radii.
    pub reach: [usize; 2],
}

impl Cells {
    /// Cells of at least `radius` along x and twice that along y, where the region is so large.
    pub fn new(domain: Domain, radius: f64) -> Result<Self, Declined> {
        let side = radius * SLACK;
        let counts = (domain.extent / (SHAPE * side)).floor().max(DVec2::ONE);
        let sides = domain.extent / counts;
        let mut reach = (2.0 * side / sides).ceil();
        if !domain.periodic {
            reach = reach.min(counts);
        }
        if counts.max_element() > MAX_CELLS || reach.max_element() > MAX_REACH {
            return Err(Declined::Radius);
        }
        Ok(Self {
            domain,
            counts: [counts.x as usize, counts.y as usize],
            per_unit: counts / domain.extent,
            sides,
            reach: [reach.x as usize, reach.y as usize],
        })
    }

    pub fn column(&self, x: f64) -> usize {
        // Through i32, which is quicker; counts are below its limit.
        ((x * self.per_unit.x) as i32 as usize).min(self.counts[0] - 1)
    }

    /// The row of an ordinate; it does not fall when that rises.
    pub fn row(&self, y: f64) -> usize {
        ((y * self.per_unit.y) as i32 as usize).min(self.counts[1] - 1)
    }

    /// The distance up to which all samples around one are in its cell and so many cells to either side.
    pub fn certain_distance(&self, around: [usize; 2]) -> f64 {
        let distance = |axis: usize| {
            if !self.domain.periodic && around[axis] >= self.counts[axis] {
                f64::INFINITY
            } else {
                around[axis] as f64 * self.sides[axis] / SLACK
            }
        };
        distance(0).min(distance(1))
    }
}

/// Samples of consecutive rows.
#[derive(Debug)]
pub(crate) struct Samples {
    pub cells: Cells,
    /// The first row held.
    first: usize,
    /// Rows held; those past the last row of the region are its first ones.
    held: usize,
    blocks: usize,
    /// The first sample of each block of each row, and the end.
    starts: Vec<u32>,
    pub all: Vec<Sample>,
}

impl Samples {
    /// Sorts samples into the rows from `first` on. All must lie in one of these `held` rows.
    pub fn new(
        cells: Cells,
        first: usize,
        held: usize,
        samples: impl ExactSizeIterator<Item = Sample> + Clone,
    ) -> Result<Self, Declined> {
        let blocks = cells.counts[0].div_ceil(BLOCK);
        let count = samples.len();
        let buckets = held.saturating_mul(blocks);
        if buckets > MIN_BUCKETS + 4 * count {
            return Err(Declined::Sparse);
        }
        let bucket = |sample: &Sample| {
            let (row, column) = (
                cells.row(sample.position.y),
                cells.column(sample.position.x),
            );
            // Rows before the first are those past the last row.
            let slot = if row >= first {
                row - first
            } else {
                row + cells.counts[1] - first
            };
            slot * blocks + column / BLOCK
        };
        let mut starts = vec![0_u32; buckets + 2];
        let buckets: Vec<u32> = samples
            .clone()
            .map(|sample| bucket(&sample) as u32)
            .collect();
        for &bucket in &buckets {
            starts[bucket as usize + 2] += 1;
        }
        for index in 2..starts.len() {
            starts[index] += starts[index - 1];
        }
        let unset = Sample {
            position: DVec2::ZERO,
            id: 0,
        };
        let mut all = vec![unset; count];
        for (sample, bucket) in samples.zip(buckets) {
            // Each start moves on to that of the next bucket.
            let next = &mut starts[bucket as usize + 1];
            all[*next as usize] = sample;
            *next += 1;
        }
        starts.pop();
        Ok(Self {
            cells,
            first,
            held,
            blocks,
            starts,
            all,
        })
    }

    /// The rows that are held, counted on across the seam.
    pub fn holds(&self, row: i64) -> bool {
        slot(row, self.first, self.cells.counts[1]) < self.held
    }

    /// Calls `each` with the index of every sample of some columns of a row, and with its column.
    pub fn visit(
        &self,
        row: i64,
        columns: std::ops::Range<usize>,
        mut each: impl FnMut(u32, usize),
    ) {
        let first = slot(row, self.first, self.cells.counts[1]) * self.blocks;
        let blocks = columns.start / BLOCK..columns.end.div_ceil(BLOCK);
        let [start, end] = [blocks.start, blocks.end].map(|block| self.starts[first + block]);
        for index in start..end {
            let column = self.cells.column(self.all[index as usize].position.x);
            if columns.contains(&column) {
                each(index, column);
            }
        }
    }
}

/// The place among the rows held of a row counted on across the seam.
fn slot(row: i64, first: usize, rows: usize) -> usize {
    (row - first as i64).rem_euclid(rows as i64) as usize
}
