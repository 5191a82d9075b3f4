//! Finds the blocks that reach into a region, and the pattern's samples in any rectangle of a block.

use glam::I64Vec2;

use crate::error::SampleError;
use crate::lattice::{Domain, Point, R, Rect, Rect64};
use crate::pattern::{Pattern, PatternVariant, Symmetry};
use crate::random::{Key, Stream, below};
use crate::stages::blocks::{Block, Node};
use crate::stages::tile::clip_start;

use super::frame::{CELL_BITS, Frame};

/// The pattern under one symmetry, by cells: rows of cells, then columns.
pub struct CellPattern {
    /// Sides and boundary; the samples are in the fields below.
    pub shape: PatternVariant,
    /// Cells in a row.
    pub columns: usize,
    /// Index of each cell's first sample; one more at the end.
    pub starts: Vec<u32>,
    /// Positions, cell by cell.
    pub points: Vec<Point>,
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
            points: samples.iter().map(|s| s.0).collect(),
            ids: samples.iter().map(|s| s.1).collect(),
        }
    }

    /// Calls `place` with the place, counted from `corner`, and the pattern index of every sample of a
    /// `width` x `height` rectangle whose lowest corner lies at `start` of the (repeated) pattern.
    #[inline(always)]
    fn clip(
        &self,
        start: I64Vec2,
        [width, height]: [i32; 2],
        corner: Point,
        mut place: impl FnMut(i32, i32, u32),
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
                self.piece(
                    &piece,
                    Point::new(corner.x + right, corner.y + up),
                    &mut place,
                );
                right += columns;
                from_x = 0;
            }
            up += rows;
            from_y = 0;
        }
    }

    /// The same for a rectangle of the pattern that does not cross its edge.
    #[inline(always)]
    fn piece(&self, piece: &Rect, corner: Point, place: &mut impl FnMut(i32, i32, u32)) {
        let cell = |x: i32| (x >> CELL_BITS) as usize;
        let (first, last) = (cell(piece.min.x), cell(piece.max.x - 1));
        let (width, height) = (piece.width() as u32, piece.height() as u32);
        for row in cell(piece.min.y)..=cell(piece.max.y - 1) {
            let start = row * self.columns;
            let range = self.starts[start + first] as usize..self.starts[start + last + 1] as usize;
            for (p, &id) in self.points[range.clone()].iter().zip(&self.ids[range]) {
                let (x, y) = (p.x - piece.min.x, p.y - piece.min.y);
                if (x as u32) < width && (y as u32) < height {
                    place(corner.x + x, corner.y + y, id);
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
    /// The place in the pattern of the lowest corner of the block enlarged by r.
    pub start: Point,
}

/// Clips the pattern for the blocks of a run: the tree of blocks and the variants of the pattern.
pub struct Clipper {
    domain: Domain,
    leaf: i32,
    key: Key,
    variants: Vec<CellPattern>,
    counts: Option<Vec<u32>>,
}

/// A node to visit: the node, the sequence number of its first split, the index of its first leaf.
type Visit = (Node, u32, u32);

impl Clipper {
    /// Returns the clipper of a run: of `domain`, with blocks of `leaf` units under the run's `key`.
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
        }
    }

    /// Returns the pattern's variants, by symmetry.
    #[must_use]
    pub fn variants(&self) -> &[CellPattern] {
        &self.variants
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
    /// one after the other.
    pub fn blocks(&self, frame: &Frame, out: &mut Vec<PlacedBlock>) -> Result<(), SampleError> {
        out.clear();
        let target = frame.tiled();
        let mut stack: Vec<Visit> = vec![(Node::root(&self.domain, self.key), 0, 0)];
        let mut sequence = 0;
        while let Some((node, split, leaf)) = stack.pop() {
            let images = Images::of(&node.block.rect, frame, &target);
            if images.is_empty() {
                continue;
            }
            if let Some(cut) = node.cut(self.leaf) {
                let lower = self
                    .counts
                    .as_ref()
                    .map_or(0, |counts| counts[split as usize]);
                stack.push((cut.upper, split + lower, leaf + lower));
                stack.push((cut.lower, split + 1, leaf));
            } else {
                self.place(&node.block, &images, sequence, leaf, out)?;
                sequence += 1;
            }
        }
        Ok(())
    }

    fn place(
        &self,
        block: &Block,
        images: &Images,
        sequence: u32,
        index: u32,
        out: &mut Vec<PlacedBlock>,
    ) -> Result<(), SampleError> {
        let symmetry = below(
            block.key.draw(Stream::Dihedral, 0)[0],
            self.variants.len() as u32,
        );
        let start = clip_start(block, &self.variants[symmetry as usize].shape)?;
        out.extend(images.rects().map(|rect| PlacedBlock {
            rect,
            sequence,
            index,
            symmetry: symmetry as u8,
            start,
        }));
        Ok(())
    }

    /// Calls `place` with the place in the frame and the pattern index of every sample that `block`
    /// clips inside `part` (of the enlarged block) and `target`.
    #[inline(always)]
    pub fn clip(
        &self,
        block: &PlacedBlock,
        part: &Rect64,
        target: &Rect,
        place: impl FnMut(i32, i32, u32),
    ) {
        let Some(rect) = part.within(target) else {
            return;
        };
        let corner = block.rect.min - i64::from(R);
        let start = I64Vec2::from(block.start) + I64Vec2::from(rect.min) - corner;
        let size = [rect.width(), rect.height()];
        self.variants[block.symmetry as usize].clip(start, size, rect.min, place);
    }
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
    sides: I64Vec2,
    /// First and last shift on each axis, in sides.
    shifts: [[i64; 2]; 2],
}

impl Images {
    fn of(rect: &Rect, frame: &Frame, target: &Rect) -> Self {
        let rect = Rect64::from(*rect).moved(-frame.origin);
        let sides = I64Vec2::from(frame.sides.map(i64::from));
        let reach = rect.grown(R.into(), R.into());
        let (low, high) = (I64Vec2::from(target.min), I64Vec2::from(target.max));
        let shifts = std::array::from_fn(|axis| {
            if frame.periodic {
                // min + k side < high and low < max + k side.
                let side = sides[axis];
                let first = (low[axis] - reach.max[axis]).div_euclid(side) + 1;
                let last = (high[axis] - 1 - reach.min[axis]).div_euclid(side);
                [first, last]
            } else if reach.min[axis] < high[axis] && low[axis] < reach.max[axis] {
                [0, 0]
            } else {
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
