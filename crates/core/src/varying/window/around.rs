//! The base cells of a window and around it, layer by layer, and which of them can have samples near each other's places.

use std::collections::HashMap;

use glam::I64Vec2;

use crate::lattice::{Point, Rect, Rect64, Window};
use crate::stages::disks::Cell;
use crate::varying::field::{RadiusField, RadiusRange};
use crate::varying::octaves::octave_of;
use crate::varying::rule::most_reach;
use crate::varying::shape::{Class, Shape};

/// A square of the plane, in which a periodic domain repeats.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneSquare {
    /// Its lowest place.
    pub min: I64Vec2,
    pub side: i64,
}

impl PlaneSquare {
    /// Returns the square of the distance between the nearest places of two squares.
    pub fn gap_squared(&self, other: &Self) -> i64 {
        let above = other.min - (self.min + (self.side - 1));
        let below = self.min - (other.min + (other.side - 1));
        above.max(below).max(I64Vec2::ZERO).length_squared()
    }

    /// Returns the square of the longest distance between a place of this square and the place of another that is nearest to it.
    pub fn farthest_gap_squared(&self, other: &Self) -> i64 {
        // The nearest place lies beside a place, unless that is beyond an end of the other square. So the distance along an
        // axis is longest at one of this square's ends.
        let above = other.min - self.min;
        let below = (self.min + (self.side - 1)) - (other.min + (other.side - 1));
        above.max(below).max(I64Vec2::ZERO).length_squared()
    }

    fn meets(&self, rect: &Rect64) -> bool {
        (self.min.cmplt(rect.max) & rect.min.cmplt(self.min + self.side)).all()
    }
}

/// A base cell in the plane.
pub(super) struct PlaneCell {
    pub square: PlaneSquare,
    /// Its lowest place in the domain.
    pub min: Point,
    /// The binary logarithm of its side.
    pub bits: u8,
    /// Which of its places belong to the shape.
    pub class: Class,
    pub range: RadiusRange,
}

impl PlaneCell {
    /// Returns whether a sample of at most a radius in a square can be near a place of the cell.
    pub fn is_reached_from(&self, square: &PlaneSquare, radius: i32) -> bool {
        let reach = i64::from(most_reach(radius, self.range.greatest));
        self.square.gap_squared(square) <= reach * reach
    }
}

/// The base cells of a window, those whose samples can be near a place of it, those whose samples can be near a place of these,
/// and so on. The cells of the last layer stand for all that is beyond.
pub(super) struct CellsAround<'a> {
    field: &'a RadiusField,
    shape: &'a Shape,
    /// Layer after layer, from the cells of the window on.
    pub cells: Vec<PlaneCell>,
    /// How many cells meet the window.
    pub own: usize,
    /// Of each cell before those of the last layer, the numbers of the cells in which samples can be near its places, its
    /// own among them.
    pub near: Vec<Box<[u32]>>,
    /// The numbers of the cells by their lowest places in the plane, of which no two cells have the same.
    numbers: HashMap<I64Vec2, u32>,
}

impl<'a> CellsAround<'a> {
    /// Returns the base cells that meet a window and hold a place of the shape, as a first layer.
    pub fn of(field: &'a RadiusField, shape: &'a Shape, window: &Window) -> Self {
        let mut around = Self {
            field,
            shape,
            cells: Vec::new(),
            own: 0,
            near: Vec::new(),
            numbers: HashMap::new(),
        };
        around.visit(window, |square, _| square.meets(window));
        around.own = around.cells.len();
        around
    }

    /// Adds a layer.
    pub fn widen(&mut self) {
        for number in self.near.len()..self.cells.len() {
            let PlaneCell { square, range, .. } = self.cells[number];
            // No reach is longer than twice the smaller radius.
            let farthest = 2 * i64::from(range.greatest);
            let rect = Rect64 {
                min: square.min,
                max: square.min + square.side,
            };
            let found = self.visit(&rect.grown(farthest, farthest), |other, greatest| {
                let reach = i64::from(most_reach(range.greatest, greatest));
                square.gap_squared(other) <= reach * reach
            });
            self.near.push(found.into());
        }
    }

    /// Returns the numbers of the base cells that meet a rectangle of the plane and are wanted. `is_wanted` says it of a square and
    /// its greatest radius, and of a square if of a part of it. Cells that were not there are added.
    fn visit(&mut self, rect: &Rect64, is_wanted: impl Fn(&PlaneSquare, i32) -> bool) -> Vec<u32> {
        let domain = self.field.domain();
        let sides = I64Vec2::new(domain.width().into(), domain.height().into());
        let places = domain.rect();
        // The images of a periodic domain that the rectangle may meet.
        let [first, last] = if domain.is_periodic() {
            [rect.min, rect.max - 1].map(|at| at.div_euclid(sides))
        } else {
            [I64Vec2::ZERO; 2]
        };

        let mut found = Vec::new();
        for row in first.y..=last.y {
            for column in first.x..=last.x {
                let shift = I64Vec2::new(column, row) * sides;
                // In 64 bits, as the rectangle may lie beyond all places of 32.
                if let Some(part) = rect.moved(-shift).within(&places) {
                    self.visit_part(&part, shift, &is_wanted, &mut found);
                }
            }
        }
        found
    }

    /// Visits, as [`Self::visit`], the cells that meet a part of the domain, where `shift` leads from the domain to the plane.
    fn visit_part(
        &mut self,
        part: &Rect,
        shift: I64Vec2,
        is_wanted: &impl Fn(&PlaneSquare, i32) -> bool,
        found: &mut Vec<u32>,
    ) {
        let mut stack: Vec<Cell> = top_squares(self.field, part).collect();
        while let Some(cell) = stack.pop() {
            let square = PlaneSquare {
                min: I64Vec2::from(cell.min) + shift,
                side: cell.side.into(),
            };
            // Most cells are visited from many others, and searched for in the field and in the shape only once.
            let known = self.numbers.get(&square.min).copied();
            if let Some(number) = known {
                let other = &self.cells[number as usize];
                if other.square.side == square.side {
                    if is_wanted(&square, other.range.greatest) {
                        found.push(number);
                    }
                    continue;
                }
            }

            let range = self.field.range(cell);
            if !is_wanted(&square, range.greatest) {
                continue;
            }
            let class = self.shape.class(cell);
            // Without a place of the shape there is no dart.
            if class == Class::Outside {
                continue;
            }
            // As `add_base_cells` finds them, from above.
            if cell.side <= range.least {
                let number = self.cells.len() as u32;
                self.numbers.insert(square.min, number);
                self.cells.push(PlaneCell {
                    square,
                    min: cell.min,
                    bits: cell.side.ilog2() as u8,
                    class,
                    range,
                });
                found.push(number);
            } else {
                let quarters = cell.quarters().into_iter();
                stack.extend(quarters.filter(|quarter| meets(quarter, part)));
            }
        }
    }
}

/// Returns the squares of the largest base cells that a part of the domain meets.
fn top_squares(field: &RadiusField, part: &Rect) -> impl Iterator<Item = Cell> + use<> {
    let bits = octave_of(field.whole().greatest);
    let Rect { min, max } = *part;
    let starts =
        move |min: i32, max: i32| (min >> bits..=(max - 1) >> bits).map(move |k| k << bits);
    starts(min.y, max.y).flat_map(move |y| {
        starts(min.x, max.x).map(move |x| Cell {
            min: Point::new(x, y),
            side: 1 << bits,
        })
    })
}

/// Returns whether a cell of the domain has a place in a part of it.
fn meets(cell: &Cell, part: &Rect) -> bool {
    // Offsets, since a cell may reach beyond all places of 32 bits.
    let above = part.min - cell.min;
    (cell.min.x < part.max.x && cell.min.y < part.max.y) && above.max_element() < cell.side
}
