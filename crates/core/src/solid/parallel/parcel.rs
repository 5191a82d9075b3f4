//! The cells of a block, which one thread works on at a time.

use fearless_simd::Simd;
use glam::IVec3;

use super::contest::{Contender, NewBall};
use super::cover::{BallLists, Halves};
use super::draws::DrawnCubeDarts;
use super::parcels::{CELLS, cell_number};
use crate::chains::Chain;
use crate::lattice::{R, R_SQUARED};
use crate::random::Stream;
use crate::solid::Place;
use crate::solid::balls::{UPPER, octant_halves};
use crate::solid::darts::{PlaneKeys, SolidThrow};

/// How many cells a parcel has.
const CELL_COUNT: usize = cell_number([0, 0, CELLS as usize]);

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
    min: IVec3,
    /// From `min` to the highest place of the domain in it.
    ends: IVec3,
    /// For each cell the samples that can cover its places; closed if it has no active cubes.
    near: Vec<Chain>,
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
        let mut near = vec![Chain::CLOSED; CELL_COUNT];
        let mut cubes = Vec::new();
        let [columns, rows, planes] = ends.map(|end| (end >> R.ilog2()) as usize);
        for z in 0..=planes {
            for y in 0..=rows {
                for x in 0..=columns {
                    let cell = cell_number([x, y, z]);
                    near[cell] = Chain::EMPTY;
                    cubes.push(ActiveCube {
                        cell: cell as u16,
                        at: [0; 3],
                    });
                }
            }
        }

        Self {
            min: min.into(),
            ends: ends.into(),
            near,
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
        // Sides are nearly as long as 32 bits allow, so that steps may wrap; the offset of a sample that is near is short.
        let from = self.min.wrapping_sub(shift.into());
        for ball in balls {
            let at = IVec3::from(ball.place).wrapping_sub(from);
            let first = ((at - R) >> R.ilog2() as i32).max(IVec3::ZERO);
            let last = ((at + R) >> R.ilog2() as i32).min(IVec3::splat(CELLS - 1));
            // From R below the sample to R above it there are at most three cells on an axis.
            let along_x = [0, 1, 2].map(|step| squared_beyond(at.x, first.x + step));

            for z in first.z..=last.z {
                let deep = squared_beyond(at.z, z);
                for y in first.y..=last.y {
                    let flat = deep + squared_beyond(at.y, y);
                    let row = cell_number([0, y as usize, z as usize]);
                    for (x, squared) in (first.x..=last.x).zip(along_x) {
                        let near = &mut self.near[row + x as usize];
                        // A sample farther than R from the cell covers no place of it.
                        if !near.is_closed() && flat + squared <= R_SQUARED as u32 {
                            let corner = IVec3::new(x, y, z) * R;
                            self.lists.push(near, at - corner + R);
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
            self.near = Vec::new();
            self.lists = BallLists::for_lists(0);
        }
    }

    /// Replaces the cubes by their octants, `half` units wide, that hold places of the domain and are not covered by a single
    /// sample.
    #[inline(always)]
    fn cut<S: Simd>(&mut self, simd: S, half: i32, open: &mut Vec<ActiveCube>) {
        open.clear();
        for cubes in self.cubes.chunk_by(|a, b| a.cell == b.cell) {
            let number = cubes[0].cell;
            let near = &mut self.near[usize::from(number)];
            let before = open.len();
            // The highest place of the domain, from the cell's lowest one. It may be in a cell beyond.
            let last = self.ends - cell_corner(number);
            for cube in cubes {
                cube.push_open_octants(half, last, open, |halves| {
                    self.lists.covered_octants(simd, *near, halves)
                });
            }
            if open.len() == before {
                self.lists.close(near);
            }
        }
        // Exactly as much memory as is needed, as all parcels have cubes at the same time.
        self.cubes = open.as_slice().into();
    }

    /// Throws darts into all active cubes, and keeps those that land in the domain and that no sample covers.
    #[inline(always)]
    fn throw_darts<S: Simd>(&mut self, simd: S, throw: SolidThrow, drawn: &mut DrawnCubeDarts) {
        let min = self.min;
        let lowest = |cube: &ActiveCube| min + cell_corner(cube.cell) + cube.lowest();
        let mut planes = PlaneKeys::new(throw);

        for cubes in self.cubes.chunks(DrawnCubeDarts::CUBES) {
            drawn.draw(simd, throw, &mut planes, cubes, lowest);
            for dart in &drawn.darts {
                let cube = &cubes[usize::from(dart.cube)];
                let in_cell = cube.lowest() + IVec3::from(dart.offset);
                let at = cell_corner(cube.cell) + in_cell;
                // A cube at an upper side may reach beyond it.
                if at.cmpgt(self.ends).any() {
                    continue;
                }

                let near = self.near[usize::from(cube.cell)];
                if !self.lists.covers(simd, near, in_cell + R) {
                    // The rank is drawn only now, since nine of ten darts are covered and need none.
                    let [rank, _] = dart.key.draw(Stream::Rank, dart.index);
                    self.contenders
                        .push(Contender::new(rank, (min + at).into()));
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
            let place = IVec3::from(contender.ball.place);
            let IVec3 { x, y, z } = (place - self.min) >> R.ilog2() as i32;
            let cell = cell_number([x as usize, y as usize, z as usize]);
            // Each cell counts its own one place too late, where the next one begins.
            starts[cell + 1] += 1;
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
    /// Returns what leads from its cell's lowest place to its own.
    #[inline(always)]
    fn lowest(self) -> IVec3 {
        let [x, y, z] = self.at;
        IVec3::new(x.into(), y.into(), z.into())
    }

    /// Appends its octants, `half` units wide, that hold places of the domain and are not covered. `last` leads from the cell's
    /// lowest place to the domain's highest one; `covered` returns octants that one sample covers, as bits.
    #[inline(always)]
    fn push_open_octants(
        self,
        half: i32,
        last: IVec3,
        open: &mut Vec<Self>,
        covered: impl FnOnce(&[Halves; 3]) -> u8,
    ) {
        // Most cells lie whole in the domain, and so do their cubes.
        let (halves, beyond) = if last.cmpge(IVec3::splat(R - 1)).all() {
            let low = self.lowest();
            let along = |low: i32| Halves::of_whole(low, half);
            ([along(low.x), along(low.y), along(low.z)], 0)
        } else {
            self.cut_by_domain(half, last)
        };
        let closed = beyond | covered(&halves);

        let [x, y, z] = self.at;
        let step = half as u16;
        for octant in 0..8 {
            if closed >> octant & 1 == 0 {
                let [right, up, deep] = octant_halves(octant);
                let at = [
                    x + step * right as u16,
                    y + step * up as u16,
                    z + step * deep as u16,
                ];
                open.push(Self { at, ..self });
            }
        }
    }

    /// Returns its halves along each axis as far as they lie in the domain, and which octants hold no place of it, as bits.
    /// Otherwise as [`Self::push_open_octants`].
    fn cut_by_domain(self, half: i32, last: IVec3) -> ([Halves; 3], u8) {
        let low = self.lowest();
        let middle = low + half;
        // Both halves may be cut by the domain's side, and the upper one may lie beyond it.
        let ends = [(middle - 1).min(last), (middle + half - 1).min(last)];
        let along =
            |axis: usize| Halves::of([low[axis], middle[axis]], [ends[0][axis], ends[1][axis]]);

        let is_beyond = ends[1].cmplt(middle);
        let octants = |axis: usize| if is_beyond.test(axis) { UPPER[axis] } else { 0 };
        let beyond = octants(0) | octants(1) | octants(2);
        ([along(0), along(1), along(2)], beyond)
    }
}

/// Returns the lowest place of a cell, from that of its parcel.
#[inline(always)]
fn cell_corner(cell: u16) -> IVec3 {
    let number = i32::from(cell);
    // A cell's number has equally many bits for each axis.
    let bits = CELLS.ilog2();
    let mask = CELLS - 1;
    IVec3::new(number & mask, number >> bits & mask, number >> (2 * bits)) * R
}

/// Returns the square of the distance on an axis from a place to a cell, or 0 between its ends. A cell farther than R may get a
/// smaller number, so that three of them fit 32 bits; no caller asks for one.
#[inline(always)]
fn squared_beyond(at: i32, cell: i32) -> u32 {
    let first = cell * R;
    let beyond = (first - at).max(at - (first + R - 1)).clamp(0, R);
    beyond.unsigned_abs().pow(2)
}
