//! Questions about samples and darts, in the order of arrival. Levels follow each other; while one is decided, more
//! questions of it may come up.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::exact::darts::{Arrival, PlacedDart};
use crate::stages::darts::LAST_LEVEL;

/// A question whose answer may differ from that in the pattern, to be decided when its dart arrives.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Arriving {
    pub(crate) dart: PlacedDart,
    pub(crate) what: What,
}

/// The question that a dart's arrival brings up.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum What {
    /// Whether an earlier sample covers a present one, given by its id.
    Sample(u32),
    /// Whether no earlier sample covers a dart of the tile given by its index.
    Dart(u32),
}

/// All questions, level by level.
#[derive(Default)]
pub(crate) struct Agenda {
    /// The questions of each level.
    levels: [Vec<Arriving>; LAST_LEVEL as usize + 1],
    deciding: Option<u32>,
    /// The arrivals of what is known of it, in their order, each with its index in the level.
    order: Vec<(Arrival, u32)>,
    /// How much of the level that is being decided is done.
    done: usize,
    /// The questions of that level that came up since it began.
    sudden: BinaryHeap<Reverse<Arriving>>,
}

impl Agenda {
    /// Removes all questions, so that another tiling can begin.
    pub(crate) fn clear(&mut self) {
        self.levels.iter_mut().for_each(Vec::clear);
        self.sudden.clear();
        self.deciding = None;
    }

    /// Adds a question, to be decided when its dart arrives.
    #[inline]
    pub(crate) fn add(&mut self, dart: PlacedDart, what: What) {
        let level = dart.arrival.level();
        let arriving = Arriving { dart, what };

        if self.deciding == Some(level) {
            self.sudden.push(Reverse(arriving));
        } else {
            self.levels[level as usize].push(arriving);
        }
    }

    /// Begins a level, and returns how much arrives with it as far as that is known.
    pub(crate) fn begin(&mut self, level: u32) -> usize {
        // Nearly everything is known when a level begins: to sort it once costs less than a heap of all.
        let known = &self.levels[level as usize];
        let arrivals = known.iter().map(|arriving| arriving.dart.arrival);
        self.order.clear();
        self.order.extend(arrivals.zip(0..));
        // Nearly always arrivals differ, so that only they are moved and compared.
        self.order.sort_unstable_by(|(a, i), (b, j)| {
            a.cmp(b)
                .then_with(|| known[*i as usize].cmp(&known[*j as usize]))
        });
        self.deciding = Some(level);
        self.done = 0;
        known.len()
    }

    /// Returns whether nothing is known to arrive with a level and those after it.
    pub(crate) fn is_empty_from(&self, level: u32) -> bool {
        self.levels[level as usize..].iter().all(Vec::is_empty)
    }

    /// Returns what arrives next with the level.
    pub(crate) fn next(&mut self) -> Option<Arriving> {
        let level = self.deciding?;
        let known = self.order.get(self.done);
        let known = known.map(|&(_, index)| &self.levels[level as usize][index as usize]);
        let sudden = self.sudden.peek().map(|Reverse(sudden)| sudden);
        // A question that came up late still comes in its turn: an earlier dart has its answer first.
        if sudden.is_some_and(|sudden| known.is_none_or(|known| sudden < known)) {
            return self.sudden.pop().map(|Reverse(sudden)| sudden);
        }
        self.done += 1;
        known.copied()
    }
}
