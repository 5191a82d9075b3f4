//! The largest of many numbers of which a few change at a time: each inner node of a binary tree has the larger number of the
//! two below it.

/// Numbers by slot, and the largest of them. Zero stands for none.
#[derive(Clone, Debug, Default)]
pub(super) struct Tournament {
    /// The root is node 1, the children of node `i` are `2 i` and `2 i + 1`, the lower half of the places are inner nodes.
    nodes: Vec<u64>,
}

impl Tournament {
    /// Returns the tree of the given number of slots without a number.
    pub fn new(slots: usize) -> Self {
        // With two leaves or more the root is an inner node.
        let nodes = vec![0; 2 * slots.next_power_of_two().max(2)];
        Self { nodes }
    }

    /// Returns the number of leaves: the slots that have room for a number.
    fn leaves(&self) -> usize {
        self.nodes.len() / 2
    }

    /// Returns the number of a slot; 0 if it has none, or no room for one yet.
    pub fn at(&self, slot: u32) -> u64 {
        let number = self.nodes.get(self.leaves() + slot as usize);
        number.copied().unwrap_or(0)
    }

    /// Returns the largest number; 0 if no slot has one.
    pub fn largest(&self) -> u64 {
        self.nodes[1]
    }

    /// Sets the number of a slot, and renews the nodes above it.
    pub fn set(&mut self, slot: u32, number: u64) {
        if slot as usize >= self.leaves() {
            self.grow(slot as usize + 1);
        }

        let mut node = self.leaves() + slot as usize;
        self.nodes[node] = number;
        while node > 1 {
            node /= 2;
            let larger = self.nodes[2 * node].max(self.nodes[2 * node + 1]);
            // A node that keeps its number changes none above it: most changes end after a few nodes.
            if self.nodes[node] == larger {
                break;
            }
            self.nodes[node] = larger;
        }
    }

    /// Makes room for the numbers of that many slots.
    fn grow(&mut self, slots: usize) {
        let mut larger = Self::new(slots);
        let (leaves, more) = (self.leaves(), larger.leaves());
        larger.nodes[more..more + leaves].copy_from_slice(&self.nodes[leaves..]);
        for node in (1..more).rev() {
            larger.nodes[node] = larger.nodes[2 * node].max(larger.nodes[2 * node + 1]);
        }
        *self = larger;
    }

    /// Returns the slots that have the largest number; none if no slot has one.
    pub fn winners(&self) -> Vec<u32> {
        let (largest, mut open, mut found) = (self.largest(), vec![1], Vec::new());
        while let Some(node) = open.pop() {
            if largest == 0 || self.nodes[node] != largest {
                continue;
            }
            if node < self.leaves() {
                open.extend([2 * node, 2 * node + 1]);
            } else {
                found.push((node - self.leaves()) as u32);
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_is_that_of_a_plain_search_after_every_change() {
        let mut tournament = Tournament::new(0);
        let mut plain = vec![0; 100];
        for step in 0_u64..3000 {
            let (slot, number) = (step * 37 % 100, step * step % 11);
            plain[slot as usize] = number;
            tournament.set(slot as u32, number);
            let largest = plain.iter().copied().max().unwrap_or(0);
            assert_eq!(tournament.largest(), largest, "{step}");

            let mut winners = tournament.winners();
            winners.sort_unstable();
            let with_it = |slot: &u32| largest > 0 && plain[*slot as usize] == largest;
            assert_eq!(winners, (0..100).filter(with_it).collect::<Vec<u32>>());
        }
    }
}
