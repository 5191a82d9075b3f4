//! The cells of a block, which one thread works on at a time.

use fearless_simd::Simd;

use super::contest::{Contender, NewBall};
use super::cover::{BallList, BallLists, Halves};
use super::draws::DrawnCubeDarts;
use super::parcels::{CELLS, cell_number};
use crate::lattice::{R, R_SQUARED};
use crate::random::Stream;
use crate::solid::Place;
use crate::solid::balls::{UPPER, octant_halves};
use crate::solid::darts::{PlaneKeys, SolidThrow};

/// How many cells a parcel has.
const CELL_COUNT: usize = cell_number([0, 0, CELLS as usize]);

/// A cell of side R.
#[derive(Clone, Copy)]
struct ParcelCell {
    /// The samples that can cover its places.
    near: BallList,
    /// Whether it has active cubes.
    is_active: bool,
}

/// An active cube of a cell. Its side follows from the level.
#[derive(Clone, Copy)]
pub(super) struct ActiveCube {
    /// The number of its cell.
    cell: u16,
    /// From the cell's lowest place to its own, which 15 bits hold.
    at: [u16; 3],
}

/// The buffers of a thread, whose content does not matter between two parcels.
#[derive(Default)]
pub(super) struct ParcelScratch {
    cubes: Vec<ActiveCube>,
    drawn: DrawnCubeDarts,
}

/// All cells of a block.
pub(super) struct CellParcel {
    min: Place,
    /// The highest place of the domain in it, from `min`.
    ends: Place,
    cells: Vec<ParcelCell>,
    lists: BallLists,
    /// The active cubes of all cells, one cell's after another's.
    cubes: Box<[ActiveCube]>,
    /// The darts of the last throw that no sample before it covers, one cell's after another's.
    pub contenders: Vec<Contender>,
    /// Where those of each cell begin, and where the last ones end, if there are any.
    pub starts: Vec<u32>,
}

impl CellParcel {
    /// Returns the parcel that begins at `min`, before the first throw. `ends` leads from there to the highest place of the
    /// domain in it.
    pub fn new(min: Place, ends: Place) -> Self {
        let empty = ParcelCell {
            near: BallList::EMPTY,
            is_active: false,
        };
        let mut cells = vec![empty; CELL_COUNT];
        let mut cubes = Vec::new();
        let [columns, rows, planes] = ends.map(|end| (end >> R.ilog2()) as usize);
        for z in 0..=planes {
            for y in 0..=rows {
                for x in 0..=columns {
                    let cell = cell_number([x, y, z]);
                    cells[cell].is_active = true;
                    cubes.push(ActiveCube {
                        cell: cell as u16,
                        at: [0; 3],
                    });
                }
            }
        }

        Self {
            min,
            ends,
            cells,
            lists: BallLists::for_lists(cubes.len()),
            cubes: cubes.into(),
            contenders: Vec::new(),
            starts: Vec::new(),
        }
    }

    /// Returns whether nothing in it is left to fill.
    pub const fn is_finished(&self) -> bool {
        self.cubes.is_empty()
    }

    /// Returns how many cubes are active.
    pub const fn active_cubes(&self) -> u64 {
        self.cubes.len() as u64
    }

    /// Adds new samples, moved by `shift`, to the lists of the active cells that have a place that they can cover.
    pub fn list(&mut self, balls: &[NewBall], shift: Place) {
        for ball in balls {
            // Sides are nearly as long as 32 bits allow, so that steps may wrap; the offset of a sample that is near is short.
            let at = [0, 1, 2].map(|axis| {
                let image = ball.place[axis].wrapping_add(shift[axis]);
                image.wrapping_sub(self.min[axis])
            });
            let near = at.map(|offset| {
                let first = ((offset - R) >> R.ilog2()).max(0);
                let last = ((offset + R) >> R.ilog2()).min(CELLS - 1);
                first..=last
            });
            let [columns, rows, planes] = near;

            for z in planes {
                let deep = squared_beyond(at[2], z);
                for y in rows.clone() {
                    let flat = deep + squared_beyond(at[1], y);
                    for x in columns.clone() {
                        let squared = flat + squared_beyond(at[0], x);
                        let cell = &mut self.cells[cell_number([x, y, z].map(|at| at as usize))];
                        if cell.is_active && squared <= R_SQUARED {
                            // Lists have offsets from a place R below the cell's lowest one.
                            let [x, y, z] = [x, y, z].map(|number| (number - 1) * R);
                            let offset = [at[0] - x, at[1] - y, at[2] - z];
                            self.lists.push(&mut cell.near, offset);
                        }
                    }
                }
            }
        }
    }

    /// Cuts the active cubes, if the throw is the first one of its level, and throws darts into them.
    #[inline(always)]
    pub fn throw<S: Simd>(&mut self, simd: S, throw: SolidThrow, scratch: &mut ParcelScratch) {
        self.contenders = Vec::new();
        self.starts = Vec::new();
        if throw.begins_level() {
            self.cut(simd, throw.side(), &mut scratch.cubes);
        }

        self.throw_darts(simd, throw, &mut scratch.drawn);
        // A cube of one place has thrown that place.
        if throw.side() == 1 {
            self.cubes = Box::default();
        }
        // A finished parcel is not visited again.
        if self.is_finished() {
            self.cells = Vec::new();
            self.lists = BallLists::default();
        }
    }

    /// Replaces the cubes by their octants, `half` units wide, that hold places of the domain and are not covered by a single
    /// sample.
    #[inline(always)]
    fn cut<S: Simd>(&mut self, simd: S, half: i32, open: &mut Vec<ActiveCube>) {
        open.clear();
        for cubes in self.cubes.chunk_by(|a, b| a.cell == b.cell) {
            let number = cubes[0].cell;
            let cell = &mut self.cells[usize::from(number)];
            let before = open.len();
            // The highest place of the domain, from the cell's lowest one. It may be in a cell beyond.
            let corner = cell_corner(number);
            let last = [0, 1, 2].map(|axis| self.ends[axis] - corner[axis]);
            for cube in cubes {
                cube.push_open_octants(half, last, open, |halves| {
                    self.lists.covered_octants(simd, cell.near, halves)
                });
            }
            if open.len() == before {
                cell.is_active = false;
                self.lists.release(&mut cell.near);
            }
        }
        // Exactly as much memory as is needed, as all parcels have cubes at the same time.
        self.cubes = open.as_slice().into();
    }

    /// Throws darts into all active cubes, and keeps those that land in the domain and that no sample covers.
    #[inline(always)]
    fn throw_darts<S: Simd>(&mut self, simd: S, throw: SolidThrow, drawn: &mut DrawnCubeDarts) {
        let min = self.min;
        let lowest = |cube: &ActiveCube| {
            let corner = cell_corner(cube.cell);
            [0, 1, 2].map(|axis| min[axis] + corner[axis] + i32::from(cube.at[axis]))
        };
        let mut planes = PlaneKeys::new(throw);

        for cubes in self.cubes.chunks(DrawnCubeDarts::CUBES) {
            drawn.draw(simd, throw, &mut planes, cubes, lowest);
            for dart in &drawn.darts {
                let cube = &cubes[usize::from(dart.cube)];
                let corner = cell_corner(cube.cell);
                let in_cell = [0, 1, 2].map(|axis| i32::from(cube.at[axis]) + dart.offset[axis]);
                let at = [0, 1, 2].map(|axis| corner[axis] + in_cell[axis]);
                // A cube at an upper side may reach beyond it.
                if at[0] > self.ends[0] || at[1] > self.ends[1] || at[2] > self.ends[2] {
                    continue;
                }

                // Lists have offsets from a place R below the cell's lowest one.
                let offset = in_cell.map(|at| at + R);
                let near = self.cells[usize::from(cube.cell)].near;
                if !self.lists.covers(simd, near, offset) {
                    // The rank is drawn only now, since nine of ten darts are covered and need none.
                    let [rank, _] = dart.key.draw(Stream::Rank, dart.index);
                    let place = [0, 1, 2].map(|axis| min[axis] + at[axis]);
                    self.contenders.push(Contender::new(rank, place));
                }
            }
        }
        if !self.contenders.is_empty() {
            self.starts = self.starts_of_cells();
        }
    }

    /// Returns where the contenders of each cell begin, and where the last ones end.
    fn starts_of_cells(&self) -> Vec<u32> {
        let mut starts = vec![0; CELL_COUNT + 1];
        for contender in &self.contenders {
            let place = contender.ball.place;
            let cell = [0, 1, 2].map(|axis| ((place[axis] - self.min[axis]) >> R.ilog2()) as usize);
            // Each cell counts its own one place too late, where the next one begins.
            starts[cell_number(cell) + 1] += 1;
        }
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        starts
    }
}

impl ActiveCube {
    /// Appends its octants, `half` units wide, that hold places of the domain and are not covered. `last` leads from the cell's
    /// lowest place to the domain's highest one; `covered` returns octants that one sample covers, as bits.
    #[inline(always)]
    fn push_open_octants(
        self,
        half: i32,
        last: Place,
        open: &mut Vec<Self>,
        covered: impl FnOnce(&[Halves; 3]) -> u8,
    ) {
        let mut halves = [Halves::default(); 3];
        // Octants without a place of the domain count as covered.
        let mut beyond = 0;
        for axis in 0..3 {
            let low = i32::from(self.at[axis]);
            let middle = low + half;
            // Both halves may be cut by the domain's side, and the upper one may lie beyond it.
            let ends = [middle - 1, middle + half - 1].map(|end| end.min(last[axis]));
            // Lists have offsets from a place R below the cell's lowest one.
            halves[axis] = Halves::of([low + R, middle + R], ends.map(|end| end + R));
            if ends[1] < middle {
                beyond |= UPPER[axis];
            }
        }

        let covered = beyond | covered(&halves);
        for octant in 0..8 {
            if covered >> octant & 1 == 0 {
                let upper = octant_halves(octant);
                let at = [0, 1, 2].map(|axis| self.at[axis] + upper[axis] as u16 * half as u16);
                open.push(Self { at, ..self });
            }
        }
    }
}

/// Returns the lowest place of a cell, from that of its parcel.
#[inline(always)]
fn cell_corner(cell: u16) -> Place {
    let number = i32::from(cell);
    // A cell's number has equally many bits for each axis.
    let bits = CELLS.ilog2();
    [number, number >> bits, number >> (2 * bits)].map(|bits| (bits & (CELLS - 1)) * R)
}

/// Returns the square of the distance on an axis from a place to a cell, or 0 between its ends.
#[inline(always)]
fn squared_beyond(at: i32, cell: i32) -> i64 {
    let first = cell * R;
    let beyond = (first - at).max(at - (first + R - 1)).max(0);
    i64::from(beyond) * i64::from(beyond)
}
