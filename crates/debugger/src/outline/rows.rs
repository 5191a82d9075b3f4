//! The visible rows of the tree of events: which nodes are expanded, and which event is in each row.

use super::Outline;

/// A row of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct OutlineRow {
    /// The number of the event, from 0.
    pub event: usize,
    /// How many ancestors it has.
    pub level: usize,
    /// Whether it has children.
    pub has_children: bool,
    /// Whether its children are visible.
    pub expanded: bool,
}

/// An expanded node: its children, and which of them are expanded in turn.
#[derive(Clone, Debug, Default)]
struct Node {
    children: Vec<u32>,
    /// The first event after the last child's descendants.
    end: u32,
    open: Vec<Open>,
}

#[derive(Clone, Debug)]
struct Open {
    /// Which child it is.
    index: usize,
    /// Rows inside earlier expanded children.
    before: usize,
    /// Rows inside this one.
    rows: usize,
    node: Node,
}

/// The rows of an outline: its roots, and the children of expanded nodes.
///
/// Finding a row takes a few binary searches, however many there are; expanding a node takes 4 bytes and a
/// step for each of its children.
#[derive(Clone, Debug, Default)]
pub struct OutlineRows {
    root: Node,
}

impl Node {
    /// Returns the node of these children, the last of which ends at `end`; all are collapsed.
    fn of(children: impl Iterator<Item = usize>, end: usize) -> Self {
        Self {
            children: children.map(|event| event as u32).collect(),
            end: end as u32,
            open: Vec::new(),
        }
    }

    fn rows(&self) -> usize {
        let below = self.open.last().map_or(0, |open| open.before + open.rows);
        self.children.len() + below
    }

    fn has_children(&self, index: usize) -> bool {
        let next = self.children.get(index + 1).copied().unwrap_or(self.end);
        next > self.children[index] + 1
    }

    fn open_at(&self, index: usize) -> Result<usize, usize> {
        self.open.binary_search_by_key(&index, |open| open.index)
    }

    /// Returns the index of the child that is the event or its ancestor.
    fn child_of(&self, event: usize) -> Option<usize> {
        if event >= self.end as usize {
            return None;
        }
        let after = self
            .children
            .partition_point(|&child| child as usize <= event);
        after.checked_sub(1)
    }

    /// Returns the `k`-th row below this node, from 0. `level` is that of the node's children.
    fn row(&self, k: usize, level: usize) -> Option<OutlineRow> {
        // A child's row is its index and the rows inside expanded children before it. The last expanded child whose row is
        // at or before the wanted one decides where the wanted row lies.
        let after = self
            .open
            .partition_point(|open| open.index + open.before <= k);

        let (index, expanded) = match after.checked_sub(1).map(|last| &self.open[last]) {
            // No child up to the row is expanded: rows and children have the same numbers.
            None => (k, false),
            Some(open) => {
                // How many rows the wanted one lies below that of the expanded child.
                let below = k - open.index - open.before;
                // The rows inside the expanded child follow its own row at once.
                if (1..=open.rows).contains(&below) {
                    return open.node.row(below - 1, level + 1);
                }

                if below == 0 {
                    // The wanted row is that of the expanded child itself.
                    (open.index, true)
                } else {
                    // The wanted row is that of a later child, which is collapsed. The rows inside this expanded
                    // child and inside the earlier ones stand before it.
                    (k - open.before - open.rows, false)
                }
            }
        };

        Some(OutlineRow {
            event: *self.children.get(index)? as usize,
            level,
            has_children: self.has_children(index),
            expanded,
        })
    }

    /// Returns the row of an event below this node, from 0; `None` if a collapsed node hides it, or it is not below this one.
    fn row_of(&self, event: usize) -> Option<usize> {
        let index = self.child_of(event)?;
        let at = self.open_at(index);
        // The last expanded child before this one: as an error, `at` is the place that this one would have among them.
        let earlier = at.unwrap_or_else(|next| next).checked_sub(1);
        let before = earlier.map_or(0, |last| self.open[last].before + self.open[last].rows);

        if self.children[index] as usize == event {
            return Some(index + before);
        }

        // The event is a descendant of this child: it has a row if the child is expanded.
        let below = self.open[at.ok()?].node.row_of(event)?;
        Some(index + before + 1 + below)
    }

    /// Expands or collapses a visible event, or toggles it if `wanted` is `None`. Returns whether anything changed.
    fn set(&mut self, outline: &Outline, event: usize, wanted: Option<bool>) -> bool {
        let Some(index) = self.child_of(event) else {
            return false;
        };
        // Where the child stands in the list of expanded ones or, as an error, where it would stand.
        let at = self.open_at(index);
        // Whether the event is the child itself, and not one inside it.
        let own = self.children[index] as usize == event;

        let changed = match at {
            // The event lies inside an expanded child, whose node changes it.
            Ok(at) if !own => self.open[at].node.set(outline, event, wanted),

            // Collapsing a node also collapses the nodes within it.
            Ok(at) if wanted != Some(true) => {
                self.open.remove(at);
                true
            }

            // The numbers of rows are filled in below, by `count`.
            Err(at) if own && wanted != Some(false) && self.has_children(index) => {
                let node = Node::of(outline.children(event), outline.end(event));
                self.open.insert(
                    at,
                    Open {
                        index,
                        before: 0,
                        rows: 0,
                        node,
                    },
                );
                true
            }

            // It is as wanted already, hidden by a collapsed node, or has no children.
            _ => false,
        };

        // Rows before this child stay where they are.
        if changed {
            self.count(at.unwrap_or_else(|at| at));
        }
        changed
    }

    /// Counts the rows again from an expanded child on.
    fn count(&mut self, from: usize) {
        let earlier = from.checked_sub(1).map(|last| &self.open[last]);
        let mut before = earlier.map_or(0, |open| open.before + open.rows);
        for open in &mut self.open[from..] {
            (open.before, open.rows) = (before, open.node.rows());
            before += open.rows;
        }
    }
}

impl OutlineRows {
    /// Returns the rows of an outline with nothing expanded.
    #[must_use]
    pub fn new(outline: &Outline) -> Self {
        Self {
            root: Node::of(outline.roots(), outline.len()),
        }
    }

    /// Returns how many rows there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.root.rows()
    }

    /// Returns whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns a row, or `None` past the end.
    #[must_use]
    pub fn row(&self, k: usize) -> Option<OutlineRow> {
        self.root.row(k, 0)
    }

    /// Returns the row of an event, or `None` if a collapsed node hides it.
    #[must_use]
    pub fn row_of(&self, event: usize) -> Option<usize> {
        self.root.row_of(event)
    }

    /// Expands a collapsed event, or collapses an expanded one with everything in it. Returns whether anything changed:
    /// events without children and hidden ones do not change. `outline` must be the one that the rows were made from.
    pub fn toggle(&mut self, outline: &Outline, event: usize) -> bool {
        self.root.set(outline, event, None)
    }

    /// Expands all collapsed ancestors of an event.
    pub fn expand_to(&mut self, outline: &Outline, event: usize) {
        let mut parents: Vec<usize> = outline.parents(event).collect();
        while let Some(parent) = parents.pop() {
            self.root.set(outline, parent, Some(true));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    /// Returns a reference implementation: all rows, one by one.
    fn naive(outline: &Outline, expanded: &BTreeSet<usize>) -> Vec<OutlineRow> {
        fn walk(
            outline: &Outline,
            expanded: &BTreeSet<usize>,
            (event, level): (usize, usize),
            rows: &mut Vec<OutlineRow>,
        ) {
            let open = expanded.contains(&event);
            let has_children = outline.children(event).next().is_some();
            rows.push(OutlineRow {
                event,
                level,
                has_children,
                expanded: open,
            });
            if open {
                for child in outline.children(event) {
                    walk(outline, expanded, (child, level + 1), rows);
                }
            }
        }
        let mut rows = Vec::new();
        for root in outline.roots() {
            walk(outline, expanded, (root, 0), &mut rows);
        }
        rows
    }

    fn visible(outline: &Outline, expanded: &BTreeSet<usize>, event: usize) -> bool {
        outline
            .parents(event)
            .all(|parent| expanded.contains(&parent))
    }

    fn toggle_naively(outline: &Outline, expanded: &mut BTreeSet<usize>, event: usize) {
        if visible(outline, expanded, event) && outline.has_children(event) {
            if expanded.remove(&event) {
                let end = outline.end(event);
                expanded.retain(|&other| other < event || other >= end);
            } else {
                expanded.insert(event);
            }
        }
    }

    proptest! {
        #[test]
        fn rows_are_those_of_a_plain_walk(
            depths in prop::collection::vec(0_u8..5, 1..400),
            moves in prop::collection::vec((any::<bool>(), any::<prop::sample::Index>()), 0..40),
        ) {
            let outline = Outline::of_depths(depths.iter().copied(), depths.len());
            let (mut rows, mut expanded) = (OutlineRows::new(&outline), BTreeSet::new());
            for (to, index) in moves {
                let event = index.index(depths.len());
                if to {
                    rows.expand_to(&outline, event);
                    expanded.extend(outline.parents(event));
                } else {
                    let before = expanded.clone();
                    toggle_naively(&outline, &mut expanded, event);
                    prop_assert_eq!(rows.toggle(&outline, event), before != expanded);
                }
                let expected = naive(&outline, &expanded);
                prop_assert_eq!(rows.len(), expected.len());
                let found: Vec<_> = (0..rows.len()).map(|k| rows.row(k).unwrap()).collect();
                prop_assert_eq!(&found, &expected);
                prop_assert_eq!(rows.row(rows.len()), None);
                for event in 0..depths.len() {
                    let row = expected.iter().position(|row| row.event == event);
                    prop_assert_eq!(rows.row_of(event), row);
                }
            }
        }
    }

    #[test]
    fn half_a_million_children_are_rows_at_once() {
        let count = 500_000;
        let depths = [0]
            .into_iter()
            .chain((0..count).flat_map(|_| [2, 3]))
            .chain([0]);
        let depths: Vec<u8> = depths.collect();
        let outline = Outline::of_depths(depths.iter().copied(), depths.len());
        let mut rows = OutlineRows::new(&outline);
        assert!(rows.toggle(&outline, 0));
        assert_eq!(rows.len(), count + 2);
        for k in (1..count).step_by(997) {
            let row = rows.row(k).unwrap();
            assert_eq!(
                (row.event, row.level, row.has_children),
                (2 * k - 1, 1, true)
            );
            assert_eq!(outline.parent(row.event), Some(0));
        }
        rows.expand_to(&outline, 2 * count);
        assert_eq!(rows.row_of(2 * count), Some(count + 1));
        assert_eq!(rows.row(count + 1).unwrap().level, 2);
        assert_eq!(rows.row(count + 2).unwrap().event, 2 * count + 1);
        assert!(!rows.toggle(&outline, 2 * count));
        assert_eq!(rows.row_of(usize::MAX), None);
    }
}
