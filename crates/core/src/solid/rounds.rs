//! The darts of a throw, decided on all threads.
//!
//! A dart without an earlier undecided one within the radius is decided: it is kept, since no later dart can change that.
//! So in each round every thread looks at its share of the undecided darts, those that are first around themselves become
//! samples, and those that these cover are dropped. The earliest undecided dart is always among them, so that each round
//! makes progress; and each kept dart is one that taking all darts in sequence would keep, so that the result is the same.

use rayon::prelude::*;

use super::Place;
use super::balls::BallGrid;
use super::darts::SolidDart;
use super::frame::{BallFrame, covers_offset};

/// No entry: fewer darts than 2^32 are thrown at a time.
const NOTHING: u32 = u32::MAX;

/// An undecided dart, or an image of one, in its cell.
struct Entry {
    /// The dart's number in the sequence of arrival.
    number: u32,
    place: Place,
    /// The cell's next entry, of a later dart.
    next: u32,
}

/// The undecided darts by cells.
struct Undecided<'a> {
    frame: &'a BallFrame,
    /// The first entry of each cell.
    heads: &'a mut [u32],
    entries: Vec<Entry>,
}

impl<'a> Undecided<'a> {
    /// Sorts darts into cells. `heads` has nothing in any of them.
    fn new(
        numbers: &[u32],
        darts: &[SolidDart],
        frame: &'a BallFrame,
        heads: &'a mut [u32],
    ) -> Self {
        let mut entries = Vec::with_capacity(numbers.len());
        // From the last to the first, each before those that are there: so a cell's entries follow each other as they arrive.
        for &number in numbers.iter().rev() {
            frame.each_image(darts[number as usize].place, |place| {
                let head = &mut heads[frame.index(place)];
                let next = std::mem::replace(head, entries.len() as u32);
                entries.push(Entry {
                    number,
                    place,
                    next,
                });
            });
        }

        Self {
            frame,
            heads,
            entries,
        }
    }

    /// Returns whether no earlier dart lies within the radius of a dart.
    fn is_first(&self, number: u32, place: Place) -> bool {
        // Cells are searched around a cube, and only those from which a ball reaches `depth` units into the cube. The cube
        // of a dart is its place alone, one unit wide, which a ball need only touch.
        let (side, depth) = (1, 0);
        !self.frame.any_cell_near(place, side, depth, |cell, _| {
            let mut entry = self.heads[cell];
            while entry != NOTHING {
                let other = &self.entries[entry as usize];
                // All that follow in the cell are later ones, too.
                if other.number >= number {
                    return false;
                }
                if covers_offset([0, 1, 2].map(|axis| other.place[axis] - place[axis])) {
                    return true;
                }
                entry = other.next;
            }
            false
        })
    }

    /// Leaves nothing in the cells.
    fn clear(self) {
        for entry in &self.entries {
            self.heads[self.frame.index(entry.place)] = NOTHING;
        }
    }
}

/// Adds to `balls` the darts that would be kept if they were taken in sequence, and returns their places in that sequence.
/// No dart may be covered by a ball that is there already.
pub(super) fn decide_in_rounds(darts: &[SolidDart], balls: &mut BallGrid) -> Vec<Place> {
    let place = |number: u32| darts[number as usize].place;
    let mut heads = vec![NOTHING; balls.frame().count()];
    let mut numbers: Vec<u32> = (0..darts.len() as u32).collect();
    let mut kept = Vec::new();

    while !numbers.is_empty() {
        let undecided = Undecided::new(&numbers, darts, balls.frame(), &mut heads);
        let is_first = |number: &u32| undecided.is_first(*number, place(*number));
        let first: Vec<u32> = numbers.par_iter().copied().filter(is_first).collect();
        undecided.clear();

        for &number in &first {
            balls.insert(place(number));
        }
        // A kept dart covers itself, and is dropped from those that are undecided, too.
        let is_open = |number: &u32| !balls.covers(place(*number));
        numbers = numbers.into_par_iter().filter(is_open).collect();
        kept.extend(first);
    }

    // Darts are numbered in the order of arrival.
    kept.sort_unstable();
    kept.into_iter().map(place).collect()
}
