//! Finds the blocks that reach into a region, and the pattern's samples in any rectangle of a block.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u32x8};
use glam::I64Vec2;

use crate::error::{PatternError, SampleError};
use crate::lattice::{Domain, Point, R, Rect, Rect64};
use crate::pattern::{Pattern, PatternVariant, Symmetry};
use crate::pool::Pool;
use crate::random::{Key, Stream, below};
use crate::stages::blocks::{Block, Node};
use crate::stages::tile::clip_start;

use super::frame::{CELL_BITS, Frame, PAD};

/// Samples of a pattern that are computed at once.
const LANES: usize = 8;

/// The pattern under one symmetry, by cells: rows of cells, then columns.
#[derive(Clone)]
pub struct CellPattern {
    /// Sides and boundary; the samples are in the fields below.
    pub shape: PatternVariant,
    /// Cells in a row.
    pub columns: usize,
    /// Index of each cell's first sample; one more at the end.
    pub starts: Vec<u32>,
    /// Abscissas, cell by cell, and eight more, so that eight can be read from any of them on.
    pub xs: Vec<u32>,
    /// Ordinates in the same sequence, with eight more, too.
    pub ys: Vec<u32>,
    /// The samples' indices in the pattern.
    pub ids: Vec<u32>,
}

impl CellPattern {
    /// Returns a variant of a pattern, sorted into cells.
    #[must_use]
    pub fn new(mut shape: PatternVariant) -> Self {
        let cells = |side: i32| ((side - 1) >> CELL_BITS) as usize + 1;
        let (columns, rows) = (cells(shape.width), cells(shape.height));
        let cell = |p: Point| (p.y >> CELL_BITS) as usize * columns + (p.x >> CELL_BITS) as usize;

        // Samples are sorted by cell: those of a cell begin where the samples of all cells before it end.
        let mut samples = std::mem::take(&mut shape.samples);
        samples.sort_by_key(|(p, _)| cell(*p));
        let mut starts = vec![0_u32; columns * rows + 1];
        for (p, _) in &samples {
            starts[cell(*p) + 1] += 1;
        }

        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }

        Self {
            shape,
            columns,
            starts,
            // Groups of eight may read on beyond the last sample.
            xs: (samples.iter().map(|s| s.0.x as u32))
                .chain([0; LANES])
                .collect(),
            ys: (samples.iter().map(|s| s.0.y as u32))
                .chain([0; LANES])
                .collect(),
            ids: samples.iter().map(|s| s.1).collect(),
        }
    }

    /// Calls `visit` with the position and the pattern index of every sample of a rectangle that begins at `start` of
    /// the repeated pattern. The lowest corner of the rectangle is laid at `corner`.
    #[inline(always)]
    fn clip(
        &self,
        start: I64Vec2,
        size: [i32; 2],
        corner: Point,
        mut visit: impl FnMut(i32, i32, u32),
    ) {
        self.pieces(start, size, corner, |piece, corner| {
            self.piece(piece, corner, &mut visit);
        });
    }

    /// Cuts the rectangle that begins at `start` of the repeated pattern where it crosses the pattern's edges. Calls
    /// `visit` with each part, as a rectangle of the pattern, and with the place where its lowest corner is laid. The
    /// lowest corner of the whole is laid at `corner`. No rectangle crosses the edges of a bounded pattern, which every
    /// block fits into.
    #[inline(always)]
    fn pieces(
        &self,
        start: I64Vec2,
        [width, height]: [i32; 2],
        corner: Point,
        mut visit: impl FnMut(&Rect, Point),
    ) {
        let (period_x, period_y) = (self.shape.width, self.shape.height);

        let mut from_y = start.y.rem_euclid(i64::from(period_y)) as i32;
        let mut up = 0;
        while up < height {
            let rows = (height - up).min(period_y - from_y);
            let mut from_x = start.x.rem_euclid(i64::from(period_x)) as i32;
            let mut right = 0;
            while right < width {
                let columns = (width - right).min(period_x - from_x);
                let piece = Rect {
                    min: Point::new(from_x, from_y),
                    max: Point::new(from_x + columns, from_y + rows),
                };
                visit(&piece, Point::new(corner.x + right, corner.y + up));
                right += columns;
                // Beyond an edge the pattern begins again.
                from_x = 0;
            }
            up += rows;
            from_y = 0;
        }
    }

    /// Calls `visit` with the position and the pattern index of every sample of `piece`, a rectangle that does not
    /// cross the pattern's edge and whose lowest corner is laid at `corner`.
    #[inline(always)]
    fn piece(&self, piece: &Rect, corner: Point, visit: &mut impl FnMut(i32, i32, u32)) {
        let cell = |x: i32| (x >> CELL_BITS) as usize;
        let (first, last) = (cell(piece.min.x), cell(piece.max.x - 1));
        let (width, height) = (piece.width() as u32, piece.height() as u32);
        let (left, bottom) = (piece.min.x as u32, piece.min.y as u32);

        for row in cell(piece.min.y)..=cell(piece.max.y - 1) {
            let start = row * self.columns;
            let range = self.starts[start + first] as usize..self.starts[start + last + 1] as usize;
            let points = self.xs[range.clone()].iter().zip(&self.ys[range.clone()]);
            for ((x, y), &id) in points.zip(&self.ids[range]) {
                // Unsigned, a place left of the piece or below it is far to the right or above: one comparison an
                // axis does.
                let (x, y) = (x.wrapping_sub(left), y.wrapping_sub(bottom));
                if x < width && y < height {
                    visit(corner.x + x as i32, corner.y + y as i32, id);
                }
            }
        }
    }

    /// Calls `visit` with the cell and the slot of every sample of `piece`, which is laid at `corner` of `frame`. Eight
    /// samples are computed at once. A slot is a place within a cell: 15 bits of x, and above them 15 bits of y.
    #[inline(always)]
    fn slots<S: Simd>(
        &self,
        simd: S,
        frame: &Frame,
        piece: &Rect,
        corner: Point,
        visit: &mut impl FnMut(usize, u32),
    ) {
        let cell = |x: i32| (x >> CELL_BITS) as usize;
        let (first, last) = (cell(piece.min.x), cell(piece.max.x - 1));

        let width = u32x8::splat(simd, piece.width() as u32);
        let height = u32x8::splat(simd, piece.height() as u32);

        // A cell has a side of R, which is 2^CELL_BITS: the bits below are the place within the cell.
        let place_bits = R as u32 - 1;
        // Coordinates count from the corner of the cells of padding around the frame, so that none is negative.
        let (right, up) = (corner.x + (PAD << CELL_BITS), corner.y + (PAD << CELL_BITS));
        let stride = u32x8::splat(simd, frame.stride() as u32);

        for row in cell(piece.min.y)..=cell(piece.max.y - 1) {
            let start = row * self.columns;
            let (from, to) = (
                self.starts[start + first] as usize,
                self.starts[start + last + 1] as usize,
            );
            let (xs, ys) = (&self.xs[from..to + LANES], &self.ys[from..to + LANES]);

            for k in (0..to - from).step_by(LANES) {
                let x = u32x8::from_slice(simd, &xs[k..k + LANES]) - piece.min.x as u32;
                let y = u32x8::from_slice(simd, &ys[k..k + LANES]) - piece.min.y as u32;
                // Unsigned, offsets of places left of the piece or below it are too large to be inside.
                let mut inside = (x.simd_lt(width) & y.simd_lt(height)).to_bitmask() as u32;

                // The last group reads on into the samples of other cells, or into the eight at the end.
                let rest = to - from - k;
                if rest < LANES {
                    inside &= (1 << rest) - 1;
                }

                let (x, y) = (x + right as u32, y + up as u32);
                let cells = (y >> CELL_BITS) * stride + (x >> CELL_BITS);
                let slots = ((y & place_bits) << CELL_BITS) | (x & place_bits);
                let (cells, slots): ([u32; LANES], [u32; LANES]) = (cells.into(), slots.into());

                // Most groups lie inside of the piece as a whole. One at its border is looked at bit by bit.
                if inside == (1 << LANES) - 1 {
                    for (cell, slot) in cells.into_iter().zip(slots) {
                        visit(cell as usize, slot);
                    }
                } else {
                    while inside != 0 {
                        // The remainder changes nothing, but shows the compiler that the index is in range.
                        let lane = inside.trailing_zeros() as usize % LANES;
                        // Takes away the lowest bit that is set.
                        inside &= inside - 1;
                        visit(cells[lane] as usize, slots[lane]);
                    }
                }
            }
        }
    }
}

/// A block, or an image of it, that reaches into a frame.
#[derive(Clone, Copy, Debug)]
pub struct PlacedBlock {
    /// Its rectangle in the frame's coordinates, which may be far outside 32 bits.
    pub rect: Rect64,
    /// A number that is equal for all images of a block and grows with the block's index.
    pub sequence: u32,
    /// The block's index if the clipper counts blocks, otherwise 0.
    pub index: u32,
    /// The symmetry under which it clips.
    pub symmetry: u8,
    /// The pattern's point on the lowest corner of the block enlarged by r.
    pub start: Point,
}

/// Clips the pattern for the blocks of a run: the tree of blocks and the variants of the pattern.
#[derive(Clone)]
pub struct Clipper {
    domain: Domain,
    leaf: i32,
    key: Key,
    /// The pattern by symmetry.
    variants: Vec<CellPattern>,
    /// For every split of the tree, in order, the number of leaves of its lower side; `None` until blocks are counted.
    counts: Option<Vec<u32>>,
    /// Lists of the nodes that a search has yet to visit.
    stacks: Pool<Vec<Visit>>,
}

/// A node to visit, the index of its first split in the clipper's counts, and the index of its first leaf.
type Visit = (Node, u32, u32);

impl Clipper {
    /// Returns the clipper of a run: of `domain`, with blocks of `leaf` units under the run's `key`. With `dihedral`
    /// blocks clip from the eight rotations and mirror images of the pattern.
    #[must_use]
    pub fn new(domain: Domain, leaf: i32, key: Key, pattern: &Pattern, dihedral: bool) -> Self {
        let variants = (0..if dihedral { 8 } else { 1 })
            .map(|s| CellPattern::new(pattern.variant(Symmetry(s))))
            .collect();
        Self {
            domain,
            leaf,
            key,
            variants,
            counts: None,
            stacks: Pool::default(),
        }
    }

    /// Returns the pattern's variants, by symmetry.
    #[must_use]
    pub fn variants(&self) -> &[CellPattern] {
        &self.variants
    }

    /// Fails with the first block, in their order, that does not fit a bounded pattern: all engines then refuse a run
    /// in the same words, whichever of its blocks they would compute first.
    pub fn check_blocks(&self) -> Result<(), PatternError> {
        // Every block fits a periodic pattern.
        if self.variants.iter().all(|variant| variant.shape.periodic) {
            return Ok(());
        }
        let mut stack = vec![Node::root(&self.domain, self.key)];
        while let Some(node) = stack.pop() {
            if let Some(cut) = node.cut(self.leaf) {
                // The lower side is taken off the stack first: its blocks come first in the order.
                stack.extend([cut.upper, cut.lower]);
            } else {
                let (_, variant) = self.variant_of(&node.block);
                clip_start(&node.block, &variant.shape)?;
            }
        }
        Ok(())
    }

    /// Returns the symmetry under which a block is clipped, and the pattern's variant.
    fn variant_of(&self, block: &Block) -> (u8, &CellPattern) {
        let drawn = block.key.draw(Stream::Dihedral, 0)[0];
        let symmetry = below(drawn, self.variants.len() as u32);
        (symmetry as u8, &self.variants[symmetry as usize])
    }

    /// Counts the blocks, so that from now on blocks carry their index.
    pub fn count_blocks(&mut self) {
        if self.counts.is_none() {
            let mut counts = Vec::new();
            count(&Node::root(&self.domain, self.key), self.leaf, &mut counts);
            self.counts = Some(counts);
        }
    }

    /// Fills `out` with the blocks that, enlarged by r, reach into the frame, ordered by index, the images of a block
    /// one after the other. Fails if one of them does not fit a bounded pattern.
    pub fn blocks(&self, frame: &Frame, out: &mut Vec<PlacedBlock>) -> Result<(), SampleError> {
        out.clear();
        let target = frame.tiled();
        // The stack is empty: a search that fails does not give its stack back.
        let mut stack = self.stacks.take();
        stack.push((Node::root(&self.domain, self.key), 0, 0));
        let mut sequence = 0;

        while let Some((node, first_split, first_leaf)) = stack.pop() {
            let images = Images::of(&node.block.rect, frame, &target);
            // Blocks lie in their nodes: a node that does not reach into the frame has no block that does.
            if images.is_empty() {
                continue;
            }

            if let Some(cut) = node.cut(self.leaf) {
                // The leaves of the lower side. If blocks are not counted, every index is 0.
                let lower_leaves = self
                    .counts
                    .as_ref()
                    .map_or(0, |counts| counts[first_split as usize]);

                // In `counts` the node's own split comes first, then the `lower_leaves - 1` splits of the lower side,
                // then those of the upper one. The lower side is pushed last, to be visited first: it has the smaller
                // indices.
                stack.push((
                    cut.upper,
                    first_split + lower_leaves,
                    first_leaf + lower_leaves,
                ));
                stack.push((cut.lower, first_split + 1, first_leaf));
            } else {
                self.push_images(&node.block, &images, sequence, first_leaf, out)?;
                sequence += 1;
            }
        }

        self.stacks.give(stack);
        Ok(())
    }

    /// Appends the images of a block in the frame. Fails if the block does not fit a bounded pattern.
    fn push_images(
        &self,
        block: &Block,
        images: &Images,
        sequence: u32,
        index: u32,
        out: &mut Vec<PlacedBlock>,
    ) -> Result<(), SampleError> {
        let (symmetry, variant) = self.variant_of(block);
        let start = clip_start(block, &variant.shape)?;
        out.extend(images.rects().map(|rect| PlacedBlock {
            rect,
            sequence,
            index,
            symmetry,
            start,
        }));
        Ok(())
    }

    /// Calls `visit` with the position in the frame and the pattern index of every sample that `block` clips inside
    /// `part` (of the enlarged block) and `target`.
    #[inline(always)]
    pub fn clip(
        &self,
        block: &PlacedBlock,
        part: &Rect64,
        target: &Rect,
        visit: impl FnMut(i32, i32, u32),
    ) {
        let Some(rect) = part.within(target) else {
            return;
        };
        let size = [rect.width(), rect.height()];
        self.variants[block.symmetry as usize].clip(start_of(block, &rect), size, rect.min, visit);
    }

    /// Visits the samples that [`Self::clip`] visits with [`Frame::tiled`] as the target, but calls `visit` with each
    /// sample's cell of `frame` and its slot there: 15 bits of x, and above them 15 bits of y.
    #[inline(always)]
    pub fn clip_slots<S: Simd>(
        &self,
        simd: S,
        block: &PlacedBlock,
        part: &Rect64,
        frame: &Frame,
        mut visit: impl FnMut(usize, u32),
    ) {
        let Some(rect) = part.within(&frame.tiled()) else {
            return;
        };
        let size = [rect.width(), rect.height()];
        let pattern = &self.variants[block.symmetry as usize];
        pattern.pieces(start_of(block, &rect), size, rect.min, |piece, corner| {
            pattern.slots(simd, frame, piece, corner, &mut visit);
        });
    }
}

/// Returns the point of the pattern at the lowest corner of `rect`, a part of a block enlarged by r.
fn start_of(block: &PlacedBlock, rect: &Rect) -> I64Vec2 {
    let corner = block.rect.min - i64::from(R);
    I64Vec2::from(block.start) + I64Vec2::from(rect.min) - corner
}

/// Appends, for every split at or below `node` in order, the number of leaves of its lower side. Returns the number of
/// leaves of `node`.
fn count(node: &Node, leaf: i32, counts: &mut Vec<u32>) -> u32 {
    let Some(cut) = node.cut(leaf) else {
        return 1;
    };

    let at = counts.len();
    counts.push(0);
    let lower = count(&cut.lower, leaf, counts);
    counts[at] = lower;
    lower + count(&cut.upper, leaf, counts)
}

/// The images of a rectangle of the domain that, enlarged by r, meet a frame's target.
struct Images {
    rect: Rect64,
    /// Sides of the domain.
    sides: I64Vec2,
    /// First and last shift on each axis, in sides.
    shifts: [[i64; 2]; 2],
}

impl Images {
    /// Returns the images of `rect` that reach into a frame whose tiled samples lie in `target`.
    fn of(rect: &Rect, frame: &Frame, target: &Rect) -> Self {
        let rect = Rect64::from(*rect).moved(-frame.origin);
        let sides = I64Vec2::from(frame.sides.map(i64::from));
        let grown = rect.grown(R.into(), R.into());
        let (low, high) = (I64Vec2::from(target.min), I64Vec2::from(target.max));

        let shifts = std::array::from_fn(|axis| {
            if frame.periodic {
                // The image moved by k sides meets the target if min + k side < high and low < max + k side.
                let side = sides[axis];
                let first = (low[axis] - grown.max[axis]).div_euclid(side) + 1;
                let last = (high[axis] - 1 - grown.min[axis]).div_euclid(side);
                [first, last]
            } else if grown.min[axis] < high[axis] && low[axis] < grown.max[axis] {
                [0, 0]
            } else {
                // The last shift is below the first, which means that there is no image.
                [1, 0]
            }
        });

        Self {
            rect,
            sides,
            shifts,
        }
    }

    fn is_empty(&self) -> bool {
        self.shifts.iter().any(|[first, last]| first > last)
    }

    fn rects(&self) -> impl Iterator<Item = Rect64> {
        let [[left, right], [bottom, top]] = self.shifts;
        (bottom..=top).flat_map(move |j| {
            (left..=right).map(move |i| self.rect.moved(I64Vec2::new(i, j) * self.sides))
        })
    }
}
