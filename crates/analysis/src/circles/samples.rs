//! Samples in the sequence of cells, row by row, so that the neighbours of a sample are in the cells around its own.
//! Some rows of the region are held, or all of them.

use std::ops::Range;

use glam::DVec2;

use super::found::Declined;
use super::sample::Sample;
use crate::domain::Domain;

/// Sides of a cell in radii: fewer and longer runs of samples are scanned than in square cells.
const SHAPE: DVec2 = DVec2::new(1.0, 2.0);

/// Cells that even a set of few samples may have.
const FEW_CELLS: usize = 1 << 20;

/// Most cells per sample; a maximal set has 0.7.
const MAX_CELLS_PER_SAMPLE: usize = 16;

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
    pub per_unit: DVec2,
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

/// Samples as they were given.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given<'a> {
    /// In the caller's unit.
    pub points: &'a [[f64; 2]],
    /// Their indices in the whole set, where these are not the indices here.
    pub ids: Option<&'a [u32]>,
}

/// Samples of consecutive rows.
#[derive(Debug)]
pub(crate) struct Samples<'a> {
    pub cells: Cells,
    given: Given<'a>,
    /// The first row held.
    first: usize,
    /// Rows held; those past the last row of the region are its first ones.
    held: usize,
    /// The first sample of each cell of each row, and the end.
    starts: Vec<u32>,
    /// The samples in the sequence of cells, as indices of those given.
    order: Vec<u32>,
}

/// The cell of a sample in no row that is held.
const NOT_HELD: u32 = u32::MAX;

impl<'a> Samples<'a> {
    /// Sorts the samples of the `held` rows from `first` on. Others are skipped.
    pub fn new(
        cells: Cells,
        first: usize,
        held: usize,
        given: Given<'a>,
    ) -> Result<Self, Declined> {
        let [columns, rows] = cells.counts;
        let all_cells = held.saturating_mul(columns);
        if all_cells > FEW_CELLS + MAX_CELLS_PER_SAMPLE * given.points.len() {
            return Err(Declined::Sparse);
        }
        let cell = |point: &[f64; 2]| {
            let position = cells.domain.scale_point(*point);
            let row = cells.row(position.y);
            // Rows before the first are those past the last row.
            let slot = if row >= first {
                row - first
            } else {
                row + rows - first
            };
            if slot < held {
                (slot * columns + cells.column(position.x)) as u32
            } else {
                NOT_HELD
            }
        };
        let mut starts = vec![0_u32; all_cells + 2];
        let cell_of: Vec<u32> = given.points.iter().map(cell).collect();
        for &cell in &cell_of {
            if cell != NOT_HELD {
                starts[cell as usize + 2] += 1;
            }
        }
        for index in 2..starts.len() {
            starts[index] += starts[index - 1];
        }
        let mut order = vec![0; starts[all_cells + 1] as usize];
        for (index, cell) in cell_of.into_iter().enumerate() {
            if cell != NOT_HELD {
                // Each start moves on to that of the next cell.
                let next = &mut starts[cell as usize + 1];
                order[*next as usize] = index as u32;
                *next += 1;
            }
        }
        starts.pop();
        Ok(Self {
            cells,
            given,
            first,
            held,
            starts,
            order,
        })
    }

    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// A sample by its rank in the sequence of cells.
    pub fn at(&self, rank: usize) -> Sample {
        let index = self.order[rank];
        Sample {
            position: self.position(index),
            id: self.given.ids.map_or(index, |ids| ids[index as usize]),
        }
    }

    /// The positions of samples of consecutive ranks in the sequence of cells.
    pub fn positions(&self, ranks: Range<usize>) -> impl ExactSizeIterator<Item = DVec2> {
        self.order[ranks].iter().map(|&index| self.position(index))
    }

    fn position(&self, index: u32) -> DVec2 {
        let point = self.given.points[index as usize];
        self.cells.domain.scale_point(point)
    }

    /// The rows that are held, counted on across the seam.
    pub fn holds(&self, row: i64) -> bool {
        slot(row, self.first, self.cells.counts[1]) < self.held
    }

    /// The first sample of each of some cells of a row, and the end of the last one.
    pub fn starts(&self, row: i64, columns: Range<usize>) -> &[u32] {
        let [width, rows] = self.cells.counts;
        let line = slot(row, self.first, rows) * width;
        &self.starts[line + columns.start..=line + columns.end]
    }
}

/// The place among the rows held of a row counted on across the seam.
fn slot(row: i64, first: usize, rows: usize) -> usize {
    (row - first as i64).rem_euclid(rows as i64) as usize
}
