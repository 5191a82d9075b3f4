//! The radius at a place, and the least and the greatest radius in a square.

use crate::region::Boundary;

use super::error::SquaresError;
use super::{LatticeRegion, MAX_PITCH_BITS, MAX_RADIUS, PointSpan, Radii};

/// The radii of a region.
#[derive(Clone, Debug)]
pub(super) enum RadiusTable {
    Constant(i64),
    Nodes(NodeTable),
}

/// The least and the greatest of some radii.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RadiusRange {
    pub least: i64,
    pub greatest: i64,
}

/// Radii at nodes, with bilinear ones between them.
#[derive(Clone, Debug)]
pub(super) struct NodeTable {
    /// A cell of four nodes is 2^`bits` units wide.
    bits: u32,
    /// Cells of a row and of a column.
    cells: [usize; 2],
    /// The nodes around all cells, row by row: those of a periodic region have the first row and column again at the end.
    nodes: Vec<i32>,
    /// Ranges of blocks of 2 x 2 cells, of 4 x 4, and so on up to one of all. Those of single cells are not held, as
    /// they are seen from their nodes.
    levels: Vec<BlockLevel>,
    /// The least and the greatest node of all, which every sample that comes or goes asks for.
    whole: RadiusRange,
}

/// The least and greatest nodes of the blocks of a size.
#[derive(Clone, Debug)]
struct BlockLevel {
    /// How many blocks a row has.
    columns: usize,
    /// The least and the greatest node of each block, row by row.
    ranges: Vec<[i32; 2]>,
}

impl RadiusTable {
    /// Returns the table of the radii of a region, or the error for a number that is beyond its limit.
    pub(super) fn new(region: LatticeRegion, radii: Radii<'_>) -> Result<Self, SquaresError> {
        let (pitch_bits, columns, nodes) = match radii {
            Radii::Constant(radius) => {
                check_radii(&[radius])?;
                return Ok(Self::Constant(radius.into()));
            }
            Radii::Nodes {
                pitch_bits,
                columns,
                nodes,
            } => (pitch_bits, columns, nodes),
        };

        if pitch_bits > MAX_PITCH_BITS {
            return Err(SquaresError::Pitch { bits: pitch_bits });
        }
        check_radii(nodes)?;

        // In a periodic region the first node follows the last one at the same pitch.
        let sides = [region.width, region.height];
        let uneven = sides.into_iter().find(|side| side % (1 << pitch_bits) != 0);
        let wraps = region.boundary == Boundary::Periodic;
        if let Some(side) = uneven.filter(|_| wraps) {
            let bits = pitch_bits;
            return Err(SquaresError::UnevenPitch { side, bits });
        }

        // The last cell may reach beyond the region. Along each axis there is a node more than cells, unless the first node
        // follows the last one.
        let cells = sides.map(|side| ((side - 1) >> pitch_bits) as usize + 1);
        let [needed_columns, needed_rows] = cells.map(|cells| cells + usize::from(!wraps));
        if columns != needed_columns || nodes.len() != needed_columns * needed_rows {
            return Err(SquaresError::Nodes {
                given: nodes.len(),
                columns,
                needed_columns,
                needed_rows,
            });
        }

        let node = |row: usize, column: usize| {
            // A periodic region has its first nodes again at the end.
            nodes[(row % needed_rows) * columns + column % needed_columns]
        };
        let rows = 0..=cells[1];
        let nodes = rows.flat_map(|row| (0..=cells[0]).map(move |column| node(row, column)));
        Ok(Self::Nodes(NodeTable::new(
            pitch_bits,
            cells,
            nodes.collect(),
        )))
    }

    /// Returns the radius at a place of the region.
    #[inline]
    pub(super) fn at(&self, x: i64, y: i64) -> i64 {
        match self {
            Self::Constant(radius) => *radius,
            Self::Nodes(table) => table.cell(x, y).at(x, y),
        }
    }

    /// Returns the largest radius of the region, or more.
    pub(super) fn greatest(&self) -> i64 {
        self.whole().greatest
    }

    /// Returns the least and the greatest radius of a node.
    pub(super) fn whole(&self) -> RadiusRange {
        match self {
            Self::Constant(radius) => RadiusRange {
                least: *radius,
                greatest: *radius,
            },
            Self::Nodes(table) => table.whole,
        }
    }

    /// Returns how wide a cell of four nodes is: two to this power. A radius that is the same everywhere has one cell.
    pub(super) const fn cell_bits(&self) -> u32 {
        match self {
            Self::Constant(_) => i32::BITS,
            Self::Nodes(table) => table.bits,
        }
    }

    /// Returns radii between which all radii of a span lie: the part in the region of a square whose sides are 2^`bits`
    /// and whose coordinates are multiples of that.
    #[inline]
    pub(super) fn range(&self, span: PointSpan, bits: u32) -> RadiusRange {
        match self {
            Self::Constant(radius) => RadiusRange {
                least: *radius,
                greatest: *radius,
            },
            Self::Nodes(table) => table.range(span, bits),
        }
    }
}

fn check_radii(radii: &[i32]) -> Result<(), SquaresError> {
    let beyond = radii
        .iter()
        .find(|radius| !(1..=MAX_RADIUS).contains(radius));
    beyond.map_or(Ok(()), |&radius| Err(SquaresError::Radius { radius }))
}

impl NodeTable {
    /// Returns the table of nodes, with the ranges of ever larger blocks of cells.
    fn new(bits: u32, cells: [usize; 2], nodes: Vec<i32>) -> Self {
        let each = || nodes.iter().copied();
        // A table has at least four nodes: the 1 is never taken.
        let whole = RadiusRange {
            least: each().min().unwrap_or(1).into(),
            greatest: each().max().unwrap_or(1).into(),
        };
        let mut table = Self {
            bits,
            cells,
            nodes,
            levels: Vec::new(),
            whole,
        };

        let mut below = cells;
        // Up to one block of all, so that every square lies within a block.
        while below != [1, 1] {
            let [columns, rows] = below.map(|count| count.div_ceil(2));
            let mut ranges = Vec::with_capacity(columns * rows);
            for row in 0..rows {
                for column in 0..columns {
                    ranges.push(table.joined(2 * row, 2 * column, below));
                }
            }

            table.levels.push(BlockLevel { columns, ranges });
            below = [columns, rows];
        }
        table
    }

    /// Returns the range of up to four blocks, the first of which is given, of a level with `columns` times `rows`
    /// blocks.
    fn joined(&self, row: usize, column: usize, [columns, rows]: [usize; 2]) -> [i32; 2] {
        let mut range = [i32::MAX, i32::MIN];
        for row in row..(row + 2).min(rows) {
            for column in column..(column + 2).min(columns) {
                let [least, greatest] = match self.levels.last() {
                    Some(level) => level.ranges[row * columns + column],
                    None => self.around(row, column),
                };
                range = [range[0].min(least), range[1].max(greatest)];
            }
        }
        range
    }

    /// Returns the least and the greatest node around a cell.
    fn around(&self, row: usize, column: usize) -> [i32; 2] {
        let first = row * (self.cells[0] + 1) + column;
        let above = first + self.cells[0] + 1;
        let nodes = [first, first + 1, above, above + 1].map(|index| self.nodes[index]);
        let [a, b, c, d] = nodes;
        [a.min(b).min(c).min(d), a.max(b).max(c).max(d)]
    }

    /// Returns the cell of a place of the region.
    #[inline]
    fn cell(&self, x: i64, y: i64) -> NodeCell {
        // The far border of a bounded region belongs to the last cells, of which it may be the end.
        let column = ((x >> self.bits) as usize).min(self.cells[0] - 1);
        let row = ((y >> self.bits) as usize).min(self.cells[1] - 1);
        let first = row * (self.cells[0] + 1) + column;
        let above = first + self.cells[0] + 1;
        NodeCell {
            bits: self.bits,
            x: (column as i64) << self.bits,
            y: (row as i64) << self.bits,
            below: [self.nodes[first].into(), self.nodes[first + 1].into()],
            above: [self.nodes[above].into(), self.nodes[above + 1].into()],
        }
    }

    /// Returns radii between which all radii of a span lie, as [`RadiusTable::range`].
    fn range(&self, PointSpan { min, max }: PointSpan, bits: u32) -> RadiusRange {
        if bits <= self.bits {
            // The square lies in one cell. A bilinear function has its extremes over a rectangle at the corners, and rounding
            // down keeps the order.
            let cell = self.cell(min[0], min[1]);
            let corners = [
                cell.at(min[0], min[1]),
                cell.at(max[0], min[1]),
                cell.at(min[0], max[1]),
                cell.at(max[0], max[1]),
            ];
            let [a, b, c, d] = corners;
            return RadiusRange {
                least: a.min(b).min(c.min(d)),
                greatest: a.max(b).max(c.max(d)),
            };
        }

        // The last level is one block of all cells: wider squares need no more.
        let size = ((bits - self.bits) as usize).min(self.levels.len());
        let Some(level) = size.checked_sub(1).map(|index| &self.levels[index]) else {
            // A table of a single cell has no levels.
            let [least, greatest] = self.around(0, 0).map(i64::from);
            return RadiusRange { least, greatest };
        };

        // A square at the far border of a bounded region belongs to the last blocks.
        let rows = level.ranges.len() / level.columns;
        let shift = self.bits + size as u32;
        let column = ((min[0] >> shift) as usize).min(level.columns - 1);
        let row = ((min[1] >> shift) as usize).min(rows - 1);
        let [least, greatest] = level.ranges[row * level.columns + column].map(i64::from);
        RadiusRange { least, greatest }
    }
}

/// The four nodes around a place.
struct NodeCell {
    bits: u32,
    /// The lowest place of the cell, of which a side is 2^`bits`.
    x: i64,
    y: i64,
    /// The radii at the left and the right node, of the lower side and of the upper one.
    below: [i64; 2],
    above: [i64; 2],
}

impl NodeCell {
    #[inline]
    fn at(&self, x: i64, y: i64) -> i64 {
        let pitch = 1 << self.bits;
        let (right, up) = (x - self.x, y - self.y);
        let along = |[left, end]: [i64; 2]| left * (pitch - right) + end * right;
        // The sum is at most 2^21 times 2^40, which fits 64 bits.
        (along(self.below) * (pitch - up) + along(self.above) * up) >> (2 * self.bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field of 5 x 4 nodes that are 8 units apart, and its region.
    fn table(boundary: Boundary, [width, height]: [i32; 2]) -> RadiusTable {
        let nodes = [
            7, 40, 3, 19, 90, 11, 2, 64, 5, 5, 31, 8, 8, 77, 1, 50, 4, 23, 60, 9,
        ];
        let region = LatticeRegion {
            width,
            height,
            boundary,
        };
        let radii = Radii::Nodes {
            pitch_bits: 3,
            columns: 5,
            nodes: &nodes,
        };
        RadiusTable::new(region, radii).unwrap()
    }

    /// Compares the ranges of all aligned squares with those of all their places.
    fn check_ranges(table: &RadiusTable, last: [i64; 2]) {
        for bits in 0..7 {
            let side = 1 << bits;
            let starts = |last: i64| (0..=last).step_by(side as usize);
            for (x, y) in starts(last[0]).flat_map(|x| starts(last[1]).map(move |y| (x, y))) {
                let max = [(x + side - 1).min(last[0]), (y + side - 1).min(last[1])];
                let places = (x..=max[0]).flat_map(|x| (y..=max[1]).map(move |y| (x, y)));
                let radii: Vec<i64> = places.map(|(x, y)| table.at(x, y)).collect();
                let (least, greatest) =
                    (*radii.iter().min().unwrap(), *radii.iter().max().unwrap());

                let range = table.range(PointSpan { min: [x, y], max }, bits);
                assert!(range.least <= least && range.greatest >= greatest);
                if bits <= 3 {
                    assert_eq!((range.least, range.greatest), (least, greatest));
                }
            }
        }
    }

    #[test]
    fn ranges_hold_the_radii_of_all_places() {
        check_ranges(&table(Boundary::Periodic, [40, 32]), [39, 31]);
        check_ranges(&table(Boundary::Bounded, [32, 24]), [32, 24]);
        check_ranges(&table(Boundary::Bounded, [27, 17]), [27, 17]);
    }

    #[test]
    fn radii_are_bilinear_and_rounded_down() {
        let table = table(Boundary::Bounded, [32, 24]);
        let nodes = [table.at(0, 0), table.at(8, 0), table.at(32, 24)];
        assert_eq!(nodes, [7, 40, 9]);
        // (7 * 5 + 40 * 3) / 8 = 19.375, and halfway to (11 * 5 + 2 * 3) / 8 = 7.625 the middle is 13.5.
        assert_eq!(
            [table.at(3, 0), table.at(3, 8), table.at(3, 4)],
            [19, 7, 13]
        );
    }

    #[test]
    fn a_periodic_field_goes_on_with_its_first_nodes() {
        let table = table(Boundary::Periodic, [40, 32]);
        // Between 90 and the first node, 7.
        assert_eq!(table.at(36, 0), 48);
        // Between the last row's 50 and the first row's 7.
        assert_eq!(table.at(0, 28), 28);
        assert_eq!(table.greatest(), 90);
    }
}
