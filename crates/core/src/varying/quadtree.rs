//! The cells at which the process of darts begins: squares about as wide as the radius there. Places are *near* each
//! other if they are at most the reach of their two radii apart ([`super::rule`]). An *octave* holds the radii from a power of
//! two to the next; the *sight* of a cell says in which octaves samples can be near its places.

use super::field::{RadiusField, RadiusRange};
use super::octaves::{Sight, octave_of};
use super::shape::{Class, Shape};
use crate::lattice::Point;
use crate::stages::disks::{Cell, tiling_cells};

/// A square into which darts are thrown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct VaryingCell {
    pub min: Point,
    /// The binary logarithms of the sides of the base cell of which it is a part, and of its own.
    pub base_bits: u8,
    pub bits: u8,
    /// Which of its places belong to the shape.
    pub class: Class,
    /// The samples that can be near its places.
    pub sight: Sight,
}

impl VaryingCell {
    pub const fn square(&self) -> Cell {
        Cell {
            min: self.min,
            side: 1 << self.bits,
        }
    }
}

/// Returns the base cells: the largest aligned squares that are no wider than the least radius in them. Those without a place of
/// the shape are left out.
pub(super) fn base_cells(field: &RadiusField, shape: &Shape) -> Vec<VaryingCell> {
    // No base cell is wider than the octave of the largest radius.
    let top = 1 << octave_of(field.whole().greatest);
    let squares = tiling_cells(&field.domain().rect(), top).collect();

    let mut base = Vec::new();
    add_base_cells(field, shape, squares, &mut |cell, _| {
        base.push(cell);
    });
    base
}

/// Calls `add` with each base cell in the aligned squares of `stack`, and with the range of the radii in it.
pub(super) fn add_base_cells(
    field: &RadiusField,
    shape: &Shape,
    mut stack: Vec<Cell>,
    add: &mut impl FnMut(VaryingCell, RadiusRange),
) {
    let rect = field.domain().rect();
    while let Some(cell) = stack.pop() {
        let class = shape.class(cell);
        // The cell holds no place of the shape, and so no dart.
        if class == Class::Outside {
            continue;
        }

        let range = field.range(cell);
        if cell.side <= range.least {
            let bits = cell.side.ilog2() as u8;
            let base = VaryingCell {
                min: cell.min,
                base_bits: bits,
                bits,
                class,
                sight: sight_of(field, cell, range.greatest),
            };
            add(base, range);
        } else {
            // Quarters beyond the domain's far borders hold no place of it. Cells do not come off the stack row by row,
            // which does not matter to the process of darts.
            let quarters = cell.quarters().into_iter();
            stack.extend(quarters.filter(|quarter| rect.contains(quarter.min)));
        }
    }
}

/// Returns which samples can be near a place of a cell whose radii are at most `greatest`.
fn sight_of(field: &RadiusField, cell: Cell, greatest: i32) -> Sight {
    // The reach of a place is at most twice its radius.
    let around = field.range_around(cell, 2 * i64::from(greatest));
    Sight {
        octaves: [octave_of(around.least), octave_of(around.greatest)],
        largest: around.greatest,
    }
}
