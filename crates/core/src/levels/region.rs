//! The part of the plane around a window, computed level by level. Samples that may depend on the plane beyond are
//! replaced by *unknowns*: disks in which, at this level or later, a sample may lie that is not listed.
//!
//! *Listed samples are right.* A tiled sample is kept only if no sample before it in the order covers it: no listed one,
//! and no one that may lie in an unknown or beyond the frame. It is lost only if a listed sample covers it. All others
//! become unknowns. How insertion deals with unknowns stands in [`super::gaps`].

use crate::error::SampleError;
use crate::lattice::{Point, Rect};
use crate::progress::Meter;
use crate::radius::Radius;

use super::blocks::NestedBlock;
use super::frame::LevelFrame;
use super::grid::LevelGrid;
use super::pattern::LevelClip;
use super::search::centre_margin;

/// What a flag of a cell says.
pub(super) mod flag {
    /// A sample that is not its block's own, or an unknown, may cover a place in it.
    pub const CONTESTED: u8 = 1;
    /// A tiled sample that is not kept may have covered a place in it.
    pub const DIRTY: u8 = 2;
    /// An unknown may concern candidates in it.
    pub const DOUBTFUL: u8 = 4;
    /// A sample inserted last may concern candidates in it.
    pub const CHANGED: u8 = 8;
}

/// Flags of the cells of a grid.
#[derive(Default)]
pub(super) struct CellFlags(Vec<u8>);

impl CellFlags {
    /// Returns whether a cell has a flag.
    #[inline]
    pub fn has(&self, cell: usize, flag: u8) -> bool {
        self.0[cell] & flag != 0
    }

    /// Sets a flag of all cells that touch the square of side 2 `reach` around `from`, and calls `first` with those
    /// that did not have it.
    pub fn set_near(
        &mut self,
        grid: &LevelGrid,
        from: Point,
        reach: i32,
        flag: u8,
        mut first: impl FnMut(usize),
    ) {
        grid.layout().any_range(from, reach, |range, _| {
            for cell in range {
                if self.0[cell] & flag == 0 {
                    self.0[cell] |= flag;
                    first(cell);
                }
            }
            // No cell ends the visit.
            false
        });
    }

    /// Takes a flag from one cell.
    pub fn unset(&mut self, cell: usize, flag: u8) {
        self.0[cell] &= !flag;
    }

    /// Takes a flag from all cells.
    pub fn clear(&mut self, flag: u8) {
        for flags in &mut self.0 {
            *flags &= !flag;
        }
    }

    /// Takes all flags from `count` cells.
    fn reset(&mut self, count: usize) {
        self.0.clear();
        self.0.resize(count, 0);
    }
}

/// A tiled sample whose fate is to be decided. Its fields, one after another, are its place in the order of elimination.
#[derive(Clone, Copy)]
struct Claimant {
    /// The sequence of its block, and a larger number if it lies in the margin.
    turn: u32,
    /// Its place in its block, which tells images of one block apart.
    row: i32,
    column: i32,
    block: u32,
}

/// Added to the turns of samples in margins. A run in memory has fewer blocks.
const IN_MARGIN: u32 = 1 << 31;

/// A disk in which an unlisted sample may lie.
#[derive(Clone, Copy)]
pub(super) struct UnknownDisk {
    pub at: Point,
    pub radius: i32,
}

/// The samples of a frame and the buffers to compute them. Coordinates begin at the window's lowest corner.
#[derive(Default)]
pub(super) struct LevelRegion {
    pub frame: LevelFrame,
    /// The samples in the frame, at the level's radius.
    pub grid: LevelGrid,
    pub flags: CellFlags,
    /// The samples of all levels so far.
    pub samples: Vec<Point>,
    /// Those of them that are no samples that their blocks clip.
    foreign: Vec<Point>,
    /// How many samples there are up to the end of each level.
    pub ends: Vec<usize>,
    pub blocks: Vec<NestedBlock>,
    claimants: Vec<Claimant>,
    /// Tiled samples that are not kept. At a finer level they may be.
    waiting: Vec<Claimant>,
    pub unknown: Vec<UnknownDisk>,
    /// The first unknown of each cell, and the next one of each unknown.
    unknown_in: Vec<u32>,
    unknown_next: Vec<u32>,
    largest_unknown: i32,
    /// Cells in which there may be a gap.
    pub dirty: Vec<u32>,
}

/// The end of a cell's list of unknowns.
const NONE: u32 = u32::MAX;

/// Fates decided between two calls of the observer.
const CLAIMED: usize = 1 << 14;

impl LevelRegion {
    /// Empties the region before the first level.
    pub fn clear(&mut self) {
        self.samples.clear();
        self.foreign.clear();
        self.ends.clear();
        self.waiting.clear();
        self.unknown.clear();
    }

    /// Begins a level: takes over the samples and unknowns of the level before.
    pub fn begin(&mut self, frame: LevelFrame, radius: Radius) {
        // Every second level has the cells of the one before. Before the first the grid holds samples of another run.
        let is_first = self.ends.is_empty();
        if is_first || !self.grid.refine(&frame.rect, radius) {
            self.grid.reset(frame.rect, frame.wraps, radius);
            for &at in self.samples.iter().filter(|at| frame.rect.contains(**at)) {
                let fits = self.grid.insert(at);
                debug_assert!(fits, "the samples are conflict-free");
            }
        }

        self.flags.reset(self.grid.layout().count());
        self.dirty.clear();

        // A foreign sample may be in conflict with the pattern of the block around it: the pattern's samples in the cells that
        // it reaches are tested, and not copied.
        for &at in self.foreign.iter().filter(|at| frame.rect.contains(**at)) {
            self.flags
                .set_near(&self.grid, at, radius.units, flag::CONTESTED, |_| ());
        }

        // The lists of unknowns are made anew, by `doubt`, for the cells of this level's frame.
        let before = std::mem::take(&mut self.unknown);
        self.unknown_next.clear();
        self.unknown_in.clear();
        self.largest_unknown = 0;
        self.frame = frame;

        for unknown in before {
            // A disk that a sample covers whole holds no other sample. One unit is taken off, since `units` is rounded
            // up.
            let inner = i64::from(radius.units - 1 - unknown.radius);
            let covered = self.grid.any_near(unknown.at, radius.units, |offset| {
                inner >= 0 && offset.as_i64vec2().length_squared() <= inner * inner
            });

            // A disk that does not reach into the frame is left out. If the centre of another disk lies outside of the
            // frame, it is moved to the nearest place of the frame. The frame is convex, so that no place of the frame
            // is farther from the moved centre than from the first one: all that the frame has of the disk lies in the
            // moved disk, too.
            let Rect { min, max } = self.frame.rect;
            let x = unknown.at.x.clamp(min.x, max.x - 1);
            let y = unknown.at.y.clamp(min.y, max.y - 1);
            let beyond = (Point::new(x, y) - unknown.at).as_i64vec2();
            let reaches_in = beyond.length_squared() <= i64::from(unknown.radius).pow(2);

            if reaches_in && !covered {
                let within = UnknownDisk {
                    at: Point::new(x, y),
                    radius: unknown.radius,
                };
                self.doubt(within);
                let reach = radius.units + within.radius;
                self.flags
                    .set_near(&self.grid, within.at, reach, flag::CONTESTED, |_| ());
            }
        }
    }

    /// Adds an unknown, and marks the cells that it concerns.
    pub fn doubt(&mut self, unknown: UnknownDisk) {
        // A whole run has no unknowns, and needs no lists of them.
        if self.unknown_in.is_empty() {
            self.unknown_in.resize(self.grid.layout().count(), NONE);
        }

        // The unknowns of a cell are a linked list, in which the new one becomes the first.
        let cell = self.grid.layout().cell_at(unknown.at);
        self.unknown_next.push(self.unknown_in[cell]);
        self.unknown_in[cell] = self.unknown.len() as u32;
        self.largest_unknown = self.largest_unknown.max(unknown.radius);
        self.unknown.push(unknown);

        // A sample as far away as `sight` may concern candidates at a place, and the unknown one may lie anywhere in
        // its disk.
        let reach = self.frame.sight(self.grid.radius()) + unknown.radius;
        self.flags
            .set_near(&self.grid, unknown.at, reach, flag::DOUBTFUL, |_| ());
    }

    /// Returns whether an unknown touches the disk of `radius` units around `at`. Frames with unknowns do not wrap.
    pub fn touches_unknown(&self, at: Point, radius: i32) -> bool {
        if self.unknown.is_empty() {
            return false;
        }

        // Cells list the unknowns whose centres lie in them, so that the largest one decides how far to look.
        let reach = radius + self.largest_unknown;
        let touches = |unknown: &UnknownDisk| {
            let (x, y) = (unknown.at.x - at.x, unknown.at.y - at.y);
            let limit = i64::from(radius) + i64::from(unknown.radius);
            i64::from(x) * i64::from(x) + i64::from(y) * i64::from(y) <= limit * limit
        };

        self.grid.layout().any_range(at, reach, |range, _| {
            self.unknown_in[range].iter().any(|&first| {
                let mut next = first;
                // `NONE`, the end of a list, is no index.
                while let Some(unknown) = self.unknown.get(next as usize) {
                    if touches(unknown) {
                        return true;
                    }
                    next = self.unknown_next[next as usize];
                }
                false
            })
        })
    }

    /// Tiles what the level number `level` adds and decides all fates, as far as they can be known. Fails only when the
    /// observer of `meter` stops it.
    pub fn claim(
        &mut self,
        level: usize,
        variants: &[Vec<LevelClip>],
        meter: &mut Meter<'_>,
    ) -> Result<(), SampleError> {
        // These lists are taken out of the region, to which samples are added meanwhile.
        let blocks = std::mem::take(&mut self.blocks);
        let mut claimants = std::mem::take(&mut self.claimants);
        claimants.clear();

        let Radius { units, .. } = self.grid.radius();
        let reach = i64::from(units);
        let tiled = self.frame.tiled(units);
        // No sample beyond the frame covers a place of `inside`.
        let inside = self.frame.inside(units);

        for (block, index) in blocks.iter().zip(0..) {
            // The blocks are those of the coarsest level's frame, and finer frames meet fewer of them.
            let Some(part) = block.rect.grown(reach, reach).within(&tiled) else {
                continue;
            };

            // A tiled sample deeper than r in its block is kept without a comparison. Other samples within r of it are
            // of the block's own pattern, which has no conflicts, or of the margins of other blocks, which come later
            // in the order. A foreign sample of a coarser level, or an unknown, may also cover it: the cells near these
            // are contested. The block is half open, so that one unit more is taken off at its lower sides.
            let deep = block.rect.grown(-reach - 1, -reach).within(&inside);
            let safe = deep.unwrap_or_default();

            let clip = &variants[block.symmetry as usize][level];
            clip.clip(block.origin, &part, |p| {
                if safe.contains(p)
                    && !self
                        .flags
                        .has(self.grid.layout().cell_at(p), flag::CONTESTED)
                {
                    let foreign = false;
                    self.keep(p, foreign);
                } else {
                    claimants.push(Claimant::new(block, index, p));
                }
            });

            meter.ask()?;
        }

        // Samples that were not kept at coarser levels are decided again. The margins of blocks and the frame are
        // narrower than at the level before: samples that lie outside of them now are left out for good.
        claimants.extend(self.waiting.drain(..).filter(|claimant| {
            let block = &blocks[claimant.block as usize];
            let [width, height] = [0, 1].map(|axis| block.rect.max[axis] - block.rect.min[axis]);
            let within = |at: i32, side: i64| (-reach..side + reach).contains(&at.into());
            within(claimant.column, width)
                && within(claimant.row, height)
                && tiled.contains(claimant.place(block, &self.frame))
        }));

        // Claimants compare by the order of elimination: own samples before those of margins, then by block, row and column.
        claimants.sort_unstable_by_key(Claimant::key);
        for batch in claimants.chunks(CLAIMED) {
            for claimant in batch {
                let block = &blocks[claimant.block as usize];
                self.decide(claimant, block, &inside);
            }
            meter.ask()?;
        }

        self.blocks = blocks;
        self.claimants = claimants;
        Ok(())
    }

    /// Decides the fate of a sample: all before it in the order are decided.
    fn decide(&mut self, claimant: &Claimant, block: &NestedBlock, inside: &Rect) {
        let p = claimant.place(block, &self.frame);
        let Radius { units, .. } = self.grid.radius();

        if self.frame.rect.contains(p) {
            // A sample of a coarser level is tiled again.
            if self.grid.holds(p) {
                return;
            }
            if !self.grid.covers(p) {
                if inside.contains(p) && !self.touches_unknown(p, units) {
                    let foreign = claimant.turn >= IN_MARGIN;
                    self.keep(p, foreign);
                    return;
                }
                // A sample beyond the frame's edge, or one in an unknown disk, may cover this one: whether it is kept
                // is not known.
                self.doubt(UnknownDisk { at: p, radius: 0 });
            }
        }

        // The place of a sample that is not kept, and the places around it, may now be a gap. The circumcentre that is
        // found for such a gap may lie a little farther away, as it is rounded to the lattice.
        self.waiting.push(*claimant);
        let mark = |cell| self.dirty.push(cell as u32);
        let reach = units + centre_margin(self.grid.radius());
        self.flags.set_near(&self.grid, p, reach, flag::DIRTY, mark);
    }

    /// Adds a sample, which no other may cover. `foreign` says whether it is another one than a sample that its block clips.
    #[inline]
    pub fn keep(&mut self, at: Point, foreign: bool) {
        let fits = self.grid.insert(at);
        debug_assert!(fits, "the samples are conflict-free");
        self.samples.push(at);
        if foreign {
            self.foreign.push(at);
        }
    }
}

impl Claimant {
    /// Returns the sample of a block at `p`, which is in its margin if it is not in the block.
    fn new(block: &NestedBlock, index: u32, p: Point) -> Self {
        let [left, bottom] = block.rect.min.to_array();
        let (column, row) = (i64::from(p.x) - left, i64::from(p.y) - bottom);
        let own = (0..block.rect.max[0] - left).contains(&column)
            && (0..block.rect.max[1] - bottom).contains(&row);

        Self {
            turn: block.sequence + if own { 0 } else { IN_MARGIN },
            row: row as i32,
            column: column as i32,
            block: index,
        }
    }

    /// Returns a number that compares as the fields do, one after another. To compare it takes no branches.
    #[inline]
    fn key(&self) -> u128 {
        // Negative numbers become the smaller ones, in their order.
        let [row, column] = [self.row, self.column].map(|at| u128::from(at as u32 ^ 1 << 31));
        u128::from(self.turn) << 96 | row << 64 | column << 32 | u128::from(self.block)
    }

    /// Returns its place in the frame.
    fn place(&self, block: &NestedBlock, frame: &LevelFrame) -> Point {
        let [left, bottom] = block.rect.min.to_array();
        let (x, y) = (left + i64::from(self.column), bottom + i64::from(self.row));
        frame.wrap(Point::new(x as i32, y as i32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A disk whose centre lies outside of a narrower frame still counts in it, if it reaches in.
    #[test]
    fn unknowns_reach_into_narrower_frames() {
        let side = 1 << 20;
        let frame = |strip: i32| LevelFrame {
            rect: Rect {
                min: Point::new(strip, strip),
                max: Point::new(side - strip, side - strip),
            },
            goes_on: [[true; 2]; 2],
            ..LevelFrame::default()
        };
        let strip = 1 << 16;

        // The centre is 3 units outside on one axis, and on the other 4 units: the frame's corner is 5 away.
        for (radius, reaches_in) in [(4, false), (5, true)] {
            let mut region = LevelRegion::default();
            region.begin(frame(0), Radius::before(1));
            let at = Point::new(strip - 3, side - strip + 3);
            region.doubt(UnknownDisk { at, radius });
            region.ends.push(0);
            region.begin(frame(strip), Radius::FINEST);

            let corner = Point::new(strip, side - strip - 1);
            assert_eq!(region.touches_unknown(corner, 0), reaches_in, "{radius}");
        }
    }
}
