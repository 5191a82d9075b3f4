//! Samples in the sequence of cells, row by row, so that the neighbours of a sample are in the cells around its own.
//! Some rows of the region are held, or all of them.

use std::borrow::Cow;
use std::ops::Range;

use glam::DVec2;
use rayon::prelude::*;

use super::found::Declined;
use super::rows::SortedRows;
use super::sample::Sample;
use crate::domain::Domain;

/// Sides of a cell in radii: fewer and longer runs of samples are scanned than in square cells.
const SHAPE: DVec2 = DVec2::new(1.0, 2.0);

/// Cells that even a set of few samples may have: 4 MiB.
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
    /// How many columns and rows there are.
    pub counts: [usize; 2],
    /// How many cells a unit of length holds, along each axis.
    pub per_unit: DVec2,
    /// The width and the height of a cell.
    pub sides: DVec2,
    /// Cells to either side, along each axis, that hold all samples within two radii.
    pub reach: [usize; 2],
}

impl Cells {
    /// Returns cells of at least `radius` along x and twice that along y, where the region is so large. Declines a
    /// radius for which there would be too many cells, or too many of them within two radii.
    pub fn new(domain: Domain, radius: f64) -> Result<Self, Declined> {
        let side = radius * SLACK;
        // Rounded down: cells may be larger than asked for, but not smaller.
        let counts = (domain.extent / (SHAPE * side)).floor().max(DVec2::ONE);
        let sides = domain.extent / counts;
        let mut reach = (2.0 * side / sides).ceil();
        if !domain.periodic {
            // There are no cells beyond the border.
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

    /// The row of an ordinate. A greater ordinate never has a lower row.
    pub fn row(&self, y: f64) -> usize {
        ((y * self.per_unit.y) as i32 as usize).min(self.counts[1] - 1)
    }

    /// The index of the cell at a position among those of the rows from `first` on.
    pub fn cell(&self, position: DVec2, first: usize) -> usize {
        (self.row(position.y) - first) * self.counts[0] + self.column(position.x)
    }

    /// Refuses so many rows for so few samples that their cells would take more memory than the samples.
    pub fn check_count(&self, rows: usize, samples: usize) -> Result<(), Declined> {
        let cells = rows.saturating_mul(self.counts[0]);
        if cells > FEW_CELLS + MAX_CELLS_PER_SAMPLE * samples {
            return Err(Declined::Sparse);
        }
        Ok(())
    }

    /// The distance up to which all samples around one are in its cell and the given number of cells to either side.
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
pub(crate) struct Samples<'a> {
    pub cells: Cells,
    /// The first row held.
    first: usize,
    /// Rows held; those past the last row of the region are its first ones.
    held: usize,
    /// The first sample of each cell of each row, and the end.
    starts: Cow<'a, [u32]>,
    /// In the caller's unit.
    points: &'a [[f64; 2]],
    /// The samples in the sequence of cells, as indices of the points, unless these are in that sequence.
    order: Option<Vec<u32>>,
    /// Indices of the points in the whole set, where these are not the indices here.
    ids: Option<&'a [u32]>,
}

impl<'a> Samples<'a> {
    /// Sorts a whole set into cells.
    pub fn new(cells: Cells, points: &'a [[f64; 2]]) -> Result<Self, Declined> {
        let rows = cells.counts[1];
        cells.check_count(rows, points.len())?;
        let first_row = 0;
        let cell = |point: &[f64; 2]| {
            let position = cells.domain.scale_point(*point);
            cells.cell(position, first_row) as u32
        };

        let cell_of: Vec<u32> = points.par_iter().map(cell).collect();
        // Samples are sorted as indices, and read where the caller has them.
        let (starts, order) = sorted(&cell_of, rows * cells.counts[0]);

        Ok(Self {
            cells,
            first: 0,
            held: rows,
            starts: starts.into(),
            points,
            order: Some(order),
            ids: None,
        })
    }

    /// Samples that are sorted already.
    pub fn of_rows(cells: Cells, rows: &'a SortedRows) -> Self {
        Self {
            cells,
            first: rows.first,
            held: rows.count(&cells),
            starts: Cow::Borrowed(&rows.starts),
            points: &rows.points,
            order: None,
            ids: Some(&rows.ids),
        }
    }

    pub fn len(&self) -> usize {
        self.starts[self.starts.len() - 1] as usize
    }

    /// A sample by its rank in the sequence of cells.
    pub fn at(&self, rank: usize) -> Sample {
        let index = (self.order.as_ref()).map_or(rank, |order| order[rank] as usize);
        Sample {
            position: self.cells.domain.scale_point(self.points[index]),
            id: self.ids.map_or(index as u32, |ids| ids[index]),
        }
    }

    /// Appends the shifted positions of samples of consecutive ranks in the sequence of cells.
    pub fn append_positions(&self, ranks: Range<usize>, shift: DVec2, to: &mut Vec<DVec2>) {
        let position = |&point: &[f64; 2]| self.cells.domain.scale_point(point) + shift;
        if let Some(order) = &self.order {
            let points = order[ranks]
                .iter()
                .map(|&index| &self.points[index as usize]);
            to.extend(points.map(position));
        } else {
            to.extend(self.points[ranks].iter().map(position));
        }
    }

    /// Whether a row, counted on across the seam, is held.
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

/// The cell of a sample that is not sorted.
pub(super) const NO_CELL: u32 = u32::MAX;

/// Sorts samples by counting, given the cell of each. Returns where each cell begins, with the end of the last one, and the
/// samples cell by cell, as indices. Samples of [`NO_CELL`] are left out.
pub(super) fn sorted(cell_of: &[u32], cells: usize) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0_u32; cells + 2];
    for &cell in cell_of {
        if cell != NO_CELL {
            // The samples of cell `c` are counted in entry `c + 2`. So the sums below make entry `c + 1` the start of
            // cell `c`.
            starts[cell as usize + 2] += 1;
        }
    }

    for index in 2..starts.len() {
        starts[index] += starts[index - 1];
    }

    let mut order = vec![0; starts[cells + 1] as usize];
    for (index, &cell) in (0..).zip(cell_of) {
        if cell != NO_CELL {
            // Entry `c + 1` grows with each sample of cell `c`, from the cell's start to its end.
            let next = &mut starts[cell as usize + 1];
            order[*next as usize] = index;
            *next += 1;
        }
    }
    // The end of a cell is the start of the next one. So entry `c` is now the start of cell `c`, and the entry behind
    // those of all cells is the end of the last cell. One more entry is left over.
    starts.pop();
    (starts, order)
}
