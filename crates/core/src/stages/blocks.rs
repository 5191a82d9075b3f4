//! Building blocks: the leaves of a random KD-tree over the domain (paper, Algorithm 1). Every node's key is derived
//! from its parent's, so any branch can be computed alone.

use crate::lattice::{Domain, Point, Rect};
use crate::random::{Key, Stream, below};
use crate::record::{Recorder, RunEvent, Unrecorded};

/// An axis of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Axis {
    /// From left to right.
    X,
    /// From bottom to top.
    Y,
}

impl Axis {
    const fn other(self) -> Self {
        match self {
            Self::X => Self::Y,
            Self::Y => Self::X,
        }
    }
}

/// A node that was split.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Split {
    /// The rectangle of the node.
    pub rect: Rect,
    /// The axis across which it was split.
    pub axis: Axis,
    /// The first coordinate of the upper child.
    pub plane: i32,
    /// The number of splits above it.
    pub depth: u32,
}

/// A leaf of the KD-tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Block {
    /// The block's rectangle, half open.
    pub rect: Rect,
    /// The key from which the block's own draws are made.
    pub key: Key,
    /// The number of splits above it.
    pub depth: u32,
}

/// The KD-tree: its splits in the sequence in which they were made (parents first, lower side
/// first), and its leaves in the same sequence.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Blocks {
    /// All splits, parents first.
    pub splits: Vec<Split>,
    /// All leaves; a block's index is its index here.
    pub leaves: Vec<Block>,
}

/// Returns the building blocks of `domain`: rectangles that tile it, every edge in
/// `[leaf, 2 leaf)` units, or the domain's own side where that is shorter than `2 leaf`.
///
/// Algorithm 1 splits while an extent exceeds the threshold, which would make shorter edges than
/// it promises; here an axis is split only while its extent is at least twice the leaf.
#[must_use]
pub fn split(domain: &Domain, leaf: i32, key: Key) -> Blocks {
    split_recorded(domain, leaf, key, &mut Unrecorded)
}

/// Like [`split`], and reports events to `recorder`.
pub(crate) fn split_recorded<T: Recorder>(
    domain: &Domain,
    leaf: i32,
    key: Key,
    recorder: &mut T,
) -> Blocks {
    let mut blocks = Blocks::default();
    let mut stack = vec![Node::root(domain, key)];

    while let Some(node) = stack.pop() {
        match node.cut(leaf) {
            None => {
                recorder.record(RunEvent::Leaf {
                    block: blocks.leaves.len() as u32,
                });
                blocks.leaves.push(node.block);
            }
            Some(cut) => {
                // If the rectangle is too short along the axis whose turn it was, it is cut across the other axis.
                recorder.record(RunEvent::Split {
                    index: blocks.splits.len() as u32,
                    turned: cut.axis != node.axis,
                });
                blocks.splits.push(Split {
                    rect: node.block.rect,
                    axis: cut.axis,
                    plane: cut.plane,
                    depth: node.block.depth,
                });

                // The lower child is taken from the stack first: the paper's recursion goes left before right
                // (Algorithm 1, lines 5 and 6), and blocks are numbered in this sequence.
                stack.push(cut.upper);
                stack.push(cut.lower);
            }
        }
    }

    blocks
}

/// A node of the tree that may or may not be cut.
#[derive(Clone, Copy)]
pub(crate) struct Node {
    /// The block that the node is if it is not cut.
    pub(crate) block: Block,
    /// The axis across which it is cut if it is long enough.
    axis: Axis,
}

/// A node's children and the plane between them.
pub(crate) struct Cut {
    axis: Axis,
    plane: i32,
    pub(crate) lower: Node,
    pub(crate) upper: Node,
}

impl Node {
    /// Returns the root over `domain` under a run's key.
    pub(crate) fn root(domain: &Domain, key: Key) -> Self {
        Self {
            block: Block {
                rect: domain.rect(),
                key: key.derive(Stream::Split, 0),
                depth: 0,
            },
            axis: Axis::X,
        }
    }

    /// Returns how the node is cut, or `None` for a leaf.
    pub(crate) fn cut(&self, leaf: i32) -> Option<Cut> {
        let Block { rect, key, depth } = &self.block;
        // Algorithm 1 splits while an extent exceeds the leaf, which could leave a child shorter than a leaf; twice the
        // leaf is needed. An axis that is too short passes its turn to the other (line 7). If both axes are too short,
        // the node is a leaf (line 9).
        let axis = [self.axis, self.axis.other()]
            .into_iter()
            .find(|&a| extent(rect, a) / 2 >= leaf)?;

        // Every plane that leaves at least a leaf on both sides is equally likely.
        let planes = (extent(rect, axis) - 2 * leaf + 1) as u32;
        let draw = below(key.draw(Stream::Plane, 0)[0], planes) as i32;
        let plane = start(rect, axis) + leaf + draw;
        let (lower, upper) = halves(rect, axis, plane);

        let child = |rect, side| Self {
            block: Block {
                rect,
                key: key.derive(Stream::Split, side),
                depth: depth + 1,
            },
            axis: axis.other(),
        };

        Some(Cut {
            axis,
            plane,
            lower: child(lower, 0),
            upper: child(upper, 1),
        })
    }
}

/// Returns where a rectangle begins on an axis.
const fn start(rect: &Rect, axis: Axis) -> i32 {
    match axis {
        Axis::X => rect.min.x,
        Axis::Y => rect.min.y,
    }
}

/// Returns how long a rectangle is on an axis.
const fn extent(rect: &Rect, axis: Axis) -> i32 {
    match axis {
        Axis::X => rect.width(),
        Axis::Y => rect.height(),
    }
}

/// Returns the lower and the upper part of a rectangle that is cut across an axis. The upper part begins at the
/// coordinate `plane`.
const fn halves(rect: &Rect, axis: Axis, plane: i32) -> (Rect, Rect) {
    match axis {
        Axis::X => (
            Rect {
                min: rect.min,
                max: Point::new(plane, rect.max.y),
            },
            Rect {
                min: Point::new(plane, rect.min.y),
                max: rect.max,
            },
        ),
        Axis::Y => (
            Rect {
                min: rect.min,
                max: Point::new(rect.max.x, plane),
            },
            Rect {
                min: Point::new(rect.min.x, plane),
                max: rect.max,
            },
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Boundary, R};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn leaves_tile_the_domain_with_edges_in_range(
            seed: u64,
            width in 10.0_f64..400.0,
            height in 10.0_f64..400.0,
            leaf in 6.0_f64..60.0,
            bounded: bool,
        ) {
            let boundary = if bounded { Boundary::Bounded } else { Boundary::Periodic };
            let domain = Domain::from_size([width, height], 1.0, boundary).unwrap();
            let leaf = (leaf * f64::from(R)) as i32;
            let blocks = split(&domain, leaf, Key::from_seed(seed));
            let whole = domain.rect();
            prop_assert_eq!(blocks.splits.len() + 1, blocks.leaves.len());
            let area = |r: &Rect| i64::from(r.width()) * i64::from(r.height());
            prop_assert_eq!(blocks.leaves.iter().map(|b| area(&b.rect)).sum::<i64>(), area(&whole));
            for (k, block) in blocks.leaves.iter().enumerate() {
                for (edge, side) in [
                    (block.rect.width(), whole.width()),
                    (block.rect.height(), whole.height()),
                ] {
                    prop_assert!(edge < 2 * leaf);
                    prop_assert!(edge >= leaf || edge == side && side < 2 * leaf);
                }
                for other in &blocks.leaves[k + 1..] {
                    let (a, b) = (&block.rect, &other.rect);
                    let apart = a.max.x <= b.min.x || b.max.x <= a.min.x
                        || a.max.y <= b.min.y || b.max.y <= a.min.y;
                    prop_assert!(apart);
                }
            }
        }
    }

    #[test]
    fn a_huge_leaf_gives_one_block() {
        let domain = Domain::from_size([20.0; 2], 1.0, Boundary::Periodic).unwrap();
        let blocks = split(&domain, i32::MAX / 2, Key::from_seed(0));
        assert_eq!(blocks.leaves.len(), 1);
        assert_eq!(blocks.leaves[0].rect, domain.rect());
    }
}
