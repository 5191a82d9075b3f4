//! Samples in square cells, where each comes and goes in a few steps. Above the cells lies a pyramid of which cells hold any:
//! a search in a large hole sees blocks of empty cells at once, so no search takes in the plane because a hole is large.
//!
//! Searches return how many *steps* they took: the cells, the samples and the blocks that they looked at. Live measures
//! count their work in these, instead of in time, to spread it over frames.

use std::ops::ControlFlow;

use glam::DVec2;

use super::plane::Plane;
use crate::measures::{MeasureError, check_range};
use crate::region::Boundary;

/// Cells beyond these would take more memory than the samples; the cells of larger planes are larger.
const MAX_CELLS: f64 = 4_194_304.0;

/// The longest side of a plane. The products that decide about circles then have less than 127 bits.
const MAX_SIDE: u32 = 1 << 30;

/// The largest radius: 1,600 times the square of five radii then fits 64 bits.
const MAX_RADIUS: u32 = 1 << 20;

/// Blocks of a layer of the pyramid along each side of the block above them, which has a bit for each in one number of
/// 64 bits.
const BLOCK: usize = 8;

/// The rounding of a border of cells, in units, with room to spare.
const ROUNDING: f64 = 0.01;

/// Refuses planes that are too large.
pub(super) fn check_plane(Plane { size, radius, .. }: Plane) -> Result<(), MeasureError> {
    let within = |name, value: u32, most: u32| check_range(name, value.into(), [1.0, most.into()]);
    within("the width of a plane", size[0], MAX_SIDE)?;
    within("the height of a plane", size[1], MAX_SIDE)?;
    within("the radius of a plane", radius, MAX_RADIUS)
}

/// A sample: its place, and the slot at which a measure keeps what belongs to it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Occupant {
    pub place: [i32; 2],
    pub slot: u32,
}

/// Where the occupants of a cell lie in the pool.
#[derive(Clone, Copy, Debug, Default)]
struct Bucket {
    start: u32,
    len: u32,
    /// There is room for `1 << room` occupants, but for none at 0.
    room: u32,
}

/// A layer of the pyramid: of each block of 8 x 8 cells, or of 8 x 8 blocks of the layer below, which are occupied.
#[derive(Clone, Debug)]
struct Layer {
    /// How many blocks a row of the layer has.
    columns: usize,
    /// A bit for each part of each block, row by row.
    masks: Vec<u64>,
}

/// The samples of a plane.
#[derive(Clone, Debug)]
pub(super) struct PlaceGrid {
    /// The sides of the plane, in units.
    size: [i32; 2],
    is_periodic: bool,
    /// How many columns and rows of cells there are.
    counts: [usize; 2],
    /// Sides of a cell.
    sides: DVec2,
    /// How many cells a unit holds, along each axis.
    per_unit: DVec2,
    /// The buckets of the cells, row by row.
    buckets: Vec<Bucket>,
    /// The occupants of all cells, and free room.
    pool: Vec<Occupant>,
    /// Places in the pool that were left, by room.
    free: Vec<Vec<u32>>,
    /// From the one above the cells to a single block.
    layers: Vec<Layer>,
}

impl PlaceGrid {
    /// Returns the empty grid of a plane, with cells whose sides are at least `side` units where the plane is so large.
    pub fn new(plane: Plane, side: f64) -> Self {
        let extent = DVec2::from(plane.size.map(f64::from));
        let least_side = side.max((extent.element_product() / MAX_CELLS).sqrt());
        // A plane that is thinner than a cell has one row of them, which must not have more than `MAX_CELLS` either.
        let counts = (extent / least_side)
            .floor()
            .clamp(DVec2::ONE, DVec2::splat(MAX_CELLS));
        let whole_counts = counts.to_array().map(|count| count as usize);

        Self {
            size: plane.size.map(|side| side as i32),
            is_periodic: plane.boundary == Boundary::Periodic,
            counts: whole_counts,
            sides: extent / counts,
            per_unit: counts / extent,
            buckets: vec![Bucket::default(); whole_counts[0] * whole_counts[1]],
            pool: Vec::new(),
            // Rooms are powers of two, and places in the pool have 32 bits.
            free: vec![Vec::new(); 32],
            layers: layers(whole_counts),
        }
    }

    /// Takes out all samples. The memory of the pool stays for others.
    pub fn clear(&mut self) {
        self.buckets.fill(Bucket::default());
        self.pool.clear();
        self.free.iter_mut().for_each(Vec::clear);
        for layer in &mut self.layers {
            layer.masks.fill(0);
        }
    }

    /// The column and the row of a place; neither falls when its coordinate rises.
    fn cell_of(&self, place: [i32; 2]) -> [usize; 2] {
        [0, 1].map(|axis| {
            let cell = f64::from(place[axis]) * self.per_unit[axis];
            (cell as usize).min(self.counts[axis] - 1)
        })
    }

    /// Adds a sample to the cell of its place.
    pub fn insert(&mut self, occupant: Occupant) {
        let [column, row] = self.cell_of(occupant.place);
        let index = row * self.counts[0] + column;
        let bucket = self.buckets[index];
        // A bucket has room for two to the power of `room`, and at 0 for none.
        let is_full = bucket.room == 0 || bucket.len == 1 << bucket.room;
        if is_full {
            self.buckets[index] = self.moved(bucket);
        }

        let Bucket { start, len, .. } = self.buckets[index];
        self.pool[(start + len) as usize] = occupant;
        self.buckets[index].len += 1;
        if len == 0 {
            let is_occupied = true;
            self.mark(column, row, is_occupied);
        }
    }

    /// Moves the occupants of a cell to where there is twice the room.
    fn moved(&mut self, bucket: Bucket) -> Bucket {
        let room = bucket.room + 1;
        // Room of this size that another cell has given up is used before the pool grows.
        let start = self.free[room as usize].pop().unwrap_or_else(|| {
            let end = self.pool.len();
            self.pool.resize(end + (1 << room), Occupant::default());
            end as u32
        });

        let from = bucket.start as usize;
        self.pool
            .copy_within(from..from + bucket.len as usize, start as usize);
        if bucket.room > 0 {
            self.free[bucket.room as usize].push(bucket.start);
        }

        Bucket {
            start,
            room,
            ..bucket
        }
    }

    /// Takes out the first occupant, of the cell in which `place` lies, that `is_it` names. Returns its slot; none if
    /// there is no such occupant.
    pub fn remove(&mut self, place: [i32; 2], is_it: impl Fn(&Occupant) -> bool) -> Option<u32> {
        let [column, row] = self.cell_of(place);
        let index = row * self.counts[0] + column;
        let Bucket { start, len, .. } = self.buckets[index];
        let (first, end) = (start as usize, (start + len) as usize);
        let at = self.pool[first..end].iter().position(is_it)?;

        let slot = self.pool[first + at].slot;
        // Cells have no sequence, so that the last one may fill the hole.
        self.pool[first + at] = self.pool[end - 1];
        self.buckets[index].len -= 1;
        if len == 1 {
            let is_occupied = false;
            self.mark(column, row, is_occupied);
        }
        Some(slot)
    }

    /// Returns the occupants of the cell that holds a place.
    pub fn beside(&self, place: [i32; 2]) -> &[Occupant] {
        let [column, row] = self.cell_of(place);
        self.cell(column, row)
    }

    /// Returns all samples, cell by cell.
    pub fn all(&self) -> impl Iterator<Item = &Occupant> {
        let occupants = |bucket: &Bucket| {
            &self.pool[bucket.start as usize..(bucket.start + bucket.len) as usize]
        };
        self.buckets.iter().flat_map(occupants)
    }

    fn cell(&self, column: usize, row: usize) -> &[Occupant] {
        let Bucket { start, len, .. } = self.buckets[row * self.counts[0] + column];
        &self.pool[start as usize..(start + len) as usize]
    }

    /// Notes in the pyramid whether a cell is occupied.
    fn mark(&mut self, mut column: usize, mut row: usize, is_occupied: bool) {
        for layer in &mut self.layers {
            let bit = 1 << (row % BLOCK * BLOCK + column % BLOCK);
            (column, row) = (column / BLOCK, row / BLOCK);
            let mask = &mut layer.masks[row * layer.columns + column];
            let before = *mask;
            *mask = if is_occupied {
                before | bit
            } else {
                before & !bit
            };
            // The layer above has one bit for this whole block: it changes only when the first part of the block is
            // occupied or the last one is left.
            if (before == 0) == (*mask == 0) {
                break;
            }
        }
    }

    /// Returns the offset of a sample from a place, the shorter way around a torus.
    pub fn offset(&self, from: [i32; 2], to: [i32; 2]) -> [i32; 2] {
        let along = |axis: usize| {
            // More than half of a period away, the other way around is shorter.
            let (direct, size) = (to[axis] - from[axis], self.size[axis]);
            if !self.is_periodic {
                direct
            } else if direct > size / 2 {
                direct - size
            } else if direct < -(size / 2) {
                direct + size
            } else {
                direct
            }
        };
        [along(0), along(1)]
    }

    /// Whether there are more cells than the given number to either side of one, with one to spare so that each sample
    /// in them is seen at its shorter offset.
    fn is_wide(&self, axis: usize, reach: usize) -> bool {
        self.counts[axis] > 2 * reach + 2
    }

    /// The distance up to which [`Self::around`] sees all samples around every place.
    pub fn certain_distance(&self, reach: usize) -> f64 {
        let along = |axis: usize| {
            if self.is_wide(axis, reach) {
                reach as f64 * self.sides[axis] - ROUNDING
            } else {
                f64::INFINITY
            }
        };
        along(0).min(along(1))
    }

    /// The distance up to which [`Self::around`] also sees all of their copies on a torus.
    pub fn certain_with_copies(&self, reach: usize) -> f64 {
        let half = if self.is_periodic {
            0.5 * f64::from(self.size[0].min(self.size[1])) - ROUNDING
        } else {
            f64::INFINITY
        };
        self.certain_distance(reach).min(half)
    }

    /// Calls `each` with the samples of the cells at most `reach` cells away, which is at most [`MAX_REACH`], and their
    /// offsets, until it breaks. Nearer cells come first, but not at seams and borders. Each sample is seen once, at
    /// its shorter offset. Returns the counted steps.
    pub fn around(
        &self,
        place: [i32; 2],
        reach: usize,
        mut each: impl FnMut(&Occupant, [i32; 2]) -> ControlFlow<()>,
    ) -> u64 {
        let [column, row] = self.cell_of(place);
        // For nearly all samples no seam or border is near.
        let inside = |axis: usize, at: usize| {
            self.is_wide(axis, reach) && at >= reach && at + reach < self.counts[axis]
        };
        let is_inside = inside(0, column) && inside(1, row);

        let mut steps = 0;
        let mut look = |cell: &[Occupant]| {
            steps += 1 + cell.len() as u64;
            for occupant in cell {
                let offset = if is_inside {
                    [0, 1].map(|axis| occupant.place[axis] - place[axis])
                } else {
                    // Near a seam a sample may be nearer the other way around.
                    self.offset(place, occupant.place)
                };
                each(occupant, offset)?;
            }
            ControlFlow::Continue(())
        };

        // Whether `each` broke does not matter: only the steps are returned.
        let _: ControlFlow<()> = if is_inside {
            let mut ways = WAYS[..(2 * reach + 1) * (2 * reach + 1)].iter();
            ways.try_for_each(|[across, up]| {
                let at = [column as i64 + across, row as i64 + up].map(|at| at as usize);
                look(self.cell(at[0], at[1]))
            })
        } else {
            let (columns, rows) = (self.lines(0, column, reach), self.lines(1, row, reach));
            let mut all = rows
                .iter()
                .flat_map(|row| columns.iter().map(move |column| (column, row)));
            all.try_for_each(|(&column, &row)| look(self.cell(column, row)))
        };
        steps
    }

    /// The columns or rows at most `reach` away from one, each once; all of them where there are not many more.
    fn lines(&self, axis: usize, at: usize, reach: usize) -> Vec<usize> {
        let count = self.counts[axis];
        if !self.is_wide(axis, reach) {
            return (0..count).collect();
        }

        let (at, reach, count) = (at as i64, reach as i64, count as i64);
        let near =
            (at - reach..=at + reach).filter(|line| self.is_periodic || (0..count).contains(line));
        near.map(|line| line.rem_euclid(count) as usize).collect()
    }

    /// Calls `each` with the samples, and on a torus their copies, in the closed disk of a squared radius about a
    /// place. `each` gets the sample, the shift of the copy in periods, and the squared radius, which it may make
    /// smaller. Blocks without samples are passed over at once. Returns the counted steps.
    pub fn within(
        &self,
        center: DVec2,
        square: f64,
        mut each: impl FnMut(&Occupant, [i32; 2], &mut f64),
    ) -> u64 {
        // Each search begins with the one block of the highest layer.
        let (highest, block) = (self.layers.len() - 1, [0; 2]);
        let mut search = DiskSearch {
            center,
            square,
            periods: [0; 2],
            steps: 0,
        };
        if !self.is_periodic {
            self.descend(highest, block, &mut search, &mut each);
            return search.steps;
        }

        // On a torus the disk is looked at from each copy of the plane that it may meet: as one about a shifted centre.
        let extent = DVec2::from(self.size.map(f64::from));
        let radius = square.sqrt();
        let first = ((center - radius) / extent).floor();
        let last = ((center + radius) / extent).floor();
        for up in first.y as i32..=last.y as i32 {
            for across in first.x as i32..=last.x as i32 {
                search.periods = [across, up];
                search.center = center - DVec2::new(across.into(), up.into()) * extent;
                self.descend(highest, block, &mut search, &mut each);
            }
        }
        search.steps
    }

    /// Calls `each` with the samples of a block of a layer that lie in the disk, by way of the layers below.
    fn descend(
        &self,
        layer: usize,
        block: [usize; 2],
        search: &mut DiskSearch,
        each: &mut impl FnMut(&Occupant, [i32; 2], &mut f64),
    ) {
        let Layer { columns, masks } = &self.layers[layer];
        // The parts of a block of the lowest layer are cells. In each layer above, the parts are eight times as wide
        // and as high as in the layer below. The factor is a power of two, so that the product is exact.
        let part_sides = self.sides * (1_u64 << (BLOCK.trailing_zeros() as usize * layer)) as f64;
        search.steps += 1;
        // One bit stands for each part of the block: those without samples and those that the square around the disk does not
        // meet are passed over at once.
        let mut open = masks[block[1] * columns + block[0]] & search.near(block, part_sides);

        while open != 0 {
            let bit = open.trailing_zeros() as usize;
            // This clears the lowest bit that is set.
            open &= open - 1;
            let at = [
                block[0] * BLOCK + bit % BLOCK,
                block[1] * BLOCK + bit / BLOCK,
            ];
            // `each` may have made the disk smaller since.
            if !search.meets(at, part_sides) {
                continue;
            }
            if layer > 0 {
                self.descend(layer - 1, at, search, each);
                continue;
            }

            let cell = self.cell(at[0], at[1]);
            search.steps += 1 + cell.len() as u64;
            for occupant in cell {
                let place = DVec2::from(occupant.place.map(f64::from));
                if place.distance_squared(search.center) <= search.square {
                    each(occupant, search.periods, &mut search.square);
                }
            }
        }
    }
}

/// A disk in which samples are looked for, as seen from one copy of the plane.
struct DiskSearch {
    center: DVec2,
    /// The square of the disk's radius.
    square: f64,
    /// Which copy that is, in periods along x and y.
    periods: [i32; 2],
    /// The counted steps so far.
    steps: u64,
}

impl DiskSearch {
    /// Returns the parts of a block that the square around the disk meets, as bits. `part_sides` are the width and the
    /// height of a part.
    fn near(&self, block: [usize; 2], part_sides: DVec2) -> u64 {
        let radius = self.square.sqrt() + ROUNDING;
        // A disk may be larger than any integer can say: its ends then stay at the limits, far beyond the block.
        let along = |axis: usize| {
            let first = (block[axis] * BLOCK) as i64;
            let part = |at: f64| whole_below(at / part_sides[axis]).saturating_sub(first);
            let low = part(self.center[axis] - radius);
            let high = part(self.center[axis] + radius).saturating_add(1);
            [low, high].map(|part| part.clamp(0, BLOCK as i64) as u32)
        };
        // The bits of the first `count` lines of `width` bits each. A shift by all 64 leaves none of the ones.
        let before = |count: u32, width: u32| !u64::MAX.checked_shl(count * width).unwrap_or(0);

        let [[left, right], [low, high]] = [along(0), along(1)];
        let columns = before(right, 1) & !before(left, 1);
        let rows = before(high, BLOCK as u32) & !before(low, BLOCK as u32);
        // The product writes the bits of the columns into each of the eight lines.
        (columns * 0x0101_0101_0101_0101) & rows
    }

    /// Whether the disk meets a cell or a block.
    fn meets(&self, at: [usize; 2], sides: DVec2) -> bool {
        let low = DVec2::new(at[0] as f64, at[1] as f64) * sides;
        let high = low + sides;
        let apart = (low - self.center).max(self.center - high) - ROUNDING;
        apart.max(DVec2::ZERO).length_squared() <= self.square
    }
}

/// Returns the largest whole number that is not above a value, without a call of a function of the system.
fn whole_below(value: f64) -> i64 {
    let whole = value as i64;
    // The cast rounds towards zero, which is upwards for negative numbers.
    whole.saturating_sub(i64::from(whole as f64 > value))
}

/// The empty layers of the pyramid over the given number of cells.
fn layers(cells: [usize; 2]) -> Vec<Layer> {
    let mut layers = Vec::new();
    let mut below = cells;
    while layers.is_empty() || below != [1, 1] {
        below = below.map(|count| count.div_ceil(BLOCK));
        layers.push(Layer {
            columns: below[0],
            masks: vec![0; below[0] * below[1]],
        });
    }
    layers
}

/// The most cells away at which samples are looked for around one.
const MAX_REACH: i64 = 2;

/// The ways to the cells around one, the nearer cells first.
const WAYS: [[i64; 2]; 25] = {
    let (mut ways, mut count, mut ring) = ([[0; 2]; 25], 0, 0);
    while ring <= MAX_REACH {
        let mut up = -ring;
        while up <= ring {
            let mut across = -ring;
            while across <= ring {
                if across.abs() == ring || up.abs() == ring {
                    ways[count] = [across, up];
                    count += 1;
                }
                across += 1;
            }
            up += 1;
        }
        ring += 1;
    }
    ways
};
