//! Finds the blocks that reach into a frame, with the place in the nested pattern that each of them shows.

use glam::I64Vec2;

use crate::lattice::{Domain, R, Rect, Rect64};
use crate::random::{Key, Stream, below};
use crate::stages::blocks::{Block, Node};

/// A block, or an image of it in a periodic domain.
#[derive(Clone, Copy, Debug)]
pub(super) struct NestedBlock {
    /// Its rectangle in the frame's coordinates.
    pub rect: Rect64,
    /// A number that is equal for all images of a block and grows with the block's index.
    pub sequence: u32,
    /// The symmetry under which it clips.
    pub symmetry: u8,
    /// The place in the pattern that lies on the place (0, 0).
    pub origin: I64Vec2,
}

/// What blocks and their clips are drawn from.
pub(super) struct BlockDraws {
    pub domain: Domain,
    pub leaf: i32,
    pub key: Key,
    pub symmetries: u32,
    /// The side of the periodic pattern, in units.
    pub period: i32,
}

impl BlockDraws {
    /// Fills `out` with the blocks that, enlarged by `reach` units, meet `target`, in the order of their indices. Both
    /// are in the frame's coordinates, which begin at the plane's place `origin`. `repeats` says whether a block may
    /// meet the target several times, as its images do in a periodic plane.
    pub fn find(
        &self,
        target: &Rect,
        origin: I64Vec2,
        reach: i32,
        repeats: bool,
        out: &mut Vec<NestedBlock>,
    ) {
        out.clear();
        let mut sequence = 0;
        let mut stack = vec![Node::root(&self.domain, self.key)];

        while let Some(node) = stack.pop() {
            let found = self.images(&node.block.rect, target, origin, reach, repeats);
            let mut rects = found.peekable();
            // The node does not reach the target, and so none of its leaves does. Leaves that are left out get no
            // number, and the numbers still grow with the indices.
            if rects.peek().is_none() {
                continue;
            }

            if let Some(cut) = node.cut(self.leaf) {
                // The last one pushed is taken first: the lower part has the lower indices.
                stack.push(cut.upper);
                stack.push(cut.lower);
            } else {
                out.extend(rects.map(|rect| self.place(&node.block, rect, sequence)));
                sequence += 1;
            }
        }
    }

    fn place(&self, block: &Block, rect: Rect64, sequence: u32) -> NestedBlock {
        let symmetry = below(block.key.draw(Stream::Dihedral, 0)[0], self.symmetries);
        let words = block.key.draw(Stream::Offset, 0);
        // As in a run of one level, the place drawn comes to lie on the corner of the block enlarged by the finest radius.
        let start = words.map(|word| i64::from(below(word, self.period as u32)));
        NestedBlock {
            rect,
            sequence,
            symmetry: symmetry as u8,
            origin: I64Vec2::from(start) - (rect.min - i64::from(R)),
        }
    }

    /// Returns the images of a rectangle of the domain that, enlarged by `reach`, meet the target: itself alone, unless the
    /// plane repeats.
    fn images(
        &self,
        rect: &Rect,
        target: &Rect,
        origin: I64Vec2,
        reach: i32,
        repeats: bool,
    ) -> impl Iterator<Item = Rect64> + use<> {
        let rect = Rect64::from(*rect).moved(-origin);

        let (grown, target) = (
            rect.grown(reach.into(), reach.into()),
            Rect64::from(*target),
        );

        let sides = I64Vec2::new(self.domain.width().into(), self.domain.height().into());
        let shifts = [0, 1].map(|axis| {
            let (low, high) = (grown.min[axis], grown.max[axis]);
            let (first, end, side) = (target.min[axis], target.max[axis], sides[axis]);
            if repeats {
                // The image moved by k sides meets the target if low + k side < end and first < high + k side.
                ((first - high).div_euclid(side) + 1)..=((end - 1 - low).div_euclid(side))
            } else {
                // The rectangle itself, shift 0, or nothing: 0..=-1 is empty.
                0..=i64::from(low < end && first < high) - 1
            }
        });

        let [columns, rows] = shifts;
        rows.flat_map(move |j| {
            let columns = columns.clone();
            columns.map(move |i| rect.moved(I64Vec2::new(i, j) * sides))
        })
    }
}
