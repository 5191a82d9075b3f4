//! Samples of a box in nearly cubic cells. A search around a place looks at the cell of the place and at the cells
//! beside that cell. A cell is a chain of samples, so that a sample comes and goes without moving another.

use crate::region::Boundary;

use super::solid_box::SolidBox;

/// Cells beyond these would take more memory than the samples; the cells of larger boxes are larger.
const MAX_CELLS: u64 = 4_194_304;

/// The rounding of a border of cells, in units, with room to spare.
const ROUNDING: f64 = 0.01;

/// The end of a chain of samples.
const END: u32 = u32::MAX;

/// A sample with what follows it in its cell.
#[derive(Clone, Copy, Debug)]
struct Link {
    place: [i32; 3],
    next: u32,
}

/// The samples of a box, by slot.
#[derive(Clone, Debug)]
pub(super) struct SolidGrid {
    /// The sides of the box, in units.
    size: [i64; 3],
    is_periodic: bool,
    /// How many cells there are along each axis.
    counts: [usize; 3],
    /// How many cells a unit holds, along each axis.
    per_unit: [f64; 3],
    /// The first sample of each cell, row by row and layer by layer.
    heads: Vec<u32>,
    /// Samples by slot. Those of slots that are in no chain mean nothing.
    links: Vec<Link>,
}

impl SolidGrid {
    /// Returns the empty grid of a box, with cells whose edges are at least `edge` units where the box is so large.
    pub fn new(solid: SolidBox, edge: f64) -> Self {
        let extent = solid.size.map(f64::from);
        let counts_of = |edge: f64| extent.map(|side| (side / edge).floor().max(1.0) as u64);
        let mut edge = edge;
        // Twice the edge gives at most half as many cells, unless there is only one: the loop ends.
        // The product of three counts may exceed 64 bits, but not the range of `f64`.
        let product =
            |edge: f64| -> f64 { counts_of(edge).iter().map(|&count| count as f64).product() };
        while product(edge) > MAX_CELLS as f64 {
            edge *= 2.0;
        }

        let counts = counts_of(edge);
        let cells = counts.iter().product::<u64>() as usize;
        Self {
            size: solid.size.map(i64::from),
            is_periodic: solid.boundary == Boundary::Periodic,
            counts: counts.map(|count| count as usize),
            per_unit: [0, 1, 2].map(|axis| counts[axis] as f64 / extent[axis]),
            heads: vec![END; cells],
            links: Vec::new(),
        }
    }

    /// Takes out all samples.
    pub fn clear(&mut self) {
        self.heads.fill(END);
        self.links.clear();
    }

    /// Returns the place of a slot.
    pub fn place(&self, slot: u32) -> [i32; 3] {
        self.links[slot as usize].place
    }

    /// The column, the row and the layer of a place.
    fn cell_of(&self, place: [i32; 3]) -> [usize; 3] {
        [0, 1, 2].map(|axis| {
            let cell = f64::from(place[axis]) * self.per_unit[axis];
            (cell as usize).min(self.counts[axis] - 1)
        })
    }

    const fn index(&self, [column, row, layer]: [usize; 3]) -> usize {
        (layer * self.counts[1] + row) * self.counts[0] + column
    }

    /// Adds a sample. Its slot is one that is free, or the next one.
    pub fn insert(&mut self, slot: u32, place: [i32; 3]) {
        let index = self.index(self.cell_of(place));
        let next = std::mem::replace(&mut self.heads[index], slot);
        let link = Link { place, next };
        match self.links.get_mut(slot as usize) {
            Some(free) => *free = link,
            None => self.links.push(link),
        }
    }

    /// Takes out the first sample at a place that `is_it` names. Returns its slot; none if there is no such sample.
    pub fn remove(&mut self, place: [i32; 3], is_it: impl Fn(u32) -> bool) -> Option<u32> {
        let index = self.index(self.cell_of(place));
        let (mut before, mut slot) = (END, self.heads[index]);
        while slot != END && !(self.place(slot) == place && is_it(slot)) {
            (before, slot) = (slot, self.links[slot as usize].next);
        }
        if slot == END {
            return None;
        }

        let next = self.links[slot as usize].next;
        // The first sample of a chain has none before it.
        match self.links.get_mut(before as usize) {
            Some(link) => link.next = next,
            None => self.heads[index] = next,
        }
        Some(slot)
    }

    /// Returns the square of the distance between two places, the shorter way around a torus. Offsets have at most 31 bits and their
    /// sign, so that three squares fit 64 bits.
    pub fn square(&self, one: [i32; 3], other: [i32; 3]) -> u64 {
        let along = |axis: usize| {
            let direct = (i64::from(one[axis]) - i64::from(other[axis])).unsigned_abs();
            // More than half of a period away, the other way around is shorter.
            let around = self.size[axis].unsigned_abs().abs_diff(direct);
            let apart = if self.is_periodic {
                direct.min(around)
            } else {
                direct
            };
            apart * apart
        };
        along(0) + along(1) + along(2)
    }

    /// The distance up to which [`Self::around`] sees all samples around every place, in units.
    pub fn certain_distance(&self) -> f64 {
        let edges = (0..3).filter(|&axis| self.counts[axis] > 3);
        // Along an axis of three cells or fewer, all are looked at.
        let edges = edges.map(|axis| 1.0 / self.per_unit[axis] - ROUNDING);
        edges.fold(f64::INFINITY, f64::min)
    }

    /// Calls `each` with the slots of the samples in the cell of a place and in the cells beside it, each once, and their squared
    /// distances. Returns the counted steps: the cells and the samples that it looked at.
    pub fn around(&self, place: [i32; 3], mut each: impl FnMut(u32, u64)) -> u64 {
        let cell = self.cell_of(place);
        let [columns, rows, layers] = [0, 1, 2].map(|axis| self.lines(axis, cell[axis]));
        let mut steps = 0;
        for layer in layers.iter() {
            for row in rows.iter() {
                for column in columns.iter() {
                    let mut slot = self.heads[self.index([column, row, layer])];
                    steps += 1;
                    while slot != END {
                        let Link { place: other, next } = self.links[slot as usize];
                        each(slot, self.square(place, other));
                        (slot, steps) = (next, steps + 1);
                    }
                }
            }
        }
        steps
    }

    /// Returns the columns, rows or layers (by `axis`) that are beside the one with the number `at`, and that one, each
    /// once. Where there are three or fewer, all of them are returned.
    fn lines(&self, axis: usize, at: usize) -> Lines {
        let count = self.counts[axis];
        let last = count - 1;
        // Where fewer than three lines are looked at, the rest of the array is not read.
        let (all, looked_at) = if count <= 3 {
            ([0, 1, 2], count)
        } else if at > 0 && at < last {
            ([at - 1, at, at + 1], 3)
        } else if self.is_periodic {
            ([(at + last) % count, at, (at + 1) % count], 3)
        } else if at == 0 {
            ([0, 1, 0], 2)
        } else {
            ([last - 1, last, 0], 2)
        };
        Lines {
            all,
            count: looked_at,
        }
    }
}

/// The numbers of up to three columns, rows or layers of cells.
struct Lines {
    /// The first `count` of these are the numbers; the others mean nothing.
    all: [usize; 3],
    count: usize,
}

impl Lines {
    fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        self.all[..self.count].iter().copied()
    }
}
