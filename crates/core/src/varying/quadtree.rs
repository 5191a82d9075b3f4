//! The cells at which the process of darts begins: squares about as wide as the radius there. Places are *near* each
//! other if they are at most the reach of their two radii apart ([`super::rule`]).

use super::field::RadiusField;
use super::octaves::{Sight, octave_of};
use super::shape::{Class, Shape};
use crate::lattice::Point;
use crate::stages::disks::Cell;

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
    let mut base = Vec::new();
    let mut stack = Vec::new();

    // The search begins with cells of the side of the octave of the largest radius. That is at most this radius, and
    // base cells are no wider than the least radius in them.
    let top = octave_of(field.whole().greatest);

    let rect = field.domain().rect();
    for row in 0..=(rect.max.y - 1) >> top {
        for column in 0..=(rect.max.x - 1) >> top {
            stack.push((Point::new(column << top, row << top), top));
        }
    }

    while let Some((min, bits)) = stack.pop() {
        let side = 1 << bits;
        let cell = Cell { min, side };
        let class = shape.class(cell);
        // The cell holds no place of the shape, and so no dart.
        if class == Class::Outside {
            continue;
        }

        let range = field.range(cell);
        if side <= range.least {
            let sight = sight_of(field, cell, range.greatest);
            base.push(VaryingCell {
                min,
                base_bits: bits,
                bits,
                class,
                sight,
            });
        } else {
            let quarters = cell.quarters().map(|quarter| (quarter.min, bits - 1));
            // Quarters beyond the domain's far borders hold no place of it. Cells come off the stack in another order than
            // their places, which does not matter to the process of darts.
            stack.extend(quarters.into_iter().filter(|(min, _)| rect.contains(*min)));
        }
    }

    base
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
