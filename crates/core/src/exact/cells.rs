//! Numbers of things with their places, in cells of side R that lie behind one another in memory. Darts arrive all over the
//! domain, so that a look at a place must touch little memory.

use crate::lattice::{Point, R, Rect};

/// Numbers in one part of a cell. Four samples more than R apart fit into no cell, but those of several blocks do.
const SLOTS: usize = 3;

/// The number that stands in a slot without any.
const FREE: u32 = u32::MAX;

/// Part of a cell: its first one, or more of a crowded one.
#[derive(Clone, Copy, Debug)]
struct CellPart {
    places: [Point; SLOTS],
    numbers: [u32; SLOTS],
    /// The index of the next part; 0, which is a cell's first, if there is none.
    next: u32,
}

impl CellPart {
    const EMPTY: Self = Self {
        places: [Point::new(0, 0); SLOTS],
        numbers: [FREE; SLOTS],
        next: 0,
    };
}

/// Numbers by cell, row by row, from place (0, 0) on.
#[derive(Clone, Debug, Default)]
pub(crate) struct NumberCells {
    columns: usize,
    count: usize,
    /// First of all one part of each cell, then what crowded ones have more.
    parts: Vec<CellPart>,
}

impl NumberCells {
    /// Empties the cells, and sets the first place beyond them.
    pub(crate) fn reset(&mut self, end: Point) {
        let cells = |end: i32| ((end - 1) / R + 1) as usize;
        self.columns = cells(end.x);
        self.count = self.columns * cells(end.y);
        self.parts.clear();
        self.parts.resize(self.count, CellPart::EMPTY);
    }

    /// Returns how many cells there are.
    pub(crate) const fn count(&self) -> usize {
        self.count
    }

    /// Returns the index of the cell of a place.
    #[inline]
    pub(crate) const fn index(&self, place: Point) -> usize {
        (place.y / R) as usize * self.columns + (place.x / R) as usize
    }

    /// Adds a number at a place.
    #[inline]
    pub(crate) fn add(&mut self, place: Point, number: u32) {
        let mut part = self.index(place);
        loop {
            let CellPart {
                places,
                numbers,
                next,
            } = &mut self.parts[part];
            // A removal may have left a slot free before the last part.
            if let Some(slot) = numbers.iter().position(|&held| held == FREE) {
                (places[slot], numbers[slot]) = (place, number);
                return;
            }

            part = match *next {
                0 => self.append(part),
                next => next as usize,
            };
        }
    }

    #[cold]
    fn append(&mut self, part: usize) -> usize {
        let appended = self.parts.len();
        self.parts[part].next = appended as u32;
        self.parts.push(CellPart::EMPTY);
        appended
    }

    /// Removes a number from the cell of its place.
    pub(crate) fn remove(&mut self, place: Point, number: u32) {
        let mut part = self.index(place);
        loop {
            let CellPart { numbers, next, .. } = &mut self.parts[part];
            if let Some(slot) = numbers.iter_mut().find(|held| **held == number) {
                *slot = FREE;
                return;
            }
            debug_assert_ne!(*next, 0, "{number} is in no part of its cell");
            part = *next as usize;
        }
    }

    /// Calls `visit` with the numbers of a cell, and their places.
    #[inline]
    pub(crate) fn each_in(&self, column: i32, row: i32, mut visit: impl FnMut(u32, Point)) {
        let mut part = &self.parts[row as usize * self.columns + column as usize];
        loop {
            for (&number, &place) in part.numbers.iter().zip(&part.places) {
                if number != FREE {
                    visit(number, place);
                }
            }
            if part.next == 0 {
                return;
            }
            part = &self.parts[part.next as usize];
        }
    }

    /// Calls `visit` with the numbers, and their places, in all cells that a rectangle touches, until it returns
    /// `true`; returns whether it did.
    #[inline]
    pub(crate) fn any_in(&self, rect: &Rect, mut visit: impl FnMut(u32, Point) -> bool) -> bool {
        let columns = (rect.min.x / R) as usize..=((rect.max.x - 1) / R) as usize;

        for row in (rect.min.y / R) as usize..=((rect.max.y - 1) / R) as usize {
            let start = row * self.columns;
            let parts = &self.parts[start + columns.start()..=start + columns.end()];
            for first in parts {
                let mut part = first;
                loop {
                    for (&number, &place) in part.numbers.iter().zip(&part.places) {
                        // Removals leave free slots between others, so that all are looked at.
                        if number != FREE && visit(number, place) {
                            return true;
                        }
                    }
                    if part.next == 0 {
                        break;
                    }
                    part = &self.parts[part.next as usize];
                }
            }
        }
        false
    }
}
