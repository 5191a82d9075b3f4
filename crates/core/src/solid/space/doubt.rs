//! The doubtful parts of a frame: where darts may have been kept that the frame cannot decide.
//!
//! A dart is decided if a sample covers it, or if nothing in doubt is within the radius: neither a place outside of the frame, nor
//! a dart that was in doubt itself, nor a cube that was given up. A cube of the process is given up when all of its places are
//! within the radius of one dart in doubt, or of the outside: its darts would all be in doubt. From then on the cube stands for
//! them. Cubes near others that were given up go on: otherwise all open cubes would be given up one after the other.

use crate::lattice::{R, R_SQUARED};

use super::super::Place;

/// Places in doubt: a cube of a power of two, down to the one place of a dart. Local places, as all here.
#[derive(Clone, Copy)]
struct DoubtCube {
    min: Place,
    side: i32,
}

/// The places in doubt of a frame whose lowest place is 0.
pub(super) struct Doubt {
    /// Cells of side R along each axis.
    cells: [i32; 3],
    /// The cubes that begin in each cell.
    cubes: Vec<Vec<DoubtCube>>,
}

impl Doubt {
    /// Returns a frame of `cells` cells along each axis, in which places near its sides alone are in doubt.
    pub fn new(cells: [i32; 3]) -> Self {
        let count = cells.iter().map(|&count| count as usize).product();
        Self {
            cells,
            cubes: vec![Vec::new(); count],
        }
    }

    fn index(&self, [x, y, z]: [i32; 3]) -> usize {
        ((z * self.cells[1] + y) * self.cells[0] + x) as usize
    }

    /// Puts a cube in doubt.
    pub fn add(&mut self, min: Place, side: i32) {
        let cell = self.index(min.map(|at| at / R));
        self.cubes[cell].push(DoubtCube { min, side });
    }

    /// Returns whether a dart is in doubt that no sample covers.
    pub fn reaches(&self, place: Place) -> bool {
        let (side, of_any_side) = (1, R);
        self.holds(place, side, of_any_side)
    }

    /// Returns whether a cube that no single sample covers is to be given up.
    pub fn gives_up(&self, min: Place, side: i32) -> bool {
        let of_darts = 1;
        self.holds(min, side, of_darts)
    }

    /// Returns whether all places of a cube are within the radius of a place outside of the frame, or of one cube in doubt of at
    /// most the side `largest`.
    fn holds(&self, min: Place, side: i32, largest: i32) -> bool {
        // The nearest place outside is one beyond the lowest or the highest of the frame.
        let is_near_a_side = (0..3).any(|axis| {
            let (from_low, from_high) = (min[axis] + side, self.cells[axis] * R - min[axis]);
            from_low <= R || from_high <= R
        });
        if is_near_a_side {
            return true;
        }

        // Cubes lie in the cell in which they begin: only those of this cell and of its neighbours are near enough.
        let cell = min.map(|at| at / R);
        let is_within = |cube: &DoubtCube| {
            // On an axis the place that is farthest from those in doubt is the lowest or the highest one of the cube.
            // If both lie among those in doubt, neither distance is above 0.
            let squared = |axis: usize| {
                let below = cube.min[axis] - min[axis];
                let above = min[axis] + side - (cube.min[axis] + cube.side);
                i64::from(below.max(above).max(0)).pow(2)
            };
            cube.side <= largest && squared(0) + squared(1) + squared(2) <= R_SQUARED
        };
        // Nothing here is near a side, so that there are neighbours on all sides.
        (-1..=1).any(|z| {
            (-1..=1).any(|y| {
                (-1..=1).any(|x| {
                    let there = self.index([cell[0] + x, cell[1] + y, cell[2] + z]);
                    self.cubes[there].iter().any(is_within)
                })
            })
        })
    }
}
