//! The tree of events: phase or iteration, block, sample, search, test. A skip table of four bytes an event has the end
//! of each event's descendants. The visible rows of a list are in `rows`.

mod rows;

pub use rows::{OutlineRow, OutlineRows};

use crate::event::{Event, NONE};
use crate::recording::Recording;

/// Events between two stored rows of ancestors. Chosen, not measured.
const STRIDE: usize = 1024;

/// The depth of the deepest events, plus one.
const LEVELS: usize = 5;

/// The tree of events. The parent of an event is the nearest earlier event that is less deep; an event without one is a
/// root.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Outline {
    /// The first event after each one's descendants.
    ends: Vec<u32>,
    /// For every 1024th event its ancestor of each depth.
    ancestors: Vec<[u32; LEVELS]>,
}

impl Outline {
    /// Returns the tree of a recording's events. It takes one pass over the tape and 4 bytes an event.
    #[must_use]
    pub fn new(recording: &Recording) -> Self {
        let depths = recording.tape().iter().map(Event::depth);
        Self::of_depths(depths, recording.len())
    }

    /// Returns the tree of `len` events of these depths, each below [`LEVELS`].
    fn of_depths(depths: impl DoubleEndedIterator<Item = u8>, len: usize) -> Self {
        let mut ends = vec![0; len];

        // For each depth, the nearest event after the current one that is at most so deep.
        let mut next = [len as u32; LEVELS];
        // From the last event to the first, so that the end of each event's descendants is known when it is met.
        for (index, depth) in (0..len).rev().zip(depths.rev()) {
            // No depth is greater: the bound only keeps it within `next`.
            let depth = usize::from(depth).min(LEVELS - 1);
            ends[index] = next[depth];
            // An event ends all that are at least as deep as it is.
            next[depth..].fill(index as u32);
        }

        let mut outline = Self {
            ends,
            ancestors: Vec::with_capacity(len / STRIDE + 1),
        };
        outline.keep_ancestors();
        outline
    }

    /// Stores a row for every `STRIDE`th event: the open events there, which are the ancestors of that event. `parent`
    /// reads the row where it finds no ancestor behind the row's event.
    fn keep_ancestors(&mut self) {
        let mut open: Vec<u32> = Vec::with_capacity(LEVELS);
        for index in 0..self.ends.len() {
            while open
                .last()
                .is_some_and(|&last| self.ends[last as usize] <= index as u32)
            {
                open.pop();
            }

            if index.is_multiple_of(STRIDE) {
                let mut row = [NONE; LEVELS];
                row[..open.len()].copy_from_slice(&open);
                self.ancestors.push(row);
            }

            // Each open event is deeper than the open one before it, and the deepest events have no children. So at
            // most four events are open at a time.
            if self.has_children(index) {
                open.push(index as u32);
            }
        }
    }

    /// Returns how many events there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.ends.len()
    }

    /// Returns whether there are no events.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Returns the first event after the last descendant of an event, at most the number of events.
    #[must_use]
    pub fn end(&self, index: usize) -> usize {
        self.ends.get(index).map_or(self.len(), |&end| end as usize)
    }

    /// Returns whether an event has children.
    #[must_use]
    pub fn has_children(&self, index: usize) -> bool {
        self.ends
            .get(index)
            .is_some_and(|&end| end as usize > index + 1)
    }

    /// Returns the parent of an event, or `None` for a root and where there is no such event. Reads about 1024 entries at
    /// most.
    #[must_use]
    pub fn parent(&self, index: usize) -> Option<usize> {
        if index >= self.len() {
            return None;
        }

        let holds = |&event: &usize| self.ends[event] as usize > index;
        let key = index / STRIDE;
        let near = (key * STRIDE..index).rev().find(holds);

        // An ancestor from before the stored row is in the row, whose last entry is the deepest.
        near.or_else(|| {
            let stored = self.ancestors[key].iter().rev();
            let earlier = stored.filter(|&&event| event != NONE);
            earlier.map(|&event| event as usize).find(holds)
        })
    }

    /// Returns the ancestors of an event, the nearest first.
    pub fn parents(&self, index: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(self.parent(index), |&event| self.parent(event))
    }

    /// Returns the children of an event, in sequence.
    pub fn children(&self, index: usize) -> impl Iterator<Item = usize> {
        self.row(index.saturating_add(1).min(self.len()), self.end(index))
    }

    /// Returns the roots, in sequence.
    pub fn roots(&self) -> impl Iterator<Item = usize> {
        self.row(0, self.len())
    }

    /// Returns the siblings from `start` to `end`, skipping descendants.
    fn row(&self, start: usize, end: usize) -> impl Iterator<Item = usize> {
        let within = move |event: usize| (event < end).then_some(event);
        std::iter::successors(within(start), move |&event| within(self.end(event)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Returns the parents, each found by walking back.
    fn parents(depths: &[u8]) -> Vec<Option<usize>> {
        (0..depths.len())
            .map(|k| (0..k).rev().find(|&j| depths[j] < depths[k]))
            .collect()
    }

    fn reached(outline: &Outline, event: usize, seen: &mut Vec<usize>) {
        seen.push(event);
        for child in outline.children(event) {
            reached(outline, child, seen);
        }
    }

    proptest! {
        #[test]
        fn the_tree_is_the_naive_one(depths in prop::collection::vec(0_u8..5, 0..3_000)) {
            let outline = Outline::of_depths(depths.iter().copied(), depths.len());
            let expected = parents(&depths);
            let found: Vec<_> = (0..depths.len()).map(|k| outline.parent(k)).collect();
            prop_assert_eq!(&found, &expected);
            let mut seen = Vec::new();
            for root in outline.roots() {
                reached(&outline, root, &mut seen);
            }
            // Every event exactly once, and in sequence.
            prop_assert_eq!(seen, (0..depths.len()).collect::<Vec<_>>());
            for k in (0..depths.len()).step_by(37) {
                let children: Vec<usize> = outline.children(k).collect();
                let naive: Vec<usize> =
                    (0..depths.len()).filter(|&j| expected[j] == Some(k)).collect();
                prop_assert_eq!(outline.has_children(k), !naive.is_empty());
                prop_assert_eq!(children, naive);
                let end = (k + 1..depths.len()).find(|&j| depths[j] <= depths[k]);
                prop_assert_eq!(outline.end(k), end.unwrap_or(depths.len()));
            }
        }
    }

    #[test]
    fn events_that_there_are_not_have_no_family() {
        let outline = Outline::of_depths([0, 1].into_iter(), 2);
        assert_eq!(outline.parent(2), None);
        assert_eq!(outline.children(usize::MAX).next(), None);
        assert_eq!(outline.end(7), 2);
        assert!(!outline.has_children(1) && !outline.has_children(2));
        assert_eq!(Outline::of_depths([].into_iter(), 0).roots().next(), None);
    }
}
