//! The radius at each place: one for all places, or integers at nodes and bilinear between them. Every decision about a
//! varying radius is made with the integer that this file gives.

use thiserror::Error;

use super::patch::FieldPatch;
use crate::lattice::{Domain, Point, R};
use crate::stages::disks::Cell;

/// The largest radius of a field, 64 times the smallest: sums of bilinear values then fit 64 bits with the largest
/// pitch.
pub const MAX_FIELD_RADIUS: i32 = 64 * R;

/// The largest pitch of nodes, which is how far neighbours are apart, and of the pixels of a mask, is two to this power.
pub const MAX_PITCH_BITS: u32 = 20;

/// Sides of a periodic domain are longer than this many of its largest radii, so that a sample near a place is
/// found once, and not again as its own image.
const MIN_PERIODIC_RADII: i32 = 4;

/// Why a field is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FieldError {
    /// A radius is too small or too large.
    #[error(
        "the radius {radius} at node {node} is not from {R} to {MAX_FIELD_RADIUS} units: the largest radius is at most 64 times the smallest"
    )]
    Radius {
        /// The refused radius, in units.
        radius: i32,
        /// The index of its node, row by row.
        node: usize,
    },
    /// The pitch is too large.
    #[error("nodes are 2^{bits} units apart; at most 2^{MAX_PITCH_BITS} are possible")]
    Pitch {
        /// The binary logarithm of the pitch.
        bits: u32,
    },
    /// The sides of a periodic domain are no multiples of the pitch.
    #[error(
        "a side of the periodic domain has {side} units, which is no multiple of the 2^{bits} units between nodes"
    )]
    Uneven {
        /// The length of such a side, in units.
        side: i32,
        /// The binary logarithm of the pitch.
        bits: u32,
    },
    /// There are too few or too many nodes.
    #[error("{given} nodes are given; the domain has {columns} x {rows}")]
    Count {
        /// How many nodes are given.
        given: usize,
        /// Nodes of a row that are needed.
        columns: usize,
        /// Rows that are needed.
        rows: usize,
    },
    /// A periodic domain is too small for its largest radius.
    #[error(
        "the shorter side of the periodic domain has {side} units; more than {MIN_PERIODIC_RADII} times the largest radius, {radius}, are needed"
    )]
    Period {
        /// The length of the shorter side, in units.
        side: i32,
        /// The largest radius of the field, in units.
        radius: i32,
    },
}

/// The radius at each lattice point of a domain, in units.
///
/// Nodes are 2^b units apart, the first at the domain's corner. Between them the radius is bilinear, rounded down.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct RadiusField {
    domain: Domain,
    /// Cells of four nodes are 2^`bits` units wide. One such cell holds a whole domain of constant radius.
    bits: u32,
    /// Cells of a row and of a column.
    cells: [usize; 2],
    /// The nodes around all cells, row by row: where the domain is periodic, the first ones again at the end.
    nodes: Vec<i32>,
    /// Blocks of 2 x 2 cells, of 4 x 4, and so on up to one of all.
    levels: Vec<RadiusBlocks>,
}

/// The least and the greatest of some radii.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) struct RadiusRange {
    pub least: i32,
    pub greatest: i32,
}

/// The ranges of the nodes of blocks of one size.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
struct RadiusBlocks {
    columns: usize,
    ranges: Vec<RadiusRange>,
}

impl RadiusRange {
    /// The range of no radii: joined with another one it gives that.
    const NOTHING: Self = Self {
        least: i32::MAX,
        greatest: i32::MIN,
    };

    fn of(radii: [i32; 4]) -> Self {
        let [a, b, c, d] = radii;
        Self {
            least: a.min(b).min(c.min(d)),
            greatest: a.max(b).max(c.max(d)),
        }
    }

    fn and(self, other: Self) -> Self {
        Self {
            least: self.least.min(other.least),
            greatest: self.greatest.max(other.greatest),
        }
    }
}

/// Returns the error of the first radius out of range, if there is one.
fn check_radii(nodes: &[i32]) -> Result<(), FieldError> {
    let allowed = R..=MAX_FIELD_RADIUS;
    match nodes.iter().position(|radius| !allowed.contains(radius)) {
        Some(node) => Err(FieldError::Radius {
            radius: nodes[node],
            node,
        }),
        None => Ok(()),
    }
}

impl RadiusField {
    /// Returns the field of one radius everywhere.
    ///
    /// Fails when the radius is not from [`R`] to [`MAX_FIELD_RADIUS`], or the domain is too small for it.
    pub fn constant(domain: Domain, radius: i32) -> Result<Self, FieldError> {
        check_radii(&[radius])?;
        // The one cell is a unit wide. Places beyond it have the radius at its end (see `at`), which is the same.
        Self::new(domain, 0, [1, 1], vec![radius; 4])
    }

    /// Returns the field with these radii at its nodes, row by row, [`Self::node_counts`] of them.
    ///
    /// Fails when the pitch does not suit the domain, there are too few or too many nodes, a radius is not from [`R`] to
    /// [`MAX_FIELD_RADIUS`], or a periodic domain is too small for the largest.
    pub fn from_nodes(domain: Domain, pitch_bits: u32, nodes: &[i32]) -> Result<Self, FieldError> {
        let [columns, rows] = Self::node_counts(&domain, pitch_bits)?;
        if nodes.len() != columns * rows {
            return Err(FieldError::Count {
                given: nodes.len(),
                columns,
                rows,
            });
        }

        // Before nodes are repeated, so that the error counts them as they were given.
        check_radii(nodes)?;

        // A periodic domain has a cell for each node, the last of which ends at the first nodes again.
        let cells = [columns, rows].map(|count| count - usize::from(!domain.is_periodic()));
        let mut around = Vec::with_capacity((cells[0] + 1) * (cells[1] + 1));
        for row in 0..=cells[1] {
            let of_row = &nodes[row % rows * columns..][..columns];
            around.extend((0..=cells[0]).map(|column| of_row[column % columns]));
        }
        Self::new(domain, pitch_bits, cells, around)
    }

    /// Returns how many nodes a row and a column have: in a periodic domain one for each pitch; in a bounded one they
    /// end at the far border or beyond it.
    ///
    /// Fails when the pitch is above 2^[`MAX_PITCH_BITS`], or a side of a periodic domain is no multiple of it.
    pub fn node_counts(domain: &Domain, pitch_bits: u32) -> Result<[usize; 2], FieldError> {
        let bits = pitch_bits;
        if bits > MAX_PITCH_BITS {
            return Err(FieldError::Pitch { bits });
        }

        let sides = [domain.width(), domain.height()];
        let uneven = sides.into_iter().find(|side| side % (1 << bits) != 0);
        if let Some(side) = uneven.filter(|_| domain.is_periodic()) {
            return Err(FieldError::Uneven { side, bits });
        }

        // In a bounded domain the last cell has nodes on its far side, too.
        let closed = usize::from(!domain.is_periodic());
        Ok(sides.map(|side| ((side - 1) >> bits) as usize + 1 + closed))
    }

    /// Returns the field of the nodes around `cells`, 2^`bits` units apart, with their blocks. The radii must have been
    /// checked. Refuses a periodic domain that is too small for the largest.
    fn new(
        domain: Domain,
        bits: u32,
        cells: [usize; 2],
        nodes: Vec<i32>,
    ) -> Result<Self, FieldError> {
        let mut field = Self {
            domain,
            bits,
            cells,
            nodes,
            levels: Vec::new(),
        };

        field.build_levels();
        // Blocks come first, since the largest radius is read from them.
        let (side, radius) = (domain.width().min(domain.height()), field.whole().greatest);

        if domain.is_periodic() && side <= MIN_PERIODIC_RADII * radius {
            return Err(FieldError::Period { side, radius });
        }
        Ok(field)
    }

    /// Makes the levels above the cells, each with the ranges of two by two parts of the level below, up to a single
    /// block.
    fn build_levels(&mut self) {
        let mut below = self.cells;
        while below != [1, 1] {
            let [columns, rows] = below.map(|count| count.div_ceil(2));
            let size = self.levels.len();

            let mut ranges = Vec::with_capacity(columns * rows);
            for row in 0..rows {
                for column in 0..columns {
                    let end = [2 * column + 1, 2 * row + 1];
                    // An odd count leaves its last block with half of its cells.
                    let last = [0, 1].map(|axis| end[axis].min(below[axis] - 1));
                    // Parts of this size are those of the level below, or the cells.
                    ranges.push(self.blocks(size, [2 * column, 2 * row], last));
                }
            }

            self.levels.push(RadiusBlocks { columns, ranges });
            below = [columns, rows];
        }
    }

    /// Returns the domain at whose places the radii are.
    #[must_use]
    pub const fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Returns the radius at a place of the domain.
    #[inline]
    #[must_use]
    pub fn radius_at(&self, place: Point) -> i32 {
        self.at(place.x.into(), place.y.into())
    }

    /// Returns the radius at a place that is not negative; beyond the last nodes it is that at the nearest place
    /// among them.
    #[inline]
    fn at(&self, x: i64, y: i64) -> i32 {
        self.patch(x, y).at(x, y)
    }

    /// Returns the nodes around a place that is not negative, or those nearest to one beyond the last nodes.
    #[inline]
    fn patch(&self, x: i64, y: i64) -> FieldPatch {
        let bits = self.bits;
        let column = ((x >> bits) as usize).min(self.cells[0] - 1);
        let row = ((y >> bits) as usize).min(self.cells[1] - 1);

        let below = row * (self.cells[0] + 1) + column;
        let above = below + self.cells[0] + 1;
        FieldPatch {
            x: (column as i64) << bits,
            y: (row as i64) << bits,
            bits,
            nodes: [below, below + 1, above, above + 1].map(|node| self.nodes[node]),
        }
    }

    /// Returns the least and the greatest radius of all nodes, in units; those of all places lie between them.
    #[must_use]
    pub fn extremes(&self) -> [i32; 2] {
        let range = self.whole();
        [range.least, range.greatest]
    }

    /// Returns the range of all radii.
    pub(super) fn whole(&self) -> RadiusRange {
        let last = self.cells.map(|count| count - 1);
        self.cells_range([0, 0], last)
    }

    /// Returns the radii at the corners of a cell that is no wider than the pitch and begins in the domain: lower left,
    /// lower right, upper left, upper right. All radii in it lie between them, as a bilinear function has its extremes
    /// at corners. Of wider cells it returns `None`.
    ///
    /// A cell that reaches beyond the domain is not cut off there, so that the radii of its quarters follow from its
    /// corners by averages.
    #[inline]
    pub(super) fn corners(&self, Cell { min, side }: Cell) -> Option<[i32; 4]> {
        if side > 1 << self.bits {
            return None;
        }
        let (x, y) = (i64::from(min.x), i64::from(min.y));
        let (right, top) = (x + i64::from(side) - 1, y + i64::from(side) - 1);
        // Cells begin at multiples of their sides, which are powers of two as the pitch is: this one lies between four nodes.
        let patch = self.patch(x, y);
        Some([
            patch.at(x, y),
            patch.at(right, y),
            patch.at(x, top),
            patch.at(right, top),
        ])
    }

    /// Returns lower bounds of the radii in a cell's quarters, and an upper bound of all.
    pub(super) fn quarter_bounds(&self, cell: Cell) -> ([i32; 4], i32) {
        let Some([a, b, c, d]) = self.corners(cell) else {
            let range = self.range(cell);
            return ([range.least; 4], range.greatest);
        };

        // On edges a bilinear function is linear, and in the middle it is the mean of the corners. A quarter's radii
        // are not below the least of its corner of the cell, the middles of two edges, and the middle of the cell.
        let [ab, ac, bd, cd] = [a + b, a + c, b + d, c + d].map(|sum| sum / 2);
        let middle = (a + b + c + d) / 4;
        let quarters = [[a, ab, ac], [b, ab, bd], [c, ac, cd], [d, bd, cd]];
        let least = quarters.map(|radii| radii.into_iter().fold(middle, i32::min));
        (least, a.max(b).max(c).max(d))
    }

    /// Returns radii between which all radii of a cell lie that begins in the domain. Those of its corners if it is no
    /// wider than the pitch; otherwise those of all nodes around it. Which cells throw darts depends on this: it is
    /// part of the definition of the set.
    pub(super) fn range(&self, cell: Cell) -> RadiusRange {
        // Base cells ask so often that one radius everywhere, which needs no search, is looked for first.
        if let Some(range) = self.of_one_radius() {
            return range;
        }
        if let Some(corners) = self.corners(cell) {
            return RadiusRange::of(corners);
        }

        let last = i64::from(cell.side) - 1;
        let min = [i64::from(cell.min.x), i64::from(cell.min.y)];
        let cell_of =
            |value: i64, axis: usize| ((value >> self.bits) as usize).min(self.cells[axis] - 1);
        let first_cell = [0, 1].map(|axis| cell_of(min[axis], axis));
        let last_cell = [0, 1].map(|axis| cell_of(min[axis] + last, axis));
        self.cells_range(first_cell, last_cell)
    }

    /// Returns the range of all radii if they are the same everywhere.
    #[inline]
    fn of_one_radius(&self) -> Option<RadiusRange> {
        // A field of one cell has no blocks.
        let whole = match self.levels.last() {
            Some(level) => level.ranges[0],
            None => self.around(0, 0),
        };
        (whole.least == whole.greatest).then_some(whole)
    }

    /// Returns radii between which all radii lie that are at most `reach` from a cell on both axes.
    pub(super) fn range_around(&self, cell: Cell, reach: i64) -> RadiusRange {
        if let Some(range) = self.of_one_radius() {
            return range;
        }
        let spans = [cell.min.x, cell.min.y].map(|min| {
            let (min, side) = (i64::from(min), i64::from(cell.side));
            [min - reach, min + side - 1 + reach].map(|value| value >> self.bits)
        });
        // A span across the border of a periodic domain is two spans.
        let [columns, rows] = [0, 1].map(|axis| self.cell_spans(spans[axis], axis));

        let mut range = RadiusRange::NOTHING;
        for [bottom, top] in rows.into_iter().flatten() {
            for [left, right] in columns.into_iter().flatten() {
                range = range.and(self.cells_range([left, bottom], [right, top]));
            }
        }
        range
    }

    /// Returns the first and the last cell of a span along an axis, which may leave the domain. If the domain is
    /// periodic, the part beyond its end is returned as a second span at the other side. Without such a rest, the
    /// second one is `None`.
    fn cell_spans(&self, [first, last]: [i64; 2], axis: usize) -> [Option<[usize; 2]>; 2] {
        let count = self.cells[axis] as i64;
        let cells = |first: i64, last: i64| Some([first as usize, last as usize]);
        if !self.domain.is_periodic() {
            // Beyond a closed border there are no samples: the nearest cells stand for those there.
            return [
                cells(first.clamp(0, count - 1), last.clamp(0, count - 1)),
                None,
            ];
        }

        // A span that is at least as long as the axis meets all cells. Each is returned once.
        if last - first + 1 >= count {
            return [cells(0, count - 1), None];
        }

        let (first, last) = (first.rem_euclid(count), last.rem_euclid(count));
        if first <= last {
            [cells(first, last), None]
        } else {
            [cells(first, count - 1), cells(0, last)]
        }
    }

    /// Returns the range of the nodes around some cells, or a little more.
    fn cells_range(&self, first: [usize; 2], last: [usize; 2]) -> RadiusRange {
        // A field of one radius, which is asked most often, has one cell and no blocks.
        if self.levels.is_empty() {
            return self.around(0, 0);
        }

        // The smallest blocks of which three or fewer on each axis hold all cells: at most nine ranges are read. The
        // last level has a single block, which always does.
        let spread =
            |size: usize| (0..2).all(|axis| (last[axis] >> size) - (first[axis] >> size) <= 2);
        // `least` is the largest size whose blocks are at most a quarter as long as `longest`, or 0 if there is none.
        // Smaller blocks are not tried: more than three of them would be needed on the longer axis.
        let longest = (last[0] - first[0]).max(last[1] - first[1]);
        let least = (longest / 4).checked_ilog2().unwrap_or(0) as usize;
        let size = (least..self.levels.len())
            .find(|&size| spread(size))
            .unwrap_or(self.levels.len());
        self.blocks(
            size,
            first.map(|cell| cell >> size),
            last.map(|cell| cell >> size),
        )
    }

    /// Returns the range of the nodes around some blocks of 2^`size` x 2^`size` cells.
    fn blocks(&self, size: usize, first: [usize; 2], last: [usize; 2]) -> RadiusRange {
        let mut range = RadiusRange::NOTHING;
        for row in first[1]..=last[1] {
            for column in first[0]..=last[0] {
                // Size 0 is that of single cells, which have no level: the first is that of 2 x 2 cells.
                let level = size.checked_sub(1).map(|level| &self.levels[level]);
                let block = level.map_or_else(
                    || self.around(row, column),
                    |level| level.ranges[row * level.columns + column],
                );
                range = range.and(block);
            }
        }
        range
    }

    /// Returns the range of the nodes around a cell.
    fn around(&self, row: usize, column: usize) -> RadiusRange {
        let below = row * (self.cells[0] + 1) + column;
        let above = below + self.cells[0] + 1;
        let nodes = [below, below + 1, above, above + 1];
        RadiusRange::of(nodes.map(|node| self.nodes[node]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Boundary, Rect};
    use crate::random::{Key, Stream};

    /// A field of random nodes that are 2^13 units apart.
    fn field(boundary: Boundary, width: i32, height: i32) -> RadiusField {
        let domain = Domain::from_units(width, height, boundary);
        let [columns, rows] = RadiusField::node_counts(&domain, 13).unwrap();
        let node = |index: usize| {
            let [word, _] = Key::from_seed(5).draw(Stream::Dart, index as u32);
            R + (word >> 18) as i32
        };
        let nodes: Vec<i32> = (0..columns * rows).map(node).collect();
        RadiusField::from_nodes(domain, 13, &nodes).unwrap()
    }

    /// Returns the range of the radii at places of a rectangle that are 2^11 apart, at its ends, and at nodes.
    fn seen(field: &RadiusField, rect: &Rect) -> RadiusRange {
        let places = |min: i32, max: i32| {
            let inner = (min..max).filter(|value| value % (1 << 11) == 0);
            inner.chain([min, max - 1]).collect::<Vec<_>>()
        };
        let columns = places(rect.min.x, rect.max.x);
        let mut range = RadiusRange::NOTHING;
        for y in places(rect.min.y, rect.max.y) {
            for &x in &columns {
                let radius = field.at(x.into(), y.into());
                range = range.and(RadiusRange::of([radius; 4]));
            }
        }
        range
    }

    #[test]
    fn ranges_hold_the_radii_of_all_places() {
        let fields = [
            field(Boundary::Periodic, 27 << 13, 29 << 13),
            field(Boundary::Bounded, (19 << 13) + 5_000, 17 << 13),
        ];
        for field in fields {
            let rect = field.domain().rect();
            assert!(seen(&field, &rect).least >= field.whole().least);
            for bits in 10..19 {
                let side = 1 << bits;
                let starts = |end: i32| (0..end).step_by(side as usize);
                for (x, y) in
                    starts(rect.max.x).flat_map(|x| starts(rect.max.y).map(move |y| (x, y)))
                {
                    let min = Point::new(x, y);
                    let cell = Cell { min, side };
                    let max = Point::new((x + side).min(rect.max.x), (y + side).min(rect.max.y));
                    let (range, seen) = (field.range(cell), seen(&field, &Rect { min, max }));
                    assert!(range.least <= seen.least && range.greatest >= seen.greatest);
                    let whole = max == Point::new(x + side, y + side);
                    assert!(bits > 13 || !whole || range == seen);

                    let around = field.range_around(cell, 9_000);
                    let wide = field.range_around(cell, 0);
                    assert!(around.least <= wide.least && wide.least <= seen.least);
                    assert!(around.greatest >= wide.greatest && wide.greatest >= seen.greatest);
                }
            }
        }
    }

    #[test]
    fn what_is_around_a_cell_goes_on_at_the_other_side() {
        let domain = Domain::from_units(40 << 13, 40 << 13, Boundary::Periodic);
        let mut nodes = vec![R; 1600];
        nodes[39 * 40 + 20] = 2 * R;
        let field = RadiusField::from_nodes(domain, 13, &nodes).unwrap();
        let cell = Cell {
            min: Point::new(20 << 13, 0),
            side: 1 << 12,
        };
        assert_eq!(field.range_around(cell, 1).greatest, 2 * R);
        assert_eq!(field.range(cell).greatest, R);
        let far = Cell {
            min: Point::new(20 << 13, 20 << 13),
            side: 1 << 12,
        };
        assert_eq!(field.range_around(far, 1 << 15).greatest, R);
        assert_eq!(field.range_around(far, 40 << 13).greatest, 2 * R);
    }

    #[test]
    fn what_is_no_field_is_refused_in_words() {
        let domain = |boundary| Domain::from_units(20 << 15, 10 << 15, boundary);
        let (periodic, bounded) = (domain(Boundary::Periodic), domain(Boundary::Bounded));
        let words = |error: FieldError| error.to_string();
        let constant = |radius| words(RadiusField::constant(periodic, radius).unwrap_err());
        assert!(
            constant(R - 1).starts_with("the radius 32767 at node 0 is not from 32768 to 2097152")
        );
        assert!(
            constant(3 * R).contains("more than 4 times the largest radius, 98304, are needed")
        );
        assert!(RadiusField::constant(bounded, 3 * R).is_ok());

        assert_eq!(RadiusField::node_counts(&periodic, 15), Ok([20, 10]));
        assert_eq!(RadiusField::node_counts(&bounded, 15), Ok([21, 11]));
        assert_eq!(RadiusField::node_counts(&bounded, 17), Ok([6, 4]));
        let uneven = RadiusField::node_counts(&periodic, 17).unwrap_err();
        assert!(words(uneven).contains("a side of the periodic domain has 327680 units"));
        let coarse = RadiusField::node_counts(&bounded, 21).unwrap_err();
        assert!(words(coarse).starts_with("nodes are 2^21 units apart"));
        let few = RadiusField::from_nodes(bounded, 15, &[R; 200]).unwrap_err();
        assert_eq!(words(few), "200 nodes are given; the domain has 21 x 11");
        let mut low = [R; 200];
        low[45] = R - 1;
        let low = RadiusField::from_nodes(periodic, 15, &low).unwrap_err();
        assert!(words(low).starts_with("the radius 32767 at node 45 "));
    }
}
