//! Many lists in one memory: each is a chain of groups of eight, and other lists use the groups of a list that is closed.

// Loops over a chain are compiled for the instructions of the function that asks for them.
#![allow(clippy::inline_always)]

/// How many members a group has, which are compared at a time.
pub(crate) const GROUP_LANES: usize = 8;

/// The number of no group.
const NO_GROUP: u32 = u32::MAX;

/// The groups of all lists.
pub(crate) struct Chains<G> {
    groups: Vec<G>,
    /// The group after each one, in its chain or among the free ones.
    next: Vec<u32>,
    /// The first of the groups that no list has any more.
    free: u32,
}

/// A list as a chain of groups, of which only the first may have free lanes.
#[derive(Clone, Copy)]
pub(crate) struct Chain {
    first: u32,
    /// Groups of the chain. Most have one, whose next is not looked up.
    groups: u16,
    /// Members of the first group.
    filled: u8,
    is_closed: bool,
}

/// Where a member is: in a lane of a group.
#[derive(Clone, Copy)]
pub(crate) struct Lane {
    pub group: usize,
    pub number: usize,
}

impl Chain {
    pub const EMPTY: Self = Self {
        first: NO_GROUP,
        groups: 0,
        // The first member begins a group.
        filled: GROUP_LANES as u8,
        is_closed: false,
    };

    /// A list that takes no members.
    pub const CLOSED: Self = Self {
        is_closed: true,
        ..Self::EMPTY
    };

    /// Returns whether it takes no members.
    #[inline]
    pub const fn is_closed(self) -> bool {
        self.is_closed
    }
}

impl<G: Copy> Chains<G> {
    /// Returns room for some groups, and no lists.
    pub fn with_capacity(groups: usize) -> Self {
        Self {
            groups: Vec::with_capacity(groups),
            next: Vec::with_capacity(groups),
            free: NO_GROUP,
        }
    }

    /// Returns a lane for one member more of a list, which must not be closed. If it is the first one of a group, the group is a
    /// copy of `empty`.
    #[inline(always)]
    pub fn add(&mut self, chain: &mut Chain, empty: &G) -> Lane {
        if usize::from(chain.filled) == GROUP_LANES {
            chain.first = self.add_group(chain.first, empty);
            chain.groups += 1;
            chain.filled = 0;
        }
        let number = usize::from(chain.filled);
        chain.filled += 1;
        Lane {
            group: chain.first as usize,
            number,
        }
    }

    /// Adds a group before `next`, in the place of a free one if there is any, and returns its number.
    fn add_group(&mut self, next: u32, empty: &G) -> u32 {
        if self.free == NO_GROUP {
            // The room at first is an estimate of all groups, so that only a few do not fit. A vector would double its
            // room by itself, and most of it would stay empty. An eighth is added instead, and 8 for small vectors.
            if self.groups.len() == self.groups.capacity() {
                let more = self.groups.len() / 8 + 8;
                self.groups.reserve_exact(more);
                self.next.reserve_exact(more);
            }
            self.groups.push(*empty);
            self.next.push(next);
            return self.groups.len() as u32 - 1;
        }
        let number = self.free;
        let after = &mut self.next[number as usize];
        self.free = *after;
        *after = next;
        self.groups[number as usize] = *empty;
        number
    }

    /// Returns a group by its number.
    #[inline]
    pub fn group_mut(&mut self, number: usize) -> &mut G {
        &mut self.groups[number]
    }

    /// Empties and closes a list. Others may use its groups.
    pub fn close(&mut self, chain: &mut Chain) {
        let mut number = chain.first;
        for _ in 0..chain.groups {
            let next = &mut self.next[number as usize];
            let after = *next;
            *next = self.free;
            self.free = number;
            number = after;
        }
        *chain = Chain::CLOSED;
    }

    /// Returns the groups of a list and their numbers.
    #[inline(always)]
    pub fn of(&self, chain: Chain) -> impl Iterator<Item = (usize, &G)> {
        let (mut number, mut left) = (chain.first as usize, chain.groups);
        std::iter::from_fn(move || {
            left = left.checked_sub(1)?;
            let own = number;
            if left > 0 {
                number = self.next[own] as usize;
            }
            Some((own, &self.groups[own]))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_keep_their_members_when_others_take_the_groups_of_closed_ones() {
        let mut chains = Chains::with_capacity(1);
        let mut lists = [Chain::EMPTY; 3];
        let add = |chains: &mut Chains<[u32; 8]>, list: &mut Chain, value: u32| {
            let Lane { group, number } = chains.add(list, &[0; 8]);
            chains.group_mut(group)[number] = value;
        };
        let members = |chains: &Chains<[u32; 8]>, list: Chain| {
            let groups = chains.of(list).flat_map(|(_, group)| *group);
            let mut all: Vec<u32> = groups.filter(|&value| value > 0).collect();
            all.sort_unstable();
            all
        };

        // Two lists in turn, of three groups each.
        for value in 1..=20 {
            add(&mut chains, &mut lists[0], value);
            add(&mut chains, &mut lists[1], 100 + value);
        }
        chains.close(&mut lists[0]);
        assert!(lists[0].is_closed() && members(&chains, lists[0]).is_empty());

        for value in 201..=230 {
            add(&mut chains, &mut lists[2], value);
        }
        assert_eq!(members(&chains, lists[1]), (101..=120).collect::<Vec<_>>());
        assert_eq!(members(&chains, lists[2]), (201..=230).collect::<Vec<_>>());
        // Of the four groups of the last list three are those of the first.
        assert_eq!(chains.groups.len(), 3 + 3 + 1);
    }
}
