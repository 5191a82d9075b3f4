//! Which samples cover places of a cell, in one list: a cell that is asked about is asked about often, and a list is read at
//! once, where the cells around would be read one by one.

use std::ops::Range;

use glam::IVec2;

/// A sample that covers places of a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Covering {
    /// Its place, counted from the cell's lowest one.
    pub(crate) at: IVec2,
    /// The first bits of its arrival.
    pub(crate) when: u32,
    pub(crate) id: u32,
}

/// Free places behind a new list. Few are enough: only about one sample in seventy is inserted, and not of the
/// pattern. That they are two is chosen, not measured.
const SPARE: u32 = 2;

/// Where a cell's list is.
#[derive(Clone, Copy, Default)]
struct Held {
    start: u32,
    len: u32,
    /// The length that there is memory for; 0 of a cell without a list.
    room: u32,
}

impl Held {
    const fn range(self) -> Range<usize> {
        self.start as usize..(self.start + self.len) as usize
    }
}

/// The lists of some cells, one behind the other in the sequence in which they were asked for.
#[derive(Default)]
pub(crate) struct CoverLists {
    cells: Vec<Held>,
    entries: Vec<Covering>,
    /// The list that is being made.
    found: Vec<Covering>,
}

impl CoverLists {
    /// Removes all lists, and sets how many cells there are.
    pub(crate) fn reset(&mut self, cells: usize) {
        self.cells.clear();
        self.cells.resize(cells, Held::default());
        self.entries.clear();
    }

    /// Returns whether a cell has a list.
    #[inline]
    pub(crate) fn has(&self, cell: usize) -> bool {
        self.cells[cell].room > 0
    }

    /// Returns the list of a cell, in no order.
    #[inline]
    pub(crate) fn of(&self, cell: usize) -> &[Covering] {
        &self.entries[self.cells[cell].range()]
    }

    /// Returns an empty list, to be filled and given to [`Self::put`].
    pub(crate) fn begin(&mut self) -> Vec<Covering> {
        self.found.clear();
        std::mem::take(&mut self.found)
    }

    /// Makes `found` the list of a cell.
    pub(crate) fn put(&mut self, cell: usize, found: Vec<Covering>) {
        let len = found.len() as u32;
        self.cells[cell] = self.append(&found, len + SPARE);
        self.found = found;
    }

    /// Appends a list and free places behind it, `room` in all.
    fn append(&mut self, list: &[Covering], room: u32) -> Held {
        let start = self.entries.len() as u32;
        // Any entry would do: free places are not read.
        let free = Covering {
            at: IVec2::ZERO,
            when: 0,
            id: 0,
        };
        self.entries.extend_from_slice(list);
        self.entries.resize((start + room) as usize, free);
        Held {
            start,
            len: list.len() as u32,
            room,
        }
    }

    /// Adds a sample to the list of a cell that has one. A list without room moves behind the others; its old places
    /// stay unused until all lists are removed.
    pub(crate) fn add(&mut self, cell: usize, sample: Covering) {
        let held = self.cells[cell];
        if held.len == held.room {
            let list = self.of(cell).to_vec();
            self.cells[cell] = self.append(&list, 2 * held.room);
        }
        let held = &mut self.cells[cell];
        self.entries[(held.start + held.len) as usize] = sample;
        held.len += 1;
    }

    /// Removes a sample from the list of a cell.
    pub(crate) fn remove(&mut self, cell: usize, id: u32) {
        let held = &mut self.cells[cell];
        let list = &mut self.entries[held.range()];
        if let Some(at) = list.iter().position(|sample| sample.id == id) {
            list.swap(at, held.len as usize - 1);
            held.len -= 1;
        }
    }
}
