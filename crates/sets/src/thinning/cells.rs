//! The points of one octave of radii in the cells of a grid, sorted by cell and, in a cell, by rank.
//!
//! An octave reaches from a radius to its double. A rank is a place in the order in which points are taken. All points
//! together are the cloud.
//!
//! Only cells with points exist, so that the memory follows the points and not the rectangle around them.

use rayon::prelude::*;

use super::turns::Turns;

/// A cell is wider than the reach of its points by this share: positions in a grid of up to 2^31 cells are rounded by less.
const MARGIN: f64 = 1.0 / (1 << 16) as f64;

/// The most cells along a side of a grid, so that two numbers fit into a key.
pub(super) const MAX_CELLS: f64 = (1_u64 << 31) as f64;

/// The cells that a grid has along x and y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    low: [f64; 2],
    /// Cells of a unit of length, along x and y.
    inverse: [f64; 2],
    /// How many whole cells there are along x and y. In a rectangle a narrower one at the upper border may follow.
    cells: [u32; 2],
    is_periodic: bool,
}

/// The place of a cell in its grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub column: u32,
    pub row: u32,
}

impl Place {
    fn of(key: u64) -> Self {
        Self {
            column: key as u32,
            row: (key >> 32) as u32,
        }
    }

    fn key(self) -> u64 {
        u64::from(self.row) << 32 | u64::from(self.column)
    }
}

/// The first and the last of rows or columns that follow each other, both included.
type Span = (u32, u32);

impl Grid {
    /// Returns a grid over a rectangle: points that are nearer to each other than `reach` lie in one cell or in cells
    /// beside each other.
    pub fn new(low: [f64; 2], size: [f64; 2], reach: f64, is_periodic: bool) -> Self {
        let wished = reach * (1.0 + MARGIN);
        let cells = size.map(|side| (side / wished).floor().clamp(1.0, MAX_CELLS));
        // On a torus cells are of equal width, so that the last one ends where the first begins.
        let inverse = [0, 1].map(|axis| {
            if is_periodic {
                cells[axis] / size[axis]
            } else {
                1.0 / wished
            }
        });
        Self {
            low,
            inverse,
            cells: cells.map(|count| count as u32),
            is_periodic,
        }
    }

    /// Returns the cell of a point of the rectangle.
    pub fn place(&self, point: [f64; 2]) -> Place {
        let [column, row] = [0, 1].map(|axis| {
            let along = (point[axis] - self.low[axis]) * self.inverse[axis];
            let last = self.cells[axis].saturating_sub(u32::from(self.is_periodic));
            // In a rectangle the number behind the last whole cell is that of the rest at the upper border. On a torus,
            // which has no rest, a point that is rounded onto the border belongs to the last cell.
            (along.max(0.0) as u32).min(last)
        });
        Place { column, row }
    }

    /// Returns the numbers along an axis that are at most `steps` from `at`: on a torus there may be two runs of them.
    fn around(&self, axis: usize, at: u32, steps: u32) -> [Option<Span>; 2] {
        let count = self.cells[axis];
        let high = at + steps;
        if !self.is_periodic {
            // A span may end beyond the last cell, where there are no points.
            return [Some((at.saturating_sub(steps), high)), None];
        }

        // Steps that reach around the whole torus meet on its other side: one span of all cells has each of them once.
        if 2 * steps + 1 >= count {
            return [Some((0, count - 1)), None];
        }

        // A span that crosses the seam goes on at the other side.
        match at.checked_sub(steps) {
            None => [Some((0, high)), Some((at + count - steps, count - 1))],
            Some(low) if high >= count => [Some((low, count - 1)), Some((0, high - count))],
            Some(low) => [Some((low, high)), None],
        }
    }
}

/// The points of an octave, and which of them are decided.
#[derive(Debug)]
pub(super) struct Layer {
    pub grid: Grid,
    /// The cells that have points, in order.
    keys: Vec<u64>,
    finder: Finder,
    pub points: Vec<[f64; 2]>,
    pub ranks: Vec<u32>,
    /// The index of each point in the cloud.
    pub indices: Vec<u32>,
    pub turns: Turns,
}

/// A point in a grid, before it is sorted: by its cell, and in a cell by its rank.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Entry {
    key: u64,
    rank: u32,
    /// Its index in the cloud.
    index: u32,
}

impl Layer {
    /// Sorts the points of these indices into cells. Without `ranks` the index of a point is its rank.
    pub fn new(
        grid: Grid,
        indices: impl IndexedParallelIterator<Item = u32>,
        points: &[[f64; 2]],
        ranks: Option<&[u32]>,
    ) -> Self {
        let entry = |index: u32| Entry {
            key: grid.place(points[index as usize]).key(),
            rank: ranks.map_or(index, |ranks| ranks[index as usize]),
            index,
        };
        let mut entries: Vec<Entry> = indices.map(entry).collect();
        // Ranks differ, so that there is one sorted order alone, on any number of threads.
        entries.par_sort_unstable();

        // From here on a cell is known by its number among those that have points.
        let (mut keys, mut starts) = (Vec::new(), Vec::new());
        for (at, entry) in entries.iter().enumerate() {
            if keys.last() != Some(&entry.key) {
                keys.push(entry.key);
                starts.push(at as u32);
            }
        }
        starts.push(entries.len() as u32);

        Self {
            finder: Finder::of(&keys, grid.cells),
            points: (entries.par_iter())
                .map(|entry| points[entry.index as usize])
                .collect(),
            ranks: entries.par_iter().map(|entry| entry.rank).collect(),
            indices: entries.par_iter().map(|entry| entry.index).collect(),
            turns: Turns::new(starts),
            grid,
            keys,
        }
    }

    /// Returns how many cells there are.
    pub fn cells(&self) -> u32 {
        self.keys.len() as u32
    }

    pub fn place(&self, cell: u32) -> Place {
        Place::of(self.keys[cell as usize])
    }

    /// Returns the band of a row, where the rows from the lowest to the highest are divided into `bands` bands.
    pub fn band(&self, row: u32, bands: u32) -> u32 {
        // One more than the whole rows, for the rest at the upper border.
        let rows = u64::from(self.grid.cells[1]) + 1;
        (u64::from(row) * u64::from(bands) / rows) as u32
    }

    /// Returns the cells of a band, which follow each other.
    pub fn cells_of_band(&self, band: u32, bands: u32) -> std::ops::Range<u32> {
        let before = |band: u32| {
            let is_before = |key: &u64| self.band(Place::of(*key).row, bands) < band;
            self.keys.partition_point(is_before) as u32
        };
        before(band)..before(band + 1)
    }

    /// Calls `add` with each cell that is at most `steps` rows and columns from a place.
    pub fn add_around(&self, at: Place, steps: u32, mut add: impl FnMut(u32)) {
        let row_spans = self.grid.around(1, at.row, steps);
        let column_spans = self.grid.around(0, at.column, steps);
        for row in row_spans
            .into_iter()
            .flatten()
            .flat_map(|(low, high)| low..=high)
        {
            for columns in column_spans.into_iter().flatten() {
                self.cells_in_row(row, columns).for_each(&mut add);
            }
        }
    }

    /// Returns the cells in a span of columns of a row, which follow each other.
    fn cells_in_row(&self, row: u32, (low, high): Span) -> std::ops::Range<u32> {
        match &self.finder {
            Finder::Places { columns, begins } => {
                // A span that ends beyond the last column ends where the next row begins. Beyond the last row there are
                // no points, so that all cells lie before it.
                let begin = |column: u32| {
                    let place = row as usize * columns + (column as usize).min(*columns);
                    begins.get(place).copied().unwrap_or(self.cells())
                };
                begin(low)..begin(high + 1)
            }
            Finder::Rows(rows) => {
                let begin = |row: usize| rows.get(row).copied().unwrap_or(self.cells());
                self.found(
                    begin(row as usize),
                    begin(row as usize + 1),
                    row,
                    (low, high),
                )
            }
            Finder::Search => self.found(0, self.cells(), row, (low, high)),
        }
    }

    /// Returns those of the cells from `begin` to `end` that lie in a span of columns of a row, which are all of these.
    fn found(&self, begin: u32, end: u32, row: u32, (low, high): Span) -> std::ops::Range<u32> {
        let [low_key, high_key] = [low, high].map(|column| Place { column, row }.key());
        let keys = &self.keys[begin as usize..end as usize];
        let first = keys.partition_point(|&key| key < low_key);
        let within = keys[first..].iter().take_while(|&&key| key <= high_key);
        let first = begin + first as u32;
        first..first + within.count() as u32
    }
}

/// How the cell of a place is found among those that have points.
#[derive(Debug)]
enum Finder {
    /// For each place of the grid, row by row, the first cell that lies at this place or behind it. A row has `columns`
    /// places.
    Places { columns: usize, begins: Vec<u32> },
    /// Where the cells of each row begin.
    Rows(Vec<u32>),
    /// By a search through all cells.
    Search,
}

impl Finder {
    /// Returns the quickest way whose table is not much larger than the list of the cells' keys, which takes 8 bytes a
    /// cell. `cells` is how many whole cells the grid has along x and y.
    fn of(keys: &[u64], cells: [u32; 2]) -> Self {
        // The rests at the upper borders are a column and a row of their own.
        let [columns, most_rows] = cells.map(|count| count as usize + 1);

        // A table of two places for each cell takes 8 bytes a cell. The 1024 entries more (chosen, not measured) let
        // small clouds have a table, too, wherever their points lie.
        if columns.saturating_mul(most_rows) <= 2 * keys.len() + 1024 {
            let place = |key| {
                let Place { column, row } = Place::of(key);
                row as usize * columns + column as usize
            };
            let begins = begins(keys, columns * most_rows, place);
            return Self::Places { columns, begins };
        }
        // A table of four rows for each cell takes 16 bytes a cell, which `BYTES_A_POINT` counts. A grid has more rows
        // than that where a point lies far from all others; most of its rows are then empty.
        if most_rows < 4 * keys.len() + 1024 {
            let row = |key| Place::of(key).row as usize;
            return Self::Rows(begins(keys, most_rows, row));
        }
        Self::Search
    }
}

/// Returns for each number from 0 on the first cell of which `number` gives that or a higher one. Numbers behind that of the last
/// cell are missing: for them it is the end of all cells.
fn begins(keys: &[u64], most: usize, number: impl Fn(u64) -> usize) -> Vec<u32> {
    let mut begins = Vec::with_capacity(most);
    for (cell, &key) in keys.iter().enumerate() {
        while begins.len() <= number(key) {
            begins.push(cell as u32);
        }
    }
    begins
}
